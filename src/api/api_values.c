/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions about fields in files: they check arguments and call down. */
#include "base/sized.h"
#include "grid/crop.h"
#include "gridio/common/values_crop.h"
#include "gridio/gridio.h"
#include "gridio/page/page.h"
#include "gridio/picture/picture.h"

#include <inttypes.h>
#include <string.h>

static vxm_status fail_null(vxm_error *error) {
  return vxm_fail(error, VXM_ERROR_ARGUMENT, "field: an argument is NULL");
}

/* ---- Making and reading ---- */

static vxm_status check_new(const vxm_space *space, vxm_field_kind kind, vxm_scalar scalar,
                            vxm_error *error) {
  if (!*vxm_field_kind_name(kind))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "field: %d is none of the kinds of fields", (int)kind);
  if (!*vxm_scalar_name(scalar) || (kind == VXM_FIELD_COLORS && scalar != VXM_UINT8))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "field: scalar %d is none that %s can have", (int)scalar,
                    vxm_field_kind_name(kind));
  return vxm_space_check(space, error);
}

vxm_status vxm_field_create(vxm_field **out, vxm_context *context, const vxm_space *space,
                            vxm_field_kind kind, vxm_scalar scalar, const void *values, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !space || !values)
    return fail_null(error);
  vxm_context *owner;
  vxm_status status = check_new(space, kind, scalar, error);
  if (status == VXM_OK)
    status = vxm_context_acquire(&owner, context, error);
  if (status != VXM_OK)
    return status;
  status = vxm_field_make(out, owner, space, kind, scalar, error);
  vxm_context_release(owner);
  if (status != VXM_OK)
    return status;
  (*out)->about.is_declared = kind != VXM_FIELD_NUMBERS;
  vxm_field_put_all(*out, values, false);
  return VXM_OK;
}

vxm_status vxm_grid_or_field_read(vxm_grid **grid, vxm_field **field, vxm_context *context, const char *path,
                                  vxm_error *error) {
  if (grid)
    *grid = NULL;
  if (field)
    *field = NULL;
  if (!grid || !field || !path)
    return fail_null(error);
  vxm_context *owner;
  vxm_status status = vxm_context_acquire(&owner, context, error);
  if (status != VXM_OK)
    return status;
  status = vxm_gridio_read_either(grid, field, owner, path, error);
  vxm_context_release(owner);
  return status;
}

/** Bits as numbers. */
static vxm_status spread(vxm_field **out, const vxm_grid *grid, vxm_error *error) {
  vxm_status status = vxm_field_make(out, grid->context, &grid->space, VXM_FIELD_NUMBERS, VXM_UINT8, error);
  if (status != VXM_OK)
    return status;
  vxm_field_put_grid(*out, grid);
  (*out)->warnings = grid->warnings;
  return VXM_OK;
}

vxm_status vxm_field_read(vxm_field **out, vxm_context *context, const char *path, vxm_error *error) {
  vxm_grid *grid;
  if (out)
    *out = NULL;
  if (!out || !path)
    return fail_null(error);
  vxm_status status = vxm_grid_or_field_read(&grid, out, context, path, error);
  if (status == VXM_OK && grid)
    status = spread(out, grid, error);
  vxm_grid_destroy(grid);
  return status;
}

vxm_status vxm_field_window(vxm_field **out, const vxm_field *field, const int64_t begin[3],
                            const int64_t end[3], vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !field || !begin || !end)
    return fail_null(error);
  vxm_status status = vxm_space_check_box(&field->space, begin, end, error);
  return status == VXM_OK ? vxm_field_crop(out, field, begin, end, error) : status;
}

/* ---- What it holds ---- */

const vxm_space *vxm_field_space(const vxm_field *field) {
  return field ? &field->space : NULL;
}

vxm_field_kind vxm_field_kind_of(const vxm_field *field) {
  return field ? field->about.kind : VXM_FIELD_NUMBERS;
}

vxm_scalar vxm_field_scalar(const vxm_field *field) {
  return field ? field->scalar : VXM_FLOAT64;
}

int vxm_field_channels(const vxm_field *field) {
  return field ? field->channels : 0;
}

const void *vxm_field_values(const vxm_field *field) {
  return field ? field->values : NULL;
}

int64_t vxm_field_label_count(const vxm_field *field) {
  return field ? (int64_t)field->about.table.count : 0;
}

const char *vxm_field_label_name(const vxm_field *field, int64_t label) {
  bool is_there = label >= 1 && label <= vxm_field_label_count(field);
  return is_there ? vxm_label_table_name(&field->about.table, (size_t)label) : "";
}

int64_t vxm_field_metadata_count(const vxm_field *field) {
  return field ? (int64_t)field->about.pairs.count : 0;
}

const char *vxm_field_metadata_key(const vxm_field *field, int64_t index) {
  const char *key = field ? vxm_metadata_next(&field->about.pairs, NULL) : NULL;
  for (int64_t i = 0; i < index && key; i++)
    key = vxm_metadata_next(&field->about.pairs, key);
  return index >= 0 && key ? key : "";
}

const char *vxm_field_metadata_value(const vxm_field *field, int64_t index) {
  const char *key = vxm_field_metadata_key(field, index);
  return *key ? vxm_metadata_value(key) : "";
}

vxm_status vxm_field_add_label(vxm_field *field, const char *name, int64_t voxels, vxm_error *error) {
  if (!field || !name)
    return fail_null(error);
  if (voxels < 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "field: a label of %" PRId64 " voxels", voxels);
  return vxm_field_put_label(field, name, voxels, error);
}

vxm_status vxm_field_add_metadata(vxm_field *field, const char *key, const char *value, vxm_error *error) {
  if (!field || !key || !value)
    return fail_null(error);
  if (!*key)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "field: metadata without a key");
  return vxm_field_put_pair(field, key, value, error);
}

int64_t vxm_field_warning_count(const vxm_field *field) {
  return field ? field->warnings.count : 0;
}

const char *vxm_field_warning(const vxm_field *field, int64_t index) {
  return field && index >= 0 && index < field->warnings.count ? field->warnings.text[index] : "";
}

/* ---- Writing ---- */

vxm_status vxm_field_write(const vxm_field *field, const char *path, const vxm_grid_write_options *options,
                           vxm_error *error) {
  if (!field || !path)
    return fail_null(error);
  vxm_grid_write_options chosen = VXM_GRID_WRITE_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "field", error);
  vxm_field shown = *field; /* what it has is borrowed */
  if (status == VXM_OK)
    status = vxm_style_of(&shown.style, chosen.blocks, chosen.up, error);
  return status == VXM_OK ? vxm_gridio_write_field(&shown, path, chosen.format, error) : status;
}

vxm_status vxm_field_picture(const vxm_field *field, const char *path, const vxm_picture_options *options,
                             const vxm_threshold_options *threshold, vxm_error *error) {
  if (!field || !path)
    return fail_null(error);
  vxm_picture_options chosen = VXM_PICTURE_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "picture", error);
  return status == VXM_OK ? vxm_gridio_field_picture(field, path, &chosen, threshold, error) : status;
}

vxm_status vxm_field_page(const vxm_field *field, const char *path, const vxm_page_options *options,
                          const vxm_threshold_options *threshold, vxm_error *error) {
  if (!field || !path)
    return fail_null(error);
  vxm_page_options chosen = VXM_PAGE_OPTIONS_INIT;
  vxm_threshold_options bounds = VXM_THRESHOLD_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "page", error);
  if (status == VXM_OK)
    status = VXM_OPTIONS_READ(&bounds, threshold, "page", error);
  return status == VXM_OK ? vxm_gridio_page(NULL, field, path, &chosen, threshold ? &bounds : NULL, error)
                          : status;
}
