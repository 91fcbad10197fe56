/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/bodies/hanging_sheets.h"

#include "repair/bodies/rimmed_sheets.h"
#include "repair/holes/fill_fans.h"

#include <string.h>

/** What the edges of sheets that are joined tell, at the face that stands for them. */
enum mark {
  HANGS = 1, /**< one has sides of other patches than sheets */
  HOLDS = 2  /**< one has an odd number of those: it would be open without the sheets */
};

typedef struct cutting {
  vxm_repair_state *state;
  vxm_soup *soup;
  vxm_edge_groups groups;
  vxm_rimmed_sheets sheets;
  bool of_closed;    /**< only those are cut off without which the faces that edges connect are closed */
  uint8_t *marks;    /**< per face that stands for sheets that are joined */
  uint8_t *unclosed; /**< per group: it is not closed without the sheets that hang */
  uint8_t *open;     /**< per face: of a component that is a sheet */
  size_t *at;        /**< per edge: scratch */
  vxm_error error;
} cutting;

static void *scratch(cutting *c, size_t count, size_t size) {
  return vxm_calloc(c->state->context, count, size, &c->error);
}

/** Asks now and then whether to go on. */
static bool goes_on(cutting *c, size_t step) {
  return vxm_check_cancelled_at(step, c->state->context, &c->error) == VXM_OK;
}

/** Whether there is a rim, and an edge that a sheet could hang on. */
static bool may_hang(const vxm_edges *edges) {
  bool rim = false, border = false;
  for (size_t e = 0; e < edges->count && !(rim && border); e++) {
    rim = rim || edges->edges[e].count == 1;
    border = border || edges->edges[e].count > 2;
  }
  return rim && border;
}

/* ---- Which sheets hang ---- */

/** Whether a face is of a sheet that hangs. */
static bool hangs(cutting *c, size_t face) {
  return c->sheets.sheet[face] && (c->marks[vxm_set_of(c->sheets.joined, face)] & (HANGS | HOLDS)) == HANGS;
}

/** Counts the sides of sheets at each edge; with `hanging` those of sheets that hang. */
static void count_sheets(cutting *c, bool hanging) {
  memset(c->at, 0, c->state->edges.count * sizeof *c->at);
  for (size_t f = 0; f < c->soup->face_count; f++)
    for (uint64_t s = c->soup->offsets[f]; s < c->soup->offsets[f + 1] && c->sheets.sheet[f]; s++)
      if (c->groups.sides[s] != VXM_NO_EDGE && (!hanging || hangs(c, f)))
        c->at[c->groups.sides[s]]++;
}

/** Sides along the edge that begins at a corner, without those that were counted. */
static size_t others_at(const cutting *c, uint64_t corner) {
  size_t edge = c->groups.sides[corner];
  return edge == VXM_NO_EDGE ? 0 : c->state->edges.edges[edge].count - c->at[edge];
}

/** Looks at what else is at the edges of sheets that are joined by now. All sheets at an edge are joined, so
 * that what is found of some holds whatever becomes of others. */
static bool look_at_edges(cutting *c) {
  count_sheets(c, false);
  for (size_t f = 0; f < c->soup->face_count && goes_on(c, f); f++)
    for (uint64_t s = c->soup->offsets[f]; s < c->soup->offsets[f + 1] && c->sheets.sheet[f]; s++) {
      size_t others = others_at(c, s);
      c->marks[vxm_set_of(c->sheets.joined, f)] |= others % 2 ? HOLDS : others ? HANGS : 0;
    }
  return c->error.code == VXM_OK;
}

/** Whether a face is to be cut off. */
static bool is_cut(cutting *c, size_t face) {
  return hangs(c, face) && (!c->unclosed[c->groups.of_face[face]] || c->open[face]);
}

/**
 * Chooses which of the hanging sheets are cut off: those without which the faces that edges connect are
 * closed, and those with which all of these would be a sheet for the voxelizer. The others stay: holes of
 * other bodies are capped with them as without, and what seems to hang on a shell full of holes may be a part
 * of it. *any: some are to be cut off.
 */
static bool choose(cutting *c, bool *any) {
  count_sheets(c, true);
  for (size_t f = 0; f < c->soup->face_count && goes_on(c, f); f++)
    for (uint64_t s = c->soup->offsets[f]; s < c->soup->offsets[f + 1] && !hangs(c, f); s++)
      if (others_at(c, s) % 2)
        c->unclosed[c->groups.of_face[f]] = 1;
  bool asks = false;
  for (size_t f = 0; f < c->soup->face_count && !asks && !c->of_closed; f++)
    asks = c->unclosed[c->groups.of_face[f]] && hangs(c, f);
  int64_t parts = c->state->open_parts; /* those that the pass of closing counted */
  if (asks && vxm_find_sheets(c->open, c->state, &c->error) != VXM_OK)
    return false;
  c->state->open_parts = parts;
  for (size_t f = 0; f < c->soup->face_count && !*any; f++)
    *any = is_cut(c, f);
  return c->error.code == VXM_OK;
}

/* ---- Cutting ---- */

/** Gives the sheets that are cut off their own vertices in the place of those that others have, too. Sheets
 * that share some go on doing so. @param number scratch per vertex */
static bool cut(cutting *c, size_t *number) {
  enum { OTHERS = 1 }; /* else 0, or 1 + the vertex of sheets, which is more */
  vxm_soup *soup = c->soup;
  size_t from = soup->vertex_count;
  for (size_t f = 0; f < soup->face_count && goes_on(c, f); f++)
    for (uint64_t s = soup->offsets[f]; s < soup->offsets[f + 1] && !is_cut(c, f); s++)
      number[soup->indices[s]] = OTHERS;
  for (size_t f = 0; f < soup->face_count && c->error.code == VXM_OK && goes_on(c, f); f++)
    for (uint64_t s = soup->offsets[f]; s < soup->offsets[f + 1] && is_cut(c, f); s++) {
      uint32_t vertex = soup->indices[s];
      const double x[3] = {soup->positions[3 * (size_t)vertex], soup->positions[3 * (size_t)vertex + 1],
                           soup->positions[3 * (size_t)vertex + 2]};
      if (number[vertex] == OTHERS) {
        if (vxm_soup_add_vertex(soup, x[0], x[1], x[2], &c->error) != VXM_OK)
          return false;
        number[vertex] = soup->vertex_count;
      }
      if (number[vertex] > 0)
        soup->indices[s] = (uint32_t)(number[vertex] - 1);
    }
  return c->error.code == VXM_OK &&
         vxm_repair_state_grow_marks(c->state, from, soup->vertex_count, &c->error);
}

static bool cut_sheets(cutting *c) {
  size_t faces = c->soup->face_count;
  bool any = false;
  if (vxm_edge_groups_find(&c->groups, c->state, &c->error) != VXM_OK ||
      vxm_rimmed_sheets_find(&c->sheets, c->state, &c->groups, &c->error) != VXM_OK)
    return false;
  if (!c->sheets.sheet)
    return true;
  c->marks = scratch(c, faces, sizeof *c->marks);
  c->open = c->marks ? scratch(c, faces, sizeof *c->open) : NULL;
  c->unclosed = c->open ? scratch(c, c->groups.count, sizeof *c->unclosed) : NULL;
  c->at = c->unclosed ? scratch(c, c->state->edges.count, sizeof *c->at) : NULL;
  if (!c->at || !look_at_edges(c) || !choose(c, &any))
    return false;
  size_t *number = any ? scratch(c, c->soup->vertex_count, sizeof *number) : NULL;
  bool done = !any || (number && cut(c, number));
  vxm_free(c->state->context, number);
  return done;
}

static vxm_status cut_off(vxm_repair_state *state, bool of_closed, int64_t *added, vxm_error *error) {
  *added = 0;
  vxm_status status = vxm_repair_state_edges(state, error);
  if (status != VXM_OK || !may_hang(&state->edges))
    return status;
  cutting c = {.state = state, .soup = state->soup, .of_closed = of_closed, .error = VXM_ERROR_INIT};
  size_t before = state->soup->vertex_count;
  bool done = cut_sheets(&c);
  vxm_free(state->context, c.at);
  vxm_free(state->context, c.unclosed);
  vxm_free(state->context, c.open);
  vxm_free(state->context, c.marks);
  vxm_rimmed_sheets_destroy(&c.sheets, state->context);
  vxm_edge_groups_destroy(&c.groups, state->context);
  *added = (int64_t)(state->soup->vertex_count - before);
  if (*added > 0)
    vxm_repair_state_touch(state);
  if (!done)
    vxm_error_pass(error, &c.error);
  return done ? VXM_OK : c.error.code;
}

vxm_status vxm_cut_hanging_sheets(vxm_repair_state *state, int64_t *added, vxm_error *error) {
  return cut_off(state, false, added, error);
}

/* ---- For a while ---- */

vxm_status vxm_take_sheets_off(vxm_hung_sheets *off, vxm_repair_state *state, vxm_error *error) {
  *off = (vxm_hung_sheets){0};
  vxm_status status = vxm_repair_state_edges(state, error);
  if (status != VXM_OK || !may_hang(&state->edges))
    return status;
  const vxm_soup *soup = state->soup;
  int64_t added = 0;
  off->vertex_count = soup->vertex_count;
  off->indices = vxm_repair_state_scratch(state, soup->corner_count, sizeof *off->indices, &status, error);
  if (!off->indices)
    return status;
  memcpy(off->indices, soup->indices, soup->corner_count * sizeof *off->indices);
  status = cut_off(state, true, &added, error);
  if (added == 0) {
    vxm_free(state->context, off->indices);
    off->indices = NULL;
  }
  return status;
}

void vxm_hang_sheets_again(vxm_hung_sheets *off, vxm_repair_state *state) {
  if (!off->indices)
    return;
  vxm_soup *soup = state->soup;
  memcpy(soup->indices, off->indices, soup->corner_count * sizeof *off->indices);
  soup->vertex_count = off->vertex_count;
  vxm_free(state->context, off->indices);
  off->indices = NULL;
  vxm_repair_state_touch(state);
}
