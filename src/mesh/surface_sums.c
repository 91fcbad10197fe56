/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/surface_sums.h"

#include "base/threads.h"

enum {
  BLOCK = 1 << 14, /**< faces whose shares are held at a time */
  SLICE = 1 << 12
};

/** Of a face. */
typedef struct share {
  vxm_vec3 vector_area;
  double area, volume;
} share;

typedef struct summing {
  const vxm_soup *soup;
  double scale, middle[3]; /**< of the bounds, scaled */
  share *shares;
  size_t begin, end; /**< of the block */
} summing;

static bool face_is_finite(const vxm_soup *soup, const uint32_t *corner, size_t count) {
  for (size_t c = 0; c < count; c++)
    if (!vxm_is_finite(vxm_position(soup, corner[c])))
      return false;
  return true;
}

static void measure_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const summing *s = payload;
  size_t begin = s->begin + slice * SLICE, end = s->end - begin < SLICE ? s->end : begin + SLICE;
  for (size_t f = begin; f < end; f++) {
    size_t count;
    vxm_soup_look_ahead(s->soup, f);
    const uint32_t *corner = vxm_face(s->soup, f, &count);
    share *face = &s->shares[f - s->begin];
    face->vector_area = vxm_polygon_area(s->soup->positions, corner, count, s->scale);
    face->area = vxm_vec3_length(face->vector_area);
    face->volume = 0;
    if (count < 3 || !face_is_finite(s->soup, corner, count))
      continue;
    const double *p = vxm_position(s->soup, corner[0]);
    vxm_vec3 first = {p[0] * s->scale - s->middle[0], p[1] * s->scale - s->middle[1],
                      p[2] * s->scale - s->middle[2]};
    face->volume = vxm_polygon_cone(first, face->vector_area);
  }
}

static void add_shares(vxm_surface_sums *out, const share *shares, size_t count) {
  vxm_surface_sums sums = *out;
  for (size_t i = 0; i < count; i++) {
    sums.area += shares[i].area;
    sums.volume += shares[i].volume;
    sums.vector_area.x += shares[i].vector_area.x;
    sums.vector_area.y += shares[i].vector_area.y;
    sums.vector_area.z += shares[i].vector_area.z;
  }
  *out = sums;
}

vxm_status vxm_surface_sums_of(vxm_surface_sums *out, const vxm_soup *soup, const double bounds[6],
                               const vxm_unit_scale *frame, vxm_error *error) {
  *out = (vxm_surface_sums){0};
  vxm_error local = VXM_ERROR_INIT;
  summing s = {.soup = soup, .scale = frame->scale};
  for (int a = 0; a < 3; a++)
    s.middle[a] = (bounds[a] * s.scale + bounds[a + 3] * s.scale) / 2;
  s.shares =
      vxm_alloc(soup->context, soup->face_count < BLOCK ? soup->face_count : BLOCK, sizeof *s.shares, &local);
  vxm_status status = s.shares ? VXM_OK : local.code;
  for (; status == VXM_OK && s.begin < soup->face_count; s.begin = s.end) {
    s.end = soup->face_count - s.begin < BLOCK ? soup->face_count : s.begin + BLOCK;
    vxm_parallel(soup->context, (s.end - s.begin - 1) / SLICE + 1, measure_slice, &s);
    add_shares(out, s.shares, s.end - s.begin);
    status = vxm_ask(soup->context, &local);
  }
  vxm_free(soup->context, s.shares);
  out->volume = out->volume / s.scale / s.scale / s.scale;
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
