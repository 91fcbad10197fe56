/* SPDX-License-Identifier: BSD-3-Clause */
#include "export/values_write.h"
#include "base/endian.h"
#include "export/colors.h"
#include "gridio/common/sidecar.h"
#include "gridio/formats/binvox.h"
#include "gridio/formats/npy_header.h"
#include "gridio/formats/nrrd_header.h"
#include "gridio/formats/vdb.h"
#include "gridio/formats/vdb_field.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/** A file of a field in the making. */
typedef struct field_file {
  const vxm_field *field;
  const char *path;
  vxm_output *output;
} field_file;

/** How a format holds fields. */
typedef struct kind {
  const char *name;
  /** Refuses what it cannot hold, before anything is opened. */
  vxm_status (*check)(const vxm_field *field, const char *path, vxm_error *error);
  vxm_status (*write)(const field_file *file, vxm_error *error);
  /** What the JSON beside it says. */
  vxm_sidecar_text sidecar;
  bool has_sidecar; /**< always; otherwise only with a table of labels */
  /** What a file has at least, without the header; NULL = that is not known. */
  uint64_t (*file_bytes)(const vxm_field *field);
} kind;

static vxm_status refuse(const vxm_field *field, const char *path, vxm_status status, const char *why,
                         vxm_error *error) {
  return vxm_fail_at(error, status, (vxm_place){path, 0, -1, -1}, "the field (%s, %s) %s",
                     vxm_field_kind_name(field->about.kind), vxm_scalar_name(field->scalar), why);
}

/** Passes on a failed write, and progress. */
static vxm_status step(const field_file *file, int64_t done, int64_t all, vxm_error *error) {
  if (vxm_output_failed(file->output))
    return VXM_ERROR_IO;
  return vxm_progress(file->field->context, "writing", (double)done / (double)all, error);
}

/* ---- .npy: all numbers as they lie ---- */

static vxm_status check_any(const vxm_field *field, const char *path, vxm_error *error) {
  (void)field, (void)path, (void)error;
  return VXM_OK;
}

/** numpy's name of a type. */
static void name_type(char text[8], vxm_scalar scalar) {
  size_t size = vxm_scalar_bytes(scalar);
  char order = size == 1 ? '|' : vxm_le64(1) == 1 ? '<' : '>', letter = vxm_scalar_name(scalar)[0];
  snprintf(text, 8, "%c%c%zu", order, letter, size);
}

static vxm_status write_npy(const field_file *file, vxm_error *error) {
  const vxm_field *field = file->field;
  const int64_t *n = field->space.dims;
  size_t bytes = (size_t)(n[1] * n[2]) * vxm_field_voxel_bytes(field);
  vxm_status status = VXM_OK;
  char type[8];
  name_type(type, field->scalar);
  if (field->channels == 4)
    vxm_npy_header_write_bytes(file->output, n, 4);
  else
    vxm_npy_header_write(file->output, type, false, n);
  for (int64_t x = 0; x < n[0] && status == VXM_OK; x++) {
    vxm_output_write(file->output, field->values + (size_t)x * bytes, bytes);
    status = step(file, x + 1, n[0], error);
  }
  return status;
}

/* ---- .nrrd: x fastest ---- */

/** Floats of 16 bits become those of 32. */
static const unsigned char *widen(float *out, const unsigned char *halves, size_t count) {
  for (size_t v = 0; v < count; v++) {
    uint16_t bits;
    memcpy(&bits, halves + 2 * v, sizeof bits);
    out[v] = vxm_half_value(bits);
  }
  return (const unsigned char *)out;
}

static vxm_status put_slices(const field_file *file, unsigned char *slice, float *wide, vxm_error *error) {
  const vxm_field *field = file->field;
  const int64_t *n = field->space.dims;
  size_t count = (size_t)(n[0] * n[1]);
  vxm_status status = VXM_OK;
  for (int64_t z = 0; z < n[2] && status == VXM_OK; z++) {
    vxm_field_take_slices(slice, field, z, z + 1);
    if (wide)
      vxm_output_write(file->output, widen(wide, slice, count), count * sizeof *wide);
    else
      vxm_output_write(file->output, slice, count * vxm_field_voxel_bytes(field));
    status = step(file, z + 1, n[2], error);
  }
  return status;
}

static vxm_status write_nrrd(const field_file *file, vxm_error *error) {
  const vxm_field *field = file->field;
  bool is_half = field->scalar == VXM_FLOAT16;
  const vxm_nrrd_values header = {"a number per voxel, at its centre", is_half ? VXM_FLOAT32 : field->scalar,
                                  field->channels, &field->about};
  size_t count = (size_t)(field->space.dims[0] * field->space.dims[1]);
  vxm_error local = VXM_ERROR_INIT;
  unsigned char *slice = vxm_alloc(field->context, count, vxm_field_voxel_bytes(field), &local);
  float *wide = slice && is_half ? vxm_alloc(field->context, count, sizeof *wide, &local) : NULL;
  vxm_status status = local.code;
  if (status == VXM_OK)
    status = vxm_nrrd_header_write(file->output, &header, &field->space, &local);
  if (status == VXM_OK)
    status = put_slices(file, slice, wide, &local);
  vxm_free(field->context, wide);
  vxm_free(field->context, slice);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/* ---- .vdb: 32-bit floats ---- */

static vxm_status check_vdb(const vxm_field *field, const char *path, vxm_error *error) {
  const vxm_vdb_functions *functions;
  if (field->channels == 4)
    return refuse(field, path, VXM_ERROR_ARGUMENT, "cannot be written as .vdb; use .npy or .nrrd", error);
  if (!vxm_field_is_float_exactly(field))
    return refuse(field, path, VXM_ERROR_RANGE,
                  "has numbers that the 32-bit floats of .vdb do not hold; use .npy or .nrrd", error);
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

static vxm_status fill_tree(vxm_vdb_field *tree, const field_file *file, vxm_error *error) {
  const vxm_field *field = file->field;
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

static vxm_status write_vdb(const field_file *file, vxm_error *error) {
  const vxm_field *field = file->field;
  vxm_vdb_kind what = kind_of(field);
  vxm_vdb_field *tree = NULL;
  vxm_error local = VXM_ERROR_INIT;
  const char **texts = list_texts(field, &what, &local);
  vxm_status status = local.code;
  what.texts = texts;
  if (status == VXM_OK)
    status = vxm_vdb_field_create(&tree, field->context, &field->space, &what, &local);
  if (status == VXM_OK)
    status = fill_tree(tree, file, &local);
  if (status == VXM_OK)
    status = vxm_vdb_field_write(tree, file->output, &local);
  vxm_vdb_field_destroy(tree);
  vxm_free(field->context, texts);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/* ---- .binvox: labels ---- */

static vxm_status check_binvox(const vxm_field *field, const char *path, vxm_error *error) {
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  vxm_field_kind what = field->about.kind;
  if ((what != VXM_FIELD_LABELS && what != VXM_FIELD_NUMBERS) || vxm_scalar_is_float(field->scalar))
    return refuse(
        field, path, VXM_ERROR_ARGUMENT,
        "cannot be written as .binvox, which holds labels from 0 to 255; choose a threshold, or .npy "
        "or .nrrd",
        error);
  vxm_status status = vxm_field_measure(&range, field, error);
  if (status == VXM_OK && (range.min < 0 || range.max > 255))
    return refuse(
        field, path, VXM_ERROR_RANGE,
        "has numbers beyond 0 to 255, which .binvox does not hold; choose a threshold, or .npy or .nrrd",
        error);
  return status == VXM_OK ? vxm_binvox_check(&field->space, path, error) : status;
}

/** A slice across x, y fastest. */
static void turn_slice(uint16_t *out, double *row, const vxm_field *field, int64_t x) {
  size_t ny = (size_t)field->space.dims[1], nz = (size_t)field->space.dims[2];
  for (size_t y = 0; y < ny; y++) {
    vxm_field_doubles(row, field, ((size_t)x * ny + y) * nz, nz);
    for (size_t z = 0; z < nz; z++)
      out[z * ny + y] = (uint16_t)row[z];
  }
}

static vxm_status write_binvox(const field_file *file, vxm_error *error) {
  const vxm_field *field = file->field;
  const int64_t *n = field->space.dims;
  vxm_error local = VXM_ERROR_INIT;
  uint16_t *slice = vxm_alloc(field->context, (size_t)(n[1] * n[2]), sizeof *slice, &local);
  double *row = slice ? vxm_alloc(field->context, (size_t)n[2], sizeof *row, &local) : NULL;
  vxm_status status = local.code;
  if (status == VXM_OK)
    status = vxm_binvox_header_write(file->output, &field->space, 2, &local);
  for (int64_t x = 0; x < n[0] && status == VXM_OK; x++) {
    turn_slice(slice, row, field, x);
    vxm_binvox_put_slice(file->output, &field->space, slice);
    status = step(file, x + 1, n[0], &local);
  }
  if (status == VXM_OK)
    vxm_binvox_put_end(file->output, &field->space);
  vxm_free(field->context, row);
  vxm_free(field->context, slice);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/* ---- All formats ---- */

static uint64_t plain_bytes(const vxm_field *field) {
  return vxm_field_count(field) * vxm_field_voxel_bytes(field);
}

static uint64_t binvox_bytes(const vxm_field *field) {
  return vxm_binvox_bytes(&field->space);
}

static const kind kinds[] = {
    {"npy", check_any, write_npy, {"voxmend npy", "z fastest, then y, then x", NULL}, true, plain_bytes},
    {"nrrd",
     check_any,
     write_nrrd,
     {"voxmend labels", "x fastest, then y, then z", NULL},
     false,
     plain_bytes},
    {"vdb", check_vdb, write_vdb, {"voxmend labels", "x fastest, then y, then z", NULL}, false, NULL},
    {"binvox",
     check_binvox,
     write_binvox,
     {"voxmend labels", "y fastest, then z, then x", NULL},
     false,
     binvox_bytes},
};

static vxm_status write_file(field_file *file, const kind *k, vxm_error *error) {
  const vxm_field *field = file->field;
  vxm_output *sidecar = NULL;
  vxm_status status = vxm_output_open(&file->output, field->context, file->path, error);
  if (status != VXM_OK)
    return status;
  if (k->file_bytes)
    status = vxm_output_expect(file->output, k->file_bytes(field), error);
  if (status != VXM_OK) {
    vxm_output_abort(file->output);
    return status;
  }
  status = k->write(file, error);
  /* A failed write is told by committing it. */
  if (status == VXM_ERROR_IO && vxm_output_failed(file->output))
    return vxm_output_commit(file->output, error);
  if (status == VXM_OK && (k->has_sidecar || field->about.table.count > 0))
    status = vxm_sidecar_open(&sidecar, field->context, &field->space, file->path, &k->sidecar, &field->about,
                              error);
  if (status == VXM_OK)
    return vxm_output_commit_both(file->output, sidecar, error);
  vxm_output_abort(file->output);
  return status;
}

/** The message for formats that hold only bits, or that there are not. */
static vxm_status fail_format(const vxm_field *field, const char *path, const char *name, vxm_error *error) {
  char why[160];
  snprintf(why, sizeof why, "cannot be written as \"%.20s\"; choose %s, or make bits of it by a threshold",
           name, field->channels == 4 ? "npy, nrrd, ply or vox" : "npy, nrrd, vdb or (labels) binvox");
  return refuse(field, path, VXM_ERROR_ARGUMENT, why, error);
}

vxm_status vxm_gridio_write_field(const vxm_field *field, const char *path, const char *format,
                                  vxm_error *error) {
  const char *name = format ? format : vxm_path_extension(path);
  if (field->channels == 4 && !vxm_text_equal_nocase(name, "nrrd") && !vxm_text_equal_nocase(name, "vdb")) {
    const vxm_colored colored = {field->context, &field->space, field->values};
    return vxm_colored_write(&colored, &field->about, path, format, error);
  }
  field_file file = {.field = field, .path = path};
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
    if (vxm_text_equal_nocase(name, kinds[k].name)) {
      vxm_status status = kinds[k].check(field, path, error);
      return status == VXM_OK ? write_file(&file, &kinds[k], error) : status;
    }
  return fail_format(field, path, name, error);
}
