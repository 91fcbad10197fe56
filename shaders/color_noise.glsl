/* SPDX-License-Identifier: BSD-3-Clause */
vec3 color(vec3 position, vec3 unit, uint part) {
  float sum = 0.0, size = 0.5;
  vec3 p = unit * 8.0;
  for (int octave = 0; octave < 4; octave++, p *= 2.0, size *= 0.5)
    sum += size * noise(p);
  return mix(vec3(0.12, 0.28, 0.50), vec3(0.97, 0.90, 0.72), clamp(0.5 + sum, 0.0, 1.0));
}
