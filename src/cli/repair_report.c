/* SPDX-License-Identifier: BSD-3-Clause */
/** What a repair did, as a table and as JSON. */
#include "cli/repair.h"
#include "cli/repair_common.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

const char *const repair_levels[] = {"clean", "manifold", "closed", "solid", NULL};

/* ---- JSON ---- */

/** @param cut the self-intersections of all parts were not counted to the end */
static json_t *state_json(const vxm_part_state *state, bool cut) {
  json_t *object = json_object();
  json_object_set_new(object, "faces", json_integer(state->faces));
  json_object_set_new(object, "boundary_edges", json_integer(state->boundary_edges));
  json_object_set_new(object, "nonmanifold_edges", json_integer(state->nonmanifold_edges));
  json_object_set_new(object, "inconsistent_edges", json_integer(state->inconsistent_edges));
  json_object_set_new(object, "holes", json_integer(state->holes));
  if (state->self_intersections >= 0)
    json_object_set_new(object, "self_intersections", json_integer(state->self_intersections));
  if (state->self_intersections >= 0 && cut)
    json_object_set_new(object, "self_intersections_at_least", json_true());
  json_object_set_new(object, "closed", json_boolean(state->closed));
  json_object_set_new(object, "area", cli_json_number(state->area));
  json_object_set_new(object, "volume", cli_json_number(state->volume));
  json_object_set_new(object, "bounds", cli_json_numbers(state->bounds, 6));
  return object;
}

static bool is_cut(int64_t intersections) {
  return intersections >= VXM_SELF_INTERSECTIONS_MAX;
}

static json_t *parts_json(const vxm_mesh *mesh, const vxm_repair_report *repair) {
  json_t *parts = json_array();
  for (int64_t i = 0; i < vxm_mesh_part_change_count(mesh); i++) {
    const vxm_part_change *change = vxm_mesh_part_change(mesh, i);
    json_t *part = json_object();
    if (change->tag != UINT32_MAX)
      json_object_set_new(part, "name", cli_json_text(vxm_mesh_tag_name(mesh, change->tag)));
    json_object_set_new(part, "before",
                        state_json(change->before, is_cut(repair->self_intersections_before)));
    json_object_set_new(part, "after", state_json(change->after, is_cut(repair->self_intersections_after)));
    json_object_set_new(part, "flipped", json_integer(change->flipped));
    json_object_set_new(part, "max_displacement", cli_json_number(change->max_displacement));
    json_object_set_new(part, "union_failed", json_boolean(change->union_failed));
    json_array_append_new(parts, part);
  }
  return parts;
}

static json_t *verification_json(const repair_outcome *outcome) {
  json_t *object = json_object(), *findings = json_array();
  const vxm_verification *found = &outcome->verification;
  for (int i = 0; i < found->count; i++) {
    json_t *one = json_object();
    json_object_set_new(one, "what", json_string(found->findings[i].what));
    json_object_set_new(one, "count", json_integer(found->findings[i].count));
    if (strcmp(found->findings[i].what, "self_intersections") == 0 && is_cut(found->findings[i].count))
      json_object_set_new(one, "at_least", json_true());
    if (found->findings[i].element >= 0)
      json_object_set_new(one, "first", json_integer(found->findings[i].element));
    if (found->findings[i].placed)
      json_object_set_new(one, "position", cli_json_numbers(found->findings[i].position, 3));
    json_array_append_new(findings, one);
  }
  json_object_set_new(object, "level", json_string(repair_levels[outcome->level]));
  json_object_set_new(object, "reached", json_boolean(found->reached));
  json_object_set_new(object, "findings", findings);
  return object;
}

/** What was wrong, in a sentence. */
static const char *repair_verdict(char sentence[CLI_SENTENCE], const repair_outcome *outcome) {
  const cli_openings openings = {.known = outcome->level >= VXM_LEVEL_CLOSED,
                                 .sheets = outcome->repair.sheets + outcome->repair.open_parts,
                                 .holes = outcome->repair.filled_holes + outcome->repair.unfilled_holes};
  return cli_verdict(sentence, &outcome->before, &openings, outcome->repair.self_intersections_before);
}

json_t *repair_report(const cli_run *cli, const char *input, const char *output,
                      const repair_outcome *outcome) {
  const vxm_repair_report *repair = &outcome->repair;
  json_t *before = json_object(), *after = json_object(), *report = json_object();
  cli_census_json(before, &outcome->before);
  cli_census_json(after, &outcome->after);
  cli_intersections_json(before, repair->self_intersections_before);
  cli_intersections_json(after, repair->self_intersections_after);
  json_object_set_new(report, "input", cli_json_text(input));
  json_object_set_new(report, "output", output ? cli_json_text(output) : json_null());
  if (!output)
    json_object_set_new(report, "refused", cli_json_text(cli->error.text));
  char sentence[CLI_SENTENCE];
  json_object_set_new(report, "verdict", cli_json_text(repair_verdict(sentence, outcome)));
  json_object_set_new(report, "verified", verification_json(outcome));
  json_object_set_new(report, "passes", cli_passes_json(repair));
  json_object_set_new(report, "nonorientable_patches", json_integer(repair->nonorientable_patches));
  json_object_set_new(report, "open_parts", json_integer(repair->open_parts));
  json_object_set_new(report, "sheets", json_integer(repair->sheets));
  json_object_set_new(report, "filled_holes", json_integer(repair->filled_holes));
  json_object_set_new(report, "unfilled_holes", json_integer(repair->unfilled_holes));
  json_object_set_new(report, "fan_fallbacks", json_integer(repair->fan_fallbacks));
  json_object_set_new(report, "union_failures", json_integer(repair->union_failures));
  json_object_set_new(report, "union_tries", json_integer(repair->union_tries));
  json_object_set_new(report, "wrapped_parts", json_integer(repair->wrapped_parts));
  json_object_set_new(report, "unparted_vertices", json_integer(repair->unparted_vertices));
  json_object_set_new(report, "shared_faces", json_integer(repair->shared_faces));
  json_object_set_new(report, "lost_parts", json_integer(repair->lost_parts));
  json_object_set_new(report, "emptied_parts", json_integer(repair->emptied_parts));
  json_object_set_new(report, "opened_parts", json_integer(repair->opened_parts));
  json_object_set_new(report, "max_displacement", cli_json_number(repair->max_displacement));
  json_object_set_new(report, "before", before);
  json_object_set_new(report, "after", after);
  json_object_set_new(report, "parts", parts_json(outcome->mesh, repair));
  if (outcome->found.list)
    json_object_set(report, "defects", outcome->found.list);
  json_object_set(report, "warnings", cli->warnings);
  return report;
}

/* ---- Text ---- */

enum { PARTS_SHOWN = 12, NAMED = 5, LONG_SECONDS = 30 };

static void part_row(const cli_run *cli, const vxm_mesh *mesh, int64_t i) {
  const vxm_part_change *part = vxm_mesh_part_change(mesh, i);
  const vxm_part_state *a = part->before, *b = part->after;
  char number[24], one[24], other[24];
  snprintf(number, sizeof number, "%" PRId64, i);
  const char *name = part->tag != UINT32_MAX ? vxm_mesh_tag_name(mesh, part->tag) : number;
  fprintf(cli->text,
          "  %-14.14s %8" PRId64 " %8" PRId64 " %7" PRId64 " %7" PRId64 " %7" PRId64 " %7" PRId64
          " %11s %11s %9.2g\n",
          name, a->faces, b->faces, a->boundary_edges, b->boundary_edges, a->nonmanifold_edges,
          b->nonmanifold_edges, cli_volume_text(one, 5, a->closed, a->volume),
          cli_volume_text(other, 5, b->closed, b->volume), part->max_displacement);
}

static void summarize_parts(const cli_run *cli, const vxm_mesh *mesh) {
  int64_t count = vxm_mesh_part_change_count(mesh);
  if (count < 2)
    return;
  fprintf(cli->text, "\n%-16s %17s %15s %15s %23s %9s\n", "Part", "faces", "open edges", "non-manifold",
          "volume", "moved");
  fprintf(cli->text, "  %-14s %8s %8s %7s %7s %7s %7s %11s %11s\n", "", "before", "after", "before", "after",
          "before", "after", "before", "after");
  for (int64_t i = 0; i < count && i < PARTS_SHOWN; i++)
    part_row(cli, mesh, i);
  if (count > PARTS_SHOWN)
    fprintf(cli->text, "  and %" PRId64 " more; --json lists all\n", count - PARTS_SHOWN);
}

static void summarize_passes(const cli_run *cli, const vxm_repair_report *repair) {
  bool any = false;
  for (int i = 0; i < repair->pass_count; i++) {
    if (repair->passes[i].count == 0 && !cli->verbose)
      continue;
    if (!any)
      fprintf(cli->text, "\n%-28s %12s\n", "Pass", "Changed");
    fprintf(cli->text, "  %-26s %12" PRId64 "\n", repair->passes[i].pass, repair->passes[i].count);
    any = true;
  }
  if (!any)
    fprintf(cli->text, "\nThere was nothing to repair\n");
}

static void summarize_rest(const cli_run *cli, const vxm_repair_report *repair, vxm_sheets sheets) {
  if (repair->nonorientable_patches > 0)
    fprintf(cli->text, "\n%" PRId64 " patches cannot be turned consistently (like a Moebius strip)\n",
            repair->nonorientable_patches);
  if (repair->open_parts > 0)
    fprintf(cli->text, "\n%" PRId64 " components stay open: sheets, which filling would only duplicate\n",
            repair->open_parts);
  if (repair->sheets > 0)
    fprintf(cli->text, "\n%" PRId64 " open sheets %s\n", repair->sheets,
            sheets == VXM_SHEETS_DROP ? "were dropped" : "became plates (--sheets, --thickness)");
  if (repair->unfilled_holes > 0)
    fprintf(cli->text, "\n%" PRId64 " holes could not be filled\n", repair->unfilled_holes);
  if (repair->fan_fallbacks > 0)
    fprintf(cli->text, "\n%" PRId64 " holes could not be filled as asked for, and were by fans\n",
            repair->fan_fallbacks);
  if (repair->union_tries > 1)
    fprintf(cli->text, "\nThe union was tried %" PRId64 " times: slivers were in the way, which takes long\n",
            repair->union_tries);
  if (repair->wrapped_parts > 0)
    fprintf(cli->text, "\n%" PRId64 " parts could not be united, and were wrapped\n", repair->wrapped_parts);
  if (repair->union_failures > 0)
    fprintf(cli->text, "\n%" PRId64 " parts were not united\n", repair->union_failures);
}

/** The name of a part, or else its number. */
static void part_name(char *out, size_t size, const vxm_mesh *mesh, int64_t part) {
  uint32_t tag = vxm_mesh_part_change(mesh, part)->tag;
  if (tag != UINT32_MAX)
    snprintf(out, size, "%s", vxm_mesh_tag_name(mesh, tag));
  else
    snprintf(out, size, "%" PRId64, part);
}

void repair_warn_ununited(cli_run *cli, const char *input, const repair_outcome *outcome) {
  char list[256] = "", name[40];
  size_t length = 0;
  int64_t count = 0;
  bool some_open = false;
  for (int64_t i = 0; i < vxm_mesh_part_change_count(outcome->mesh); i++) {
    const vxm_part_change *change = vxm_mesh_part_change(outcome->mesh, i);
    some_open =
        some_open || (change->union_failed && !(change->before->closed && change->before->volume != 0));
    if (!change->union_failed || count++ >= NAMED)
      continue;
    part_name(name, sizeof name, outcome->mesh, i);
    length += (size_t)snprintf(list + length, sizeof list - length, "%s%s", length ? ", " : "", name);
  }
  if (count > NAMED)
    snprintf(list + length, sizeof list - length, " and %" PRId64 " more", count - NAMED);
  cli_warn(cli, "%s: %" PRId64 " parts still cut through others or themselves%s: %s",
           cli_shown(input, "<stdin>"), count, some_open ? ", and what is open has no inside to unite" : "",
           list);
}

/** Says why it took long, where a union did. */
static void say_long(FILE *stream, const repair_outcome *outcome) {
  const vxm_repair_report *repair = &outcome->repair;
  int64_t united = 0;
  for (int i = 0; i < repair->pass_count; i++)
    if (strcmp(repair->passes[i].pass, "union") == 0)
      united = repair->passes[i].count;
  if (outcome->seconds > LONG_SECONDS && united > 0)
    fprintf(stream,
            "\n  The repair took %.0f s, most of it to cut faces exactly where %" PRId64
            " parts meet: --level closed does not\n",
            outcome->seconds, united);
}

/** Whether the model would have finer numbers at the origin. */
static bool is_far(const double bounds[6]) {
  double largest = 0, longest = 0;
  for (int i = 0; i < 6; i++)
    largest = fmax(largest, fabs(bounds[i]));
  for (int i = 0; i < 3; i++)
    longest = fmax(longest, bounds[i + 3] - bounds[i]);
  return largest > 2 * longest;
}

/** Why vertices are together still, and what helps. */
static void say_unparted(FILE *stream, const repair_outcome *outcome) {
  const char *why = outcome->single_precision && is_far(outcome->before.bounds)
                        ? "the numbers of the file are too coarse\n"
                          "  there; write another format than .stl, or move the model to the origin\n"
                    : outcome->single_precision ? "the numbers of the file are too coarse\n"
                                                  "  there; write another format than .stl\n"
                    : repair_leaves_slivers(outcome)
                        ? "the union has slivers there that are\n"
                          "  too thin; --level solid takes those away, or leave out --union\n"
                        : "faces there are too thin, or too far from\n"
                          "  the origin; go around them (--wrap), or move the model to the origin\n";
  if (outcome->repair.unparted_vertices > 0)
    fprintf(stream, "  %" PRId64 " vertices share positions and could not be moved apart: %s",
            outcome->repair.unparted_vertices, why);
}

bool repair_leaves_slivers(const repair_outcome *outcome) {
  bool united = false;
  for (int i = 0; i < outcome->repair.pass_count; i++)
    united = united ||
             (strcmp(outcome->repair.passes[i].pass, "union") == 0 && outcome->repair.passes[i].count > 0);
  return united && outcome->level < VXM_LEVEL_SOLID && !outcome->single_precision &&
         outcome->repair.unparted_vertices > 0;
}

void repair_say_remains(const cli_run *cli, FILE *stream, const repair_outcome *outcome) {
  (void)cli;
  say_long(stream, outcome);
  say_unparted(stream, outcome);
  const vxm_verification *found = &outcome->verification;
  for (int i = 0; i < found->count; i++) {
    fprintf(stream, "  %-26s %12" PRId64, found->findings[i].what, found->findings[i].count);
    if (found->findings[i].placed)
      fprintf(stream, "  the first at %.6g %.6g %.6g", found->findings[i].position[0],
              found->findings[i].position[1], found->findings[i].position[2]);
    fputc('\n', stream);
  }
}

void repair_summarize(const cli_run *cli, const repair_outcome *outcome) {
  char sentence[CLI_SENTENCE];
  fprintf(cli->text, "%s\n\n", repair_verdict(sentence, outcome));
  cli_census_print_both(cli, &outcome->before, &outcome->after);
  char before[32], after[32];
  if (outcome->repair.self_intersections_before >= 0)
    fprintf(cli->text, "  %-22s %16s %12s\n", "self intersections",
            cli_intersections_text(before, outcome->repair.self_intersections_before),
            cli_intersections_text(after, outcome->repair.self_intersections_after));
  summarize_passes(cli, &outcome->repair);
  summarize_parts(cli, outcome->mesh);
  summarize_rest(cli, &outcome->repair, outcome->sheets);
  cli_defects_print(cli, outcome->found.list);
  fprintf(cli->text, "\nLevel %s: %s\n", repair_levels[outcome->level],
          outcome->verification.reached ? "verified in the file as it was read back" : "not reached");
  repair_say_remains(cli, cli->text, outcome);
}
