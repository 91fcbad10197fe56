# SPDX-License-Identifier: BSD-3-Clause
"""What datasets do about files that cannot be read."""
from __future__ import annotations

import contextlib
from typing import Any, Iterator, Set

from . import _core, _values
from ._errors import ArgumentError, CancelledError, EmptyError, FormatError, RangeError, UnavailableError, UnreachedError

# What lies with a file; not what lies with the caller, or with this machine's memory.
_OF_FILES = (EmptyError, FormatError, OSError, RangeError, UnavailableError, UnreachedError)


def check_on_error(caller: str, value: Any) -> str:
    if _values.word(caller + ": on_error", value) not in ("raise", "skip"):
        raise ArgumentError("%s: on_error %r is neither raise nor skip" % (caller, value))
    return str(value)


@contextlib.contextmanager
def left_out(name: str, known: Set[int], number: int) -> Iterator[None]:
    """Adds a number to those that are known, with a warning, where a file cannot be read within."""
    try:
        yield
    except CancelledError:  # which a timeout is, and that an OSError
        raise
    except _OF_FILES as problem:
        known.add(number)
        told = str(problem)
        _core.warn(["%s; it is left out" % (told if name in told else "%s: %s" % (name, told))])
