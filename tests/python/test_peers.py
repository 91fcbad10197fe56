# SPDX-License-Identifier: BSD-3-Clause
"""Meshes and grids of trimesh, open3d, pyvista and meshio, there and back, and what scipy makes of grids; each is left out where
it is not installed, and the last line tells which. SAMPLES is a folder of what samples/generate_samples makes."""
import importlib
import os
import sys
import unittest
import warnings

import numpy

import voxmend

SAMPLES = os.environ["SAMPLES"]
NAMES = ("trimesh", "open3d", "pyvista", "meshio", "scipy.ndimage")
peers = {}
for _name in NAMES:
    try:
        peers[_name] = importlib.import_module(_name)
    except ImportError:
        pass


def needs(name):
    return unittest.skipUnless(name in peers, name + " is not installed")


def sample(name):
    return os.path.join(SAMPLES, name + ".off")


def same_mesh(test, one, other):
    numpy.testing.assert_allclose(one.vertices, other.vertices, rtol=1e-7)
    test.assertEqual(one.faces.tolist(), other.faces.tolist())


@needs("trimesh")
class Trimesh(unittest.TestCase):
    def test_mesh(self):
        mesh = voxmend.load(sample("torus"))
        made = mesh.to_trimesh()
        self.assertIsInstance(made, peers["trimesh"].Trimesh)
        self.assertAlmostEqual(made.volume, mesh.info().volume)
        same_mesh(self, voxmend.Mesh.of(made), mesh)
        self.assertEqual(voxmend.voxelize(made, 24), mesh.voxelize(24))

    def test_concave_polygons(self):
        for name in ("star_prism", "l_prism"):
            mesh = voxmend.load(sample(name))
            self.assertAlmostEqual(mesh.to_trimesh().volume, mesh.info().volume)
            self.assertAlmostEqual(mesh.to_trimesh().area, mesh.info().area)

    def test_scene(self):
        trimesh = peers["trimesh"]
        cube, ball = trimesh.creation.box((2, 2, 2)), trimesh.creation.icosphere(2)
        scene = trimesh.Scene()
        turn = trimesh.transformations.rotation_matrix(0.5, (1, 2, 3), (1, 0, 0))
        mirror = numpy.diag([-1.0, 1, 1, 1])
        mirror[0, 3] = 9
        scene.add_geometry(cube, node_name="box", geom_name="cube", transform=turn)
        scene.add_geometry(ball, node_name="ball", geom_name="ball", transform=trimesh.transformations.translation_matrix((4, 0, 0)))
        scene.add_geometry(ball, node_name="mirrored", geom_name="ball", transform=mirror)
        scene.add_geometry(trimesh.points.PointCloud([[90, 90, 90]]), node_name="cloud")
        mesh, wanted = voxmend.Mesh.of(scene), scene.to_mesh() if hasattr(scene, "to_mesh") else scene.dump(concatenate=True)
        numpy.testing.assert_allclose(mesh.info().bounds, wanted.bounds.ravel())
        self.assertAlmostEqual(mesh.info().volume, cube.volume + 2 * ball.volume)  # none inside out
        self.assertEqual(sorted(mesh.tags), ["ball", "box", "mirrored"])
        field = voxmend.labels(scene, 40, by="group")
        names = {name: number for number, name in field.label_names.items()}
        for name, place in (("box", turn[:3, 3] + turn[:3, :3] @ [0.5, 0.5, 0.5]), ("ball", [4, 0, 0]), ("mirrored", [9, 0, 0])):
            self.assertEqual(field.values[tuple(field.points_to_indices(place))], names[name])
        with self.assertRaises(voxmend.EmptyError):
            voxmend.Mesh.of(trimesh.Scene())

    def test_pitch(self):
        """The box of trimesh's voxelized(pitch), and in it all of its voxels: those of vertices of a mesh cut small, each of
        which lies in a voxel of the conservative surface."""
        trimesh = peers["trimesh"]
        rng = numpy.random.default_rng(5)
        meshes = [voxmend.load(sample(name)).to_trimesh() for name in ("torus", "rocket", "star_prism", "l_prism", "sphere")]
        meshes += [trimesh.creation.box(rng.random(3) + 0.2) for _ in range(8)]
        for number, mesh in enumerate(meshes):
            mesh.remove_unreferenced_vertices()
            mesh.apply_translation(rng.normal(size=3) * number)
            extent = float(numpy.ptp(mesh.vertices, axis=0).max())
            for pitch in (extent / 17.3, extent / 32, extent / 9, 0.25, 0.5):
                theirs = mesh.voxelized(pitch)
                for mode in ("solid", "surface", "both"):
                    grid = voxmend.voxelize(mesh, pitch=pitch, mode=mode)
                    self.assertEqual(grid.shape, tuple(theirs.shape))
                    numpy.testing.assert_allclose(grid.transform, theirs.transform, rtol=1e-12, atol=1e-12)
                surface = voxmend.voxelize(mesh, pitch=pitch, mode="surface", repair=False)
                self.assertEqual(int((theirs.matrix & ~surface.matrix).sum()), 0)

        used = voxmend.load(sample("rocket")).to_trimesh()  # which has a vertex of no face
        used.remove_unreferenced_vertices()
        self.assertLess(len(used.vertices), len(voxmend.load(sample("rocket")).vertices))
        self.assertEqual(voxmend.voxelize(sample("rocket"), pitch=0.25).shape, tuple(used.voxelized(0.25).shape))

    def test_grid(self):
        for matrix, pitch in ((numpy.random.default_rng(2).random((5, 9, 70)) < 0.3, (1, 2, 3)),
                              (voxmend.voxelize(sample("torus"), 20).matrix, 0.07)):
            grid = voxmend.VoxelGrid(matrix, pitch, (4, 5, 6))
            made = grid.to_trimesh()
            self.assertEqual(made.filled_count, grid.filled_count)
            numpy.testing.assert_allclose(made.points, grid.points)
            again = voxmend.VoxelGrid.from_trimesh(made)
            numpy.testing.assert_array_equal(again.matrix, grid.matrix)
            numpy.testing.assert_allclose(again.bounds, grid.bounds, rtol=1e-14)
            self.assertTrue((made.is_filled(grid.points) == grid.is_filled(grid.points)).all())
        ours = peers["trimesh"].creation.icosphere().voxelized(0.1)
        self.assertEqual(voxmend.VoxelGrid.from_trimesh(ours).filled_count, ours.filled_count)
        alike = voxmend.voxelize(sample("torus"), like=ours)
        numpy.testing.assert_allclose(alike.transform, ours.transform)
        self.assertEqual(alike.shape, tuple(ours.shape))
        ours.apply_transform(peers["trimesh"].transformations.rotation_matrix(0.3, (0, 0, 1)))
        with self.assertRaises(voxmend.ArgumentError):
            voxmend.VoxelGrid.from_trimesh(ours)
        with self.assertRaises(TypeError):
            voxmend.VoxelGrid.from_trimesh(3)


@needs("open3d")
class Open3d(unittest.TestCase):
    def test_mesh(self):
        mesh = voxmend.load(sample("torus"))
        made = mesh.to_open3d()
        self.assertAlmostEqual(made.get_volume(), mesh.info().volume, places=6)
        same_mesh(self, voxmend.Mesh.of(made), mesh)
        tensor = peers["open3d"].t.geometry.TriangleMesh.from_legacy(made)
        self.assertEqual(voxmend.Mesh.of(tensor).faces.tolist(), mesh.faces.tolist())
        self.assertEqual(voxmend.voxelize(made, 24), mesh.voxelize(24))

    def test_grid(self):
        grid = voxmend.voxelize(sample("star_prism"), 24, pad=2)
        made = grid.to_open3d()
        indices = numpy.array(sorted(voxel.grid_index.tolist() for voxel in made.get_voxels()))
        numpy.testing.assert_array_equal(indices, grid.sparse_indices)
        numpy.testing.assert_allclose(made.get_voxel_center_coordinate(indices[7]), grid.indices_to_points(indices[7]))
        with self.assertRaises(voxmend.ArgumentError):
            voxmend.VoxelGrid(numpy.ones((2, 2, 2)), (1, 1, 2)).to_open3d()


@needs("pyvista")
class Pyvista(unittest.TestCase):
    def test_mesh(self):
        for name in ("torus", "star_prism"):  # triangles; polygons of several numbers of corners
            mesh = voxmend.load(sample(name))
            made = mesh.to_pyvista()
            self.assertEqual((made.n_points, made.n_cells), (len(mesh.vertices), len(mesh.offsets) - 1))
            again = voxmend.Mesh.of(made)
            self.assertEqual((again.offsets.tolist(), again.indices.tolist()), (mesh.offsets.tolist(), mesh.indices.tolist()))
        self.assertEqual(voxmend.Mesh.of(peers["pyvista"].Sphere()).info().boundary_edges, 0)
        ball = peers["pyvista"].Sphere()
        self.assertAlmostEqual(voxmend.Mesh.of(ball).info().volume, ball.volume, places=5)
        strips = ball.strip()
        self.assertAlmostEqual(voxmend.Mesh.of(strips).info().volume, ball.volume, places=5)
        with self.assertRaisesRegex(TypeError, "extract_surface"):
            voxmend.Mesh.of(peers["pyvista"].ImageData(dimensions=(3, 3, 3)))

    def test_grid_and_field(self):
        grid = voxmend.VoxelGrid(numpy.random.default_rng(2).random((5, 9, 7)) < 0.3, (1, 2, 3), (4, 5, 6))
        made = grid.to_pyvista()
        centres, filled = made.cell_centers().points, made.cell_data["filled"]
        self.assertEqual(made.n_cells, 5 * 9 * 7)
        self.assertTrue((grid.is_filled(centres) == (filled > 0)).all())
        field = voxmend.colors(sample("torus"), 12, by="position")
        data = field.to_pyvista().cell_data["colors"].reshape(12, 12, 12, 4)  # z, y, x
        numpy.testing.assert_array_equal(data.transpose(2, 1, 0, 3), field.values)


@needs("meshio")
class Meshio(unittest.TestCase):
    def test_mesh(self):
        for name in ("torus", "star_prism"):
            mesh = voxmend.load(sample(name))
            again = voxmend.Mesh.of(mesh.to_meshio())
            self.assertAlmostEqual(again.info().volume, mesh.info().volume)
            self.assertEqual(len(again.offsets), len(mesh.offsets))
        meshio, points = peers["meshio"], voxmend.load(sample("torus")).vertices
        with self.assertRaisesRegex(ValueError, "tetra"):
            voxmend.Mesh.of(meshio.Mesh(points, [("tetra", [[0, 1, 2, 3]])]))
        six = meshio.Mesh(numpy.eye(6, 3), [("triangle6", [[0, 1, 2, 3, 4, 5]]), ("line", [[0, 1]]), ("quad", [[0, 1, 2, 3]])])
        self.assertEqual([len(face) for face in numpy.split(voxmend.Mesh.of(six).indices, [3])], [3, 4])


@needs("scipy.ndimage")
class Scipy(unittest.TestCase):
    def test_fill_and_hollow(self):
        ndimage = peers["scipy.ndimage"]
        rng = numpy.random.default_rng(8)
        for shape in ((9, 10, 11), (30, 4, 70)):
            grid = voxmend.VoxelGrid(rng.random(shape) < 0.7)
            numpy.testing.assert_array_equal(grid.fill().matrix, ndimage.binary_fill_holes(grid.matrix))
            numpy.testing.assert_array_equal(grid.hollow().matrix, grid.matrix & ~ndimage.binary_erosion(grid.matrix))

    def test_distance_to_the_solid(self):
        """Far from the surface, distances between voxels are within a voxel's diagonal of those to the mesh."""
        field = voxmend.distance(sample("torus"), 40, pad=6, band=0)
        outside = voxmend.voxelize(sample("torus"), like=field, thin="drop").matrix
        theirs = peers["scipy.ndimage"].distance_transform_edt(~outside, sampling=field.pitch)
        self.assertLess(abs(theirs - field.values)[~outside].max(), numpy.linalg.norm(field.pitch))

    def test_parts(self):
        """Connected voxels of parts that are apart are the labels."""
        boxes = [numpy.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float) + (3 * n, n, 0) for n in range(4)]
        sides = numpy.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
        mesh = (numpy.concatenate(boxes), numpy.concatenate([sides + 8 * n for n in range(4)]))
        field = voxmend.labels(mesh, 50)
        theirs, count = peers["scipy.ndimage"].label(field.values > 0)
        self.assertEqual(count, 4)
        numpy.testing.assert_array_equal(theirs, field.values)  # both number them along x


class Absent(unittest.TestCase):
    def test_told(self):
        """What is asked for of a package that is not there."""
        kept = dict(sys.modules)
        try:
            for name in ("trimesh", "open3d", "pyvista", "meshio"):
                sys.modules[name] = None
            mesh, grid = voxmend.load(sample("cube")), voxmend.voxelize(sample("cube"), 4)
            for call, name in ((mesh.to_trimesh, "trimesh"), (mesh.to_open3d, "open3d"), (mesh.to_pyvista, "pyvista"),
                               (mesh.to_meshio, "meshio"), (grid.to_trimesh, "trimesh"), (grid.to_pyvista, "pyvista"),
                               (grid.to_open3d, "open3d")):
                with self.assertRaisesRegex(voxmend.UnavailableError, name):
                    call()
        finally:
            for name in ("trimesh", "open3d", "pyvista", "meshio"):
                sys.modules.pop(name, None)
                if name in kept:
                    sys.modules[name] = kept[name]

    def test_none_is_imported(self):
        import subprocess
        program = ("import sys, voxmend; g = voxmend.voxelize(sys.argv[1], 8); "
                   "assert not {'trimesh', 'open3d', 'pyvista', 'meshio', 'tqdm', 'scipy', 'torch'} & set(sys.modules)")
        subprocess.run([sys.executable, "-c", program, sample("cube")], check=True)


if __name__ == "__main__":
    print("python %s, numpy %s; with %s" % (sys.version.split()[0], numpy.__version__, ", ".join(peers) or "no peer"))
    warnings.simplefilter("ignore", DeprecationWarning)
    unittest.main(verbosity=1)
