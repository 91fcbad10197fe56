/* SPDX-License-Identifier: BSD-3-Clause */
/* Where the corners of tetrahedra are, for vertex shaders: behind section.glsl. */
layout(std430, binding = 0) readonly buffer Points {
  ivec4 at[];
} points;
layout(std430, binding = 1) readonly buffer Corners {
  uint corner[];
} corners;
layout(std430, binding = 2) readonly buffer Random {
  float value[]; // -1 to 1
} random;
layout(std430, binding = 3) readonly buffer Apexes {
  uint apex[]; // of each triangle
} apexes;
layout(std430, binding = 4) readonly buffer List {
  uint triangle[]; // of each slice
} list;
layout(location = 0) uniform uint list_begin;

/* A point along u, v, w in voxels, moved at random if that is asked for. Each point has its place in the circular
   buffer, so that all tetrahedra move it alike. */
vec3 place(uint number) {
  ivec4 p = points.at[number];
  vec3 at = vec3(p[job.axes.x], p[job.axes.y], p[job.axes.z]) / float(1 << job.axes.w);
  if (job.amount.x > 0.0) {
    uint first = (job.random.y + 3u * number) % job.random.x;
    vec3 move = vec3(random.value[first], random.value[(first + 1u) % job.random.x],
                     random.value[(first + 2u) % job.random.x]);
    at += job.amount.x * vec3(move[job.axes.x], move[job.axes.y], move[job.axes.z]);
  }
  return at;
}

/* The apex of a triangle's part. Any point will do; this one is a little off the middle, as in symmetric bodies the
   middle may be the centre of a voxel, where all tetrahedra meet. */
vec3 place_apex(uint triangle) {
  return place(apexes.apex[triangle]) + vec3(0.0137, 0.0271, 0.0314);
}
