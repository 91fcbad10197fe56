/* SPDX-License-Identifier: BSD-3-Clause */
/* Corners of the facets that a slice meets, and the apex of their part. */
out vec3 corner;
out vec3 apex;

void main() {
  uint facet = list.facet[list_begin + uint(gl_VertexID) / 3u];
  corner = place(corners.corner[3u * facet + uint(gl_VertexID) % 3u]);
  apex = place_apex(facet);
}
