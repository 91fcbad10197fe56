# SPDX-License-Identifier: BSD-3-Clause
# The binding, which cffi makes of voxmend.h: its types are not Python's, and stay within the package.
from typing import Any

ffi: Any
lib: Any
