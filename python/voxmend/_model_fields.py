# SPDX-License-Identifier: BSD-3-Clause
"""Fields of meshes: a distance, share, label or colour for each voxel."""
from __future__ import annotations

from typing import Any, Optional

import numpy

from . import _core, _values
from ._core import ffi, lib
from ._engines import EngineLike
from ._errors import ArgumentError, KindError
from ._field import VoxelField
from ._mesh_sources import MeshLike
from ._records import CoverageReport, DistanceReport, LabelReport
from ._space import Like, Place
from ._types import ArrayLike, Progress, Resolution, Size
from ._work import Rules, Run, Work


def _values_for(space: Any, dtype: Any, channels: int = 1) -> Any:
    shape = tuple(int(n) for n in space.dims)
    return numpy.empty(shape + ((channels,) if channels > 1 else ()), dtype)


def distance(mesh: MeshLike, resolution: Optional[Resolution] = None, *, pitch: Optional[Size] = None,
             voxel_size: Optional[Size] = None, fit: Optional[str] = None, pad: int = 0, bounds: Optional[ArrayLike] = None,
             like: Optional[Like] = None, band: float = 3.0, unsigned: bool = False, repair: bool = True,
             engine: EngineLike = None, progress: Progress = None, timeout: Optional[float] = None) -> VoxelField:
    """Distances from the centres of voxels to the mesh, negative inside.

    Args:
        band: voxels from the mesh within which they are exact; beyond it they are plus or minus the band's width. 0 =
            exact everywhere.
        unsigned: positive inside, too.
        others: as for `voxmend.voxelize`.

    Returns:
        a field of float32 in model units, with a DistanceReport. It can be unpacked: values, origin, pitch = distance(...)
    """
    place = Place("distance", resolution, pitch, voxel_size, fit, pad, bounds, like)
    options = _core.new("vxm_distance_options", band=_values.real("distance: band", band, 0),
                        is_unsigned=_values.flag("distance: unsigned", unsigned))
    with Work(mesh, place, Rules(), Run(repair, engine, progress, timeout)) as work:
        space, model = work.space(), work.model()
        values, solid = _values_for(space, numpy.float32), _core.new("vxm_voxelize_report")
        report = _core.new("vxm_distance_report", voxelize=solid)
        _core.call(lib.vxm_model_distance, _core.pointer("float *", values), report, model, space, options)
        told = DistanceReport._of(report, voxelize=work.report(solid))
        made = VoxelField._made(values, space, "distance", told, work.warnings(model))
    _core.warn(made.warnings)
    return made


def coverage(mesh: MeshLike, resolution: Optional[Resolution] = None, *, pitch: Optional[Size] = None,
             voxel_size: Optional[Size] = None, fit: Optional[str] = None, pad: int = 0, bounds: Optional[ArrayLike] = None,
             like: Optional[Like] = None, subdivision: int = 4, dtype: str = "float32", repair: bool = True,
             engine: EngineLike = None, progress: Progress = None, timeout: Optional[float] = None) -> VoxelField:
    """How much of each voxel is filled.

    Args:
        subdivision: 2, 4 or 8: sub-voxels along each axis by which it is counted.
        dtype: "float32": 0 to 1; "uint8": 0 to 255, rounded.
        others: as for `voxmend.voxelize`.

    Returns:
        a field with a CoverageReport. It can be unpacked: values, origin, pitch = coverage(...)
    """
    if _values.word("coverage: dtype", dtype) not in ("float32", "uint8"):
        raise ArgumentError("coverage: dtype %r is none of float32, uint8" % dtype)
    place = Place("coverage", resolution, pitch, voxel_size, fit, pad, bounds, like)
    options = _core.new("vxm_coverage_options", subdivision=_values.whole("coverage: subdivision", subdivision, 2, 8),
                        scalar=lib.VXM_FLOAT32 if dtype == "float32" else lib.VXM_UINT8)
    with Work(mesh, place, Rules(), Run(repair, engine, progress, timeout)) as work:
        space, model = work.space(), work.model()
        values, solid = _values_for(space, dtype), _core.new("vxm_voxelize_report")
        report = _core.new("vxm_coverage_report", voxelize=solid)
        _core.call(lib.vxm_model_coverage, _core.pointer("void *", values), report, model, space, options)
        told = CoverageReport._of(report, voxelize=work.report(solid))
        made = VoxelField._made(values, space, "coverage", told, work.warnings(model))
    _core.warn(made.warnings)
    return made


def labels(mesh: MeshLike, resolution: Optional[Resolution] = None, *, by: str = "part", pitch: Optional[Size] = None,
           voxel_size: Optional[Size] = None, fit: Optional[str] = None, pad: int = 0, bounds: Optional[ArrayLike] = None,
           like: Optional[Like] = None, mode: str = "solid", surface: Optional[str] = None, method: Optional[str] = None,
           vote: Optional[str] = None, parts: str = "auto", cavities: Optional[str] = None, thin: str = "auto",
           repair: bool = True, engine: EngineLike = None, progress: Progress = None,
           timeout: Optional[float] = None) -> VoxelField:
    """Which part, group or material each set voxel belongs to.

    Args:
        by: "part": connected components; "group": groups or named parts of the file, or nodes of a scene; "material".
            Bodies have what they enclose, also where they share walls: each closed group or material is repaired by itself.
            Those that are patches of a surface have the voxels at it.
        others: as for `voxmend.voxelize`, which sets the same voxels but where the repair of all groups together does other.

    Returns:
        a field of uint16, 0 where no voxel is set, with its table in `labels` and `label_names`, and a LabelReport

    Raises:
        RangeError: beyond 65535 labels.
    """
    place = Place("labels", resolution, pitch, voxel_size, fit, pad, bounds, like)
    options = _core.new("vxm_label_options", by=_core.choice("labels: by", by, "VXM_LABEL_"))
    rules = Rules(mode, surface, method, vote, parts, cavities, thin)
    with Work(mesh, place, rules, Run(repair, engine, progress, timeout), by) as work:
        space, model = work.space(), work.model()
        values, solid = _values_for(space, numpy.uint16), _core.new("vxm_voxelize_report")
        report = _core.new("vxm_label_report", voxelize=solid)
        _core.call(lib.vxm_model_labels, _core.pointer("uint16_t *", values), report, model, space, options)
        names = [_core.text(lib.vxm_model_label_name(model, n + 1)) for n in range(lib.vxm_model_label_count(model))]
        told = LabelReport._of(report, voxelize=work.report(solid))
        made = VoxelField._made(values, space, "labels", told, work.warnings(model), {}, names)
    _core.warn(made.warnings)
    return made


def colors(mesh: MeshLike, resolution: Optional[Resolution] = None, *, by: str = "noise", source: Optional[str] = None,
           average: bool = False, volume: Optional[VoxelField] = None, pitch: Optional[Size] = None,
           voxel_size: Optional[Size] = None, fit: Optional[str] = None, pad: int = 0, bounds: Optional[ArrayLike] = None,
           like: Optional[Like] = None, mode: str = "solid", surface: Optional[str] = None, method: Optional[str] = None,
           vote: Optional[str] = None, parts: str = "auto", cavities: Optional[str] = None, thin: str = "auto",
           repair: bool = True, engine: EngineLike = None, progress: Progress = None,
           timeout: Optional[float] = None) -> VoxelField:
    """A colour for each set voxel.

    Args:
        by: "noise": Perlin's, in three dimensions; "position": red, green and blue along x, y and z; "part": a hue for each
            connected component; "glsl": a function, `source`, which needs engine="opengl"; "mesh": the mesh's own, of vertices,
            faces, materials and textures. A file is read with them; a Mesh has them if `load(..., colors=True)` made it;
            "volume": numbers or colours that are sampled at the centres of voxels.
        source: with "glsl": defines vec3 color(vec3 position, vec3 unit, uint part), of a voxel's centre in model units, the
            same from the grid's corner on with its longest side as 1, and the number of the component, from 1 on; it may
            call float noise(vec3), -1 to 1.
        average: with "mesh": the mean over the surface within a voxel, where there is any, in place of the colour nearest to
            its centre.
        volume: with "volume": a field in the same coordinates. It is interpolated between the centres of its voxels; beyond the
            outermost ones the nearest point counts. Numbers are grey, black the least and white the greatest.
        others: as for `voxmend.voxelize`, which sets the same voxels.

    Returns:
        a field of (nx, ny, nz, 4) uint8: red, green, blue and 255, zeros where no voxel is set; with a VoxelizeReport
    """
    place = Place("colors", resolution, pitch, voxel_size, fit, pad, bounds, like)
    options = _core.new("vxm_color_options", by=_core.choice("colors: by", by, "VXM_COLOR_"),
                        average=_values.flag("colors: average", average))
    if options.average and by != "mesh":
        raise ArgumentError("colors: average goes with by='mesh'")
    if (source is not None) != (by == "glsl"):
        raise ArgumentError("colors: by='glsl' and a source go together")
    if (volume is not None) != (by == "volume"):
        raise ArgumentError("colors: by='volume' and a volume go together")
    if volume is not None and not isinstance(volume, VoxelField):
        raise KindError("colors: the volume is a %s, not a VoxelField" % type(volume).__name__)
    options.volume = ffi.NULL if volume is None else volume._pointer
    code = ffi.NULL if source is None else ffi.new("char[]", _values.word("colors: source", source).encode())
    options.source = code
    rules = Rules(mode, surface, method, vote, parts, cavities, thin)
    with Work(mesh, place, rules, Run(repair, engine, progress, timeout, by == "mesh")) as work:
        space, model = work.space(), work.model()
        options.mesh = work.original._pointer if by == "mesh" else ffi.NULL
        values, report = _values_for(space, numpy.uint8, 4), _core.new("vxm_voxelize_report")
        _core.call(lib.vxm_model_colors, _core.pointer("uint8_t *", values), report, model, space, options)
        made = VoxelField._made(values, space, "colors", work.report(report), work.warnings(model))
    _core.warn(made.warnings)
    return made
