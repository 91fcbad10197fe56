/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/bodies/hanging_sheets.h"

#include "repair/holes/fill_fans.h"
#include "repair/state/edge_groups.h"

#include <string.h>

/** What the edges of a patch tell, at the face that stands for it. */
enum mark {
  RIM = 1,    /**< one has no other side */
  BORDER = 2, /**< one has more than two sides */
  HANGS = 4,  /**< one has sides of other patches than sheets */
  HOLDS = 8   /**< one has an odd number of those: it would be open without the sheets */
};

typedef struct cutting {
  vxm_repair_state *state;
  vxm_soup *soup;
  vxm_edge_groups groups;
  size_t *patch;     /**< per face: another one of its patch, or itself; see vxm_set_of */
  uint8_t *marks;    /**< per face that stands for a patch */
  uint8_t *sheet;    /**< per face */
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

/** Sides along the edge that begins at a corner; 0 if there is none. */
static uint32_t sides_at(const cutting *c, uint64_t corner) {
  size_t edge = c->groups.sides[corner];
  return edge == VXM_NO_EDGE ? 0 : c->state->edges.edges[edge].count;
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

/* ---- Patches ---- */

/** Joins faces that meet at an edge with two sides, or, once they are known, sheets that meet at one with
 * more. */
static bool join_faces(cutting *c, bool sheets) {
  memset(c->at, 0, c->state->edges.count * sizeof *c->at);
  for (size_t f = 0; f < c->soup->face_count && goes_on(c, f); f++)
    for (uint64_t s = c->soup->offsets[f]; s < c->soup->offsets[f + 1]; s++) {
      uint32_t count = sides_at(c, s);
      if (sheets ? count <= 2 || !c->sheet[f] : count != 2)
        continue;
      size_t *other = &c->at[c->groups.sides[s]];
      if (*other == 0)
        *other = f + 1;
      else
        vxm_set_unite(c->patch, f, *other - 1);
    }
  return c->error.code == VXM_OK;
}

/** Finds the patches; *any: some have a rim and meet others. */
static bool find_patches(cutting *c, bool *any) {
  for (size_t f = 0; f < c->soup->face_count; f++)
    c->patch[f] = f;
  if (!join_faces(c, false))
    return false;
  for (size_t f = 0; f < c->soup->face_count && goes_on(c, f); f++) {
    uint8_t *marks = &c->marks[vxm_set_of(c->patch, f)];
    for (uint64_t s = c->soup->offsets[f]; s < c->soup->offsets[f + 1]; s++) {
      uint32_t count = sides_at(c, s);
      *marks |= count == 1 ? RIM : count > 2 ? BORDER : 0;
    }
    *any = *any || *marks == (RIM | BORDER);
  }
  return c->error.code == VXM_OK;
}

/* ---- Which patches are sheets ---- */

/** The patches that may be sheets, as a soup. */
typedef struct apart {
  vxm_soup *soup;
  uint8_t *sheet;         /**< per face of it */
  size_t *first, *next;   /**< per face: 1 + the first face of its patch, 1 + the one that follows it */
  size_t *number;         /**< per vertex: 1 + the last one that stands for it there */
  uint32_t *corners;      /**< scratch per corner of a face */
  vxm_repair_state state; /**< of it */
} apart;

static bool add_face(cutting *c, apart *a, size_t face, size_t begin) {
  size_t count;
  const uint32_t *corner = vxm_face(c->soup, face, &count);
  for (size_t i = 0; i < count; i++) {
    const double *x = vxm_position(c->soup, corner[i]);
    size_t *number = &a->number[corner[i]];
    if (*number <= begin) { /* so far only other patches have it */
      if (vxm_soup_add_vertex(a->soup, x[0], x[1], x[2], &c->error) != VXM_OK)
        return false;
      *number = a->soup->vertex_count;
    }
    a->corners[i] = (uint32_t)(*number - 1);
  }
  return vxm_soup_add_face(a->soup, a->corners, count, &c->error) == VXM_OK;
}

/** Makes the soup, where each patch has vertices of its own. */
static bool make_apart(cutting *c, apart *a) {
  for (size_t f = c->soup->face_count; f-- > 0;) {
    size_t root = vxm_set_of(c->patch, f);
    a->next[f] = a->first[root];
    a->first[root] = f + 1;
  }
  for (size_t f = 0; f < c->soup->face_count && goes_on(c, f); f++)
    for (size_t g = c->marks[f] == (RIM | BORDER) ? a->first[f] : 0, begin = a->soup->vertex_count; g != 0;
         g = a->next[g - 1])
      if (!goes_on(c, g) || !add_face(c, a, g - 1, begin))
        return false;
  return c->error.code == VXM_OK;
}

/** Asks which components of it are sheets. */
static bool ask_apart(cutting *c, apart *a) {
  a->state = (vxm_repair_state){.context = c->state->context, .soup = a->soup};
  a->state.used = scratch(c, a->soup->vertex_count, sizeof *a->state.used);
  a->sheet = a->state.used ? scratch(c, a->soup->face_count, sizeof *a->sheet) : NULL;
  if (!a->sheet || vxm_find_sheets(a->sheet, &a->state, &c->error) != VXM_OK)
    return false;
  size_t next = 0;
  for (size_t f = 0; f < c->soup->face_count; f++)
    for (size_t g = c->marks[f] == (RIM | BORDER) ? a->first[f] : 0; g != 0; g = a->next[g - 1])
      c->sheet[g - 1] = a->sheet[next++];
  return true;
}

static size_t largest_face(const vxm_soup *soup) {
  size_t largest = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count = (size_t)(soup->offsets[f + 1] - soup->offsets[f]);
    largest = count > largest ? count : largest;
  }
  return largest;
}

static bool find_sheets(cutting *c) {
  apart a = {0};
  size_t faces = c->soup->face_count;
  a.first = scratch(c, faces, sizeof *a.first);
  a.next = a.first ? scratch(c, faces, sizeof *a.next) : NULL;
  a.number = a.next ? scratch(c, c->soup->vertex_count, sizeof *a.number) : NULL;
  a.corners = a.number ? scratch(c, largest_face(c->soup), sizeof *a.corners) : NULL;
  bool done = a.corners && vxm_soup_create(&a.soup, c->state->context, "", &c->error) == VXM_OK;
  done = done && make_apart(c, &a) && ask_apart(c, &a);
  if (a.state.soup)
    vxm_repair_state_touch(&a.state);
  vxm_free(c->state->context, a.state.used);
  vxm_free(c->state->context, a.sheet);
  vxm_soup_destroy(a.soup);
  vxm_free(c->state->context, a.corners);
  vxm_free(c->state->context, a.number);
  vxm_free(c->state->context, a.next);
  vxm_free(c->state->context, a.first);
  return done;
}

/* ---- Which sheets hang ---- */

/** Whether a face is of a sheet that hangs. */
static bool hangs(cutting *c, size_t face) {
  return c->sheet[face] && (c->marks[vxm_set_of(c->patch, face)] & (HANGS | HOLDS)) == HANGS;
}

/** Counts the sides of sheets at each edge; with `hanging` those of sheets that hang. */
static void count_sheets(cutting *c, bool hanging) {
  memset(c->at, 0, c->state->edges.count * sizeof *c->at);
  for (size_t f = 0; f < c->soup->face_count; f++)
    for (uint64_t s = c->soup->offsets[f]; s < c->soup->offsets[f + 1] && c->sheet[f]; s++)
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
    for (uint64_t s = c->soup->offsets[f]; s < c->soup->offsets[f + 1] && c->sheet[f]; s++) {
      size_t others = others_at(c, s);
      c->marks[vxm_set_of(c->patch, f)] |= others % 2 ? HOLDS : others ? HANGS : 0;
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
  for (size_t f = 0; f < c->soup->face_count && !asks; f++)
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
  if (vxm_edge_groups_find(&c->groups, c->state, &c->error) != VXM_OK)
    return false;
  c->patch = scratch(c, faces, sizeof *c->patch);
  c->marks = c->patch ? scratch(c, faces, sizeof *c->marks) : NULL;
  c->sheet = c->marks ? scratch(c, faces, sizeof *c->sheet) : NULL;
  c->open = c->sheet ? scratch(c, faces, sizeof *c->open) : NULL;
  c->unclosed = c->open ? scratch(c, c->groups.count, sizeof *c->unclosed) : NULL;
  c->at = c->unclosed ? scratch(c, c->state->edges.count, sizeof *c->at) : NULL;
  if (!c->at || !find_patches(c, &any))
    return false;
  if (!any)
    return true;
  if (!find_sheets(c) || !join_faces(c, true) || !look_at_edges(c))
    return false;
  any = false;
  if (!choose(c, &any))
    return false;
  size_t *number = any ? scratch(c, c->soup->vertex_count, sizeof *number) : NULL;
  bool done = !any || (number && cut(c, number));
  vxm_free(c->state->context, number);
  return done;
}

vxm_status vxm_cut_hanging_sheets(vxm_repair_state *state, int64_t *added, vxm_error *error) {
  *added = 0;
  vxm_status status = vxm_repair_state_edges(state, error);
  if (status != VXM_OK || !may_hang(&state->edges))
    return status;
  cutting c = {.state = state, .soup = state->soup, .error = VXM_ERROR_INIT};
  size_t before = state->soup->vertex_count;
  bool done = cut_sheets(&c);
  vxm_free(state->context, c.at);
  vxm_free(state->context, c.unclosed);
  vxm_free(state->context, c.open);
  vxm_free(state->context, c.sheet);
  vxm_free(state->context, c.marks);
  vxm_free(state->context, c.patch);
  vxm_edge_groups_destroy(&c.groups, state->context);
  *added = (int64_t)(state->soup->vertex_count - before);
  if (*added > 0)
    vxm_repair_state_touch(state);
  if (!done)
    vxm_error_pass(error, &c.error);
  return done ? VXM_OK : c.error.code;
}
