/* SPDX-License-Identifier: BSD-3-Clause */
/* Builds the tetrahedron of a triangle and the apex, and emits its cross-section with the plane of the slice. */
layout(triangles) in;
layout(triangle_strip, max_vertices = 6) out;
in vec3 corner[];
in vec3 apex[];
flat out uvec4 point_a, point_b, point_c;

void emit(dvec2 a, dvec2 b, dvec2 c) {
  dvec2 p[3] = dvec2[3](a, b, c);
  for (int i = 0; i < 3; i++) {
    point_a = uvec4(unpackDouble2x32(a.x), unpackDouble2x32(a.y));
    point_b = uvec4(unpackDouble2x32(b.x), unpackDouble2x32(b.y));
    point_c = uvec4(unpackDouble2x32(c.x), unpackDouble2x32(c.y));
    gl_Position = position(p, i);
    EmitVertex();
  }
  EndPrimitive();
}

void main() {
  dvec2 p[4];
  vec3 t[4] = vec3[4](corner[0], corner[1], corner[2], apex[0]);
  int count = section(t, p);
  if (count >= 3)
    emit(p[0], p[1], p[2]);
  if (count == 4)
    emit(p[3], p[2], p[1]);
}
