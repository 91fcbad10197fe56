#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a CAD importer in Python does with an assembly, as import_parts.cc does in C++: read it at a tolerance, take it apart by
the names of its parts, repair each as far as it goes, and voxelize all of them into one space; with progress and a time limit.

    import_parts.py FILE [--deflection SHARE] [--weld DISTANCE] [--resolution N] [--seconds S]
"""
import argparse
import sys
import time

import numpy
import voxmend


def parts_of(mesh):
    """(name, mesh) of the faces of each name."""
    if not mesh.tags:
        return [("unnamed", mesh)]
    sizes = numpy.diff(mesh.offsets.astype(numpy.int64))
    found = []
    for number, name in enumerate(mesh.tags):
        chosen = mesh.face_tags == number
        if chosen.any():
            used, corners = numpy.unique(mesh.indices[numpy.repeat(chosen, sizes)], return_inverse=True)
            faces = numpy.split(corners, numpy.cumsum(sizes[chosen])[:-1])
            found.append((name, voxmend.Mesh(mesh.vertices[used], [face.tolist() for face in faces])))
    return found


def repaired(mesh, weld):
    """A part, repaired to the highest level that it reaches without being changed beyond what is tolerated, and that level."""
    for level in "closed", "manifold", "clean":
        try:  # as it was drawn: what is open is not to become a plate
            mended = mesh.repair(level, weld=weld or "auto", sheets="keep", max_change=0.05, part_changes=True)
        except (voxmend.UnreachedError, voxmend.UnavailableError):
            continue
        if mended.verify(level).reached:
            return mended, level
    return mesh, "as it came"


class Told:
    """Where an importer would move its bar; what it raises ends the call."""

    def __init__(self):
        self.start, self.shown = time.monotonic(), ""

    def __call__(self, phase, fraction):
        if phase != self.shown and time.monotonic() > self.start + 1:
            self.shown = phase
            print(phase, "...", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description="Repairs and voxelizes the parts of an assembly.")
    parser.add_argument("file")
    parser.add_argument("--deflection", type=float, default=0, help="of curved surfaces, as a part of the diagonal")
    parser.add_argument("--weld", type=float, default=0, help="how far apart vertices may be that are one")
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--seconds", type=float, help="time limit")
    wanted = parser.parse_args()
    try:
        with voxmend.watch(progress=Told(), timeout=wanted.seconds):
            whole = voxmend.load(wanted.file, deflection=wanted.deflection)
            space = voxmend.voxelize(whole, wanted.resolution)
            for name, mesh in parts_of(whole):
                mended, level = repaired(mesh, wanted.weld)
                info = mended.info()
                grid = voxmend.voxelize(mended, like=space, repair=False)
                print("%s: %d faces, %s, volume %.6g, moved %.3g, %d voxels" %
                      (name, len(mesh.offsets) - 1, level, info.volume if info.closed else 0,
                       mended.report.max_displacement if level != "as it came" else 0, grid.filled_count))
    except voxmend.VoxmendTimeout as why:
        print("import_parts.py:", why, file=sys.stderr)
        return 3
    except voxmend.VoxmendError as why:
        print("import_parts.py:", why, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
