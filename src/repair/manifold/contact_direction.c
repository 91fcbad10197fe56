/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/manifold/contact_direction.h"

#include <math.h>

/** Steps of the search; each normal that matters takes a few. */
enum { STEPS = 200 };
/** Of the length: where faces move by less of it, they do not. */
static const double LEAST = 1e-3;
/** Of the squared length: what another step gains at least. */
static const double GAIN = 1e-6;

/** What a face is at a vertex: a sector between two edges. */
typedef struct sector {
  uint32_t ends[2];
  vxm_vec3 edges[2], normal; /**< of length 1 */
} sector;

typedef struct fan {
  size_t begin, end; /**< of its sectors */
  uint32_t vertex;
  uint32_t next; /**< fan of the next vertex at this place, or VXM_NO_VERTEX */
} fan;

typedef struct contacts {
  const vxm_soup *soup;
  const uint32_t *map, *number;
  size_t count;
  fan *fans;
  sector *sectors;
  uint32_t *firsts; /**< vertex: the first fan at its place, as `map` has it, or VXM_NO_VERTEX */
} contacts;

static vxm_vec3 plus(vxm_vec3 a, vxm_vec3 b, double share) {
  return (vxm_vec3){a.x + share * b.x, a.y + share * b.y, a.z + share * b.z};
}

static vxm_vec3 unit(vxm_vec3 a) {
  double length = vxm_vec3_length(a);
  return length > 0 ? (vxm_vec3){a.x / length, a.y / length, a.z / length} : a;
}

/* ---- Away from all faces of a fan ---- */

static const sector *least_along(const sector *sectors, size_t count, vxm_vec3 along) {
  const sector *least = sectors;
  for (const sector *s = sectors + 1; s < sectors + count; s++)
    if (vxm_vec3_dot(s->normal, along) < vxm_vec3_dot(least->normal, along))
      least = s;
  return least;
}

/** The point of the normals' convex hull that lies nearest to the origin (Gilbert 1966), as a direction: none
 * goes farther along all of them. 0 if that is not along all. */
static vxm_vec3 along_all(const sector *sectors, size_t count) {
  vxm_vec3 at = sectors->normal, none = {0, 0, 0};
  for (int step = 0; step < STEPS; step++) {
    vxm_vec3 to = plus(least_along(sectors, count, at)->normal, at, -1);
    double gain = -vxm_vec3_dot(at, to);
    if (!(gain > GAIN * vxm_vec3_dot(at, at)))
      break;
    at = plus(at, to, fmin(1, gain / vxm_vec3_dot(to, to)));
  }
  vxm_vec3 direction = unit(at);
  return vxm_vec3_dot(least_along(sectors, count, direction)->normal, direction) > LEAST ? direction : none;
}

/* ---- On which side of a fan something lies ---- */

/** The sum of the normals at an edge of the fan. */
static vxm_vec3 normal_at(const sector *sectors, size_t count, uint32_t end) {
  vxm_vec3 sum = {0, 0, 0};
  for (size_t i = 0; i < count; i++)
    if (sectors[i].ends[0] == end || sectors[i].ends[1] == end)
      sum = plus(sum, sectors[i].normal, 1);
  return sum;
}

/** Those at the vertex, by the angles of the faces (Baerentzen & Aanaes 2005), or rather by the chords of
 * these, as the square root is the same on all processors. */
static vxm_vec3 normal_of(const sector *sectors, size_t count) {
  vxm_vec3 sum = {0, 0, 0};
  for (size_t i = 0; i < count; i++)
    sum = plus(sum, sectors[i].normal, vxm_vec3_length(plus(sectors[i].edges[0], sectors[i].edges[1], -1)));
  return sum;
}

/** Whether a direction's foot in the plane of a sector lies in it. */
static bool is_over(const sector *s, vxm_vec3 along) {
  return vxm_vec3_dot(vxm_vec3_cross(s->edges[0], along), s->normal) >= 0 &&
         vxm_vec3_dot(vxm_vec3_cross(along, s->edges[1]), s->normal) >= 0;
}

/** The squared distance of a direction from a fan; *side: above 0 where its faces look to it. */
static double distance_to(const sector *sectors, size_t count, vxm_vec3 along, double *side) {
  double nearest = 1;
  vxm_vec3 normal = normal_of(sectors, count);
  for (size_t i = 0; i < count; i++) {
    double height = vxm_vec3_dot(sectors[i].normal, along);
    if (height * height < nearest && is_over(&sectors[i], along)) {
      nearest = height * height;
      normal = sectors[i].normal;
    }
    for (int k = 0; k < 2; k++) {
      double foot = vxm_vec3_dot(sectors[i].edges[k], along), distance = 1 - foot * foot;
      if (foot > 0 && distance < nearest) {
        nearest = distance;
        normal = normal_at(sectors, count, sectors[i].ends[k]);
      }
    }
  }
  *side = vxm_vec3_dot(normal, along);
  return nearest;
}

/** 1 if another fan lies before this one, -1 if behind it: by the middle of a face that lies farthest from
 * it, as they may touch along edges. */
static int side_of(const contacts *c, const fan *f, const fan *other) {
  double farthest = 0, side = 0;
  for (size_t i = other->begin; i < other->end; i++) {
    vxm_vec3 middle = unit(plus(c->sectors[i].edges[0], c->sectors[i].edges[1], 1));
    double at, distance = distance_to(c->sectors + f->begin, f->end - f->begin, middle, &at);
    if (distance > farthest) {
      farthest = distance;
      side = at;
    }
  }
  return (side > 0) - (side < 0);
}

/* ---- All fans ---- */

static vxm_vec3 direction_of(const contacts *c, const fan *f) {
  vxm_vec3 none = {0, 0, 0};
  int before = 0, behind = 0;
  if (f->begin == f->end)
    return none;
  for (uint32_t i = c->firsts[c->map[f->vertex]]; i != VXM_NO_VERTEX; i = c->fans[i].next) {
    int side = &c->fans[i] == f ? 0 : side_of(c, f, &c->fans[i]);
    before += side > 0;
    behind += side < 0;
  }
  vxm_vec3 along = along_all(c->sectors + f->begin, f->end - f->begin);
  if (before > 0 && behind > 0)
    return none;
  return behind > 0 ? along : plus(none, along, -1);
}

static void add_sector(contacts *c, size_t face, size_t i) {
  size_t corners;
  const uint32_t *corner = vxm_face(c->soup, face, &corners);
  const double *p = vxm_position(c->soup, corner[i]);
  vxm_vec3 normal = unit(vxm_polygon_area(c->soup->positions, corner, corners, 1));
  if (!(vxm_vec3_length(normal) > 0))
    return;
  const uint32_t ends[2] = {corner[i + 1 < corners ? i + 1 : 0], corner[i > 0 ? i - 1 : corners - 1]};
  sector *s = &c->sectors[c->fans[c->number[corner[i]]].end++];
  *s = (sector){.normal = normal};
  for (int k = 0; k < 2; k++) {
    s->ends[k] = ends[k];
    s->edges[k] = unit(vxm_vec3_between(vxm_position(c->soup, ends[k]), p, 1));
  }
}

/** Room for a sector of each face; those without area will have none. Returns how much. */
static size_t make_room(contacts *c) {
  size_t total = 0;
  for (size_t i = 0; i < c->soup->corner_count; i++)
    if (c->number[c->soup->indices[i]] != VXM_NO_VERTEX)
      c->fans[c->number[c->soup->indices[i]]].end++;
  for (size_t i = 0; i < c->count; i++) {
    size_t faces = c->fans[i].end;
    c->fans[i].begin = c->fans[i].end = total;
    total += faces;
  }
  return total;
}

static void link_fans(contacts *c) {
  for (size_t v = 0; v < c->soup->vertex_count; v++)
    c->firsts[v] = VXM_NO_VERTEX;
  for (size_t v = c->soup->vertex_count; v-- > 0;)
    if (c->number[v] != VXM_NO_VERTEX) {
      fan *f = &c->fans[c->number[v]];
      f->vertex = (uint32_t)v;
      f->next = c->firsts[c->map[v]];
      c->firsts[c->map[v]] = c->number[v];
    }
}

vxm_status vxm_contact_directions(vxm_vec3 *out, const vxm_soup *soup, const uint32_t *map,
                                  const uint32_t *number, size_t count, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  contacts c = {.soup = soup, .map = map, .number = number, .count = count};
  c.fans = vxm_calloc(soup->context, count, sizeof *c.fans, &local);
  if (c.fans)
    c.firsts = vxm_alloc(soup->context, soup->vertex_count, sizeof *c.firsts, &local);
  if (c.firsts)
    c.sectors = vxm_alloc(soup->context, make_room(&c), sizeof *c.sectors, &local);
  if (c.sectors) {
    link_fans(&c);
    for (size_t f = 0; f < soup->face_count; f++)
      for (uint64_t i = soup->offsets[f]; i < soup->offsets[f + 1]; i++)
        if (number[soup->indices[i]] != VXM_NO_VERTEX)
          add_sector(&c, f, (size_t)(i - soup->offsets[f]));
    for (size_t i = 0; i < count; i++)
      out[i] = direction_of(&c, &c.fans[i]);
  }
  vxm_free(soup->context, c.sectors);
  vxm_free(soup->context, c.firsts);
  vxm_free(soup->context, c.fans);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}
