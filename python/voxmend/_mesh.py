# SPDX-License-Identifier: BSD-3-Clause
"""Meshes: reading, looking, repairing, writing."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Optional, Sequence, Tuple, Type

import numpy

from . import _core, _values
from ._core import ffi, lib
from ._errors import ArgumentError
from ._records import Census, Look, PartChange, PartState, RepairReport, Texture, Verification
from ._types import Array, ArrayLike, Floats, Int64s, Path, Progress, Uint32s, Uint64s

if TYPE_CHECKING:
    from ._defects import Defects
    from ._grid import VoxelGrid


def _points_of(vertices: Any) -> Array:
    points = _values.array("mesh: vertices", vertices, "iuf", "numbers")
    if points.shape == (0,):
        points = numpy.zeros((0, 3))
    if points.ndim != 2 or points.shape[1] != 3:
        raise ArgumentError("mesh: vertices have shape %s, not (V, 3)" % (points.shape,))
    kind = numpy.float32 if points.dtype.kind == "f" and points.dtype.itemsize == 4 else numpy.float64
    return numpy.ascontiguousarray(points, kind)


def _are_ragged(faces: Any) -> bool:
    return isinstance(faces, (list, tuple)) and len({len(f) if hasattr(f, "__len__") else 0 for f in faces}) > 1


def _corners_of(faces: Any) -> Tuple[Int64s, Int64s]:
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


def _corner_array(faces: Any) -> Int64s:
    out = _values.array("mesh: faces", faces, "iu", "whole numbers")
    if out.dtype.kind == "u" and out.size and out.max() > _values.INT64_MAX:
        raise ArgumentError("mesh: faces name vertex %d, which cannot exist" % out.max())
    return numpy.ascontiguousarray(out, numpy.int64)


def _new(points: Array, offsets: Int64s, corners: Int64s, tags: Sequence[bytes] = (), face_tags: Optional[Uint32s] = None) -> Any:
    arrays = _core.new("vxm_mesh_arrays", vertex_count=len(points), face_count=len(offsets) - 1,
                       index_count=corners.size, tag_count=len(tags))
    arrays.vertex_scalar = lib.VXM_FLOAT32 if points.dtype == numpy.float32 else lib.VXM_FLOAT64
    arrays.vertices = _core.pointer("void *", points)
    arrays.offsets = _core.pointer("int64_t *", offsets)
    arrays.indices = _core.pointer("void *", corners)
    names = [ffi.new("char[]", tag) for tag in tags]
    arrays.tags = table = ffi.new("char *[]", names)
    if face_tags is not None:
        arrays.face_tags = _core.pointer("uint32_t *", face_tags)
    made = _core.create("vxm_mesh", lib.vxm_mesh_create, _core.context(), arrays, destroy=lib.vxm_mesh_destroy)
    del table  # until now the arrays point to it
    return made


class Mesh:
    """Vertices and polygons, with nothing assumed of them: a polygon soup, or a mesh after repair. It does not change.

    Made by `voxmend.load`, by a repair, from arrays, or by `Mesh.of` from meshes of other packages. Pickles and copies hold
    the same content.

    Args:
        vertices: (V, 3) coordinates in model units, of any kind of real numbers; copied.
        faces: (F, 3) vertex indices of triangles, (F, n) of polygons of n corners each, or a list of lists of any lengths.
        tags: names of groups or materials, "group" or "group/material", where faces have some.
        face_tags: (F,) which of them each face has.

    Attributes:
        report: what the repair that made it has done; empty if there was none.
    """

    def __init__(self, vertices: ArrayLike, faces: ArrayLike, *, tags: Sequence[str] = (), face_tags: Optional[ArrayLike] = None):
        points, (offsets, corners) = _points_of(vertices), _corners_of(faces)
        numbers: Optional[Uint32s] = None
        if (face_tags is None) != (len(tags) == 0):
            raise ArgumentError("mesh: tags and face_tags go together")
        if face_tags is not None:
            numbers = numpy.ascontiguousarray(_values.wholes("mesh: face_tags", face_tags, 0, len(tags) - 1), numpy.uint32)
            if numbers.shape != (len(offsets) - 1,):
                raise ArgumentError("mesh: face_tags have shape %s, not (%d,)" % (numbers.shape, len(offsets) - 1))
        names = [_values.word("mesh: a tag", tag).encode() for tag in tags]
        self._take(_new(points, offsets, corners, names, numbers))

    def _take(self, pointer: Any, report: Optional[RepairReport] = None) -> "Mesh":
        self._pointer = pointer
        self.report: RepairReport = report or RepairReport()
        self._told: Optional[Tuple[str, List[str]]] = None  # format and warnings, where another mesh was read
        return self

    @classmethod
    def _of(cls, pointer: Any, report: Optional[RepairReport] = None) -> "Mesh":
        return cls.__new__(cls)._take(pointer, report)

    @classmethod
    def of(cls, source: Any) -> "Mesh":
        """A mesh of whatever `voxmend.voxelize` takes for one: a path, a file, (vertices, faces), or a mesh of trimesh, open3d,
        pyvista or meshio."""
        from ._mesh_sources import as_mesh
        return as_mesh(source)

    def __reduce__(self) -> Tuple[Any, ...]:
        names = [ffi.string(lib.vxm_mesh_tag_name(self._pointer, t)) for t in range(lib.vxm_mesh_tag_count(self._pointer))]
        content = (self.vertices.copy(), self.offsets.astype(numpy.int64), self.indices.astype(numpy.uint32), names,
                   None if self.face_tags is None else self.face_tags.copy())
        return _restore, (type(self), content, self.report, (self.format, self.warnings))

    def __repr__(self) -> str:
        return "<voxmend.Mesh: %d vertices, %d faces>" % (len(self.vertices), len(self.offsets) - 1)

    @property
    def vertices(self) -> Floats:
        """(V, 3) float64, model units; read-only, without a copy."""
        count = lib.vxm_mesh_vertex_count(self._pointer)
        return _core.view(self._pointer, lib.vxm_mesh_vertices(self._pointer), (count, 3), "<f8")

    @property
    def offsets(self) -> Uint64s:
        """(F + 1,) uint64: face f has the corners indices[offsets[f]:offsets[f + 1]]; read-only, without a copy."""
        count = lib.vxm_mesh_face_count(self._pointer)
        return _core.view(self._pointer, lib.vxm_mesh_offsets(self._pointer), (count + 1,), "<u8")

    @property
    def indices(self) -> Uint32s:
        """Vertices of all corners, uint32, face after face; read-only, without a copy."""
        offsets = self.offsets
        return _core.view(self._pointer, lib.vxm_mesh_indices(self._pointer), (int(offsets[-1]),), "<u4")

    @property
    def faces(self) -> Uint32s:
        """(F, n) uint32, without a copy, where all faces have n corners; else see `offsets` and `indices`."""
        sizes = numpy.diff(self.offsets)
        if len(sizes) == 0:
            return self.indices.reshape(0, 3)
        if (sizes != sizes[0]).any():
            raise ArgumentError("mesh: faces have different numbers of corners; use offsets and indices, or triangles()")
        return self.indices.reshape(-1, int(sizes[0]))

    def triangles(self) -> Uint32s:
        """(T, 3) uint32: polygons cut into fans from their first corners, which is right where they are convex; else see
        `triangulated`."""
        offsets, indices = self.offsets.astype(numpy.int64), self.indices
        counts = numpy.maximum(numpy.diff(offsets) - 2, 0)
        first = numpy.repeat(offsets[:-1], counts)
        step = numpy.arange(counts.sum()) - numpy.repeat(numpy.cumsum(counts) - counts, counts)
        return numpy.stack([indices[first], indices[first + step + 1], indices[first + step + 2]], axis=1)

    def triangulated(self) -> "Mesh":
        """A mesh of the triangles that voxelizing takes polygons for, and `save` writes, whatever shape they have; the same
        vertices and tags."""
        return Mesh._of(_core.create("vxm_mesh", lib.vxm_mesh_triangulate, self._pointer, destroy=lib.vxm_mesh_destroy))

    @property
    def format(self) -> str:
        """What it was read from, such as "off"; "arrays" if made from arrays."""
        return self._told[0] if self._told else _core.text(lib.vxm_mesh_format(self._pointer))

    @property
    def tags(self) -> List[str]:
        """Names of groups, parts or materials."""
        return [_core.text(lib.vxm_mesh_tag_name(self._pointer, t)) for t in range(lib.vxm_mesh_tag_count(self._pointer))]

    @property
    def face_tags(self) -> Optional[Uint32s]:
        """(F,) uint32: the number of each face's tag; None if there are no tags."""
        pointer = lib.vxm_mesh_face_tags(self._pointer)
        if pointer == ffi.NULL:
            return None
        return _core.view(self._pointer, pointer, (lib.vxm_mesh_face_count(self._pointer),), "<u4")

    @property
    def warnings(self) -> List[str]:
        """What reading met, one line each; `load` tells them as VoxmendWarning too."""
        if self._told:
            return list(self._told[1])
        return [_core.text(lib.vxm_mesh_warning(self._pointer, i)) for i in range(lib.vxm_mesh_warning_count(self._pointer))]

    @property
    def part_changes(self) -> List[PartChange]:
        """What the repair that made it did to each connected component; empty without `part_changes=True`. Not pickled."""
        out = []
        for index in range(lib.vxm_mesh_part_change_count(self._pointer)):
            one = lib.vxm_mesh_part_change(self._pointer, index)
            tag = self.tags[one.tag] if one.tag < lib.vxm_mesh_tag_count(self._pointer) else None
            out.append(PartChange._of(one, before=PartState._of(one.before), after=PartState._of(one.after), tag=tag))
        return out

    @property
    def look(self) -> Look:
        """Which colours, materials and textures it has: none, unless `load` was told to keep them. Neither repairs nor pickles
        keep them."""
        out, textures = _core.new("vxm_look"), []
        _core.call(lib.vxm_mesh_look, out, self._pointer)
        for index in range(out.textures):
            one = _core.new("vxm_texture")
            _core.call(lib.vxm_mesh_texture, one, self._pointer, index)
            textures.append(Texture._of(one, name=_core.text(one.name), failure=_core.text(one.failure)))
        return Look._of(out, textures=tuple(textures))

    # ---- What is wrong, and mending it ----

    def info(self) -> Census:
        """What is wrong with it: counts, bounds, area, volume, `watertight` and `closed`."""
        census = _core.new("vxm_census")
        _core.call(lib.vxm_mesh_census, census, self._pointer)
        return Census._of(census)

    def defects(self, *, intersections: bool = False, max_count: int = 0, progress: Progress = None,
                timeout: Optional[float] = None) -> "Defects":
        """Where it is wrong, as arrays: see `voxmend.Defects`.

        Args:
            intersections: look for faces that cut through each other, too: needs the module for CGAL.
            max_count: of each kind to list; 0 = all. All are counted.
            progress, timeout: as for `voxmend.watch`.
        """
        from ._defects import find_defects
        return find_defects(self, intersections, max_count, progress, timeout)

    def verify(self, level: str = "clean", **options: Any) -> Verification:
        """Whether it is at a level, and what is in the way; options as of `voxmend.repair`: what is to be kept."""
        from ._repair import verify
        return verify(self, level, **options)

    def repair(self, level: str = "clean", **options: Any) -> "Mesh":
        """A repaired copy: as `voxmend.repair`."""
        from ._repair import repair
        return repair(self, level, **options)

    def voxelize(self, *arguments: Any, **options: Any) -> "VoxelGrid":
        """As `voxmend.voxelize`."""
        from ._voxelize import voxelize
        return voxelize(self, *arguments, **options)

    def save(self, path: Path, format: Optional[str] = None, ascii: bool = False, keep_polygons: bool = False,
             level: Optional[str] = None) -> None:
        """Writes .off, .obj, .stl or .ply, told by the name or by `format`; "-" is standard output. Polygons become
        triangles, as many programs read nothing else, unless `keep_polygons` (.stl has triangles in any case).

        With a `level` what was written is read back and verified: UnreachedError, and no file, where it is not at that."""
        options = _core.new("vxm_mesh_write_options", ascii=_values.flag("save: ascii", ascii))
        options.keep_polygons = _values.flag("save: keep_polygons", keep_polygons)
        name = format_name("save", format)
        options.format = name
        if level is None:
            _core.call(lib.vxm_mesh_write, self._pointer, _values.path(path), options, path=path)
            return
        wanted = _core.new("vxm_repair_options", level=_core.choice("save: level", level, "VXM_LEVEL_"))
        _core.call(lib.vxm_mesh_write_verified, _core.new("vxm_verification"), self._pointer, _values.path(path), options, wanted,
                   False, path=path)

    # ---- For other packages ----

    def to_trimesh(self) -> Any:
        """A trimesh.Trimesh of its triangles, with no vertex merged."""
        from . import _mesh_convert
        return _mesh_convert.to_trimesh(self)

    def to_open3d(self) -> Any:
        """An open3d.geometry.TriangleMesh of its triangles."""
        from . import _mesh_convert
        return _mesh_convert.to_open3d(self)

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData of its polygons."""
        from . import _mesh_convert
        return _mesh_convert.to_pyvista(self)

    def to_meshio(self) -> Any:
        """A meshio.Mesh of its triangles, quadrilaterals and other polygons, in blocks."""
        from . import _mesh_convert
        return _mesh_convert.to_meshio(self)


def _restore(kind: Type[Mesh], content: Tuple[Any, ...], report: RepairReport, told: Tuple[str, List[str]]) -> Mesh:
    """A mesh from its pickle."""
    vertices, offsets, indices, tags, face_tags = content
    made = kind.__new__(kind)._take(_new(vertices, offsets, numpy.ascontiguousarray(indices, numpy.int64), tags, face_tags), report)
    made._told = told
    return made


def format_name(caller: str, format: Optional[str]) -> Any:
    """The name of a format for C, NULL if it is to be found out."""
    return ffi.NULL if format is None else ffi.new("char[]", _values.word(caller + ": format", format).encode())
