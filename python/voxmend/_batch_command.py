# SPDX-License-Identifier: BSD-3-Clause
"""The words of `python3 -m voxmend.batch`."""
from __future__ import annotations

import argparse
from typing import Any, Dict, List, Tuple

_EXAMPLES = """examples:
  python3 -m voxmend.batch ModelNet40 -o grids --dask local:2 --shards 16 -- -r 64
  python3 -m voxmend.batch ModelNet40 -o grids --dask tcp://node1:8786 --shards 256 -- -r 64 --format npy
  python3 -m voxmend.batch export grids --to webdataset -o tars
"""


def _run_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python3 -m voxmend.batch", epilog=_EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     description="Runs 'voxmend batch' on many machines by Dask, a shard a task. What "
                                     "follows -- are its options. The same command goes on with what was interrupted. "
                                     "'export' as the first word writes what was made in another form.")
    parser.add_argument("inputs", nargs="+", metavar="INPUT", help="folder, file, pattern, list, table or archive")
    parser.add_argument("-o", "--output", required=True, metavar="DIR", help="folder of what is made")
    parser.add_argument("--dask", metavar="ADDRESS|local[:WORKERS]", default=None,
                        help="scheduler, by its address or its file (.json), or workers on this machine; without it all is done here, without Dask")
    parser.add_argument("--shards", type=int, metavar="N", default=None,
                        help="into how many the meshes are divided [as it began, or 16]")
    parser.add_argument("-j", "--jobs", type=int, metavar="N", default=None,
                        help="meshes at a time for each shard [a worker's share of the processors]")
    parser.add_argument("--program", metavar="PATH", default=None, help="the program voxmend")
    parser.add_argument("--retries", type=int, metavar="N", default=3, help="tries more for a shard that fails [3]")
    return parser


def _export_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python3 -m voxmend.batch export", description="Writes a batch in another form.")
    parser.add_argument("folder", metavar="DIR", help="folder of the batch")
    parser.add_argument("--to", required=True, choices=("parquet", "webdataset", "zarr"))
    parser.add_argument("-o", "--output", required=True, dest="path", metavar="PATH", help="file, or folder, that is written")
    parser.add_argument("--max-bytes", type=int, metavar="N", help="webdataset: of a tar [268435456]")
    parser.add_argument("--content", choices=("bits", "files"),
                        help="webdataset: grids with eight voxels a byte, or all files as they are [bits]")
    parser.add_argument("--shuffle", type=int, metavar="SEED", help="webdataset: meshes in an order drawn by this seed")
    parser.add_argument("--split", metavar="NAME", help="zarr: only the meshes of this split")
    parser.add_argument("--chunk-bytes", type=int, metavar="N", help="zarr: of a chunk of grids [4194304]")
    parser.add_argument("--zarr-format", type=int, choices=(2, 3), help="zarr: version of the format")
    return parser


_OWN = {"parquet": (), "webdataset": ("max_bytes", "content", "shuffle"), "zarr": ("split", "chunk_bytes", "zarr_format")}


def read_arguments(words: List[str]) -> Tuple[str, Dict[str, Any]]:
    """"run" or "export", and its arguments; ends the program where the words are wrong, with status 2."""
    if words[:1] == ["export"]:
        parser = _export_parser()
        given = {name: value for name, value in vars(parser.parse_args(words[1:])).items() if value is not None}
        for name in sorted(set(given) - {"folder", "to", "path", *_OWN[given["to"]]}):
            parser.error("--%s is not for --to %s" % (name.replace("_", "-"), given["to"]))
        return "export", given
    at = words.index("--") if "--" in words else len(words)
    arguments = vars(_run_parser().parse_args(words[:at]))
    return "run", dict(arguments, options=words[at + 1:])
