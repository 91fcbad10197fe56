# SPDX-License-Identifier: BSD-3-Clause
"""octree_nodes.py VOXMEND FOLDER: .octree files of values are the bytes of those that 'convert' makes of .npy files, and the
reports say the same. Samples, and random bodies and sheets that overlap, each a group of its own. EVERY=N tries every N-th of
the random ones."""
import json
import os
import random
import subprocess
import sys

voxmend, folder = sys.argv[1:]
os.chdir(folder)


def run(*words):
    done = subprocess.run([voxmend, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert done.returncode == 0, (words, done.stdout.decode())


def box(low, high):
    """Eight corners and twelve triangles, wound outward."""
    corners = [[(low, high)[n >> a & 1][a] for a in range(3)] for n in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def random_mesh(path, seed):
    draw = random.Random(seed)
    lines, count = [], 0
    for group in range(draw.randrange(1, 9)):
        size = draw.choice([0.02, 0.5, 1.2, 1.2])
        low = [draw.uniform(-1, 1 - size) for _ in range(3)]
        corners, faces = box(low, [x + draw.uniform(size / 3, size) for x in low])
        patches = draw.random() < 0.3
        corners = [[x + draw.uniform(-0.1, 0.1) * size for x in c] for c in corners]
        if draw.random() < 0.3:
            faces = faces[:draw.randrange(1, len(faces))]
        lines += ["g group%d" % draw.randrange(5), "usemtl m%d" % draw.randrange(3)]
        lines += ["v %r %r %r" % tuple(c) for c in corners]
        for face in faces:
            if patches:
                lines.append("usemtl m%d" % draw.randrange(3))
            lines.append("f %d %d %d" % tuple(count + 1 + c for c in face))
        count += len(corners)
    open(path, "w").write("\n".join(lines) + "\n")


def told(path):
    report = json.load(open(path))
    kept = {key: report.get(key) for key in ("labels", "distance", "color", "voxels", "hash", "parts", "votes")}
    if kept["distance"] is None:  # of these thin parts are told of in more grids
        kept["warnings"] = report["warnings"]
    return kept


def check(mesh, *options):
    run("voxelize", mesh, *options, "-o", "dense.npy", "-q", "--report", "dense.json")
    run("convert", "dense.npy", "-o", "dense.octree", "-q")
    run("voxelize", mesh, *options, "-o", "nodes.octree", "-q", "--report", "nodes.json", "--sparse")
    words = (mesh,) + options
    assert open("nodes.octree", "rb").read() == open("dense.octree", "rb").read(), words
    assert told("dense.json") == told("nodes.json"), (words, told("dense.json"), told("nodes.json"))
    for name in os.listdir("."):
        if name.startswith(("dense.", "nodes.")):
            os.remove(name)


VALUES = [["--labels", "part"], ["--labels", "group"], ["--labels", "material", "--mode", "both"], ["--color", "position"],
          ["--color", "part"], ["--color", "noise", "--mode", "surface"], ["--distance", "signed"],
          ["--distance", "unsigned", "--band", "1.5"], ["--distance", "signed", "--band", "8"]]
GRIDS = [["-r", "50"], ["-r", "17x40x65", "--fit", "tight"], ["-r", "63", "--pad", "20"],
         ["-r", "70x30x20", "--bounds", "-0.4,-0.3,-0.5,0.6,0.3,0.2"]]
MESHES = sorted(name for name in os.listdir("in") if name.endswith((".off", ".obj", ".ply", ".stl")))
for number, mesh in enumerate(MESHES):
    check("in/" + mesh, *VALUES[number % len(VALUES)], *GRIDS[number // 2 % 3])
# All of the grid within the body, so that the first voxel is far inside: it is the background.
check("in/cube.off", "-r", "40", "--bounds", "-0.1,-0.1,-0.1,0.1,0.1,0.1", "--distance", "signed")
check("in/cube.off", "-r", "40", "--bounds", "-0.1,-0.1,-0.1,0.1,0.1,0.1", "--labels", "part")
run("voxelize", "in/torus.off", "-o", "volume.nrrd", "-r", "12", "--pad", "2", "--distance", "signed", "-q")
check("in/torus.off", "-r", "40", "--color", "volume.nrrd")
# A cube whose nodes are all full, and of which one side has another material: full nodes have two labels.
corners, faces = box((0, 0, 0), (1, 1, 1))
with open("sides.obj", "w") as out:
    out.write("".join("v %r %r %r\n" % tuple(c) for c in corners))
    out.write("".join("usemtl m%d\nf %d %d %d\n" % (n >= 10, *(c + 1 for c in f)) for n, f in enumerate(faces)))
check("sides.obj", "-r", "48", "--fit", "tight", "--labels", "material")
corners, faces = box((0, 0, 0), (1, 0.7, 0.4))
with open("colored.ply", "w") as out:
    out.write("ply\nformat ascii 1.0\nelement vertex 8\n")
    out.write("".join("property %s\n" % p for p in ("float x", "float y", "float z", "uchar red", "uchar green", "uchar blue")))
    out.write("element face 12\nproperty list uchar int vertex_indices\nend_header\n")
    out.write("".join("%r %r %r %d %d %d\n" % (*c, 255 * (n & 1), 30 * n, 255 * (n >> 2)) for n, c in enumerate(corners)))
    out.write("".join("3 %d %d %d\n" % f for f in faces))
for options in (["-r", "40"], ["-r", "61x20x33", "--fit", "tight", "--mode", "surface", "--threads", "2"], ["-r", "30", "--color-average"]):
    check("colored.ply", "--color", "mesh", *options)
rules = [[], ["--method", "x"], ["--vote", "majority"], ["--parts", "whole"], ["--thin", "26"], ["--method", "winding"]]
for seed in range(0, 60, int(os.environ.get("EVERY", 1))):
    random_mesh("random.obj", seed)
    values = VALUES[seed % len(VALUES)]
    rule = [] if "surface" in values or "unsigned" in values else rules[seed // 3 % len(rules)]
    check("random.obj", *values, *GRIDS[seed % len(GRIDS)], *rule, "--no-repair", "--threads", str(1 + seed % 3))
