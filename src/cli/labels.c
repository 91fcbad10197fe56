/* SPDX-License-Identifier: BSD-3-Clause */
/** Labels: the file, the table of labels, and what came of it. */
#include "cli/field.h"

#include <inttypes.h>

const char *const cli_label_kinds[] = {"part", "group", "material", NULL};

static json_t *table_of(const vxm_model *model) {
  json_t *table = json_array();
  for (int64_t label = 1; label <= vxm_model_label_count(model); label++) {
    json_t *entry = json_object();
    json_object_set_new(entry, "label", json_integer(label));
    json_object_set_new(entry, "name", cli_json_text(vxm_model_label_name(model, label)));
    json_object_set_new(entry, "voxels", json_integer(vxm_model_label_voxels(model, label)));
    json_array_append_new(table, entry);
  }
  return table;
}

vxm_status cli_labels_write(cli_run *cli, cli_field *field, vxm_model *model, const vxm_space *space,
                            const char *path) {
  vxm_status status =
      vxm_model_write_labels(&field->label_report, model, space, path, &field->label_options, &cli->error);
  if (status == VXM_OK)
    field->label_table = table_of(model);
  return status;
}

void cli_labels_json(json_t *report, const cli_field *field) {
  const vxm_label_report *labels = &field->label_report;
  json_t *object = json_object();
  json_object_set_new(object, "by", json_string(cli_label_kinds[field->label_options.by]));
  json_object_set_new(object, "contested", json_integer(labels->contested));
  json_object_set_new(object, "unassigned", json_integer(labels->unassigned));
  json_object_set(object, "table", field->label_table);
  json_object_set_new(report, "voxels", json_integer(labels->voxelize->voxels));
  json_object_set_new(report, "hash", cli_json_hash(labels->voxelize->hash));
  json_object_set_new(report, "labels", object);
}

/** The first labels with their voxels; all with --verbose. */
static void summarize_table(const cli_run *cli, const json_t *table) {
  enum { SHOWN = 12 };
  size_t count = json_array_size(table), shown = cli->verbose || count <= SHOWN ? count : SHOWN;
  for (size_t i = 0; i < shown; i++) {
    const json_t *entry = json_array_get(table, i);
    cli_row(cli, "", "%5" JSON_INTEGER_FORMAT "  %s: %" JSON_INTEGER_FORMAT " voxels",
            json_integer_value(json_object_get(entry, "label")),
            json_string_value(json_object_get(entry, "name")),
            json_integer_value(json_object_get(entry, "voxels")));
  }
  if (shown < count)
    cli_row(cli, "", "  ... and %zu more (-v shows all)", count - shown);
}

void cli_labels_summarize(const cli_run *cli, const cli_field *field) {
  const vxm_label_report *labels = &field->label_report;
  const vxm_voxelize_report *voxelize = labels->voxelize;
  cli_row(cli, "voxels", "%" PRId64, voxelize->voxels);
  cli_row(cli, "hash", "%016" PRIx64, voxelize->hash);
  cli_row(cli, "labels",
          "%" PRId64 " by %s%s; the nearest face decides %" PRId64 " voxels that several claim, and "
          "%" PRId64 " that none does%s",
          labels->labels, cli_label_kinds[field->label_options.by],
          field->label_options.by == VXM_LABEL_PART ? ", connected pieces as in 'voxmend info'" : "",
          labels->contested, labels->unassigned,
          field->label_options.by == VXM_LABEL_PART ? "" : "; and between patches of a surface");
  summarize_table(cli, field->label_table);
}
