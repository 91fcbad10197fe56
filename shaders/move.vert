/* SPDX-License-Identifier: BSD-3-Clause */
/* Moves a point of a model, displaces it by a vector of a circular buffer and puts it on the lattice (Ogayar et al.,
   section III-B). "precise" keeps every product and sum rounded by itself, as the CPU has them (voxel/lattice/vertex_transform.h). */
layout(std430, binding = 0) readonly buffer Originals {
  double at[]; // three for each point
} originals;
layout(std430, binding = 1) readonly buffer Entries {
  uint entry[]; // of each point in the noise
} entries;
layout(std430, binding = 2) readonly buffer Noise {
  vec4 vector[];
} noise;
layout(std430, binding = 3) writeonly buffer Points {
  ivec4 at[];
} points;
layout(std140, binding = 0) uniform Job {
  dvec4 row[3]; // of the matrix
  dvec4 origin;
  dvec4 scale; // steps per unit; the fourth number is what all of them stay below
  uvec4 noise; // size, 0 = not displaced; where it begins
} job;

void main() {
  uint p = uint(gl_VertexID);
  double x = originals.at[3u * p], y = originals.at[3u * p + 1u], z = originals.at[3u * p + 2u];
  uint entry = job.noise.x > 0u ? entries.entry[p] + job.noise.y : 0u;
  vec4 move = job.noise.x > 0u ? noise.vector[entry < job.noise.x ? entry : entry - job.noise.x] : vec4(0.0);
  ivec4 steps = ivec4(0);
  for (int a = 0; a < 3; a++) {
    precise double at = job.row[a].x * x + job.row[a].y * y + job.row[a].z * z + job.row[a].w;
    precise double moved = job.noise.x > 0u ? at + double(move[a]) : at;
    precise double exact = (moved - job.origin[a]) * job.scale[a];
    /* Added and taken away again, this rounds to a whole number, to even between two. */
    precise double large = exact + 6755399441055744.0LF;
    precise double whole = large - 6755399441055744.0LF;
    bool fits = whole < job.scale.w && whole > -job.scale.w; // NaN does not
    steps[a] = fits ? int(whole) : 0;
    steps.w |= fits ? 0 : 1;
  }
  points.at[p] = steps;
  gl_Position = vec4(0.0, 0.0, 0.0, 1.0); // nothing is drawn
}
