/* SPDX-License-Identifier: BSD-3-Clause */
/* One triangle for each invocation: a few columns are done at once, triangles with more are listed to be drawn. */
layout(local_size_x = 64) in;

layout(std430, binding = 4) buffer Large {
  uint vertices, instances, first_vertex, first_instance; // of the indirect draw
  uint triangle[];
} large;

void main() {
  uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  ivec3 corner[3];
  Triangle t;
  ivec2 begin, end;
  if (i >= job.triangles.y)
    return;
  uint triangle = triangle_number(i);
  if (!load_triangle(triangle, corner) || !make_triangle(corner, t) || !columns_of(t, begin, end))
    return;
  ivec2 size = end - begin;
  if (float(size.x) * float(size.y) > float(job.triangles.w)) {
    large.triangle[atomicAdd(large.vertices, 3u) / 3u] = triangle;
    return;
  }
  for (int v = begin.y; v < end.y; v++)
    for (int u = begin.x; u < end.x; u++)
      flip_column(t, ivec2(u, v));
}
