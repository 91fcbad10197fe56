/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/page/page.h"
#include "gridio/page/parts.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/** page.html with its styles and scripts in it. */
static const unsigned char frame_bytes[] = {
#include "view_page.inc"
};

/** Bytes of a texture, and voxels along a side, that browsers take everywhere. */
enum { TEXTURE_MAX = 1 << 27, SIDE_MAX = 2048 };

json_t *vxm_page_text(const char *text) {
  json_t *value = json_string(text);
  if (value)
    return value;
  char *plain = strdup(text);
  for (char *c = plain; c && *c; c++)
    if ((unsigned char)*c >= 128)
      *c = '?';
  value = plain ? json_string(plain) : NULL;
  free(plain);
  return value;
}

json_t *vxm_page_color(const uint8_t rgb[3]) {
  char text[8];
  snprintf(text, sizeof text, "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
  return json_string(text);
}

static vxm_status check(const vxm_space *space, const vxm_field *field, const vxm_page_options *options,
                        vxm_error *error) {
  const int64_t *n = space->dims;
  size_t bytes = !field ? 1 : field->channels == 4 ? 4 : 2;
  if (options->up < 0 || options->up > 3)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "page: up axis %d; choose 1 (x), 2 (y) or 3 (z)", options->up);
  if (n[0] > SIDE_MAX || n[1] > SIDE_MAX || n[2] > SIDE_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "page: a browser takes up to %d voxels along an axis, not %" PRId64 " x %" PRId64
                    " x %" PRId64,
                    SIDE_MAX, n[0], n[1], n[2]);
  if ((uint64_t)(n[0] * n[1] * n[2]) > TEXTURE_MAX / bytes)
    return vxm_fail(
        error, VXM_ERROR_RANGE,
        "page: %" PRId64 " x %" PRId64 " x %" PRId64
        " voxels are too many for a browser, which takes %zu million of them; make them at a lower "
        "resolution, or a picture (.png)",
        n[0], n[1], n[2], TEXTURE_MAX / bytes / 1000000);
  return VXM_OK;
}

/** What is told of every page. */
static json_t *describe(const vxm_space *space, const vxm_page_options *options) {
  const int64_t *n = space->dims;
  const double *o = space->origin, *s = space->voxel_size;
  return json_pack("{s:o, s:[I,I,I], s:[f,f,f], s:[f,f,f], s:i}", "title",
                   vxm_page_text(options->title ? options->title : ""), "dims", (json_int_t)n[0],
                   (json_int_t)n[1], (json_int_t)n[2], "origin", o[0], o[1], o[2], "voxel", s[0], s[1], s[2],
                   "up", options->up == 0 ? 2 : options->up - 1);
}

/** JSON in a page: "</script>" must not end it. */
static void put_json(vxm_output *output, const char *text) {
  for (const char *end; (end = strchr(text, '<')) != NULL; text = end + 1) {
    vxm_output_write(output, text, (size_t)(end - text));
    vxm_output_write(output, "\\u003c", 6);
  }
  vxm_output_write(output, text, strlen(text));
}

static vxm_status put_about(const vxm_page *page, vxm_error *error) {
  char *text = page->about ? json_dumps(page->about, JSON_COMPACT | JSON_REAL_PRECISION(9)) : NULL;
  if (!text)
    return vxm_fail(error, VXM_ERROR_MEMORY, "page: out of memory");
  vxm_output_printf(page->output, "<script type=\"application/json\" id=\"about\">");
  put_json(page->output, text);
  vxm_output_printf(page->output, "</script>\n");
  free(text);
  return VXM_OK;
}

static vxm_status put_all(vxm_page *page, const vxm_grid *grid, const vxm_field *field,
                          const vxm_page_options *options, const vxm_threshold_options *threshold,
                          vxm_error *error) {
  static const char mark[] = "@DATA@";
  const char *frame = (const char *)frame_bytes; /* it ends with a 0 */
  const char *found = strstr(frame, mark), *rest = found + sizeof mark - 1;
  vxm_output_write(page->output, frame, (size_t)(found - frame));
  vxm_status status =
      grid ? vxm_page_put_grid(page, grid, error) : vxm_page_put_field(page, field, threshold, error);
  if (status == VXM_OK)
    status = vxm_progress(page->context, "page", options->mesh ? 0.5 : 1, error);
  if (status == VXM_OK && options->mesh)
    status = vxm_page_put_mesh(page, options->mesh, options->repaired, error);
  if (status == VXM_OK)
    status = put_about(page, error);
  vxm_output_write(page->output, rest, strlen(rest));
  return status;
}

vxm_status vxm_gridio_page(const vxm_grid *grid, const vxm_field *field, const char *path,
                           const vxm_page_options *options, const vxm_threshold_options *threshold,
                           vxm_error *error) {
  vxm_page page = {.context = grid ? grid->context : field->context,
                   .space = grid ? &grid->space : &field->space};
  vxm_status status = check(page.space, field, options, error);
  if (status == VXM_OK)
    status = vxm_output_open(&page.output, page.context, path, error);
  if (status != VXM_OK)
    return status;
  page.about = describe(page.space, options);
  status = put_all(&page, grid, field, options, threshold, error);
  json_decref(page.about);
  if (status == VXM_OK)
    return vxm_output_commit(page.output, error);
  vxm_output_abort(page.output);
  return status;
}
