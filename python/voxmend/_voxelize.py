# SPDX-License-Identifier: BSD-3-Clause
"""Grids, octrees and surfaces of meshes."""
from __future__ import annotations

from typing import Optional

from . import _core
from ._core import ffi, lib
from ._engines import EngineLike
from ._grid import VoxelGrid
from ._mesh import Mesh
from ._mesh_sources import MeshLike
from ._space import Like, Place
from ._sparse import SparseGrid
from ._types import ArrayLike, Progress, Resolution, Size
from ._work import Rules, Run, Work


def voxelize(mesh: MeshLike, resolution: Optional[Resolution] = None, *, pitch: Optional[Size] = None,
             voxel_size: Optional[Size] = None, fit: Optional[str] = None, pad: int = 0, bounds: Optional[ArrayLike] = None,
             like: Optional[Like] = None, mode: str = "solid", surface: Optional[str] = None, method: Optional[str] = None,
             vote: Optional[str] = None, parts: str = "auto", cavities: Optional[str] = None, thin: str = "auto",
             confidence: bool = False, repair: bool = True, engine: EngineLike = None, progress: Progress = None,
             timeout: Optional[float] = None) -> VoxelGrid:
    """Voxelizes a mesh: a voxel is set where its centre is inside, and where parts thinner than a voxel need it.

    Args:
        mesh: Mesh, path, open file, (vertices, faces), or a mesh of trimesh (also a Scene), open3d, pyvista or meshio.
        resolution: voxels along the longest side, or three numbers; 128 if no size is given.
        pitch: side of a voxel in model units, one number or three: the grid that trimesh's mesh.voxelized(pitch) has. Centres
            of voxels are whole multiples of the pitch, from round(least corner / pitch) to round(greatest corner / pitch).
            With `fit` or `bounds` as `voxel_size`.
        voxel_size: side of a voxel in model units, one number or three, fitted about the model as `fit` says.
        fit: "cube": equal dimensions, filled by the longest side, which is what is taken if nothing is said; "tight": the
            box of the model; "sphere": equal dimensions, filled by the diagonal of the box.
        pad: voxels kept free on each side: within a resolution, in addition with a size.
        bounds: (2, 3) corners of the box to cover, model units.
        like: a grid, octree or field whose space is taken; or a VoxelGrid of trimesh.
        mode: "solid", "surface" or "both".
        surface: with mode "surface", "conservative", which is what is taken if nothing is said, "thin", "shell26", "shell18" or
            "shell6"; with "both" one of the first two.
        method, vote, parts, cavities: as in `voxmend voxelize --help`. None: "vote", "auto", "auto". `vote` goes with method
            "vote", `cavities` with parts "auto", and neither `method` nor `vote` with a surface that is no shell.
        thin: parts thinner than a voxel: "keep": voxels are added that hold them together, and through which no path from
            face to face leaks; "26": nor one over edges and corners; "drop": only voxels whose centre is inside; "auto":
            "keep", but "drop" where `method` or `vote` chooses another rule. With a surface it goes if that is a shell.
        confidence: keep for each voxel how sure it is: `VoxelGrid.confidence`.
        repair: repair the mesh first, as `voxmend.repair(mesh, separate=True)` does.
        engine: "cpu"; "opencl", "opengl", a name that `voxmend.engines` gives, "auto", or an `Engine`. The bits are the same.
        progress, timeout: as for `voxmend.watch`.

    Returns:
        the grid; its `report` has counts of parts, contested voxels, voxels added for thin parts, the engine and so on.

    Raises:
        EmptyError: no face has three different corners.
        OutOfMemoryError: the grid would not fit the memory limit; RangeError: beyond 2^20 voxels along an axis.
        UnavailableError: the engine is not there. VoxmendTimeout: the time was up.
    """
    place = Place("voxelize", resolution, pitch, voxel_size, fit, pad, bounds, like)
    rules = Rules(mode, surface, method, vote, parts, cavities, thin, confidence)
    with Work(mesh, place, rules, Run(repair, engine, progress, timeout)) as work:
        space, report = work.space(), _core.new("vxm_voxelize_report")
        made = _core.create("vxm_grid", lib.vxm_voxelize, report, work.source._pointer,
                            _core.new("vxm_space_options", like=space), work.options, destroy=lib.vxm_grid_destroy)
        grid = VoxelGrid._of(made, work.report(report))
    _core.warn(grid.warnings)
    return grid


def voxelize_sparse(mesh: MeshLike, resolution: Optional[Resolution] = None, *, pitch: Optional[Size] = None,
                    voxel_size: Optional[Size] = None, fit: Optional[str] = None, pad: int = 0,
                    bounds: Optional[ArrayLike] = None, like: Optional[Like] = None, mode: str = "solid",
                    surface: Optional[str] = None, method: Optional[str] = None, vote: Optional[str] = None,
                    parts: str = "auto", cavities: Optional[str] = None, thin: str = "auto", repair: bool = True,
                    engine: EngineLike = None, progress: Progress = None, timeout: Optional[float] = None) -> SparseGrid:
    """As `voxelize`, into an octree, whose memory follows the surface: for grids of 4096 voxels along a side and more."""
    place = Place("voxelize_sparse", resolution, pitch, voxel_size, fit, pad, bounds, like)
    rules = Rules(mode, surface, method, vote, parts, cavities, thin)
    with Work(mesh, place, rules, Run(repair, engine, progress, timeout)) as work:
        space, model, report = work.space(), work.model(), _core.new("vxm_voxelize_report")
        made = _core.create("vxm_sparse", lib.vxm_model_sparse, report, model, space, ffi.NULL, destroy=lib.vxm_sparse_destroy)
        sparse = SparseGrid._of(made, work.report(report), work.warnings(model))
    _core.warn(sparse.warnings)
    return sparse


def remesh(mesh: MeshLike, resolution: Optional[int] = None, *, pitch: Optional[Size] = None, voxel_size: Optional[Size] = None,
           thin: str = "auto", repair: bool = True, progress: Progress = None, timeout: Optional[float] = None) -> Mesh:
    """A closed surface of a mesh's solid, made anew at the resolution of a grid; smooth where the mesh is.

    Args:
        mesh: as for `voxelize`.
        resolution: voxels along the longest side; 128 if no size is given.
        pitch, voxel_size: side of a voxel in model units, one number or three. Either stands for the other here.
        thin: as for `voxelize`; plates and walls come out whole, two thirds of a voxel thick
            or more. 'keep' and '26' are the same here.
        repair: repair the mesh first.
        progress, timeout: as for `voxmend.watch`.
    """
    place = Place("remesh", resolution, pitch, voxel_size, "tight")
    with Work(mesh, place, Rules(thin=thin), Run(repair, None, progress, timeout)) as work:
        space_options, kept = place.options(work.original)
        made = _core.create("vxm_mesh", lib.vxm_mesh_remesh, ffi.NULL, work.source._pointer, space_options, work.options,
                            destroy=lib.vxm_mesh_destroy)
        del kept  # until now the options point to it
    return Mesh._of(made)
