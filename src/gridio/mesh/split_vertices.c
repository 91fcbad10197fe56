/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/mesh/split_vertices.h"

/** The voxels about a lattice point that are set. */
static unsigned set_about(const vxm_grid *grid, uint64_t point) {
  unsigned set = 0;
  for (unsigned o = 0; o < 8; o++) {
    int64_t at[3];
    bool inside = true;
    for (int a = 0; a < 3; a++) {
      at[a] = (int64_t)vxm_quad_point_coordinate(point, a) - (o >> a & 1 ? 0 : 1);
      inside = inside && at[a] >= 0 && at[a] < grid->space.dims[a];
    }
    if (inside && vxm_grid_get(grid, at[0], at[1], at[2]))
      set |= 1u << o;
  }
  return set;
}

/** Whether the edge to the next vertex along an axis has four faces and at both ends one fan. */
static bool needs_middle(const vxm_split_vertices *s, uint32_t at, int along) {
  uint32_t next = s->lattice->next[along][at];
  if (!vxm_lattice_edge_pinched(s->set[at], along, true) || next == VXM_NO_CORNER)
    return false;
  int across = along == 0 ? 1 : 0; /* the two faces across this axis lie on either side */
  const uint8_t *here = s->fans.fan[s->set[at]], *there = s->fans.fan[s->set[next]];
  return here[vxm_lattice_face_at(across, along, true, false)] ==
             here[vxm_lattice_face_at(across, along, true, true)] &&
         there[vxm_lattice_face_at(across, along, false, false)] ==
             there[vxm_lattice_face_at(across, along, false, true)];
}

static size_t count_at(const vxm_split_vertices *s, uint32_t at, size_t *middles) {
  size_t count = s->fans.count[s->set[at]];
  for (int along = 0; along < 3; along++)
    if (needs_middle(s, at, along)) {
      count += 2;
      ++*middles;
    }
  return count;
}

/** Numbers the vertices; where each lattice vertex is one, no numbers are kept. */
static vxm_status number(vxm_split_vertices *s, vxm_error *error) {
  const size_t lattice = s->lattice->vertex_count;
  size_t count = 0;
  for (size_t v = 0; v < lattice; v++)
    count += count_at(s, (uint32_t)v, &s->middles);
  if (count >= VXM_NO_CORNER)
    return vxm_fail(error, VXM_ERROR_RANGE, "the surface has more than 2^32 vertices; lower the resolution");
  s->vertex_count = count;
  if (count == lattice)
    return VXM_OK;
  vxm_status status = VXM_OK;
  s->first = vxm_try_alloc(s->context, lattice, sizeof *s->first, &status, error);
  if (!s->first)
    return status;
  size_t next = 0, ignored;
  for (size_t v = 0; v < lattice; v++) {
    s->first[v] = (uint32_t)next;
    next += count_at(s, (uint32_t)v, &ignored);
  }
  return VXM_OK;
}

vxm_status vxm_split_vertices_find(vxm_split_vertices *out, const vxm_quad_vertices *lattice,
                                   const vxm_grid *grid, vxm_error *error) {
  *out = (vxm_split_vertices){.lattice = lattice, .context = lattice->context};
  vxm_status status = VXM_OK;
  vxm_lattice_fans_fill(&out->fans);
  out->set = vxm_try_alloc(out->context, lattice->vertex_count, 1, &status, error);
  if (!out->set)
    return status;
  for (size_t v = 0; v < lattice->vertex_count; v++)
    out->set[v] = (uint8_t)set_about(grid, lattice->points[v]);
  status = number(out, error);
  if (status != VXM_OK)
    vxm_split_vertices_destroy(out);
  return status;
}

void vxm_split_vertices_destroy(vxm_split_vertices *split) {
  vxm_free(split->context, split->first);
  vxm_free(split->context, split->set);
  split->first = NULL;
  split->set = NULL;
}

uint32_t vxm_split_vertex(const vxm_split_vertices *split, uint32_t at, unsigned face) {
  return split->first ? split->first[at] + split->fans.fan[split->set[at]][face] : at;
}

/** The side of the voxel that has a face, seen from an edge along `along`: 0 or 1 along the first of the
 * other two axes. */
static bool side_of(const vxm_split_vertices *s, uint32_t at, int along, unsigned face) {
  int across = (int)face / 4, first = along == 0 ? 1 : 0, other = 3 - across - along;
  bool far = other < along ? face & 1 : face >> 1 & 1; /* where the face lies along the other axis */
  if (other == first)
    return far;
  /* of the two voxels on the far side of the edge with this side along `other`, the one that is set */
  return s->set[at] >> (1u << along | 1u << first | (unsigned)far << other) & 1;
}

uint32_t vxm_split_middle(const vxm_split_vertices *split, uint32_t at, int along, unsigned face) {
  if (split->middles == 0 || !needs_middle(split, at, along))
    return VXM_NO_CORNER;
  uint32_t vertex = split->first[at] + split->fans.count[split->set[at]];
  for (int a = 0; a < along; a++)
    vertex += needs_middle(split, at, a) ? 2 : 0;
  return vertex + side_of(split, at, along, face);
}

/* ---- Places ---- */

/** The point on the lattice in model units; the same expression for every vertex, so equal points are equal.
 */
static double place(const vxm_space *space, double coordinate, int axis) {
  return space->origin[axis] + coordinate * space->voxel_size[axis];
}

/** Both middles of an edge: each within the voxel of its side. */
static double *place_middles(const vxm_split_vertices *s, const vxm_space *space, uint32_t at, int along,
                             double *p) {
  uint64_t point = s->lattice->points[at], next = s->lattice->points[s->lattice->next[along][at]];
  int first = along == 0 ? 1 : 0, second = 3 - along - first;
  for (int side = 0; side < 2; side++, p += 3) {
    bool far = s->set[at] >> (1u << along | (unsigned)side << first | 1u << second) & 1;
    for (int a = 0; a < 3; a++) {
      double x = vxm_quad_point_coordinate(point, a);
      double share = a == along ? 0 : (a == first ? side : far) ? VXM_SPLIT_SHARE : -VXM_SPLIT_SHARE;
      if (a == along)
        x += ((double)vxm_quad_point_coordinate(next, a) - x) / 2;
      p[a] = place(space, x + share, a);
    }
  }
  return p;
}

void vxm_split_vertices_place(const vxm_split_vertices *split, const vxm_space *space, double *positions) {
  double *p = positions;
  for (uint32_t v = 0; v < split->lattice->vertex_count; v++) {
    unsigned set = split->first ? split->set[v] : 0, fans = split->first ? split->fans.count[set] : 1;
    for (unsigned fan = 0; fan < fans; fan++, p += 3)
      for (int a = 0; a < 3; a++) {
        double share = fans > 1 ? VXM_SPLIT_SHARE * split->fans.toward[set][fan][a] : 0;
        p[a] = place(space, vxm_quad_point_coordinate(split->lattice->points[v], a) + share, a);
      }
    for (int along = 0; along < 3 && split->first; along++)
      if (needs_middle(split, v, along))
        p = place_middles(split, space, v, along, p);
  }
}
