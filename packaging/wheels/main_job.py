# SPDX-License-Identifier: BSD-3-Clause
"""main_job.py MESH: what people install the package for, by the installed package: a messy mesh in; a mended one, right voxels
in many formats, and variants to train with, out. Works in the current folder."""
import importlib.metadata
import multiprocessing
import os
import pickle
import sys

import numpy

import voxmend

RESOLUTION = 48


def voxels(mesh):
    return voxmend.voxelize(mesh, RESOLUTION).hash


def formats(grid):
    """Written and read back, each by what the wheel brings."""
    for extension in ("binvox", "npy", "nrrd", "raw", "nii.gz", "vti", "octree", "h5", "bt", "vox", "schem", "tif"):
        path = "grid." + extension
        grid.save(path)
        assert os.path.getsize(path) > 0, path
        if extension in ("binvox", "npy", "nrrd", "h5"):
            again = voxmend.read(path)
            assert again.hash == grid.hash and numpy.allclose(again.origin, grid.origin), path
    for extension in ("obj", "stl", "ply", "glb"):
        path = "surface." + extension
        grid.save(path)
        surface = voxmend.load(path)  # .glb by Assimp, in the process of readers
        assert surface.info().faces > 100, path


def processes(mesh, wanted):
    """Before and after a fork, and in interpreters of their own."""
    for method in ("fork", "spawn", "forkserver"):
        with multiprocessing.get_context(method).Pool(2) as pool:
            assert pool.map(voxels, [mesh, pickle.loads(pickle.dumps(mesh))]) == [wanted, wanted], method


def missing():
    """What is not in the wheel says so, and how it can be had."""
    mesh = voxmend.load(sys.argv[1])
    for call, words in ((lambda: voxmend.repair(mesh, "solid"), ("cgal", "GPL", "configure --with-cgal")),
                        (lambda: voxmend.voxelize(mesh, 8).save("grid.vdb"), ("openvdb", "not in this wheel", "archive of sources"))):
        try:
            call()
        except voxmend.UnavailableError as error:
            assert all(word in str(error) for word in words), error
        else:
            raise AssertionError("nothing is missing")
    assert not os.path.exists("grid.vdb")


def main():
    path = os.path.abspath(sys.argv[1])
    assert voxmend.__file__.startswith(sys.prefix), voxmend.__file__
    assert voxmend.__version__ == importlib.metadata.version("voxmend")
    mesh = voxmend.load(path)
    assert not mesh.info().watertight
    closed = mesh.repair("closed")
    assert closed.info().watertight
    closed.save("closed.stl", level="closed")
    filled = voxmend.repair(mesh, "closed", fill="minimal")  # by OpenMesh
    assert filled.info().watertight
    grid = voxmend.voxelize(mesh, RESOLUTION)
    assert grid.matrix.shape == (RESOLUTION,) * 3 and grid.matrix.sum() == grid.filled_count > 1000
    assert voxmend.distance(mesh, 16).values.dtype == numpy.float32
    formats(grid)
    processes(mesh, grid.hash)
    sampler = voxmend.Sampler(32, rotate="any", seed=1)
    sampler.put(mesh.repair(separate=True))
    assert sampler.batch(4).shape == (4, 1, 32, 32, 32)
    missing()
    print("Python %s, numpy %s: %s" % (sys.version.split()[0], numpy.__version__, grid))


if __name__ == "__main__":
    main()
