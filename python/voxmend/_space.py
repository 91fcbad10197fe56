# SPDX-License-Identifier: BSD-3-Clause
"""Where voxels lie: boxes of cells, and what is said of them."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, List, Optional, Protocol, Tuple, Union

import numpy

from . import _core, _values
from ._core import ffi, lib
from ._errors import ArgumentError, EmptyError, KindError, RangeError
from ._mesh import Mesh
from ._types import Array, ArrayLike, Floats, Int64s, Path, Resolution, Shape, Size


class HasPlace(Protocol):
    """What says where its voxels lie: grids, octrees and fields, and anything else that has these."""

    @property
    def shape(self) -> Tuple[int, ...]: ...

    @property
    def origin(self) -> Any: ...

    @property
    def pitch(self) -> Any: ...


class HasTransform(Protocol):
    """A grid of trimesh: its transform takes indices to the centres of voxels."""

    @property
    def shape(self) -> Any: ...

    @property
    def encoding(self) -> Any: ...

    @property
    def transform(self) -> Any: ...


Like = Union[HasPlace, HasTransform]


def space(dims: Any, origin: Any, size: Any) -> Any:
    """A vxm_space."""
    out = ffi.new("vxm_space *")
    out.dims[0:3] = [int(d) for d in dims]
    out.origin[0:3] = _values.reals("grid: origin", origin, (3,)).tolist()
    out.voxel_size[0:3] = _values.reals("grid: pitch", size, (3,)).tolist()
    return out


def _in_threes(name: str, values: Array) -> Array:
    """As they are, if each row is x, y and z: numpy would take (n, 1) for three equal numbers. An empty list is no rows."""
    if values.shape == (0,):
        return values.reshape(0, 3)
    if values.ndim < 1 or values.shape[-1] != 3:
        raise ArgumentError("%s of shape %s are not (n, 3)" % (name, values.shape))
    return values


class Placed:
    """What grids, fields and octrees tell of where they lie."""

    @property
    def _own_space(self) -> Any:
        raise NotImplementedError

    @property
    def shape(self) -> Shape:
        """(nx, ny, nz)"""
        nx, ny, nz = (int(n) for n in self._own_space.dims)
        return nx, ny, nz

    @property
    def origin(self) -> Floats:
        """(3,) minimum corner of the box, model units."""
        return numpy.array(list(self._own_space.origin))

    @property
    def pitch(self) -> Floats:
        """(3,) sides of a voxel, model units."""
        return numpy.array(list(self._own_space.voxel_size))

    @property
    def bounds(self) -> Floats:
        """(2, 3) corners of the box, model units."""
        return numpy.stack([self.origin, self.origin + self.pitch * self.shape])

    @property
    def transform(self) -> Floats:
        """(4, 4): takes (i, j, k, 1) to the centre of the voxel, as in trimesh."""
        out = numpy.diag([*self.pitch, 1.0])
        out[:3, 3] = self.origin + self.pitch / 2
        return out

    def indices_to_points(self, indices: ArrayLike) -> Floats:
        """Centres of voxels, (n, 3) in model units, of their (n, 3) indices."""
        at = _in_threes("grid: indices", _values.array("grid: indices", indices, "iuf", "numbers"))
        return numpy.asarray(self.origin + (at + 0.5) * self.pitch)

    def points_to_indices(self, points: ArrayLike) -> Int64s:
        """(n, 3) indices of the voxels in which points lie; they may lie outside of the box."""
        given = _in_threes("grid: points", _values.reals("grid: points", points))
        at = numpy.floor((given - self.origin) / self.pitch)
        return numpy.asarray(numpy.clip(at, -(2.0 ** 62), 2.0 ** 62), numpy.int64)

    def _has_space_of(self, other: "Placed") -> bool:
        return (self.shape == other.shape and bool((self.origin == other.origin).all())
                and bool((self.pitch == other.pitch).all()))

    def _need_space_of(self, other: "Placed", what: str) -> None:
        """As `voxmend combine`: files hold a space to about nine digits, so that a thousandth of a voxel is no difference."""
        if self.shape != other.shape:
            raise ArgumentError("%s: one has %d x %d x %d voxels and the other %d x %d x %d; voxelize(..., like=grid) makes equal "
                                "ones" % (what, *self.shape, *other.shape))
        near = 1e-3 * self.pitch
        if (abs(self.pitch - other.pitch) * self.shape > near).any():
            raise ArgumentError("%s: one has voxels of %s and the other of %s; voxelize(..., like=grid) makes equal ones" %
                                (what, shown_size(self.pitch), shown_size(other.pitch)))
        if (abs(self.origin - other.origin) > near).any():
            raise ArgumentError("%s: one begins at %s and the other at %s; voxelize(..., like=grid) makes equal ones" %
                                (what, shown(self.origin), shown(other.origin)))


def shown(numbers: Floats) -> str:
    """(a, b, c)"""
    return "(%s)" % ", ".join("%.6g" % n for n in numbers.tolist())


def shown_size(sizes: Floats) -> str:
    """One number if all are equal."""
    return "%.6g" % sizes[0] if (sizes == sizes[0]).all() else shown(sizes)


def is_of_trimesh(source: Any) -> bool:
    """By what a grid of trimesh has, of which some versions call a centre `origin`."""
    return not isinstance(source, Placed) and all(hasattr(source, name) for name in ("shape", "encoding", "transform"))


def place_of_trimesh(caller: str, source: Any) -> Tuple[Floats, Floats]:
    """Origin and sides of voxels of a grid of trimesh."""
    transform = numpy.asarray(source.transform, numpy.float64)
    sizes = numpy.diag(transform)[:3]
    if transform.shape != (4, 4) or (transform[:3, :3] != numpy.diag(sizes)).any() or not (sizes > 0).all():
        raise ArgumentError("%s: the grid is turned, mirrored or sheared, which a VoxelGrid cannot be; use its "
                            ".revoxelized(shape) or its mesh" % caller)
    return transform[:3, 3] - sizes / 2, sizes


def _sizes(caller: str, name: str, wanted: Size) -> List[float]:
    """Three positive numbers, of one or three."""
    title = "%s: %s" % (caller, name)
    if isinstance(wanted, (str, bytes)) or numpy.ndim(wanted) == 0 or isinstance(wanted, complex):
        out = [_values.real(title, wanted)] * 3
    else:
        out = [_values.real(title, n) for n in numpy.asarray(wanted, object)]
    if len(out) != 3 or not min(out) > 0:
        raise ArgumentError("%s: the %s %r is neither a positive number nor three" % (caller, name, wanted))
    return out


def _resolution(caller: str, wanted: Resolution) -> List[int]:
    name = caller + ": the resolution"
    if isinstance(wanted, (int, str, bytes)) or numpy.ndim(wanted) == 0:
        return [_values.whole(name, wanted, 1, _values.DIM_MAX), 0, 0]
    numbers = [_values.whole(name, n, 1, _values.DIM_MAX) for n in wanted]
    if len(numbers) != 3:
        raise ArgumentError("%s %r is neither one number nor three" % (name, wanted))
    return numbers


def _used_corners(mesh: Mesh) -> Tuple[Floats, Floats]:
    """The bounds of the finite vertices that faces use."""
    used = numpy.zeros(len(mesh.vertices), numpy.bool_)
    used[mesh.indices] = True
    points = mesh.vertices[used]
    points = points[numpy.isfinite(points).all(axis=1)]
    if len(points) == 0:
        raise EmptyError("the mesh has no faces, and so no extent")
    return points.min(axis=0), points.max(axis=0)


def _lattice(mesh: Mesh, sizes: List[float], pad: int) -> Any:
    """The space of trimesh's `mesh.voxelized(pitch)`: centres of voxels are whole multiples of the pitch, and reach from that
    nearest to the least corner of the mesh to that nearest to its greatest (of two equally near ones the even one)."""
    least, greatest = _used_corners(mesh)
    size = numpy.array(sizes)
    first, last = numpy.round(least / size) - pad, numpy.round(greatest / size) + pad
    if not (abs(numpy.concatenate([first, last])) < 2.0 ** 52).all():
        raise RangeError("voxelize: the pitch %s is too small for where the mesh lies" % shown(size))
    return space(last - first + 1, first * size - size / 2, size)


@dataclass
class Place:
    """What a caller says of where voxels are to lie."""

    caller: str
    resolution: Optional[Resolution] = None
    pitch: Optional[Size] = None
    voxel_size: Optional[Size] = None
    fit: Optional[str] = None
    pad: int = 0
    bounds: Optional[ArrayLike] = None
    like: Optional[Like] = None

    def check(self) -> None:
        """What does not go together."""
        given = [name for name in ("resolution", "pitch", "voxel_size") if getattr(self, name) is not None]
        if len(given) > 1:
            raise ArgumentError("%s: %s and %s exclude each other" % (self.caller, given[0], given[1]))
        if self.like is None:
            return
        if given or self.bounds is not None or self.fit is not None or self.pad:
            raise ArgumentError("%s: `like` takes the whole space of a grid; leave out the others" % self.caller)
        missing = [name for name in ("shape", "origin", "pitch") if not hasattr(self.like, name)]
        if missing and not is_of_trimesh(self.like):
            raise KindError("%s: `like` is %s, which has no %s; give a grid, a field or an octree, such as "
                            "voxmend.VoxelGrid(array, pitch, least_corner)" %
                            (self.caller, type(self.like).__name__, " and no ".join(missing)))

    def options(self, original: Mesh) -> Tuple[Any, Any]:
        """The options, and what they point to."""
        fit = "cube" if self.fit is None else self.fit
        options = _core.new("vxm_space_options", pad=_values.whole(self.caller + ": pad", self.pad, 0),
                            fit=_core.choice(self.caller + ": fit", fit, "VXM_FIT_"))
        kept = None
        if self.like is not None:
            like: Any = self.like
            origin, sides = place_of_trimesh(self.caller, like) if is_of_trimesh(like) else (like.origin, like.pitch)
            kept = space(like.shape, origin, sides)
        if self.resolution is not None:
            options.resolution[0:3] = _resolution(self.caller, self.resolution)
        if self.voxel_size is not None:
            options.voxel_sizes[0:3] = _sizes(self.caller, "voxel_size", self.voxel_size)
        if self.pitch is not None:
            sizes = _sizes(self.caller, "pitch", self.pitch)
            options.voxel_sizes[0:3] = sizes
            if self.fit is None and self.bounds is None:
                kept = _lattice(original, sizes, options.pad)
        if self.bounds is not None:
            corners = _values.reals(self.caller + ": bounds", self.bounds)
            if corners.shape not in ((2, 3), (6,)):  # (3, 2), a range along each axis, would be taken for other corners
                raise ArgumentError("%s: bounds of shape %s are not two corners of three numbers, the least and the greatest: "
                                    "[[x0, y0, z0], [x1, y1, z1]]" % (self.caller, corners.shape))
            options.use_bounds = True
            options.bounds[0:6] = corners.reshape(-1).tolist()
        if kept is not None:
            options.like = kept
        return options, kept

    def fitted(self, original: Mesh, source: Mesh) -> Any:
        """The vxm_space: of the mesh that is voxelized, or of trimesh's lattice about the one that was given."""
        options, kept = self.options(original)
        out = ffi.new("vxm_space *")
        _core.call(lib.vxm_space_fit, out, source._pointer, options)
        del kept  # until now the options point to it
        return out


def warn_of_stretch(path: Path, format: Optional[str], pitch: Floats) -> None:
    """Tells of voxels that are no cubes in a file of a program for which all are."""
    name = os.fsdecode(_values.path(path))
    kind = (format or os.path.splitext(name)[1].lstrip(".")).lower()
    if kind in ("schem", "litematic", "vox") and (abs(pitch - pitch[0]) > 1e-6 * pitch[0]).any():
        _core.warn(["%s: .%s shows all voxels as cubes, and these are %.4g x %.4g x %.4g: the model looks stretched in other "
                    "programs" % (name, kind, *pitch)])
