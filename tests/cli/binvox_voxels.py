# SPDX-License-Identifier: BSD-3-Clause
"""The voxels and files of binvox, compared with what numpy makes of 'voxmend voxelize' and of each other.

binvox_voxels.py BINVOX VOXMEND FOLDER ZLIB: FOLDER holds the sample meshes.
"""
import gzip
import json
import os
import struct
import subprocess
import sys

import numpy

BINVOX, VOXMEND, FOLDER, ZLIB = sys.argv[1:5]
os.chdir(FOLDER)
checks = 0


def check(is_right, *what):
    global checks
    checks += 1
    if not is_right:
        sys.exit("FAILED: " + " ".join(map(str, what)))


def run(*words):
    done = subprocess.run([BINVOX, *map(str, words)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit("FAILED: binvox %s: %s" % (" ".join(map(str, words)), done.stderr))
    return done.stdout


def read_binvox(path):
    """The voxels as [x, y, z], their size and the corner."""
    header, _, data = open(path, "rb").read().partition(b"\ndata\n")
    keys = {line.split()[0]: line.split()[1:] for line in header.decode("ascii").split("\n")}
    dims = [int(n) for n in keys["dim"]]
    pairs = numpy.frombuffer(data, numpy.uint8).reshape(-1, 2)
    voxels = numpy.repeat(pairs[:, 0], pairs[:, 1]).astype(bool).reshape(dims).transpose(0, 2, 1)
    return voxels, float(keys["scale"][0]) / dims[0], numpy.array([float(t) for t in keys["translate"]])


def voxels_of(*words):
    if os.path.exists("out.binvox"):
        os.remove("out.binvox")
    said = run("-o", "out.binvox", *words)
    read = read_binvox("out.binvox")
    counted = [int(word) for word in said.split("counted")[1].split("\n")[0].split() if word.isdigit()]
    check(len(counted) == 2 and counted[0] == read[0].sum(), "counted", counted, read[0].sum(), words)
    return read


def voxelize(mesh, *words):
    subprocess.run([VOXMEND, "voxelize", mesh, "-o", "truth.npy", "-q", *map(str, words)], check=True)
    about = json.load(open("truth.npy.json"))
    return numpy.load("truth.npy").astype(bool), about["voxel_size"][0], numpy.array(about["origin"])


def same(a, b, *what):
    check(a[0].shape == b[0].shape and (a[0] == b[0]).all(), "other voxels:", *what)
    check(abs(a[1] - b[1]) <= 1e-7 * a[1] and abs(a[2] - b[2]).max() <= 1e-7 * max(1, abs(a[2]).max()), "other place:", *what, a[1:], b[1:])


# ---- The operations, plainly ----

def carved(solid):
    seen = numpy.zeros_like(solid)
    for axis in range(3):
        seen |= numpy.cumsum(solid, axis) == 0
        seen |= numpy.flip(numpy.cumsum(numpy.flip(solid, axis), axis), axis) == 0
    return ~seen


def neighbours(voxels):
    padded = numpy.pad(voxels, 1)
    for axis in range(3):
        for step in (-1, 1):
            yield numpy.roll(padded, step, axis)[1:-1, 1:-1, 1:-1]


def dilated(voxels):
    return numpy.logical_or.reduce([voxels, *neighbours(voxels)])


def hollow(voxels):
    return voxels & ~numpy.logical_and.reduce(list(neighbours(voxels)))


def halved(voxels, least):
    voxels = numpy.pad(voxels, [(0, n % 2) for n in voxels.shape])
    x, y, z = (n // 2 for n in voxels.shape)
    return voxels.reshape(x, 2, y, 2, z, 2).sum((1, 3, 5)) >= least


def fitted(voxels):
    where = numpy.argwhere(voxels)
    low, high = where.min(0), where.max(0) + 1
    part = voxels[tuple(slice(a, b) for a, b in zip(low, high))]
    return numpy.pad(part, [(0, max(part.shape) - n) for n in part.shape]), low


# ---- Voxels ----

def bounds_of(mesh):
    report = json.loads(subprocess.run([VOXMEND, "info", mesh, "--json"], capture_output=True, check=True).stdout)
    return numpy.array(report["bounds"])


def test_methods(mesh, n):
    b = bounds_of(mesh)
    side = (b[3:] - b[:3]).max()
    box = "--bounds=" + ",".join(repr(float(v)) for v in (*b[:3], *(b[:3] + side)))
    grid = (box, "-r", "%dx%dx%d" % (n, n, n))
    solid = voxelize(mesh, *grid)
    same(voxels_of("-d", n, mesh), solid, mesh, n)
    same(voxels_of("-d", n, "-cb", mesh), voxelize(mesh, "-r", n), mesh, n, "-cb")
    same(voxels_of("-d", n, "-v", mesh), voxelize(mesh, *grid, "--vote", "majority"), mesh, n, "-v")
    same(voxels_of("-d", n, "-e", mesh), voxelize(mesh, *grid, "--mode", "surface"), mesh, n, "-e")
    both = voxelize(mesh, *grid, "--mode", "both", "--surface", "thin")
    same(voxels_of("-d", n, "-aw", mesh), both, mesh, n, "-aw")
    voxels, size, corner = solid
    same(voxels_of("-d", n, "-c", mesh), (carved(voxels), size, corner), mesh, n, "-c")
    same(voxels_of("-d", n, "-dc", mesh), (dilated(carved(voxels)), size, corner), mesh, n, "-dc")
    same(voxels_of("-d", n, "-ri", mesh), (hollow(voxels), size, corner), mesh, n, "-ri")
    part, low = fitted(voxels)
    same(voxels_of("-d", n, "-fit", mesh), (part, size, corner + size * low), mesh, n, "-fit")
    for least in range(1, 9):
        down = voxels_of("-d", n, "-down", "-dmin", least, mesh)
        same(down, (halved(voxels, least), 2 * size, corner), mesh, n, "-down", least)
    twice = halved(halved(voxels, 4), 4)
    same(voxels_of("-down", "-d", n, mesh, "-down"), (twice, 4 * size, corner), mesh, n, "-down -down")
    all_of_them = hollow(halved(dilated(carved(both[0])), 2))
    part, low = fitted(all_of_them)
    same(voxels_of("-aw", "-dc", "-down", "-dmin", 2, "-ri", "-fit", "-pb", "-d", n, mesh),
         (part, 2 * size, corner + 2 * size * low), mesh, n, "all")
    return (voxels != carved(voxels)).any()


def test_fit(mesh, n, shift):
    """A box around the model, so that the voxels begin and end within words of 64."""
    b = bounds_of(mesh)
    side = (b[3:] - b[:3]).max()
    corner = b[:3] - shift * side
    words = ("-d", n, "-bb", *map(float, corner), *map(float, corner + 1.7 * side), mesh)
    voxels, size, corner = voxels_of(*words)
    part, low = fitted(voxels)
    check(low.min() > 0 and (low[0] + part.shape[0]) // 64 > low[0] // 64, mesh, "does not cross words", low)
    same(voxels_of("-fit", *words), (part, size, corner + size * low), mesh, n, "-fit -bb")


def test_turns(mesh, n):
    """Turned about its centre, the mesh fills voxels that are turned alike."""
    turns = {"-rotx": lambda v: numpy.rot90(v, 1, (1, 2)), "-roty": lambda v: numpy.rot90(v, 1, (2, 0)),
             "-rotz": lambda v: numpy.rot90(v, -1, (0, 1))}
    for words in (["-rotx"], ["-roty"], ["-rotz"], ["-rotx", "-rotz"], ["-rotz", "-rotx", "-rotz", "-rotz"]):
        expected = voxels_of("-d", n, "-cb", "-e", mesh)[0]
        for word in words:
            expected = turns[word](expected)
        got = voxels_of("-d", n, "-cb", "-e", *words, mesh)[0]
        check((got == expected).all() and got.any(), "turned otherwise:", mesh, words)
    check(not (voxels_of("-d", n, "-cb", "-e", mesh)[0] == got).all(), mesh, "is symmetrical, which tests nothing")


def test_box():
    voxels, size, corner = voxels_of("-d", 8, "-bb", -1, -1, -1, 3, 2, 2, "cube.off")
    check(size == 0.5 and (corner == -1).all(), "-bb", size, corner)
    expected = numpy.zeros((8, 8, 8), bool)
    expected[2:4, 2:4, 2:4] = True
    check((voxels == expected).all(), "-bb: other voxels")


# ---- Files ----

def read_vtk(path):
    header, _, data = open(path, "rb").read().partition(b"LOOKUP_TABLE default\n")
    words = header.decode("ascii").split()
    numbers = {key: words[words.index(key) + 1:][:3] for key in ("DIMENSIONS", "ORIGIN", "SPACING")}
    dims = [int(n) for n in numbers["DIMENSIONS"]]
    voxels = numpy.frombuffer(data, numpy.uint8, dims[0] * dims[1] * dims[2]).reshape(dims[::-1]).transpose(2, 1, 0)
    size = float(numbers["SPACING"][0])
    return voxels.astype(bool), size, numpy.array([float(n) for n in numbers["ORIGIN"]]) - size / 2


def read_msh(path, like):
    lines = iter(open(path).read().split("\n"))
    sections = {}
    for line in lines:
        if line.startswith("$"):
            sections[line] = []
            for entry in lines:
                if entry.startswith("$End"):
                    break
                sections[line].append(entry.split())
    check(sections["$MeshFormat"] == [["2.2", "0", "8"]], path, "version")
    check(len(sections["$Nodes"]) - 1 == int(sections["$Nodes"][0][0]), path, "nodes")
    nodes = {int(n[0]): numpy.array([float(v) for v in n[1:]]) for n in sections["$Nodes"][1:]}
    elements = sections["$Elements"][1:]
    check(len(elements) == int(sections["$Elements"][0][0]), path, "elements")
    voxels, size, corner = numpy.zeros(like[0].shape, bool), like[1], like[2]
    for e in elements:
        check(e[1:5] == ["5", "2", "1", "1"], path, "hexahedra", e)
        p = numpy.array([nodes[int(n)] for n in e[5:]])
        volume = numpy.dot(numpy.cross(p[1] - p[0], p[3] - p[0]), p[4] - p[0])
        check(abs(volume - size ** 3) < 1e-4 * size ** 3, path, "volume")
        voxels[tuple(numpy.floor((p.mean(0) - corner) / size).astype(int))] = True
    check({int(n) for e in elements for n in e[5:]} == set(nodes), path, "nodes without an element")
    return voxels, size, corner


def read_nbt(data):
    """A reader of Minecraft's tags, by their description: big-endian, a type, a name, the content."""
    at = 0

    def take(form):
        nonlocal at
        values = struct.unpack_from(">" + form, data, at)
        at += struct.calcsize(">" + form)
        return values[0]

    def text():
        nonlocal at
        length = take("H")
        at += length
        return data[at - length:at].decode("utf-8")

    def value(tag):
        nonlocal at
        if tag in (1, 2, 3):
            return take("bhi"[tag - 1])
        if tag == 7:
            length = take("i")
            at += length
            return data[at - length:at]
        if tag == 8:
            return text()
        if tag == 9:
            kind, length = take("b"), take("i")
            return [value(kind) for _ in range(length)]
        check(tag == 10, "tag", tag)
        entries = {}
        while True:
            kind = take("b")
            if kind == 0:
                return entries
            name = text()
            entries[name] = value(kind)

    check(take("b") == 10 and text() == "Schematic", "not a schematic")
    root = value(10)
    check(at == len(data), "bytes behind the end")
    return root


def read_blocks(path):
    root = read_nbt(gzip.open(path).read())
    width, height, length = root["Width"], root["Height"], root["Length"]
    check(root["Materials"] == "Alpha" and not any(root["Data"]) and root["Entities"] == [] and root["TileEntities"] == [], root.keys())
    blocks = numpy.frombuffer(root["Blocks"], numpy.uint8).reshape(height, length, width)
    return blocks.transpose(2, 0, 1)


def read_schematic(path, block):
    blocks = read_blocks(path)
    check(set(numpy.unique(blocks)) <= {0, block}, "blocks", numpy.unique(blocks))
    return blocks == block


def test_files(mesh, n, *words):
    truth = voxels_of("-d", n, *words, mesh)
    for kind in ("vtk", "raw", "msh", "nrrd"):
        run("-d", n, *words, "-t", kind, "-o", "out." + kind, mesh)
    vtk = read_vtk("out.vtk")
    if vtk[0].shape != truth[0].shape:  # -fit: .binvox is made a cube
        vtk = (numpy.pad(vtk[0], [(0, a - b) for a, b in zip(truth[0].shape, vtk[0].shape)]), *vtk[1:])
    same(vtk, truth, mesh, words, "vtk")
    same(read_msh("out.msh", truth), truth, mesh, words, "msh")
    shape = read_vtk("out.vtk")[0].shape
    raw = numpy.fromfile("out.raw", numpy.uint8).reshape(shape[0], shape[2], shape[1]).transpose(0, 2, 1)
    check((raw == read_vtk("out.vtk")[0]).all(), mesh, words, "raw")
    subprocess.run([VOXMEND, "convert", "out.nrrd", "-o", "nrrd.npy", "-q"], check=True)
    check((numpy.load("nrrd.npy") == read_vtk("out.vtk")[0]).all(), mesh, words, "nrrd")
    if ZLIB == "yes":
        run("-d", n, *words, "-t", "schematic", "-bi", 45, "-o", "out.schematic", mesh)
        check((read_schematic("out.schematic", 45) == read_vtk("out.vtk")[0]).all(), mesh, words, "schematic")


def test_blocks():
    """Each material alone, in the same box, touches the voxels that have its block, or a higher one."""
    corners = ["v %d %d %d" % (n & 1, n >> 1 & 1, n >> 2) for n in range(8)]
    sides = {"blockid_35": ["f 1 3 4 2", "f 1 5 7 3"], "blockid_255": ["f 5 6 8 7"], "stone": ["f 1 2 6 5", "f 2 4 8 6"], "blockid_256": ["f 3 7 8 4"]}
    with open("blocks.obj", "w") as file:
        file.write("\n".join(corners + ["\n".join(["usemtl " + name] + faces) for name, faces in sides.items()]) + "\n")
    for words in ((), ("-down", "-dmin", 1), ("-fit", "-bb", -0.3, -0.3, -0.3, 1.5, 1.2, 1.2)):
        box = words if "-bb" in words else (*words, "-bb", 0, 0, 0, 1, 1, 1)
        run("-d", 9, "-e", "-mb", "-bi", 7, "-t", "schematic", "-o", "out.schematic", *box, "blocks.obj")
        got, truth = read_blocks("out.schematic"), None
        for name, block in (("all", 7), ("blockid_35", 35), ("blockid_255", 255)):
            with open("one.obj", "w") as file:
                file.write("\n".join(corners + (sum(sides.values(), []) if name == "all" else sides[name])) + "\n")
            voxels = voxels_of("-d", 9, "-e", *[w for w in box if w != "-fit"], "one.obj")[0]
            truth = numpy.where(voxels, block, truth) if truth is not None else voxels * block
        if "-fit" in words:
            where = numpy.argwhere(truth)
            truth = truth[tuple(slice(a, b + 1) for a, b in zip(where.min(0), where.max(0)))]
        check(got.shape == truth.shape and (got == truth).all() and set(numpy.unique(got)) == {0, 7, 35, 255}, "-mb", words)


MESHES = (("torus.off", 33), ("rocket.off", 70), ("open_box.off", 24), ("cavity.off", 130), ("cube.off", 2), ("missing.off", 64))
hidden = [test_methods(mesh, n) for mesh, n in MESHES]
check(any(hidden), "nothing is hidden in any mesh, which tests nothing")
test_fit("rocket.off", 150, 0.3)
test_fit("torus.off", 201, 0.41)
test_turns("rocket.off", 37)
test_turns("star_prism.off", 20)
test_box()
test_files("rocket.off", 21)
test_files("l_prism.off", 13, "-fit", "-rotx")
if ZLIB == "yes":
    test_blocks()
    # The command line of a public script (doc/binvox.md), and the voxels that it means.
    words = ("-d", 64, "-down", "-down", "-rotx", "-rotz", "-rotz", "-rotz", "star_prism.off")
    run("-t", "schematic", "-o", "out.schematic", *words)
    check((read_schematic("out.schematic", 1) == voxels_of(*words)[0]).all() and voxels_of(*words)[0].sum() == 495, words)
print(checks, "checks")
