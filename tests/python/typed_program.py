# SPDX-License-Identifier: BSD-3-Clause
"""A program that uses all of the package, with types throughout: mypy --strict has nothing to say of it, and it runs. SAMPLES is a
folder of what samples/generate_samples makes."""
from __future__ import annotations

import io
import os
import pathlib
import pickle
from typing import Dict, List, Optional, Tuple

import numpy
import numpy.typing

import voxmend

Floats = numpy.typing.NDArray[numpy.float64]
folder = pathlib.Path(os.environ["SAMPLES"])


class Mesh:
    """What another package's mesh looks like."""

    def __init__(self, vertices: Floats, faces: List[List[int]]):
        self.vertices, self.faces = vertices, faces


def what_is_wrong(path: pathlib.Path) -> Tuple[int, Floats]:
    mesh: voxmend.Mesh = voxmend.load(path, format="off", external="none")
    info: voxmend.Census = mesh.info()
    open_: bool = not info.closed
    box: Tuple[float, float, float, float, float, float] = info.bounds
    defects: voxmend.Defects = mesh.defects(max_count=100)
    edges: voxmend.DefectGroup = defects["boundary_edge"]
    counts: Dict[str, int] = defects.counts
    for group in defects:
        print(group.kind, group.total, group.elements.shape, box[0], open_)
    for finding in voxmend.verify(mesh, "closed").findings:
        where: Optional[Tuple[float, float, float]] = finding.position
        print(finding.what, finding.count, where)
    return counts["boundary_edge"], edges.positions


def mended(mesh: voxmend.MeshLike) -> voxmend.Mesh:
    out = voxmend.repair(mesh, "closed", fill_holes="all", weld=1e-9, sheets="keep", part_changes=True, timeout=60.0)
    report: voxmend.RepairReport = out.report
    passes: Dict[str, int] = report.passes
    print(report.filled_holes + report.sheets, sum(passes.values()), out.part_changes[0].after.volume)
    out.save(folder / "mended.ply", level="closed")
    return out


def grids(mesh: voxmend.Mesh) -> voxmend.VoxelGrid:
    one = voxmend.voxelize(mesh, 24, pad=1, mode="both", engine="cpu", confidence=True)
    report: voxmend.VoxelizeReport = one.report
    count: int = report.voxels + one.filled_count
    matrix: numpy.typing.NDArray[numpy.bool_] = one.matrix
    words: numpy.typing.NDArray[numpy.uint64] = one.packed
    points: Floats = one.points
    shape: Tuple[int, int, int] = one.shape
    sure: Optional[voxmend.VoxelField] = one.confidence
    assert sure is not None and sure.shape == shape and count == 2 * int(matrix.sum()) and words.ndim == 3 and len(points) > 0
    other = voxmend.voxelize((mesh.vertices, mesh.faces), like=one, mode="surface")
    both: voxmend.VoxelGrid = (one | other) - (one & other) ^ ~one
    same: bool = both == pickle.loads(pickle.dumps(both))
    compared: voxmend.Comparison = one.compare(other)
    print(repr(one), same, compared.iou, one.hash, one.volume, one.bounds.tolist(), one.filled_box, one.transform.shape)
    tight = mesh.voxelize(pitch=0.1)
    filled: numpy.typing.NDArray[numpy.bool_] = tight.is_filled(tight.indices_to_points([[0, 0, 0], [1, 1, 1]]))
    surface: voxmend.Mesh = tight.fill().hollow().as_boxes()
    print(filled.tolist(), len(surface.triangulated().faces), voxmend.voxelize(Mesh(mesh.vertices, mesh.faces.tolist()), 8))
    return one


def octrees(mesh: voxmend.Mesh) -> int:
    first: voxmend.SparseGrid = voxmend.voxelize_sparse(mesh, 128, mode="surface")
    second = voxmend.voxelize(mesh, like=first).to_sparse()
    part: voxmend.VoxelGrid = (first | second).window((0, 0, 0), (16, 16, 16))
    indices: numpy.typing.NDArray[numpy.int64] = (second - first).sparse_indices
    first.save(folder / "sparse.npy")
    first.save(folder / "sparse.octree")
    with voxmend.SparseFile(folder / "sparse.octree") as file:
        block: voxmend.VoxelGrid = file.window((0, 0, 0), (16, 16, 16))
        coarse: voxmend.VoxelField = file.coverage(16)
        print(file.shape, file.has_values, block.filled_count, coarse.values.sum(), file.field().kind)
    return part.filled_count + len(indices) + first.bricks + first.nodes + first.nbytes


def fields(mesh: voxmend.Mesh) -> List[voxmend.VoxelField]:
    values, origin, pitch = voxmend.distance(mesh, 16, band=2)
    labels: voxmend.VoxelField = voxmend.labels(mesh, 16, by="part")
    table: List[voxmend.Label] = labels.labels
    names: Dict[int, str] = labels.label_names
    assert isinstance(labels.report, voxmend.LabelReport) and labels.report.labels == len(table) == len(names)
    look: voxmend.Look = voxmend.load(folder / "torus.off", colors=True).look
    print(look.has_colors, [texture.failure for texture in look.textures])
    out = [labels, voxmend.colors(mesh, 16, by="position"), voxmend.coverage(mesh, 16, subdivision=2)]
    solid: voxmend.VoxelGrid = voxmend.VoxelField(values, pitch, origin, "distance").threshold(below=0)
    for field in out:
        field.save(folder / "field.npy")
        read: voxmend.VoxelField = voxmend.read_field(folder / "field.npy")
        print(read.kind, read.values.dtype, solid.filled_count)
    return out


def carved(grid: voxmend.VoxelGrid, tool: voxmend.Mesh) -> int:
    carver = voxmend.Carver(grid.to_sparse(), tool)
    step: voxmend.CarveReport = carver.place([0.0, 0.0, 0.0])
    rest: voxmend.SparseGrid = carver.grid()
    left: voxmend.VoxelGrid = grid.carve(tool, numpy.zeros((2, 3)))
    return step.removed - carver.follow([[0.0, 0.0, 0.5]]) + rest.filled_count - left.filled_count


def engines() -> List[str]:
    found: List[voxmend.EngineInfo] = voxmend.engines()
    engine = voxmend.Engine(found[0].name)
    print(engine.info.name, voxmend.settings().threads)
    return [info.name for info in found if info.available]


def variants(mesh: voxmend.Mesh) -> Floats:
    sampler = voxmend.Sampler(16, rotate="any", scale=0.3, seed=3)
    sampler.put(mesh)
    sampler.put(mesh.repair(separate=True), 1, repair=False)
    batch = sampler.batch(4)
    print(batch.shape, sampler.pose(0)["transform"].shape)
    return numpy.asarray(batch, numpy.float64)


def main() -> None:
    told: List[Tuple[str, float]] = []

    def tell(phase: str, fraction: float) -> None:
        told.append((phase, fraction))
    count, ends = what_is_wrong(folder / "open_box.off")
    assert ends.shape == (count, 2, 3)
    with voxmend.watch(progress=tell, timeout=300):
        mesh = mended(str(folder / "open_box.off"))
        with open(folder / "torus.off", "rb") as file:
            torus = voxmend.load(file)
        torus = voxmend.load(io.BytesIO((folder / "torus.off").read_bytes()), "off")
        grid = grids(torus)
        print(octrees(torus), len(fields(torus)), carved(grid, mesh), engines(), variants(torus).sum(), voxmend.remesh(mesh, voxel_size=(0.1, 0.1, 0.2)))
    grid.save(folder / "grid.binvox")
    print(voxmend.read(folder / "grid.binvox").compare(grid)["iou"], len(told))
    try:
        voxmend.voxelize(torus, 600, timeout=0)
    except voxmend.VoxmendTimeout as problem:
        print(problem.status, problem)
    try:
        voxmend.load(folder / "there is none.off")
    except voxmend.FileError as problem:
        print(problem.errno, problem.filename)


if __name__ == "__main__":
    main()
