# SPDX-License-Identifier: BSD-3-Clause
"""Where the grids of a batch stand: its folder, or what was exported of it. Each gives bits, as `_packed` has them.

A source has `shape`, of each grid; `names`, `kinds` and `splits`, of each; `classes`, names of all kinds of the batch's plan; `groups`,
numbers of what is read together; and `packed(i)`. It may be pickled, and used after a fork.
"""
from __future__ import annotations

import collections
import io
import json
import os
from typing import Any, Collection, Dict, Iterator, List, Optional, Tuple

import numpy

from ._batch_records import Records
from ._core import lib
from ._errors import ArgumentError, EmptyError, FormatError, UnavailableError
from ._export_common import describe, need_voxels, packed_grid, with_grids
from ._field import VALUE_KINDS, VoxelField
from ._grid import read
from ._packed import pack
from ._placement import class_names, split_as
from ._types import Array


class _Told:
    """What is told of grids, one after another, in little memory."""

    def __init__(self) -> None:
        self.names: List[str] = []
        self.kinds: List[str] = []
        self.splits: List[str] = []
        self.shape: Optional[Tuple[int, ...]] = None
        self._known: Dict[str, str] = {}  # one string of each class and split

    def add(self, told: Dict[str, Any], where: str) -> None:
        need_voxels(told.get("values"), where, told["item"])
        shape = tuple(told["shape"] or ())
        if self.shape is None:
            self.shape = shape
        if shape != self.shape or len(shape) != 3:
            raise ArgumentError("%s: the grid of %s is of %s, not of %s; make a dataset of grids of equal shape (--fit cube)" %
                                (where, told["item"], shape, self.shape))
        self.names.append(told["item"])
        self.kinds.append(self._known.setdefault(told["class"], told["class"]))
        split = split_as(told["split"])
        self.splits.append(self._known.setdefault(split, split))


class Source:
    """What all of them share."""

    def __init__(self, told: _Told, groups: Array, where: str, classes: Any):
        if told.shape is None:
            raise EmptyError("%s: there is no grid in it" % where)
        self.where, self.shape, self.groups = where, told.shape, groups
        self.names, self.kinds, self.splits = told.names, told.kinds, told.splits
        if classes is not None and not (isinstance(classes, list) and set(class_names(self.kinds)) <= set(classes)):
            raise FormatError("%s: its classes are not those of its grids" % where)
        self.classes: List[str] = class_names(self.kinds) if classes is None else classes  # None: an older export

    def __len__(self) -> int:
        return len(self.names)

    def packed(self, number: int) -> Array:
        raise NotImplementedError

    def check(self, number: int, bits: Array) -> Array:
        nx, ny, nz = self.shape
        if bits.shape != (nx, ny, (nz + 7) // 8) or bits.dtype != numpy.uint8:
            raise FormatError("%s: the grid of %s is %s of %s, not bits of %s" %
                              (self.where, self.names[number], bits.dtype, bits.shape, self.shape))
        return bits


def _places(records: Records) -> List[Tuple[int, int]]:
    """Number in the plan and number of the variant, of all grids; -1 = the grid itself. Variants count where no mesh has one."""
    grids = [(number, -1) for number, item in enumerate(records) if item.grid() is not None]
    if not grids:
        grids = [(number, v) for number, item in enumerate(records) for v in range(item.variant_count)]
    return grids or [(number, -1) for number in with_grids(records)]  # which says why there are none


class FolderSource(Source):
    """The outputs of a batch as they are."""

    def __init__(self, path: str):
        self.records = Records(path)
        self.records.need_complete()
        self.places = numpy.array(_places(self.records), numpy.int64)
        told = _Told()
        for number, _ in self.places:
            told.add(describe(self.records[number]), path)
        super().__init__(told, numpy.arange(len(told.names)), path, self.records.classes())

    def packed(self, number: int) -> Array:
        place, variant = self.places[number].tolist()
        item = self.records[place]
        if variant >= 0:
            return self.check(number, pack(read(self.records.path(item.variant(variant))).matrix))
        return self.check(number, packed_grid(self.records, item, False)[0])


def _lines(path: str) -> Iterator[Dict[str, Any]]:
    with open(path, "rb") as file:
        for line in file:
            try:
                yield json.loads(line)
            except ValueError:
                raise FormatError("%s: a line is no JSON" % path) from None


def _array_in(data: bytes, where: str, name: str) -> Array:
    try:
        array: Array = numpy.lib.format.read_array(io.BytesIO(data), allow_pickle=False)
    except ValueError:
        raise FormatError("%s: no .npy where the index has that of %s" % (where, name)) from None
    return array


def _kind_in(data: bytes, where: str, name: str) -> Optional[str]:
    """What the .json of an array says that its values are; None if it says nothing."""
    try:
        kind = json.loads(data).get("values") if data else None
    except (ValueError, AttributeError):
        raise FormatError("%s: no .json where the index has that of %s" % (where, name)) from None
    return kind if kind in VALUE_KINDS else None


def _need_mask(array: Array, kind: Optional[str], where: str, name: str) -> Array:
    """The array, if `read` would take it for set and clear voxels: the library decides, as there."""
    if array.dtype == numpy.bool_ and kind is None:
        return array
    is_mask = array.ndim == 3 and kind != "colors"
    if not is_mask or not lib.vxm_field_is_mask(VoxelField(array, kind=kind or "numbers")._pointer):
        need_voxels(kind or str(array.dtype), where, name)
    return array


def _arrays_of(line: Dict[str, Any], members: Collection[str], where: str) -> List[str]:
    """The grid among the files of a mesh, or its variants, where no grid was made."""
    has_grid = line["origin"] is not None
    wanted = [name for name in ("bits.npy", "npy") if name in members][:1] if has_grid else \
        sorted(name for name in members if name.startswith("variants.") and name.endswith(".npy"))
    if not wanted:
        raise ArgumentError("%s: of %s there is no %s" % (where, line["item"], "grid as bits.npy or npy; export the batch with "
                            "--content bits" if has_grid else "grid, and no variant as .npy; make the batch with grids, or with "
                            "--augment \"... --format npy\""))
    return wanted


def _classes_of_tars(path: str) -> Any:
    try:
        with open(os.path.join(path, "classes.json"), "rb") as file:
            return json.load(file)
    except FileNotFoundError:
        return None
    except ValueError:
        raise FormatError("%s: classes.json is no JSON" % path) from None


class TarSource(Source):
    """Tars with their index.jsonl, read where each grid stands."""

    def __init__(self, path: str):
        told, tars = _Told(), []  # type: Tuple[_Told, List[Tuple[int, ...]]]
        self.tars: List[str] = []
        numbers: Dict[str, int] = {}
        for line in _lines(os.path.join(path, "index.jsonl")):
            members = {member["name"]: member for member in line["members"]}
            tar = numbers.setdefault(line["tar"], len(numbers))
            for name in _arrays_of(line, members, path):
                told.add(line, path)
                member, beside = members[name], members.get(name + ".json", {"offset": 0, "bytes": 0})
                tars.append((tar, member["offset"], member["bytes"], name != "bits.npy", beside["offset"], beside["bytes"]))
        self.tars = [os.path.join(path, name) for name in numbers]
        self.places = numpy.array(tars, numpy.int64).reshape(-1, 6)
        self._open: "collections.OrderedDict[int, Any]" = collections.OrderedDict()
        super().__init__(told, self.places[:, 0].copy(), path, _classes_of_tars(path))

    def __getstate__(self) -> Dict[str, Any]:
        return dict(self.__dict__, _open=collections.OrderedDict())

    def __del__(self) -> None:
        for file in getattr(self, "_open", {}).values():
            file.close()

    def _descriptor(self, tar: int) -> int:
        """Files are read at places told, which processes that share them do not mind."""
        if tar not in self._open:
            self._open[tar] = open(self.tars[tar], "rb", buffering=0)
            if len(self._open) > 64:
                self._open.popitem(last=False)[1].close()
        self._open.move_to_end(tar)
        return int(self._open[tar].fileno())

    def packed(self, number: int) -> Array:
        tar, offset, size, is_plain, beside, beside_size = self.places[number].tolist()
        where, name = self.tars[tar], self.names[number]
        array = _array_in(os.pread(self._descriptor(tar), size, offset), where, name)
        if is_plain:
            kind = _kind_in(os.pread(self._descriptor(tar), beside_size, beside), where, name)
            array = pack(_need_mask(array, kind, where, name))
        return self.check(number, array)


class ZarrSource(Source):
    """A Zarr group; the last chunks stay in memory."""

    HELD = 8

    def __init__(self, path: str):
        told = _Told()
        self.path = path
        self._held: "collections.OrderedDict[int, Array]" = collections.OrderedDict()
        self._grids: Any = None
        attributes = dict(self._group().attrs)
        if attributes.get("format") != "voxmend grids":
            raise FormatError("%s: no Zarr group of voxmend's grids" % path)
        for line in _lines(os.path.join(path, "items.jsonl")):
            told.add(line, path)
        self.each = int(self._array().chunks[0])
        super().__init__(told, numpy.arange(len(told.names)) // self.each, path, attributes.get("classes"))

    def _group(self) -> Any:
        try:
            import zarr
        except ImportError:
            raise UnavailableError("grids: the package zarr is not installed (Debian: python3-zarr; PyPI: zarr)") from None
        return zarr.open_group(self.path, mode="r")

    def _array(self) -> Any:
        if self._grids is None:
            self._grids = self._group()["grids"]
        return self._grids

    def __getstate__(self) -> Dict[str, Any]:
        return dict(self.__dict__, _grids=None, _held=collections.OrderedDict())

    def packed(self, number: int) -> Array:
        chunk = number // self.each
        if chunk not in self._held:
            self._held[chunk] = self._array()[chunk * self.each:(chunk + 1) * self.each]
            if len(self._held) > self.HELD:
                self._held.popitem(last=False)
        self._held.move_to_end(chunk)
        return self.check(number, self._held[chunk][number % self.each])


def open_source(path: str) -> Source:
    """By what stands in the folder."""
    if os.path.isdir(os.path.join(path, ".batch")):
        return FolderSource(path)
    if os.path.isfile(os.path.join(path, "index.jsonl")):
        return TarSource(path)
    if os.path.isfile(os.path.join(path, "items.jsonl")):
        return ZarrSource(path)
    raise ArgumentError("%s: neither the folder of a batch, nor one of its exports to webdataset or Zarr" % path)
