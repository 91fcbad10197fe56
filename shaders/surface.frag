/* SPDX-License-Identifier: BSD-3-Clause */
/* A column of voxels for each fragment; the tests are exact, whatever the rasterizer rounded. */
flat in ivec3 corner_a, corner_b, corner_c;

void main() {
  ivec3 corner[3] = ivec3[3](corner_a, corner_b, corner_c);
  Triangle t = triangle_of(corner);
  ivec2 column = ivec2(gl_FragCoord.xy) + job.view.xy;
  ivec2 begin = ivec2(t.begin[t.u], t.begin[t.v]), end = ivec2(t.end[t.u], t.end[t.v]);
  if (all(greaterThanEqual(column, begin)) && all(lessThan(column, end)))
    set_column(t, column);
}
