# SPDX-License-Identifier: BSD-3-Clause
"""Voxel grids, by the names that users of trimesh know."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, List, Optional, Tuple, Type

import numpy

from . import _core, _values
from ._core import ffi, lib
from ._dlpack import Shared
from ._errors import ArgumentError, KindError
from ._mesh import Mesh, format_name
from ._records import Comparison, VoxelizeReport
from ._show import Shown
from ._space import Placed, shown, shown_size, space, warn_of_stretch
from ._types import Array, ArrayLike, Bools, Floats, Int64s, Path, Size, Uint8s, Uint64s

if TYPE_CHECKING:
    from ._field import VoxelField
    from ._mesh_sources import MeshLike
    from ._sparse import SparseGrid


def _empty_grid(space: Any) -> Any:
    return _core.create("vxm_grid", lib.vxm_grid_create, _core.context(), space, destroy=lib.vxm_grid_destroy)


def _filled(matrix: Any) -> Uint8s:
    """(nx, ny, nz) uint8, not 0 where a voxel is set."""
    values = _values.array("grid: the matrix", matrix, "biuf", "numbers or truth values")
    if values.ndim != 3:
        raise ArgumentError("grid: the matrix has %d dimensions, not 3" % values.ndim)
    if values.dtype == numpy.bool_ and values.flags.c_contiguous:
        return values.view(numpy.uint8)
    out = numpy.empty(values.shape, numpy.bool_)
    for layer, filled in zip(values, out):  # one at a time, between which Ctrl-C is heard
        if layer.dtype.kind == "f" and numpy.isnan(layer).any():
            raise ArgumentError("grid: the matrix has numbers that are NaN, neither 0 nor another")
        numpy.not_equal(layer, 0, out=filled)
    return out.view(numpy.uint8)


class VoxelGrid(Placed, Shown):
    """A box of voxels that are set or not. Voxel (i, j, k) has its centre at origin + ((i, j, k) + 1/2) * pitch.

    It does not change; pickles and copies hold the same content. Grids are equal if they have the same space, exactly, and
    the same voxels. Grids in one space are combined by `|`, `&`, `-` and `^`, and `~` is what is not set.

    Args:
        matrix: (nx, ny, nz) array; what is not 0 is set. It is copied.
        pitch: side of a voxel in model units, one number or three.
        origin: minimum corner of the box, model units.

    Attributes:
        report: what came of voxelizing a mesh; all 0, and False, if the grid comes from elsewhere.
    """

    report: VoxelizeReport

    def __init__(self, matrix: ArrayLike, pitch: Size = 1.0, origin: ArrayLike = (0.0, 0.0, 0.0)):
        filled = _filled(matrix)
        made = _empty_grid(space(filled.shape, origin, pitch))
        _core.call(lib.vxm_grid_pack_range, made, 0, filled.shape[0], _core.pointer("uint8_t *", filled))
        self._take(made)

    def _take(self, pointer: Any, report: Optional[VoxelizeReport] = None) -> "VoxelGrid":
        self._pointer = pointer
        self.report = report or VoxelizeReport()
        self._matrix: Optional[Bools] = None
        self._told: Optional[List[str]] = None  # warnings, where another grid was made
        self._sure: Optional[Uint8s] = None  # its confidence, where another grid was made with it
        return self

    @classmethod
    def _of(cls, pointer: Any, report: Optional[VoxelizeReport] = None) -> "VoxelGrid":
        return cls.__new__(cls)._take(pointer, report)

    @classmethod
    def _of_words(cls, words: Uint64s, place: Any) -> "VoxelGrid":
        """Of what `packed` gives."""
        made = _empty_grid(place)
        native = numpy.ascontiguousarray(words, numpy.uint64)
        _core.call(lib.vxm_grid_set_words, made, _core.pointer("uint64_t *", native), native.size)
        return cls._of(made)

    @classmethod
    def from_trimesh(cls, source: Any) -> "VoxelGrid":
        """Of a trimesh.voxel.VoxelGrid that is not turned: the same voxels in the same place."""
        from . import _grid_convert
        return _grid_convert.from_trimesh(source)

    def __reduce__(self) -> Tuple[Any, ...]:
        place = (self.shape, self.origin, self.pitch)
        sure = None if self.confidence is None else numpy.array(self.confidence.values)
        return _restore, (type(self), place, self.packed.astype("<u8"), self.report, self.warnings, sure)

    def __repr__(self) -> str:
        return "<voxmend.VoxelGrid: %d x %d x %d voxels of %s from %s on, %d set>" % (
            *self.shape, shown_size(self.pitch), shown(self.origin), self.filled_count)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, VoxelGrid):
            return NotImplemented
        return self._has_space_of(other) and numpy.array_equal(self.packed, other.packed)

    def __hash__(self) -> int:
        return hash(self.hash)

    @property
    def _own_space(self) -> Any:
        return lib.vxm_grid_space(self._pointer)

    # ---- What is set ----

    @property
    def matrix(self) -> Bools:
        """(nx, ny, nz) bool, read-only, made when it is first asked for. For another grid change a copy: VoxelGrid(copy)."""
        if self._matrix is None:
            self._matrix = _core.read_only(self._unpacked().view(numpy.bool_))
        return self._matrix

    def _unpacked(self) -> Uint8s:
        out = numpy.empty(self.shape, numpy.uint8)
        _core.call(lib.vxm_grid_unpack_range, self._pointer, 0, self.shape[0], _core.pointer("uint8_t *", out))
        return out

    @property
    def packed(self) -> Uint64s:
        """(nz, ny, words) uint64, the grid's own memory: bit i % 64 of word i // 64 is voxel (i, j, k); read-only."""
        nx, ny, nz = self.shape
        words = lib.vxm_grid_row_words(self._pointer)
        return _core.view(self._pointer, lib.vxm_grid_words(self._pointer), (nz, ny, words), "<u8")

    @property
    def bits(self) -> Shared:
        """The same memory as (nz, ny, 8 * words) uint8 for other packages, without a copy: torch.from_dlpack(grid.bits). Bit
        i % 8 of byte i // 8 of a row is voxel (i, j, k). What they give must not be written to."""
        return Shared(self.packed.view("u1"))

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> Array:
        out = self.matrix
        if dtype is not None and numpy.dtype(dtype) != out.dtype:
            return out.astype(dtype)
        return out.copy() if copy else out

    def __dlpack__(self, **arguments: Any) -> Any:
        """The voxels as uint8, in memory of their own, which may be written to: torch.from_dlpack(grid)."""
        return self._unpacked().__dlpack__(**arguments)

    def __dlpack_device__(self) -> Tuple[int, int]:
        return 1, 0  # the CPU

    @property
    def filled_count(self) -> int:
        """Number of set voxels."""
        return int(lib.vxm_grid_count(self._pointer))

    @property
    def filled_box(self) -> Optional[Int64s]:
        """(2, 3) int64: the first indices of the smallest box that has all set voxels, and those behind its last ones; None
        if no voxel is set. `begin, end = grid.filled_box`, then `grid.matrix[tuple(map(slice, begin, end))]` is the box."""
        out = numpy.empty((2, 3), numpy.int64)
        begin, end = (_core.pointer("int64_t *", ends) for ends in out)
        return out if lib.vxm_grid_box(begin, end, self._pointer) else None

    @property
    def volume(self) -> float:
        """Of the set voxels, model units cubed."""
        return self.filled_count * float(numpy.prod(self.pitch))

    @property
    def sparse_indices(self) -> Int64s:
        """(n, 3) int64 indices of set voxels."""
        return numpy.argwhere(self.matrix)

    @property
    def points(self) -> Floats:
        """(n, 3) centres of set voxels, model units."""
        return self.indices_to_points(self.sparse_indices)

    def is_filled(self, points: ArrayLike) -> Bools:
        """(n,) bool: whether points lie in set voxels."""
        at = self.points_to_indices(points)
        inside = ((at >= 0) & (at < self.shape)).all(axis=-1)
        out = numpy.zeros(inside.shape, numpy.bool_)
        out[inside] = self.matrix[tuple(at[inside].T)]
        return out

    @property
    def hash(self) -> int:
        """Of dimensions and voxels, the same on every machine."""
        return int(lib.vxm_grid_hash(self._pointer))

    @property
    def confidence(self) -> Optional["VoxelField"]:
        """How sure each voxel is, a field of uint8 from 0 (a guess) to 255 (proven), without a copy; None unless it was made
        with confidence=True."""
        from ._field import VoxelField
        values: Optional[Array] = self._sure
        if values is None:
            nx, ny, nz = self.shape
            there = lib.vxm_grid_confidence(self._pointer)
            if there == ffi.NULL:
                return None
            values = _core.view(self._pointer, there, (nz, ny, nx), "|u1").transpose()
        place = space(self.shape, self.origin, self.pitch)
        return VoxelField._made(values, place, "confidence", self.report or None, [])

    @property
    def warnings(self) -> List[str]:
        """What reading or voxelizing met, one line each, told as VoxmendWarning too."""
        if self._told is not None:
            return list(self._told)
        return [_core.text(lib.vxm_grid_warning(self._pointer, i)) for i in range(lib.vxm_grid_warning_count(self._pointer))]

    # ---- Others made of it ----

    def _like(self, matrix: Bools) -> "VoxelGrid":
        return VoxelGrid(matrix, self.pitch, self.origin)

    def copy(self) -> "VoxelGrid":
        return self._like(self.matrix)

    def fill(self) -> "VoxelGrid":
        """A new grid, with all that cannot be reached from outside over faces of empty voxels set too."""
        matrix = self.matrix
        empty = numpy.ones([n + 2 for n in matrix.shape], numpy.bool_)
        for layer, filled in zip(empty[1:-1], matrix):
            numpy.logical_not(filled, out=layer[1:-1, 1:-1])
        reached = numpy.zeros_like(empty)
        reached[0], reached[-1] = True, True
        reached[:, 0], reached[:, -1] = True, True
        reached[:, :, 0], reached[:, :, -1] = True, True
        before = -1
        while before != (before := sum(int(layer.sum()) for layer in reached)):
            for axis in range(3):
                slices, open_ = numpy.moveaxis(reached, axis, 0), numpy.moveaxis(empty, axis, 0)
                for i in range(1, len(slices)):
                    slices[i] |= slices[i - 1] & open_[i]
                for i in range(len(slices) - 2, -1, -1):
                    slices[i] |= slices[i + 1] & open_[i]
        out = numpy.empty(matrix.shape, numpy.bool_)
        for layer, filled in zip(reached[1:-1], out):
            numpy.logical_not(layer[1:-1, 1:-1], out=filled)
        return self._like(out)

    def hollow(self) -> "VoxelGrid":
        """A new grid of those set voxels that have an empty one beside a face, or lie at the border."""
        matrix = self.matrix
        out = numpy.zeros(matrix.shape, numpy.bool_)
        for i, full in enumerate(matrix):
            border = numpy.pad(full, 1)
            inner = border[:-2, 1:-1] & border[2:, 1:-1] & border[1:-1, :-2] & border[1:-1, 2:]
            for beside in (i - 1, i + 1):
                inner = inner & matrix[beside] if 0 <= beside < len(matrix) else numpy.zeros_like(inner)
            out[i] = full & ~inner
        return self._like(out)

    def as_boxes(self) -> Mesh:
        """The faces between set and empty voxels, in model units: triangles of which every edge has two. Where voxels
        touch in an edge or a corner alone, either side has vertices of its own, 1/256 of a voxel within its voxels."""
        return Mesh._of(_core.create("vxm_mesh", lib.vxm_grid_surface_mesh, self._pointer, destroy=lib.vxm_mesh_destroy))

    def compare(self, other: "VoxelGrid") -> Comparison:
        """Counts of voxels in both and in one only, and `iou`, for grids of equal shape."""
        if not isinstance(other, VoxelGrid):
            raise KindError("compare: %s is not a VoxelGrid" % type(other).__name__)
        out = _core.new("vxm_comparison")
        _core.call(lib.vxm_grid_compare, out, self._pointer, other._pointer)
        try:
            self._need_space_of(other, "compare")
        except ArgumentError as differ:
            _core.warn(["%s; voxels are compared by index" % str(differ).split(";")[0]])
        return Comparison._of(out)

    # ---- Sets ----

    def _combined(self, other: object, operation: int, word: str) -> "VoxelGrid":
        if not isinstance(other, VoxelGrid):
            raise KindError("%s: %s is not a VoxelGrid" % (word, type(other).__name__))
        self._need_space_of(other, word)
        return VoxelGrid._of(_core.create("vxm_grid", lib.vxm_grid_combine, self._pointer, other._pointer, operation,
                                          destroy=lib.vxm_grid_destroy))

    def __or__(self, other: "VoxelGrid") -> "VoxelGrid":
        return self._combined(other, lib.VXM_SET_UNION, "or")

    def __and__(self, other: "VoxelGrid") -> "VoxelGrid":
        return self._combined(other, lib.VXM_SET_INTERSECTION, "and")

    def __sub__(self, other: "VoxelGrid") -> "VoxelGrid":
        return self._combined(other, lib.VXM_SET_DIFFERENCE, "minus")

    def __xor__(self, other: "VoxelGrid") -> "VoxelGrid":
        return self._combined(other, lib.VXM_SET_SYMMETRIC_DIFFERENCE, "xor")

    def __invert__(self) -> "VoxelGrid":
        return VoxelGrid._of(_core.create("vxm_grid", lib.vxm_grid_combine, self._pointer, ffi.NULL, lib.VXM_SET_COMPLEMENT,
                                          destroy=lib.vxm_grid_destroy))

    def carve(self, tool: "MeshLike", path: ArrayLike, *, repair: bool = True) -> "VoxelGrid":
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

    # ---- For files and other packages ----

    def to_sparse(self) -> "SparseGrid":
        """The same voxels as an octree."""
        from ._sparse import SparseGrid
        return SparseGrid(self)

    def to_trimesh(self) -> Any:
        """A trimesh.voxel.VoxelGrid of the same voxels in the same place."""
        from . import _grid_convert
        return _grid_convert.to_trimesh(self)

    def to_pyvista(self) -> Any:
        """A pyvista.ImageData whose cells are the voxels, cell_data["filled"] 0 or 1; `.threshold(0.5)` leaves what is set."""
        from . import _grid_convert
        return _grid_convert.to_pyvista(self)

    def to_open3d(self) -> Any:
        """An open3d.geometry.VoxelGrid of the set voxels, which have to be cubes."""
        from . import _grid_convert
        return _grid_convert.to_open3d(self)

    def save(self, path: Path, format: Optional[str] = None) -> None:
        """Writes .binvox, .npy, .raw, .rle, .nrrd, .vdb, .octree, .bt, .nii, .nii.gz, .vti, .vtk, .tif, .h5, .zarr, .vox, .schem,
        .litematic, or the surface as .obj, .ply, .stl, .off, .glb."""
        options = _core.new("vxm_grid_write_options")
        name = format_name("save", format)
        options.format = name
        _core.call(lib.vxm_grid_write, self._pointer, _values.path(path), options, path=path)
        warn_of_stretch(path, format, self.pitch)


def _restore(kind: Type[VoxelGrid], place: Tuple[Any, ...], words: Uint64s, report: Any, warnings: List[str],
             sure: Optional[Uint8s] = None) -> VoxelGrid:
    """A grid from its pickle."""
    grid = kind._of_words(words, space(*place))
    grid.report = report or VoxelizeReport()
    grid._told, grid._sure = warnings, sure
    return grid


def read(path: Path, *, at_least: Optional[float] = None, below: Optional[float] = None) -> VoxelGrid:
    """Reads a grid: .binvox, .npy, .raw, .rle, .nrrd, .vdb, .octree, .nii, .nii.gz, .vti, .vtk, .tif, .zarr, .vox,
    .schem or .litematic; what is odd about it is told as VoxmendWarning.

    Numbers are taken as set and clear voxels only if nothing is lost: all are 0 or 1, or unsigned bytes 0 and 255. Other
    files raise NumbersError; `read_field` reads them, or a bound says which voxels are set.

    Args:
        at_least, below: voxels are set where the number is in between, see `Field.threshold`.
    """
    if at_least is not None or below is not None:
        from ._field import read_field
        return read_field(path).threshold(at_least, below)
    made = VoxelGrid._of(_core.create("vxm_grid", lib.vxm_grid_read, _core.context(), _values.path(path),
                                      destroy=lib.vxm_grid_destroy, path=path))
    _core.warn(["%s: %s" % (os.fsdecode(path), line) for line in made.warnings])
    return made


def write(grid: VoxelGrid, path: Path, format: Optional[str] = None) -> None:
    """As `VoxelGrid.save`."""
    if not isinstance(grid, VoxelGrid):
        raise KindError("write: %s is not a VoxelGrid" % type(grid).__name__)
    grid.save(path, format)
