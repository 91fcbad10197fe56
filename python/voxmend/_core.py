# SPDX-License-Identifier: BSD-3-Clause
"""Calling the library: its context, its objects and arrays, and how Ctrl-C ends a call."""
from __future__ import annotations

import contextlib
import sys
import threading
import warnings
from types import FrameType
from typing import Any, Iterable, Iterator, Optional, Tuple

import numpy

from . import _errors, _values
from ._errors import ArgumentError, VoxmendWarning
from ._records import Settings
from ._types import Array
from ._wording import in_python

try:
    from ._voxmend import ffi as ffi, lib as lib
except ImportError as problem:
    if "libvoxmend" not in str(problem):
        raise
    raise ImportError("%s: the library of the package voxmend is not where the system looks for libraries; run ldconfig "
                      "after 'make install', set LD_LIBRARY_PATH to its folder, or install the package anew with "
                      "VOXMEND_RPATH=1 to remember the folder" % problem) from None


def text(pointer: Any) -> str:
    """A string of the library."""
    out: bytes = ffi.string(pointer)
    return out.decode("utf-8", "replace")


def new(name: str, **values: Any) -> Any:
    """A struct with its defaults, then some of its fields set."""
    out = ffi.new(name + " *")
    getattr(lib, "voxmend_init_" + name)(out)
    for key, value in values.items():
        setattr(out, key, value)
    return out


# ---- Failures ----

_classes = {
    lib.VXM_ERROR_ARGUMENT: _errors.ArgumentError,
    lib.VXM_ERROR_IO: _errors.FileError,
    lib.VXM_ERROR_FORMAT: _errors.FormatError,
    lib.VXM_ERROR_EMPTY: _errors.EmptyError,
    lib.VXM_ERROR_MEMORY: _errors.OutOfMemoryError,
    lib.VXM_ERROR_MEMORY_LIMIT: _errors.OutOfMemoryError,
    lib.VXM_ERROR_RANGE: _errors.RangeError,
    lib.VXM_ERROR_UNAVAILABLE: _errors.UnavailableError,
    lib.VXM_ERROR_UNREACHED: _errors.UnreachedError,
    lib.VXM_ERROR_CANCELLED: _errors.CancelledError,
    lib.VXM_ERROR_NUMBERS: _errors.NumbersError,
}


def failure(status: int, error: Any, path: Any = None) -> _errors.VoxmendError:
    """The exception for what a call has failed with; `path` is what the caller named a file by."""
    message, file = text(error.text), ffi.string(error.file)
    if status == lib.VXM_ERROR_IO:
        made: _errors.VoxmendError = _errors.file_error(message, error.system, file, path)
    else:
        made = _classes.get(status, _errors.VoxmendError)(in_python(message))
    made.status = text(lib.vxm_status_name(status))
    made.file = file.decode("utf-8", "replace")
    made.line, made.offset, made.element = error.line, error.offset, error.element
    return made


def timeout() -> _errors.VoxmendTimeout:
    made = _errors.VoxmendTimeout("the time is up: the call was stopped before it was done")
    made.status = text(lib.vxm_status_name(lib.VXM_ERROR_CANCELLED))
    return made


# ---- Calls, and what interrupts them ----

class _Interrupt(threading.local):
    """What a signal handler of Python raised while the library worked: KeyboardInterrupt for one."""
    raised: Optional[BaseException] = None


_interrupt = _Interrupt()


def keep_raised(kind: Any, raised: BaseException, traceback: Any) -> None:
    """What a callback raised ends the call that it serves, which raises it again."""
    _interrupt.raised = raised


def _ask() -> int:
    """Called by the library now and then in the main thread: handlers of signals run here."""
    for _ in (0,):  # the interpreter looks for signals where a loop begins anew
        pass
    return 0


ffi.def_extern("voxmend_ask", error=1, onerror=keep_raised)(_ask)


def call(function: Any, *arguments: Any, path: Any = None) -> None:
    """Calls a function whose last argument is a vxm_error. Other Python threads run meanwhile; in the main thread handlers
    of signals do, and what one raises ends the call."""
    error = new("vxm_error")
    if lib.voxmend_is_late():
        raise timeout()
    before = lib.voxmend_enter(threading.get_ident() == threading.main_thread().ident)
    try:
        status = function(*arguments, error)
    finally:
        lib.voxmend_leave(before)
    raised, _interrupt.raised = _interrupt.raised, None
    if raised is not None:
        raise raised
    if status == lib.VXM_ERROR_CANCELLED and lib.voxmend_timed_out():
        raise timeout()
    if status != lib.VXM_OK:
        raise failure(status, error, path)


def create(type_name: str, function: Any, *arguments: Any, destroy: Any, path: Any = None) -> Any:
    """Calls a function that makes an object, which is destroyed when Python drops it."""
    out = ffi.new(type_name + " **")
    try:
        call(function, out, *arguments, path=path)
        return ffi.gc(out[0], destroy)
    except BaseException:  # of a handler of signals, as the call came to its end
        if out[0] != ffi.NULL:
            destroy(out[0])
        raise


@contextlib.contextmanager
def stoppable(flag: Any) -> Iterator[None]:
    """Calls of this thread end with CancelledError once the flag, of ffi.new("int *"), is not 0."""
    before = lib.voxmend_stop_at(flag)
    try:
        yield
    finally:
        lib.voxmend_stop_at(before)


def warn(lines: Iterable[str]) -> None:
    """Tells the warnings of an object, as from the line of the user's program that asked for it."""
    lines = list(lines)
    if not lines:
        return
    level = 1
    frame: Optional[FrameType] = sys._getframe()
    while frame is not None and frame.f_globals.get("__name__", "").split(".")[0] == "voxmend":
        level, frame = level + 1, frame.f_back
    for line in lines:
        warnings.warn(in_python(line), VoxmendWarning, stacklevel=level)


# ---- The context ----

_context: Any = None


def context() -> Any:
    """The context of all objects: its threads, and its memory limit."""
    if _context is None:
        configure()
    return _context


def configure(threads: int = 0, memory_limit: int = 0) -> None:
    """Chooses how objects made from now on work; `settings` tells what is chosen.

    Args:
        threads: threads that a call works with; 0 = one per processor.
        memory_limit: bytes that all objects may hold together; 0 = what the machine has. What would exceed it raises OutOfMemoryError
            before it is allocated. Arrays of numpy are not counted.
    """
    global _context, _memory_limit
    options = new("vxm_context_options", threads=_values.whole("configure: threads", threads, 0, 0x7FFFFFFF),
                  memory_limit=_values.whole("configure: memory_limit", memory_limit, 0, 0xFFFFFFFFFFFFFFFF))
    options.progress = ffi.addressof(lib, "voxmend_on_progress")
    _context = create("vxm_context", lib.vxm_context_create, options, destroy=lib.vxm_context_destroy)
    _memory_limit = int(options.memory_limit)


_memory_limit = 0


def settings() -> Settings:
    """How many threads and bytes `configure` allows, and the most bytes that were held at once since."""
    at = context()
    return Settings(int(lib.vxm_context_threads(at)), _memory_limit, int(lib.vxm_context_peak_bytes(at)))


# ---- Arrays ----

class _Holder:
    """Memory of the library that numpy looks at; it holds the object to which it belongs."""

    def __init__(self, owner: Any, address: int, shape: Tuple[int, ...], kind: str, strides: Optional[Tuple[int, ...]] = None):
        self.owner = owner
        self.__array_interface__ = {"version": 3, "shape": shape, "typestr": kind, "data": (address, True), "strides": strides}


def view(owner: Any, pointer: Any, shape: Tuple[int, ...], kind: str) -> Array:
    """A read-only array over the library's memory, without a copy, which keeps its owner alive."""
    if pointer == ffi.NULL or 0 in shape:
        out = numpy.zeros(shape, kind)
        out.flags.writeable = False
        return out
    return numpy.asarray(_Holder(owner, int(ffi.cast("uintptr_t", pointer)), shape, kind))


def read_only(array: Array) -> Array:
    """The same memory, which nobody can make writeable again."""
    if array.size == 0:
        return array
    return numpy.asarray(_Holder(array, array.ctypes.data, array.shape, array.dtype.str, array.strides))


def pointer(kind: str, array: Array) -> Any:
    """What C sees of an array; the caller keeps the array until the call is over."""
    return ffi.cast(kind, array.ctypes.data)


_LONG_NAMES = {"VXM_THIN_26": "VXM_THIN_KEEP26"}  # the command has the short ones
_SHORT_NAMES = {long: short for short, long in _LONG_NAMES.items()}


def choice(name: str, value: str, prefix: str) -> int:
    """The number of an enum's value by its name, such as "cube" of VXM_FIT_."""
    wanted = prefix + _values.word(name, value).upper()
    number = getattr(lib, _LONG_NAMES.get(wanted, wanted), None)
    if not isinstance(number, int):
        names = [_SHORT_NAMES.get(n, n)[len(prefix):].lower() for n in dir(lib)
                 if n.startswith(prefix) and not n.endswith("_KINDS")]
        raise ArgumentError("%s %r is none of %s" % (name, value, ", ".join(sorted(names))))
    return number
