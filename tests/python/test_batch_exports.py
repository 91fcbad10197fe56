# SPDX-License-Identifier: BSD-3-Clause
"""What voxmend.batch exports, read by others: zarr, pyarrow and webdataset, each of which may be absent. The words of the
command line name those that have to be there."""
import json
import os
import sys
import tempfile
import unittest

import numpy

import voxmend
import voxmend.batch

from voxmend._export_common import packed_grid, with_grids
from voxmend._packed import pack

from batch_lib import make_batch

WANTED = sys.argv[1:]


class Exports(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        make_batch(cls.folder.name, "-r", "21", "--format", "rle")
        cls.out = os.path.join(cls.folder.name, "out")
        cls.records = list(voxmend.batch.Records(cls.out))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_other_formats(self):
        """Grids of octrees are grids like others."""
        with tempfile.TemporaryDirectory() as folder:
            make_batch(folder, "-r", "21", "--format", "octree")
            records = voxmend.batch.Records(os.path.join(folder, "out"))
            numbers = with_grids(records)
            self.assertEqual(len(numbers), 11)
            for number in numbers:
                item = records[number]
                self.assertTrue((packed_grid(records, item)[0] == pack(self.grid(item.item).matrix)).all())

    def at(self, name):
        return os.path.join(self.folder.name, name)

    def grid(self, item):
        return voxmend.read(os.path.join(self.out, item[:-len(".off")] + ".rle"))

    @unittest.skipUnless("zarr" in WANTED, "not asked for")
    def test_zarr(self):
        import zarr
        versions = [2, 3] if hasattr(zarr.Group, "create_array") else [2]
        for version in versions:
            path = self.at("grids%d.zarr" % version)
            told = voxmend.batch.export(self.out, path, to="zarr", zarr_format=version, chunk_bytes=4 * 21 * 21 * 3)
            self.assertEqual((told["meshes"], told["chunk_grids"]), (11, 4))
            self.assertTrue(os.path.exists(os.path.join(path, ".zgroup" if version == 2 else "zarr.json")))
            group = zarr.open_group(path, mode="r")
            bits = group["grids"][...]
            self.assertEqual((bits.shape, bits.dtype), ((11, 21, 21, 3), numpy.uint8))
            with open(os.path.join(path, "items.jsonl")) as file:
                items = [json.loads(line) for line in file]
            for i, item in enumerate(items):
                grid = self.grid(item["item"])
                self.assertTrue((numpy.unpackbits(bits[i], axis=-1, count=21, bitorder="little") == grid.matrix).all())
                self.assertTrue((group["origin"][i] == grid.origin).all() and (group["voxel_size"][i] == grid.pitch).all())
                self.assertEqual(group.attrs["classes"][group["label"][i]], item["item"].split("/")[0])
            self.assertEqual(list(group.attrs["shape"]), [21, 21, 21])
        some = voxmend.batch.export(self.out, self.at("test.zarr"), to="zarr", split="test")
        self.assertEqual(some["meshes"], 3)
        with self.assertRaises(voxmend.EmptyError):
            voxmend.batch.export(self.out, self.at("none.zarr"), to="zarr", split="none")
        self.assertEqual([name for name in os.listdir(self.folder.name) if name.endswith(".tmp") or "none" in name], [])

    @unittest.skipUnless("pyarrow" in WANTED, "not asked for")
    def test_parquet(self):
        import pyarrow.parquet
        path = self.at("meshes.parquet")
        self.assertEqual(voxmend.batch.export(self.out, path, to="parquet")["meshes"], 12)
        rows = pyarrow.parquet.read_table(path).to_pylist()
        self.assertEqual([row["item"] for row in rows], [item.item for item in self.records])
        for row, item in zip(rows, self.records):
            self.assertEqual((row["status"], row["class"], row["split"]), (item.status, item.kind, item.split))
            self.assertEqual(json.loads(row["record"]), item.end)
            if item.status == "unreadable":
                self.assertEqual((row["code"], row["stage"] is None, row["outputs"]), ("format", False, []))
                self.assertIn("damaged.off:2", row["message"])
                continue
            grid = self.grid(item.item)
            self.assertEqual((row["voxels"], row["hash"]), (grid.filled_count, "%016x" % grid.hash))
            self.assertEqual((row["shape"], row["origin"]), ([21, 21, 21], grid.origin.tolist()))
            self.assertEqual(row["outputs"][0]["bytes"], os.path.getsize(os.path.join(self.out, row["outputs"][0]["path"])))
        with self.assertRaisesRegex(voxmend.ArgumentError, "is there already"):
            voxmend.batch.export(self.out, path, to="parquet")

    @unittest.skipUnless("webdataset" in WANTED, "not asked for")
    def test_webdataset(self):
        import torch
        import webdataset
        from voxmend.torch import GridDataset
        voxmend.batch.export(self.out, self.at("tars"), to="webdataset", max_bytes=20480, shuffle=8)
        tars = sorted(os.path.join(self.at("tars"), name) for name in os.listdir(self.at("tars"))
                      if name.startswith("train") and name.endswith(".tar"))
        self.assertGreater(len(tars), 1)
        mine = GridDataset(self.at("tars"), "train", packed=True)
        theirs = list(webdataset.WebDataset(tars, shardshuffle=False).decode())
        self.assertEqual([sample["json"]["item"] for sample in theirs], mine.names)
        for i, sample in enumerate(theirs):
            bits, label = mine[i]
            self.assertTrue((torch.from_numpy(sample["bits.npy"]) == bits).all())
            self.assertEqual(mine.classes[label], sample["json"]["class"])


if __name__ == "__main__":
    for name in WANTED:
        print(name, __import__(name).__version__)
    unittest.main(argv=sys.argv[:1], verbosity=1)
