/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/components.h"

#include "base/threads.h"

#include <inttypes.h>
#include <stdatomic.h>

/* Every label is a vertex of the same component and only ever falls. When no face has two labels and every
   label labels itself, all vertices of a component carry the same label, and it is the lowest vertex, as that
   one's label cannot be another. So the result does not depend on who wins a race, only the number of rounds
   does. Besides its own corners a face lowers the label of their former labels, which joins whole groups (Liu
   & Tarjan, "Simple concurrent labeling algorithms for connected components", 2019): the number of rounds
   grows with the logarithm of the size, where plain propagation takes as many as a strip is long. */

enum { PER_SLICE = 8192, JUMPS_MAX = 64 };

typedef struct grouping {
  const vxm_soup *soup;
  const uint32_t *map;
  _Atomic uint32_t *labels;
  size_t face_slices, vertex_slices;
  atomic_bool changed;
} grouping;

static inline uint32_t load(const grouping *g, uint32_t v) {
  return atomic_load_explicit(&g->labels[v], memory_order_relaxed);
}

static inline void lower(const grouping *g, uint32_t v, uint32_t label) {
  uint32_t old = load(g, v);
  while (old > label && !atomic_compare_exchange_weak_explicit(&g->labels[v], &old, label,
                                                               memory_order_relaxed, memory_order_relaxed))
    ;
}

/** Gives the corners of a face, and the groups they were in, the least of their labels. */
static bool join_face(const grouping *g, const uint32_t *corners, size_t count) {
  if (count == 0)
    return false;
  uint32_t least = UINT32_MAX, most = 0;
  for (size_t i = 0; i < count; i++) {
    uint32_t label = load(g, g->map ? g->map[corners[i]] : corners[i]);
    least = label < least ? label : least;
    most = label > most ? label : most;
  }
  if (least == most)
    return false;
  for (size_t i = 0; i < count; i++) {
    uint32_t v = g->map ? g->map[corners[i]] : corners[i];
    uint32_t label = load(g, v);
    if (label > least) {
      lower(g, v, least);
      lower(g, label, least);
    }
  }
  return true;
}

static void join_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  grouping *g = payload;
  size_t begin = vxm_slice_begin(g->soup->face_count, g->face_slices, slice);
  size_t end = vxm_slice_begin(g->soup->face_count, g->face_slices, slice + 1);
  bool changed = false;
  for (size_t f = begin; f < end; f++) {
    size_t count;
    const uint32_t *corners = vxm_face(g->soup, f, &count);
    changed |= join_face(g, corners, count);
  }
  if (changed)
    atomic_store_explicit(&g->changed, true, memory_order_relaxed);
}

/** Pointer jumping: a vertex takes the label of its label, until that is its own or many jumps are made. */
static void jump_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  grouping *g = payload;
  size_t begin = vxm_slice_begin(g->soup->vertex_count, g->vertex_slices, slice);
  size_t end = vxm_slice_begin(g->soup->vertex_count, g->vertex_slices, slice + 1);
  for (size_t v = begin; v < end; v++) {
    uint32_t old = load(g, (uint32_t)v), label = old, next = load(g, label);
    int jumps = 0;
    for (; next != label && jumps < JUMPS_MAX; jumps++) {
      label = next;
      next = load(g, label);
    }
    if (label != old)
      atomic_store_explicit(&g->labels[v], label, memory_order_relaxed);
    if (next != label)
      atomic_store_explicit(&g->changed, true, memory_order_relaxed);
  }
}

static void start_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  grouping *g = payload;
  size_t begin = vxm_slice_begin(g->soup->vertex_count, g->vertex_slices, slice);
  size_t end = vxm_slice_begin(g->soup->vertex_count, g->vertex_slices, slice + 1);
  for (size_t v = begin; v < end; v++)
    atomic_store_explicit(&g->labels[v], (uint32_t)v, memory_order_relaxed);
}

vxm_status vxm_group_vertices(vxm_context *context, const vxm_soup *soup, const uint32_t *vertex_map,
                              uint32_t *labels, int *rounds, vxm_error *error) {
  _Static_assert(sizeof(_Atomic uint32_t) == sizeof(uint32_t), "labels are shared as plain words");
  grouping g = {.soup = soup, .map = vertex_map, .labels = (_Atomic uint32_t *)labels};
  g.face_slices = soup->face_count / PER_SLICE + 1;
  g.vertex_slices = soup->vertex_count / PER_SLICE + 1;
  vxm_status status = vxm_parallel_cancellable(context, g.vertex_slices, start_slice, &g, error);
  if (status != VXM_OK)
    return status;
  int round = 0;
  do {
    status = vxm_progress(context, "grouping", 1.0 - 1.0 / (1.0 + round), error);
    if (status != VXM_OK)
      return status;
    atomic_store_explicit(&g.changed, false, memory_order_relaxed);
    status = vxm_parallel_cancellable(context, g.face_slices, join_slice, &g, error);
    if (status == VXM_OK && atomic_load_explicit(&g.changed, memory_order_relaxed))
      status = vxm_parallel_cancellable(context, g.vertex_slices, jump_slice, &g, error);
    if (status != VXM_OK)
      return status;
    round++;
  } while (atomic_load_explicit(&g.changed, memory_order_relaxed));
  if (rounds)
    *rounds = round;
  return VXM_OK;
}

/** Numbers the labels in the order in which faces meet them. */
static vxm_status number_faces(vxm_context *context, const vxm_soup *soup, const uint32_t *map,
                               const uint32_t *labels, uint32_t *numbers, uint32_t *face_labels,
                               size_t *count, vxm_error *error) {
  for (size_t v = 0; v < soup->vertex_count; v++)
    numbers[v] = UINT32_MAX;
  size_t next = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    vxm_status status = vxm_check_cancelled_at(f, context, error);
    if (status != VXM_OK)
      return status;
    if (next == UINT32_MAX)
      return vxm_fail(error, VXM_ERROR_RANGE, "more than %" PRIu32 " components: split the mesh", UINT32_MAX);
    size_t corners;
    const uint32_t *face = vxm_face(soup, f, &corners);
    uint32_t number = (uint32_t)next;
    if (corners > 0) {
      uint32_t label = labels[map ? map[face[0]] : face[0]];
      if (numbers[label] == UINT32_MAX)
        numbers[label] = (uint32_t)next++;
      number = numbers[label];
    } else
      next++;
    if (face_labels)
      face_labels[f] = number;
  }
  *count = next;
  return VXM_OK;
}

/** Whether every corner has a vertex of its own, as what is read from an .stl. */
static bool shares_no_vertex(const vxm_soup *soup) {
  size_t c = 0;
  while (c < soup->corner_count && soup->indices[c] == c)
    c++;
  return c == soup->corner_count;
}

vxm_status vxm_components(vxm_context *context, const vxm_soup *soup, const uint32_t *vertex_map,
                          uint32_t *face_labels, size_t *count, vxm_error *error) {
  *count = 0;
  if (!vertex_map && shares_no_vertex(soup) && soup->face_count < UINT32_MAX) {
    for (size_t f = 0; face_labels && f < soup->face_count; f++)
      face_labels[f] = (uint32_t)f;
    *count = soup->face_count;
    return VXM_OK;
  }
  vxm_error local = VXM_ERROR_INIT;
  uint32_t *labels = vxm_alloc(context, soup->vertex_count, sizeof *labels, &local);
  uint32_t *numbers = labels ? vxm_alloc(context, soup->vertex_count, sizeof *numbers, &local) : NULL;
  vxm_status status = numbers ? VXM_OK : local.code;
  if (status == VXM_OK)
    status = vxm_group_vertices(context, soup, vertex_map, labels, NULL, &local);
  if (status == VXM_OK)
    status = number_faces(context, soup, vertex_map, labels, numbers, face_labels, count, &local);
  vxm_free(context, numbers);
  vxm_free(context, labels);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
