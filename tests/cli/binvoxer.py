# SPDX-License-Identifier: BSD-3-Clause
"""trimesh's interface to binvox, with each of its options, unchanged: the voxels are where the mesh is.

binvoxer.py FOLDER ZLIB
"""

import os
import sys

import numpy
import trimesh
from trimesh.exchange import binvox

FOLDER, ZLIB = sys.argv[1:3]
assert binvox.binvox_encoder and binvox.binvox_encoder.startswith(FOLDER), binvox.binvox_encoder

sphere = trimesh.creation.icosphere(subdivisions=3, radius=2)
torus = trimesh.creation.torus(2, 0.7)
bracket = trimesh.util.concatenate([trimesh.creation.box((4, 2, 1)), trimesh.creation.cylinder(0.5, 3)])
for mesh in (sphere, torus, bracket):
    mesh.apply_translation((30, -4, 5))

D = 32


def voxels_of(mesh, **options):
    grid = binvox.voxelize_mesh(mesh, dimension=D, **options)
    assert isinstance(grid, trimesh.voxel.VoxelGrid) and grid.filled_count > 0, options
    return grid


def centres(grid, low, side, count=D):
    """Of voxels, by binvox's own formula; trimesh takes n - 1 voxels for the side."""
    return numpy.asarray(low) + (grid.sparse_indices + 0.5) * side / count


for mesh in (sphere, torus):
    low, side = mesh.bounds[0], mesh.extents.max()
    solid = voxels_of(mesh, exact=False)
    assert solid.shape == (D, D, D)
    inside = mesh.contains(centres(solid, low, side))
    assert inside.mean() > 0.99, inside.mean()
    assert abs(solid.filled_count * (side / D) ** 3 / mesh.volume - 1) < 0.05
    carved = voxels_of(mesh, exact=False, z_buffer_voting=False)
    voted = voxels_of(mesh, exact=False, z_buffer_carving=False)
    assert mesh.contains(centres(voted, low, side)).all()
    assert (carved.matrix | solid.matrix == carved.matrix).all()
    thick = voxels_of(mesh, exact=False, dilated_carving=True)
    assert (thick.matrix | carved.matrix == thick.matrix).all() and thick.filled_count > carved.filled_count
    exact = voxels_of(mesh)
    distance = numpy.abs(trimesh.proximity.signed_distance(mesh, centres(exact, low, side)))
    assert distance.max() <= side / D * 3 ** 0.5 / 2 * 1.0001, distance.max()
    lined = voxels_of(mesh, exact=False, wireframe=True)
    assert (lined.matrix | solid.matrix == lined.matrix).all() and lined.filled_count > solid.filled_count
    hollow = voxels_of(mesh, exact=False, remove_internal=True)
    assert (hollow.matrix | solid.matrix == solid.matrix).all() and hollow.filled_count < solid.filled_count / 2
    centred = voxels_of(mesh, exact=False, center=True)
    assert mesh.contains(centres(centred, mesh.bounds.mean(0) - side / 2, side)).mean() > 0.99
    box = (25, -8, 0, 35, 2, 10)
    boxed = voxels_of(mesh, exact=False, bounding_box=box)
    assert mesh.contains(centres(boxed, box[:3], 10)).mean() > 0.95
    halves = voxels_of(mesh, exact=False, downsample_factor=4, downsample_threshold=5)
    assert halves.shape == (D // 4,) * 3 and mesh.contains(centres(halves, low, side, D // 4)).mean() > 0.95
    fitted = voxels_of(mesh, exact=False, fit=True)
    assert fitted.filled_count == solid.filled_count

# Turned: as trimesh turns, anticlockwise about x and clockwise about z.
for x, z in ((1, 0), (0, 1), (2, 1), (3, 2)):
    turned = bracket.copy()
    for n in range(x):
        turned.apply_transform(trimesh.transformations.rotation_matrix(numpy.pi / 2, (1, 0, 0)))
    for n in range(z):
        turned.apply_transform(trimesh.transformations.rotation_matrix(-numpy.pi / 2, (0, 0, 1)))
    grid = voxels_of(bracket, rotate_x=x, rotate_z=z)
    distance = trimesh.proximity.closest_point(turned, centres(grid, turned.bounds[0], turned.extents.max()))[1]
    assert distance.max() <= turned.extents.max() / D * 3 ** 0.5 / 2 * 1.0001, (x, z, distance.max())

# Files of each type, named as Binvoxer expects; two of them are refused, which it raises.
path = os.path.join(FOLDER, "torus.ply")
torus.export(path)
for kind in binvox.Binvoxer.SUPPORTED_OUTPUT_TYPES:
    binvoxer = binvox.Binvoxer(dimension=D, file_type=kind, exact=False, use_offscreen_pbuffer=True, verbose=True)
    if kind in ("hips", "mira") or (kind == "schematic" and ZLIB != "yes"):
        try:
            binvoxer(path)
        except Exception as error:
            assert b"voxmend: " in error.output, error
            continue
        raise AssertionError(kind)
    assert os.path.getsize(binvoxer(path)) > 0, kind
count = voxels_of(torus, exact=False).filled_count
try:
    import meshio
    mesh = meshio.read(os.path.join(FOLDER, "torus.msh"))
    assert [c.type for c in mesh.cells] == ["hexahedron"] and len(mesh.cells[0].data) == count
except ImportError:
    print("without meshio")
try:
    import vtk
    reader = vtk.vtkStructuredPointsReader()
    reader.SetFileName(os.path.join(FOLDER, "torus.vtk"))
    reader.Update()
    points = reader.GetOutput()
    size = torus.extents.max() / D
    assert points.GetDimensions() == (D, D, D)
    numpy.testing.assert_allclose(points.GetOrigin(), torus.bounds[0] + size / 2, rtol=1e-6)
    numpy.testing.assert_allclose(points.GetSpacing(), size, rtol=1e-6)
    scalars = points.GetPointData().GetScalars()
    assert sum(scalars.GetValue(n) for n in range(D ** 3)) == count
except ImportError:
    print("without VTK")
try:
    binvox.Binvoxer(dimension=D)(path)
except OSError as error:
    assert "existing path" in str(error)
else:
    raise AssertionError("Binvoxer does not see the file")
print("ok")
