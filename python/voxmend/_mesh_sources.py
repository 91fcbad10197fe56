# SPDX-License-Identifier: BSD-3-Clause
"""What is taken for a mesh: files, arrays, and the meshes of other packages, by the names that they give their parts.

None of these packages is imported: an object that has such parts is such a mesh.
"""
from __future__ import annotations

import os
from typing import Any, List, Optional, Protocol, Tuple, Union

import numpy

from . import _core, _values
from ._core import ffi, lib
from ._errors import ArgumentError, EmptyError, KindError
from ._mesh import Mesh, format_name
from ._records import Census
from ._types import Array, ArrayLike, Floats, Path


class HasFaces(Protocol):
    """A mesh as trimesh and libigl's users have it."""

    @property
    def vertices(self) -> Any: ...

    @property
    def faces(self) -> Any: ...


class HasTriangles(Protocol):
    """A mesh of open3d.geometry."""

    @property
    def vertices(self) -> Any: ...

    @property
    def triangles(self) -> Any: ...


class HasTensors(Protocol):
    """A mesh of open3d.t.geometry."""

    @property
    def vertex(self) -> Any: ...

    @property
    def triangle(self) -> Any: ...


class HasPolygons(Protocol):
    """A mesh of pyvista: numbers of corners, each before its corners."""

    @property
    def points(self) -> Any: ...

    @property
    def faces(self) -> Any: ...


class HasCells(Protocol):
    """A mesh of meshio."""

    @property
    def points(self) -> Any: ...

    @property
    def cells(self) -> Any: ...


class IsScene(Protocol):
    """A scene of trimesh: meshes by name, and a graph that says where each stands."""

    @property
    def geometry(self) -> Any: ...

    @property
    def graph(self) -> Any: ...


class IsFile(Protocol):
    """A file that is open for reading."""

    def read(self) -> Any: ...


MeshLike = Union[Mesh, Path, Tuple[ArrayLike, ArrayLike], HasFaces, HasTriangles, HasTensors, HasPolygons, HasCells, IsScene, IsFile]


# ---- Files ----

def _read_options(format: Optional[str], deflection: float, external: str, colors: bool) -> Tuple[Any, Any]:
    """The options, and what they point to."""
    name = format_name("load", format)
    options = _core.new("vxm_mesh_read_options", deflection=_values.real("load: deflection", deflection),
                        external=_core.choice("load: external", external, "VXM_EXTERNAL_"),
                        colors=_values.flag("load: colors", colors))
    options.format = name
    return options, name


def _need_name(path: Any) -> None:
    """Refuses what stands in a file where its name is wanted, which would be shown as one that is not there."""
    if not isinstance(path, (str, bytes)):
        return
    text = path if isinstance(path, str) else path.decode("latin-1")
    longest, least_binary = 4096, 84  # no path is longer; no .stl is shorter
    if len(text) > longest or text.count("\n") > 1 or (len(text) >= least_binary and "\0" in text):
        kind, stream = ("characters", "StringIO") if isinstance(path, str) else ("bytes", "BytesIO")
        raise ArgumentError("load: %d %s that are no path but what stands in a file; give its path, or io.%s(...) of them" %
                            (len(path), kind, stream))


def load(path: Union[Path, IsFile], format: Optional[str] = None, deflection: float = 0.0, external: str = "folder",
         colors: bool = False) -> Mesh:
    """Reads a mesh file; what a damaged file still holds is read, and its damage told as VoxmendWarning.

    Args:
        path: .off, .obj, .stl, .ply; .gltf, .3mf, .step and more where the library was built with their modules. "-" is
            standard input. Or a file that is open for reading: it is read to its end, and not closed.
        format: such as "stl" or "glb"; by content, then name, if None.
        deflection: STEP and IGES: how far triangles may lie from a curved surface, as a part of the diagonal; 0 = 0.001.
        external: which other files the mesh may refer to, such as the buffers of a glTF: "folder" = in its own folder or below,
            "any" = wherever it says, "none". What is refused is a warning, or an error where the mesh cannot be read without.
            Of an open file that has no path there is no folder.
        colors: keep colours, materials and textures too, for `voxmend.colors(mesh, by="mesh")` and `Mesh.look`.
    """
    options, name = _read_options(format, deflection, external, colors)
    _need_name(path)
    if not isinstance(path, (str, bytes, os.PathLike)) and hasattr(path, "read"):
        made, shown = _read_file(path, options)
    else:
        made = Mesh._of(_core.create("vxm_mesh", lib.vxm_mesh_read_with, _core.context(), _values.path(path), options,
                                     destroy=lib.vxm_mesh_destroy, path=path))
        shown = os.fsdecode(_values.path(path))
    del name  # until now the options point to it
    _core.warn(["%s: %s" % (shown, line) for line in made.warnings])
    return made


def _read_file(file: IsFile, options: Any) -> Tuple[Mesh, str]:
    content = file.read()
    if isinstance(content, str):
        content = content.encode("utf-8")
    if not isinstance(content, (bytes, bytearray, memoryview)):
        raise KindError("load: the file gives %s, neither bytes nor text" % type(content).__name__)
    name = getattr(file, "name", None)
    shown = os.fsdecode(name) if isinstance(name, (str, bytes)) else "<file>"
    data = ffi.from_buffer(content)
    made = _core.create("vxm_mesh", lib.vxm_mesh_read_memory_with, _core.context(), data, len(data), os.fsencode(shown), options,
                        destroy=lib.vxm_mesh_destroy)
    return Mesh._of(made), shown


# ---- Meshes of other packages ----

def _of_polygons(source: Any) -> Mesh:
    """pyvista: (n, corner 1, ..., corner n, n, ...); strips are cut up by pyvista itself."""
    if getattr(source, "n_strips", 0):
        source = source.triangulate()
    flat = numpy.asarray(source.faces)
    if flat.ndim != 1:
        return Mesh(source.points, source.faces)
    if len(flat) and int(flat[0]) > 0 and len(flat) % (int(flat[0]) + 1) == 0 and (flat[::int(flat[0]) + 1] == flat[0]).all():
        return Mesh(source.points, flat.reshape(-1, int(flat[0]) + 1)[:, 1:])
    faces, at = [], 0
    while at < len(flat):
        if int(flat[at]) < 0:
            raise ArgumentError("faces: %d corners of a face" % int(flat[at]))
        faces.append(flat[at + 1:at + 1 + int(flat[at])])
        at += 1 + int(flat[at])
    return Mesh(source.points, faces)


# Corners of the faces that meshio knows; others of their points lie on edges, or within.
_CORNERS = {"triangle": 3, "triangle6": 3, "triangle7": 3, "quad": 4, "quad8": 4, "quad9": 4, "polygon": 0}


def _of_cells(source: Any) -> Mesh:
    """meshio: the surface that it has; of a volume without one there is nothing to take."""
    blocks = [(block.type, block.data) for block in source.cells if block.type in _CORNERS]
    if not blocks:
        raise ArgumentError("mesh: the meshio.Mesh has no triangles, quadrilaterals or polygons, but %s" %
                            (", ".join(sorted({block.type for block in source.cells})) or "no cells"))
    cut = [numpy.asarray(data)[:, :_CORNERS[kind]] if _CORNERS[kind] else data for kind, data in blocks]
    if len(cut) == 1:
        return Mesh(source.points, cut[0])
    return Mesh(source.points, [row for block in cut for row in block])


def _moved(points: Floats, matrix: Floats) -> Floats:
    return numpy.asarray(points @ matrix[:3, :3].T + matrix[:3, 3])


def _of_scene(scene: Any) -> Mesh:
    """trimesh: every mesh where each node of the graph puts it; the nodes' names become tags. What is no mesh is left out."""
    points: List[Array] = []
    faces: List[Array] = []
    tags: List[str] = []
    numbers: List[Array] = []
    first = 0
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        mesh = scene.geometry[name]
        if not hasattr(mesh, "faces") or len(mesh.faces) == 0:
            continue
        placed = numpy.asarray(matrix, numpy.float64)
        corners = numpy.asarray(mesh.faces, numpy.int64) + first
        if numpy.linalg.det(placed[:3, :3]) < 0:  # a mirror turns faces inside out
            corners = corners[:, ::-1]
        points.append(_moved(numpy.asarray(mesh.vertices, numpy.float64), placed))
        faces.append(corners)
        numbers.append(numpy.full(len(corners), len(tags)))
        tags.append(str(node))
        first += len(points[-1])
    if not faces:
        raise EmptyError("mesh: there is no mesh in the scene")
    return Mesh(numpy.concatenate(points), numpy.concatenate(faces), tags=tags, face_tags=numpy.concatenate(numbers))


def _has(source: Any, *names: str) -> bool:
    return all(hasattr(source, name) for name in names)


def as_mesh(source: Any, colors: bool = False) -> Mesh:
    """A Mesh of what the type MeshLike stands for; a file is read with its colours on request."""
    if isinstance(source, Mesh):
        return source
    if isinstance(source, (tuple, list)) and len(source) == 2:
        return Mesh(*source)
    if isinstance(source, (str, bytes, os.PathLike)):
        return load(source, colors=colors)
    if _has(source, "geometry", "graph"):
        return _of_scene(source)
    if _has(source, "points", "faces"):
        return _of_polygons(source)
    if _has(source, "vertices", "faces"):
        return Mesh(source.vertices, source.faces)
    if _has(source, "vertex", "triangle"):
        return Mesh(source.vertex["positions"].numpy(), source.triangle["indices"].numpy())
    if _has(source, "vertices", "triangles"):
        return Mesh(numpy.asarray(source.vertices), numpy.asarray(source.triangles))
    if _has(source, "points", "extract_surface"):
        raise KindError("a mesh is wanted, and %s is a volume: its .extract_surface() is one" % type(source).__name__)
    if _has(source, "points", "cells"):
        return _of_cells(source)
    if callable(getattr(source, "read", None)):
        return load(source, colors=colors)
    raise KindError("a mesh is a Mesh, a path, an open file, (vertices, faces), or a mesh of trimesh, open3d, pyvista or meshio, "
                    "not %s" % type(source).__name__)


def info(mesh: MeshLike) -> Census:
    """What is wrong with a mesh or mesh file: see `Mesh.info`."""
    return as_mesh(mesh).info()
