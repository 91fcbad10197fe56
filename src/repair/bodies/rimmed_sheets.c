/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/bodies/rimmed_sheets.h"

#include "repair/holes/fill_fans.h"

#include <string.h>

/** What the edges of a patch tell, at the face that stands for it. */
enum mark {
  RIM = 1,   /**< one has no other side */
  BORDER = 2 /**< one has more than two sides */
};

typedef struct search {
  vxm_repair_state *state;
  const vxm_soup *soup;
  const vxm_edge_groups *groups;
  vxm_rimmed_sheets *out;
  uint8_t *marks; /**< per face that stands for a patch */
  size_t *at;     /**< per edge: scratch */
  vxm_error error;
} search;

static void *scratch(search *q, size_t count, size_t size) {
  return vxm_calloc(q->state->context, count, size, &q->error);
}

/** Asks now and then whether to go on. */
static bool goes_on(search *q, size_t step) {
  return vxm_check_cancelled_at(step, q->state->context, &q->error) == VXM_OK;
}

/** Sides along the edge that begins at a corner; 0 if there is none. */
static uint32_t sides_at(const search *q, uint64_t corner) {
  size_t edge = q->groups->sides[corner];
  return edge == VXM_NO_EDGE ? 0 : q->state->edges.edges[edge].count;
}

/* ---- Patches ---- */

/** Joins faces that meet at an edge with two sides, or, once they are known, sheets that meet at one with
 * more. */
static bool join_faces(search *q, bool sheets) {
  memset(q->at, 0, q->state->edges.count * sizeof *q->at);
  for (size_t f = 0; f < q->soup->face_count && goes_on(q, f); f++)
    for (uint64_t s = q->soup->offsets[f]; s < q->soup->offsets[f + 1]; s++) {
      uint32_t count = sides_at(q, s);
      if (sheets ? count <= 2 || !q->out->sheet[f] : count != 2)
        continue;
      size_t *other = &q->at[q->groups->sides[s]];
      if (*other == 0)
        *other = f + 1;
      else
        vxm_set_unite(q->out->joined, f, *other - 1);
    }
  return q->error.code == VXM_OK;
}

/** Finds the patches; *any: some have a rim and meet others. */
static bool find_patches(search *q, bool *any) {
  for (size_t f = 0; f < q->soup->face_count; f++)
    q->out->joined[f] = f;
  if (!join_faces(q, false))
    return false;
  for (size_t f = 0; f < q->soup->face_count && goes_on(q, f); f++) {
    uint8_t *marks = &q->marks[vxm_set_of(q->out->joined, f)];
    for (uint64_t s = q->soup->offsets[f]; s < q->soup->offsets[f + 1]; s++) {
      uint32_t count = sides_at(q, s);
      *marks |= count == 1 ? RIM : count > 2 ? BORDER : 0;
    }
    *any = *any || *marks == (RIM | BORDER);
  }
  return q->error.code == VXM_OK;
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

static bool add_face(search *q, apart *a, size_t face, size_t begin) {
  size_t count;
  const uint32_t *corner = vxm_face(q->soup, face, &count);
  for (size_t i = 0; i < count; i++) {
    const double *x = vxm_position(q->soup, corner[i]);
    size_t *number = &a->number[corner[i]];
    if (*number <= begin) { /* so far only other patches have it */
      if (vxm_soup_add_vertex(a->soup, x[0], x[1], x[2], &q->error) != VXM_OK)
        return false;
      *number = a->soup->vertex_count;
    }
    a->corners[i] = (uint32_t)(*number - 1);
  }
  return vxm_soup_add_face(a->soup, a->corners, count, &q->error) == VXM_OK;
}

/** Makes the soup, where each patch has vertices of its own. */
static bool make_apart(search *q, apart *a) {
  for (size_t f = q->soup->face_count; f-- > 0;) {
    size_t root = vxm_set_of(q->out->joined, f);
    a->next[f] = a->first[root];
    a->first[root] = f + 1;
  }
  for (size_t f = 0; f < q->soup->face_count && goes_on(q, f); f++)
    for (size_t g = q->marks[f] == (RIM | BORDER) ? a->first[f] : 0, begin = a->soup->vertex_count; g != 0;
         g = a->next[g - 1])
      if (!goes_on(q, g) || !add_face(q, a, g - 1, begin))
        return false;
  return q->error.code == VXM_OK;
}

/** Asks which components of it are sheets. */
static bool ask_apart(search *q, apart *a) {
  a->state = (vxm_repair_state){.context = q->state->context, .soup = a->soup};
  a->state.used = scratch(q, a->soup->vertex_count, sizeof *a->state.used);
  a->sheet = a->state.used ? scratch(q, a->soup->face_count, sizeof *a->sheet) : NULL;
  if (!a->sheet || vxm_find_sheets(a->sheet, &a->state, &q->error) != VXM_OK)
    return false;
  size_t next = 0;
  for (size_t f = 0; f < q->soup->face_count; f++)
    for (size_t g = q->marks[f] == (RIM | BORDER) ? a->first[f] : 0; g != 0; g = a->next[g - 1])
      q->out->sheet[g - 1] = a->sheet[next++];
  return true;
}

static bool find_sheets(search *q) {
  apart a = {0};
  size_t faces = q->soup->face_count;
  a.first = scratch(q, faces, sizeof *a.first);
  a.next = a.first ? scratch(q, faces, sizeof *a.next) : NULL;
  a.number = a.next ? scratch(q, q->soup->vertex_count, sizeof *a.number) : NULL;
  a.corners = a.number ? scratch(q, vxm_largest_face(q->soup), sizeof *a.corners) : NULL;
  bool done = a.corners && vxm_soup_create(&a.soup, q->state->context, "", &q->error) == VXM_OK;
  done = done && make_apart(q, &a) && ask_apart(q, &a);
  if (a.state.soup)
    vxm_repair_state_touch(&a.state);
  vxm_free(q->state->context, a.state.used);
  vxm_free(q->state->context, a.sheet);
  vxm_soup_destroy(a.soup);
  vxm_free(q->state->context, a.corners);
  vxm_free(q->state->context, a.number);
  vxm_free(q->state->context, a.next);
  vxm_free(q->state->context, a.first);
  return done;
}

/* ---- All of it ---- */

static bool find(search *q) {
  size_t faces = q->soup->face_count;
  bool any = false;
  q->out->joined = scratch(q, faces, sizeof *q->out->joined);
  q->marks = q->out->joined ? scratch(q, faces, sizeof *q->marks) : NULL;
  q->at = q->marks ? scratch(q, q->state->edges.count, sizeof *q->at) : NULL;
  if (!q->at || !find_patches(q, &any))
    return false;
  if (!any)
    return true;
  q->out->sheet = scratch(q, faces, sizeof *q->out->sheet);
  return q->out->sheet && find_sheets(q) && join_faces(q, true);
}

vxm_status vxm_rimmed_sheets_find(vxm_rimmed_sheets *out, vxm_repair_state *state,
                                  const vxm_edge_groups *groups, vxm_error *error) {
  *out = (vxm_rimmed_sheets){0};
  search q = {.state = state, .soup = state->soup, .groups = groups, .out = out, .error = VXM_ERROR_INIT};
  bool done = find(&q);
  vxm_free(state->context, q.at);
  vxm_free(state->context, q.marks);
  if (!done)
    vxm_error_pass(error, &q.error);
  return done ? VXM_OK : q.error.code;
}

void vxm_rimmed_sheets_destroy(vxm_rimmed_sheets *sheets, vxm_context *context) {
  vxm_free(context, sheets->joined);
  vxm_free(context, sheets->sheet);
  *sheets = (vxm_rimmed_sheets){0};
}
