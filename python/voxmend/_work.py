# SPDX-License-Identifier: BSD-3-Clause
"""What making voxels of a mesh takes: the mesh, repaired, where the voxels lie, the rules, and an engine."""
from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import Any, List, Optional

from . import _core, _values
from ._core import ffi, lib
from ._engines import Engine, EngineLike, used
from ._mesh import Mesh
from ._mesh_sources import MeshLike, as_mesh
from ._progress import watch
from ._records import VoxelizeReport
from ._repair import repair as repair_mesh
from ._space import Place
from ._types import Progress


@dataclass
class Rules:
    """Which voxels are set."""

    mode: str = "solid"
    surface: str = "conservative"
    method: str = "vote"
    vote: str = "auto"
    parts: str = "auto"
    cavities: str = "auto"
    thin: str = "auto"
    confidence: bool = False

    def options(self, caller: str) -> Any:
        out = _core.new("vxm_voxelize_options")
        for name in ("mode", "surface", "method", "vote", "parts", "cavities", "thin"):
            field = "split_mode" if name == "parts" else name
            setattr(out, field, _core.choice("%s: %s" % (caller, name), getattr(self, name), "VXM_%s_" % field.upper()))
        out.confidence = _values.flag(caller + ": confidence", self.confidence)
        return out


@dataclass
class Run:
    """How it is done."""

    repair: bool = True
    engine: EngineLike = None
    progress: Progress = None
    timeout: Optional[float] = None
    colors: bool = False  # the mesh is read with its own


class Work:
    """For one call: `with Work(...) as work`. The engine is this thread's meanwhile, progress is told, and time runs.

    `source` is the mesh to voxelize, `space` says where, `options` how.
    """

    def __init__(self, mesh: MeshLike, place: Place, rules: Rules, run: Run):
        self._mesh, self._place, self._run = mesh, place, run
        self._stack = contextlib.ExitStack()
        self._engine: Optional[Engine] = None
        place.check()
        self.options = rules.options(place.caller)
        self.source: Mesh

    def __enter__(self) -> "Work":
        try:
            self._begin()
        except BaseException:
            self._stack.close()
            raise
        return self

    def _begin(self) -> None:
        repairs = _values.flag(self._place.caller + ": repair", self._run.repair)
        self._stack.enter_context(watch(self._run.progress, self._run.timeout))
        self.options.engine, self._engine = self._stack.enter_context(used(self._run.engine))
        self.original = as_mesh(self._mesh, self._run.colors)
        self.source = repair_mesh(self.original, separate=True) if repairs else self.original

    def __exit__(self, *_: Any) -> None:
        self._stack.close()

    def space(self) -> Any:
        return self._place.fitted(self.original, self.source)

    def model(self) -> Any:
        """The mesh made ready; it is dropped before the engine is another thread's."""
        made = _core.create("vxm_model", lib.vxm_model_create, self.source._pointer, self.options, destroy=lib.vxm_model_destroy)
        self._stack.callback(ffi.release, made)
        return made

    def report(self, struct: Any) -> VoxelizeReport:
        """With what made the voxels in the end."""
        if self._engine is None:
            return VoxelizeReport._of(struct, engine="cpu", engine_note="")
        info = self._engine.info
        return VoxelizeReport._of(struct, engine=info.name, engine_note=info.note)

    @staticmethod
    def warnings(model: Any) -> List[str]:
        return [_core.text(lib.vxm_model_warning(model, i)) for i in range(lib.vxm_model_warning_count(model))]
