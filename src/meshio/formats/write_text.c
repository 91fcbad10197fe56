/* SPDX-License-Identifier: BSD-3-Clause */
/** OFF and OBJ out. */
#include "meshio/common/faces_out.h"
#include "meshio/common/format.h"
#include "meshio/common/text_out.h"
#include "meshio/common/write_flags.h"

#include <inttypes.h>
#include <string.h>

static vxm_status write_vertices(vxm_text_out *text, const char *lead, vxm_error *error) {
  const vxm_soup *soup = text->soup;
  vxm_status status = VXM_OK;
  for (size_t v = 0; v < soup->vertex_count && status == VXM_OK; v++) {
    vxm_text_vertex(text, lead, vxm_position(soup, v));
    status = vxm_write_progress(soup, text->output, v, soup->vertex_count, 0.0, 0.6, error);
  }
  return status;
}

static vxm_status write_off(vxm_text_out *text, vxm_faces_out *faces, vxm_error *error) {
  const vxm_soup *soup = text->soup;
  vxm_output_printf(text->output, "OFF\n%zu %" PRIu64 " 0\n", soup->vertex_count,
                    vxm_faces_out_count(soup, faces->polygons));
  vxm_status status = write_vertices(text, "", error);
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    status = vxm_faces_out_take(faces, f, error);
    for (size_t p = 0; p < faces->pieces && status == VXM_OK; p++) {
      vxm_text_uint(text, faces->each);
      vxm_text_corners(text, faces->corners + 3 * p, faces->each, 0);
    }
    if (status == VXM_OK)
      status = vxm_write_progress(soup, text->output, f, soup->face_count, 0.6, 1.0, error);
  }
  return status;
}

/** A tag "group" or "group/material" as the statements that make it again. */
static void write_tag(vxm_text_out *text, const char *tag, const char *before) {
  const char *slash = strrchr(tag, '/');
  size_t group = slash ? (size_t)(slash - tag) : strlen(tag);
  const char *old_slash = before ? strrchr(before, '/') : NULL;
  vxm_output_write(text->output, "g ", 2);
  vxm_output_write(text->output, tag, group);
  vxm_output_write(text->output, "\n", 1);
  if (!slash && !old_slash)
    return;
  /* A tag without a material after one with: the empty name takes the material back. */
  vxm_output_write(text->output, "usemtl ", 7);
  if (slash)
    vxm_output_write(text->output, slash + 1, strlen(slash + 1));
  vxm_output_write(text->output, "\n", 1);
}

static vxm_status write_obj(vxm_text_out *text, vxm_faces_out *faces, vxm_error *error) {
  const vxm_soup *soup = text->soup;
  vxm_status status = write_vertices(text, "v ", error);
  const char *tag = NULL;
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    /* OBJ has no faces of one or two corners. */
    if (soup->offsets[f + 1] - soup->offsets[f] < 3)
      continue;
    if (soup->face_tags && (!tag || soup->tags[soup->face_tags[f]] != tag)) {
      write_tag(text, soup->tags[soup->face_tags[f]], tag);
      tag = soup->tags[soup->face_tags[f]];
    }
    status = vxm_faces_out_take(faces, f, error);
    for (size_t p = 0; p < faces->pieces && status == VXM_OK; p++) {
      vxm_output_write(text->output, "f", 1);
      vxm_text_corners(text, faces->corners + 3 * p, faces->each, 1);
    }
    if (status == VXM_OK)
      status = vxm_write_progress(soup, text->output, f, soup->face_count, 0.6, 1.0, error);
  }
  return status;
}

typedef vxm_status (*write_all)(vxm_text_out *text, vxm_faces_out *faces, vxm_error *error);

static vxm_status write_as(write_all write, const vxm_soup *soup, vxm_output *output, unsigned flags,
                           vxm_error *error) {
  vxm_text_out text = {.output = output, .soup = soup};
  vxm_faces_out faces;
  vxm_faces_out_open(&faces, soup, flags & VXM_WRITE_POLYGONS);
  vxm_status status = write(&text, &faces, error);
  vxm_faces_out_close(&faces);
  return status;
}

vxm_status vxm_off_write(const vxm_soup *soup, vxm_output *output, unsigned flags, vxm_error *error) {
  return write_as(write_off, soup, output, flags, error);
}

vxm_status vxm_obj_write(const vxm_soup *soup, vxm_output *output, unsigned flags, vxm_error *error) {
  return write_as(write_obj, soup, output, flags, error);
}
