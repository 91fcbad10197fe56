# SPDX-License-Identifier: BSD-3-Clause
"""What exports share: the grids of a batch, what is told beside each, and names that appear when all is there."""
from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import os
import shutil
from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy

from ._batch_records import GRIDS, Item, Records
from ._errors import EmptyError, FormatError, NumbersError, file_error
from ._grid import read
from ._packed import pack
from ._types import Array


def _need_folder(path: str) -> None:
    """That in which it is to be written; its own name says what is wrong, not one that it has until then."""
    folder = os.path.dirname(os.path.abspath(path))
    if not os.path.isdir(folder):
        number = errno.ENOTDIR if os.path.lexists(folder) else errno.ENOENT
        raise file_error("%s: there is no folder %s to write it in; make that first" % (path, folder), number, os.fsencode(path), path)
    if not os.access(folder, os.W_OK | os.X_OK):
        raise file_error("%s: the folder %s may not be written to" % (path, folder), errno.EACCES, os.fsencode(path), path)


@contextlib.contextmanager
def published(path: str, is_folder: bool) -> Iterator[str]:
    """A name to write to, which becomes `path` at the end; nothing is left of it after a failure."""
    _need_folder(path)
    aside = "%s.%d.tmp" % (path.rstrip("/"), os.getpid())
    try:
        if is_folder:
            os.mkdir(aside)
        yield aside
        os.rename(aside, path)
    except BaseException:
        if os.path.isdir(aside):
            shutil.rmtree(aside, ignore_errors=True)
        else:
            with contextlib.suppress(OSError):
                os.unlink(aside)
        raise


def is_folder(output: Dict[str, Any]) -> bool:
    return "files" in output


def _read(path: str) -> Tuple[bytes, str]:
    """The bytes of a file, and their SHA-256."""
    with open(path, "rb") as file:
        data = file.read()
    return data, hashlib.sha256(data).hexdigest()


def _need_digest(records: Records, output: Dict[str, Any], digest: str) -> None:
    if digest != output["sha256"]:
        raise FormatError("%s: not as it was written; see 'voxmend batch verify %s'" % (records.path(output), records.folder))


def content(records: Records, output: Dict[str, Any]) -> bytes:
    """The bytes of an output, if they are those that the journal tells of."""
    data, digest = _read(records.path(output))
    _need_digest(records, output, digest)
    return data


def folder_content(records: Records, output: Dict[str, Any]) -> List[Tuple[str, bytes]]:
    """Names and bytes of the files of an output that is a folder, if they are those that the journal tells of."""
    path, files, told = records.path(output), [], hashlib.sha256()
    for name in sorted(os.listdir(path), key=os.fsencode):
        if os.path.isfile(os.path.join(path, name)):
            data, digest = _read(os.path.join(path, name))
            told.update(b"%s %s\n" % (os.fsencode(name), digest.encode()))
            files.append((name, data))
    _need_digest(records, output, told.hexdigest())
    return files


def need_voxels(values: Optional[str], folder: str, item: str) -> None:
    """Refuses what holds other numbers, as `Item.values` tells them."""
    if values is not None:
        raise NumbersError("%s: of %s it holds numbers (%s), not set and clear voxels; voxmend.read_field reads them in the "
                           "folder of the batch" % (folder, item, values))


def with_grids(records: Records) -> List[int]:
    """Numbers of those of which there is a grid, in the order of the plan."""
    out = []
    for number, item in enumerate(records):
        if item.grid() is not None:
            need_voxels(item.values, records.folder, item.item)
            out.append(number)
    if not out and any(item.variant_count for item in records):
        raise EmptyError("%s: this batch has no grids (--no-grid), but variants, which GridDataset reads in its folder, and "
                         "'export --to webdataset --content files' takes" % records.folder)
    if not out:
        raise EmptyError("%s: no mesh of this batch has a grid that can be read (%s)" % (records.folder, " ".join(GRIDS)))
    return out


def describe(item: Item) -> Dict[str, Any]:
    """What is told beside a grid: the same for the same mesh and options, whenever they were run. `values` stands there where
    it holds no voxels."""
    made = item.end.get("voxelize", {})
    grid = made.get("grid", {})
    shape = grid.get("dims")
    if shape is None and item.variant_count:  # of each of them
        shape = [item.end["augment"]["resolution"]] * 3
    numbers = {} if item.values is None else {"values": item.values}
    return {"item": item.item, "class": item.kind, "split": item.split, "status": item.status,
            "shape": shape, "origin": grid.get("origin"), "voxel_size": grid.get("voxel_size"),
            "voxels": made.get("voxels"), "hash": made.get("hash"), "mesh_sha256": item.end.get("sha256"), **numbers}


def packed_grid(records: Records, item: Item, verify: bool = True) -> Tuple[Array, Dict[str, Any]]:
    """A grid's bits, (nx, ny, ceil(nz / 8)) uint8, and what is told of it."""
    output = item.grid()
    assert output is not None
    if verify:
        (folder_content if is_folder(output) else content)(records, output)
    told = describe(item)
    matrix = read(records.path(output)).matrix
    if told["shape"] is None or list(matrix.shape) != list(told["shape"]):  # .binvox pads to a cube
        shape = told["shape"]
        if shape is None or any(a < b for a, b in zip(matrix.shape, shape)):
            raise FormatError("%s: a grid of %s, not of %s as its batch tells" % (records.path(output), matrix.shape, shape))
        matrix = matrix[tuple(slice(0, n) for n in shape)]
    return pack(matrix), told


def json_line(value: Dict[str, Any]) -> bytes:
    return json.dumps(value, sort_keys=True, ensure_ascii=False, separators=(",", ":")).encode() + b"\n"
