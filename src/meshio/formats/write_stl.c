/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * STL out: 32-bit floats and triangles; larger polygons are split. Text holds the very numbers that binary
 * files hold, for readers of doubles too, which the shortest digits of a float are not.
 */
#include "base/endian.h"
#include "meshio/common/faces_out.h"
#include "meshio/common/format.h"
#include "meshio/common/text_out.h"
#include "meshio/common/write_flags.h"
#include "meshio/formats/stl.h"

#include <inttypes.h>
#include <math.h>

/** Either of the two forms. */
typedef struct stl_writer {
  const vxm_soup *soup;
  vxm_output *output;
  vxm_text_out text;
  bool ascii;
} stl_writer;

static vxm_status count_facets(const vxm_soup *soup, uint32_t *facets, vxm_error *error) {
  uint64_t count = vxm_faces_out_count(soup, false);
  if (count > UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "%" PRIu64 " triangles are more than STL can hold; write ply",
                    count);
  *facets = (uint32_t)count;
  return VXM_OK;
}

/** Vertices that no facet has are not written, and may be anything. */
static vxm_status check_range(const vxm_soup *soup, vxm_error *error) {
  for (size_t i = 0; i < soup->corner_count; i++) {
    vxm_status status = vxm_check_cancelled_at(i, soup->context, error);
    if (status != VXM_OK)
      return status;
    for (size_t c = 0; c < 3; c++) {
      uint32_t v = soup->indices[i];
      double value = vxm_position(soup, v)[c];
      /* Halfway from FLT_MAX to the next power of two is the first value that becomes infinite. */
      if (isfinite(value) && fabs(value) >= 0x1.ffffffp127)
        return vxm_fail_at(error, VXM_ERROR_RANGE, (vxm_place){NULL, 0, -1, (int64_t)v},
                           "vertex %" PRIu32
                           ": %c = %g is beyond the 32-bit floats of STL; write ply or scale down",
                           v, (char)('x' + c), value);
    }
  }
  return VXM_OK;
}

/** The unit normal of a triangle, 0 if it has none. */
static void normal_of(const float corner[3][3], float normal[3]) {
  double a[3], b[3], n[3];
  for (size_t c = 0; c < 3; c++) {
    a[c] = (double)corner[1][c] - (double)corner[0][c];
    b[c] = (double)corner[2][c] - (double)corner[0][c];
  }
  n[0] = a[1] * b[2] - a[2] * b[1];
  n[1] = a[2] * b[0] - a[0] * b[2];
  n[2] = a[0] * b[1] - a[1] * b[0];
  double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (size_t c = 0; c < 3; c++)
    normal[c] = length > 0.0 && isfinite(length) ? (float)(n[c] / length) : 0.0f;
}

static void write_facet(stl_writer *writer, const uint32_t triangle[3]) {
  float corner[3][3], normal[3];
  for (size_t k = 0; k < 3; k++)
    for (size_t c = 0; c < 3; c++)
      corner[k][c] = (float)vxm_position(writer->soup, triangle[k])[c];
  normal_of(corner, normal);
  if (writer->ascii) {
    vxm_text_vertex_float(&writer->text, "  facet normal ", normal);
    vxm_output_printf(writer->output, "    outer loop\n");
    for (size_t k = 0; k < 3; k++)
      vxm_text_vertex(&writer->text, "      vertex ",
                      (const double[]){(double)corner[k][0], (double)corner[k][1], (double)corner[k][2]});
    vxm_output_printf(writer->output, "    endloop\n  endfacet\n");
    return;
  }
  const bool swap = vxm_must_swap(false);
  char *room = vxm_output_reserve(writer->output, VXM_STL_FACET);
  for (size_t c = 0; c < 3; c++)
    vxm_store_f32(room + 4 * c, normal[c], swap);
  for (size_t k = 0; k < 3; k++)
    for (size_t c = 0; c < 3; c++)
      vxm_store_f32(room + 12 + 12 * k + 4 * c, corner[k][c], swap);
  room[48] = room[49] = 0;
  vxm_output_advance(writer->output, VXM_STL_FACET);
}

static vxm_status write_facets(stl_writer *writer, vxm_error *error) {
  const vxm_soup *soup = writer->soup;
  vxm_faces_out faces;
  vxm_faces_out_open(&faces, soup, false);
  vxm_status status = VXM_OK;
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    status = vxm_faces_out_take(&faces, f, error);
    for (size_t t = 0; status == VXM_OK && t < faces.pieces; t++)
      write_facet(writer, faces.corners + 3 * t);
    if (status == VXM_OK)
      status = vxm_write_progress(soup, writer->output, f, soup->face_count, 0.0, 1.0, error);
  }
  vxm_faces_out_close(&faces);
  return status;
}

vxm_status vxm_stl_write(const vxm_soup *soup, vxm_output *output, unsigned flags, vxm_error *error) {
  const bool ascii = flags & VXM_WRITE_ASCII;
  stl_writer writer = {
      .soup = soup, .output = output, .ascii = ascii, .text = {.output = output, .soup = soup}};
  uint32_t facets = 0;
  vxm_status status = check_range(soup, error);
  if (status == VXM_OK)
    status = count_facets(soup, &facets, error);
  if (status != VXM_OK)
    return status;
  if (ascii)
    vxm_output_printf(output, "solid voxmend\n");
  else {
    /* The text must not begin with "solid", by which readers tell the other form. */
    unsigned char header[VXM_STL_FACETS_AT] = "voxmend";
    vxm_store_u32(header + VXM_STL_COUNT_AT, facets, vxm_must_swap(false));
    vxm_output_write(output, header, sizeof header);
  }
  status = write_facets(&writer, error);
  if (ascii)
    vxm_output_printf(output, "endsolid voxmend\n");
  return status;
}
