/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Voxels by the overlap test of Faieghi, Tutunea-Fatan and Eagleson, "Fast and cross-vendor OpenCL-based implementation
 * for voxelization of triangular mesh models", in 32-bit floats as they have it; the numbers are their equations. One
 * byte for each voxel gets a material. Products and sums are rounded one by one, so that all devices that keep subnormal numbers have
 * the same bits.
 */
#pragma OPENCL FP_CONTRACT OFF

typedef struct PublishedJob { /* vxm_published_job */
  float first[3], per_unit; /* p0; voxels for each model unit */
  float size[3];            /* delta p */
  uint facets;
  uint dims[3], material;
  uint is_counted, unused[3];
} PublishedJob;

typedef struct Triangle {
  float at[3][3]; /* of each corner x, y, z */
} Triangle;

typedef struct Plane {
  float normal[3], near, far; /* a1 and a2 of (3.5) */
} Plane;

typedef struct Sides {
  float normal[3][2], reach[3]; /* of each edge (3.6) and (3.7) */
} Sides;

static inline float dot3(const float a[3], const float b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline Triangle triangle_of(__global const float *vertices, size_t i) {
  Triangle t;
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 3; a++)
      t.at[c][a] = vertices[9 * i + 3 * c + a];
  return t;
}

/* The minimum corner of a voxel, by (3.1). */
static inline void corner_of(float p[3], const PublishedJob *job, const uint voxel[3]) {
  for (int a = 0; a < 3; a++)
    p[a] = job->first[a] + job->size[a] * (float)voxel[a];
}

static inline Plane plane_of(const Triangle *t, const PublishedJob *job) {
  Plane plane;
  float near[3], far[3];
  for (int a = 0; a < 3; a++) {
    int b = a == 2 ? 0 : a + 1, c = a == 0 ? 2 : a - 1;
    plane.normal[a] = (t->at[1][b] - t->at[0][b]) * (t->at[2][c] - t->at[1][c]) -
                      (t->at[1][c] - t->at[0][c]) * (t->at[2][b] - t->at[1][b]);
  }
  for (int a = 0; a < 3; a++) {
    float critical = plane.normal[a] > 0 ? job->size[a] : 0; /* (3.4) */
    near[a] = critical - t->at[0][a];
    far[a] = job->size[a] - critical - t->at[0][a];
  }
  plane.near = dot3(plane.normal, near);
  plane.far = dot3(plane.normal, far);
  return plane;
}

static inline bool meets_plane(const Plane *plane, const float p[3]) {
  float at = dot3(plane->normal, p);
  return (at + plane->near) * (at + plane->far) <= 0; /* (3.5) */
}

/* Seen along axis w; u and v follow it in turn, so that the edges run the same way round on all three planes. */
static inline Sides sides_of(const Triangle *t, const Plane *plane, const PublishedJob *job, int w) {
  int u = w == 2 ? 0 : w + 1, v = w == 0 ? 2 : w - 1;
  float sign = plane->normal[w] >= 0 ? 1 : -1;
  Sides sides;
  for (int e = 0; e < 3; e++) {
    int next = e == 2 ? 0 : e + 1;
    float nu = -(t->at[next][v] - t->at[e][v]) * sign, nv = (t->at[next][u] - t->at[e][u]) * sign;
    sides.normal[e][0] = nu;
    sides.normal[e][1] = nv;
    sides.reach[e] =
        -(nu * t->at[e][u] + nv * t->at[e][v]) + fmax(0.0f, job->size[u] * nu) + fmax(0.0f, job->size[v] * nv);
  }
  return sides;
}

static inline bool meets_sides(const Sides *sides, const float p[3], int w) {
  int u = w == 2 ? 0 : w + 1, v = w == 0 ? 2 : w - 1;
  for (int e = 0; e < 3; e++)
    if (!(sides->normal[e][0] * p[u] + sides->normal[e][1] * p[v] + sides->reach[e] >= 0)) /* (3.8) */
      return false;
  return true;
}

/* The voxels of the grid whose closed boxes meet that of the triangle. */
static inline bool box_of(uint begin[3], uint end[3], const Triangle *t, const PublishedJob *job) {
  bool is_some = true;
  for (int a = 0; a < 3; a++) {
    float low = fmin(fmin(t->at[0][a], t->at[1][a]), t->at[2][a]) - job->first[a];
    float high = fmax(fmax(t->at[0][a], t->at[1][a]), t->at[2][a]) - job->first[a];
    float most = (float)(job->dims[a] - 1);
    begin[a] = (uint)clamp(ceil(low * job->per_unit) - 1, 0.0f, most);
    end[a] = (uint)clamp(floor(high * job->per_unit), 0.0f, most) + 1;
    is_some = is_some && begin[a] < end[a];
  }
  return is_some;
}

/* A work-item for each voxel, over all facets until one meets it. */
__kernel void published_voxels(__global const float *vertices, __global uchar *voxels, __global uint *tests,
                               const PublishedJob job) {
  ulong i = get_global_id(0), slice = (ulong)job.dims[0] * job.dims[1];
  if (i >= slice * job.dims[2])
    return;
  uint voxel[3], begin[3], end[3], facet = 0;
  voxel[2] = (uint)(i / slice); /* (3.3) */
  voxel[1] = (uint)((i - voxel[2] * slice) / job.dims[0]);
  voxel[0] = (uint)(i - voxel[2] * slice - (ulong)voxel[1] * job.dims[0]);
  float p[3];
  corner_of(p, &job, voxel);
  for (; facet < job.facets; facet++) {
    Triangle t = triangle_of(vertices, facet);
    Plane plane = plane_of(&t, &job);
    bool is_met = meets_plane(&plane, p);
    for (int w = 2; w >= 0 && is_met; w--) {
      Sides sides = sides_of(&t, &plane, &job, w);
      is_met = meets_sides(&sides, p, w);
    }
    if (!is_met)
      continue;
    box_of(begin, end, &t, &job);
    for (int a = 0; a < 3; a++)
      is_met = is_met && begin[a] <= voxel[a] && voxel[a] < end[a];
    if (!is_met)
      continue;
    voxels[i] = (uchar)job.material;
    break;
  }
  if (job.is_counted)
    tests[i] = facet < job.facets ? facet + 1 : facet;
}

/* A work-item for each facet, over the voxels of its box: their figure 5. */
__kernel void published_facets(__global const float *vertices, __global uchar *voxels, __global ulong *tests,
                               const PublishedJob job) {
  size_t i = get_global_id(0);
  if (i >= job.facets)
    return;
  Triangle t = triangle_of(vertices, i);
  uint begin[3], end[3], voxel[3];
  bool is_some = box_of(begin, end, &t, &job);
  if (job.is_counted)
    tests[i] = is_some ? (ulong)(end[0] - begin[0]) * (end[1] - begin[1]) * (end[2] - begin[2]) : 0;
  if (!is_some)
    return;
  Plane plane = plane_of(&t, &job);
  Sides x = sides_of(&t, &plane, &job, 0), y = sides_of(&t, &plane, &job, 1), z = sides_of(&t, &plane, &job, 2);
  for (voxel[2] = begin[2]; voxel[2] < end[2]; voxel[2]++)
    for (voxel[1] = begin[1]; voxel[1] < end[1]; voxel[1]++)
      for (voxel[0] = begin[0]; voxel[0] < end[0]; voxel[0]++) {
        float p[3];
        corner_of(p, &job, voxel);
        if (meets_plane(&plane, p) && meets_sides(&z, p, 2) && meets_sides(&y, p, 1) && meets_sides(&x, p, 0))
          voxels[voxel[0] + ((ulong)voxel[2] * job.dims[1] + voxel[1]) * job.dims[0]] = (uchar)job.material; /* (3.2) */
      }
}
