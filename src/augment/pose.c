/* SPDX-License-Identifier: BSD-3-Clause */
#include "augment/pose.h"
#include "augment/random.h"

#include <math.h>
#include <string.h>

static vxm_random begin(const vxm_pose_rules *rules, const vxm_variant *variant, vxm_purpose purpose) {
  return vxm_random_begin(rules->options.seed,
                          (const uint32_t[3]){variant->model, variant->epoch, variant->index}, purpose);
}

static void draw_rotation(double m[9], const vxm_pose_rules *rules, const vxm_variant *variant) {
  static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const vxm_sampler_options *options = &rules->options;
  vxm_random draw = begin(rules, variant, VXM_DRAW_ROTATION);
  switch (options->rotation) {
  case VXM_ROTATION_ANY:
    vxm_random_rotation(m, &draw);
    break;
  case VXM_ROTATION_AXIS:
    vxm_random_turn(m, rules->axis, &draw);
    break;
  case VXM_ROTATION_LIST:
    memcpy(m, options->rotations + 9 * (size_t)(variant->index % (uint64_t)options->rotation_count),
           sizeof identity);
    break;
  default:
    memcpy(m, identity, sizeof identity);
  }
}

/** Factors along the model's axes; one is negative where the model is mirrored along it. */
static bool draw_scale(double scale[3], const vxm_pose_rules *rules, const vxm_variant *variant) {
  vxm_random stretch = begin(rules, variant, VXM_DRAW_SCALE), mirror = begin(rules, variant, VXM_DRAW_MIRROR);
  uint32_t flips = vxm_random_word(&mirror) & rules->options.mirror;
  bool mirrored = false;
  for (int a = 0; a < 3; a++) {
    bool flip = flips >> a & 1;
    scale[a] = (1 + rules->options.scale * vxm_random_signed(&stretch)) * (flip ? -1 : 1);
    mirrored ^= flip;
  }
  return mirrored;
}

double vxm_pose_room(const vxm_pose_rules *rules) {
  return 1 - 2 * (double)rules->options.pad / (double)rules->options.resolution - 2 * rules->reach;
}

/**
 * The factor by which the scaled box fits its room: its diagonal, so that every rotation does (Ogayar et al.,
 * section III-B); or its longest side.
 */
static double fit(const double scale[3], const vxm_pose_rules *rules, const vxm_model_extent *extent) {
  double longest = 0, squared = 0;
  for (int a = 0; a < 3; a++) {
    double side = fabs(scale[a]) * extent->side[a];
    longest = fmax(longest, side);
    squared += side * side;
  }
  return vxm_pose_room(rules) / (rules->options.fill ? longest : sqrt(squared));
}

void vxm_pose_draw(vxm_placement *out, const vxm_pose_rules *rules, const vxm_model_extent *extent,
                   const vxm_variant *variant) {
  draw_rotation(out->rotation, rules, variant);
  out->mirrored = draw_scale(out->scale, rules, variant);
  double factor = fit(out->scale, rules, extent), most = 0;
  for (int a = 0; a < 3; a++) {
    out->scale[a] *= factor;
    most = fmax(most, fabs(out->scale[a]));
  }
  out->stretch = most * 1.0625; /* a list may hold what is a rotation but for rounding */
  vxm_random translation = begin(rules, variant, VXM_DRAW_TRANSLATION);
  for (int row = 0; row < 3; row++) {
    double *m = out->matrix + (ptrdiff_t)4 * row, half = 0, moved = 0;
    for (int c = 0; c < 3; c++) {
      m[c] = out->rotation[3 * row + c] * out->scale[c];
      half += fabs(m[c]) * extent->side[c] / 2;
      moved += m[c] * extent->centre[c];
    }
    double free = fmax(0, 0.5 - rules->reach - half);
    out->shift[row] = rules->options.translate * free * vxm_random_signed(&translation);
    m[3] = 0.5 + out->shift[row] - moved;
  }
  vxm_random offset = begin(rules, variant, VXM_DRAW_OFFSET);
  out->offset = vxm_random_word(&offset);
}
