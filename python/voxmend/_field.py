# SPDX-License-Identifier: BSD-3-Clause
"""Numbers, labels and colours of voxels in files."""
from __future__ import annotations

import os
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple, Type, Union

import numpy

from . import _core, _values
from ._core import lib
from ._dlpack import Shared
from ._errors import ArgumentError, KindError
from ._grid import VoxelGrid
from ._mesh import format_name
from ._records import CoverageReport, DistanceReport, Label, LabelReport, VoxelizeReport
from ._show import Shown
from ._space import Placed, space, warn_of_stretch
from ._types import Array, ArrayLike, Path, Size

FieldReport = Union[DistanceReport, CoverageReport, LabelReport, VoxelizeReport, None]

VALUE_KINDS = ("numbers", "distance", "coverage", "labels", "confidence", "colors")


def _scalars() -> Dict[int, "numpy.dtype[Any]"]:
    """numpy's types by the library's numbers."""
    names = [n for n in dir(lib) if n.startswith(("VXM_FLOAT", "VXM_UINT", "VXM_INT"))]
    return {getattr(lib, n): numpy.dtype(n[4:].lower()) for n in names}


class VoxelField(Placed, Shown):
    """A number (or colour) for each voxel of a box. It does not change once it is made.

    Made by `voxmend.distance`, `coverage`, `labels` and `colors`, by `read_field`, or of an array; numpy.asarray(field) gives
    its values. `values, origin, pitch = field` takes it apart.

    Args:
        values: (nx, ny, nz) array of integers or floats, or (nx, ny, nz, 4) uint8 of colours; copied.
        pitch: side of a voxel in model units, one number or three.
        origin: minimum corner of the box, model units.
        kind: "numbers", "distance", "coverage", "labels", "confidence" or "colors"; goes along into files.

    Attributes:
        report: of what made it of a mesh; None if that was something else.
    """

    report: FieldReport

    def __init__(self, values: ArrayLike, pitch: Size = 1.0, origin: ArrayLike = (0.0, 0.0, 0.0), kind: str = "numbers"):
        array = _values.array("field: the values", values, "biuf", "integers or floats of 16 to 64 bits")
        if array.dtype == bool:
            array = array.view(numpy.uint8)
        kinds = {dtype: number for number, dtype in _scalars().items()}
        native = array.dtype.newbyteorder("=")
        if _values.word("field: kind", kind) not in VALUE_KINDS:
            raise ArgumentError("field: %r is none of %s" % (kind, ", ".join(VALUE_KINDS)))
        if native not in kinds:
            raise ArgumentError("field: values of type %s are neither integers nor floats of 16 to 64 bits" % array.dtype)
        expected = 4 if kind == "colors" else 3
        if array.ndim != expected or (expected == 4 and array.shape[3] != 4):
            raise ArgumentError("field: values of shape %r are not those of %s" % (array.shape, kind))
        self._take(_create(array, space(array.shape[:3], origin, pitch), kind))

    def _take(self, pointer: Any) -> "VoxelField":
        self._own: Any = pointer  # the library's field; None until it is asked for, of what is in an array
        self._lying: Any = None  # that array, read-only, then
        self._place: Any = None  # and its space
        self._kind = ""
        self._labels: List[str] = []
        self._pairs: Dict[str, str] = {}
        self._told: Optional[List[str]] = None  # warnings, where another field was read
        self.report = None
        return self

    @classmethod
    def _of(cls, pointer: Any) -> "VoxelField":
        return cls.__new__(cls)._take(pointer)

    @classmethod
    def _made(cls, values: Array, place: Any, kind: str, report: FieldReport, warnings: List[str],
              pairs: Optional[Dict[str, str]] = None, names: Sequence[str] = ()) -> "VoxelField":
        """Of an array that nobody else has, or that nobody can change; the library has a copy only when it is asked for one."""
        out = cls._of(None)
        out._lying, out._place, out._kind = _core.read_only(values), place, kind
        out._labels, out._pairs, out._told, out.report = list(names), dict(pairs or {}), list(warnings), report
        return out

    @property
    def _pointer(self) -> Any:
        if self._own is None:
            made = _create(self._lying, self._place, self._kind)
            _describe(made, self._lying, [name.encode() for name in self._labels],
                      [(key.encode(), value.encode()) for key, value in self._pairs.items()])
            self._own = made
        return self._own

    def __reduce__(self) -> Tuple[Any, ...]:
        labels = [name.encode() for name in self._labels]
        pairs = [(key.encode(), value.encode()) for key, value in self._pairs.items()]
        if self._own is not None:  # as its file has them, which may be no UTF-8
            string, own = _core.ffi.string, self._own
            labels = [string(lib.vxm_field_label_name(own, n + 1)) for n in range(lib.vxm_field_label_count(own))]
            pairs = [(string(lib.vxm_field_metadata_key(own, n)), string(lib.vxm_field_metadata_value(own, n)))
                     for n in range(lib.vxm_field_metadata_count(own))]
        made = (self.values.copy(), self.pitch, self.origin, self.kind)
        return _restore, (type(self), made, labels, pairs, self.warnings, self.report)

    def __repr__(self) -> str:
        return "<voxmend.VoxelField: %d x %d x %d, %s, %s>" % (*self.shape, self.kind, self.values.dtype)

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> Array:
        out = self.values
        if dtype is not None and numpy.dtype(dtype) != out.dtype:
            return out.astype(dtype)
        return out.copy() if copy else out

    def __iter__(self) -> Iterator[Array]:
        return iter((self.values, self.origin, self.pitch))

    @property
    def _own_space(self) -> Any:
        return self._place if self._own is None else lib.vxm_field_space(self._own)

    @property
    def kind(self) -> str:
        """What the numbers are, as far as the file says; "numbers" if it does not."""
        return self._kind if self._own is None else _core.text(lib.vxm_field_kind_name(lib.vxm_field_kind_of(self._own)))

    def __dlpack__(self, **arguments: Any) -> Any:
        """The values as they are, without a copy, not to be written to: torch.from_dlpack(field)."""
        return Shared(self.values).__dlpack__(**arguments)

    def __dlpack_device__(self) -> Tuple[int, int]:
        return 1, 0  # the CPU

    @property
    def values(self) -> Array:
        """(nx, ny, nz), or of colours (nx, ny, nz, 4); read-only, without a copy."""
        if self._lying is not None:
            return self._lying  # type: ignore[no-any-return]
        shape = self.shape + ((4,) if lib.vxm_field_channels(self._pointer) == 4 else ())
        dtype = _scalars()[lib.vxm_field_scalar(self._pointer)]
        return _core.view(self._pointer, lib.vxm_field_values(self._pointer), shape, dtype.str)

    @property
    def label_names(self) -> Dict[int, str]:
        """Names of labels by their numbers, where there is a table of them."""
        if self._own is None:
            return {n + 1: name for n, name in enumerate(self._labels)}
        return {n: _core.text(lib.vxm_field_label_name(self._own, n)) for n in range(1, lib.vxm_field_label_count(self._own) + 1)}

    @property
    def labels(self) -> List[Label]:
        """The table of labels: those that have a name, and those that a voxel has; empty of floats and colours."""
        if self.kind != "labels" or self.values.dtype.kind not in "iu":
            return []
        names = self.label_names
        numbers, counts = numpy.unique(self.values, return_counts=True)
        voxels = {int(n): int(count) for n, count in zip(numbers, counts) if n != 0}
        return [Label(n, names.get(n, ""), voxels.get(n, 0)) for n in sorted(set(names) | set(voxels))]

    @property
    def metadata(self) -> Dict[str, str]:
        """What else the file says of its values, such as units."""
        if self._own is None:
            return dict(self._pairs)
        return {_core.text(lib.vxm_field_metadata_key(self._own, n)): _core.text(lib.vxm_field_metadata_value(self._own, n))
                for n in range(lib.vxm_field_metadata_count(self._own))}

    @property
    def warnings(self) -> List[str]:
        """What was odd about the file or mesh, told as VoxmendWarning too."""
        if self._told is not None:
            return list(self._told)
        return [_core.text(lib.vxm_field_warning(self._pointer, n)) for n in range(lib.vxm_field_warning_count(self._pointer))]

    def to_pyvista(self) -> Any:
        """A pyvista.ImageData whose cells are the voxels, with the values in cell_data under the name of the kind."""
        from . import _grid_convert
        return _grid_convert.image_data(self, self.kind, self.values)

    def threshold(self, at_least: Optional[float] = None, below: Optional[float] = None) -> VoxelGrid:
        """A grid in which voxels are set whose number is `at_least` one number, `below` another, or both.

        `below=0` of a signed distance is the solid, -0 included. What is not a number is never set.
        """
        options = _core.new("vxm_threshold_options")
        for name, bound in (("at_least", at_least), ("below", below)):
            if bound is not None:
                setattr(options, "use_" + name, True)
                setattr(options, name, _values.real("field: " + name, bound))
        return VoxelGrid._of(_core.create("vxm_grid", lib.vxm_field_threshold, self._pointer, options,
                                          destroy=lib.vxm_grid_destroy))

    def _combined(self, other: object, operation: int, word: str) -> "VoxelField":
        if not isinstance(other, VoxelField):
            raise KindError("%s: %s is not a VoxelField" % (word, type(other).__name__))
        self._need_space_of(other, word)
        return VoxelField._of(_core.create("vxm_field", lib.vxm_field_combine, self._pointer, other._pointer, operation,
                                           destroy=lib.vxm_field_destroy))

    def __or__(self, other: "VoxelField") -> "VoxelField":
        """The union, of values of one kind and type: where both have one, that of the first; the lesser distance."""
        return self._combined(other, lib.VXM_SET_UNION, "or")

    def __and__(self, other: "VoxelField") -> "VoxelField":
        """The values of the first where both have one; the greater distance."""
        return self._combined(other, lib.VXM_SET_INTERSECTION, "and")

    def __sub__(self, other: "VoxelField") -> "VoxelField":
        """The values of the first where the second has none; of distances max(a, -b)."""
        return self._combined(other, lib.VXM_SET_DIFFERENCE, "minus")

    def __xor__(self, other: "VoxelField") -> "VoxelField":
        """The values where one alone has one; of distances the union minus the intersection."""
        return self._combined(other, lib.VXM_SET_SYMMETRIC_DIFFERENCE, "xor")

    def save(self, path: Path, format: Optional[str] = None) -> None:
        """Writes .npy, .nrrd, .octree, .nii, .nii.gz, .vti, .vtk, .tif, .h5, .zarr or .vdb; labels also .binvox, colours not .vdb, but .ply;
        both .vox, .schem, .litematic and .glb."""
        options = _core.new("vxm_grid_write_options")
        name = format_name("save", format)
        options.format = name
        _core.call(lib.vxm_field_write, self._pointer, _values.path(path), options, path=path)
        warn_of_stretch(path, format, self.pitch)


Field = VoxelField  # the name that it had


def _create(values: Array, place: Any, kind: str) -> Any:
    native = values.dtype.newbyteorder("=")
    kinds = {dtype: number for number, dtype in _scalars().items()}
    plain = numpy.ascontiguousarray(values, native)
    return _core.create("vxm_field", lib.vxm_field_create, _core.context(), place, VALUE_KINDS.index(kind), kinds[native],
                        _core.pointer("void *", plain), destroy=lib.vxm_field_destroy)


def _describe(pointer: Any, values: Array, labels: List[bytes], pairs: List[Tuple[bytes, bytes]]) -> None:
    """Adds a table of labels, with their voxels, and what else is known."""
    if labels:
        numbers, counts = numpy.unique(values, return_counts=True)
        voxels = {int(n): int(count) for n, count in zip(numbers, counts)}
        for n, label in enumerate(labels):
            _core.call(lib.vxm_field_add_label, pointer, label, voxels.get(n + 1, 0))
    for key, value in pairs:
        _core.call(lib.vxm_field_add_metadata, pointer, key, value)


def _restore(kind: Type[VoxelField], made: Tuple[Any, ...], labels: List[bytes], pairs: List[Tuple[bytes, bytes]],
             warnings: List[str], report: FieldReport = None) -> VoxelField:
    """A field from its pickle."""
    field = kind.__new__(kind)
    VoxelField.__init__(field, *made)
    _describe(field._pointer, made[0], labels, pairs)
    field._told, field.report = warnings, report
    return field


def read_field(path: Path) -> VoxelField:
    """Reads the numbers of a file as they are: .npy, .nrrd, .vdb, .octree, .nii, .vti, .vtk, .tif, .zarr, .vox, .schem, .litematic or .binvox. Bits are 0 and 1."""
    field = VoxelField._of(_core.create("vxm_field", lib.vxm_field_read, _core.context(), _values.path(path),
                                   destroy=lib.vxm_field_destroy, path=path))
    _core.warn(["%s: %s" % (os.fsdecode(path), line) for line in field.warnings])
    return field
