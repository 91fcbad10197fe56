# SPDX-License-Identifier: BSD-3-Clause
"""GridDataset: the same grids from the folder of a batch, its tars and its Zarr; orders, ranks and workers."""
import collections
import io
import json
import os
import pickle
import shutil
import tempfile
import unittest
import warnings

import numpy
import torch
from torch.utils.data import DataLoader

import voxmend
import voxmend.batch
from voxmend._placement import place
from voxmend.torch import GridDataset, IterableVoxelDataset, VoxelDataset, unpack

from batch_lib import SAMPLES, make_batch, remove

try:
    import zarr
except ImportError:
    zarr = None


class Grids(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        make_batch(cls.folder.name, "-r", "20")
        cls.out = os.path.join(cls.folder.name, "out")
        cls.tars, cls.files, cls.zarr = (os.path.join(cls.folder.name, name) for name in ("tars", "files", "grids.zarr"))
        voxmend.batch.export(cls.out, cls.tars, to="webdataset", max_bytes=20000, shuffle=3)
        cls.made = [cls.out, cls.tars]
        if zarr is not None:
            voxmend.batch.export(cls.out, cls.zarr, to="zarr", chunk_bytes=3000)
            cls.made.append(cls.zarr)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_the_same_everywhere(self):
        for root in self.made:
            data = GridDataset(root, "train")
            self.assertEqual((data.classes, len(data), data.shape), (["ball", "prism", "ring"], 8, (20, 20, 20)))
            self.assertEqual(len(GridDataset(root)), 11)
            for i, name in enumerate(data.names):
                grid = voxmend.read(os.path.join(self.out, name[:-len(".off")] + ".binvox"))
                voxels, label = data[i]
                self.assertEqual((voxels.dtype, tuple(voxels.shape)), (torch.float32, (1, 20, 20, 20)))
                self.assertTrue((voxels[0].numpy() == grid.matrix).all())
                self.assertEqual(data.classes[label], name.split("/")[0])
            packed, labels = GridDataset(root, "train", packed=True).batch([3, -1])
            self.assertEqual((packed.dtype, tuple(packed.shape)), (torch.uint8, (2, 20, 20, 3)))
            self.assertTrue((unpack(packed, 20) == data.batch([3, len(data) - 1])[0]).all())
            copy = pickle.loads(pickle.dumps(data))
            self.assertTrue((copy[2][0] == data[2][0]).all())
            with self.assertRaises(IndexError):
                data[8]
            with self.assertRaises(voxmend.EmptyError):
                GridDataset(root, "none")

    def test_numbers_of_classes(self):
        """They are those of the plan: a class of broken files keeps its number, also in a split that has none of it, when it
        is mended and tried again, and for VoxelDataset; a folder without meshes has none."""
        meshes, out, tars, packed = (os.path.join(self.folder.name, name) for name in ("some", "few", "few-tars", "few.zarr"))
        for place, text in (("b/train/x.off", None), ("c/train/x.off", "OFF\n3 nothing\n"), ("d/test/x.off", None),
                            ("a/train/readme.txt", "none")):
            os.makedirs(os.path.dirname(os.path.join(meshes, place)))
            shutil.copy(os.path.join(SAMPLES, "cube.off"), os.path.join(meshes, place))
            if text:
                with open(os.path.join(meshes, place), "w") as file:
                    file.write(text)
        os.makedirs(os.path.join(meshes, "e", "train"))
        wanted = {None: {"b": 0, "d": 2}, "train": {"b": 0}, "test": {"d": 2}}
        voxmend.batch.run(meshes, out, options="-r 8")
        for mended in False, True:
            if mended:
                shutil.copy(os.path.join(SAMPLES, "cube.off"), os.path.join(meshes, "c", "train", "x.off"))
                voxmend.batch.run(meshes, out, options="-r 8 --retry unreadable")
                wanted[None]["c"] = wanted["train"]["c"] = 1
            voxmend.batch.export(out, tars, to="webdataset")
            roots = [out, tars]
            if zarr is not None:
                voxmend.batch.export(out, packed, to="zarr")
                roots.append(packed)
            for split, labels in wanted.items():
                for root in roots:
                    data = GridDataset(root, split)
                    self.assertEqual(data.classes, ["b", "c", "d"])
                    self.assertEqual({name.split("/")[0]: data[i][1] for i, name in enumerate(data.names)}, labels)
                models = VoxelDataset(meshes, split, 8)
                self.assertEqual(models.classes, ["b", "c", "d"])
                self.assertEqual({os.path.relpath(file, meshes)[0]: label for file, label in zip(models.files, models.labels)
                                  if mended or "/c/" not in file}, labels)
            for root in roots[1:]:
                remove(root)

    def test_without_a_class(self):
        """A mesh beside the folders of classes has none, -1, and moves no numbers; so have all where no folder is a class."""
        meshes, out, tars, packed = (os.path.join(self.folder.name, name)
                                     for name in ("stray", "strays", "stray-tars", "stray.zarr"))
        for number, name in enumerate(("template.off", "train/beside.off", "bed/train/x.off", "chair/train/y.off")):
            os.makedirs(os.path.dirname(os.path.join(meshes, name)), exist_ok=True)
            with open(os.path.join(SAMPLES, "cube.off")) as source, open(os.path.join(meshes, name), "w") as file:
                file.write(source.read() + "# %d\n" % number)
        wanted = {"template.off": -1, "train/beside.off": -1, "bed/train/x.off": 0, "chair/train/y.off": 1}
        for classes in ["bed", "chair"], []:
            voxmend.batch.run(meshes, out, options="-r 8")
            voxmend.batch.export(out, tars, to="webdataset")
            with open(os.path.join(tars, "classes.json")) as file:
                self.assertEqual(json.load(file), classes)
            roots = [out, tars]
            if zarr is not None:
                voxmend.batch.export(out, packed, to="zarr")
                roots.append(packed)
                group = zarr.open_group(packed, mode="r")
                with open(os.path.join(packed, "items.jsonl")) as file:
                    items = [json.loads(line)["item"] for line in file]
                self.assertEqual((group.attrs["classes"], dict(zip(items, group["label"][...].tolist()))), (classes, wanted))
            for root in roots:
                data = GridDataset(root)
                self.assertEqual((data.classes, dict(zip(data.names, data.labels.tolist()))), (classes, wanted))
                self.assertEqual([data[i][1] for i in range(len(data))], data.labels.tolist())
            if classes:
                models = VoxelDataset(meshes, None, 8)
                self.assertEqual((models.classes, [os.path.relpath(file, meshes) for file in models.files], models.labels),
                                 (classes, ["bed/train/x.off", "chair/train/y.off"], [0, 1]))
            for root in roots + [os.path.join(meshes, name) for name in classes]:
                remove(root)
            wanted = {name: -1 for name in wanted if "/" not in name or name.startswith("train")}

    def test_names_of_splits(self):
        """The plan, what is read of it and folders of meshes agree about what is a split, a class, or neither."""
        words = {"train": "train", "TRAIN": "train", "Training": "train", "test": "test", "Test": "test", "testing": "test",
                 "val": "val", "Valid": "val", "validation": "val", "validate": "val", "trained": "", "extra": "", "validity": ""}
        names = ["chair/%s/x.off" % word for word in words] + ["lamp/x.off", "group/desk/test/x.off", "bed/extra/more/train/x.off",
                                                                "toy/a/val/b/x.off"]
        meshes, out = os.path.join(self.folder.name, "words"), os.path.join(self.folder.name, "words-out")
        for number, name in enumerate(names):
            os.makedirs(os.path.dirname(os.path.join(meshes, name)))
            with open(os.path.join(SAMPLES, "cube.off")) as source, open(os.path.join(meshes, name), "w") as file:
                file.write(source.read() + "# %d\n" % number)
        voxmend.batch.run(meshes, out, options="-r 4")
        told = {item.item: (item.plan.get("class", ""), item.plan.get("split", "")) for item in voxmend.batch.Records(out)}
        self.assertEqual({name: place(name) for name in names}, told)
        self.assertEqual({word: told["chair/%s/x.off" % word] for word in words},
                         {word: ("chair", split) for word, split in words.items()})
        self.assertEqual([told[name] for name in names[-4:]], [("lamp", ""), ("desk", "test"), ("more", "train"), ("toy", "")])
        for split, wanted in (("train", 4), ("TRAINING", 4), ("Test", 4), ("valid", 4), (None, 17)):
            grids, models = GridDataset(out, split), VoxelDataset(meshes, split, 4)
            self.assertEqual(len(grids), wanted)
            self.assertEqual(sorted(grids.names), sorted(os.path.relpath(file, meshes) for file in models.files))
            self.assertEqual(grids.classes, models.classes)
            self.assertEqual(sorted(grids.labels), sorted(models.labels))
        self.assertEqual(len(VoxelDataset(meshes, "extra", 4)), 1)  # any folder below the class
        with self.assertRaisesRegex(voxmend.EmptyError, "'none'; there are .'test', 'train', 'val'.$"):
            VoxelDataset(meshes, "none", 4)
        older = os.path.join(out, ".batch", "plan.jsonl")  # of a batch that kept the words
        with open(older) as file:
            plan = file.read()
        with open(older, "w") as file:
            file.write(plan.replace('"split":"train"', '"split":"Train"'))
        self.assertEqual(len(GridDataset(out, "train")), 4)

    def test_splits_above_classes(self):
        """train/chair/x.off, as torchvision's ImageFolder has it; folders may be links."""
        meshes, out = os.path.join(self.folder.name, "above"), os.path.join(self.folder.name, "above-out")
        for name in ("train/chair/a.off", "Train/chair/b.off", "train/lamp/a.off", "test/chair/a.off", "train/.hidden/a.off"):
            os.makedirs(os.path.dirname(os.path.join(meshes, name)), exist_ok=True)
            shutil.copy(os.path.join(SAMPLES, "cube.off"), os.path.join(meshes, name))
        os.symlink("../train/lamp", os.path.join(meshes, "test", "bed"))
        os.symlink("..", os.path.join(meshes, "test", "chair", "back"))
        voxmend.batch.run(meshes, out, options="-r 4")
        for split, wanted in (("train", ["chair", "chair", "lamp"]), ("test", ["bed", "chair"]),
                              (None, ["bed", "chair", "chair", "chair", "lamp"])):
            for data in GridDataset(out, split), VoxelDataset(meshes, split, 4):
                self.assertEqual(data.classes, ["bed", "chair", "lamp"])
                self.assertEqual(sorted(data.classes[label] for label in data.labels), wanted)

    def test_padded_and_not_cubic(self):
        out = os.path.join(self.folder.name, "flat")
        voxmend.batch.run(os.path.join(self.folder.name, "in", "prism"), out, options="-r 21x10x13 --format binvox")
        data = GridDataset(out)
        self.assertEqual((data.shape, tuple(data[0][0].shape)), ((21, 10, 13), (1, 21, 10, 13)))
        with open(os.path.join(out, ".batch", "journal-0-of-1.jsonl")) as file:
            self.assertEqual(len(data), sum('"status":"ok"' in line for line in file))

    def test_numbers_are_no_voxels(self):
        """Nor where all are 0 or 1, as labels of one body: the batch tells. Files in tars are as those of the batch."""
        meshes, out, tars = (os.path.join(self.folder.name, name) for name in ("in/ring/train", "numbers", "number-tars"))
        draw = '--no-grid --augment "-n 2 -r 12 --format npy%s"'
        for options, values in (("--distance signed", "distance"), ("--coverage 2 --scalar uint8", "coverage"), ("--coverage 2", "coverage"),
                                ("--labels part", "labels"), ("--color position", "color"), ("", None),
                                (draw % " --coverage 2", "coverage"), (draw % "", None)):
            voxmend.batch.run(meshes, out, options="-r 12 --format npy " + options if "-n" not in options else options)
            voxmend.batch.export(out, tars, to="webdataset", content="files")
            if values is None:
                folder, files = GridDataset(out), GridDataset(tars)
                self.assertEqual(folder.names, files.names)
                for i in range(len(folder)):
                    self.assertTrue((folder[i][0] == files[i][0]).all())
            else:
                for root in out, tars:
                    with self.assertRaisesRegex(voxmend.NumbersError, r"holds numbers \(%s\)" % values):
                        GridDataset(root)
            if values is not None and "-n" not in options:
                for to in ("webdataset",) + ("zarr",) * (zarr is not None):
                    with self.assertRaisesRegex(voxmend.NumbersError, r"holds numbers \(%s\)" % values):
                        voxmend.batch.export(out, tars + to, to=to)
                    self.assertFalse(os.path.exists(tars + to))
            remove(out)
            remove(tars)

    def rewritten(self, array, said=None):
        """A tar of one grid, whose array and .json are others."""
        folder = tempfile.mkdtemp(dir=self.folder.name)
        files = [("npy", io.BytesIO())] + ([("npy.json", io.BytesIO(json.dumps(said).encode()))] if said else [])
        numpy.save(files[0][1], array)
        line = {"item": "a.off", "class": "a", "split": "", "shape": list(array.shape[:3]), "origin": [0, 0, 0], "tar": "x",
                "members": []}
        with open(os.path.join(folder, "x"), "wb") as tar:
            for name, file in files:
                line["members"].append({"name": name, "offset": tar.tell(), "bytes": len(file.getvalue())})
                tar.write(file.getvalue())
        with open(os.path.join(folder, "index.jsonl"), "w") as index:
            index.write(json.dumps(line) + "\n")
        return GridDataset(folder)

    def test_what_is_bits(self):
        """As voxmend.read has it, of all types and what is said of them."""
        mask = numpy.zeros((3, 4, 5), bool)
        mask[1, 2:, ::2] = True
        for dtype in ("bool", "u1", "i1", "u2", ">i4", "f2", "f4", ">f8"):
            for factor in (1, 255, 2, -1):
                for kind in (None, "numbers", "distance", "coverage", "labels", "confidence", "colors", "other"):
                    if dtype == "bool" and factor != 1 or dtype == "u1" and factor < 0:
                        continue
                    array, said = (mask * numpy.array(factor)).astype(dtype), {
                        "format": "voxmend npy", "version": 1, "dims": list(mask.shape), "order": "z fastest, then y, then x",
                        "origin": [0, 0, 0], "voxel_size": [1, 1, 1]}
                    if kind:
                        said["values"] = kind
                    path = os.path.join(self.folder.name, "said.npy")
                    numpy.save(path, array)
                    with open(path + ".json", "w") as file:
                        json.dump(said, file)
                    try:
                        with warnings.catch_warnings():
                            warnings.simplefilter("error")
                            wanted = voxmend.read(path).matrix
                    except voxmend.NumbersError:
                        wanted = None
                    data = self.rewritten(array, said)
                    if wanted is None:
                        with self.assertRaises(voxmend.NumbersError, msg=(dtype, factor, kind)):
                            data[0]
                    else:
                        self.assertTrue((data[0][0][0].numpy() == wanted).all(), (dtype, factor, kind))
        with self.assertRaises(voxmend.NumbersError):
            self.rewritten(numpy.zeros((3, 4, 5, 4), numpy.uint8))[0]

    def test_variants(self):
        """Of a batch without grids they are the items, from the folder and the tars; else the grids are."""
        meshes, out, tars = (os.path.join(self.folder.name, name) for name in ("in", "variants", "variant-tars"))
        draws = '--augment "-n 3 -r 10 --rotate any --format %s"'
        voxmend.batch.run(meshes, out, options="--no-grid " + draws % "npy")
        voxmend.batch.export(out, tars, to="webdataset", content="files", shuffle=1, max_bytes=30000)
        folder, files = GridDataset(out, "train"), GridDataset(tars, "train")
        self.assertEqual((len(folder), folder.shape, folder.classes), (24, (10, 10, 10), ["ball", "prism", "ring"]))
        self.assertEqual(folder.names[:4], 3 * ["ball/train/flipped 0.v1.off"] + ["ball/train/repeated 0.v1.off"])
        found = {}
        for data in folder, files:
            for i, name in enumerate(data.names):
                found.setdefault(name, []).append(data[i][0])
                self.assertEqual(data.classes[data[i][1]], name.split("/")[0])
        for name, voxels in found.items():
            self.assertEqual(len(voxels), 6)
            for v in range(3):
                path = os.path.join(out, name[:-len(".off")] + ".variants", "%06d.npy" % v)
                self.assertTrue((voxels[v][0].numpy() == numpy.load(path)).all())
                self.assertTrue((voxels[v] == voxels[v + 3]).all())
        for path in (out, tars):
            remove(path)
        voxmend.batch.run(meshes, out, options="-r 12 --format npy " + draws % "rle")
        voxmend.batch.export(out, tars, to="webdataset", content="files")
        for data in GridDataset(out), GridDataset(tars):
            self.assertEqual((len(data), data.shape), (11, (12, 12, 12)))
        for path in (out, tars):
            remove(path)
        voxmend.batch.run(os.path.join(meshes, "prism"), out, options="--no-grid " + draws % "rle")
        self.assertEqual(len(GridDataset(out)), 9)
        voxmend.batch.export(out, tars, to="webdataset", content="files")
        with self.assertRaisesRegex(voxmend.ArgumentError, "no variant as .npy.*--format npy"):
            GridDataset(tars)

    def test_refusals(self):
        voxmend.batch.export(self.out, self.files, to="webdataset", content="files")
        with self.assertRaisesRegex(voxmend.ArgumentError, "--content bits"):
            GridDataset(self.files)
        with self.assertRaisesRegex(voxmend.ArgumentError, "neither the folder of a batch"):
            GridDataset(self.folder.name)
        tight = os.path.join(self.folder.name, "tight")
        voxmend.batch.run(os.path.join(self.folder.name, "in"), tight, options="-r 20 --fit tight")
        with self.assertRaisesRegex(voxmend.ArgumentError, "equal shape"):
            GridDataset(tight)
        if zarr is not None:
            with self.assertRaisesRegex(voxmend.ArgumentError, "--fit cube"):
                voxmend.batch.export(tight, os.path.join(self.folder.name, "x"), to="zarr")
        data = GridDataset(self.out)
        for wrong in (dict(shuffle="all"), dict(rank=2, ranks=2), dict(ranks=0)):
            with self.assertRaises(voxmend.ArgumentError):
                IterableVoxelDataset(data, 4, **wrong)
        meshes = VoxelDataset(os.path.join(self.folder.name, "in"), "test")
        with self.assertRaises(voxmend.ArgumentError):
            IterableVoxelDataset(meshes, 4, shuffle="groups")

    # ---- Orders ----

    def sums(self, data):
        """One number for each item, to tell them apart."""
        return [int(voxels.sum() * 7 + (voxels[0, 5] * torch.arange(400).reshape(20, 20)).sum()) for voxels, _ in
                (data[i] for i in range(len(data)))]

    def test_epochs(self):
        for root in self.made:
            data = GridDataset(root)
            for shuffle in (True, "groups"):
                batches = IterableVoxelDataset(data, 3, epochs=2, seed=9, shuffle=shuffle)
                self.assertEqual(sorted(batches.order(0)), list(range(11)))
                self.assertFalse((batches.order(0) == batches.order(1)).all())
                self.assertTrue((batches.order(1) == IterableVoxelDataset(data, 3, seed=9, shuffle=shuffle).order(1)).all())
                made = torch.cat([voxels for voxels, _ in batches])
                wanted = data.batch(numpy.concatenate([batches.order(0), batches.order(1)]))[0]
                self.assertTrue((made == wanted).all())

    def test_what_cannot_be_read(self):
        out = os.path.join(self.folder.name, "holes")
        shutil.copytree(self.out, out)
        data = GridDataset(out)
        self.assertEqual(len(data), 11)
        os.remove(os.path.join(out, os.path.splitext(data.names[4])[0] + ".binvox"))
        with self.assertRaises(OSError):
            data.batch(range(11))
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            for _ in range(2):
                voxels, labels = data.batch(range(11), on_error="skip")
                kept = [i for i in range(11) if i != 4]
                self.assertTrue((voxels == data.batch(kept)[0]).all() and (labels == data.batch(kept)[1]).all())
            self.assertEqual(sum(len(labels) for _, labels in IterableVoxelDataset(data, 3, on_error="skip")), 10)
        self.assertEqual(len(told), 1)
        self.assertRegex(str(told[0].message), "%s.*; it is left out$" % os.path.splitext(data.names[4])[0])
        with self.assertRaises(OSError):
            list(IterableVoxelDataset(data, 3))

    def test_groups_stay_together(self):
        data = GridDataset(self.tars)
        self.assertGreater(len(set(data.groups.tolist())), 3)
        batches = IterableVoxelDataset(data, 2, shuffle="groups")
        batches.TOGETHER = 2
        order = data.groups[batches.order(4)].tolist()
        windows = []  # pairs of groups, one after another
        for group in order:
            if not windows or (group not in windows[-1] and len(windows[-1]) == 2):
                windows.append(set())
            windows[-1].add(group)
        self.assertEqual(sum(len(window) for window in windows), len(set(order)))

    def test_ranks_and_workers(self):
        data = GridDataset(self.tars)
        names = self.sums(data)
        for workers in (0, 2):
            seen = []
            for rank in range(3):
                batches = IterableVoxelDataset(data, 1, seed=2, rank=rank, ranks=3)
                loader = DataLoader(batches, batch_size=None, num_workers=workers)
                mine = [int(voxels[0].sum() * 7 + (voxels[0, 0, 5] * torch.arange(400).reshape(20, 20)).sum())
                        for voxels, _ in loader]
                self.assertEqual(len(mine), 3)  # 11 items: two are left out, so that all ranks have as many
                seen += mine
            order = IterableVoxelDataset(data, 1, seed=2).order(0)
            self.assertEqual(collections.Counter(seen), collections.Counter(names[i] for i in order[:9]))

    def test_forked_workers_read_the_folder(self):
        data = GridDataset(self.out)
        data[0]  # files are open
        loader = DataLoader(data, batch_size=1, num_workers=2)
        for i, (voxels, label) in enumerate(loader):
            self.assertTrue((voxels[0] == data[i][0]).all())


if __name__ == "__main__":
    print("torch %s, zarr %s" % (torch.__version__, zarr.__version__ if zarr else "not there"))
    unittest.main(verbosity=1)
