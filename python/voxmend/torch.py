# SPDX-License-Identifier: BSD-3-Clause
"""Datasets for PyTorch: variants of the meshes of a folder, made when they are asked for, and grids that a batch has made.

    from voxmend.torch import GridDataset, IterableVoxelDataset, VoxelDataset
    data = VoxelDataset("ModelNet10", "train", 32, rotate="z", scale=0.3, displace=0.01)
    for voxels, labels in IterableVoxelDataset(data, batch_size=32, epochs=10):
        ...                                      # (32, 1, 32, 32, 32) float32 and (32,) int64
    data = GridDataset("grids", "train")         # of voxmend batch, or its tars or Zarr
"""
from __future__ import annotations

import collections
import hashlib
import os
import queue
import threading
import time
from typing import Any, Dict, Iterator, List, Optional, Sequence, Set, Tuple, Union

import numpy
import torch
from torch.utils.data import Dataset, IterableDataset, get_worker_info

from . import __version__, _core, _values
from ._call_lock import CallLock, watch_forks
from ._core import ffi
from ._errors import ArgumentError, EmptyError
from ._grid_dataset import GridDataset, order_by_groups
from ._left_out import check_on_error, left_out
from ._mesh import Mesh
from ._mesh_sources import load
from ._placement import class_names, place, split_named
from ._repair import repair
from ._sampler import Sampler
from ._types import Array

__all__ = ["EXTENSIONS", "GridDataset", "IterableVoxelDataset", "VoxelDataset", "unpack"]

EXTENSIONS = (".off", ".obj", ".stl", ".ply", ".glb", ".gltf", ".3mf", ".dae", ".fbx", ".step", ".stp", ".iges", ".igs")


def _is_hidden(name: str) -> bool:
    """What is hidden, and what macOS adds to archives."""
    return name.startswith(".") or name == "__MACOSX"


def _meshes_below(folder: str, prefix: str = "", above: Tuple[Tuple[int, int], ...] = ()) -> Iterator[Tuple[str, str]]:
    """Names from the folder on, and paths, of what `voxmend batch` would take: not what is hidden, or a link to nothing or
    back."""
    state = os.stat(folder)
    here = (state.st_dev, state.st_ino)
    for entry in os.scandir(folder) if here not in above else ():
        if _is_hidden(entry.name):
            continue
        name = prefix + entry.name
        if os.path.isdir(entry.path) if entry.is_symlink() else entry.is_dir():
            yield from _meshes_below(entry.path, name + "/", above + (here,))
        elif name.lower().endswith(EXTENSIONS) and os.path.isfile(entry.path):
            yield name, entry.path


def _is_of(split: Optional[str], where: Tuple[str, str], name: str) -> bool:
    """Whether a mesh, whose class and split are told, is of a split: one that is known, or any folder below the class."""
    if split is None or split_named(split):
        return split is None or split_named(split) == where[1]
    return name.startswith("%s/%s/" % (where[0], split.strip("/")))


class VoxelDataset(Dataset):
    """The meshes of a folder of class folders, as in ModelNet: `root/chair/train/chair_0001.off`; or `root/chair/*.off`, or
    `root/train/chair/*.off`.

    Item i is variant i // models of model i % models, in the present epoch: the same whoever asks for it, in whatever
    process, and another one in each epoch.

    Args:
        root: folder of the class folders; the sorted names of those with a mesh in them, in whatever split, are the classes;
            files beside these folders are left out.
        split: "train", "test", "val", or another word for one of them (doc/datasets.md), in which the folders may be called
            otherwise; or any folder within those of the classes; None = all files of a class.
        resolution: D, voxels along each axis.
        variants: of each model in an epoch.
        packed: items are (D, D, ceil(D / 8)) uint8, see `unpack`, rather than (1, D, D, D) float32.
        seed: of all that is drawn.
        cache: folder for repaired meshes, so that they are repaired once only; None = repaired in each process.
        memory: bytes of models to keep at once in each process, more or less.
        level: how far meshes are repaired.
        on_error: "raise"; "skip": batches are smaller by the items of meshes that cannot be read or made, each told once as
            VoxmendWarning. An item that is asked for by itself raises all the same.
        augment: the other options of `voxmend.Sampler`.
    """

    def __init__(self, root: Any, split: Optional[str] = None, resolution: int = 32, *, variants: int = 1,
                 packed: bool = False, seed: int = 0, cache: Any = None, memory: int = 1 << 30, level: str = "clean",
                 on_error: str = "raise", **augment: Any):
        self.root = os.fsdecode(_values.path(root))
        split = None if split is None else _values.word("dataset: split", split)
        for name, value, least in (("resolution", resolution, 1), ("variants", variants, 0), ("memory", memory, 0)):
            _values.whole("dataset: " + name, value, least)
        found = [(place(name), name, path) for name, path in _meshes_below(self.root)]
        self.classes = class_names(kind for (kind, _), _, _ in found)
        numbers = {name: label for label, name in enumerate(self.classes)}
        chosen = sorted((numbers[where[0]], path) for where, name, path in found if where[0] and _is_of(split, where, name))
        self.files: List[str] = [path for _, path in chosen]
        self.labels: List[int] = [label for label, _ in chosen]
        if not chosen:
            raise EmptyError("%s: no mesh in class folders%s" % (self.root, "" if split is None else
                             ", of the split %r; there are %s" % (split, sorted({where[1] for where, _, _ in found if where[1]}))))
        self.resolution, self.variants, self.packed, self.level = resolution, variants, packed, level
        self.cache = None if cache is None else os.fspath(cache)
        self.memory = memory
        self.on_error = check_on_error("dataset", on_error)
        self._options = dict(augment, resolution=resolution, seed=seed)
        self._epoch = torch.zeros(1, dtype=torch.int64).share_memory_()  # workers that run already see it too
        self._forget()
        Sampler(**self._options)  # wrong options are told now, not by a worker

    def _forget(self) -> None:
        self._sampler: Optional[Sampler] = None
        self._held: "collections.OrderedDict[int, int]" = collections.OrderedDict()  # model: bytes
        self._broken: Set[int] = set()  # models that are left out
        self._call_lock = CallLock()
        watch_forks(self)

    def _after_fork(self) -> None:
        if self._call_lock.is_taken():  # by a thread that is not in this process
            self._forget()

    def __getstate__(self) -> Dict[str, Any]:
        state = dict(self.__dict__)
        for name in ("_sampler", "_held", "_broken", "_call_lock"):  # of this process
            state.pop(name)
        return state

    def __setstate__(self, state: Dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._forget()

    def __len__(self) -> int:
        return len(self.files) * self.variants

    @property
    def epoch(self) -> int:
        return int(self._epoch[0])

    def set_epoch(self, epoch: int) -> None:
        """Chooses the epoch of all items, in running workers too."""
        self._epoch[0] = epoch

    # ---- Models ----

    def _cached_path(self, path: str) -> Optional[str]:
        if self.cache is None:
            return None
        state = os.stat(path)
        name = "%s|%d|%d|%s|separate|%s" % (os.path.abspath(path), state.st_size, state.st_mtime_ns, self.level, __version__)
        return os.path.join(self.cache, hashlib.sha256(name.encode()).hexdigest()[:32] + ".ply")

    def _repaired(self, path: str) -> Mesh:
        cached = self._cached_path(path)
        if cached is not None and os.path.exists(cached):
            return load(cached)
        mesh = repair(load(path), self.level, separate=True)
        if cached is not None and self.cache is not None:
            os.makedirs(self.cache, exist_ok=True)
            mesh.save(cached, keep_polygons=True)  # under another name until it is complete
        return mesh

    def _put(self, sampler: Sampler, model: int) -> None:
        mesh = self._repaired(self.files[model])
        sampler.put(mesh, model, repair=False)
        self._held[model] = 64 * len(mesh.indices) + 128 * len(mesh.vertices)

    def _need(self, models: Sequence[int], on_error: str) -> Sampler:
        if self._sampler is None:
            self._sampler = Sampler(**self._options)
        wanted = set(models)
        for model in wanted:
            if model in self._held:
                self._held.move_to_end(model)
            elif on_error == "raise":
                self._put(self._sampler, model)
            elif model not in self._broken:
                with left_out(self.files[model], self._broken, model):
                    self._put(self._sampler, model)
        total = sum(self._held.values())
        for model in list(self._held):
            if total <= self.memory:
                break
            if model not in wanted:
                total -= self._held.pop(model)
                self._sampler.put(None, model)
        return self._sampler

    # ---- Items ----

    def batch(self, items: Union[Sequence[int], Array], epoch: Optional[int] = None,
              on_error: Optional[str] = None) -> Tuple[torch.Tensor, torch.Tensor]:
        """Many items at once, made by all threads: voxels (n, 1, D, D, D), or packed, and labels (n,) int64. `on_error` as for the
        dataset; None = what that has."""
        on_error = self.on_error if on_error is None else check_on_error("dataset", on_error)
        at = _values.array("dataset: items", items, "iu", "whole numbers").reshape(-1)
        if at.size and (at.min() < -len(self) or at.max() >= len(self)):
            raise IndexError("items are from 0 to %d" % (len(self) - 1))
        at = at.astype(numpy.int64)
        at = numpy.where(at < 0, at + len(self), at)
        models, indices = at % len(self.files), at // len(self.files)
        names = numpy.stack([models, numpy.full(len(at), self.epoch if epoch is None else epoch), indices], axis=1)
        with self._call_lock:
            sampler = self._need(models.tolist(), on_error)
            made = numpy.array([model in self._held for model in models.tolist()], bool)
            models, names = models[made], names[made]
            voxels = sampler.batch(names.reshape(-1, 3), dtype="bits" if self.packed else "float32")
        return torch.from_numpy(voxels), torch.from_numpy(numpy.asarray(self.labels, numpy.int64)[models])

    def __getitem__(self, item: int) -> Tuple[torch.Tensor, int]:
        voxels, labels = self.batch([item], on_error="raise")
        return voxels[0], int(labels[0])

    def __getitems__(self, items: Sequence[int]) -> List[Tuple[torch.Tensor, int]]:
        """What torch.utils.data.DataLoader asks for, if it knows of it, rather than for items one by one."""
        voxels, labels = self.batch(items)
        if len(items) > 0 and len(labels) == 0:
            raise EmptyError("dataset: none of the meshes of a batch can be read; IterableVoxelDataset passes over it")
        return list(zip(voxels, labels.tolist()))


def unpack(packed: torch.Tensor, resolution: int) -> torch.Tensor:
    """(n, D, D, ceil(D / 8)) uint8 to (n, 1, D, D, D) float32, on whatever device it is. The last axis alone counts, so that
    grids of three lengths are unpacked by the last of them."""
    bits = torch.arange(8, dtype=torch.uint8, device=packed.device)
    voxels = (packed.unsqueeze(-1) >> bits) & 1
    return voxels.flatten(-2)[..., :resolution].unsqueeze(1).float()


class IterableVoxelDataset(IterableDataset):
    """Whole batches of a VoxelDataset or GridDataset, epoch after epoch, made ahead by a thread while the network learns.

    Iterate over it as it is, or through DataLoader(..., batch_size=None, num_workers=n): each worker then makes its share.

    Args:
        dataset: where items come from.
        batch_size: items of a batch; the last one of an epoch is smaller, unless `drop_last`.
        epochs: how many; None = without end.
        shuffle: another order in each epoch, which follows from `seed`; "groups" mixes the items of eight tars, or chunks of
            Zarr, at a time, which are then read one after another: for disks and networks that mind.
        prefetch: batches made ahead; 0 = when they are asked for.
        rank: number of this process among those that train together, from 0 on.
        ranks: how many they are. Each gets as many batches in an epoch, all of full size: what is left over, fewer than
            ranks * batch_size items, is left out.
        on_error: "raise"; "skip": batches are smaller by the items that cannot be read or made, each mesh told once as
            VoxmendWarning; one that would be empty is passed over, so that ranks may then differ by it. None: as the dataset
            does.

    Attributes:
        waited: seconds for which the last iteration had to wait for batches.
    """

    TOGETHER = 8  # groups that are mixed

    def __init__(self, dataset: Union[VoxelDataset, GridDataset], batch_size: int, *, epochs: Optional[int] = 1,
                 first_epoch: int = 0, shuffle: Union[bool, str] = True, seed: int = 0, drop_last: bool = False,
                 prefetch: int = 2, rank: int = 0, ranks: int = 1, on_error: Optional[str] = None):
        _values.whole("batches: batch_size", batch_size, 1)
        for name, value in (("epochs", epochs or 0), ("first_epoch", first_epoch), ("seed", seed), ("prefetch", prefetch)):
            _values.whole("batches: " + name, value, 0)
        _values.whole("batches: rank", rank, 0, _values.whole("batches: ranks", ranks, 1) - 1)
        if isinstance(shuffle, str) and (shuffle != "groups" or not isinstance(dataset, GridDataset)):
            raise ArgumentError("batches: shuffle %r is neither true nor false, nor \"groups\" of a GridDataset" % shuffle)
        self.dataset, self.batch_size, self.epochs, self.first_epoch = dataset, batch_size, epochs, first_epoch
        self.shuffle, self.seed, self.drop_last, self.prefetch = shuffle, seed, drop_last, prefetch
        self.rank, self.ranks = rank, ranks
        self.on_error = None if on_error is None else check_on_error("batches", on_error)
        self.waited = 0.0

    def order(self, epoch: int) -> Array:
        """The items of an epoch, in order: the same in every process."""
        if not self.shuffle:
            return numpy.arange(len(self.dataset))
        draw = numpy.random.Generator(numpy.random.Philox(key=[self.seed, epoch]))
        if self.shuffle == "groups" and isinstance(self.dataset, GridDataset):
            return order_by_groups(self.dataset.groups, self.TOGETHER, draw)
        return draw.permutation(len(self.dataset))

    def _batches_of(self, epoch: int) -> List[Array]:
        """Those of this rank."""
        items = self.order(epoch)
        if self.ranks > 1:
            items = items[:len(items) // (self.ranks * self.batch_size) * self.ranks * self.batch_size]
        elif self.drop_last:
            items = items[:len(items) // self.batch_size * self.batch_size]
        return [items[begin:begin + self.batch_size]
                for begin in range(self.rank * self.batch_size, len(items), self.ranks * self.batch_size)]

    def _batches(self) -> Iterator[Tuple[int, Array]]:
        worker = get_worker_info()
        share, shares = (worker.id, worker.num_workers) if worker else (0, 1)
        number, epoch = 0, self.first_epoch
        while self.epochs is None or epoch < self.first_epoch + self.epochs:
            for chosen in self._batches_of(epoch):
                if number % shares == share:
                    yield epoch, chosen
                number += 1
            epoch += 1

    def _made(self) -> Iterator[Tuple[torch.Tensor, torch.Tensor]]:
        """The batches that have something in them."""
        given: Dict[str, str] = {} if self.on_error is None else {"on_error": self.on_error}
        passed = 0  # items since the last of them
        for epoch, items in self._batches():
            made = self.dataset.batch(items, epoch, **given)
            passed = 0 if len(made[1]) else passed + len(items)
            if len(made[1]):
                yield made
            elif passed > len(self.dataset):  # else it would go on without end
                raise EmptyError("batches: nothing of the dataset can be read")

    def __iter__(self) -> Iterator[Tuple[torch.Tensor, torch.Tensor]]:
        self.waited = 0.0
        if self.prefetch < 1:
            start = time.perf_counter()
            for made in self._made():
                self.waited += time.perf_counter() - start
                yield made
                start = time.perf_counter()
            return
        ready: "queue.Queue[Any]" = queue.Queue(self.prefetch)
        stop = ffi.new("int *")
        worker = threading.Thread(target=self._make_ahead, args=(ready, stop), daemon=True)
        worker.start()
        try:
            while True:
                start = time.perf_counter()
                kind, value = ready.get()
                self.waited += time.perf_counter() - start
                if kind == "end":
                    return
                if kind == "error":
                    raise value
                yield value
        finally:
            stop[0] = 1  # ends the call in which it may be
            while worker.is_alive():  # it may wait for room
                try:
                    ready.get_nowait()
                except queue.Empty:
                    worker.join(0.01)

    def _make_ahead(self, ready: Any, stop: Any) -> None:
        try:
            with _core.stoppable(stop):
                for made in self._made():
                    if stop[0]:
                        return
                    ready.put(("batch", made))
            ready.put(("end", None))
        except BaseException as problem:  # goes on in the thread that asked
            ready.put(("error", problem))
