/* SPDX-License-Identifier: BSD-3-Clause */
/** .vdb of numbers: whole fields, and coverage and distances as they are made. */
#include "gridio/formats/vdb/vdb_values.h"
#include "gridio/common/values_writer.h"
#include "gridio/formats/vdb/vdb_field.h"

#include <math.h>
#include <string.h>

/* ---- Whole fields ---- */

vxm_status vxm_vdb_check_field(const vxm_field *field, const char *path, vxm_error *error) {
  const vxm_vdb_functions *functions;
  if (!vxm_field_is_float_exactly(field))
    return vxm_field_refuse(field, path, VXM_ERROR_RANGE,
                            "has numbers that the 32-bit floats of .vdb do not hold; use .npy or .nrrd",
                            error);
  return vxm_vdb_open_writer(&functions, &field->space, error);
}

/** The class and background of a field. Beyond the band of distances lie the greatest, plus or minus. */
static vxm_vdb_kind kind_of(const vxm_field *field) {
  vxm_vdb_kind tree = {VXM_VDB_NUMBERS, vxm_field_kind_name(field->about.kind), 0, NULL};
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  const char *name = vxm_metadata_find(&field->about.pairs, VXM_VDB_NAME_KEY);
  vxm_field_measure(&range, field, NULL);
  if (name)
    tree.name = name;
  if (field->about.kind == VXM_FIELD_COVERAGE && field->scalar != VXM_UINT8)
    tree.content = VXM_VDB_FOG;
  double farthest = fmax(range.max, -range.min);
  if (field->about.kind == VXM_FIELD_DISTANCE && farthest > 0 && isfinite(farthest)) {
    tree.background = (float)farthest;
    if (range.min < 0)
      tree.content = VXM_VDB_LEVEL_SET;
  }
  return tree;
}

/** What becomes metadata: the kind, unless class or name tell it, the type, and the pairs. NULL without
 * memory. */
static const char **list_texts(const vxm_field *field, const vxm_vdb_kind *tree, vxm_error *error) {
  const vxm_metadata *pairs = &field->about.pairs;
  const char **texts = vxm_alloc(field->context, 2 * pairs->count + 5, sizeof *texts, error), **at = texts;
  if (!texts)
    return NULL;
  bool is_told = tree->content != VXM_VDB_NUMBERS || strcmp(tree->name, "distance") == 0;
  if (!is_told && field->about.is_declared) {
    *at++ = "voxmend_values";
    *at++ = vxm_field_kind_name(field->about.kind);
  }
  if (field->scalar != VXM_FLOAT32) {
    *at++ = "voxmend_scalar";
    *at++ = vxm_scalar_name(field->scalar);
  }
  for (const char *key = NULL; (key = vxm_metadata_next(pairs, key)) != NULL;)
    if (strcmp(key, VXM_VDB_NAME_KEY) != 0) {
      *at++ = key;
      *at++ = vxm_metadata_value(key);
    }
  *at = NULL;
  return texts;
}

/** Numbers of a slice across x as floats; `doubles` has room for a row along z. */
static void load_slice(float *out, double *doubles, const vxm_field *field, int64_t x) {
  size_t ny = (size_t)field->space.dims[1], nz = (size_t)field->space.dims[2];
  if (field->scalar == VXM_FLOAT32) {
    memcpy(out, field->values + (size_t)x * ny * nz * sizeof *out, ny * nz * sizeof *out);
    return;
  }
  for (size_t y = 0; y < ny; y++) {
    vxm_field_doubles(doubles, field, ((size_t)x * ny + y) * nz, nz);
    for (size_t z = 0; z < nz; z++)
      *out++ = (float)doubles[z];
  }
}

static vxm_status fill_tree(vxm_vdb_field *tree, const vxm_field *field, vxm_error *error) {
  const int64_t *n = field->space.dims;
  vxm_error local = VXM_ERROR_INIT;
  float *slice = vxm_alloc(field->context, (size_t)(n[1] * n[2]), sizeof *slice, &local);
  double *row = slice ? vxm_alloc(field->context, (size_t)n[2], sizeof *row, &local) : NULL;
  vxm_status status = local.code;
  for (int64_t x = 0; x < n[0] && status == VXM_OK; x++) {
    load_slice(slice, row, field, x);
    status = vxm_vdb_field_put(tree, slice, x, x + 1, &local);
    if (status == VXM_OK)
      status = vxm_progress(field->context, "writing", (double)(x + 1) / (double)n[0], &local);
  }
  vxm_free(field->context, row);
  vxm_free(field->context, slice);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status write_tree(vxm_output *output, const vxm_field *field, vxm_error *error) {
  vxm_vdb_kind what = kind_of(field);
  vxm_vdb_field *tree = NULL;
  vxm_error local = VXM_ERROR_INIT;
  const char **texts = list_texts(field, &what, &local);
  vxm_status status = local.code;
  what.texts = texts;
  if (status == VXM_OK)
    status = vxm_vdb_field_create(&tree, field->context, &field->space, &what, &local);
  if (status == VXM_OK)
    status = fill_tree(tree, field, &local);
  if (status == VXM_OK)
    status = vxm_vdb_field_write(tree, output, &local);
  vxm_vdb_field_destroy(tree);
  vxm_free(field->context, texts);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_vdb_write_field(const vxm_field *field, const char *path, vxm_error *error) {
  vxm_output *output, *sidecar = NULL;
  vxm_status status = vxm_output_open(&output, field->context, path, error);
  if (status != VXM_OK)
    return status;
  status = write_tree(output, field, error);
  /* A failed write is told by committing it. */
  if (status == VXM_ERROR_IO && vxm_output_failed(output))
    return vxm_output_commit(output, error);
  if (status == VXM_OK && field->about.table.count > 0)
    status = vxm_sidecar_open(&sidecar, field->context, &field->space, path, &vxm_sidecar_labels,
                              &field->about, error);
  if (status == VXM_OK)
    return vxm_output_commit_both(output, sidecar, error);
  vxm_output_abort(output);
  return status;
}

/* ---- Coverage and distances in the making ---- */

static vxm_status check(const vxm_space *space, const vxm_values_spec *values, const char *path,
                        vxm_error *error) {
  (void)space;
  if (values->scalar != VXM_FLOAT32)
    return vxm_fail_at(error, VXM_ERROR_ARGUMENT, (vxm_place){path, 0, -1, -1},
                       ".vdb holds 32-bit floats; choose them, or .npy or .nrrd");
  return VXM_OK;
}

static vxm_status begin(vxm_values_writer *w, vxm_error *error) {
  vxm_field_kind what = w->values.about->kind;
  vxm_vdb_kind kind = {VXM_VDB_NUMBERS, vxm_field_kind_name(what), w->values.background, NULL};
  if (what == VXM_FIELD_COVERAGE)
    kind.content = VXM_VDB_FOG;
  else if (w->values.is_signed)
    kind.content = VXM_VDB_LEVEL_SET;
  vxm_vdb_field *tree = NULL;
  vxm_status status = vxm_vdb_field_create(&tree, w->context, &w->space, &kind, error);
  w->state = tree;
  return status == VXM_OK && !w->values.in_tiles ? vxm_vdb_field_make_room(tree, error) : status;
}

static vxm_status put(vxm_values_writer *w, const void *values, int64_t begin, int64_t end,
                      vxm_error *error) {
  return vxm_vdb_field_put(w->state, values, begin, end, error);
}

static vxm_status put_tile(vxm_values_writer *w, const vxm_value_tile *tile, vxm_error *error) {
  return vxm_vdb_field_put_tile(w->state, tile, error);
}

static vxm_status end(vxm_values_writer *w, vxm_error *error) {
  return vxm_vdb_field_write(w->state, w->output, error);
}

static void drop(vxm_values_writer *w) {
  vxm_vdb_field_destroy(w->state);
  w->state = NULL;
}

const vxm_values_writer_kind vxm_vdb_values = {
    .layout = VXM_PLANE_Z_FAST,
    .holds = VXM_HOLDS_NUMBERS,
    .sidecar = &vxm_sidecar_labels,
    .check = check,
    .begin = begin,
    .put = put,
    .put_tile = put_tile,
    .end = end,
    .drop = drop,
};
