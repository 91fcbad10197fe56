# SPDX-License-Identifier: BSD-3-Clause
"""Numbers, labels and colours of voxels in files."""
from __future__ import annotations

import os
from typing import Any, Optional, Sequence, Union

import numpy

from . import _core, _values
from ._core import lib
from ._errors import ArgumentError
from ._grid import VoxelGrid, _space
from ._mesh import format_name
from ._show import Shown

_KINDS = ("numbers", "distance", "coverage", "labels", "confidence", "colors")


def _scalars() -> dict:
    """numpy's types by the library's numbers."""
    names = [n for n in dir(lib) if n.startswith(("VXM_FLOAT", "VXM_UINT", "VXM_INT"))]
    return {getattr(lib, n): numpy.dtype(n[4:].lower()) for n in names}


class Field(Shown):
    """A number (or colour) for each voxel of a box, as a file has them. It does not change once it is made.

    Args:
        values: (nx, ny, nz) array of integers or floats, or (nx, ny, nz, 4) uint8 of colours.
        pitch: side of a voxel in model units, one number or three.
        origin: minimum corner of the box, model units.
        kind: "numbers", "distance", "coverage", "labels", "confidence" or "colors"; goes along into files.
    """

    def __init__(self, values: Any, pitch: Union[float, Sequence[float]] = 1.0, origin: Sequence[float] = (0.0, 0.0, 0.0),
                 kind: str = "numbers"):
        array = _values.array("field: the values", values, "biuf", "integers or floats of 16 to 64 bits")
        if array.dtype == bool:
            array = array.view(numpy.uint8)
        kinds = {dtype: number for number, dtype in _scalars().items()}
        native = array.dtype.newbyteorder("=")
        if _values.word("field: kind", kind) not in _KINDS:
            raise ArgumentError("field: %r is none of %s" % (kind, ", ".join(_KINDS)))
        if native not in kinds:
            raise ArgumentError("field: values of type %s are neither integers nor floats of 16 to 64 bits" % array.dtype)
        expected = 4 if kind == "colors" else 3
        if array.ndim != expected or (expected == 4 and array.shape[3] != 4):
            raise ArgumentError("field: values of shape %r are not those of %s" % (array.shape, kind))
        plain = numpy.ascontiguousarray(array, native)
        self._take(_core.create("vxm_field", lib.vxm_field_create, _core.context(), _space(plain.shape[:3], origin, pitch),
                                _KINDS.index(kind), kinds[native], _core.pointer("void *", plain),
                                destroy=lib.vxm_field_destroy))

    def _take(self, pointer: Any) -> "Field":
        self._pointer = pointer
        self._told: Optional[list] = None  # warnings, where another field was read
        return self

    @classmethod
    def _of(cls, pointer: Any) -> "Field":
        return cls.__new__(cls)._take(pointer)

    def __reduce__(self) -> tuple:
        labels = [_core.ffi.string(lib.vxm_field_label_name(self._pointer, n))
                  for n in range(1, lib.vxm_field_label_count(self._pointer) + 1)]
        pairs = [(_core.ffi.string(lib.vxm_field_metadata_key(self._pointer, n)),
                  _core.ffi.string(lib.vxm_field_metadata_value(self._pointer, n)))
                 for n in range(lib.vxm_field_metadata_count(self._pointer))]
        made = (self.values.copy(), self.pitch, self.origin, self.kind)
        return _restore, (type(self), made, labels, pairs, self.warnings)

    def __repr__(self) -> str:
        return "<voxmend.Field: %d x %d x %d, %s, %s>" % (*self.shape, self.kind, self.values.dtype)

    @property
    def kind(self) -> str:
        """What the numbers are, as far as the file says; "numbers" if it does not."""
        return _core.text(lib.vxm_field_kind_name(lib.vxm_field_kind_of(self._pointer)))

    @property
    def values(self) -> numpy.ndarray:
        """(nx, ny, nz), or of colours (nx, ny, nz, 4); read-only, without a copy."""
        shape = self.shape + ((4,) if lib.vxm_field_channels(self._pointer) == 4 else ())
        dtype = _scalars()[lib.vxm_field_scalar(self._pointer)]
        return _core.view(self._pointer, lib.vxm_field_values(self._pointer), shape, dtype.str)

    @property
    def shape(self) -> tuple:
        """(nx, ny, nz)"""
        return tuple(lib.vxm_field_space(self._pointer).dims)

    @property
    def origin(self) -> numpy.ndarray:
        """(3,) minimum corner of the box, model units."""
        return numpy.array(list(lib.vxm_field_space(self._pointer).origin))

    @property
    def pitch(self) -> numpy.ndarray:
        """(3,) sides of a voxel, model units."""
        return numpy.array(list(lib.vxm_field_space(self._pointer).voxel_size))

    @property
    def label_names(self) -> dict:
        """Names of labels by their numbers, where the file has a table of them."""
        count = lib.vxm_field_label_count(self._pointer)
        return {n: _core.text(lib.vxm_field_label_name(self._pointer, n)) for n in range(1, count + 1)}

    @property
    def metadata(self) -> dict:
        """What else the file says of its values, such as units."""
        return {_core.text(lib.vxm_field_metadata_key(self._pointer, n)):
                _core.text(lib.vxm_field_metadata_value(self._pointer, n))
                for n in range(lib.vxm_field_metadata_count(self._pointer))}

    @property
    def warnings(self) -> list:
        """What was odd about the file, told as VoxmendWarning too."""
        if self._told is not None:
            return list(self._told)
        return [_core.text(lib.vxm_field_warning(self._pointer, n)) for n in range(lib.vxm_field_warning_count(self._pointer))]

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

    def save(self, path: Any, format: Optional[str] = None) -> None:
        """Writes .npy, .nrrd or .vdb; labels also .binvox; colours .npy, .nrrd, .ply or .vox."""
        options = _core.new("vxm_grid_write_options")
        name = format_name("save", format)
        options.format = name
        _core.call(lib.vxm_field_write, self._pointer, _values.path(path), options, path=path)


def _restore(kind: type, made: tuple, labels: list, pairs: list, warnings: list) -> Field:
    """A field from its pickle."""
    field = kind.__new__(kind)
    Field.__init__(field, *made)
    if labels:
        counts = [numpy.count_nonzero(made[0] == n + 1) for n in range(len(labels))]
        for label, count in zip(labels, counts):
            _core.call(lib.vxm_field_add_label, field._pointer, label, count)
    for key, value in pairs:
        _core.call(lib.vxm_field_add_metadata, field._pointer, key, value)
    field._told = warnings
    return field


def read_field(path: Any) -> Field:
    """Reads the numbers of a file as they are: .npy, .nrrd, .vdb or .binvox. Bits are 0 and 1."""
    field = Field._of(_core.create("vxm_field", lib.vxm_field_read, _core.context(), _values.path(path),
                                   destroy=lib.vxm_field_destroy, path=path))
    _core.warn(["%s: %s" % (os.fsdecode(path), line) for line in field.warnings])
    return field
