# SPDX-License-Identifier: BSD-3-Clause
"""Grids for other packages, each imported when it is asked for, and grids of theirs."""
from __future__ import annotations

from typing import Any

import numpy

from ._errors import ArgumentError, KindError
from ._grid import VoxelGrid
from ._mesh_convert import package
from ._space import Placed, place_of_trimesh
from ._types import Array


def to_trimesh(grid: VoxelGrid) -> Any:
    return package("trimesh").voxel.VoxelGrid(numpy.array(grid.matrix), transform=grid.transform)


def from_trimesh(source: Any) -> VoxelGrid:
    if not all(hasattr(source, name) for name in ("matrix", "transform")):
        raise KindError("from_trimesh: %s has no matrix and transform" % type(source).__name__)
    origin, sizes = place_of_trimesh("from_trimesh", source)
    return VoxelGrid(source.matrix, sizes, origin)


def image_data(placed: Placed, name: str, values: Array) -> Any:
    """A pyvista.ImageData of one cell for each voxel."""
    pyvista = package("pyvista")
    out = pyvista.ImageData(dimensions=[n + 1 for n in placed.shape], spacing=placed.pitch.tolist(),
                            origin=placed.origin.tolist())
    channels = values.shape[3:]
    out.cell_data[name] = values.transpose(2, 1, 0, 3).reshape((-1,) + channels) if channels else values.flatten(order="F")
    return out


def to_pyvista(grid: VoxelGrid) -> Any:
    return image_data(grid, "filled", grid.matrix.view(numpy.uint8))


def to_open3d(grid: VoxelGrid) -> Any:
    sizes = grid.pitch
    if not numpy.allclose(sizes, sizes[0], rtol=1e-9):
        raise ArgumentError("to_open3d: the voxels are no cubes, and open3d has no others")
    open3d = package("open3d")
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(grid.points))
    least, greatest = grid.bounds
    return open3d.geometry.VoxelGrid.create_from_point_cloud_within_bounds(cloud, float(sizes[0]), least, greatest)
