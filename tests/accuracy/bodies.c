/* SPDX-License-Identifier: BSD-3-Clause */
#include "bodies.h"

#include "base/rng.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

const char *const body_names[BODY_COUNT] = {"torus", "two parts", "lumpy sphere"};

void require(vxm_status status, const vxm_error *error) {
  if (status == VXM_OK)
    return;
  fprintf(stderr, "accuracy: %s\n", error->text);
  exit(1);
}

/* ---- Closed bodies ---- */

static shape make_torus(void) {
  double profile[2 * 32];
  shape_circle(profile, 32, 1, 0.4);
  shape made = shape_revolve(32, profile, true, 64);
  shape_turn(&made, 0, 31);
  return made;
}

static shape make_ball(size_t rings, size_t segments, double radius) {
  double profile[2 * 64];
  shape_half_circle(profile, rings, radius);
  return shape_revolve(rings, profile, false, segments);
}

/** A ball and an egg that sticks in its side: two components that share space but no vertex. */
static shape make_two_parts(void) {
  shape made = make_ball(32, 48, 1), egg = make_ball(24, 40, 0.7);
  shape_scale(&egg, 1, 0.8, 0.6);
  shape_turn(&egg, 1, 37);
  shape_move(&egg, 1.25, 0.3, 0.15);
  shape_append(&made, &egg);
  shape_free(&egg);
  return made;
}

/** A ball whose radius goes up and down by a third, so that it has hollows as well as bumps. */
static shape make_lumpy(void) {
  shape made = make_ball(48, 80, 1);
  for (size_t i = 0; i < made.vertex_count; i++) {
    double *p = made.positions + 3 * i;
    double radius = 1 + 0.15 * sin(5 * p[0] + 1) + 0.12 * cos(6 * p[1]) + 0.08 * sin(7 * p[2] + 2 * p[0]);
    for (int a = 0; a < 3; a++)
      p[a] *= radius;
  }
  shape_turn(&made, 1, 23);
  return made;
}

shape body_make(int index) {
  static shape (*const makers[BODY_COUNT])(void) = {make_torus, make_two_parts, make_lumpy};
  shape made = makers[index]();
  shape_split_triangles(&made);
  return made;
}

/* ---- Panels ---- */

/** Adds side `side` of the box with half edges `half`, in cells x cells squares of two triangles. */
static void add_panel(shape *s, int side, const double half[3], int cells, bool outward) {
  int w = side / 2, u = (w + 1) % 3, v = (w + 2) % 3;
  int64_t first = (int64_t)s->vertex_count, row = cells + 1;
  for (int j = 0; j <= cells; j++)
    for (int i = 0; i <= cells; i++) {
      double p[3];
      p[w] = side % 2 ? half[w] : -half[w];
      p[u] = half[u] * (2.0 * i / cells - 1);
      p[v] = half[v] * (2.0 * j / cells - 1);
      shape_add_vertex(s, p[0], p[1], p[2]);
    }
  bool swapped = (side % 2 == 1) != outward;
  for (int j = 0; j < cells; j++)
    for (int i = 0; i < cells; i++) {
      int64_t a = first + j * row + i, b = swapped ? a + row : a + 1, d = swapped ? a + 1 : a + row;
      shape_add_face(s, 3, (int64_t[]){a, b, a + row + 1});
      shape_add_face(s, 3, (int64_t[]){a, a + row + 1, d});
    }
}

shape body_panels(panels kind, uint64_t seed) {
  vxm_rng rng = {seed};
  const double half[3] = {1, 0.5 + 0.4 * vxm_rng_unit(&rng), 0.3 + 0.4 * vxm_rng_unit(&rng)};
  shape made = {0};
  if (kind == PANELS_JOINED) {
    made = shape_box(-half[0], -half[1], -half[2], half[0], half[1], half[2]);
    shape_split_triangles(&made);
  }
  double degrees[3];
  for (int a = 0; a < 3; a++)
    degrees[a] = 360 * vxm_rng_unit(&rng);
  for (int side = 0; side < 6 && kind != PANELS_JOINED; side++) {
    bool turned = vxm_rng_unit(&rng) < 0.5;
    add_panel(&made, side, half, 3 + 2 * side, kind != PANELS_TURNED || !turned);
  }
  for (int a = 0; a < 3; a++)
    shape_turn(&made, a, degrees[a]);
  return made;
}

/* ---- Shapes and meshes ---- */

shape shape_of_mesh(const vxm_mesh *mesh) {
  shape made = {0};
  const double *p = vxm_mesh_vertices(mesh);
  const uint64_t *offsets = vxm_mesh_offsets(mesh);
  const uint32_t *corners = vxm_mesh_indices(mesh);
  for (int64_t i = 0; i < vxm_mesh_vertex_count(mesh); i++)
    shape_add_vertex(&made, p[3 * i], p[3 * i + 1], p[3 * i + 2]);
  for (int64_t f = 0; f < vxm_mesh_face_count(mesh); f++)
    for (uint64_t c = offsets[f] + 1; c + 1 < offsets[f + 1]; c++)
      shape_add_face(&made, 3, (int64_t[]){corners[offsets[f]], corners[c], corners[c + 1]});
  return made;
}

vxm_mesh *mesh_of_shape(vxm_context *context, const shape *from) {
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  arrays.vertices = from->positions;
  arrays.vertex_count = (int64_t)from->vertex_count;
  arrays.offsets = from->offsets;
  arrays.indices = from->indices;
  arrays.index_count = from->offsets[from->face_count];
  arrays.face_count = (int64_t)from->face_count;
  vxm_mesh *mesh;
  vxm_error error = VXM_ERROR_INIT;
  require(vxm_mesh_create(&mesh, context, &arrays, &error), &error);
  return mesh;
}
