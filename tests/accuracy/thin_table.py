#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What is left of the thin parts of real meshes: the table of doc/accuracy.md.

thin_table.py VOXMEND MESHES [--resolutions 32,64,128] [--markdown FILE]

MESHES is the folder of shared meshes. For the solid by voxel centres (--thin drop), the default and the solid with its
conservative surface (--mode both), and for trimesh's voxelized().fill() where this Python has trimesh and that takes no
more than PEER_SECONDS: the share of the surface farther than 1.5 voxels from the centre of any set voxel, the 26-connected
pieces, and the voxels. The surface is that of the mesh as 'voxmend repair' leaves it, at points at random on its triangles.
Of --markdown FILE the table between the marks is written anew.
"""
import argparse, json, os, re, signal, subprocess, sys, tempfile

import numpy

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "voxel"))
from thin import count_pieces, read_off, sample

MODELS = [
    "modelnet/off2multiview-bed_0001.off",
    "modelnet/off2multiview-bed_0002.off",
    "modelnet/off2multiview-bathtub_0001.off",
    "modelnet/off2multiview-bathtub_0003.off",
    "modelnet/off2mat-bathtub_0004.off",
    "modelnet/off2multiview-airplane_0003.off",
    "modelnet/umvcnn-airplane_0001.off",
    "modelnet/gomesh-chair_0001.off",
    "modelnet/gomesh-chair_0059.off",
    "modelnet/gomesh-toilet_0002.off",
    "modelnet/meshfusion-chair_0890.off",
    "modelnet/meshfusion-chair_0892.off",
    "modelnet/panoview-stool_0002.off",
    "modelnet/manifoldplus-chair.off",
    "modelnet/manifoldplus-bathtub.obj",
    "cad/trimesh-1002_tray_bottom.STL",
    "cad/trimesh-chair_model.obj",
    "cad/numpystl-rear_case.stl",
    "cad/prusa-mk3_bed.stl",
    "cad/cgal-pinion.off",
    "classic/booleans-bunny50k.obj",
]
POINTS = 200000
FAR = 1.5  # voxels
PEER_SECONDS = 5


def share_far(at, grid):
    """Of points, in voxels from the centre of the first one, those farther than FAR from the centre of any set voxel."""
    reach = int(numpy.ceil(FAR))
    padded = numpy.pad(grid, reach + 1)
    cell = numpy.clip(numpy.rint(at).astype(int), -1, numpy.array(grid.shape)) + reach + 1
    near = numpy.zeros(len(at), bool)
    for step in numpy.ndindex(*(2 * reach + 1,) * 3):
        step = numpy.array(step) - reach
        there = cell + step
        close = ((there - (reach + 1) - at) ** 2).sum(1) <= FAR**2
        near |= close & padded[tuple(there.T)]
    return 1 - near.mean()


def fill_by_trimesh(points, triangles, header):
    """trimesh's grid, and a function to places in it; None where this Python has no trimesh, or that gives up."""

    def give_up(*_):
        raise TimeoutError

    signal.signal(signal.SIGALRM, give_up)
    signal.alarm(PEER_SECONDS)
    try:
        import trimesh

        voxels = trimesh.Trimesh(points, triangles).voxelized(header["voxel_size"][0]).fill()
    except (ImportError, ValueError, MemoryError, TimeoutError):
        return None
    finally:
        signal.alarm(0)
    return voxels.matrix, lambda p: trimesh.transform_points(p, numpy.linalg.inv(voxels.transform))


def cell_of(grid, at):
    voxels = f"{grid.sum():,}".replace(",", " ")
    return f"{100 * share_far(at, grid):.2f} %, {count_pieces(grid)}, {voxels}"


def rows_of(program, path, resolutions, random):
    with tempfile.TemporaryDirectory() as folder:
        clean, out = os.path.join(folder, "mesh.off"), os.path.join(folder, "grid.npy")
        run = lambda *arguments: subprocess.run([program, *arguments, "-q"], check=True, stdout=subprocess.DEVNULL)
        run("repair", path, "-o", clean, "--polygons", "split")
        points, triangles, _ = read_off(clean)
        at, _ = sample(points, triangles, POINTS, random)
        for resolution in resolutions:
            cells = []
            for options in (["--thin", "drop"], [], ["--mode", "both"]):
                run("voxelize", path, "-o", out, "--force", "-r", resolution, *options)
                with open(out + ".json") as file:
                    header = json.load(file)
                place = (at - header["origin"]) / header["voxel_size"] - 0.5
                cells.append(cell_of(numpy.load(out).astype(bool), place))
            peer = fill_by_trimesh(points, triangles, header)
            cells.append(cell_of(peer[0], peer[1](at)) if peer else "–")
            name = re.sub(r"^\w+-|\.\w+$", "", os.path.basename(path))
            yield f"| {name} | {resolution} | " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("meshes")
    parser.add_argument("--resolutions", default="32,64,128")
    parser.add_argument("--markdown")
    given = parser.parse_args()
    lines = ["| model | voxels | `--thin drop` | default | `--mode both` | trimesh, filled |", "|---|---|---|---|---|---|"]
    print("\n".join(lines))
    random = numpy.random.default_rng(1)
    for model in MODELS:
        path = os.path.join(given.meshes, model)
        for row in rows_of(given.program, path, given.resolutions.split(","), random) if os.path.exists(path) else ():
            print(row, flush=True)
            lines.append(row)
    if given.markdown:
        with open(given.markdown) as file:
            text = file.read()
        begin, end = "<!-- thin parts: begin -->\n", "<!-- thin parts: end -->"
        text = text[: text.index(begin) + len(begin)] + "\n" + "\n".join(lines) + "\n\n" + text[text.index(end) :]
        with open(given.markdown, "w") as file:
            file.write(text)


main()
