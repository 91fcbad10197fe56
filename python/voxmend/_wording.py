# SPDX-License-Identifier: BSD-3-Clause
"""Advice of the library names options of the command line; here it names what a Python program has instead."""
from __future__ import annotations

import re

_PHRASES = (
    ("make them so with 'voxmend convert --threshold' or '--below' (in C vxm_field_read, vxm_field_threshold)",
     "at_least= or below= of voxmend.read makes them so, and voxmend.read_field reads the numbers"),
    ("give it with vxm_sampler_put first", "give it with Sampler.put first"),
    ("vxm_sampler_batch alone gives", "Sampler.batch alone gives"),
    ("resolution (-r)", "resolution"),
    ("'voxmend repair --level closed'", "voxmend.repair(level=\"closed\")"),
    ("'voxmend remesh'", "voxmend.remesh"),
    ("look at it with 'view'", "look at it with show()"),
    ("--distance unsigned", "unsigned=True"),
    ("--confidence tells", "confidence=True tells"),
    ("--memlimit", "voxmend.configure(memory_limit=...)"),
)

# An option that is a parameter too, and its value where that is one word of a choice. Others stay as they are.
_OPTION = re.compile(r"(?<![\w-])--(bounds|engine|external|fill|fill-holes|fit|level|like|max-change|method|pad|parts|thin|vote)\b(?!-)"
                     r"(?: (keep|drop|auto|cpu|none|any|fan|clean|manifold|closed|winding|tetra|majority|whole|group)\b)?")


def in_python(line: str) -> str:
    """The line as a Python program's user has use for it: `--thin keep` is `thin="keep"`, `--bounds` is `bounds=`."""
    for option, name in _PHRASES:
        line = line.replace(option, name)

    def parameter(found: re.Match[str]) -> str:
        name, value = found[1].replace("-", "_"), found[2]
        return '%s="%s"' % (name, value) if value else name + "="

    return _OPTION.sub(parameter, line)
