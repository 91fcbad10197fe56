# SPDX-License-Identifier: BSD-3-Clause
"""A Parquet table with a row for each mesh of a batch, done or not, by pyarrow."""
from __future__ import annotations

import json
from typing import Any, Dict, List

from ._batch_records import Item, Records
from ._errors import UnavailableError
from ._export_common import published

ROWS = 65536  # of a group


def _pyarrow() -> Any:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as problem:
        raise UnavailableError("export: pyarrow is not installed, or not for this Python (PyPI: pyarrow): %s" %
                               problem) from None
    return pyarrow


def _schema(arrow: Any, records: Records) -> Any:
    text, whole, real, vector = arrow.string(), arrow.int64(), arrow.float64(), arrow.list_(arrow.float64(), 3)
    outputs = arrow.list_(arrow.struct([("path", text), ("bytes", whole), ("sha256", text)]))
    columns = [("item", text), ("path", text), ("member", text), ("class", text), ("split", text), ("bytes", whole),
               ("sha256", text), ("shard", arrow.int32()), ("attempt", arrow.int32()), ("status", text), ("stage", text),
               ("code", text), ("message", text), ("signal", text), ("duplicate_of", text),
               ("warnings", arrow.list_(text)), ("shape", arrow.list_(arrow.int32(), 3)), ("origin", vector),
               ("voxel_size", vector), ("voxels", whole), ("hash", text), ("parts", whole), ("contested", whole),
               ("thin_share", real), ("outputs", outputs), ("wall_ms", real), ("cpu_ms", real), ("peak_bytes", whole),
               ("record", text)]
    told = {"voxmend": json.dumps({name: records.run.get(name) for name in ("voxmend", "began", "settings", "plan_sha256")})}
    return arrow.schema(columns, metadata=told)


def _row(item: Item) -> Dict[str, Any]:
    end, made = item.end, item.end.get("voxelize", {})
    grid = made.get("grid", {})
    signal = end.get("signal")
    return {
        "item": item.item, "path": item.plan.get("path"), "member": item.plan.get("member"), "class": item.kind or None,
        "split": item.split or None, "bytes": item.plan.get("bytes"), "sha256": end.get("sha256"),
        "shard": item.shard if item.shard >= 0 else None, "attempt": end.get("attempt"), "status": item.status,
        "stage": end.get("stage"), "code": end.get("code"), "message": end.get("message", end.get("last_words")),
        "signal": None if signal is None else str(signal), "duplicate_of": end.get("duplicate_of"),
        "warnings": end.get("warnings"), "shape": grid.get("dims"), "origin": grid.get("origin"),
        "voxel_size": grid.get("voxel_size"), "voxels": made.get("voxels"), "hash": made.get("hash"),
        "parts": made.get("parts"), "contested": made.get("votes", {}).get("contested"),
        "thin_share": made.get("thin", {}).get("share"),
        "outputs": [{name: output.get(name) for name in ("path", "bytes", "sha256")} for output in end.get("outputs", ())],
        "wall_ms": end.get("wall_ms"), "cpu_ms": end.get("cpu_ms"), "peak_bytes": end.get("peak_bytes"),
        "record": json.dumps(end, sort_keys=True, ensure_ascii=False) if end else None}


def write(records: Records, path: str) -> Dict[str, Any]:
    """See `voxmend.batch.export`."""
    arrow = _pyarrow()
    schema, count = _schema(arrow, records), 0
    rows: List[Dict[str, Any]] = []
    with published(path, False) as aside, arrow.parquet.ParquetWriter(aside, schema, compression="zstd") as writer:
        for item in records:
            rows.append(_row(item))
            count += 1
            if len(rows) == ROWS:
                writer.write_table(arrow.Table.from_pylist(rows, schema))
                rows.clear()
        if rows or count == 0:
            writer.write_table(arrow.Table.from_pylist(rows, schema))
    return {"output": path, "format": "parquet", "meshes": count}
