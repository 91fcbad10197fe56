# SPDX-License-Identifier: BSD-3-Clause
"""Repair of meshes, and whether a level is reached."""
from __future__ import annotations

from typing import Any, List, Optional, Union

from . import _core, _values
from ._core import ffi, lib
from ._mesh import Mesh
from ._mesh_sources import MeshLike, as_mesh
from ._progress import watch
from ._records import Finding, RepairReport, Verification
from ._types import Progress


def repair(mesh: MeshLike, level: str = "clean", *, weld: Union[str, float] = "auto", keep_duplicates: bool = False,
           keep_orientation: bool = False, fill_holes: Union[int, str] = 0, fill: str = "fan", union: bool = False,
           wrap_alpha: float = 0.0, wrap_offset: float = 0.0, max_change: float = 0.0, drop_faces: int = 0,
           drop_volume: float = 0.0, triangles: bool = False, separate: bool = False, sheets: str = "thicken",
           thickness: float = 0.0, fallback_alpha: float = 0.0, single_precision: bool = False, part_changes: bool = False,
           intersections: bool = False, progress: Progress = None, timeout: Optional[float] = None) -> Mesh:
    """A repaired copy; its `report` tells how many vertices or faces each pass has changed, and what could not be mended.

    Args:
        mesh: Mesh, path, open file, (vertices, faces), or a mesh of trimesh, open3d, pyvista or meshio.
        level: how far to go: "clean", "manifold", "closed" or "solid" (which needs the module for CGAL).
        weld: "auto", "off", or a distance in model units, within which no two vertices are left.
        keep_duplicates, keep_orientation: leave repeated faces in, and faces turned as they are; not with `wrap_alpha`.
        fill_holes: those of at most so many edges; a negative number or "all" is all.
        fill: with what: "fan", "minimal" (needs OpenMesh) or "smooth" (needs CGAL).
        union: unite closed parts that cut through each other, as "solid" does (needs CGAL).
        wrap_alpha: put a closed surface around everything instead: the size of the smallest hole that it goes into, as a
            fraction of the diagonal; 0 = do not. wrap_offset: its distance from the mesh, in the same way (needs CGAL).
        max_change: UnreachedError where the volume or the bounds of a closed part change by more than this fraction; 0 = any.
        drop_faces, drop_volume: components with fewer faces, or less volume (model units cubed), are dropped. Cavities stay
            with what they are in.
        sheets: what becomes of open sheets at "closed" and "solid": "thicken", "keep" or "drop".
        thickness: of the plates they become, model units, at most the diagonal of the bounds; 0 is 0.002 of it.
        fallback_alpha: wrap the parts that cannot be united, alone, with this fraction of their diagonal; 0 leaves them.
        triangles: split polygons first, so that the level holds of the triangles that `Mesh.save` writes.
        separate: where bodies share faces each gets its own (level "manifold"), so that no body is lost between others
            when they are voxelized. `voxelize` and the datasets do that.
        single_precision: keep to positions that 32-bit floats hold, as .stl files do.
        part_changes: keep account of every connected component: `Mesh.part_changes`.
        intersections: count self-intersections before and after, in the report (needs CGAL).
        progress, timeout: as for `voxmend.watch`.

    Raises:
        UnavailableError: the library was built without a module that this needs.
        UnreachedError: beyond `max_change`.
    """
    options = _core.new("vxm_repair_options")
    for name, value in (("keep_duplicates", keep_duplicates), ("keep_orientation", keep_orientation), ("triangles", triangles),
                        ("single_precision", single_precision), ("part_changes", part_changes), ("intersections", intersections)):
        setattr(options, name, _values.flag("repair: " + name, value))
    options.boolean_union = _values.flag("repair: union", union)
    for name, number in (("wrap_alpha", wrap_alpha), ("wrap_offset", wrap_offset), ("max_change", max_change),
                         ("drop_volume", drop_volume), ("thickness", thickness), ("fallback_alpha", fallback_alpha)):
        setattr(options, name, _values.real("repair: " + name, number, 0))
    options.drop_faces = _values.whole("repair: drop_faces", drop_faces, 0)
    options.level = _core.choice("repair: level", level, "VXM_LEVEL_")
    options.hole_fill = _core.choice("repair: fill", fill, "VXM_HOLE_FILL_")
    options.sheets = _core.choice("repair: sheets", sheets, "VXM_SHEETS_")
    all_holes = isinstance(fill_holes, str) and fill_holes == "all"
    options.fill_holes = -1 if all_holes else _values.whole("repair: fill_holes", fill_holes)
    _set_weld(options, weld)
    report = _core.new("vxm_repair_report")
    function = lib.vxm_mesh_prepare if _values.flag("repair: separate", separate) else lib.vxm_mesh_repair
    with watch(progress, timeout):
        source = as_mesh(mesh)
        made = _core.create("vxm_mesh", function, report, source._pointer, options, destroy=lib.vxm_mesh_destroy)
    _core.warn(_remaining(report))
    passes = {_core.text(getattr(report.passes[i], "pass")): int(report.passes[i].count) for i in range(report.pass_count)}
    return Mesh._of(made, RepairReport._of(report, passes=passes))


def divided(mesh: Mesh, by: str) -> Mesh:
    """The mesh with the vertices and bodies of each closed label by themselves, as labels are made of; by "part" it stays."""
    if by == "part":
        return mesh
    kind = _core.choice("labels: by", by, "VXM_LABEL_")
    return Mesh._of(_core.create("vxm_mesh", lib.vxm_mesh_divide, mesh._pointer, kind, destroy=lib.vxm_mesh_destroy))


def _set_weld(options: Any, weld: Union[str, float]) -> None:
    if isinstance(weld, str) and weld != "tolerance":
        options.weld = _core.choice("repair: weld", weld, "VXM_WELD_")
    else:
        options.weld, options.weld_tolerance = lib.VXM_WELD_TOLERANCE, _values.real("repair: weld", weld, 0)


def _remaining(report: Any) -> List[str]:
    """What the command line warns of after a repair."""
    out = []
    if report.shared_faces > 0:
        out.append("%d faces repeat others, where bodies overlap and share a part of their surfaces; level 'manifold' gives "
                   "each body its own, level 'solid' unites them" % report.shared_faces)
    if report.union_failures > 0:
        out.append("%d parts still cut through others or themselves; open ones have no inside to unite" % report.union_failures)
    if report.emptied_parts > 0:
        out.append("the union has taken away some of what %d closed parts enclosed, as of one that lies in a cavity; remesh "
                   "keeps it" % report.emptied_parts)
    return out


def verify(mesh: MeshLike, level: str = "clean", *, keep_duplicates: bool = False, keep_orientation: bool = False) -> Verification:
    """Checks what a level guarantees of a mesh, after welding equal positions; see `voxmend.repair` for the levels."""
    options = _core.new("vxm_repair_options", level=_core.choice("verify: level", level, "VXM_LEVEL_"),
                        keep_duplicates=_values.flag("verify: keep_duplicates", keep_duplicates),
                        keep_orientation=_values.flag("verify: keep_orientation", keep_orientation))
    made = _core.new("vxm_verification")
    _core.call(lib.vxm_mesh_verify, made, as_mesh(mesh)._pointer, options)
    findings = []
    for one in made.findings[0:made.count]:
        x, y, z = one.position
        findings.append(Finding("" if one.what == ffi.NULL else _core.text(one.what), int(one.count), int(one.element),
                                (x, y, z) if one.placed else None))
    return Verification(bool(made.reached), tuple(findings))
