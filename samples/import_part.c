/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * What a CAD importer does with a mesh: read it at a tolerance, repair it to a level, look at what each part
 * went through, voxelize it and hand the arrays over; with progress, and a time limit.
 *
 *   import_part MESH [RESOLUTION [WELD [SECONDS]]]
 */
#include <voxmend.h>

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/** The importer's own types: what it keeps when the library's objects are gone. */
typedef struct imported {
  int64_t vertex_count, triangle_count;
  float *vertices;     /* x y z */
  uint32_t *triangles; /* a b c */
  int64_t dims[3];
  uint8_t *voxels; /* [x][y][z], a byte each */
} imported;

static void imported_free(imported *out) {
  free(out->voxels);
  free(out->triangles);
  free(out->vertices);
}

/** What the callback looks at. */
typedef struct listener {
  time_t start;
  double seconds; /* below 0 = no limit */
  char shown[32];
} listener;

/** Where an importer would move its bar, and look at its button: what is not 0 cancels the call. */
static int tell(const char *phase, double fraction, void *payload) {
  listener *self = payload;
  double passed = difftime(time(NULL), self->start);
  if (passed >= 1 && fraction > 0 && strcmp(self->shown, phase) != 0) {
    snprintf(self->shown, sizeof self->shown, "%s", phase);
    fprintf(stderr, "%s ...\n", phase);
  }
  return self->seconds >= 0 && passed >= self->seconds;
}

/** Goes as far as it can: down from closed, so that what comes in is known to be at least that good. */
static vxm_status repair(vxm_mesh **out, vxm_level *reached, const vxm_mesh *raw, double weld,
                         vxm_error *error) {
  static const char *const names[] = {"clean", "manifold", "closed", "solid"};
  for (int level = VXM_LEVEL_CLOSED; level >= VXM_LEVEL_CLEAN; level--) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    vxm_verification found = VXM_VERIFICATION_INIT;
    options.level = (vxm_level)level;
    options.weld = weld > 0 ? VXM_WELD_TOLERANCE : VXM_WELD_AUTO;
    options.weld_tolerance = weld; /* vertices that are no farther apart are one */
    options.part_changes = true;
    options.sheets = VXM_SHEETS_KEEP; /* the part as it was drawn: what is open is not to become a plate */
    options.max_change = 0.05;        /* a repair that inflates a part by more is none */
    vxm_status status = vxm_mesh_repair(out, NULL, raw, &options, error);
    if (status == VXM_OK)
      status = vxm_mesh_verify(&found, *out, &options, error);
    if (status == VXM_OK && found.reached) {
      *reached = (vxm_level)level;
      return VXM_OK;
    }
    if (status == VXM_OK)
      printf("not %s: %" PRId64 " %s\n", names[level], found.findings[0].count, found.findings[0].what);
    else if (status != VXM_ERROR_UNAVAILABLE && status != VXM_ERROR_UNREACHED)
      return status; /* nothing that a lower level would mend */
    else
      printf("not %s: %s\n", names[level], error->text);
    vxm_mesh_destroy(*out);
    *out = NULL;
  }
  return VXM_ERROR_UNREACHED;
}

static void show_parts(const vxm_mesh *mesh) {
  for (int64_t i = 0; i < vxm_mesh_part_change_count(mesh); i++) {
    const vxm_part_change *part = vxm_mesh_part_change(mesh, i);
    const char *name = part->tag == UINT32_MAX ? "unnamed" : vxm_mesh_tag_name(mesh, part->tag);
    printf("part %" PRId64 " (%s): %" PRId64 " faces, %" PRId64 " after; volume %.6g, %.6g after\n", i, name,
           part->before->faces, part->after->faces, part->before->volume, part->after->volume);
  }
}

/** Copies the mesh into the importer's arrays; polygons become fans, which is enough for convex ones. */
static int copy_mesh(imported *out, const vxm_mesh *mesh) {
  const uint64_t *offsets = vxm_mesh_offsets(mesh);
  const uint32_t *indices = vxm_mesh_indices(mesh);
  int64_t faces = vxm_mesh_face_count(mesh);
  out->vertex_count = vxm_mesh_vertex_count(mesh);
  for (int64_t f = 0; f < faces; f++)
    out->triangle_count += (int64_t)(offsets[f + 1] - offsets[f]) - 2;
  out->vertices = malloc((size_t)out->vertex_count * 3 * sizeof *out->vertices);
  out->triangles = malloc((size_t)out->triangle_count * 3 * sizeof *out->triangles);
  if (!out->vertices || !out->triangles)
    return 0;
  for (int64_t i = 0; i < 3 * out->vertex_count; i++)
    out->vertices[i] = (float)vxm_mesh_vertices(mesh)[i];
  uint32_t *next = out->triangles;
  for (int64_t f = 0; f < faces; f++)
    for (uint64_t c = offsets[f] + 2; c < offsets[f + 1]; c++) {
      *next++ = indices[offsets[f]];
      *next++ = indices[c - 1];
      *next++ = indices[c];
    }
  return 1;
}

static vxm_status copy_voxels(imported *out, const vxm_mesh *mesh, int64_t resolution, vxm_error *error) {
  vxm_grid *grid;
  vxm_space_options space = VXM_SPACE_OPTIONS_INIT;
  space.resolution[0] = resolution;
  vxm_status status = vxm_voxelize(&grid, NULL, mesh, &space, NULL, error);
  if (status != VXM_OK)
    return status;
  size_t count = 1;
  for (int a = 0; a < 3; a++) {
    out->dims[a] = vxm_grid_space(grid)->dims[a];
    count *= (size_t)out->dims[a];
  }
  out->voxels = malloc(count);
  if (out->voxels)
    vxm_grid_unpack(grid, out->voxels);
  vxm_grid_destroy(grid);
  return out->voxels ? VXM_OK : VXM_ERROR_MEMORY;
}

int main(int argc, char **argv) {
  if (argc < 2 || argc > 5) {
    fprintf(stderr, "usage: import_part MESH [RESOLUTION [WELD [SECONDS]]]\n");
    return 2;
  }
  static const char *const names[] = {"clean", "manifold", "closed", "solid"};
  int64_t resolution = argc > 2 ? atoi(argv[2]) : 64;
  double weld = argc > 3 ? atof(argv[3]) : 0;
  listener heard = {time(NULL), argc > 4 ? atof(argv[4]) : -1, ""};
  vxm_context_options how = VXM_CONTEXT_OPTIONS_INIT;
  how.progress = tell;
  how.payload = &heard;
  vxm_mesh_read_options reading = VXM_MESH_READ_OPTIONS_INIT;
  reading.deflection = 0.0005; /* STEP and IGES: of the diagonal */
  vxm_error error = VXM_ERROR_INIT;
  vxm_context *context = NULL;
  vxm_mesh *raw = NULL, *mesh = NULL;
  vxm_level level = VXM_LEVEL_CLEAN;
  imported made = {0};
  vxm_status status = vxm_context_create(&context, &how, &error);
  if (status == VXM_OK)
    status = vxm_mesh_read_with(&raw, context, argv[1], &reading, &error);
  if (status == VXM_OK)
    status = repair(&mesh, &level, raw, weld, &error);
  if (status == VXM_OK) {
    printf("the mesh is %s\n", names[level]);
    show_parts(mesh);
    status = copy_mesh(&made, mesh) ? copy_voxels(&made, mesh, resolution, &error) : VXM_ERROR_MEMORY;
  }
  vxm_mesh_destroy(mesh); /* the importer's arrays do not depend on these */
  vxm_mesh_destroy(raw);
  vxm_context_destroy(context);
  if (status == VXM_OK) {
    size_t set = 0, count = (size_t)made.dims[0] * (size_t)made.dims[1] * (size_t)made.dims[2];
    for (size_t i = 0; i < count; i++)
      set += made.voxels[i];
    printf("handed over: %" PRId64 " vertices, %" PRId64 " triangles, %zu of %zu voxels\n", made.vertex_count,
           made.triangle_count, set, count);
  } else
    fprintf(stderr, "import_part: %s\n", error.text[0] ? error.text : vxm_status_name(status));
  imported_free(&made);
  return status == VXM_OK ? 0 : status == VXM_ERROR_CANCELLED ? 3 : 1;
}
