#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Rueda et al., Fast and Simple Hardware Accelerated Voxelizations Using Simplicial Coverings: tables 2 to 4, figure 4."""
import os

from papers import Paper, ms

# Triangles; seconds at 64, 128, 256, 512 by HA, VP with display lists, Sramek's; VP with vertex arrays
THEIRS = {
    "Simple": (25, (0.0088, 0.0032, 0.0134, 0.0696), (0.0031, 0.0032, 0.0058, 0.0108), (0.0563, 0.6034, 4.4940, 43.9656),
               (0.0030, 0.0017, 0.0030, 0.0077)),
    "Celtic Cross": (1849, (0.0147, 0.0292, 0.0634, 0.1886), (0.0014, 0.0037, 0.0047, 0.0110), (0.0363, 0.4554, 3.7144, 46.0224),
                     (0.0069, 0.0100, 0.0201, 0.0369)),
    "Depot": (5466, (0.0511, 0.1092, 0.2319, 0.5476), (0.0009, 0.0035, 0.0042, 0.7433), (0.0693, 0.5791, 3.9336, 38.6934),
              (0.0935, 0.1869, 0.3853, 0.7272)),
    "Mobile Phone": (13025, (0.0994, 0.1988, 0.6091, 0.9039), (0.0012, 0.0023, 0.8746, 1.9770), (0.0656, 0.4883, 3.7207, 49.0143),
                     (0.2337, 0.4522, 0.8746, 1.8530)),
    "Dragon": (100207, (1.2508, 2.3448, 4.7673, 9.2517), (1.7029, 4.0169, 8.6638, 18.0581), (0.2887, 0.7611, 4.0288, 40.4131),
               (1.6914, 3.3484, 6.6215, 13.5793)),
}
GRIDS = (64, 128, 256, 512)


def models(p):
    return {"Simple": p.mesh("none", "l_prism.off"), "Celtic Cross": p.mesh("classic/cgal-cactus.off", "torus.off"),
            "Depot": p.mesh("classic/cgal-triceratops.off", "torus.off"),
            "Mobile Phone": p.mesh("classic/common3d-cheburashka.obj", "sphere.off"),
            "Dragon": p.mesh("paper/karimvoxelizer-dragon.obj", "sphere.off")}


def tables(p, grids):
    phases = "baseline_tetra_listed,baseline_tetra_full,baseline_density,solid_centres,surface_conservative"
    rows, gl_rows = [], []
    for name, path in models(p).items():
        slow = [g for g in grids if THEIRS[name][0] * g < 3e7]
        found = p.bench(path, phases, slow, time=0)
        for grid in slow:
            at = GRIDS.index(grid) if grid in GRIDS else 0
            theirs = [1000 * THEIRS[name][t][at] for t in (1, 2, 3)]
            cells = [found.get(("baseline_" + b, "cpu", grid)) for b in ("tetra_listed", "tetra_full", "density")]
            solid = found[("solid_centres", "cpu", grid)]
            for cell in cells[:2]:
                p.expect(cell["voxels"] == solid["voxels"], "%s at %d: the tetrahedra's solid is voxmend's" % (name, grid))
            rows.append([name, THEIRS[name][0], os.path.basename(path), p.triangles, "%d³" % grid, theirs[0], ms(cells[0]), theirs[1],
                         ms(cells[1]), theirs[2], ms(cells[2]), ms(solid), ms(found[("surface_conservative", "cpu", grid)])])
    p.text("**Tables 2 and 3** (and of table 4 the column DL), ms. HA: the sections of the tetrahedra that a slice meets, computed by "
           "the CPU. VP (DL): all tetrahedra in each slice. Both are drawn here by a scan-line with XOR on one thread, there by a "
           "GeForce 6800. Šrámek's: the density of the surface (radius 1.8 voxels). Then voxmend's solid and its conservative "
           "surface, one thread. `voxmend bench FILE -r 64,128,256,512 --threads 1 --phases %s`:" % phases)
    p.table(["their model", "triangles", "our model", "triangles", "grid", "HA, theirs", "HA here", "VP, theirs", "DL here",
             "Šrámek, theirs", "Šrámek here", "voxmend, solid", "voxmend, surface"], rows)


def table_4(p, grids):
    if not p.has_opengl():
        p.text("No OpenGL in this build or on this machine: table 4 is left out.")
        return
    rows = []
    for name, path in list(models(p).items())[:3 if p.quick else 4]:
        found = p.bench(path, "solid_centres", grids, engine="cpu,opengl/tetra-vertex,opengl/columns", time=0)
        for grid in grids:
            at = GRIDS.index(grid) if grid in GRIDS else 0
            vertex = found.get(("solid_centres", "opengl/tetra-vertex", grid))
            p.expect(vertex["voxels"] == found[("solid_centres", "cpu", grid)]["voxels"], "the vertex program's solid is the CPU's")
            rows.append([name, os.path.basename(path), "%d³" % grid, 1000 * THEIRS[name][4][at], 1000 * THEIRS[name][2][at], ms(vertex),
                         ms(found.get(("solid_centres", "opengl/columns", grid))), ms(found[("solid_centres", "cpu", grid)])])
    p.text("**Table 4**: their vertex program with vertex arrays (VA: each slice gets the tetrahedra that it meets), as "
           "`--engine opengl --gl-method tetra-vertex` does, here in software (Mesa's llvmpipe), where a GPU's work is done by the "
           "CPU; `columns` is voxmend's own method there:")
    p.table(["their model", "our model", "grid", "VA, theirs", "DL, theirs", "tetra-vertex here", "columns here", "voxmend, CPU"], rows)


def figure_4(p, size):
    folder = p.given.pictures or p.folder.name
    path = models(p)["Mobile Phone"]
    out = os.path.join(folder, "noise.ply")
    p.run("voxelize", path, "-r", size, "--color", "noise", "-o", out, "--force", "-q")
    if p.has_pictures():
        p.run("view", path, "-r", size, "--color", "noise", "-o", os.path.join(folder, "noise.png"), "-q")


def main():
    p = Paper("rueda")
    tables(p, [16] if p.quick else list(GRIDS))
    table_4(p, [8] if p.quick else [64, 128])
    figure_4(p, 16 if p.quick else 128)
    p.finish()


main()
