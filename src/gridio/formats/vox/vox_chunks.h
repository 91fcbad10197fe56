/* SPDX-License-Identifier: BSD-3-Clause */
/** The chunks of a .vox file: its models, the nodes of its scene, its palette. All lies in the bytes of the
 * file. */
#ifndef VXM_GRIDIO_FORMATS_VOX_VOX_CHUNKS_H
#define VXM_GRIDIO_FORMATS_VOX_VOX_CHUNKS_H

#include "base/file.h"

typedef struct vxm_vox_model {
  int64_t size[3];
  const unsigned char *voxels; /**< x, y, z and number of the palette of each */
  size_t count;
} vxm_vox_model;

typedef enum vxm_vox_node_type { VXM_VOX_TRANSFORM, VXM_VOX_GROUP, VXM_VOX_SHAPE } vxm_vox_node_type;

/** Content that was checked as far as `at`, behind the number. */
typedef struct vxm_vox_node {
  int32_t number;
  vxm_vox_node_type type;
  bool is_taken; /**< it has its place in the scene */
  const unsigned char *at, *end;
} vxm_vox_node;

typedef struct vxm_vox_file {
  vxm_context *context;
  const vxm_input *input;
  vxm_vox_model *models;
  size_t model_count, model_capacity;
  vxm_vox_node *nodes; /**< by number */
  size_t node_count, node_capacity;
  const unsigned char
      *palette; /**< of 256 colours as red, green, blue, alpha: that of number 1 first; NULL = none */
} vxm_vox_file;

/** @return VXM_OK; VXM_ERROR_FORMAT with the byte offset; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_vox_file_read(vxm_vox_file *out, const vxm_input *input, vxm_error *error);
void vxm_vox_file_destroy(vxm_vox_file *file);
/** The node of a number, or NULL. */
vxm_vox_node *vxm_vox_node_find(const vxm_vox_file *file, int32_t number);

/** Takes a number; false at the end. */
bool vxm_vox_take(int32_t *out, const unsigned char **at, const unsigned char *end);
/** Steps over a dictionary. */
bool vxm_vox_skip_pairs(const unsigned char **at, const unsigned char *end);
/** The value of a key in the dictionary at `at`, cut to the room of `out`; false if there is none. */
bool vxm_vox_find(char *out, size_t room, const unsigned char *at, const unsigned char *end, const char *key);

#endif
