# SPDX-License-Identifier: BSD-3-Clause
"""Every write fails once, the disk is full, the program is killed: what was there before is there, or all that is new.

Whatever goes wrong, a run ends with status 0 and all its files, or with status 1, one line, and everything as it was;
and after SIGKILL every file is an old or a new one, whole. FAULTS=all tries all commands with all formats, every call
and every 4 KiB; otherwise it is a sample of a few seconds.
"""
import errno
import hashlib
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time

PROGRAM, SHIM, SAMPLES = sys.argv[1:4]
ALL = os.environ.get("FAULTS") == "all"
CHANCE = random.Random(17)
counts = {"failed calls": 0, "full disks": 0, "kills": 0, "left by kills": 0, "commands": 0}

MESHES = ["off", "obj", "stl", "ply"]
GRIDS = ["binvox", "npy", "raw", "rle", "nrrd", "vdb"]


def commands():
    """The writing commands: a name, and what follows the program; in.off is another mesh than that of the old files."""
    for f in MESHES:
        yield "repair " + f, "repair in.off -o out.%s --force --locate wrong.ply --report report.json" % f
        yield "repair stdout " + f, "repair in.off -o - --format %s" % f
        yield "convert to " + f, "convert in.rle -o out.%s --force" % f
        yield "voxelize to " + f, "voxelize in.off -o out.%s --force -r 20" % f
    for f in ("ply", "stl"):
        yield "repair ascii " + f, "repair in.off -o out.%s --force --ascii --best-effort" % f
    for f in GRIDS:
        yield "voxelize " + f, "voxelize in.off -o out.%s -r 32 --report report.json" % f
        yield "sparse " + f, "voxelize in.off -o out.%s -r 32 --sparse --coords coords.npy" % f
        yield "convert " + f, "convert in.rle -o out.%s" % f
    yield "voxelize stdout", "voxelize in.off -o - --format rle -r 32"
    yield "sure", "voxelize in.off -o out.raw -r 32 --confidence sure.npy --coords coords.npy --report report.json"
    for f in ("npy", "nrrd", "vdb"):
        yield "distance " + f, "voxelize in.off -o out.%s -r 20 --distance signed" % f
        yield "coverage " + f, "voxelize in.off -o out.%s -r 20 --coverage 2" % f
    for f in ("npy", "nrrd", "binvox"):
        yield "labels " + f, "voxelize in.off -o out.%s -r 20 --labels part" % f
    for f in ("npy", "ply", "vox", "schem", "litematic", "glb"):
        yield "colours " + f, "voxelize in.off -o out.%s -r 20 --color position --force" % f
    yield "view", "view in.rle -o out.png --size 320x240 --report report.json"
    yield "info", "info in.off --force --locate wrong.ply --report report.json"
    for f in ("npy", "binvox"):
        yield "combine " + f, "combine in.rle xor in.rle -o out.%s --report report.json" % f
    for f in ("binvox", "raw", "vtk", "msh"):
        yield "binvox " + f, "binvox -d 20 -t %s -o out.%s in.off" % (f, f)
    yield "compare", "compare in.rle in.rle --report report.json"
    yield "bench", "bench in.off --plot out.svg --report report.json --time 0 -r 8 --phases solid_vote --threads 1"
    for f in ("rle", "raw", "binvox", "npy", "nrrd"):
        yield "augment " + f, "augment in.off -o many -n 3 -r 16 --format %s --force --report report.json" % f
    yield "augment stdout", "augment in.off -o - -n 3 -r 16"


SAMPLE = ["repair ply", "voxelize raw", "labels nrrd", "convert to off", "augment npy", "repair stdout off"]


class Case:
    def __init__(self, name, arguments, folder):
        self.name, self.folder = name, folder
        self.arguments = [PROGRAM] + arguments.split()
        if not arguments.startswith("binvox"):  # which takes binvox's options alone
            self.arguments += ["-q"]
        self.before = os.path.join(folder, "before")
        self.work = os.path.join(folder, "work")
        self.in_steps = name.startswith("augment") and "stdout" not in name

    def run(self, kill_after=None, **faults):
        """Runs it in the work folder; the exit status and what it said."""
        environment = dict(os.environ, TMPDIR=os.path.join(self.folder, "tmp"))
        if faults:
            environment["LD_PRELOAD"] = SHIM
            environment.update({k: str(v) for k, v in faults.items()})
        with open(os.path.join(self.folder, "stdout"), "wb") as out:
            process = subprocess.Popen(self.arguments, cwd=self.work, env=environment, stdin=subprocess.DEVNULL,
                                       stdout=out, stderr=subprocess.PIPE)
            if kill_after is not None:
                time.sleep(kill_after)
                process.kill()
            said = process.communicate(timeout=120)[1].decode()
        return process.returncode, said

    def reset(self):
        shutil.rmtree(self.work, ignore_errors=True)
        shutil.copytree(self.before, self.work)

    def look(self):
        """What is in the folder: a digest of each file; of a report only that it is whole."""
        found = {}
        for at, _, names in os.walk(self.work):
            for name in names:
                path = os.path.join(at, name)
                with open(path, "rb") as file:
                    data = file.read()
                digest = hashlib.sha1(data).hexdigest()
                if name == "report.json" and data != b"old":
                    json.loads(data)
                    digest = "a report"
                if name.endswith(".svg") and data != b"old" and data.rstrip().endswith(b"</svg>"):
                    digest = "a plot"
                found[os.path.relpath(path, self.work)] = digest
        return found

    def prepare(self):
        """Inputs, old files under the names of the outputs, and what a good run makes of them; False if it cannot."""
        os.makedirs(self.before)
        os.makedirs(os.path.join(self.folder, "tmp"))
        shutil.copy(os.path.join(SAMPLES, "in.off"), self.before)
        shutil.copy(os.path.join(SAMPLES, "in.rle"), self.before)
        self.reset()
        status, said = self.run()
        if status != 0 and "is not installed" in said:
            return False
        assert status == 0, (self.name, status, said)
        for name in self.look():
            if not name.startswith("in."):
                os.makedirs(os.path.dirname(os.path.join(self.before, name)), exist_ok=True)
                with open(os.path.join(self.before, name), "wb") as file:
                    file.write(b"old")
        if self.in_steps:  # one that is there, two that are not
            for name in os.listdir(os.path.join(self.before, "many")):
                if name.startswith("000002"):
                    os.remove(os.path.join(self.before, "many", name))
        self.reset()
        self.old = self.look()
        count = os.path.join(self.folder, "count")
        started = time.time()
        status, said = self.run(FAULT_COUNT=count)
        self.seconds = time.time() - started
        assert status == 0, (self.name, status, said)
        self.new = self.look()
        with open(count) as file:
            self.calls = max(int(line) for line in file)
        counts["commands"] += 1
        return True

    def complain(self, what, status, said):
        sys.exit("FAILED: %s: %s: status %d\n%sold %s\nnew %s\nnow %s" %
                 (self.name, what, status, said, self.old, self.new, self.look()))

    def is_step(self, now):
        """Of files that are written one by one: those that were there are old or new, no other is left."""
        return all(k in self.old and v in (self.old[k], self.new.get(k)) for k, v in now.items()) and \
            all(k in now for k in self.old)

    def check(self, what, status, said):
        now = self.look()
        left = os.listdir(os.path.join(self.folder, "tmp"))
        if status == 0:
            good = now == self.new
        else:
            lines = said.splitlines()
            good = status == 1 and len(lines) == 1 and lines[0].startswith("voxmend: ") and \
                (self.is_step(now) if self.in_steps else now == self.old)
        if not good or left:
            self.complain(what, status, said)

    def fail_calls(self, **more):
        for n in range(1, self.calls + 3):
            for code in (errno.EIO, errno.ENOSPC) if ALL else (CHANCE.choice((errno.EIO, errno.ENOSPC)),):
                self.reset()
                status, said = self.run(FAULT_AT=n, FAULT_ERRNO=code, **more)
                self.check("call %d fails with %s %s" % (n, errno.errorcode[code], more), status, said)
                counts["failed calls"] += 1

    def fill_disk(self, **more):
        room, step, done = 0, 4096 if ALL else 20480, False
        while not done:
            self.reset()
            status, said = self.run(FAULT_ROOM=room, **more)
            self.check("room for %d bytes" % room, status, said)
            counts["full disks"] += 1
            done = status == 0
            room += step

    def kill(self, **more):
        self.reset()
        status, said = self.run(kill_after=CHANCE.uniform(0, 1.1 * self.seconds), **more)
        counts["kills"] += 1
        now = self.look()
        left = [k for k in now if re.search(r"(^|/)voxmend-[0-9a-f]{8}-\d+\.tmp$", k)]
        counts["left by kills"] += len(left)
        whole = all(v in (self.old.get(k), self.new.get(k)) for k, v in now.items() if k not in left)
        if not whole or not all(k in now for k in self.old):
            self.complain("killed", status, said)
        if left and not more:
            print("%s: left by SIGKILL between two steps: %s" % (self.name, left))
        status, said = self.run(**more)  # the next run takes away what may be left
        if status != 0 or self.look() != self.new:
            self.complain("after a kill", status, said)


def main():
    folder = tempfile.mkdtemp(prefix="voxmend-faults.")
    try:
        global SAMPLES
        source, SAMPLES = SAMPLES, os.path.join(folder, "samples")
        os.makedirs(SAMPLES)
        shutil.copy(source, os.path.join(SAMPLES, "in.off"))
        subprocess.run([PROGRAM, "voxelize", "in.off", "-o", "in.rle", "-r", "32", "-q"], cwd=SAMPLES, check=True)
        cases = []
        for i, (name, arguments) in enumerate(commands()):
            case = Case(name, arguments, os.path.join(folder, str(i)))
            if (ALL or name in SAMPLE) and case.prepare():
                cases.append(case)
        for case in cases:
            case.fail_calls()
            case.fill_disk()
            if ALL:
                print("%s: %d calls" % (case.name, case.calls), flush=True)
        for case in cases if ALL else CHANCE.sample(cases, 2):  # file systems that can do less
            case.fail_calls(FAULT_LACKS="tmpfile")
            case.fill_disk(FAULT_LACKS="tmpfile")
        for i in range(200 if ALL else 10):
            CHANCE.choice(cases).kill()
        for i in range(50 if ALL else 4):
            CHANCE.choice(cases).kill(FAULT_LACKS="tmpfile")
        print(", ".join("%s: %d" % item for item in counts.items()))
    finally:
        shutil.rmtree(folder)


main()
