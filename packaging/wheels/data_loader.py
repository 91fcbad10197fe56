# SPDX-License-Identifier: BSD-3-Clause
"""data_loader.py MESH: PyTorch's workers, forked and spawned, give the same batches as no worker. Works in the current folder."""
import os
import shutil
import sys

import torch

import voxmend.torch


def batches(dataset, workers, method):
    context = method if workers else None
    loader = torch.utils.data.DataLoader(dataset, batch_size=2, num_workers=workers, multiprocessing_context=context)
    return torch.cat([voxels for voxels, *_ in loader])


def main():
    assert voxmend.__file__.startswith(sys.prefix), voxmend.__file__
    for name in ("first", "second"):
        os.makedirs("models/%s/train" % name, exist_ok=True)
        shutil.copy(sys.argv[1], "models/%s/train/mesh.off" % name)
    dataset = voxmend.torch.VoxelDataset("models", "train", 16, rotate="any", seed=3, variants=4)
    alone = batches(dataset, 0, None)
    assert alone.any()
    for method in ("fork", "spawn"):
        assert torch.equal(batches(dataset, 2, method), alone), method
    print("torch %s: %s from workers that are forked and spawned" % (torch.__version__, tuple(alone.shape)))


if __name__ == "__main__":
    main()
