/* SPDX-License-Identifier: BSD-3-Clause */
/* Hues a golden section apart. */
vec3 color(vec3 position, vec3 unit, uint part) {
  float hue = fract(float(part) * 0.61803398875) * 6.0;
  return 0.25 + 0.75 * clamp(vec3(abs(hue - 3.0) - 1.0, 2.0 - abs(hue - 2.0), 2.0 - abs(hue - 4.0)), 0.0, 1.0);
}
