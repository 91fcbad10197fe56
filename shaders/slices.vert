/* SPDX-License-Identifier: BSD-3-Clause */
/* Corners of the triangles that a slice meets, and the apex of their part. */
out vec3 corner;
out vec3 apex;

void main() {
  uint triangle = list.triangle[list_begin + uint(gl_VertexID) / 3u];
  corner = place(corners.corner[3u * triangle + uint(gl_VertexID) % 3u]);
  apex = place_apex(triangle);
}
