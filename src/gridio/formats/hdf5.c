/* SPDX-License-Identifier: BSD-3-Clause */
/** .h5: an array "voxels", [x][y][z], with its place and kind as attributes; written and read by HDF5. */
#include "gridio/formats/hdf5.h"
#include "grid/bit_transpose.h"
#include "gridio/common/values_writer.h"
#include "gridio/formats/hdf5_read.h"

#include <string.h>

const vxm_module_need vxm_hdf5_need = {"hdf5", "libhdf5-dev", "reading and writing .h5 files"};

typedef struct state {
  const vxm_hdf5_functions *functions;
  vxm_hdf5 *file;
} state;

static vxm_status open_module(const vxm_hdf5_functions **out, vxm_error *error) {
  const vxm_module *module;
  vxm_status status = vxm_module_open(&module, &vxm_hdf5_need, error);
  if (status == VXM_OK)
    *out = module->functions;
  return status;
}

static vxm_status check(const vxm_space *space, const vxm_values_spec *values, const char *path,
                        vxm_error *error) {
  const vxm_hdf5_functions *functions;
  (void)space, (void)values, (void)path;
  return open_module(&functions, error);
}

static vxm_status check_field(const vxm_field *field, const char *path, vxm_error *error) {
  return check(&field->space, NULL, path, error);
}

static vxm_status begin(vxm_values_writer *w, vxm_error *error) {
  vxm_status status = VXM_OK;
  state *s = vxm_try_calloc(w->context, 1, sizeof *s, &status, error);
  if (!s)
    return status;
  w->state = s;
  const vxm_hdf5_array array = {.space = w->space,
                                .scalar = w->values.scalar,
                                .channels = w->values.channels,
                                .kind =
                                    w->values.is_bits ? "bits" : vxm_field_kind_name(w->values.about->kind)};
  status = open_module(&s->functions, error);
  return status == VXM_OK ? s->functions->create(&s->file, w->context, &array, error) : status;
}

static vxm_status put(vxm_values_writer *w, const void *values, int64_t begin, int64_t end,
                      vxm_error *error) {
  const state *s = w->state;
  return s->functions->put(s->file, values, begin, end, error);
}

static vxm_status put_labels(vxm_values_writer *w, vxm_error *error) {
  const state *s = w->state;
  const vxm_label_table *table = &w->values.about->table;
  vxm_status status = VXM_OK;
  vxm_hdf5_label *labels = vxm_try_alloc(w->context, table->count, sizeof *labels, &status, error);
  if (!labels)
    return status;
  for (size_t l = 0; l < table->count; l++)
    labels[l] = (vxm_hdf5_label){vxm_label_table_name(table, l + 1), table->voxels[l]};
  status = s->functions->label(s->file, labels, table->count, error);
  vxm_free(w->context, labels);
  return status;
}

static vxm_status end(vxm_values_writer *w, vxm_error *error) {
  const state *s = w->state;
  vxm_status status = w->values.about->table.count > 0 ? put_labels(w, error) : VXM_OK;
  return status == VXM_OK ? s->functions->write(s->file, w->output, error) : status;
}

static void drop(vxm_values_writer *w) {
  const state *s = w->state;
  if (s && s->file)
    s->functions->destroy(s->file);
}

/** The file is held twice when it is written. Bits and labels become a small part of what they are; of other
 * numbers not much is taken off. */
static uint64_t held_bytes(const vxm_space *space, const vxm_values_spec *values) {
  uint64_t bytes = vxm_values_plain_bytes(space, values);
  bool is_even = values->is_bits || values->about->kind == VXM_FIELD_LABELS;
  return is_even ? bytes / 4 : 2 * bytes;
}

static const vxm_sidecar_text description = {"voxmend labels", "z fastest, then y, then x", NULL};

static const vxm_values_writer_kind values_kind = {
    .layout = VXM_PLANE_Z_FAST,
    .holds = VXM_HOLDS_ALL,
    .sidecar = &description,
    .stored = vxm_values_no_halves,
    .convert = vxm_values_widen_halves,
    .check = check,
    .held_bytes = held_bytes,
    .begin = begin,
    .put = put,
    .end = end,
    .drop = drop,
};

const vxm_grid_format vxm_format_h5 = {
    .name = "h5",
    .holds = VXM_HOLDS_ALL,
    .sniff = vxm_hdf5_sniff,
    .read = vxm_hdf5_read,
    .read_field = vxm_hdf5_read_field,
    .values = &values_kind,
    .check_field = check_field,
};
