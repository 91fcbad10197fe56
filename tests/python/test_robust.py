# SPDX-License-Identifier: BSD-3-Clause
"""What goes wrong: odd values, files that are not there, threads, forks, pickles, Ctrl-C. SAMPLES is a folder of what
samples/generate_samples makes."""
import copy
import errno
import gc
import io
import multiprocessing
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

SAMPLES = os.environ["SAMPLES"]
LONG = bool(os.environ.get("VOXMEND_LONG"))  # the whole of what else takes a sample
LATEST = float(os.environ.get("VOXMEND_LATEST", "1.5"))  # seconds in which Ctrl-C ends a call; 0.3 on a quiet machine


def sample(name):
    return os.path.join(SAMPLES, name + ".off")


CORNERS = numpy.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
SIDES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def sampler(**changed):
    out = voxmend.Sampler(**dict(dict(resolution=24, seed=7, rotate="any", scale=0.4, displace=0.02, mirror="xz"), **changed))
    out.put(voxmend.load(sample("star_prism")))
    out.put(voxmend.load(sample("cracks")), 3)
    return out


class Values(unittest.TestCase):
    def refused(self, kind, *calls):
        for number, function in enumerate(calls):
            with self.assertRaises(kind, msg=number) as caught:
                function()
            self.assertIsInstance(caught.exception, voxmend.VoxmendError)
            self.assertNotIn("\n", str(caught.exception))

    def test_messages_for_python(self):
        """They name what a Python program has, and what is wanted."""
        cube = voxmend.load(sample("cube"))
        with open(sample("cube"), "rb") as file:
            content = file.read()
        with tempfile.TemporaryDirectory() as folder:
            stl, distances = os.path.join(folder, "c.stl"), os.path.join(folder, "d.npy")
            cube.save(stl)
            with open(stl, "rb") as file:
                binary = file.read()
            voxmend.distance(cube, 6).save(distances)
            for kind, words, call in (
                    (ValueError, "give it with Sampler.put first", lambda: voxmend.Sampler(16).batch(2)),
                    (TypeError, "ndarray, which has no origin and no pitch; give a grid, a field or an octree",
                     lambda: voxmend.voxelize(cube, like=numpy.zeros((4, 4, 4)))),
                    (ValueError, r"%d bytes that are no path.* io\.BytesIO" % len(content), lambda: voxmend.voxelize(content, 16)),
                    (ValueError, r"%d bytes that are no path.* io\.BytesIO" % len(binary), lambda: voxmend.voxelize(binary, 16)),
                    (ValueError, r"characters that are no path.* io\.StringIO", lambda: voxmend.info(content.decode())),
                    (ValueError, "at_least= or below= of voxmend.read .* voxmend.read_field", lambda: voxmend.read(distances)),
                    (ValueError, "noise goes with displace", lambda: voxmend.Sampler(16, noise=100)),
                    (FileNotFoundError, "no.such", lambda: voxmend.load(b"no\nsuch"))):
                with self.assertRaisesRegex(kind, words) as caught:
                    call()
                self.assertIsInstance(caught.exception, voxmend.VoxmendError)
                self.assertNotRegex(str(caught.exception), "vxm_|--[a-z]")
                self.assertLess(len(str(caught.exception)), 240)
        self.assertEqual(voxmend.voxelize(io.BytesIO(content), 8), voxmend.voxelize(cube, 8))
        voxmend.Sampler(16, noise=100, displace=0.1)

    def test_kinds_of_numbers(self):
        mesh, make = voxmend.load(sample("cube")), voxmend.Sampler
        mixed = [[0, 0, 0], [1, 0, "x"], [0, 1, 0]]
        self.refused(
            TypeError, *(lambda r=r: voxmend.voxelize(mesh, r) for r in (1.5, True, "8", 8j, None.__class__, [8, 8.5, 8], b"8",
                                                                        numpy.float64(8), numpy.array(8.0), numpy.bool_(1))),
            lambda: voxmend.voxelize(mesh, 8, pad=1.5), lambda: voxmend.voxelize(mesh, pitch="1"),
            lambda: voxmend.voxelize(mesh, pitch=1j), lambda: voxmend.voxelize(mesh, 8, repair="no"),
            lambda: voxmend.voxelize(mesh, 8, repair=2), lambda: voxmend.voxelize(mesh, 8, mode=1),
            lambda: voxmend.voxelize(mesh, like=8), lambda: voxmend.voxelize(17, 8), lambda: voxmend.voxelize(None, 8),
            lambda: voxmend.Mesh(CORNERS * 1j, SIDES), lambda: voxmend.Mesh(mixed, [[0, 1, 2]]),
            lambda: voxmend.Mesh(CORNERS.astype(object), SIDES), lambda: voxmend.Mesh(CORNERS, numpy.array(SIDES, object)),
            lambda: voxmend.Mesh(CORNERS, numpy.array(SIDES, float)), lambda: voxmend.Mesh(CORNERS, "faces"),
            lambda: voxmend.Mesh(CORNERS > 0, SIDES), lambda: voxmend.Mesh(CORNERS, numpy.ones((1, 3), bool)),
            lambda: voxmend.VoxelGrid(numpy.zeros((2, 2, 2), complex)), lambda: voxmend.VoxelGrid([[["a"]]]),
            lambda: voxmend.VoxelGrid(numpy.zeros((2, 2, 2), object)), lambda: voxmend.VoxelGrid(numpy.zeros((2, 2, 2)), 1j),
            lambda: voxmend.distance(mesh, 8, band="3"), lambda: voxmend.coverage(mesh, 8, subdivision=4.0),
            lambda: voxmend.repair(mesh, fill_holes=1.5), lambda: voxmend.repair(mesh, weld=1j),
            lambda: voxmend.repair(mesh, weld=True), lambda: voxmend.repair(mesh, level=2), lambda: make(16.0),
            lambda: make(16, scale="1"), lambda: make(16, seed=1.0), lambda: make(16, rotate=b"any"),
            lambda: make(16, rotate=["x"]), lambda: make(16, engine=3), lambda: sampler().batch(1.5),
            lambda: sampler().batch([0.5]), lambda: sampler().batch(True), lambda: sampler().batch(2, out=[1, 2]),
            lambda: sampler().pose(1.0), lambda: sampler().put(mesh, "a"), lambda: voxmend.configure(threads=1.5),
            lambda: voxmend.load(3), lambda: voxmend.load(sample("cube"), format=3), lambda: voxmend.write(3, "x.npy"),
            lambda: voxmend.voxelize(mesh, 8).compare(3))

    def test_ranges(self):
        mesh, make, nan = voxmend.load(sample("cube")), voxmend.Sampler, float("nan")
        self.refused(
            ValueError, *(lambda r=r: voxmend.voxelize(mesh, r) for r in (0, -1, 1 << 63, 1 << 70, [8, 8], [8, 0, 8], 1 << 40)),
            *(lambda p=p: voxmend.voxelize(mesh, pitch=p) for p in (nan, float("inf"), 0, -1.0, 10 ** 400)),
            lambda: voxmend.voxelize(mesh, 8, pad=-1), lambda: voxmend.voxelize(mesh, 8, pad=1 << 62),
            lambda: voxmend.voxelize(mesh, 8, bounds=[[0, 0, 0], [1, 1, nan]]), lambda: voxmend.distance(mesh, 8, band=nan),
            lambda: voxmend.distance(mesh, 8, band=-1), lambda: voxmend.coverage(mesh, 8, subdivision=3),
            lambda: voxmend.repair(mesh, weld=nan), lambda: voxmend.repair(mesh, weld=-1), lambda: voxmend.repair(mesh, drop_volume=nan),
            lambda: voxmend.repair(mesh, drop_faces=-1), lambda: voxmend.repair(mesh, wrap_alpha=nan),
            lambda: voxmend.Mesh(CORNERS, [[0, 1, 8]]), lambda: voxmend.Mesh(CORNERS, [[0, 1, -1]]),
            lambda: voxmend.Mesh(CORNERS, numpy.array([[0, 1, 1 << 63]], numpy.uint64)), lambda: voxmend.Mesh(CORNERS, numpy.zeros((5, 0), int)),
            lambda: voxmend.Mesh(CORNERS[:, :2], SIDES), lambda: voxmend.Mesh(numpy.ma.masked_less(CORNERS, 0.5), SIDES),
            lambda: voxmend.VoxelGrid(numpy.full((2, 2, 2), nan)), lambda: voxmend.VoxelGrid(numpy.zeros((2, 0, 2))),
            lambda: voxmend.VoxelGrid(numpy.zeros((2, 2, 2)), pitch=0), lambda: voxmend.VoxelGrid(numpy.zeros((2, 2, 2)), [1, 2]),
            lambda: voxmend.VoxelGrid(numpy.zeros((2, 2, 2)), origin=[0, 0, nan]), lambda: make(16, seed=-1), lambda: make(16, seed=1 << 64),
            lambda: make(16, scale=nan), lambda: make(16, noise=-1), lambda: make(16, noise=0, displace=0.1), lambda: make(16, rotate=[[[nan] * 3] * 3]), lambda: make(0),
            lambda: sampler().batch(-1), lambda: sampler().batch([1 << 32]), lambda: sampler().put(mesh, -1),
            lambda: sampler().put(mesh, 1 << 32), lambda: voxmend.configure(threads=-1), lambda: voxmend.configure(memory_limit=-1),
            lambda: voxmend.configure(memory_limit=1 << 64), lambda: voxmend.load(sample("cube"), format="off\0"),
            lambda: voxmend.load(sample("cube"), deflection=nan))

    def test_numbers_that_are_taken(self):
        mesh = voxmend.load(sample("torus"))
        wanted = mesh.voxelize(24).hash
        for number in (numpy.int8(24), numpy.uint64(24), numpy.array(24), [24, 24, 24], (numpy.int32(24),) * 3, numpy.array([24] * 3)):
            self.assertEqual(mesh.voxelize(number).hash, wanted)
        self.assertEqual(mesh.voxelize(24, repair=numpy.True_).hash, wanted)
        points, faces = mesh.vertices, mesh.faces
        wide = numpy.zeros((len(points), 5))
        wide[:, 1:4] = points
        for vertices in (numpy.asfortranarray(points), points.astype(">f8"), wide[:, 1:4], points[::-1][::-1], points.astype(numpy.longdouble)):
            for corners in (faces.astype(">i4"), numpy.asfortranarray(faces), faces.astype(numpy.uint16), numpy.repeat(faces, 2, 0)[::2]):
                again = voxmend.Mesh(vertices, corners)
                self.assertTrue((again.vertices == points).all() and (again.faces == faces).all())
        self.assertTrue((voxmend.Mesh(points.astype(">f4"), faces).vertices == points.astype("f4")).all())
        self.assertTrue((voxmend.Mesh(CORNERS.astype(numpy.float16), SIDES).vertices == CORNERS).all())
        self.assertTrue((voxmend.Mesh(CORNERS.astype(numpy.uint8), SIDES).vertices == CORNERS).all())
        mixed = voxmend.Mesh(CORNERS, SIDES[:5] + [[1, 5, 7], (1, 7, 3)])
        self.assertTrue(mixed.info()["watertight"])
        self.assertEqual(len(voxmend.Mesh([], []).faces), 0)
        matrix = numpy.zeros((3, 4, 5), bool)
        matrix[1, 2, 3] = matrix[0, 0, 4] = True
        for given in (matrix.astype(">f4"), numpy.asfortranarray(matrix), matrix.astype(">u2") * 256, matrix.tolist(), matrix[::-1][::-1]):
            self.assertTrue((voxmend.VoxelGrid(given).matrix == matrix).all())

    def test_warnings(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "damaged.off")
            path.write_text("OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 9\n3 0 2 3\n")
            with self.assertWarns(voxmend.VoxmendWarning) as caught:
                mesh = voxmend.load(path)
            self.assertEqual(caught.filename, __file__)  # the line that asked for it
            self.assertIn(mesh.warnings[0], str(caught.warning))
            self.assertNotIn("\n", str(caught.warning))
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                self.assertEqual(copy.copy(mesh).warnings, mesh.warnings)
                with self.assertRaises(voxmend.VoxmendWarning):
                    voxmend.voxelize(path, 8)


class Paths(unittest.TestCase):
    def test_refused(self):
        grid = voxmend.voxelize(sample("cube"), 8)
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "file")
            open(file, "w").close()
            long = os.path.join(folder, *["a" * 200] * 3, "b.off")
            for kind, number, path in ((FileNotFoundError, errno.ENOENT, os.path.join(folder, "no.off")), (FileNotFoundError, errno.ENOENT, long),
                                       (IsADirectoryError, errno.EISDIR, folder), (NotADirectoryError, errno.ENOTDIR, file + "/x.npy"),
                                       (OSError, errno.ENAMETOOLONG, "x" * 300)):
                for function in (voxmend.load, voxmend.read, lambda p: voxmend.voxelize(p, 8)):
                    for form in (os.fsdecode, os.fsencode, pathlib.Path):
                        with self.assertRaises(kind, msg=path) as caught:
                            function(form(path))
                        error = caught.exception
                        self.assertIsInstance(error, voxmend.FileError)
                        self.assertEqual((error.errno, error.strerror, error.filename), (number, os.strerror(number), os.fspath(form(path))))
                        self.assertEqual(error.status, "io")
                        again = pickle.loads(pickle.dumps(error))
                        self.assertEqual((type(again), str(again), again.errno, again.filename), (type(error), str(error), number, error.filename))
            for kind, path in ((FileNotFoundError, folder + "/no/x.npy"), (IsADirectoryError, folder), (NotADirectoryError, file + "/x.npy")):
                with self.assertRaises(kind):
                    grid.save(path, "npy")
                with self.assertRaises(kind):
                    voxmend.load(sample("cube")).save(path, "ply")
            if os.getuid():
                os.chmod(file, 0)
                with self.assertRaises(PermissionError):
                    voxmend.load(file)
        with self.assertRaises(OSError) as caught:
            grid.save("/dev/full", "npy")
        self.assertEqual((caught.exception.errno, caught.exception.filename), (errno.ENOSPC, "/dev/full"))

    def test_nul(self):
        grid = voxmend.voxelize(sample("cube"), 8)
        for path in ("a\0b.off", b"a\0b.off", pathlib.PurePath("a\0b.off"), sample("cube") + "\0"):
            for function in (voxmend.load, voxmend.read, voxmend.info, lambda p: voxmend.write(grid, p), voxmend.load(sample("cube")).save):
                with self.assertRaises(ValueError):
                    function(path)

    def test_forms(self):
        grid = voxmend.voxelize(pathlib.Path(sample("cube")), 8)
        with tempfile.TemporaryDirectory() as folder:
            for name in ("a.npy", b"\xff\xfe.npy", pathlib.Path("c.npy"), "ö\n.npy", os.fsdecode(b"\xe9.npy")):
                path = os.path.join(os.fsencode(folder), os.fsencode(name))
                for form in (path, os.fsdecode(path), pathlib.Path(os.fsdecode(path))):
                    voxmend.write(grid, form)
                    self.assertEqual(voxmend.read(form).hash, grid.hash)
                os.remove(path)
                with self.assertRaises(FileNotFoundError) as caught:
                    voxmend.read(path)
                self.assertEqual(caught.exception.filename, path)
                self.assertNotIn("\n", str(caught.exception))


class Views(unittest.TestCase):
    def test_read_only(self):
        mesh, grid = voxmend.load(sample("torus")), voxmend.voxelize(sample("torus"), 16)
        before = grid.hash
        for array in (mesh.vertices, mesh.offsets, mesh.indices, mesh.faces, grid.matrix, grid.packed, numpy.asarray(grid),
                      voxmend.Mesh([], []).vertices, voxmend.Mesh([], []).faces):
            with self.assertRaises(ValueError):
                array[...] = 1
            if array.size:
                with self.assertRaises(ValueError):
                    array.flags.writeable = True
        self.assertEqual((grid.hash, grid.matrix.sum()), (before, grid.filled_count))
        changed = numpy.array(grid)
        changed[:] = True
        self.assertEqual(voxmend.VoxelGrid(changed, grid.pitch, grid.origin).filled_count, 16 ** 3)
        exported = numpy.from_dlpack(grid)
        self.assertTrue((exported == grid.matrix).all())
        self.assertFalse(numpy.shares_memory(exported, grid.matrix))

    def test_owners_may_go(self):
        for _ in range(20):
            mesh, grid = voxmend.load(sample("torus")), voxmend.voxelize(sample("torus"), 32)
            views = [mesh.vertices, mesh.indices, mesh.faces, mesh.offsets, grid.packed, grid.matrix, grid.matrix[1:, ::2]]
            copies = [v.copy() for v in views]
            mesh.__init__(CORNERS, SIDES)  # another content; the views show the old one
            grid.__init__(numpy.zeros((2, 2, 2)))
            del mesh, grid
            gc.collect()
            junk = [voxmend.voxelize(sample("cube"), 32) for _ in range(3)]
            self.assertTrue(all((v == c).all() for v, c in zip(views, copies)))
            del junk

    def test_models_outlive_their_meshes(self):
        one, wanted = sampler(), sampler().batch([[3, 0, 1], [0, 0, 1]])
        for _ in range(5):
            mesh = voxmend.load(sample("cracks"))
            one.put(mesh, 3)
            mesh.__init__(CORNERS, SIDES)
            del mesh
            gc.collect()
            self.assertTrue((one.batch([[3, 0, 1], [0, 0, 1]]) == wanted).all())


class Threads(unittest.TestCase):
    def together(self, work, threads=4):
        failures = []

        def run(number):
            try:
                work(number)
            except BaseException as problem:
                failures.append(problem)
        running = [threading.Thread(target=run, args=(n,)) for n in range(threads)]
        for thread in running:
            thread.start()
        for thread in running:
            thread.join()
        if failures:
            raise failures[0]

    def test_one_sampler(self):
        one = sampler()
        wanted = one.batch([[m, 2, i] for i in range(40) for m in (0, 3)], dtype="bits")
        spare = voxmend.load(sample("torus"))
        stop = time.monotonic() + (60 if LONG else 1.5)

        def work(number):
            rng = numpy.random.default_rng(number)
            while time.monotonic() < stop:
                at = rng.integers(0, 80, rng.integers(1, 9))
                names = numpy.stack([at % 2 * 3, numpy.full(len(at), 2), at // 2], axis=1)
                made = one.batch(names, dtype="bits")
                self.assertTrue((made == wanted[at]).all())
                if number == 0:
                    one.put(spare, 9)  # the models change meanwhile
                    one.put(None, 9)
                    one.pose(3, model=3)
        self.together(work)

    def test_one_mesh_and_grid(self):
        mesh = voxmend.load(sample("rocket"))
        grid = mesh.voxelize(40, mode="both")
        wanted = (mesh.info(), mesh.repair().info(), grid.hash, grid.matrix.sum(), grid.as_boxes().info(), mesh.voxelize(30, mode='both').hash)

        def work(number):
            for _ in range(20 if LONG else 3):
                own = copy.copy(grid)  # whose matrix is not there yet
                got = (mesh.info(), mesh.repair().info(), own.hash, own.matrix.sum(), grid.as_boxes().info(), mesh.voxelize(30, mode='both').hash)
                self.assertEqual(got, wanted)
        self.together(work)

    def test_a_handler_that_asks_for_more_is_refused(self):
        one, met = sampler(resolution=160), []

        def handler(*_):
            try:
                one.batch(1)
            except RuntimeError as problem:
                met.append(problem)
        before = signal.signal(signal.SIGALRM, handler)
        try:
            signal.setitimer(signal.ITIMER_REAL, 0.1, 0.1)
            stop = time.monotonic() + 5
            while not met and time.monotonic() < stop:
                one.batch(64, dtype="bits")
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)
        self.assertIsInstance(met[0], voxmend.VoxmendError)
        self.assertTrue((one.batch(1) == sampler(resolution=160).batch(1)).all())

    def test_a_fork_in_the_middle_of_a_batch(self):
        one = sampler(resolution=96)
        wanted, stop = one.batch(2, dtype="bits"), threading.Event()

        def busy():
            while not stop.is_set():
                one.batch(16, dtype="bits")
        thread = threading.Thread(target=busy)
        thread.start()
        try:
            for _ in range(5):
                time.sleep(0.03)
                child = os.fork()
                if child == 0:
                    signal.alarm(20)
                    os._exit(0 if (one.batch(2, dtype="bits") == wanted).all() else 1)
                self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)
        finally:
            stop.set()
            thread.join()


def digest(thing):
    """Of a mesh, grid or sampler, in whatever process."""
    if isinstance(thing, voxmend.Mesh):
        return (thing.vertices.tobytes(), thing.offsets.tobytes(), thing.indices.tobytes(), thing.tags, thing.format, thing.warnings,
                None if thing.face_tags is None else thing.face_tags.tobytes(), thing.report)
    if isinstance(thing, voxmend.VoxelGrid):
        return thing.hash, thing.shape, thing.origin.tobytes(), thing.pitch.tobytes(), thing.report, thing.warnings, thing.packed.tobytes()
    return thing.batch([[m, 5, i] for m in (0, 3) for i in range(3)], dtype="bits").tobytes(), thing.pose(2, model=3)["shift"].tobytes()


class Copies(unittest.TestCase):
    def things(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "tagged.obj")
            with open(path, "w") as file:
                file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng one\nusemtl red\nf 1 2 3\ng two\nf 1 2 4 3\nf 7 8 9\n")
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                tagged = voxmend.load(path)
        self.assertEqual(tagged.tags, ["one/red", "two/red"])
        self.assertTrue(tagged.warnings)
        turns = numpy.array([numpy.eye(3), [[0, -1, 0], [1, 0, 0], [0, 0, 1]]])
        return (tagged, voxmend.repair(sample("doubled")), voxmend.Mesh([], []), voxmend.voxelize(sample("open_box"), (70, 5, 9), pad=1),
                voxmend.VoxelGrid(numpy.ones((65, 2, 3)), (1, 2, 3), (4, 5, 6)), sampler(), sampler(rotate=turns, engine="cpu"), sampler(rotate="z"))

    def test_in_this_process(self):
        for thing in self.things():
            for again in (pickle.loads(pickle.dumps(thing)), pickle.loads(pickle.dumps(thing, 5)), copy.deepcopy(thing), copy.copy(thing)):
                self.assertIs(type(again), type(thing))
                self.assertEqual(digest(again), digest(thing))

    def test_tags_are_written(self):
        tagged = self.things()[0]
        with tempfile.TemporaryDirectory() as folder:
            texts = []
            for mesh in (tagged, copy.deepcopy(tagged)):
                mesh.save(os.path.join(folder, "x.obj"))
                with open(os.path.join(folder, "x.obj")) as file:
                    texts.append(file.read())
        self.assertEqual(*texts)

    def test_in_another_process(self):
        things = self.things()
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            self.assertEqual(pool.map(digest, things), [digest(t) for t in things])

    def test_copies_are_apart(self):
        one = sampler()
        other = copy.deepcopy(one)
        other.put(None, 3)
        one.batch([0], model=3)
        with self.assertRaises(ValueError):
            other.batch([0], model=3)


# Each goes on until it is interrupted, on any machine.
LONG_CALLS = {
    "distance": "for _ in range(99): voxmend.distance(mesh, 300, band=0)",
    "coverage": "for _ in range(99): voxmend.coverage(mesh, 512)",
    "voxelize": "for _ in range(99): voxmend.voxelize(mesh, 1400)",
    "winding": "for _ in range(99): voxmend.voxelize(mesh, 300, method='winding')",
    "batch": "for _ in range(99): sampler.batch(4096, dtype='bits')",
    "one variant": "for _ in range(99): large.batch(1, dtype='bits')",
    "repair": "for _ in range(99): voxmend.repair(big)",
    "info": "for _ in range(99): big.info()",
    "load": "for _ in range(999): voxmend.load('big.ply')",
    "save": "for _ in range(99): big.save('out.obj')",
    "matrix": "for _ in range(99): voxmend.VoxelGrid(filled).matrix",
    "numbers": "for _ in range(99): voxmend.VoxelGrid(numbers)",
    "fill": "for _ in range(99): hollow.fill()",
    "hollow": "for _ in range(99): hollow.hollow()",
    "boxes": "for _ in range(99): hollow.as_boxes()",
}
CHILD = """
import os, signal, sys, time, numpy, voxmend
signal.signal(signal.SIGINT, signal.default_int_handler)  # shells start what is in the background without it
mesh = voxmend.load(sys.argv[1] + "/rocket.off")
call = sys.argv[2]
if "sampler" in call or "large" in call:
    sampler, large = voxmend.Sampler(64, rotate="any", displace=0.01), voxmend.Sampler(700, rotate="any", displace=0.01)
    sampler.put(mesh), large.put(mesh)
if "big" in call:
    one = mesh.triangles()
    times = int(sys.argv[3])
    points = numpy.concatenate([mesh.vertices + [0, 0, 9.0 * n] for n in range(times)])
    big = voxmend.Mesh(points, numpy.concatenate([one + n * len(mesh.vertices) for n in range(times)]))
    big.save("big.ply")
if "filled" in call:
    filled = numpy.ones((600, 600, 600), bool)
if "numbers" in call:
    numbers = numpy.ones((400, 400, 400))
if "hollow" in call:
    hollow = voxmend.voxelize(mesh, 500, mode="surface", repair=False)
print("ready", flush=True)
try:
    CALL
    print("done", flush=True)
except KeyboardInterrupt:
    print("interrupted", flush=True)
left = [name for name in os.listdir(".") if name != "big.ply"]
assert not left or left == ["out.obj"], left
assert voxmend.voxelize(sys.argv[1] + "/cube.off", 8).filled_count == 512  # what comes after is as ever
"""


class CtrlC(unittest.TestCase):
    def ended_after(self, name, delay):
        """Seconds from the signal to the exception, in a process of its own."""
        program = CHILD.replace("    CALL", "    " + LONG_CALLS[name])
        with tempfile.TemporaryDirectory() as folder:
            child = subprocess.Popen([sys.executable, "-c", program, SAMPLES, LONG_CALLS[name], "400" if LONG else "60"],
                                     stdout=subprocess.PIPE, text=True, cwd=folder)
            try:
                self.assertEqual(child.stdout.readline(), "ready\n", name)
                time.sleep(delay)
                start = time.perf_counter()
                child.send_signal(signal.SIGINT)
                self.assertEqual(child.stdout.readline(), "interrupted\n", name)
                seconds = time.perf_counter() - start
                self.assertEqual(child.wait(60), 0, name)
                return seconds
            finally:
                child.kill()
                child.wait()
                child.stdout.close()

    def test_calls_end(self):
        """On a machine that has other things to do a call may be late, but not each time."""
        worst = {}
        for name in LONG_CALLS:
            if not LONG and name not in ("distance", "winding", "one variant", "repair", "load", "matrix", "fill"):
                continue
            for delay in (0.05, 0.2, 0.5, 1.1, 2.3) if LONG else (0.35,):
                seconds = self.ended_after(name, delay)
                for _ in range(0 if LONG else 4):
                    if seconds > LATEST:
                        seconds = self.ended_after(name, delay)
                worst[name] = max(worst.get(name, 0), seconds)
        if LONG:
            print(", ".join("%s %.2f s" % each for each in worst.items()))
        self.assertFalse({name: seconds for name, seconds in worst.items() if seconds > (1 if LONG else LATEST)})

    def test_other_signals_and_exceptions(self):
        """A handler runs in the middle of a call; what it raises comes out of the call; what it does not lets it go on."""
        class Enough(Exception):
            pass
        counts = [0]

        def handler(*_):
            counts[0] += 1
            voxmend.voxelize(sample("cube"), 8)  # handlers may use the package
            if counts[0] == 3:
                signal.setitimer(signal.ITIMER_REAL, 0)
                raise Enough
        before = signal.signal(signal.SIGALRM, handler)
        try:
            signal.setitimer(signal.ITIMER_REAL, 0.1, 0.1)
            with self.assertRaises(Enough):
                voxmend.distance(sample("rocket"), 300, band=0)
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)
        self.assertEqual(counts[0], 3)

    def test_threads_are_told_to_stop(self):
        from voxmend import _core
        flag, caught = _core.ffi.new("int *"), []

        def work():
            try:
                with _core.stoppable(flag):
                    voxmend.distance(sample("rocket"), 400, band=0)
            except voxmend.CancelledError as problem:
                caught.append(problem)
        thread = threading.Thread(target=work)
        thread.start()
        time.sleep(0.2)
        flag[0] = 1
        thread.join(10)
        self.assertEqual(caught[0].status, "cancelled")


if __name__ == "__main__":
    unittest.main(verbosity=1)
