# SPDX-License-Identifier: BSD-3-Clause
"""What callers hand in: numbers, words, paths and arrays, refused where they are of a wrong kind.

numpy's scalars and arrays of no dimension are numbers too. Truth values are not: True as a resolution is a slip.
"""
from __future__ import annotations

import math
import operator
import os
from typing import Any, Optional, Tuple

import numpy

from ._errors import ArgumentError, KindError
from ._types import Array, Floats

INT64_MAX = (1 << 63) - 1
DIM_MAX = 1 << 20  # voxels along an axis


def _shown(value: Any) -> str:
    """On one line, and not too long a one."""
    out = " ".join(repr(value).split())
    return out if len(out) <= 80 else out[:77] + "..."


def _is_truth(value: Any) -> bool:
    return isinstance(value, (bool, numpy.bool_)) or getattr(value, "dtype", None) == numpy.bool_


def whole(name: str, value: Any, least: int = -INT64_MAX - 1, most: int = INT64_MAX) -> int:
    """A whole number from `least` to `most`."""
    try:
        if _is_truth(value):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        raise KindError("%s is %s, which is not a whole number" % (name, _shown(value))) from None
    if not least <= number <= most:
        raise ArgumentError("%s is %s, which is not from %d to %d" % (name, _shown(number), least, most))
    return number


def real(name: str, value: Any, least: float = -math.inf) -> float:
    """A finite number, not below `least`."""
    array = None if isinstance(value, (str, bytes)) or _is_truth(value) else numpy.asarray(value)
    if array is None or array.ndim != 0 or array.dtype.kind not in "iuf":
        if not isinstance(value, int) or _is_truth(value):  # one beyond 64 bits is an object to numpy
            raise KindError("%s is %s, which is not a number" % (name, _shown(value)))
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number) or number < least:
        raise ArgumentError("%s is %s, which is not a finite number%s" %
                            (name, _shown(value), "" if least == -math.inf else " from %g on" % least))
    return number


def flag(name: str, value: Any) -> bool:
    """True or False, as numpy's too, or 1 or 0."""
    if _is_truth(value) and numpy.ndim(value) == 0:
        return bool(value)
    try:
        number = operator.index(value)
    except TypeError:
        number = -1
    if number not in (0, 1):
        raise KindError("%s is %s, which is neither True nor False" % (name, _shown(value)))
    return bool(number)


def word(name: str, value: Any) -> str:
    """A string that C sees whole."""
    if not isinstance(value, str):
        raise KindError("%s is %s, which is not a string" % (name, _shown(value)))
    if "\0" in value:
        raise ArgumentError("%s %r has a NUL in it" % (name, value))
    return value


def path(value: Any) -> bytes:
    """str, bytes or os.PathLike as the system's bytes."""
    try:
        out = os.fsencode(value)
    except TypeError:
        raise KindError("the path is %s, which is not str, bytes or os.PathLike" % _shown(value)) from None
    except UnicodeError:
        raise ArgumentError("the path %s cannot be a name in this system's encoding" % ascii(value)) from None
    if b"\0" in out:
        raise ArgumentError("the path %s has a NUL in it" % _shown(value))
    return out


def array(name: str, value: Any, kinds: str, wanted: str) -> Array:
    """An array whose type is of one of the kinds (numpy's letters), of any shape, byte order and layout."""
    try:
        out = numpy.asarray(value)
    except ValueError:
        raise ArgumentError("%s: rows of different lengths are no array" % name) from None
    if numpy.ma.is_masked(value):
        raise ArgumentError("%s: the array has masked values, which would be taken for valid ones" % name)
    if out.size == 0 and out.dtype == numpy.float64:  # an empty list
        return out
    if out.dtype.kind not in kinds:
        raise KindError("%s: an array of %s, not of %s" % (name, out.dtype, wanted))
    return out


def reals(name: str, value: Any, shape: Optional[Tuple[int, ...]] = None) -> Floats:
    """A C-contiguous float64 array of finite numbers, broadcast to a shape if one is given."""
    out = numpy.ascontiguousarray(array(name, value, "iuf", "numbers"), numpy.float64)
    if not numpy.isfinite(out).all():
        raise ArgumentError("%s: not all numbers are finite" % name)
    if shape is not None:
        try:
            out = numpy.ascontiguousarray(numpy.broadcast_to(out, shape))
        except ValueError:
            raise ArgumentError("%s: shape %s is not %s" % (name, numpy.shape(value), shape)) from None
    return out


def wholes(name: str, value: Any, least: int, most: int) -> Array:
    """An array of whole numbers from `least` to `most`."""
    out = array(name, value, "iu", "whole numbers")
    if out.size and (out.min() < least or out.max() > most):
        raise ArgumentError("%s: not all are from %d to %d" % (name, least, most))
    return out
