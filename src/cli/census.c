/* SPDX-License-Identifier: BSD-3-Clause */
/** The census of a mesh as a table and as JSON. */
#include "cli/defects.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

/** A count of the census. */
typedef struct count_row {
  const char *key; /**< in JSON; shown with blanks for underscores */
  size_t offset;
  const char *meaning; /**< shown beside a count that is not zero; NULL = none */
} count_row;

#define COUNT(field, meaning) \
  { #field, offsetof(vxm_census, field), meaning }

static const count_row counts[] = {
    COUNT(vertices, NULL),
    COUNT(faces, NULL),
    COUNT(triangles, NULL),
    COUNT(largest_face, NULL),
    COUNT(components, NULL),
    COUNT(components_raw, NULL),
    COUNT(duplicate_faces, "repeat another face; repair removes them"),
    COUNT(opposite_duplicate_faces, "lie back to back with another; repair merges them"),
    COUNT(degenerate_faces,
          "have no area beside the size of the whole; repair removes those that close no gap"),
    COUNT(boundary_edges, "open: holes, cracks or loose sheets"),
    COUNT(nonmanifold_edges, "join more than two faces"),
    COUNT(inconsistent_edges, "join two faces that are wound against each other"),
    COUNT(nonfinite_vertices, "infinite or not a number; repair removes them with their faces"),
    COUNT(unused_vertices, "in no face; repair removes them"),
};

enum { COUNTS = sizeof counts / sizeof counts[0], LABEL = 26 };

static int64_t value_of(const vxm_census *census, const count_row *row) {
  int64_t value;
  memcpy(&value, (const char *)census + row->offset, sizeof value);
  return value;
}

static const char *label_of(const count_row *row, char label[LABEL]) {
  size_t i = 0;
  for (; row->key[i] && i + 1 < LABEL; i++)
    label[i] = row->key[i] == '_' ? ' ' : row->key[i];
  label[i] = '\0';
  return label;
}

static const char *yes(bool value) {
  return value ? "yes" : "no";
}

/** An area or volume, or that it is beyond the range of numbers. */
static const char *measure_text(char text[24], int digits, double value) {
  if (isfinite(value))
    snprintf(text, 24, "%.*g", digits, value);
  else
    snprintf(text, 24, "%s", "out of range");
  return text;
}

const char *cli_volume_text(char text[24], int digits, bool closed, double value) {
  return closed ? measure_text(text, digits, value) : "-";
}

void cli_census_print(const cli_run *cli, const vxm_census *census) {
  char label[LABEL];
  for (int i = 0; i < COUNTS; i++) {
    const count_row *row = &counts[i];
    int64_t value = value_of(census, row);
    fprintf(cli->text, "  %-26s %12" PRId64, label_of(row, label), value);
    if (row->meaning && value > 0)
      fprintf(cli->text, "  %s", row->meaning);
    fputc('\n', cli->text);
  }
  const double *b = census->bounds;
  fprintf(cli->text, "  %-26s %12s\n", "watertight", yes(census->watertight));
  fprintf(cli->text, "  %-26s %12s%s\n", "closed", yes(census->closed),
          census->closed ? "" : "  some edge has an odd number of faces");
  fprintf(cli->text, "  %-26s %12.6g %.6g %.6g\n", "least corner", b[0], b[1], b[2]);
  fprintf(cli->text, "  %-26s %12.6g %.6g %.6g\n", "greatest corner", b[3], b[4], b[5]);
  char number[24];
  fprintf(cli->text, "  %-26s %12s\n", "area", measure_text(number, 6, census->area));
  fprintf(cli->text, "  %-26s %12s%s\n", "volume", cli_volume_text(number, 6, census->closed, census->volume),
          census->closed ? "" : "  none: the mesh is not closed");
}

const char *cli_intersections_text(char text[32], int64_t count) {
  snprintf(text, 32, "%s%" PRId64, count >= VXM_SELF_INTERSECTIONS_MAX ? "at least " : "", count);
  return text;
}

void cli_intersections_json(json_t *object, int64_t count) {
  if (count >= 0)
    json_object_set_new(object, "self_intersections", json_integer(count));
  if (count >= VXM_SELF_INTERSECTIONS_MAX)
    json_object_set_new(object, "self_intersections_at_least", json_true());
}

void cli_census_print_intersections(const cli_run *cli, int64_t count) {
  char text[32];
  if (count >= 0)
    fprintf(cli->text, "  %-22s %16s%s\n", "self intersections", cli_intersections_text(text, count),
            count > 0 ? "  pairs of faces that cut through each other" : "");
}

void cli_census_print_both(const cli_run *cli, const vxm_census *before, const vxm_census *after) {
  char label[LABEL];
  fprintf(cli->text, "%-28s %12s %12s\n", "", "Original", "Final");
  for (int i = 0; i < COUNTS; i++)
    fprintf(cli->text, "  %-26s %12" PRId64 " %12" PRId64 "\n", label_of(&counts[i], label),
            value_of(before, &counts[i]), value_of(after, &counts[i]));
  fprintf(cli->text, "  %-26s %12s %12s\n", "watertight", yes(before->watertight), yes(after->watertight));
  fprintf(cli->text, "  %-26s %12s %12s\n", "closed", yes(before->closed), yes(after->closed));
  char one[24], other[24];
  fprintf(cli->text, "  %-26s %12s %12s\n", "area", measure_text(one, 6, before->area),
          measure_text(other, 6, after->area));
  fprintf(cli->text, "  %-26s %12s %12s\n", "volume", cli_volume_text(one, 6, before->closed, before->volume),
          cli_volume_text(other, 6, after->closed, after->volume));
}

void cli_census_json(json_t *object, const vxm_census *census) {
  for (int i = 0; i < COUNTS; i++)
    json_object_set_new(object, counts[i].key, json_integer(value_of(census, &counts[i])));
  json_object_set_new(object, "watertight", json_boolean(census->watertight));
  json_object_set_new(object, "closed", json_boolean(census->closed));
  json_object_set_new(object, "bounds", cli_json_numbers(census->bounds, 6));
  json_object_set_new(object, "area", cli_json_number(census->area));
  json_object_set_new(object, "volume", cli_json_number(census->volume));
}
