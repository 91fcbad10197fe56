# SPDX-License-Identifier: BSD-3-Clause
"""The datasets for PyTorch. SAMPLES is a folder of what samples/generate_samples makes."""
import gc
import os
import pickle
import shutil
import tempfile
import threading
import unittest
import warnings

import numpy
import torch
from torch.utils.data import DataLoader

import voxmend
from voxmend.torch import IterableVoxelDataset, VoxelDataset, unpack

SAMPLES = os.environ["SAMPLES"]


def sample(name):
    return os.path.join(SAMPLES, name + ".off")


class Tensors(unittest.TestCase):
    def test_from_dlpack(self):
        grid = voxmend.voxelize(sample("torus"), 24)
        voxels, bits = torch.from_dlpack(grid), torch.from_dlpack(grid.bits)
        self.assertEqual((voxels.dtype, tuple(voxels.shape), int(voxels.sum())), (torch.uint8, (24, 24, 24), grid.filled_count))
        voxels.zero_()  # of its own
        self.assertEqual((bits.dtype, bits.data_ptr()), (torch.uint8, grid.packed.ctypes.data))
        matrix = torch.from_numpy(numpy.array(grid.matrix))
        del grid
        gc.collect()
        unpacked = (bits[..., None] >> torch.arange(8) & 1).reshape(24, 24, -1)[..., :24]
        self.assertTrue(torch.equal(unpacked.permute(2, 1, 0).bool(), matrix))
        field = voxmend.coverage(sample("sphere"), 16)
        self.assertEqual(torch.from_dlpack(field).data_ptr(), field.values.ctypes.data)


class Datasets(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        for name, models in (("ring", ["torus", "doubled"]), ("prism", ["star_prism", "l_prism"]), ("ball", ["sphere"])):
            for split, chosen in (("train", models), ("test", models[:1])):
                at = os.path.join(cls.folder.name, name, split)
                os.makedirs(at)
                for model in chosen:
                    with open(sample(model), "rb") as source, open(os.path.join(at, model + ".off"), "wb") as copy:
                        copy.write(source.read())

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def dataset(self, **changed):
        return VoxelDataset(self.folder.name, **dict(dict(split="train", resolution=24, variants=3, seed=4, rotate="any",
                                                          scale=0.4, displace=0.01), **changed))

    def test_items(self):
        data = self.dataset()
        self.assertEqual(data.classes, ["ball", "prism", "ring"])
        self.assertEqual(len(data), 15)
        voxels, label = data[7]
        self.assertEqual(tuple(voxels.shape), (1, 24, 24, 24))
        self.assertEqual(voxels.dtype, torch.float32)
        self.assertEqual(label, data.labels[7 % 5])
        self.assertEqual(len(self.dataset(split="test")), 9)
        self.assertEqual(len(self.dataset(split=None)), 24)
        with self.assertRaises(voxmend.EmptyError):
            self.dataset(split="none")
        with self.assertRaises(IndexError):
            data[15]
        with self.assertRaises(ValueError):
            self.dataset(scale=3)

    def test_hidden(self):
        """Files that `voxmend batch` passes over, and classes of nothing else."""
        with tempfile.TemporaryDirectory() as root:
            for name in ("a/train/x.off", "a/train/._x.off", "a/.old/train/y.off", "a/train/__MACOSX/z.off", "__MACOSX/a/x.off",
                         ".git/x.off", "b/train/._x.off"):
                os.makedirs(os.path.dirname(os.path.join(root, name)), exist_ok=True)
                shutil.copy(sample("torus"), os.path.join(root, name))
            data = VoxelDataset(root, resolution=8)
            self.assertEqual(data.classes, ["a"])
            self.assertEqual([os.path.relpath(file, root) for file in data.files], ["a/train/x.off"])

    def test_epochs_and_batches(self):
        data = self.dataset()
        first, labels = data.batch(range(15))
        for item in range(15):
            self.assertTrue((data[item][0] == first[item]).all())
        self.assertTrue((data.__getitems__([3, 8])[1][0] == first[8]).all())
        data.set_epoch(1)
        self.assertFalse((data.batch(range(15))[0] == first).all())
        data.set_epoch(0)
        self.assertTrue((data.batch(range(15))[0] == first).all())
        self.assertEqual(labels.tolist(), 3 * [0, 1, 1, 2, 2])

    def test_packed(self):
        packed, _ = self.dataset(packed=True, resolution=21).batch(range(6))
        self.assertEqual(tuple(packed.shape), (6, 21, 21, 3))
        self.assertTrue((unpack(packed, 21) == self.dataset(resolution=21).batch(range(6))[0]).all())

    def test_workers(self):
        data = self.dataset()
        expected = data.batch(range(15))[0]
        for workers, method in ((0, None), (2, "fork"), (2, "spawn")):
            loader = DataLoader(data, batch_size=4, num_workers=workers, multiprocessing_context=method)
            made = torch.cat([voxels for voxels, _ in loader])
            self.assertTrue((made == expected).all(), (workers, method))
        self.assertTrue((pickle.loads(pickle.dumps(data)).batch(range(15))[0] == expected).all())

    def test_models_that_do_not_all_fit(self):
        data = self.dataset(memory=1)
        self.assertTrue((data.batch(range(15))[0] == self.dataset().batch(range(15))[0]).all())
        data.batch([0])
        self.assertEqual(len(data._held), 1)

    def test_cache(self):
        with tempfile.TemporaryDirectory() as cache:
            at = os.path.join(cache, "deep", "er")
            made = self.dataset(cache=at).batch(range(15))[0]
            names = sorted(os.listdir(at))
            self.assertEqual(len(names), 5)
            self.assertTrue((self.dataset(cache=at).batch(range(15))[0] == made).all())
            self.assertEqual(sorted(os.listdir(at)), names)
            self.assertTrue((self.dataset().batch(range(15))[0] == made).all())

    def test_iterable(self):
        def made(prefetch, workers=0, **options):
            iterable = IterableVoxelDataset(self.dataset(), 4, **dict(dict(epochs=2, seed=9, prefetch=prefetch), **options))
            source = DataLoader(iterable, batch_size=None, num_workers=workers) if workers else iterable
            return [(voxels, labels.tolist()) for voxels, labels in source]
        one = made(0)
        self.assertEqual([len(labels) for _, labels in one], [4, 4, 4, 3] * 2)
        for other in (made(2), made(0, 2), made(2, 2)):
            self.assertEqual([labels for _, labels in one], [labels for _, labels in other])
            self.assertTrue(all((a == b).all() for (a, _), (b, _) in zip(one, other)))
        self.assertNotEqual([labels for _, labels in one[:4]], [labels for _, labels in one[4:]])
        self.assertEqual(len(made(1, drop_last=True)), 6)
        self.assertEqual([labels for _, labels in made(1, shuffle=False)][0], [0, 1, 1, 2])
        endless = iter(IterableVoxelDataset(self.dataset(), 4, epochs=None))
        for _ in range(9):
            next(endless)
        endless.close()  # its thread ends
        self.assertLess(threading.active_count(), 3)

    def test_what_cannot_be_read(self):
        """It ends an epoch, or is left out with a warning; a link to nothing is no mesh."""
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (("a/good.off", None), ("a/broken.off", "OFF\n3 nothing\n"), ("a/more.off", None),
                               ("b/empty.off", "OFF\n0 0 0\n"), ("b/good.off", None)):
                os.makedirs(os.path.dirname(os.path.join(folder, name)), exist_ok=True)
                with open(sample("torus")) as source, open(os.path.join(folder, name), "w") as file:
                    file.write(source.read() if text is None else text)
            os.symlink("nowhere.off", os.path.join(folder, "a", "link.off"))
            os.makedirs(os.path.join(folder, "c"))
            os.symlink("nowhere.off", os.path.join(folder, "c", "link.off"))
            data = VoxelDataset(folder, None, 8, variants=2, on_error="skip")
            self.assertEqual((data.classes, len(data)), (["a", "b"], 10))
            good = [item for item in range(10) if "good" in data.files[item % 5] or "more" in data.files[item % 5]]
            with warnings.catch_warnings(record=True) as told:
                warnings.simplefilter("always")
                voxels, labels = data.batch(range(10))
                self.assertTrue((voxels == data.batch(good)[0]).all())
                self.assertEqual((len(good), labels.tolist()), (6, [data.labels[item % 5] for item in good]))
                self.assertEqual(len(data.__getitems__([0, 1])), 1)
                broken = [item for item in range(5) if item not in good]
                self.assertEqual(len(data.batch(broken)[1]), 0)
            lines = sorted(str(line.message) for line in told if "left out" in str(line.message))
            self.assertEqual(len(lines), 2)  # one a mesh
            for line, name in zip(lines, ("broken", "empty")):
                self.assertRegex(line, "/%s.off.*; it is left out$" % name)
            for wrong in lambda: data[broken[0]], lambda: data.batch(range(10), on_error="raise"), lambda: data.__getitems__(broken):
                with self.assertRaises(ValueError):
                    wrong()
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                for prefetch, workers in ((0, 0), (2, 0), (0, 2)):
                    for size, batches in ((4, 3), (1, 6)):
                        for which, options in ((data, {}), (VoxelDataset(folder, None, 8, variants=2), {"on_error": "skip"})):
                            iterable = IterableVoxelDataset(which, size, prefetch=prefetch, **options)
                            source = DataLoader(iterable, batch_size=None, num_workers=workers) if workers else iterable
                            made = [len(labels) for _, labels in source]
                            self.assertEqual((sum(made), len(made)), (6, batches))
                os.remove(os.path.join(folder, "a", "good.off")), os.remove(os.path.join(folder, "a", "more.off"))
                shutil.copy(os.path.join(folder, "b", "empty.off"), os.path.join(folder, "b", "good.off"))
                none = VoxelDataset(folder, None, 8, on_error="skip")
                with self.assertRaisesRegex(voxmend.EmptyError, "nothing of the dataset can be read"):
                    list(IterableVoxelDataset(none, 2, epochs=None))
            for wrong in lambda: IterableVoxelDataset(data, 4, on_error="raise"), lambda: IterableVoxelDataset(VoxelDataset(folder, None, 8), 4):
                with self.assertRaises(ValueError):
                    list(wrong())
            for wrong in lambda: VoxelDataset(folder, None, 8, on_error="ignore"), lambda: IterableVoxelDataset(data, 4, on_error=1):
                with self.assertRaises((ValueError, TypeError)):
                    wrong()

    def test_errors_of_the_thread_come_through(self):
        data = self.dataset()
        data.files[0] = "gone.off"
        with self.assertRaises(OSError):
            list(IterableVoxelDataset(data, 4))


if __name__ == "__main__":
    print("torch %s" % torch.__version__)
    unittest.main(verbosity=1)
