/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/face_sets.h"
#include "base/box.h"
#include "mesh/geometry.h"
#include "mesh/nonfinite.h"
#include "mesh/unit_scale.h"

vxm_status vxm_set_faces_create(vxm_set_faces *out, const vxm_soup *soup, vxm_error *error) {
  vxm_status status = VXM_OK;
  *out = (vxm_set_faces){.context = soup->context};
  out->faces = vxm_try_alloc(soup->context, soup->face_count, sizeof *out->faces, &status, error);
  out->begin = vxm_try_calloc(soup->context, soup->set_count + 2, sizeof *out->begin, &status, error);
  if (status != VXM_OK)
    return status;
  /* Counted two places on: as faces are put in place the ends of sets become their beginnings. */
  for (size_t f = 0; f < soup->face_count; f++)
    out->begin[soup->face_sets[f] + 2]++;
  for (size_t s = 2; s < soup->set_count + 2; s++)
    out->begin[s] += out->begin[s - 1];
  for (size_t f = 0; f < soup->face_count; f++)
    out->faces[out->begin[soup->face_sets[f] + 1]++] = (uint32_t)f;
  return VXM_OK;
}

void vxm_set_faces_destroy(vxm_set_faces *list) {
  vxm_free(list->context, list->faces);
  vxm_free(list->context, list->begin);
  *list = (vxm_set_faces){.context = list->context};
}

/* ---- Vertices ---- */

/** Of a vertex of several sets: the last set that has got it, and as what. */
typedef struct copy_of {
  uint32_t set, vertex;
} copy_of;

/** Makes the corners of a face those of its set. */
static vxm_status part_face(vxm_soup *soup, uint32_t face, copy_of *copies, vxm_error *error) {
  vxm_status status = VXM_OK;
  uint32_t set = soup->face_sets[face];
  for (uint64_t c = soup->offsets[face]; c < soup->offsets[face + 1] && status == VXM_OK; c++) {
    uint32_t vertex = soup->indices[c];
    copy_of *copy = &copies[vertex];
    if (copy->vertex == VXM_NO_VERTEX)
      *copy = (copy_of){set, vertex};
    else if (copy->set != set) {
      const double *p = vxm_position(soup, vertex);
      *copy = (copy_of){set, (uint32_t)soup->vertex_count};
      status = vxm_soup_add_vertex(soup, p[0], p[1], p[2], error);
    }
    soup->indices[c] = copy->vertex;
  }
  return status;
}

vxm_status vxm_face_sets_part(vxm_soup *soup, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_set_faces list;
  vxm_status status = vxm_set_faces_create(&list, soup, &local);
  size_t vertices = soup->vertex_count;
  copy_of *copies = status == VXM_OK ? vxm_alloc(soup->context, vertices, sizeof *copies, &local) : NULL;
  for (size_t v = 0; copies && v < vertices; v++)
    copies[v].vertex = VXM_NO_VERTEX;
  /* set by set: a vertex has to be remembered for one at a time */
  for (size_t i = 0; copies && i < soup->face_count && local.code == VXM_OK; i++) {
    part_face(soup, list.faces[i], copies, &local);
    vxm_check_cancelled_at(i, soup->context, &local);
  }
  vxm_free(soup->context, copies);
  vxm_set_faces_destroy(&list);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

/* ---- Winding ---- */

/** Of the finite corners; low above high if there is none. */
static void box_of(double box[6], const vxm_soup *soup, const uint32_t *faces, size_t count) {
  vxm_box_empty(box, box + 3);
  for (size_t i = 0; i < count; i++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, faces ? faces[i] : i, &n);
    for (size_t c = 0; c < n; c++)
      if (vxm_is_finite(vxm_position(soup, corner[c])))
        vxm_box_include(box, box + 3, vxm_position(soup, corner[c]));
  }
}

int vxm_faces_winding(const vxm_soup *soup, const uint32_t *faces, size_t count) {
  const double least = 1e-9; /* of the box */
  double box[6], volume = 0;
  box_of(box, soup, faces, count);
  if (!(box[0] <= box[3]))
    return 0;
  double scale = vxm_unit_scale_of(box).scale;
  for (int a = 0; a < 6; a++)
    box[a] *= scale;
  for (size_t i = 0; i < count; i++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, faces ? faces[i] : i, &n);
    if (n < 3 || !vxm_face_is_finite(soup, corner, n))
      continue;
    const double *p = vxm_position(soup, corner[0]);
    vxm_vec3 first = {p[0] * scale - (box[0] + box[3]) / 2, p[1] * scale - (box[1] + box[4]) / 2,
                      p[2] * scale - (box[2] + box[5]) / 2};
    volume += vxm_polygon_cone(first, vxm_polygon_area(soup->positions, corner, n, scale));
  }
  double room = (box[3] - box[0]) * (box[4] - box[1]) * (box[5] - box[2]);
  return volume > least * room ? 1 : volume < -least * room ? -1 : 0;
}
