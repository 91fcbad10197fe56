/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/manifold/cut_nonmanifold.h"

#include "repair/manifold/halfedge_pairing.h"

#include <string.h>

enum { UNUSED = 0, WAITING = 1, TAKEN = 2 };

/** Fans into vertices. */
typedef struct numbering {
  const vxm_halfedge_pairing *pairing;
  vxm_soup *soup;   /**< the result, with the corners of the input as yet */
  uint32_t *vertex; /**< per fan */
  uint8_t *state;   /**< per vertex of the input */
} numbering;

/** The first fan of a vertex, by its lowest corner, keeps the number; others get new ones. */
static vxm_status number_fans(numbering *n, int64_t *added, vxm_error *error) {
  vxm_soup *soup = n->soup;
  memset(n->vertex, 0xff, n->pairing->fan_count * sizeof *n->vertex);
  for (size_t c = 0; c < soup->corner_count; c++) {
    uint32_t v = soup->indices[c], *number = &n->vertex[n->pairing->fan[c]];
    if (n->state[v] == UNUSED)
      n->state[v] = WAITING;
    if (*number == VXM_NO_VERTEX && n->state[v] == WAITING) {
      *number = v;
      n->state[v] = TAKEN;
    } else if (*number == VXM_NO_VERTEX) {
      const double p[3] = {soup->positions[3 * (size_t)v], soup->positions[3 * (size_t)v + 1],
                           soup->positions[3 * (size_t)v + 2]};
      *number = (uint32_t)soup->vertex_count;
      ++*added;
      vxm_status status = vxm_soup_add_vertex(soup, p[0], p[1], p[2], error);
      if (status != VXM_OK)
        return status;
    }
  }
  for (size_t c = 0; c < soup->corner_count; c++)
    soup->indices[c] = n->vertex[n->pairing->fan[c]];
  return VXM_OK;
}

/** Leaves out the vertices whose fans have all become part of others. */
static void drop_emptied(numbering *n, size_t before, uint32_t *map) {
  vxm_soup *soup = n->soup;
  size_t kept = 0;
  for (size_t v = 0; v < soup->vertex_count; v++) {
    map[v] = (uint32_t)kept;
    if (v < before && n->state[v] == WAITING)
      continue;
    memmove(soup->positions + 3 * kept++, soup->positions + 3 * v, 3 * sizeof *soup->positions);
  }
  soup->vertex_count = kept;
  for (size_t c = 0; c < soup->corner_count; c++)
    soup->indices[c] = map[soup->indices[c]];
}

static vxm_status apply(numbering *n, int64_t *added, vxm_error *error) {
  vxm_context *context = n->soup->context;
  size_t before = n->soup->vertex_count;
  vxm_error local = VXM_ERROR_INIT;
  uint32_t *map = NULL;
  n->vertex = vxm_alloc(context, n->pairing->fan_count, sizeof *n->vertex, &local);
  n->state = n->vertex ? vxm_calloc(context, before, sizeof *n->state, &local) : NULL;
  vxm_status status = n->state ? number_fans(n, added, &local) : local.code;
  if (status == VXM_OK) {
    map = vxm_alloc(context, n->soup->vertex_count, sizeof *map, &local);
    status = map ? VXM_OK : local.code;
  }
  if (status == VXM_OK)
    drop_emptied(n, before, map);
  vxm_free(context, map);
  vxm_free(context, n->state);
  vxm_free(context, n->vertex);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status copy_and_apply(vxm_soup **out, const vxm_halfedge_pairing *pairing, int64_t *added,
                                 vxm_error *error) {
  numbering n = {.pairing = pairing};
  vxm_status status = vxm_soup_copy(&n.soup, pairing->soup, error);
  if (status == VXM_OK)
    status = apply(&n, added, error);
  if (status != VXM_OK) {
    vxm_soup_destroy(n.soup);
    n.soup = NULL;
  }
  *out = n.soup;
  return status;
}

vxm_status vxm_cut_nonmanifold(vxm_soup **out, int64_t *split, int64_t *stitched, const vxm_soup *soup,
                               vxm_error *error) {
  *out = NULL;
  *split = *stitched = 0;
  vxm_halfedge_pairing pairing;
  vxm_status status = vxm_halfedge_pairing_build(&pairing, soup, error);
  if (status == VXM_OK)
    status = vxm_halfedge_pairing_stitch(&pairing, stitched, error);
  if (status == VXM_OK)
    status = copy_and_apply(out, &pairing, split, error);
  if (status != VXM_OK)
    *split = *stitched = 0;
  vxm_halfedge_pairing_destroy(&pairing);
  return status;
}
