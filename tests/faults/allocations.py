# SPDX-License-Identifier: BSD-3-Clause
"""Every allocation fails once, and every one with all after it: an error of one line and nothing else, or the same result.

A run that lacks memory ends with status 1, one line and the folder as it was; or with status 0 and all its files, where
it could do without. FAULTS=all takes every allocation of every command (of those that make more than MOST, so many, evenly
spread), otherwise it is a sample of a few seconds. COMMANDS=word tries the commands with that word alone.
"""

import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

PROGRAM, LIBRARY, SHIM = sys.argv[1:4]
ALL = os.environ.get("FAULTS") == "all"
ONLY = os.environ.get("COMMANDS", "")
MOST = int(os.environ.get("MOST", 3000 if ALL else 6))
SECONDS = 120

# What the drivers of graphics and OpenCL allocate is left alone: they crash by themselves.
OURS = "voxmend:jansson"
# So does log4cplus, which OpenVDB begins with: then nothing may be left behind either.
ENDED_BY_LIBRARY = ("vdb", "terminate called after throwing an instance of")


def commands():
    """A name, what follows the program, and the settings of the shim."""
    for mesh in ("off", "obj", "stl", "ply"):
        yield "info " + mesh, "info box.%s" % mesh, {}
    yield "info locate", "info torn.off --locate wrong.ply --report report.json", {}
    yield "info glb", "info box.glb", {"ALLOCATION_IN": "voxmend"}
    for level in ("clean", "manifold", "closed"):
        yield "repair " + level, "repair torn.off -o out.ply --level %s --report report.json" % level, {}
    yield "repair solid", "repair two.off -o out.ply --level solid --best-effort", {}
    yield "repair intersections", "repair two.off -o out.off --intersections", {}
    for fill in ("minimal", "smooth"):
        yield "repair " + fill, "repair open.off -o out.stl --fill-holes all --fill %s" % fill, {}
    yield "repair wrap", "repair torn.off -o out.obj --wrap 0.2", {}
    yield "repair weld", "repair torn.off -o out.off --weld 0.01 --drop-parts faces:3", {}
    for grid in ("binvox", "npy", "raw", "rle", "nrrd", "vdb", "ply", "stl"):
        yield "voxelize " + grid, "voxelize two.off -o out.%s -r 6" % grid, {}
        if grid not in ("ply", "stl"):
            yield "convert " + grid, "convert in.%s -o out.rle" % grid, {}
            yield "sparse " + grid, "voxelize two.off -o out.%s -r 6 --sparse --coords coords.npy" % grid, {}
    for grid in ("npy", "nrrd", "vdb", "octree", "binvox"):
        yield "numbers " + grid, "convert labels.%s -o out.nrrd" % grid, {}
        yield "numbers to " + grid, "convert labels.npy -o out.%s" % grid, {}
    yield "threshold", "convert distance.nrrd -o out.rle --below 0", {}
    yield "view distance", "view distance.nrrd -o out.png --size 16x12", {}
    for method in ("x", "tetra", "winding"):
        yield "voxelize " + method, "voxelize torn.off -o out.rle -r 6 --method %s" % method, {}
    yield "voxelize open", "voxelize torn.off -o out.rle -r 6 --vote auto --confidence sure.npy", {}
    for mode in ("conservative", "thin", "shell26"):
        yield "voxelize " + mode, "voxelize torn.off -o out.rle -r 6 --mode %s --surface %s" % ("surface" if mode == "shell26" else "both", mode), {}
    yield "coverage", "voxelize two.off -o out.npy -r 6 --coverage 2", {}
    yield "distance", "voxelize two.off -o out.nrrd -r 6 --distance signed", {}
    yield "distance vdb", "voxelize two.off -o out.vdb -r 6 --distance signed", {}
    yield "octree", "voxelize torn.off -o out.octree -r 20 --sparse", {}
    yield "octree values", "voxelize two.off -o out.octree -r 20 --distance signed --threads 2", {}
    yield "octree window", "convert labels.octree -o out.npy --window 0:2,1:3,0:4", {}
    yield "octree coverage", "convert in.npy -o out.nrrd --coverage 2", {}
    yield "labels", "voxelize box.obj -o out.npy -r 6 --labels group", {}
    for labels in ("schem", "litematic", "vox", "glb"):
        yield "blocks " + labels, "voxelize box.obj -o out.%s -r 6 --labels group" % labels, {}
    for labels in ("schem", "litematic", "vox"):
        yield "blocks from " + labels, "convert labels.%s -o out.npy" % labels, {}
    for colors in ("npy", "ply", "vox", "schem", "glb"):
        yield "colours " + colors, "voxelize two.off -o out.%s -r 6 --color noise" % colors, {}
    yield "threads", "voxelize torn.off -o out.rle -r 6 --threads 3", {}
    yield "limit", "voxelize torn.off -o out.rle -r 6 --memlimit 64M", {}
    yield "view", "view in.rle -o out.png --size 16x12", {}
    for operation in ("or", "minus"):
        yield "combine " + operation, "combine in.rle %s in.npy -o out.npy --report report.json" % operation, {}
    yield "carve", "carve in.rle -t two.off -p path.csv -o out.npy --report report.json", {}
    yield "carve octree", "carve in.rle -t two.off -p path.csv -o out.octree", {}
    for kind in ("binvox", "nrrd", "raw", "vtk", "msh", "schematic"):
        yield "binvox " + kind, "binvox -d 6 -t %s -dc -down -ri -fit -rotx two.off" % kind, {}
    yield "binvox blocks", "binvox -d 6 -e -mb -t schematic -rotz blocks.obj", {}
    yield "compare", "compare in.rle in.npy --report report.json", {}
    yield "augment", "augment two.off -o many -n 2 -r 8 --format npy --rotate any", {}
    yield "augment coverage", "augment two.off -o many -n 2 -r 8 --coverage 2 --rotate any", {}
    yield "augment stdout", "augment two.off -o - -n 2 -r 8", {}
    yield "engines", "engines --json", {"ALLOCATION_FROM": OURS}
    yield "bench", "bench two.off --report report.json --time 0 -r 4 --phases solid_vote --threads 1", {}
    yield "library", None, {}


SAMPLE = ["info off", "repair manifold", "voxelize rle", "convert npy", "labels", "threads", "view", "library"]


def shape(value):
    """The keys of a report, without its values: they tell times."""
    if isinstance(value, dict):
        return str({k: shape(v) for k, v in value.items()})
    return "[%d]" % len(value) if isinstance(value, list) else type(value).__name__


class Case:
    def __init__(self, name, arguments, settings, folder, inputs):
        self.name, self.settings, self.folder, self.inputs = name, settings, folder, inputs
        self.arguments = [LIBRARY, "once"] if arguments is None else [PROGRAM] + arguments.split()
        if arguments and not arguments.startswith("binvox"):  # which takes binvox's options alone
            self.arguments += ["-q"]
        if arguments and "threads" not in arguments and arguments.split()[0] not in ("engines", "binvox"):
            self.arguments += ["--threads", "1"]
        self.work, self.temporary = os.path.join(folder, "work"), os.path.join(folder, "tmp")
        self.runs = self.failed = self.ended = 0
        os.makedirs(self.temporary)

    def run(self, **faults):
        """The exit status and what it said."""
        environment = dict(os.environ, TMPDIR=self.temporary, LD_PRELOAD=SHIM, XDG_CACHE_HOME=self.temporary)
        environment.update(self.settings)
        environment.update({k: str(v) for k, v in faults.items()})
        with open(os.path.join(self.folder, "stdout"), "wb") as out:
            done = subprocess.run(self.arguments, cwd=self.work, env=environment, stdin=subprocess.DEVNULL, stdout=out,
                                  stderr=subprocess.PIPE, timeout=SECONDS)
        return done.returncode, done.stderr.decode(errors="replace")

    def reset(self):
        shutil.rmtree(self.work, ignore_errors=True)
        shutil.copytree(self.inputs, self.work)

    def look(self):
        found = {}
        for at, _, names in os.walk(self.work):
            for name in names:
                with open(os.path.join(at, name), "rb") as file:
                    data = file.read()
                path = os.path.relpath(os.path.join(at, name), self.work)
                found[path] = shape(json.loads(data)) if name == "report.json" else hashlib.sha1(data).hexdigest()
        return found

    def prepare(self):
        """False if the command cannot do its work here."""
        self.reset()
        self.old = self.look()
        count = os.path.join(self.folder, "count")
        status, said = self.run(ALLOCATION_COUNT=count)
        if status != 0 and re.search("is not installed|is not there|without|needs|lacks|No such file", said):
            return False
        if status != 0:
            sys.exit("FAILED: %s: status %d: %s" % (self.name, status, said))
        self.new = self.look()
        if not os.path.exists(count):  # the program in question does not come under the shim
            return False
        with open(count) as file:
            self.allocations = max(int(line) for line in file)
        return True

    def is_good(self, status, said):
        now = self.look()
        if os.listdir(self.temporary):
            return False
        if status == 0:
            return now == self.new
        lines = said.splitlines()
        if status == -signal.SIGABRT and ENDED_BY_LIBRARY[0] in self.name and ENDED_BY_LIBRARY[1] in said:
            self.ended += 1
            return now in (self.old, self.new)
        left = {k: v for k, v in now.items() if not k.startswith("many")}  # variants are written one by one
        return status == 1 and len(lines) == 1 and lines[0].startswith("voxmend: ") and left == self.old

    def difference(self):
        """What is neither as it was nor as it should become."""
        now = self.look()
        return sorted(k for k in set(now) | set(self.new) if now.get(k) not in (self.old.get(k), self.new.get(k)))

    def try_one(self, n, **more):
        if self.look() != self.old:
            self.reset()
        try:
            status, said = self.run(ALLOCATION_AT=n, **more)
        except subprocess.TimeoutExpired:
            status, said = "time", ""
        self.runs += 1
        self.failed += status != 0
        if self.is_good(status, said):
            return True
        print("FAILED: %s: allocation %d of %d %s: status %s: %s\n%s" %
              (self.name, n, self.allocations, more, status, said.strip(), self.difference()),
              flush=True)
        self.reset()
        return False

    def try_all(self):
        step = max(1.0, self.allocations / MOST)
        good, n = True, 1.0
        while n <= self.allocations + 1:
            good &= self.try_one(int(n))
            good &= self.try_one(int(n), ALLOCATION_ON=1)
            n += step
            if not good and not ALL:
                break
        return good


def make_inputs(folder):
    """Tiny meshes and a grid in each format."""
    def write(name, text):
        with open(os.path.join(folder, name), "w") as file:
            file.write(text)
    corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]

    def off(bodies):
        points, polygons = [], []
        for shift, kept in bodies:
            polygons += [tuple(i + len(points) for i in f) for f in faces[:kept]]
            points += [tuple(c + shift for c in p) for p in corners]
        return "OFF\n%d %d 0\n" % (len(points), len(polygons)) + \
            "".join("%r %r %r\n" % p for p in points) + "".join("4 %d %d %d %d\n" % f for f in polygons)
    write("box.off", off([(0, 6)]))
    write("two.off", off([(0, 6), (0.5, 6)]))
    write("open.off", off([(0, 5)]))
    write("torn.off", off([(0, 5), (1, 6), (1, 6), (4, 4)]))
    lines = ["v %r %r %r" % p for p in corners]
    for i, f in enumerate(faces):
        lines += ["g side%d" % (i % 2)] + ["f " + " ".join(str(c + 1) for c in f)]
    write("path.csv", "0.1,0.2,0.3\n0.7,0.2,0.3\n0.7,0.2,0.3,1,1,0,0\n".replace(".3\n", ".3,1,0,0,0\n"))
    write("box.obj", "\n".join(lines) + "\n")
    write("blocks.obj", "\n".join(lines).replace("g side", "usemtl blockid_4") + "\n")
    for mesh in ("stl", "ply"):
        subprocess.run([PROGRAM, "repair", "box.off", "-o", "box." + mesh, "-q"], cwd=folder, check=True)
    for grid in ("binvox", "npy", "raw", "rle", "nrrd", "vdb"):
        subprocess.run([PROGRAM, "voxelize", "box.off", "-o", "in." + grid, "-r", "4", "-q"], cwd=folder,
                       stderr=subprocess.DEVNULL)
    for command in ("voxelize box.obj -o labels.npy -r 4 --labels group", "convert labels.npy -o labels.nrrd",
                    "convert labels.npy -o labels.vdb", "convert labels.npy -o labels.binvox",
                    "convert labels.npy -o labels.octree",
                    "convert labels.npy -o labels.schem", "convert labels.npy -o labels.litematic",
                    "convert labels.npy -o labels.vox",
                    "voxelize box.off -o distance.nrrd -r 4 --distance signed"):
        subprocess.run([PROGRAM] + command.split() + ["-q"], cwd=folder, stderr=subprocess.DEVNULL)
    seeds = os.path.join(os.environ["SRCDIR"], "tests", "fuzz", "corpus")
    shutil.copy(os.path.join(seeds, "glb", "cube.glb"), os.path.join(folder, "box.glb"))


def main():
    folder = tempfile.mkdtemp(prefix="voxmend-memory.")
    good, runs, failed, tried = True, 0, 0, 0
    try:
        inputs = os.path.join(folder, "inputs")
        os.makedirs(inputs)
        make_inputs(inputs)
        for i, (name, arguments, settings) in enumerate(commands()):
            if (not ALL and name not in SAMPLE) or ONLY not in name:
                continue
            case = Case(name, arguments, settings, os.path.join(folder, str(i)), inputs)
            if not case.prepare():
                continue
            started = time.time()
            good &= case.try_all()
            tried, runs, failed = tried + 1, runs + case.runs, failed + case.failed
            if ALL:
                print("%s: %d allocations, %d runs, %d with an error, %d ended by a library, %.0f s" %
                      (name, case.allocations, case.runs, case.failed, case.ended, time.time() - started), flush=True)
        print("commands: %d, runs: %d, with an error: %d" % (tried, runs, failed))
    finally:
        shutil.rmtree(folder)
    sys.exit(0 if good and tried else 1)


main()
