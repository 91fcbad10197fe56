# SPDX-License-Identifier: BSD-3-Clause
"""Voxel grids, by the names that users of trimesh know, and how they are made."""
from __future__ import annotations

import os
from typing import Any, Iterable, Optional, Sequence, Union

import numpy

from . import _core, _values
from ._core import ffi, lib
from ._errors import ArgumentError, KindError
from ._mesh import Mesh, MeshLike, as_mesh, format_name, repair as repair_mesh
from ._show import Shown


def _space(dims: Sequence[int], origin: Any, size: Any) -> Any:
    out = ffi.new("vxm_space *")
    out.dims[0:3] = [int(d) for d in dims]
    out.origin[0:3] = _values.reals("grid: origin", origin, (3,)).tolist()
    out.voxel_size[0:3] = _values.reals("grid: pitch", size, (3,)).tolist()
    return out


def _empty_grid(space: Any) -> Any:
    return _core.create("vxm_grid", lib.vxm_grid_create, _core.context(), space, destroy=lib.vxm_grid_destroy)


def _filled(matrix: Any) -> numpy.ndarray:
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


class VoxelGrid(Shown):
    """A box of voxels that are set or not. Voxel (i, j, k) has its centre at origin + ((i, j, k) + 1/2) * pitch.

    It does not change; pickles and copies hold the same content.

    Args:
        matrix: (nx, ny, nz) array; what is not 0 is set.
        pitch: side of a voxel in model units, one number or three.
        origin: minimum corner of the box, model units.
    """

    def __init__(self, matrix: Any, pitch: Union[float, Sequence[float]] = 1.0, origin: Sequence[float] = (0.0, 0.0, 0.0)):
        filled = _filled(matrix)
        made = _empty_grid(_space(filled.shape, origin, pitch))
        _core.call(lib.vxm_grid_pack_range, made, 0, filled.shape[0], _core.pointer("uint8_t *", filled))
        self._take(made)

    def _take(self, pointer: Any, report: Optional[dict] = None) -> "VoxelGrid":
        self._pointer = pointer
        self.report: dict = report or {}
        self._matrix: Optional[numpy.ndarray] = None
        self._told: Optional[list] = None  # warnings, where another grid was made
        return self

    @classmethod
    def _of(cls, pointer: Any, report: Optional[dict] = None) -> "VoxelGrid":
        return cls.__new__(cls)._take(pointer, report)

    def __reduce__(self) -> tuple:
        place = (self.shape, self.origin, self.pitch)
        return _restore, (type(self), place, self.packed.astype("<u8"), self.report, self.warnings)

    def __repr__(self) -> str:
        return "<voxmend.VoxelGrid: %d x %d x %d voxels, %d set>" % (*self.shape, self.filled_count)

    # ---- Where it is ----

    @property
    def _own_space(self) -> Any:
        return lib.vxm_grid_space(self._pointer)

    @property
    def shape(self) -> tuple:
        """(nx, ny, nz)"""
        return tuple(self._own_space.dims)

    @property
    def origin(self) -> numpy.ndarray:
        """(3,) minimum corner of the box, model units."""
        return numpy.array(list(self._own_space.origin))

    @property
    def pitch(self) -> numpy.ndarray:
        """(3,) sides of a voxel, model units."""
        return numpy.array(list(self._own_space.voxel_size))

    @property
    def bounds(self) -> numpy.ndarray:
        """(2, 3) corners of the box, model units."""
        return numpy.stack([self.origin, self.origin + self.pitch * self.shape])

    @property
    def transform(self) -> numpy.ndarray:
        """(4, 4): takes (i, j, k, 1) to the centre of the voxel, as in trimesh."""
        out = numpy.diag([*self.pitch, 1.0])
        out[:3, 3] = self.origin + self.pitch / 2
        return out

    def indices_to_points(self, indices: Any) -> numpy.ndarray:
        """Centres of voxels, (n, 3), of their (n, 3) indices."""
        return self.origin + (_values.array("grid: indices", indices, "iuf", "numbers") + 0.5) * self.pitch

    def points_to_indices(self, points: Any) -> numpy.ndarray:
        """(n, 3) indices of the voxels in which points lie; they may lie outside of the grid."""
        at = numpy.floor((_values.reals("grid: points", points) - self.origin) / self.pitch)
        return numpy.clip(at, -(2.0 ** 62), 2.0 ** 62).astype(numpy.int64)

    # ---- What is set ----

    @property
    def matrix(self) -> numpy.ndarray:
        """(nx, ny, nz) bool, read-only, made when it is first asked for. For another grid change a copy: VoxelGrid(copy)."""
        if self._matrix is None:
            self._matrix = _core.read_only(self._unpacked().view(numpy.bool_))
        return self._matrix

    def _unpacked(self) -> numpy.ndarray:
        out = numpy.empty(self.shape, numpy.uint8)
        _core.call(lib.vxm_grid_unpack_range, self._pointer, 0, self.shape[0], _core.pointer("uint8_t *", out))
        return out

    @property
    def packed(self) -> numpy.ndarray:
        """(nz, ny, words) uint64, the grid's own memory: bit i % 64 of word i // 64 is voxel (i, j, k); read-only."""
        nx, ny, nz = self.shape
        words = lib.vxm_grid_row_words(self._pointer)
        return _core.view(self._pointer, lib.vxm_grid_words(self._pointer), (nz, ny, words), "<u8")

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> numpy.ndarray:
        out = self.matrix
        if dtype is not None and numpy.dtype(dtype) != out.dtype:
            return out.astype(dtype)
        return out.copy() if copy else out

    def __dlpack__(self, **arguments: Any) -> Any:
        """The voxels as uint8, in memory of their own, which may be written to: torch.from_dlpack(grid)."""
        return self._unpacked().__dlpack__(**arguments)

    def __dlpack_device__(self) -> tuple:
        return 1, 0  # the CPU

    @property
    def filled_count(self) -> int:
        """Number of set voxels."""
        return lib.vxm_grid_count(self._pointer)

    @property
    def volume(self) -> float:
        """Of the set voxels, model units cubed."""
        return self.filled_count * float(numpy.prod(self.pitch))

    @property
    def sparse_indices(self) -> numpy.ndarray:
        """(n, 3) int64 indices of set voxels."""
        return numpy.argwhere(self.matrix)

    @property
    def points(self) -> numpy.ndarray:
        """(n, 3) centres of set voxels, model units."""
        return self.indices_to_points(self.sparse_indices)

    def is_filled(self, points: Any) -> numpy.ndarray:
        """(n,) bool: whether points lie in set voxels."""
        at = self.points_to_indices(points)
        inside = ((at >= 0) & (at < self.shape)).all(axis=-1)
        out = numpy.zeros(inside.shape, numpy.bool_)
        out[inside] = self.matrix[tuple(at[inside].T)]
        return out

    @property
    def hash(self) -> int:
        """Of dimensions and voxels, the same on every machine."""
        return lib.vxm_grid_hash(self._pointer)

    @property
    def warnings(self) -> list:
        """What reading or voxelizing met, one line each, told as VoxmendWarning too."""
        if self._told is not None:
            return list(self._told)
        return [_core.text(lib.vxm_grid_warning(self._pointer, i)) for i in range(lib.vxm_grid_warning_count(self._pointer))]

    # ---- Others made of it ----

    def _like(self, matrix: numpy.ndarray) -> "VoxelGrid":
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

    def compare(self, other: "VoxelGrid") -> dict:
        """Counts of voxels in both and in one only, and `iou`, for grids of equal shape."""
        if not isinstance(other, VoxelGrid):
            raise KindError("compare: %s is not a VoxelGrid" % type(other).__name__)
        out = _core.new("vxm_comparison")
        _core.call(lib.vxm_grid_compare, out, self._pointer, other._pointer)
        for name in ("origin", "pitch"):
            if (getattr(self, name) != getattr(other, name)).any():
                _core.warn(["the grids differ in %s; voxels are compared by index" % name])
        return _core.fields(out[0])

    def save(self, path: Any, format: Optional[str] = None) -> None:
        """Writes .binvox, .npy, .raw, .rle, .nrrd, .vdb, or the surface as .obj, .ply, .stl, .off."""
        options = _core.new("vxm_grid_write_options")
        name = format_name("save", format)
        options.format = name
        _core.call(lib.vxm_grid_write, self._pointer, _values.path(path), options, path=path)


def _restore(kind: type, place: tuple, words: numpy.ndarray, report: dict, warnings: list) -> VoxelGrid:
    """A grid from its pickle."""
    made = _empty_grid(_space(*place))
    native = numpy.ascontiguousarray(words, numpy.uint64)
    _core.call(lib.vxm_grid_set_words, made, _core.pointer("uint64_t *", native), native.size)
    grid = kind.__new__(kind)._take(made, report)
    grid._told = warnings
    return grid


def read(path: Any, *, at_least: Optional[float] = None, below: Optional[float] = None) -> VoxelGrid:
    """Reads a grid: .binvox, .npy, .raw, .rle, .nrrd or .vdb; what is odd about it is told as VoxmendWarning.

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


def write(grid: VoxelGrid, path: Any, format: Optional[str] = None) -> None:
    """As `VoxelGrid.save`."""
    if not isinstance(grid, VoxelGrid):
        raise KindError("write: %s is not a VoxelGrid" % type(grid).__name__)
    grid.save(path, format)


# ---- From meshes ----

def _space_options(resolution: Any, pitch: Optional[float], fit: str, pad: int, bounds: Any, like: Optional[VoxelGrid]) -> tuple:
    """The options, and what they point to."""
    options = _core.new("vxm_space_options", pad=_values.whole("voxelize: pad", pad, 0),
                        fit=_core.choice("voxelize: fit", fit, "VXM_FIT_"))
    if resolution is not None and pitch is not None:
        raise ArgumentError("voxelize: resolution and pitch exclude each other")
    if like is not None and (resolution is not None or pitch is not None or bounds is not None or pad):
        raise ArgumentError("voxelize: `like` takes the whole space of a grid; leave out the others")
    if pitch is not None:
        options.voxel_size = _values.real("voxelize: pitch", pitch)
        if not options.voxel_size > 0:
            raise ArgumentError("voxelize: the pitch %r is not a positive number" % (pitch,))
    if resolution is not None:
        options.resolution[0:3] = _resolution(resolution)
    if bounds is not None:
        corners = _values.reals("voxelize: bounds", bounds).reshape(-1)
        if corners.size != 6:
            raise ArgumentError("voxelize: bounds are not two corners of three numbers")
        options.use_bounds = True
        options.bounds[0:6] = corners.tolist()
    kept = None
    if like is not None:
        if not all(hasattr(like, name) for name in ("shape", "origin", "pitch")):
            raise KindError("voxelize: `like` is %s, which has no shape, origin and pitch" % type(like).__name__)
        kept = _space(like.shape, like.origin, like.pitch)
        options.like = kept
    return options, kept


def _resolution(wanted: Any) -> list:
    name = "voxelize: the resolution"
    if isinstance(wanted, (str, bytes)) or numpy.ndim(wanted) == 0:
        return [_values.whole(name, wanted, 1), 0, 0]
    numbers = [_values.whole(name, n, 1) for n in wanted]
    if len(numbers) != 3:
        raise ArgumentError("%s %r is neither one number nor three" % (name, wanted))
    return numbers


def _prepare(mesh: MeshLike, repair: bool) -> Mesh:
    source = as_mesh(mesh)
    return repair_mesh(source, separate=True) if _values.flag("voxelize: repair", repair) else source


def voxelize(mesh: MeshLike, resolution: Union[int, Iterable[int], None] = None, *, pitch: Optional[float] = None,
             fit: str = "cube", pad: int = 0, bounds: Any = None, like: Optional[VoxelGrid] = None, mode: str = "solid",
             surface: str = "conservative", method: str = "vote", vote: str = "auto", parts: str = "auto",
             cavities: str = "auto", thin: str = "auto", repair: bool = True) -> VoxelGrid:
    """Voxelizes a mesh: a voxel is set where its centre is inside, and where parts thinner than a voxel need it.

    Args:
        mesh: Mesh, path, (vertices, faces), or an object with these, such as trimesh's.
        resolution: voxels along the longest side, or three numbers; 128 if neither this nor `pitch` is given.
        pitch: side of a voxel in model units.
        fit: "cube": equal dimensions, filled by the longest side; "tight": the box of the model; "sphere": equal
            dimensions, filled by the diagonal of the box.
        pad: voxels kept free on each side.
        bounds: (2, 3) corners of the box to cover, model units.
        like: a grid whose space is taken.
        mode: "solid", "surface" or "both".
        surface: "conservative", "thin", "shell26", "shell18" or "shell6".
        method, vote, parts, cavities: as in `voxmend voxelize --help`.
        thin: parts thinner than a voxel: "keep": voxels are added that hold them together, and through which no path from
            face to face leaks; "26": nor one over edges and corners; "drop": only voxels whose centre is inside; "auto":
            "keep", but "drop" where `method` or `vote` chooses another rule.
        repair: repair the mesh first, as `voxmend.repair` does.

    Returns:
        the grid; its `report` has counts of parts, contested voxels, voxels added for thin parts and so on.
    """
    source = _prepare(mesh, repair)
    options = _core.new("vxm_voxelize_options")
    space_options, kept = _space_options(resolution, pitch, fit, pad, bounds, like)
    options.mode = _core.choice("voxelize: mode", mode, "VXM_MODE_")
    options.surface = _core.choice("voxelize: surface", surface, "VXM_SURFACE_")
    options.method = _core.choice("voxelize: method", method, "VXM_METHOD_")
    options.vote = _core.choice("voxelize: vote", vote, "VXM_VOTE_")
    options.split_mode = _core.choice("voxelize: parts", parts, "VXM_SPLIT_MODE_")
    options.cavities = _core.choice("voxelize: cavities", cavities, "VXM_CAVITIES_")
    options.thin = _core.choice("voxelize: thin", thin, "VXM_THIN_")
    report = _core.new("vxm_voxelize_report")
    made = _core.create("vxm_grid", lib.vxm_voxelize, report, source._pointer, space_options, options,
                        destroy=lib.vxm_grid_destroy)
    del kept  # until now the options point to it
    grid = VoxelGrid._of(made, _core.fields(report[0]))
    _core.warn(grid.warnings)
    return grid


def remesh(mesh: MeshLike, resolution: Optional[int] = None, *, pitch: Optional[float] = None, thin: str = "auto",
           repair: bool = True) -> Mesh:
    """A closed surface of a mesh's solid, made anew at the resolution of a grid; smooth where the mesh is.

    Args:
        mesh: as for `voxelize`.
        resolution: voxels along the longest side; 128 if neither this nor `pitch` is given.
        pitch: side of a voxel in model units.
        thin: as for `voxelize`; thin parts come out two thirds of a voxel thick or more.
        repair: repair the mesh first.
    """
    source = _prepare(mesh, repair)
    options = _core.new("vxm_voxelize_options")
    space_options, kept = _space_options(resolution, pitch, "tight", 0, None, None)
    options.thin = _core.choice("remesh: thin", thin, "VXM_THIN_")
    made = _core.create("vxm_mesh", lib.vxm_mesh_remesh, ffi.NULL, source._pointer, space_options, options,
                        destroy=lib.vxm_mesh_destroy)
    del kept
    return Mesh._of(made)


def _field(mesh: MeshLike, space_of: tuple, repair: bool, kind: str, options: Any, dtype: Any) -> tuple:
    source = _prepare(mesh, repair)
    space_options, kept = _space_options(*space_of)
    space = ffi.new("vxm_space *")
    _core.call(lib.vxm_space_fit, space, source._pointer, space_options)
    del kept
    model = _core.create("vxm_model", lib.vxm_model_create, source._pointer, ffi.NULL, destroy=lib.vxm_model_destroy)
    values = numpy.empty(tuple(space.dims), dtype)
    _core.call(getattr(lib, "vxm_model_" + kind), _core.pointer("float *", values), ffi.NULL, model, space, options)
    _core.warn([_core.text(lib.vxm_model_warning(model, i)) for i in range(lib.vxm_model_warning_count(model))])
    return values, numpy.array(list(space.origin)), numpy.array(list(space.voxel_size))


def distance(mesh: MeshLike, resolution: Any = None, *, pitch: Optional[float] = None, fit: str = "cube", pad: int = 0,
             bounds: Any = None, like: Optional[VoxelGrid] = None, band: float = 3.0, unsigned: bool = False,
             repair: bool = True) -> tuple:
    """Distances from the centres of voxels to the mesh, negative inside.

    Args:
        band: voxels from the mesh within which they are exact; 0 = everywhere.

    Returns:
        (nx, ny, nz) float32 in model units, origin (3,), pitch (3,)
    """
    options = _core.new("vxm_distance_options", band=_values.real("distance: band", band, 0),
                        is_unsigned=_values.flag("distance: unsigned", unsigned))
    return _field(mesh, (resolution, pitch, fit, pad, bounds, like), repair, "distance", options, numpy.float32)


def coverage(mesh: MeshLike, resolution: Any = None, *, pitch: Optional[float] = None, fit: str = "cube", pad: int = 0,
             bounds: Any = None, like: Optional[VoxelGrid] = None, subdivision: int = 4, repair: bool = True) -> tuple:
    """How much of each voxel is filled, by 2, 4 or 8 sub-voxels along each axis.

    Returns:
        (nx, ny, nz) float32 from 0 to 1, origin (3,), pitch (3,), both in model units
    """
    options = _core.new("vxm_coverage_options", subdivision=_values.whole("coverage: subdivision", subdivision, 2, 8))
    return _field(mesh, (resolution, pitch, fit, pad, bounds, like), repair, "coverage", options, numpy.float32)
