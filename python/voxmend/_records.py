# SPDX-License-Identifier: BSD-3-Clause
"""What calls report: numbers with names. Each is read as `report.voxels`, and as the dict that it was: `report["voxels"]`."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Dict, Iterator, Optional, Tuple, Type, TypeVar

Bounds = Tuple[float, float, float, float, float, float]
Point = Tuple[float, float, float]
Made = TypeVar("Made", bound="Record")


@dataclass(frozen=True)
class Record(Mapping[str, Any]):
    """A dataclass that is a mapping of its fields, too."""

    def __getitem__(self, name: str) -> Any:
        if name not in tuple(self):
            raise KeyError(name)
        return getattr(self, name)

    def __iter__(self) -> Iterator[str]:
        return (known.name for known in fields(self))

    def __len__(self) -> int:
        return len(fields(self))

    @classmethod
    def _of(cls: Type[Made], struct: Any, **others: Any) -> Made:
        """Of a struct of the library, whose fields have the same names; those that are structs come with `others`."""
        for known in fields(cls):
            if known.name not in others and hasattr(struct, known.name):
                value = getattr(struct, known.name)
                plain = isinstance(value, (bool, int, float))
                others[known.name] = value if plain else tuple(value)
        return cls(**others)


@dataclass(frozen=True)
class Settings(Record):
    """How the package works (`voxmend.settings`).

    Attributes:
        threads: that a call works with.
        memory_limit: bytes that objects may hold together; 0 = what the machine has.
        peak_bytes: held at once at most since `configure` was called.
    """

    threads: int
    memory_limit: int
    peak_bytes: int


@dataclass(frozen=True)
class Census(Record):
    """What is wrong with a mesh (`Mesh.info`). Edges, components and duplicates are taken after welding equal positions.

    Attributes:
        triangles: after splitting polygons.
        components: connected by welded vertices; components_raw: by the numbers of vertices as they are.
        duplicate_faces, opposite_duplicate_faces: that repeat an earlier one, turned the same way or the other.
        degenerate_faces: of fewer than three corners, or without area; finite ones.
        boundary_edges, nonmanifold_edges: with one face, with more than two.
        inconsistent_edges: of which both faces run along it in the same direction.
        nonfinite_vertices: with a coordinate that is not a finite number; repair removes them with their faces, which
            therefore have no edges here.
        largest_face: corners of the largest face.
        watertight: there are edges, and none of them has one or more than two.
        closed: there are edges, and every one has an even number of them.
        bounds: x0 y0 z0 x1 y1 z1 in model units.
        area, volume: model units squared and cubed; the volume is positive if faces look outward.
    """

    vertices: int
    faces: int
    triangles: int
    components: int
    components_raw: int
    duplicate_faces: int
    opposite_duplicate_faces: int
    degenerate_faces: int
    boundary_edges: int
    nonmanifold_edges: int
    inconsistent_edges: int
    nonfinite_vertices: int
    unused_vertices: int
    largest_face: int
    watertight: bool
    closed: bool
    bounds: Bounds
    area: float
    volume: float


@dataclass(frozen=True)
class Texture(Record):
    """A picture that the materials of a mesh name: as the mesh says, its pixels, and why it cannot be read, "" if it can."""

    name: str
    width: int
    height: int
    failure: str


@dataclass(frozen=True)
class Look(Record):
    """What a mesh looks like that was read with its colours (`Mesh.look`).

    Attributes:
        has_colors: any of what follows is there, textures that cannot be read left out.
        vertex_colors, face_colors: vertices, or faces, have colours.
        materials: colours and textures of faces.
        textures: pictures that materials name, those that cannot be read among them.
    """

    has_colors: bool
    vertex_colors: bool
    face_colors: bool
    materials: int
    textures: Tuple[Texture, ...]


@dataclass(frozen=True)
class RepairReport(Record):
    """What a repair has done (`Mesh.report`). As a mapping it has the passes: report["exact_weld"].

    Attributes:
        passes: vertices or faces that each pass removed, changed or added, in the order of the work.
        nonorientable_patches: faces joined by edges that cannot all be turned consistently.
        open_parts: components whose holes stay open, as they are sheets.
        filled_holes, unfilled_holes: that were filled, and that could not be.
        fan_fallbacks: holes that "minimal" or "smooth" left to fans.
        union_failures, union_tries: parts that still cut through others or themselves; tries until they did not.
        wrapped_parts: that could not be united and were wrapped.
        self_intersections_before, self_intersections_after: pairs of faces; -1 = not looked for.
        unparted_vertices: that share a position and could not be moved apart.
        shared_faces: that repeat others and stay, as bodies overlap there.
        lost_parts: closed components that enclose less than before.
        emptied_parts: closed components of whose inside a union has taken something away.
        sheets: open components that became plates, or were dropped.
        opened_parts: closed before, open after (with `part_changes`).
        max_displacement: no vertex was moved farther, model units (with `part_changes`).
    """

    passes: Dict[str, int] = field(default_factory=dict)
    nonorientable_patches: int = 0
    open_parts: int = 0
    filled_holes: int = 0
    unfilled_holes: int = 0
    fan_fallbacks: int = 0
    union_failures: int = 0
    union_tries: int = 0
    wrapped_parts: int = 0
    self_intersections_before: int = -1
    self_intersections_after: int = -1
    unparted_vertices: int = 0
    shared_faces: int = 0
    lost_parts: int = 0
    sheets: int = 0
    opened_parts: int = 0
    max_displacement: float = 0.0
    emptied_parts: int = 0

    def __getitem__(self, name: str) -> int:
        return self.passes[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.passes)

    def __len__(self) -> int:
        return len(self.passes)


@dataclass(frozen=True)
class PartState(Record):
    """A connected component at one time. Names mean what they mean in `Census`.

    Attributes:
        holes: closed walks along edges with an odd number of faces.
        self_intersections: pairs of faces; -1 = not looked for.
    """

    faces: int
    boundary_edges: int
    nonmanifold_edges: int
    inconsistent_edges: int
    holes: int
    self_intersections: int
    closed: bool
    area: float
    volume: float
    bounds: Bounds


@dataclass(frozen=True)
class PartChange(Record):
    """What a repair did to a connected component (`Mesh.part_changes`).

    Attributes:
        before, after: the component as it was given, and all faces that come from it.
        flipped: faces that were turned.
        max_displacement: none of its vertices was moved farther, model units.
        tag: name of its first face's tag, or None.
        union_failed: it still cuts through others or itself.
    """

    before: PartState
    after: PartState
    flipped: int
    max_displacement: float
    tag: Optional[str]
    union_failed: bool


@dataclass(frozen=True)
class Finding(Record):
    """What is in the way of a level.

    Attributes:
        what: fixed name such as "boundary_edges", or of a pass that would still change something.
        count: how many of them.
        element: the first one, a vertex, or for faces and edges a face; -1 = none to tell.
        position: where that is, model units; None = not known.
    """

    what: str
    count: int
    element: int
    position: Optional[Point]


@dataclass(frozen=True)
class Verification(Record):
    """Whether a mesh is at a level (`Mesh.verify`), and what is in the way."""

    reached: bool
    findings: Tuple[Finding, ...]


@dataclass(frozen=True)
class VoxelizeReport(Record):
    """What came of voxelizing (`VoxelGrid.report`); of a grid that comes from elsewhere all is 0, and bool() False.

    Attributes:
        parts: that were voxelized apart and united; closed_parts, capped_parts: of them closed, closed by caps over holes.
        cavities: components that are cavities of the one around them; caps: rims that were capped.
        contested: voxels on which the voters of open parts disagreed; winding_decided: that the winding number decided.
        voxels, hash: as `VoxelGrid.filled_count` and `VoxelGrid.hash`.
        empty_parts, outside_parts: that set no voxel, within the grid or because they lie outside of it.
        thin_voxels: added because parts are thinner than one; thin_share: of the surface that needed them, 0 to 1.
        self_overlapping_parts: that run through themselves, and are filled where parity would leave them hollow;
            hollow_overlaps: that seem to, but are left hollow, as their faces are wound against each other;
            filled_overlaps: with cavities that overlap each other, where what these share is filled.
        components: pieces that share vertices, of which the parts are made; those that stay open are one part together.
        fill_ms, write_ms: of what is written to a file.
        engine: what made the voxels, such as "cpu" or "opencl:0"; engine_note: why it was taken in place of another.
    """

    parts: int = 0
    closed_parts: int = 0
    capped_parts: int = 0
    cavities: int = 0
    caps: int = 0
    contested: int = 0
    winding_decided: int = 0
    voxels: int = 0
    hash: int = 0
    empty_parts: int = 0
    outside_parts: int = 0
    fill_ms: float = 0.0
    write_ms: float = 0.0
    thin_voxels: int = 0
    thin_share: float = 0.0
    components: int = 0
    self_overlapping_parts: int = 0
    hollow_overlaps: int = 0
    filled_overlaps: int = 0
    engine: str = ""
    engine_note: str = ""

    def __bool__(self) -> bool:
        return self.engine != ""


@dataclass(frozen=True)
class DistanceReport(Record):
    """What came of distances: `exact`, voxels that the band does not clamp; `min` and `max` of all values; the solid's
    report, of zeros if they have no sign."""

    exact: int
    min: float
    max: float
    voxelize: VoxelizeReport


@dataclass(frozen=True)
class CoverageReport(Record):
    """What came of coverage: `full`, voxels of which all sub-voxels are set; `partial`, of which some are; `volume`, the sum
    of the fractions times that of a voxel, model units cubed; the report of the sub-voxels."""

    full: int
    partial: int
    volume: float
    voxelize: VoxelizeReport


@dataclass(frozen=True)
class LabelReport(Record):
    """What came of labels: `labels`, how many; `contested`, voxels that several labels claim; `unassigned`, voxels that none
    claims, which have the nearest face's; the report of the set voxels. Voxels near open labels are counted by who claimed them."""

    labels: int
    contested: int
    unassigned: int
    voxelize: VoxelizeReport


@dataclass(frozen=True)
class Label(Record):
    """A row of a table of labels: its number, its name ("" if there is none), and how many voxels have it."""

    number: int
    name: str
    voxels: int


@dataclass(frozen=True)
class Comparison(Record):
    """How two grids differ: set voxels of each, of both, of one alone, and both / either (1 if both are empty)."""

    voxels_a: int
    voxels_b: int
    both: int
    only_a: int
    only_b: int
    iou: float


@dataclass(frozen=True)
class CarveReport(Record):
    """What a step of a `Carver` has removed.

    Attributes:
        removed: voxels that were set.
        begin, end: the box of these, from a voxel to the one before another; (0, 0, 0) where none was removed.
    """

    removed: int
    begin: Tuple[int, int, int]
    end: Tuple[int, int, int]


@dataclass(frozen=True)
class EngineInfo(Record):
    """What is known of an engine (`voxmend.engines`).

    Attributes:
        name: such as "cpu", "opengl:osmesa" or "opencl:0".
        available: it can be made and works; hardware: it is not a renderer in software.
        renderer, version, platform, driver: as the driver says, "" if there is none.
        block_bytes, viewport, layers, global_bytes, local_bytes, work_group: limits of the device.
        int64, int64_atomics, subpixel_bits, attachment, compute_units: what it has.
        moves: it moves the vertices of variants for training itself.
        note: why it is not available, or why another one was taken.
        kind, clock_mhz, cache_bytes, shares_memory: of an OpenCL device: "cpu", "gpu", "accelerator" or "custom"; its
            highest clock rate, the cache of its memory, and whether that is the host's.
        devices, lost_devices: that work at once, 1 of one; that failed, whose work the others did.
    """

    name: str
    available: bool
    hardware: bool
    renderer: str
    version: str
    block_bytes: int
    viewport: int
    layers: int
    subpixel_bits: int
    int64: bool
    attachment: str
    platform: str
    driver: str
    compute_units: int
    global_bytes: int
    local_bytes: int
    work_group: int
    int64_atomics: bool
    moves: bool
    note: str
    kind: str
    clock_mhz: int
    cache_bytes: int
    shares_memory: bool
    devices: int
    lost_devices: int
