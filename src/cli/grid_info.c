/* SPDX-License-Identifier: BSD-3-Clause */
/** What voxmend info tells of a grid: where its voxels lie, and what they hold. */
#include "cli/values.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { LABELS_MAX = 1 << 16, LABELS_SHOWN = 12, TEXT_SIZE = 240 };

/** What a file holds. */
typedef struct facts {
  const char *path, *format;
  vxm_space space;
  cli_values values;        /**< both NULL of an octree that is told of by its file's header */
  bool has_values;          /**< of an octree: numbers, labels or colours rather than bits */
  int64_t set;              /**< voxels: set, or below 0, or that have a label or colour; -1 = numbers */
  int64_t begin[3], end[3]; /**< the box of set voxels; only of a grid with some */
  int64_t *counts;          /**< voxels of each label; NULL = no labels */
  int64_t label_end;
} facts;

bool cli_is_grid_name(const char *path) {
  return (vxm_grid_format_traits(vxm_grid_format_of(path)) & VXM_FORMAT_READ) != 0;
}

/* ---- Looking ---- */

/** A whole number of a field; -1 of another type. */
static int64_t whole_number(const void *values, vxm_scalar scalar, size_t i) {
  switch (scalar) {
  case VXM_UINT8:
    return ((const uint8_t *)values)[i];
  case VXM_INT8:
    return ((const int8_t *)values)[i];
  case VXM_UINT16:
    return ((const uint16_t *)values)[i];
  case VXM_INT16:
    return ((const int16_t *)values)[i];
  case VXM_UINT32:
    return ((const uint32_t *)values)[i];
  case VXM_INT32:
    return ((const int32_t *)values)[i];
  default:
    return -1;
  }
}

static bool is_whole(vxm_scalar scalar) {
  return scalar == VXM_UINT8 || scalar == VXM_INT8 || scalar == VXM_UINT16 || scalar == VXM_INT16 ||
         scalar == VXM_UINT32 || scalar == VXM_INT32;
}

static size_t cells_of(const vxm_space *space) {
  return (size_t)space->dims[0] * (size_t)space->dims[1] * (size_t)space->dims[2];
}

/** Counts the voxels of each label, where the numbers can be some. */
static vxm_status count_labels(cli_run *cli, facts *f, const vxm_field_range *range) {
  const vxm_field *field = f->values.field;
  vxm_field_kind kind = vxm_field_kind_of(field);
  vxm_scalar scalar = vxm_field_scalar(field);
  bool may_be = kind == VXM_FIELD_LABELS || (kind == VXM_FIELD_NUMBERS && vxm_field_label_count(field) > 0);
  if (!may_be || !is_whole(scalar) || range->min < 0 || range->max >= LABELS_MAX)
    return VXM_OK;
  f->counts = calloc(LABELS_MAX, sizeof *f->counts);
  if (!f->counts) {
    cli->error.code = VXM_ERROR_MEMORY;
    snprintf(cli->error.text, sizeof cli->error.text, "out of memory for counts: free some");
    return VXM_ERROR_MEMORY;
  }
  size_t cells = cells_of(&f->space);
  for (size_t i = 0; i < cells; i++)
    f->counts[whole_number(vxm_field_values(field), scalar, i)]++;
  int64_t last = (int64_t)range->max, named = vxm_field_label_count(field);
  f->label_end = (named > last && named < LABELS_MAX ? named : last) + 1;
  f->set = (int64_t)cells - f->counts[0];
  return VXM_OK;
}

/** How many voxels a threshold sets. */
static vxm_status count_set(cli_run *cli, facts *f, double at_least, double below) {
  vxm_threshold_options options = VXM_THRESHOLD_OPTIONS_INIT;
  bool is_distance = vxm_field_kind_of(f->values.field) == VXM_FIELD_DISTANCE;
  vxm_grid *grid;
  options.use_below = is_distance;
  options.use_at_least = !is_distance;
  options.below = below;
  options.at_least = at_least;
  vxm_status status = vxm_field_threshold(&grid, f->values.field, &options, &cli->error);
  if (status == VXM_OK)
    f->set = vxm_grid_count(grid);
  vxm_grid_destroy(status == VXM_OK ? grid : NULL);
  return status;
}

static vxm_status look_at_numbers(cli_run *cli, facts *f) {
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  vxm_field_kind kind = vxm_field_kind_of(f->values.field);
  vxm_status status = vxm_field_measure(&range, f->values.field, &cli->error);
  if (status == VXM_OK && (kind == VXM_FIELD_COLORS || (kind == VXM_FIELD_DISTANCE && range.min < 0)))
    return count_set(cli, f, 1, 0);
  return status == VXM_OK ? count_labels(cli, f, &range) : status;
}

/** What an octree's file says of itself. */
static vxm_status look_at_octree(cli_run *cli, facts *f) {
  vxm_sparse_file *file;
  vxm_status status = vxm_sparse_file_open(&file, cli->context, f->path, &cli->error);
  if (status != VXM_OK)
    return status;
  f->space = *vxm_sparse_file_space(file);
  f->set = vxm_sparse_file_count(file);
  f->has_values = vxm_sparse_file_has_values(file);
  vxm_sparse_file_close(file);
  return VXM_OK;
}

/** Values of an octree are looked at where they can be held; bits of one need not be read. */
static vxm_status look(cli_run *cli, facts *f) {
  const size_t most = (size_t)1 << 28;
  vxm_status status = VXM_OK;
  if (strcmp(f->format, "octree") == 0) {
    status = look_at_octree(cli, f);
    if (status != VXM_OK || !f->has_values || cells_of(&f->space) > most)
      return status;
  }
  status = cli_values_read(cli, &f->values, f->path);
  if (status != VXM_OK)
    return status;
  f->space = *cli_values_space(&f->values);
  f->set = -1;
  if (f->values.field)
    return look_at_numbers(cli, f);
  f->set = vxm_grid_count(f->values.grid);
  vxm_grid_box(f->begin, f->end, f->values.grid);
  return VXM_OK;
}

/* ---- Telling ---- */

static const char *dims_text(char text[TEXT_SIZE], const vxm_space *space) {
  snprintf(text, TEXT_SIZE, "%" PRId64 " x %" PRId64 " x %" PRId64, space->dims[0], space->dims[1],
           space->dims[2]);
  return text;
}

static const char *size_text(char text[TEXT_SIZE], const vxm_space *space) {
  const double *s = space->voxel_size;
  if (s[0] == s[1] && s[1] == s[2])
    snprintf(text, TEXT_SIZE, "%.6g", s[0]);
  else
    snprintf(text, TEXT_SIZE, "%.6g x %.6g x %.6g", s[0], s[1], s[2]);
  return text;
}

static double share_of(const facts *f) {
  return 100 * (double)f->set / (double)cells_of(&f->space);
}

/** "17629 set (0.84 %)", "distance, float32 from -1 to 1; 512 below 0 (3 %)", "labels 1 to 6 ..." */
static const char *content_text(char text[TEXT_SIZE], const facts *f) {
  char values[128];
  const vxm_field *field = f->values.field;
  if (!field) {
    snprintf(text, TEXT_SIZE, "%" PRId64 " %s (%.2f %%)", f->set, f->has_values ? "with values" : "set",
             share_of(f));
    return text;
  }
  vxm_field_kind kind = vxm_field_kind_of(field);
  cli_values_text(values, field);
  if (f->set < 0)
    snprintf(text, TEXT_SIZE, "%s", values);
  else if (kind == VXM_FIELD_COLORS)
    snprintf(text, TEXT_SIZE, "colours of %" PRId64 " voxels (%.2f %%)", f->set, share_of(f));
  else
    snprintf(text, TEXT_SIZE, "%s; %" PRId64 " voxels %s (%.2f %%)", values, f->set,
             kind == VXM_FIELD_DISTANCE ? "below 0" : "with a label", share_of(f));
  return text;
}

static void tell_label(const cli_run *cli, const facts *f, int64_t label, bool is_first) {
  const char *name = vxm_field_label_name(f->values.field, label);
  fprintf(cli->text, "  %-12s %5" PRId64 "  ", is_first ? "labels" : "", label);
  cli_put_text(cli, name, 0);
  fprintf(cli->text, "%s%" PRId64 " voxels\n", *name ? ": " : "", f->counts[label]);
}

static void tell_metadata(const cli_run *cli, const vxm_field *field, int64_t index) {
  const char *key = vxm_field_metadata_key(field, index);
  fputs("  ", cli->text);
  cli_put_text(cli, key, 12);
  fputc(' ', cli->text);
  cli_put_text(cli, vxm_field_metadata_value(field, index), 0);
  fputc('\n', cli->text);
}

static void tell_labels(const cli_run *cli, const facts *f) {
  int64_t there = 0;
  for (int64_t l = 1; l < f->label_end; l++) {
    if (f->counts[l] == 0 && !*vxm_field_label_name(f->values.field, l))
      continue;
    if (++there <= LABELS_SHOWN || cli->verbose)
      tell_label(cli, f, l, there == 1);
  }
  if (there > LABELS_SHOWN && !cli->verbose)
    fprintf(cli->text, "  %-12s   ... and %" PRId64 " more (-v shows all)\n", "", there - LABELS_SHOWN);
}

static void tell(const cli_run *cli, const facts *f) {
  char text[TEXT_SIZE];
  const double *o = f->space.origin, *s = f->space.voxel_size;
  const int64_t *n = f->space.dims, *b = f->begin, *e = f->end;
  cli_put_text(cli, f->path, 0);
  fprintf(cli->text, "\na grid of %s voxels: ", dims_text(text, &f->space));
  fprintf(cli->text, "%s\n", content_text(text, f));
  fprintf(cli->text, "  %-12s %s\n", "format", f->format);
  fprintf(cli->text, "  %-12s %s\n", "voxel size", size_text(text, &f->space));
  fprintf(cli->text, "  %-12s (%.6g, %.6g, %.6g)\n", "from", o[0], o[1], o[2]);
  fprintf(cli->text, "  %-12s (%.6g, %.6g, %.6g)\n", "to", o[0] + (double)n[0] * s[0],
          o[1] + (double)n[1] * s[1], o[2] + (double)n[2] * s[2]);
  if (f->values.grid && f->set > 0)
    fprintf(cli->text,
            "  %-12s %" PRId64 "..%" PRId64 ", %" PRId64 "..%" PRId64 ", %" PRId64 "..%" PRId64
            " along x, y and z\n",
            "set within", b[0], e[0] - 1, b[1], e[1] - 1, b[2], e[2] - 1);
  if (f->counts)
    tell_labels(cli, f);
  for (int64_t m = 0; f->values.field && m < vxm_field_metadata_count(f->values.field); m++)
    tell_metadata(cli, f->values.field, m);
}

static void tell_heading(const cli_run *cli, int width) {
  fprintf(cli->text, "%-*s %-18s %-12s %-32s  %s\n", width, "file", "voxels", "voxel size", "from",
          "content");
}

static void tell_row(const cli_run *cli, const facts *f, int width) {
  char dims[TEXT_SIZE], size[TEXT_SIZE], from[TEXT_SIZE], content[TEXT_SIZE];
  const double *o = f->space.origin;
  snprintf(from, sizeof from, "(%.6g, %.6g, %.6g)", o[0], o[1], o[2]);
  cli_put_text(cli, f->path, width);
  fprintf(cli->text, " %-18s %-12s %-32s  %s\n", dims_text(dims, &f->space), size_text(size, &f->space), from,
          content_text(content, f));
}

static json_t *labels_json(const facts *f) {
  json_t *table = json_array();
  for (int64_t l = 1; l < f->label_end; l++) {
    const char *name = vxm_field_label_name(f->values.field, l);
    if (f->counts[l] == 0 && !*name)
      continue;
    json_t *entry = json_object();
    json_object_set_new(entry, "label", json_integer(l));
    json_object_set_new(entry, "name", cli_json_text(name));
    json_object_set_new(entry, "voxels", json_integer(f->counts[l]));
    json_array_append_new(table, entry);
  }
  return table;
}

static json_t *box_json(const facts *f) {
  json_t *box = json_object(), *begin = json_array(), *end = json_array();
  for (int a = 0; a < 3; a++) {
    json_array_append_new(begin, json_integer(f->begin[a]));
    json_array_append_new(end, json_integer(f->end[a]));
  }
  json_object_set_new(box, "begin", begin);
  json_object_set_new(box, "end", end);
  return box;
}

static json_t *describe_json(const cli_run *cli, const facts *f) {
  json_t *object = json_object();
  json_object_set_new(object, "file", cli_json_text(f->path));
  json_object_set_new(object, "format", json_string(f->format));
  json_object_set_new(object, "grid", cli_json_space(&f->space));
  if (f->values.grid || f->values.field)
    cli_values_json(object, &f->values, true);
  if (f->set >= 0)
    json_object_set_new(object, "voxels", json_integer(f->set));
  if (f->values.grid && f->set > 0)
    json_object_set_new(object, "set_within", box_json(f));
  if (f->counts)
    json_object_set_new(object, "labels", labels_json(f));
  json_object_set_new(object, "warnings", json_copy(cli->warnings));
  return object;
}

int cli_grid_info(cli_run *cli, json_t *reports, const char *path, const cli_grid_row *row, bool is_row) {
  facts f = {.path = path, .format = vxm_grid_format_of(path)};
  vxm_status status = look(cli, &f);
  cli_progress_clear(cli);
  if (status == VXM_OK && cli_summary(cli)) {
    if (is_row && row->has_heading)
      tell_heading(cli, row->width);
    else if (!is_row && row->is_next)
      fputc('\n', cli->text);
    if (is_row)
      tell_row(cli, &f, row->width);
    else
      tell(cli, &f);
  }
  if (status == VXM_OK)
    json_array_append_new(reports, describe_json(cli, &f));
  free(f.counts);
  cli_values_free(&f.values);
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}
