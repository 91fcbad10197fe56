/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/repair_state.h"

#include "base/threads.h"
#include "repair/external/cgal.h"

#include <string.h>

void *vxm_repair_state_scratch(vxm_repair_state *state, size_t count, size_t size, vxm_status *status,
                               vxm_error *error) {
  return vxm_try_calloc(state->context, count, size, status, error);
}

vxm_status vxm_repair_state_edges(vxm_repair_state *state, vxm_error *error) {
  if (state->has_edges)
    return VXM_OK;
  if (state->has_counts) /* without a list */
    vxm_edges_destroy(&state->edges);
  vxm_status status = vxm_edges_build_sides(&state->edges, state->context, state->soup, NULL, error);
  state->has_edges = state->has_counts = status == VXM_OK;
  return status;
}

vxm_status vxm_repair_state_count_edges(vxm_repair_state *state, vxm_error *error) {
  if (state->has_counts)
    return VXM_OK;
  vxm_status status = vxm_edges_build_pairs(&state->edges, state->context, state->soup, error);
  state->has_counts = status == VXM_OK;
  state->has_edges = state->edges.edges != NULL;
  return status;
}

vxm_status vxm_repair_state_patches(vxm_repair_state *state, vxm_error *error) {
  vxm_status status = state->has_patches ? VXM_OK : vxm_repair_state_count_edges(state, error);
  if (status == VXM_OK && !state->has_patches && state->edges.crowded == 0) {
    status = vxm_patches_build(&state->patches, state->soup, &state->edges, error);
    state->has_patches = status == VXM_OK;
  }
  return status;
}

void vxm_repair_state_extent(vxm_repair_state *state, vxm_extent *extent) {
  if (!state->has_extent)
    vxm_extent_of(&state->extent, state->context, state->soup, state->used);
  state->has_extent = true;
  *extent = state->extent;
}

vxm_status vxm_repair_state_measure(vxm_repair_state *state, uint8_t *flat, vxm_error *error) {
  if (state->has_sums && !flat)
    return VXM_OK;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  vxm_unit_scale frame = vxm_unit_scale_of(extent.bounds);
  vxm_status status = vxm_surface_sums_of(&state->sums, state->soup, extent.bounds, &frame, flat, error);
  state->has_sums = status == VXM_OK;
  return status;
}

void vxm_repair_state_move(vxm_repair_state *state) {
  state->has_extent = state->has_sums = false;
}

static void drop_edges(vxm_repair_state *state) {
  if (state->has_counts)
    vxm_edges_destroy(&state->edges);
  state->has_counts = state->has_edges = false;
}

/** Lets the edge map follow a face that was turned. */
static void turn_sides(vxm_edges *edges, const vxm_soup *soup, size_t face) {
  uint64_t begin = soup->offsets[face], end = soup->offsets[face + 1];
  for (uint64_t i = begin, j = end; i + 1 < j; i++) {
    j--;
    uint32_t kept = edges->sides[i];
    edges->sides[i] = edges->sides[j];
    edges->sides[j] = kept;
  }
  for (uint64_t c = begin; c < end; c++) {
    if (edges->sides[c] == VXM_NO_EDGE)
      continue;
    vxm_edge *edge = &edges->edges[edges->sides[c]];
    edges->against -= edge->count == 2 && edge->forward != 1;
    edge->forward += soup->indices[c] == edge->a ? 1 : UINT32_MAX;
    edges->against += edge->count == 2 && edge->forward != 1;
  }
}

void vxm_repair_state_turn(vxm_repair_state *state, const uint8_t *turned) {
  /* without such edges there may turn out to be nothing but pairs, of which less is to be known */
  bool follows = state->has_edges && state->edges.crowded > 0;
  for (size_t f = 0; follows && f < state->soup->face_count; f++)
    if (turned[f])
      turn_sides(&state->edges, state->soup, f);
  if (!follows)
    drop_edges(state);
  state->has_sums = state->is_manifold = false;
}

void vxm_repair_state_touch(vxm_repair_state *state) {
  drop_edges(state);
  state->is_manifold = false;
  vxm_repair_state_move(state);
  if (state->has_patches)
    vxm_patches_destroy(&state->patches);
  state->has_patches = false;
}

/* ---- The first of what a pass changes ---- */

static void note(vxm_pass_finding *first, int64_t element, const double *p) {
  first->placed = true;
  first->element = element;
  for (int a = 0; a < 3; a++)
    first->at[a] = p[a];
}

void vxm_repair_state_note_vertex(vxm_repair_state *state, vxm_pass pass, size_t vertex) {
  if (!state->firsts[pass].placed)
    note(&state->firsts[pass], (int64_t)vertex, vxm_position(state->soup, vertex));
}

void vxm_repair_state_note_face(vxm_repair_state *state, vxm_pass pass, size_t face) {
  size_t count;
  const uint32_t *corner = vxm_face(state->soup, face, &count);
  if (!state->firsts[pass].placed && count > 0)
    note(&state->firsts[pass], state->renumbered ? -1 : (int64_t)face, vxm_position(state->soup, corner[0]));
}

void vxm_repair_state_note_merge(vxm_repair_state *state, vxm_pass pass, const uint32_t *map) {
  for (size_t v = 0; v < state->soup->vertex_count && !state->firsts[pass].placed; v++)
    if (map[v] != v && !state->gone[v])
      vxm_repair_state_note_vertex(state, pass, v);
}

void vxm_repair_state_note_marked(vxm_repair_state *state, vxm_pass pass, const uint8_t *marks) {
  for (size_t f = 0; f < state->soup->face_count && !state->firsts[pass].placed; f++)
    if (marks[f])
      vxm_repair_state_note_face(state, pass, f);
}

/* ---- Merging vertices ---- */

enum { CORNERS_PER_SLICE = 1 << 16 };

typedef struct merging {
  vxm_soup *soup;
  const uint32_t *map;
} merging;

static void merge_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const merging *m = payload;
  size_t begin = slice * CORNERS_PER_SLICE, end = begin + CORNERS_PER_SLICE;
  if (end > m->soup->corner_count)
    end = m->soup->corner_count;
  for (size_t c = begin; c < end; c++)
    m->soup->indices[c] = m->map[m->soup->indices[c]];
}

int64_t vxm_repair_state_merge(vxm_repair_state *state, const uint32_t *map) {
  int64_t count = 0;
  for (size_t v = 0; v < state->soup->vertex_count; v++)
    if (map[v] != v) {
      count += !state->gone[v];
      state->gone[v] = 1;
    }
  if (state->provenance)
    vxm_provenance_merge(state->provenance, map);
  if (count > 0) {
    merging m = {state->soup, map};
    vxm_parallel(state->context, state->soup->corner_count / CORNERS_PER_SLICE + 1, merge_slice, &m);
    vxm_repair_state_touch(state);
  }
  return count;
}

/* ---- Removing faces ---- */

void vxm_repair_state_renumber(vxm_repair_state *state, size_t from, size_t to) {
  vxm_soup *soup = state->soup;
  if (soup->face_tags)
    soup->face_tags[to] = soup->face_tags[from];
  if (soup->face_parts)
    soup->face_parts[to] = soup->face_parts[from];
  if (state->turned)
    state->turned[to] = state->turned[from];
}

int64_t vxm_repair_state_remove_faces(vxm_repair_state *state, const uint8_t *remove) {
  vxm_soup *soup = state->soup;
  size_t kept = 0, corners = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    uint64_t begin = soup->offsets[f];
    size_t count = (size_t)(soup->offsets[f + 1] - begin);
    if (remove[f])
      continue;
    if (kept < f) {
      memmove(soup->indices + corners, soup->indices + begin, count * sizeof *soup->indices);
      soup->offsets[kept] = corners;
      vxm_repair_state_renumber(state, f, kept);
    }
    kept++;
    corners += count;
  }
  int64_t removed = (int64_t)(soup->face_count - kept);
  soup->offsets[kept] = corners;
  soup->face_count = kept;
  soup->corner_count = corners;
  if (removed > 0) {
    state->renumbered = true;
    vxm_repair_state_touch(state);
  }
  return removed;
}

/* ---- Taking over what a module has made ---- */

/** Gives each face the number that its origin has in `from`, or that of the face before it where it has none.
 */
static uint32_t *inherit(vxm_repair_state *state, const uint32_t *from, const vxm_soup *soup,
                         const uint64_t *origin, vxm_status *status, vxm_error *error) {
  uint32_t *numbers = vxm_repair_state_scratch(state, soup->face_count, sizeof *numbers, status, error);
  uint32_t last = 0;
  for (size_t f = 0; numbers && f < soup->face_count; f++) {
    if (origin[f] != VXM_NO_FACE)
      last = from[origin[f]];
    numbers[f] = last;
  }
  return numbers;
}

static vxm_status take_tags(vxm_repair_state *state, vxm_soup *soup, const uint64_t *origin,
                            vxm_error *error) {
  const vxm_soup *old = state->soup;
  vxm_status status = VXM_OK;
  vxm_free(state->context, soup->face_tags);
  soup->face_tags = NULL;
  if (old->face_tags)
    soup->face_tags = inherit(state, old->face_tags, soup, origin, &status, error);
  if (status == VXM_OK && old->face_parts)
    soup->face_parts = inherit(state, old->face_parts, soup, origin, &status, error);
  for (size_t t = soup->tag_count; soup->face_tags && t < old->tag_count && status == VXM_OK; t++) {
    uint32_t tag;
    status = vxm_soup_add_tag(soup, old->tags[t], strlen(old->tags[t]), &tag, error);
  }
  return status;
}

/** Which faces were turned goes on with them. */
static vxm_status take_turned(vxm_repair_state *state, const vxm_soup *soup, const uint64_t *origin,
                              vxm_error *error) {
  if (!state->turned)
    return VXM_OK;
  vxm_status status = VXM_OK;
  uint8_t *turned = vxm_repair_state_scratch(state, soup->face_count, sizeof *turned, &status, error);
  for (size_t f = 0; turned && f < soup->face_count; f++)
    turned[f] = origin && origin[f] != VXM_NO_FACE ? state->turned[origin[f]] : VXM_ADDED;
  vxm_free(state->context, state->turned);
  state->turned = turned;
  return status;
}

void vxm_repair_state_mark_added(vxm_repair_state *state, size_t first) {
  for (size_t f = first; state->turned && f < state->soup->face_count; f++)
    state->turned[f] = VXM_ADDED;
}

bool vxm_repair_state_grow_marks(vxm_repair_state *state, size_t from, size_t to, vxm_error *error) {
  uint8_t **marks[2] = {&state->gone, &state->used};
  for (int i = 0; i < 2; i++) {
    uint8_t *grown = vxm_realloc(state->context, *marks[i], to, 1, error);
    if (!grown)
      return false;
    memset(grown + from, 0, to - from);
    *marks[i] = grown;
  }
  return true;
}

vxm_status vxm_repair_state_renew(vxm_repair_state *state, vxm_error *error) {
  size_t vertices = state->soup->vertex_count;
  vxm_status status = VXM_OK;
  vxm_free(state->context, state->gone);
  vxm_free(state->context, state->used);
  state->used = NULL;
  state->gone = vxm_repair_state_scratch(state, vertices, sizeof *state->gone, &status, error);
  if (state->gone)
    state->used = vxm_repair_state_scratch(state, vertices, sizeof *state->used, &status, error);
  if (status != VXM_OK)
    return status;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  for (size_t v = 0; v < vertices; v++)
    state->gone[v] = !state->used[v]; /* what is left over was not unused in the mesh */
  return VXM_OK;
}

vxm_status vxm_repair_state_adopt(vxm_repair_state *state, vxm_soup *soup, uint64_t *origin,
                                  vxm_error *error) {
  vxm_status status = origin ? take_tags(state, soup, origin, error) : VXM_OK;
  if (status == VXM_OK)
    status = take_turned(state, soup, origin, error);
  vxm_free(state->context, origin);
  if (status != VXM_OK) {
    vxm_soup_destroy(soup);
    return status;
  }
  for (size_t i = 0; i < 3 * soup->vertex_count; i++)
    soup->positions[i] = vxm_repair_state_round(state, soup->positions[i]);
  state->renumbered = true;
  soup->format = state->soup->format;
  soup->warnings = state->soup->warnings;
  vxm_repair_state_touch(state);
  vxm_soup_destroy(state->soup);
  state->soup = soup;
  return vxm_repair_state_renew(state, error);
}
