/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/defects.h"

#include "mesh/duplicate_faces.h"
#include "mesh/nonfinite.h"
#include "mesh/weld.h"
#include "meshio/formats/write_marked.h"
#include "repair/state/self_intersections.h"
#include "repair/state/vertex_fans.h"

#include <string.h>

typedef struct finding {
  vxm_defects *defects;
  const vxm_soup *soup;
  size_t most;
  size_t of_kind;         /**< found of the present kind */
  vxm_repair_state state; /**< on a copy with welded corners */
  uint32_t *map;
  vxm_error error;
} finding;

const char *vxm_defect_name(vxm_defect_kind kind) {
  static const char *const names[VXM_DEFECT_KINDS] = {
      "nonfinite_vertex", "degenerate_face",   "duplicate_face",     "boundary_edge",
      "nonmanifold_edge", "inconsistent_edge", "nonmanifold_vertex", "self_intersection"};
  return kind >= 0 && kind < VXM_DEFECT_KINDS ? names[kind] : "";
}

/* ---- Entering ---- */

static bool enter(finding *f, const vxm_defect *defect) {
  vxm_defects *list = f->defects;
  if (f->of_kind++ >= f->most)
    return true;
  void *items = list->items;
  if (vxm_grow(list->context, &items, &list->capacity, list->count + 1, sizeof *list->items, &f->error) !=
      VXM_OK)
    return false;
  list->items = items;
  list->items[list->count] = *defect;
  list->items[list->count++].size = sizeof *defect;
  return true;
}

static void place(double at[3], const double p[3]) {
  memcpy(at, p, 3 * sizeof *at);
}

static void place_face(double at[3], const vxm_soup *soup, size_t face) {
  size_t count;
  const uint32_t *corner = vxm_face(soup, face, &count);
  for (int a = 0; a < 3; a++) {
    at[a] = 0;
    for (size_t i = 0; i < count; i++)
      at[a] += vxm_position(soup, corner[i])[a] / (double)count;
  }
}

static bool enter_vertex(finding *f, vxm_defect_kind kind, size_t vertex) {
  vxm_defect defect = {.kind = kind, .element = {(int64_t)vertex, -1}};
  place(defect.position, vxm_position(f->soup, vertex));
  place(defect.position + 3, vxm_position(f->soup, vertex));
  return enter(f, &defect);
}

static bool enter_face(finding *f, vxm_defect_kind kind, size_t face) {
  vxm_defect defect = {.kind = kind, .element = {(int64_t)face, -1}};
  place_face(defect.position, f->soup, face);
  memcpy(defect.position + 3, defect.position, 3 * sizeof *defect.position);
  return enter(f, &defect);
}

/* ---- Looking ---- */

static bool find_nonfinite(finding *f) {
  for (size_t v = 0; v < f->soup->vertex_count; v++)
    if (!vxm_is_finite(vxm_position(f->soup, v)) && !enter_vertex(f, VXM_DEFECT_NONFINITE_VERTEX, v))
      return false;
  return true;
}

static bool find_degenerate(finding *f) {
  vxm_extent extent;
  vxm_repair_state_extent(&f->state, &extent);
  vxm_unit_scale frame = vxm_unit_scale_of(extent.bounds);
  for (size_t i = 0; i < f->soup->face_count; i++) {
    size_t count;
    const uint32_t *corner = vxm_face(f->state.soup, i, &count);
    if (vxm_check_cancelled_at(i, f->state.context, &f->error) != VXM_OK)
      return false;
    bool bad = vxm_unit_scale_no_area(&frame, f->soup, i) || !vxm_face_has_three(corner, count, NULL);
    bad = bad && vxm_face_is_finite(f->soup, f->soup->indices + f->soup->offsets[i], count);
    if (bad && !enter_face(f, VXM_DEFECT_DEGENERATE_FACE, i))
      return false;
  }
  return true;
}

static bool find_duplicates(finding *f) {
  vxm_duplicates found;
  uint8_t *marks = vxm_calloc(f->state.context, f->soup->face_count, 1, &f->error);
  bool done =
      marks && vxm_duplicates_find(&found, f->state.context, f->state.soup, marks, NULL, &f->error) == VXM_OK;
  for (size_t i = 0; done && i < f->soup->face_count; i++)
    if (marks[i])
      done = enter_face(f, VXM_DEFECT_DUPLICATE_FACE, i);
  vxm_free(f->state.context, marks);
  return done;
}

static bool edge_is(const vxm_edge *edge, vxm_defect_kind kind) {
  if (kind == VXM_DEFECT_BOUNDARY_EDGE)
    return edge->count == 1;
  if (kind == VXM_DEFECT_NONMANIFOLD_EDGE)
    return edge->count > 2;
  return edge->count == 2 && edge->forward != 1;
}

static bool find_edges(finding *f, vxm_defect_kind kind) {
  const vxm_edges *edges = &f->state.edges;
  for (size_t e = 0; e < edges->count; e++) {
    const vxm_edge *edge = &edges->edges[e];
    if (!edge_is(edge, kind))
      continue;
    vxm_defect defect = {.kind = kind, .element = {edge->a, edge->b}};
    place(defect.position, vxm_position(f->soup, edge->a));
    place(defect.position + 3, vxm_position(f->soup, edge->b));
    if (!enter(f, &defect))
      return false;
  }
  return true;
}

/** Vertices of more than one fan, but for those of edges with too many faces, which tell it themselves. */
static bool find_vertices(finding *f) {
  uint8_t *fans;
  if (vxm_vertex_fans_count(&fans, &f->state, &f->error) != VXM_OK)
    return false;
  const vxm_edges *edges = &f->state.edges;
  for (size_t e = 0; e < edges->count; e++)
    if (edges->edges[e].count > 2)
      fans[edges->edges[e].a] = fans[edges->edges[e].b] = 0;
  bool done = true;
  for (size_t v = 0; done && v < f->soup->vertex_count; v++)
    if (fans[v] > 1)
      done = enter_vertex(f, VXM_DEFECT_NONMANIFOLD_VERTEX, v);
  vxm_free(f->state.context, fans);
  return done;
}

static bool find_intersections(finding *f) {
  vxm_face_pairs pairs;
  /* all are counted, whatever is listed */
  bool done = vxm_self_intersections_find(&pairs, f->state.soup, VXM_CROSSINGS_MOST, &f->error) == VXM_OK;
  for (size_t i = 0; done && i < pairs.count; i++) {
    vxm_defect defect = {.kind = VXM_DEFECT_SELF_INTERSECTION,
                         .element = {(int64_t)pairs.pairs[i].first, (int64_t)pairs.pairs[i].second}};
    place_face(defect.position, f->soup, pairs.pairs[i].first);
    place_face(defect.position + 3, f->soup, pairs.pairs[i].second);
    done = enter(f, &defect);
  }
  vxm_free(f->state.context, pairs.pairs);
  return done;
}

static bool find(finding *f, bool intersections) {
  bool done = true;
  for (vxm_defect_kind kind = 0; done && kind < VXM_DEFECT_KINDS; kind++) {
    f->of_kind = 0;
    if (vxm_progress(f->state.context, "inspecting", (double)kind / VXM_DEFECT_KINDS, &f->error) != VXM_OK)
      return false;
    done = kind == VXM_DEFECT_NONFINITE_VERTEX     ? find_nonfinite(f)
           : kind == VXM_DEFECT_DEGENERATE_FACE    ? find_degenerate(f)
           : kind == VXM_DEFECT_DUPLICATE_FACE     ? find_duplicates(f)
           : kind == VXM_DEFECT_NONMANIFOLD_VERTEX ? find_vertices(f)
           : kind == VXM_DEFECT_SELF_INTERSECTION  ? !intersections || find_intersections(f)
                                                   : find_edges(f, kind);
    f->defects->totals[kind] =
        kind == VXM_DEFECT_SELF_INTERSECTION && !intersections ? -1 : (int64_t)f->of_kind;
  }
  return done;
}

/** Makes the copy with welded corners and its edge map. */
static bool prepare(finding *f) {
  vxm_context *context = f->soup->context;
  f->state.context = context;
  f->map = vxm_alloc(context, f->soup->vertex_count, sizeof *f->map, &f->error);
  f->state.used = f->map ? vxm_alloc(context, f->soup->vertex_count, 1, &f->error) : NULL;
  if (!f->state.used || vxm_soup_copy(&f->state.soup, f->soup, &f->error) != VXM_OK)
    return false;
  if (vxm_weld_exact(context, f->soup->positions, f->soup->vertex_count, f->map, NULL, &f->error) != VXM_OK)
    return false;
  for (size_t c = 0; c < f->soup->corner_count; c++)
    f->state.soup->indices[c] = f->map[f->soup->indices[c]];
  vxm_nonfinite_collapse(f->state.soup->indices, f->soup); /* as the census does */
  return vxm_repair_state_edges(&f->state, &f->error) == VXM_OK;
}

vxm_status vxm_defects_find(vxm_defects **out, const vxm_soup *soup, size_t most, bool intersections,
                            vxm_error *error) {
  finding f = {.soup = soup, .most = most > 0 ? most : SIZE_MAX, .error = VXM_ERROR_INIT};
  *out = NULL;
  vxm_context *context;
  vxm_status status = vxm_context_acquire(&context, soup->context, error);
  if (status != VXM_OK)
    return status;
  f.defects = vxm_calloc(context, 1, sizeof *f.defects, &f.error);
  if (f.defects)
    *f.defects =
        (vxm_defects){.context = context, .vertex_count = soup->vertex_count, .face_count = soup->face_count};
  bool done = f.defects && prepare(&f) && find(&f, intersections);
  vxm_repair_state_touch(&f.state);
  vxm_soup_destroy(f.state.soup);
  vxm_free(context, f.state.used);
  vxm_free(context, f.map);
  if (done) {
    *out = f.defects;
    return VXM_OK;
  }
  if (f.defects)
    vxm_defects_destroy(f.defects);
  else
    vxm_context_release(context);
  vxm_error_pass(error, &f.error);
  return f.error.code;
}

void vxm_defects_destroy(vxm_defects *defects) {
  if (!defects)
    return;
  vxm_context *context = defects->context;
  vxm_free(context, defects->items);
  vxm_free(context, defects);
  vxm_context_release(context);
}

/* ---- In colour ---- */

vxm_status vxm_defects_paint(const vxm_defects *defects, const vxm_soup *soup, const char *path,
                             vxm_error *error) {
  static const vxm_colour colours[VXM_DEFECT_KINDS] = {
      [VXM_DEFECT_NONFINITE_VERTEX] = {0, 0, 0},        [VXM_DEFECT_DEGENERATE_FACE] = {230, 159, 0},
      [VXM_DEFECT_DUPLICATE_FACE] = {204, 121, 167},    [VXM_DEFECT_BOUNDARY_EDGE] = {213, 94, 0},
      [VXM_DEFECT_NONMANIFOLD_EDGE] = {0, 114, 178},    [VXM_DEFECT_INCONSISTENT_EDGE] = {0, 158, 115},
      [VXM_DEFECT_NONMANIFOLD_VERTEX] = {86, 180, 233}, [VXM_DEFECT_SELF_INTERSECTION] = {220, 20, 60}};
  vxm_error local = VXM_ERROR_INIT;
  vxm_marks marks = {.grey = {190, 190, 190}};
  marks.faces = vxm_alloc(soup->context, soup->face_count, sizeof *marks.faces, &local);
  marks.edges = marks.faces ? vxm_alloc(soup->context, defects->count, sizeof *marks.edges, &local) : NULL;
  for (size_t f = 0; marks.edges && f < soup->face_count; f++)
    marks.faces[f] = marks.grey;
  for (size_t i = 0; marks.edges && i < defects->count; i++) {
    const vxm_defect *defect = &defects->items[i];
    bool is_edge = defect->kind >= VXM_DEFECT_BOUNDARY_EDGE && defect->kind <= VXM_DEFECT_INCONSISTENT_EDGE;
    bool is_vertex =
        defect->kind == VXM_DEFECT_NONFINITE_VERTEX || defect->kind == VXM_DEFECT_NONMANIFOLD_VERTEX;
    if (is_edge)
      marks.edges[marks.edge_count++] = (vxm_marked_edge){
          (uint32_t)defect->element[0], (uint32_t)defect->element[1], colours[defect->kind]};
    else if (is_vertex) /* an edge of no length is how .ply can colour a vertex beside faces */
      marks.edges[marks.edge_count++] = (vxm_marked_edge){
          (uint32_t)defect->element[0], (uint32_t)defect->element[0], colours[defect->kind]};
    for (int e = 0; !is_edge && !is_vertex && e < 2; e++)
      if (defect->element[e] >= 0)
        marks.faces[defect->element[e]] = colours[defect->kind];
  }
  vxm_status status = marks.edges ? vxm_meshio_write_marked(soup, &marks, path, &local) : local.code;
  vxm_free(soup->context, marks.edges);
  vxm_free(soup->context, marks.faces);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
