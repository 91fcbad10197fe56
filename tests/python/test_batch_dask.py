# SPDX-License-Identifier: BSD-3-Clause
"""voxmend.batch over Dask, with a scheduler and workers in processes of their own, which are killed in the midst of it."""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import distributed

import voxmend
import voxmend.batch

from batch_lib import make_dataset, outputs

HERE = os.path.dirname(os.path.abspath(__file__))
OPTIONS = ["-r", "256", "--thin", "26"]  # some 0.1 s each
SHARDS = 3


def wait_for(condition, what, seconds=60):
    until = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > until:
            raise AssertionError("waited for %s in vain" % what)
        time.sleep(0.02)


def parent_of(process):
    """0 where there is no such process."""
    try:
        with open("/proc/%d/stat" % process) as file:
            return int(file.read().rpartition(")")[2].split()[1])
    except (OSError, IndexError):
        return 0


def is_running(process):
    return parent_of(process) != 0


class Dask(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.count = make_dataset(cls.at("in"), copies=4)
        cls.wanted = cls.at("wanted")
        cls.summary = voxmend.batch.run(cls.at("in"), cls.wanted, options=OPTIONS)
        cls.environment = dict(os.environ, DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT="3s",
                               DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0")  # a death is the client's to mend

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def at(cls, name):
        return os.path.join(cls.folder.name, name)

    def setUp(self):
        self.nodes = []

    def tearDown(self):
        for node in self.nodes:
            node.kill()
            node.wait()

    def start(self, *words, **options):
        # Ctrl-C ends them, also where the tests are in the background and it is ignored.
        node = subprocess.Popen([sys.executable, *words], env=self.environment, cwd=self.folder.name,
                                preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL), **options)
        self.nodes.append(node)
        return node

    def scheduler(self, name):
        node = self.start(os.path.join(HERE, "dask_nodes.py"), "scheduler", self.at(name), stderr=subprocess.DEVNULL)
        wait_for(lambda: os.path.exists(self.at(name)), "the scheduler")
        with open(self.at(name)) as file:
            return node, file.read()

    def worker(self, address):
        return self.start(os.path.join(HERE, "dask_nodes.py"), "worker", address, stderr=subprocess.DEVNULL)

    def client(self, output, address):
        return self.start("-m", "voxmend.batch", "in", "-o", output, "--dask", address, "--shards", str(SHARDS), "-j", "1", "--",
                          *OPTIONS, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def journals(self, output):
        """{shard: records}"""
        found = {}
        for shard in range(SHARDS):
            try:
                with open(self.at("%s/.batch/journal-%d-of-%d.jsonl" % (output, shard, SHARDS))) as file:
                    found[shard] = [json.loads(line) for line in file if line.endswith("}\n")]
            except OSError:
                found[shard] = []
        return found

    def in_the_midst(self, output):
        """{process of a shard's supervisor: its shard}, of shards of which some meshes are done, not all."""
        found = {}
        for shard, records in self.journals(output).items():
            events = [record["event"] for record in records]
            if "end" in events and events[-1] not in ("complete", "stop"):
                found[[record for record in records if record["event"] == "begin"][-1]["process"]] = shard
        return found

    def check(self, output, client):
        told, lines = client.communicate(timeout=240)
        self.assertEqual(client.returncode, 0, lines)
        self.assertEqual(outputs(self.at(output)), outputs(self.wanted))
        summary = json.loads(told)
        self.assertEqual(summary["complete_shards"], SHARDS)
        self.assertEqual(summary["counts"]["pending"], 0)
        self.assertEqual(summary["counts"]["unreadable"], self.summary["counts"]["unreadable"])
        return lines

    def test_two_workers(self):
        _, address = self.scheduler("s1")
        for _ in range(2):
            self.worker(address)
        lines = self.check("two", self.client("two", address))
        self.assertEqual(lines.count("is at its end"), SHARDS)
        self.assertNotIn("begun again", lines)

    def test_worker_killed(self):
        _, address = self.scheduler("s2")
        workers = {node.pid: node for node in (self.worker(address), self.worker(address))}
        client = self.client("killed", address)
        wait_for(lambda: any(parent_of(p) in workers for p in self.in_the_midst("killed")), "a shard in the midst of its work")
        supervisor, shard = next((p, s) for p, s in self.in_the_midst("killed").items() if parent_of(p) in workers)
        workers[parent_of(supervisor)].kill()
        wait_for(lambda: not is_running(supervisor), "the end of the worker's program", 10)
        lines = self.check("killed", client)
        self.assertIn("shard %d is begun again" % shard, lines)
        events = [record["event"] for record in self.journals("killed")[shard]]
        runs = [event for event in events if event in ("begin", "stop", "complete")]
        self.assertEqual(runs[:2], ["begin", "begin"])  # the first died with its worker

    def test_scheduler_killed(self):
        node, address = self.scheduler("s3")
        workers = [self.worker(address) for _ in range(2)]
        client = self.client("lost", address)
        wait_for(lambda: len(self.in_the_midst("lost")) == 2, "two shards in the midst of their work")
        supervisors = list(self.in_the_midst("lost"))
        node.kill()
        told, lines = client.communicate(timeout=120)
        self.assertEqual((client.returncode, told), (1, ""))
        self.assertRegex(lines.splitlines()[-1], "^voxmend.batch: batch: the scheduler is gone, with [0-9]+ of 3 shards")
        wait_for(lambda: not any(is_running(process) for process in supervisors), "the workers' programs to end", 60)
        for worker in workers:
            worker.kill()
        _, address = self.scheduler("s4")
        for _ in range(2):
            self.worker(address)
        self.check("lost", self.client("lost", address))

    def test_interrupted(self):
        _, address = self.scheduler("s5")
        self.worker(address)
        client = self.client("stopped", address)
        wait_for(lambda: self.in_the_midst("stopped"), "a shard in the midst of its work")
        supervisors = list(self.in_the_midst("stopped"))
        client.send_signal(signal.SIGINT)
        told, lines = client.communicate(timeout=60)
        self.assertEqual((client.returncode, told), (130, ""))
        self.assertEqual(lines.splitlines()[-1], "voxmend.batch: interrupted; the same command goes on")
        wait_for(lambda: not any(is_running(process) for process in supervisors), "the worker's program to end", 60)
        last = [records[-1]["event"] for records in self.journals("stopped").values() if records]
        self.assertIn("stop", last)  # it was asked to, and did not come to its end
        self.check("stopped", self.client("stopped", address))

    def test_local_and_refusals(self):
        told = []
        summary = voxmend.batch.run(self.at("in"), self.at("local"), dask="local:2", shards=SHARDS, options=OPTIONS,
                                    tell=told.append)
        self.assertEqual((summary["meshes"], len(told)), (self.count, SHARDS))
        self.assertEqual(outputs(self.at("local")), outputs(self.wanted))
        for wrong in ("local:0", "local:x", "nonsense://1"):
            with self.assertRaises(voxmend.ArgumentError):
                voxmend.batch.run(self.at("in"), self.at("none"), dask=wrong)
        with distributed.LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None) as cluster, \
                distributed.Client(cluster) as client:
            with self.assertRaisesRegex(voxmend.ArgumentError, "unknown option --nonsense"):
                voxmend.batch.run(self.at("in"), self.at("none"), dask=client, options=["--nonsense"])
            with self.assertRaisesRegex(voxmend.batch.BatchError, "resolution=256.*resolution=193"):
                voxmend.batch.run(self.at("in"), self.at("local"), dask=client, options="-r 193 --thin 26", tell=told.append)


if __name__ == "__main__":
    print("distributed %s" % distributed.__version__)
    unittest.main(verbosity=1)
