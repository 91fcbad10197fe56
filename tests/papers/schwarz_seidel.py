#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Schwarz and Seidel, Fast Parallel Surface and Solid Voxelization on GPUs: tables 1 to 3."""
import os

from papers import Paper, ms, show

# Grid -> ms: Zhang, simple, specialized, sorted; thousands of voxels; 1D/2D/3D; then the 6-separating surface
TABLE_1 = {
    "Stanford bunny": {128: ((10.39, 1.62, 1.65, 2.94), 54, "10/49/41", (1.60, 1.50, 2.37), 33),
                       256: ((10.24, 3.99, 2.51, 4.19), 222, "0/20/79", (3.38, 1.98, 3.16), 133),
                       512: ((14.80, 11.97, 5.96, 8.40), 900, "0/9/91", (12.40, 4.59, 6.26), 535),
                       1024: ((72.64, 60.96, 20.69, 26.75), 3627, "0/3/97", (58.08, 17.09, 18.42), 2147)},
    "Stanford dragon": {128: ((116.27, 12.67, 11.72, 16.99), 39, "89/10/1", (12.54, 8.91, 13.51), 25),
                        256: ((142.88, 9.14, 8.26, 16.84), 162, "64/28/8", (9.09, 6.60, 12.84), 98),
                        512: ((194.15, 10.93, 10.69, 20.67), 660, "24/39/36", (10.99, 8.15, 15.55), 387),
                        1024: ((331.81, 24.17, 23.00, 32.18), 2664, "8/24/68", (23.74, 16.24, 23.45), 1539)},
}
# Grid -> ms: Eisemann and Decoret, triangle-parallel; tiles: total, pairs, sort, tiles; thousands of pairs, triangles a tile
TABLE_2 = {
    "Stanford bunny": {128: (0.52, 0.48, 1.53, 0.38, 0.32, 0.48, 42, 64.2), 256: (0.58, 1.48, 2.02, 0.39, 0.44, 0.80, 81, 32.2),
                       512: (1.43, 9.27, 4.72, 0.49, 0.78, 2.88, 145, 14.6), 1024: (8.75, 74.86, 18.24, 0.76, 1.39, 14.08, 301, 7.6)},
    "Stanford dragon": {128: (2.69, 1.45, 2.51, 1.09, 0.32, 0.47, 40, 81.8), 256: (2.73, 2.03, 4.72, 1.21, 0.64, 1.11, 156, 84.7),
                        512: (3.16, 7.57, 7.19, 1.41, 1.96, 2.91, 476, 67.3), 1024: (13.56, 51.95, 16.41, 1.79, 3.54, 8.76, 944, 34.0)},
}
# Grid -> total; active, construct, voxelize, propagate, coverage ms; MB
TABLE_3 = {
    "Stanford bunny": {512: (4.87, 1.49, 1.01, 1.47, 0.44, 0.12, 3.2), 1024: (9.15, 1.92, 1.74, 3.43, 1.36, 0.37, 13.2),
                       2048: (25.17, 3.60, 3.99, 10.65, 5.12, 1.37, 53.7), 4096: (93.27, 12.74, 12.36, 42.61, 19.71, 5.36, 216)},
    "Stanford dragon": {512: (14.50, 8.07, 0.97, 4.45, 0.32, 0.10, 2.3), 1024: (23.59, 10.63, 1.52, 9.59, 0.92, 0.28, 9.7),
                        2048: (37.71, 9.02, 3.37, 20.57, 3.28, 1.02, 39.6), 4096: (100.32, 17.79, 9.43, 55.36, 13.16, 3.98, 159)},
}


def models(p):
    """Closed: the dragon of the collection is one of 100 000 triangles."""
    return {"Stanford bunny": p.closed(p.mesh("paper/tinyply-bunny.ply", "missing.off")),
            "Stanford dragon": p.mesh("paper/karimvoxelizer-dragon.obj", "sphere.off")}


def beside(theirs, ours):
    """"theirs / ours"."""
    return "%s / %s" % (show(theirs), show(ours))


def surfaces(p, grids, kind, at):
    thin = "thin_" if kind == "thin" else ""
    names = ["baseline_%s%s" % (thin, n) for n in ("simple", "specialized", "sorted")]
    rows = []
    for name, path in models(p).items():
        found = p.bench(path, ",".join(names + ["baseline_zhang", "surface_" + kind]), grids, time=0)
        for grid in grids:
            paper = TABLE_1[name].get(grid, ((None,) * 4, None, "–", (None,) * 3, None))
            ours = found[("surface_" + kind, "cpu", grid)]
            cells = [found[(n, "cpu", grid)] for n in names]
            zhang = found[("baseline_zhang", "cpu", grid)]
            for cell in cells:
                p.expect(cell["voxels"] == ours["voxels"], "%s has voxmend's surface" % cell["phase"])
            boxes = [cells[0]["figures"]["boxes_%dd" % d] for d in (1, 2, 3)]
            shares = "/".join("%.0f" % (100 * b / sum(boxes)) for b in boxes)
            theirs = paper[at]
            row = [name, "%d³" % grid]
            if kind == "conservative":
                row += [beside(theirs[0], ms(zhang)), "%+.2g %%" % (100 * (zhang["voxels"] / ours["voxels"] - 1)), "%s / %s" % (paper[2], shares)]
                theirs = theirs[1:]
            row += [beside(t, ms(c)) for t, c in zip(theirs, cells)]
            rows.append(row + [beside(paper[at + 1], ours["voxels"] // 1000), ms(ours)])
    heads = ["model", "grid"] + (["Zhang et al.", "Zhang's voxels beyond", "1D/2D/3D %"] if kind == "conservative" else [])
    p.text("**Table 1, %s surface**, theirs (GeForce GTX 285) / here (one thread of a CPU), ms and thousands of voxels; the last column is "
           "voxmend's own, one thread. `voxmend bench FILE --threads 1 -r %s --phases %s`:" %
           ("conservative" if kind == "conservative" else "6-separating", ",".join(map(str, grids)), ",".join(names)))
    p.table(heads + ["simple", "specialized", "sorted", "thousands of voxels", "voxmend"], rows)


def table_2(p, grids):
    rows = []
    opencl = p.has_opencl()
    for name, path in models(p).items():
        found = p.bench(path, "solid_x,baseline_eisemann", grids, threads=2, engine="cpu,opencl/triangles,opencl/tiles" if opencl else None,
                        time=0)
        for grid in grids:
            t = TABLE_2[name].get(grid, (None,) * 8)
            cpu, one = found[("solid_x", "cpu", grid)], found[("baseline_eisemann", "cpu", grid)]
            p.expect(one["voxels"] == cpu["voxels"], "the column's XOR is voxmend's solid")
            row = [name, "%d³" % grid, beside(t[0], ms(one))]
            if opencl:
                tiles = found[("solid_x", "opencl/tiles", grid)]
                f = tiles["figures"]
                row += [beside(t[1], ms(found[("solid_x", "opencl/triangles", grid)])), beside(t[2], ms(tiles))]
                row += [beside(t[i], f[k]) for i, k in ((3, "pairs_ms"), (4, "sort_ms"), (5, "tiles_ms"))]
                row += [beside(t[6], f["pairs"] // 1000)]
            rows.append(row + [ms(cpu)])
    p.text("**Table 2**, solids, theirs / here, ms. Eisemann and Décoret's single pass by the CPU; triangles and tiles by OpenCL, "
           "with the stages of one run in which the device is waited for after each; the last column is voxmend's own on two "
           "threads. `voxmend bench FILE --threads 2 -r %s --engine cpu,opencl/triangles,opencl/tiles --phases solid_x,baseline_eisemann`. "
           "Tiles here have 64 columns, theirs 16, hence fewer pairs:" % ",".join(map(str, grids)))
    p.table(["model", "grid", "Eisemann"] + (["triangles", "tiles", "pairs ms", "sort ms", "tiles ms", "thousands of pairs"] if opencl else []) +
            ["voxmend"], rows)


def table_3(p, grids):
    opencl = p.has_opencl()
    rows = []
    for name, path in models(p).items():
        found = p.bench(path, "octree_centres", grids, threads=2, engine="cpu,opencl" if opencl else None, time=0)
        for grid in grids:
            t = TABLE_3[name].get(grid, (None,) * 7)
            cpu = found[("octree_centres", "cpu", grid)]
            row = [name, "%d³" % grid]
            if opencl:
                other = found[("octree_centres", "opencl", grid)]
                f = other["figures"]
                row += [beside(t[0], ms(other))] + [beside(t[i], f[k]) for i, k in ((1, "active_ms"), (2, "construct_ms"), (3, "voxelize_ms"),
                                                                                    (4, "propagate_ms"))] + [f["prune_ms"]]
                p.expect(other["voxels"] == cpu["voxels"], "OpenCL's octree has the CPU's voxels")
            rows.append(row + [beside(t[6], cpu["bytes"] / 1e6), ms(cpu)])
    p.text("**Table 3**, octrees, theirs / here (OpenCL), ms and MB; the last column is voxmend's own by the CPU, two threads. "
           "`voxmend bench FILE --threads 2 -r %s --engine cpu,opencl --phases octree_centres`. Octrees here keep no pointers between "
           "neighbours, and nodes of 16³ voxels with bricks of a bit for each, hence their size:" % ",".join(map(str, grids)))
    p.table(["model", "grid"] + (["total", "active nodes", "construct", "voxelize", "propagate", "leave out, read back"] if opencl else []) +
            ["MB", "voxmend"], rows)


def main():
    p = Paper("schwarz-seidel")
    surfaces(p, [16, 32] if p.quick else [128, 256, 512, 1024], "conservative", 0)
    surfaces(p, [16, 32] if p.quick else [128, 256, 512, 1024], "thin", 3)
    table_2(p, [16, 32] if p.quick else [128, 256, 512, 1024])
    table_3(p, [32] if p.quick else [512, 1024, 2048, 4096])
    p.finish()


main()
