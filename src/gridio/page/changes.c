/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/page/changes.h"
#include "base/exact_math.h"
#include "base/hash.h"
#include "mesh/near_vertices.h"
#include "mesh/sort.h"

#include <math.h>
#include <string.h>

/** Both meshes' vertices, one after the other. */
typedef struct vertices {
  double *positions;
  uint8_t *roles;
  uint32_t *map;
  uint64_t *keys[2], *scratch; /**< of the faces of each mesh, in order */
} vertices;

static void gather(vertices *v, const vxm_soup *soup, size_t first, double bounds[6]) {
  if (soup->vertex_count > 0)
    memcpy(v->positions + 3 * first, soup->positions, 3 * soup->vertex_count * sizeof *v->positions);
  for (size_t i = 0; i < soup->vertex_count; i++) {
    const double *p = vxm_position(soup, i);
    bool is_finite = isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
    v->roles[first + i] = is_finite ? VXM_NEAR_MEMBER : VXM_NEAR_ABSENT;
    for (int a = 0; is_finite && a < 3; a++) {
      bounds[a] = fmin(bounds[a], p[a]);
      bounds[3 + a] = fmax(bounds[3 + a], p[a]);
    }
  }
}

/** The same for the same corners in any order. */
static uint64_t key_of(const vxm_soup *soup, size_t face, const uint32_t *map) {
  size_t count;
  const uint32_t *corner = vxm_face(soup, face, &count);
  uint64_t sum = vxm_mix(count);
  for (size_t c = 0; c < count; c++)
    sum += vxm_mix(map[corner[c]] + UINT64_C(0x9e3779b97f4a7c15));
  return sum;
}

static bool has_key(const uint64_t *keys, size_t count, uint64_t key) {
  size_t low = 0, high = count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (keys[middle] < key)
      low = middle + 1;
    else
      high = middle;
  }
  return low < count && keys[low] == key;
}

static void compare(uint8_t *missing, const vxm_soup *soup, const uint32_t *map, const uint64_t *others,
                    size_t other_count) {
  for (size_t f = 0; f < soup->face_count; f++)
    missing[f] = !has_key(others, other_count, key_of(soup, f, map));
}

static vxm_status make_room(vertices *v, const vxm_soup *before, const vxm_soup *after, vxm_error *error) {
  vxm_context *context = before->context;
  size_t count = before->vertex_count + after->vertex_count;
  size_t faces = before->face_count > after->face_count ? before->face_count : after->face_count;
  vxm_error local = VXM_ERROR_INIT;
  v->positions = vxm_alloc(context, count, 3 * sizeof *v->positions, &local);
  v->roles = v->positions ? vxm_alloc(context, count, 1, &local) : NULL;
  v->map = v->roles ? vxm_alloc(context, count, sizeof *v->map, &local) : NULL;
  v->keys[0] = v->map ? vxm_alloc(context, before->face_count, sizeof **v->keys, &local) : NULL;
  v->keys[1] = v->keys[0] ? vxm_alloc(context, after->face_count, sizeof **v->keys, &local) : NULL;
  v->scratch = v->keys[1] ? vxm_alloc(context, faces, sizeof *v->scratch, &local) : NULL;
  if (!v->scratch)
    vxm_error_pass(error, &local);
  return v->scratch ? VXM_OK : local.code;
}

static vxm_status weld(vertices *v, const vxm_soup *before, const vxm_soup *after, vxm_error *error) {
  double b[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
  gather(v, before, 0, b);
  gather(v, after, before->vertex_count, b);
  double diagonal = vxm_length3(b[3] - b[0], b[4] - b[1], b[5] - b[2]);
  double tolerance = isfinite(diagonal) ? 1e-6 * diagonal : 0;
  size_t count = before->vertex_count + after->vertex_count;
  return vxm_near_vertices_group(before->context, v->positions, count, v->roles, tolerance, v->map, error);
}

vxm_status vxm_mesh_changes(uint8_t *removed, uint8_t *added, const vxm_soup *before, const vxm_soup *after,
                            vxm_error *error) {
  vertices v = {0};
  vxm_context *context = before->context;
  if (before->vertex_count > VXM_VERTICES_MAX - after->vertex_count)
    return vxm_fail(error, VXM_ERROR_RANGE, "page: the mesh has too many vertices to be compared");
  vxm_status status = make_room(&v, before, after, error);
  if (status == VXM_OK)
    status = weld(&v, before, after, error);
  if (status == VXM_OK) {
    const uint32_t *later = v.map + before->vertex_count;
    for (size_t f = 0; f < before->face_count; f++)
      v.keys[0][f] = key_of(before, f, v.map);
    for (size_t f = 0; f < after->face_count; f++)
      v.keys[1][f] = key_of(after, f, later);
    vxm_sort_keys(v.keys[0], v.scratch, before->face_count);
    vxm_sort_keys(v.keys[1], v.scratch, after->face_count);
    compare(removed, before, v.map, v.keys[1], after->face_count);
    compare(added, after, later, v.keys[0], before->face_count);
  }
  vxm_free(context, v.scratch);
  vxm_free(context, v.keys[1]);
  vxm_free(context, v.keys[0]);
  vxm_free(context, v.map);
  vxm_free(context, v.roles);
  vxm_free(context, v.positions);
  return status;
}
