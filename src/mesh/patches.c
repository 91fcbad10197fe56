/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/patches.h"

#include "base/threads.h"
#include "mesh/disjoint_sets.h"

#include <string.h>

static const uint32_t NONE = UINT32_MAX;

/** Joins a face with those before it; says whether one of them has all its sides. */
static bool join(uint32_t *parent, uint32_t *first, const vxm_soup *soup, const uint32_t *sides,
                 uint32_t face) {
  uint32_t other = NONE;
  bool same = true;
  parent[face] = face;
  for (uint64_t c = soup->offsets[face]; c < soup->offsets[face + 1]; c++) {
    if (sides[c] == VXM_NO_EDGE)
      continue;
    uint32_t *at = &first[sides[c]], before = *at < face ? *at : face;
    *at = before; /* without a branch, as nobody can tell which is which */
    same &= (before != face) & ((other == NONE) | (before == other));
    other = before;
    vxm_sets_join(parent, face, before);
  }
  return same && other != NONE;
}

/** Numbers the sets; as each is led by its first face, what a face points to has its number already. */
static size_t number_sets(uint32_t *parent, size_t faces) {
  uint32_t count = 0;
  for (size_t f = 0; f < faces; f++)
    parent[f] = parent[f] == f ? count++ : parent[parent[f]];
  return count;
}

/** Fetches what will be needed soon, which lies here and there. */
static inline void look_ahead(const uint32_t *parent, const uint32_t *first, const vxm_soup *soup,
                              const uint32_t *sides, size_t face) {
  enum { AHEAD = 48, NEAR = 24 /**< corners */ };
  uint64_t begin = soup->offsets[face], end = soup->offsets[face + 1];
  for (uint64_t c = begin + AHEAD; c < end + AHEAD && c < soup->corner_count; c++)
    if (sides[c] != VXM_NO_EDGE)
      __builtin_prefetch(first + sides[c], 1);
  for (uint64_t c = begin + NEAR; c < end + NEAR && c < soup->corner_count; c++)
    if (sides[c] != VXM_NO_EDGE && first[sides[c]] != NONE)
      __builtin_prefetch(parent + first[sides[c]], 1);
}

static vxm_status build(vxm_patches *out, const vxm_soup *soup, const vxm_edges *edges, vxm_error *error) {
  if (soup->face_count >= UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu faces are too many to number; split the mesh",
                    soup->face_count);
  out->of_face = vxm_alloc(out->context, soup->face_count, sizeof *out->of_face, error);
  uint32_t *first = out->of_face ? vxm_alloc(out->context, edges->count, sizeof *first, error) : NULL;
  if (!first)
    return error->code;
  memset(first, 0xff, edges->count * sizeof *first); /* NONE */
  vxm_status status = VXM_OK;
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    look_ahead(out->of_face, first, soup, edges->sides, f);
    out->may_repeat |= join(out->of_face, first, soup, edges->sides, (uint32_t)f);
    status = vxm_ask_at(f, out->context, error);
  }
  vxm_free(out->context, first);
  out->count = status == VXM_OK ? number_sets(out->of_face, soup->face_count) : 0;
  out->is_closed = edges->open == 0;
  return status;
}

vxm_status vxm_patches_build(vxm_patches *out, const vxm_soup *soup, const vxm_edges *edges,
                             vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  *out = (vxm_patches){.context = soup->context};
  vxm_status status = build(out, soup, edges, &local);
  if (status != VXM_OK) {
    vxm_patches_destroy(out);
    vxm_error_pass(error, &local);
  }
  return status;
}

void vxm_patches_destroy(vxm_patches *patches) {
  if (!patches->context)
    return;
  vxm_free(patches->context, patches->of_face);
  *patches = (vxm_patches){0};
}

vxm_status vxm_patches_are_apart(bool *apart, const vxm_patches *patches, const vxm_soup *soup,
                                 vxm_error *error) {
  *apart = true;
  if (patches->count < 2)
    return VXM_OK;
  vxm_error local = VXM_ERROR_INIT;
  uint32_t *at = vxm_alloc(soup->context, soup->vertex_count, sizeof *at, &local);
  if (!at) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  memset(at, 0xff, soup->vertex_count * sizeof *at); /* NONE */
  for (size_t f = 0; f < soup->face_count && *apart; f++)
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++) {
      uint32_t *patch = &at[soup->indices[c]];
      *apart = *apart && (*patch == NONE || *patch == patches->of_face[f]);
      *patch = patches->of_face[f];
    }
  vxm_free(soup->context, at);
  return VXM_OK;
}
