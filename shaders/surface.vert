/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers of the triangles that surface.comp listed. */
layout(std430, binding = 4) readonly buffer Large {
  uint vertices, instances, first_vertex, first_instance;
  uint triangle[];
} large;
flat out uint triangle;

void main() {
  triangle = large.triangle[gl_VertexID];
}
