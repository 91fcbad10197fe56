#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Repair by voxmend beside what other tools do, on the same meshes in the same run: time, and what trimesh finds in it.

repair_peers.py VOXMEND MESH... [--timeout SECONDS] [--runs N] [--markdown FILE]

Each pair of a tool and a mesh is a process of its own with one thread (where the tool lets itself be told), and the least
of N runs (3) counts; what takes over a tenth of the time is run once. Process: from its start to its end, with reading and
writing, for tools in Python with starting Python and importing what they need. Call: their repair alone, of a mesh in
memory; of voxmend only the process is timed.

A result is read and merged by trimesh, whoever made it. It is told by a letter: V, closed and of one orientation with a
volume (is_volume); C, closed (is_watertight); o, open; x, lost: a side of the box is shorter by more than a tenth of the
diagonal, or all is gone; f, failed or refused, with no result; t, not done in time.

The tools are those this Python can import: PyMeshLab (duplicates, non-manifold edges and vertices, holes of any size; and
CGAL's alpha wrap as it has it), trimesh (its repair functions, in the order of its documentation), MeshFix (pymeshfix, with
all components kept), manifold3d (merge, which mends cracks alone). With --markdown the table between the marks of FILE is
written anew.
"""
import argparse, os, re, statistics, subprocess, sys, tempfile, time

VOXMEND = {
    "voxmend repair --level closed": ["repair", "--level", "closed"],
    "voxmend repair --level solid": ["repair", "--level", "solid"],
    "voxmend remesh, 128": ["remesh", "-r", "128"],
}


# Each peer reads a mesh (not timed), repairs it (timed) and writes what comes of it: (read, repair, write).
def pymeshlab_peer(repair):
    import pymeshlab

    meshes = pymeshlab.MeshSet(verbose=False)
    return meshes.load_new_mesh, lambda _: repair(meshes), lambda path, _: meshes.save_current_mesh(path)


def pymeshlab_repair(meshes):
    meshes.meshing_remove_duplicate_vertices()
    meshes.meshing_remove_duplicate_faces()
    meshes.meshing_remove_null_faces()
    meshes.meshing_repair_non_manifold_edges()
    meshes.meshing_repair_non_manifold_vertices()
    meshes.meshing_close_holes(maxholesize=1 << 30)
    try:
        meshes.meshing_re_orient_faces_coherently()
    except Exception:  # it refuses what is not orientable
        pass


def pymeshlab_wrap(meshes):
    import pymeshlab

    meshes.generate_alpha_wrap(alpha=pymeshlab.PercentageValue(1), offset=pymeshlab.PercentageValue(1 / 30))


def read_by_trimesh(path):
    import trimesh

    mesh = trimesh.load(path, process=True, force="mesh")
    mesh.merge_vertices()
    return mesh


def trimesh_repair(mesh):
    import trimesh

    mesh.update_faces(mesh.unique_faces())
    mesh.update_faces(mesh.nondegenerate_faces())
    mesh.remove_unreferenced_vertices()
    trimesh.repair.fill_holes(mesh)
    trimesh.repair.fix_winding(mesh)
    trimesh.repair.fix_inversion(mesh)
    trimesh.repair.fix_normals(mesh)
    return mesh


def export(path, mesh):
    mesh.export(path)


def arrays(path, vertices, faces):
    import trimesh

    trimesh.Trimesh(vertices, faces, process=False).export(path)


def meshfix_repair(mesh):
    import pymeshfix

    return pymeshfix.clean_from_arrays(mesh.vertices, mesh.faces.astype("int32"), joincomp=True, remove_smallest_components=False)


def manifold_repair(mesh):
    import manifold3d

    made = manifold3d.Mesh(mesh.vertices.astype("float32"), mesh.faces.astype("uint32"))
    made.merge()
    solid = manifold3d.Manifold(made)
    if solid.is_empty():
        raise ValueError(str(solid.status()))
    return solid.to_mesh()


PEERS = {
    "PyMeshLab, repair and close holes": ("pymeshlab", lambda: pymeshlab_peer(pymeshlab_repair)),
    "PyMeshLab, alpha wrap 1 %": ("pymeshlab", lambda: pymeshlab_peer(pymeshlab_wrap)),
    "trimesh.repair": ("trimesh", lambda: (read_by_trimesh, trimesh_repair, export)),
    "MeshFix (pymeshfix)": ("pymeshfix", lambda: (read_by_trimesh, meshfix_repair, lambda path, made: arrays(path, *made))),
    "manifold3d, merge": (
        "manifold3d",
        lambda: (read_by_trimesh, manifold_repair, lambda path, made: arrays(path, made.vert_properties[:, :3], made.tri_verts)),
    ),
}


def work(tool, mesh, output):
    """The process of a peer; prints the seconds of its call."""
    read, repair, write = PEERS[tool][1]()
    loaded = read(mesh)
    start = time.perf_counter()
    made = repair(loaded)
    print("call", time.perf_counter() - start)
    write(output, made)


def judge(original, path):
    """The letter of a result."""
    import trimesh

    try:
        mesh = trimesh.load(path, process=True, force="mesh")
        mesh.merge_vertices()
    except Exception:
        return "x"
    if len(mesh.faces) == 0 or ((original.extents - mesh.extents) > 0.1 * original.scale).any():
        return "x"
    return "V" if mesh.is_volume else "C" if mesh.is_watertight else "o"


def run(command, timeout):
    """Seconds of the process and of the call within; None and a letter if it came to nothing."""
    threads = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
    start = time.perf_counter()
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, env={**os.environ, **threads})
    except subprocess.TimeoutExpired:
        return None, None, "t"
    seconds = time.perf_counter() - start
    if done.returncode:
        return None, None, "f"
    call = re.search(r"^call (.*)", done.stdout, re.M)
    return seconds, float(call.group(1)) if call else None, ""


def measure(command, options):
    process, call, letter = run(command, options.timeout)
    for _ in range(options.runs - 1):
        if process is None or process > options.timeout / 10:
            break
        again, again_call, _ = run(command, options.timeout)
        process = min(process, again or process)
        call = min(call, again_call or call) if call else None
    return process, call, letter


def milliseconds(seconds):
    return "–" if seconds is None else "%.3g" % (seconds * 1e3) if seconds < 1 else "{:,.0f}".format(seconds * 1e3).replace(",", " ")


def available():
    import importlib.util

    return [tool for tool, (package, _) in PEERS.items() if importlib.util.find_spec(package)]


def table(options):
    import trimesh

    tools = list(VOXMEND) + available()
    results = {tool: [] for tool in tools}
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for mesh in options.meshes:
            original = trimesh.load(mesh, process=True, force="mesh")
            cells = []
            for tool in tools:
                output = os.path.join(folder, "out.ply")
                if tool in VOXMEND:
                    command = [options.voxmend, *VOXMEND[tool], mesh, "-o", output, "--force", "--threads", "1", "-q"]
                else:
                    command = [sys.executable, __file__, "--work", tool, mesh, output]
                process, call, letter = measure(command, options)
                letter = letter or judge(original, output)
                if os.path.exists(output):
                    os.unlink(output)
                results[tool].append((process, call, letter))
                cells.append("%s %s" % (milliseconds(call or process), letter) if process else letter)
                print("%-40s %-36s %10s %10s %s" % (os.path.basename(mesh), tool, milliseconds(process), milliseconds(call), letter), file=sys.stderr)
            rows.append((os.path.basename(mesh), len(original.faces), cells))
    return tools, results, rows


def markdown(tools, results, rows):
    reference = [process for process, _, _ in results[tools[0]]]
    lines = ["| | process, median ms | call, median ms | × %s | volume | closed | open | lost | failed |" % tools[0], "|---" * 9 + "|"]
    for tool in tools:
        ratios = [a[0] / b for a, b in zip(results[tool], reference) if a[0] and b]
        middle = lambda which: statistics.median(r[which] for r in results[tool] if r[which]) if any(r[which] for r in results[tool]) else None
        count = lambda letters: sum(letter in letters for _, _, letter in results[tool])
        ratio = "–" if not ratios else "%.3g" % statistics.median(ratios)
        lines.append("| %s | %s | %s | %s | %d | %d | %d | %d | %d |" % (tool, milliseconds(middle(0)), milliseconds(middle(1)), ratio, count("V"), count("C"), count("o"), count("x"), count("ft")))
    lines += ["", "Each mesh, ms: for voxmend the process, for others the call alone.", ""]
    lines += ["| mesh | triangles | " + " | ".join(tools) + " |", "|---" * (len(tools) + 2) + "|"]
    lines += ["| %s | %d | %s |" % (name, faces, " | ".join(cells)) for name, faces, cells in rows]
    return "\n".join(lines) + "\n"


def main():
    if sys.argv[1:2] == ["--work"]:
        return work(*sys.argv[2:])
    parser = argparse.ArgumentParser()
    parser.add_argument("voxmend")
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--timeout", type=float, default=60)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--markdown", metavar="FILE")
    options = parser.parse_args()
    text = markdown(*table(options))
    if options.markdown:
        with open(options.markdown) as file:
            old = file.read()
        new = re.sub(r"(<!-- repair peers begin -->\n).*(<!-- repair peers end -->)", lambda m: m.group(1) + text + m.group(2), old, flags=re.S)
        with open(options.markdown, "w") as file:
            file.write(new)
    else:
        print(text, end="")


if __name__ == "__main__":
    main()
