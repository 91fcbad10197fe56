# SPDX-License-Identifier: BSD-3-Clause
"""Whole datasets: `voxmend batch` on many machines by Dask, and what comes out of it in other forms.

    import voxmend.batch
    voxmend.batch.run("ModelNet40", "grids", dask="tcp://node1:8786", shards=64, options=["-r", "64"])
    voxmend.batch.export("grids", "tars", to="webdataset")

    python3 -m voxmend.batch ModelNet40 -o grids --dask local:2 --shards 16 -- -r 64
    python3 -m voxmend.batch export grids --to webdataset -o tars

All machines have to see the inputs and the folder of outputs under the same names. Each shard is a run of `voxmend batch`,
whose journal makes it harmless that one is run twice; whatever dies, the same call goes on.
"""
from __future__ import annotations

import json
import os
import shlex
import sys
from typing import Any, Callable, Dict, Iterable, List, Optional, Sequence, Union

from . import _batch_program, _values
from ._batch_dask import BatchError, run_shards
from ._batch_records import Item, Records
from ._errors import ArgumentError, VoxmendError

__all__ = ["BatchError", "Item", "Records", "export", "run"]

_KINDS = ("parquet", "webdataset", "zarr")
_SHARDS = 16
_TAKEN = ("-o", "--output", "--shard", "-j", "--jobs", "--progress")


def _tell(line: str) -> None:
    print("voxmend.batch: " + line, file=sys.stderr, flush=True)


def _words(options: Union[str, Iterable[str]]) -> List[str]:
    words = shlex.split(options) if isinstance(options, str) else [_values.word("batch: an option", w) for w in options]
    for word in words:
        if word.split("=")[0] in _TAKEN or word[:2] in ("-o", "-j"):
            raise ArgumentError("batch: the option %s is an argument of its own here; leave it out of the options" % word)
    return words


def _frozen_shards(output: str) -> Optional[int]:
    try:
        with open(os.path.join(output, ".batch", "run.json"), encoding="utf-8") as file:
            return int(json.load(file)["shards"])
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _run_here(shard: int, arguments: Dict[str, Any]) -> None:
    result = _batch_program.run_shard(shard, **dict(arguments, jobs=arguments["jobs"] or len(os.sched_getaffinity(0))))
    if result["rc"] == _batch_program.WRONG_USAGE:
        raise ArgumentError("batch: " + result["line"])
    if result["rc"] != 0:
        raise BatchError("batch: shard %d did not come to its end: %s" %
                         (shard, result["line"] or "signal %d" % -result["rc"]))


def run(inputs: Any, output: Any, *, shards: Optional[int] = None, dask: Any = None, jobs: Optional[int] = None,
        options: Union[str, Iterable[str]] = (), program: Any = None, retries: int = 3,
        tell: Optional[Callable[[str], None]] = None) -> Dict[str, Any]:
    """Makes grids, or what else the options ask for, of all meshes of the inputs; goes on with what was begun.

    Args:
        inputs: a folder, file, pattern, list, table or archive, or several of them; see `voxmend batch --help`.
        output: folder of what is made.
        shards: into how many the meshes are divided; None = as the batch began, else 16 (1 without `dask`). Some for each
            worker let them end together.
        dask: "local" or "local:WORKERS", a scheduler's address such as "tcp://node1:8786" or file (.json), a
            `distributed.Client`; None = here, one shard after another.
        jobs: meshes at a time for each shard; None = the worker's share of its machine's processors. Give workers one
            thread each (`dask worker --nthreads 1`): the program uses the processors.
        options: those of `voxmend batch`, as words or as one text: ["-r", "64"] or "-r 64".
        program: path of the program voxmend, which has to be of the package's version; None = beside the package, or on
            the PATH of each worker.
        retries: how often a shard is tried again that failed, or whose worker died; one that fails twice in the same way
            is given up.
        tell: called with a line for each shard that ends; None = they go to standard error.

    Returns:
        the content of summary.json: counts by status, times, bytes.

    Raises:
        BatchError: shards did not come to their end; the same call goes on.
        ArgumentError: the options are wrong.
    """
    names = [os.fsdecode(_values.path(name)) for name in (inputs if isinstance(inputs, (list, tuple)) else [inputs])]
    if not names or "-" in names:
        raise ArgumentError("batch: %s" % ("a list on standard input is not for workers; name a file" if names else
                                           "no inputs are named"))
    folder = os.fsdecode(_values.path(output))
    if shards is None:
        shards = _frozen_shards(folder) or (1 if dask is None else _SHARDS)
    arguments: Dict[str, Any] = {
        "shards": _values.whole("batch: shards", shards, 1, 1000000), "inputs": names, "output": folder,
        "options": _words(options), "folder": os.getcwd(),
        "jobs": None if jobs is None else _values.whole("batch: jobs", jobs, 1, 512),
        "program": None if program is None else _batch_program.find_program(program)}
    _values.whole("batch: retries", retries, 0)
    if dask is not None:
        run_shards(dask, arguments, retries, tell or _tell)
    else:
        for shard in range(arguments["shards"]):
            _run_here(shard, arguments)
    summary = os.path.join(folder, "summary.json")
    if not os.path.exists(summary):  # shards that ended at once may not have seen each other's end
        _run_here(0, arguments)
    with open(summary, encoding="utf-8") as file:
        out: Dict[str, Any] = json.load(file)
        return out


def export(folder: Any, path: Any, *, to: str, **options: Any) -> Dict[str, Any]:
    """Writes a complete batch in another form: a table of its meshes, or its grids for training.

    Args:
        folder: that of the batch.
        path: what is written, which must not be there: a file for "parquet", else a folder.
        to: "parquet", "webdataset" or "zarr".
        options: of webdataset: `max_bytes` of a tar (268435456), `content` "bits" (grids, eight voxels a byte) or "files"
            (all that was made, as it is; variants are files of their mesh), `shuffle` (a seed that decides about the order; None = that of the plan); of
            zarr: `zarr_format` (2 or 3; None = what the zarr package prefers), `chunk_bytes` (4194304), `split`.

    Returns:
        {"output", "format", "meshes"} and what else there is to tell.
    """
    if to not in _KINDS:
        raise ArgumentError("export: %r is none of %s" % (to, ", ".join(_KINDS)))
    name = os.fsdecode(_values.path(path))
    if os.path.lexists(name):
        raise ArgumentError("export: %s is there already" % name)
    records = Records(os.fsdecode(_values.path(folder)))
    records.need_complete()
    write: Callable[..., Dict[str, Any]]
    if to == "parquet":
        from ._export_parquet import write
    elif to == "webdataset":
        from ._export_webdataset import write
    else:
        from ._export_zarr import write
    return write(records, name, **options)


# ---- Command line ----

def main(words: Optional[Sequence[str]] = None) -> int:
    """`python3 -m voxmend.batch`: exit status 0 = done, 1 = failed, with a line, 2 = wrong usage."""
    from ._batch_command import read_arguments
    try:
        called, arguments = read_arguments(list(sys.argv[1:] if words is None else words))
        result = run(**arguments) if called == "run" else export(**arguments)
        print(json.dumps(result, indent=2, sort_keys=True))
        return 0
    except KeyboardInterrupt:
        print("voxmend.batch: interrupted; the same command goes on", file=sys.stderr)
        return 130
    except (VoxmendError, OSError) as problem:
        print("voxmend.batch: %s" % problem, file=sys.stderr)
        return 1


if __name__ == "__main__":
    from voxmend.batch import main as _main  # whose classes are those of the package, not of __main__
    sys.exit(_main())
