/* SPDX-License-Identifier: BSD-3-Clause */
#include "export/labels.h"
#include "base/clock.h"
#include "grid/bit_transpose.h"
#include "gridio/formats/octree/octree_values.h"
#include "gridio/gridio.h"
#include "voxel/labels/label_nodes.h"

#include <string.h>

/** A file of labels in the making: slice by slice, or as a field where the format needs all of them. */
typedef struct label_file {
  const char *path;
  const vxm_grid_format *format;
  bool streams;
  vxm_style style;
  vxm_layout layout;
  vxm_field *field; /**< its values in the order of the layout */
  vxm_about about;  /**< with the table of labels, which belongs to another */
  vxm_values_spec values;
  vxm_values_writer writer;
} label_file;

static vxm_status choose_format(label_file *file, const char *format, vxm_error *error) {
  file->format = vxm_grid_format_holding(file->path, format, VXM_HOLDS_LABELS, "labels go", error);
  if (!file->format)
    return VXM_ERROR_ARGUMENT;
  const vxm_values_writer_kind *kind = file->format->values;
  file->streams = kind && (kind->holds & VXM_HOLDS_LABELS);
  file->layout = file->streams ? kind->layout : (vxm_layout)VXM_PLANE_Z_FAST;
  file->about = (vxm_about){.is_declared = true, .kind = VXM_FIELD_LABELS};
  file->values = (vxm_values_spec){.scalar = VXM_UINT16, .channels = 1, .about = &file->about};
  return VXM_OK;
}

/** Makes room for the values, and begins the file where it is written slice by slice. */
static vxm_status open_file(label_file *file, vxm_context *context, const vxm_space *space,
                            const vxm_label_table *table, vxm_error *error) {
  const vxm_values_writer_kind *kind = file->format->values;
  vxm_status status = VXM_OK;
  file->about.table = *table;
  if (file->streams && kind->check)
    status = kind->check(space, &file->values, file->path, error);
  if (status == VXM_OK)
    status =
        vxm_memory_check(context, vxm_space_voxels(space) * sizeof(uint16_t), "a label per voxel", error);
  if (status == VXM_OK)
    status = vxm_field_make(&file->field, context, space, VXM_FIELD_LABELS, VXM_UINT16, error);
  if (status == VXM_OK && file->streams)
    status = vxm_values_writer_open(&file->writer, kind, context, space, &file->values, file->path, error);
  return status;
}

static vxm_status put_slices(label_file *file, vxm_error *error) {
  int64_t slices = file->field->space.dims[file->layout.slow];
  vxm_status status = VXM_OK;
  for (int64_t s = 0; s < slices && status == VXM_OK; s++) {
    status = vxm_values_writer_put(&file->writer, file->field->values + (size_t)s * file->writer.slice_bytes,
                                   s, s + 1, error);
    if (status == VXM_OK)
      status = vxm_progress(file->field->context, "writing", (double)(s + 1) / (double)slices, error);
  }
  return status;
}

/** Writes the values with the labels' table. */
static vxm_status write_file(label_file *file, const vxm_label_table *table, vxm_error *error) {
  file->about.table = *table;
  if (file->streams) {
    vxm_status status = put_slices(file, error);
    return status == VXM_OK ? vxm_values_writer_commit(&file->writer, error) : status;
  }
  vxm_field whole = *file->field;
  whole.about = file->about;
  whole.style = file->style;
  return vxm_gridio_write_field(&whole, file->path, file->format->name, error);
}

/** As a whole, or slice by slice. */
static vxm_status write_dense(label_file *file, vxm_label_report *report, vxm_model *model,
                              const vxm_space *space, vxm_face_labels *labelling, double *made,
                              vxm_error *error) {
  vxm_status status = open_file(file, model->context, space, &labelling->table, error);
  if (status == VXM_OK)
    status = vxm_labels_run((uint16_t *)(void *)file->field->values, file->layout, report, model, space,
                            labelling, error);
  *made = vxm_clock_ms();
  return status == VXM_OK ? write_file(file, &vxm_model_results_read(model->results)->labels, error) : status;
}

/** As an octree, of which only what has voxels is made. */
static vxm_status write_octree(label_file *file, vxm_label_report *report, vxm_model *model,
                               const vxm_space *space, vxm_face_labels *labelling, double *made,
                               vxm_error *error) {
  vxm_label_nodes *nodes;
  vxm_status status = vxm_label_nodes_create(&nodes, report->voxelize, model, space, labelling, error);
  if (status != VXM_OK)
    return status;
  vxm_node_maker maker = vxm_label_nodes_maker(nodes);
  status = vxm_values_writer_open(&file->writer, file->format->values, model->context, space, &file->values,
                                  file->path, error);
  if (status == VXM_OK)
    status = vxm_octree_values_make(&file->writer, &maker, error);
  if (status == VXM_OK)
    status = vxm_label_nodes_report(report, nodes, error);
  vxm_label_nodes_destroy(nodes);
  *made = vxm_clock_ms();
  if (status != VXM_OK)
    return status;
  file->about.table = vxm_model_results_read(model->results)->labels;
  return vxm_values_writer_commit(&file->writer, error);
}

vxm_status vxm_labels_write(vxm_label_report *report, vxm_model *model, const vxm_space *space,
                            const char *path, const vxm_label_options *options, vxm_error *error) {
  double start = vxm_clock_ms();
  label_file file = {.path = path};
  vxm_face_labels labelling;
  vxm_status status = choose_format(&file, options->format, error);
  if (status == VXM_OK)
    status = vxm_style_of(&file.style, options->blocks, options->up, error);
  if (status == VXM_OK)
    status = vxm_face_labels_create(&labelling, model->analysis.soup, options->by, error);
  if (status != VXM_OK)
    return status;
  double made = start;
  bool is_octree = file.format->values == &vxm_octree_values && !model->options.confidence;
  status = (is_octree ? write_octree : write_dense)(&file, report, model, space, &labelling, &made, error);
  vxm_values_writer_abort(&file.writer);
  report->voxelize->fill_ms = made - start;
  report->voxelize->write_ms = vxm_clock_ms() - made;
  vxm_face_labels_destroy(&labelling);
  vxm_field_destroy(file.field);
  return status;
}
