# SPDX-License-Identifier: BSD-3-Clause
"""Files of octrees, of which parts are read without the rest."""
from __future__ import annotations

import os
from types import TracebackType
from typing import Any, Optional, Tuple, Type

import numpy

from . import _core, _values
from ._core import lib
from ._errors import ArgumentError
from ._field import VoxelField
from ._grid import VoxelGrid
from ._sparse import SparseGrid, coverage_arguments
from ._space import Placed, shown_size
from ._types import ArrayLike, Path


class SparseFile(Placed):
    """An open .octree file: it is mapped, its index is read, and of the rest what is asked for.

    Several threads may read it. It is closed at the end of `with`, by `close`, or once nothing refers to it.
    """

    def __init__(self, path: Path):
        name = _values.path(path)
        self._name = os.fsdecode(path)
        self._pointer = _core.create("vxm_sparse_file", lib.vxm_sparse_file_open, _core.context(), name, path=path,
                                     destroy=lib.vxm_sparse_file_close)

    @property
    def _open(self) -> Any:
        if self._pointer is None:
            raise ArgumentError("octree: the file %s has been closed" % self._name)
        return self._pointer

    @property
    def _own_space(self) -> Any:
        return lib.vxm_sparse_file_space(self._open)

    @property
    def filled_count(self) -> int:
        """Number of set voxels; of values, those that are not the background."""
        return int(lib.vxm_sparse_file_count(self._open))

    @property
    def has_values(self) -> bool:
        """Whether it holds numbers, labels or colours, for `field`, rather than set and clear voxels."""
        return bool(lib.vxm_sparse_file_has_values(self._open))

    def _box(self, begin: Optional[ArrayLike], end: Optional[ArrayLike]) -> Tuple[Any, Any, Any]:
        """Pointers to both ends of a window, and what holds them."""
        first = _values.wholes("octree: begin", (0, 0, 0) if begin is None else begin, 0, _values.INT64_MAX).astype(numpy.int64)
        last = _values.wholes("octree: end", self.shape if end is None else end, 0, _values.INT64_MAX).astype(numpy.int64)
        if first.shape != (3,) or last.shape != (3,):
            raise ArgumentError("octree: begin and end of a window are three numbers each")
        return _core.pointer("int64_t *", first), _core.pointer("int64_t *", last), (first, last)

    def window(self, begin: Optional[ArrayLike] = None, end: Optional[ArrayLike] = None) -> VoxelGrid:
        """A dense grid of the voxels from index `begin` to the one before `end`, which lies where they lie. [all]"""
        first, last, _ = self._box(begin, end)
        return VoxelGrid._of(_core.create("vxm_grid", lib.vxm_sparse_file_window, self._open, first, last,
                                          destroy=lib.vxm_grid_destroy))

    def field(self, begin: Optional[ArrayLike] = None, end: Optional[ArrayLike] = None) -> VoxelField:
        """The values from index `begin` to the one before `end`; of set voxels 0 and 1, as uint8. [all]"""
        first, last, _ = self._box(begin, end)
        return VoxelField._of(_core.create("vxm_field", lib.vxm_sparse_file_field, self._open, first, last,
                                           destroy=lib.vxm_field_destroy))

    def coverage(self, subdivision: int = 4, begin: Optional[ArrayLike] = None, end: Optional[ArrayLike] = None,
                 dtype: str = "float32") -> VoxelField:
        """As `SparseGrid.coverage`: cubes of 256 voxels or more are counted by the index of the file alone."""
        return VoxelField._of(_core.create("vxm_field", lib.vxm_sparse_file_coverage, self._open,
                                           *coverage_arguments(subdivision, begin, end, dtype), destroy=lib.vxm_field_destroy))

    def read(self) -> SparseGrid:
        """All set voxels as an octree in memory."""
        self._open
        return SparseGrid.read(self._name)

    def close(self) -> None:
        """Closes the file, once other threads are done with it; what has been read of it stays."""
        self._pointer = None

    def __enter__(self) -> "SparseFile":
        self._open
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], raised: Optional[BaseException], traceback: Optional[TracebackType]) -> None:
        self.close()

    def __repr__(self) -> str:
        if self._pointer is None:
            return "<voxmend.SparseFile %s: closed>" % self._name
        return "<voxmend.SparseFile %s: %d x %d x %d voxels of %s, %d %s>" % (
            self._name, *self.shape, shown_size(self.pitch), self.filled_count, "with values" if self.has_values else "set")
