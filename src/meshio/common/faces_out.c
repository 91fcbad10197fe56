/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/common/faces_out.h"

#include <string.h>

void vxm_faces_out_open(vxm_faces_out *out, const vxm_soup *soup, bool polygons) {
  *out = (vxm_faces_out){.soup = soup, .polygons = polygons};
  vxm_triangulator_open(&out->tri, soup->context);
}

void vxm_faces_out_close(vxm_faces_out *out) {
  vxm_triangulator_close(&out->tri);
}

vxm_status vxm_faces_out_take(vxm_faces_out *out, size_t face, vxm_error *error) {
  size_t count;
  out->corners = vxm_face(out->soup, face, &count);
  out->pieces = 1;
  out->each = count;
  if (out->polygons || count == 3)
    return VXM_OK;
  out->pieces = count > 3 ? count - 2 : 0;
  out->each = 3;
  return count > 3
             ? vxm_triangulate(&out->tri, out->soup->positions, out->corners, count, &out->corners, error)
             : VXM_OK;
}

uint64_t vxm_faces_out_count(const vxm_soup *soup, bool polygons) {
  uint64_t count = 0;
  for (size_t f = 0; f < soup->face_count && !polygons; f++) {
    uint64_t corners = soup->offsets[f + 1] - soup->offsets[f];
    count += corners > 2 ? corners - 2 : 0;
  }
  return polygons ? soup->face_count : count;
}

static vxm_status copy_vertices_and_tags(vxm_soup *to, const vxm_soup *from, vxm_error *error) {
  vxm_status status = VXM_OK;
  if (from->vertex_count > 0)
    memcpy(to->positions, from->positions, 3 * from->vertex_count * sizeof *to->positions);
  to->vertex_count = from->vertex_count;
  uint32_t tag;
  for (size_t t = 0; status == VXM_OK && t < from->tag_count; t++)
    status = vxm_soup_add_tag(to, from->tags[t], strlen(from->tags[t]), &tag, error);
  if (status != VXM_OK || from->tag_count == 0)
    return status;
  vxm_error local = VXM_ERROR_INIT;
  to->face_tags = vxm_alloc(to->context, to->face_capacity, sizeof *to->face_tags, &local);
  if (!to->face_tags)
    vxm_error_pass(error, &local);
  return to->face_tags ? VXM_OK : local.code;
}

static vxm_status add_triangles(vxm_soup *to, vxm_faces_out *faces, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t f = 0; status == VXM_OK && f < faces->soup->face_count; f++) {
    status = vxm_faces_out_take(faces, f, error);
    for (size_t t = 0; status == VXM_OK && t < faces->pieces; t++) {
      if (to->face_tags)
        to->face_tags[to->face_count] = faces->soup->face_tags[f];
      status = vxm_soup_add_face(to, faces->corners + 3 * t, 3, error);
    }
  }
  return status;
}

vxm_status vxm_faces_out_triangles(vxm_soup **out, const vxm_soup *soup, vxm_error *error) {
  vxm_soup *made;
  size_t count = (size_t)vxm_faces_out_count(soup, false);
  vxm_status status = vxm_soup_create(&made, soup->context, soup->format, error);
  if (status != VXM_OK)
    return status;
  status = vxm_soup_reserve(made, soup->vertex_count, count, 3 * count, error);
  if (status == VXM_OK)
    status = copy_vertices_and_tags(made, soup, error);
  vxm_faces_out faces;
  vxm_faces_out_open(&faces, soup, false);
  if (status == VXM_OK)
    status = add_triangles(made, &faces, error);
  vxm_faces_out_close(&faces);
  if (status == VXM_OK)
    *out = made;
  else
    vxm_soup_destroy(made);
  return status;
}
