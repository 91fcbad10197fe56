/* SPDX-License-Identifier: BSD-3-Clause */
/** .ply: bits as the surface of what is set; colours as the faces between set and empty voxels. */
#include "base/endian.h"
#include "gridio/common/format.h"

#include <string.h>

/** Steps to the six neighbours, and the corners of the face toward each, running around to the left as seen
 * from there. */
static const int steps[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
static const int quads[6][4][3] = {
    {{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0}}, {{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}},
    {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}, {{0, 1, 0}, {0, 1, 1}, {1, 1, 1}, {1, 1, 0}},
    {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}}, {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

typedef void (*face_fn)(const vxm_field *c, const int64_t at[3], int side, void *payload);

static void for_faces(const vxm_field *c, face_fn function, void *payload) {
  const int64_t *dims = c->space.dims;
  const uint8_t *value = c->values;
  int64_t at[3];
  for (at[0] = 0; at[0] < dims[0]; at[0]++)
    for (at[1] = 0; at[1] < dims[1]; at[1]++)
      for (at[2] = 0; at[2] < dims[2]; at[2]++, value += 4)
        for (int s = 0; s < 6 && value[3]; s++) {
          const uint8_t *beside =
              vxm_field_color(c, at[0] + steps[s][0], at[1] + steps[s][1], at[2] + steps[s][2]);
          if (!beside || !beside[3])
            function(c, at, s, payload);
        }
}

static void count_face(const vxm_field *c, const int64_t at[3], int side, void *payload) {
  (void)c, (void)at, (void)side;
  ++*(int64_t *)payload;
}

static void put_face(const vxm_field *c, const int64_t at[3], int side, void *payload) {
  vxm_output *output = payload;
  const uint8_t *color = vxm_field_color(c, at[0], at[1], at[2]);
  for (int v = 0; v < 4; v++) {
    for (int a = 0; a < 3; a++) {
      float p = (float)(c->space.origin[a] + (double)(at[a] + quads[side][v][a]) * c->space.voxel_size[a]);
      uint32_t word;
      memcpy(&word, &p, sizeof word);
      word = vxm_le32(word);
      vxm_output_write(output, &word, sizeof word);
    }
    vxm_output_write(output, color, 3);
  }
}

static vxm_status write_ply(vxm_output *output, const vxm_field *c, vxm_error *error) {
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

static vxm_status write_field(const vxm_field *field, const char *path, vxm_error *error) {
  return vxm_field_write_file(field, path, write_ply, error);
}

const vxm_grid_format vxm_format_ply = {
    .name = "ply",
    .holds = VXM_HOLDS_BITS | VXM_HOLDS_COLORS,
    .write_field = write_field,
    .is_surface = true,
};
