# SPDX-License-Identifier: BSD-3-Clause
"""voxmend: repairs messy meshes and turns them into voxel grids, exactly.

    import voxmend
    mesh = voxmend.load("chair.off")                    # tells what is wrong: mesh.info(), mesh.defects()
    grid = voxmend.voxelize(mesh, 64)                   # repairs it, then 64 x 64 x 64 voxels
    grid.save("chair.binvox")
    parts = voxmend.labels(mesh, 64)                    # which part each voxel belongs to
    sampler = voxmend.Sampler(32, rotate="any", scale=0.3)
    sampler.put(mesh)                                   # repairs it, too
    batch = sampler.batch(16)                           # (16, 1, 32, 32, 32) float32

doc/python.md of the sources has more.
"""
from ._carve import Carver
from ._core import configure, lib as _lib, settings, text as _text
from ._defects import DefectGroup, Defects
from ._engines import Engine, engines
from ._errors import (ArgumentError, BusyError, CancelledError, EmptyError, FileError, FormatError, KindError,
                      NumbersError, OutOfMemoryError, RangeError, UnavailableError, UnreachedError,
                      VoxmendError, VoxmendTimeout, VoxmendWarning)
from ._field import Field, VoxelField, read_field
from ._grid import VoxelGrid, read, write
from ._mesh import Mesh
from ._mesh_sources import MeshLike, info, load
from ._model_fields import colors, coverage, distance, labels
from ._progress import watch
from ._records import (CarveReport, Census, Comparison, CoverageReport, DistanceReport, EngineInfo, Finding, Label, LabelReport, Look,
                       PartChange, PartState, RepairReport, Settings, Texture, Verification, VoxelizeReport)
from ._repair import repair, verify
from ._sampler import Sampler
from ._sparse import SparseGrid
from ._sparse_file import SparseFile
from ._voxelize import remesh, voxelize, voxelize_sparse

__version__ = _text(_lib.vxm_version())

__all__ = [
    "ArgumentError", "BusyError", "CancelledError", "CarveReport", "Carver", "Census", "Comparison", "CoverageReport", "DefectGroup", "Defects",
    "DistanceReport", "EmptyError", "Engine", "EngineInfo", "Field", "FileError", "Finding", "FormatError", "KindError", "Label",
    "LabelReport", "Look", "Mesh", "MeshLike", "NumbersError", "OutOfMemoryError", "PartChange", "PartState", "RangeError", "RepairReport",
    "Sampler", "Settings", "SparseFile", "SparseGrid", "Texture", "UnavailableError", "UnreachedError", "Verification", "VoxelField",
    "VoxelGrid", "VoxelizeReport", "VoxmendError", "VoxmendTimeout", "VoxmendWarning", "colors", "configure", "coverage", "distance", "engines",
    "info", "labels", "load", "read", "read_field", "remesh", "repair", "settings", "verify", "voxelize", "voxelize_sparse", "watch",
    "write"
]
