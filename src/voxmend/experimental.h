/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file voxmend/experimental.h
 * What may change from one version to the next, and is in no other header: which instructions are used,
 * voxels that stay on a device, and published methods, for comparison.
 */
#ifndef VOXMEND_EXPERIMENTAL_H
#define VOXMEND_EXPERIMENTAL_H

#include "voxmend/engine.h"
#include "voxmend/grid.h"
#include "voxmend/sampler.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Which instructions are used ---- */

/** Vectors of a processor: the inner loops are built for each, with the same results bit for bit. */
typedef enum vxm_cpu_level {
  VXM_CPU_PLAIN = 0, /**< those that every processor of its kind has: of x86-64, SSE2 */
  VXM_CPU_AVX2,      /**< x86-64 with AVX2 and BMI2 */
  VXM_CPU_AVX512     /**< with AVX-512 F, CD, DQ, BW and VL besides */
} vxm_cpu_level;

/** The highest level that this processor, and this build of the library, have. */
VXM_API vxm_cpu_level vxm_cpu_highest(void);
/** The highest level that is used: vxm_cpu_highest, unless it was limited. */
VXM_API vxm_cpu_level vxm_cpu_used(void);
/**
 * Limits what is used, in the whole process, to see what other processors would give. While nothing runs.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT for what is no level; VXM_ERROR_UNAVAILABLE for one above
 * vxm_cpu_highest
 */
VXM_API vxm_status vxm_cpu_limit(vxm_cpu_level level, vxm_error *error);

/* ---- Published methods, for comparison ---- */

/** Methods of the papers that this library was measured against, plainly and by one thread of the CPU: they
 * show by how much a method is slower, or sets other voxels (doc/papers.md). */
typedef enum vxm_baseline {
  VXM_BASELINE_FANG_CHEN = 0, /**< slices of the whole mesh along x, y and z, of which two decide */
  VXM_BASELINE_CHEN_TU, /**< the same for each group of connected vertices; united along each axis first */
  VXM_BASELINE_TETRA_LISTED, /**< XOR of tetrahedra, slice by slice, of those that a slice meets (Rueda et
                                al.: HA) */
  VXM_BASELINE_TETRA_FULL,   /**< all tetrahedra asked in each slice (Rueda et al.: DL), made once (Ogayar et
                                al.: precomputed) */
  VXM_BASELINE_TETRA_ANEW,   /**< all triangles in each slice, whose tetrahedra are made there (Ogayar et al.)
                              */
  VXM_BASELINE_TETRA_LAYERS, /**< each tetrahedron once, into all of its slices (Ogayar et al.: single pass)
                              */
  VXM_BASELINE_DENSITY,     /**< a density that falls with the distance from the surface (Sramek & Kaufman) */
  VXM_BASELINE_SIMPLE,      /**< each triangle asks all voxels of its box (Schwarz & Seidel, section 3.2) */
  VXM_BASELINE_SPECIALIZED, /**< boxes of one, two and three dimensions, and the axis of the normal, apart */
  VXM_BASELINE_SORTED,      /**< the same with the triangles sorted by that first */
  VXM_BASELINE_ZHANG,       /**< conservative rasterization with a range of depth (Zhang et al.) */
  VXM_BASELINE_EISEMANN /**< each triangle flips all voxels behind it, word by word (Eisemann & Decoret) */
} vxm_baseline;

/** Which method, and how. */
typedef struct vxm_baseline_options {
  size_t size;         /**< as the initializer sets it */
  vxm_baseline method; /**< which */
  bool
      thin; /**< of the simple, specialized and sorted one: the 6-separating surface, else the conservative */
  double radius;    /**< of the density: voxels from the surface within which it is above 0; 0 = 1.8 */
  uint8_t *density; /**< NULL, or room for a byte per voxel, x fastest: 255 on the surface */
} vxm_baseline_options;

/** Initial value of vxm_baseline_options. */
#define VXM_BASELINE_OPTIONS_INIT \
  { sizeof(vxm_baseline_options), VXM_BASELINE_FANG_CHEN, false, 0.0, NULL }

/** What a baseline came to. What a method does not have is 0. */
typedef struct vxm_baseline_report {
  size_t size;       /**< as the initializer sets it, or 0 */
  double setup_ms;   /**< before the first voxel: groups, tetrahedra, sorting */
  double fill_ms;    /**< making the voxels */
  int64_t triangles; /**< polygons are cut into triangles */
  int64_t parts;     /**< groups of connected vertices that have faces */
  int64_t rounds;    /**< passes over the faces until groups stay as they are */
  int64_t tests;     /**< of a triangle, tetrahedron or column against a voxel or slice */
  int64_t sections;  /**< triangles that were drawn into slices */
  int64_t boxes[3];  /**< triangles whose box is longer than a voxel along one axis at most, two, three */
  uint64_t bytes;    /**< held beside the mesh and the grid */
} vxm_baseline_report;

/** Initial value of vxm_baseline_report. */
#define VXM_BASELINE_REPORT_INIT \
  { sizeof(vxm_baseline_report), 0.0, 0.0, 0, 0, 0, 0, 0, {0, 0, 0}, 0 }

/**
 * Voxelizes a mesh by a published method: all bits of the grid are replaced. Of a closed mesh that lies
 * within the grid the solids are those of VXM_SPLIT_MODE_GROUP or VXM_SPLIT_MODE_WHOLE without thin parts;
 * the simple, specialized and sorted surfaces are those of VXM_MODE_SURFACE; the density's voxels, those
 * within half of its radius, and Zhang's are these and more.
 *
 * @param grid        says the space
 * @param[out] report may be NULL
 * @param mesh        as for vxm_voxelize
 * @param options     NULL = defaults
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_EMPTY without triangles; VXM_ERROR_RANGE where a triangle is
 *         longer than 2^20 steps of the lattice, which is the grid's length up to 1024 voxels;
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED. After a failure the content of the
 *         grid is unspecified
 */
VXM_API vxm_status vxm_baseline_voxelize(vxm_grid *grid, vxm_baseline_report *report, const vxm_mesh *mesh,
                                         const vxm_baseline_options *options, vxm_error *error);

/* ---- Stages of the work on an OpenCL device ---- */

/** How long stages took, in milliseconds, and what they had to do: those of Schwarz & Seidel 2010, table 2
 * (solids by VXM_CL_TILES) and table 3 (octrees). */
typedef struct vxm_engine_stages {
  size_t size;         /**< as the initializer sets it, or 0 */
  double pairs_ms;     /**< listing tiles of columns and the triangles that may cover them */
  double sort_ms;      /**< sorting that list by tile */
  double tiles_ms;     /**< filling the tiles */
  int64_t pairs;       /**< of a tile and a triangle */
  int64_t tiles;       /**< of columns, with triangles or without */
  double active_ms;    /**< finding the nodes that the surface meets */
  double construct_ms; /**< the octree above them */
  double voxelize_ms;  /**< flips of the lowest level */
  double propagate_ms; /**< carrying them along x, through all levels */
  double prune_ms;     /**< leaving out what is all empty or full, and reading back the rest */
  int64_t active;      /**< nodes that the surface meets, of 16^3 voxels */
  int64_t nodes;       /**< of all levels, before any is left out */
} vxm_engine_stages;

/** Initial value of vxm_engine_stages. */
#define VXM_ENGINE_STAGES_INIT \
  { sizeof(vxm_engine_stages), 0.0, 0.0, 0.0, 0, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0, 0 }

/**
 * Tells how long stages took since the last call, and whether those to come are measured: the device is then
 * waited for after each, which makes the whole slower. At first they are not.
 *
 * @param[out] out may be NULL; all 0 where nothing was measured
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_UNAVAILABLE for an engine that is not of OpenCL
 */
VXM_API vxm_status vxm_engine_measure(vxm_engine_stages *out, vxm_engine *engine, bool measure,
                                      vxm_error *error);
/* ---- Voxels that stay on a device ---- */

struct DLManagedTensor; /* of dlpack.h, which whoever takes one includes */

/** Voxels in the memory of an OpenCL device or in a texture of OpenGL, for who goes on with them there. They
 * do not change. */
typedef struct vxm_device_voxels vxm_device_voxels;

/** What holds voxels that stay. */
typedef enum vxm_device_kind {
  VXM_DEVICE_OPENCL = 0, /**< a buffer */
  VXM_DEVICE_EGL,        /**< a 3D texture in a context of EGL */
  VXM_DEVICE_OSMESA      /**< the same of OSMesa */
} vxm_device_kind;

/**
 * Where voxels are, and how they lie.
 *
 * In a buffer voxel (i,j,k) of variant v is the element, or with VXM_VOXEL_FORMAT_PACKED the bit k % 8 of the
 * byte k / 8, of the row that begins at byte v * step[0] + i * step[1] + j * step[2]: [v][x][y][z] in C
 * order. Packed rows have whole words of 64 bits, little-endian; bits beyond the last voxel are 0.
 *
 * In a texture voxel (i,j,k) is texel (i,j,k): GL_R8UI with 0 and 1, or GL_R32F with 0 and 1, which can be
 * filtered; or packed the bit i % 32 of texel (i / 32, j, k) of GL_R32UI.
 */
typedef struct vxm_device_info {
  size_t size;             /**< as the initializer sets it, or 0 */
  vxm_device_kind kind;    /**< what holds the voxels */
  vxm_voxel_format format; /**< what each is */
  int64_t count;           /**< variants one behind the other; 1 of a model, and in a texture */
  int64_t dims[3];         /**< voxels along x, y, z */
  int64_t step[3];         /**< bytes from a variant to the next, along x and along y; 0 in a texture */
  int64_t bytes;           /**< of the buffer, or of the texture's texels */
  bool stayed;   /**< made on the device alone; else the CPU had a share in them, and they were sent there */
  int device;    /**< number of the OpenCL device, N of "opencl:N"; 0 of others */
  void *buffer;  /**< cl_mem; NULL for a texture */
  void *context; /**< cl_context, EGLContext or OSMesaContext */
  void *queue;   /**< cl_command_queue of the engine, in order, with nothing under way; else NULL */
  void *device_id;         /**< cl_device_id; else NULL */
  void *display;           /**< EGLDisplay; else NULL */
  uint32_t texture;        /**< its name; 0 for a buffer */
  uint32_t texture_format; /**< GL_R8UI, GL_R32F or GL_R32UI; 0 for a buffer */
  int64_t texels[3];       /**< of a texture */
} vxm_device_info;

/** Initial value of vxm_device_info. */
#define VXM_DEVICE_INFO_INIT                                                                                \
  {                                                                                                         \
    sizeof(vxm_device_info), VXM_DEVICE_OPENCL, VXM_VOXEL_FORMAT_PACKED, 0, {0, 0, 0}, {0, 0, 0}, 0, false, \
        0, NULL, NULL, NULL, NULL, NULL, 0, 0, {                                                            \
      0, 0, 0                                                                                               \
    }                                                                                                       \
  }

/**
 * Voxelizes a model where its engine is, and leaves the voxels there: those of vxm_model_voxelize.
 *
 * They never leave the device if all parts are closed or one method decides them (VXM_METHOD_X and the like,
 * or a vote by majority, any or all), thin parts are not looked after (VXM_THIN_DROP) and no shell is asked
 * for. Else the CPU completes them as ever, and they are sent to the device; `stayed` tells.
 *
 * @param[out] out  owned by the caller (vxm_device_voxels_destroy)
 * @param model     with an engine of one OpenCL device, or of OpenGL; without confidence
 * @param transform as for vxm_model_voxelize; NULL = none
 * @return as vxm_model_voxelize; VXM_ERROR_UNAVAILABLE where there is no such engine; VXM_ERROR_RANGE for
 * more than the device gives to a buffer, or a texture has along an axis
 */
VXM_API vxm_status vxm_model_voxelize_device(vxm_device_voxels **out, vxm_model *model,
                                             const vxm_space *space, const double transform[12],
                                             vxm_voxel_format format, vxm_error *error);
/**
 * The voxels of vxm_sampler_batch in a buffer of the OpenCL device that is the sampler's engine.
 *
 * @return as vxm_sampler_batch and vxm_model_voxelize_device; VXM_ERROR_ARGUMENT for no variants,
 * and where the sampler makes densities (vxm_sampler_options.coverage)
 */
VXM_API vxm_status vxm_sampler_batch_device(vxm_device_voxels **out, vxm_sampler *sampler,
                                            const vxm_variant *variants, size_t count,
                                            vxm_voxel_format format, vxm_error *error);
/**
 * Tells where voxels are. The handles are those of the voxels: who needs them longer retains them
 * (clRetainMemObject), or takes a DLPack. All work on them is done. A texture is in the context of the
 * engine, which makes it current only while it works, in the thread that called; others may do so between
 * that, and have to leave nothing bound that they do not delete.
 *
 * @return VXM_OK, VXM_ERROR_ARGUMENT
 */
VXM_API vxm_status vxm_device_voxels_describe(vxm_device_info *out, const vxm_device_voxels *voxels,
                                              vxm_error *error);
/**
 * The voxels of a buffer as a DLPack tensor, on kDLOpenCL with the number of the device, its data the cl_mem:
 * unsigned bytes or floats as [x][y][z], of packed voxels unsigned bytes as [x][y][(z + 7) / 8] with the
 * steps of rows; of a sampler [variant] before that. It holds the buffer until its deleter is called, from
 * any thread, also when the voxels and the engine are gone.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_UNAVAILABLE for a texture, for which DLPack has no name;
 * VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_device_voxels_dlpack(struct DLManagedTensor **out, vxm_device_voxels *voxels,
                                            vxm_error *error);
/** Drops them: a buffer when nobody else holds it, from any thread; a texture at once, from the thread that
 * may use its engine, which stays until then. NULL is allowed. */
VXM_API void vxm_device_voxels_destroy(vxm_device_voxels *voxels);

/* ---- A published OpenCL program, for comparison ---- */

/** The voxels of a mesh in the memory of an OpenCL device, made by the program of Faieghi, Tutunea-Fatan and
 * Eagleson, "Fast and cross-vendor OpenCL-based implementation for voxelization of triangular mesh models".
 */
typedef struct vxm_published vxm_published;

/** How the published program works. */
typedef struct vxm_published_options {
  size_t size;       /**< as the initializer sets it */
  double voxel_size; /**< model units; has no default */
  bool by_voxel; /**< a work-item for each voxel, over all facets until one meets it (their approach 1); else
                    one for each facet, over the voxels of its box (approach 2, their figure 5) */
  bool count_tests; /**< count the intersection tests as well, which costs memory on the device: 4 bytes per
                       voxel or 8 per facet */
  uint8_t material; /**< what a voxel gets that the surface touches; 0 = 1. Others are 0 */
} vxm_published_options;

/** Initial value of vxm_published_options. */
#define VXM_PUBLISHED_OPTIONS_INIT \
  { sizeof(vxm_published_options), 0.0, false, false, 0 }

/** What a run of the published program came to. */
typedef struct vxm_published_report {
  size_t size;        /**< as the initializer sets it, or 0 */
  double kernel_ms;   /**< of the kernel alone, by the device's own clock where `profiled` */
  bool profiled;      /**< the device has profiling events; else times are the host's */
  int64_t triangles;  /**< polygons are cut into triangles */
  int64_t work_group; /**< work-items of a group: as many as the device lets the kernel have (section 3.4) */
  int64_t tests;      /**< tests of a facet against a voxel, as in their table 1; 0 = not counted */
} vxm_published_report;

/** Initial value of vxm_published_report. */
#define VXM_PUBLISHED_REPORT_INIT \
  { sizeof(vxm_published_report), 0.0, false, 0, 0, 0 }

/** How voxels come from the device to the host; their figure 7 compares the two. */
typedef enum vxm_transfer {
  VXM_TRANSFER_MAP = 0, /**< clEnqueueMapBuffer */
  VXM_TRANSFER_READ     /**< clEnqueueReadBuffer */
} vxm_transfer;

/**
 * Brings the triangles of a mesh to a device, nine 32-bit floats for each (section 3.1), and makes room for a
 * byte for each voxel of the mesh's bounding box. All is in floats, as published: far from the origin, or
 * where voxels are small against coordinates, voxels at the edge of triangles may differ from
 * vxm_model_voxelize's conservative surface, which is exact.
 *
 * @param[out] out   owned by the caller (vxm_published_destroy); the engine must outlive it, the mesh need
 * not
 * @param[out] space what the grid covers; may be NULL. Its origin is the minimum of the vertices
 * @param engine     an engine of OpenCL
 * @param mesh       polygons in model units; need not be closed
 * @param options    not NULL: the voxel size has to be told
 * @return VXM_OK; VXM_ERROR_ARGUMENT for a voxel size that is not a positive number; VXM_ERROR_UNAVAILABLE
 * for an engine that is not of OpenCL; VXM_ERROR_EMPTY without triangles; VXM_ERROR_RANGE for a vertex that
 * is no finite float, for more than 2^24 voxels along an axis, or for more bytes than the device gives to a
 *         buffer; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT (what is on the device counts, too)
 */
VXM_API vxm_status vxm_published_create(vxm_published **out, vxm_space *space, vxm_engine *engine,
                                        const vxm_mesh *mesh, const vxm_published_options *options,
                                        vxm_error *error);
/**
 * Sets the voxels on the device. Both approaches set the same ones.
 *
 * @param[out] report may be NULL
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_UNAVAILABLE, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_published_voxelize(vxm_published_report *report, vxm_published *published,
                                          vxm_error *error);
/**
 * Brings the voxels to the host.
 *
 * @param[out] voxels a byte per voxel, x fastest, then y, then z (their equation 3.2); NULL = only map them
 * @param[out] ms     time of the transfer alone, as kernel_ms; may be NULL. What is mapped is copied off the
 * clock
 * @return VXM_OK; VXM_ERROR_ARGUMENT for no voxels with VXM_TRANSFER_READ; VXM_ERROR_MEMORY,
 *         VXM_ERROR_UNAVAILABLE
 */
VXM_API vxm_status vxm_published_read(uint8_t *voxels, double *ms, vxm_published *published, vxm_transfer how,
                                      vxm_error *error);
/** NULL is allowed. */
VXM_API void vxm_published_destroy(vxm_published *published);

#ifdef __cplusplus
}
#endif
#endif
