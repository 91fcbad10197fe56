# SPDX-License-Identifier: BSD-3-Clause
"""The dataset of grids that a batch has made; part of `voxmend.torch`."""
from __future__ import annotations

import os
from typing import Any, Dict, List, Optional, Sequence, Set, Tuple, Union

import numpy
import torch
from torch.utils.data import Dataset

from . import _values
from ._call_lock import CallLock, watch_forks
from ._errors import EmptyError
from ._grid_sources import open_source
from ._left_out import check_on_error, left_out
from ._packed import unpack as unpack_rows
from ._placement import class_numbers, split_as
from ._types import Array


class GridDataset(Dataset):
    """The grids that `voxmend batch` has made: its folder, or an export to webdataset or Zarr (`voxmend batch export`). Of a
    batch without grids (--no-grid --augment) the variants, each an item: its folder, or, of .npy, webdataset with `content`
    "files".

    Numbers are no voxels: a batch of distances, shares, labels or colours raises NumbersError.

    Args:
        root: the folder.
        split: only those of this split, as the plan tells or the folders (chair/train/...); None = all. The words that stand
            for "train", "test" and "val", such as "Training", are one, there and here: doc/datasets.md.
        packed: items are (nx, ny, ceil(nz / 8)) uint8, see `unpack`, rather than (1, nx, ny, nz) float32.

    Attributes:
        classes: sorted names of all that the batch's plan has, in whatever split and whatever became of their meshes, so that
            labels are the same everywhere.
        names: of the meshes, as in the plan; of variants as often as there are some.
        labels: (n,) int64, numbers of the classes; -1 for a mesh without one, such as a file beside the folders of classes.
        shape: (nx, ny, nz)
        groups: (n,) numbers of the tars, or of the chunks, in which the grids are: what is best read together.
    """

    def __init__(self, root: Any, split: Optional[str] = None, *, packed: bool = False):
        self.root = os.fsdecode(_values.path(root))
        self._source = open_source(self.root)
        self.classes: List[str] = list(self._source.classes)
        self.packed = _values.flag("dataset: packed", packed)
        self.shape = self._source.shape
        split = None if split is None else split_as(_values.word("dataset: split", split))
        if split is not None and split not in self._source.splits:
            raise EmptyError("%s: no grid is of the split %r; there are %s" %
                             (self.root, split, sorted(set(self._source.splits))))
        chosen = [i for i, name in enumerate(self._source.splits) if split is None or name == split]
        self._numbers = numpy.array(chosen, numpy.int64)
        self.labels = numpy.array(class_numbers((self._source.kinds[i] for i in chosen), self.classes), numpy.int64)
        self.groups = self._source.groups[self._numbers]
        self._forget()

    def _forget(self) -> None:
        self._call_lock = CallLock()
        self._broken: Set[int] = set()  # grids that are left out
        watch_forks(self)

    def _after_fork(self) -> None:
        if self._call_lock.is_taken():  # by a thread that is not in this process
            self._forget()

    def __getstate__(self) -> Dict[str, Any]:
        state = dict(self.__dict__)
        del state["_call_lock"], state["_broken"]
        return state

    def __setstate__(self, state: Dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._forget()

    def __len__(self) -> int:
        return len(self._numbers)

    @property
    def names(self) -> List[str]:
        return [self._source.names[i] for i in self._numbers]

    def batch(self, items: Union[Sequence[int], Array], epoch: Optional[int] = None,
              on_error: str = "raise") -> Tuple[torch.Tensor, torch.Tensor]:
        """Many at once: voxels (n, 1, nx, ny, nz), or packed, and labels (n,) int64. The epoch makes no difference. With `on_error`
        "skip" they are fewer by those that cannot be read, each told once as VoxmendWarning."""
        skips = check_on_error("dataset", on_error) == "skip"
        at = _values.array("dataset: items", items, "iu", "whole numbers").reshape(-1).astype(numpy.int64)
        if at.size and (at.min() < -len(self) or at.max() >= len(self)):
            raise IndexError("items are from 0 to %d" % (len(self) - 1))
        at = numpy.where(at < 0, at + len(self), at)
        nx, ny, nz = self.shape
        bits = numpy.empty((len(at), nx, ny, (nz + 7) // 8), numpy.uint8)
        made = numpy.ones(len(at), bool)
        with self._call_lock:
            for i, number in enumerate(self._numbers[at].tolist()):
                if not skips:
                    bits[i] = self._source.packed(number)
                elif number not in self._broken:
                    with left_out(self._source.names[number], self._broken, number):
                        bits[i] = self._source.packed(number)
                made[i] = number not in self._broken or not skips
        at, bits = at[made], bits[made] if not made.all() else bits
        voxels = bits if self.packed else unpack_rows(bits, nz)[:, None]
        return torch.from_numpy(voxels), torch.from_numpy(self.labels[at])

    def __getitem__(self, item: int) -> Tuple[torch.Tensor, int]:
        voxels, labels = self.batch([item])
        return voxels[0], int(labels[0])

    def __getitems__(self, items: Sequence[int]) -> List[Tuple[torch.Tensor, int]]:
        """What torch.utils.data.DataLoader asks for, if it knows of it, rather than for items one by one."""
        voxels, labels = self.batch(items)
        return list(zip(voxels, labels.tolist()))


def order_by_groups(groups: Array, together: int, draw: numpy.random.Generator) -> Array:
    """Groups in an order that is drawn, so many at a time with their members mixed: near enough to a shuffle of all, and
    each tar or chunk is read in one go."""
    order = numpy.argsort(groups, kind="stable")
    begins = numpy.flatnonzero(numpy.diff(groups[order], prepend=groups[order][:1] - 1))
    members = numpy.split(order, begins[1:])
    drawn = draw.permutation(len(members))
    parts = []
    for begin in range(0, len(drawn), together):
        mixed = numpy.concatenate([members[g] for g in drawn[begin:begin + together]])
        parts.append(mixed[draw.permutation(len(mixed))])
    return numpy.concatenate(parts) if parts else order
