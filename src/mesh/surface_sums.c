/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/surface_sums.h"

#include "base/threads.h"

#include <stdatomic.h>

enum {
  BLOCK = 1 << 14,       /**< faces whose shares are held at a time */
  BLOCK_ALONE = 1 << 10, /**< by one thread, so that they stay at hand */
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
  double no_area;
  share *shares;
  uint8_t *flat;     /**< per face, or NULL */
  size_t begin, end; /**< of the block */
  atomic_size_t flat_faces;
} summing;

/** The cone from the middle to a face, if it is finite; `first` is the face's first corner. */
static inline double cone_of(const summing *s, const double *first, vxm_vec3 area, double size) {
  vxm_vec3 at = {first[0] * s->scale - s->middle[0], first[1] * s->scale - s->middle[1],
                 first[2] * s->scale - s->middle[2]};
  return size - size == 0 ? vxm_polygon_cone(at, area) : 0;
}

/** Measures a face and says whether it has an area, that of its triangles about the first corner; what is no
 * number is none. */
static bool measure_polygon(const summing *s, share *face, const uint32_t *corner, size_t count) {
  const double *positions = s->soup->positions;
  *face = (share){{0, 0, 0}, 0, 0};
  if (count < 3)
    return false;
  double fan = vxm_polygon_fan_area(positions, corner, count, s->scale);
  face->vector_area = vxm_polygon_area(positions, corner, count, s->scale);
  face->area = vxm_vec3_length(face->vector_area);
  face->volume = cone_of(s, positions + 3 * (size_t)corner[0], face->vector_area, fan);
  return fan > s->no_area;
}

/** The same of three corners, as nearly all have. */
static inline bool measure_triangle(const summing *s, share *face, const uint32_t *corner) {
  const double *p = vxm_position(s->soup, corner[0]);
  vxm_vec3 u = vxm_vec3_between(vxm_position(s->soup, corner[1]), p, s->scale);
  vxm_vec3 v = vxm_vec3_between(vxm_position(s->soup, corner[2]), p, s->scale);
  vxm_vec3 cross = vxm_vec3_cross(u, v), area = {0.5 * cross.x, 0.5 * cross.y, 0.5 * cross.z};
  double size = vxm_vec3_length(area), volume = cone_of(s, p, area, size);
  face->vector_area.x = area.x; /* one by one: what is copied as a whole would wait for them to be written */
  face->vector_area.y = area.y;
  face->vector_area.z = area.z;
  face->area = size;
  face->volume = volume;
  return size > s->no_area;
}

static void measure_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  summing *s = payload;
  size_t begin = s->begin + slice * SLICE, end = s->end - begin < SLICE ? s->end : begin + SLICE, flat = 0;
  const summing own = *s; /* which no store can change */
  for (size_t f = begin; f < end; f++) {
    size_t count;
    vxm_soup_look_ahead(own.soup, f);
    const uint32_t *corner = vxm_face(own.soup, f, &count);
    share *face = &own.shares[f - own.begin];
    bool is_flat =
        !(count == 3 ? measure_triangle(&own, face, corner) : measure_polygon(&own, face, corner, count));
    flat += is_flat;
    if (own.flat)
      own.flat[f] = is_flat;
  }
  atomic_fetch_add_explicit(&s->flat_faces, flat, memory_order_relaxed);
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
                               const vxm_unit_scale *frame, uint8_t *flat, vxm_error *error) {
  *out = (vxm_surface_sums){0};
  vxm_error local = VXM_ERROR_INIT;
  summing s = {.soup = soup, .scale = frame->scale, .no_area = frame->no_area, .flat = flat};
  for (int a = 0; a < 3; a++)
    s.middle[a] = (bounds[a] * s.scale + bounds[a + 3] * s.scale) / 2;
  size_t block = vxm_context_threads(soup->context) == 1 ? BLOCK_ALONE : BLOCK;
  block = soup->face_count < block ? soup->face_count : block;
  s.shares = vxm_alloc(soup->context, block, sizeof *s.shares, &local);
  vxm_status status = s.shares ? VXM_OK : local.code;
  for (; status == VXM_OK && s.begin < soup->face_count; s.begin = s.end) {
    s.end = soup->face_count - s.begin < block ? soup->face_count : s.begin + block;
    vxm_parallel(soup->context, (s.end - s.begin - 1) / SLICE + 1, measure_slice, &s);
    add_shares(out, s.shares, s.end - s.begin);
    status = vxm_check_cancelled(soup->context, &local);
  }
  vxm_free(soup->context, s.shares);
  out->volume = out->volume / s.scale / s.scale / s.scale;
  out->flat_faces = atomic_load(&s.flat_faces);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
