/* SPDX-License-Identifier: BSD-3-Clause */
/** PLY with coloured faces and edges, as MeshLab and Blender show them. */
#include "meshio/formats/write_marked.h"
#include "base/endian.h"
#include "base/output.h"

static void write_header(const vxm_soup *soup, const vxm_marks *marks, vxm_output *output) {
  static const char colour[] = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  vxm_output_printf(output,
                    "ply\nformat binary_little_endian 1.0\ncomment voxmend: what is wrong, in colour\n"
                    "element vertex %zu\nproperty double x\nproperty double y\nproperty double z\n"
                    "element face %zu\nproperty list uint uint vertex_indices\n%s"
                    "element edge %zu\nproperty uint vertex1\nproperty uint vertex2\n%send_header\n",
                    soup->vertex_count, soup->face_count, colour, marks->edge_count, colour);
}

static void put_u32(vxm_output *output, uint32_t value, bool swap) {
  vxm_store_u32(vxm_output_reserve(output, 4), value, swap);
  vxm_output_advance(output, 4);
}

static void put_colour(vxm_output *output, vxm_colour colour) {
  unsigned char bytes[3] = {colour.red, colour.green, colour.blue};
  vxm_output_write(output, bytes, sizeof bytes);
}

static void write_body(const vxm_soup *soup, const vxm_marks *marks, vxm_output *output) {
  const bool swap = vxm_must_swap(false);
  for (size_t v = 0; v < soup->vertex_count; v++) {
    char *room = vxm_output_reserve(output, 24);
    for (size_t a = 0; a < 3; a++)
      vxm_store_f64(room + 8 * a, vxm_position(soup, v)[a], swap);
    vxm_output_advance(output, 24);
  }
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    put_u32(output, (uint32_t)count, swap);
    for (size_t i = 0; i < count; i++)
      put_u32(output, corner[i], swap);
    put_colour(output, marks->faces[f]);
  }
  for (size_t e = 0; e < marks->edge_count; e++) {
    put_u32(output, marks->edges[e].a, swap);
    put_u32(output, marks->edges[e].b, swap);
    put_colour(output, marks->edges[e].colour);
  }
}

vxm_status vxm_meshio_write_marked(const vxm_soup *soup, const vxm_marks *marks, const char *path,
                                   vxm_error *error) {
  vxm_output *output;
  if (!vxm_text_equal_nocase(vxm_path_extension(path), "ply"))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "%s: what is wrong is shown in .ply files; name one", path);
  vxm_status status = vxm_output_open(&output, soup->context, path, error);
  if (status != VXM_OK)
    return status;
  write_header(soup, marks, output);
  write_body(soup, marks, output);
  return vxm_output_commit(output, error);
}
