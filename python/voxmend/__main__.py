# SPDX-License-Identifier: BSD-3-Clause
"""python3 -m voxmend: the command line."""
from __future__ import annotations

import os
import sys

from . import _program

program = _program.find()
if program is None:
    sys.exit("voxmend: the program voxmend is neither beside the package nor on the PATH")
sys.stdout.flush()
os.execv(program, ["voxmend", *sys.argv[1:]])
