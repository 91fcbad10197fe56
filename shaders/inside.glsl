/* SPDX-License-Identifier: BSD-3-Clause */
/* Whether the centre of a fragment lies in a triangle of a cross-section: whether a ray crosses an odd number of its
   sides. A side is crossed or not for both of its triangles alike, as its ends are taken in one order; so what is
   rounded can matter within rounding of a side only, also where a triangle is all but a line. */
layout(std140, binding = 0) uniform Job {
  ivec4 axes, view;
  uvec4 random;
  vec4 amount;
} job;
flat in uvec4 point_a, point_b, point_c;

/* Whether the ray from p toward smaller u crosses a side. */
bool crosses(dvec2 from, dvec2 to, dvec2 p) {
  if ((from.y > p.y) == (to.y > p.y))
    return false;
  dvec2 a = from.y < to.y ? from : to, b = from.y < to.y ? to : from;
  precise dvec2 d = b - a, q = p - a;
  precise double left = d.y * q.x, right = d.x * q.y;
  return left > right;
}

bool is_inside() {
  dvec2 a = dvec2(packDouble2x32(point_a.xy), packDouble2x32(point_a.zw));
  dvec2 b = dvec2(packDouble2x32(point_b.xy), packDouble2x32(point_b.zw));
  dvec2 c = dvec2(packDouble2x32(point_c.xy), packDouble2x32(point_c.zw));
  dvec2 p = dvec2(floor(gl_FragCoord.xy)) + dvec2(job.view.xy) + 0.5LF + dvec2(nudge(job.axes.x), nudge(job.axes.y));
  return crosses(a, b, p) != (crosses(b, c, p) != crosses(c, a, p));
}
