# SPDX-License-Identifier: BSD-3-Clause
"""Meshes for other packages, each imported when it is asked for."""
from __future__ import annotations

import importlib
from typing import Any, List, Tuple

import numpy

from ._errors import UnavailableError
from ._mesh import Mesh
from ._types import Array


def package(name: str) -> Any:
    """Another package, or an UnavailableError that names it."""
    try:
        return importlib.import_module(name)
    except ImportError as problem:
        raise UnavailableError("%s cannot be imported: %s (pip install %s)" % (name, problem, name.split(".")[0])) from None


def to_trimesh(mesh: Mesh) -> Any:
    return package("trimesh").Trimesh(mesh.vertices.copy(), mesh.triangulated().faces.astype(numpy.int64), process=False)


def to_open3d(mesh: Mesh) -> Any:
    open3d = package("open3d")
    return open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(mesh.vertices.copy()),
                                        open3d.utility.Vector3iVector(mesh.triangulated().faces.astype(numpy.int32)))


def to_pyvista(mesh: Mesh) -> Any:
    sizes = numpy.diff(mesh.offsets.astype(numpy.int64))
    flat = numpy.insert(mesh.indices.astype(numpy.int64), mesh.offsets[:-1].astype(numpy.int64), sizes)
    return package("pyvista").PolyData(mesh.vertices.copy(), flat)


def to_meshio(mesh: Mesh) -> Any:
    sizes, offsets = numpy.diff(mesh.offsets.astype(numpy.int64)), mesh.offsets.astype(numpy.int64)
    cells: List[Tuple[str, Array]] = []
    for size in numpy.unique(sizes):
        first = offsets[:-1][sizes == size]
        corners = mesh.indices[first[:, None] + numpy.arange(size)].astype(numpy.int64)
        cells.append(({3: "triangle", 4: "quad"}.get(int(size), "polygon"), corners))
    return package("meshio").Mesh(mesh.vertices.copy(), cells)
