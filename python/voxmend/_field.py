# SPDX-License-Identifier: BSD-3-Clause
"""Numbers, labels and colours of voxels in files."""
from __future__ import annotations

from typing import Any, Optional, Sequence, Union

import numpy

from . import _core
from ._core import ffi, lib
from ._grid import VoxelGrid, _space

_KINDS = ("numbers", "distance", "coverage", "labels", "confidence", "colors")


def _scalars() -> dict:
    """numpy's types by the library's numbers."""
    names = [n for n in dir(lib) if n.startswith(("VXM_FLOAT", "VXM_UINT", "VXM_INT"))]
    return {getattr(lib, n): numpy.dtype(n[4:].lower()) for n in names}


class Field:
    """A number (or colour) for each voxel of a box, as a file has them. It does not change once it is made.

    Args:
        values: (nx, ny, nz) array of integers or floats, or (nx, ny, nz, 4) uint8 of colours.
        pitch: side of a voxel in model units, one number or three.
        origin: minimum corner of the box, model units.
        kind: "numbers", "distance", "coverage", "labels", "confidence" or "colors"; goes along into files.
    """

    def __init__(self, values: Any, pitch: Union[float, Sequence[float]] = 1.0, origin: Sequence[float] = (0.0, 0.0, 0.0),
                 kind: str = "numbers"):
        array = numpy.asarray(values)
        if array.dtype == bool:
            array = array.view(numpy.uint8)
        kinds = {dtype: number for number, dtype in _scalars().items()}
        native = array.dtype.newbyteorder("=")
        if kind not in _KINDS:
            raise _core.ArgumentError("field: %r is none of %s" % (kind, ", ".join(_KINDS)))
        if native not in kinds:
            raise _core.ArgumentError("field: values of type %s are neither integers nor floats of 16 to 64 bits" % array.dtype)
        expected = 4 if kind == "colors" else 3
        if array.ndim != expected or (expected == 4 and array.shape[3] != 4):
            raise _core.ArgumentError("field: values of shape %r are not those of %s" % (array.shape, kind))
        plain = numpy.ascontiguousarray(array, native)
        self._pointer = _core.create("vxm_field", lib.vxm_field_create, _core.context(),
                                     _space(plain.shape[:3], origin, numpy.broadcast_to(pitch, 3)), _KINDS.index(kind),
                                     kinds[native], ffi.cast("void *", plain.ctypes.data), destroy=lib.vxm_field_destroy)

    @classmethod
    def _of(cls, pointer: Any) -> "Field":
        self = cls.__new__(cls)
        self._pointer = pointer
        return self

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
        return _core.view(self, lib.vxm_field_values(self._pointer), shape, dtype.str)

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
        """What was odd about the file."""
        return [_core.text(lib.vxm_field_warning(self._pointer, n)) for n in range(lib.vxm_field_warning_count(self._pointer))]

    def threshold(self, at_least: Optional[float] = None, below: Optional[float] = None) -> VoxelGrid:
        """A grid in which voxels are set whose number is `at_least` one number, `below` another, or both.

        `below=0` of a signed distance is the solid, -0 included. What is not a number is never set.
        """
        options = _core.new("vxm_threshold_options", use_at_least=at_least is not None, at_least=at_least or 0.0,
                            use_below=below is not None, below=below or 0.0)
        return VoxelGrid._of(_core.create("vxm_grid", lib.vxm_field_threshold, self._pointer, options,
                                          destroy=lib.vxm_grid_destroy))

    def save(self, path: Any, format: Optional[str] = None) -> None:
        """Writes .npy, .nrrd or .vdb; labels also .binvox; colours .npy, .nrrd, .ply or .vox."""
        options = _core.new("vxm_grid_write_options")
        name = ffi.new("char[]", format.encode()) if format else ffi.NULL
        options.format = name
        _core.call(lib.vxm_field_write, self._pointer, _core.path_bytes(path), options)


def read_field(path: Any) -> Field:
    """Reads the numbers of a file as they are: .npy, .nrrd, .vdb or .binvox. Bits are 0 and 1."""
    return Field._of(_core.create("vxm_field", lib.vxm_field_read, _core.context(), _core.path_bytes(path),
                                  destroy=lib.vxm_field_destroy))
