#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Chen and Tu, Robust Voxelization of Arbitrary Meshes: table 1, figures 4 to 7, and where the method fails."""
import os

from papers import Paper

# Model, V, F, parts, voxels, grouping time and voxelization time in seconds
TABLE_1 = {"Al Capone": (3618, 3440, 21, 108873, 0.15, 14.33), "Teapot": (3644, 6320, 4, 203370, 0.05, 2.51),
           "Dinopet": (8145, 15945, 23, 83769, 0.23, 18.60), "Castle": (6620, 6493, 21, 149012, 0.50, 19.16)}


def table_1(p, size):
    meshes = [("Al Capone", p.mesh("paper/nau-al.obj", "overlapping.off")),
              ("Al Capone", p.mesh("paper/v-hacd-al.obj", "star_prism.off")),
              ("Al Capone", p.mesh("paper/meshviewer-al.obj", "sphere.off")),
              ("Teapot", p.mesh("paper/common3d-teapot.obj", "torus.off"))]
    rows = []
    for name, path in meshes:
        theirs = TABLE_1[name]
        whole = p.least(path, "-r", size, "--no-repair", "--baseline", "fang-chen")
        grouped = p.least(path, "-r", size, "--no-repair", "--baseline", "chen-tu")
        ours = p.least(path, "-r", size)
        info = p.report("info", path)
        figures = grouped["figures"]
        rows.append([name, os.path.basename(path), info["vertices"], info["faces"], "%d / %d" % (theirs[2], figures["parts"]),
                     theirs[3], whole["voxels"], grouped["voxels"], ours["voxels"], 1000 * theirs[4], figures["setup_ms"],
                     1000 * theirs[5], figures["fill_ms"], ours["time_ms"]["repair"] + ours["time_ms"]["voxelize"]])
    p.text("**Table 1**, %d³, files as they are (`voxmend voxelize FILE -r %d --no-repair --baseline chen-tu`, for the whole mesh "
           "`fang-chen`); the last columns are `voxmend voxelize FILE -r %d`, repair and thin parts included:" % (size, size, size))
    p.table(["model", "file", "V", "F", "parts, theirs / ours", "voxels, theirs", "whole mesh", "their method", "voxmend",
             "grouping ms, theirs", "their method here", "voxelization ms, theirs", "their method here", "voxmend"], rows)
    return meshes


def figure_6(p, meshes, size):
    rows = []
    for name, path in meshes[:1] + meshes[3:]:
        p.voxelize(path, "-r", size, "--no-repair", "--baseline", "fang-chen", out="whole.npy")
        p.voxelize(path, "-r", size, "--no-repair", "--baseline", "chen-tu", out="grouped.npy")
        p.voxelize(path, "-r", size, "--thin", "drop", out="ours.npy")
        holes, same = p.compare("grouped.npy", "whole.npy"), p.compare("grouped.npy", "ours.npy")
        rows.append([name, os.path.basename(path), holes["only_a"], holes["only_b"], same["only_a"], same["only_b"], "%.4f" % same["iou"]])
    p.text("**Figure 6**: voxels that the whole mesh loses where parts cut through each other, and their method beside voxmend's "
           "solid by voxel centres (`--thin drop`), %d³:" % size)
    p.table(["model", "file", "in groups alone", "in the whole alone", "their method alone", "voxmend alone", "IoU"], rows)


def failures(p, size):
    cases = [("a hollow sphere: the inner one is a group, and fills the hole", "cavity.off", None),
             ("triangles that share no vertices: each is a group", "soup.off", None),
             ("a face missing, which two of three axes put right", "open_box.off", None),
             ("every face doubled and reversed: two crossings for each", "doubled.off", None),
             ("scan with holes", None, "paper/tinyply-bunny.ply")]
    rows = []
    for what, sample, real in cases:
        path = p.mesh(real, "missing.off") if real else os.path.join(p.given.samples, sample)
        theirs = p.voxelize(path, "-r", size, "--no-repair", "--baseline", "chen-tu", out="theirs.npy")
        ours = p.voxelize(path, "-r", size, "--thin", "drop", out="ours.npy")
        rows.append([what, os.path.basename(path), theirs["voxels"], ours["voxels"],
                     "%.4f" % p.compare("theirs.npy", "ours.npy")["iou"]])
    p.text("**Where the method fails**, %d³, files as they are:" % size)
    p.table(["what", "file", "their method", "voxmend", "IoU"], rows)


def pictures(p, meshes, size):
    """Figures 4 to 7: parts in colours, voxels, and slices of the distances in colour."""
    folder = p.given.pictures or p.folder.name
    if not p.has_pictures():
        return
    for name, path in meshes[:1] + meshes[3:]:
        start = os.path.join(folder, name.lower().replace(" ", "-"))
        p.run("view", path, "-r", size, "--labels", "part", "-o", start + "-parts.png", "-q")
        p.run("remesh", path, "-r", size, "-o", p.place("body.ply"), "--force", "-q")  # without the surfaces within
        p.run("voxelize", p.place("body.ply"), "-r", size, "--distance", "signed", "--band", 0, "-o", p.place("distance.nrrd"), "-q")
        p.run("view", p.place("distance.nrrd"), "--slice", "z=0.5", "-o", start + "-distance.png", "-q")
        for method in "fang-chen", "chen-tu":
            p.run("voxelize", path, "-r", size, "--no-repair", "--baseline", method, "-o", p.place("bits.npy"), "-q")
            p.run("view", p.place("bits.npy"), "-o", "%s-%s.png" % (start, method), "-q", "--up", "y")
            p.run("view", p.place("bits.npy"), "--slice", "z=0.5", "-o", "%s-%s-slice.png" % (start, method), "-q")


def main():
    p = Paper("chen-tu")
    size = 24 if p.quick else 128
    p.bench(os.path.join(p.given.samples, "sphere.off"), "load", [size])  # tells the machine
    meshes = table_1(p, size)
    figure_6(p, meshes, size)
    failures(p, size)
    pictures(p, meshes, size)
    p.finish()


main()
