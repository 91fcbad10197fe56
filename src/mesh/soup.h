/* SPDX-License-Identifier: BSD-3-Clause */
/** The polygon soup: what all folders after this one work on. A vxm_mesh of the public header is a soup. */
#ifndef VXM_MESH_SOUP_H
#define VXM_MESH_SOUP_H

#include "base/context.h"
#include "base/warnings.h"
#include "mesh/appearance.h"
#include "voxmend/repair.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Vertices are numbered by uint32_t to halve the memory; the largest number is kept free as "none". */
#define VXM_NO_VERTEX UINT32_MAX
#define VXM_VERTICES_MAX ((size_t)UINT32_MAX - 1)

typedef struct vxm_mesh vxm_soup;

/**
 * Invariants: offsets[0] = 0, offsets do not decrease, offsets[face_count] = corner_count,
 * indices[c] < vertex_count. A face may have any number of corners, also fewer than 3, and may repeat a
 * corner: that is for the census to count and for repair to remove. Positions may be NaN or infinite.
 */
struct vxm_mesh {
  vxm_context *context; /**< one reference held */
  double *positions;    /**< vertex_count x 3 */
  uint64_t *offsets;    /**< face_count + 1; never NULL in a finished soup */
  uint32_t *indices;    /**< corner_count; never NULL, so that vxm_face is fine without corners */
  uint32_t *face_tags;  /**< face_count, or NULL when tag_count is 0 */
  char **tags;          /**< tag_count names, each a block of the context */
  size_t vertex_count, face_count, corner_count, tag_count;
  size_t vertex_capacity, face_capacity, corner_capacity, tag_capacity; /**< room while a soup grows */
  const char *format;                                                   /**< static text, such as "off" */
  vxm_warnings warnings;
  char **companions; /**< companion_count names of other files that were opened to read it, each a block */
  size_t companion_count, companion_capacity;
  vxm_appearance *appearance; /**< of the faces as they were read; made before reading where it is wanted */
  uint32_t
      *face_parts; /**< face_count: the part of the mesh that was repaired which each comes from, or NULL */
  vxm_part_change *part_changes; /**< part_count, or NULL */
  vxm_part_state *part_states;   /**< what they point to: all before, then all after */
  size_t part_count;
  uint32_t *face_sets; /**< face_count, or NULL: sets of faces that have nothing to do with each other
                          (mesh/face_sets.h); those of one share no vertex with others */
  size_t set_count;    /**< numbered from 0 */
  /* What a repair has found out on its way, so that nobody has to look for it again. */
  size_t component_count; /**< as vxm_components counts them; 0 = not known */
  uint32_t *components;   /**< face_count, as vxm_components numbers them; NULL unless there are several */
  bool is_closed;         /**< known to have no edge with an odd number of sides */
};

/** An empty soup in a context (NULL = a new one). */
vxm_status vxm_soup_create(vxm_soup **out, vxm_context *context, const char *format, vxm_error *error);
/** Same as vxm_mesh_destroy; NULL is allowed. */
void vxm_soup_destroy(vxm_soup *soup);
/** Copies all but the appearance and companions, which are those of the mesh as read, sets of faces, and what
 * a repair has found out; warnings included. */
vxm_status vxm_soup_copy(vxm_soup **out, const vxm_soup *soup, vxm_error *error);

/** Turns a face over: its corners run the other way from the first one on. */
void vxm_soup_reverse_face(vxm_soup *soup, size_t face);
/** Makes room for at least so many elements in all (half as many again where it grows). */
vxm_status vxm_soup_reserve(vxm_soup *soup, size_t vertices, size_t faces, size_t corners, vxm_error *error);
/** Adds a vertex; VXM_ERROR_RANGE beyond VXM_VERTICES_MAX. */
vxm_status vxm_soup_add_vertex(vxm_soup *soup, double x, double y, double z, vxm_error *error);
/** Adds all vertices of another soup, in their order. @return as vxm_soup_add_vertex */
vxm_status vxm_soup_add_vertices(vxm_soup *soup, const vxm_soup *from, vxm_error *error);
/** Adds a face; the corners must exist by the time the soup is finished. */
vxm_status vxm_soup_add_face(vxm_soup *soup, const uint32_t *corners, size_t count, vxm_error *error);
/** Adds a tag name (copied) and gives its number. */
vxm_status vxm_soup_add_tag(vxm_soup *soup, const char *name, size_t length, uint32_t *tag, vxm_error *error);

/** Notes another file that is opened to read it, once (the name is copied). */
vxm_status vxm_soup_add_companion(vxm_soup *soup, const char *name, vxm_error *error);

/** Corners of a face. */
static inline const uint32_t *vxm_face(const vxm_soup *soup, size_t face, size_t *count) {
  uint64_t begin = soup->offsets[face];
  *count = (size_t)(soup->offsets[face + 1] - begin);
  return *count ? soup->indices + begin : soup->indices; /* there may be no corners at all */
}

/** The most corners of a face; 0 without faces. */
static inline size_t vxm_largest_face(const vxm_soup *soup) {
  uint64_t most = 0;
  for (size_t f = 0; f < soup->face_count; f++)
    if (soup->offsets[f + 1] - soup->offsets[f] > most)
      most = soup->offsets[f + 1] - soup->offsets[f];
  return (size_t)most;
}

static inline const double *vxm_position(const vxm_soup *soup, size_t vertex) {
  return soup->positions + 3 * vertex;
}

/** In a walk over all faces: fetches positions that will be asked for soon, as they may lie anywhere. */
static inline void vxm_soup_look_ahead(const vxm_soup *soup, size_t face) {
  enum { AHEAD = 48 /**< corners */ };
  uint64_t from = soup->offsets[face] + AHEAD, to = soup->offsets[face + 1] + AHEAD;
  for (uint64_t c = from; c < to && c < soup->corner_count; c++)
    __builtin_prefetch(vxm_position(soup, soup->indices[c]));
}

#ifdef __cplusplus
}
#endif
#endif
