# SPDX-License-Identifier: BSD-3-Clause
"""Meshes: reading, looking, repairing, writing."""
from __future__ import annotations

import os
from typing import Any, Optional, Union

import numpy

from . import _core
from ._core import ffi, lib


class Mesh:
    """Vertices and polygons, with nothing assumed of them: a polygon soup, or a mesh after repair.

    Made by `load`, by `repair`, or from arrays.

    Args:
        vertices: (V, 3) coordinates in model units, float64 or float32.
        faces: (F, 3) vertex indices of triangles, or (F, n) of polygons of n corners each.
    """

    def __init__(self, vertices: Any, faces: Any):
        points = numpy.ascontiguousarray(vertices)
        if points.dtype != numpy.float32:
            points = numpy.ascontiguousarray(points, numpy.float64)
        corners = numpy.asarray(faces)
        if corners.size == 0:
            corners = numpy.zeros((0, 3), numpy.int64)
        if not numpy.issubdtype(corners.dtype, numpy.integer):
            raise _core.ArgumentError("mesh: faces are %s, not whole numbers" % corners.dtype)
        corners = numpy.ascontiguousarray(corners, numpy.int64)
        if points.ndim != 2 or points.shape[1] != 3 or corners.ndim != 2:
            raise _core.ArgumentError("mesh: vertices have shape %s and faces %s, not (V, 3) and (F, n)" %
                                      (points.shape, corners.shape))
        offsets = numpy.arange(len(corners) + 1, dtype=numpy.int64) * corners.shape[1]
        arrays = _core.new("vxm_mesh_arrays", vertex_count=len(points), face_count=len(corners))
        arrays.vertex_scalar = lib.VXM_FLOAT32 if points.dtype == numpy.float32 else lib.VXM_FLOAT64
        arrays.vertices = ffi.cast("void *", points.ctypes.data)
        arrays.offsets = ffi.cast("int64_t *", offsets.ctypes.data)
        arrays.indices = ffi.cast("int64_t *", corners.ctypes.data)
        self._pointer = _core.create("vxm_mesh", lib.vxm_mesh_create, _core.context(), arrays,
                                     destroy=lib.vxm_mesh_destroy)
        self.report: dict = {}

    @classmethod
    def _of(cls, pointer: Any, report: Optional[dict] = None) -> "Mesh":
        self = cls.__new__(cls)
        self._pointer = pointer
        self.report = report or {}  # of the repair that made it: passes and their counts
        return self

    def __repr__(self) -> str:
        return "<voxmend.Mesh: %d vertices, %d faces>" % (len(self.vertices), len(self.offsets) - 1)

    @property
    def vertices(self) -> numpy.ndarray:
        """(V, 3) float64, model units; read-only, without a copy."""
        count = lib.vxm_mesh_vertex_count(self._pointer)
        return _core.view(self, lib.vxm_mesh_vertices(self._pointer), (count, 3), "<f8")

    @property
    def offsets(self) -> numpy.ndarray:
        """(F + 1,) uint64: face f has the corners indices[offsets[f]:offsets[f + 1]]; without a copy."""
        count = lib.vxm_mesh_face_count(self._pointer)
        return _core.view(self, lib.vxm_mesh_offsets(self._pointer), (count + 1,), "<u8")

    @property
    def indices(self) -> numpy.ndarray:
        """Vertices of all corners, uint32, face after face; read-only, without a copy."""
        offsets = self.offsets
        return _core.view(self, lib.vxm_mesh_indices(self._pointer), (int(offsets[-1]),), "<u4")

    @property
    def faces(self) -> numpy.ndarray:
        """(F, n) uint32, without a copy, where all faces have n corners; else see `offsets` and `indices`."""
        sizes = numpy.diff(self.offsets)
        if len(sizes) == 0:
            return numpy.zeros((0, 3), numpy.uint32)
        if (sizes != sizes[0]).any():
            raise _core.ArgumentError("mesh: faces have different numbers of corners; use offsets and indices, or triangles()")
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
        return _core.text(lib.vxm_mesh_format(self._pointer))

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
        return _core.view(self, pointer, (lib.vxm_mesh_face_count(self._pointer),), "<u4")

    @property
    def warnings(self) -> list:
        """What reading met, one line each."""
        return [_core.text(lib.vxm_mesh_warning(self._pointer, i)) for i in range(lib.vxm_mesh_warning_count(self._pointer))]

    def info(self) -> dict:
        """What is wrong with it: counts, bounds, area, volume, `watertight` and `closed`."""
        census = ffi.new("vxm_census *")
        _core.call(lib.vxm_mesh_census, census, self._pointer)
        return _core.fields(census[0])

    def repair(self, level: str = "clean", **options: Any) -> "Mesh":
        """As `voxmend.repair`."""
        return repair(self, level, **options)

    def voxelize(self, *arguments: Any, **options: Any) -> Any:
        """As `voxmend.voxelize`."""
        from ._grid import voxelize
        return voxelize(self, *arguments, **options)

    def save(self, path: Any, format: Optional[str] = None, ascii: bool = False) -> None:
        """Writes .off, .obj, .stl or .ply, told by the name or by `format`."""
        options = _core.new("vxm_mesh_write_options", ascii=ascii)
        name = ffi.new("char[]", format.encode()) if format else ffi.NULL
        options.format = name
        _core.call(lib.vxm_mesh_write, self._pointer, _core.path_bytes(path), options)


MeshLike = Union[Mesh, str, "os.PathLike[str]", tuple, Any]


def load(path: Any, format: Optional[str] = None, deflection: float = 0.0, external: str = "folder") -> Mesh:
    """Reads a mesh file; what a damaged file still holds is read, see `Mesh.warnings`.

    Args:
        path: .off, .obj, .stl, .ply; .gltf, .3mf, .step and more where the library was built with their modules.
        format: by content, then name, if None.
        deflection: STEP and IGES: how far triangles may lie from a curved surface, as a part of the diagonal; 0 = 0.001.
        external: which other files the mesh may refer to, such as the buffers of a glTF: "folder" = in its own folder or below,
            "any" = wherever it says, "none". What is refused is a warning, or an error where the mesh cannot be read without.
    """
    options = _core.new("vxm_mesh_read_options", deflection=deflection, external=_core.choice(external, "VXM_EXTERNAL_"))
    name = ffi.new("char[]", format.encode()) if format else ffi.NULL
    options.format = name
    return Mesh._of(_core.create("vxm_mesh", lib.vxm_mesh_read_with, _core.context(), _core.path_bytes(path), options,
                                 destroy=lib.vxm_mesh_destroy))


def as_mesh(source: MeshLike) -> Mesh:
    """A Mesh of a mesh, a file, (vertices, faces), or an object with `vertices` and `faces` such as trimesh's."""
    if isinstance(source, Mesh):
        return source
    if isinstance(source, (tuple, list)) and len(source) == 2:
        return Mesh(*source)
    if hasattr(source, "vertices") and hasattr(source, "faces"):
        return Mesh(source.vertices, source.faces)
    return load(source)


def info(mesh: MeshLike) -> dict:
    """What is wrong with a mesh or mesh file: see `Mesh.info`."""
    return as_mesh(mesh).info()


def repair(mesh: MeshLike, level: str = "clean", *, weld: Union[str, float] = "auto", keep_duplicates: bool = False,
           keep_orientation: bool = False, fill_holes: Union[int, str] = 0, fill: str = "fan", union: bool = False,
           wrap_alpha: float = 0.0, wrap_offset: float = 0.0, max_change: float = 0.0, drop_faces: int = 0,
           drop_volume: float = 0.0, separate: bool = False) -> Mesh:
    """A repaired copy; its `report` tells how many vertices or faces each pass has changed.

    Args:
        mesh: Mesh, path, (vertices, faces) or an object with these.
        level: how far to go: "clean", "manifold", "closed" or "solid".
        weld: "auto", "off", or a distance in model units.
        fill_holes: those of at most so many edges, or "all".
        fill: with what: "fan", "minimal" or "smooth".
        drop_faces, drop_volume: components with fewer faces, or less volume (model units cubed), are dropped.
        separate: where bodies share faces each gets its own (level "manifold"), so that no body is lost between others
            when they are voxelized. `voxelize` and the datasets do that.
    """
    source = as_mesh(mesh)
    options = _core.new("vxm_repair_options", keep_duplicates=keep_duplicates, keep_orientation=keep_orientation,
                        unite=union, wrap_alpha=wrap_alpha, wrap_offset=wrap_offset, max_change=max_change,
                        drop_faces=drop_faces, drop_volume=drop_volume)
    options.level = _core.choice(level, "VXM_LEVEL_")
    options.fill = _core.choice(fill, "VXM_FILL_")
    options.fill_holes = -1 if fill_holes == "all" else int(fill_holes)
    if isinstance(weld, str):
        options.weld = _core.choice(weld, "VXM_WELD_")
    else:
        options.weld, options.weld_tolerance = lib.VXM_WELD_TOLERANCE, weld
    report = ffi.new("vxm_repair_report *")
    function = lib.vxm_mesh_prepare if separate else lib.vxm_mesh_repair
    made = _core.create("vxm_mesh", function, report, source._pointer, options, destroy=lib.vxm_mesh_destroy)
    passes = {_core.text(getattr(report.passes[i], "pass")): report.passes[i].count for i in range(report.pass_count)}
    return Mesh._of(made, passes)
