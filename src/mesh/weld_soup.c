/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/weld_soup.h"

#include "base/threads.h"
#include "mesh/unit_scale.h"
#include "mesh/weld.h"

#include <stdatomic.h>

enum { CORNERS_PER_SLICE = 1 << 16, VERTICES_PER_SLICE = 1 << 14 };

/* ---- Whether all is finite ---- */

typedef struct finiteness {
  const vxm_soup *soup;
  atomic_bool some; /**< vertices are not finite */
} finiteness;

static void look_at_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  finiteness *f = payload;
  size_t begin = slice * VERTICES_PER_SLICE, rest = f->soup->vertex_count - begin;
  bool all = true;
  for (size_t v = begin; v < begin + (rest < VERTICES_PER_SLICE ? rest : VERTICES_PER_SLICE); v++)
    all &= vxm_is_finite(vxm_position(f->soup, v));
  if (!all)
    atomic_store_explicit(&f->some, true, memory_order_relaxed);
}

static bool is_finite(const vxm_soup *soup) {
  finiteness found = {.soup = soup};
  vxm_parallel(soup->context, soup->vertex_count / VERTICES_PER_SLICE + 1, look_at_slice, &found);
  return !atomic_load(&found.some);
}

/* ---- Welding ---- */

typedef struct renaming {
  vxm_soup *soup;
  const uint32_t *number;
} renaming;

static void rename_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const renaming *r = payload;
  size_t begin = slice * CORNERS_PER_SLICE, rest = r->soup->corner_count - begin;
  for (size_t c = begin; c < begin + (rest < CORNERS_PER_SLICE ? rest : CORNERS_PER_SLICE); c++)
    r->soup->indices[c] = r->number[r->soup->indices[c]];
}

/** Moves up what stays, and turns the map into new numbers: whatever a vertex is merged into has its own
 * already. */
static size_t move_up(vxm_soup *soup, uint32_t *map) {
  enum { AHEAD = 32 };
  size_t kept = 0;
  for (size_t v = 0; v < soup->vertex_count; v++) {
    if (v + AHEAD < soup->vertex_count)
      __builtin_prefetch(&map[map[v + AHEAD]]);
    if (map[v] != v) {
      map[v] = map[map[v]];
      continue;
    }
    const double *from = vxm_position(soup, v);
    double *to = soup->positions + 3 * kept;
    for (int axis = 0; axis < 3; axis++)
      to[axis] = from[axis];
    map[v] = (uint32_t)kept++;
  }
  return kept;
}

vxm_status vxm_weld_soup(vxm_soup *soup, size_t *merged, vxm_error *error) {
  vxm_context *context = soup->context;
  vxm_error local = VXM_ERROR_INIT;
  size_t distinct = soup->vertex_count;
  *merged = 0;
  if (!is_finite(soup))
    return VXM_OK;
  uint32_t *map = vxm_alloc(context, soup->vertex_count, sizeof *map, &local);
  vxm_status status =
      map ? vxm_weld_exact(context, soup->positions, soup->vertex_count, map, &distinct, &local) : local.code;
  if (status == VXM_OK && distinct < soup->vertex_count) {
    *merged = soup->vertex_count - distinct;
    soup->vertex_count = move_up(soup, map);
    renaming r = {soup, map};
    vxm_parallel(context, soup->corner_count / CORNERS_PER_SLICE + 1, rename_slice, &r);
    double *shrunk = vxm_realloc(context, soup->positions, distinct, 3 * sizeof *shrunk, NULL);
    if (shrunk) { /* else it stays larger than it needs to be */
      soup->positions = shrunk;
      soup->vertex_capacity = distinct;
    }
  }
  vxm_free(context, map);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
