#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What other programs find in grids that voxmend writes: nibabel, VTK, tifffile, Pillow, h5py, zarr and pynrrd, those that are
there.

other_grid_readers.py VOXMEND SAMPLES MESHES

A sample, and a real mesh where there are some, are voxelized into each format. Each reader has to open the file, to find
the voxels of the .npy (whose order the tests of numpy hold to), and to put them where the mesh is: of voxels whose centres
lie, by the place that the reader finds, away from the surface, those that trimesh has inside the mesh are set, and no others.
Distances, coverage and labels are those of the .npy, and so is the table of labels where the format has one. Prints a table.
"""
import json, os, subprocess, sys

import numpy
import trimesh

DIMS = "23x19x21"  # odd, and of three lengths: axes that are mixed up show


def nifti(path):
    import nibabel

    image = nibabel.load(path)
    for form in (image.get_sform(), image.get_qform()):
        assert numpy.allclose(form, image.affine, atol=1e-5)
    assert numpy.allclose(image.affine[:3, :3], numpy.diag(numpy.diag(image.affine[:3, :3])))
    label = image.header.get_intent()[0] == "label"
    return numpy.asarray(image.dataobj), image.affine[:3, 3], numpy.diag(image.affine)[:3], label


def vtk_image(path):
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    reader = vtk.vtkXMLImageDataReader() if path.endswith(".vti") else vtk.vtkStructuredPointsReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    cells, values = image.GetCellData(), image.GetCellData().GetArray(0)
    assert cells.GetNumberOfArrays() == 1 and image.GetPointData().GetNumberOfArrays() == 0
    dims = [n - 1 for n in image.GetDimensions()]
    spacing = numpy.array(image.GetSpacing())
    first = numpy.array(image.GetCell(0).GetBounds()).reshape(3, 2).mean(axis=1)  # where VTK has the first cell
    array = vtk_to_numpy(values).reshape(*dims[::-1], -1).squeeze(3).transpose(2, 1, 0)
    return array, first, spacing, values.GetName() == "labels"


def tiff(path):
    import tifffile

    with tifffile.TiffFile(path) as file:
        assert file.is_imagej
        text, tags = file.imagej_metadata, file.pages[0].tags
        across = [tags[name].value for name in ("XResolution", "YResolution")]
        size = numpy.array([below / above for above, below in across] + [text["spacing"]])
        origin = -numpy.array([text[name] for name in ("xorigin", "yorigin", "zorigin")]) * size
        return file.asarray().transpose(2, 1, 0), origin + size / 2, size, text["voxmend"].startswith("labels ")


def pillow(path):
    """Pages alone: Pillow looks at no place."""
    from PIL import Image

    image = Image.open(path)
    pages = []
    for page in range(image.n_frames):
        image.seek(page)
        pages.append(numpy.asarray(image).transpose())
    return numpy.stack(pages, axis=2), None, None, None


def slices(path):
    """Pictures by Pillow, and the place by the JSON."""
    from PIL import Image

    with open(path + ".json") as file:
        told = json.load(file)
    names = [path % number for number in range(told["dims"][2])]
    assert not os.path.exists(path % len(names))
    pages = [Image.open(name) for name in names]
    assert {page.mode for page in pages} <= {"L", "I;16", "I", "F"}
    voxels = numpy.stack([numpy.asarray(page).transpose() for page in pages], axis=2)
    if "values" not in told:
        full = 255 if path.endswith("png") else 1  # as a stack in one .tif has them
        assert set(numpy.unique(voxels)) <= {0, full}
        voxels = voxels // full
    size = numpy.array(told["voxel_size"])
    names = [label["name"] for label in told.get("labels", [])]
    return voxels, told["origin"] + size / 2, size, names if told.get("values") == "labels" else False


def hdf5(path):
    import h5py

    with h5py.File(path) as file:
        voxels, text = file["voxels"][...], file["voxels"].attrs
        size = text["voxel_size"]
        names = list(text["label_names"]) if "label_names" in text else None
        return voxels, text["origin"] + size / 2, size, names if text["kind"] == "labels" else False


def zarr_array(path):
    import zarr

    array = zarr.open(path, mode="r")
    text = dict(array.attrs)
    size = numpy.array(text["voxel_size"])
    return array[...], text["origin"] + size / 2, size, text.get("label_names") if text["kind"] == "labels" else False


def nrrd_file(path):
    import nrrd

    values, header = nrrd.read(path)
    return values, header["space origin"], numpy.diag(header["space directions"]), None


# format, reader's name, function, module
READERS = (
    ("nii", "nibabel", nifti, "nibabel"),
    ("nii.gz", "nibabel", nifti, "nibabel"),
    ("vti", "VTK", vtk_image, "vtk"),
    ("vtk", "VTK", vtk_image, "vtk"),
    ("tif", "tifffile", tiff, "tifffile"),
    ("tif", "Pillow", pillow, "PIL"),
    ("%03d.png", "Pillow (place, names: the JSON)", slices, "PIL"),
    ("%03d.tif", "Pillow (place, names: the JSON)", slices, "PIL"),
    ("h5", "h5py", hdf5, "h5py"),
    ("zarr", "zarr", zarr_array, "zarr"),
    ("nrrd", "pynrrd", nrrd_file, "nrrd"),
)


def has(module):
    try:
        __import__(module)
        return True
    except (ImportError, OSError):
        return False


def voxmend(*words):
    return subprocess.run([sys.argv[1], *words, "-q"], capture_output=True, text=True)


class Mesh:
    """A mesh as it is voxelized, repaired so that trimesh can tell its inside."""

    def __init__(self, path, folder):
        self.path, self.folder = path, folder
        closed = os.path.join(folder, "closed.ply")
        assert voxmend("repair", path, "-o", closed, "--level", "closed").returncode == 0
        self.mesh = trimesh.load(closed, force="mesh")
        assert self.mesh.is_watertight
        self.truth = {}
        self.path = closed
        for name, words in (("bits", ("--thin", "drop")), ("distance", ("--distance", "signed")), ("coverage", ("--coverage", "4")),
                            ("bytes", ("--coverage", "4", "--scalar", "uint8")),
                            ("labels", ("--labels", "part"))):
            file = os.path.join(folder, name + ".npy")
            done = self.write(file, words)
            assert done.returncode == 0, done.stderr
            self.truth[name] = numpy.load(file), words
        with open(os.path.join(folder, "labels.npy.json")) as file:
            self.names = [label["name"] for label in json.load(file)["labels"]]

    def write(self, file, words):
        return voxmend("voxelize", self.path, "-r", DIMS, "--fit", "tight", "-o", file, *words)

    def is_in_place(self, voxels, first, size):
        """Whether what is set is what lies inside the mesh, by the reader's own place."""
        at = numpy.stack(numpy.meshgrid(*map(numpy.arange, voxels.shape), indexing="ij"), axis=-1).reshape(-1, 3)
        centres = first + at * size
        some = numpy.random.default_rng(5).permutation(len(centres))[:500]
        away = numpy.abs(trimesh.proximity.closest_point(self.mesh, centres[some])[1]) > 1e-3 * size.max()
        some = some[away]
        inside = self.mesh.contains(centres[some])
        return bool(inside.any() and (inside == (voxels.reshape(-1)[some] != 0)).all())


def check(mesh, kind, reader):
    """None if the format is not to be had here; else what of a file is right."""
    truth, words = mesh.truth[kind]
    file = os.path.join(mesh.folder, f"{kind}.{reader[0]}")
    done = mesh.write(file, words)
    if done.returncode != 0 and "configure" in done.stderr:
        print(f"  without .{reader[0]}: {done.stderr.strip()}")
        return None
    if reader[0].endswith("png") and truth.dtype.kind == "f":
        assert done.returncode != 0 and "go into .png" in done.stderr, done.stderr
        return None
    assert done.returncode == 0, done.stderr
    voxels, first, size, labels = reader[2](file)
    found = {"same": voxels.shape == truth.shape and bool((voxels == truth).all())}
    if kind == "bits":
        found["place"] = None if first is None else mesh.is_in_place(voxels, first, size)
    if kind == "labels":
        found["labels"] = labels == mesh.names if isinstance(labels, list) else labels
    return found


def sign(value):
    return "—" if value is None else "yes" if value else "NO"


def main():
    samples, meshes = sys.argv[2:4]
    paths = [os.path.join(samples, name) for name in ("l_prism.off", "sphere.off")]
    real = os.path.join(meshes, "messy", "trimesh-bunny.ply")
    if os.path.exists(real):
        paths.append(real)
    table, bad = {}, 0
    for path in paths:
        folder = os.path.join(samples, "grids-" + os.path.basename(path))
        os.makedirs(folder)
        mesh = Mesh(path, folder)
        for reader in READERS:
            if not has(reader[3]):
                print(f"  without {reader[1]}")
                continue
            row = table.setdefault(reader[:2], {})
            for kind in mesh.truth:
                if reader[1] == "Pillow" and kind not in ("bits", "labels"):
                    continue
                try:
                    found = check(mesh, kind, reader)
                except Exception as error:  # of whatever the reader has
                    print(f"{path}: .{reader[0]} by {reader[1]}, {kind}: {type(error).__name__}: {error}")
                    found = {"same": False, "opens": False}
                for name, value in (found or {}).items():
                    name = {"same": "voxels" if kind == "bits" else "numbers" if kind != "labels" else "label numbers"}.get(name, name)
                    row[name] = False if row.get(name) is False else value
                    if value is not None and not value:
                        bad += 1
                        print(f"{path}: .{reader[0]} by {reader[1]}, {kind}: wrong ({name})")
    columns = ("voxels", "place", "numbers", "label numbers", "labels")
    print("\n| format | reader | opens | same voxels | same place | same numbers | same labels | told as labels, names |")
    print("|---|---|---|---|---|---|---|---|")
    for (name, reader), row in table.items():
        print(f"| `.{name}` | {reader} | {sign(row.get('opens', bool(row) or None))} | "
              + " | ".join(sign(row.get(column)) for column in columns) + " |")
    sys.exit(bad > 0 or not table)


main()
