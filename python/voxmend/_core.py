# SPDX-License-Identifier: BSD-3-Clause
"""Errors, the context, and how C and Python see each other's values."""
from __future__ import annotations

import os
from typing import Any, Optional

import numpy

from ._voxmend import ffi, lib


class VoxmendError(Exception):
    """A call that failed, with the library's own text.

    Attributes:
        status: short fixed name of the failure, such as "format".
        file: file concerned, or "".
        line: line in a text file, or 0.
        offset: byte in a binary file, or -1.
        element: vertex, face or record, or -1.
    """

    status: str = ""
    file: str = ""
    line: int = 0
    offset: int = -1
    element: int = -1


class ArgumentError(VoxmendError, ValueError):
    """An argument is out of its range."""


class FileError(VoxmendError, OSError):
    """The system refused to open, read, write or rename."""


class FormatError(VoxmendError, ValueError):
    """The content is not a known format, or is damaged beyond reading."""


class NumbersError(FormatError):
    """The file holds numbers, not set and clear voxels: `voxmend.read_field` reads them."""


class EmptyError(VoxmendError, ValueError):
    """There is nothing to work on."""


class OutOfMemoryError(VoxmendError, MemoryError):
    """The system has no memory left, or the limit would be exceeded."""


class RangeError(VoxmendError, ValueError):
    """A size or coordinate is beyond what can be computed."""


class UnavailableError(VoxmendError, NotImplementedError):
    """The library was built without what this needs."""


class UnreachedError(VoxmendError, RuntimeError):
    """A repair did not come as far as it was asked to."""


_classes = {
    lib.VXM_ERROR_ARGUMENT: ArgumentError,
    lib.VXM_ERROR_IO: FileError,
    lib.VXM_ERROR_FORMAT: FormatError,
    lib.VXM_ERROR_EMPTY: EmptyError,
    lib.VXM_ERROR_MEMORY: OutOfMemoryError,
    lib.VXM_ERROR_MEMORY_LIMIT: OutOfMemoryError,
    lib.VXM_ERROR_RANGE: RangeError,
    lib.VXM_ERROR_UNAVAILABLE: UnavailableError,
    lib.VXM_ERROR_UNREACHED: UnreachedError,
    lib.VXM_ERROR_NUMBERS: NumbersError,
}


def text(pointer: Any) -> str:
    """A string of the library."""
    return ffi.string(pointer).decode("utf-8", "replace")


def new(name: str, **values: Any) -> Any:
    """A struct with its defaults, then some of its fields set."""
    out = ffi.new(name + " *")
    getattr(lib, "voxmend_init_" + name)(out)
    for key, value in values.items():
        setattr(out, key, value)
    return out


def check(status: int, error: Any) -> None:
    """Raises what a call has failed with."""
    if status == lib.VXM_OK:
        return
    made = _classes.get(status, VoxmendError)(text(error.text))
    made.status = text(lib.vxm_status_name(status))
    made.file = text(error.file)
    made.line, made.offset, made.element = error.line, error.offset, error.element
    raise made


def call(function: Any, *arguments: Any) -> None:
    """Calls a function whose last argument is a vxm_error. Other Python threads run meanwhile."""
    error = new("vxm_error")
    check(function(*arguments, error), error)


def create(type_name: str, function: Any, *arguments: Any, destroy: Any) -> Any:
    """Calls a function that makes an object, which is destroyed when Python drops it."""
    out = ffi.new(type_name + " **")
    call(function, out, *arguments)
    return ffi.gc(out[0], destroy)


_context: Any = None


def context() -> Any:
    """The context of all objects: its threads, and its memory limit."""
    global _context
    if _context is None:
        configure()
    return _context


def configure(threads: int = 0, memory_limit: int = 0) -> None:
    """Chooses how objects made from now on work.

    Args:
        threads: threads that a call works with; 0 = one per processor.
        memory_limit: bytes that all objects may hold together; 0 = no limit.
    """
    global _context
    options = new("vxm_context_options", threads=threads, memory_limit=memory_limit)
    _context = create("vxm_context", lib.vxm_context_create, options, destroy=lib.vxm_context_destroy)


def path_bytes(path: Any) -> bytes:
    return os.fsencode(os.fspath(path))


class _Holder:
    """Memory of the library that numpy looks at; it holds the object to which it belongs."""

    def __init__(self, owner: Any, pointer: Any, shape: tuple, kind: str, strides: Optional[tuple]):
        self.owner = owner
        self.__array_interface__ = {
            "version": 3, "shape": shape, "typestr": kind, "strides": strides,
            "data": (int(ffi.cast("uintptr_t", pointer)), True)}


def view(owner: Any, pointer: Any, shape: tuple, kind: str, strides: Optional[tuple] = None) -> numpy.ndarray:
    """A read-only array over the library's memory, without a copy, which keeps its owner alive."""
    if pointer == ffi.NULL or 0 in shape:
        return numpy.zeros(shape, kind)
    return numpy.asarray(_Holder(owner, pointer, shape, kind, strides))


def choice(value: str, prefix: str) -> int:
    """The number of an enum's value by its name, such as "cube" of VXM_FIT_."""
    number = getattr(lib, prefix + str(value).upper(), None)
    if number is None:
        names = [n[len(prefix):].lower() for n in dir(lib) if n.startswith(prefix) and not n.endswith("_KINDS")]
        raise ArgumentError("%r is none of %s" % (value, ", ".join(sorted(names))))
    return number


def fields(struct: Any) -> dict:
    """A struct of numbers as a dict; arrays become tuples."""
    out = {}
    for name, field in ffi.typeof(struct).fields:
        value = getattr(struct, name)
        out[name] = tuple(value) if field.type.kind == "array" else value
    return out
