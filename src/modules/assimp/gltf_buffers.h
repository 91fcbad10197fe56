/* SPDX-License-Identifier: BSD-3-Clause */
/** The numbers of a glTF file: accessors, and the buffers behind them. */
#ifndef VXM_MODULES_ASSIMP_GLTF_BUFFERS_H
#define VXM_MODULES_ASSIMP_GLTF_BUFFERS_H

#include <jansson.h>

#include "sandbox/reader.h"

/** A buffer that was asked for. */
typedef struct vxm_gltf_buffer {
  const unsigned char *data;
  unsigned char *owned; /**< what to free; NULL within the file itself */
  size_t size;
  bool asked;
} vxm_gltf_buffer;

/** Buffers are read when they are first needed. Start from the first five members, end with
 * vxm_gltf_buffers_destroy. */
typedef struct vxm_gltf_buffers {
  const json_t *root;
  const vxm_reader_request *request;
  vxm_context *context;
  const unsigned char *binary; /**< that of a .glb, which the first buffer is if it has no name; or NULL */
  size_t binary_size;
  vxm_gltf_buffer *list;
  size_t count;
  size_t size; /**< the bytes of all that were asked for */
} vxm_gltf_buffers;

enum { VXM_GLTF_BYTE = 5120, VXM_GLTF_FLOAT = 5126 };

/** Where the elements of an accessor lie. */
typedef struct vxm_gltf_elements {
  const unsigned char *data;
  size_t count, stride;
  unsigned components; /**< numbers of each */
  unsigned bytes;      /**< of a number */
  bool is_signed, is_normalized;
} vxm_gltf_elements;

/**
 * Finds an accessor's elements, which are whole numbers of 8 or 16 bits.
 *
 * @return NULL, or why it cannot be read
 */
const char *vxm_gltf_find_elements(vxm_gltf_elements *out, vxm_gltf_buffers *buffers, const json_t *accessor);

/** Number `component` of an element, as the file means it. */
float vxm_gltf_number(const vxm_gltf_elements *elements, size_t element, unsigned component);

void vxm_gltf_buffers_destroy(vxm_gltf_buffers *buffers);

#endif
