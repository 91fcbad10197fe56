# SPDX-License-Identifier: BSD-3-Clause
"""Augmented variants of meshes, straight into arrays."""
from __future__ import annotations

from typing import Any, Dict, Optional, Sequence, Tuple, Type, Union

import numpy

from . import _core, _values
from ._call_lock import CallLock, watch_forks
from ._core import ffi, lib
from ._errors import ArgumentError, KindError
from ._mesh import Mesh
from ._mesh_sources import MeshLike, as_mesh
from ._repair import repair as repair_mesh
from ._types import Array, Floats, Uint32s
from ._work import Rules

_UINT32_MAX = 0xFFFFFFFF
_VOXELS = {"bits": lib.VXM_VOXEL_FORMAT_PACKED, "uint8": lib.VXM_VOXEL_FORMAT_UINT8, "float32": lib.VXM_VOXEL_FORMAT_FLOAT32}


class Sampler:
    """Draws endless, reproducible variants of models. Variant (model, epoch, index) of a seed is the same on any machine.

    Args:
        resolution: D, voxels along each axis.
        pad: voxels kept free on each side of the model before it is moved.
        seed: 64 bits.
        rotate: None; "any": uniform over all rotations; "x", "y", "z" or (3,): about an axis; (n, 3, 3): of which variant
            `index` takes number index % n; rotations alone, `mirror` is for what mirrors.
        scale: each axis is scaled by a factor of its own, uniform in 1 - scale to 1 + scale.
        displace: how far vertices are displaced, as a fraction of the width of the grid.
        displacement: "uniform": by up to that along each axis; "normal": with that deviation.
        noise: displacements in the buffer that all variants read; None = 65536. It goes with `displace`.
        mirror: axes such as "x" or "xyz", along each of which half of the variants are mirrored.
        translate: part of the room on each side, 0 to 1, by which variants are moved.
        fill: the longest side fills the grid rather than the diagonal; without rotation.
        mode, surface, method, vote, parts, cavities, thin: as for `voxmend.voxelize`.
        coverage: None; 2, 4 or 8: each voxel is the share of its sub-voxels, so many along each axis, that are inside: 0 to 1
            of "float32", 0 to 255 of "uint8".
        engine: who makes the voxels: "cpu"; "opengl", "opencl" or one that the command 'voxmend engines' lists, one variant
            after another; "auto": a GPU, or else the CPU. Variants have the same bits.

    Several threads may use one sampler: they take turns. A call works with all threads of the library, and other Python
    threads run meanwhile. Which variant is which follows from model, epoch and index alone, so that neither turns, nor
    pickles and copies, which hold the models too, make a difference.
    """

    def __init__(self, resolution: int = 64, *, pad: int = 0, seed: int = 0, rotate: Any = None, scale: float = 0.0,
                 displace: float = 0.0, displacement: str = "uniform", noise: Optional[int] = None, mirror: str = "",
                 translate: float = 0.0, fill: bool = False, mode: str = "solid", surface: Optional[str] = None,
                 method: Optional[str] = None, vote: Optional[str] = None, parts: str = "auto", cavities: Optional[str] = None,
                 thin: str = "auto", engine: Optional[str] = None, coverage: Optional[int] = None):
        if isinstance(rotate, (list, tuple, numpy.ndarray)):
            rotate = numpy.array(rotate)  # a copy
        self._options = dict(resolution=resolution, pad=pad, seed=seed, rotate=rotate, scale=scale, displace=displace,
                             displacement=displacement, noise=noise, mirror=mirror, translate=translate, fill=fill,
                             mode=mode, surface=surface, method=method, vote=vote, parts=parts, cavities=cavities,
                             thin=thin, engine=engine, coverage=coverage)
        self._meshes: Dict[int, Mesh] = {}
        self._call_lock = CallLock()
        self._torn = False  # by a fork in the middle of a call
        self._pointer = self._make()
        self.resolution = int(lib.vxm_sampler_space(self._pointer).dims[0])
        watch_forks(self)

    def _make(self) -> Any:
        """The library's sampler of the options, without models."""
        given = self._options
        rules = ("mode", "surface", "method", "vote", "parts", "cavities", "thin")
        voxelize = Rules(**{name: given[name] for name in rules}).options("sampler")
        options = _core.new("vxm_sampler_options", voxelize=voxelize)
        for name, least, most in (("resolution", 1, _values.DIM_MAX), ("pad", 0, _values.INT64_MAX),
                                  ("seed", 0, 0xFFFFFFFFFFFFFFFF)):
            setattr(options, name, _values.whole("sampler: " + name, given[name], least, most))
        for name in ("scale", "displace", "translate"):
            setattr(options, name, _values.real("sampler: " + name, given[name], 0))
        if given["noise"] is not None:
            options.noise = _values.whole("sampler: noise", given["noise"], 1, _UINT32_MAX)
            if options.displace == 0:
                raise ArgumentError("sampler: noise goes with displace; give displace too, or leave noise out")
        if given["coverage"] is not None:
            options.coverage = _values.whole("sampler: coverage", given["coverage"], 1, 8)
            if voxelize.thin != lib.VXM_THIN_AUTO:
                raise ArgumentError("sampler: coverage counts what is inside, and thin adds voxels; give one of them")
        options.fill = _values.flag("sampler: fill", given["fill"])
        options.displacement = _core.choice("sampler: displacement", given["displacement"], "VXM_DISPLACEMENT_")
        for axis in _values.word("sampler: mirror", given["mirror"]):
            if axis not in "xyz":
                raise ArgumentError("sampler: mirror %r names other axes than x, y and z" % given["mirror"])
            options.mirror |= 1 << "xyz".index(axis)
        rotations = self._set_rotation(options, given["rotate"])
        voxelize.engine = engine = self._make_engine(given["engine"])

        def destroy(sampler: Any, kept: Tuple[Any, ...] = (engine, self._meshes)) -> None:  # which outlive the sampler
            lib.vxm_sampler_destroy(sampler)
        made = _core.create("vxm_sampler", lib.vxm_sampler_create, _core.context(), options, destroy=destroy)
        del rotations  # the library has copied them
        return made

    @staticmethod
    def _make_engine(name: Optional[str]) -> Any:
        if name is None or _values.word("sampler: engine", name) == "cpu":
            return ffi.NULL
        return _core.create("vxm_engine", lib.vxm_engine_create, _core.context(), name.encode(), ffi.NULL,
                            destroy=lib.vxm_engine_destroy)

    # ---- Copies, and processes that are forked ----

    def __reduce__(self) -> Tuple[Any, ...]:
        with self._call_lock:
            return _restore, (type(self), self._options, dict(self._meshes))

    def _after_fork(self) -> None:
        if self._call_lock.is_taken():  # by a thread that is not in this process, in the middle of something
            self._call_lock, self._torn = CallLock(), True

    def _ready(self) -> Any:
        """The library's sampler; made anew where a fork came upon it in the middle of a call."""
        if self._torn:
            ffi.gc(self._pointer, None)  # left as it is: nobody knows how
            self._pointer = self._make()
            for model, mesh in self._meshes.items():
                _core.call(lib.vxm_sampler_put, self._pointer, model, mesh._pointer)
            self._torn = False
        return self._pointer

    @staticmethod
    def _set_rotation(options: Any, rotate: Any) -> Any:
        if rotate is None or (isinstance(rotate, str) and rotate == "none"):
            return None
        if isinstance(rotate, (bytes, bool)):
            raise KindError("sampler: rotate is %r, neither a name, an axis nor matrices" % rotate)
        if isinstance(rotate, str) and rotate == "any":
            options.rotation = lib.VXM_ROTATION_ANY
            return None
        if isinstance(rotate, str):
            if rotate not in ("x", "y", "z"):
                raise ArgumentError("sampler: rotate %r is none of any, x, y, z, an axis or matrices" % rotate)
            rotate = numpy.eye(3)["xyz".index(rotate)]
        values = _values.reals("sampler: rotate", rotate)
        if values.shape == (3,):
            options.rotation = lib.VXM_ROTATION_AXIS
            options.axis[0:3] = values.tolist()
            return None
        if values.ndim != 3 or values.shape[1:] != (3, 3):
            raise ArgumentError("sampler: rotate has shape %s, neither (3,) nor (n, 3, 3)" % (values.shape,))
        options.rotation, options.rotation_count = lib.VXM_ROTATION_LIST, len(values)
        options.rotations = _core.pointer("double *", values)
        return values

    def put(self, mesh: Optional[MeshLike], model: int = 0, *, repair: bool = True) -> None:
        """Puts a mesh in, so that variants are made of it.

        Args:
            mesh: as for `voxmend.voxelize`; None takes the model out.
            model: its number.
            repair: repair the mesh first, as `voxmend.repair(mesh, separate=True)` does; what that gave is not changed by it.
        """
        repairs = _values.flag("sampler: repair", repair)
        own = None if mesh is None else as_mesh(mesh)
        if own is not None and repairs:
            own = repair_mesh(own, separate=True)
        number = _values.whole("sampler: model", model, 0, _UINT32_MAX)
        with self._call_lock:
            at = self._ready()
            try:
                _core.call(lib.vxm_sampler_put, at, number, ffi.NULL if own is None else own._pointer)
            except BaseException:
                _core.call(lib.vxm_sampler_put, at, number, ffi.NULL)  # there is none, whenever the failure came
                self._meshes.pop(number, None)
                raise
            self._meshes.pop(number, None)  # only now: until it was replaced the library looked at it
            if own is not None:
                self._meshes[number] = own

    def shape(self, count: int, dtype: str = "float32") -> Tuple[int, ...]:
        """Of an array of `count` variants."""
        d = self.resolution
        count = _values.whole("sampler: count", count, 0)
        if _values.word("sampler: dtype", dtype) not in _VOXELS:
            raise ArgumentError("sampler: dtype %r is none of float32, uint8, bits" % (dtype,))
        return (count, d, d, (d + 7) // 8) if dtype == "bits" else (count, 1, d, d, d)

    def batch(self, variants: Union[int, Sequence[int], Array], *, model: int = 0, epoch: int = 0,
              dtype: str = "float32", out: Optional[Array] = None) -> Array:
        """Makes variants with all threads.

        Args:
            variants: a number n for variants 0 to n - 1, (n,) indices, or (n, 3) model, epoch and index of each.
            model, epoch: where `variants` does not say them.
            dtype: "float32", "uint8", or "bits".
            out: array to fill, C-contiguous and of the right shape and type; else a new one is made.

        Returns:
            (n, 1, D, D, D), indexed [n, 0, x, y, z]; as bits (n, D, D, ceil(D / 8)) uint8, to be unpacked by
            numpy.unpackbits(..., axis=-1, count=D, bitorder="little")
        """
        names = self._names(variants, model, epoch)
        shape, kind = self.shape(len(names), dtype), numpy.float32 if dtype == "float32" else numpy.uint8
        if out is None:
            out = numpy.empty(shape, kind)
        if not isinstance(out, numpy.ndarray):
            raise KindError("sampler: out is %s, not a numpy array" % type(out).__name__)
        if out.shape != shape or out.dtype != kind or not out.flags.carray:
            raise ArgumentError("sampler: out is not a writeable C-contiguous array of %s of shape %s" %
                                (numpy.dtype(kind).name, shape))
        with self._call_lock:
            _core.call(lib.vxm_sampler_batch, _core.pointer("void *", out), self._ready(),
                       _core.pointer("vxm_variant *", names), len(names), _VOXELS[dtype])
        return out

    @staticmethod
    def _names(variants: Any, model: Any, epoch: Any) -> Uint32s:
        """(n, 3) uint32: model, epoch and index of each variant."""
        if numpy.ndim(variants) == 0:
            variants = numpy.arange(_values.whole("sampler: variants", variants, 0, _UINT32_MAX))
        names = _values.wholes("sampler: model, epoch and index", variants, 0, _UINT32_MAX)
        if names.ndim == 1:
            names = numpy.stack([numpy.full(len(names), _values.whole("sampler: model", model, 0, _UINT32_MAX)),
                                 numpy.full(len(names), _values.whole("sampler: epoch", epoch, 0, _UINT32_MAX)), names], axis=1)
        if names.ndim != 2 or names.shape[1] != 3:
            raise ArgumentError("sampler: variants have shape %s, neither (n,) nor (n, 3)" % (names.shape,))
        return numpy.ascontiguousarray(names, numpy.uint32)

    def pose(self, index: int, *, model: int = 0, epoch: int = 0) -> Dict[str, Floats]:
        """How a variant lies, before its vertices are displaced.

        Returns:
            transform (3, 4): takes (x, y, z, 1) of the mesh to voxels; rotation (3, 3); scale (3,) in voxels per model
            unit, negative where mirrored; shift (3,) in voxels
        """
        out = _core.new("vxm_pose")
        variant = ffi.new("vxm_variant *", {name: _values.whole("sampler: " + name, value, 0, _UINT32_MAX)
                                            for name, value in (("model", model), ("epoch", epoch), ("index", index))})
        with self._call_lock:
            _core.call(lib.vxm_sampler_pose, out, self._ready(), variant)
        shapes = {"transform": (3, 4), "rotation": (3, 3), "scale": (3,), "shift": (3,)}
        return {key: numpy.array(list(getattr(out, key))).reshape(shape) for key, shape in shapes.items()}


def _restore(kind: Type[Sampler], options: Dict[str, Any], meshes: Dict[int, Mesh]) -> Sampler:
    """A sampler from its pickle."""
    made = kind.__new__(kind)
    Sampler.__init__(made, **options)
    for model, mesh in meshes.items():
        made.put(mesh, model, repair=False)  # as it is held
    return made
