# SPDX-License-Identifier: BSD-3-Clause
"""Names of types that signatures share."""
from __future__ import annotations

import os
from typing import Any, Callable, Sequence, Tuple, Union

import numpy
import numpy.typing

Array = numpy.typing.NDArray[Any]
Bools = numpy.typing.NDArray[numpy.bool_]
Floats = numpy.typing.NDArray[numpy.float64]
Int32s = numpy.typing.NDArray[numpy.int32]
Int64s = numpy.typing.NDArray[numpy.int64]
Uint8s = numpy.typing.NDArray[numpy.uint8]
Uint32s = numpy.typing.NDArray[numpy.uint32]
Uint64s = numpy.typing.NDArray[numpy.uint64]
ArrayLike = numpy.typing.ArrayLike

Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]
Shape = Tuple[int, int, int]
Size = Union[float, Sequence[float], Floats]  # one number or three
Resolution = Union[int, Sequence[int], Int64s]  # one number or three

# True for a bar of tqdm, or what is called with the name of a phase and the fraction of it that is done.
Progress = Union[bool, Callable[[str, float], object], None]
