/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * accuracy [-r N] [--method LIST] [--markdown FILE] [MESH...]: damages closed meshes in known ways, voxelizes
 * them and says how right each method is and how long it takes. Without MESH it takes the shared meshes
 * ($SRCDIR/../shared/meshes) or, where they are missing, its own bodies.
 */
#include "report.h"

#include <stdlib.h>
#include <string.h>

static const char *const shared_meshes[] = {
    "classic/booleans-bunny50k.obj", "classic/cgal-armadillo.off",      "classic/cgal-camel.off",
    "classic/common3d-cow.obj",      "classic/libigl-elephant.obj",     "classic/libigl-fertility.off",
    "classic/common3d-homer.obj",    "classic/cgal-bull.off",           "classic/gel-octopus.obj",
    "classic/cgal-bear.off",         "paper/karimvoxelizer-dragon.obj", "cad/cgal-rotor_small.off",
    "cad/cgal-pinion.off",           "cad/numpystl-rear_case.stl"};
enum { SHARED_COUNT = sizeof shared_meshes / sizeof shared_meshes[0], MESHES_MAX = 256, PATH_ROOM = 1024 };

typedef struct arguments {
  int64_t resolution;
  bool wanted[METHOD_COUNT];
  const char *markdown;
  int mesh_count;
  char **meshes;
} arguments;

static _Noreturn void usage(void) {
  fprintf(stderr, "usage: accuracy [-r N] [--method auto,majority,x,winding] [--markdown FILE] [MESH...]\n");
  exit(2);
}

static void choose_methods(bool wanted[METHOD_COUNT], char *list) {
  memset(wanted, 0, METHOD_COUNT * sizeof *wanted);
  for (char *key = strtok(list, ","); key; key = strtok(NULL, ",")) {
    int by = 0;
    while (by < METHOD_COUNT && strcmp(key, method_keys[by]) != 0)
      by++;
    if (by == METHOD_COUNT)
      usage();
    wanted[by] = true;
  }
}

static arguments parse(int count, char **words) {
  arguments parsed = {.resolution = 128, .wanted = {true, true, true, true}};
  int i = 1;
  for (; i + 1 < count && words[i][0] == '-'; i += 2) {
    if (strcmp(words[i], "-r") == 0)
      parsed.resolution = strtol(words[i + 1], NULL, 10);
    else if (strcmp(words[i], "--method") == 0)
      choose_methods(parsed.wanted, words[i + 1]);
    else if (strcmp(words[i], "--markdown") == 0)
      parsed.markdown = words[i + 1];
    else
      usage();
  }
  if ((i < count && words[i][0] == '-') || parsed.resolution < 8 || parsed.resolution > 1024 ||
      count - i > MESHES_MAX)
    usage();
  parsed.mesh_count = count - i;
  parsed.meshes = words + i;
  return parsed;
}

/* ---- Bodies to damage ---- */

typedef struct bodies {
  shape shapes[MESHES_MAX];
  char *names[MESHES_MAX];
  size_t triangles[MESHES_MAX];
  size_t count;
} bodies;

static void add_body(bodies *to, shape body, const char *name) {
  const char *slash = strrchr(name, '/');
  to->shapes[to->count] = body;
  to->triangles[to->count] = body.face_count;
  to->names[to->count] = strdup(slash ? slash + 1 : name);
  if (!to->names[to->count])
    exit(1);
  char *dot = strrchr(to->names[to->count], '.');
  if (dot)
    *dot = 0;
  to->count++;
}

/** Reads a mesh, repairs it, and takes it if it is closed. */
static void add_file(bodies *to, vxm_context *context, const char *path) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_mesh *raw, *mesh;
  vxm_census census = VXM_CENSUS_INIT;
  require(vxm_mesh_read(&raw, context, path, &error), &error);
  require(vxm_mesh_repair(&mesh, NULL, raw, NULL, &error), &error);
  require(vxm_mesh_census(&census, mesh, &error), &error);
  if (census.watertight)
    add_body(to, shape_of_mesh(mesh), path);
  else
    fprintf(stderr, "accuracy: %s is not closed; left out\n", path);
  vxm_mesh_destroy(raw);
  vxm_mesh_destroy(mesh);
}

static void add_shared(bodies *to, vxm_context *context) {
  const char *source = getenv("SRCDIR");
  for (int i = 0; i < SHARED_COUNT; i++) {
    char path[PATH_ROOM];
    snprintf(path, sizeof path, "%s/../shared/meshes/%s", source ? source : ".", shared_meshes[i]);
    FILE *file = fopen(path, "r");
    if (!file)
      continue;
    fclose(file);
    add_file(to, context, path);
  }
}

static void find_bodies(bodies *to, vxm_context *context, const arguments *parsed) {
  for (int i = 0; i < parsed->mesh_count; i++)
    add_file(to, context, parsed->meshes[i]);
  if (parsed->mesh_count == 0)
    add_shared(to, context);
  for (int i = 0; i < BODY_COUNT && parsed->mesh_count == 0 && to->count < BODY_COUNT; i++)
    add_body(to, body_make(i), body_names[i]);
}

/* ---- The survey ---- */

static void survey_body(answer *answers, const shape *body, uint64_t seed, vxm_context *context,
                        const arguments *parsed) {
  for (int kind = 0; kind < DAMAGE_COUNT; kind++) {
    question q;
    if (!question_make(&q, context, body, (damage)kind, parsed->resolution, seed))
      continue;
    measure(&answers[kind], &q, parsed->wanted, true);
    question_free(&q);
  }
}

int main(int count, char **words) {
  static bodies found;
  arguments parsed = parse(count, words);
  vxm_context *context;
  vxm_error error = VXM_ERROR_INIT;
  require(vxm_context_create(&context, NULL, &error), &error);
  find_bodies(&found, context, &parsed);
  survey all = {.names = found.names,
                .triangles = found.triangles,
                .mesh_count = found.count,
                .resolution = parsed.resolution};
  all.threads = vxm_context_threads(context);
  all.answers = calloc(found.count * DAMAGE_COUNT + 1, sizeof *all.answers);
  if (!all.answers)
    return 1;
  for (size_t m = 0; m < found.count; m++) {
    fprintf(stderr, "%s\n", found.names[m]);
    survey_body(all.answers + m * DAMAGE_COUNT, &found.shapes[m], m + 1, context, &parsed);
    shape_free(&found.shapes[m]);
  }
  report_setting(stdout, &all);
  printf("\n");
  report_iou(stdout, &all);
  printf("\n");
  report_times(stdout, &all);
  printf("\n");
  report_bounds(stdout, &all);
  bool written = !parsed.markdown || report_markdown(parsed.markdown, &all);
  if (!written)
    fprintf(stderr, "accuracy: cannot put the tables into %s\n", parsed.markdown);
  for (size_t m = 0; m < found.count; m++)
    free(found.names[m]);
  free(all.answers);
  vxm_context_destroy(context);
  return written ? 0 : 1;
}
