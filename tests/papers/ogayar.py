#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Ogayar et al., GPU-Based Framework for Training 3D Convolutional Neural Networks with Voxelized Polygonal Models: the
alternatives of section III-B, tables 2 and 3, figures 2 and 7 to 9."""
import os

from papers import Paper, ms, show

VARIANTS = 5000  # of each model
MODELS = 9843  # of table 3
RATES = {64: (2.9, 21, 43), 256: (2.5, 15, 36)}  # variants a second, by the totals of table 2


def alternatives(p, grids):
    """Section III-B2 and III-B3: what they tried and rejected."""
    rows = []
    names = ("baseline_tetra_anew", "baseline_tetra_full", "baseline_tetra_layers", "solid_centres")
    for path in (p.mesh("classic/common3d-cheburashka.obj", "torus.off"), p.mesh("classic/cgal-armadillo.off", "sphere.off")):
        found = p.bench(path, ",".join(names), grids, time=0)
        for grid in grids:
            cells = [found[(name, "cpu", grid)] for name in names]
            for cell in cells:
                p.expect(cell["voxels"] == cells[3]["voxels"], "%s is voxmend's solid" % cell["phase"])
            rows.append([os.path.basename(path), p.triangles, "%d³" % grid] + [ms(c) for c in cells[:3]] +
                        [cells[2]["figures"]["bytes"] >> 10, ms(cells[3])])
    p.text("**Sections III-B2 and III-B3**, the alternatives that they tried and rejected, as scan-lines on one thread, ms (`--phases "
           "baseline_tetra`). As published, each slice makes the tetrahedra of all triangles anew; made once and kept (their "
           "alternatives a to c) that was 15 to 20 % slower on their GPU; each tetrahedron once into all its layers (their option a of "
           "textures) noticeably slower. On a CPU it is the other way round: making them anew costs most, and a single pass, which looks at "
           "no tetrahedron in a slice that it does not meet, as much as keeping them or less:")
    p.table(["model", "triangles", "grid", "as published", "made once", "single pass", "KiB kept", "voxmend, solid"], rows)


def table_2(p, grids):
    path = p.mesh("classic/common3d-cheburashka.obj", "torus.off")
    found = p.bench(path, None, grids, threads=2, time=0, options=["--augment"])
    rows = []
    for grid in grids:
        cells = [found.get(("augment_" + kind, "cpu", grid)) for kind in ("standard", "batch", "direct")]
        rows.append(["%d³" % grid] + [ms(c, "median_ms") for c in cells] +
                    ["%s / %s" % (theirs, show(c["per_second"])) for theirs, c in zip(RATES.get(grid, "–––"), cells)])
    p.text("**Table 2**, the three ways to feed a network: a process for each variant that reads and writes (standard), one for all "
           "variants of a model that writes them (one-model batch), numbers in memory (direct). Milliseconds a variant and variants a "
           "second, two threads, `voxmend bench %s --augment -r %s`. Their times are of 5 million variants of 1000 models; in the scan "
           "that we have the digits of the table have fallen apart (legible are totals of 473, 66 and 32 h at 64³, and 545, "
           "92 and 39 h at 256³; the rates beside ours are 5 million over these):" % (os.path.basename(path), ",".join(map(str, grids))))
    p.table(["grid", "standard ms", "batch ms", "direct ms", "standard /s, theirs / here", "batch /s", "direct /s"], rows)


def table_3(p, grids):
    path = p.mesh("classic/common3d-cheburashka.obj", "torus.off")
    rows = []
    for grid in grids:
        sizes = {}
        for kind in "rle", "raw":
            folder = p.place("%s-%d" % (kind, grid))
            p.run("augment", path, "-o", folder, "-r", grid, "-n", 4 if p.quick else 16, "--format", kind, "-q")
            files = [os.path.join(folder, f) for f in os.listdir(folder) if f.endswith("." + kind)]
            sizes[kind] = sum(os.path.getsize(f) for f in files) / len(files)
        rows.append(["%d³" % grid] + ["%s GB" % show(sizes[k] * VARIANTS * MODELS / 1e9) for k in ("raw", "rle")] +
                    ["%s MB" % show(sizes[k] * VARIANTS / 1e6) for k in ("raw", "rle")] + ["0"])
    p.text("**Table 3**, what the files of all variants would take: 5000 of each of the 9843 models of ModelNet40's training set "
           "(standard), or of one model at a time (batch), from the mean size of %d variants of %s. Raw is a bit for each voxel as theirs "
           "is: their 156.25 MB at 64³ and 9.76 GB at 256³ for 5000 are these numbers with M = 2^20. RLE depends on the model: "
           "their 47.7 MB and 1.91 GB are those of the one that packs worst:" %
           (4 if p.quick else 16, os.path.basename(path)))
    p.table(["grid", "standard, raw", "standard, RLE", "batch, raw", "batch, RLE", "direct"], rows)


def pictures(p, size):
    """Figures 2 (surface and solid), 7 (scale to fit), 8 (scalings) and 9 (displaced vertices)."""
    path = p.mesh("classic/common3d-cheburashka.obj", "sphere.off")
    for name, options in (("solid", []), ("shell", ["--mode", "surface", "--surface", "shell6"]), ("sphere", ["--fit", "sphere"])):
        p.voxelize(path, "-r", size, *options, out=name + ".npy")
        if p.has_pictures():
            p.run("view", p.place(name + ".npy"), "--slice", "z=0.5", "-o",
                  os.path.join(p.given.pictures or p.folder.name, name + ".png"), "-q")


def main():
    p = Paper("ogayar")
    alternatives(p, [8, 16] if p.quick else [64, 256])
    table_2(p, [8] if p.quick else [64, 256])
    table_3(p, [16] if p.quick else [32, 64, 128, 256])
    pictures(p, 16 if p.quick else 128)
    p.finish()


main()
