# SPDX-License-Identifier: BSD-3-Clause
"""What makes the bits: the CPU, or a device by OpenCL or OpenGL."""
from __future__ import annotations

import contextlib
import dataclasses
from typing import Any, Dict, Iterator, List, Optional, Tuple, Union

from . import _core, _values
from ._call_lock import CallLock, watch_forks
from ._core import ffi, lib
from ._errors import ArgumentError, KindError
from ._records import EngineInfo


def _info(struct: Any) -> EngineInfo:
    texts = {f.name: _core.text(getattr(struct, f.name)) for f in dataclasses.fields(EngineInfo) if str(f.type) == "str"}
    return EngineInfo._of(struct, **texts)


def engines() -> List[EngineInfo]:
    """Every engine that this build knows, each tried out: "cpu", and devices of OpenCL and OpenGL by their names."""
    count = ffi.new("int64_t *")
    _core.call(lib.vxm_engines_find, ffi.NULL, 0, count)
    found = ffi.new("vxm_engine_info[]", int(count[0]))
    for one in found:
        lib.voxmend_init_vxm_engine_info(ffi.addressof(one))
    _core.call(lib.vxm_engines_find, found, len(found), count)
    return [_info(one) for one in found]


class Engine:
    """An engine that is kept and used again, with its options. Where a name alone does, `engine="opencl"` is enough.

    Threads take turns. A process that a fork makes opens the device anew.

    Args:
        name: "cpu"; "opencl"; "opengl"; one of them by the name that `engines` gives; several that work at once, joined by
            "+", or "opencl:all"; "auto": a GPU that works, else, and wherever it fails later, the CPU.
        device: OpenCL: the number of a device, or a part of its name or its platform's.
        gl_method: "columns", with the bits of the CPU; "slices" or "tetra_vertex", as published.
        cl_method: "auto", "triangles" or "tiles"; all have the bits of the CPU.
        slice_axis: "x", "y" or "z": across which the published methods cut.
        displacement, seed: the published methods move each vertex at random by up to so many voxels.

    Raises:
        UnavailableError: with what is missing.
    """

    def __init__(self, name: str = "auto", *, device: Optional[str] = None, gl_method: str = "columns", cl_method: str = "auto",
                 slice_axis: str = "y", displacement: float = 0.0, seed: int = 0):
        if _values.word("engine: slice_axis", slice_axis) not in ("x", "y", "z"):
            raise ArgumentError("engine: slice_axis %r is none of x, y, z" % slice_axis)
        options = _core.new("vxm_engine_options", gl_method=_core.choice("engine: gl_method", gl_method, "VXM_GL_"),
                            cl_method=_core.choice("engine: cl_method", cl_method, "VXM_CL_"),
                            slice_axis="xyz".index(slice_axis),
                            displacement=_values.real("engine: displacement", displacement, 0),
                            seed=_values.whole("engine: seed", seed, 0, 0xFFFFFFFFFFFFFFFF))
        self._name = ffi.new("char[]", _values.word("engine: name", name).encode())
        self._device = ffi.NULL if device is None else ffi.new("char[]", _values.word("engine: device", device).encode())
        options.device = self._device
        self._options = options
        self._made: Any = None
        self._call_lock = CallLock()
        watch_forks(self)
        self._ready()

    def __repr__(self) -> str:
        return "<voxmend.Engine: %s>" % self.info.name

    def _ready(self) -> Any:
        if self._made is None:
            self._made = _core.create("vxm_engine", lib.vxm_engine_create, _core.context(), self._name, self._options,
                                      destroy=lib.vxm_engine_destroy)
        return self._made

    def _after_fork(self) -> None:
        """What the driver holds belongs to the other process: it is left as it is."""
        if self._made is not None:
            ffi.gc(self._made, None)
            self._made = None
        self._call_lock = CallLock()

    @property
    def info(self) -> EngineInfo:
        """What it is; `note` tells what was taken in its place, and why."""
        return _info(lib.vxm_engine_describe(self._ready()))

    @contextlib.contextmanager
    def _in_use(self) -> Iterator[Any]:
        with self._call_lock:
            yield self._ready()


EngineLike = Union[str, Engine, None]

_by_name: Dict[str, Tuple[Any, Engine]] = {}  # and the context that each was made in


def _named(name: str) -> Engine:
    context, found = _by_name.get(name, (None, None))
    if found is None or context is not _core.context():
        found = Engine(name)
        _by_name[name] = _core.context(), found
    return found


@contextlib.contextmanager
def used(engine: EngineLike) -> Iterator[Tuple[Any, Optional[Engine]]]:
    """What C takes for an engine, for one call, and which it is: none for the CPU. A name stands for one that is kept."""
    if engine is None or (isinstance(engine, str) and engine == "cpu"):
        yield ffi.NULL, None
        return
    if not isinstance(engine, (str, Engine)):
        raise KindError("engine is %s, neither a name nor an Engine" % type(engine).__name__)
    one = engine if isinstance(engine, Engine) else _named(engine)
    with one._in_use() as made:
        yield made, one


__all__ = ["Engine", "EngineInfo", "EngineLike", "engines", "used"]
