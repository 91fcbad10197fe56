/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/face_adjacency.h"

#include "base/threads.h"
#include "mesh/sort.h"

#include <stdatomic.h>
#include <string.h>

enum {
  VERTICES_PER_SLICE = 1 << 12,
  FEW = 16 /**< sides of a vertex that are looked for one by one */
};

typedef struct pairing {
  vxm_side_table *table;
  const uint32_t *face_of; /**< per corner, NULL if it is a third of it */
  uint32_t *adjacent;
  uint64_t *scratch; /**< per worker, as many as the largest group has */
  atomic_bool failed;
} pairing;

static inline uint32_t face_at(const pairing *p, uint32_t corner) {
  return p->face_of ? p->face_of[corner] : corner / 3;
}

static inline void put_pair(const pairing *p, uint64_t side, uint64_t other) {
  uint32_t corner = vxm_side_corner(side), opposite = vxm_side_corner(other);
  p->adjacent[corner] = face_at(p, opposite);
  p->adjacent[opposite] = face_at(p, corner);
}

/** Finds for each upward side, among those downward that are left, the one that has the same end; without a
 * branch on which it is, as nobody can tell. */
static bool pair_few(const pairing *p, const uint64_t *up, uint64_t *down, size_t count) {
  for (size_t i = 0; i < count; i++) {
    size_t hits = 0, at = i;
    for (size_t j = i; j < count; j++) {
      bool hit = vxm_side_high(down[j]) == vxm_side_high(up[i]);
      hits += hit;
      at = hit ? j : at;
    }
    if (hits != 1)
      return false;
    uint64_t found = down[at];
    down[at] = down[i];
    down[i] = found;
    put_pair(p, up[i], found);
  }
  return true;
}

static bool pair_many(const pairing *p, uint64_t *up, uint64_t *down, size_t count, uint64_t *scratch) {
  enum { HIGH = 32 };
  vxm_sort_keys_above(up, scratch, count, HIGH);
  vxm_sort_keys_above(down, scratch, count, HIGH);
  for (size_t i = 0; i < count; i++) {
    if (vxm_side_high(up[i]) != vxm_side_high(down[i]) ||
        (i > 0 && vxm_side_high(up[i]) == vxm_side_high(up[i - 1])))
      return false;
    put_pair(p, up[i], down[i]);
  }
  return true;
}

static void pair_slice(size_t slice, int worker, void *payload) {
  pairing *p = payload;
  size_t begin = slice * VERTICES_PER_SLICE, rest = p->table->vertex_count - begin;
  size_t end = begin + (rest < VERTICES_PER_SLICE ? rest : VERTICES_PER_SLICE);
  if (atomic_load_explicit(&p->failed, memory_order_relaxed))
    return;
  bool paired = true;
  for (size_t v = begin; v < end && paired; v++) {
    vxm_side_group group = vxm_side_group_of(p->table, v);
    uint64_t *up = p->table->records + group.up, *down = p->table->records + group.down;
    size_t count = group.down - group.up;
    paired = count <= FEW ? pair_few(p, up, down, count)
                          : pair_many(p, up, down, count, p->scratch + (size_t)worker * p->table->largest);
  }
  if (!paired)
    atomic_store_explicit(&p->failed, true, memory_order_relaxed);
}

/** For soups with polygons: the face of each corner. */
static vxm_status list_faces(uint32_t **face_of, const vxm_side_table *table, const vxm_soup *soup,
                             vxm_error *error) {
  *face_of = NULL;
  if (table->is_triangles)
    return VXM_OK;
  if (soup->face_count >= UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu faces are too many to number; split the mesh",
                    soup->face_count);
  *face_of = vxm_alloc(table->context, soup->corner_count, sizeof **face_of, error);
  for (size_t f = 0; *face_of && f < soup->face_count; f++)
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++)
      (*face_of)[c] = (uint32_t)f;
  return *face_of ? VXM_OK : error->code;
}

static vxm_status pair(pairing *p, const vxm_soup *soup, vxm_error *error) {
  vxm_context *context = p->table->context;
  size_t workers = (size_t)vxm_context_threads(context);
  p->adjacent = vxm_alloc(context, soup->corner_count, sizeof *p->adjacent, error);
  if (p->adjacent)
    p->scratch = vxm_alloc(context, p->table->largest > FEW ? workers * p->table->largest : 0,
                           sizeof *p->scratch, error);
  if (!p->scratch)
    return error->code;
  if (p->table->count < soup->corner_count)
    memset(p->adjacent, 0xff, soup->corner_count * sizeof *p->adjacent); /* VXM_NO_ADJACENT */
  return vxm_parallel_cancellable(context, p->table->vertex_count / VERTICES_PER_SLICE + 1, pair_slice, p,
                                  error);
}

vxm_status vxm_face_adjacency_build(uint32_t **adjacent, vxm_side_table *table, const vxm_soup *soup,
                                    vxm_error *error) {
  *adjacent = NULL;
  if (!table->is_balanced)
    return VXM_OK;
  pairing p = {.table = table};
  uint32_t *face_of;
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = list_faces(&face_of, table, soup, &local);
  p.face_of = face_of;
  if (status == VXM_OK)
    status = pair(&p, soup, &local);
  vxm_free(table->context, p.scratch);
  vxm_free(table->context, face_of);
  if (status == VXM_OK && !atomic_load(&p.failed))
    *adjacent = p.adjacent;
  else
    vxm_free(table->context, p.adjacent);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
