/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend view: a picture of a grid, or of a mesh as voxels, or a page that shows them in a browser. */
#include "cli/field.h"
#include "cli/values.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { RESOLUTION = 128, VALUES_RESOLUTION_MAX = 512 };

typedef struct request {
  const char *input, *output;
  bool is_page;
  int64_t resolution;  /**< 0 = not given */
  const char *of_mesh; /**< an option that is for meshes alone, or NULL */
  bool has_colors, has_labels;
  vxm_color_options colors;
  vxm_label_options labels;
  const char *up_hint; /**< the extension by which `up` was chosen, or NULL */
  vxm_picture_options picture;
  vxm_threshold_options threshold;
} request;

/** What was made of the input. */
typedef struct subject {
  cli_values values;
  vxm_mesh *prepared; /**< to be voxelized, or NULL */
  vxm_mesh *mesh;     /**< of a page, and where its colours are wanted: as it was read; or NULL */
  vxm_mesh *repaired; /**< of a page: what a repair would make of it, or NULL */
} subject;

/** "800x600" */
static bool read_size(vxm_picture_options *out, const char *text) {
  enum { MOST = 16384 };
  const char *x = strchr(text, 'x');
  char width[8];
  int64_t w, h;
  if (!x || (size_t)(x - text) >= sizeof width)
    return false;
  memcpy(width, text, (size_t)(x - text));
  width[x - text] = '\0';
  if (!cli_read_integer(&w, width, 1, MOST) || !cli_read_integer(&h, x + 1, 1, MOST))
    return false;
  out->width = (int)w;
  out->height = (int)h;
  return true;
}

/** "z=0.5" */
static bool read_slice(vxm_picture_options *out, const char *text) {
  if (text[0] < 'x' || text[0] > 'z' || text[1] != '=')
    return false;
  out->slice_axis = text[0] - 'x' + 1;
  return cli_read_number(&out->slice, text + 2) && out->slice >= 0 && out->slice <= 1;
}

static int take_color(cli_run *cli, const cli_option *option, const char *value, void *member) {
  static const char *const names[] = {"mesh", "position", "part", "noise", NULL};
  static const vxm_color_by by[] = {VXM_COLOR_MESH, VXM_COLOR_POSITION, VXM_COLOR_PART, VXM_COLOR_NOISE};
  vxm_color_options *colors = member;
  int choice;
  if (cli_choose(cli, &choice, option->name, value, names) == CLI_STOP)
    return CLI_STOP;
  colors->by = by[choice];
  cli->read.colors = colors->by == VXM_COLOR_MESH;
  return CLI_END;
}

static int take_size(cli_run *cli, const cli_option *option, const char *value, void *member) {
  if (read_size(member, value))
    return CLI_END;
  return cli_usage(cli, "--%s '%s' is not WxH, each from 1 to 16384", option->name, value);
}

static int take_slice(cli_run *cli, const cli_option *option, const char *value, void *member) {
  if (read_slice(member, value))
    return CLI_END;
  return cli_usage(cli, "--%s '%s' is not x=S, y=S or z=S with S from 0 to 1", option->name, value);
}

static const cli_option known_options[] = {
    {'o', "output", "FILE", "picture (.png), or page for a browser (.html), to write",
     CLI_TEXT(request, output)},
    {'r', "resolution", "N", "voxels along the longest side of a mesh [128]",
     CLI_NUMBER(request, resolution, 1, 2048)},
    {0, "color", "mesh|position|part|noise", "colours of a mesh's voxels, as for voxelize",
     CLI_VALUE(take_color, request, colors)},
    {0, "labels", "part|group|material", "labels of a mesh's voxels, as for voxelize",
     CLI_CHOICE(request, labels.by, cli_label_kinds)},
    {0, "slice", "x|y|z=S", "the cross-section at a share S, from 0 to 1, of the grid along an axis",
     CLI_VALUE(take_slice, request, picture)},
    {0, "size", "WxH", "pixels, each from 1 to 16384 [800x600]", CLI_VALUE(take_size, request, picture)},
    {0, "azimuth", "DEGREES", "direction to look from, about the up axis [30]",
     CLI_REAL(request, picture.azimuth, -DBL_MAX, DBL_MAX, "a number of degrees")},
    {0, "elevation", "DEGREES", "height to look from, -90 to 90 above the horizon [25]",
     CLI_REAL(request, picture.elevation, -90, 90, "a number of degrees from -90 to 90")},
    {0, "up", "x|y|z", "axis that points up [by the format of a mesh, else z]",
     CLI_CHOICE_FROM(1, request, picture.up, cli_axes)},
    CLI_OPTIONS_THRESHOLD(request),
    CLI_OPTIONS_READ,
    CLI_OPTIONS_END};

static int read_arguments(cli_run *cli, request *out) {
  static const char *const of_view[] = {"azimuth", "elevation", NULL};
  static const char *const of_picture[] = {"slice", "size", "azimuth", "elevation", NULL};
  if (cli_read_options(cli, out) == CLI_STOP)
    return CLI_STOP;
  const char *view = cli_last_given(cli, of_view), *picture = cli_last_given(cli, of_picture);
  out->has_colors = cli_is_given(cli, "color");
  out->has_labels = cli_is_given(cli, "labels");
  if (cli->argument_count != 1)
    return cli_usage(cli, "one grid or mesh is expected, not %d", cli->argument_count);
  out->input = cli->arguments[0];
  if (!out->output)
    return cli_usage(cli, "-o FILE.png or -o FILE.html is missing");
  out->is_page = cli_is_extension(out->output, "html");
  if (!out->is_page && !cli_is_extension(out->output, "png"))
    return cli_usage(cli, "'%s' must end in .png, for a picture, or .html, for a page", out->output);
  if (out->has_colors && out->has_labels)
    return cli_usage(cli, "--color and --labels are two things to show; choose one");
  if ((out->has_colors || out->has_labels) && out->resolution > VALUES_RESOLUTION_MAX)
    return cli_usage(cli, "colours and labels are shown at up to %d voxels; lower --resolution",
                     VALUES_RESOLUTION_MAX);
  if (view && out->picture.slice_axis != 0)
    return cli_usage(cli, "--%s is for a view from outside; --slice is seen along its axis", view);
  if (out->is_page && picture)
    return cli_usage(cli, "--%s is for pictures (.png); a page is turned by hand", picture);
  cli_writes(cli, "-o", out->output, false);
  return cli_check_names(cli);
}

static bool is_named(const char *path, const char *const *formats) {
  for (int i = 0; formats[i]; i++)
    if (cli_is_extension(path, formats[i]))
      return true;
  return false;
}

char cli_usual_up(const char *mesh) {
  static const char *const y_formats[] = {"obj", "gltf", "glb", "dae", "zae", "x3d", "fbx", NULL};
  return is_named(mesh, y_formats) ? 'y' : 'z';
}

static void guess_up(request *given) {
  const char *dot = strrchr(given->input, '.'), *slash = strrchr(given->input, '/');
  if (given->picture.up != 0 || !dot || (slash && dot < slash))
    return;
  given->picture.up = cli_usual_up(given->input) - 'x' + 1;
  given->up_hint = dot;
}

/** For a page: what repair --level closed changes. */
static int repair_mesh(cli_run *cli, subject *out) {
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_CLOSED;
  vxm_status status = vxm_mesh_repair(&out->repaired, NULL, out->mesh, &options, &cli->error);
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}

/** Reads and prepares; for a page the mesh is kept as it was, too. */
static int read_mesh(cli_run *cli, subject *out, const request *given) {
  cli_input input;
  vxm_repair_options repair = VXM_REPAIR_OPTIONS_INIT;
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  int status = given->is_page ? cli_read_repaired(cli, &input, given->input, NULL)
                              : cli_read_divided(cli, &input, given->input, given->labels.by, &repair);
  *(given->is_page ? &out->mesh : &out->prepared) = input.mesh;
  if (!given->is_page)
    out->mesh = input.as_read;
  if (status != CLI_DONE || !given->is_page)
    return status;
  if (vxm_mesh_divide(&out->prepared, out->mesh, given->labels.by, &cli->error) != VXM_OK ||
      vxm_mesh_prepare_in_place(&out->prepared, &report, &repair, &cli->error) != VXM_OK)
    return cli_fail(cli);
  cli_warn_mesh(cli, given->input, out->prepared, vxm_mesh_warning_count(out->mesh));
  cli_warn_lost(cli, given->input, &report);
  if (vxm_mesh_face_count(out->prepared) == 0) {
    cli_no_face(cli, given->input, input.faces, &report);
    return cli_fail(cli);
  }
  return repair_mesh(cli, out);
}

/** Room for so many bytes a voxel; NULL after a failure, which is in cli->error. */
static void *values_of(cli_run *cli, const vxm_space *space, size_t bytes) {
  size_t voxels = (size_t)(space->dims[0] * space->dims[1] * space->dims[2]); /* 512^3 at most */
  void *values = malloc(voxels * bytes);
  if (!values) {
    cli->error = (vxm_error)VXM_ERROR_INIT;
    cli->error.code = VXM_ERROR_MEMORY;
    snprintf(cli->error.text, sizeof cli->error.text,
             "out of memory for the colours or labels of voxels: lower -r");
  }
  return values;
}

static vxm_status make_colors(cli_run *cli, subject *out, const request *given, vxm_model *model,
                              const vxm_space *space) {
  vxm_color_options options = given->colors;
  options.mesh = out->mesh;
  void *values = values_of(cli, space, 4);
  vxm_status status =
      values ? vxm_model_colors(values, NULL, model, space, &options, &cli->error) : VXM_ERROR_MEMORY;
  if (status == VXM_OK)
    status = vxm_field_create(&out->values.field, cli->context, space, VXM_FIELD_COLORS, VXM_UINT8, values,
                              &cli->error);
  free(values);
  if (status == VXM_ERROR_ARGUMENT && options.by == VXM_COLOR_MESH)
    cli_color_name_mesh(cli, cli_shown(given->input, "<stdin>"));
  return status;
}

static vxm_status make_labels(cli_run *cli, subject *out, const request *given, vxm_model *model,
                              const vxm_space *space) {
  uint16_t *values = values_of(cli, space, sizeof *values);
  vxm_status status =
      values ? vxm_model_labels(values, NULL, model, space, &given->labels, &cli->error) : VXM_ERROR_MEMORY;
  if (status == VXM_OK)
    status = vxm_field_create(&out->values.field, cli->context, space, VXM_FIELD_LABELS, VXM_UINT16, values,
                              &cli->error);
  for (int64_t l = 1; status == VXM_OK && l <= vxm_model_label_count(model); l++)
    status = vxm_field_add_label(out->values.field, vxm_model_label_name(model, l),
                                 vxm_model_label_voxels(model, l), &cli->error);
  free(values);
  return status;
}

static vxm_status make_values(cli_run *cli, subject *out, const request *given,
                              const vxm_space_options *wanted) {
  vxm_space space;
  vxm_model *model = NULL;
  vxm_status status = vxm_space_fit(&space, out->prepared, wanted, &cli->error);
  if (status == VXM_OK)
    status = vxm_model_create(&model, out->prepared, NULL, &cli->error);
  if (status == VXM_OK)
    status = given->has_colors ? make_colors(cli, out, given, model, &space)
                               : make_labels(cli, out, given, model, &space);
  vxm_model_destroy(model);
  return status;
}

static int voxelize(cli_run *cli, subject *out, request *given) {
  if (cli_threshold_given(&given->threshold))
    return cli_fail_text(
        cli, "%s: --threshold and --below are for files of numbers; of a mesh solid voxels are shown",
        given->input);
  if (read_mesh(cli, out, given) != CLI_DONE)
    return CLI_FAILED;
  guess_up(given);
  vxm_space_options space = VXM_SPACE_OPTIONS_INIT;
  space.resolution[0] = given->resolution ? given->resolution : RESOLUTION;
  vxm_status status = given->has_colors || given->has_labels
                          ? make_values(cli, out, given, &space)
                          : vxm_voxelize(&out->values.grid, NULL, out->prepared, &space, NULL, &cli->error);
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}

/** What a page takes (vxm_grid_page): voxels along a side, and bytes of all of them. */
enum { PAGE_SIDE = 2048, PAGE_BYTES = 1 << 27 };

/** An octree may be of more voxels than a page takes, or than there is memory for when they are read one by
 * one: its header tells. What is wrong with the file is told when it is read. */
static int check_page(cli_run *cli, const char *path) {
  vxm_sparse_file *file;
  vxm_error unread = VXM_ERROR_INIT;
  if (!cli_is_extension(path, "octree") || vxm_sparse_file_open(&file, cli->context, path, &unread) != VXM_OK)
    return CLI_DONE;
  const vxm_space space = *vxm_sparse_file_space(file);
  const int64_t *n = space.dims, most = PAGE_BYTES / (vxm_sparse_file_has_values(file) ? 2 : 1);
  vxm_sparse_file_close(file);
  for (int a = 0; a < 3; a++)
    if (n[a] > PAGE_SIDE)
      return cli_fail_text(
          cli, "%s: a browser takes up to %d voxels along an axis, not %" PRId64 " x %" PRId64 " x %" PRId64,
          path, PAGE_SIDE, n[0], n[1], n[2]);
  if (n[0] * n[1] * n[2] > most)
    return cli_fail_text(cli,
                         "%s: %" PRId64 " x %" PRId64 " x %" PRId64
                         " voxels are too many for a browser, which takes %" PRId64
                         " million of them; make them at a lower resolution, or a picture (.png)",
                         path, n[0], n[1], n[2], most / 1000000);
  return CLI_DONE;
}

/** Reads a grid or a mesh, as the name tells; where it does not tell, tries a grid first. */
static int read_input(cli_run *cli, subject *out, request *given) {
  static const char *const of_meshes[] = {"resolution", "color", "labels", NULL};
  const char *path = given->input, *of_mesh = cli_last_given(cli, of_meshes);
  if (is_named(path, cli_mesh_formats))
    return voxelize(cli, out, given);
  if (given->is_page && check_page(cli, path) != CLI_DONE)
    return CLI_FAILED;
  vxm_status status = cli_values_read(cli, &out->values, path);
  if (status == VXM_OK && of_mesh)
    return cli_fail_text(cli, "%s: --%s is for meshes; this has its voxels", cli_shown(path, "<stdin>"),
                         of_mesh);
  if (status == VXM_OK)
    return CLI_DONE;
  bool maybe_mesh = status == VXM_ERROR_FORMAT && strcmp(path, "-") != 0;
  if (maybe_mesh && !(vxm_grid_format_traits(vxm_grid_format_of(path)) & VXM_FORMAT_READ))
    return voxelize(cli, out, given);
  return cli_fail(cli);
}

static json_t *make_report(const cli_run *cli, const request *given, const cli_values *values) {
  json_t *report = json_object();
  json_object_set_new(report, "input", cli_json_text(given->input));
  json_object_set_new(report, "output", cli_json_text(given->output));
  json_object_set_new(report, "grid", cli_json_space(cli_values_space(values)));
  cli_values_json(report, values, false);
  json_object_set(report, "warnings", cli->warnings);
  return report;
}

static vxm_status write_page(cli_run *cli, const request *given, const subject *of) {
  bool is_given = cli_threshold_given(&given->threshold);
  const char *slash = strrchr(given->input, '/');
  vxm_page_options page = VXM_PAGE_OPTIONS_INIT;
  page.title = strcmp(given->input, "-") == 0 ? "standard input" : slash ? slash + 1 : given->input;
  page.mesh = of->mesh;
  page.repaired = of->repaired;
  page.up = given->picture.up;
  if (of->values.grid)
    return vxm_grid_page(of->values.grid, given->output, &page, &cli->error);
  return vxm_field_page(of->values.field, given->output, &page, is_given ? &given->threshold : NULL,
                        &cli->error);
}

/** Draws set voxels; numbers by the threshold where one is given, else in the way of their kind. */
static vxm_status draw(cli_run *cli, const request *given, const cli_values *values) {
  bool is_given = cli_threshold_given(&given->threshold);
  if (values->grid)
    return vxm_grid_picture(values->grid, given->output, &given->picture, &cli->error);
  return vxm_field_picture(values->field, given->output, &given->picture, is_given ? &given->threshold : NULL,
                           &cli->error);
}

static void slice_row(const cli_run *cli, const vxm_picture_options *picture, const vxm_space *space) {
  int axis = picture->slice_axis - 1;
  int64_t n = space->dims[axis], layer = (int64_t)(picture->slice * (double)n);
  cli_row(cli, "slice", "%c, voxel %" PRId64 " of 0 to %" PRId64, "xyz"[axis], layer < n ? layer : n - 1,
          n - 1);
}

static int make_output(cli_run *cli, const request *given, const subject *of) {
  const cli_values *values = &of->values;
  if ((given->is_page ? write_page(cli, given, of) : draw(cli, given, values)) != VXM_OK)
    return cli_fail(cli);
  cli_progress_clear(cli);
  if (cli_summary(cli)) {
    cli_row(cli, "input", "%s", cli_shown(given->input, "<stdin>"));
    cli_rows_space(cli, cli_values_space(values));
    cli_values_row(cli, values);
    const char *hint = given->up_hint;
    bool has_mesh = of->prepared || of->mesh;
    if (hint && given->picture.slice_axis == 0)
      cli_row(cli, "up", "%c, as usual for %s; --up changes it", "xyz"[given->picture.up - 1], hint);
    else if (!has_mesh && given->picture.up == 0 && given->picture.slice_axis == 0)
      cli_row(cli, "up", "z, as a grid does not tell; --up y where y is up in its model (.obj, .glb)");
    if (given->picture.slice_axis != 0)
      slice_row(cli, &given->picture, cli_values_space(values));
    cli_row(cli, "output", "%s", given->output);
  }
  return cli_finish(cli, make_report(cli, given, values));
}

static int run(cli_run *cli) {
  request given = {.colors = VXM_COLOR_OPTIONS_INIT,
                   .labels = VXM_LABEL_OPTIONS_INIT,
                   .picture = VXM_PICTURE_OPTIONS_INIT,
                   .threshold = VXM_THRESHOLD_OPTIONS_INIT};
  if (read_arguments(cli, &given) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  subject of = {{NULL, NULL}, NULL, NULL, NULL};
  int status = read_input(cli, &of, &given);
  if (status == CLI_DONE)
    status = make_output(cli, &given, &of);
  cli_values_free(&of.values);
  vxm_mesh_destroy(of.prepared);
  vxm_mesh_destroy(of.repaired);
  vxm_mesh_destroy(of.mesh);
  return status;
}

const cli_command cli_command_view = {
    .name = "view",
    .arguments = "GRID|MESH -o FILE.png|FILE.html [OPTION]...",
    .summary = "draw a picture of a grid or a mesh, or write a page that shows it",
    .notes =
        "A mesh is repaired and voxelized first. Standard input is read as a grid. Up is y in OBJ, glTF, "
        "FBX,\n"
        "X3D and COLLADA, else z, unless --up tells.\n\n"
        "A page is one file that needs no network: it is turned by mouse, touch and keys, cut along the "
        "axes,\n"
        "and switches labels; of a mesh it shows what is wrong with it, and what repair --level closed\n"
        "would change.\n\n"
        "A file of values is drawn by what they are: signed distances below 0, unsigned ones below half a\n"
        "voxel's diagonal; coverage from one half on; confidence below 255, where the solid was not proven;\n"
        "labels and colours in their colours. If the file does not tell, non-negative integers are labels,\n"
        "values on both sides of 0 are distances, values from 0 to 1 coverage. --threshold and --below\n"
        "choose others.\n\n"
        "Examples:\n"
        "  voxmend view chair.binvox -o chair.png\n"
        "  voxmend view chair.off -o chair.html -r 256\n"
        "  voxmend view bunny.obj -o bunny.png --up y --azimuth 120 --size 1200x900\n"
        "  voxmend view teapot.glb -o teapot.png --color mesh\n"
        "  voxmend view distance.nrrd -o inside.png --below -0.1\n"
        "  voxmend view distance.nrrd -o section.png --slice z=0.5",
    .options = known_options,
    .run = run,
};
