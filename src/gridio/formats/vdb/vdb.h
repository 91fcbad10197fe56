/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The module "openvdb": what the library asks of OpenVDB, as a table of functions.
 *
 * A grid of OpenVDB is a tree whose leaves are blocks of 8 x 8 x 8 voxels; constant blocks, 8, 128 or 4096
 * voxels wide, are tiles of the nodes above. To write one the library makes the blocks, and OpenVDB the tree
 * and the file, in our process. Files are read in a process of their own (sandbox/reader_process.h), because
 * OpenVDB trusts them: a damaged one may crash it.
 */
#ifndef VXM_GRIDIO_FORMATS_VDB_VDB_H
#define VXM_GRIDIO_FORMATS_VDB_VDB_H

#include "base/module.h"
#include "base/output.h"
#include "sandbox/reader.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Voxels along a block, and in it. */
enum { VXM_VDB_SIDE = VXM_SINK_SIDE, VXM_VDB_VOXELS = VXM_SINK_VOXELS };

/** Under which the name of a grid is carried along with its values. */
#define VXM_VDB_NAME_KEY "vdb_name"

typedef enum vxm_vdb_content {
  VXM_VDB_BITS,      /**< a BoolGrid: active and true where a voxel is set */
  VXM_VDB_LEVEL_SET, /**< signed distances; active where they are between -background and background */
  VXM_VDB_FOG,       /**< shares; active where they are not the background, which is 0 */
  VXM_VDB_NUMBERS    /**< of another kind; active where they are not the background */
} vxm_vdb_content;

typedef struct vxm_vdb_kind {
  vxm_vdb_content content;
  const char *name;
  float background; /**< value of voxels that are not there */
  /** Keys and values in turn, which become metadata; NULL ends them, and stands for none. */
  const char *const *texts;
} vxm_vdb_kind;

/** A grid of OpenVDB in the making. */
typedef struct vxm_vdb vxm_vdb;

/** Each block of a grid may be given once, in any order. All `at` are multiples of 8 and not negative. */
typedef struct vxm_vdb_functions {
  vxm_reader reader; /**< first: to the reading process the table is this alone */
  /** Whether OpenVDB can hold a grid in this place, with voxels of this size. @return VXM_OK,
   * VXM_ERROR_RANGE, VXM_ERROR_MEMORY */
  vxm_status (*check)(const vxm_space *space, vxm_error *error);
  /** @return VXM_OK, VXM_ERROR_MEMORY */
  vxm_status (*create)(vxm_vdb **out, vxm_context *context, const vxm_vdb_kind *kind, const vxm_space *space,
                       vxm_error *error);
  void (*destroy)(vxm_vdb *vdb);
  /** A block of bits: voxel (x,y,z) of it is bit 8 y + z of word x. */
  vxm_status (*put_bits)(vxm_vdb *vdb, const int64_t at[3], const uint64_t bits[8], vxm_error *error);
  /** A block of numbers, z fastest, then y, then x. */
  vxm_status (*put_numbers)(vxm_vdb *vdb, const int64_t at[3], const float numbers[VXM_VDB_VOXELS],
                            vxm_error *error);
  /** A cube of voxels that are alike: set, or of this number. Its side is 8 times a power of 2. */
  vxm_status (*put_cube)(vxm_vdb *vdb, const int64_t at[3], int64_t side, float number, vxm_error *error);
  /**
   * Writes the file, and reports progress. The same grid gives the same bytes.
   *
   * @return VXM_OK; VXM_ERROR_IO without a message if a write failed, as committing the output tells the
   *         reason; VXM_ERROR_CANCELLED, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
   */
  vxm_status (*write)(vxm_vdb *vdb, vxm_output *output, vxm_error *error);
} vxm_vdb_functions;

extern const vxm_module_need vxm_vdb_need;

/** Opens the module. @return VXM_OK; VXM_ERROR_UNAVAILABLE, which names what to install */
vxm_status vxm_vdb_open(const vxm_vdb_functions **out, vxm_error *error);
/** Opens it to write a grid. @return as vxm_vdb_open; VXM_ERROR_RANGE for voxels that OpenVDB does not take
 */
vxm_status vxm_vdb_open_writer(const vxm_vdb_functions **out, const vxm_space *space, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
