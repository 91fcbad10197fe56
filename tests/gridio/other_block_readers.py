# SPDX-License-Identifier: BSD-3-Clause
"""The formats of games and artists, read by others: nbtlib (.schem), litemapy (.litematic), a reader of MagicaVoxel's
chunks written from their description and, if it is there, midvoxio (.vox), trimesh (.glb). What they find is compared
with the .npy of the same voxels: which are set, where they lie, their labels and colours.

    other_block_readers.py VOXMEND FOLDER MESH...
"""

import json
import os
import struct
import subprocess
import sys

import litemapy
import nbtlib
import numpy as np
import trimesh

try:
    import pygltflib
except ImportError:
    pygltflib = None
try:
    from midvoxio.voxio import vox_to_arr
except ImportError:
    vox_to_arr = None

failures = 0


def check(holds, what):
    global failures
    if not holds:
        failures += 1
        print("FAIL", what)


def run(*arguments):
    subprocess.run([program, *map(str, arguments), "-q"], check=True)


# ---- What is true ----


class Truth:
    """Values of a .npy, with the place of its voxels."""

    def __init__(self, path):
        self.values = np.load(path)
        about = json.load(open(path + ".json"))
        self.origin, self.size = np.array(about["origin"]), np.array(about["voxel_size"])
        self.names = {entry["label"]: entry["name"] for entry in about.get("labels", [])}
        self.is_color = self.values.ndim == 4
        self.set = self.values[..., 3] > 0 if self.is_color else self.values != 0


def up_in_game(array, up):
    """The axes of a model as those of the game: x, y (up), z."""
    return {"z": lambda a: a.transpose(0, 2, 1, *range(3, a.ndim))[:, :, ::-1],
            "y": lambda a: a,
            "x": lambda a: a.transpose(2, 0, 1, *range(3, a.ndim))}[up](array)


# ---- Readers ----


def read_schem(path):
    """Names of blocks by x, y, z, and the file."""
    file = nbtlib.load(path)
    size = [int(file[key]) & 0xFFFF for key in ("Width", "Height", "Length")]
    names = {int(number): str(name) for name, number in file["Palette"].items()}
    data, numbers, value, shift = bytes(np.array(file["BlockData"], np.uint8)), [], 0, 0
    for byte in data:
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            numbers.append(value)
            value = shift = 0
    check(int(file["Version"]) == 2 and file.root_name == "Schematic" if hasattr(file, "root_name") else True,
          f"{path}: version 2")
    check(len(numbers) == size[0] * size[1] * size[2], f"{path}: as many blocks as it says")
    grid = np.array([names[n] for n in sorted(names)])[np.array(numbers)]
    return grid.reshape(size[1], size[2], size[0]).transpose(2, 0, 1), file["Metadata"]["voxmend"]


def read_litematic(path):
    schematic = litemapy.Schematic.load(path)
    (region,) = schematic.regions.values()
    numbers = region._Region__blocks
    names = np.array([state.id for state in region._Region__palette])
    return names[np.asarray(numbers)], nbtlib.load(path)["Metadata"]["voxmend"]


def read_vox(path):
    """Numbers of the palette by x, y, z, counted from the least of each, the palette, and the root's attributes. By
    ephtracy's description of the format alone."""
    data = open(path, "rb").read()
    assert data[:4] == b"VOX "
    at, models, nodes, palette = 20, [], {}, None

    def word(p):
        return struct.unpack_from("<i", data, p)[0]

    def text(p):
        return data[p + 4 : p + 4 + word(p)].decode(), p + 4 + word(p)

    def pairs(p):
        out, count = {}, word(p)
        p += 4
        for _ in range(count):
            key, p = text(p)
            out[key], p = text(p)
        return out, p

    while at < len(data):
        name, content = data[at : at + 4], at + 12
        at = content + word(at + 4)
        if name == b"SIZE":
            models.append([struct.unpack_from("<3i", data, content), None])
        elif name == b"XYZI":
            models[-1][1] = np.frombuffer(data, np.uint8, 4 * word(content), content + 4).reshape(-1, 4)
        elif name == b"RGBA":
            palette = np.frombuffer(data, np.uint8, 1024, content).reshape(256, 4)
        elif name in (b"nTRN", b"nGRP", b"nSHP"):
            nodes[word(content)] = (name, *pairs(content + 4))
    check(at == len(data), f"{path}: chunks end with the file")
    found = []

    def visit(number, step):
        name, _, p = nodes[number]
        if name == b"nTRN":
            frame, _ = pairs(p + 16)
            assert "_r" not in frame
            visit(word(p), step + np.array([int(v) for v in frame.get("_t", "0 0 0").split()]))
        elif name == b"nGRP":
            for child in range(word(p)):
                visit(word(p + 4 + 4 * child), step)
        else:
            size, voxels = models[word(p + 4)]
            corner = step - np.array(size) // 2
            found.append((corner, np.array(size), voxels))

    visit(0, np.zeros(3, int))
    low = np.min([corner for corner, _, _ in found], axis=0)
    high = np.max([corner + size for corner, size, _ in found], axis=0)
    check((low == 0).all(), f"{path}: the grid begins at 0")
    numbers = np.zeros(high - low, np.uint8)
    for corner, _, voxels in found:
        numbers[tuple((voxels[:, :3] + corner - low).T)] = voxels[:, 3]
    return numbers, palette, nodes[0][1]


def read_glb(path):
    """Triangles in the world of glTF, their normals, colours (sRGB) and names."""
    scene = trimesh.load(path)
    parts = []
    for node in scene.graph.nodes_geometry:
        matrix, geometry = scene.graph[node]
        mesh = scene.geometry[geometry].copy()
        colors = getattr(scene.geometry[geometry].visual, "vertex_attributes", {}).get("color")
        mesh.apply_transform(matrix)
        parts.append((node, mesh, colors))
    return parts


# ---- Comparisons ----


def compare_place(path, own, truth):
    check(np.array_equal(np.array(own["Origin"], float), truth.origin), f"{path}: origin")
    check(np.array_equal(np.array(own["VoxelSize"], float), truth.size), f"{path}: size of voxels")


def lab(rgb):
    """CIELAB, written anew: by matrices, for all at once."""
    v = np.asarray(rgb, float) / 255
    v = np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)
    xyz = v @ np.array([[0.4124, 0.2126, 0.0193], [0.3576, 0.7152, 0.1192], [0.1805, 0.0722, 0.9505]])
    t = xyz / [0.9505, 1, 1.089]
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.stack([116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])], -1)


def block_colors():
    """The table of the library's source: facts about the game."""
    source = os.path.join(os.path.dirname(__file__), "../../src/gridio/formats/minecraft/block_colors.c")
    lines = [line.strip().strip("{},") for line in open(source) if line.strip().startswith('{"minecraft:')]
    return {part.split(", {")[0].strip('"'): [int(v) for v in part.split("{")[1].split(",")] for part in lines}


def compare_blocks(path, truth, up):
    blocks, own = (read_schem if path.endswith("schem") else read_litematic)(path)
    voxels = up_in_game(truth.values, up)
    is_set = up_in_game(truth.set, up)
    check(blocks.shape == is_set.shape, f"{path}: sides {blocks.shape}")
    check(np.array_equal(blocks != "minecraft:air", is_set), f"{path}: voxels")
    compare_place(path, own, truth)
    if truth.is_color:
        table = block_colors()
        names, colors = list(table), lab(list(table.values()))
        for color in np.unique(voxels[is_set][:, :3], axis=0)[:500]:
            here = is_set & (voxels[..., :3] == color).all(-1)
            distance = ((colors - lab(color)) ** 2).sum(1)
            taken = set(blocks[here])
            check(len(taken) == 1 and distance[names.index(taken.pop())] <= distance.min() + 1e-9,
                  f"{path}: the block of {color} is the nearest")
    elif truth.names:
        taken = {}
        for label in truth.names:
            kinds = set(blocks[voxels == label])
            check(len(kinds) <= 1, f"{path}: label {label} is one kind of block")
            taken.update(dict.fromkeys(kinds, label))
        labels = np.unique((voxels[is_set].astype(int) - 1) % 48)
        check(len(taken) == len(labels), f"{path}: labels are told apart")
        check([str(name) for name in own["Labels"]] == list(truth.names.values()), f"{path}: names of labels")
    else:
        check(set(blocks[is_set]) <= {"minecraft:stone"}, f"{path}: stone")


def compare_vox(path, truth):
    numbers, palette, attributes = read_vox(path)
    check(numbers.shape == truth.set.shape, f"{path}: sides {numbers.shape}")
    check(np.array_equal(numbers != 0, truth.set), f"{path}: voxels")
    for key, value in (("voxmend_origin", truth.origin), ("voxmend_voxel_size", truth.size)):
        check([float(v) for v in attributes[key].split()] == list(value), f"{path}: {key}")
    if truth.is_color:
        found = palette[numbers[truth.set].astype(int) - 1][:, :3].astype(int)
        check(np.abs(found - truth.values[truth.set][:, :3]).max(initial=0) < 64, f"{path}: colours")
    elif truth.names:
        check(np.array_equal(numbers, truth.values), f"{path}: labels")
        check([attributes[f"voxmend_label_{label}"] for label in truth.names] == list(truth.names.values()),
              f"{path}: names of labels")
    if vox_to_arr and max(numbers.shape) <= 256:
        array = vox_to_arr(path)
        check(np.array_equal(array[..., 3] > 0, truth.set), f"{path}: voxels by midvoxio")


def compare_glb(path, truth, up):
    """Each triangle lies between a set voxel and an empty one, and their area is that of all such faces."""
    parts = read_glb(path)
    turn = np.array({"z": [[1, 0, 0], [0, 0, 1], [0, -1, 0]], "y": np.eye(3), "x": [[0, 0, 1], [1, 0, 0], [0, 1, 0]]}[up])
    padded, area = np.pad(truth.set, 1), 0
    for axis in range(3):
        faces = np.count_nonzero(np.diff(padded.astype(np.int8), axis=axis))
        area += faces * np.prod(truth.size) / truth.size[axis]
    total, volume = 0, 0
    for name, mesh, colors in parts:
        points = mesh.triangles_center @ turn  # from glTF's axes to the model's
        normals = mesh.face_normals @ turn
        inside = np.floor((points - 0.25 * normals * truth.size - truth.origin) / truth.size).astype(int)
        outside = np.floor((points + 0.25 * normals * truth.size - truth.origin) / truth.size).astype(int)
        check(padded[tuple(inside.T + 1)].all() and not padded[tuple(outside.T + 1)].any(), f"{path}: {name}: places")
        total += mesh.area
        a, b, c = mesh.triangles.transpose(1, 0, 2)
        volume += np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
        if truth.is_color:
            linear = truth.values[tuple(inside.T)][:, :3] / 255.0
            linear = np.where(linear <= 0.04045, linear / 12.92, ((linear + 0.055) / 1.055) ** 2.4)
            scale = 65535 if colors.dtype == np.uint16 else 255 if colors.dtype == np.uint8 else 1
            check(np.abs(colors[mesh.faces[:, 0]][:, :3] / scale - linear).max() <= 1.01 / 255, f"{path}: colours")
        elif truth.names:
            label = {value: key for key, value in truth.names.items()}.get(name.rsplit("_", 1)[0] if name not in truth.names.values() else name)
            check(label is not None and (truth.values[tuple(inside.T)] == label).all(), f"{path}: label {name}")
    check(np.isclose(total, area, rtol=1e-6), f"{path}: area {total}, not {area}")
    expected = np.count_nonzero(truth.set) * np.prod(truth.size)
    check(np.isclose(volume, expected, rtol=1e-4, atol=1e-9), f"{path}: volume {volume}, not {expected}")
    if pygltflib:
        check_structure(path)


def check_structure(path):
    """Counts, ranges and boxes of accessors."""
    file = pygltflib.GLTF2().load(path)
    blob = file.binary_blob() or b""
    kinds = {5126: "<f4", 5123: "<u2", 5125: "<u4"}
    wide = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
    arrays = []
    for accessor in file.accessors:
        view = file.bufferViews[accessor.bufferView]
        kind = np.dtype(kinds[accessor.componentType])
        count = accessor.count * wide[accessor.type]
        begin = view.byteOffset + accessor.byteOffset
        check(accessor.byteOffset + count * kind.itemsize <= view.byteLength, f"{path}: accessor within its view")
        check(begin % kind.itemsize == 0, f"{path}: accessor aligned")
        array = np.frombuffer(blob, kind, count, begin).reshape(accessor.count, -1)
        if accessor.min:
            check(np.array_equal(array.min(0), accessor.min) and np.array_equal(array.max(0), accessor.max), f"{path}: box")
        arrays.append(array)
    for mesh in file.meshes:
        for primitive in mesh.primitives:
            positions, normals = arrays[primitive.attributes.POSITION], arrays[primitive.attributes.NORMAL]
            indices = arrays[primitive.indices].reshape(-1, 3)
            check(indices.max() < len(positions) == len(normals), f"{path}: indices")
            corners = positions[indices].astype(float)
            turned = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            check((np.einsum("ij,ij->i", turned, normals[indices[:, 0]]) > 0).all(), f"{path}: normals face as faces do")
    check(file.buffers[0].byteLength == len(blob) if file.buffers else not blob, f"{path}: length of the buffer")


# ---- All together ----


def compare(mesh, folder, options, up):
    name = os.path.join(folder, os.path.basename(mesh).replace(".", "-") + "".join(options).replace("--", "-"))
    base = name + ".npy"
    run("voxelize", mesh, "-o", base, "-r", 20, "--fit", "tight", *options)
    truth = Truth(base)
    for format in ("schem", "litematic", "vox", "glb"):
        path = f"{name}-{up}.{format}"
        turned = [] if format == "vox" or up == "z" else ["--up", up]
        run("voxelize", mesh, "-o", path, "-r", 20, "--fit", "tight", *options, *turned)
        converted = path.replace(f".{format}", f"-converted.{format}")
        run("convert", base, "-o", converted, *turned)
        check(open(path, "rb").read() == open(converted, "rb").read(), f"{path}: convert writes the same")
        if format == "vox":
            compare_vox(path, truth)
        elif format == "glb":
            compare_glb(path, truth, up)
        else:
            compare_blocks(path, truth, up)
        if format != "glb":
            back = path + "-back.npy"
            run("convert", path, "-o", back)
            again = Truth(back)
            check(np.array_equal(again.origin, truth.origin) and np.array_equal(again.size, truth.size), f"{back}: place")
            check(np.array_equal(again.set, truth.set), f"{back}: voxels")
            values = truth.values
            if not truth.is_color and format != "vox":  # blocks repeat after 48 labels
                values = np.where(values > 0, (values.astype(int) - 1) % 48 + 1, 0)
            check(truth.is_color or np.array_equal(again.values, values), f"{back}: values")
            check(again.names == truth.names or len(truth.names) == 0, f"{back}: names")
    return int(np.count_nonzero(truth.set))


def main():
    for number, mesh in enumerate(meshes):
        for options in ([], ["--labels", "part"], ["--labels", "group"], ["--color", "noise"], ["--color", "part"]):
            up = "zyx"[(number + len(options)) % 3]
            voxels = compare(mesh, folder, options, up)
            print(f"{os.path.basename(mesh)} {' '.join(options)} up {up}: {voxels} voxels")
    print(f"{len(meshes)} meshes, {failures} failures")
    sys.exit(failures > 0)


program, folder, *meshes = sys.argv[1:]
main()
