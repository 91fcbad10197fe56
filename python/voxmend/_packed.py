# SPDX-License-Identifier: BSD-3-Clause
"""Grids with eight voxels a byte: rows along z begin with a byte of their own, the first voxel in its lowest bit, as in
`Sampler.batch(dtype="bits")`."""
from __future__ import annotations

from typing import Any

import numpy

from . import _core
from ._core import lib
from ._errors import ArgumentError
from ._types import Array


def pack(matrix: Any) -> Array:
    """(..., nz) of what is 0 or not to (..., ceil(nz / 8)) uint8."""
    return numpy.packbits(numpy.asarray(matrix, numpy.bool_), axis=-1, bitorder="little")


def unpack(packed: Any, length: int, dtype: Any = numpy.float32) -> Array:
    """(..., ceil(length / 8)) uint8 to (..., length) of 0 and 1: float32, uint8 or bool."""
    bits, kind = numpy.ascontiguousarray(packed), numpy.dtype(dtype)
    if bits.dtype != numpy.uint8 or bits.ndim < 1 or length < 1 or bits.shape[-1] != (length + 7) // 8:
        raise ArgumentError("unpack: %s of %s are no rows of %d bits" % (bits.dtype, bits.shape, length))
    if kind not in (numpy.dtype(numpy.float32), numpy.dtype(numpy.uint8), numpy.dtype(numpy.bool_)):
        raise ArgumentError("unpack: to %s, which is none of float32, uint8, bool" % kind)
    out = numpy.empty(bits.shape[:-1] + (length,), kind)
    rows = out.size // length
    lib.voxmend_unpack_rows(_core.pointer("void *", out), _core.pointer("unsigned char *", bits), rows, length,
                            kind.itemsize == 4)
    return out
