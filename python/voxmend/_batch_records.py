# SPDX-License-Identifier: BSD-3-Clause
"""What the folder of a batch tells: its plan, and what its journals say became of each mesh."""
from __future__ import annotations

import hashlib
import json
import os
from array import array
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Tuple

from ._errors import ArgumentError, FormatError
from ._placement import class_names, place, split_as

GRIDS = (".binvox", ".npy", ".raw", ".rle", ".nrrd", ".vdb", ".octree", ".bt", ".nii", ".nii.gz", ".vti", ".vtk", ".tif", ".h5",
         ".vox", ".schem", ".litematic", ".zarr")
DONE = ("ok", "degraded", "duplicate")
_HEAD, _SUM, _TAIL = b'{"sum":"', 16, b'",'
_REST = len(_HEAD) + _SUM + len(_TAIL)


def is_whole(line: bytes) -> bool:
    """Whether a line of a journal, without its end, is as it was written."""
    return (len(line) > _REST and line.startswith(_HEAD) and
            hashlib.sha256(line[_REST:]).hexdigest()[:_SUM].encode() == line[len(_HEAD):len(_HEAD) + _SUM])


class Item(NamedTuple):
    """A mesh of the plan, and its last record; `end` is {} where it is still to be done."""
    item: str
    kind: str
    split: str
    plan: Dict[str, Any]
    end: Dict[str, Any]
    shard: int

    @property
    def status(self) -> str:
        return str(self.end.get("status", "pending"))

    def grid(self) -> Optional[Dict[str, Any]]:
        """The output that is a grid: {path, bytes, sha256}; None where there is none."""
        wanted = [self.plan["output"] + extension for extension in GRIDS]
        for output in self.end.get("outputs", ()) if self.status in DONE else ():
            if output["path"] in wanted:
                return dict(output)
        return None

    @property
    def values(self) -> Optional[str]:
        """What the numbers are that were made in place of set and clear voxels: of its grid, or of its variants where there is
        none; None = they are voxels."""
        has_grid = self.grid() is not None
        made = self.end.get("voxelize" if has_grid else "augment", {})
        return next((kind for kind in ("distance", "coverage", "labels", "color") if kind in made), None)

    @property
    def variant_count(self) -> int:
        """How many variants were made of it (--augment)."""
        folder = self.plan["output"] + ".variants"
        is_there = any(output["path"] == folder for output in self.end.get("outputs", ()) if self.status in DONE)
        return int(self.end.get("augment", {}).get("variants", 0)) if is_there else 0

    def variant(self, index: int) -> Dict[str, Any]:
        """The output that is one of them, from 0 on: {path}."""
        made = self.end["augment"]
        return {"path": "%s.variants/%06d.%s" % (self.plan["output"], made["first"] + index, made["format"])}


def _place(plan: Dict[str, Any]) -> Tuple[str, str]:
    """Class and split: what the plan tells, or else the folders."""
    kind, split = place(plan["item"])
    return str(plan.get("class", kind)), split_as(str(plan.get("split", split)))


class Records:
    """The meshes of a batch in the order of its plan. Plan and journals are read once, for where each mesh's lines stand, so
    that a million of them take little memory: `records[i]` reads those of one.

    Args:
        folder: what -o named.
    """

    def __init__(self, folder: str):
        self.folder = folder
        path = self._at("run.json")
        try:
            with open(path, encoding="utf-8") as file:
                self.run: Dict[str, Any] = json.load(file)
            self.shards = int(self.run["shards"])
        except FileNotFoundError:
            raise ArgumentError("%s: there is no batch in this folder" % folder) from None
        except (ValueError, KeyError, TypeError):
            raise FormatError("%s: the plan is damaged" % path) from None
        self.complete = 0  # shards at their end
        self.damaged = 0  # lines of journals that are not as they were written
        self._files: Dict[int, Any] = {}  # -1: the plan; else a shard's journal
        self._process = os.getpid()  # whose files these are: after a fork both would move one position
        self._plan, self._shard, self._end = array("q"), array("i"), array("q")  # where the lines begin
        numbers = self._scan_plan()
        for shard in range(self.shards):
            if os.path.exists(self.journal(shard)):
                self._scan(shard, numbers)

    def _at(self, name: str) -> str:
        return os.path.join(self.folder, ".batch", name)

    def journal(self, shard: int) -> str:
        return self._at("journal-%d-of-%d.jsonl" % (shard, self.shards))

    def _scan_plan(self) -> Dict[str, int]:
        numbers: Dict[str, int] = {}
        at = 0
        with open(self._at("plan.jsonl"), "rb") as file:
            for line in file:
                numbers[json.loads(line)["item"]] = len(self._plan)
                self._plan.append(at)
                self._shard.append(-1)
                self._end.append(0)
                at += len(line)
        return numbers

    def _scan(self, shard: int, numbers: Dict[str, int]) -> None:
        at, is_complete, bad = 0, False, 0
        with open(self.journal(shard), "rb") as file:
            for line in file:
                if line.endswith(b"\n") and is_whole(line[:-1]):
                    self.damaged, bad = self.damaged + bad, 0
                    record = json.loads(line)
                    event = record.get("event")
                    if event in ("end", "changed") and record["item"] in numbers:  # changed: pending again
                        self._shard[numbers[record["item"]]], self._end[numbers[record["item"]]] = shard, at
                    if event in ("begin", "complete", "changed"):
                        is_complete = event == "complete"
                else:
                    bad += 1  # those at the very end are being written
                at += len(line)
        self.complete += is_complete

    def need_complete(self) -> None:
        """Refuses a batch of which something is still to be done: what is made of it would lack that without a word."""
        if self.complete < self.shards:
            raise ArgumentError("%s: %d of %d shards are at their end; run the batch to its end first" %
                                (self.folder, self.complete, self.shards))

    def _line(self, file: int, at: int) -> Dict[str, Any]:
        if self._process != os.getpid():
            self.close()
            self._process = os.getpid()
        if file not in self._files:
            self._files[file] = open(self._at("plan.jsonl") if file < 0 else self.journal(file), "rb")
        self._files[file].seek(at)
        out: Dict[str, Any] = json.loads(self._files[file].readline())
        return out

    def classes(self) -> List[str]:
        """Sorted names of all classes of the plan, whatever became of their meshes: their numbers depend on nothing else."""
        return class_names(_place(self._line(-1, at))[0] for at in self._plan)

    def __len__(self) -> int:
        return len(self._plan)

    def __getitem__(self, number: int) -> Item:
        plan, shard = self._line(-1, self._plan[number]), self._shard[number]
        kind, split = _place(plan)
        return Item(plan["item"], kind, split, plan, self._line(shard, self._end[number]) if shard >= 0 else {}, shard)

    def __iter__(self) -> Iterator[Item]:
        for number in range(len(self)):
            yield self[number]

    def close(self) -> None:
        """Files are opened again when they are needed."""
        for file in self._files.values():
            file.close()
        self._files = {}

    def __del__(self) -> None:
        for file in getattr(self, "_files", {}).values():
            file.close()

    def __getstate__(self) -> Dict[str, Any]:
        return dict(self.__dict__, _files={})  # of this process

    def path(self, output: Dict[str, Any]) -> str:
        return os.path.join(self.folder, output["path"])
