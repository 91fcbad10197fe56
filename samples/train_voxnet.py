#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Trains a small VoxNet (Maturana & Scherer 2015) on voxels that voxmend makes while it learns: no dataset of grids is stored.

    samples/train_voxnet.py                                 eight classes of generated shapes, a few minutes on two cores
    samples/train_voxnet.py ModelNet10 --rotate z           a folder of class folders with train/ and test/ in them

Each epoch sees another variant of each mesh: turned, scaled, dented, mirrored and moved.
"""
import argparse
import math
import os
import tempfile
import time

import numpy
import torch
from torch import nn

import voxmend
from voxmend.torch import IterableVoxelDataset, VoxelDataset

# ---- Generated classes: solids of revolution and prisms, of random proportions ----


def revolved(profile, around=32):
    """A mesh of a closed profile (r, z) about the z axis; points with r = 0 become poles."""
    vertices, rings = [], []
    for r, z in profile:
        if r == 0:
            rings.append([len(vertices)] * around)
            vertices.append((0, 0, z))
            continue
        rings.append(list(range(len(vertices), len(vertices) + around)))
        vertices += [(r * math.cos(a), r * math.sin(a), z) for a in numpy.arange(around) * (2 * math.pi / around)]
    faces = []
    for below, above in zip(rings, rings[1:] + rings[:1]):
        for i in range(around):
            k = (i + 1) % around
            faces += [(below[i], below[k], above[k]), (below[i], above[k], above[i])]
    return vertices, [f for f in faces if len(set(f)) == 3]


def prism(outline, height):
    """A mesh over an outline that a fan from its first corner covers, or at least covers mod 2."""
    n = len(outline)
    vertices = [(x, y, z) for z in (0, height) for x, y in outline]
    faces = [f for i in range(1, n - 1) for f in ((0, i + 1, i), (n, n + i, n + i + 1))]
    for i in range(n):
        k = (i + 1) % n
        faces += [(i, k, n + k), (i, n + k, n + i)]
    return vertices, faces


def joined(*meshes):
    vertices, faces = [], []
    for points, triangles in meshes:
        faces += [tuple(v + len(vertices) for v in f) for f in triangles]
        vertices += points
    return vertices, faces


def box(low, high):
    outline = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
    points, faces = prism(outline, high[2] - low[2])
    return [(x, y, z + low[2]) for x, y, z in points], faces


def make_bottle(u):
    body, neck, height = u(.5, .8), u(.15, .25), u(1.2, 1.8)
    return revolved([(0, 0), (body, 0), (body, height), (neck, height + .4), (neck, height + u(.6, .9)), (0, height + 1)])


def make_ring(u):
    wide, thick, flat = u(.9, 1.1), u(.2, .35), u(.7, 1.3)
    turns = numpy.arange(16) * math.pi / 8
    return revolved([(wide + thick * math.cos(a), flat * thick * math.sin(a)) for a in turns])


def make_cone(u):
    return revolved([(0, 0), (u(.6, 1), 0), (0, u(1.3, 2.2))])


def make_ball(u):
    turns = numpy.linspace(-math.pi / 2, math.pi / 2, 13)[1:-1]
    flat = u(.8, 1.2)
    return revolved([(0, -flat)] + [(math.cos(a), flat * math.sin(a)) for a in turns] + [(0, flat)])


def make_table(u):
    wide, deep, high, leg, top = u(.8, 1.2), u(.5, .8), u(.7, 1.1), u(.1, .16), u(.1, .18)
    corners = [(x, y) for x in (-wide, wide - leg) for y in (-deep, deep - leg)]
    return joined(box((-wide, -deep, high), (wide, deep, high + top)),
                  *[box((x, y, 0), (x + leg, y + leg, high + .01)) for x, y in corners])


def make_chair(u):
    wide, seat, back, leg = u(.4, .55), u(.4, .6), u(.6, .9), u(.1, .14)
    corners = [(x, y) for x in (-wide, wide - leg) for y in (-wide, wide - leg)]
    return joined(box((-wide, -wide, seat), (wide, wide, seat + .12)), box((-wide, wide - .12, seat), (wide, wide, seat + back)),
                  *[box((x, y, 0), (x + leg, y + leg, seat + .01)) for x, y in corners])


def make_stairs(u):
    steps, rise, wide = int(u(3, 6)), u(.25, .4), u(.5, 1)
    return joined(*[box((i * .4 - .001, -wide, 0), ((i + 1) * .4, wide, (i + 1) * rise)) for i in range(steps)])


def make_star(u):
    points, inner = int(u(5, 8)), u(.35, .5)
    turns = numpy.arange(2 * points) * (math.pi / points)
    return prism([((1 if i % 2 == 0 else inner) * math.cos(a), (1 if i % 2 == 0 else inner) * math.sin(a))
                  for i, a in enumerate(turns)], u(.25, .5))


CLASSES = {"ball": make_ball, "bottle": make_bottle, "chair": make_chair, "cone": make_cone, "ring": make_ring,
           "stairs": make_stairs, "star": make_star, "table": make_table}


def generate(folder, train, test, seed):
    """Writes meshes in ModelNet's layout."""
    random = numpy.random.default_rng(seed)
    for name, make in CLASSES.items():
        for split, count in (("train", train), ("test", test)):
            at = os.path.join(folder, name, split)
            os.makedirs(at)
            for i in range(count):
                vertices, faces = make(random.uniform)
                voxmend.Mesh(vertices, faces).save(os.path.join(at, "%s_%04d.off" % (name, i)))


# ---- The network ----

class VoxNet(nn.Module):
    """Two convolutions, as Maturana & Scherer's, with a stride in each instead of most of the pooling."""

    def __init__(self, classes, resolution):
        super().__init__()
        self.features = nn.Sequential(nn.Conv3d(1, 16, 5, stride=2), nn.BatchNorm3d(16), nn.ReLU(),
                                      nn.Conv3d(16, 32, 3, stride=2), nn.BatchNorm3d(32), nn.ReLU(), nn.MaxPool3d(2),
                                      nn.Flatten())
        with torch.no_grad():
            self.features.eval()
            size = self.features(torch.zeros(1, 1, resolution, resolution, resolution)).shape[1]
            self.features.train()
        self.decide = nn.Sequential(nn.Linear(size, 128), nn.ReLU(), nn.Dropout(0.3), nn.Linear(128, classes))

    def forward(self, voxels):
        return self.decide(self.features(voxels))


def accuracy(network, data, batch):
    network.eval()
    right = total = 0
    with torch.no_grad():
        for voxels, labels in IterableVoxelDataset(data, batch, shuffle=False):
            right += int((network(voxels).argmax(1) == labels).sum())
            total += len(labels)
    network.train()
    return right / total


def main():
    parser = argparse.ArgumentParser(description="Trains a small VoxNet on voxels that voxmend makes while it learns.")
    parser.add_argument("folder", nargs="?", help="class folders with train/ and test/ [generated shapes]")
    parser.add_argument("--epochs", type=int, default=12)
    parser.add_argument("--resolution", type=int, default=32)
    parser.add_argument("--batch", type=int, default=32)
    parser.add_argument("--variants", type=int, default=4, help="of each model in an epoch")
    parser.add_argument("--models", type=int, default=24, help="generated for each class, and a third as many for the test")
    parser.add_argument("--rotate", default="z", help="none, any, x, y or z: the axis that points up")
    parser.add_argument("--displace", type=float, default=0.01)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cache", help="folder for repaired meshes")
    parser.add_argument("--threads", type=int, default=0, help="of torch and voxmend each")
    given = parser.parse_args()
    torch.manual_seed(given.seed)
    torch.set_num_threads(given.threads or len(os.sched_getaffinity(0)))
    voxmend.configure(given.threads)
    with tempfile.TemporaryDirectory() as made:
        if given.folder is None:
            generate(made, given.models, max(1, given.models // 3), given.seed)
        train(given, given.folder or made)


def train(given, folder):
    options = dict(variants=given.variants, seed=given.seed, cache=given.cache, rotate=given.rotate, mirror="x")
    data = VoxelDataset(folder, "train", given.resolution, scale=0.3, displace=given.displace, pad=1, translate=1, **options)
    test = VoxelDataset(folder, "test", given.resolution, pad=1, **dict(options, seed=given.seed + 1))
    network = VoxNet(len(data.classes), given.resolution)
    learner = torch.optim.Adam(network.parameters(), 1e-3)
    print("%d models of %d classes to train, %d to test; %d^3 voxels" %
          (len(data.files), len(data.classes), len(test.files), given.resolution), flush=True)
    waited = spent = 0.0
    start = time.perf_counter()
    for epoch in range(given.epochs):
        begin, total = time.perf_counter(), 0.0
        batches = IterableVoxelDataset(data, given.batch, first_epoch=epoch, seed=given.seed)
        for voxels, labels in batches:
            learner.zero_grad()
            loss = nn.functional.cross_entropy(network(voxels), labels)
            loss.backward()
            learner.step()
            total += float(loss.detach()) * len(labels)
        spent += time.perf_counter() - begin
        waited += batches.waited
        print("epoch %2d  loss %.3f  validation %5.1f %%  %5.1f s" %
              (epoch + 1, total / len(data), 100 * accuracy(network, test, given.batch), time.perf_counter() - start), flush=True)
    print("%d variants; the network waited %.2f s of %.1f s for voxels, %.1f %%" %
          (len(data) * given.epochs, waited, spent, 100 * waited / spent))


if __name__ == "__main__":
    main()
