/* SPDX-License-Identifier: BSD-3-Clause */
/* Dilates a triangle, seen along the axis that its normal leans to, by half the diagonal of a pixel and a little
   more: every pixel that it touches has its centre inside. */
layout(points) in;
layout(triangle_strip, max_vertices = 3) out;
flat in uint triangle[];
flat out ivec3 corner_a, corner_b, corner_c;

void main() {
  ivec3 corner[3];
  load_triangle(triangle[0], corner);
  Triangle t = triangle_of(corner);
  float unit = float(1 << job.first.w);
  vec2 p[3];
  for (int c = 0; c < 3; c++) {
    ivec3 d = corner[c] - corner[0];
    p[c] = vec2(d[t.u], d[t.v]) / unit;
  }
  vec2 origin = vec2(corner[0][t.u], corner[0][t.v]) / unit - vec2(job.view.xy);
  for (int i = 0; i < 3; i++) {
    corner_a = corner[0];
    corner_b = corner[1];
    corner_c = corner[2];
    gl_Position = vec4(2.0 * (origin + cover_corner(p, i, 0.75)) / vec2(job.view.zw) - 1.0, 0.0, 1.0);
    EmitVertex();
  }
  EndPrimitive();
}
