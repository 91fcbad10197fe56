# SPDX-License-Identifier: BSD-3-Clause
"""Fields, engines, octrees, sets, defects, progress and timeouts, each compared with what numpy alone makes of it. SAMPLES is a
folder of what samples/generate_samples makes."""
import copy
import io
import itertools
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

import numpy

import voxmend

SAMPLES, VOXMEND = os.environ["SAMPLES"], os.environ["VOXMEND"]


def sample(name):
    return os.path.join(SAMPLES, name + ".off")


def box(size, at=(0, 0, 0)):
    corners = numpy.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float) * size + at
    return corners, numpy.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])


def boxes(*placed):
    """Meshes side by side, as arrays."""
    points = [box(*one)[0] for one in placed]
    faces = [box(*one)[1] + 8 * n for n, one in enumerate(placed)]
    return numpy.concatenate(points), numpy.concatenate(faces)


class Fields(unittest.TestCase):
    def test_labels_of_boxes(self):
        """Two boxes: each voxel has the label of the one that its centre lies in."""
        mesh = boxes((2, (0, 0, 0)), (1, (3, 0, 0)))
        field = voxmend.labels(mesh, voxel_size=0.25, fit="tight")
        centres = field.indices_to_points(numpy.argwhere(numpy.ones(field.shape)))
        first, second = (centres < 2).all(axis=1), (centres[:, 0] > 3) & (centres[:, 1:] < 1).all(axis=1)
        self.assertTrue((field.values.ravel() == first + 2 * second).all())
        self.assertEqual((field.kind, field.values.dtype), ("labels", numpy.uint16))
        self.assertEqual([(label.number, label.voxels) for label in field.labels], [(1, 512), (2, 64)])
        self.assertEqual(field.label_names, {1: "part 1", 2: "part 2"})
        self.assertEqual((field.report.labels, field.report.voxelize.voxels), (2, 576))
        again = pickle.loads(pickle.dumps(field))
        self.assertEqual((again.labels, again.report), (field.labels, field.report))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "labels.npy")
            field.save(path)
            read = voxmend.read_field(path)
            self.assertEqual((read.labels, read.kind), (field.labels, "labels"))
            self.assertTrue((read.values == field.values).all() and (numpy.load(path) == field.values).all())

    def test_labels_of_groups_and_materials(self):
        corners, faces = boxes((2, (0, 0, 0)), (1, (3, 0, 0)), (1, (5, 0, 0)))
        tags = numpy.repeat([0, 1, 0], 6)
        mesh = voxmend.Mesh(corners, faces, tags=["left/red", "right/red"], face_tags=tags)
        groups = voxmend.labels(mesh, 24, by="group")
        self.assertEqual(groups.label_names, {1: "left", 2: "right"})
        self.assertEqual([label.name for label in voxmend.labels(mesh, 24, by="material").labels], ["red"])
        self.assertEqual(int(groups.values[0, 12, 12]), 1)
        walled = voxmend.Mesh(*boxes((1, (0, 0, 0)), (1, (1, 0, 0))), tags=["a/x", "b/y"], face_tags=tags[:len(tags) // 3 * 2])
        for by, repair in (("group", True), ("material", True), ("group", False)):
            shared = voxmend.labels(walled, 8, by=by, repair=repair)
            self.assertEqual([label.voxels for label in shared.labels], [64, 64])
        for wrong in (dict(by="colour"), dict(by="group", mode="x")):
            with self.assertRaises(ValueError):
                voxmend.labels(mesh, 8, **wrong)
        with self.assertRaises(ValueError):
            voxmend.Mesh(corners, faces, tags=["a"])
        with self.assertRaises(ValueError):
            voxmend.Mesh(corners, faces, tags=["a"], face_tags=tags)

    def test_colors(self):
        mesh = voxmend.load(sample("l_prism"))
        grid = voxmend.voxelize(mesh, 24)
        for by in ("noise", "position", "part"):
            field = voxmend.colors(mesh, 24, by=by)
            self.assertEqual((field.kind, field.values.shape, field.values.dtype), ("colors", (24, 24, 24, 4), numpy.uint8))
            self.assertTrue(((field.values[..., 3] == 255) == grid.matrix).all())
            self.assertFalse(field.values[~grid.matrix].any())
        position = voxmend.colors(mesh, 24, by="position").values
        along = [position[..., a][grid.matrix].astype(float) for a in range(3)]
        indices = numpy.argwhere(grid.matrix)
        for axis in range(3):  # red, green and blue grow along x, y and z
            self.assertGreater(numpy.corrcoef(along[axis], indices[:, axis])[0, 1], 0.999)
        with self.assertRaises(voxmend.ArgumentError):
            voxmend.colors(mesh, 8, by="glsl")
        with self.assertRaises(voxmend.ArgumentError):
            voxmend.colors(mesh, 8, source="vec3 color")
        with self.assertRaises(voxmend.UnavailableError):
            voxmend.colors(mesh, 8, by="glsl", source="vec3 color(vec3 p, vec3 u, uint n) { return u; }")

    def test_colors_of_the_mesh(self):
        """A red box and a blue one, by the colours of their vertices: each voxel has that of the box it lies in."""
        corners, faces = boxes((2, (0, 0, 0)), (1, (3, 0, 0)))
        shades = numpy.repeat([[255, 0, 0], [0, 0, 255]], 8, axis=0)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "two.ply")
            kinds = "".join("property %s\n" % p for p in ("float x", "float y", "float z", "uchar red", "uchar green", "uchar blue"))
            path.write_text("ply\nformat ascii 1.0\nelement vertex 16\n%selement face 12\nproperty list uchar int vertex_indices\nend_header\n"
                            % kinds + "".join("%g %g %g %d %d %d\n" % (*p, *s) for p, s in zip(corners, shades)) +
                            "".join("4 %d %d %d %d\n" % tuple(f) for f in faces))
            mesh = voxmend.load(path, colors=True)
            for given in (path, str(path), mesh, open(path, "rb")):
                for average in (False, True):
                    field = voxmend.colors(given, voxel_size=0.25, fit="tight", by="mesh", average=average)
                    centres = field.indices_to_points(numpy.argwhere(field.values[..., 3]))
                    wanted = numpy.where(centres[:, :1] < 2.5, [255, 0, 0, 255], [0, 0, 255, 255])
                    numpy.testing.assert_array_equal(field.values[field.values[..., 3] > 0], wanted)
                    self.assertEqual(len(centres), 576)
                    if hasattr(given, "close"):
                        given.seek(0)
            given.close()
            self.assertEqual((mesh.look.has_colors, mesh.look.vertex_colors, mesh.look.materials, mesh.look.textures), (True, True, 0, ()))
            for plain in (voxmend.load(path), mesh.repair(), (corners, faces)):
                self.assertFalse(voxmend.Mesh.of(plain).look.has_colors)
                with self.assertRaisesRegex(voxmend.ArgumentError, "without its colours"):
                    voxmend.colors(plain, 8, by="mesh")

    def test_coverage_of_a_box(self):
        """A box that ends in the middle of voxels: the share is the product along the axes."""
        share = numpy.array([1, 1, 0.5, 0])
        field = voxmend.coverage(box(2.5), (4, 4, 4), bounds=[[0, 0, 0], [4, 4, 4]], subdivision=2)
        wanted = share[:, None, None] * share[:, None] * share
        numpy.testing.assert_allclose(field.values, wanted)
        self.assertAlmostEqual(field.report.volume, wanted.sum())
        self.assertEqual(field.report.full, 8)
        numbers = voxmend.coverage(box(2.5), (4, 4, 4), bounds=[[0, 0, 0], [4, 4, 4]], subdivision=2, dtype="uint8")
        numpy.testing.assert_array_equal(numbers.values, numpy.floor(255 * wanted + 0.5))

    def test_distance_of_a_box(self):
        field = voxmend.distance(box(2), pad=4, voxel_size=0.25, fit="tight", band=0)
        points = field.indices_to_points(numpy.argwhere(numpy.ones(field.shape)))
        beyond = abs(points - 1) - 1
        wanted = numpy.linalg.norm(numpy.maximum(beyond, 0), axis=1) + numpy.minimum(beyond.max(axis=1), 0)
        numpy.testing.assert_allclose(field.values.ravel(), wanted, atol=1e-6)
        self.assertEqual((field.report.min, field.report.max), (field.values.min(), field.values.max()))
        values, origin, pitch = field
        self.assertIs(values, field.values)
        self.assertTrue((origin == field.origin).all() and (pitch == 0.25).all())
        self.assertTrue((numpy.asarray(field) == values).all())
        self.assertFalse(values.flags.writeable)
        self.assertEqual(field.threshold(below=0), voxmend.voxelize(box(2), like=field))
        self.assertTrue((voxmend.distance(box(2), like=field, band=0, unsigned=True).values == abs(values)).all())

    def test_shares_of_variants(self):
        """A box that fills half of a row of voxels along x: as floats, as bytes, and in a copy of the sampler."""
        corners = numpy.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]) * [5.0, 8, 8]
        faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        sampler = voxmend.Sampler(8, fill=True, coverage=4)
        sampler.put((corners, faces))
        share = numpy.array([0, 0.5, 1, 1, 1, 1, 0.5, 0])
        for one in (sampler, pickle.loads(pickle.dumps(sampler))):
            self.assertTrue((one.batch(1)[0, 0] == share[:, None, None]).all())
        self.assertTrue((sampler.batch(1, dtype="uint8")[0, 0] == numpy.floor(255 * share + 0.5)[:, None, None]).all())
        with self.assertRaises(voxmend.ArgumentError):
            sampler.batch(1, dtype="bits")
        with self.assertRaises(voxmend.ArgumentError):
            voxmend.Sampler(8, coverage=3)

    def test_carve(self):
        """A box that goes along x, is lifted, and turns: what it meets is counted, and the stock stays."""
        stock = voxmend.VoxelGrid(numpy.ones((12, 8, 8), bool), pitch=0.5)
        corners = numpy.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) * 0.5
        faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        wanted = numpy.ones(stock.shape, bool)
        wanted[1:9, 1:3, 1:3] = False
        path = [[1.0, 1, 1], [4.0, 1, 1]]
        self.assertTrue((stock.carve((corners, faces), path).matrix == wanted).all())
        self.assertTrue((stock.to_sparse().carve((corners, faces), path).to_grid().matrix == wanted).all())
        self.assertEqual(stock.filled_count, 12 * 8 * 8)
        carver = voxmend.Carver(stock, (corners, faces))
        self.assertEqual(carver.place(path[0]), voxmend.CarveReport(8, (1, 1, 1), (3, 3, 3)))
        self.assertEqual(carver.move(path[1] + [2, 0, 0, 0]).removed, 24)
        self.assertTrue((carver.grid().matrix == wanted).all())
        quarter = numpy.array([[0, -1, 0, 4.5], [1, 0, 0, 1], [0, 0, 1, 1.0]])
        turned = carver.move(quarter)
        self.assertGreaterEqual(turned.removed, 4)
        self.assertLessEqual(turned.removed, 4 * 4)  # corners go beyond the box, along x and y
        self.assertEqual(carver.move([9.0, 9, 9]).end[0], 12)
        for wrong in ([1.0, 2], [[1.0, 2, 3]], numpy.ones((3, 3)), [1.0, 2, 3, 0, 0, 0, 0], -numpy.eye(4)):
            with self.assertRaises(voxmend.ArgumentError):
                carver.move(wrong)
        matrix = numpy.eye(4)
        matrix[:3, 3] = path[0]
        self.assertEqual(voxmend.Carver(stock, (corners, faces)).place(matrix).begin, (1, 1, 1))
        with self.assertRaisesRegex(voxmend.ArgumentError, "transpose"):  # else it would cut about the origin
            carver.place(matrix.T)
        with self.assertRaises(voxmend.KindError):
            voxmend.Carver(numpy.ones((2, 2, 2)), (corners, faces))

    def test_confidence(self):
        self.assertIsNone(voxmend.voxelize(sample("open_box"), 16).confidence)
        sure = voxmend.voxelize(sample("torus"), 16, confidence=True)
        self.assertTrue((sure.confidence.values == 255).all())  # it is closed
        mesh = voxmend.load(sample("cracks")) if os.path.exists(sample("cracks")) else voxmend.load(sample("open_box"))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            grid = voxmend.voxelize(mesh, (20, 17, 9), bounds=[[-1, -1, -1], [2, 2, 2]], confidence=True, repair=False,
                                    vote="majority")
        field = grid.confidence
        self.assertEqual((field.kind, field.values.dtype, field.shape), ("confidence", numpy.uint8, grid.shape))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "c.npy")
            field.save(path)
            numpy.testing.assert_array_equal(numpy.load(path), field.values)
        for again in (pickle.loads(pickle.dumps(grid)), copy.deepcopy(grid)):
            numpy.testing.assert_array_equal(again.confidence.values, field.values)
        kept = grid.confidence.values
        before = kept.copy()
        del grid, field
        self.assertTrue((kept == before).all())  # the array keeps the grid

    def test_confidence_along_axes(self):
        """The share of voters that agree, of a sheet that only rays along z cross: voxels beyond it are the unsure ones."""
        sheet = ([[0, 0, 0.5], [1, 0, 0.5], [1, 1, 0.5], [0, 1, 0.5]], [[0, 1, 2, 3]])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            grid = voxmend.voxelize(sheet, (3, 4, 8), bounds=[[0, 0, 0], [1, 1, 1]], confidence=True, repair=False,
                                    vote="majority")
        values = grid.confidence.values
        self.assertEqual(values.shape, (3, 4, 8))
        for k in range(8):  # every layer is alike, and layers differ
            self.assertEqual(len(numpy.unique(values[:, :, k])), 1)
        self.assertGreater(len(numpy.unique(values)), 1)


class Rules(unittest.TestCase):
    """What would be of no effect is refused, as by the command line."""

    CHOICES = dict(mode=("solid", "surface", "both"), surface=("conservative", "thin", "shell26", "shell6"), method=("vote", "x"),
                   vote=("auto", "any"), parts=("auto", "group"), cavities=("auto", "fill"), thin=("keep", "drop"))

    def chosen(self):
        """Each choice of up to three options."""
        for names in (c for n in (1, 2, 3) for c in itertools.combinations(self.CHOICES, n)):
            for values in itertools.product(*(self.CHOICES[name] for name in names)):
                yield dict(zip(names, values))

    def refuses(self, make, **options):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                make(**options)
        except voxmend.ArgumentError:
            return True
        return False

    def test_as_the_command_line(self):
        refused = 0
        for options in self.chosen():
            words = [word for name, value in options.items() for word in ("--" + name, value)]
            told = subprocess.run([VOXMEND, "voxelize", sample("cube"), "-o", "no.npy", "-r", "2", "--dry-run", *words],
                                  capture_output=True)
            self.assertIn(told.returncode, (0, 2))
            refused += told.returncode == 2
            self.assertEqual(self.refuses(lambda **more: voxmend.voxelize(sample("cube"), 2, repair=False, **more), **options),
                             told.returncode == 2, (options, told.stderr))
        self.assertGreater(refused, 100)

    def test_everywhere(self):
        mesh, wrong = voxmend.load(sample("cube")), (
            (dict(surface="thin"), "mode='surface'"), (dict(mode="both", surface="shell6"), "leave out surface"),
            (dict(method="z", vote="any"), "method='vote'"), (dict(mode="surface", thin="keep"), "thin goes with the solid"),
            (dict(parts="whole", cavities="fill"), "parts='auto'"), (dict(mode="surface", vote="any"), "about the solid"))
        makers = dict(voxelize=lambda **more: voxmend.voxelize(mesh, 2, **more), labels=lambda **more: voxmend.labels(mesh, 2, **more),
                      voxelize_sparse=lambda **more: voxmend.voxelize_sparse(mesh, 2, **more),
                      colors=lambda **more: voxmend.colors(mesh, 2, **more), sampler=lambda **more: voxmend.Sampler(2, **more))
        for name, make in makers.items():
            for options, words in wrong:
                with self.assertRaisesRegex(ValueError, name + ": .*" + words):
                    make(**options)
            for options in (dict(mode="surface", surface="shell6", method="x", thin="keep"), dict(mode="both", surface="thin"),
                            dict(mode="surface", parts="group"), dict(vote="any", parts="auto", cavities="keep", thin="auto")):
                self.assertFalse(self.refuses(make, **options), (name, options))

    def test_others(self):
        with self.assertRaisesRegex(TypeError, "thin"):
            voxmend.distance(sample("cube"), 4, thin="keep")
        with self.assertRaisesRegex(ValueError, "by='mesh'"):
            voxmend.colors(sample("cube"), 4, average=True)
        with self.assertRaisesRegex(ValueError, "give one of them"):
            voxmend.Sampler(4, coverage=2, thin="drop")
        try:
            voxmend.configure(memory_limit=10000)
            with self.assertRaisesRegex(voxmend.OutOfMemoryError, r"raise it \(voxmend.configure\(memory_limit=...\)\)") as told:
                voxmend.voxelize(sample("cube"), voxel_size=1e-4)
            self.assertNotRegex(str(told.exception), r"-r\b|--")
        finally:
            voxmend.configure()


class Engines(unittest.TestCase):
    def test_same_bits(self):
        found = voxmend.engines()
        self.assertEqual(found[0].name, "cpu")
        mesh = voxmend.load(sample("star_prism"))
        wanted = mesh.voxelize(40)
        self.assertEqual(wanted.report.engine, "cpu")
        for info in found:
            if not info.available:
                self.assertTrue(info.note)
                continue
            grid = mesh.voxelize(40, engine=info.name)
            self.assertEqual((grid, grid.report.engine), (wanted, info.name))
            self.assertEqual(voxmend.voxelize_sparse(mesh, 40, engine=info.name).hash, wanted.hash)
            self.assertTrue((voxmend.labels(mesh, 40, engine=info.name).values > 0)[wanted.matrix].all())
        self.assertEqual(mesh.voxelize(40, engine="auto"), wanted)
        print("engines: " + ", ".join(info.name for info in found if info.available))

    def test_kept_engines(self):
        mesh = voxmend.load(sample("torus"))
        names = [info.name for info in voxmend.engines() if info.available and info.name.startswith(("opencl", "opengl:osmesa"))]
        for name in names:
            engine = voxmend.Engine(name)
            self.assertEqual(engine.info.name, name)
            wanted = mesh.voxelize(32)
            made = []
            threads = [threading.Thread(target=lambda: made.append(mesh.voxelize(32, engine=engine))) for _ in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(made, [wanted] * 4)
            child = os.fork()
            if child == 0:
                signal.alarm(60)
                os._exit(0 if engine._made is None else 1)
            self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)
            self.assertEqual(mesh.voxelize(32, engine=engine), wanted)

    def test_glsl(self):
        if not any(info.available and info.name.startswith("opengl") for info in voxmend.engines()):
            self.skipTest("there is no OpenGL")
        source = "vec3 color(vec3 position, vec3 unit, uint part) { return vec3(unit.x, 0.5, float(part) / 255.0); }"
        field = voxmend.colors(box(2), 8, by="glsl", source=source, engine="opengl")
        centres = (numpy.arange(8) + 0.5) / 8
        self.assertLessEqual(abs(field.values[:, 0, 0, 0] - 255 * centres).max(), 1)
        self.assertTrue((field.values[..., 2] == 1).all())
        with self.assertRaises(voxmend.ArgumentError):
            voxmend.colors(box(2), 8, by="glsl", source="vec3 colour", engine="opengl")

    def test_refused(self):
        for engine, kind in (("abacus", ValueError), (3, TypeError), (b"cpu", TypeError)):
            with self.assertRaises(kind):
                voxmend.voxelize(sample("cube"), 8, engine=engine)
        for wrong in (dict(slice_axis="w"), dict(cl_method="x"), dict(seed=-1), dict(displacement=-1)):
            with self.assertRaises(ValueError):
                voxmend.Engine("cpu", **wrong)

    def test_settings(self):
        voxmend.configure(threads=3, memory_limit=1 << 28)
        try:
            self.assertEqual((voxmend.settings().threads, voxmend.settings().memory_limit), (3, 1 << 28))
            voxmend.voxelize(sample("torus"), 128)
            self.assertGreater(voxmend.settings().peak_bytes, 128 ** 3 // 8)
        finally:
            voxmend.configure()


class Sets(unittest.TestCase):
    def grids(self):
        rng = numpy.random.default_rng(11)
        for shape in ((5, 66, 3), (64, 1, 65), (130, 7, 9)):
            yield [voxmend.VoxelGrid(rng.random(shape) < 0.4, (1, 2, 3), (4, 5, 6)) for _ in range(2)]

    def test_operations(self):
        for a, b in self.grids():
            for make in (lambda g: g, lambda g: g.to_sparse()):
                x, y = make(a), make(b)
                for made, wanted in ((x | y, a.matrix | b.matrix), (x & y, a.matrix & b.matrix), (x - y, a.matrix & ~b.matrix),
                                     (x ^ y, a.matrix ^ b.matrix), (~x, ~a.matrix)):
                    self.assertIs(type(made), type(x))
                    dense = made if isinstance(made, voxmend.VoxelGrid) else made.to_grid()
                    numpy.testing.assert_array_equal(dense.matrix, wanted)
                    self.assertEqual(made.filled_count, wanted.sum())
                    self.assertTrue((made.pitch == a.pitch).all() and (made.origin == a.origin).all())
                self.assertEqual(x ^ y, (x | y) - (x & y))
                self.assertNotEqual(x, y)

    def test_filled_box(self):
        for grid, _ in self.grids():
            self.assertIsNone((grid - grid).filled_box)
            begin, end = grid.filled_box
            at = grid.sparse_indices
            self.assertEqual((begin.tolist(), end.tolist()), (at.min(axis=0).tolist(), (at.max(axis=0) + 1).tolist()))
            self.assertEqual(grid.matrix[tuple(map(slice, begin, end))].sum(), grid.filled_count)

    def test_other_spaces(self):
        matrix = numpy.ones((3, 4, 5))
        grid = voxmend.VoxelGrid(matrix, 1, 0)
        for other, word in ((voxmend.VoxelGrid(matrix[1:], 1, 0), "3 x 4 x 5"), (voxmend.VoxelGrid(matrix, 1.01, 0), "1.01"),
                            (voxmend.VoxelGrid(matrix, 1, (0, 0.5, 0)), "0.5")):
            self.assertNotEqual(grid, other)
            for operation in (lambda a, b: a | b, lambda a, b: a & b, lambda a, b: a - b, lambda a, b: a ^ b):
                with self.assertRaisesRegex(voxmend.ArgumentError, word):
                    operation(grid, other)
                with self.assertRaisesRegex(voxmend.ArgumentError, word):
                    operation(grid.to_sparse(), other.to_sparse())
        self.assertEqual((grid | voxmend.VoxelGrid(matrix, 1 + 1e-9, 1e-9)).filled_count, 60)  # as files round it
        for wrong in (matrix, 3, None, grid.to_sparse()):
            with self.assertRaises(TypeError):
                grid | wrong

    def test_equality(self):
        one = voxmend.voxelize(sample("torus"), 40)
        for same in (copy.copy(one), pickle.loads(pickle.dumps(one)), voxmend.VoxelGrid(one.matrix, one.pitch, one.origin)):
            self.assertTrue(one == same and not one != same)
            self.assertEqual(hash(one), hash(same))
        changed = numpy.array(one)
        changed[3, 3, 3] ^= True
        self.assertNotEqual(one, voxmend.VoxelGrid(changed, one.pitch, one.origin))
        self.assertNotEqual(one, voxmend.VoxelGrid(one.matrix, one.pitch, one.origin + 1e-9))
        self.assertFalse(one == 3 or one == "grid" or one is None)
        self.assertEqual(len({one, copy.copy(one)}), 1)
        self.assertIn("40 x 40 x 40 voxels of 0.07 from (-1.4, -1.4, -1.4) on", repr(one))


class Sparse(unittest.TestCase):
    def check_coverage(self, sparse, dense):
        cubes = numpy.zeros([(n + 7) // 8 * 8 for n in dense.shape])
        cubes[tuple(slice(n) for n in dense.shape)] = dense.matrix
        wanted = cubes.reshape(sum(([n // 8, 8] for n in cubes.shape), [])).sum(axis=(1, 3, 5))
        field = sparse.coverage(8)
        self.assertEqual((field.kind, field.values.dtype), ("coverage", numpy.float32))
        numpy.testing.assert_array_equal(field.values, wanted / 512)
        part = sparse.coverage(8, (1, 2, 3), (4, 8, 5), "uint64")
        numpy.testing.assert_array_equal(part.values, wanted[1:4, 2:8, 3:5])
        numpy.testing.assert_allclose(part.origin, dense.origin + 8 * dense.pitch * (1, 2, 3))
        for wrong in (dict(subdivision=6), dict(begin=(1, 2)), dict(end=(1, 1, 99)), dict(dtype="int8")):
            with self.assertRaises(voxmend.ArgumentError):
                sparse.coverage(**wrong)

    def test_like_dense(self):
        mesh = voxmend.load(sample("star_prism"))
        for choice in (dict(), dict(mode="surface"), dict(thin="drop", method="x")):
            dense, sparse = mesh.voxelize(70, pad=2, **choice), voxmend.voxelize_sparse(mesh, 70, pad=2, **choice)
            self.assertEqual((sparse.hash, sparse.filled_count, sparse.shape), (dense.hash, dense.filled_count, dense.shape))
            self.assertEqual(sparse.to_grid(), dense)
            self.assertEqual(sparse.report.voxels, dense.filled_count)
            numpy.testing.assert_array_equal(sparse.sparse_indices, numpy.argwhere(dense.matrix))
            numpy.testing.assert_allclose(sparse.points, dense.points)
            self.assertEqual(sparse, voxmend.SparseGrid.from_grid(dense))
            self.check_coverage(sparse, dense)
            at = numpy.random.default_rng(1).integers(-5, 80, (500, 3))
            inside = ((at >= 0) & (at < 70)).all(axis=1)
            wanted = numpy.zeros(500, bool)
            wanted[inside] = dense.matrix[tuple(at[inside].T)]
            numpy.testing.assert_array_equal(sparse.is_set(at), wanted)
            numpy.testing.assert_array_equal(sparse.is_filled(sparse.indices_to_points(at)), wanted)

    def test_windows(self):
        rng = numpy.random.default_rng(4)
        dense = voxmend.VoxelGrid(numpy.kron(rng.random((9, 5, 7)) < 0.5, numpy.ones((8, 8, 8))) > 0, (1, 2, 3), (4, 5, 6))
        sparse = dense.to_sparse()
        for _ in range(40):
            begin = rng.integers(0, dense.shape)
            end = begin + 1 + rng.integers(0, numpy.array(dense.shape) - begin)
            window = sparse.window(begin, end)
            cut = tuple(slice(b, e) for b, e in zip(begin, end))
            numpy.testing.assert_array_equal(window.matrix, dense.matrix[cut])
            numpy.testing.assert_allclose(window.origin, dense.origin + begin * dense.pitch)
        for begin, end in (((0, 0, 0), (0, 1, 1)), ((0, 0, 0), (73, 1, 1)), ((-1, 0, 0), (1, 1, 1)), ((0, 0), (1, 1))):
            with self.assertRaises(ValueError):
                sparse.window(begin, end)

    def test_large(self):
        """4096 voxels along a side are 8 GiB of bits."""
        sparse = voxmend.voxelize_sparse(sample("torus"), 4096, mode="surface")
        self.assertEqual(sparse.shape, (4096, 4096, 4096))
        self.assertLess(sparse.nbytes, 1 << 28)
        window = sparse.window((2000, 2000, 2000), (2100, 2100, 2100))
        self.assertEqual(window.shape, (100, 100, 100))
        self.assertTrue(((sparse | ~sparse).filled_count, (sparse & ~sparse).filled_count) == (4096 ** 3, 0))

    def test_files_and_copies(self):
        sparse = voxmend.voxelize_sparse(sample("torus"), 50)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.npy")
            sparse.save(path)
            self.assertEqual(voxmend.read(path).hash, sparse.hash)
            sparse.save_indices(path)
            numpy.testing.assert_array_equal(numpy.load(path), sparse.sparse_indices)
            with self.assertRaises(NotADirectoryError):
                sparse.save(path / "b.npy")
        again = pickle.loads(pickle.dumps(sparse))
        self.assertEqual((again, again.report), (sparse, sparse.report))
        with self.assertRaises(TypeError):
            voxmend.SparseGrid(sparse.to_grid().matrix)


class SparseFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name, "a.octree")

    def check_windows(self, file, wanted, read):
        rng = numpy.random.default_rng(6)
        for _ in range(20):
            begin = rng.integers(0, file.shape)
            end = begin + 1 + rng.integers(0, numpy.array(file.shape) - begin)
            part = read(begin, end)
            values = part.matrix if isinstance(part, voxmend.VoxelGrid) else part.values
            numpy.testing.assert_array_equal(values, wanted[tuple(slice(b, e) for b, e in zip(begin, end))])
            numpy.testing.assert_allclose(part.origin, file.origin + begin * file.pitch)
        for begin, end in (((0, 0, 0), (0, 1, 1)), ((0, 0, 0), (601, 1, 1)), ((-1, 0, 0), (1, 1, 1)), ((0, 0), (1, 1))):
            with self.assertRaises(voxmend.ArgumentError):
                read(begin, end)

    def test_voxels(self):
        dense = voxmend.voxelize(voxmend.load(sample("star_prism")), 300, pad=2)
        sparse = dense.to_sparse()
        sparse.save(self.path)
        with voxmend.SparseFile(self.path) as file:
            self.assertEqual((file.shape, file.filled_count, file.has_values), (dense.shape, dense.filled_count, False))
            numpy.testing.assert_array_equal((file.origin, file.pitch), (dense.origin, dense.pitch))
            self.check_windows(file, dense.matrix, file.window)
            self.check_windows(file, dense.matrix, file.field)
            self.assertEqual(file.window(), dense)
            for side, part in ((8, {}), (256, {}), (4, dict(begin=(1, 2, 3), end=(60, 70, 50), dtype="uint64"))):
                numpy.testing.assert_array_equal(file.coverage(side, **part).values, sparse.coverage(side, **part).values)
            for wrong in (dict(subdivision=6), dict(begin=(1, 2)), dict(end=(1, 1, 99)), dict(dtype="int8")):
                with self.assertRaises(voxmend.ArgumentError):
                    file.coverage(**wrong)
            self.assertEqual(file.read(), sparse)
            self.assertIn("a.octree", repr(file))
        for call in (lambda: file.shape, lambda: file.window(), lambda: file.coverage(), lambda: file.__enter__()):
            with self.assertRaisesRegex(voxmend.ArgumentError, "closed"):
                call()
        file.close()
        self.assertIn("closed", repr(file))

    def test_values(self):
        labels = voxmend.labels(sample("star_prism"), 100, by="part")
        labels.save(self.path)
        file = voxmend.SparseFile(str(self.path))
        self.assertTrue(file.has_values)
        self.assertEqual(file.filled_count, (labels.values != 0).sum())
        self.check_windows(file, labels.values, file.field)
        for call in (file.window, file.coverage, file.read):
            with self.assertRaises(voxmend.NumbersError):
                call()

    def test_refused(self):
        with self.assertRaises(FileNotFoundError):
            voxmend.SparseFile(self.path)
        self.path.write_bytes(b"no octree")
        with self.assertRaises(voxmend.FormatError):
            voxmend.SparseFile(self.path)
        for wrong in (3, None):
            with self.assertRaises(TypeError):
                voxmend.SparseFile(wrong)


class Defects(unittest.TestCase):
    def test_positions(self):
        """Of a box without its lid: four open edges, where they are."""
        corners, faces = box(2)
        mesh = voxmend.Mesh(corners, faces[:-1])  # without z = 2
        defects = mesh.defects()
        group = defects["boundary_edge"]
        self.assertEqual((len(group), group.total, defects.total), (4, 4, 4))
        self.assertEqual((group.elements.shape, group.positions.shape), ((4, 2), (4, 2, 3)))
        for (a, b), ends in zip(group.elements, group.positions):
            numpy.testing.assert_array_equal(ends, corners[[a, b]])
            self.assertTrue((ends[:, 2] == 2).all())
        self.assertEqual([one.kind for one in defects], ["boundary_edge"])
        self.assertEqual(defects.counts["nonmanifold_edge"], 0)
        self.assertEqual(defects.counts["self_intersection"], -1)
        self.assertEqual(repr(defects), "<voxmend.Defects: 4 boundary_edge>")
        limited = mesh.defects(max_count=1)
        self.assertEqual((len(limited), limited["boundary_edge"].total), (1, 4))
        self.assertEqual(len(voxmend.Mesh(corners, faces).defects()), 0)
        with self.assertRaises(ValueError):
            defects["holes"]
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "d.ply")
            defects.save(path)
            self.assertEqual(len(voxmend.load(path).faces), 10 + 4 * 8)  # triangles, and rods

    def test_every_kind(self):
        corners, faces = box(1)
        nan = numpy.concatenate([corners, [[numpy.nan, 0, 0]]])
        self.assertEqual(voxmend.Mesh(nan, faces).defects().counts["nonfinite_vertex"], 1)
        twice = voxmend.Mesh(corners, numpy.concatenate([faces, faces[:1]])).defects()
        self.assertEqual((twice.counts["duplicate_face"], twice.counts["nonmanifold_edge"]), (1, 4))
        turned = numpy.concatenate([faces[:1, ::-1], faces[1:]])
        self.assertEqual(voxmend.Mesh(corners, turned).defects().counts["inconsistent_edge"], 4)
        flat = numpy.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]], [[0, 0, 1]]])
        self.assertEqual(voxmend.Mesh(corners, flat).defects().counts["degenerate_face"], 1)

    def test_reports(self):
        sheet = voxmend.Mesh(box(2)[0], box(2)[1][:-1])
        self.assertFalse(sheet.verify("closed").reached)
        finding = sheet.verify("closed").findings[0]
        self.assertEqual((finding.what, finding.count), ("boundary_edges", 4))
        self.assertEqual(len(finding.position), 3)
        mended = sheet.repair("closed", part_changes=True)
        self.assertTrue(mended.verify("closed").reached)
        self.assertEqual(mended.report.filled_holes, 1)
        (part,) = mended.part_changes
        self.assertEqual((part.before.boundary_edges, part.after.closed, part.tag), (4, True, None))
        self.assertAlmostEqual(part.after.volume, 8)
        doubled = voxmend.repair(sample("doubled"))
        self.assertEqual(doubled.report.passes["opposite_duplicate_faces"], doubled.report["opposite_duplicate_faces"])
        self.assertEqual(dict(doubled.report), doubled.report.passes)
        with self.assertRaises(KeyError):
            doubled.report["no such pass"]
        info = sheet.info()
        self.assertEqual((info.faces, info["faces"], dict(info)["watertight"]), (5, 5, False))
        self.assertEqual(pickle.loads(pickle.dumps(info)), info)
        self.assertFalse(sheet.report)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.ply")
            with self.assertRaises(voxmend.UnreachedError):
                sheet.save(path, level="closed")
            self.assertFalse(os.path.exists(path))
            mended.save(path, level="closed")
            self.assertTrue(voxmend.info(path).watertight)

    def test_every_field_is_told(self):
        """What the library adds to a report has to be added here."""
        from voxmend._core import ffi
        for name, kind, apart in (("vxm_census", voxmend.Census, ()), ("vxm_voxelize_report", voxmend.VoxelizeReport, ()),
                                  ("vxm_repair_report", voxmend.RepairReport, ("pass_count", "before", "after")),
                                  ("vxm_part_state", voxmend.PartState, ()), ("vxm_part_change", voxmend.PartChange, ()),
                                  ("vxm_distance_report", voxmend.DistanceReport, ()), ("vxm_label_report", voxmend.LabelReport, ()),
                                  ("vxm_coverage_report", voxmend.CoverageReport, ()), ("vxm_comparison", voxmend.Comparison, ()),
                                  ("vxm_engine_info", voxmend.EngineInfo, ()), ("vxm_look", voxmend.Look, ()),
                                  ("vxm_texture", voxmend.Texture, ())):
            there = {field for field, _ in ffi.typeof(name).fields} - {"size"} - set(apart)
            self.assertLessEqual(there, set(kind.__dataclass_fields__), name)

    def test_triangulated(self):
        """A concave polygon: a fan covers more than it."""
        outline = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [2, 1, 0], [0, 4, 0]]
        mesh = voxmend.Mesh(outline, [[1, 2, 3, 4, 0]], tags=["a", "b"], face_tags=[1])
        made = mesh.triangulated()
        points = made.vertices[made.faces]
        areas = numpy.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])[:, 2] / 2
        x, y = numpy.array(outline)[:, :2].T
        self.assertAlmostEqual(abs(areas).sum(), abs((x * numpy.roll(y, -1) - y * numpy.roll(x, -1)).sum()) / 2)
        self.assertTrue((areas > 0).all())
        self.assertEqual((made.tags, made.face_tags.tolist()), (["a", "b"], [1, 1, 1]))
        self.assertTrue((made.vertices == mesh.vertices).all())


class Progress(unittest.TestCase):
    def test_told(self):
        told = []
        with voxmend.watch(lambda phase, fraction: told.append((phase, fraction))):
            voxmend.distance(sample("rocket"), 160, band=0)
        self.assertGreater(len({phase for phase, _ in told}), 1)
        self.assertTrue(all(isinstance(phase, str) and 0 <= fraction <= 1 for phase, fraction in told))
        count = len(told)
        voxmend.voxelize(sample("cube"), 8)  # no more, once it is over
        self.assertEqual(len(told), count)
        inner = []
        with voxmend.watch(lambda *_: told.append(1)):
            voxmend.voxelize(sample("cube"), 8, progress=lambda *one: inner.append(one))
        self.assertTrue(inner)

    def test_what_it_raises(self):
        def stop(phase, fraction):
            raise LookupError(phase)
        for call in (lambda: voxmend.voxelize(sample("rocket"), 64, progress=stop), lambda: voxmend.repair(sample("rocket"), progress=stop),
                     lambda: voxmend.voxelize_sparse(sample("rocket"), 64, progress=stop), lambda: voxmend.remesh(sample("rocket"), progress=stop),
                     lambda: voxmend.labels(sample("rocket"), 64, progress=stop), lambda: voxmend.colors(sample("rocket"), 64, progress=stop),
                     lambda: voxmend.coverage(sample("rocket"), 64, progress=stop)):
            with self.assertRaises(LookupError):
                call()
        self.assertEqual(voxmend.voxelize(sample("cube"), 8).filled_count, 512)
        for wrong in (3, "yes"):
            with self.assertRaises(TypeError):
                voxmend.voxelize(sample("cube"), 8, progress=wrong)

    def test_bar(self):
        try:
            import tqdm  # noqa: F401
        except ImportError:
            with self.assertRaisesRegex(voxmend.UnavailableError, "tqdm"):
                voxmend.voxelize(sample("cube"), 8, progress=True)
            self.skipTest("tqdm is not installed")
        kept, sys.stderr = sys.stderr, io.StringIO()
        try:
            voxmend.distance(sample("rocket"), 128, band=0, progress=True)
            shown = sys.stderr.getvalue()
        finally:
            sys.stderr = kept
        self.assertIn("%", shown)
        self.assertIn("distances" if "distances" in shown else "reading", shown)

    def test_timeout(self):
        for call in (lambda: voxmend.distance(sample("rocket"), 400, band=0, timeout=0.2),
                     lambda: voxmend.voxelize(sample("rocket"), 900, method="winding", timeout=0.001),
                     lambda: voxmend.voxelize(sample("cube"), 8, timeout=0)):
            start = time.monotonic()
            with self.assertRaises(voxmend.VoxmendTimeout) as caught:
                call()
            self.assertLess(time.monotonic() - start, 3)
            self.assertIsInstance(caught.exception, TimeoutError)
            self.assertIsInstance(caught.exception, voxmend.CancelledError)
            self.assertEqual(caught.exception.status, "cancelled")
            self.assertNotIn("\n", str(caught.exception))
        self.assertEqual(voxmend.voxelize(sample("cube"), 8, timeout=60).filled_count, 512)
        start = time.monotonic()
        with self.assertRaises(TimeoutError):
            with voxmend.watch(timeout=0.2):  # that around it ends sooner
                voxmend.distance(sample("rocket"), 400, band=0, timeout=60)
        self.assertLess(time.monotonic() - start, 3)
        for wrong, kind in ((-1, ValueError), (float("nan"), ValueError), ("1", TypeError), (True, TypeError)):
            with self.assertRaises(kind):
                voxmend.voxelize(sample("cube"), 8, timeout=wrong)

    def test_timeout_of_another_thread(self):
        """It is that thread's alone."""
        failures = []

        def work():
            try:
                voxmend.distance(sample("rocket"), 400, band=0, timeout=0.2)
            except voxmend.VoxmendTimeout:
                failures.append("timeout")
        thread = threading.Thread(target=work)
        thread.start()
        self.assertTrue(voxmend.distance(sample("rocket"), 96, band=0).values.any())
        thread.join()
        self.assertEqual(failures, ["timeout"])


class Sources(unittest.TestCase):
    def test_files(self):
        with open(sample("torus"), "rb") as file:
            data = file.read()
        wanted = voxmend.voxelize(sample("torus"), 24)
        with open(sample("torus"), "rb") as binary, open(sample("torus")) as text:
            for file in (binary, text, io.BytesIO(data), io.StringIO(data.decode()), pathlib.Path(sample("torus"))):
                self.assertEqual(voxmend.voxelize(file, 24), wanted)
        self.assertEqual(voxmend.load(io.BytesIO(data), format="off").format, "off")
        with self.assertRaises(voxmend.FormatError):
            voxmend.load(io.BytesIO(b"nothing of the sort"))
        with self.assertRaises(TypeError):
            voxmend.load(3)
        damaged = io.BytesIO(b"OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 9\n3 0 2 3\n")
        damaged.name = "damaged.off"
        with self.assertWarnsRegex(voxmend.VoxmendWarning, "damaged.off") as caught:
            voxmend.voxelize(damaged, 8, repair=False)
        self.assertEqual(caught.filename, __file__)

    def test_sizes(self):
        mesh = voxmend.Mesh(*box((2, 3, 4), (0.3, 0, 0)))
        self.assertEqual(mesh.voxelize(voxel_size=(0.5, 1, 2), fit="tight").shape, (4, 3, 2))
        self.assertEqual(mesh.voxelize(voxel_size=0.5, fit="tight").shape, (4, 6, 8))
        self.assertEqual(mesh.voxelize(pitch=0.5, fit="tight").shape, (4, 6, 8))
        grid = mesh.voxelize(pitch=(0.5, 1, 2))  # round(0.3 / 0.5) = 1 to round(2.3 / 0.5) = 5, and so on
        self.assertEqual(grid.shape, (5, 4, 3))
        numpy.testing.assert_allclose(grid.indices_to_points([0, 0, 0]), [0.5, 0, 0])
        self.assertEqual(mesh.voxelize(pitch=0.5, pad=2).shape, (9, 11, 13))
        self.assertTrue(voxmend.remesh(mesh, voxel_size=(0.1, 0.2, 0.3)).info().watertight)
        for wrong in (dict(voxel_size=(1, 2)), dict(voxel_size=(1, 0, 1)), dict(pitch=(1, 1, -1)), dict(pitch=1, voxel_size=1),
                      dict(resolution=8, voxel_size=1), dict(like=grid, fit="cube"), dict(pitch=1e-300)):
            with self.assertRaises(ValueError, msg=str(wrong)):
                mesh.voxelize(**wrong)
        with self.assertRaises(voxmend.EmptyError):
            voxmend.voxelize(([], []), pitch=1)


if __name__ == "__main__":
    unittest.main(verbosity=1)
