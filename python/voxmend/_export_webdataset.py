# SPDX-License-Identifier: BSD-3-Clause
"""Tars as webdataset reads them: KEY.bits.npy and KEY.json for each mesh; index.jsonl, which says where each stands, and
classes.json, all classes of the batch's plan.

The bytes follow from the outputs of the batch and the options alone (and numpy's header of .npy).
"""
from __future__ import annotations

import hashlib
import io
import json
import os
import tarfile
from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy

from . import _values
from ._batch_records import DONE, Item, Records
from ._errors import ArgumentError, EmptyError
from ._export_common import content, describe, folder_content, is_folder, json_line, packed_grid, published, with_grids

MAX_BYTES = 256 << 20
Member = Tuple[str, bytes]


def key_of(item: Item) -> str:
    """The item's name of outputs; webdataset's keys end at the first dot of a file's name."""
    output: str = item.plan["output"]
    folder, slash, name = output.rpartition("/")
    return folder + slash + name.replace("%", "%25").replace(".", "%2E")


def _order(records: Records, numbers: List[int], seed: Optional[int]) -> List[int]:
    if seed is None:
        return numbers
    salt = b"%d|" % seed
    return sorted(numbers, key=lambda number: hashlib.sha256(salt + records[number].item.encode()).digest())


def _bits(records: Records, item: Item) -> Tuple[List[Member], Dict[str, Any]]:
    bits, told = packed_grid(records, item)
    file = io.BytesIO()
    numpy.lib.format.write_array(file, bits, (1, 0), allow_pickle=False)
    return [("bits.npy", file.getvalue())], told


def _files_of(records: Records, output: Dict[str, Any], start: int) -> List[Member]:
    name = output["path"][start:].lstrip(".")
    if not is_folder(output):
        return [(name, content(records, output))]
    if name == "zarr":
        raise ArgumentError("%s: a grid of --format zarr is a folder, and content \"files\" takes grids that are files; export "
                            "with content \"bits\", or make the batch with another format" % records.path(output))
    return [("%s.%s" % (name, inner), data) for inner, data in folder_content(records, output)]


def _files(records: Records, item: Item) -> Tuple[List[Member], Dict[str, Any]]:
    """All outputs; their names without that of the item: npy, npy.json, repaired.ply, variants.000000.npy."""
    start = len(item.plan["output"])
    return [member for output in item.end.get("outputs", ()) for member in _files_of(records, output, start)], describe(item)


class _Tars:
    """Tars of a split, one after another, none larger than it may be unless by a single mesh."""

    def __init__(self, folder: str, name: str, max_bytes: int):
        self.folder, self.name, self.max_bytes = folder, name, max_bytes
        self.count = 0
        self.tar: Optional[tarfile.TarFile] = None
        self.tar_name = ""

    def close(self) -> None:
        if self.tar is not None:
            self.tar.close()
        self.tar = None

    def _need(self, size: int) -> tarfile.TarFile:
        if self.tar is not None and self.tar.offset > 0:
            end = self.tar.offset + size + 2 * tarfile.BLOCKSIZE  # what ends a tar
            if -(-end // tarfile.RECORDSIZE) * tarfile.RECORDSIZE > self.max_bytes:
                self.close()
        if self.tar is None:
            self.tar_name = "%s-%06d.tar" % (self.name, self.count)
            self.tar = tarfile.open(os.path.join(self.folder, self.tar_name), "w", format=tarfile.PAX_FORMAT)
            self.count += 1
        return self.tar

    def add(self, key: str, members: List[Member]) -> Tuple[str, List[int]]:
        """Adds all members of a mesh, next to each other; the tar's name, and where their bytes begin."""
        infos, heads = [], []
        for suffix, data in members:
            info = tarfile.TarInfo("%s.%s" % (key, suffix))  # of no user and no time
            info.size, info.mode = len(data), 0o644
            infos.append(info)
            heads.append(len(info.tobuf(tarfile.PAX_FORMAT)))
        block = tarfile.BLOCKSIZE
        tar = self._need(sum(head - (-info.size // block) * block for head, info in zip(heads, infos)))
        offsets = []
        for head, info, (_, data) in zip(heads, infos, members):
            offsets.append(tar.offset + head)
            tar.addfile(info, io.BytesIO(data))
        return self.tar_name, offsets


def _write_all(records: Records, numbers: List[int], folder: str, make: Any, max_bytes: int) -> Iterator[Dict[str, Any]]:
    tars: Dict[str, _Tars] = {}
    try:
        for item in map(records.__getitem__, numbers):
            members, told = make(records, item)
            name = item.split.replace("/", "_") or "data"
            key = key_of(item)
            here = tars.setdefault(name, _Tars(folder, name, max_bytes))
            tar, offsets = here.add(key, members + [("json", json_line(told))])
            yield dict(told, key=key, tar=tar, members=[{"name": suffix, "offset": offset, "bytes": len(data)}
                                                        for (suffix, data), offset in zip(members, offsets)])
    finally:
        for each in tars.values():
            each.close()


def write(records: Records, path: str, *, max_bytes: int = MAX_BYTES, content: str = "bits",
          shuffle: Optional[int] = None) -> Dict[str, Any]:
    """See `voxmend.batch.export`."""
    _values.whole("export: max_bytes", max_bytes, 1)
    if shuffle is not None:
        _values.whole("export: shuffle", shuffle, 0)
    if content not in ("bits", "files"):
        raise ArgumentError("export: content %r is neither bits nor files" % (content,))
    numbers = (with_grids(records) if content == "bits" else
               [number for number, item in enumerate(records) if item.status in DONE])
    if not numbers:
        raise EmptyError("%s: nothing came of this batch" % records.folder)
    tars = set()
    with published(path, True) as folder, open(os.path.join(folder, "index.jsonl"), "wb") as index:
        order, make = _order(records, numbers, shuffle), _bits if content == "bits" else _files
        for line in _write_all(records, order, folder, make, max_bytes):
            tars.add(line["tar"])
            index.write(json_line(line))
        with open(os.path.join(folder, "classes.json"), "w", encoding="utf-8") as file:
            json.dump(records.classes(), file)
    return {"output": path, "format": "webdataset", "meshes": len(numbers), "tars": len(tars)}
