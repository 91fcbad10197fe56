# SPDX-License-Identifier: BSD-3-Clause
"""What the programs of tests/papers share: they make the tables and figures of a paper with voxmend, and put the paper's own
numbers beside.

  python3 tests/papers/NAME.py [--quick] [--meshes DIR] [--samples DIR] [--pictures DIR] [--markdown doc/papers.md]

Tables go to standard output, or between the marks of NAME in a Markdown file. Meshes come from DIR (../shared/meshes of the
source), or where one is not there, or with --quick, from the samples that samples/generate_samples writes. --quick takes
small grids and each measurement once: it shows that everything works. VOXMEND names the program (./voxmend).
"""
import argparse, json, os, re, subprocess, sys, tempfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


class Paper:
    def __init__(self, name):
        parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
        parser.add_argument("--quick", action="store_true")
        parser.add_argument("--meshes", default=os.path.join(ROOT, "..", "shared", "meshes"))
        parser.add_argument("--samples", default=os.path.join(ROOT, "samples"))
        parser.add_argument("--pictures")
        parser.add_argument("--markdown")
        self.given = parser.parse_args()
        self.name = name
        self.quick = self.given.quick
        self.voxmend = os.environ.get("VOXMEND") or os.path.join(ROOT, "voxmend")
        self.folder = tempfile.TemporaryDirectory()
        self.lines = []
        self.machine_told = False
        self.triangles = 0  # of the mesh that was measured last

    # ---- Meshes ----

    def mesh(self, path, sample):
        """A mesh of the collection, or the sample in its place."""
        real = os.path.join(self.given.meshes, path)
        if not self.quick and os.path.exists(real):
            return real
        return os.path.join(self.given.samples, sample)

    def place(self, name):
        return os.path.join(self.folder.name, name)

    def closed(self, path):
        """The same mesh with its holes filled."""
        out = self.place("closed-" + os.path.splitext(os.path.basename(path))[0] + ".ply")
        if not os.path.exists(out):
            self.run("repair", path, "-o", out, "--fill-holes", "all", "-q")
        return out

    # ---- Commands ----

    def run(self, *arguments):
        command = [self.voxmend] + [str(a) for a in arguments]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            sys.exit("%s: %s" % (" ".join(command), done.stderr.strip()))
        return done.stdout

    def report(self, *arguments):
        return json.loads(self.run(*arguments, "--json"))

    def voxelize(self, path, *arguments, out="grid.npy"):
        return self.report("voxelize", path, "-o", self.place(out), *arguments)

    def least(self, path, *arguments, runs=5):
        """The report of the run whose voxels were made fastest."""
        reports = [self.voxelize(path, *arguments) for _ in range(1 if self.quick else runs)]
        return min(reports, key=lambda r: r.get("figures", {}).get("fill_ms", r["time_ms"]["voxelize"]))

    def compare(self, a, b):
        return self.report("compare", self.place(a), self.place(b))

    def bench(self, path, phases, resolutions, threads=1, engine=None, time=None, options=()):
        """(phase, engine, resolution) -> result; what was left out is not there."""
        time = time if time is not None else 0 if self.quick else 1000
        report = self.report("bench", path, "--threads", threads, "-r", ",".join(map(str, resolutions)), "--time", time,
                             *(["--phases", phases] if phases else []), *(["--engine", engine] if engine else []), *options)
        self.triangles = report["mesh"]["triangles"]
        if not self.machine_told:
            machine = report["machine"]
            self.machine_told = True
            self.text("Machine: %s, %d cores, vectors %s; %s; %s. Least of several runs, ms, unless it says otherwise; the machine "
                      "had other work." % (machine["processor"] or machine["architecture"], machine["cores"], machine["vectors"],
                                           machine["system"], machine["compiler"]))
        return {(r["phase"], r["engine"], r["resolution"]): r for r in report["results"]}

    def has_opencl(self):
        return any(e["name"].startswith("opencl") and e["available"] for e in self.report("engines")["engines"])

    def has_opengl(self):
        return any(e["name"].startswith("opengl") and e["available"] for e in self.report("engines")["engines"])

    def has_pictures(self):
        """Whether this build has libpng."""
        done = subprocess.run([self.voxmend, "view", os.path.join(self.given.samples, "cube.off"), "-r", "8", "-q", "-o",
                               self.place("try.png")], stderr=subprocess.DEVNULL)
        return done.returncode == 0

    # ---- Text ----

    def text(self, line):
        self.lines += [line, ""]

    def table(self, heads, rows):
        self.lines.append("| " + " | ".join(heads) + " |")
        self.lines.append("|" + "---|" * len(heads))
        self.lines += ["| " + " | ".join(show(cell) for cell in row) + " |" for row in rows]
        self.lines.append("")

    def finish(self):
        text = "\n".join(self.lines).strip() + "\n"
        if not self.given.markdown:
            sys.stdout.write(text)
            return
        with open(self.given.markdown) as file:
            whole = file.read()
        begin, end = "<!-- %s: begin -->\n" % self.name, "<!-- %s: end -->" % self.name
        if begin not in whole or end not in whole:
            sys.exit("%s has no marks of %s" % (self.given.markdown, self.name))
        before, rest = whole.split(begin, 1)
        with open(self.given.markdown, "w") as file:
            file.write(before + begin + "\n" + text + "\n" + end + rest.split(end, 1)[1])

    def expect(self, condition, what):
        if not condition:
            sys.exit("%s: %s does not hold" % (self.name, what))


def show(cell):
    """Numbers with three digits that count, and blanks between thousands."""
    if cell is None:
        return "–"
    if isinstance(cell, float):
        cell = "%.0f" % cell if cell >= 100 else "%.3g" % cell
    if isinstance(cell, int):
        cell = str(cell)
    return re.sub(r"(?<=\d)(?=(\d{3})+$)", " ", cell) if re.fullmatch(r"\d{5,}", cell) else cell


def ms(result, key="min_ms"):
    return result[key] if result else None
