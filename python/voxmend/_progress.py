# SPDX-License-Identifier: BSD-3-Clause
"""How far a call is, and when it has to be over."""
from __future__ import annotations

import contextlib
import threading
from typing import Any, Callable, Iterator, List, Optional

from . import _core, _values
from ._core import ffi, lib
from ._errors import KindError, UnavailableError
from ._types import Progress


class _Listeners(threading.local):
    """Whom the calls of this thread tell how far they are: the last one of them."""

    def __init__(self) -> None:
        self.told: List[Callable[[str, float], object]] = []


_listeners = _Listeners()


def _tell(phase: Any, fraction: float) -> int:
    """Called by the library now and then, in the thread that made the call."""
    if _listeners.told:
        _listeners.told[-1](_core.text(phase), min(max(fraction, 0.0), 1.0))
    return 0


ffi.def_extern("voxmend_tell", error=1, onerror=_core.keep_raised)(_tell)


class _Bar:
    """A bar of tqdm, anew for each phase."""

    def __init__(self) -> None:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            raise UnavailableError("progress: tqdm is not installed (Debian: python3-tqdm; PyPI: tqdm); give a function of "
                                   "(phase, fraction) instead of True") from None
        self._phase = ""
        self._bar: Any = tqdm(total=100, unit="%", leave=False, bar_format="{desc} {percentage:3.0f}% |{bar}| {elapsed}")

    def __call__(self, phase: str, fraction: float) -> None:
        done = int(100 * fraction)
        if phase != self._phase or done < self._bar.n:
            self._phase = phase
            self._bar.reset()
            self._bar.set_description_str(phase, refresh=False)
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        self._bar.close()


@contextlib.contextmanager
def _telling(listener: Callable[[str, float], object]) -> Iterator[None]:
    _listeners.told.append(listener)
    before = lib.voxmend_tell_progress(1)
    try:
        yield
    finally:
        lib.voxmend_tell_progress(before)
        _listeners.told.pop()


@contextlib.contextmanager
def _ending(timeout: float) -> Iterator[None]:
    seconds = _values.real("timeout", timeout, 0)
    at = max(1, lib.voxmend_now_ms() + int(min(1000 * seconds, 2.0 ** 60)))
    before = lib.voxmend_set_deadline(at)
    if 0 < before < at:  # one around this ends sooner
        lib.voxmend_set_deadline(before)
    try:
        yield
    finally:
        lib.voxmend_set_deadline(before)


@contextlib.contextmanager
def watch(progress: Progress = None, timeout: Optional[float] = None) -> Iterator[None]:
    """For all calls of this thread within a `with`: how far they are is told, and they end in time.

        with voxmend.watch(progress=True, timeout=60):
            mesh = voxmend.load("chair.off").repair("closed")

    Args:
        progress: True for a bar of tqdm (UnavailableError where that is not installed), or a function that is called with
            the name of a phase and the fraction of it that is done, 0 to 1, some 20 times a second; what it raises ends
            the call, which raises it again.
        timeout: seconds from now on; then VoxmendTimeout is raised, and nothing is made. It is looked at where the library
            works, mostly within 0.1 seconds.
    """
    with contextlib.ExitStack() as stack:
        if timeout is not None:
            stack.enter_context(_ending(timeout))
        if progress is True:
            bar = _Bar()
            stack.callback(bar.close)
            stack.enter_context(_telling(bar))
        elif callable(progress):
            stack.enter_context(_telling(progress))
        elif progress is not None and progress is not False:
            raise KindError("progress is %s, which is neither True, False, None nor a function" % type(progress).__name__)
        yield
