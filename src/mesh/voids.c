/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/voids.h"

enum {
  LOOKS_MAX = 256,        /**< voids of a body that another one is compared with */
  LOOKS_IN_ALL = 1 << 27, /**< half a second or less */
  MOVES_MAX = 16          /**< voids that change their bodies to make room for one */
};

typedef struct surroundings {
  uint32_t *around;
  size_t count;
  bool known;
} surroundings;

typedef struct matching {
  const vxm_void_search *search;
  uint32_t *body;
  uint32_t *first;     /**< per body: one of its voids */
  uint32_t *next;      /**< per void: another one of its body */
  uint32_t *asked;     /**< per body: the last void for which room was to be made in it */
  uint8_t *moves;      /**< per body: a void of it may lie in others, too */
  surroundings *lists; /**< per component, as far as they were asked for */
  int64_t looks;
  vxm_error error;
} matching;

static bool is_wound_inward(const matching *m, uint32_t component) {
  return m->search->volume[component] < 0;
}

/** Whether a void could be cut out of it: a body that is wound the other way. */
static bool may_have(const matching *m, uint32_t body, uint32_t component) {
  return m->body[body] == VXM_NO_COMPONENT && m->search->volume[body] != 0 &&
         is_wound_inward(m, body) != is_wound_inward(m, component);
}

static void put(matching *m, uint32_t component, uint32_t body) {
  m->body[component] = body;
  m->next[component] = m->first[body];
  m->first[body] = component;
}

static void take(matching *m, uint32_t component) {
  uint32_t *link = &m->first[m->body[component]];
  while (*link != component)
    link = &m->next[*link];
  *link = m->next[component];
  m->body[component] = VXM_NO_COMPONENT;
}

/** How many voids of a body may overlap a component, 2 for more; one of them. */
static int count_rivals(matching *m, uint32_t component, uint32_t body, uint32_t *rival) {
  int count = 0, looks = 0;
  for (uint32_t v = m->first[body]; v != VXM_NO_COMPONENT && looks < LOOKS_MAX && count < 2; v = m->next[v]) {
    if (m->looks >= LOOKS_IN_ALL)
      break;
    looks++;
    m->looks++;
    if (!m->search->may_overlap(m->search->payload, v, component))
      continue;
    *rival = v;
    count++;
  }
  return count;
}

/** What is around a component; NULL after a failure. */
static const surroundings *look_around(matching *m, uint32_t component) {
  surroundings *list = &m->lists[component];
  if (!list->known) {
    vxm_status status =
        m->search->list_around(m->search->payload, component, &list->around, &list->count, &m->error);
    list->known = status == VXM_OK;
  }
  return list->known ? list : NULL;
}

/** Puts a component into a body that has no void where it is, if there is one. */
static bool put_if_free(matching *m, uint32_t component, const surroundings *list) {
  uint32_t rival;
  for (size_t i = 0; i < list->count; i++)
    if (may_have(m, list->around[i], component) && count_rivals(m, component, list->around[i], &rival) == 0) {
      put(m, component, list->around[i]);
      return true;
    }
  return false;
}

/** The same, and makes room in one where a single void is in the way that can go elsewhere. @param whose the
 * component that all that is for */
static bool make_room(matching *m, uint32_t component, uint32_t whose, int moves) {
  const surroundings *list = look_around(m, component);
  if (!list)
    return false;
  if (put_if_free(m, component, list))
    return true;
  for (size_t i = 0; i < list->count && moves > 0; i++) {
    uint32_t body = list->around[i], rival;
    if (m->asked[body] == whose || !may_have(m, body, component) ||
        count_rivals(m, component, body, &rival) != 1)
      continue;
    m->asked[body] = whose;
    take(m, rival);
    put(m, component, body);
    if (make_room(m, rival, whose, moves - 1))
      return true;
    take(m, component);
    put(m, rival, body);
    if (m->error.code != VXM_OK)
      return false;
  }
  return false;
}

/** Whether a component lies in a void of a body. */
static bool lies_in_void(const matching *m, const surroundings *list, uint32_t body) {
  for (size_t i = 0; i < list->count; i++)
    if (m->body[list->around[i]] == body)
      return true;
  return false;
}

/** Finds a body for what may be a void; if voids of all may overlap it, the first that has none around it. */
static void place(matching *m, uint32_t component) {
  if (make_room(m, component, component, MOVES_MAX))
    return;
  const surroundings *list = m->error.code == VXM_OK ? look_around(m, component) : NULL;
  for (size_t i = 0; list && i < list->count; i++)
    if (may_have(m, list->around[i], component) && !lies_in_void(m, list, list->around[i])) {
      put(m, component, list->around[i]);
      return;
    }
}

static void match(matching *m, uint32_t component) {
  const vxm_void_search *s = m->search;
  uint32_t parent = s->parent[component], rival;
  if (parent == VXM_NO_COMPONENT || s->volume[component] == 0)
    return;
  bool in_void = m->body[parent] != VXM_NO_COMPONENT;
  bool against = is_wound_inward(m, parent) != is_wound_inward(m, component);
  if (in_void == against)
    return; /* a body in a body, or in a void */
  bool several = in_void || s->may_have_several(s->payload, component);
  if (in_void || !may_have(m, parent, component) ||
      ((several || m->moves[parent]) && count_rivals(m, component, parent, &rival) > 0))
    place(m, component);
  else
    put(m, component, parent);
  uint32_t body = m->body[component];
  if (body != VXM_NO_COMPONENT)
    m->moves[body] |= several;
}

vxm_status vxm_voids_find(uint32_t *body, const vxm_void_search *search, vxm_error *error) {
  matching m = {.search = search, .body = body, .error = VXM_ERROR_INIT};
  vxm_context *context = search->context;
  m.first = vxm_alloc(context, search->count, sizeof *m.first, &m.error);
  m.next = vxm_alloc(context, search->count, sizeof *m.next, &m.error);
  m.asked = vxm_alloc(context, search->count, sizeof *m.asked, &m.error);
  m.moves = vxm_calloc(context, search->count, sizeof *m.moves, &m.error);
  m.lists = vxm_calloc(context, search->count, sizeof *m.lists, &m.error);
  bool done = m.first && m.next && m.asked && m.moves && m.lists;
  for (size_t i = 0; done && i < search->count; i++)
    body[i] = m.first[i] = m.next[i] = m.asked[i] = VXM_NO_COMPONENT;
  for (size_t i = search->order_count; done && i-- > 0;) {
    match(&m, search->order[i]);
    done = m.error.code == VXM_OK;
  }
  for (size_t i = 0; m.lists && i < search->count; i++)
    vxm_free(context, m.lists[i].around);
  vxm_free(context, m.lists);
  vxm_free(context, m.moves);
  vxm_free(context, m.asked);
  vxm_free(context, m.next);
  vxm_free(context, m.first);
  if (!done)
    vxm_error_pass(error, &m.error);
  return done ? VXM_OK : m.error.code;
}
