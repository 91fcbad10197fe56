/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/triangle_order.h"
#include "base/threads.h"
#include "mesh/sort.h"

#include <string.h>

/* A key is, from above: the layer of the first slice, the cube of the first corner, the layer of the last
 * slice, and the number of the triangle in its part. */
enum { NUMBER_BITS = 32, LAYER_BITS = 7, CUBE_BITS = 8, CUBE_SHIFT = 6, TASK = 1 << 12 };
enum { REACH_AT = NUMBER_BITS, CUBE_AT = REACH_AT + LAYER_BITS, LAYER_AT = CUBE_AT + 2 * CUBE_BITS + 1 };

typedef struct ordering {
  const vxm_triangle_set *triangles;
  const vxm_snapped_points *placed;
  vxm_triangle_order *out;
  uint64_t *keys;
  size_t begin, end; /**< faces of a part */
  int cube_shift;
} ordering;

/** The bits of a number below 2^CUBE_BITS, each with a 0 above. */
static inline uint64_t spread(uint64_t number) {
  number = (number | number << 4) & 0x0f0f;
  number = (number | number << 2) & 0x3333;
  return (number | number << 1) & 0x5555;
}

static inline uint64_t cell_along(uint64_t cell, int axis) {
  return cell >> VXM_CELL_BITS * axis & vxm_cell_mask(0);
}

static inline uint64_t key_of(const ordering *o, size_t triangle) {
  const uint32_t *corner = o->triangles->corners[triangle];
  uint64_t cell = o->placed->cells[corner[0]], low = cell_along(cell, 2), high = low;
  for (int k = 1; k < 3; k++) {
    uint64_t z = cell_along(o->placed->cells[corner[k]], 2);
    low = z < low ? z : low;
    high = z > high ? z : high;
  }
  const int shift = o->cube_shift;
  uint64_t cube = spread(cell_along(cell, 0) >> shift) | spread(cell_along(cell, 1) >> shift) << 1;
  cube = (cube & ~UINT64_C(3)) << 1 | (low >> shift & 1) << 2 | (cube & 3);
  return low >> o->out->layer_shift << LAYER_AT | cube << CUBE_AT | high >> o->out->layer_shift << REACH_AT |
         (triangle - o->begin);
}

static void make_keys(size_t task, int worker, void *payload) {
  (void)worker;
  const ordering *o = payload;
  size_t begin = o->begin + task * TASK, end = o->end - begin < TASK ? o->end : begin + TASK;
  for (size_t t = begin; t < end; t++)
    o->keys[t - o->begin] = key_of(o, t);
}

static void move_triangles(size_t task, int worker, void *payload) {
  (void)worker;
  const ordering *o = payload;
  size_t begin = o->begin + task * TASK, end = o->end - begin < TASK ? o->end : begin + TASK;
  for (size_t t = begin; t < end; t++) {
    size_t from = o->begin + (size_t)(o->keys[t - o->begin] & UINT32_MAX);
    memcpy(o->out->corners[t], o->triangles->corners[from], sizeof *o->out->corners);
  }
}

/** Notes where layers of the first part begin, and how far they reach. */
static void note_layers(const ordering *o) {
  vxm_triangle_order *out = o->out;
  const uint64_t layer_mask = VXM_ORDER_LAYERS - 1;
  for (size_t k = 0; k < o->end - o->begin; k++) {
    size_t layer = (size_t)(o->keys[k] >> LAYER_AT);
    uint8_t last = (uint8_t)(o->keys[k] >> REACH_AT & layer_mask);
    out->begin[layer + 1]++;
    out->reach[layer] = last > out->reach[layer] ? last : out->reach[layer];
  }
  out->begin[0] = o->begin;
  for (size_t l = 0; l < VXM_ORDER_LAYERS; l++) {
    out->begin[l + 1] += out->begin[l];
    if (l > 0 && out->reach[l] < out->reach[l - 1])
      out->reach[l] = out->reach[l - 1];
  }
}

static void order_part(ordering *o, uint64_t *scratch, size_t part) {
  const vxm_part *p = &o->triangles->parts[part];
  o->begin = p->begin;
  o->end = p->caps;
  size_t count = o->end - o->begin, tasks = (count + TASK - 1) / TASK;
  vxm_parallel(o->out->context, tasks, make_keys, o);
  vxm_sort_keys_above(o->keys, scratch, count, CUBE_AT);
  vxm_parallel(o->out->context, tasks, move_triangles, o);
  memcpy(o->out->corners[p->caps], o->triangles->corners[p->caps],
         (p->end - p->caps) * sizeof *o->out->corners);
  if (part == 0)
    note_layers(o);
}

static int cube_shift_of(const vxm_space *space) {
  int64_t longest = vxm_max(vxm_max(space->dims[0], space->dims[1]), space->dims[2]);
  int shift = CUBE_SHIFT;
  while (longest >> shift >> CUBE_BITS)
    shift++;
  return shift;
}

void vxm_triangle_order_make(vxm_triangle_order *out, vxm_context *context, const vxm_triangle_set *triangles,
                             const vxm_snapped_points *placed) {
  const size_t count = triangles->triangle_count;
  *out = (vxm_triangle_order){.context = context, .set = *triangles};
  if (placed->wide || count > UINT32_MAX)
    return;
  uint64_t *keys = vxm_alloc(context, 2 * count, sizeof *keys, NULL);
  out->corners = keys ? vxm_alloc(context, count, sizeof *out->corners, NULL) : NULL;
  ordering o = {triangles, placed, out, keys, 0, 0, cube_shift_of(&placed->lattice.space)};
  out->layer_shift = o.cube_shift + 1;
  for (size_t p = 0; out->corners && p < triangles->split.part_count; p++)
    order_part(&o, keys + count, p);
  vxm_free(context, keys);
  if (out->corners)
    out->set.corners = out->corners;
}

void vxm_triangle_order_destroy(vxm_triangle_order *order) {
  vxm_free(order->context, order->corners);
  *order = (vxm_triangle_order){.context = order->context};
}

void vxm_triangle_order_slices(const vxm_triangle_order *order, int64_t begin, int64_t end, size_t *first,
                               size_t *last) {
  size_t layer = 0, end_layer = (size_t)((end - 1) >> order->layer_shift) + 1;
  while (layer < end_layer && order->reach[layer] < begin >> order->layer_shift)
    layer++;
  *first = order->begin[layer];
  *last = order->begin[end_layer];
}
