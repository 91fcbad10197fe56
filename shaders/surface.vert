/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers of the triangles that surface.comp listed. */
layout(std430, binding = 4) readonly buffer Large {
  uint vertices, instances, first_vertex, first_instance;
  uint facet[];
} large;
flat out uint facet;

void main() {
  facet = large.facet[gl_VertexID];
}
