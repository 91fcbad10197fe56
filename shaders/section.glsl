/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The cross-section of a tetrahedron (Rueda et al., section 4; Ogayar et al., section III-A1): a plane w = s + 1/2
 * cuts its edges in P0 to P3, of which P0 P1 P2 and, where two corners lie on either side, P3 P2 P1 are triangles.
 *
 * Neighbouring tetrahedra share cut points bit for bit: each is computed from the upper end of its edge to the lower
 * one, and a corner on the plane counts as below it. In doubles, as the rasterizer's 1/256 pixel would misplace one
 * in a thousand voxels of the surface: what is drawn is only where to look, and each fragment tells by the points
 * themselves.
 */
layout(std140, binding = 0) uniform Job {
  ivec4 axes;   // u, v, w as numbers of axes; bits of the lattice below a voxel
  ivec4 view;   // first column of the viewport along u and v; its width and height
  uvec4 random; // numbers in the circular buffer; the first one to use
  vec4 amount;  // of the displacement, in voxels
} job;

layout(location = 1) uniform int slice;

dvec2 cut(vec3 above, vec3 below, double plane) {
  precise double part = (plane - double(below.z)) / (double(above.z) - double(below.z));
  precise dvec2 at = dvec2(below.xy) + part * (dvec2(above.xy) - dvec2(below.xy));
  return at;
}

/* Corners in order from above; P0 to P3; how many of these there are: 0, 3 or 4. */
int section(vec3 t[4], out dvec2 p[4]) {
  double plane = double(slice) + 0.5LF + nudge(job.axes.z);
  for (int last = 3; last > 0; last--)
    for (int i = 0; i < last; i++)
      if (t[i].z < t[i + 1].z) {
        vec3 swap = t[i];
        t[i] = t[i + 1];
        t[i + 1] = swap;
      }
  p[0] = p[1] = p[2] = p[3] = dvec2(0.0);
  if (!(double(t[0].z) > plane) || double(t[3].z) > plane)
    return 0;
  bool below_b = double(t[1].z) > plane, below_c = double(t[2].z) > plane; // the plane lies below B, below C
  p[0] = cut(t[0], t[3], plane);
  p[1] = below_b ? cut(t[1], t[3], plane) : cut(t[0], t[1], plane);
  p[2] = below_c ? cut(t[2], t[3], plane) : cut(t[0], t[2], plane);
  if (below_b && !below_c)
    p[3] = cut(t[1], t[2], plane);
  return below_b && !below_c ? 4 : 3;
}

/* Where a corner of the triangle to draw goes. */
vec4 position(dvec2 p[3], int which) {
  vec2 q[3];
  for (int i = 0; i < 3; i++)
    q[i] = vec2(p[i] - p[0]);
  vec2 at = vec2(p[0] - dvec2(job.view.xy)) + cover_corner(q, which, 0.0625);
  return vec4(2.0 * at / vec2(job.view.zw) - 1.0, 0.0, 1.0);
}
