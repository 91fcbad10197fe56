/* SPDX-License-Identifier: BSD-3-Clause */
/* A column for each fragment: whether the triangle covers it is told exactly, not by the rasterizer. */
flat in ivec3 corner_a, corner_b, corner_c;

void main() {
  ivec3 corner[3] = ivec3[3](corner_a, corner_b, corner_c);
  ivec2 column = ivec2(gl_FragCoord.xy) + job.view.xy;
  Triangle t;
  if (any(lessThan(column, job.first.xy)) || any(greaterThanEqual(column, job.last.xy)) || !make_triangle(corner, t))
    return;
  flip_column(t, column);
}
