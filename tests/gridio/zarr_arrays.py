#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Zarr arrays of the package zarr read by voxmend, and the other way round.

zarr_arrays.py VOXMEND FOLDER
"""
import itertools, json, os, subprocess, sys

import numcodecs
import numpy
import zarr

VOXMEND, FOLDER = sys.argv[1:3]
NEW = int(zarr.__version__.split(".")[0]) >= 3  # its own format is 3; it reads and writes 2


def voxmend(*words):
    return subprocess.run([VOXMEND, *words], capture_output=True, text=True, cwd=FOLDER)


def create(name, values, chunks, **how):
    """An array of format 2 with values, by either version of the package."""
    path = os.path.join(FOLDER, name)
    if NEW:
        separator = how.pop("dimension_separator", ".")
        array = zarr.create(store=path, zarr_format=2, overwrite=True, shape=values.shape, chunks=chunks, dtype=values.dtype,
                            dimension_separator=separator, **how)
    else:
        array = zarr.open(path, mode="w", shape=values.shape, chunks=chunks, dtype=values.dtype, **how)
    array[...] = values
    return array


def read(name):
    """What voxmend makes of it, as numpy has it."""
    done = voxmend("convert", name, "-o", "back.npy")
    if "need zlib" in done.stderr:
        print("built without zlib")
        sys.exit(77)
    assert done.returncode == 0, done.stderr
    return numpy.load(os.path.join(FOLDER, "back.npy")), done.stderr


def strangers():
    random = numpy.random.default_rng(3)
    shape = (13, 7, 21)
    count = 0
    packers = (None, numcodecs.Zlib(1), numcodecs.GZip(5))
    types = ("|b1", "|u1", "|i1", "<u2", ">i2", "<u4", ">f4", "<f8", "<f2", ">u8")
    for number, (kind, packer, order) in enumerate(itertools.product(types, packers, "CF")):
        values = random.integers(0, 2 if kind == "|b1" else 90, shape).astype(kind)
        values[:6] = 0 if number % 2 else values[0, 0, 0]
        chunks = [(5, 7, 4), (13, 7, 21), (64, 64, 64), (1, 2, 21)][number % 4]
        how = {"order": order, "dimension_separator": "./"[number % 3 == 0]}
        if number % 5 == 0 and kind != "<f2":
            how["fill_value"] = values[0, 0, 0].item()
        create("a.zarr", values, chunks, compressor=packer, **how)
        back, _ = read("a.zarr")
        assert back.shape == shape and (back == values).all(), (kind, packer, order, chunks)
        count += 1
    return count


def fill_values():
    values = numpy.zeros((4, 5, 6), "<f4")
    for fill in (float("nan"), float("inf"), -float("inf"), 2.5, 0):
        array = create("f.zarr", values, (2, 2, 2), compressor=None, fill_value=fill)
        for key in os.listdir(os.path.join(FOLDER, "f.zarr")):
            if key[0] != ".":
                os.unlink(os.path.join(FOLDER, "f.zarr", key))
        assert numpy.array_equal(read("f.zarr")[0], numpy.full((4, 5, 6), fill, "<f4"), equal_nan=True), fill


def places():
    values = numpy.arange(60, dtype="<i4").reshape(3, 4, 5)
    array = create("p.zarr", values, (3, 4, 5), compressor=None)
    assert "no attributes \"origin\" and" in read("p.zarr")[1]
    # Axes as others write them; what they are not is told, and the names of xarray may be anything.
    for said, order in (("zyx", (2, 1, 0)), ("Z, X, Y", (1, 2, 0)), (["z", "y", "x"], (2, 1, 0)), ("zyxc", (2, 1, 0)), ("zyxcc", None), ("depth", None), (["x", "y", "y"], None),
                        (3, None)):
        for name in ("axes", "_ARRAY_DIMENSIONS"):
            array.attrs.put({name: said, "origin": [1, 2, 3], "voxel_size": 1})
            back, warned = read("p.zarr")
            assert (back == values.transpose(order or (0, 1, 2))).all(), (said, name)
            assert ("\"axes\" is not" in warned) == (order is None and name == "axes"), (said, name, warned)
    for attributes, place, lacks in (({"voxel_size": 0.5}, [[0, 0, 0], [0.5] * 3], "\"origin\""),
                                     ({"origin": [1, 2, 3], "voxel_size": [1, 2]}, [[1, 2, 3], [1] * 3], "\"voxel_size\"")):
        array.attrs.put(attributes)
        assert "no attribute " + lacks in read("p.zarr")[1]
        with open(os.path.join(FOLDER, "back.npy.json")) as file:
            told = json.load(file)
        assert [told["origin"], told["voxel_size"]] == place, told
    array.attrs.put({})
    array.attrs.update({"axes": "z,y,x", "origin": [1, 2, 3], "voxel_size": [0.5, 0.25, 2], "metadata": {"unit": "mm"}})
    back, warned = read("p.zarr")
    assert not warned and (back == values.transpose(2, 1, 0)).all()
    with open(os.path.join(FOLDER, "back.npy.json")) as file:
        told = json.load(file)
    assert told["origin"] == [1, 2, 3] and told["voxel_size"] == [0.5, 0.25, 2] and told["metadata"] == {"unit": "mm"}
    colors = numpy.random.default_rng(4).integers(0, 256, (3, 4, 5, 3)).astype("|u1")
    for chunks in ((2, 2, 2, 3), (3, 4, 5, 1)):
        for order in "CF":
            create("c.zarr", colors, chunks, compressor=numcodecs.Zlib(), order=order)
            back, _ = read("c.zarr")
            assert (back[..., :3] == colors).all() and (back[..., 3] == 255).all()


def refused():
    values = numpy.ones((4, 5, 6), "|u1")
    cases = [({"compressor": numcodecs.Blosc()}, "compressed by blosc, which is not read; save it with compressor=numcodecs.Zlib()"),
             ({"compressor": None, "filters": [numcodecs.Delta("|u1")]}, "filters=None")]
    for how, text in cases:
        create("r.zarr", values, (4, 5, 6), **how)
        done = voxmend("convert", "r.zarr", "-o", "r.npy")
        assert done.returncode == 1 and text in done.stderr and done.stderr.count("\n") == 1, done.stderr
    for values, text in ((numpy.ones((4, 5), "|u1"), "2 dimensions"), (numpy.ones((2, 2, 2), "<c8"), "type <c8")):
        create("r.zarr", values, values.shape, compressor=None)
        done = voxmend("convert", "r.zarr", "-o", "r.npy")
        assert done.returncode == 1 and text in done.stderr, done.stderr
    os.makedirs(os.path.join(FOLDER, "g.zarr"))
    for name, text in ((".zgroup", "give the array in it"), ("zarr.json", "zarr_format=2")):
        with open(os.path.join(FOLDER, "g.zarr", name), "w") as file:
            file.write("{}")
        done = voxmend("convert", "g.zarr", "-o", "r.npy")
        assert done.returncode == 1 and text in done.stderr, done.stderr
        os.unlink(os.path.join(FOLDER, "g.zarr", name))
    assert not os.path.exists(os.path.join(FOLDER, "r.npy"))


def ours():
    """What voxmend writes, of bits and of numbers of every type."""
    random = numpy.random.default_rng(5)
    for kind in ("|b1", "|u1", "<u2", "<i4", "<f4", "<f8", "<f2"):
        values = random.integers(0, 2 if kind == "|b1" else 90, (70, 65, 130)).astype(kind)
        values[:, :64] *= numpy.array(0).astype(kind)
        numpy.save(os.path.join(FOLDER, "o.npy"), values)
        done = voxmend("convert", "o.npy", "-o", "o.zarr", "-q")
        assert done.returncode == 0, done.stderr
        array = zarr.open(os.path.join(FOLDER, "o.zarr"), mode="r")
        assert array.dtype == numpy.dtype(kind) and array.chunks == (64, 64, 64)
        assert (array[...] == values).all()
        assert not os.path.exists(os.path.join(FOLDER, "o.zarr", "0.0.0"))  # all zeros


count = strangers()
fill_values()
places()
refused()
ours()
print(f"{count} arrays of zarr {zarr.__version__} were read")
