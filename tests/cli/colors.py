# SPDX-License-Identifier: BSD-3-Clause
"""colors.py make: meshes with colours and what they refer to, sound and damaged, in the working folder.
colors.py list FILE.npy [N]: the colours of its voxels and how often each is there, the N most frequent."""
import base64
import collections
import json
import os
import struct
import sys
import zlib


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width, height, rows):
    """A PNG of 8-bit RGB from rows of colours."""
    raw = b"".join(b"\0" + b"".join(bytes(pixel) for pixel in row) for row in rows)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


# 8 x 8 pixels of (200, 100, 50).
JPEG = base64.b64decode(
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAIBAQEBAQIBAQECAgICAgQDAgICAgUEBAMEBgUGBgYFBgYGBwkIBgcJBwYGCAsICQoKCgoKBggLDAsK"
    "DAkKCgr/2wBDAQICAgICAgUDAwUKBwYHCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgr/wAARCAAI"
    "AAgDASIAAhEBAxEB/8QAFQABAQAAAAAAAAAAAAAAAAAAAAX/xAAUEAEAAAAAAAAAAAAAAAAAAAAA/8QAFAEBAAAAAAAAAAAAAAAAAAAACP/EABQR"
    "AQAAAAAAAAAAAAAAAAAAAAD/2gAMAwEAAhEDEQA/AJ4Armw//9k=")

RED, GREEN, BLUE, GREY = (255, 0, 0), (0, 255, 0), (0, 0, 255), (90, 90, 90)
CORNERS = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
SIDES = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]


def write(name, data):
    os.makedirs(os.path.dirname(name) or ".", exist_ok=True)
    with open(name, "wb") as file:
        file.write(data if isinstance(data, bytes) else data.encode())


def cube(material, library, uvs=("0.1 0.1", "0.2 0.1", "0.2 0.2", "0.1 0.2")):
    """A cube whose sides all show the same part of the texture: by default its lower left."""
    lines = ["mtllib " + library] + ["v %d %d %d" % p for p in CORNERS] + ["vt " + uv for uv in uvs]
    lines.append("usemtl " + material)
    lines += ["f " + " ".join("%d/%d" % (v, n + 1) for n, v in enumerate(side)) for side in SIDES]
    return "\n".join(lines) + "\n"


def make():
    # Red above and green below on the left, blue and grey on the right.
    quarters = png(8, 8, [[RED] * 4 + [BLUE] * 4] * 4 + [[GREEN] * 4 + [GREY] * 4] * 4)
    write("cube.obj", cube("wood", "cube.mtl"))
    write("cube.mtl", "# a material\nnewmtl other\nKd 1 0 0\nnewmtl wood\nKd 0.5 0.5 0.5\nmap_Kd -s 1 1 1 -clamp on maps/four parts.png\n")
    write("maps/four parts.png", quarters)
    write("half.obj", cube("wood", "cube.mtl", ("0 0.1", "1 0.1", "1 0.2", "0 0.2")))
    write("nan.obj", cube("wood", "cube.mtl", ("nan nan", "inf 0", "1e300 1", "0 0")))
    write("plain.obj", cube("wood", "plain.mtl"))
    write("plain.mtl", "newmtl wood\nKd 0.5 0.25 1\n")
    for name, data in (("photo.jpg", JPEG), ("cut.jpg", JPEG[:180]), ("torn.png", quarters[:60] + b"\0\0" + quarters[62:]),
                       ("huge.png", quarters[:8] + chunk(b"IHDR", struct.pack(">IIBBBBB", 60000, 60000, 8, 6, 0, 0, 0)) +
                        quarters[33:]), ("drawing.bmp", b"BM" + bytes(60)), ("empty.png", b"")):
        stem = name.replace(".", "_")
        write(name, data)
        write(stem + ".obj", cube("wood", stem + ".mtl"))
        write(stem + ".mtl", "newmtl wood\nmap_Kd " + name + "\n")
    write("away.obj", cube("wood", "away.mtl"))
    write("away.mtl", "newmtl wood\nKd 0 0 1\nmap_Kd ../../../../../../../../etc/passwd\n")
    write("absolute.obj", cube("wood", "/etc/passwd"))
    write("no_library.obj", cube("wood", "missing.mtl"))
    write("vertices.obj", "\n".join("v %d %d %d 1 %d 0" % (p + (p[2],)) for p in CORNERS) + "\n" +
          "\n".join("f %d %d %d %d" % side for side in SIDES) + "\n")
    write("faces.off", "OFF\n8 6 0\n" + "\n".join("%d %d %d" % p for p in CORNERS) + "\n" +
          "\n".join("4 %d %d %d %d 0 128 255" % tuple(v - 1 for v in side) for side in SIDES) + "\n")
    gltf(quarters)


def gltf(picture):
    """A square in a glTF: its texture within the file, its upper left shown, times base colour and vertex colours."""
    floats = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0] + [0.1, 0.1, 0.2, 0.1, 0.2, 0.2, 0.1, 0.2] + [0.5, 1, 1] * 4
    data = struct.pack("<32f", *floats) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    uri = "data:%s;base64,%s"
    views = [(0, 48), (48, 32), (80, 48), (128, 12)]
    kinds = [(5126, 4, "VEC3"), (5126, 4, "VEC2"), (5126, 4, "VEC3"), (5123, 6, "SCALAR")]
    scene = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
             "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1, "COLOR_0": 2}, "indices": 3,
                                         "material": 0}]}],
             "materials": [{"name": "paint", "pbrMetallicRoughness": {"baseColorFactor": [0.25, 1, 1, 1],
                                                                      "baseColorTexture": {"index": 0}}}],
             "textures": [{"source": 0}],
             "images": [{"uri": uri % ("image/png", base64.b64encode(picture).decode())}],
             "buffers": [{"byteLength": len(data),
                          "uri": uri % ("application/octet-stream", base64.b64encode(data).decode())}],
             "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": size} for at, size in views],
             "accessors": [{"bufferView": n, "componentType": kind, "count": count, "type": name}
                           for n, (kind, count, name) in enumerate(kinds)]}
    scene["accessors"][0].update(min=[0, 0, 0], max=[1, 1, 0])
    write("square.gltf", json.dumps(scene))
    scene["images"][0] = {"uri": "maps/four%20parts.png"}
    write("beside.gltf", json.dumps(scene))
    # The upper right, by coordinates in whole numbers.
    data = data[:48] + struct.pack("<8H", *[round(65535 * c) for c in (0.6, 0.1, 0.7, 0.1, 0.7, 0.2, 0.6, 0.2)]) + data[64:]
    scene["buffers"][0]["uri"] = uri % ("application/octet-stream", base64.b64encode(data).decode())
    scene["accessors"][1].update(componentType=5123, normalized=True)
    write("whole.gltf", json.dumps(scene))


def show(path, most):
    with open(path, "rb") as file:
        data = file.read()
    begin = 10 + struct.unpack_from("<H", data, 8)[0]
    counts = collections.Counter(struct.iter_unpack("4B", data[begin:]))
    counts.pop((0, 0, 0, 0), None)
    for color, count in sorted(counts.items(), key=lambda item: (-item[1], item[0]))[:most]:
        print("%6d of %3d %3d %3d" % ((count,) + color[:3]))


if sys.argv[1] == "make":
    make()
else:
    show(sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else 8)
