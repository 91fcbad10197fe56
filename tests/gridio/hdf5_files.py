#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What voxmend makes of .h5 files: its own come back as they were, those of h5py are what h5py was given, and damaged ones
are refused in one line.

hdf5_files.py VOXMEND FOLDER
"""
import itertools, json, os, random, subprocess, sys

import numpy

VOXMEND, FOLDER = sys.argv[1:3]
DAMAGED = int(os.environ.get("DAMAGED", "40"))


def voxmend(*words):
    return subprocess.run([VOXMEND, *words], capture_output=True, text=True, cwd=FOLDER, errors="replace")


def content(name):
    with open(os.path.join(FOLDER, name), "rb") as file:
        return file.read()


def own():
    for options in ((), ("--distance", "signed"), ("--coverage", "4", "--scalar", "uint8"), ("--labels", "part"),
                    ("--color", "position"), ("--sparse",)):
        for name in ("a.h5", "a.npy"):
            done = voxmend("voxelize", "cavity.off", "-r", "17x23x19", "--fit", "tight", "-o", name, "-q", *options)
            if "configure --with-hdf5" in done.stderr:
                print("built without HDF5")
                sys.exit(77)
            assert done.returncode == 0, done.stderr
        done = voxmend("convert", "a.h5", "-o", "b.npy")
        assert done.returncode == 0 and not done.stderr, done.stderr
        for name in ("a.npy", "a.npy.json"):
            assert content(name) == content(name.replace("a.", "b.", 1)), (options, name)
        for name in ("a.npy", "b.npy", "a.npy.json", "b.npy.json"):
            os.remove(os.path.join(FOLDER, name))
    # Numbers of which nothing is said stay such.
    for name in ("a.h5", "a.nii", "b.npy", "a.nrrd"):
        if name == "a.h5":
            numpy.save(os.path.join(FOLDER, "a.npy"), numpy.arange(24, dtype="i4").reshape(2, 3, 4))
        done = voxmend("convert", {"a.h5": "a.npy", "a.nii": "a.h5", "b.npy": "a.h5", "a.nrrd": "b.npy"}[name], "-o", name, "-q")
        assert done.returncode == 0, done.stderr
    with open(os.path.join(FOLDER, "b.npy.json")) as file:
        assert "values" not in json.load(file)
    assert b"numbers" not in content("a.nrrd")
    for name in ("a.npy", "a.h5", "a.nii", "b.npy", "b.npy.json", "a.nrrd"):
        os.remove(os.path.join(FOLDER, name))
    voxmend("voxelize", "cavity.off", "-r", "17", "-o", "bits.h5", "-q")
    assert voxmend("combine", "bits.h5", "minus", "bits.h5", "-o", "none.h5", "-q").returncode == 0
    assert not convert("none.h5")[0].any() and convert("bits.h5")[0].any()
    assert voxmend("view", "bits.h5", "-o", "bits.png", "-q", "--size", "40x40").returncode in (0, 6)


def refused(name, data=None):
    """One line, no output, and no crash of the caller; or, if the damage does not matter, a grid."""
    if data is not None:
        with open(os.path.join(FOLDER, name), "wb") as file:
            file.write(data)
    done = voxmend("convert", name, "-o", "out.npy", "-q")
    assert 0 <= done.returncode < 64, (done.returncode, done.stderr)
    assert done.returncode == 0 or len(done.stderr.splitlines()) == 1, done.stderr
    assert (done.returncode == 0) == os.path.exists(os.path.join(FOLDER, "out.npy"))
    if done.returncode == 0:
        os.remove(os.path.join(FOLDER, "out.npy"))
    return done


def damaged():
    chance = random.Random(7)
    whole = content("bits.h5")
    failures = 0
    for number in range(DAMAGED):
        data = bytearray(whole)
        if number % 4 == 0:
            del data[chance.randrange(len(data)):]
        else:
            for _ in range(chance.choice((1, 2, 16))):  # most of what HDF5 follows lies in front
                data[chance.randrange(min(len(data), chance.choice((100, 1000, 4000))))] = chance.choice((0, 1, 0x7f, 0xff, chance.randrange(256)))
        failures += refused("damaged.h5", bytes(data)).returncode != 0
    assert failures > DAMAGED // 3, failures
    print(f"{failures} of {DAMAGED} damaged files refused")


def convert(name):
    done = voxmend("convert", name, "-o", "back.npy")
    assert done.returncode == 0, (name, done.stderr)
    return numpy.load(os.path.join(FOLDER, "back.npy")), done.stderr


def strangers():
    import h5py

    chance = numpy.random.default_rng(3)
    path, shape, count = os.path.join(FOLDER, "other.h5"), (13, 7, 21), 0
    kinds = ("?", "|u1", "|i1", "<u2", ">i2", "<u4", ">i8", ">u8", "<f2", ">f4", "<f8")
    ways = ({}, {"chunks": (5, 7, 4), "compression": "gzip"}, {"chunks": (13, 7, 21), "shuffle": True, "fletcher32": True},
            {"chunks": (1, 2, 21), "compression": "gzip", "maxshape": (None, 7, 21)}, {"userblock": 512})
    for kind, way, order in list(itertools.product(kinds, ways, "CF"))[::3]:
        values = numpy.array(chance.integers(0, 2 if kind == "?" else 90, shape).astype(kind), order=order)
        how = dict(way)
        with h5py.File(path, "w", userblock_size=how.pop("userblock", 0)) as file:
            file.create_group("deep").create_dataset("er", data=values, **how)
            file["table"] = numpy.arange(6)
            file["deep/soft"] = h5py.SoftLink("/deep/er")
            file["deep/away"] = h5py.ExternalLink("a.h5", "/voxels")
        back, said = convert("other.h5")
        assert back.shape == shape and (back == values).all(), (kind, way, order)
        assert back.dtype.kind == values.dtype.kind and "origin" in said, (kind, back.dtype, said)
        count += 1
    # Place, axes and labels, as texts of fixed length and of any; the one called "voxels" of two.
    values = chance.integers(0, 3, shape).astype("u1")
    for texts in (("z,x,y", "labels", ["ä", "b"]), (b"z,x,y", b"labels", numpy.array([b"\xc3\xa4", b"b"]))):
        with h5py.File(path, "w") as file:
            file["another"] = values
            file["voxels"] = values
            file["voxels"].attrs.update({"origin": [1, 2, 3.5], "voxel_size": numpy.float32(0.5) * numpy.ones(3), "axes": texts[0],
                                         "kind": texts[1], "label_names": texts[2], "label_voxels": [4, 5]})
        back, said = convert("other.h5")
        assert (back == values.transpose(1, 2, 0)).all() and "of its 2 datasets" in said, said
        with open(os.path.join(FOLDER, "back.npy.json")) as file:
            told = json.load(file)
        assert told["origin"] == [1, 2, 3.5] and told["voxel_size"] == [0.5] * 3, told
        assert [label["name"] for label in told["labels"]] == ["ä", "b"], told
    # Axes as others write them; what they are not is told. A place in parts.
    for said, order in (("ZYX", (2, 1, 0)), ("z, y, x", (2, 1, 0)), (["z", "x", "y"], (1, 2, 0)), (numpy.array([b"Y", b"X", b"Z"]), (1, 0, 2)),
                        (["z", "y", "x", "c"], (2, 1, 0)),
                        ("depth", None), ("z,y,y", None), ("zyc", None), ("zyxcc", None), ("czyx", None), (7, None), (["x"] * 50, None)):
        with h5py.File(path, "w") as file:
            file["voxels"] = values
            file["voxels"].attrs.update({"axes": said, "origin": [1, 2, 3.5], "voxel_size": 0.5})
        back, said_then = convert("other.h5")
        assert (back == values.transpose(order or (0, 1, 2))).all(), said
        assert ("\"axes\" is not" in said_then) == (order is None) and "no attribute" not in said_then, (said, said_then)
    for attributes, place, lacks in (({"voxel_size": [1, 2, 3]}, [[0, 0, 0], [1, 2, 3]], "\"origin\""),
                                     ({"origin": [1, 2, 3], "voxel_size": [1, 2]}, [[1, 2, 3], [1] * 3], "\"voxel_size\"")):
        with h5py.File(path, "w") as file:
            file["voxels"] = values
            file["voxels"].attrs.update(attributes)
        assert "no attribute " + lacks in convert("other.h5")[1]
        with open(os.path.join(FOLDER, "back.npy.json")) as file:
            told = json.load(file)
        assert [told["origin"], told["voxel_size"]] == place, told
    # Colours without opacity, and values that were never written.
    for channels in (3, 4):
        colors = chance.integers(0, 256, (5, 6, 7, channels)).astype("u1")
        with h5py.File(path, "w") as file:
            file["rgb"] = colors
        back, _ = convert("other.h5")
        assert (back[..., :channels] == colors).all() and (channels == 4 or (back[..., 3] == 255).all())
        for axes in ("zyxc", "Z, Y, X, C", "zyx", ["z", "y", "x", "channel"]):
            with h5py.File(path, "a") as file:
                file["rgb"].attrs["axes"] = axes
            back, said = convert("other.h5")
            assert (back[..., :channels] == colors.transpose(2, 1, 0, 3)).all() and "\"axes\"" not in said, (axes, said)
    with h5py.File(path, "w") as file:
        file.create_dataset("x", (20, 30, 40), "f4", chunks=(5, 5, 5), fillvalue=2.5)
    assert (convert("other.h5")[0] == 2.5).all()
    print(f"{count} arrays of h5py")
    refusals(h5py, path, values)


def refusals(h5py, path, values):
    for what, words in ((lambda f: f.update({"flat": values[0], "text": "hello"}), ("no dataset", "flat (7 x 21 uint8)", "text (texts)")),
                        (lambda f: f.update({"a": values, "b": values}), ("2 datasets", "\"voxels\"", "a (13 x 7 x 21 uint8), b")),
                        (lambda f: f.create_group("empty"), ("no dataset in it",)),
                        (lambda f: f.create_dataset("l", data=values, compression="lzf"), ("filter", "gzip")),
                        (lambda f: f.create_dataset("e", (4, 4, 4), "u1", external=[("a.npy", 0, 64)]), ("other files",)),
                        (lambda f: f.create_dataset("huge", (1 << 20, 1 << 20, 1 << 20), "u1", chunks=(8, 8, 8)), ("huge", "2 GiB")),
                        (lambda f: f.create_dataset("c", (4, 4, 4), "c8"), ("c (4 x 4 x 4 records)",))):
        with h5py.File(path, "w") as file:
            what(file)
        done = refused("other.h5")
        assert done.returncode != 0 and all(word in done.stderr for word in words), (words, done.stderr)
    layout = h5py.VirtualLayout((2, 7, 21), "u1")
    layout[0] = h5py.VirtualSource("a.h5", "voxels", (7, 21))
    with h5py.File(path, "w") as file:
        file.create_virtual_dataset("v", layout)
    done = refused("other.h5")
    assert done.returncode != 0 and "other files" in done.stderr, done.stderr


own()
damaged()
try:
    import h5py  # noqa: F401
except ImportError:
    print("without h5py")
else:
    strangers()
