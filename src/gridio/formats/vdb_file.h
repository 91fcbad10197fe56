/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * What stands before the tree in a .vdb file: header, metadata and transform. Every length in the file is
 * checked before it is used.
 */
#ifndef VXM_GRIDIO_FORMATS_VDB_FILE_H
#define VXM_GRIDIO_FORMATS_VDB_FILE_H

#include "gridio/common/values.h"

/** Under which the name of a grid is carried along. */
#define VXM_VDB_NAME_KEY "vdb_name"

typedef enum vxm_vdb_type { VXM_VDB_TYPE_BOOL, VXM_VDB_TYPE_MASK, VXM_VDB_TYPE_FLOAT } vxm_vdb_type;

/** How values are packed, bits of `compression`. */
enum { VXM_VDB_ZIP = 1, VXM_VDB_ACTIVE_ONLY = 2, VXM_VDB_BLOSC = 4 };

/** The grid of a file that is read. */
typedef struct vxm_vdb_grid {
  char name[64];
  vxm_vdb_type type;
  bool is_half; /**< numbers of 16 bits */
  uint32_t compression;
  vxm_about about;   /**< destroyed by the caller, also after a failure */
  vxm_scalar scalar; /**< of the numbers before they became floats */
  double size[3];    /**< of a voxel */
  double first[3];   /**< centre of the voxel with index 0 0 0 */
  bool has_space;    /**< voxmend has written it, for this voxel size */
  vxm_space space;
  size_t tree; /**< offset */
} vxm_vdb_grid;

bool vxm_vdb_sniff(const vxm_input *input);
/** Finds the first grid that can be read, and sets out->about in any case. VXM_ERROR_FORMAT with the offset
 * of what is wrong. */
vxm_status vxm_vdb_file_read(vxm_vdb_grid *out, const vxm_input *input, vxm_warnings *warnings,
                             vxm_error *error);

#endif
