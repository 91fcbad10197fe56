#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What holds the thin parts of real meshes together, against the solid alone and the surface.

thin.py VOXMEND MESHES RESOLUTION...

S is the solid (--thin drop), C every voxel that a face meets (--mode surface), K the default. For each mesh and resolution:
 - S lies in K, and K in S and C together;
 - wherever a point of the surface lies, one of the eight voxels whose centres are about it is in K;
 - no break: the voxels about a part, faces that share vertices, belong to one 26-connected piece of K. So K has no more pieces
   than the mesh has parts. S and C together may have fewer still, as they bridge gaps of up to two voxels between parts, which K,
   adding nothing to what is thick, must leave;
 - no two voxels outside of K that share a face have one of some triangles between their centres.
"""
import json, os, subprocess, sys, tempfile

import numpy

MESHES = [
    "modelnet/euclid-chair.off",
    "modelnet/gomesh-chair_0059.off",
    "modelnet/gomesh-toilet_0002.off",
    "modelnet/manifoldplus-chair.off",
    "modelnet/off2mat-bathtub_0001.off",
    "modelnet/meshfusion-chair_0892.off",
    "modelnet/off2multiview-airplane_0003.off",
    "modelnet/panoview-bed_0001.off",
    "modelnet/panoview-stool_0002.off",
    "classic/cgal-diplodocus.off",
    "classic/common3d-cow.obj",
    "classic/gel-octopus.obj",
    "classic/objloader-f-16.obj",
]
POINTS = 100000
TRIANGLES = 300


def read_off(path):
    """Vertices, triangles, and a corner of each face with each other one of it."""
    with open(path) as file:
        lines = [line for line in file if line.strip() and not line.startswith("#")]
    vertices, faces = (int(number) for number in lines[1].split()[:2])
    points = numpy.array([line.split()[:3] for line in lines[2 : 2 + vertices]], "f8")
    triangles, pairs = [], []
    for line in lines[2 + vertices : 2 + vertices + faces]:
        count, *corners = (int(number) for number in line.split())
        corners = corners[:count]
        pairs += [(corners[0], other) for other in corners[1:]]
        if count == 3:
            triangles.append(corners)
    return points, numpy.array(triangles, "i8").reshape(-1, 3), numpy.array(pairs, "i8").reshape(-1, 2)


def count_parts(count, pairs):
    """How many sets of `count` things there are if those of a pair belong together: each thing points to one that is not
    greater, roots to themselves."""
    root = numpy.arange(count)
    while len(pairs):
        ends = root[pairs]
        pairs = pairs[ends[:, 0] != ends[:, 1]]
        ends = numpy.sort(root[pairs], axis=1)
        numpy.minimum.at(root, ends[:, 1], ends[:, 0])
        while (root[root] != root).any():
            root = root[root]
    return root


def number_pieces(grid):
    """For each set voxel, in their order, the number of its 26-connected piece."""
    padded = numpy.pad(grid, 1)
    number = numpy.full(padded.shape, -1)
    number[padded] = numpy.arange(grid.sum())
    pairs = []
    for step in numpy.ndindex(3, 3, 3):
        x, y, z = (s - 1 for s in step)
        if (x, y, z) > (0, 0, 0):
            other = numpy.roll(number, (-x, -y, -z), (0, 1, 2))
            both = (number >= 0) & (other >= 0)
            pairs.append(numpy.stack([number[both], other[both]], 1))
    return count_parts(int(grid.sum()), numpy.concatenate(pairs))


def count_pieces(grid):
    return len(numpy.unique(number_pieces(grid)))


def count_cut(numbers, parts):
    """How many parts have more than one number among those of their points."""
    pairs = numpy.unique(numpy.stack([parts, numbers], 1), axis=0)
    return int((numpy.unique(pairs[:, 0], return_counts=True)[1] > 1).sum())


def sample(points, triangles, count, random):
    """Points at random on triangles, and the triangles."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1)
    t = random.choice(len(triangles), count, p=area / area.sum())
    u = random.random((count, 2))
    u = numpy.where((u.sum(1) > 1)[:, None], 1 - u, u)
    return a[t] + u[:, :1] * (b - a)[t] + u[:, 1:] * (c - a)[t], t


def leaks(corners, padded, axis):
    """Whether a triangle crosses a link along an axis between two voxels that are not set. Corners are in voxels from the centre
    of the first one of the padded grid; what is within 1/1000 of a centre is left to the lattice."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    low = numpy.ceil(corners.min(0)).astype(int)
    high = numpy.floor(corners.max(0)).astype(int)
    b, c = corners[1] - corners[0], corners[2] - corners[0]
    area = b[u] * c[v] - b[v] * c[u]
    if abs(area) < 1e-6:
        return False
    at = numpy.stack(numpy.meshgrid(numpy.arange(low[u], high[u] + 1), numpy.arange(low[v], high[v] + 1)), -1).reshape(-1, 2)
    away = at - corners[0][[u, v]]
    p = (away[:, 0] * c[v] - away[:, 1] * c[u]) / area
    q = (b[u] * away[:, 1] - b[v] * away[:, 0]) / area
    depth = corners[0][axis] + p * b[axis] + q * c[axis]
    sure = (numpy.minimum(numpy.minimum(p, q), 1 - p - q) > 1e-3) & (numpy.abs(depth - numpy.rint(depth)) > 1e-3)
    cell = numpy.empty((sure.sum(), 3), int)
    cell[:, [u, v]] = at[sure]
    cell[:, axis] = numpy.floor(depth[sure])
    lower = padded[tuple(cell.T)]
    cell[:, axis] += 1
    return (~lower & ~padded[tuple(cell.T)]).any()


def main():
    program, meshes, *resolutions = sys.argv[1:]
    random = numpy.random.default_rng(1)
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        clean, out = os.path.join(folder, "mesh.off"), os.path.join(folder, "grid.npy")

        def run(*arguments):
            subprocess.run([program, *arguments, "-q", "--threads", "2"], check=True, stdout=subprocess.DEVNULL)

        def voxels(resolution, *options):
            run("voxelize", clean, "-o", out, "-r", resolution, *options)
            return numpy.load(out).astype(bool)

        for mesh in MESHES:
            if os.path.exists(clean):
                os.remove(clean)
            run("repair", os.path.join(meshes, mesh), "-o", clean)
            points, triangles, pairs = read_off(clean)
            used = numpy.unique(pairs)
            part_of = count_parts(len(points), pairs)
            parts = len(numpy.unique(part_of[used]))
            for resolution in resolutions:
                solid = voxels(resolution, "--thin", "drop")
                surface = voxels(resolution, "--mode", "surface")
                kept = voxels(resolution)
                with open(out + ".json") as file:
                    header = json.load(file)
                both = solid | surface
                place = lambda p: (p - header["origin"]) / header["voxel_size"] - 0.5
                at, of = sample(points, triangles, POINTS, random)
                at = place(at)
                sure = (numpy.abs(at - numpy.rint(at)) > 1e-3).all(1)  # where snapping to the lattice does not matter
                cell = numpy.floor(at[sure]).astype(int) + 1
                padded = numpy.pad(kept, 1)
                number = numpy.full(padded.shape, -1)
                number[padded] = number_pieces(kept)
                piece = numpy.full(len(cell), -1)  # of any voxel about a point: they all touch each other
                for corner in numpy.ndindex(2, 2, 2):
                    piece = numpy.maximum(piece, number[tuple((cell + corner).T)])
                held = piece >= 0
                cut = count_cut(piece[held], part_of[triangles[of[sure], 0]][held])
                some = random.choice(len(triangles), min(TRIANGLES, len(triangles)), replace=False)
                leak = any(leaks(place(points[triangles[t]]) + 1, padded, axis) for t in some for axis in range(3))
                pieces = [count_pieces(solid), len(numpy.unique(number[padded])), count_pieces(both)]
                wrong = [
                    name
                    for name, bad in (
                        ("voxels of the solid are lost", (solid & ~kept).any()),
                        ("voxels lie off the surface", (kept & ~both).any()),
                        ("surface is lost", not held.all()),
                        ("parts are cut", cut > 0 or pieces[1] > parts),
                        ("a face is crossed", leak),
                    )
                    if bad
                ]
                failures += bool(wrong)
                print(
                    f"{mesh} {resolution}: {solid.sum()} voxels, {kept.sum()} with thin parts, {both.sum()} with all of the",
                    f"surface; {pieces[0]}, {pieces[1]} and {pieces[2]} pieces of {parts} parts;",
                    f"{len(held) - held.sum()} of {len(held)} points lost",
                    *(f"FAILED: {name}" for name in wrong),
                )
    return failures > 0


if __name__ == "__main__":
    sys.exit(main())
