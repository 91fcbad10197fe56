# SPDX-License-Identifier: BSD-3-Clause
"""One thread at a time, and what a fork leaves of that."""
from __future__ import annotations

import os
import threading
import weakref
from typing import Any

from ._errors import BusyError


class CallLock:
    """Lets one thread at a time in, others wait; a thread that is inside already is refused rather than stuck."""

    def __init__(self) -> None:
        self._lock, self._holder = threading.Lock(), 0

    def __enter__(self) -> None:
        if self._holder == threading.get_ident():
            raise BusyError("the object is at work for this very thread, whose signal handler asks it for more")
        self._lock.acquire()
        self._holder = threading.get_ident()

    def __exit__(self, *_: Any) -> None:
        self._holder = 0
        self._lock.release()

    def is_taken(self) -> bool:
        return self._lock.locked()


_living: "weakref.WeakSet[Any]" = weakref.WeakSet()


def watch_forks(holder: Any) -> None:
    """Has holder._after_fork called in a process that a fork makes."""
    _living.add(holder)


def _after_fork() -> None:
    for holder in list(_living):
        holder._after_fork()


os.register_at_fork(after_in_child=_after_fork)
