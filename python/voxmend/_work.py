# SPDX-License-Identifier: BSD-3-Clause
"""What making voxels of a mesh takes: the mesh, repaired, where the voxels lie, the rules, and an engine."""
from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import Any, List, Optional, Tuple

from . import _core, _values
from ._core import ffi, lib
from ._engines import Engine, EngineLike, used
from ._errors import ArgumentError
from ._mesh import Mesh
from ._mesh_sources import MeshLike, as_mesh
from ._progress import watch
from ._records import VoxelizeReport
from ._repair import divided, repair as repair_mesh
from ._space import Place
from ._types import Progress


@dataclass
class Rules:
    """Which voxels are set; None where nothing was said."""

    mode: str = "solid"
    surface: Optional[str] = None
    method: Optional[str] = None
    vote: Optional[str] = None
    parts: str = "auto"
    cavities: Optional[str] = None
    thin: str = "auto"
    confidence: bool = False

    def options(self, caller: str) -> Any:
        out = _core.new("vxm_voxelize_options")
        for name in ("mode", "surface", "method", "vote", "parts", "cavities", "thin"):
            field, value = "split_mode" if name == "parts" else name, getattr(self, name)
            if value is not None:
                setattr(out, field, _core.choice("%s: %s" % (caller, name), value, "VXM_%s_" % field.upper()))
        out.confidence = _values.flag(caller + ": confidence", self.confidence)
        for is_wrong, what in self._conflicts(out):
            if is_wrong:
                raise ArgumentError("%s: %s" % (caller, what))
        return out

    def _conflicts(self, chosen: Any) -> List[Tuple[bool, str]]:
        """What would be of no effect, as the command line refuses it."""
        is_shell = chosen.surface >= lib.VXM_SURFACE_SHELL26
        is_solid = chosen.mode != lib.VXM_MODE_SURFACE or is_shell
        return [
            (self.surface is not None and chosen.mode == lib.VXM_MODE_SOLID, "surface goes with mode='surface' or 'both'"),
            (is_shell and chosen.mode == lib.VXM_MODE_BOTH,
             "a shell is a part of the solid; with mode='both' leave out surface"),
            (chosen.thin != lib.VXM_THIN_AUTO and not is_solid,
             "thin goes with the solid: mode='solid' or 'both', or a shell as surface"),
            (self.vote is not None and chosen.method != lib.VXM_METHOD_VOTE, "vote goes with method='vote' only"),
            (self.cavities is not None and chosen.split_mode != lib.VXM_SPLIT_MODE_AUTO,
             "cavities goes with parts='auto' only"),
            ((self.method is not None or self.vote is not None) and not is_solid,
             "method and vote are about the solid; leave them out with mode='surface', unless surface is a shell"),
        ]


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

    def __init__(self, mesh: MeshLike, place: Place, rules: Rules, run: Run, by: str = "part"):
        """`by`: labels that the mesh is taken apart by before it is repaired; parts stay together."""
        self._mesh, self._place, self._run, self._by = mesh, place, run, by
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
        source = divided(self.original, self._by)
        self.source = repair_mesh(source, separate=True) if repairs else source

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
