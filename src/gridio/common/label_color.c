/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/label_color.h"

#include <math.h>

/** A hue from 0 to 1, of some saturation and brightness. */
static void color_of_hue(double rgb[3], double hue, double saturation, double brightness) {
  for (int n = 0; n < 3; n++) {
    double at = fmod(hue * 6 + (n == 0 ? 5 : n == 1 ? 3 : 1), 6);
    rgb[n] = brightness * (1 - saturation * fmax(0, fmin(fmin(at, 4 - at), 1)));
  }
}

void vxm_label_color(double rgb[3], double label) {
  const double golden = 0.61803398874989485;
  double whole = isfinite(label) ? label : 0, hue = fmod((whole - 1) * golden, 1), pale = fmod(whole, 2);
  color_of_hue(rgb, hue < 0 ? hue + 1 : hue, pale == 0 ? 0.45 : 0.7, pale == 0 ? 0.75 : 0.9);
}

void vxm_label_color_bytes(uint8_t rgb[3], double label) {
  double color[3];
  vxm_label_color(color, label);
  for (int n = 0; n < 3; n++)
    rgb[n] = (uint8_t)lround(255 * color[n]);
}
