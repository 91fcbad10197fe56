/* SPDX-License-Identifier: BSD-3-Clause */
/** PLY: the header, and the readers of the body that it describes. */
#ifndef VXM_MESHIO_FORMATS_PLY_H
#define VXM_MESHIO_FORMATS_PLY_H

#include "base/endian.h"
#include "meshio/common/tokenizer.h"

typedef enum vxm_ply_type {
  VXM_PLY_I8,
  VXM_PLY_U8,
  VXM_PLY_I16,
  VXM_PLY_U16,
  VXM_PLY_I32,
  VXM_PLY_U32,
  VXM_PLY_I64,
  VXM_PLY_U64,
  VXM_PLY_F32,
  VXM_PLY_F64
} vxm_ply_type;

/** What a property is to us. */
typedef enum vxm_ply_use {
  VXM_PLY_X,
  VXM_PLY_Y,
  VXM_PLY_Z,
  VXM_PLY_CORNERS, /**< the list of a face, or of a strip */
  VXM_PLY_OTHER
} vxm_ply_use;

typedef struct vxm_ply_property {
  uint8_t type;       /**< vxm_ply_type of the number, or of each number of the list */
  uint8_t count_type; /**< of the list's length */
  bool is_list;
  uint8_t use;     /**< vxm_ply_use */
  uint8_t channel; /**< 1, 2 and 3 for red, green and blue; 0 = none */
} vxm_ply_property;

typedef enum vxm_ply_role { VXM_PLY_VERTICES, VXM_PLY_FACES, VXM_PLY_STRIPS, VXM_PLY_PASSED } vxm_ply_role;

typedef struct vxm_ply_element {
  uint8_t role; /**< vxm_ply_role */
  bool has_list, has_corners;
  bool has_colors; /**< red, green and blue, none of them a list */
  uint64_t count;
  size_t first, properties; /**< its part of the header's properties */
  size_t least;             /**< bytes of one such element whose lists are empty */
  size_t name_at, name_length;
} vxm_ply_element;

typedef struct vxm_ply_header {
  bool ascii, big_endian;
  vxm_ply_element *elements;
  vxm_ply_property *properties;
  size_t element_count, element_capacity, property_count, property_capacity;
  uint64_t vertices;          /**< announced */
  vxm_text_defect no_corners; /**< elements of faces without a list of corners */
} vxm_ply_header;

/** How the reading of a body went. */
typedef struct vxm_ply_body {
  vxm_text_defect numbers, short_lines, long_lines, beyond, small_faces, bad_faces, bad_strips;
  const vxm_ply_element *cut; /**< the element within which the file ends, or NULL */
  uint64_t cut_done;          /**< how many of it were whole */
  const unsigned char *last;  /**< the last line of a text, if half a number there could be a mesh's */
  bool lines_counted;         /**< whether `few_lines` is known */
  bool by_tokens;             /**< those there are wider than an element, and not all alike */
  bool few_lines;             /**< a text has fewer lines than elements */
  bool faces_first;           /**< faces came before vertices, so that indices are checked at the end */
} vxm_ply_body;

size_t vxm_ply_size(vxm_ply_type type);

/** Whether the colours of an element are to be kept; if so what is full light is known from their type. */
bool vxm_ply_wants_colors(const vxm_soup *soup, const vxm_ply_header *header, const vxm_ply_element *element);

/** Reads the header; the cursor ends at the first byte of the body. */
vxm_status vxm_ply_read_header(vxm_tokenizer *scan, vxm_ply_header *header, vxm_error *error);
void vxm_ply_header_destroy(vxm_ply_header *header, vxm_context *context);

vxm_status vxm_ply_read_text(vxm_tokenizer *scan, const vxm_ply_header *header, vxm_ply_body *body,
                             vxm_error *error);
vxm_status vxm_ply_read_binary(vxm_tokenizer *scan, const vxm_ply_header *header, vxm_ply_body *body,
                               vxm_error *error);

/** Vertices that an index may name: those announced while they are still to come. */
static inline uint64_t vxm_ply_index_limit(const vxm_tokenizer *scan, const vxm_ply_header *header,
                                           const vxm_ply_body *body) {
  uint64_t announced = header->vertices < VXM_VERTICES_MAX ? header->vertices : VXM_VERTICES_MAX;
  return body->faces_first ? announced : scan->soup->vertex_count;
}

/**
 * A triangle strip that is being taken apart: -1 begins a new one, every second triangle is turned round.
 */
typedef struct vxm_ply_strip {
  uint32_t a, b;  /**< the last two corners */
  uint64_t count; /**< corners since the beginning */
} vxm_ply_strip;

/** Takes the next number of a strip; degenerate triangles, which strips use to turn, are left out. */
vxm_status vxm_ply_strip_add(vxm_ply_strip *strip, vxm_soup *soup, int64_t index, uint64_t limit,
                             const unsigned char *at, vxm_ply_body *body, vxm_error *error);

#endif
