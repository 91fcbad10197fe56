/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend repair: a repaired mesh, verified, and a table of what changed. */
#include "cli/repair.h"
#include "cli/repair_common.h"

#include <string.h>

typedef struct request {
  const char *input, *output, *format;
  bool best_effort;
  vxm_repair_options repair;
  vxm_mesh_write_options write;
  cli_defects defects;
} request;

/* ---- Options ---- */

static int take_fill_holes(cli_run *cli, const cli_option *option, const char *value, void *member) {
  int64_t *edges = member;
  if (strcmp(value, "all") == 0)
    *edges = -1;
  else if (!cli_read_integer(edges, value, 3, INT64_MAX))
    return cli_usage(cli, "--%s '%s' is neither all nor a number of edges from 3 on", option->name, value);
  return CLI_END;
}

static int take_drop_parts(cli_run *cli, const cli_option *option, const char *value, void *member) {
  vxm_repair_options *repair = member;
  const char *number = strchr(value, ':');
  size_t length = number ? (size_t)(number++ - value) : 0;
  if (length == 5 && strncmp(value, "faces", length) == 0 &&
      cli_read_integer(&repair->drop_faces, number, 1, INT64_MAX))
    return CLI_END;
  if (length == 6 && strncmp(value, "volume", length) == 0 && cli_read_number(&repair->drop_volume, number) &&
      repair->drop_volume > 0)
    return CLI_END;
  return cli_usage(cli, "--%s '%s' is neither faces:N, such as faces:50, nor volume:V, such as volume:0.1",
                   option->name, value);
}

static int take_wrap(cli_run *cli, const cli_option *option, const char *value, void *member) {
  vxm_repair_options *repair = member;
  double numbers[2] = {0, 0};
  if (!cli_read_numbers(numbers, strchr(value, ',') ? 2 : 1, value) || !(numbers[0] > 0 && numbers[0] <= 1) ||
      !(numbers[1] >= 0 && numbers[1] <= 1))
    return cli_usage(cli,
                     "--%s '%s' is not a fraction of the diagonal such as 0.02, or two such as 0.02,0.001",
                     option->name, value);
  repair->wrap_alpha = numbers[0];
  repair->wrap_offset = numbers[1];
  return CLI_END;
}

static int take_fallback(cli_run *cli, const cli_option *option, const char *value, void *member) {
  vxm_repair_options *repair = member;
  double alpha = 0.01;
  bool known = strncmp(value, "wrap", 4) == 0 && (value[4] == 0 || value[4] == ':');
  if (known && value[4] == ':')
    known = cli_read_number(&alpha, value + 5) && alpha > 0 && alpha <= 1;
  if (!known)
    return cli_usage(cli, "--%s '%s' is neither wrap nor wrap:ALPHA, such as wrap:0.005", option->name,
                     value);
  repair->fallback_alpha = alpha;
  return CLI_END;
}

static const char *const fills[] = {"fan", "minimal", "smooth", NULL};
static const char *const sheets[] = {"thicken", "keep", "drop", NULL};

static const cli_option known_options[] = {
    {'o', "output", "MESH", "file to write; '-' is standard output (needs --format)",
     CLI_TEXT(request, output)},
    {0, "level", "clean|manifold|closed|solid",
     "how far to go; each includes those before it, and is verified in the\n"
     "file as it is read back and welded [clean]:\n"
     "clean     nothing is left to weld, remove or turn\n"
     "manifold  no edge has more than two faces, no vertex more than one fan\n"
     "closed    every edge has two faces: holes are filled, sheets thickened\n"
     "solid     no face cuts through another: parts are united",
     CLI_CHOICE(request, repair.level, repair_levels)},
    {0, "best-effort", NULL, "write the mesh, with a warning, although the level is not reached",
     CLI_FLAG(request, best_effort)},
    {0, "weld", "auto|off|EPS",
     "which vertices become one: auto = those at identical positions, and\n"
     "near ones where that closes cracks; off = identical positions only;\n"
     "EPS = all that are no farther apart, in model units: each goes to the\n"
     "nearest that stays, and no two that stay are within EPS. Edges that\n"
     "short collapse, and walls that thin close up [auto]",
     CLI_VALUE(cli_take_weld, request, repair)},
    {0, "keep-duplicates", NULL, "leave faces that repeat another, or lie back to back with it",
     CLI_FLAG(request, repair.keep_duplicates)},
    {0, "keep-orientation", NULL, "leave faces turned as they are, rather than consistently and outward",
     CLI_FLAG(request, repair.keep_orientation)},
    {0, "fill-holes", "N|all",
     "fill holes with at most N edges [none; all from level closed on].\n"
     "Open sheets are not: that would only duplicate them; see --sheets",
     CLI_VALUE(take_fill_holes, request, repair.fill_holes)},
    {0, "fill", "fan|minimal|smooth",
     "with what: fan = triangles from the middle of the rim; minimal = the\n"
     "triangulation of least area (OpenMesh); smooth = small triangles that\n"
     "continue the surface (CGAL) [fan]",
     CLI_CHOICE(request, repair.hole_fill, fills)},
    {0, "sheets", "thicken|keep|drop",
     "what becomes of open sheets at the levels closed and solid: plates, with\n"
     "their faces moved to both sides; keep leaves them open, and the level is\n"
     "not reached [thicken]",
     CLI_CHOICE(request, repair.sheets, sheets)},
    {0, "thickness", "T", "how thick, in model units; at most the model's diagonal [0.002 of that]",
     CLI_REAL(request, repair.thickness, CLI_ABOVE_0, DBL_MAX, "a length above 0, such as 0.5")},
    {0, "drop-parts", "faces:N|volume:V",
     "drop components with fewer than N faces, or closed ones with less volume\n"
     "than V, in model units cubed; may be given twice, once for each. The\n"
     "component with the largest area always stays, and cavities with what they\n"
     "are in",
     CLI_VALUE(take_drop_parts, request, repair)},
    {0, "union", NULL, "unite closed parts that cut through each other (CGAL)",
     CLI_FLAG(request, repair.boolean_union)},
    {0, "fallback", "wrap[:ALPHA]",
     "wrap those parts alone that cannot be united, with --union or --level\n"
     "solid; ALPHA as below, of their own diagonal [0.01] (CGAL)",
     CLI_VALUE(take_fallback, request, repair)},
    {0, "wrap", "ALPHA[,OFFSET]",
     "lay a closed surface around everything: ALPHA is the smallest hole that\n"
     "it goes into, OFFSET its distance, as fractions of the diagonal, such as\n"
     "0.02 [OFFSET: ALPHA/30] (CGAL)",
     CLI_VALUE(take_wrap, request, repair)},
    {0, "max-change", "F",
     "fail if the volume of a closed part, or the bounds of one, change by more\n"
     "than this fraction, such as 0.01",
     CLI_REAL(request, repair.max_change, CLI_ABOVE_0, DBL_MAX, "a fraction above 0, such as 0.01")},
    {0, "locate", "FILE.ply", "show what was wrong, in colour on the mesh as it was read",
     CLI_TEXT(request, defects.locate)},
    {0, "list", "N", "list what was wrong, up to N of each kind",
     CLI_NUMBER(request, defects.list, 1, CLI_LISTED_MAX)},
    {0, "intersections", NULL,
     "count faces that cut through others, before and after, and show them with\n"
     "--locate and --list (CGAL). With --union and --level solid they are\n"
     "counted in any case",
     CLI_FLAG(request, defects.intersections)},
    {0, "ascii", NULL, "write .stl and .ply as text rather than binary; .off and .obj are text anyway",
     CLI_FLAG(request, write.ascii)},
    {0, "polygons", "split|keep",
     "split = write triangles, as many programs read nothing else; keep = leave\n"
     "polygons as they are in .off, .obj and .ply [split]",
     CLI_CHOICE(request, write.keep_polygons, cli_polygon_kinds)},
    {0, "format", "F", "off, obj, stl or ply [by the name of the output]", CLI_TEXT(request, format)},
    CLI_OPTION_FORCE,
    CLI_OPTIONS_READ,
    CLI_OPTIONS_END};

static int check_conflicts(cli_run *cli, const request *given) {
  const vxm_repair_options *repair = &given->repair;
  if (repair->keep_orientation && repair->level > VXM_LEVEL_CLEAN)
    return cli_usage(cli, "--level %s turns faces; leave out --keep-orientation",
                     repair_levels[repair->level]);
  if (repair->wrap_alpha > 0 &&
      (repair->fill_holes != 0 || cli_is_given(cli, "fill") || repair->boolean_union ||
       repair->max_change > 0 || repair->keep_duplicates || repair->keep_orientation))
    return cli_usage(
        cli, "--wrap makes a new surface, without holes, parts to compare or faces to keep; leave out "
             "--fill-holes, --fill, --union, --max-change, --keep-duplicates and --keep-orientation");
  if (cli_is_given(cli, "fill") && repair->fill_holes == 0 && repair->level < VXM_LEVEL_CLOSED)
    return cli_usage(cli, "--fill goes with --fill-holes, or with --level closed or solid");
  if (repair->fallback_alpha > 0 &&
      (repair->wrap_alpha > 0 || !(repair->boolean_union || repair->level == VXM_LEVEL_SOLID)))
    return cli_usage(cli, "--fallback goes with --union or --level solid, without --wrap");
  bool plates = repair->thickness > 0;
  if ((cli_is_given(cli, "sheets") || plates) && (repair->level < VXM_LEVEL_CLOSED || repair->wrap_alpha > 0))
    return cli_usage(cli, "%s goes with --level closed or solid, without --wrap",
                     plates ? "--thickness" : "--sheets");
  if (plates && repair->sheets != VXM_SHEETS_THICKEN)
    return cli_usage(cli, "--thickness goes with --sheets thicken");
  return cli_defects_check(cli, &given->defects);
}

/** CLI_DONE, or CLI_STOP with cli->status set. */
static int read_arguments(cli_run *cli, request *out) {
  if (cli_read_options(cli, out) == CLI_STOP)
    return CLI_STOP;
  if (cli->argument_count != 1)
    return cli_usage(cli, "one mesh is expected, not %d", cli->argument_count);
  out->input = cli->arguments[0];
  if (check_conflicts(cli, out) == CLI_STOP)
    return CLI_STOP;
  out->write.format = cli_output_format(cli, out->output, out->format, cli_mesh_formats);
  if (!out->write.format || cli_check_polygons(cli, out->write.keep_polygons, out->write.format) == CLI_STOP)
    return CLI_STOP;
  cli_writes(cli, "-o", out->output, false);
  cli_writes(cli, "--locate", out->defects.locate, false);
  if (cli_check_names(cli) == CLI_STOP ||
      cli_check_surface_file(cli, out->output, out->write.format) == CLI_STOP ||
      cli_defects_check_file(cli, &out->defects) == CLI_STOP)
    return CLI_STOP;
  out->repair.part_changes = cli_summary(cli) || cli->json || cli->report;
  out->repair.intersections =
      out->defects.intersections ||
      (out->repair.part_changes && (out->repair.boolean_union || out->repair.level == VXM_LEVEL_SOLID));
  out->repair.single_precision = strcmp(out->write.format, "stl") == 0;
  out->repair.triangles = !out->write.keep_polygons;
  return CLI_DONE;
}

/* ---- Work ---- */

static bool wants_report(const cli_run *cli) {
  return cli->json || cli->report;
}

/** Says why nothing is written; the report and the picture of what was wrong are what there is to work with.
 */
static int refuse(cli_run *cli, const request *given, repair_outcome *outcome) {
  cli_fail(cli);
  if (!cli->quiet && outcome->verification.count > 0)
    repair_say_remains(cli, stderr, outcome);
  if (wants_report(cli) && outcome->mesh)
    cli_finish(cli, repair_report(cli, given->input, NULL, outcome));
  else
    cli_publish(cli);
  return CLI_FAILED;
}

static int try_repair(cli_run *cli, const request *given, repair_outcome *outcome, const vxm_mesh *raw) {
  double start = cli_clock();
  vxm_status status = vxm_mesh_repair(&outcome->mesh, &outcome->repair, raw, &given->repair, &cli->error);
  outcome->seconds = (cli_clock() - start) / 1e3;
  if (status == VXM_OK && vxm_mesh_face_count(outcome->mesh) > 0)
    return CLI_DONE;
  if (status == VXM_OK) {
    cli_no_face(cli, given->input, vxm_mesh_face_count(raw), &outcome->repair);
  } else if (status != VXM_ERROR_UNREACHED)
    return cli_fail(cli);
  else if (wants_report(cli)) { /* what changes by too much is told nevertheless */
    vxm_repair_options any = given->repair;
    vxm_error ignored = VXM_ERROR_INIT;
    any.max_change = 0;
    vxm_mesh_repair(&outcome->mesh, &outcome->repair, raw, &any, &ignored);
  }
  return refuse(cli, given, outcome);
}

static int repair_mesh(cli_run *cli, const request *given, repair_outcome *outcome) {
  vxm_mesh *raw = NULL;
  if (vxm_mesh_read_with(&raw, cli->context, given->input, &cli->read, &cli->error) != VXM_OK)
    return cli_fail(cli);
  cli_note_companions(cli, raw);
  cli_warn_mesh(cli, given->input, raw, 0);
  cli_defects wanted = given->defects; /* the repair counts intersections itself */
  wanted.intersections = wanted.intersections && (wanted.list || wanted.locate);
  int status = cli_defects_show(cli, &outcome->found, &wanted, raw);
  if (status == CLI_DONE)
    status = try_repair(cli, given, outcome, raw);
  if (outcome->mesh)
    cli_warn_mesh(cli, given->input, outcome->mesh, vxm_mesh_warning_count(raw));
  vxm_mesh_destroy(raw);
  if (status == CLI_DONE && outcome->repair.union_failures > 0)
    repair_warn_ununited(cli, given->input, outcome);
  return status;
}

/** What helps where a level is not reached. */
static const char *advice(const vxm_repair_options *repair, const repair_outcome *outcome) {
  if (repair_leaves_slivers(outcome))
    return "choose --level solid, which takes away the slivers that the union has there, leave out --union, "
           "or "
           "take what there is (--best-effort)";
  if (repair->level == VXM_LEVEL_CLEAN)
    return repair->single_precision ? "write another format than stl, or take what there is (--best-effort)"
                                    : "repair the result again, or take what there is (--best-effort)";
  if (repair->level == VXM_LEVEL_MANIFOLD)
    return "choose --level clean, or take what there is (--best-effort)";
  return "choose a lower --level, fill or drop what is in the way (--fill-holes, --drop-parts), go around it "
         "(--wrap, --fallback), or take what there is (--best-effort)";
}

static void warn_emptied(cli_run *cli, const char *input, int64_t parts) {
  if (parts > 0)
    cli_warn(cli,
             "%s: the union has taken away some of what %lld closed %s enclosed, as of one that lies in a "
             "cavity; voxmend remesh keeps it, and voxmend voxelize takes the mesh as it is",
             cli_shown(input, "<stdin>"), (long long)parts, parts == 1 ? "part" : "parts");
}

static int write_mesh(cli_run *cli, const request *given, repair_outcome *outcome) {
  vxm_status status = vxm_mesh_write_verified(&outcome->verification, outcome->mesh, given->output,
                                              &given->write, &given->repair, given->best_effort, &cli->error);
  if (status == VXM_ERROR_UNREACHED) {
    cli_advise(cli, advice(&given->repair, outcome));
    return refuse(cli, given, outcome);
  }
  if (status != VXM_OK)
    return cli_fail(cli);
  cli_warn_lost(cli, given->input, &outcome->repair);
  warn_emptied(cli, given->input, outcome->repair.emptied_parts);
  if (outcome->repair.opened_parts > 0)
    cli_warn(cli, "%s: %lld closed %s open after the repair", given->output,
             (long long)outcome->repair.opened_parts,
             outcome->repair.opened_parts == 1 ? "part is" : "parts are");
  if (outcome->repair.shared_faces > 0)
    cli_warn(cli,
             "%s: %lld %s, where bodies overlap and share a part of their surfaces; "
             "--level manifold gives each body its own, --level solid unites them",
             given->output, (long long)outcome->repair.shared_faces,
             outcome->repair.shared_faces == 1 ? "face repeats another" : "faces repeat others");
  if (!outcome->verification.reached)
    cli_warn(cli, "%s: the level %s is not reached; the report lists what remains", given->output,
             repair_levels[outcome->level]);
  return CLI_DONE;
}

static int finish(cli_run *cli, const request *given, repair_outcome *outcome) {
  if (repair_mesh(cli, given, outcome) != CLI_DONE || write_mesh(cli, given, outcome) != CLI_DONE)
    return CLI_FAILED;
  cli_progress_clear(cli);
  if (cli_summary(cli))
    repair_summarize(cli, outcome);
  return cli_finish(cli, wants_report(cli) ? repair_report(cli, given->input, given->output, outcome) : NULL);
}

static int run(cli_run *cli) {
  request given = {.repair = VXM_REPAIR_OPTIONS_INIT, .write = VXM_MESH_WRITE_OPTIONS_INIT};
  if (read_arguments(cli, &given) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  repair_outcome outcome = {.repair = VXM_REPAIR_REPORT_INIT,
                            .before = VXM_CENSUS_INIT,
                            .after = VXM_CENSUS_INIT,
                            .level = given.repair.level,
                            .sheets = given.repair.sheets,
                            .single_precision = given.repair.single_precision,
                            .verification = VXM_VERIFICATION_INIT};
  outcome.repair.before = &outcome.before;
  outcome.repair.after = &outcome.after;
  int status = finish(cli, &given, &outcome);
  json_decref(outcome.found.list);
  vxm_mesh_destroy(outcome.mesh);
  return status;
}

const cli_command cli_command_repair = {
    .name = "repair",
    .arguments = "MESH -o MESH [OPTION]...",
    .summary = "mend a mesh, verify it, and show it before and after",
    .notes =
        "Removes vertices that are not finite with their faces, welds vertices, removes faces without area\n"
        "(but those that close a gap), repeated faces (of two that lie back to back one stays) and unused\n"
        "vertices, and turns faces consistently, outward where they enclose something; then goes as far as\n"
        "--level says. Repairing the result again changes nothing. Where the level is not reached, the exit\n"
        "status is 1, what remains is listed, also in the report, and no mesh is written. Groups and the\n"
        "names of materials stay in .obj; colours, textures and normals do not.\n\n"
        "Examples:\n"
        "  voxmend repair scan.obj -o scan.ply\n"
        "  voxmend repair part.stl -o part.off --weld 0.001\n"
        "  voxmend repair scan.ply -o closed.stl --level closed\n"
        "  voxmend repair chair.off -o chair.stl --level closed --thickness 0.5\n"
        "  voxmend repair scan.ply -o main.ply --drop-parts faces:100\n"
        "  voxmend repair bracket.obj -o bracket.stl --level solid --max-change 0.001\n"
        "  voxmend repair wreck.obj -o wrapped.ply --wrap 0.02 --level solid\n"
        "  voxmend repair part.stl -o part.ply --locate wrong.ply --list 10 --json\n"
        "  cat part.stl | voxmend repair - -o - --format obj > part.obj",
    .options = known_options,
    .run = run,
};
