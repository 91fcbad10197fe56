/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file voxmend/engine.h
 * Engines: what makes the bits, the CPU or a device.
 */
#ifndef VOXMEND_ENGINE_H
#define VOXMEND_ENGINE_H

#include "voxmend/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Engines: what makes the bits ---- */

/** The CPU, a context of a graphics driver, or an OpenCL device. */
typedef struct vxm_engine vxm_engine;

/** What is known of an engine. */
typedef struct vxm_engine_info {
  size_t size;          /**< as the initializer sets it, or 0 */
  char name[48];        /**< such as "cpu", "opengl:osmesa" or "opencl:0" */
  bool available;       /**< it can be made and works */
  bool hardware;        /**< not a renderer in software */
  char renderer[128];   /**< as the driver says; "" if there is none */
  char version[128];    /**< of OpenGL or OpenCL, and of the driver */
  int64_t block_bytes;  /**< largest buffer that a shader may use; larger grids are made in tiles */
  int64_t viewport;     /**< columns that one pass draws along an axis; more are drawn in several */
  int64_t layers;       /**< of an array texture: slices drawn at a time */
  int subpixel_bits;    /**< of the rasterizer */
  bool int64;           /**< shaders have 64-bit integers, which VXM_GL_COLUMNS and the surface need */
  char attachment[16];  /**< format in which the XOR self-test passed: "r8ui", "r8" or "image"; "" = none */
  char platform[128];   /**< of OpenCL; "" for others, as all below is 0 */
  char driver[128];     /**< version of the OpenCL driver */
  int compute_units;    /**< of the device */
  int64_t global_bytes; /**< memory of the device */
  int64_t local_bytes;  /**< memory that a work-group shares */
  int64_t work_group;   /**< most work-items of a group */
  bool int64_atomics;   /**< not needed */
  bool moves;     /**< moves the vertices of variants for training (vxm_sampler) itself; else the CPU does */
  char note[256]; /**< why it is not available, or why another one was taken */
  char kind[16];  /**< of an OpenCL device: "cpu", "gpu", "accelerator" or "custom"; "" for others */
  int clock_mhz;  /**< highest clock rate that the device tells; 0 = it tells none */
  int64_t cache_bytes; /**< cache of its memory; 0 = none, or not told */
  bool shares_memory;  /**< device and host have the same memory */
  int devices;         /**< that work at once: 1, or of several those that have not failed */
  int lost_devices;    /**< of several those that have failed, whose work the others did; `note` says why */
} vxm_engine_info;

/** Initial value of vxm_engine_info. */
#define VXM_ENGINE_INFO_INIT                                                                             \
  {                                                                                                      \
    sizeof(vxm_engine_info), "", false, false, "", "", 0, 0, 0, 0, false, "", "", "", 0, 0, 0, 0, false, \
        false, "", "", 0, 0, false, 0, 0                                                                 \
  }

/** How an engine of OpenGL makes solids. */
typedef enum vxm_gl_method {
  VXM_GL_COLUMNS = 0, /**< one pass along an axis, a bit flipped for each crossing; the bits of the CPU */
  VXM_GL_SLICES,      /**< slice by slice, tetrahedra cut in a geometry shader (Ogayar et al.) */
  VXM_GL_TETRA_VERTEX /**< the same by a vertex program (Rueda et al.) */
} vxm_gl_method;

/** How an engine of OpenCL makes solids; both have the bits of the CPU (Schwarz & Seidel 2010, section 4). */
typedef enum vxm_cl_method {
  VXM_CL_AUTO =
      0, /**< by tiles on a GPU, where many parts meet or rows have 1024 voxels, else by triangles */
  VXM_CL_TRIANGLES, /**< a work-item for each triangle, which flips bits by atomic XOR; then a prefix XOR */
  VXM_CL_TILES      /**< triangles sorted by tiles of columns, a work-group for each tile, no atomics */
} vxm_cl_method;

/** Which device, and how it works. */
typedef struct vxm_engine_options {
  size_t size;             /**< as the initializer sets it */
  vxm_gl_method gl_method; /**< how OpenGL makes solids */
  int slice_axis; /**< across which axis the slicing methods cut: 0 = x, 1 = y, 2 = z (pictures count from 1)
                   */
  double displacement; /**< slicing methods: each vertex is moved at random by up to so many voxels along each
                          axis (Ogayar et al., section III-B1) */
  uint64_t seed;       /**< of these moves */
  vxm_cl_method cl_method; /**< how OpenCL makes solids */
  const char *device; /**< OpenCL: the number of a device, or a part of its name or its platform's; NULL = a
                         GPU or accelerator, else the first */
} vxm_engine_options;

/** Initial value of vxm_engine_options. */
#define VXM_ENGINE_OPTIONS_INIT \
  { sizeof(vxm_engine_options), VXM_GL_COLUMNS, 1, 0.0, 0, VXM_CL_AUTO, NULL }

/**
 * Makes an engine. One thread at a time may use it; many models may, one after another.
 *
 * Several devices work at once where names are joined by '+', as in "opencl:0+opencl:1+opengl:egl-device0",
 * or by "opencl:all" and "opengl:all", which are all that work. "opencl:0:2" is device 0 in two equal parts
 * (clCreateSubDevices), "opencl:0:2.1" the second of them. Slices of a grid, and variants of
 * vxm_sampler_batch and vxm_sampler_files, go to whichever device is free, more to the faster ones; the bits
 * are those of one. What a device that fails had left to do goes to the others.
 *
 * @param context whose memory limit counts what it holds
 * @param name    "cpu"; "opencl", on the device that the options choose; "opengl", which prefers a hardware
 * device, then EGL without a surface, then OSMesa; one of them by the name that vxm_engines_find gives; or
 * "auto": a GPU by OpenCL or OpenGL that works, else, and wherever it fails later, the CPU
 * @param options NULL = defaults
 * @return VXM_OK; VXM_ERROR_ARGUMENT for an unknown name; VXM_ERROR_UNAVAILABLE with what is missing;
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_engine_create(vxm_engine **out, vxm_context *context, const char *name,
                                     const vxm_engine_options *options, vxm_error *error);
/** Drops it; NULL is allowed. */
VXM_API void vxm_engine_destroy(vxm_engine *engine);
/** What the engine is, and under `note` what was taken in its place and why. */
VXM_API const vxm_engine_info *vxm_engine_describe(const vxm_engine *engine);
/**
 * Looks at every engine that this build knows, each tried out. Fills at most `capacity` of them, which lie as
 * far apart as the size of the first one says.
 *
 * @param[out] count how many there are
 * @return VXM_OK, VXM_ERROR_ARGUMENT, VXM_ERROR_MEMORY
 */
VXM_API vxm_status vxm_engines_find(vxm_engine_info *out, int64_t capacity, int64_t *count, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
