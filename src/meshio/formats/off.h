/* SPDX-License-Identifier: BSD-3-Clause */
/** What the text and the binary reader of OFF share: the first word. */
#ifndef VXM_MESHIO_FORMATS_OFF_H
#define VXM_MESHIO_FORMATS_OFF_H

#include "meshio/common/tokenizer.h"

/**
 * The first word, [ST][C][N][4][n]OFF in any order (geomview's manual, "OFF Files"): what each vertex has
 * beside its position. The counts may be glued to it.
 */
typedef struct vxm_off_header {
  bool textures, colours, normals, four, n_dimensional, binary;
  bool missing;            /**< no such word: the counts come first, which geomview allows */
  size_t dimension;        /**< numbers of a position */
  const unsigned char *at; /**< where the header begins */
} vxm_off_header;

/** Numbers of a vertex behind its position. */
static inline size_t vxm_off_extras(const vxm_off_header *header) {
  return (header->normals ? 3u : 0u) + (header->colours ? 4u : 0u) + (header->textures ? 2u : 0u);
}

/** What is kept of the colours of a soup: NULL for nothing. */
static inline vxm_gathered *vxm_off_vertex_colors(const vxm_soup *soup, const vxm_off_header *header) {
  return soup->appearance && header->colours ? &soup->appearance->vertices : NULL;
}

/** Reads what follows the words OFF BINARY and their line end. */
vxm_status vxm_off_read_binary(vxm_tokenizer *scan, vxm_off_header *header, vxm_error *error);

#endif
