# SPDX-License-Identifier: BSD-3-Clause
"""voxmend.batch without Dask: runs, records, tars, packed grids."""
import hashlib
import io
import json
import os
import shutil
import sqlite3
import subprocess
import sys
import tarfile
import tempfile
import unittest

import numpy

import voxmend
import voxmend.batch
from voxmend._packed import pack, unpack

from batch_lib import make_batch, outputs, remove


class Batches(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.summary = make_batch(cls.folder.name, "-r", "20", "--format", "npy")
        cls.out = os.path.join(cls.folder.name, "out")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def at(self, name):
        return os.path.join(self.folder.name, name)

    def command(self, *words, **environment):
        return subprocess.run([sys.executable, "-m", "voxmend.batch", *words], capture_output=True, text=True, cwd=self.folder.name,
                              env=dict(os.environ, **environment), timeout=120)

    # ---- Runs ----

    def test_run(self):
        counts = self.summary["counts"]
        self.assertEqual((self.summary["meshes"], counts["ok"] + counts["degraded"], counts["duplicate"], counts["unreadable"]),
                         (12, 10, 1, 1))
        self.assertEqual(len(outputs(self.out)), 22)  # .npy and .npy.json

    def test_shards_and_words(self):
        other = voxmend.batch.run(self.at("in"), self.at("shards"), shards=3, jobs=1, options="-r 20 --format npy")
        self.assertEqual(other["counts"]["unreadable"], 1)
        self.assertEqual(outputs(self.at("shards")), outputs(self.out))
        again = voxmend.batch.run(self.at("in"), self.at("shards"), options="-r 20 --format npy")  # as many as it began with
        self.assertEqual(again["shards"], 3)

    def test_command(self):
        done = self.command("in", "-o", "told", "-j", "2", "--", "-r", "20", "--format", "npy")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(json.loads(done.stdout)["counts"], self.summary["counts"])
        self.assertEqual(outputs(self.at("told")), outputs(self.out))

    def test_refusals(self):
        for words, options, line in (
                (["in"], ["--nonsense"], "unknown option --nonsense"), (["in"], ["-o", "x"], "an argument of its own"),
                (["none"], [], "none: "), (["-"], [], "standard input")):
            done = self.command(*words, "-o", "refused", "--", *options)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(line, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        with self.assertRaisesRegex(voxmend.batch.BatchError, "resolution=20.*resolution=21"):
            voxmend.batch.run(self.at("in"), self.out, options="-r 21 --format npy")
        for wrong in (dict(shards=0), dict(jobs=0), dict(retries=-1), dict(program="/none")):
            with self.assertRaises(voxmend.ArgumentError):
                voxmend.batch.run(self.at("in"), self.out, **wrong)
        self.assertEqual(self.command("export", "out").returncode, 2)
        self.assertEqual(self.command("export", "out", "--to", "parquet", "-o", "p", "--shuffle", "1").returncode, 2)

    def test_without_dask(self):
        with open(self.at("distributed.py"), "w") as file:
            file.write("raise ImportError('not here')\n")
        done = self.command("in", "-o", "x", "--dask", "local", PYTHONPATH=self.folder.name + ":" + os.environ["PYTHONPATH"])
        os.unlink(self.at("distributed.py"))
        self.assertEqual((done.returncode, done.stderr), (1, "voxmend.batch: batch: Dask is not installed (Debian: "
                                                          "python3-distributed; PyPI: distributed)\n"))

    # ---- Records ----

    def test_records(self):
        records = voxmend.batch.Records(self.out)
        self.assertEqual((len(records), records.complete, records.damaged), (12, 1, 0))
        places = {item.item: (item.kind, item.split, item.status) for item in records}
        self.assertEqual(places["prism/test/rocket 0.v1.off"], ("prism", "test", "ok"))
        self.assertEqual(places["ring/train/damaged.off"], ("ring", "train", "unreadable"))
        self.assertEqual(places["ring/train/torus 0.v1.off"][2], "duplicate")
        with self.assertRaisesRegex(voxmend.ArgumentError, "no batch in this folder"):
            voxmend.batch.Records(self.at("in"))

    def test_damaged_and_unfinished(self):
        remove(self.at("cut"))
        os.makedirs(self.at("cut/.batch"))
        for name in os.listdir(self.out + "/.batch"):
            with open(os.path.join(self.out, ".batch", name), "rb") as file:
                data = file.read()
            if name.startswith("journal"):
                lines = data.splitlines(keepends=True)
                damaged = next(i for i, line in enumerate(lines) if b'"event":"end"' in line)
                lines[damaged] = lines[damaged].replace(b'"attempt":1', b'"attempt":2')
                data = b"".join(lines[:-1]) + lines[-1][:20]
            with open(os.path.join(self.at("cut/.batch"), name), "wb") as file:
                file.write(data)
        records = voxmend.batch.Records(self.at("cut"))
        self.assertEqual((records.complete, records.damaged), (0, 1))
        self.assertEqual(sum(item.status == "pending" for item in records), 1)
        with self.assertRaisesRegex(voxmend.ArgumentError, "0 of 1 shards are at their end"):
            voxmend.batch.export(self.at("cut"), self.at("never"), to="webdataset")
        self.assertFalse(os.path.exists(self.at("never")))

    def test_changed_input_is_pending(self):
        remove(self.at("mended"))
        shutil.copytree(self.out, self.at("mended"))
        item = "prism/test/rocket 0.v1.off"
        rest = b'"event":"changed","item":"%s","status":"pending"}' % item.encode()
        with open(self.at("mended/.batch/journal-0-of-1.jsonl"), "ab") as file:
            file.write(b'{"sum":"%s",%s\n' % (hashlib.sha256(rest).hexdigest()[:16].encode(), rest))
        records = voxmend.batch.Records(self.at("mended"))
        self.assertEqual((records.complete, records.damaged), (0, 0))
        self.assertEqual([found.item for found in records if found.status == "pending"], [item])
        with self.assertRaisesRegex(voxmend.ArgumentError, "0 of 1 shards are at their end"):
            voxmend.batch.export(self.at("mended"), self.at("never"), to="webdataset")
        program = voxmend._batch_program.find_program()
        done = subprocess.run([program, "batch", "export", self.at("mended"), "--to", "sqlite", "-o", self.at("mended.db")],
                              capture_output=True, text=True)
        if "writes no databases" in done.stderr:
            return
        self.assertEqual(done.returncode, 0, done.stderr)
        database = sqlite3.connect(self.at("mended.db"))
        self.assertEqual(database.execute("SELECT status, sha256 FROM meshes WHERE item = ?", (item,)).fetchall(),
                         [("pending", None)])
        self.assertEqual(database.execute("SELECT count(*) FROM outputs WHERE item = ?", (item,)).fetchone(), (0,))
        database.close()

    # ---- Tars ----

    def members(self, folder):
        found = {}
        for name in sorted(os.listdir(folder)):
            if name.endswith(".tar"):
                with tarfile.open(os.path.join(folder, name)) as tar:
                    for member in tar:
                        found[name, member.name] = tar.extractfile(member).read()
        return found

    def test_tars(self):
        told = voxmend.batch.export(self.out, self.at("tars"), to="webdataset")
        self.assertEqual((told["meshes"], told["tars"]), (11, 2))
        found = self.members(self.at("tars"))
        self.assertEqual(len(found), 22)
        grid = voxmend.read(os.path.join(self.out, "prism/test/rocket 0.v1.npy"))
        bits = numpy.load(io.BytesIO(found["test-000000.tar", "prism/test/rocket 0%2Ev1.bits.npy"]))
        self.assertTrue((unpack(bits, 20, bool) == grid.matrix).all())
        about = json.loads(found["test-000000.tar", "prism/test/rocket 0%2Ev1.json"])
        self.assertEqual((about["class"], about["shape"], about["hash"]), ("prism", [20, 20, 20], "%016x" % grid.hash))
        self.assertTrue(numpy.allclose(about["origin"], grid.origin))
        with open(self.at("tars/index.jsonl")) as file:
            lines = [json.loads(line) for line in file]
        self.assertEqual(len(lines), 11)
        for line in lines:  # each stands where the index says
            with open(os.path.join(self.at("tars"), line["tar"]), "rb") as tar:
                tar.seek(line["members"][0]["offset"])
                self.assertEqual(tar.read(line["members"][0]["bytes"]), found[line["tar"], line["key"] + ".bits.npy"])

    def test_long_names(self):
        place = "in2/" + "x" * 120 + "/tr\u00e4in \U0001f9ca"
        os.makedirs(self.at(place))
        os.link(self.at("in/prism/test/rocket 0.v1.off"), self.at(place + "/a%.b.off"))
        os.link(self.at("in/ring/test/torus 0.v1.off"), self.at(place + "/a%2E.off"))
        voxmend.batch.run(self.at("in2"), self.at("out2"), options="-r 20")
        voxmend.batch.export(self.at("out2"), self.at("long"), to="webdataset", max_bytes=10240)
        found = self.members(self.at("long"))
        self.assertEqual(sorted(name.rsplit("/")[-1] for _, name in found),
                         ["a%25%2Eb.bits.npy", "a%25%2Eb.json", "a%252E.bits.npy", "a%252E.json"])
        with open(self.at("long/index.jsonl"), encoding="utf-8") as file:
            for line in map(json.loads, file):
                with open(os.path.join(self.at("long"), line["tar"]), "rb") as tar:
                    tar.seek(line["members"][0]["offset"])
                    self.assertEqual(tar.read(6), b"\x93NUMPY")
                self.assertLessEqual(os.path.getsize(os.path.join(self.at("long"), line["tar"])), 10240)

    def test_exports_without_a_folder(self):
        """Neither a name that is only used meanwhile, nor one that is none, is told."""
        beside = self.at("a-file")
        open(beside, "w").close()
        for path, missing in ((self.at("gone/tars"), self.at("gone")), (beside + "/tars/", beside)):
            with self.assertRaisesRegex(OSError, "^%s: there is no folder %s to write it in; make that first$" % (path, missing)):
                voxmend.batch.export(self.out, path, to="webdataset")
        with self.assertRaises(FileNotFoundError) as told:
            voxmend.batch.export(self.out, self.at("gone/tars"), to="webdataset")
        self.assertEqual(told.exception.filename, self.at("gone/tars"))
        os.remove(beside)

    def test_tars_of_files(self):
        options = dict(to="webdataset", content="files", max_bytes=40000, shuffle=5)
        first = voxmend.batch.export(self.out, self.at("files1"), **options)
        self.assertGreater(first["tars"], 3)
        found = self.members(self.at("files1"))
        with open(os.path.join(self.out, "ball/test/doubled 0.v1.npy"), "rb") as file:
            self.assertIn(file.read(), found.values())
        self.assertEqual(sum(name.endswith(".npy.json") for _, name in found), 11)
        for name in os.listdir(self.at("files1")):
            self.assertLessEqual(os.path.getsize(self.at("files1/" + name)), 40000)
        os.utime(os.path.join(self.out, "ball/test/doubled 0.v1.npy"))
        voxmend.batch.export(self.out, self.at("files2"), **options)
        self.assertEqual(outputs(self.at("files1")), outputs(self.at("files2")))  # the same bytes, whenever
        voxmend.batch.export(self.out, self.at("files3"), **dict(options, shuffle=6))
        self.assertNotEqual(outputs(self.at("files1")), outputs(self.at("files3")))
        self.assertEqual(sorted(name for _, name in self.members(self.at("files3"))), sorted(name for _, name in found))

    def test_tars_of_folders(self):
        """Variants are files of their mesh, after it; a grid that is a folder is none."""
        prisms = self.at("in/prism/train")
        for name, options in (("both", "-r 9"), ("alone", "--no-grid")):
            voxmend.batch.run(prisms, self.at(name), options=options + ' --augment "-n 3 --first 4 -r 10 --format npy"')
            voxmend.batch.export(self.at(name), self.at(name + "-tars"), to="webdataset", content="files")
            files = {file: data for (_, file), data in self.members(self.at(name + "-tars")).items()}
            for mesh in ("l_prism 0", "star_prism 0"):
                made = ["variants.%06d.npy%s" % (v, end) for v in (4, 5, 6) for end in ("", ".json")]
                self.assertEqual([file[len(mesh + "%2Ev1."):] for file in files if os.path.basename(file).startswith(mesh)],
                                 (["binvox"] if name == "both" else []) + made + ["json"])
                folder = next(at for at, _, _ in os.walk(self.at(name)) if at.endswith("/%s.v1.variants" % mesh))
                key = next(file for file in files if file.endswith(mesh + "%2Ev1.json"))[:-len("json")]
                for file in made:
                    with open(os.path.join(folder, file[len("variants."):]), "rb") as one:
                        self.assertEqual(one.read(), files[key + file])
                self.assertEqual(json.loads(files[key + "json"])["shape"], [9 if name == "both" else 10] * 3)
        with self.assertRaisesRegex(voxmend.EmptyError, "no grids .--no-grid., but variants"):
            voxmend.batch.export(self.at("alone"), self.at("never"), to="webdataset")
        os.rename(os.path.join(folder, "000005.npy"), os.path.join(folder, "000007.npy"))
        with self.assertRaisesRegex(voxmend.FormatError, "not as it was written"):
            voxmend.batch.export(self.at("alone"), self.at("never"), to="webdataset", content="files")
        voxmend.batch.run(prisms, self.at("arrays"), options="-r 9 --format zarr")
        with self.assertRaisesRegex(voxmend.ArgumentError, '--format zarr is a folder.* content "bits"'):
            voxmend.batch.export(self.at("arrays"), self.at("never"), to="webdataset", content="files")
        voxmend.batch.export(self.at("arrays"), self.at("array-tars"), to="webdataset")
        voxmend.batch.export(self.at("both"), self.at("grid-tars"), to="webdataset")
        bits = [[data for (_, file), data in self.members(self.at(name)).items() if file.endswith("bits.npy")]
                for name in ("array-tars", "grid-tars")]
        self.assertEqual((len(bits[0]), bits[0]), (2, bits[1]))

    def test_changed_output_is_refused(self):
        path = os.path.join(self.out, "ring/test/torus 0.v1.npy")
        with open(path, "r+b") as file:
            file.seek(-1, 2)
            last = file.read(1)
            file.seek(-1, 2)
            file.write(bytes([last[0] ^ 1]))
        try:
            with self.assertRaisesRegex(voxmend.FormatError, "not as it was written"):
                voxmend.batch.export(self.out, self.at("bad"), to="webdataset")
        finally:
            with open(path, "r+b") as file:
                file.seek(-1, 2)
                file.write(last)
        self.assertEqual([name for name in os.listdir(self.folder.name) if name.startswith("bad")], [])

    def test_program_exports(self):
        program = voxmend._batch_program.find_program()

        def export(name, *options, python=sys.executable):
            return subprocess.run([program, "batch", "export", self.out, "--to", "webdataset", "-o", self.at(name), *options],
                                  capture_output=True, text=True, env=dict(os.environ, PYTHON=python))

        done = export("by", "--json", "--report", self.at("by.json"))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(json.loads(done.stdout)["meshes"], 11)
        with open(self.at("by.json"), encoding="utf-8") as file:
            self.assertEqual(json.load(file), json.loads(done.stdout))
        done = export("words")
        self.assertEqual((done.returncode, done.stdout), (0, "output     %s (webdataset): 11 meshes\n" % self.at("words")))
        done = export("drawn", "--shuffle", "5", "--max-bytes", "10K", "--content=bits", "--json")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        voxmend.batch.export(self.out, self.at("same"), to="webdataset", shuffle=5, max_bytes=10240)
        self.assertGreater(json.loads(done.stdout)["tars"], 1)
        with open(self.at("drawn/index.jsonl"), "rb") as one, open(self.at("same/index.jsonl"), "rb") as other:
            self.assertEqual(one.read(), other.read())
        bare = self.at("bare")  # a Python without packages
        with open(bare, "w", encoding="utf-8") as file:
            file.write('#!/bin/sh\nexec "%s" -I -S "$@"\n' % sys.executable)
        os.chmod(bare, 0o755)
        done = export("never", python=bare)
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (1, "", 1))
        self.assertIn("lacks the Python package voxmend, or what it needs", done.stderr)
        self.assertFalse(os.path.exists(self.at("never")))

    # ---- Bits ----

    def test_packed(self):
        draw = numpy.random.default_rng(7)
        for length in (1, 7, 8, 9, 20, 64, 65):
            matrix = draw.random((3, 2, 5, length)) < 0.5
            bits = pack(matrix)
            self.assertEqual(bits.shape, (3, 2, 5, (length + 7) // 8))
            for kind in (numpy.float32, numpy.uint8, bool):
                self.assertTrue((unpack(bits, length, kind) == matrix).all())
                self.assertEqual(unpack(bits, length, kind).dtype, kind)
            self.assertTrue((unpack(bits[:, ::-1], length, bool) == matrix[:, ::-1]).all())
        self.assertEqual(unpack(numpy.empty((0, 4, 1), numpy.uint8), 8).shape, (0, 4, 8))
        for wrong in (lambda: unpack(bits, 64), lambda: unpack(bits, 65, numpy.int64), lambda: unpack(bits.astype(int), 65)):
            with self.assertRaises(voxmend.ArgumentError):
                wrong()


if __name__ == "__main__":
    unittest.main(verbosity=1)
