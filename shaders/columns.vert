/* SPDX-License-Identifier: BSD-3-Clause */
/* Pulls the triangles that columns.comp listed, and draws each a little larger than it is. */
layout(std430, binding = 4) readonly buffer Large {
  uint vertices, instances, first_vertex, first_instance;
  uint triangle[];
} large;

flat out ivec3 corner_a, corner_b, corner_c;

void main() {
  ivec3 corner[3];
  load_triangle(large.triangle[gl_VertexID / 3], corner);
  corner_a = corner[0];
  corner_b = corner[1];
  corner_c = corner[2];
  vec2 p[3];
  float unit = float(1 << job.axes.w);
  for (int c = 0; c < 3; c++)
    p[c] = (vec2(corner[c].xy - corner[0].xy)) / unit;
  vec2 origin = vec2(corner[0].xy - job.view.xy * (1 << job.axes.w)) / unit;
  vec2 at = origin + cover_corner(p, gl_VertexID % 3, 0.0625);
  gl_Position = vec4(2.0 * at / vec2(job.view.zw) - 1.0, 0.0, 1.0);
}
