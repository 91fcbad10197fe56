/* SPDX-License-Identifier: BSD-3-Clause */
vec3 color(vec3 position, vec3 unit, uint part) {
  return unit;
}
