/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/unit_scale.h"

#include "base/box.h"
#include "base/threads.h"
#include "mesh/geometry.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

enum { SLICES_MAX = 64, PER_SLICE = 16384 };

typedef struct survey {
  const vxm_soup *soup;
  _Atomic uint8_t *used;
  size_t face_slices, vertex_slices;
  vxm_extent found[SLICES_MAX];
} survey;

static size_t slices_for(size_t items) {
  size_t slices = items / PER_SLICE + 1;
  return slices < SLICES_MAX ? slices : SLICES_MAX;
}

static void mark_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  survey *s = payload;
  size_t begin = vxm_slice_begin(s->soup->face_count, s->face_slices, slice);
  size_t end = vxm_slice_begin(s->soup->face_count, s->face_slices, slice + 1);
  for (uint64_t c = s->soup->offsets[begin]; c < s->soup->offsets[end]; c++)
    atomic_store_explicit(&s->used[s->soup->indices[c]], 1, memory_order_relaxed);
}

static void measure_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  survey *s = payload;
  size_t begin = vxm_slice_begin(s->soup->vertex_count, s->vertex_slices, slice);
  size_t end = vxm_slice_begin(s->soup->vertex_count, s->vertex_slices, slice + 1);
  vxm_extent found = {0};
  vxm_box_empty(found.bounds, found.bounds + 3);
  for (size_t v = begin; v < end; v++) {
    const double *p = vxm_position(s->soup, v);
    bool used = atomic_load_explicit(&s->used[v], memory_order_relaxed), finite = vxm_is_finite(p);
    found.unused += !used;
    found.nonfinite += !finite;
    if (used && finite)
      vxm_box_include(found.bounds, found.bounds + 3, p);
  }
  s->found[slice] = found;
}

void vxm_extent_of(vxm_extent *out, vxm_context *context, const vxm_soup *soup, uint8_t *used) {
  _Static_assert(sizeof(_Atomic uint8_t) == 1, "marks are shared as plain bytes");
  *out = (vxm_extent){0};
  survey s = {.soup = soup, .used = (_Atomic uint8_t *)used};
  s.face_slices = slices_for(soup->face_count);
  s.vertex_slices = slices_for(soup->vertex_count);
  if (soup->vertex_count > 0)
    memset(used, 0, soup->vertex_count);
  vxm_parallel(context, s.face_slices, mark_slice, &s);
  vxm_parallel(context, s.vertex_slices, measure_slice, &s);
  vxm_box_empty(out->bounds, out->bounds + 3);
  for (size_t i = 0; i < s.vertex_slices; i++) {
    out->nonfinite += s.found[i].nonfinite;
    out->unused += s.found[i].unused;
    vxm_box_join(out->bounds, out->bounds + 3, s.found[i].bounds, s.found[i].bounds + 3);
  }
  for (int i = 0; i < 6; i++)
    /* no point: the bounds are still infinite; and -0.0 would be printed as such */
    out->bounds[i] = isinf(out->bounds[i]) ? 0.0 : out->bounds[i] + 0.0;
}

vxm_status vxm_extent_find(vxm_extent *out, vxm_context *context, const vxm_soup *soup, vxm_error *error) {
  vxm_status status = VXM_OK;
  uint8_t *used = vxm_try_alloc(context, soup->vertex_count, sizeof *used, &status, error);
  if (!used)
    return status;
  vxm_extent_of(out, context, soup, used);
  vxm_free(context, used);
  return VXM_OK;
}

vxm_unit_scale vxm_unit_scale_of(const double bounds[6]) {
  double longest = 0, squared = 0;
  vxm_unit_scale frame = {.scale = 1};
  for (int axis = 0; axis < 3; axis++) {
    double length = bounds[3 + axis] - bounds[axis];
    frame.centre[axis] = 0.5 * bounds[3 + axis] + 0.5 * bounds[axis];
    longest = length > longest ? length : longest;
  }
  if (longest > 0) {
    int exponent = 1025;
    if (isfinite(longest))
      frexp(longest, &exponent);
    /* the inverse of a number below the normal ones would be infinite */
    frame.scale = ldexp(1.0, exponent < -1020 ? 1020 : -exponent);
  }
  for (int axis = 0; axis < 3; axis++) {
    double length = vxm_scaled_between(bounds[3 + axis], bounds[axis], frame.scale);
    squared += length * length;
  }
  frame.diagonal = sqrt(squared);
  frame.no_area = VXM_NO_AREA * squared;
  return frame;
}

bool vxm_unit_scale_no_area(const vxm_unit_scale *frame, const vxm_soup *soup, size_t face) {
  size_t count;
  const uint32_t *corners = vxm_face(soup, face, &count);
  /* written so that NaN counts as no area */
  return !(vxm_polygon_fan_area(soup->positions, corners, count, frame->scale) > frame->no_area);
}
