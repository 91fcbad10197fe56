# SPDX-License-Identifier: BSD-3-Clause
"""What is wrong with a mesh, and where."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, Iterator, Optional, Tuple

import numpy

from . import _core, _values
from ._core import lib
from ._errors import ArgumentError
from ._mesh import Mesh
from ._progress import watch
from ._types import Floats, Int64s, Path, Progress


@dataclass(frozen=True)
class DefectGroup:
    """The defects of one kind.

    Attributes:
        kind: such as "boundary_edge".
        total: how many there are; more than are listed where `max_count` says so.
        elements: (n, 2) int64: of vertices and faces their number, and -1; of edges both vertices; of intersections both
            faces. Numbers are those of the mesh's arrays.
        positions: (n, 2, 3) float64, model units: the vertex, or the middle of the face, twice; the ends of the edge; the
            middles of both faces.
    """

    kind: str
    total: int
    elements: Int64s
    positions: Floats

    def __len__(self) -> int:
        return len(self.elements)

    def __repr__(self) -> str:
        return "<voxmend.DefectGroup: %d %s>" % (self.total, self.kind)


class Defects:
    """What is wrong with a mesh, after welding equal positions: `Mesh.defects` makes it.

        defects = mesh.defects()
        defects.counts                              # {"boundary_edge": 12, ...}
        defects["boundary_edge"].positions          # (12, 2, 3): the ends of each
        defects.save("defects.ply")                 # the mesh, with its defects in colour

    Iterating gives the kinds of which there are any, in their order.
    """

    def __init__(self, mesh: Mesh, pointer: Any):
        self.mesh = mesh
        self._pointer = pointer
        count = int(lib.vxm_defects_count(pointer))
        kinds, self._elements = numpy.empty(count, numpy.int32), numpy.empty((count, 2), numpy.int64)
        self._positions = numpy.empty((count, 2, 3))
        lib.voxmend_defects_gather(pointer, _core.pointer("int32_t *", kinds), _core.pointer("int64_t *", self._elements),
                                   _core.pointer("double *", self._positions))
        for array in (self._elements, self._positions):
            array.flags.writeable = False
        names = [_core.text(lib.vxm_defect_name(kind)) for kind in range(lib.VXM_DEFECT_KINDS)]
        ends = numpy.searchsorted(kinds, numpy.arange(len(names) + 1))  # they are ordered by kind
        self._ranges = {name: (int(ends[k]), int(ends[k + 1])) for k, name in enumerate(names)}
        self._totals = {name: int(lib.vxm_defects_total(pointer, k)) for k, name in enumerate(names)}

    @property
    def counts(self) -> Dict[str, int]:
        """How many of each kind there are, listed or not; -1 = not looked for."""
        return dict(self._totals)

    @property
    def kinds(self) -> Tuple[str, ...]:
        """All kinds that are known."""
        return tuple(self._totals)

    @property
    def total(self) -> int:
        """How many there are of all kinds."""
        return sum(max(count, 0) for count in self._totals.values())

    def __getitem__(self, kind: str) -> DefectGroup:
        if kind not in self._ranges:
            raise ArgumentError("defects: %r is none of %s" % (kind, ", ".join(self._ranges)))
        begin, end = self._ranges[kind]
        return DefectGroup(kind, self._totals[kind], self._elements[begin:end], self._positions[begin:end])

    def __iter__(self) -> Iterator[DefectGroup]:
        return (self[kind] for kind, total in self._totals.items() if total > 0)

    def __len__(self) -> int:
        """How many are listed."""
        return len(self._elements)

    def __repr__(self) -> str:
        told = ", ".join("%d %s" % (group.total, group.kind) for group in self)
        return "<voxmend.Defects: %s>" % (told or "none")

    def save(self, path: Path) -> None:
        """Writes the mesh as .ply with its defects in colour, edges and vertices as thin rods; the rest is grey."""
        _core.call(lib.vxm_defects_write, self._pointer, self.mesh._pointer, _values.path(path), path=path)


def find_defects(mesh: Mesh, intersections: bool, max_count: int, progress: Progress, timeout: Optional[float]) -> Defects:
    looks, most = _values.flag("defects: intersections", intersections), _values.whole("defects: max_count", max_count, 0)
    with watch(progress, timeout):
        return Defects(mesh, _core.create("vxm_defects", lib.vxm_mesh_defects, mesh._pointer, most, looks,
                                          destroy=lib.vxm_defects_destroy))
