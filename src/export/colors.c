/* SPDX-License-Identifier: BSD-3-Clause */
#include "export/colors.h"
#include "base/clock.h"
#include "base/endian.h"
#include "gridio/common/format.h"
#include "gridio/formats/npy_header.h"
#include "voxel/labels/mesh_colors.h"

#include <string.h>

/* ---- .npy ---- */

static vxm_status write_npy(vxm_output *output, const vxm_colored *c, vxm_error *error) {
  vxm_status status = vxm_output_expect(output, vxm_space_voxels(c->space) * 4, error);
  if (status != VXM_OK)
    return status;
  const int64_t *dims = c->space->dims;
  vxm_npy_header_write_bytes(output, dims, 4);
  vxm_output_write(output, c->values, 4 * (size_t)(dims[0] * dims[1] * dims[2]));
  return VXM_OK;
}

/* ---- .ply: the faces between set and empty voxels ---- */

/** Steps to the six neighbours, and the corners of the face toward each, running around to the left as seen
 * from there. */
static const int steps[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
static const int quads[6][4][3] = {
    {{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0}}, {{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}},
    {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}, {{0, 1, 0}, {0, 1, 1}, {1, 1, 1}, {1, 1, 0}},
    {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}}, {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

typedef void (*face_fn)(const vxm_colored *c, const int64_t at[3], int side, void *payload);

static void for_faces(const vxm_colored *c, face_fn function, void *payload) {
  const int64_t *dims = c->space->dims;
  const uint8_t *value = c->values;
  int64_t at[3];
  for (at[0] = 0; at[0] < dims[0]; at[0]++)
    for (at[1] = 0; at[1] < dims[1]; at[1]++)
      for (at[2] = 0; at[2] < dims[2]; at[2]++, value += 4)
        for (int s = 0; s < 6 && value[3]; s++) {
          const uint8_t *beside =
              vxm_colored_at(c, at[0] + steps[s][0], at[1] + steps[s][1], at[2] + steps[s][2]);
          if (!beside || !beside[3])
            function(c, at, s, payload);
        }
}

static void count_face(const vxm_colored *c, const int64_t at[3], int side, void *payload) {
  (void)c, (void)at, (void)side;
  ++*(int64_t *)payload;
}

static void put_face(const vxm_colored *c, const int64_t at[3], int side, void *payload) {
  vxm_output *output = payload;
  const uint8_t *color = vxm_colored_at(c, at[0], at[1], at[2]);
  for (int v = 0; v < 4; v++) {
    for (int a = 0; a < 3; a++) {
      float p = (float)(c->space->origin[a] + (double)(at[a] + quads[side][v][a]) * c->space->voxel_size[a]);
      uint32_t word;
      memcpy(&word, &p, sizeof word);
      word = vxm_le32(word);
      vxm_output_write(output, &word, sizeof word);
    }
    vxm_output_write(output, color, 3);
  }
}

static vxm_status write_ply(vxm_output *output, const vxm_colored *c, vxm_error *error) {
  int64_t faces = 0;
  for_faces(c, count_face, &faces);
  if (faces > INT32_MAX / 4)
    return vxm_fail(error, VXM_ERROR_RANGE, ".ply holds fewer than 2^31 corners of faces; use .npy");
  vxm_status status = vxm_output_expect(output, (uint64_t)faces * (4 * 15 + 17), error);
  if (status != VXM_OK)
    return status;
  vxm_output_printf(
      output,
      "ply\nformat binary_little_endian 1.0\ncomment voxmend: voxels in colour\nelement vertex %lld\n"
      "property float x\nproperty float y\nproperty float z\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nelement face %lld\n"
      "property list uchar int vertex_indices\nend_header\n",
      (long long)(4 * faces), (long long)faces);
  for_faces(c, put_face, output);
  for (int64_t f = 0; f < faces; f++) {
    const uint8_t count = 4;
    vxm_output_write(output, &count, 1);
    for (int64_t v = 0; v < 4; v++) {
      uint32_t word = vxm_le32((uint32_t)(4 * f + v));
      vxm_output_write(output, &word, sizeof word);
    }
  }
  return VXM_OK;
}

/* ---- All formats ---- */

typedef struct kind {
  const char *name;
  vxm_status (*write)(vxm_output *output, const vxm_colored *colored, vxm_error *error);
  bool has_sidecar;
} kind;

static const kind kinds[] = {
    {"npy", write_npy, true}, {"ply", write_ply, false}, {"vox", vxm_vox_write, false}};

static const kind *find_kind(const char *path, const char *format, vxm_error *error) {
  const char *name = format ? format : vxm_path_extension(path);
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
    if (vxm_text_equal_nocase(name, kinds[k].name))
      return &kinds[k];
  vxm_fail_at(error, VXM_ERROR_ARGUMENT, (vxm_place){path, 0, -1, -1},
              "colours go into .npy, .ply or .vox, not \"%s\"", name);
  return NULL;
}

static vxm_status write_file(const vxm_colored *colored, const vxm_about *about, const kind *k,
                             const char *path, vxm_error *error) {
  static const vxm_sidecar_text text = {"voxmend colors", "z fastest, then y, then x", NULL};
  vxm_output *output = NULL, *sidecar = NULL;
  vxm_status status = vxm_output_open(&output, colored->context, path, error);
  if (status != VXM_OK)
    return status;
  status = k->write(output, colored, error);
  if (status == VXM_OK && k->has_sidecar)
    status = vxm_sidecar_open(&sidecar, colored->context, colored->space, path, &text, about, error);
  if (status == VXM_OK)
    return vxm_output_commit_both(output, sidecar, error);
  vxm_output_abort(output);
  return status;
}

vxm_status vxm_colors_write(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                            const char *path, const vxm_color_options *options, vxm_error *error) {
  const vxm_about about = {.is_declared = true, .kind = VXM_FIELD_COLORS};
  double start = vxm_clock_ms();
  vxm_error local = VXM_ERROR_INIT;
  const kind *k = find_kind(path, options->format, error);
  if (!k)
    return VXM_ERROR_ARGUMENT;
  /* The values, the grid and, where they are wanted, the parts. */
  uint64_t voxels = (uint64_t)space->dims[0] * (uint64_t)space->dims[1] * (uint64_t)space->dims[2];
  uint64_t bytes = voxels > UINT64_MAX / 8 ? UINT64_MAX : voxels * (vxm_color_wants_parts(options) ? 6 : 4);
  if (options->by == VXM_COLOR_MESH)
    bytes += vxm_mesh_colors_bytes(options->mesh, space, options->average);
  vxm_status status = vxm_memory_check(model->context, bytes, "a colour per voxel", error);
  if (status != VXM_OK)
    return status;
  uint8_t *values = vxm_alloc(model->context, (size_t)voxels, 4, &local);
  status = values ? vxm_colors_run(values, report, model, space, options, &local) : local.code;
  report->fill_ms = vxm_clock_ms() - start;
  if (status == VXM_OK)
    status = write_file(&(vxm_colored){model->context, space, values}, &about, k, path, &local);
  report->write_ms = vxm_clock_ms() - start - report->fill_ms;
  vxm_free(model->context, values);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_colored_write(const vxm_colored *colored, const vxm_about *about, const char *path,
                             const char *format, vxm_error *error) {
  const kind *k = find_kind(path, format, error);
  return k ? write_file(colored, about, k, path, error) : VXM_ERROR_ARGUMENT;
}
