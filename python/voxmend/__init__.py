# SPDX-License-Identifier: BSD-3-Clause
"""voxmend: repairs messy meshes and turns them into voxel grids, exactly.

    import voxmend
    mesh = voxmend.load("chair.off")                    # tells what is wrong: mesh.info()
    grid = voxmend.voxelize(mesh, 64)                   # repairs it, then 64 x 64 x 64 voxels
    grid.save("chair.binvox")
    sampler = voxmend.Sampler(32, rotate="any", scale=0.3)
    sampler.put(mesh.repair(separate=True))
    batch = sampler.batch(16)                           # (16, 1, 32, 32, 32) float32
"""
from ._core import configure, lib as _lib, text as _text
from ._errors import (ArgumentError, BusyError, CancelledError, EmptyError, FileError, FormatError, KindError,
                      NumbersError, OutOfMemoryError, RangeError, UnavailableError, UnreachedError,
                      VoxmendError, VoxmendWarning)
from ._field import Field, read_field
from ._grid import VoxelGrid, coverage, distance, read, remesh, voxelize, write
from ._mesh import Mesh, info, load, repair
from ._sampler import Sampler

__version__ = _text(_lib.vxm_version())

__all__ = [
    "ArgumentError", "BusyError", "CancelledError", "EmptyError", "Field", "FileError", "FormatError", "KindError", "Mesh",
    "NumbersError", "OutOfMemoryError", "RangeError", "Sampler", "UnavailableError", "UnreachedError", "VoxelGrid",
    "VoxmendError", "VoxmendWarning", "configure", "coverage", "distance", "info", "load", "read", "read_field", "remesh", "repair",
    "voxelize", "write"
]
