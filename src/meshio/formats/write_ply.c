/* SPDX-License-Identifier: BSD-3-Clause */
/** PLY out: doubles, little-endian or as text. */
#include "base/endian.h"
#include "meshio/common/faces_out.h"
#include "meshio/common/format.h"
#include "meshio/common/text_out.h"
#include "meshio/common/write_flags.h"

#include <inttypes.h>

static void write_header(const vxm_soup *soup, vxm_output *output, unsigned flags, bool long_lists) {
  vxm_output_printf(output, "ply\nformat %s 1.0\ncomment voxmend\nelement vertex %zu\n",
                    flags & VXM_WRITE_ASCII ? "ascii" : "binary_little_endian", soup->vertex_count);
  for (int c = 'x'; c <= 'z'; c++)
    vxm_output_printf(output, "property double %c\n", c);
  /* Readers know int for indices best; uint is for those beyond it. */
  vxm_output_printf(output, "element face %" PRIu64 "\nproperty list %s %s vertex_indices\nend_header\n",
                    vxm_faces_out_count(soup, flags & VXM_WRITE_POLYGONS), long_lists ? "uint" : "uchar",
                    soup->vertex_count > INT32_MAX ? "uint" : "int");
}

static vxm_status write_text(vxm_faces_out *faces, vxm_output *output, vxm_error *error) {
  const vxm_soup *soup = faces->soup;
  vxm_text_out text = {.output = output, .soup = soup};
  vxm_status status = VXM_OK;
  for (size_t v = 0; v < soup->vertex_count && status == VXM_OK; v++) {
    vxm_text_vertex(&text, "", vxm_position(soup, v));
    status = vxm_write_progress(soup, output, v, soup->vertex_count, 0.0, 0.6, error);
  }
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    status = vxm_faces_out_take(faces, f, error);
    for (size_t p = 0; p < faces->pieces && status == VXM_OK; p++) {
      vxm_text_uint(&text, faces->each);
      vxm_text_corners(&text, faces->corners + 3 * p, faces->each, 0);
    }
    if (status == VXM_OK)
      status = vxm_write_progress(soup, output, f, soup->face_count, 0.6, 1.0, error);
  }
  return status;
}

static void write_face(vxm_output *output, const uint32_t *corner, size_t count, bool long_lists, bool swap) {
  unsigned char *room = (unsigned char *)vxm_output_reserve(output, 4);
  if (long_lists)
    vxm_store_u32(room, (uint32_t)count, swap);
  else
    room[0] = (unsigned char)count;
  vxm_output_advance(output, long_lists ? 4 : 1);
  for (size_t c = 0; c < count; c++) {
    vxm_store_u32(vxm_output_reserve(output, 4), corner[c], swap);
    vxm_output_advance(output, 4);
  }
}

static vxm_status write_binary(vxm_faces_out *faces, vxm_output *output, bool long_lists, vxm_error *error) {
  const vxm_soup *soup = faces->soup;
  const bool swap = vxm_must_swap(false);
  vxm_status status = VXM_OK;
  for (size_t v = 0; v < soup->vertex_count && status == VXM_OK; v++) {
    const double *p = vxm_position(soup, v);
    char *room = vxm_output_reserve(output, 24);
    for (size_t c = 0; c < 3; c++)
      vxm_store_f64(room + 8 * c, p[c], swap);
    vxm_output_advance(output, 24);
    status = vxm_write_progress(soup, output, v, soup->vertex_count, 0.0, 0.6, error);
  }
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    status = vxm_faces_out_take(faces, f, error);
    for (size_t p = 0; p < faces->pieces && status == VXM_OK; p++)
      write_face(output, faces->corners + 3 * p, faces->each, long_lists, swap);
    if (status == VXM_OK)
      status = vxm_write_progress(soup, output, f, soup->face_count, 0.6, 1.0, error);
  }
  return status;
}

vxm_status vxm_ply_write(const vxm_soup *soup, vxm_output *output, unsigned flags, vxm_error *error) {
  size_t largest = flags & VXM_WRITE_POLYGONS ? vxm_largest_face(soup) : 3;
  if (largest > UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "a face has %zu corners, more than PLY can hold", largest);
  bool long_lists = largest > UINT8_MAX;
  vxm_faces_out faces;
  vxm_faces_out_open(&faces, soup, flags & VXM_WRITE_POLYGONS);
  write_header(soup, output, flags, long_lists);
  vxm_status status = flags & VXM_WRITE_ASCII ? write_text(&faces, output, error)
                                              : write_binary(&faces, output, long_lists, error);
  vxm_faces_out_close(&faces);
  return status;
}
