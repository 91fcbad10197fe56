/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/mesh/colored_quads.h"

#include <stdlib.h>
#include <string.h>

enum { QUADS_MOST = 1 << 30 };

static vxm_status add(vxm_colored_quads *quads, vxm_colored_quad quad, vxm_error *error) {
  if (quads->count == QUADS_MOST)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "the surface has more than 2^30 rectangles; lower the resolution");
  vxm_status status = VXM_OK;
  if (quads->count == quads->capacity)
    status = vxm_grow(quads->context, (void **)&quads->items, &quads->capacity, quads->count + 1,
                      sizeof *quads->items, error);
  if (status == VXM_OK)
    quads->items[quads->count++] = quad;
  return status;
}

void vxm_colored_quads_destroy(vxm_colored_quads *quads) {
  vxm_free(quads->context, quads->items);
  quads->items = NULL;
}

/** One layer of voxels across an axis, and what of it is seen from a side. */
typedef struct layer {
  const vxm_field *field;
  int axis, u, v;
  size_t width, height;   /**< along u and v */
  uint32_t *own, *beside; /**< keys of the layer and the next, u fastest; 0 = no voxel */
  uint32_t *seen;
} layer;

static uint32_t key_of(const vxm_field *field, size_t voxel) {
  if (field->channels == 4) {
    const unsigned char *rgba = field->values + 4 * voxel;
    return rgba[3] ? UINT32_C(1) << 24 | (uint32_t)rgba[0] << 16 | (uint32_t)rgba[1] << 8 | rgba[2] : 0;
  }
  return vxm_field_label(field, voxel);
}

static void load_keys(uint32_t *out, const layer *l, int64_t at) {
  const int64_t *n = l->field->space.dims;
  const size_t step[3] = {(size_t)(n[1] * n[2]), (size_t)n[2], 1};
  for (size_t v = 0; v < l->height; v++)
    for (size_t u = 0; u < l->width; u++)
      *out++ = key_of(l->field, (size_t)at * step[l->axis] + u * step[l->u] + v * step[l->v]);
}

/** Takes the longest run of a key along u, then as many rows along v as have all of it. */
static vxm_status merge(vxm_colored_quads *quads, const layer *l, uint32_t level, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t v = 0; v < l->height; v++)
    for (size_t u = 0; u < l->width; u++) {
      uint32_t *row = l->seen + v * l->width, key = row[u];
      if (key == 0)
        continue;
      size_t u1 = u, v1 = v;
      while (u1 < l->width && row[u1] == key)
        u1++;
      for (; v1 < l->height; v1++) {
        uint32_t *other = l->seen + v1 * l->width;
        size_t same = u;
        while (same < u1 && other[same] == key)
          same++;
        if (same < u1)
          break;
        memset(other + u, 0, (u1 - u) * sizeof *other);
      }
      status = add(quads,
                   (vxm_colored_quad){key, level, (uint32_t)u, (uint32_t)v, (uint32_t)u1, (uint32_t)v1,
                                      (uint32_t)l->axis},
                   error);
      if (status != VXM_OK)
        return status;
    }
  return status;
}

/** What of `own` is not behind voxels of `beside`. */
static void expose(const layer *l, const uint32_t *own, const uint32_t *beside) {
  for (size_t i = 0; i < l->width * l->height; i++)
    l->seen[i] = beside[i] ? 0 : own[i];
}

/** Between each two layers those of the one are seen from the other's empty voxels; beyond the ends all is
 * empty. */
static vxm_status merge_axis(vxm_colored_quads *quads, layer *l, vxm_error *error) {
  int64_t count = l->field->space.dims[l->axis];
  vxm_status status = VXM_OK;
  memset(l->own, 0, l->width * l->height * sizeof *l->own);
  for (int64_t at = 0; at <= count && status == VXM_OK; at++) {
    if (at < count)
      load_keys(l->beside, l, at);
    else
      memset(l->beside, 0, l->width * l->height * sizeof *l->beside);
    expose(l, l->own, l->beside);
    status = merge(quads, l, 2 * (uint32_t)at + 1, error);
    expose(l, l->beside, l->own);
    if (status == VXM_OK)
      status = merge(quads, l, 2 * (uint32_t)at, error);
    uint32_t *own = l->own;
    l->own = l->beside;
    l->beside = own;
    if (status == VXM_OK)
      status = vxm_progress(quads->context, "finding faces",
                            ((double)l->axis + (double)at / (double)(count + 1)) / 3, error);
  }
  return status;
}

static vxm_status do_axis(vxm_colored_quads *quads, const vxm_field *field, int axis, vxm_error *error) {
  const int64_t *n = field->space.dims;
  layer l = {.field = field, .axis = axis, .u = axis == 0 ? 1 : 0, .v = axis == 2 ? 1 : 2};
  l.width = (size_t)n[l.u];
  l.height = (size_t)n[l.v];
  size_t size = l.width * l.height;
  uint32_t *keys = vxm_alloc(quads->context, size, 3 * sizeof *keys, error);
  if (!keys)
    return error->code;
  l.own = keys;
  l.beside = keys + size;
  l.seen = keys + 2 * size;
  vxm_status status = merge_axis(quads, &l, error);
  vxm_free(quads->context, keys);
  return status;
}

/** By label, then as they were found, which level and place tell. */
static int compare(const void *a, const void *b) {
  const vxm_colored_quad *p = a, *q = b;
  const uint32_t x[] = {p->key, p->axis, p->level, p->v0, p->u0},
                 y[] = {q->key, q->axis, q->level, q->v0, q->u0};
  for (size_t i = 0; i < sizeof x / sizeof x[0]; i++)
    if (x[i] != y[i])
      return x[i] < y[i] ? -1 : 1;
  return 0;
}

vxm_status vxm_colored_quads_make(vxm_colored_quads *out, const vxm_field *field, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  *out = (vxm_colored_quads){.context = field->context};
  vxm_status status = VXM_OK;
  for (int axis = 0; axis < 3 && status == VXM_OK; axis++)
    status = do_axis(out, field, axis, &local);
  if (status == VXM_OK && field->channels == 1 && out->count > 1)
    qsort(out->items, out->count, sizeof *out->items, compare);
  if (status != VXM_OK) {
    vxm_colored_quads_destroy(out);
    vxm_error_pass(error, &local);
  }
  return status;
}
