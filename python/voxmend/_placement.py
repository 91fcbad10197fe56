# SPDX-License-Identifier: BSD-3-Clause
"""Classes and splits of meshes, as the names of their folders tell them. src/batch/placement.c has the same rules."""
from __future__ import annotations

from typing import Iterable, List, Optional, Tuple

_SPLITS = {"train": "train", "training": "train", "test": "test", "testing": "test",
           "val": "val", "valid": "val", "validation": "val", "validate": "val"}


def split_named(word: str) -> Optional[str]:
    """"train", "test" or "val" for the words that stand for one of them, in any case; None for others."""
    return _SPLITS.get(word.lower())


def split_as(word: str) -> str:
    """The name of a split: other words are names of their own."""
    return split_named(word) or word


def class_names(kinds: Iterable[str]) -> List[str]:
    """The classes of a dataset, whose places are their numbers. A mesh beside the folders of classes has none, and moves none."""
    return sorted(set(kinds) - {""})


def class_numbers(kinds: Iterable[str], classes: List[str]) -> List[int]:
    """The number of each, -1 for what has no class. Exports by older versions have "" among the classes: so it is there."""
    numbers = {name: number for number, name in enumerate(classes)}
    return [numbers[kind] if kind else numbers.get(kind, -1) for kind in kinds]


def place(name: str) -> Tuple[str, str]:
    """Class and split, each "" if it is not told: chair/train/chair_0001.off as in ModelNet, train/chair/1.off as well."""
    folders = name.split("/")[:-1]
    if folders and split_named(folders[-1]):
        folders = folders[-2:]  # also data/ModelNet40/chair/train/1.off
    kind = next((folder for folder in folders if not split_named(folder) and folder not in ("", ".", "..")), "")
    split = next((folder for folder in folders[:2] if split_named(folder)), "")
    return kind, split_as(split)
