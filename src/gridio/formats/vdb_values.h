/* SPDX-License-Identifier: BSD-3-Clause */
/** The values of one node of a tree in a .vdb file: which are left out, how the others are packed. */
#ifndef VXM_GRIDIO_FORMATS_VDB_VALUES_H
#define VXM_GRIDIO_FORMATS_VDB_VALUES_H

#include "gridio/formats/vdb.h"
#include "gridio/formats/vdb_file.h"

/** Values of the largest node. */
enum { VXM_VDB_NODE_MAX = 32 * 32 * 32 };

/** Reads the values of the nodes of one grid. */
typedef struct vxm_vdb_values {
  const vxm_input *input;
  const vxm_vdb_grid *grid;
  vxm_error *error;
  float background;
  const vxm_vdb_functions *functions; /**< NULL until something is to be unpacked */
  /** Room for vxm_vdb_values_read: the packed values of a node as they are, and as they become. */
  struct vxm_vdb_room {
    unsigned char bytes[VXM_VDB_NODE_MAX * 4];
    float values[VXM_VDB_NODE_MAX];
  } * room;
} vxm_vdb_values;

/** Bytes of a value that stands alone. */
static inline size_t vxm_vdb_value_bytes(const vxm_vdb_grid *grid) {
  return grid->type == VXM_VDB_TYPE_FLOAT ? 4 : 1;
}

/** A value that stands alone; those of bool and mask are 0 or 1. */
float vxm_vdb_value_at(const vxm_vdb_grid *grid, const unsigned char *bytes);

/**
 * Goes behind the values of a node.
 *
 * @param at    offset of them, then of what follows
 * @param mask  the active ones, `count` bits
 * @param count 512, 4096 or 32768
 * @param out   count values; NULL = they are only skipped
 */
vxm_status vxm_vdb_values_read(vxm_vdb_values *values, size_t *at, const uint64_t *mask, size_t count,
                               float *out);

#endif
