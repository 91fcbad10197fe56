/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/sheets/thicken.h"

#include "mesh/duplicate_faces.h"
#include "mesh/triangulate.h"
#include "mesh/unit_scale.h"
#include "mesh/weld.h"
#include "repair/sheets/sheet_offsets.h"

#include <string.h>

typedef struct thickening {
  vxm_soup *out;
  uint64_t **origin;
  size_t capacity; /**< of `origin`: faces */
  const vxm_soup *from;
  vxm_soup *triangles; /**< of the sheets, with only their vertices */
  uint64_t *source;    /**< per triangle: the face it is a piece of */
  vxm_sheet_sides sides;
  vxm_sheet_offsets offsets;
  size_t first;    /**< vertex of `out` that the first one of the surface becomes */
  uint32_t *after; /**< per vertex of the surface: the one that a strip's end leads to from it */
  vxm_error error;
} thickening;

/* ---- The triangles of the sheets ---- */

static bool add_triangle(thickening *t, const uint32_t *corners, size_t face, const uint32_t *weld,
                         uint32_t *number) {
  uint32_t own[3];
  for (int i = 0; i < 3; i++) {
    uint32_t v = weld[corners[i]];
    const double *p = vxm_position(t->from, v);
    if (number[v] == VXM_NO_VERTEX) {
      if (vxm_soup_add_vertex(t->triangles, p[0], p[1], p[2], &t->error) != VXM_OK)
        return false;
      number[v] = (uint32_t)(t->triangles->vertex_count - 1);
    }
    own[i] = number[v];
  }
  if (!vxm_face_has_three(own, 3, NULL))
    return true;
  t->source[t->triangles->face_count] = face;
  return vxm_soup_add_face(t->triangles, own, 3, &t->error) == VXM_OK;
}

static bool add_triangles(thickening *t, const uint8_t *faces, const uint32_t *weld, uint32_t *number) {
  vxm_triangulator triangulator;
  vxm_triangulator_open(&triangulator, t->from->context);
  bool done = true;
  for (size_t f = 0; f < t->from->face_count && done; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(t->from, f, &count), *pieces = corner;
    done = vxm_check_cancelled_at(f, t->from->context, &t->error) == VXM_OK;
    if (!faces[f] || count < 3 || !done)
      continue;
    if (count > 3)
      done = vxm_triangulate(&triangulator, t->from->positions, corner, count, &pieces, &t->error) == VXM_OK;
    for (size_t i = 0; i + 2 < count && done; i++)
      done = add_triangle(t, pieces + 3 * i, f, weld, number);
  }
  vxm_triangulator_close(&triangulator);
  return done;
}

/** Of triangles with the same corners the first stays: around their edges there is no order among them. */
static bool drop_repeated(thickening *t) {
  vxm_soup *soup = t->triangles;
  vxm_duplicates found;
  uint8_t *kinds = vxm_alloc(soup->context, soup->face_count, sizeof *kinds, &t->error);
  if (!kinds)
    return false;
  vxm_status status = vxm_duplicates_find(&found, soup->context, soup, kinds, NULL, &t->error);
  size_t kept = 0;
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++)
    if (kinds[f] == VXM_REPEAT_NONE) {
      memmove(soup->indices + 3 * kept, soup->indices + 3 * f, 3 * sizeof *soup->indices);
      t->source[kept++] = t->source[f];
    }
  vxm_free(soup->context, kinds);
  soup->face_count = kept; /* the offsets of triangles stay what they are */
  soup->corner_count = 3 * kept;
  return status == VXM_OK;
}

static bool take_triangles(thickening *t, const uint8_t *faces) {
  const vxm_soup *from = t->from;
  vxm_context *context = from->context;
  size_t triangles = 0;
  for (size_t f = 0; f < from->face_count; f++)
    triangles += faces[f] ? (size_t)(from->offsets[f + 1] - from->offsets[f]) : 0;
  uint32_t *weld = vxm_alloc(context, from->vertex_count, sizeof *weld, &t->error);
  uint32_t *number = weld ? vxm_alloc(context, from->vertex_count, sizeof *number, &t->error) : NULL;
  t->source = number ? vxm_alloc(context, triangles, sizeof *t->source, &t->error) : NULL;
  bool done = t->source && vxm_soup_create(&t->triangles, context, "", &t->error) == VXM_OK &&
              vxm_weld_exact(context, from->positions, from->vertex_count, weld, NULL, &t->error) == VXM_OK;
  if (done) {
    memset(number, 0xff, from->vertex_count * sizeof *number);
    done = add_triangles(t, faces, weld, number) && drop_repeated(t);
  }
  vxm_free(context, number);
  vxm_free(context, weld);
  return done;
}

/* ---- The surface ---- */

/** Adds a face of the surface, of three or more of its vertices, that comes from a triangle. */
static bool put(thickening *t, const uint32_t *vertices, size_t count, size_t triangle) {
  for (size_t i = 1; i + 1 < count; i++) {
    uint32_t corners[3] = {vertices[0], vertices[i], vertices[i + 1]};
    for (int k = 0; k < 3; k++)
      corners[k] += (uint32_t)t->first;
    if (vxm_grow(t->out->context, (void **)t->origin, &t->capacity, t->out->face_count + 1,
                 sizeof **t->origin, &t->error) != VXM_OK ||
        vxm_soup_add_face(t->out, corners, 3, &t->error) != VXM_OK)
      return false;
    (*t->origin)[t->out->face_count - 1] = t->source[triangle];
  }
  return true;
}

static bool put_side(thickening *t, uint32_t side) {
  const uint32_t *v = t->offsets.vertex + side;
  const uint32_t front[3] = {v[0], v[2], v[4]}, back[3] = {v[0], v[4], v[2]};
  return put(t, side % 2 ? back : front, 3, side / 6);
}

/** The vertices at the ends of an edge, in the order in which its side passes them. */
static void ends_of(const thickening *t, uint32_t edge, uint32_t ends[2]) {
  uint32_t a = t->offsets.vertex[edge], b = t->offsets.vertex[vxm_sheet_next(edge)];
  ends[0] = edge % 2 ? b : a;
  ends[1] = edge % 2 ? a : b;
}

/** Puts a strip between sides that see each other where they have vertices of their own: a quadrangle along a
 * rim, a triangle where only one end of the edge is cut. */
static bool put_strip(thickening *t, uint32_t edge) {
  uint32_t a[2], b[2], strip[4];
  size_t count = 0;
  ends_of(t, edge, a);
  ends_of(t, t->sides.across[edge], b);
  strip[count++] = a[1];
  strip[count++] = a[0];
  if (b[1] != a[0]) {
    t->after[a[0]] = b[1];
    strip[count++] = b[1];
  }
  if (b[0] != a[1]) {
    t->after[b[0]] = a[1];
    strip[count++] = b[0];
  }
  return put(t, strip, count, edge / 6);
}

/** Where three strips or more end at a vertex of the sheets they leave a polygon between them. */
static bool put_cap(thickening *t, uint32_t begin, uint32_t *ring, size_t triangle) {
  size_t count = 0;
  for (uint32_t v = begin, next; t->after[v] != VXM_NO_VERTEX; v = next) {
    ring[count++] = v;
    next = t->after[v];
    t->after[v] = VXM_NO_VERTEX;
  }
  for (size_t i = 0; i < count / 2; i++) {
    uint32_t v = ring[i];
    ring[i] = ring[count - 1 - i];
    ring[count - 1 - i] = v;
  }
  return count < 3 || put(t, ring, count, triangle);
}

static bool put_all(thickening *t) {
  uint32_t *ring = vxm_alloc(t->out->context, t->offsets.count, sizeof *ring, &t->error);
  bool done = ring != NULL;
  memset(t->after, 0xff, t->offsets.count * sizeof *t->after);
  for (uint32_t v = 0; v < t->offsets.count && done; v++) {
    const double *p = t->offsets.positions + 3 * (size_t)v;
    done = vxm_soup_add_vertex(t->out, p[0], p[1], p[2], &t->error) == VXM_OK;
  }
  for (uint32_t side = 0; side < t->sides.count && done; side += side % 2 ? 5 : 1)
    done = put_side(t, side);
  for (uint32_t edge = 0; edge < t->sides.count && done; edge++)
    done = edge > t->sides.across[edge] || put_strip(t, edge);
  for (uint32_t corner = 0; corner < t->sides.count && done; corner++)
    done = put_cap(t, t->offsets.vertex[corner], ring, corner / 6);
  vxm_free(t->out->context, ring);
  return done;
}

static bool thicken(thickening *t, const uint8_t *faces, double thickness) {
  if (!take_triangles(t, faces))
    return false;
  if (t->triangles->face_count == 0) /* spikes */
    return true;
  vxm_extent extent;
  if (vxm_extent_find(&extent, t->from->context, t->triangles, &t->error) != VXM_OK)
    return false;
  double scale = vxm_unit_scale_of(extent.bounds).scale;
  if (vxm_sheet_sides_build(&t->sides, t->triangles, scale, &t->error) != VXM_OK ||
      vxm_sheet_offsets_find(&t->offsets, &t->sides, thickness / 2, scale, &t->error) != VXM_OK)
    return false;
  t->after = vxm_alloc(t->from->context, t->offsets.count, sizeof *t->after, &t->error);
  return t->after && put_all(t);
}

vxm_status vxm_thicken(vxm_soup *out, uint64_t **origin, const vxm_soup *soup, const uint8_t *faces,
                       double thickness, vxm_error *error) {
  vxm_context *context = soup->context;
  thickening t = {.out = out,
                  .origin = origin,
                  .capacity = out->face_count,
                  .from = soup,
                  .first = out->vertex_count,
                  .offsets.context = context,
                  .error = VXM_ERROR_INIT};
  bool done = thicken(&t, faces, thickness);
  vxm_free(context, t.after);
  vxm_sheet_offsets_destroy(&t.offsets);
  if (t.sides.soup)
    vxm_sheet_sides_destroy(&t.sides);
  vxm_free(context, t.source);
  vxm_soup_destroy(t.triangles);
  if (!done)
    vxm_error_pass(error, &t.error);
  return done ? VXM_OK : t.error.code;
}
