#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Grids by voxmend beside what other tools do, of the same mesh in the same run, one thread each.

voxel_peers.py VOXMEND MESH [--resolutions 64,128,256] [--runs N] [--timeout SECONDS] [--markdown FILE]

The mesh is first repaired by voxmend (--level closed), so that all have the same triangles, and is read before the clock
starts. All fill the same grid: that of voxmend at the resolution. The least of N runs (3) counts; what takes over two
seconds is run once, and what takes over --timeout (60) is not run at a higher resolution. voxmend's times are those of
'voxmend bench', of a mesh that is repaired and prepared.

The tools are those this Python can import: vtk (vtkPolyDataToImageStencil), embreex (a ray along x for each row of voxels,
again behind each hit), open3d (RaycastingScene: compute_occupancy, compute_signed_distance; VoxelGrid), igl
(fast_winding_number), trimesh (voxelized, fill), pyopenvdb (createLevelSetFromPolygons, three voxels wide). IoU is that of
their solids with voxmend's. With --markdown the table between the marks of FILE is written anew.
"""
import argparse, json, os, re, subprocess, sys, tempfile, time

import numpy

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "repair"))
from levels import read_ply

NO_TIME = float("nan")


class Grid:
    """Places of voxel centres, x fastest in memory as numpy has it last: arrays are [z, y, x]."""

    def __init__(self, report):
        grid = report["grid"]
        self.dims = numpy.array(grid["dims"])
        self.origin = numpy.array(grid["origin"], float)
        self.size = numpy.array(grid["voxel_size"], float) * numpy.ones(3)

    def axis(self, a):
        return self.origin[a] + (numpy.arange(self.dims[a]) + 0.5) * self.size[a]

    def centres(self):
        z, y, x = numpy.meshgrid(self.axis(2), self.axis(1), self.axis(0), indexing="ij")
        return numpy.stack([x, y, z], -1)


# Each peer prepares what is not timed, and returns a function: grid -> bits [z, y, x], or None where it makes no solid.


def vtk_stencil(vertices, faces):
    import vtk
    from vtk.util import numpy_support

    points, cells, poly = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkPolyData()
    points.SetData(numpy_support.numpy_to_vtk(vertices, deep=True))
    threes = numpy.hstack([numpy.full((len(faces), 1), 3), faces]).astype(numpy.int64).ravel()
    cells.SetCells(len(faces), numpy_support.numpy_to_vtkIdTypeArray(threes, deep=True))
    poly.SetPoints(points)
    poly.SetPolys(cells)
    vtk.vtkSMPTools.Initialize(1)

    def run(grid):
        stencil, image = vtk.vtkPolyDataToImageStencil(), vtk.vtkImageStencilToImage()
        stencil.SetInputData(poly)
        stencil.SetOutputOrigin(*(grid.origin + grid.size / 2))
        stencil.SetOutputSpacing(*grid.size)
        stencil.SetOutputWholeExtent(*[int(n) for d in grid.dims for n in (0, d - 1)])
        image.SetInputConnection(stencil.GetOutputPort())
        image.SetInsideValue(1)
        image.SetOutsideValue(0)
        image.SetOutputScalarTypeToUnsignedChar()
        image.Update()
        values = numpy_support.vtk_to_numpy(image.GetOutput().GetPointData().GetScalars())
        return values.reshape(grid.dims[::-1]) > 0

    return run


def embree_rays(vertices, faces):
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    scene = rtcore_scene.EmbreeScene()
    TriangleMesh(scene, vertices[faces].astype(numpy.float32))

    def run(grid):
        y, z = numpy.meshgrid(grid.axis(1), grid.axis(2))
        start = numpy.full(y.size, grid.origin[0] - grid.size[0])
        rows = numpy.arange(y.size)
        from_yz = numpy.stack([y.ravel(), z.ravel()], 1)
        flips = numpy.zeros((y.size, grid.dims[0] + 1), numpy.uint8)
        direction = numpy.zeros((y.size, 3), numpy.float32)
        direction[:, 0] = 1
        while len(rows):
            origins = numpy.column_stack([start, from_yz[rows]]).astype(numpy.float32)
            hits = scene.run(origins, direction[: len(rows)], query="DISTANCE")
            hit = numpy.isfinite(hits) & (hits < 1e30)
            rows, start = rows[hit], start[hit] + hits[hit]
            at = numpy.clip(numpy.ceil((start - grid.origin[0]) / grid.size[0] - 0.5), 0, grid.dims[0]).astype(int)
            flips[rows, at] ^= 1
            start = start + 1e-6 * grid.size[0] * grid.dims[0]
        bits = numpy.bitwise_xor.accumulate(flips[:, :-1], 1)
        return bits.reshape(grid.dims[::-1]) > 0

    return run


def open3d_scene(vertices, faces):
    import open3d

    scene = open3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(open3d.core.Tensor(vertices.astype(numpy.float32)),
                        open3d.core.Tensor(faces.astype(numpy.uint32)))
    return open3d, scene


def open3d_occupancy(vertices, faces):
    open3d, scene = open3d_scene(vertices, faces)

    def run(grid):
        points = open3d.core.Tensor(grid.centres().astype(numpy.float32))
        return scene.compute_occupancy(points, nthreads=1).numpy() > 0

    return run


def open3d_distance(vertices, faces):
    open3d, scene = open3d_scene(vertices, faces)

    def run(grid):
        points = open3d.core.Tensor(grid.centres().astype(numpy.float32))
        scene.compute_signed_distance(points, nthreads=1).numpy()

    return run


def open3d_voxel_grid(vertices, faces):
    import open3d

    mesh = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(vertices),
                                        open3d.utility.Vector3iVector(faces.astype(numpy.int32)))

    def run(grid):
        open3d.geometry.VoxelGrid.create_from_triangle_mesh_within_bounds(
            mesh, float(grid.size[0]), grid.origin, grid.origin + grid.size * grid.dims)

    return run


def igl_winding(vertices, faces):
    import igl

    def run(grid):
        numbers = igl.fast_winding_number(vertices, faces.astype(numpy.int64), grid.centres().reshape(-1, 3))
        return numpy.asarray(numbers).reshape(grid.dims[::-1]) > 0.5

    return run


def trimesh_of(vertices, faces):
    import trimesh

    return trimesh.Trimesh(vertices, faces, process=False)


def trimesh_surface(vertices, faces):
    mesh = trimesh_of(vertices, faces)
    return lambda grid: mesh.voxelized(float(grid.size[0])) and None


def trimesh_fill(vertices, faces):
    mesh = trimesh_of(vertices, faces)
    return lambda grid: mesh.voxelized(float(grid.size[0])).fill() and None


def openvdb_distance(vertices, faces):
    import pyopenvdb

    def run(grid):
        transform = pyopenvdb.createLinearTransform(voxelSize=float(grid.size[0]))
        pyopenvdb.FloatGrid.createLevelSetFromPolygons(
            points=vertices.astype(numpy.float32), triangles=faces.astype(numpy.uint32), transform=transform,
            halfWidth=3)

    return run


PEERS = [
    ("solid", "VTK, vtkPolyDataToImageStencil", vtk_stencil),
    ("solid", "Embree, rays along x", embree_rays),
    ("solid", "Open3D, compute_occupancy", open3d_occupancy),
    ("solid", "trimesh, voxelized and filled", trimesh_fill),
    ("winding number", "libigl, fast_winding_number", igl_winding),
    ("surface", "Open3D, VoxelGrid", open3d_voxel_grid),
    ("surface", "trimesh, voxelized", trimesh_surface),
    ("distance", "OpenVDB, level set, 3 voxels", openvdb_distance),
    ("distance", "Open3D, compute_signed_distance", open3d_distance),
]
PHASES = [
    ("solid", "**voxmend, one axis**", "solid_x"),
    ("solid", "**voxmend, default**", "solid_vote"),
    ("winding number", "**voxmend, --method winding**", "winding"),
    ("surface", "**voxmend, conservative**", "surface_conservative"),
    ("surface", "**voxmend, thin**", "surface_thin"),
    ("distance", "**voxmend, 3 voxels, dense**", "distance"),
]


def bench(voxmend, mesh, resolution):
    """Milliseconds of each phase."""
    phases = ",".join(phase for _, _, phase in PHASES)
    text = subprocess.run([voxmend, "bench", mesh, "-r", str(resolution), "--threads", "1", "--phases", phases, "--json"],
                          check=True, capture_output=True, text=True).stdout
    return {one["phase"]: one["min_ms"] for one in json.loads(text)["results"]}


def truth(voxmend, mesh, resolution, folder):
    """voxmend's grid and bits."""
    path = os.path.join(folder, "solid.npy")
    text = subprocess.run([voxmend, "voxelize", mesh, "-o", path, "--force", "-r", str(resolution), "--thin", "drop",
                           "--json"], check=True, capture_output=True, text=True).stdout
    return Grid(json.loads(text)), numpy.load(path) > 0


def iou(a, b):
    both = numpy.count_nonzero(a | b)
    return numpy.count_nonzero(a & b) / both if both else 1.0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("voxmend")
    parser.add_argument("mesh")
    parser.add_argument("--resolutions", default="64,128,256")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--timeout", type=float, default=60)
    parser.add_argument("--markdown")
    options = parser.parse_args()
    resolutions = [int(r) for r in options.resolutions.split(",")]
    os.environ["OMP_NUM_THREADS"] = "1"
    os.sched_setaffinity(0, {sorted(os.sched_getaffinity(0))[-1]})  # whatever a tool thinks of threads
    with tempfile.TemporaryDirectory() as folder:
        mesh = os.path.join(folder, "mesh.ply")
        subprocess.run([options.voxmend, "repair", options.mesh, "-o", mesh, "--level", "closed", "-q"], check=True)
        vertices, faces = read_ply(mesh)
        vertices, faces = vertices.copy(), numpy.array(faces, numpy.int64)
        times, agreement, left_out = {}, {}, []
        grids = {r: truth(options.voxmend, mesh, r, folder) for r in resolutions}
        for r in resolutions:
            measured = bench(options.voxmend, mesh, r)
            for what, name, phase in PHASES:
                times[what, name, r] = measured.get(phase, NO_TIME)
        for what, name, make in PEERS:
            try:
                run = make(vertices, faces)
            except (ImportError, AttributeError) as error:  # the second for a numpy that it was not built for
                left_out.append(f"{name} ({error})")
                continue
            for r in resolutions:
                grid, expected = grids[r]
                # trimesh comes in another order, and holds a voxel along each axis in memory several times
                best = NO_TIME
                try:
                    for _ in range(options.runs):
                        begin = time.perf_counter()
                        bits = run(grid)
                        spent = time.perf_counter() - begin
                        best = spent if not best <= spent else best
                        if spent > 2:
                            break
                    if bits is not None:
                        agreement[what, name] = iou(numpy.ascontiguousarray(bits), order(expected, grid))
                except (MemoryError, RuntimeError, TypeError, ValueError) as error:
                    left_out.append(f"{name} at {r}^3 ({type(error).__name__}: {str(error)[:80]})")
                    break
                times[what, name, r] = 1000 * best
                print(f"{name} {r}: {1000 * best:.1f} ms", file=sys.stderr)
                if best > options.timeout / 10:
                    break
    table = lines(os.path.basename(options.mesh), len(faces), resolutions, times, agreement, left_out)
    print("\n".join(table))
    if options.markdown:
        write_markdown(options.markdown, table)


def order(bits, grid):
    """voxmend's .npy as [z, y, x]."""
    return bits if bits.shape == tuple(grid.dims[::-1]) and bits.shape != tuple(grid.dims) else bits.transpose(2, 1, 0)


def lines(name, triangles, resolutions, times, agreement, left_out):
    out = [f"{name}, {triangles} triangles, closed; one thread, least of the runs, ms:", "",
           "| | " + " | ".join(f"{r}³" for r in resolutions) + " | IoU |", "|---|" + "---|" * (len(resolutions) + 1)]
    ours = {}
    for what, label, _ in PHASES:
        ours.setdefault(what, label)
    for what in dict.fromkeys(what for what, _, _ in PHASES):
        for row in [n for w, n, _ in PEERS + PHASES if w == what]:
            cells = []
            for r in resolutions:
                ms = times.get((what, row, r), NO_TIME)
                own = times.get((what, ours[what], r), NO_TIME)
                ratio = f" ({ms / own:.0f} ×)" if not row.startswith("**") and own > 0 and ms / own >= 1.5 else ""
                cells.append("–" if ms != ms else (f"{ms:.2f}" if ms < 10 else f"{ms:,.0f}".replace(",", " ")) + ratio)
            same = agreement.get((what, row))
            out.append(f"| {what}: {row} | " + " | ".join(cells) + f" | {'' if same is None else f'{same:.5f}'} |")
    if left_out:
        out += ["", "Left out: " + "; ".join(left_out) + "."]
    return out


def write_markdown(path, table):
    begin, end = "<!-- voxel peers: begin -->", "<!-- voxel peers: end -->"
    with open(path, encoding="utf-8") as file:
        text = file.read()
    before, rest = text.split(begin)
    after = rest.split(end)[1]
    with open(path, "w", encoding="utf-8") as file:
        file.write(before + begin + "\n\n" + "\n".join(table) + "\n\n" + end + after)


if __name__ == "__main__":
    main()
