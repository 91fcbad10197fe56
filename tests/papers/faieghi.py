#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Faieghi et al., Fast and cross-vendor OpenCL-based implementation for voxelization of triangular mesh models: tables 1 to 4
and figure 7."""
import os

from papers import Paper, ms

# Voxel size in mm -> tests by approach 1 (voxels) and 2 (facets)
TABLE_1 = {3: (1767431, 93), 2: (4615507, 224), 1: (44406021, 1107), 0.5: (368832950, 5874)}
# Model: its longest side in mm, the longest side of its file; then by voxel size the grid, ms of a GeForce 970 GTX, of the
# i7 6700K by OpenCL (table 4), and of one thread
TABLE_3 = {
    "Utah Teapot": (63.5, {0.5: ((127, 79, 59), 2.12, 3.82, 21), 0.25: ((253, 158, 118), 13.57, 20.84, 108),
                           0.1: ((632, 394, 295), 166.52, 244.84, 1081)}),
    "Stanford Bunny": (15.6, {0.5: ((32, 31, 25), 0.05, 0.66, 13), 0.25: ((63, 62, 49), 0.08, 1.24, 18),
                              0.1: ((156, 154, 121), 0.32, 5.39, 65)}),
    "Stanford Dragon": (56.4, {0.5: ((113, 51, 80), 0.31, 2.12, 85), 0.25: ((226, 101, 160), 1.09, 6.8, 159),
                               0.1: ((564, 253, 398), 10.17, 48.64, 757)}),
}


def models(p):
    return {"Utah Teapot": p.mesh("paper/common3d-teapot.obj", "rocket.off"),
            "Stanford Bunny": p.mesh("paper/tinyply-bunny.ply", "missing.off"),
            "Stanford Dragon": p.mesh("paper/karimvoxelizer-dragon.obj", "sphere.off")}


def scale(p, name, path):
    """Model units of a millimetre of theirs."""
    low_high = p.report("info", path)["bounds"]
    return max(high - low for low, high in zip(low_high[:3], low_high[3:])) / TABLE_3[name][0]


def published(p, path, size, baseline="faieghi"):
    return p.voxelize(path, "--voxel-size", size, "--engine", "opencl", "--baseline", baseline)


def table_1(p):
    path, rows = models(p)["Stanford Bunny"], []
    unit = scale(p, "Stanford Bunny", path)
    for size, theirs in TABLE_1.items():
        facets = published(p, path, size * unit)
        voxels = None
        if not p.quick and size >= 1:  # half a millimetre takes over a minute
            voxels = published(p, path, size * unit, "faieghi-voxels")
            p.expect(voxels["hash"] == facets["hash"], "both approaches set the same voxels")
        tests = voxels and voxels["figures"]["tests"]
        rows.append([float(size), ", ".join(map(str, facets["grid"]["dims"])), theirs[0], tests, theirs[1], facets["figures"]["tests"],
                     facets["voxels"], voxels and voxels["figures"]["kernel_ms"], facets["figures"]["kernel_ms"]])
    p.text("**Table 1**, tests of a facet against a voxel (`voxmend voxelize FILE --engine opencl --baseline faieghi --voxel-size S -o "
           "GRID`, and `faieghi-voxels`):")
    p.table(["voxel mm", "grid here", "by voxels, theirs", "by voxels here", "by facets, theirs", "by facets here", "voxels set",
             "by voxels ms", "by facets ms"], rows)


def table_2(p):
    rows = [[e["renderer"], e["kind"], e["compute_units"], e["work_group"], e["local_bytes"] >> 10, e["clock_mhz"],
             "%.1f" % (e["global_bytes"] / 2**30), "%.1f" % (e["cache_bytes"] / 2**20)]
            for e in p.report("engines")["engines"] if e["name"].startswith("opencl") and e["available"]]
    p.text("**Table 2** of this machine (`voxmend engines`; their third column has KB in its head, its numbers are work-items):")
    p.table(["device", "kind", "compute units", "largest group", "local KiB", "MHz", "memory GiB", "cache MiB"], rows)


def tables_3_and_4(p):
    rows = []
    for name, path in models(p).items():
        unit = scale(p, name, path)
        for size, theirs in TABLE_3[name][1].items():
            if p.quick and size < 0.5:
                continue
            step = size * unit
            runs = [published(p, path, step) for _ in range(1 if p.quick else 3)]
            made = min(runs, key=lambda r: r["figures"]["kernel_ms"])
            alone = p.least(path, "--voxel-size", step, "--fit", "tight", "--baseline", "simple", "--threads", 1, runs=3)
            ours = p.least(path, "--voxel-size", step, "--fit", "tight", "--mode", "surface", runs=3)
            rows.append([name, size, ", ".join(map(str, theirs[0])), ", ".join(map(str, made["grid"]["dims"])), theirs[1], theirs[2],
                         made["figures"]["kernel_ms"], float(theirs[3]), alone["figures"]["fill_ms"], ours["time_ms"]["voxelize"],
                         made["voxels"]])
    p.text("**Tables 3 and 4**, kernel times in ms of a GeForce 970 GTX and of an i7 6700K (8 threads) by their program, and of their "
           "single thread; here the same program by OpenCL, by facets, a single thread by `--baseline simple`, and voxmend's conservative "
           "surface (one cold run of the command, all threads). The teapot lies with another axis up; how many facets their models have is in a picture that the "
           "scan has lost; reamer and scapula were not published:")
    p.table(["model", "voxel mm", "their grid", "grid here", "GPU, theirs", "CPU, theirs", "OpenCL here", "one thread, theirs",
             "one thread here", "voxmend", "voxels set"], rows)


def figure_7(p, grids):
    found = p.bench(models(p)["Stanford Bunny"], "published_facets,transfer_read,transfer_map", grids, threads=2, engine="opencl", time=0)
    rows = [["%d³" % g] + [ms(found[(n, "opencl", g)]) for n in ("published_facets", "transfer_read", "transfer_map")] +
            [found[("transfer_read", "opencl", g)]["bytes"] >> 10] for g in grids]
    p.text("**Figure 7**, a byte for each voxel to the host by reading and by mapping, ms (`voxmend bench FILE --engine opencl --phases "
           "published_facets,transfer`). Mapping wins here too, as device and host share their memory:")
    p.table(["grid", "kernel and mapping", "read", "map", "KiB"], rows)


def main():
    p = Paper("faieghi")
    if not p.has_opencl():
        p.text("No OpenCL device in this build or on this machine: all tables are left out.")
        p.finish()
        return
    p.bench(models(p)["Stanford Bunny"], "load", [8])  # tells the machine
    table_1(p)
    table_2(p)
    tables_3_and_4(p)
    figure_7(p, [16] if p.quick else [64, 128, 256, 512])
    p.finish()


main()
