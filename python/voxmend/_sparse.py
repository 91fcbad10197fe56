# SPDX-License-Identifier: BSD-3-Clause
"""Voxels in an octree, whose memory follows their surface."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Optional, Tuple, Type

import numpy

from . import _core, _values
from ._core import ffi, lib
from ._errors import ArgumentError, KindError
from ._field import VoxelField
from ._grid import VoxelGrid
from ._mesh import format_name
from ._records import VoxelizeReport
from ._space import Placed, shown_size
from ._types import ArrayLike, Bools, Floats, Int64s, Path

if TYPE_CHECKING:
    from ._mesh_sources import MeshLike


def coverage_arguments(subdivision: int, begin: Optional[ArrayLike], end: Optional[ArrayLike], dtype: str) -> Tuple[Any, Any, Any]:
    """The options of a coverage, and its window of cubes."""
    scalars = {"float32": lib.VXM_FLOAT32, "float64": lib.VXM_FLOAT64, "uint8": lib.VXM_UINT8, "uint64": lib.VXM_UINT64}
    if _values.word("coverage: dtype", dtype) not in scalars:
        raise ArgumentError("coverage: dtype %r is none of %s" % (dtype, ", ".join(scalars)))
    options = _core.new("vxm_coverage_options", scalar=scalars[dtype],
                        subdivision=_values.whole("coverage: subdivision", subdivision, 1, 1 << 20))
    ends = [None if end is None else _values.wholes("coverage: a window", end, 0, _values.INT64_MAX).astype(numpy.int64)
            for end in (begin, end)]
    if any(end is not None and end.shape != (3,) for end in ends):
        raise ArgumentError("coverage: begin and end of a window are three numbers each")
    first, last = (ffi.NULL if end is None else _core.pointer("int64_t *", end) for end in ends)
    return options, first, last


class SparseGrid(Placed):
    """A set of voxels as an octree over bricks of 4 x 4 x 4: only bricks that are neither empty nor full are held.

    Made by `voxmend.voxelize_sparse` or `SparseGrid.from_grid`. It does not change. Sets in one space are combined by
    `|`, `&`, `-` and `^`, and `~` is what is not set within the box. Pickles hold it as a dense grid.

    Attributes:
        report: what came of voxelizing; all 0, and False, if something else made it.
    """

    report: VoxelizeReport

    def __init__(self, grid: VoxelGrid):
        if not isinstance(grid, VoxelGrid):
            raise KindError("sparse: %s is not a VoxelGrid" % type(grid).__name__)
        self._take(_core.create("vxm_sparse", lib.vxm_sparse_from_grid, grid._pointer, destroy=lib.vxm_sparse_destroy))

    def _take(self, pointer: Any, report: Optional[VoxelizeReport] = None, warnings: Tuple[str, ...] = ()) -> "SparseGrid":
        self._pointer = pointer
        self.report = report or VoxelizeReport()
        self._told = tuple(warnings)
        return self

    @classmethod
    def _of(cls, pointer: Any, report: Optional[VoxelizeReport] = None, warnings: Any = ()) -> "SparseGrid":
        return cls.__new__(cls)._take(pointer, report, tuple(warnings))

    @classmethod
    def from_grid(cls, grid: VoxelGrid) -> "SparseGrid":
        """The same voxels as a dense grid has."""
        return cls(grid)

    @classmethod
    def read(cls, path: Path) -> "SparseGrid":
        """Reads a file of set voxels: memory follows the surface for .octree, .vdb and .bt; others go by way of a grid."""
        pointer = _core.create("vxm_sparse", lib.vxm_sparse_read, _core.context(), _values.path(path), path=path,
                               destroy=lib.vxm_sparse_destroy)
        texts = [_core.text(lib.vxm_sparse_warning(pointer, i)) for i in range(lib.vxm_sparse_warning_count(pointer))]
        _core.warn(texts)
        return cls._of(pointer, None, texts)

    def to_grid(self) -> VoxelGrid:
        """All of it as a dense grid: one bit for each voxel."""
        return VoxelGrid._of(_core.create("vxm_grid", lib.vxm_sparse_to_grid, self._pointer, destroy=lib.vxm_grid_destroy))

    def window(self, begin: ArrayLike, end: ArrayLike) -> VoxelGrid:
        """A dense grid of the voxels from index `begin` to the one before `end`, which lies where they lie."""
        first = _values.wholes("sparse: begin", begin, 0, _values.INT64_MAX).astype(numpy.int64)
        last = _values.wholes("sparse: end", end, 0, _values.INT64_MAX).astype(numpy.int64)
        if first.shape != (3,) or last.shape != (3,) or not ((first < last) & (last <= self.shape)).all():
            raise ArgumentError("sparse: from %s to %s is no window of %s voxels" % (first.tolist(), last.tolist(), self.shape))
        bytes_ = numpy.zeros(tuple(last - first), numpy.uint8)
        lib.voxmend_sparse_window(self._pointer, _core.pointer("int64_t *", first), _core.pointer("int64_t *", last),
                                  _core.pointer("uint8_t *", bytes_))
        return VoxelGrid(bytes_.view(numpy.bool_), self.pitch, self.origin + first * self.pitch)

    def coverage(self, subdivision: int = 4, begin: Optional[ArrayLike] = None, end: Optional[ArrayLike] = None,
                 dtype: str = "float32") -> VoxelField:
        """How much is set of each cube of voxels: the coverage of a grid that is coarser by a power of two.

        Args:
            subdivision: voxels along a cube: 1, 2, 4, ... 2**20.
            begin, end: cubes from index `begin` to the one before `end` along each axis. [all]
            dtype: "float32" or "float64", 0 to 1; "uint8", 0 to 255; "uint64", the number of voxels.
        """
        return VoxelField._of(_core.create("vxm_field", lib.vxm_sparse_coverage, self._pointer,
                                           *coverage_arguments(subdivision, begin, end, dtype), destroy=lib.vxm_field_destroy))

    def __reduce__(self) -> Tuple[Any, ...]:
        return _restore, (type(self), self.to_grid(), self.report, self._told)

    def __repr__(self) -> str:
        return "<voxmend.SparseGrid: %d x %d x %d voxels of %s, %d set, %d bricks>" % (
            *self.shape, shown_size(self.pitch), self.filled_count, self.bricks)

    @property
    def _own_space(self) -> Any:
        return lib.vxm_sparse_space(self._pointer)

    # ---- What is set ----

    @property
    def filled_count(self) -> int:
        """Number of set voxels."""
        return int(lib.vxm_sparse_count(self._pointer))

    @property
    def volume(self) -> float:
        """Of the set voxels, model units cubed."""
        return self.filled_count * float(numpy.prod(self.pitch))

    @property
    def hash(self) -> int:
        """Of dimensions and voxels: that of the same dense grid."""
        return int(lib.vxm_sparse_hash(self._pointer))

    @property
    def bricks(self) -> int:
        """Bricks of 4 x 4 x 4 voxels that are held."""
        return int(lib.vxm_sparse_bricks(self._pointer))

    @property
    def nodes(self) -> int:
        """Nodes of all levels."""
        return int(lib.vxm_sparse_nodes(self._pointer))

    @property
    def nbytes(self) -> int:
        """Bytes that bricks and nodes take."""
        return int(lib.vxm_sparse_bytes(self._pointer))

    @property
    def warnings(self) -> List[str]:
        """What voxelizing met, told as VoxmendWarning too."""
        return list(self._told)

    @property
    def sparse_indices(self) -> Int64s:
        """(n, 3) int64 indices of set voxels, ordered as numpy.argwhere has them."""
        out = numpy.empty((self.filled_count, 3), numpy.int64)
        lib.voxmend_sparse_indices(self._pointer, _core.pointer("int64_t *", out))
        return numpy.asarray(out[numpy.lexsort(out.T[::-1])])

    @property
    def points(self) -> Floats:
        """(n, 3) centres of set voxels, model units."""
        return self.indices_to_points(self.sparse_indices)

    def is_set(self, indices: ArrayLike) -> Bools:
        """(n,) bool: whether voxels of (n, 3) indices are set; False outside of the box."""
        at = numpy.ascontiguousarray(_values.wholes("sparse: indices", indices, -_values.INT64_MAX, _values.INT64_MAX), numpy.int64)
        if at.ndim < 1 or at.shape[-1] != 3:
            raise ArgumentError("sparse: indices of shape %s are not (n, 3)" % (at.shape,))
        out = numpy.empty(at.shape[:-1], numpy.bool_)
        lib.voxmend_sparse_look_up(self._pointer, _core.pointer("int64_t *", at), out.size, _core.pointer("uint8_t *", out))
        return out

    def is_filled(self, points: ArrayLike) -> Bools:
        """(n,) bool: whether (n, 3) points, in model units, lie in set voxels."""
        return self.is_set(self.points_to_indices(points))

    # ---- Sets ----

    def _combined(self, other: object, operation: int, word: str) -> "SparseGrid":
        if not isinstance(other, SparseGrid):
            raise KindError("%s: %s is not a SparseGrid" % (word, type(other).__name__))
        self._need_space_of(other, word)
        return SparseGrid._of(_core.create("vxm_sparse", lib.vxm_sparse_combine, self._pointer, other._pointer, operation,
                                           destroy=lib.vxm_sparse_destroy))

    def __or__(self, other: "SparseGrid") -> "SparseGrid":
        return self._combined(other, lib.VXM_SET_UNION, "or")

    def __and__(self, other: "SparseGrid") -> "SparseGrid":
        return self._combined(other, lib.VXM_SET_INTERSECTION, "and")

    def __sub__(self, other: "SparseGrid") -> "SparseGrid":
        return self._combined(other, lib.VXM_SET_DIFFERENCE, "minus")

    def __xor__(self, other: "SparseGrid") -> "SparseGrid":
        return self._combined(other, lib.VXM_SET_SYMMETRIC_DIFFERENCE, "xor")

    def __invert__(self) -> "SparseGrid":
        return SparseGrid._of(_core.create("vxm_sparse", lib.vxm_sparse_combine, self._pointer, ffi.NULL, lib.VXM_SET_COMPLEMENT,
                                           destroy=lib.vxm_sparse_destroy))

    def carve(self, tool: "MeshLike", path: ArrayLike, *, repair: bool = True) -> "SparseGrid":
        """What a tool leaves that moves along a path: every voxel is removed whose centre comes to lie within it, at any time.

        Args:
            tool: as for `voxelize`, in model units about its origin; repaired first unless `repair` is False.
            path: where its origin goes: (n, 3); with quaternions w, x, y, z (n, 7); or matrices (n, 3, 4), (n, 4, 4).

        `voxmend.Carver` goes step by step, and tells what each has removed.
        """
        from ._carve import Carver
        carver = Carver(self, tool, repair=repair)
        carver.follow(path)
        return carver.grid()

    def __eq__(self, other: object) -> bool:
        """Whether both have the same space, exactly, and the same voxels."""
        if not isinstance(other, SparseGrid):
            return NotImplemented
        return self._has_space_of(other) and self.bricks == other.bricks and (self ^ other).filled_count == 0

    def __hash__(self) -> int:
        return hash(self.hash)

    # ---- Files ----

    def save(self, path: Path, format: Optional[str] = None) -> None:
        """Writes .octree, .vdb or .bt as they are, and .binvox, .npy, .raw, .rle, .nrrd, .nii, .vti, .vtk, .tif or .zarr a few slices at
        a time."""
        options = _core.new("vxm_grid_write_options")
        name = format_name("save", format)
        options.format = name
        _core.call(lib.vxm_sparse_write, self._pointer, _values.path(path), options, path=path)

    def save_indices(self, path: Path) -> None:
        """Writes the indices of set voxels as .npy: (n, 3) int32, ordered as in `sparse_indices`."""
        _core.call(lib.vxm_sparse_write_coords, self._pointer, _values.path(path), path=path)


def _restore(kind: Type[SparseGrid], grid: VoxelGrid, report: VoxelizeReport, warnings: Tuple[str, ...]) -> SparseGrid:
    """An octree from its pickle."""
    made = kind.__new__(kind)
    SparseGrid.__init__(made, grid)
    made.report, made._told = report, warnings
    return made
