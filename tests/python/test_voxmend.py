# SPDX-License-Identifier: BSD-3-Clause
"""The package as its users see it. SAMPLES is a folder of what samples/generate_samples makes."""
import gc
import os
import pickle
import subprocess
import sys
import tempfile
import threading
import time
import types
import unittest
import weakref

import numpy

import voxmend

SAMPLES = os.environ["SAMPLES"]
VOXMEND = os.environ.get("VOXMEND")

# What tests/api/test_sampler.c makes too, and its hashes, with thin parts and of voxel centres alone.
ALL = dict(resolution=32, pad=1, seed=0x123456789ABCDEF0, rotate="any", scale=0.5, displace=0.03, mirror="xyz", translate=1)
KNOWN_HASH = 0xFCDFFBB6393EF3C2
KNOWN_CENTRES = 0x0C71FE46723E2B98
ALL_AS_OPTIONS = ("-r 32 --pad 1 --seed %d --epoch 2 --rotate any --scale 0.5 --displace 0.03 --mirror xyz --translate 1" %
                  ALL["seed"]).split()


def sample(name):
    return os.path.join(SAMPLES, name + ".off")


def cube(size=1.0):
    corners = numpy.array([[x, y, z] for x in (0, size) for y in (0, size) for z in (0, size)], float)
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return corners, faces


def fnv(data):
    value = 0xCBF29CE484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return value


class Meshes(unittest.TestCase):
    def test_load_and_info(self):
        mesh = voxmend.load(sample("torus"))
        info = mesh.info()
        self.assertTrue(info["watertight"] and info["closed"])
        self.assertEqual(info["faces"], len(mesh.faces))
        self.assertEqual(info, voxmend.info(sample("torus")))
        self.assertEqual(len(info["bounds"]), 6)
        self.assertEqual(mesh.format, "off")
        self.assertFalse(voxmend.info(sample("missing"))["closed"])

    def test_arrays_are_views(self):
        mesh = voxmend.load(sample("torus"))
        first, second = mesh.vertices, mesh.vertices
        self.assertTrue(numpy.shares_memory(first, second))
        self.assertFalse(first.flags.writeable)
        self.assertEqual(first.dtype, numpy.float64)
        kept = first.copy()
        del mesh, second  # the array keeps the mesh
        self.assertTrue((first == kept).all())

    def test_from_arrays(self):
        vertices, faces = cube()
        for points in (vertices, vertices.astype(numpy.float32), vertices[::-1][::-1], vertices.tolist()):
            mesh = voxmend.Mesh(points, faces)
            self.assertAlmostEqual(mesh.info()["volume"], 1.0)
            self.assertTrue((mesh.vertices == vertices).all())
            self.assertEqual(mesh.faces.tolist(), faces)
        triangles = mesh.triangles()
        self.assertEqual(triangles.shape, (12, 3))
        self.assertAlmostEqual(voxmend.Mesh(vertices, triangles).info()["volume"], 1.0)

    def test_sheets(self):
        sheet = voxmend.Mesh([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], [[0, 1, 2, 3]])
        plate = sheet.repair("closed", thickness=0.5).info()
        self.assertTrue(plate["watertight"])
        self.assertAlmostEqual(plate["volume"], 8)
        self.assertFalse(sheet.repair("closed", sheets="keep").info()["watertight"])
        self.assertEqual(len(sheet.repair("closed", sheets="drop").faces), 0)
        with self.assertRaises(voxmend.ArgumentError):
            sheet.repair("closed", sheets="fold")

    def test_remesh(self):
        cube = voxmend.remesh(sample("cube"), 20)
        self.assertTrue(cube.info()["watertight"])
        self.assertAlmostEqual(cube.info()["volume"], voxmend.info(sample("cube"))["volume"], delta=0.02)
        self.assertGreater(len(voxmend.remesh(sample("cube"), pitch=0.025).faces), len(cube.faces))

    def test_repair(self):
        mended = voxmend.repair(sample("doubled"))
        self.assertTrue(mended.info()["watertight"])
        self.assertGreater(mended.report["opposite_duplicate_faces"], 0)
        self.assertTrue(voxmend.load(sample("open_box")).repair("closed").info()["watertight"])
        self.assertFalse(voxmend.repair(sample("cracks"), weld="off").info()["watertight"])

    def test_save(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.ply")
            mesh = voxmend.load(sample("star_prism"))
            mesh.save(path)
            self.assertTrue((voxmend.load(path).vertices == mesh.vertices).all())

    def test_errors(self):
        with self.assertRaises(OSError) as caught:
            voxmend.load("no/such.off")
        self.assertIn("no/such.off", str(caught.exception))
        self.assertEqual(caught.exception.status, "io")
        with tempfile.NamedTemporaryFile(suffix=".off") as file:
            file.write(b"OFF\nthis is none\n")
            file.flush()
            with self.assertRaises(voxmend.FormatError) as caught:
                voxmend.load(file.name)
        self.assertEqual(caught.exception.status, "format")
        for vertices, faces in ((numpy.zeros((3, 2)), [[0, 1, 2]]), (numpy.zeros((3, 3)), [[0, 1, 3]]),
                                (numpy.zeros((3, 3)), [0, 1, 2])):
            with self.assertRaises(ValueError):
                voxmend.Mesh(vertices, faces)
        with self.assertRaises(ValueError):
            voxmend.repair(sample("cube"), "perfect")
        with self.assertRaises(MemoryError):
            voxmend.configure(memory_limit=10000)
            try:
                voxmend.voxelize(sample("torus"), 512)
            finally:
                voxmend.configure()


class Grids(unittest.TestCase):
    def test_voxelize(self):
        grid = voxmend.voxelize(cube(2.0), 10)
        self.assertEqual(grid.shape, (10, 10, 10))
        self.assertEqual(grid.filled_count, 1000)
        self.assertAlmostEqual(grid.volume, 8.0)
        self.assertTrue(numpy.allclose(grid.bounds, [[0, 0, 0], [2, 2, 2]]))
        self.assertTrue(numpy.allclose(grid.pitch, 0.2))
        self.assertEqual(grid.matrix.dtype, numpy.bool_)
        self.assertTrue(numpy.allclose(grid.points.mean(axis=0), 1))
        self.assertTrue(numpy.allclose(grid.transform @ [0, 0, 0, 1], [0.1, 0.1, 0.1, 1]))
        self.assertEqual(grid.report["closed_parts"], 1)

    def test_ways_to_name_a_mesh(self):
        class Trimesh:  # what matters of one
            def __init__(self, mesh):
                self.vertices, self.faces = mesh.vertices.copy(), mesh.faces.astype(numpy.int64)
        mesh = voxmend.load(sample("torus"))
        hashes = {voxmend.voxelize(m, 24).hash for m in
                  (mesh, sample("torus"), (mesh.vertices, mesh.faces), Trimesh(mesh), mesh.repair())}
        self.assertEqual(len(hashes), 1)
        self.assertEqual(mesh.voxelize(24).hash, hashes.pop())

    def test_bodies_that_share_faces(self):
        cube = numpy.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
        faces = numpy.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
        triangles = numpy.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
        both = (numpy.concatenate([cube, cube * [1, 1, 0.5]]), numpy.concatenate([triangles, triangles + 8]))
        self.assertEqual(voxmend.voxelize(both, 16).filled_count, 16 ** 3)  # not their difference
        self.assertEqual(voxmend.repair(both, separate=True).info()["components_raw"], 2)
        sampler = voxmend.Sampler(16, fill=True)
        sampler.put(voxmend.repair(both, separate=True))
        self.assertEqual(int(sampler.batch(1).sum()), 16 ** 3)

    def test_samplers_repair(self):
        """As voxelize does: of a box whose faces are drawn from both sides. What is repaired already stays as it is."""
        corners, faces = cube()
        both = voxmend.Mesh(corners, faces + [face[::-1] for face in faces])
        repaired = both.repair(separate=True)
        sampler = voxmend.Sampler(16, fill=True)
        turned = voxmend.Sampler(16, rotate="any", displace=0.01)  # by the numbers of the vertices
        made = []
        for mesh, repairs in ((both, True), (repaired, True), (repaired, False)):
            sampler.put(mesh, repair=repairs), turned.put(mesh, 1, repair=repairs)
            self.assertEqual(int(sampler.batch(1).sum()), 16 ** 3)
            made.append(turned.batch(3, model=1, dtype="bits"))
        made.append(pickle.loads(pickle.dumps(turned)).batch(3, model=1, dtype="bits"))
        for other in made[1:]:
            self.assertTrue((other == made[0]).all())
        sampler.put(both, repair=False)
        self.assertEqual(int(sampler.batch(1).sum()), voxmend.voxelize(both, 16, repair=False).filled_count)
        self.assertLess(int(sampler.batch(1).sum()), 16 ** 3)
        self.assertTrue((pickle.loads(pickle.dumps(sampler)).batch(1) == sampler.batch(1)).all())
        both.save("both.off")
        sampler.put("both.off")
        self.assertEqual(int(sampler.batch(1).sum()), 16 ** 3)
        with self.assertRaises(voxmend.KindError):
            sampler.put(both, repair="no")

    def test_spaces(self):
        mesh = voxmend.load(sample("torus"))
        self.assertTrue(numpy.allclose(mesh.voxelize(pitch=0.25).pitch, 0.25))
        self.assertEqual(mesh.voxelize((8, 9, 10), bounds=[[-3, -3, -3], [3, 3, 3]]).shape, (8, 9, 10))
        like = mesh.voxelize(16, pad=2, fit="sphere")
        other = voxmend.voxelize(cube(), like=like)
        self.assertTrue((other.origin == like.origin).all() and other.shape == like.shape)
        for wrong in (dict(resolution=8, pitch=1), dict(pitch=-1), dict(resolution=0), dict(resolution=(1, 2)),
                      dict(fit="round"), dict(bounds=[1, 2, 3]), dict(like=like, pad=1), dict(mode="thin"), dict(method="w"),
                      dict(bounds=[[-3, -2], [-1, 3], [4, 5]]), dict(bounds=numpy.zeros((6, 1))), dict(thin="keep26x"),
                      dict(thin="")):
            with self.assertRaises(ValueError, msg=str(wrong)):
                mesh.voxelize(**wrong)
        flat = mesh.voxelize((8, 9, 10), bounds=[-3, -3, -3, 3, 4, 5])
        self.assertEqual(flat.bounds.tolist(), [[-3, -3, -3], [3, 4, 5]])

    def test_like_trimesh(self):
        """What has the parts of a grid of trimesh lies where trimesh puts it, also where `origin` is a centre."""
        theirs = types.SimpleNamespace(shape=(4, 5, 6), encoding=None, transform=numpy.diag([0.5, 0.5, 0.5, 1]), origin=numpy.zeros(3),
                                       pitch=0.5)
        grid = voxmend.voxelize(cube(), like=theirs)
        self.assertEqual(grid.bounds.tolist(), [[-0.25] * 3, [1.75, 2.25, 2.75]])
        theirs.transform[0, 0] = -0.5
        with self.assertRaisesRegex(voxmend.ArgumentError, "mirrored"):
            voxmend.voxelize(cube(), like=theirs)

    def test_thin_parts(self):
        sheet = ([[0, 0, 0.03], [1, 0, 0.03], [1, 1, 0.03], [0, 1, 0.03]], [[0, 1, 2, 3]])
        box = dict(bounds=[[0, 0, -0.5], [1, 1, 0.5]], resolution=(10, 10, 10), repair=False)
        for thin, voxels in (("auto", 100), ("keep", 100), ("26", 100)):
            grid = voxmend.voxelize(sheet, thin=thin, **box)
            self.assertEqual((grid.filled_count, grid.report["thin_voxels"]), (voxels, voxels))
            self.assertAlmostEqual(grid.report["thin_share"], 1.0, delta=0.01)
        for choice in (dict(thin="drop"), dict(vote="majority"), dict(method="x")):
            with self.assertWarns(voxmend.VoxmendWarning):
                grid = voxmend.voxelize(sheet, **choice, **box)
            self.assertEqual((grid.filled_count, grid.report["thin_voxels"], grid.report["thin_share"]), (0, 0, 0))
        with self.assertRaisesRegex(ValueError, "none of 26, auto, drop, keep"):
            voxmend.voxelize(sheet, thin="most")
        for choice, words in ((dict(thin="drop"), 'thin="keep"'), (dict(bounds=[[5, 5, 5], [6, 6, 6]]), "bounds= or like=")):
            with self.assertWarnsRegex(voxmend.VoxmendWarning, words) as told:  # as Python has it, not the command line
                voxmend.voxelize(sheet, **{**box, **choice})
            self.assertNotIn("--", str(told.warning))

    def test_packed_and_matrix_agree(self):
        grid = voxmend.voxelize(sample("star_prism"), 70)
        packed = grid.packed
        self.assertTrue(numpy.shares_memory(packed, grid.packed))
        nx, ny, nz = grid.shape
        self.assertEqual(packed.shape, (nz, ny, (nx + 63) // 64))
        bits = numpy.unpackbits(packed.view(numpy.uint8), axis=-1, bitorder="little")[..., :nx]
        self.assertTrue((bits.transpose(2, 1, 0) == grid.matrix).all())
        del grid
        self.assertGreater(int(packed.sum()), 0)

    def test_from_matrix(self):
        rng = numpy.random.default_rng(3)
        for shape in ((5, 66, 3), (64, 1, 65), (130, 7, 64)):
            matrix = rng.random(shape) < 0.3
            grid = voxmend.VoxelGrid(matrix, (1, 2, 3), (4, 5, 6))
            self.assertTrue((grid.matrix == matrix).all())
            self.assertEqual(grid.filled_count, matrix.sum())
            self.assertEqual(grid.copy().hash, grid.hash)
            self.assertEqual(numpy.asarray(grid, numpy.float32).sum(), matrix.sum())
            at = numpy.argwhere(matrix)[3]
            self.assertEqual(grid.is_filled([grid.indices_to_points(at), [-1, 0, 0], [999, 0, 0]]).tolist(), [True, False, False])
            self.assertEqual((grid.is_filled([]).shape, grid.points_to_indices([4, 5, 6]).tolist()), ((0,), [0, 0, 0]))
            for ask in (grid.is_filled, grid.to_sparse().is_filled, grid.points_to_indices, grid.indices_to_points):
                for wrong in (5.0, [5.0], [[1], [2]], [[1, 2]], numpy.ones((3, 4))):  # numpy would take one number for three
                    with self.assertRaises(voxmend.ArgumentError, msg=str(wrong)):
                        ask(wrong)
        with self.assertRaises(ValueError):
            voxmend.VoxelGrid(numpy.zeros((2, 2)))

    def test_fill_and_hollow(self):
        solid = voxmend.voxelize(sample("torus"), 40, mode="both")
        shell = voxmend.voxelize(sample("torus"), 40, mode="surface")
        self.assertLess(shell.filled_count, solid.filled_count)
        self.assertEqual(shell.fill().hash, solid.hash)
        self.assertEqual(solid.hollow().fill().hash, solid.hash)
        full = voxmend.voxelize(sample("sphere"), 24)
        self.assertEqual(full.hollow().hash, voxmend.voxelize(sample("sphere"), 24, mode="surface", surface="shell6").hash)

    def test_boxes(self):
        grid = voxmend.voxelize(sample("star_prism"), 20)
        boxes = grid.as_boxes().info()
        self.assertAlmostEqual(boxes["volume"], grid.volume, delta=1e-2 * grid.volume)
        self.assertTrue(boxes["closed"])
        self.assertTrue(boxes["watertight"])

    def test_files(self):
        grid = voxmend.voxelize(sample("torus"), 21)
        with tempfile.TemporaryDirectory() as folder:
            for name in ("a.binvox", "a.npy", "a.raw", "a.rle", "a.nrrd"):
                path = os.path.join(folder, name)
                voxmend.write(grid, path)
                again = voxmend.read(path)
                self.assertEqual(again.hash, grid.hash, name)
                self.assertTrue(numpy.allclose(again.bounds, grid.bounds, atol=1e-6), name)
            self.assertTrue((numpy.load(os.path.join(folder, "a.npy")) == grid.matrix).all())
            grid.save(os.path.join(folder, "b.dat"), "rle")
            self.assertEqual(grid.compare(voxmend.read(os.path.join(folder, "b.dat")))["iou"], 1.0)
            with self.assertRaises(ValueError):
                grid.save(os.path.join(folder, "a.xyz"))

    def test_dlpack(self):
        grid = voxmend.voxelize(sample("torus"), 16)
        again = numpy.from_dlpack(grid)
        self.assertEqual(again.sum(), grid.filled_count)
        self.assertFalse(numpy.shares_memory(again, grid.matrix))

    def test_dlpack_of_bits(self):
        grid = voxmend.voxelize(sample("torus"), (70, 13, 16))
        bits = numpy.from_dlpack(grid.bits)
        self.assertTrue(numpy.shares_memory(bits, grid.packed))
        matrix, words, owner = numpy.array(grid.matrix), numpy.array(grid.packed), weakref.ref(grid)
        del grid
        gc.collect()
        self.assertIsNone(owner())  # its memory stays
        self.assertTrue((bits.view("<u8") == words).all())
        unpacked = numpy.unpackbits(bits, axis=2, count=70, bitorder="little")
        self.assertTrue((unpacked.transpose(2, 1, 0) == matrix).all())
        field = voxmend.coverage(sample("sphere"), 16)
        self.assertTrue(numpy.shares_memory(numpy.from_dlpack(field), field.values))

    def test_fields(self):
        values, origin, pitch = voxmend.distance(cube(), 16, pad=2, band=0)
        grid = voxmend.voxelize(cube(), 16, pad=2)
        self.assertTrue(((values < 0) == grid.matrix).all())
        self.assertTrue(numpy.allclose(origin, grid.origin) and numpy.allclose(pitch, grid.pitch))
        values, _, pitch = voxmend.coverage(sample("sphere"), 16)
        self.assertAlmostEqual(float(values.sum() * pitch.prod()), voxmend.info(sample("sphere"))["volume"], delta=0.05)


    def test_colors_of_a_volume(self):
        box = cube()
        volume = voxmend.VoxelField(numpy.arange(8.0).reshape(2, 2, 2), 4.0, (-4.0, -4.0, -4.0), "numbers")
        colors = voxmend.colors(box, 8, by="volume", volume=volume)
        grid = voxmend.voxelize(box, 8)
        at = numpy.clip((grid.origin + (numpy.argwhere(grid.matrix) + 0.5) * grid.pitch + 4) / 4 - 0.5, 0, 1)
        expected = (at @ [4, 2, 1]) / 7 * 255
        self.assertLess(abs(colors.values[grid.matrix][:, 0] - expected).max(), 0.51)
        for wrong in (dict(by="volume"), dict(volume=volume), dict(by="volume", volume=3)):
            with self.assertRaises((voxmend.ArgumentError, voxmend.KindError)):
                voxmend.colors(box, 8, **wrong)


class Variants(unittest.TestCase):
    def make(self, **changed):
        sampler = voxmend.Sampler(**dict(ALL, **changed))
        sampler.put(voxmend.load(sample("l_prism")), repair=False)  # as tests/api/test_sampler.c
        return sampler

    def test_bits_of_the_library(self):
        for threads in (1, 2, 3):
            voxmend.configure(threads)
            try:
                for _ in range(2):
                    self.assertEqual(fnv(self.make().batch(24, epoch=2, dtype="bits").tobytes()), KNOWN_HASH)
            finally:
                voxmend.configure()

    def test_bits_of_voxel_centres(self):
        self.assertEqual(fnv(self.make(thin="drop").batch(24, epoch=2, dtype="bits").tobytes()), KNOWN_CENTRES)

    def test_bits_of_engines(self):
        self.assertEqual(fnv(self.make(engine="cpu").batch(24, epoch=2, dtype="bits").tobytes()), KNOWN_HASH)
        for engine in ("opengl:osmesa", "opengl:egl-surfaceless", "opencl"):
            with self.subTest(engine=engine):
                try:
                    sampler = self.make(engine=engine)
                except voxmend.UnavailableError as error:
                    self.skipTest(str(error))
                self.assertEqual(fnv(sampler.batch(24, epoch=2, dtype="bits").tobytes()), KNOWN_HASH)
        with self.assertRaises(ValueError):
            self.make(engine="vulkan")

    @unittest.skipUnless(VOXMEND, "VOXMEND names no program")
    def test_bits_of_the_stream(self):
        made = subprocess.run([VOXMEND, "augment", sample("l_prism"), "-o", "-", "-q", "-n", "24"] + ALL_AS_OPTIONS,
                              stdout=subprocess.PIPE, check=True).stdout
        kind = numpy.dtype([("name", "<u4", 4), ("bits", "u1", (32, 32, 4))])
        records = numpy.frombuffer(made, kind, offset=64)
        self.assertTrue((records["bits"] == self.make().batch(24, epoch=2, dtype="bits")).all())
        self.assertEqual(records["name"].tolist(), [[0, 2, i, 0] for i in range(24)])

    def test_forms_agree(self):
        for resolution in (32, 21):
            sampler = self.make(resolution=resolution)
            bits, bytes_, floats = (sampler.batch(6, dtype=kind) for kind in ("bits", "uint8", "float32"))
            self.assertEqual(floats.shape, (6, 1) + 3 * (resolution,))
            self.assertEqual(floats.dtype, numpy.float32)
            unpacked = numpy.unpackbits(bits, axis=-1, count=resolution, bitorder="little")
            self.assertTrue((unpacked[:, None] == bytes_).all() and (floats == bytes_).all())
            self.assertTrue(floats.any(axis=(1, 2, 3, 4)).all())

    def test_any_order_and_into_memory(self):
        sampler = self.make()
        sampler.put(voxmend.load(sample("torus")), 5)
        whole = sampler.batch(10, epoch=1)
        names = numpy.array([[0, 1, 9], [5, 1, 3], [0, 1, 0], [0, 1, 4]])
        out = numpy.full(sampler.shape(4), 7, numpy.float32)
        self.assertIs(sampler.batch(names, out=out), out)
        self.assertTrue((out[[0, 2, 3]] == whole[[9, 0, 4]]).all())
        self.assertTrue((out[1] == sampler.batch([3], model=5, epoch=1)[0]).all())
        for wrong in (out.astype(float), out[:, :, ::2], out[:3], numpy.asfortranarray(out)):
            with self.assertRaises(ValueError):
                sampler.batch(names, out=wrong)

    def test_closed_stays_closed(self):
        for name in ("torus", "star_prism"):
            made = []
            for axis in "xyz":
                sampler = voxmend.Sampler(**dict(ALL, method=axis, parts="whole"))
                sampler.put(voxmend.load(sample(name)))
                made.append(sampler.batch(20, dtype="uint8"))
            self.assertTrue((made[0] == made[1]).all() and (made[0] == made[2]).all())

    def test_poses(self):
        mesh = voxmend.load(sample("star_prism"))
        # The triangles are fans, which cover more than a star: as sheets, which would be kept.
        sampler = voxmend.Sampler(**dict(ALL, displace=0, thin="drop"))
        sampler.put(mesh, repair=False)
        for index in range(5):
            pose = sampler.pose(index)
            moved = mesh.vertices @ pose["transform"][:, :3].T + pose["transform"][:, 3]
            grid = voxmend.voxelize((moved, mesh.triangles()), (32, 32, 32), bounds=[[0, 0, 0], [32, 32, 32]], repair=False,
                                    thin="drop")
            differ = (grid.matrix != (sampler.batch([index])[0, 0] > 0)).sum()
            self.assertLessEqual(differ, 2)  # both are rounded
            self.assertTrue(numpy.allclose(pose["rotation"] @ pose["rotation"].T, numpy.eye(3)))

    def test_ways_to_rotate(self):
        turns = numpy.array([numpy.eye(3), [[0, -1, 0], [1, 0, 0], [0, 0, 1]]])
        sampler = voxmend.Sampler(16, rotate=turns)
        sampler.put(voxmend.load(sample("l_prism")))
        self.assertTrue((sampler.pose(3)["rotation"] == turns[1]).all())
        made = sampler.batch(2)[:, 0]
        self.assertTrue((made[1] == numpy.rot90(made[0], 1, (0, 1))).all())
        sampler = voxmend.Sampler(16, rotate="z")
        sampler.put(voxmend.load(sample("l_prism")))
        self.assertTrue(numpy.allclose(sampler.pose(3)["rotation"][2], [0, 0, 1]))
        for wrong in ("w", [1, 2], numpy.ones((2, 3, 3)), numpy.zeros((0, 3, 3))):
            with self.assertRaises(ValueError):
                voxmend.Sampler(16, rotate=wrong)
        turns[1, 2, 2] = -1
        with self.assertRaisesRegex(voxmend.ArgumentError, "matrix 1 .* mirror"):
            voxmend.Sampler(16, rotate=turns)

    def test_wrong_arguments(self):
        sampler = self.make()
        for call in (lambda: sampler.batch(2, model=4), lambda: sampler.batch([-1]), lambda: sampler.batch(2, dtype="int"),
                     lambda: sampler.batch([[1, 2]]), lambda: sampler.pose(0, model=9), lambda: voxmend.Sampler(0 - 1),
                     lambda: voxmend.Sampler(mirror="a"), lambda: voxmend.Sampler(scale=2), lambda: voxmend.Sampler(9, pad=5)):
            with self.assertRaises(ValueError):
                call()
        sampler.put(None)
        with self.assertRaises(voxmend.ArgumentError):
            sampler.batch(1)

    def test_other_threads_run_meanwhile(self):
        """While a batch is made, a Python thread counts."""
        sampler = voxmend.Sampler(256, rotate="any")
        sampler.put(voxmend.load(sample("torus")))
        sampler.batch(1, dtype="bits")
        counts, stop = [0], threading.Event()

        def count():
            while not stop.is_set():
                counts[0] += 1
                time.sleep(0.0002)
        thread = threading.Thread(target=count)
        thread.start()
        before, start = counts[0], time.perf_counter()
        while time.perf_counter() - start < 0.3:
            begin = counts[0]
            sampler.batch(40, dtype="bits")
            inside = counts[0] - begin
            if inside > 3:
                break
        stop.set()
        thread.join()
        self.assertGreater(inside, 3)
        self.assertGreater(counts[0], before)

    def test_after_a_fork(self):
        sampler = self.make()
        expected = sampler.batch(8, dtype="bits")
        child = os.fork()
        if child == 0:
            os._exit(0 if (sampler.batch(8, dtype="bits") == expected).all() else 1)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)


if __name__ == "__main__":
    print("python %s, numpy %s, voxmend %s" % (sys.version.split()[0], numpy.__version__, voxmend.__version__))
    unittest.main(verbosity=1)
