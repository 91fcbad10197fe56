/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/format.h"
#include "gridio/gridio.h"

#include <string.h>

/* ---- The table ---- */

static const vxm_grid_format mesh_formats[] = {
    {"obj", NULL, NULL, NULL, NULL, NULL},
    {"ply", NULL, NULL, NULL, NULL, NULL},
    {"stl", NULL, NULL, NULL, NULL, NULL},
    {"off", NULL, NULL, NULL, NULL, NULL},
};

/** In the order in which the content is asked. */
static const vxm_grid_format *const formats[] = {
    &vxm_format_raw, &vxm_format_binvox, &vxm_format_npy,  &vxm_format_rle,  &vxm_format_nrrd,
    &vxm_format_vdb, &mesh_formats[0],   &mesh_formats[1], &mesh_formats[2], &mesh_formats[3],
};

enum { FORMATS = sizeof formats / sizeof formats[0] };

static const vxm_grid_format *find_name(const char *name) {
  for (size_t f = 0; f < FORMATS; f++)
    if (vxm_text_equal_nocase(formats[f]->name, name))
      return formats[f];
  return NULL;
}

static const vxm_grid_format *find_content(const vxm_input *input) {
  for (size_t f = 0; f < FORMATS; f++)
    if (formats[f]->sniff && formats[f]->sniff(input))
      return formats[f];
  return NULL;
}

vxm_status vxm_space_check_file(const vxm_space *space, const vxm_input *input, size_t offset,
                                vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = vxm_space_check(space, &local);
  if (status == VXM_OK)
    return VXM_OK;
  if (status == VXM_ERROR_ARGUMENT)
    status = VXM_ERROR_FORMAT;
  return vxm_fail_at(error, status, (vxm_place){input->name, 0, (int64_t)offset, -1}, "%s", local.text);
}

static vxm_status find_format(const vxm_grid_format **out, const vxm_input *input, const char *path,
                              vxm_error *error) {
  const vxm_grid_format *format = find_content(input);
  if (!format)
    format = find_name(vxm_path_extension(path));
  *out = format;
  if (!format)
    return vxm_fail_at(
        error, VXM_ERROR_FORMAT, (vxm_place){input->name, 0, -1, -1},
        "not a grid: neither content nor name are those of .binvox, .npy, .raw, .rle, .nrrd or .vdb");
  if (!format->read)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){input->name, 0, -1, -1},
                       "not a grid but a mesh, by its name; voxelize it first");
  return VXM_OK;
}

/** Opens a file, finds its format, and reads bits by a rule, or else, if `field` is not NULL, numbers. */
static vxm_status read_file(vxm_grid **grid, vxm_field **field, vxm_bits_rule rule, vxm_context *context,
                            const char *path, vxm_error *error) {
  const vxm_grid_format *format;
  vxm_input input;
  vxm_error local = VXM_ERROR_INIT;
  *grid = NULL;
  vxm_status status = vxm_input_open(&input, context, path, error);
  if (status != VXM_OK)
    return status;
  status = find_format(&format, &input, path, &local);
  if (status == VXM_OK)
    status = format->read(grid, &input, rule, &local);
  if (status == VXM_ERROR_NUMBERS && field && format->read_field) {
    local = (vxm_error)VXM_ERROR_INIT;
    status = format->read_field(field, &input, &local);
  }
  vxm_input_close(&input);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_gridio_read(vxm_grid **out, vxm_context *context, const char *path, vxm_error *error) {
  return read_file(out, NULL, VXM_BITS_ANY, context, path, error);
}

vxm_status vxm_gridio_read_either(vxm_grid **grid, vxm_field **field, vxm_context *context, const char *path,
                                  vxm_error *error) {
  *field = NULL;
  return read_file(grid, field, VXM_BITS_STORED, context, path, error);
}

vxm_status vxm_gridio_read_space(vxm_grid **out, vxm_context *context, const char *path, vxm_error *error) {
  vxm_status status = read_file(out, NULL, VXM_BITS_NONE, context, path, error);
  if (status == VXM_OK)
    memset((*out)->words, 0, (*out)->word_count * sizeof *(*out)->words);
  return status;
}

const vxm_grid_format *vxm_grid_format_for(const char *path, const char *format, vxm_error *error) {
  const char *name = format ? format : vxm_path_extension(path);
  const vxm_grid_format *found = find_name(name);
  if (found)
    return found;
  if (!format && !*name)
    vxm_fail_at(
        error, VXM_ERROR_ARGUMENT, (vxm_place){path, 0, -1, -1},
        "no format is given and the name has no extension; choose binvox, npy, raw, rle, nrrd, vdb, obj, "
        "ply, stl or off");
  else
    vxm_fail_at(error, VXM_ERROR_ARGUMENT, (vxm_place){path, 0, -1, -1},
                "unknown grid format \"%s\"; choose binvox, npy, raw, rle, nrrd, vdb, obj, ply, stl or off",
                name);
  return NULL;
}
