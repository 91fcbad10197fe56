# SPDX-License-Identifier: BSD-3-Clause
"""Material removal: a tool cuts what it moves through."""
from __future__ import annotations

from typing import Any, Generic, TypeVar, Union, cast

import numpy

from . import _core, _values
from ._call_lock import CallLock
from ._core import lib
from ._errors import ArgumentError, KindError
from ._grid import VoxelGrid
from ._mesh_sources import MeshLike, as_mesh
from ._records import CarveReport
from ._repair import repair as repair_mesh
from ._sparse import SparseGrid
from ._types import ArrayLike, Floats

Stock = TypeVar("Stock", VoxelGrid, SparseGrid)


def _turned(quaternions: Floats) -> Floats:
    """(n, 3, 3) rotations of (n, 4) quaternions w, x, y, z of any length."""
    with numpy.errstate(all="ignore"):
        w, x, y, z = (quaternions / numpy.sqrt((quaternions ** 2).sum(1, keepdims=True))).T
    rows = [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
            2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
            2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]
    return cast(Floats, numpy.stack(rows, 1).reshape(-1, 3, 3))


def _poses(path: ArrayLike) -> Floats:
    """(n, 3, 4) matrices of positions, positions with quaternions, or matrices."""
    given = _values.reals("carve: path", path)
    if given.ndim == 3 and given.shape[1:] in ((3, 4), (4, 4)):
        if (abs(given[:, 3:] - (0, 0, 0, 1)) > 1e-9).any():
            raise ArgumentError("carve: the last row of a matrix (4, 4) is not 0, 0, 0, 1: x, y, z stand in its last column; "
                                "transpose matrices that have them in the last row")
        return numpy.ascontiguousarray(given[:, :3])
    if given.ndim != 2 or given.shape[1] not in (3, 7, 12):
        raise ArgumentError("carve: a path has shape (n, 3), (n, 7), (n, 12), (n, 3, 4) or (n, 4, 4), not %s" % (given.shape,))
    if given.shape[1] == 12:
        return numpy.ascontiguousarray(given.reshape(-1, 3, 4))
    straight = numpy.broadcast_to(numpy.array([1.0, 0, 0, 0]), (len(given), 4))
    turns = _turned(given[:, 3:] if given.shape[1] == 7 else straight)
    return numpy.ascontiguousarray(numpy.concatenate([turns, given[:, :3, None]], 2))


class Carver(Generic[Stock]):
    """A tool on its way through a copy of a grid, or through an octree: every voxel is removed whose centre comes to lie
    within the tool, anywhere along its path. Straight steps are covered exactly, however long; through turns no point
    moves by more than half a voxel at a time, without gaps. doc/carve.md has the rules.

    Args:
        stock: what is cut; it stays as it is.
        tool: as for `voxelize`, in the model units of the grid, about its origin.
        repair: repair the tool first, as `voxelize` does.
    """

    def __init__(self, stock: Stock, tool: MeshLike, *, repair: bool = True):
        if not isinstance(stock, (VoxelGrid, SparseGrid)):
            raise KindError("carve: %s is neither a VoxelGrid nor a SparseGrid" % type(stock).__name__)
        mesh = as_mesh(tool)
        self._tool = repair_mesh(mesh, separate=True) if _values.flag("carve: repair", repair) else mesh
        self._call_lock = CallLock()
        own: Any = stock
        is_dense = isinstance(stock, VoxelGrid)
        self._stock: Any = VoxelGrid._of_words(own.packed, own._own_space) if is_dense else own
        make = lib.vxm_carver_create if is_dense else lib.vxm_carver_create_sparse
        self._pointer = _core.create("vxm_carver", make, self._stock._pointer, self._tool._pointer,
                                     destroy=lib.vxm_carver_destroy)

    def _step(self, function: Any, pose: Union[ArrayLike, Floats]) -> CarveReport:
        matrix = _poses(numpy.asarray(pose)[None])[0]
        report = _core.new("vxm_carve_report")
        with self._call_lock:
            _core.call(function, report, self._pointer, _core.pointer("double *", matrix))
        return CarveReport._of(report)

    def place(self, pose: ArrayLike) -> CarveReport:
        """Puts the tool somewhere, and cuts nothing on the way to there.

        Args:
            pose: x, y, z of the tool's origin; or with a quaternion w, x, y, z; or a matrix (3, 4) or (4, 4).
        """
        return self._step(lib.vxm_carver_place, pose)

    def move(self, pose: ArrayLike) -> CarveReport:
        """Moves the tool from where it is, and cuts what it meets; the first time as `place`."""
        return self._step(lib.vxm_carver_move, pose)

    def follow(self, path: ArrayLike) -> int:
        """Moves through all poses of a path, (n, 3), (n, 7), (n, 12), (n, 3, 4) or (n, 4, 4): the voxels removed."""
        report, removed = _core.new("vxm_carve_report"), 0
        with self._call_lock:
            for matrix in _poses(path):
                _core.call(lib.vxm_carver_move, report, self._pointer, _core.pointer("double *", matrix))
                removed += int(report.removed)
        return removed

    def grid(self) -> Stock:
        """What is left: a new grid, or octree."""
        made: Any
        with self._call_lock:
            if isinstance(self._stock, VoxelGrid):
                made = VoxelGrid._of_words(self._stock.packed, self._stock._own_space)
            else:
                made = SparseGrid._of(_core.create("vxm_sparse", lib.vxm_carver_sparse, self._pointer,
                                                   destroy=lib.vxm_sparse_destroy))
        return cast(Stock, made)
