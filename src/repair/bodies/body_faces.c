/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/bodies/body_faces.h"

#include "mesh/sort.h"

#include <stdlib.h>

/** A vertex of a body that is not its keeper. */
typedef struct claim {
  uint64_t body;
  uint32_t vertex, number; /**< of the soup that there is, and of the new one */
} claim;

typedef struct building {
  const vxm_body_faces *list;
  vxm_repair_state *state;
  const vxm_soup *soup;
  const vxm_group_rims *rims;
  uint64_t *keeper; /**< per vertex: the body that keeps it */
  claim *claims;    /**< sorted */
  size_t claim_count;
} building;

static int by_vertex_then_body(const void *a, const void *b) {
  const claim *s = a, *t = b;
  return vxm_compare_pairs(s->vertex, s->body, t->vertex, t->body);
}

/** The body that has the vertex of a face. */
static uint64_t body_at(const building *b, const vxm_body_face *q, uint32_t vertex) {
  bool is_open = q->body != 0 && vxm_group_is_open_at(b->rims, b->rims->groups->of_face[q->face], vertex);
  return is_open ? 0 : q->body;
}

static vxm_status find_keepers(building *b, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t v = 0; v < b->soup->vertex_count; v++)
    b->keeper[v] = UINT64_MAX;
  for (size_t i = 0; i < b->list->count && status == VXM_OK; i++) {
    const vxm_body_face *q = &b->list->faces[i];
    for (uint64_t c = b->soup->offsets[q->face]; c < b->soup->offsets[q->face + 1]; c++) {
      uint64_t body = body_at(b, q, b->soup->indices[c]), *least = &b->keeper[b->soup->indices[c]];
      *least = body < *least ? body : *least;
    }
    status = vxm_check_cancelled_at(i, b->state->context, error);
  }
  return status;
}

/** Lists which other bodies have which vertices; without a list only counts their corners. */
static size_t list_claims(const building *b, claim *claims) {
  size_t count = 0;
  for (size_t i = 0; i < b->list->count; i++) {
    const vxm_body_face *q = &b->list->faces[i];
    for (uint64_t c = b->soup->offsets[q->face]; c < b->soup->offsets[q->face + 1]; c++) {
      uint32_t vertex = b->soup->indices[c];
      uint64_t body = body_at(b, q, vertex);
      if (body != b->keeper[vertex] && claims)
        claims[count] = (claim){body, vertex, 0};
      count += body != b->keeper[vertex];
    }
  }
  return count;
}

/** Finds the claims, sorted and each once. */
static vxm_status find_claims(building *b, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t count = list_claims(b, NULL);
  b->claims = vxm_repair_state_scratch(b->state, count, sizeof *b->claims, &status, error);
  if (!b->claims)
    return status;
  list_claims(b, b->claims);
  qsort(b->claims, count, sizeof *b->claims, by_vertex_then_body);
  for (size_t i = 0; i < count; i++)
    if (i == 0 || by_vertex_then_body(&b->claims[i], &b->claims[b->claim_count - 1]) != 0)
      b->claims[b->claim_count++] = b->claims[i];
  return VXM_OK;
}

static vxm_status add_vertices(building *b, vxm_soup *out, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t v = 0; v < b->soup->vertex_count && status == VXM_OK; v++) {
    const double *x = vxm_position(b->soup, v);
    status = vxm_soup_add_vertex(out, x[0], x[1], x[2], error);
    if (status == VXM_OK)
      status = vxm_check_cancelled_at(v, b->state->context, error);
  }
  for (size_t i = 0; i < b->claim_count && status == VXM_OK; i++) {
    const double *x = vxm_position(b->soup, b->claims[i].vertex);
    b->claims[i].number = (uint32_t)out->vertex_count;
    status = vxm_soup_add_vertex(out, x[0], x[1], x[2], error);
  }
  return status;
}

/** What a body has in the place of a vertex. */
static uint32_t vertex_of(const building *b, uint64_t body, uint32_t vertex) {
  const claim wanted = {body, vertex, 0};
  if (body == b->keeper[vertex])
    return vertex;
  const claim *found = bsearch(&wanted, b->claims, b->claim_count, sizeof *b->claims, by_vertex_then_body);
  return found->number;
}

static vxm_status add_faces(building *b, vxm_soup *out, vxm_error *error) {
  vxm_status status = VXM_OK;
  uint32_t *corners =
      vxm_repair_state_scratch(b->state, vxm_largest_face(b->soup), sizeof *corners, &status, error);
  for (size_t i = 0; i < b->list->count && status == VXM_OK; i++) {
    const vxm_body_face *q = &b->list->faces[i];
    size_t size;
    const uint32_t *corner = vxm_face(b->soup, q->face, &size);
    for (size_t c = 0; c < size; c++) {
      uint32_t vertex = corner[q->reversed ? size - 1 - c : c];
      corners[c] = vertex_of(b, body_at(b, q, vertex), vertex);
    }
    status = vxm_soup_add_face(out, corners, size, error);
    if (status == VXM_OK)
      status = vxm_check_cancelled_at(i, b->state->context, error);
  }
  vxm_free(b->state->context, corners);
  return status;
}

static vxm_status make_soup(building *b, vxm_soup **out, vxm_error *error) {
  vxm_status status = VXM_OK;
  b->keeper = vxm_repair_state_scratch(b->state, b->soup->vertex_count, sizeof *b->keeper, &status, error);
  if (b->keeper)
    status = find_keepers(b, error);
  if (status == VXM_OK)
    status = find_claims(b, error);
  if (status == VXM_OK)
    status = vxm_soup_create(out, b->state->context, "", error);
  if (status == VXM_OK)
    status = add_vertices(b, *out, error);
  return status == VXM_OK ? add_faces(b, *out, error) : status;
}

vxm_status vxm_body_faces_add(vxm_body_faces *list, vxm_context *context, vxm_body_face face,
                              vxm_error *error) {
  void *block = list->faces;
  vxm_status status = VXM_OK;
  if (list->count == list->capacity)
    status = vxm_grow(context, &block, &list->capacity, list->count + 1, sizeof *list->faces, error);
  if (status != VXM_OK)
    return status;
  list->faces = block;
  list->faces[list->count++] = face;
  return VXM_OK;
}

vxm_status vxm_body_faces_build(const vxm_body_faces *list, vxm_repair_state *state,
                                const vxm_group_rims *rims, int64_t *added, vxm_error *error) {
  building b = {.list = list, .state = state, .soup = state->soup, .rims = rims};
  vxm_soup *out = NULL;
  vxm_status status = VXM_OK;
  uint64_t *origin = vxm_repair_state_scratch(state, list->count, sizeof *origin, &status, error);
  if (origin)
    status = make_soup(&b, &out, error);
  vxm_free(state->context, b.claims);
  vxm_free(state->context, b.keeper);
  if (status != VXM_OK) {
    vxm_free(state->context, origin);
    vxm_soup_destroy(out);
    return status;
  }
  for (size_t i = 0; i < list->count; i++) {
    origin[i] = list->faces[i].face;
    if (list->faces[i].reversed && state->turned)
      state->turned[origin[i]] ^= VXM_TURNED;
  }
  *added = (int64_t)(out->vertex_count - b.soup->vertex_count);
  return vxm_repair_state_adopt(state, out, origin, error);
}
