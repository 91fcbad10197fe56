# SPDX-License-Identifier: BSD-3-Clause
"""A Zarr group of all grids: `grids` (n, nx, ny, ceil(nz / 8)) uint8, `origin` and `voxel_size` (n, 3), `label` (n,), and
items.jsonl beside them, a line for each grid in their order."""
from __future__ import annotations

import os
from typing import Any, Dict, List, Optional, Tuple

import numpy

from . import _values
from ._batch_records import Records
from ._errors import ArgumentError, EmptyError, UnavailableError
from ._export_common import describe, json_line, packed_grid, published, with_grids
from ._placement import class_numbers, split_as
from ._types import Array

CHUNK_BYTES = 4 << 20


def _zarr() -> Any:
    try:
        import zarr
    except ImportError:
        raise UnavailableError("export: the package zarr is not installed (Debian: python3-zarr; PyPI: zarr)") from None
    return zarr


def _group(zarr: Any, path: str, version: Optional[int]) -> Any:
    if hasattr(zarr.Group, "create_array"):
        return zarr.open_group(path, mode="w", zarr_format=version or 3)
    if version == 3:
        raise UnavailableError("export: zarr %s writes version 2 of the format only" % zarr.__version__)
    return zarr.open_group(path, mode="w")


def _array(group: Any, name: str, shape: Tuple[int, ...], chunks: Tuple[int, ...], dtype: str) -> Any:
    create = group.create_array if hasattr(group, "create_array") else group.create_dataset
    return create(name, shape=shape, chunks=chunks, dtype=dtype)


def _common_shape(records: Records, numbers: List[int]) -> List[int]:
    """That of all grids."""
    first = describe(records[numbers[0]])
    for number in numbers:
        other = describe(records[number])
        if other["shape"] != first["shape"]:
            raise ArgumentError("%s: %s has a grid of %s, %s one of %s, and an array needs the same for all: make them with "
                                "--fit cube, or export to webdataset" %
                                (records.folder, first["item"], first["shape"], other["item"], other["shape"]))
    shape: List[int] = first["shape"]
    return shape


def _fill(records: Records, numbers: List[int], group: Any, classes: List[str], row: Tuple[int, ...], each: int) -> None:
    """Chunk by chunk: each is written once."""
    count = len(numbers)
    grids = _array(group, "grids", (count,) + row, (each,) + row, "u1")
    origins, sizes = numpy.empty((count, 3)), numpy.empty((count, 3))
    labels = numpy.empty(count, numpy.int32)
    for begin in range(0, count, each):
        some = numbers[begin:begin + each]
        chunk = numpy.empty((len(some),) + row, numpy.uint8)
        for i, number in enumerate(some):
            item = records[number]
            chunk[i], told = packed_grid(records, item)
            origins[begin + i], sizes[begin + i] = told["origin"], told["voxel_size"]
            labels[begin + i] = class_numbers([item.kind], classes)[0]
        grids[begin:begin + len(some)] = chunk
    others: List[Tuple[str, Array]] = [("origin", origins), ("voxel_size", sizes), ("label", labels)]
    for name, values in others:
        _array(group, name, values.shape, (min(count, 65536),) + values.shape[1:], values.dtype.str)[...] = values


def write(records: Records, path: str, *, split: Optional[str] = None, chunk_bytes: int = CHUNK_BYTES,
          zarr_format: Optional[int] = None) -> Dict[str, Any]:
    """See `voxmend.batch.export`."""
    _values.whole("export: chunk_bytes", chunk_bytes, 1)
    wanted = None if split is None else split_as(_values.word("export: split", split))
    zarr, everything = _zarr(), with_grids(records)
    classes = records.classes()
    numbers = [number for number in everything if wanted in (None, records[number].split)]
    if not numbers:
        raise EmptyError("%s: no mesh is of the split %r" % (records.folder, split))
    shape = _common_shape(records, numbers)
    row = (shape[0], shape[1], (shape[2] + 7) // 8)
    each = min(len(numbers), max(1, chunk_bytes // (row[0] * row[1] * row[2])))
    with published(path, True) as folder:
        group = _group(zarr, folder, zarr_format)
        _fill(records, numbers, group, classes, row, each)
        group.attrs.update({"format": "voxmend grids", "version": 1, "shape": shape, "bit_order": "little", "axes":
                            ["grid", "x", "y", "z, eight voxels a byte"], "classes": classes,
                            "voxmend": records.run["voxmend"], "settings": records.run["settings"]})
        with open(os.path.join(folder, "items.jsonl"), "wb") as file:
            for number in numbers:
                file.write(json_line(describe(records[number])))
    return {"output": path, "format": "zarr", "meshes": len(numbers), "chunk_grids": each}
