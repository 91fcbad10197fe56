/* SPDX-License-Identifier: BSD-3-Clause */
/* The self-test: a triangle that covers the viewport, then one that covers its left half. */
layout(location = 0) uniform uint is_half;

void main() {
  vec2 at = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  if (is_half != 0u)
    at = vec2(gl_VertexID == 1 ? 0.0 : gl_VertexID == 2 ? 0.0 : -4.0, gl_VertexID == 1 ? -5.0 : gl_VertexID == 2 ? 5.0 : 0.0);
  gl_Position = vec4(at, 0.0, 1.0);
}
