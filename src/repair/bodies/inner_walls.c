/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/bodies/inner_walls.h"

#include "mesh/geometry.h"
#include "mesh/point_in_mesh.h"
#include "repair/bodies/rimmed_sheets.h"
#include "repair/manifold/radial_sort.h"

#include <string.h>

/** Of the area of a group times the diagonal: a space of less volume is none. */
static const double NO_VOLUME = 1e-12;

/** What is found of a group. */
typedef struct finding {
  bool asked;           /**< it has an edge with three sides, five or so on */
  bool unclear;         /**< which spaces it bounds is not clear */
  bool walls;           /**< it has some */
  size_t outers;        /**< outer spaces; there should be one */
  double area, outward; /**< of its faces; of the skin that looks out, less that which looks in */
} finding;

typedef struct walling {
  vxm_repair_state *state;
  const vxm_soup *soup;
  const vxm_edge *edges;
  vxm_edge_groups groups;
  vxm_unit_scale frame;
  finding *findings; /**< per group */
  size_t *begin;     /**< per edge: where its sides begin in `at_edge`; one more */
  vxm_radial_side *at_edge;
  size_t *space;  /**< twice per face, of its front and its back: another side at the same space, or itself */
  double *volume; /**< the same, of the side that stands for a space: what the sides look away from */
  size_t *skin_begin, *skin; /**< per group: where its skin begins in `skin`; one more */
} walling;

static finding *finding_of(const walling *w, size_t face) {
  return &w->findings[w->groups.of_face[face]];
}

/** The side of a face that looks on in the order about an edge, or that which looks back. */
static size_t side_at(const vxm_radial_side *s, bool on) {
  return 2 * (size_t)s->face + (s->forward != on);
}

/* ---- Which groups ---- */

static bool mark_asked(walling *w) {
  bool any = false;
  for (size_t f = 0; f < w->soup->face_count; f++)
    for (uint64_t c = w->soup->offsets[f]; c < w->soup->offsets[f + 1]; c++) {
      uint32_t e = w->groups.sides[c];
      if (e == VXM_NO_EDGE || w->edges[e].count < 3 || !vxm_edge_is_odd(&w->edges[e]))
        continue;
      finding_of(w, f)->asked = true;
      any = true;
    }
  return any;
}

/* ---- Spaces ---- */

/** Lists the sides of the groups that are asked, by edge. */
static vxm_status list_sides(walling *w, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t edges = w->state->edges.count;
  w->begin = vxm_repair_state_scratch(w->state, edges + 1, sizeof *w->begin, &status, error);
  if (!w->begin)
    return status;
  for (size_t f = 0; f < w->soup->face_count; f++)
    for (uint64_t c = w->soup->offsets[f]; c < w->soup->offsets[f + 1] && finding_of(w, f)->asked; c++)
      if (w->groups.sides[c] != VXM_NO_EDGE)
        w->begin[w->groups.sides[c]]++;
  for (size_t e = 0; e < edges; e++)
    w->begin[e + 1] += w->begin[e]; /* where the sides of each end, so far */
  w->at_edge = vxm_repair_state_scratch(w->state, w->begin[edges], sizeof *w->at_edge, &status, error);
  for (size_t f = w->soup->face_count; w->at_edge && f-- > 0;)
    for (uint64_t c = w->soup->offsets[f]; c < w->soup->offsets[f + 1] && finding_of(w, f)->asked; c++) {
      uint32_t e = w->groups.sides[c];
      if (e != VXM_NO_EDGE)
        w->at_edge[--w->begin[e]] = (vxm_radial_side){
            .side = (uint32_t)c, .face = (uint32_t)f, .forward = w->soup->indices[c] == w->edges[e].a};
    }
  return status;
}

/** Joins the sides that look into one space at an edge. */
static void join_at(walling *w, const vxm_edge *edge, vxm_radial_side *s, size_t count) {
  if (count > 2)
    vxm_radial_sort_order(s, count, w->soup, vxm_position(w->soup, edge->a), vxm_position(w->soup, edge->b),
                          w->frame.scale);
  for (size_t i = 0; i < count; i++) {
    const vxm_radial_side *next = &s[i + 1 < count ? i + 1 : 0];
    finding_of(w, s->face)->unclear |= count > 2 && s[i].rank == next->rank;
    vxm_set_unite(w->space, side_at(&s[i], true), side_at(next, false));
  }
}

static vxm_status find_spaces(walling *w, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t faces = w->soup->face_count;
  w->space = vxm_repair_state_scratch(w->state, 2 * faces, sizeof *w->space, &status, error);
  if (w->space)
    w->volume = vxm_repair_state_scratch(w->state, 2 * faces, sizeof *w->volume, &status, error);
  for (size_t i = 0; w->space && i < 2 * faces; i++)
    w->space[i] = i;
  for (size_t e = 0; status == VXM_OK && e < w->state->edges.count; e++) {
    join_at(w, &w->edges[e], w->at_edge + w->begin[e], w->begin[e + 1] - w->begin[e]);
    status = vxm_check_cancelled_at(e, w->state->context, error);
  }
  return status;
}

/** Measures the spaces, and counts those that lie around their group. */
static void find_outers(walling *w) {
  for (size_t f = 0; f < w->soup->face_count; f++) {
    vxm_vec3 area;
    if (!finding_of(w, f)->asked)
      continue;
    double cone = vxm_face_cone(&area, w->soup, f, w->frame.centre, w->frame.scale);
    finding_of(w, f)->area += vxm_vec3_length(area);
    w->volume[vxm_set_of(w->space, 2 * f)] += cone;
    w->volume[vxm_set_of(w->space, 2 * f + 1)] -= cone;
  }
  for (size_t i = 0; i < 2 * w->soup->face_count; i++) {
    finding *g = finding_of(w, i / 2);
    if (g->asked && vxm_set_of(w->space, i) == i)
      g->outers += w->volume[i] > NO_VOLUME * g->area * w->frame.diagonal;
  }
}

/** Whether a side of a face (0 = its front, 1 = its back) looks out. */
static bool looks_out(walling *w, size_t face, size_t side) {
  const finding *g = finding_of(w, face);
  return w->volume[vxm_set_of(w->space, 2 * face + side)] > NO_VOLUME * g->area * w->frame.diagonal;
}

/** Whether a face looks out and has an edge to itself. */
static bool has_outer_rim(walling *w, size_t face) {
  bool rim = false;
  for (uint64_t c = w->soup->offsets[face]; c < w->soup->offsets[face + 1] && !rim; c++)
    rim = w->groups.sides[c] != VXM_NO_EDGE && w->edges[w->groups.sides[c]].count == 1;
  return rim && (looks_out(w, face, 0) || looks_out(w, face, 1));
}

/** What looks out and has a rim may be what is left of a body that is open: then nobody knows what was meant.
 * But sheets that hang on the skin bound nothing. */
static vxm_status find_rims(walling *w, vxm_error *error) {
  vxm_status status = VXM_OK;
  vxm_rimmed_sheets sheets = {0};
  bool known = false;
  for (size_t f = 0; f < w->soup->face_count && status == VXM_OK; f++) {
    finding *g = finding_of(w, f);
    if (!g->asked || g->unclear || !has_outer_rim(w, f))
      continue;
    if (!known)
      status = vxm_rimmed_sheets_find(&sheets, w->state, &w->groups, error);
    known = true;
    g->unclear = !sheets.sheet || !sheets.sheet[f];
  }
  vxm_rimmed_sheets_destroy(&sheets, w->state->context);
  return status;
}

/* ---- Whether walls lie within the skin ---- */

/** The faces of each group that have just one side which looks out, one group behind the other. */
static vxm_status list_skins(walling *w, vxm_error *error) {
  vxm_status status = VXM_OK;
  const size_t faces = w->soup->face_count;
  uint8_t *is_skin = vxm_repair_state_scratch(w->state, faces, sizeof *is_skin, &status, error);
  if (is_skin)
    w->skin_begin =
        vxm_repair_state_scratch(w->state, w->groups.count + 1, sizeof *w->skin_begin, &status, error);
  if (w->skin_begin)
    w->skin = vxm_repair_state_scratch(w->state, faces, sizeof *w->skin, &status, error);
  for (size_t f = 0; w->skin && f < faces; f++)
    is_skin[f] = looks_out(w, f, 0) != looks_out(w, f, 1);
  if (w->skin)
    vxm_edge_groups_list(&w->groups, faces, is_skin, w->skin_begin, w->skin);
  vxm_free(w->state->context, is_skin);
  return status;
}

/** Whether most of the rays from the middle of a wall find it within the skin. */
static vxm_status is_within(bool *within, vxm_point_in_mesh *skin, size_t wall, vxm_error *error) {
  size_t count;
  const uint32_t *corner = vxm_face(skin->soup, wall, &count);
  double middle[3] = {0, 0, 0};
  int votes = 0;
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 3; a++)
      middle[a] += vxm_position(skin->soup, corner[c])[a] * skin->scale / 3;
  vxm_status status = VXM_OK;
  for (int axis = 0, of_axis = 0; axis < 3 && status == VXM_OK; axis++, votes += of_axis)
    status = vxm_point_in_mesh_vote(skin, middle, axis, &of_axis, error);
  *within = votes > 3;
  return status;
}

/** Groups that cut through themselves bound other spaces than the order about their edges tells: walls may
 * come to lie outside. */
static vxm_status check_walls(walling *w, const uint8_t *remove, vxm_error *error) {
  vxm_status status = list_skins(w, error);
  vxm_point_in_mesh *skins = NULL;
  if (status == VXM_OK)
    skins = vxm_repair_state_scratch(w->state, w->groups.count, sizeof *skins, &status, error);
  for (size_t f = 0; f < w->soup->face_count && status == VXM_OK; f++) {
    const size_t g = w->groups.of_face[f];
    bool within = false;
    if (!remove[f] || w->findings[g].unclear)
      continue;
    if (!skins[g].soup) {
      skins[g] = (vxm_point_in_mesh){.soup = w->soup,
                                     .faces = w->skin + w->skin_begin[g],
                                     .face_count = w->skin_begin[g + 1] - w->skin_begin[g],
                                     .scale = w->frame.scale};
      vxm_point_in_mesh_find_box(&skins[g]);
    }
    status = is_within(&within, &skins[g], f, error);
    w->findings[g].unclear |= !within;
  }
  for (size_t g = 0; skins && g < w->groups.count; g++)
    if (skins[g].soup)
      vxm_point_in_mesh_release(&skins[g]);
  vxm_free(w->state->context, skins);
  return status;
}

/* ---- What becomes of the faces ---- */

static bool is_divided(const walling *w, size_t face) {
  const finding *g = finding_of(w, face);
  return g->asked && !g->unclear && g->outers == 1;
}

/** Marks the walls; returns whether there are any. */
static bool mark_walls(walling *w, uint8_t *remove) {
  bool any = false;
  for (size_t g = 0; g < w->groups.count; g++)
    w->findings[g].walls = false;
  for (size_t f = 0; f < w->soup->face_count; f++) {
    remove[f] = is_divided(w, f) && !looks_out(w, f, 0) && !looks_out(w, f, 1) &&
                !vxm_repair_state_guards(w->state, f);
    finding_of(w, f)->walls |= remove[f];
    any |= remove[f];
  }
  return any;
}

/** Which way a face of the skin looks: 1 out, -1 in; 0 = it is none. */
static int facing(walling *w, size_t face) {
  if (!is_divided(w, face) || !finding_of(w, face)->walls)
    return 0;
  return (int)looks_out(w, face, 0) - (int)looks_out(w, face, 1);
}

/** Turns the skin of each group as most of it is, so that cavities of it, which are turned against it, stay
 * such. */
static vxm_status turn_skin(walling *w, vxm_error *error) {
  vxm_status status = VXM_OK;
  vxm_repair_state *state = w->state;
  for (size_t f = 0; f < w->soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(w->soup, f, &count);
    finding_of(w, f)->outward +=
        facing(w, f) * vxm_vec3_length(vxm_polygon_area(w->soup->positions, corner, count, w->frame.scale));
  }
  if (!state->turned)
    state->turned =
        vxm_repair_state_scratch(state, w->soup->face_count, sizeof *state->turned, &status, error);
  for (size_t f = 0; state->turned && f < w->soup->face_count; f++)
    if (facing(w, f) == (finding_of(w, f)->outward < 0 ? 1 : -1)) {
      vxm_soup_reverse_face(state->soup, f);
      state->turned[f] ^= VXM_TURNED;
    }
  return status;
}

static vxm_status leave_skin(walling *w, bool *changed, vxm_error *error) {
  vxm_status status = VXM_OK;
  uint8_t *remove = vxm_repair_state_scratch(w->state, w->soup->face_count, sizeof *remove, &status, error);
  if (remove && mark_walls(w, remove))
    status = check_walls(w, remove, error);
  if (remove && status == VXM_OK && mark_walls(w, remove))
    status = turn_skin(w, error);
  if (remove && status == VXM_OK) {
    vxm_repair_state_note_marked(w->state, VXM_PASS_INNER_WALLS, remove);
    int64_t gone = vxm_repair_state_remove_faces(w->state, remove);
    w->state->counts[VXM_PASS_INNER_WALLS] += gone;
    *changed = gone > 0;
  }
  vxm_free(w->state->context, remove);
  return status;
}

/* ---- The pass ---- */

static vxm_status leave_walls_out(walling *w, bool *changed, vxm_error *error) {
  vxm_status status = vxm_edge_groups_find(&w->groups, w->state, error);
  if (status != VXM_OK)
    return status;
  w->edges = w->state->edges.edges;
  w->findings = vxm_repair_state_scratch(w->state, w->groups.count, sizeof *w->findings, &status, error);
  if (!w->findings || !mark_asked(w))
    return status;
  status = list_sides(w, error);
  if (status == VXM_OK)
    status = find_spaces(w, error);
  if (status != VXM_OK)
    return status;
  find_outers(w);
  status = find_rims(w, error);
  return status == VXM_OK ? leave_skin(w, changed, error) : status;
}

bool vxm_inner_walls_go(const vxm_repair_state *state) {
  return (state->divides || vxm_repair_state_reaches(state, VXM_LEVEL_CLOSED)) &&
         !state->options.keep_orientation;
}

vxm_status vxm_pass_inner_walls(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  if (!vxm_inner_walls_go(state))
    return VXM_OK;
  vxm_status status = vxm_repair_state_count_edges(state, error);
  if (status != VXM_OK || state->edges.odd == state->edges.open)
    return status;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  walling w = {.state = state, .soup = state->soup, .frame = vxm_unit_scale_of(extent.bounds)};
  status = leave_walls_out(&w, changed, error);
  vxm_free(state->context, w.skin);
  vxm_free(state->context, w.skin_begin);
  vxm_free(state->context, w.volume);
  vxm_free(state->context, w.space);
  vxm_free(state->context, w.at_edge);
  vxm_free(state->context, w.begin);
  vxm_free(state->context, w.findings);
  vxm_edge_groups_destroy(&w.groups, state->context);
  return status;
}
