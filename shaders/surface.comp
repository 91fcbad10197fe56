/* SPDX-License-Identifier: BSD-3-Clause */
/* One triangle for each invocation: a few columns are done at once, triangles with more are listed to be drawn. */
layout(local_size_x = 64) in;

layout(std430, binding = 4) buffer Large {
  uint vertices, instances, first_vertex, first_instance;
  uint triangle[];
} large;

void main() {
  uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  ivec3 corner[3];
  if (i >= job.triangles.x || !load_triangle(i, corner))
    return;
  Triangle t = triangle_of(corner);
  if (any(greaterThanEqual(t.begin, t.end)))
    return;
  ivec2 begin = ivec2(t.begin[t.u], t.begin[t.v]), end = ivec2(t.end[t.u], t.end[t.v]);
  if (float(end.x - begin.x) * float(end.y - begin.y) > float(job.triangles.y)) {
    large.triangle[atomicAdd(large.vertices, 1u)] = i;
    return;
  }
  for (int v = begin.y; v < end.y; v++)
    for (int u = begin.x; u < end.x; u++)
      set_column(t, ivec2(u, v));
}
