# SPDX-License-Identifier: BSD-3-Clause
"""Reads what write_grids wrote, by readers made from the formats' descriptions alone.

readers.py plain FOLDER: binvox, raw, rle and nrrd in plain Python.
readers.py numpy FOLDER: npy by numpy itself; exits with 77 if there is no numpy.
"""
import ast
import json
import struct
import sys


def truth(path):
    lines = open(path + ".txt").read().split("\n")
    dims = [int(n) for n in lines[0].split()]
    origin, size = zip(*[map(float, line.split()) for line in lines[1:4]])
    voxels = {tuple(map(int, line.split())) for line in lines[4:] if line}
    return dims, list(origin), list(size), voxels


def read_binvox(path):
    header, _, data = open(path, "rb").read().partition(b"\ndata\n")
    lines = header.decode("ascii").split("\n")
    assert len(lines) == 4 and lines[0] == "#binvox 1", lines
    keys = {line.split()[0]: line.split()[1:] for line in lines[1:]}
    assert list(keys) == ["dim", "translate", "scale"]
    d, height, width = map(int, keys["dim"])
    assert d == height == width
    assert 0 not in data[1::2]
    values = b"".join(data[n : n + 1] * data[n + 1] for n in range(0, len(data), 2))
    assert len(values) == d ** 3
    voxels = {(n // (width * height), n % width, n // width % height) for n in range(d ** 3) if values[n]}
    return d, list(map(float, keys["translate"])), float(keys["scale"][0]), voxels


def unrank(n, dims):
    return n % dims[0], n // dims[0] % dims[1], n // (dims[0] * dims[1])


def read_raw(path):
    about = json.load(open(path + ".json"))
    assert about["format"] == "voxmend raw" and about["version"] == 1
    dims = about["dims"]
    total = dims[0] * dims[1] * dims[2]
    data = open(path, "rb").read()
    assert len(data) == (total + 7) // 8
    voxels = {unrank(n, dims) for n in range(total) if data[n // 8] >> n % 8 & 1}
    return dims, about["origin"], about["voxel_size"], voxels


def read_rle(path):
    data = open(path, "rb").read()
    assert data[:8] == b"VXMRLE1\n"
    dims = list(struct.unpack_from("<3q", data, 8))
    origin, size = list(struct.unpack_from("<3d", data, 32)), list(struct.unpack_from("<3d", data, 56))
    values, value = bytearray(), 0
    for run in data[80:]:
        values += bytes([value]) * run
        if run != 255:
            value = 1 - value
    assert len(values) == dims[0] * dims[1] * dims[2]
    return dims, origin, size, {unrank(n, dims) for n in range(len(values)) if values[n]}


def read_nrrd(path):
    header, _, data = open(path, "rb").read().partition(b"\n\n")
    lines = header.decode("ascii").split("\n")
    assert lines[0] == "NRRD0004", lines
    keys = dict(line.split(": ") for line in lines[1:] if not line.startswith("#") and ":=" not in line)
    assert (keys["type"], keys["encoding"], keys["dimension"]) == ("uchar", "raw", "3")
    dims = [int(n) for n in keys["sizes"].split()]
    assert len(data) == dims[0] * dims[1] * dims[2] and set(data) <= {0, 1}
    directions = [ast.literal_eval(v) for v in keys["space directions"].split()]
    size = [directions[a][a] for a in range(3)]
    assert all(directions[a][b] == 0 for a in range(3) for b in range(3) if a != b)
    first = ast.literal_eval(keys["space origin"])
    pairs = dict(line.split(":=") for line in lines[1:] if ":=" in line)
    origin = [float(n) for n in pairs["voxmend_origin"].split()]
    assert all(origin[a] + size[a] / 2 == first[a] for a in range(3))
    return dims, origin, size, {unrank(n, dims) for n in range(len(data)) if data[n]}


def check_plain(path):
    dims, origin, size, voxels = expected = truth(path)
    assert read_raw(path + ".raw") == expected, "raw"
    assert read_rle(path + ".rle") == expected, "rle"
    assert read_nrrd(path + ".nrrd") == expected, "nrrd"
    d, translate, scale, found = read_binvox(path + ".binvox")
    assert d == max(dims) and found == voxels, "binvox"
    for a in range(3):
        assert abs(translate[a] - origin[a]) <= 5e-9 * abs(origin[a])
        assert abs(scale / d - size[a]) <= 5e-9 * size[a]


def check_numpy(path, numpy):
    dims, origin, size, voxels = truth(path)
    array = numpy.load(path + ".npy", allow_pickle=False)
    assert array.dtype == numpy.bool_ and array.shape == tuple(dims) and array.flags["C_CONTIGUOUS"]
    assert {tuple(map(int, v)) for v in numpy.argwhere(array)} == voxels
    assert set(numpy.unique(array.view(numpy.uint8))) <= {0, 1}
    about = json.load(open(path + ".npy.json"))
    assert (about["dims"], about["origin"], about["voxel_size"]) == (dims, origin, size)


def main():
    kind, folder = sys.argv[1:]
    if kind == "numpy":
        try:
            import numpy
        except ImportError:
            print("no numpy")
            sys.exit(77)
    for n in range(4):
        path = "%s/%d" % (folder, n)
        if kind == "numpy":
            check_numpy(path, numpy)
        else:
            check_plain(path)


main()
