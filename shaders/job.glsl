/* SPDX-License-Identifier: BSD-3-Clause */
/* What one pass over the triangles works on. Axes are named u and v across the columns, and w along them. */
layout(std140, binding = 0) uniform Job {
  ivec4 axes;    // u, v, w as numbers of axes; bits of the lattice below a voxel
  ivec4 first;   // first voxel of the slab along u, v, w; whether flips before it along w count for it
  ivec4 last;    // voxel behind the last one along u, v, w
  uvec4 step;    // bits from a voxel to the next one along u, v, w
  uvec4 triangles;  // first number; how many; whether numbers are looked up in `order`; most columns that the first
                 // pass takes
  ivec4 view;    // first column of the viewport along u and v; its width and height
} job;

layout(std430, binding = 0) readonly buffer Points {
  ivec4 at[]; // the fourth number is not 0 where a point lies beyond 32 bits
} points;
layout(std430, binding = 1) readonly buffer Corners {
  uint corner[];
} corners;
layout(std430, binding = 2) readonly buffer Order {
  uint triangle[];
} order;
layout(std430, binding = 3) buffer Bits {
  uint word[];
} bits;

uint triangle_number(uint i) {
  return job.triangles.z != 0u ? order.triangle[job.triangles.x + i] : job.triangles.x + i;
}

ivec3 turned(ivec4 p) {
  return ivec3(p[job.axes.x], p[job.axes.y], p[job.axes.z]);
}

/* The corners of a triangle along u, v, w; false if it is one of those that the CPU does, because products of its
   differences do not fit 64 bits. */
bool load_triangle(uint triangle, out ivec3 corner[3]) {
  ivec4 p[3];
  for (int c = 0; c < 3; c++) {
    p[c] = points.at[corners.corner[3u * triangle + uint(c)]];
    corner[c] = turned(p[c]);
  }
  if ((p[0].w | p[1].w | p[2].w) != 0)
    return false;
  ivec3 low = min(min(corner[0], corner[1]), corner[2]), high = max(max(corner[0], corner[1]), corner[2]);
  return all(lessThanEqual(high - low, ivec3(1 << 20)));
}
