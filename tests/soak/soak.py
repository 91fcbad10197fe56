# SPDX-License-Identifier: BSD-3-Clause
"""Random meshes, random options, random faults, until the time is over: what the program promises must hold of each case.

    tests/soak/soak.py BUILD/voxmend --minutes 60 --jobs 2     goes on for an hour, best with a build of --enable-sanitizers
    tests/soak/soak.py BUILD/voxmend --case 1234               one case again, told in full; its files stay

A case follows from its number alone (and from the options that the program lists), so that any can be had again. Promised
is: an exit status of 0 to 3; nothing of a sanitizer; one clear line where it fails, no output then and what was there before
untouched; an output where it does not fail, which `info` can read; nothing else left behind; the same bytes for any number
of threads; an end in time. Those that break a promise stay in a folder each, with the command."""

import argparse
import collections
import concurrent.futures
import hashlib
import json
import math
import os
import pathlib
import random
import re
import resource
import shlex
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

GRIDS = "binvox npy raw rle nrrd octree nii nii.gz vti vtk tif bt schem litematic vox glb zarr h5 vdb ply obj off stl".split()
MESHES = "off obj stl ply".split()
SECONDS = 300  # for one run, under sanitizers


# ---- Meshes ----


def box(rng):
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, faces


def ball(rng):
    rows, columns = rng.randint(2, 12), rng.randint(3, 20)
    points = [
        (math.sin(math.pi * i / rows) * math.cos(2 * math.pi * j / columns),
         math.sin(math.pi * i / rows) * math.sin(2 * math.pi * j / columns),
         math.cos(math.pi * i / rows))
        for i in range(rows + 1) for j in range(columns)
    ]
    faces = [(i * columns + j, (i + 1) * columns + j, (i + 1) * columns + (j + 1) % columns, i * columns + (j + 1) % columns)
             for i in range(rows) for j in range(columns)]
    return points, faces


def ring(rng):
    m, n, thin = rng.randint(3, 16), rng.randint(3, 12), rng.uniform(0.01, 0.6)
    points = [((1 + thin * math.cos(2 * math.pi * j / n)) * math.cos(2 * math.pi * i / m),
               (1 + thin * math.cos(2 * math.pi * j / n)) * math.sin(2 * math.pi * i / m), thin * math.sin(2 * math.pi * j / n))
              for i in range(m) for j in range(n)]
    return points, [(i * n + j, (i + 1) % m * n + j, (i + 1) % m * n + (j + 1) % n, i * n + (j + 1) % n)
                    for i in range(m) for j in range(n)]


def sheet(rng):
    m, n = rng.randint(1, 10), rng.randint(1, 10)
    points = [(i, j, rng.uniform(0, 1)) for i in range(m + 1) for j in range(n + 1)]
    return points, [(i * (n + 1) + j, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1, i * (n + 1) + j + 1)
                    for i in range(m) for j in range(n)]


def soup(rng):
    points = [tuple(rng.choice((rng.uniform(-1, 1), rng.randint(-2, 2))) for _ in range(3)) for _ in range(rng.randint(3, 60))]
    return points, [tuple(rng.randrange(len(points)) for _ in range(rng.choice((3, 3, 3, 4, 5))))
                    for _ in range(rng.randint(1, 80))]


def moved(rng, points):
    a, b, c = (rng.uniform(-3, 3) for _ in range(3))
    s = rng.choice((1, 1, 1, 0.001, 1e6, 1e-12, 1e30, 1e150))
    shift = [rng.choice((0, 0, rng.uniform(-2, 2), 1e4)) * s for _ in range(3)]
    k = [rng.choice((1, 1, 0.3, 0.01, 0)) if rng.random() < 0.2 else 1 for _ in range(3)]
    out = []
    for x, y, z in points:
        x, y = x * math.cos(a) - y * math.sin(a), x * math.sin(a) + y * math.cos(a)
        y, z = y * math.cos(b) - z * math.sin(b), y * math.sin(b) + z * math.cos(b)
        out.append((s * x * k[0] + shift[0], s * (y + 0.1 * c * x) * k[1] + shift[1], s * z * k[2] + shift[2]))
    return out


def make_mesh(rng):
    points, faces = [], []
    for _ in range(rng.choice((1, 1, 1, 2, 3, 6))):
        p, f = rng.choice((box, ball, ring, sheet, soup))(rng)
        if rng.random() < 0.7:
            p = moved(rng, p)
        faces += [tuple(v + len(points) for v in face) for face in f]
        points += p
    damage = rng.random()
    if damage < 0.15:  # holes
        faces = [f for f in faces if rng.random() < 0.9] or faces
    elif damage < 0.25:  # turned
        faces = [f[::-1] if rng.random() < 0.3 else f for f in faces]
    elif damage < 0.35:  # again, some of them turned
        faces += [f[::-1] if rng.random() < 0.5 else f for f in faces if rng.random() < 0.4]
    elif damage < 0.45:  # every face for itself, its corners not quite where they were
        loose, own = [], []
        e = rng.choice((0, 0, 1e-12, 1e-7, 1e-3))
        for f in faces:
            own.append(tuple(range(len(loose), len(loose) + len(f))))
            loose += [tuple(x + rng.uniform(-e, e) for x in points[v]) for v in f]
        points, faces = loose, own
    elif damage < 0.5:  # numbers that are none
        points[rng.randrange(len(points))] = rng.choice(((math.nan, 0, 0), (math.inf, 0, 0), (1e308, -1e308, 0)))
    return points, faces


def mesh_bytes(rng, points, faces, kind):
    if kind == "off":
        text = f"OFF\n{len(points)} {len(faces)} 0\n"
        return (text + "".join("%.17g %.17g %.17g\n" % p for p in points)
                + "".join(f"{len(f)} {' '.join(map(str, f))}\n" for f in faces)).encode()
    if kind == "obj":
        tags = rng.random() < 0.3
        return ("".join("v %.17g %.17g %.17g\n" % p for p in points)
                + "".join((f"usemtl m{i % 3}\n" if tags and i % 5 == 0 else "") + f"f {' '.join(str(v + 1) for v in f)}\n"
                          for i, f in enumerate(faces))).encode()
    triangles = [(f[0], f[i], f[i + 1]) for f in faces for i in range(1, len(f) - 1)]
    if kind == "stl":
        def single(p):
            return struct.pack("<3f", *(x if not math.isfinite(x) or abs(x) < 3e38 else math.copysign(3e38, x) for x in p))
        return (bytes(80) + struct.pack("<I", len(triangles))
                + b"".join(bytes(12) + b"".join(single(points[v]) for v in t) + b"\0\0" for t in triangles))
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty double x\nproperty double y\n"
              f"property double z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    return (header.encode() + b"".join(struct.pack("<3d", *p) for p in points)
            + b"".join(struct.pack(f"<B{len(f)}i", len(f), *f) for f in faces))


def write_mesh(rng, folder, name):
    kind = rng.choice(MESHES)
    data = bytearray(mesh_bytes(rng, *make_mesh(rng), kind))
    damage = rng.random()
    if damage < 0.05:
        del data[rng.randrange(len(data)):]
    elif damage < 0.1:
        for _ in range(rng.randint(1, 8)):
            data[rng.randrange(len(data))] = rng.randrange(256)
    path = folder / f"{name}.{kind}"
    path.write_bytes(data)
    return path.name


# ---- Command lines ----


class Program:
    """What the program says of itself."""

    def __init__(self, path):
        path = pathlib.Path(path).resolve()
        built = path.parent / ".libs"  # the program itself, not the script that stands for it in a folder that was built in
        if (built / path.name).is_file():
            path = built / path.name
            for name in ("LD_LIBRARY_PATH", "VOXMEND_MODULES"):
                os.environ[name] = str(built)
        self.path = str(path)
        self.tables = {}

    def options(self, command):
        if command not in self.tables:
            text = subprocess.run([self.path, "help", "--table", command], capture_output=True, text=True, check=True).stdout
            self.tables[command] = [line.split("\t")[:3] for line in text.splitlines()]
        return self.tables[command]


def number(rng):
    return rng.choice(("0", "1", "2", "3", "7", "16", "-1", "0.5", "0.01", "1e-9", "1e30", "nan", "inf", "", "4294967296",
                       "99999999999999999999", "0x10", "1,2", "x"))


def value_of(rng, name, argument, files):
    """Most are good ones."""
    wild = rng.random() < 0.02
    if wild:
        return number(rng)
    good = {
        "--resolution": lambda: str(rng.choice((1, 2, 5, 8, 16, 31, 32, 33, 48, 64))) if rng.random() < 0.9
        else f"{rng.randint(1, 40)}x{rng.randint(1, 40)}x{rng.randint(1, 40)}",
        "--voxel-size": lambda: str(rng.choice((0.05, 0.1, 0.3, 1))),
        "--bounds": lambda: rng.choice(("-1,-1,-1,1,1,1", "0,0,0,1,2,3")),
        "--pad": lambda: str(rng.randint(0, 4)),
        "--threads": lambda: str(rng.randint(1, 4)),
        "--memlimit": lambda: rng.choice(("1K", "200K", "3M", "50M", "1G", "1G")),
        "--window": lambda: rng.choice(("0:8,0:8,0:8", "2:3,1:9,0:4", "5:99,0:1,0:1")),
        "--count": lambda: str(rng.randint(1, 5)),
        "--list": lambda: str(rng.randint(1, 50)),
        "--fill-holes": lambda: rng.choice(("all", "3", "20")),
        "--drop-parts": lambda: rng.choice(("faces:4", "volume:0.1")),
        "--size": lambda: rng.choice(("40x30", "200x100", "1x1")),
        "--slice": lambda: rng.choice(("x=0.5", "z=0", "y=1")),
        "--deflection": lambda: "0.01",
        "--wrap": lambda: rng.choice(("0.2", "0.1,0.01")),
        "--band": lambda: rng.choice(("0", "1", "3")),
        "--color": lambda: rng.choice(("mesh", "noise", "position", "part", rng.choice(files))),
        "--rotate": lambda: rng.choice(("none", "any", "x", "1,2,3")),
        "--displace": lambda: rng.choice(("0.01", "0.05,normal")),
        "--scale": lambda: "0.3",
        "--mirror": lambda: rng.choice(("x", "xyz")),
        "--like": lambda: rng.choice(files),
        "--engine": lambda: "cpu",
        "--external": lambda: rng.choice(("folder", "none")),
        "--max-change": lambda: rng.choice(("0.1", "0.5")),
        "--threshold": lambda: rng.choice(("0.5", "1", "128")),
        "--below": lambda: rng.choice(("0", "1")),
        "--blocks": lambda: rng.choice(("stone", "oak_planks,glass")),
    }.get(name)
    if good:
        return good()
    words = [w for w in re.split(r"[|,\[\]: ]", argument) if re.fullmatch(r"[a-z0-9][a-z0-9.-]*", w)]
    if words and rng.random() < 0.95:
        return rng.choice(words)
    return number(rng)


# Those that read or write elsewhere, or have a case of their own.
LEFT_ALONE = {"--output", "--format", "--help", "--report", "--json", "--progress", "--tool", "--path", "--device", "--cl-method", "--gl-method",
              "--gl-axis", "--gl-displace", "--coords", "--confidence", "--locate", "--force", "--strict"}


# What an option asks for beside it.
COMPANIONS = {"--fallback": ["--level", "solid"], "--fill": ["--fill-holes", "all"], "--scalar": ["--coverage", "2"],
              "--surface": ["--mode", "surface"], "--thickness": ["--level", "closed"], "--sheets": ["--level", "closed"],
              "--band": ["--distance", "signed"], "--color-average": ["--color", "mesh"], "--noise": ["--displace", "0.01"]}
# Formats that an option goes with; numbers are in some alone.
NUMBERS = "npy nrrd nii vti vtk tif zarr h5 octree".split()
FORMATS = {"--coverage": NUMBERS, "--distance": NUMBERS, "--labels": NUMBERS, "--scalar": NUMBERS, "--band": NUMBERS,
           "--color": ["ply", "npy", "vox", "glb", "schem", "zarr"], "--color-average": ["ply", "npy", "zarr"],
           "--blocks": ["schem", "litematic"], "--up": ["schem", "litematic", "glb"], "--polygons": ["ply", "obj", "off"],
           "--no-manifold": ["ply", "off", "stl"], "--sparse": ["octree", "vdb", "bt"]}


def options_of(rng, program, command, files, taken):
    out = []
    table = [row for row in program.options(command) if row[0] not in LEFT_ALONE and row[0] not in taken]
    for name, _, argument in rng.sample(table, min(len(table), rng.choice((0, 1, 1, 2, 2, 3, 5)))):
        out += [name] + ([value_of(rng, name, argument, files)] if argument else [])
        if name in COMPANIONS and COMPANIONS[name][0] not in out and rng.random() < 0.95:
            out += COMPANIONS[name]
    return out


def make_command(rng, program, folder):
    """Words behind the program's name, the output, and what has to be made first."""
    mesh, other = write_mesh(rng, folder, "a"), write_mesh(rng, folder, "b")
    command = rng.choice(("voxelize",) * 8 + ("repair",) * 5 + ("convert",) * 3 + ("combine", "remesh", "augment", "view", "info", "carve", "compare"))
    grids = []
    if command in ("convert", "combine", "carve", "compare"):
        for i, source in enumerate((mesh, other)):
            kind = rng.choice(([], [], [], ["--labels", "part"], ["--distance", "signed"], ["--coverage", "2"], ["--color", "position"]))
            known = ("npy", "nrrd", "rle", "octree", "binvox", "vti", "zarr") if not kind else ("npy", "nrrd", "zarr") if kind[0] != "--color" else ("npy", "zarr")
            grid = f"g{i}.{rng.choice(known)}"
            like = ["--like", grids[0][3]] if i and rng.random() < 0.8 else ["-r", str(rng.choice((4, 16, 30)))]
            grids.append(["voxelize", source, "-o", grid] + like + kind)
    names = [mesh, other] + [g[3] for g in grids]
    extension = rng.choice(GRIDS)
    output = f"out.{extension}"
    if command in ("repair", "remesh"):
        output = f"out.{rng.choice(MESHES)}"
        words = [command, mesh, "-o", output] + (["-r", str(rng.choice((4, 16, 32)))] if command == "remesh" else [])
    elif command == "voxelize":
        words = [command, mesh, "-o", output, "-r", value_of(rng, "--resolution", "N", names)]
    elif command == "convert":
        words = [command, names[2], "-o", output]
    elif command == "combine":
        words = [command, names[2], rng.choice(("or", "and", "minus", "xor")), names[3], "-o", output]
    elif command == "carve":
        (folder / "way.csv").write_text("".join("%g,%g,%g\n" % tuple(rng.uniform(-1, 1) for _ in range(3)) for _ in range(rng.randint(0, 9))))
        words = [command, names[2], "--tool", other, "--path", "way.csv", "-o", output]
    elif command == "augment":
        output = "out"
        words = [command, mesh, "-o", output, "-r", str(rng.choice((4, 16, 32))), "-n", str(rng.randint(1, 4)), "--format", rng.choice(("rle", "npy", "nrrd"))]
    elif command == "view":
        output = rng.choice(("out.png", "out.html"))
        words = [command, mesh, "-o", output, "-r", "24"]
    else:
        output = None
        words = [command] + (names[2:4] if command == "compare" else [mesh])
    words += options_of(rng, program, command, names, {"--resolution"} if "-r" in words else set())
    if "-r" in words and ({"--like", "--voxel-size"} & set(words)) and rng.random() < 0.95:
        del words[words.index("-r"):words.index("-r") + 2]
    fitting = [FORMATS[w] for w in words if w in FORMATS]
    if fitting and command in ("voxelize", "convert", "combine", "carve") and rng.random() < 0.95:
        output = f"out.{rng.choice(fitting[0])}"
        words[words.index("-o") + 1] = output
    if rng.random() < 0.2:
        words += ["--json"]
    return words, output, grids


# ---- Faults ----


def limits_of(rng):
    """A name for the fault, what is set in the child, and after how many seconds it gets which signal."""
    kind = rng.choice(("none",) * 6 + ("small files", "few files", "signal"))
    if kind == "small files":
        most = rng.choice((0, 10, 1000, 20000))
        return kind, lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)), None
    if kind == "few files":
        most = rng.choice((5, 6, 8, 12))
        return kind, lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (most, most)), None
    if kind == "signal":
        return kind, None, (rng.expovariate(1 / 0.15), rng.choice((signal.SIGINT, signal.SIGTERM)))
    return kind, None, None


def run(program, words, folder, preset=None, alarm=None):
    process = subprocess.Popen([program.path] + words, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, preexec_fn=preset)
    try:
        if alarm:
            try:
                out, errors = process.communicate(timeout=alarm[0])
            except subprocess.TimeoutExpired:
                process.send_signal(alarm[1])
                out, errors = process.communicate(timeout=SECONDS)
        else:
            out, errors = process.communicate(timeout=SECONDS)
        return process.returncode, out, errors.decode(errors="replace")
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return "no end", b"", ""


# ---- Promises ----


def digest(path):
    if path.is_dir():
        return {p.relative_to(path).as_posix(): hashlib.sha256(p.read_bytes()).hexdigest() for p in sorted(path.rglob("*")) if p.is_file()}
    return hashlib.sha256(path.read_bytes()).hexdigest()


def listed(folder):
    return {p.name: digest(p) for p in folder.iterdir()}


def is_output(name, output):
    return output is not None and (name == output or name == output + ".json" or name.startswith(output.split(".")[0] + "_"))


def check(program, rng, folder, words, output, before, result, sent):
    """What was broken, a sentence each."""
    status, out, errors = result
    broken = []
    own = [line for line in errors.splitlines() if line.startswith("voxmend: ") and not line.startswith("voxmend: warning: ")]
    if status == "no end":
        return ["it does not end"]
    if re.search(r"Sanitizer|runtime error:", errors):
        broken.append("a sanitizer speaks: " + next(line for line in errors.splitlines() if re.search(r"Sanitizer|runtime error:", line))[:300])
    if status not in (0, 1, 2, 3) and not (sent and status == -sent):
        broken.append(f"it ends with {status}")
    after = listed(folder)
    new = {name for name in after if name not in before}
    lost = {name for name in before if after.get(name) != before[name] and not (status in (0, 3) and is_output(name, output))}
    if lost:
        broken.append(f"changed: {sorted(lost)}")
    if status in (1, 2):
        if not own and not sent:
            broken.append("it fails and does not say why")
        if len(own) > 4:
            broken.append(f"{len(own)} lines about one failure")
        if new:
            broken.append(f"it failed, and left {sorted(new)}")
    elif status in (0, 3):
        strange = {name for name in new if not is_output(name, output)}
        if strange:
            broken.append(f"left behind: {sorted(strange)}")
        if "--json" in words:
            try:
                json.loads(out)
            except ValueError as problem:
                broken.append(f"no JSON: {problem}")
        wants_file = output and "--dry-run" not in words
        if wants_file and output not in after:
            broken.append("it has made no output")
        elif wants_file and output.endswith(".obj") and (folder / output).stat().st_size == 0:
            pass  # no voxel is set, and .obj has no header
        elif wants_file and (folder / output).is_file() and not output.endswith((".png", ".html", ".h5", ".glb", ".schem", ".litematic")) and not broken:
            code, _, said = run(program, ["info", output], folder)
            if code != 0 and not (code == 1 and "module" in said) and words[0] != "augment":
                broken.append(f"info cannot read it: {said.strip()[:200]}")
    elif new:
        broken.append(f"it was stopped, and left {sorted(new)}")
    return broken


def is_repeatable(words, result, fault, output):
    return fault == "none" and result[0] in (0, 3) and output and not {"--memlimit", "--dry-run"} & set(words) and not output.endswith((".html", ".h5"))


def one_case(program, number_of_case, kept, keep_always=False):
    rng = random.Random(number_of_case)
    folder = pathlib.Path(tempfile.mkdtemp(prefix=f"case-{number_of_case}-", dir=kept))
    words, output, first = make_command(rng, program, folder)
    fault, preset, alarm = limits_of(rng)
    for make in first:
        if run(program, make, folder)[0] not in (0, 3):
            shutil.rmtree(folder)
            return words[0], "inputs refused", fault, [], None
    occupied = output and words[0] not in ("augment",) and rng.random() < 0.2
    if occupied:
        (folder / output).write_bytes(b"was here before\n")
        words += ["--force"] if "--force" in [row[0] for row in program.options(words[0])] and rng.random() < 0.7 else []
    before = listed(folder)
    result = run(program, words, folder, preset, alarm)
    broken = check(program, rng, folder, words, output, before, result, alarm[1] if alarm else 0)
    if not broken and is_repeatable(words, result, fault, output) and (folder / output).exists() and rng.random() < 0.4:
        made = digest(folder / output)
        trash = folder / output
        shutil.rmtree(trash) if trash.is_dir() else trash.unlink()
        fewer = [w for i, w in enumerate(words) if w != "--threads" and (i == 0 or words[i - 1] != "--threads")]
        again = run(program, fewer + ["--threads", str(rng.randint(1, 5))], folder)
        if again[0] == result[0] and (not trash.exists() or digest(trash) != made):
            broken.append("other bytes with another number of threads")
        elif again[0] != result[0]:
            broken.append(f"{result[0]} at first, then {again[0]} with another number of threads")
    told = None
    if broken or keep_always:
        commands = [[program.path] + make for make in first] + [[program.path] + words]
        (folder / "again.sh").write_text(f"# {fault}\n" + "".join(shlex.join(c) + "\n" for c in commands))
        (folder / "stderr.txt").write_text(result[2])
        told = f"{folder}: {shlex.join(words)} ({fault}): " + "; ".join(broken)
    else:
        shutil.rmtree(folder)
    return words[0], str(result[0]), fault, broken, told


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--minutes", type=float, default=60, help="how long [60]")
    parser.add_argument("--cases", type=int, default=0, help="how many, rather than how long")
    parser.add_argument("--first", type=int, default=1, help="the number of the first case [1]")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="at a time [one per processor]")
    parser.add_argument("--case", type=int, help="this case alone; its files stay")
    parser.add_argument("--keep", default=None, help="folder for those that break a promise [a new one]")
    given = parser.parse_args()
    program = Program(given.program)
    kept = pathlib.Path(given.keep or tempfile.mkdtemp(prefix="voxmend-soak-"))
    kept.mkdir(parents=True, exist_ok=True)
    if given.case is not None:
        command, status, fault, broken, told = one_case(program, given.case, kept, True)
        print(told)
        return 1 if broken else 0
    begun, done, bad = time.time(), 0, 0
    commands, statuses, faults = collections.Counter(), collections.Counter(), collections.Counter()
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        waiting, next_case = set(), given.first
        while True:
            over = done + len(waiting) >= given.cases if given.cases else time.time() - begun > 60 * given.minutes
            while not over and len(waiting) < 2 * given.jobs:
                waiting.add(pool.submit(one_case, program, next_case, kept))
                next_case += 1
                over = bool(given.cases) and done + len(waiting) >= given.cases
            if not waiting:
                break
            ready, waiting = concurrent.futures.wait(waiting, return_when=concurrent.futures.FIRST_COMPLETED)
            for future in ready:
                command, status, fault, broken, told = future.result()
                done += 1
                commands[command] += 1
                statuses[status] += 1
                faults[fault] += 1
                if broken:
                    bad += 1
                    print(told, flush=True)
    minutes = (time.time() - begun) / 60
    print(f"{done} cases in {minutes:.1f} minutes, {given.first} to {next_case - 1}; {bad} broke a promise")
    for name, counter in (("commands", commands), ("exit status", statuses), ("faults", faults)):
        print(f"  {name}: " + ", ".join(f"{key} {count}" for key, count in counter.most_common()))
    if not bad and not given.keep:
        shutil.rmtree(kept)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
