/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/common/faces_out.h"

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
