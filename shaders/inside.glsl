/* SPDX-License-Identifier: BSD-3-Clause */
/* Whether the centre of a fragment lies in a triangle of a cross-section. A side has one value for both of its
   triangles, as its ends are taken in one order; should that be 0, the order of the axes decides. */
layout(std140, binding = 0) uniform Job {
  ivec4 axes, view;
  uvec4 random;
  vec4 amount;
} job;
flat in uvec4 point_a, point_b, point_c;

bool is_left(dvec2 from, dvec2 to, dvec2 p) {
  bool turn = to.x < from.x || (to.x == from.x && to.y < from.y);
  dvec2 a = turn ? to : from, b = turn ? from : to;
  precise dvec2 d = b - a, q = p - a;
  precise double left = d.x * q.y, right = d.y * q.x;
  bool on = job.axes.x < job.axes.y ? (d.y != 0.0LF ? d.y < 0.0LF : d.x > 0.0LF)
                                    : (d.x != 0.0LF ? d.x > 0.0LF : d.y < 0.0LF);
  return (left > right || (left == right && on)) != turn;
}

bool is_inside() {
  dvec2 a = dvec2(packDouble2x32(point_a.xy), packDouble2x32(point_a.zw));
  dvec2 b = dvec2(packDouble2x32(point_b.xy), packDouble2x32(point_b.zw));
  dvec2 c = dvec2(packDouble2x32(point_c.xy), packDouble2x32(point_c.zw));
  dvec2 p = dvec2(floor(gl_FragCoord.xy)) + dvec2(job.view.xy) + 0.5LF + dvec2(nudge(job.axes.x), nudge(job.axes.y));
  bool ab = is_left(a, b, p), bc = is_left(b, c, p), ca = is_left(c, a, p);
  return ab == bc && bc == ca;
}
