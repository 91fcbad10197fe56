# SPDX-License-Identifier: BSD-3-Clause
"""Numbers in files through the package, against numpy's own reading of them. SAMPLES is a folder of sample meshes."""
import base64
import copy
import json
import os
import pickle
import re
import unittest
import unittest.mock
import warnings
import zlib

import numpy

import voxmend

SAMPLES = os.environ["SAMPLES"]
TYPES = "float64 float32 float16 uint8 int8 uint16 int16 uint32 int32 uint64 int64".split()


def read_nrrd(path):
    """Values as [x][y][z], by the format's description alone."""
    with open(path, "rb") as file:
        head, data = file.read().split(b"\n\n", 1)
    lines = dict(line.split(": ", 1) for line in head.decode().split("\n") if ": " in line and not line.startswith("#"))
    names = {"uchar": "u1", "signed char": "i1", "ushort": "u2", "short": "i2", "uint": "u4", "int": "i4",
             "ulonglong": "u8", "longlong": "i8", "float": "f4", "double": "f8"}
    order = {"little": "<", "big": ">"}[lines.get("endian", "little")]
    sizes = [int(n) for n in lines["sizes"].split()]
    array = numpy.frombuffer(data, order + names[lines["type"]]).reshape(sizes[::-1])
    return array.transpose(2, 1, 0, 3) if len(sizes) == 4 else array.transpose()


def read_page(path):
    """What a page says of its voxels, and their bytes."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    about = json.loads(re.search(r'<script type="application/json" id="about">(.*?)</script>', text)[1])
    voxels = re.search(r'<script type="application/octet-stream;base64" id="voxels">(.*?)</script>', text)[1]
    return about, zlib.decompress(base64.b64decode(voxels))


class Fields(unittest.TestCase):
    def path(self, name):
        return os.path.join(SAMPLES, name)

    def random(self, kind):
        rng = numpy.random.default_rng(5)
        values = rng.integers(0, 256, (9, 11, 7, numpy.dtype(kind).itemsize), numpy.uint8).view(kind)[..., 0]
        return numpy.nan_to_num(values) if kind.startswith("float") else values

    def test_every_type_there_and_back(self):
        for kind in TYPES:
            for array in (self.random(kind), numpy.asfortranarray(self.random(kind)), self.random(kind).astype(numpy.dtype(kind).newbyteorder())):
                numpy.save(self.path("a.npy"), array)
                field = voxmend.read_field(self.path("a.npy"))
                self.assertEqual(field.values.dtype, kind)
                numpy.testing.assert_array_equal(field.values, array)
                field.save(self.path("b.nrrd"))
                numpy.testing.assert_array_equal(read_nrrd(self.path("b.nrrd")), array)
                voxmend.read_field(self.path("b.nrrd")).save(self.path("c.npy"))
                numpy.testing.assert_array_equal(numpy.load(self.path("c.npy")), array)
                with self.assertRaises(voxmend.NumbersError) as raised:
                    voxmend.read(self.path("a.npy"))
                self.assertIn(kind, str(raised.exception))
                self.assertEqual(raised.exception.status, "numbers")

    def test_made_of_arrays(self):
        for kind in TYPES:
            field = voxmend.Field(self.random(kind), pitch=(1, 2, 3), origin=(4, 5, 6), kind="labels")
            numpy.testing.assert_array_equal(field.values, self.random(kind))
            self.assertEqual((tuple(field.pitch), tuple(field.origin), field.kind), ((1, 2, 3), (4, 5, 6), "labels"))
            self.assertFalse(field.values.flags.writeable)
        with self.assertRaises(voxmend.ArgumentError):
            voxmend.Field(numpy.zeros((2, 2)))
        with self.assertRaises(voxmend.KindError):
            voxmend.Field(numpy.zeros((2, 2, 2), complex))
        with self.assertRaises(voxmend.ArgumentError):
            voxmend.Field(numpy.zeros((2, 2, 2)), kind="temperature")
        with self.assertRaises(voxmend.ArgumentError):
            voxmend.Field(numpy.zeros((2, 2, 2, 4)), kind="colors")

    def test_distance_and_solid(self):
        values, origin, pitch = voxmend.distance(self.path("torus.off"), 24, pad=2)
        field = voxmend.Field(values, pitch, origin, kind="distance")
        field.save(self.path("d.npy"))
        solid = voxmend.voxelize(self.path("torus.off"), like=field, thin="drop")
        for grid in (field.threshold(below=0), voxmend.read(self.path("d.npy"), below=0)):
            self.assertEqual(grid.compare(solid)["iou"], 1.0)
        back = voxmend.read_field(self.path("d.npy"))
        self.assertEqual(back.kind, "distance")
        numpy.testing.assert_array_equal(back.values, values)
        self.assertRaises(voxmend.ArgumentError, field.threshold)
        self.assertRaises(voxmend.ArgumentError, field.save, self.path("d.rle"))

    def test_sets(self):
        rng = numpy.random.default_rng(3)
        shape, place = (9, 20, 33), (0.5, (1, 2, 3))
        for kind, dtype in (("labels", "uint16"), ("numbers", "int32"), ("coverage", "float32")):
            a, b = ((rng.integers(1, 7, shape) * (rng.random(shape) < 0.5)).astype(dtype) for _ in range(2))
            x, y = (voxmend.VoxelField(v, *place, kind=kind) for v in (a, b))
            for made, wanted in ((x | y, numpy.where(a != 0, a, b)), (x & y, a * (b != 0)), (x - y, a * (b == 0)),
                                 (x ^ y, numpy.where(a != 0, a * (b == 0), b))):
                numpy.testing.assert_array_equal(made.values, wanted)
                self.assertEqual((made.kind, made.values.dtype), (kind, a.dtype))
        a, b = (rng.normal(size=shape).astype(numpy.float32) for _ in range(2))
        x, y = (voxmend.VoxelField(v, *place, kind="distance") for v in (a, b))
        for made, wanted in ((x | y, numpy.minimum(a, b)), (x & y, numpy.maximum(a, b)), (x - y, numpy.maximum(a, -b)),
                             (x ^ y, numpy.maximum(numpy.minimum(a, b), -numpy.maximum(a, b)))):
            numpy.testing.assert_array_equal(made.values, wanted)
        for other, error in ((voxmend.VoxelField(a, *place), voxmend.ArgumentError), (a, TypeError),
                             (voxmend.VoxelField(a[1:], *place, kind="distance"), voxmend.ArgumentError)):
            with self.assertRaises(error):
                x | other

    def test_masks(self):
        rng = numpy.random.default_rng(6)
        bits = rng.random((5, 6, 7)) < 0.5
        for array in (bits, bits.astype("uint8"), bits.astype("uint8") * 255, bits.astype("float32"), bits.astype(">i4")):
            numpy.save(self.path("m.npy"), array)
            numpy.testing.assert_array_equal(voxmend.read(self.path("m.npy")).matrix, bits)
        for array in (bits.astype("uint8") * 7, bits * -1.0, bits * 0.5, bits.astype("uint16") * 255):
            numpy.save(self.path("m.npy"), array)
            self.assertRaises(voxmend.NumbersError, voxmend.read, self.path("m.npy"))

    def test_colors_and_warnings(self):
        colors = numpy.random.default_rng(7).integers(0, 256, (3, 4, 5, 4), numpy.uint8)
        voxmend.Field(colors, kind="colors").save(self.path("k.nrrd"))
        numpy.testing.assert_array_equal(read_nrrd(self.path("k.nrrd")), colors.transpose(0, 1, 2, 3))
        numpy.testing.assert_array_equal(voxmend.read_field(self.path("k.nrrd")).values, colors)
        numpy.save(self.path("w.npy"), self.random("float32"))
        with self.assertWarns(voxmend.VoxmendWarning):
            field = voxmend.read_field(self.path("w.npy"))
        self.assertEqual(len(field.warnings), 1)

    def test_stretched(self):
        """A file of a program for which voxels are cubes tells of those that are none, and has them all the same."""
        for kind in "vox", "schem", "litematic", "npy":
            for pitch, told in (((1, 1, 2), kind != "npy"), ((2, 2, 2), False)):
                path = self.path("stretched." + kind)
                for one in voxmend.VoxelGrid(numpy.ones((2, 3, 4), bool), pitch), voxmend.VoxelField(numpy.ones((2, 3, 4), "u1"), pitch,
                                                                                                      kind="labels"):
                    with warnings.catch_warnings(record=True) as found:
                        warnings.simplefilter("always")
                        one.save(path)
                    self.assertEqual([str(line.message)[:len(path) + 40] for line in found],
                                     [("%s: .%s shows all voxels as cubes, and these are 1 x 1 x 2" % (path, kind))[:len(path) + 40]] * told)
                self.assertEqual(tuple(voxmend.read_field(path).pitch), pitch)

    def test_metadata(self):
        with open(self.path("u.nrrd"), "wb") as file:
            file.write(b"NRRD0004\ntype: uint16\ndimension: 3\nsizes: 2 1 1\nendian: little\nencoding: raw\n"
                       b"space: left-posterior-superior\nspace units: \"mm\" \"mm\" \"mm\"\nspace origin: (0,0,0)\n"
                       b"space directions: (1,0,0) (0,1,0) (0,0,1)\npatient:=nobody\n\n\x05\x00\x00\x01")
        voxmend.read_field(self.path("u.nrrd")).save(self.path("u.npy"))
        voxmend.read_field(self.path("u.npy")).save(self.path("u2.nrrd"))
        field = voxmend.read_field(self.path("u2.nrrd"))
        self.assertEqual(field.values.tolist(), [[[5]], [[256]]])
        self.assertEqual(field.metadata, {"nrrd_space": "left-posterior-superior", "nrrd_space_units": "\"mm\" \"mm\" \"mm\"",
                                          "patient": "nobody"})
        with open(self.path("u2.nrrd"), "rb") as file:
            text = file.read()
        for line in (b"\nspace: left-posterior-superior\n", b"\nspace units: \"mm\" \"mm\" \"mm\"\n", b"\npatient:=nobody\n"):
            self.assertIn(line, text)

    def test_copies(self):
        labels = numpy.zeros((3, 4, 5), numpy.uint16)
        labels[1], labels[2, 0] = 1, 2
        field = voxmend.Field(labels, (1, 2, 3), (4, 5, 6), "labels")
        from voxmend import _core
        for name, count in ((b"wood", 20), (b"steel", 5)):
            _core.call(_core.lib.vxm_field_add_label, field._pointer, name, count)
        _core.call(_core.lib.vxm_field_add_metadata, field._pointer, b"units", b"mm")
        field.save(self.path("l.npy"))
        read = voxmend.read_field(self.path("l.npy"))
        for each in (field, read):
            for again in (pickle.loads(pickle.dumps(each)), copy.deepcopy(each)):
                numpy.testing.assert_array_equal(again.values, labels)
                self.assertEqual((again.kind, again.label_names, again.metadata, again.warnings, again.values.dtype),
                                 (each.kind, {1: "wood", 2: "steel"}, {"units": "mm"}, each.warnings, labels.dtype))
                again.save(self.path("l2.npy"))
                for end in ("", ".json"):
                    with open(self.path("l.npy" + end), "rb") as one, open(self.path("l2.npy" + end), "rb") as other:
                        self.assertEqual(one.read(), other.read().replace(b"l2.npy", b"l.npy"))
        colors = voxmend.Field(numpy.ones((2, 2, 2, 4), numpy.uint8), kind="colors")
        self.assertEqual(copy.copy(colors).kind, "colors")
        values = field.values
        del field, read, each, again
        numpy.testing.assert_array_equal(values, labels)

    def test_pages(self):
        path = self.path("page.html")
        rng = numpy.random.default_rng(6)
        bits = rng.random((13, 9, 7)) < 0.4
        voxmend.VoxelGrid(bits, pitch=0.5, origin=(1, 2, 3)).save_page(path, "</script><b>")
        about, data = read_page(path)
        rows = numpy.frombuffer(data, numpy.uint8).reshape(7, 9, 2)
        read = numpy.unpackbits(rows, axis=2, bitorder="little")[:, :, :13].transpose(2, 1, 0)
        numpy.testing.assert_array_equal(read, bits)
        self.assertEqual((about["title"], about["dims"], about["origin"]), ("</script><b>", [13, 9, 7], [1, 2, 3]))
        values = rng.standard_normal((6, 5, 4))
        values[0, 0, 0], values[1, 1, 1] = 1e-30, -0.0
        voxmend.Field(values, kind="distance").save_page(path)
        about, data = read_page(path)
        high, low = numpy.frombuffer(data, numpy.uint8).reshape(2, 4, 5, 6).astype(int)
        codes = (high * 256 + low).transpose(2, 1, 0)
        numpy.testing.assert_array_equal(codes < 32768, numpy.signbit(values))
        steps = numpy.where(codes < 32768, codes - 32767, codes - 32768)
        numpy.testing.assert_allclose(steps / 32766 * about["scale"], values, atol=about["scale"] / 60000)

    def test_shown(self):
        grid = voxmend.VoxelGrid(numpy.ones((3, 3, 3), bool))
        self.assertTrue(grid._repr_html_().startswith("<iframe srcdoc="))
        self.assertNotIn("<script", grid._repr_html_())
        large = voxmend.Field(numpy.random.default_rng(7).random((150, 150, 150)))
        self.assertIn("too large for a notebook", large._repr_html_())
        with unittest.mock.patch("webbrowser.open") as opened:
            path = grid.show()
        opened.assert_called_once_with("file://" + path)
        self.assertEqual(read_page(path)[0]["count"], 27)
        os.unlink(path)


if __name__ == "__main__":
    unittest.main(verbosity=1)
