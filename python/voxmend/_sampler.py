# SPDX-License-Identifier: BSD-3-Clause
"""Augmented variants of meshes, straight into arrays."""
from __future__ import annotations

from typing import Any, Optional, Sequence, Union

import numpy

from . import _core
from ._core import ffi, lib
from ._mesh import MeshLike, as_mesh

_VOXELS = {"bits": lib.VXM_VOXELS_PACKED, "uint8": lib.VXM_VOXELS_UINT8, "float32": lib.VXM_VOXELS_FLOAT32}


class Sampler:
    """Draws endless, reproducible variants of models. Variant (model, epoch, index) of a seed is the same on any machine.

    Args:
        resolution: D, voxels along each axis.
        pad: voxels kept free on each side of the model before it is moved.
        seed: 64 bits.
        rotate: None; "any": uniform over all rotations; "x", "y", "z" or (3,): about an axis; (n, 3, 3): of which variant
            `index` takes number index % n.
        scale: each axis is scaled by a factor of its own, uniform in 1 - scale to 1 + scale.
        displace: how far vertices are displaced, as a fraction of the width of the grid.
        displacement: "uniform": by up to that along each axis; "normal": with that deviation.
        noise: displacements in the buffer that all variants read.
        mirror: axes such as "x" or "xyz", along each of which half of the variants are mirrored.
        translate: part of the room on each side, 0 to 1, by which variants are moved.
        fill: the longest side fills the grid rather than the diagonal; without rotation.
        mode, surface, method, vote, parts, cavities: as for `voxmend.voxelize`.
        engine: who makes the voxels: "cpu"; "opengl", "opencl" or one that the command 'voxmend engines' lists, one variant
            after another; "auto": a GPU, or else the CPU. Variants have the same bits.

    A sampler may be used by one thread at a time; a call works with several, and other Python threads run meanwhile.
    """

    def __init__(self, resolution: int = 64, *, pad: int = 0, seed: int = 0, rotate: Any = None, scale: float = 0.0,
                 displace: float = 0.0, displacement: str = "uniform", noise: int = 65536, mirror: str = "",
                 translate: float = 0.0, fill: bool = False, mode: str = "solid", surface: str = "conservative",
                 method: str = "vote", vote: str = "auto", parts: str = "auto", cavities: str = "auto",
                 engine: Optional[str] = None):
        options = _core.new("vxm_sampler_options", resolution=resolution, pad=pad, seed=seed, scale=scale,
                            displace=displace, noise=noise, translate=translate, fill=fill)
        kept = self._set_rotation(options, rotate)
        options.displacement = _core.choice(displacement, "VXM_DISPLACEMENT_")
        for axis in mirror:
            if axis not in "xyz":
                raise _core.ArgumentError("sampler: mirror %r names other axes than x, y and z" % mirror)
            options.mirror |= 1 << "xyz".index(axis)
        voxelize = options.voxelize
        voxelize.mode = _core.choice(mode, "VXM_MODE_")
        voxelize.surface = _core.choice(surface, "VXM_SURFACE_")
        voxelize.method = _core.choice(method, "VXM_METHOD_")
        voxelize.vote = _core.choice(vote, "VXM_VOTE_")
        voxelize.parts = _core.choice(parts, "VXM_PARTS_")
        voxelize.cavities = _core.choice(cavities, "VXM_CAVITIES_")
        self._engine = ffi.NULL
        if engine not in (None, "cpu"):
            self._engine = _core.create("vxm_engine", lib.vxm_engine_create, _core.context(), engine.encode(), ffi.NULL,
                                        destroy=lib.vxm_engine_destroy)
        voxelize.engine = self._engine
        self._pointer = _core.create("vxm_sampler", lib.vxm_sampler_create, _core.context(), options,
                                     destroy=lib.vxm_sampler_destroy)
        del kept  # the library has copied it
        self.resolution = int(lib.vxm_sampler_space(self._pointer).dims[0])
        self._meshes: dict = {}

    @staticmethod
    def _set_rotation(options: Any, rotate: Any) -> Any:
        if rotate is None or (isinstance(rotate, str) and rotate == "none"):
            return None
        if isinstance(rotate, str) and rotate == "any":
            options.rotation = lib.VXM_ROTATION_ANY
            return None
        if isinstance(rotate, str):
            if rotate not in ("x", "y", "z"):
                raise _core.ArgumentError("sampler: rotate %r is none of any, x, y, z, an axis or matrices" % rotate)
            rotate = numpy.eye(3)["xyz".index(rotate)]
        values = numpy.ascontiguousarray(rotate, numpy.float64)
        if values.shape == (3,):
            options.rotation = lib.VXM_ROTATION_AXIS
            options.axis[0:3] = values.tolist()
            return None
        if values.ndim != 3 or values.shape[1:] != (3, 3):
            raise _core.ArgumentError("sampler: rotate has shape %s, neither (3,) nor (n, 3, 3)" % (values.shape,))
        options.rotation, options.rotation_count = lib.VXM_ROTATION_LIST, len(values)
        options.rotations = ffi.cast("double *", values.ctypes.data)
        return values

    def put(self, mesh: Optional[MeshLike], model: int = 0) -> None:
        """Puts a mesh in as number `model`; None takes the model out. Repair it before:
        `voxmend.repair(mesh, separate=True)`."""
        own = None if mesh is None else as_mesh(mesh)
        self._meshes.pop(model, None)
        _core.call(lib.vxm_sampler_put, self._pointer, model, ffi.NULL if own is None else own._pointer)
        if own is not None:
            self._meshes[model] = own  # the library looks at it as long as the model is there

    def shape(self, count: int, dtype: str = "float32") -> tuple:
        """Of an array of `count` variants."""
        d = self.resolution
        if dtype not in _VOXELS:
            raise _core.ArgumentError("sampler: dtype %r is none of float32, uint8, bits" % (dtype,))
        return (count, d, d, (d + 7) // 8) if dtype == "bits" else (count, 1, d, d, d)

    def batch(self, variants: Union[int, Sequence[int], numpy.ndarray], *, model: int = 0, epoch: int = 0,
              dtype: str = "float32", out: Optional[numpy.ndarray] = None) -> numpy.ndarray:
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
        names = numpy.arange(variants) if numpy.ndim(variants) == 0 else numpy.asarray(variants)
        if names.ndim == 1:
            names = numpy.stack([numpy.full(len(names), model), numpy.full(len(names), epoch), names], axis=1)
        if names.ndim != 2 or names.shape[1] != 3:
            raise _core.ArgumentError("sampler: variants have shape %s, neither (n,) nor (n, 3)" % (names.shape,))
        if names.size and (names.min() < 0 or names.max() > 0xFFFFFFFF):
            raise _core.ArgumentError("sampler: model, epoch and index are from 0 to 4294967295")
        names = numpy.ascontiguousarray(names, numpy.uint32)
        shape, kind = self.shape(len(names), dtype), numpy.float32 if dtype == "float32" else numpy.uint8
        if out is None:
            out = numpy.empty(shape, kind)
        if out.shape != shape or out.dtype != kind or not out.flags.c_contiguous or not out.flags.writeable:
            raise _core.ArgumentError("sampler: out is not a writeable C-contiguous array of %s of shape %s" %
                                      (numpy.dtype(kind).name, shape))
        _core.call(lib.vxm_sampler_batch, ffi.cast("void *", out.ctypes.data), self._pointer,
                   ffi.cast("vxm_variant *", names.ctypes.data), len(names), _VOXELS[dtype])
        return out

    def pose(self, index: int, *, model: int = 0, epoch: int = 0) -> dict:
        """How a variant lies, before its vertices are displaced.

        Returns:
            transform (3, 4): takes (x, y, z, 1) of the mesh to voxels; rotation (3, 3); scale (3,) in voxels per model
            unit, negative where mirrored; shift (3,) in voxels
        """
        out = ffi.new("vxm_pose *")
        variant = ffi.new("vxm_variant *", {"model": model, "epoch": epoch, "index": index})
        _core.call(lib.vxm_sampler_pose, out, self._pointer, variant)
        shapes = {"transform": (3, 4), "rotation": (3, 3), "scale": (3,), "shift": (3,)}
        return {key: numpy.array(list(getattr(out, key))).reshape(shape) for key, shape in shapes.items()}


