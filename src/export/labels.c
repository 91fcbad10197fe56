/* SPDX-License-Identifier: BSD-3-Clause */
#include "export/labels.h"
#include "base/clock.h"
#include "base/endian.h"
#include "grid/bit_transpose.h"
#include "gridio/common/format.h"
#include "gridio/formats/binvox.h"
#include "gridio/formats/npy_header.h"
#include "gridio/formats/nrrd_header.h"

#include <inttypes.h>

enum { BINVOX_LABELS_MAX = 255 };

/** A file of labels in the making. */
typedef struct label_file {
  vxm_context *context;
  const vxm_space *space;
  const char *path;
  const struct kind *kind;
  vxm_output *output;
  const uint16_t *values;
} label_file;

/** How a format holds labels. */
typedef struct kind {
  const char *name; /**< also the extension */
  size_t labels;    /**< at most */
  vxm_layout layout;
  vxm_sidecar_text sidecar;
  vxm_status (*check)(const vxm_space *space, const char *path, vxm_error *error); /**< NULL = it holds all */
  vxm_status (*begin)(const label_file *file, vxm_error *error);
  void (*put)(const label_file *file, int64_t slice);
  void (*end)(const label_file *file);            /**< NULL = nothing is left to write */
  uint64_t (*file_bytes)(const vxm_space *space); /**< at least, without the header */
} kind;

/* ---- .npy and .nrrd: the values as they are ---- */

static vxm_status begin_npy(const label_file *file, vxm_error *error) {
  (void)error;
  vxm_npy_header_write(file->output, vxm_le64(1) == 1 ? "<u2" : ">u2", false, file->space->dims);
  return VXM_OK;
}

static vxm_status begin_nrrd(const label_file *file, vxm_error *error) {
  const vxm_about about = {.is_declared = true, .kind = VXM_FIELD_LABELS};
  const vxm_nrrd_values values = {"a number per voxel, at its centre", VXM_UINT16, 1, &about};
  return vxm_nrrd_header_write(file->output, &values, file->space, error);
}

static size_t slice_values(const label_file *file) {
  const vxm_layout *layout = &file->kind->layout;
  return (size_t)(file->space->dims[layout->fast] * file->space->dims[layout->middle]);
}

static void put_plain(const label_file *file, int64_t slice) {
  size_t count = slice_values(file);
  vxm_output_write(file->output, file->values + (size_t)slice * count, count * sizeof *file->values);
}

static uint64_t plain_bytes(const vxm_space *space) {
  return vxm_space_voxels(space) * sizeof(uint16_t);
}

/* ---- .binvox: pairs of a label and a count, no run going on from slice to slice ---- */

static vxm_status begin_binvox(const label_file *file, vxm_error *error) {
  return vxm_binvox_header_write(file->output, file->space, 2, error);
}

static void put_binvox(const label_file *file, int64_t slice) {
  vxm_binvox_put_slice(file->output, file->space, file->values + (size_t)slice * slice_values(file));
}

static void end_binvox(const label_file *file) {
  vxm_binvox_put_end(file->output, file->space);
}

/* ---- All formats ---- */

static const kind kinds[] = {
    {"npy",
     VXM_LABELS_MAX,
     VXM_PLANE_Z_FAST,
     {"voxmend npy", "z fastest, then y, then x", NULL},
     NULL,
     begin_npy,
     put_plain,
     NULL,
     plain_bytes},
    {"nrrd",
     VXM_LABELS_MAX,
     VXM_LAYOUT_GRID,
     {"voxmend labels", "x fastest, then y, then z", NULL},
     NULL,
     begin_nrrd,
     put_plain,
     NULL,
     plain_bytes},
    {"binvox",
     BINVOX_LABELS_MAX,
     VXM_PLANE_Y_FAST,
     {"voxmend labels", "y fastest, then z, then x", NULL},
     vxm_binvox_check,
     begin_binvox,
     put_binvox,
     end_binvox,
     vxm_binvox_bytes},
};

static const kind *find_kind(const char *path, const char *format, vxm_error *error) {
  const char *name = format ? format : vxm_path_extension(path);
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
    if (vxm_text_equal_nocase(name, kinds[k].name))
      return &kinds[k];
  vxm_fail_at(error, VXM_ERROR_ARGUMENT, (vxm_place){path, 0, -1, -1},
              "labels go into .npy, .nrrd or .binvox, not \"%s\"", name);
  return NULL;
}

static vxm_status check_kind(const kind *k, const vxm_face_labels *labelling, const vxm_space *space,
                             const char *path, vxm_error *error) {
  if (labelling->table.count > k->labels)
    return vxm_fail_at(error, VXM_ERROR_RANGE, (vxm_place){path, 0, -1, -1},
                       "%zu labels are more than .%s holds, which is %zu; use .npy or .nrrd",
                       labelling->table.count, k->name, k->labels);
  return k->check ? k->check(space, path, error) : VXM_OK;
}

/** The values, which are freed even after a failure. */
static vxm_status make_values(uint16_t **values, vxm_context *context, const vxm_space *space,
                              vxm_error *error) {
  uint64_t count = vxm_space_voxels(space);
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = vxm_memory_check(context, count * sizeof **values, "a label per voxel", &local);
  if (status == VXM_OK) {
    *values = vxm_alloc(context, (size_t)count, sizeof **values, &local);
    status = local.code;
  }
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status put_values(const label_file *file, vxm_error *error) {
  int64_t slices = file->space->dims[file->kind->layout.slow];
  vxm_status status = file->kind->begin(file, error);
  for (int64_t s = 0; s < slices && status == VXM_OK && !vxm_output_failed(file->output); s++) {
    file->kind->put(file, s);
    status = vxm_progress(file->context, "writing", (double)(s + 1) / (double)slices, error);
  }
  if (status == VXM_OK && file->kind->end)
    file->kind->end(file);
  return status;
}

/** Writes the values and the table beside them; the output is closed either way. */
static vxm_status write_file(label_file *file, const vxm_label_table *table, vxm_error *error) {
  vxm_output *sidecar = NULL;
  const vxm_about about = {.is_declared = true, .kind = VXM_FIELD_LABELS, .table = *table};
  vxm_status status = put_values(file, error);
  if (status == VXM_OK)
    status = vxm_sidecar_open(&sidecar, file->context, file->space, file->path, &file->kind->sidecar, &about,
                              error);
  if (status == VXM_OK)
    return vxm_output_commit_both(file->output, sidecar, error);
  vxm_output_abort(file->output);
  return status;
}

vxm_status vxm_labels_write(vxm_label_report *report, vxm_model *model, const vxm_space *space,
                            const char *path, const vxm_label_options *options, vxm_error *error) {
  double start = vxm_clock_ms();
  label_file file = {.context = model->context, .space = space, .path = path};
  file.kind = find_kind(path, options->format, error);
  if (!file.kind)
    return VXM_ERROR_ARGUMENT;
  uint16_t *values = NULL;
  vxm_face_labels labelling;
  vxm_status status = vxm_face_labels_create(&labelling, model->analysis.soup, options->by, error);
  if (status == VXM_OK)
    status = check_kind(file.kind, &labelling, space, path, error);
  if (status == VXM_OK)
    status = make_values(&values, file.context, space, error);
  if (status == VXM_OK)
    status = vxm_output_open(&file.output, file.context, path, error);
  if (status == VXM_OK)
    status = vxm_output_expect(file.output, file.kind->file_bytes(space), error);
  if (status == VXM_OK)
    status = vxm_labels_run(values, file.kind->layout, report, model, space, &labelling, error);
  double made = vxm_clock_ms();
  file.values = values;
  if (status == VXM_OK)
    status = write_file(&file, &vxm_model_results_read(model->results)->labels, error);
  else
    vxm_output_abort(file.output);
  report->voxelize->fill_ms = made - start;
  report->voxelize->write_ms = vxm_clock_ms() - made;
  vxm_face_labels_destroy(&labelling);
  vxm_free(file.context, values);
  return status;
}
