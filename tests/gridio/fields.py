# SPDX-License-Identifier: BSD-3-Clause
"""Reads the .nrrd and .npy files of a number per voxel in plain Python, and checks them against a box.

fields.py FOLDER: coverage.nrrd, coverage.npy, distance.nrrd, distance.npy of the box (1,1,1) to (4,3,2).
"""
import ast
import json
import struct
import sys

LOW, HIGH = (1, 1, 1), (4, 3, 2)


def read_nrrd(path):
    header, _, data = open(path, "rb").read().partition(b"\n\n")
    lines = header.decode("ascii").split("\n")
    assert lines[0] == "NRRD0004", lines
    keys = dict(line.split(": ") for line in lines[1:] if not line.startswith("#") and ":=" not in line)
    assert keys["encoding"] == "raw" and keys["dimension"] == keys["space dimension"] == "3"
    dims = [int(n) for n in keys["sizes"].split()]
    directions = [ast.literal_eval(v) for v in keys["space directions"].split()]
    size = [directions[a][a] for a in range(3)]
    assert all(directions[a][b] == 0 for a in range(3) for b in range(3) if a != b)
    first = ast.literal_eval(keys["space origin"])
    code = {"float": "f", "uchar": "B"}[keys["type"]]
    order = {"little": "<", "big": ">"}[keys.get("endian", "little")]
    values = struct.unpack("%s%d%s" % (order, dims[0] * dims[1] * dims[2], code), data)
    at = {}
    for n, value in enumerate(values):
        at[n % dims[0], n // dims[0] % dims[1], n // (dims[0] * dims[1])] = value
    return dims, [first[a] - size[a] / 2 for a in range(3)], size, at


def read_npy(path):
    data = open(path, "rb").read()
    assert data[:8] == b"\x93NUMPY\x01\x00"
    begin = 10 + struct.unpack("<H", data[8:10])[0]
    header = ast.literal_eval(data[10:begin].decode("ascii"))
    dims = header["shape"]
    assert not header["fortran_order"]
    code = {"<f4": "<%df", ">f4": ">%df", "|u1": "%dB"}[header["descr"]]
    values = struct.unpack(code % (dims[0] * dims[1] * dims[2]), data[begin:])
    about = json.load(open(path + ".json"))
    assert about["dims"] == list(dims)
    at = {}
    for n, value in enumerate(values):
        at[n // (dims[1] * dims[2]), n // dims[2] % dims[1], n % dims[2]] = value
    return list(dims), about["origin"], about["voxel_size"], at


def inside(low, high, a):
    return max(0, min(high, HIGH[a]) - max(low, LOW[a]))


def distance(p):
    outside = sum(max(LOW[a] - p[a], p[a] - HIGH[a], 0) ** 2 for a in range(3)) ** 0.5
    return outside if outside > 0 else -min(min(p[a] - LOW[a], HIGH[a] - p[a]) for a in range(3))


def check(name, right):
    files = [read_nrrd(name + ".nrrd"), read_npy(name + ".npy")]
    assert files[0] == files[1]
    dims, origin, size, values = files[0]
    assert len(values) == dims[0] * dims[1] * dims[2] > 100
    for voxel, value in values.items():
        corner = [origin[a] + voxel[a] * size[a] for a in range(3)]
        assert abs(value - right(corner, size)) < 1e-6, (name, voxel, value, right(corner, size))


def coverage(corner, size):
    share = 1
    for a in range(3):
        share *= inside(corner[a], corner[a] + size[a], a) / size[a]
    return share


def to_box(corner, size):
    return max(-1.0, min(1.0, distance([corner[a] + size[a] / 2 for a in range(3)])))


check(sys.argv[1] + "/coverage", coverage)
check(sys.argv[1] + "/bytes", lambda corner, size: int(255 * coverage(corner, size) + 0.5))
check(sys.argv[1] + "/distance", to_box)
