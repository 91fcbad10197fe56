/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/common/text_out.h"

void vxm_text_vertex(vxm_text_out *text, const char *lead, const double position[3]) {
  char *room = vxm_output_reserve(text->output, 4 * VXM_NUMBER_ROOM);
  size_t used = 0;
  while (*lead)
    room[used++] = *lead++;
  for (size_t c = 0; c < 3; c++) {
    used += vxm_number_write(room + used, position[c]);
    room[used++] = c < 2 ? ' ' : '\n';
  }
  vxm_output_advance(text->output, used);
}

void vxm_text_vertex_float(vxm_text_out *text, const char *lead, const float position[3]) {
  char *room = vxm_output_reserve(text->output, 4 * VXM_NUMBER_ROOM);
  size_t used = 0;
  while (*lead)
    room[used++] = *lead++;
  for (size_t c = 0; c < 3; c++) {
    used += vxm_number_write_float(room + used, position[c]);
    room[used++] = c < 2 ? ' ' : '\n';
  }
  vxm_output_advance(text->output, used);
}

void vxm_text_uint(vxm_text_out *text, uint64_t value) {
  char *room = vxm_output_reserve(text->output, VXM_NUMBER_ROOM);
  vxm_output_advance(text->output, vxm_number_write_uint(room, value));
}

void vxm_text_corners(vxm_text_out *text, const uint32_t *corner, size_t count, uint64_t first) {
  for (size_t c = 0; c < count; c++) {
    char *room = vxm_output_reserve(text->output, VXM_NUMBER_ROOM);
    room[0] = ' ';
    vxm_output_advance(text->output, 1 + vxm_number_write_uint(room + 1, first + corner[c]));
  }
  vxm_output_write(text->output, "\n", 1);
}

vxm_status vxm_write_progress(const vxm_soup *soup, const vxm_output *output, size_t done, size_t count,
                              double begin, double end, vxm_error *error) {
  if (done % (1 << 16) != 0)
    return VXM_OK;
  if (vxm_output_failed(output))
    return VXM_ERROR_IO;
  return vxm_progress(soup->context, "writing", begin + (end - begin) * ((double)done / (double)count),
                      error);
}
