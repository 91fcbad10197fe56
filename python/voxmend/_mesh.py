# SPDX-License-Identifier: BSD-3-Clause
"""Meshes: reading, looking, repairing, writing."""
from __future__ import annotations

import os
from typing import Any, Optional, Union

import numpy

from . import _core, _values
from ._core import ffi, lib
from ._errors import ArgumentError, KindError


def _points_of(vertices: Any) -> numpy.ndarray:
    points = _values.array("mesh: vertices", vertices, "iuf", "numbers")
    if points.shape == (0,):
        points = numpy.zeros((0, 3))
    if points.ndim != 2 or points.shape[1] != 3:
        raise ArgumentError("mesh: vertices have shape %s, not (V, 3)" % (points.shape,))
    kind = numpy.float32 if points.dtype.kind == "f" and points.dtype.itemsize == 4 else numpy.float64
    return numpy.ascontiguousarray(points, kind)


def _are_ragged(faces: Any) -> bool:
    return isinstance(faces, (list, tuple)) and len({len(f) if hasattr(f, "__len__") else 0 for f in faces}) > 1


def _corners_of(faces: Any) -> tuple:
    """Offsets, and the vertices of all corners."""
    if _are_ragged(faces):
        rows = [_corner_array(row) for row in faces]
        if any(row.ndim != 1 for row in rows):
            raise ArgumentError("mesh: faces are neither (F, n) nor a list of lists of vertices")
        return numpy.cumsum([0] + [len(row) for row in rows], dtype=numpy.int64), numpy.concatenate(rows)
    corners = _corner_array(faces)
    if corners.shape == (0,):
        corners = corners.reshape(0, 3)
    if corners.ndim != 2:
        raise ArgumentError("mesh: faces have shape %s, not (F, n)" % (corners.shape,))
    return numpy.arange(len(corners) + 1, dtype=numpy.int64) * corners.shape[1], corners


def _corner_array(faces: Any) -> numpy.ndarray:
    out = _values.array("mesh: faces", faces, "iu", "whole numbers")
    if out.dtype.kind == "u" and out.size and out.max() > _values.INT64_MAX:
        raise ArgumentError("mesh: faces name vertex %d, which cannot exist" % out.max())
    return numpy.ascontiguousarray(out, numpy.int64)


def _new(points: numpy.ndarray, offsets: numpy.ndarray, corners: numpy.ndarray, tags: Any = (), face_tags: Any = None) -> Any:
    arrays = _core.new("vxm_mesh_arrays", vertex_count=len(points), face_count=len(offsets) - 1,
                       index_count=corners.size, tag_count=len(tags))
    arrays.vertex_scalar = lib.VXM_FLOAT32 if points.dtype == numpy.float32 else lib.VXM_FLOAT64
    arrays.vertices = _core.pointer("void *", points)
    arrays.offsets = _core.pointer("int64_t *", offsets)
    arrays.indices = _core.pointer("void *", corners)
    names = [ffi.new("char[]", tag) for tag in tags]
    arrays.tags = table = ffi.new("char *[]", names)
    if len(tags):
        arrays.face_tags = _core.pointer("uint32_t *", face_tags)
    made = _core.create("vxm_mesh", lib.vxm_mesh_create, _core.context(), arrays, destroy=lib.vxm_mesh_destroy)
    del table  # until now the arrays point to it
    return made


class Mesh:
    """Vertices and polygons, with nothing assumed of them: a polygon soup, or a mesh after repair. It does not change.

    Made by `load`, by `repair`, or from arrays. Pickles and copies hold the same content.

    Args:
        vertices: (V, 3) coordinates in model units, of any kind of real numbers.
        faces: (F, 3) vertex indices of triangles, (F, n) of polygons of n corners each, or a list of lists of any lengths.
    """

    def __init__(self, vertices: Any, faces: Any):
        self._take(_new(_points_of(vertices), *_corners_of(faces)))

    def _take(self, pointer: Any, report: Optional[dict] = None) -> "Mesh":
        self._pointer = pointer
        self.report: dict = report or {}  # of the repair that made it: passes and their counts
        self._told: Optional[tuple] = None  # format and warnings, where another mesh was read
        return self

    @classmethod
    def _of(cls, pointer: Any, report: Optional[dict] = None) -> "Mesh":
        return cls.__new__(cls)._take(pointer, report)

    def __reduce__(self) -> tuple:
        names = [ffi.string(lib.vxm_mesh_tag_name(self._pointer, t)) for t in range(lib.vxm_mesh_tag_count(self._pointer))]
        content = (self.vertices.copy(), self.offsets.astype(numpy.int64), self.indices.astype(numpy.uint32), names,
                   None if self.face_tags is None else self.face_tags.copy())
        return _restore, (type(self), content, self.report, (self.format, self.warnings))

    def __repr__(self) -> str:
        return "<voxmend.Mesh: %d vertices, %d faces>" % (len(self.vertices), len(self.offsets) - 1)

    @property
    def vertices(self) -> numpy.ndarray:
        """(V, 3) float64, model units; read-only, without a copy."""
        count = lib.vxm_mesh_vertex_count(self._pointer)
        return _core.view(self._pointer, lib.vxm_mesh_vertices(self._pointer), (count, 3), "<f8")

    @property
    def offsets(self) -> numpy.ndarray:
        """(F + 1,) uint64: face f has the corners indices[offsets[f]:offsets[f + 1]]; read-only, without a copy."""
        count = lib.vxm_mesh_face_count(self._pointer)
        return _core.view(self._pointer, lib.vxm_mesh_offsets(self._pointer), (count + 1,), "<u8")

    @property
    def indices(self) -> numpy.ndarray:
        """Vertices of all corners, uint32, face after face; read-only, without a copy."""
        offsets = self.offsets
        return _core.view(self._pointer, lib.vxm_mesh_indices(self._pointer), (int(offsets[-1]),), "<u4")

    @property
    def faces(self) -> numpy.ndarray:
        """(F, n) uint32, without a copy, where all faces have n corners; else see `offsets` and `indices`."""
        sizes = numpy.diff(self.offsets)
        if len(sizes) == 0:
            return self.indices.reshape(0, 3)
        if (sizes != sizes[0]).any():
            raise ArgumentError("mesh: faces have different numbers of corners; use offsets and indices, or triangles()")
        return self.indices.reshape(-1, int(sizes[0]))

    def triangles(self) -> numpy.ndarray:
        """(T, 3) uint32: polygons cut into fans from their first corners."""
        offsets, indices = self.offsets.astype(numpy.int64), self.indices
        counts = numpy.maximum(numpy.diff(offsets) - 2, 0)
        first = numpy.repeat(offsets[:-1], counts)
        step = numpy.arange(counts.sum()) - numpy.repeat(numpy.cumsum(counts) - counts, counts)
        return numpy.stack([indices[first], indices[first + step + 1], indices[first + step + 2]], axis=1)

    @property
    def format(self) -> str:
        """What it was read from, such as "off"; "arrays" if made from arrays."""
        return self._told[0] if self._told else _core.text(lib.vxm_mesh_format(self._pointer))

    @property
    def tags(self) -> list:
        """Names of groups, parts or materials."""
        return [_core.text(lib.vxm_mesh_tag_name(self._pointer, t)) for t in range(lib.vxm_mesh_tag_count(self._pointer))]

    @property
    def face_tags(self) -> Optional[numpy.ndarray]:
        """(F,) uint32: the number of each face's tag; None if there are no tags."""
        pointer = lib.vxm_mesh_face_tags(self._pointer)
        if pointer == ffi.NULL:
            return None
        return _core.view(self._pointer, pointer, (lib.vxm_mesh_face_count(self._pointer),), "<u4")

    @property
    def warnings(self) -> list:
        """What reading met, one line each; `load` tells them as VoxmendWarning too."""
        if self._told:
            return list(self._told[1])
        return [_core.text(lib.vxm_mesh_warning(self._pointer, i)) for i in range(lib.vxm_mesh_warning_count(self._pointer))]

    def info(self) -> dict:
        """What is wrong with it: counts, bounds, area, volume, `watertight` and `closed`."""
        census = _core.new("vxm_census")
        _core.call(lib.vxm_mesh_census, census, self._pointer)
        return _core.fields(census[0])

    def repair(self, level: str = "clean", **options: Any) -> "Mesh":
        """As `voxmend.repair`."""
        return repair(self, level, **options)

    def voxelize(self, *arguments: Any, **options: Any) -> Any:
        """As `voxmend.voxelize`."""
        from ._grid import voxelize
        return voxelize(self, *arguments, **options)

    def save(self, path: Any, format: Optional[str] = None, ascii: bool = False, keep_polygons: bool = False) -> None:
        """Writes .off, .obj, .stl or .ply, told by the name or by `format`; "-" is standard output. Polygons become
        triangles, as many programs read nothing else, unless `keep_polygons` (.stl has triangles in any case)."""
        options = _core.new("vxm_mesh_write_options", ascii=_values.flag("save: ascii", ascii))
        options.keep_polygons = _values.flag("save: keep_polygons", keep_polygons)
        name = format_name("save", format)
        options.format = name
        _core.call(lib.vxm_mesh_write, self._pointer, _values.path(path), options, path=path)


def _restore(kind: type, content: tuple, report: dict, told: tuple) -> Mesh:
    """A mesh from its pickle."""
    made = kind.__new__(kind)._take(_new(*content[:2], numpy.ascontiguousarray(content[2], numpy.int64), *content[3:]), report)
    made._told = told
    return made


MeshLike = Union[Mesh, str, "os.PathLike[str]", tuple, Any]


def format_name(caller: str, format: Optional[str]) -> Any:
    """The name of a format for C, NULL if it is to be found out."""
    return ffi.NULL if format is None else ffi.new("char[]", _values.word(caller + ": format", format).encode())


def load(path: Any, format: Optional[str] = None, deflection: float = 0.0, external: str = "folder") -> Mesh:
    """Reads a mesh file; what a damaged file still holds is read, and its damage told as VoxmendWarning.

    Args:
        path: .off, .obj, .stl, .ply; .gltf, .3mf, .step and more where the library was built with their modules. "-" is
            standard input.
        format: by content, then name, if None.
        deflection: STEP and IGES: how far triangles may lie from a curved surface, as a part of the diagonal; 0 = 0.001.
        external: which other files the mesh may refer to, such as the buffers of a glTF: "folder" = in its own folder or below,
            "any" = wherever it says, "none". What is refused is a warning, or an error where the mesh cannot be read without.
    """
    options = _core.new("vxm_mesh_read_options", deflection=_values.real("load: deflection", deflection),
                        external=_core.choice("load: external", external, "VXM_EXTERNAL_"))
    name = format_name("load", format)
    options.format = name
    made = Mesh._of(_core.create("vxm_mesh", lib.vxm_mesh_read_with, _core.context(), _values.path(path), options,
                                 destroy=lib.vxm_mesh_destroy, path=path))
    _core.warn(["%s: %s" % (os.fsdecode(path), line) for line in made.warnings])
    return made


def as_mesh(source: MeshLike) -> Mesh:
    """A Mesh of a mesh, a file, (vertices, faces), or an object with `vertices` and `faces` such as trimesh's."""
    if isinstance(source, Mesh):
        return source
    if isinstance(source, (tuple, list)) and len(source) == 2:
        return Mesh(*source)
    if hasattr(source, "vertices") and hasattr(source, "faces"):
        return Mesh(source.vertices, source.faces)
    if not isinstance(source, (str, bytes, os.PathLike)):
        raise KindError("a mesh is a Mesh, a path, (vertices, faces) or an object with these, not %s" % type(source).__name__)
    return load(source)


def info(mesh: MeshLike) -> dict:
    """What is wrong with a mesh or mesh file: see `Mesh.info`."""
    return as_mesh(mesh).info()


def repair(mesh: MeshLike, level: str = "clean", *, weld: Union[str, float] = "auto", keep_duplicates: bool = False,
           keep_orientation: bool = False, fill_holes: Union[int, str] = 0, fill: str = "fan", union: bool = False,
           wrap_alpha: float = 0.0, wrap_offset: float = 0.0, max_change: float = 0.0, drop_faces: int = 0,
           drop_volume: float = 0.0, triangles: bool = False, separate: bool = False, sheets: str = "thicken",
           thickness: float = 0.0, fallback_alpha: float = 0.0) -> Mesh:
    """A repaired copy; its `report` tells how many vertices or faces each pass has changed.

    Args:
        mesh: Mesh, path, (vertices, faces) or an object with these.
        level: how far to go: "clean", "manifold", "closed" or "solid".
        weld: "auto", "off", or a distance in model units.
        fill_holes: those of at most so many edges; a negative number or "all" is all.
        fill: with what: "fan", "minimal" or "smooth".
        drop_faces, drop_volume: components with fewer faces, or less volume (model units cubed), are dropped.
        sheets: what becomes of open sheets at "closed" and "solid": "thicken", "keep" or "drop".
        thickness: of the plates they become, model units; 0 is 0.002 of the diagonal.
        fallback_alpha: wrap the parts that cannot be united, alone, with this fraction of their diagonal; 0 leaves them.
        triangles: split polygons first, so that the level holds of the triangles that `Mesh.save` writes.
        separate: where bodies share faces each gets its own (level "manifold"), so that no body is lost between others
            when they are voxelized. `voxelize` and the datasets do that.
    """
    source = as_mesh(mesh)
    options = _core.new("vxm_repair_options")
    for name, value in (("keep_duplicates", keep_duplicates), ("keep_orientation", keep_orientation), ("triangles", triangles)):
        setattr(options, name, _values.flag("repair: " + name, value))
    options.boolean_union = _values.flag("repair: union", union)
    for name, value in (("wrap_alpha", wrap_alpha), ("wrap_offset", wrap_offset), ("max_change", max_change),
                        ("drop_volume", drop_volume), ("thickness", thickness), ("fallback_alpha", fallback_alpha)):
        setattr(options, name, _values.real("repair: " + name, value, 0))
    options.drop_faces = _values.whole("repair: drop_faces", drop_faces, 0)
    options.level = _core.choice("repair: level", level, "VXM_LEVEL_")
    options.hole_fill = _core.choice("repair: fill", fill, "VXM_HOLE_FILL_")
    options.sheets = _core.choice("repair: sheets", sheets, "VXM_SHEETS_")
    all_holes = isinstance(fill_holes, str) and fill_holes == "all"
    options.fill_holes = -1 if all_holes else _values.whole("repair: fill_holes", fill_holes)
    if isinstance(weld, str) and weld != "tolerance":
        options.weld = _core.choice("repair: weld", weld, "VXM_WELD_")
    else:
        options.weld, options.weld_tolerance = lib.VXM_WELD_TOLERANCE, _values.real("repair: weld", weld, 0)
    report = _core.new("vxm_repair_report")
    function = lib.vxm_mesh_prepare if _values.flag("repair: separate", separate) else lib.vxm_mesh_repair
    made = _core.create("vxm_mesh", function, report, source._pointer, options, destroy=lib.vxm_mesh_destroy)
    _core.warn(_remaining(report))
    passes = {_core.text(getattr(report.passes[i], "pass")): report.passes[i].count for i in range(report.pass_count)}
    return Mesh._of(made, passes)


def _remaining(report: Any) -> list:
    """What the command line warns of after a repair."""
    out = []
    if report.shared_faces > 0:
        out.append("%d faces repeat others, where bodies overlap and share a part of their surfaces; level 'manifold' gives "
                   "each body its own, level 'solid' unites them" % report.shared_faces)
    if report.union_failures > 0:
        out.append("%d parts still cut through others or themselves, and what is open has no inside to unite" %
                   report.union_failures)
    return out
