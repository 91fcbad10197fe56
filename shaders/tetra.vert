/* SPDX-License-Identifier: BSD-3-Clause */
/* The vertex program of Rueda et al.: six vertices for each tetrahedron, of the triangles P0 P1 P2 and P3 P2 P1.
   Each computes the points of its triangle by the table; a second triangle that is not there is put outside. */
flat out uvec4 point_a, point_b, point_c;

void main() {
  uint triangle = list.triangle[list_begin + uint(gl_VertexID) / 6u];
  int vertex = gl_VertexID % 6;
  vec3 t[4];
  for (uint i = 0u; i < 3u; i++)
    t[i] = place(corners.corner[3u * triangle + i]);
  t[3] = place_apex(triangle);
  dvec2 p[4];
  int count = section(t, p);
  bool is_main = vertex < 3;
  dvec2 q[3] = is_main ? dvec2[3](p[0], p[1], p[2]) : dvec2[3](p[3], p[2], p[1]);
  point_a = uvec4(unpackDouble2x32(q[0].x), unpackDouble2x32(q[0].y));
  point_b = uvec4(unpackDouble2x32(q[1].x), unpackDouble2x32(q[1].y));
  point_c = uvec4(unpackDouble2x32(q[2].x), unpackDouble2x32(q[2].y));
  gl_Position = count >= (is_main ? 3 : 4) ? position(q, vertex % 3) : vec4(-2.0, -2.0, 0.0, 1.0);
}
