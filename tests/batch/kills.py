#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A batch that is ended again and again.

kills.py VOXMEND HOSTILE SAMPLES [MESHES] [--meshes N] [--kills N] [--seed N] [--time-limit SECONDS]

Meshes, one in fifty of them hostile (tests/batch/hostile.c, damaged files, files that announce more than there is), go
through a batch once undisturbed. Then the same batch is run, and at random moments its supervisor, its zygote or one of
its children is killed, with all its ilk or alone, and the batch begun again, until it has come to its end. Then
 - all outputs have the bytes of the undisturbed run, and none more or fewer;
 - each mesh has exactly one final status, the same as there;
 - no process is left, and no temporary file.
"""
import argparse, collections, hashlib, json, os, random, shutil, signal, subprocess, sys, tempfile, time


def say(text):
    print(text, flush=True)


def fail(text):
    say("FAILED: " + text)
    sys.exit(1)


# ---- Meshes ----

HOSTILE = ["crash", "abort", "hang", "flood", "memory", "stray", "bomb", "kill"]
DAMAGED = {
    "empty.off": b"",
    "huge.off": b"OFF\n3 3333333333 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
    "endless.stl": b"\0" * 80 + b"\xff\xff\xff\xff" + b"\0" * 500,
    "text.ply": b"ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n1\n",
}


def moved_off(lines, number):
    """A copy of an OFF file, a little elsewhere, so that no two are the same."""
    counts = lines[1].split()
    vertices = int(counts[0])
    out = [lines[0], lines[1]]
    for line in lines[2:2 + vertices]:
        x, y, z = map(float, line.split()[:3])
        out.append("%.9g %.9g %.9g" % (x * (1 + number * 1e-6), y, z))
    return "\n".join(out + lines[2 + vertices:]) + "\n"


def make_meshes(folder, samples, meshes, count):
    plain = [open(os.path.join(samples, name)).read().split("\n") for name in sorted(os.listdir(samples)) if name.endswith(".off")]
    plain = [lines for lines in plain if lines[0].strip() == "OFF"]
    shared = []
    for at, _, names in sorted(os.walk(meshes or "/nonexistent")):
        shared += [os.path.join(at, name) for name in sorted(names) if os.path.getsize(os.path.join(at, name)) < 400000]
    for n in range(count):
        place = os.path.join(folder, "part%02d" % (n % 17))
        os.makedirs(place, exist_ok=True)
        if n % 50 == 7:
            kind = HOSTILE[n // 50 % len(HOSTILE)]
            text = moved_off(plain[0], n)
            open(os.path.join(place, "hostile-%s-%05d.off" % (kind, n)), "w").write(text + "# %s\n" % ("x" * n))
        elif n % 50 == 31:
            name = sorted(DAMAGED)[n // 50 % len(DAMAGED)]
            open(os.path.join(place, "%05d-%s" % (n, name)), "wb").write(DAMAGED[name])
        elif n % 3 == 0 and n // 3 < len(shared):
            source = shared[n // 3]
            shutil.copy(source, os.path.join(place, "%05d-%s" % (n, os.path.basename(source))))
        elif n % 10 == 9:  # the same bytes as others
            open(os.path.join(place, "%05d.off" % n), "w").write(moved_off(plain[n % len(plain)], n % 100))
        else:
            open(os.path.join(place, "%05d.off" % n), "w").write(moved_off(plain[n % len(plain)], n))
    os.symlink("..", os.path.join(folder, "part00", "loop"))
    os.symlink("nowhere", os.path.join(folder, "part00", "dangling.off"))
    os.mkfifo(os.path.join(folder, "part00", "pipe.off"))
    if os.getuid() != 0:
        path = os.path.join(folder, "part00", "locked.off")
        open(path, "w").write("OFF\n")
        os.chmod(path, 0)


# ---- Runs ----

class Batch:
    def __init__(self, arguments, folder, output):
        self.output = output
        self.command = [arguments.voxmend, "batch", folder, "-o", output, "-r", "24", "--reports", "-j", "3",
                        "--time-limit", arguments.time_limit, "--memlimit", "64M", "--pictures", "0", "--progress", "never"]
        self.environment = dict(os.environ, LD_PRELOAD=arguments.hostile)

    def start(self):
        return subprocess.Popen(self.command, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def parents():
    found = {}
    for name in os.listdir("/proc"):
        if name.isdigit():
            try:
                text = open("/proc/%s/stat" % name).read()
                found[int(name)] = int(text.rsplit(")", 1)[1].split()[1])
            except (OSError, IndexError):
                pass
    return found


def descendants(root):
    """Lists of processes, by generation."""
    found, generations, level = parents(), [], [root]
    while level:
        level = [p for p, parent in found.items() if parent in level]
        if level:
            generations.append(level)
    return generations


def kill(process):
    try:
        os.kill(process, signal.SIGKILL)
    except OSError:
        pass


def disturb(run, chance):
    """Kills the supervisor, its zygote, a child, or all of them."""
    generations = descendants(run.pid)
    kind = chance.choice(["supervisor", "zygote", "child", "child", "all"])
    if kind == "supervisor":
        kill(run.pid)
    elif kind == "zygote" and generations:
        kill(chance.choice(generations[0]))
    elif kind == "child" and len(generations) > 1 and len(generations[1]) > 1:  # one that is alone has been chosen before
        kill(chance.choice(generations[1]))
    elif kind == "child":
        return None
    else:
        kind = "all"
        for process in [run.pid] + [p for level in generations for p in level]:
            kill(process)
    return kind


def final_records(output):
    last = {}
    with open(os.path.join(output, ".batch", "journal-0-of-1.jsonl")) as file:
        for line in file:
            record = json.loads(line)
            if record["event"] == "end":
                last[record["item"]] = record
    return last


def files_of(output):
    """Digest of each output by its name; what only tells of the run is left out."""
    found = {}
    for at, folders, names in os.walk(output):
        if at == output:
            folders[:] = [f for f in folders if f != ".batch"]
            names = [n for n in names if n not in ("summary.json", "failures.tsv", "index.html")]
        for name in names:
            path = os.path.join(at, name)
            found[os.path.relpath(path, output)] = hashlib.sha256(open(path, "rb").read()).hexdigest()
    return found


def left_behind(marks):
    """Processes of a batch, by the folder that they were started with."""
    found = []
    for name in os.listdir("/proc"):
        if name.isdigit():
            try:
                words = open("/proc/%s/cmdline" % name).read()
            except OSError:
                continue
            if any(mark in words for mark in marks) and int(name) != os.getpid():
                found.append((name, words.replace("\0", " ")[:150]))
    return found


def may_end_as(item, calm, rough):
    """Whether a mesh may end so where it is disturbed. One that kills its process is set aside if the batch was killed
    around it, too; what takes all memory is stopped by the limit or by the clock, whichever comes first."""
    also = {"quarantined"} if "hostile-" in item and calm != "ok" else set()
    if "hostile-memory" in item:
        also |= {"timeout", "crash", "oom"}
    return rough in also | {calm}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("voxmend")
    parser.add_argument("hostile")
    parser.add_argument("samples")
    parser.add_argument("folder", nargs="?")
    parser.add_argument("--meshes", type=int, default=400)
    parser.add_argument("--kills", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--time-limit", default="4", help="of a mesh, in seconds: no good one may take so long")
    arguments = parser.parse_args()
    chance = random.Random(arguments.seed)
    work = tempfile.mkdtemp(prefix="voxmend-kills-")
    try:
        folder = os.path.join(work, "in")
        make_meshes(folder, arguments.samples, arguments.folder, arguments.meshes)
        calm, rough = Batch(arguments, folder, os.path.join(work, "calm")), Batch(arguments, folder, os.path.join(work, "rough"))

        start = time.time()
        run = calm.start()
        said = run.communicate()[0].decode()
        seconds = time.time() - start
        if run.returncode != 0:
            fail("the undisturbed run ended with %d: %s" % (run.returncode, said))
        if left_behind([calm.output]):
            fail("processes are left: %d" % len(left_behind([calm.output])))
        say("undisturbed: %.1f s" % seconds)

        kinds = collections.Counter()
        while sum(kinds.values()) < arguments.kills:
            run = rough.start()
            wait = time.time() + chance.uniform(0.02, max(0.3, 1.5 * seconds / arguments.kills))
            while run.poll() is None and sum(kinds.values()) < arguments.kills:
                if time.time() >= wait:
                    kind = disturb(run, chance)
                    if kind is None:
                        continue
                    kinds[kind] += 1
                    wait = time.time() + chance.uniform(0.02, max(0.3, 1.5 * seconds / arguments.kills))
                time.sleep(0.005)
            if run.poll() is None:
                run.send_signal(signal.SIGKILL)
            said = run.communicate()[0]
            if run.returncode == 0:  # it came to its end: something is taken away, so that there is more to disturb
                for name in chance.sample(sorted(files_of(rough.output)), 40):
                    os.unlink(os.path.join(rough.output, name))
        say("kills: %s" % dict(kinds))
        for _ in range(3):
            run = rough.start()
            said = run.communicate()[0].decode()
            if run.returncode == 0:
                break
            time.sleep(0.3)  # for what was killed to be gone
        if run.returncode != 0:
            fail("the last run ended with %d: %s" % (run.returncode, said))

        time.sleep(0.3)
        left = left_behind([calm.output, rough.output])
        if left:
            fail("processes are left: %s" % left[:3])
        records = final_records(rough.output)
        calm_records = final_records(calm.output)
        if records.keys() != calm_records.keys():
            fail("not the same meshes have an end: %s" % (records.keys() ^ calm_records.keys()))
        for item, record in calm_records.items():
            if not may_end_as(item, record["status"], records[item]["status"]):
                fail("%s is %s, undisturbed it was %s (%s)" % (item, records[item]["status"], record["status"], records[item].get("message")))
        before, after = files_of(calm.output), files_of(rough.output)
        for name in sorted(before.keys() | after.keys()):
            if before.get(name) != after.get(name):
                fail("%s: %s and undisturbed %s" % (name, after.get(name), before.get(name)))
        if any(".tmp" in name for name in after):
            fail("temporary files are left")
        verified = subprocess.run([arguments.voxmend, "batch", "verify", rough.output], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if verified.returncode != 0:
            fail("verify: " + verified.stdout.decode())
        say("%d meshes, %d outputs: %s" % (len(records), len(after), dict(collections.Counter(r["status"] for r in records.values()))))
    finally:
        if os.environ.get("KEEP"):
            say("kept: " + work)
        else:
            shutil.rmtree(work, ignore_errors=True)


main()
