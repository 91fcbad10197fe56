# SPDX-License-Identifier: BSD-3-Clause
"""The library's own memory for other packages, by DLPack, without a copy."""
from __future__ import annotations

from typing import Any, Tuple

import numpy

from ._types import Array


class _Open:
    """Memory that numpy may write to, as DLPack (before its version 1) cannot say that nobody should."""

    def __init__(self, array: Array):
        self.array = array  # which keeps its owner
        self.__array_interface__ = {"version": 3, "shape": array.shape, "typestr": array.dtype.str,
                                    "data": (array.ctypes.data, False), "strides": array.strides}


class Shared:
    """Memory of a grid, which torch.from_dlpack and numpy.from_dlpack take as it is. It stays as long as what they give.
    It must not be written to: grids and fields do not change.

    Attributes:
        array: the same, read-only.
    """

    def __init__(self, array: Array):
        self.array = array

    def __dlpack__(self, **arguments: Any) -> Any:
        """A capsule for one taker."""
        return numpy.asarray(_Open(self.array)).__dlpack__(**arguments)

    def __dlpack_device__(self) -> Tuple[int, int]:
        return 1, 0  # the CPU
