#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What other programs find in files that voxmend writes: trimesh, PyMeshLab, meshio and Open3D, those that are there.

other_readers.py VOXMEND SAMPLES MESHES [--levels LIST] [--formats LIST] [--seconds N]

 - Repaired meshes (samples, and the messy ones of MESHES if there are such): whenever the exit status is 0 at level closed
   or solid, trimesh, which merges near vertices when it loads a file, calls the mesh watertight and consistently wound, and
   at solid a volume; PyMeshLab finds it two-manifold without a boundary edge; meshio reads triangles alone; Open3D finds two
   faces at every edge, once it has merged vertices, and that they can be turned consistently. Whether Open3D is there or
   not: once positions are 32-bit floats, each edge has two faces, of opposite direction.
 - Surfaces of grids (random voxels, and a hole through two that touch in an edge): the same, and no face cuts through
   another.
 - The file that --locate writes is read by all of them.
Without --seconds nothing is left out; with it, meshes are left out from there on, which is said.
"""
import argparse, os, subprocess, sys, tempfile, time

import numpy
import trimesh

try:
    import pymeshlab
except ImportError:
    pymeshlab = None
try:
    import meshio
except ImportError:
    meshio = None
try:
    import open3d
except (ImportError, OSError):  # it may lack libraries of the system
    open3d = None


def by_trimesh(path, level):
    mesh = trimesh.load(path, process=True, force="mesh")
    mesh.merge_vertices()
    if not mesh.is_watertight:
        return "not watertight"
    if not mesh.is_winding_consistent:
        return "not consistently wound"
    return None if level != "solid" or mesh.is_volume else "no volume"


def by_volume(path, voxels):
    """Of a surface of so many unit voxels."""
    difference = abs(trimesh.load(path, force="mesh").volume - voxels)
    return "the volume differs by %g voxels" % difference if difference > 0.02 * voxels else None


def by_pymeshlab(path, level):
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.load_new_mesh(path)
    found = meshes.get_topological_measures()
    if not found["is_mesh_two_manifold"] or found["boundary_edges"]:
        return "two-manifold: %s, boundary edges: %d" % (found["is_mesh_two_manifold"], found["boundary_edges"])
    if level == "grid":
        meshes.compute_selection_by_self_intersections_per_face()
        if meshes.current_mesh().selected_face_number():
            return "%d faces cut through others" % meshes.current_mesh().selected_face_number()
    return None


def by_meshio(path, level):
    mesh = meshio.read(path)
    kinds = {block.type for block in mesh.cells}
    return None if kinds == {"triangle"} else "not triangles: %s" % sorted(kinds)


def by_floats(path, level):
    """What a program finds that holds 32-bit floats and merges vertices."""
    mesh = trimesh.load(path, process=False, force="mesh")
    places = numpy.unique(mesh.vertices.astype("<f4") + numpy.float32(0), axis=0, return_inverse=True)[1].reshape(-1)
    corners = places[mesh.faces]
    sides = numpy.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    once, counts = numpy.unique(sides, axis=0, return_counts=True)
    if (counts > 1).any() or (once[:, 0] == once[:, 1]).any():
        return "vertices merge"
    other = numpy.unique(once[:, ::-1], axis=0)
    return None if numpy.array_equal(once, other) else "edges with one face"


def by_open3d(path, level):
    mesh = open3d.io.read_triangle_mesh(path)
    mesh.remove_duplicated_vertices()
    if not mesh.is_edge_manifold(allow_boundary_edges=False):
        return "edges are not manifold"
    return None if mesh.is_orientable() else "not orientable"


JUDGES = [(name, judge) for name, module, judge in (
    ("trimesh", trimesh, by_trimesh), ("32-bit floats", trimesh, by_floats), ("PyMeshLab", pymeshlab, by_pymeshlab),
    ("meshio", meshio, by_meshio), ("Open3D", open3d, by_open3d)) if module]


class Tally:
    def __init__(self):
        self.judged, self.failures, self.refused = 0, 0, 0

    def judge(self, what, path, level, judges=JUDGES):
        for name, judge in judges:
            try:
                complaint = judge(path, level)
            except (Exception, SystemExit) as error:  # whatever a reader raises is what is to be known
                complaint = "%s: %s" % (type(error).__name__, str(error)[:100])
            self.judged += 1
            if complaint:
                self.failures += 1
                print("FAILED: %s: %s: %s" % (what, name, complaint), flush=True)


def run(*arguments):
    return subprocess.run(arguments, capture_output=True, text=True, timeout=120)


def meshes_of(folders):
    for folder in folders:
        for name in sorted(os.listdir(folder)) if os.path.isdir(folder) else []:
            path = os.path.join(folder, name)
            if name.lower().endswith((".off", ".obj", ".stl", ".ply")) and os.path.getsize(path) < 3000000:
                yield path


def repaired(tally, given, work, end):
    left_out = 0
    for mesh in meshes_of([given.samples, os.path.join(given.meshes, "messy")]):
        if time.monotonic() > end:
            left_out += 1
            continue
        for level in given.levels.split(","):
            for form in given.formats.split(",") if level == "closed" else ["ply"]:
                path = os.path.join(work, "out." + form)
                done = run(given.program, "repair", mesh, "--force", "-o", path, "--level", level, "-q")
                if done.returncode == 0:
                    tally.judge("%s, %s, .%s" % (os.path.basename(mesh), level, form), path, level)
                elif "module" in done.stderr or "not reached" in done.stderr or "no face" in done.stderr:
                    tally.refused += 1
                else:
                    tally.failures += 1
                    print("FAILED: %s, %s, .%s: status %d: %s" % (mesh, level, form, done.returncode, done.stderr.strip()))
    if left_out:
        print("%d meshes were left out, as time was up" % left_out)


def grids(tally, given, work):
    random = numpy.random.default_rng(5)
    tunnel = numpy.ones((2, 2, 3), bool)
    tunnel[0, 0, 1] = tunnel[1, 1, 1] = False
    for trial, full in enumerate([tunnel] + [random.random(random.integers(1, 9, 3)) < share
                                             for share in (0.1, 0.3, 0.5, 0.7, 0.9)]):
        if not full.any():
            continue
        grid = os.path.join(work, "grid.npy")
        numpy.save(grid, full)
        for form in given.formats.split(","):
            path = os.path.join(work, "surface." + form)
            run(given.program, "convert", grid, "-o", path, "--force", "-q").check_returncode()
            what = "grid %d, .%s" % (trial, form)
            tally.judge(what, path, "grid")
            tally.judge(what, path, full.sum(), [("volume", by_volume)])


def located(tally, given, work):
    path = os.path.join(work, "wrong.ply")
    for mesh in list(meshes_of([given.samples]))[:8]:
        run(given.program, "info", mesh, "--force", "--locate", path, "-q").check_returncode()
        for name, judge in JUDGES:
            if name == "PyMeshLab":
                read = lambda: pymeshlab.MeshSet(verbose=False).load_new_mesh(path)
            else:
                read = {"trimesh": lambda: trimesh.load(path), "32-bit floats": lambda: trimesh.load(path),
                        "meshio": lambda: meshio.read(path), "Open3D": lambda: open3d.io.read_triangle_mesh(path)}[name]
            tally.judged += 1
            try:
                read()
            except (Exception, SystemExit) as error:
                tally.failures += 1
                print("FAILED: --locate of %s: %s: %s" % (mesh, name, error))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("samples")
    parser.add_argument("meshes")
    parser.add_argument("--levels", default="closed,solid")
    parser.add_argument("--formats", default="ply,stl,obj,off")
    parser.add_argument("--seconds", type=float, default=1e9)
    given = parser.parse_args()
    tally = Tally()
    with tempfile.TemporaryDirectory() as work:
        grids(tally, given, work)
        located(tally, given, work)
        repaired(tally, given, work, time.monotonic() + given.seconds)
    print("by %s: %d judged, %d refused by voxmend, %d failures" % (
        ", ".join(name for name, _ in JUDGES), tally.judged, tally.refused, tally.failures))
    return tally.failures > 0 or tally.judged == 0


if __name__ == "__main__":
    sys.exit(main())
