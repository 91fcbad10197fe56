# SPDX-License-Identifier: BSD-3-Clause
"""combine_values.py VOXMEND FOLDER: 'voxmend combine' of files with values against the rules, voxel by voxel.
EVERY=N tries every N-th kind of values and operation."""
import array
import json
import os
import random
import struct
import subprocess
import sys

voxmend, folder = sys.argv[1:]
os.chdir(folder)
NX, NY, NZ = 37, 21, 34
COUNT = NX * NY * NZ
draw = random.Random(5)


def run(*words, fails=False):
    done = subprocess.run([voxmend, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert (done.returncode != 0) == fails, (words, done.stdout.decode(), done.stderr.decode())
    return done.stderr.decode() if fails else done.stdout.decode()


def boxes(empty, values):
    """Random boxes of single values, and some of different ones, over what is empty."""
    made = [empty] * COUNT
    for _ in range(draw.randrange(1, 9)):
        ends = [sorted(draw.sample(range(n + 1), 2)) for n in (NX, NY, NZ)]
        one, varied = draw.choice(values), draw.random() < 0.3
        for x in range(*ends[0]):
            for y in range(*ends[1]):
                for z in range(*ends[2]):
                    made[(x * NY + y) * NZ + z] = draw.choice(values) if varied else one
    return made


CODES = {"uint8": ("|u1", "B"), "uint16": ("<u2", "H"), "float32": ("<f4", "f"), "float64": ("<f8", "d"), "int32": ("<i4", "i")}


def write(name, kind, scalar, values, names=()):
    code, letter = CODES[scalar]
    shape = (NX, NY, NZ, 4) if kind == "colors" else (NX, NY, NZ)
    head = repr({"descr": code, "fortran_order": False, "shape": shape}).encode()
    head += b" " * (-(len(head) + 11) % 64) + b"\n"
    flat = [c for v in values for c in v] if kind == "colors" else values
    with open(name + ".npy", "wb") as out:
        out.write(b"\x93NUMPY\1\0" + struct.pack("<H", len(head)) + head + array.array(letter, flat).tobytes())
    about = {"format": "voxmend npy", "version": 1, "dims": [NX, NY, NZ], "origin": [0, 0, 0], "voxel_size": [1, 1, 1],
             "order": "z fastest, then y, then x", "values": kind}
    if kind == "colors":
        about["format"] = "voxmend colors"
    if names:
        about["labels"] = [{"label": n + 1, "name": name, "voxels": 0} for n, name in enumerate(names)]
    if kind == "numbers":
        del about["values"]
    json.dump(about, open(name + ".npy.json", "w"))
    run("convert", name + ".npy", "-o", name + ".octree", "-q", "--force")


def read(name, scalar, kind):
    data = open(name, "rb").read()
    start = 10 + struct.unpack("<H", data[8:10])[0]
    assert CODES[scalar][0].encode() in data[:start], data[:start]
    made = array.array(CODES[scalar][1])
    made.frombytes(data[start:])
    if kind == "colors":
        return [tuple(made[i:i + 4]) for i in range(0, len(made), 4)]
    return list(made)


OF_VALUES = {"or": lambda a, b, none: a if a != none else b, "and": lambda a, b, none: a if b != none else none,
             "minus": lambda a, b, none: a if b == none else none,
             "xor": lambda a, b, none: (a if b == none else none) if a != none else b}
OF_DISTANCES = {"or": min, "and": max, "minus": lambda a, b: max(a, -b), "xor": lambda a, b: max(min(a, b), -max(a, b))}


def expected(kind, operation, a, b):
    if kind == "distance":
        return [OF_DISTANCES[operation](p, q) for p, q in zip(a, b)]
    none = (0, 0, 0, 0) if kind == "colors" else 0
    return [OF_VALUES[operation](p, q, none) for p, q in zip(a, b)]


def check(kind, scalar, result, operation, truth, threads, third=None):
    more = (third, "c.%s") if third else ()
    outputs = []
    for source, target in (("npy", "npy"), ("octree", "octree"), ("npy", "octree"), ("octree", "npy")):
        words = [word % source if "%s" in word else word for word in ("a.%s", operation, "b.%s") + more]
        out = "x%d.%s" % (len(outputs), target)
        run("combine", *words, "-o", out, "--force", "-q", "--threads", str(threads), "--report", out + ".report")
        outputs.append(out)
    assert read("x0.npy", result, kind) == truth, (kind, scalar, operation)
    assert open("x0.npy", "rb").read() == open("x3.npy", "rb").read(), (kind, operation)
    run("convert", "x0.npy", "-o", "x4.octree", "-q", "--force")
    for other in ("x1.octree", "x2.octree"):
        assert open(other, "rb").read() == open("x4.octree", "rb").read(), (kind, scalar, operation, other)
    if kind == "labels":
        tables = [json.load(open(name + ".json")).get("labels") if os.path.exists(name + ".json") else None
                  for name in ("x0.npy", "x1.octree", "x2.octree", "x3.npy")]
        assert all(table == tables[0] for table in tables), tables
        for entry in tables[0] or []:
            assert entry["voxels"] == truth.count(entry["label"]), entry
    for name in os.listdir("."):
        if name.startswith("x"):
            os.remove(name)


def make(kind):
    if kind == "labels":
        return boxes(0, range(1, 7))
    if kind == "colors":
        return boxes((0, 0, 0, 0), [tuple(draw.randrange(256) for _ in range(3)) + (255,) for _ in range(9)])
    if kind == "distance":
        return boxes(3.0, [-3.0, -1.5, -0.25, 0.5, 2.0])
    return boxes(0, [5, 2, 3.5, -4] if kind == "floats" else [3, 2, 7, 200])


number = 0
every = int(os.environ.get("EVERY", 1))
for kind, scalar in (("labels", "uint16"), ("labels", "uint8"), ("colors", "uint8"), ("distance", "float32"),
                     ("distance", "float64"), ("numbers", "uint8"), ("numbers", "int32"), ("floats", "float32"), ("coverage", "uint8")):
    for operation in ("or", "and", "minus", "xor"):
        number += 1
        if number % every:
            continue
        a, b, c = make(kind), make(kind), make(kind)
        said = "numbers" if kind == "floats" else kind
        for name, values in (("a", a), ("b", b), ("c", c)):
            write(name, said, scalar, values)
        result = "uint16" if kind == "labels" else scalar
        truth = expected(kind, operation, a, b)
        check(said, scalar, result, operation, truth, 1 + number % 3)
        third = ("or", "and", "minus", "xor")[number // 4 % 4]
        check(said, scalar, result, operation, expected(kind, third, truth, c), 1 + number % 3, third)

# Names: those of both are one label, new ones come behind the first's.
a, b = make("labels"), make("labels")
write("a", "labels", "uint16", a, ["hull", "wheel", "door", "glass", "roof", "lamp"])
write("b", "labels", "uint16", b, ["glass", "seat", "wheel", "seat", "hull", "mirror"])
moved = {0: 0, 1: 4, 2: 7, 3: 2, 4: 7, 5: 1, 6: 8}
for operation in ("or", "xor", "and", "minus"):
    check("labels", "uint16", "uint16", operation, expected("labels", operation, a, [moved[v] for v in b]), 2)
for output in ("y.npy", "y.octree"):
    source = output[2:]
    run("combine", "a." + source, "or", "b." + source, "-o", output, "-q", "--report", "y.report")
    report = json.load(open("y.report"))
    names = ["hull", "wheel", "door", "glass", "roof", "lamp", "seat", "mirror"]
    assert [entry["name"] for entry in report["labels"]] == names, report
    told = {(entry["label"], entry["name"]): entry["becomes"] for entry in report["renumbered"]}
    assert told == {(1, "glass"): 4, (2, "seat"): 7, (3, "wheel"): 2, (4, "seat"): 7, (5, "hull"): 1, (6, "mirror"): 8}, told
    assert [entry["name"] for entry in json.load(open(output + ".json"))["labels"]] == names

# Labels that have no name are their own, each; nothing is told of those that do not come into the result.
write("a", "labels", "uint16", a, ["hull", "", "door", "", "roof", "lamp"])
write("b", "labels", "uint16", b, ["", "hull", "", "seat", "seat", ""])
moved = {0: 0, 1: 7, 2: 1, 3: 8, 4: 9, 5: 9, 6: 10}
for operation in ("or", "xor", "and", "minus"):
    check("labels", "uint16", "uint16", operation, expected("labels", operation, a, [moved[v] for v in b]), 2)
for operation, count in (("or", 3), ("minus", 0)):
    run("combine", "a.npy", operation, "b.npy", "-o", "y.npy", "-q", "--force", "--report", "y.report")
    assert len(json.load(open("y.report"))["renumbered"]) == count, operation

# One label, none, and shares of all or nothing are values as others are, not bits.
for kind, scalar, first, second in (("labels", "uint16", [1], [1, 2]), ("labels", "uint16", [1], [1]), ("labels", "uint8", [0], [1]),
                                    ("coverage", "uint8", [255], [255, 100])):
    for operation in ("or", "minus"):
        a, b = boxes(0, first), boxes(0, second)
        for one, other in ((a, b), (b, a)):
            write("a", kind, scalar, one)
            write("b", kind, scalar, other)
            check(kind, scalar, "uint16" if kind == "labels" else scalar, operation, expected(kind, operation, one, other), 2)

# What does not go together.
write("a", "labels", "uint16", make("labels"))
write("d", "distance", "float32", make("distance"))
write("e", "distance", "float64", make("distance"))
write("n", "labels", "int32", make("labels"))
for source in ("npy", "octree"):
    for one, other, why in (("a", "d", "labels (uint16)"), ("d", "e", "float64"), ("n", "a", "int32"), ("a", "n", "int32")):
        for target in ("npy", "octree"):
            text = run("combine", "%s.%s" % (one, source), "or", "%s.%s" % (other, source), "-o", "z." + target, fails=True)
            assert why in text and text.count("\n") == 1, text
            assert not os.path.exists("z." + target)
