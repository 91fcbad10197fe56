/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/verify.h"

#include "mesh/weld.h"
#include "meshio/meshio.h"
#include "repair/state/merge_rule.h"
#include "repair/state/self_intersections.h"
#include "repair/state/vertex_fans.h"

#include <string.h>

typedef struct verifying {
  vxm_verification *out;
  const vxm_repair_options *options;
  vxm_repair_state state; /**< the mesh after welding, its faces and vertices numbered as they were */
} verifying;

static void add(verifying *v, const char *what, int64_t count, int64_t element, const double *at) {
  if (count == 0)
    return;
  v->out->reached = false;
  if (v->out->count == VXM_FINDINGS_MAX)
    return;
  int i = v->out->count++;
  v->out->findings[i].what = what;
  v->out->findings[i].count = count;
  v->out->findings[i].element = element;
  v->out->findings[i].placed = at != NULL;
  for (int a = 0; a < 3; a++)
    v->out->findings[i].position[a] = at ? at[a] : 0;
}

/* ---- Nothing left to do ---- */

/** Passes that only number vertices anew do not count: a file may hold a vertex for every corner. Nor do
 * those that cut apart what a look at edges and vertices has found. */
static bool is_counted(int pass) {
  return pass != VXM_PASS_EXACT_WELD && pass != VXM_PASS_UNUSED && pass != VXM_PASS_CUT_NONMANIFOLD &&
         pass != VXM_PASS_PERTURB_COINCIDENT;
}

/** What another repair would do. */
static vxm_status verify_rest(verifying *v, const vxm_soup *soup, vxm_error *error) {
  vxm_repair_options again = *v->options;
  if (again.level > VXM_LEVEL_MANIFOLD)
    again.level = VXM_LEVEL_MANIFOLD;
  again.fill_holes = again.drop_faces = 0;
  again.hole_fill = VXM_HOLE_FILL_FAN;
  again.boolean_union = again.part_changes = again.intersections = false;
  if (again.wrap_alpha > 0)
    again.weld = VXM_WELD_OFF; /* the mesh was welded before it was wrapped, not after */
  again.wrap_alpha = again.wrap_offset = again.fallback_alpha = again.max_change = again.drop_volume = 0;
  vxm_pass_finding found[VXM_PASS_COUNT];
  vxm_status status = vxm_repair_try(found, soup, &again, error);
  for (int pass = 0; pass < VXM_PASS_COUNT && status == VXM_OK; pass++)
    if (is_counted(pass))
      add(v, found[pass].pass, found[pass].count, found[pass].placed ? found[pass].element : -1,
          found[pass].placed ? found[pass].at : NULL);
  return status;
}

/* ---- Edges and vertices ---- */

/** The first face that has a side along the edge. */
static int64_t face_at(const uint32_t *sides, const vxm_soup *soup, size_t edge) {
  for (size_t f = 0; f < soup->face_count; f++)
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++)
      if (sides[c] == edge)
        return (int64_t)f;
  return -1;
}

static void add_edges(verifying *v, const char *what, int64_t count, size_t first, const uint32_t *sides) {
  if (count == 0)
    return;
  const vxm_soup *soup = v->state.soup;
  const vxm_edge *edge = &v->state.edges.edges[first];
  const double *a = vxm_position(soup, edge->a), *b = vxm_position(soup, edge->b);
  double middle[3] = {a[0] / 2 + b[0] / 2, a[1] / 2 + b[1] / 2, a[2] / 2 + b[2] / 2};
  add(v, what, count, face_at(sides, soup, first), middle);
}

static void verify_edges(verifying *v, const uint32_t *sides) {
  enum { BOUNDARY, NONMANIFOLD, INCONSISTENT, KINDS };
  static const char *const names[KINDS] = {"boundary_edges", "nonmanifold_edges", "inconsistent_edges"};
  int64_t counts[KINDS] = {0};
  size_t first[KINDS] = {0};
  for (size_t e = v->state.edges.count; e-- > 0;) {
    const vxm_edge *edge = &v->state.edges.edges[e];
    int kind = edge->count == 1                         ? BOUNDARY
               : edge->count > 2                        ? NONMANIFOLD
               : edge->count == 2 && edge->forward != 1 ? INCONSISTENT
                                                        : KINDS;
    if (kind == KINDS)
      continue;
    counts[kind]++;
    first[kind] = e;
  }
  for (int kind = 0; kind < KINDS; kind++)
    if (kind != BOUNDARY || v->options->level >= VXM_LEVEL_CLOSED)
      add_edges(v, names[kind], counts[kind], first[kind], sides);
}

static vxm_status verify_vertices(verifying *v, vxm_error *error) {
  uint8_t *fans;
  vxm_status status = vxm_vertex_fans_count(&fans, &v->state, error);
  if (status != VXM_OK)
    return status;
  int64_t count = 0, first = -1;
  for (size_t i = v->state.soup->vertex_count; i-- > 0;)
    if (fans[i] > 1) {
      count++;
      first = (int64_t)i;
    }
  add(v, "nonmanifold_vertices", count, first, first < 0 ? NULL : vxm_position(v->state.soup, (size_t)first));
  vxm_free(v->state.context, fans);
  return VXM_OK;
}

static vxm_status verify_manifold(verifying *v, vxm_error *error) {
  vxm_status status = vxm_repair_state_edges(&v->state, error);
  if (status != VXM_OK)
    return status;
  verify_edges(v, v->state.edges.sides);
  return verify_vertices(v, error);
}

/* ---- Solid ---- */

static void add_face(verifying *v, const char *what, int64_t count, size_t first) {
  size_t corners;
  const uint32_t *corner = vxm_face(v->state.soup, first, &corners);
  add(v, what, count, (int64_t)first, vxm_position(v->state.soup, corner[0]));
}

/** Finds faces that look into the solid. How the parts lie in each other tells which bound a cavity. */
static vxm_status verify_outward(verifying *v, vxm_error *error) {
  const vxm_soup *soup = v->state.soup;
  const vxm_cgal *cgal;
  vxm_soup *turned = NULL;
  int64_t count = 0;
  vxm_status status = vxm_cgal_open(&cgal, "looking for the outside", error);
  if (status == VXM_OK)
    status = cgal->orient(&turned, &count, soup, error);
  for (size_t f = 0; status == VXM_OK && count > 0 && f < soup->face_count; f++)
    if (memcmp(soup->indices + soup->offsets[f], turned->indices + soup->offsets[f],
               (size_t)(soup->offsets[f + 1] - soup->offsets[f]) * sizeof *soup->indices) != 0) {
      add_face(v, "inward_faces", count, f);
      break;
    }
  vxm_soup_destroy(turned);
  return status;
}

static vxm_status verify_solid(verifying *v, vxm_error *error) {
  vxm_face_pairs pairs;
  vxm_status status = vxm_self_intersections_find(&pairs, v->state.soup, VXM_CROSSINGS_MOST, error);
  if (status == VXM_OK && pairs.count > 0)
    add_face(v, "self_intersections", (int64_t)pairs.count, pairs.pairs[0].first);
  vxm_free(v->state.context, pairs.pairs);
  return status == VXM_OK && v->out->reached ? verify_outward(v, error) : status;
}

/* ---- Other programs ---- */

/** Finds vertices that are apart, but so near that a program which merges near vertices would read another
 * mesh.
 */
static vxm_status verify_apart(verifying *v, const vxm_soup *soup, vxm_error *error) {
  vxm_extent extent;
  vxm_status status = VXM_OK;
  v->state.used = vxm_repair_state_scratch(&v->state, soup->vertex_count, 1, &status, error);
  uint32_t *map = vxm_repair_state_scratch(&v->state, soup->vertex_count, sizeof *map, &status, error);
  if (status != VXM_OK) {
    vxm_free(soup->context, map);
    return status;
  }
  vxm_repair_state_extent(&v->state, &extent); /* of the welded mesh: one vertex for each position is used */
  vxm_merge_rule rule = vxm_merge_rule_of(vxm_extent_diagonal(extent.bounds));
  if (rule != VXM_MERGE_EXACT)
    status = vxm_merge_map(soup->context, soup->positions, soup->vertex_count, rule, map, error);
  int64_t count = 0, first = -1;
  uint8_t *seen = rule != VXM_MERGE_EXACT
                      ? vxm_repair_state_scratch(&v->state, soup->vertex_count, 1, &status, error)
                      : NULL;
  for (size_t i = 0; seen && i < soup->vertex_count; i++) {
    if (!v->state.used[i])
      continue;
    if (seen[map[i]] && count++ == 0)
      first = (int64_t)i;
    seen[map[i]] = 1;
  }
  add(v, "near_vertices", count, first, first < 0 ? NULL : vxm_position(soup, (size_t)first));
  vxm_free(soup->context, seen);
  vxm_free(soup->context, map);
  return status;
}

/** Copies the soup as a program that welds would read it: vertices of the same position are the first of
 * them.
 */
static vxm_status weld(verifying *v, const vxm_soup *soup, vxm_error *error) {
  vxm_status status = vxm_soup_copy(&v->state.soup, soup, error);
  if (status != VXM_OK)
    return status;
  uint32_t *map = vxm_repair_state_scratch(&v->state, soup->vertex_count, sizeof *map, &status, error);
  if (status == VXM_OK)
    status = vxm_weld_exact(soup->context, soup->positions, soup->vertex_count, map, NULL, error);
  for (size_t c = 0; c < soup->corner_count && status == VXM_OK; c++)
    v->state.soup->indices[c] = map[soup->indices[c]];
  vxm_free(soup->context, map);
  return status;
}

static vxm_status verify_level(verifying *v, const vxm_soup *soup, vxm_error *error) {
  vxm_level level = v->options->level;
  vxm_status status = level >= VXM_LEVEL_MANIFOLD ? weld(v, soup, error) : VXM_OK;
  if (status == VXM_OK && level >= VXM_LEVEL_MANIFOLD)
    status = verify_manifold(v, error);
  if (status == VXM_OK && level >= VXM_LEVEL_MANIFOLD)
    status = verify_apart(v, soup, error);
  if (status == VXM_OK && level >= VXM_LEVEL_SOLID)
    status = verify_solid(v, error);
  return status;
}

vxm_status vxm_verify(vxm_verification *out, const vxm_soup *soup, const vxm_repair_options *options,
                      vxm_error *error) {
  *out = (vxm_verification){.reached = true};
  verifying v = {.out = out, .options = options, .state = {.context = soup->context, .options = *options}};
  vxm_status status = VXM_OK;
  if (soup->face_count == 0)
    add(&v, "no_faces", 1, -1, NULL);
  else
    status = verify_level(&v, soup, error);
  if (status == VXM_OK)
    status = verify_rest(&v, soup, error);
  vxm_repair_state_touch(&v.state);
  vxm_free(soup->context, v.state.used);
  vxm_soup_destroy(v.state.soup);
  if (status != VXM_OK)
    *out = (vxm_verification){0};
  return status;
}

/* ---- Writing ---- */

typedef struct checking {
  vxm_verification *out;
  const vxm_repair_options *repair;
  const char *path;
  bool best_effort;
} checking;

static const char *level_name(vxm_level level) {
  static const char *const names[] = {"clean", "manifold", "closed", "solid"};
  return names[level];
}

static vxm_status check(const vxm_soup *read_back, void *payload, vxm_error *error) {
  const checking *c = payload;
  vxm_status status = vxm_verify(c->out, read_back, c->repair, error);
  if (status != VXM_OK || c->out->reached || c->best_effort)
    return status;
  bool cut = strcmp(c->out->findings[0].what, "self_intersections") == 0 &&
             c->out->findings[0].count >= VXM_CROSSINGS_MOST;
  return vxm_fail(error, VXM_ERROR_UNREACHED, "%s: the level %s is not reached: %s%lld %s remain%s",
                  strcmp(c->path, "-") == 0 ? "<stdout>" : c->path, level_name(c->repair->level),
                  cut ? "at least " : "", (long long)c->out->findings[0].count, c->out->findings[0].what,
                  c->out->count > 1 ? ", and more" : "");
}

vxm_status vxm_write_verified(vxm_verification *out, const vxm_soup *soup, const char *path,
                              const vxm_mesh_write_options *write, const vxm_repair_options *repair,
                              bool best_effort, vxm_error *error) {
  *out = (vxm_verification){0};
  checking payload = {out, repair, path, best_effort};
  return vxm_meshio_write_checked(soup, path, write->format, vxm_write_flags_of(write), check, &payload,
                                  error);
}
