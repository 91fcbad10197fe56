/* SPDX-License-Identifier: BSD-3-Clause */
/** What the readers of OFF share: the header, in text and in binary files. */
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

/** Skips blanks, line ends and comments; false at the end of the file. */
static inline bool vxm_off_skip_to_data(vxm_tokenizer *scan) {
  while (vxm_skip_space(scan) && *scan->at == '#')
    vxm_skip_line(scan);
  return scan->at < scan->end;
}

/** Reads the word, if there is one, and the number of dimensions; the cursor ends before the counts, or
 * behind the line of OFF BINARY. */
vxm_status vxm_off_read_header(vxm_tokenizer *scan, vxm_off_header *header, vxm_error *error);
/** Reads the counts of a text. What follows them on their line is the number of edges, whatever it is; it
 * says nothing and is often left out. */
vxm_status vxm_off_read_counts(vxm_tokenizer *scan, const vxm_off_header *header, uint64_t *vertices,
                               uint64_t *faces, vxm_error *error);
/** Reads what follows the words OFF BINARY and their line end. */
vxm_status vxm_off_read_binary(vxm_tokenizer *scan, vxm_off_header *header, vxm_error *error);

#endif
