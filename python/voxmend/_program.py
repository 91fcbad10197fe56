# SPDX-License-Identifier: BSD-3-Clause
"""Where the program voxmend lies."""
from __future__ import annotations

import os
import shutil
import sys
from typing import Optional


def find() -> Optional[str]:
    """Path of the program: in the package, beside it in the folder of a build, or where it is installed."""
    here = os.path.dirname(os.path.abspath(__file__))
    for path in (os.path.join(here, "bin", "voxmend"), os.path.join(here, "..", "..", "voxmend"),
                 os.path.join(sys.prefix, "bin", "voxmend")):
        if os.path.isfile(path) and os.access(path, os.X_OK):
            return os.path.abspath(path)
    found = shutil.which("voxmend")
    return os.path.abspath(found) if found else None
