#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every mesh at every level of repair: reached, or refused with a reason; judged by a reader of its own.

levels.py VOXMEND MESHES [--levels LIST] [--formats LIST] [--folders LIST] [--markdown FILE] [--timeout SECONDS]

For each mesh and level:
 - the program ends in time, with status 0, or with 1, what remains in the way, and no file;
 - what it says it has reached is found in the file by the reader below: after welding, each edge has two faces (closed), or
   at most two (manifold), of opposite direction; and so it is after rounding positions to 1e-8 and merging what is then the
   same, as trimesh does, and, where it is closed, once positions are 32-bit floats, as Open3D and many others hold them;
 - no part with an area is lost;
 - parts that were closed and manifold stay closed and keep their volume to 1e-6 (clean, manifold); in .stl to what moving
   every vertex by three units in the last place of a 32-bit float can do beside;
 - the file repaired again at the same level is left as it is, but for the numbers of vertices;
 - the solid of the repaired mesh is that of the original, IoU at least 0.999 at 64^3, where that was closed and not repaired
   beyond recognition: no duplicate faces. Where faces cut through each other, what is inside follows from how often the
   surface winds around a place: the solid (level solid) is where the parts of the mesh at level closed do, those that are wound
   outward in either direction.
Each format is tried; the table tells of the first one. The last line counts. With --markdown the table between the marks of FILE is written anew.
"""
import argparse, collections, json, os, re, subprocess, sys, tempfile

import numpy

LEVELS = ["clean", "manifold", "closed", "solid"]


def read_ply(path):
    """Vertices and faces of a binary .ply as voxmend writes it."""
    with open(path, "rb") as file:
        header = b""
        while not header.endswith(b"end_header\n"):
            header += file.readline()
        data = file.read()
    text = header.decode()
    vertices = int(re.search(r"element vertex (\d+)", text).group(1))
    faces = int(re.search(r"element face (\d+)", text).group(1))
    lists = numpy.dtype("<u4" if "list uint" in text else "u1")
    points = numpy.frombuffer(data, "<f8", 3 * vertices).reshape(-1, 3)
    at = 24 * vertices
    triangle = numpy.dtype([("count", lists), ("corners", "<u4", 3)])
    if faces and len(data) - at == faces * triangle.itemsize:
        triangles = numpy.frombuffer(data, triangle, faces, at)
        if (triangles["count"] == 3).all():
            return points, triangles["corners"].tolist()
    found = []
    for _ in range(faces):
        count = int(numpy.frombuffer(data, lists, 1, at)[0])
        at += lists.itemsize
        found.append(numpy.frombuffer(data, "<u4", count, at).tolist())
        at += 4 * count
    assert at == len(data), "bytes are left over"
    return points, found


def read_stl(path):
    """Of a binary .stl."""
    with open(path, "rb") as file:
        data = file.read()
    count = int(numpy.frombuffer(data, "<u4", 1, 80)[0])
    facets = numpy.frombuffer(data, numpy.dtype([("normal", "<f4", 3), ("points", "<f4", 9), ("pad", "<u2")]), count, 84)
    points = facets["points"].reshape(-1, 3).astype("<f8")
    return points, numpy.arange(len(points)).reshape(-1, 3).tolist()


def read_obj(path):
    points, faces = [], []
    with open(path) as file:
        for line in file:
            words = line.split()
            if words and words[0] == "v":
                points.append([float(word) for word in words[1:4]])
            elif words and words[0] == "f":
                faces.append([int(word.split("/")[0]) - 1 for word in words[1:]])
    return numpy.array(points).reshape(-1, 3), faces


def sides_of(faces):
    """(from, to) of each side of each face."""
    by_count = collections.defaultdict(list)
    for face in faces:
        by_count[len(face)].append(face)
    return numpy.concatenate([numpy.zeros((0, 2), "<i8")] + [
        numpy.stack([alike, numpy.roll(alike, -1, 1)], -1).reshape(-1, 2) for alike in map(numpy.array, by_count.values())])


def judge(points, sides):
    """What a program that welds positions finds: closed, manifold edges."""
    places = numpy.ascontiguousarray(points + 0.0)  # one zero, not two
    name = numpy.unique(places.view("V%d" % (3 * places.itemsize)), return_inverse=True)[1].ravel()
    a, b = name[sides[:, 0]], name[sides[:, 1]]
    there, back = numpy.sort(a * len(points) + b), numpy.sort(b * len(points) + a)
    manifold = not (there[1:] == there[:-1]).any()
    return manifold and numpy.array_equal(there, back), manifold


def winding(points, faces, origin, size, dims):
    """How often a closed surface winds around each centre of a grid: what a ray upward crosses, by direction."""
    crossings = numpy.zeros((dims[0], dims[1], dims[2] + 1), numpy.int32)
    # beside the centres, by less than counts, so that no ray runs through an edge
    flat = (points[:, :2] - origin[:2]) / size[:2] - 0.5 - [1.234567e-6, 7.654321e-7]
    height = (points[:, 2] - origin[2]) / size[2] - 0.5 - 1.111111e-6
    for face in faces:
        for b, c in zip(face[1:-1], face[2:]):
            corners = [face[0], b, c]
            p, z = flat[corners], height[corners]
            low = numpy.maximum(numpy.ceil(p.min(0)), 0).astype(int)
            high = numpy.minimum(numpy.floor(p.max(0)), numpy.array(dims[:2]) - 1).astype(int)
            if (high < low).any():
                continue
            x, y = numpy.mgrid[low[0]:high[0] + 1, low[1]:high[1] + 1]
            (ax, ay), (bx, by) = p[1] - p[0], p[2] - p[0]
            area = ax * by - ay * bx
            if area == 0:
                continue
            weights = [((p[j][0] - x) * (p[k][1] - y) - (p[j][1] - y) * (p[k][0] - x)) / area
                       for j, k in ((1, 2), (2, 0), (0, 1))]
            hit = (weights[0] > 0) & (weights[1] > 0) & (weights[2] > 0)
            at = (weights[0] * z[0] + weights[1] * z[1] + weights[2] * z[2])[hit]
            below = numpy.clip(numpy.ceil(at), 0, dims[2]).astype(int)  # centres under the face
            numpy.add.at(crossings, (x[hit], y[hit], below), 1 if area > 0 else -1)
    return crossings[:, :, ::-1].cumsum(2)[:, :, ::-1][:, :, 1:]


def lost_parts(parts):
    return sum(p["before"]["area"] > 0 and p["after"]["faces"] == 0 for p in parts)


def displacement_of(part):
    """How far a vertex of the part was moved, which is as little as others tell apart."""
    b = part["before"]["bounds"]
    allowed = 16 * max(1e-8, 2.0**-23 * max(map(abs, b)))
    return min(part["max_displacement"], allowed)


def complaint_of(parts, single):
    """What is wrong with the parts that had nothing to repair."""
    for i, p in enumerate(parts):
        b, a = p["before"], p["after"]
        if not b["closed"] or p["flipped"] or b["nonmanifold_edges"] or b["inconsistent_edges"] or not b["volume"]:
            continue
        slack = 1e-6 * abs(b["volume"]) + b["area"] * displacement_of(p)
        if single:
            slack += 3 * b["area"] * 2.0**-23 * max(map(abs, b["bounds"]))
        change = abs(abs(a["volume"]) - abs(b["volume"]))
        if change > slack:
            return "the volume of part %d changes by %g of %g" % (i, change, b["volume"])
        if not a["closed"] and a["faces"] and (not single or abs(b["volume"]) > slack):
            return "part %d is open" % i
    return None


def volume_of(points, faces):
    corners = numpy.array([(f[0], b, c) for f in faces for b, c in zip(f[1:-1], f[2:])])
    a, b, c = (points[corners[:, k]] - points[corners[0, 0]] for k in range(3))
    return numpy.einsum("ij,ij->", a, numpy.cross(b, c)) / 6


def parts_of(faces):
    """Lists of the faces that vertices connect."""
    leader = {}

    def find(v):
        while leader.setdefault(v, v) != v:
            leader[v] = v = leader[leader[v]]
        return v

    for face in faces:
        for v in face[1:]:
            leader[find(v)] = find(face[0])
    parts = collections.defaultdict(list)
    for face in faces:
        parts[find(face[0])].append(face)
    return list(parts.values())


def united(points, faces, *grid):
    """What parts enclose, either way if they are wound outward, less cavities."""
    depth = 0
    for part in parts_of(faces):
        around = winding(points, part, *grid)
        depth = depth + (abs(around) if volume_of(points, part) > 0 else around)
    return depth > 0


class Trial:
    def __init__(self, program, mesh, work, timeout):
        self.program, self.mesh, self.work, self.timeout = program, mesh, work, timeout

    def run(self, *arguments):
        return subprocess.run([self.program, *arguments], capture_output=True, text=True, timeout=self.timeout)

    def iou(self, repaired):
        """Of the solids of the original and the repaired mesh; both are repaired again before, by the defaults."""
        first, second = (os.path.join(self.work, name) for name in ("a.rle", "b.rle"))
        self.run("voxelize", self.mesh, "-o", first, "-r", "64", "--thin", "drop", "-q").check_returncode()
        self.run("voxelize", repaired, "-o", second, "--like", first, "--thin", "drop", "-q").check_returncode()
        return json.loads(self.run("compare", first, second, "--json").stdout)["iou"]

    def iou_of_winding(self, repaired):
        """Of what the parts of the repaired mesh and of the mesh at level closed enclose."""
        closed, grid = (os.path.join(self.work, name) for name in ("closed.ply", "grid.npy"))
        self.run("repair", self.mesh, "--force", "-o", closed, "--level", "closed", "-q").check_returncode()
        self.run("voxelize", repaired, "-o", grid, "-r", "64", "--thin", "drop", "-q").check_returncode()
        with open(grid + ".json") as file:
            space = json.load(file)
        first, second = (united(*read_ply(path), space["origin"], space["voxel_size"], space["dims"])
                         for path in (closed, repaired))
        either = (first | second).sum()
        return (first & second).sum() / either if either else 1.0  # thinner than the voxels

    def again(self, level, path):
        """What another repair of the file does; None = nothing."""
        done = self.run("repair", path, "--force", "-o", os.path.join(self.work, "again." + path[-3:]), "--level", level, "--json")
        if done.returncode != 0:
            return "repaired again: " + done.stderr.strip()
        for entry in json.loads(done.stdout)["passes"]:
            if entry["count"] and entry["pass"] not in ("exact_weld", "unused_vertices"):
                return "repaired again: %s %d" % (entry["pass"], entry["count"])
        return None

    def level(self, level, form):
        """(outcome, complaint or None)"""
        path = os.path.join(self.work, "out." + form)
        if os.path.exists(path):
            os.remove(path)
        try:
            done = self.run("repair", self.mesh, "--force", "-o", path, "--level", level, "--json")
        except subprocess.TimeoutExpired:
            return "no end", "took over %d s" % self.timeout
        if done.returncode == 1 and not os.path.exists(path) and done.stderr.startswith("voxmend: "):
            missing = re.search(r"is not reached: (.*?) remain", done.stderr)
            if missing or "module" in done.stderr:
                return missing.group(1).replace("_", " ") if missing else "module", None
        if done.returncode != 0:
            return "failed", "status %d: %s" % (done.returncode, done.stderr.strip())
        return self.check(level, path, json.loads(done.stdout))

    def check(self, level, path, report):
        points, faces = {"ply": read_ply, "stl": read_stl, "obj": read_obj}[path[-3:]](path)
        if level != "clean" and any(len(face) != 3 for face in faces):
            return "wrong", "has polygons"
        sides = sides_of(faces)
        low, high = report["after"]["bounds"][:3], report["after"]["bounds"][3:]
        small = numpy.linalg.norm(numpy.subtract(high, low)) < 1e-3
        for how, places in (("", points), (" after rounding to 1e-8", points if small else numpy.rint(points * 1e8)),
                            (" as 32-bit floats", points if level == "manifold" else points.astype("<f4"))):
            closed, manifold = judge(places, sides)
            if level in ("closed", "solid") and not closed:
                return "wrong", "is said to be closed, and is not" + how
            if level == "manifold" and not manifold:
                return "wrong", "is said to be manifold, and is not" + how
        lost = lost_parts(report["parts"])
        if lost and level != "solid":
            return "lost", "%d parts are lost" % lost
        changed = complaint_of(report["parts"], path.endswith(".stl")) if level in ("clean", "manifold") else None
        if changed:
            return "volume", changed
        changed = self.again(level, path)
        if changed:
            return "busy", changed
        before = report["before"]
        if level == "solid" and before["self_intersections"]:
            iou = self.iou_of_winding(path)
            return ("yes", None) if iou >= 0.999 else ("iou", "its solid is another one: IoU %g" % iou)
        if before["watertight"] and not before["inconsistent_edges"] and self.iou(path) < 0.999:
            return "iou", "its solid is another one: IoU %g" % self.iou(path)
        return "yes", None


def write_table(path, rows, levels):
    lines = ["| mesh | parts | " + " | ".join(levels) + " |", "|---|---|" + "---|" * len(levels)]
    for name, parts, outcomes in rows:
        lines.append("| %s | %s | %s |" % (name, parts, " | ".join(outcomes)))
    with open(path) as file:
        text = file.read()
    begin, end = "<!-- levels begin -->\n", "<!-- levels end -->"
    head, tail = text.split(begin)[0], text.split(end)[1]
    with open(path, "w") as file:
        file.write(head + begin + "\n".join(lines) + "\n" + end + tail)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("meshes")
    parser.add_argument("--levels", default=",".join(LEVELS))
    parser.add_argument("--formats", default="ply,stl,obj")
    parser.add_argument("--folders", default="messy,cad,modelnet")
    parser.add_argument("--markdown")
    parser.add_argument("--timeout", type=float, default=300)
    given = parser.parse_args()
    levels, rows, failures, tried = given.levels.split(","), [], 0, 0
    reached = collections.Counter()
    for folder in given.folders.split(","):
        for name in sorted(os.listdir(os.path.join(given.meshes, folder))):
            if name.endswith((".mtl", ".tsv", ".md")):
                continue
            short = folder + "/" + name
            with tempfile.TemporaryDirectory() as work:
                trial = Trial(given.program, os.path.join(given.meshes, short), work, given.timeout)
                info = trial.run("info", trial.mesh, "--json")
                parts = json.loads(info.stdout)["components"] if info.returncode == 0 else "?"
                outcomes = []
                for level in levels:
                    for form in given.formats.split(","):
                        outcome, complaint = trial.level(level, form)
                        tried += 1
                        reached[level] += outcome == "yes"
                        if len(outcomes) <= levels.index(level):
                            outcomes.append(outcome)
                        if complaint:
                            failures += 1
                            print("FAILED: %s, %s, .%s: %s" % (short, level, form, complaint), flush=True)
                rows.append((short, parts, outcomes))
    if given.markdown:
        write_table(given.markdown, rows, levels)
    print(", ".join("%s: %d of %d" % (level, reached[level], len(rows) * len(given.formats.split(","))) for level in levels))
    print("%d tried, %d failures" % (tried, failures))
    return failures > 0 or tried == 0


if __name__ == "__main__":
    sys.exit(main())
