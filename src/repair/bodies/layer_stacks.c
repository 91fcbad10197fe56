/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/bodies/layer_stacks.h"

#include "base/hash.h"

#include <stdlib.h>

typedef struct member {
  const vxm_patch_border *border;
  size_t size;
  uint64_t hash;
  int64_t copies; /**< less than 0 if it runs against the first one of its stack */
} member;

static int by_border(const void *a, const void *b) {
  const member *s = a, *t = b;
  if (s->hash != t->hash)
    return s->hash < t->hash ? -1 : 1;
  if (s->size != t->size)
    return s->size < t->size ? -1 : 1;
  for (size_t i = 0; i < s->size; i++)
    if (s->border[i].edge != t->border[i].edge)
      return s->border[i].edge < t->border[i].edge ? -1 : 1;
  return 0;
}

static int by_border_then_patch(const void *a, const void *b) {
  const member *s = a, *t = b;
  int order = by_border(a, b);
  return order != 0 ? order : (s->border->patch > t->border->patch) - (s->border->patch < t->border->patch);
}

static size_t list_members(member *members, const vxm_patch_border *borders, size_t count) {
  size_t found = 0;
  for (size_t i = 0, j; i < count; i = j) {
    member m = {.border = borders + i};
    for (j = i; j < count && borders[j].patch == borders[i].patch; j++)
      m.hash = vxm_hash_word(m.hash, borders[j].edge);
    m.size = j - i;
    members[found++] = m;
  }
  qsort(members, found, sizeof *members, by_border_then_patch);
  return found;
}

/** Whether all run the same way along the border as the first one, or all the other way. */
static bool is_aligned(const member *m, const member *first) {
  for (size_t i = 1; i < m->size; i++)
    if (m->border[i].turn * first->border[i].turn != m->border[0].turn * first->border[0].turn)
      return false;
  return true;
}

static void choose(vxm_layers *l, const member *m, int64_t front) {
  l->front[m->border->patch] = front;
  l->known[m->border->patch] = true;
}

/** Places the members of a stack; those that run against the first one have their front behind them. */
static void place(vxm_layers *l, member *stack, size_t count, const int32_t *reach) {
  size_t first = stack[0].border->patch;
  int64_t sum = 0, front = l->front[first], with = front;
  int64_t behind = front == reach[2 * first] ? reach[2 * first + 1] : reach[2 * first];
  for (size_t i = 0; i < count; i++) {
    if (!is_aligned(&stack[i], &stack[0]) || l->known[stack[i].border->patch])
      return;
    int64_t copies = vxm_layers_surplus(l, stack[i].border->patch);
    stack[i].copies = stack[i].border->turn == stack[0].border->turn ? copies : -copies;
    sum += stack[i].copies;
  }
  if (behind - front != sum)
    return;
  for (size_t i = 0; i < count; i++)
    if (stack[i].copies > 0) {
      choose(l, &stack[i], with);
      with += stack[i].copies;
    }
  for (size_t i = 0; i < count; i++)
    if (stack[i].copies < 0) {
      with += stack[i].copies;
      choose(l, &stack[i], with);
    }
}

vxm_status vxm_layers_stack(vxm_layers *layers, const vxm_patch_border *borders, size_t count,
                            const int32_t *reach, vxm_error *error) {
  vxm_status status = VXM_OK;
  member *members = vxm_repair_state_scratch(layers->state, count, sizeof *members, &status, error);
  size_t found = members ? list_members(members, borders, count) : 0;
  for (size_t i = 0, j; i < found; i = j) {
    for (j = i; j < found && by_border(&members[i], &members[j]) == 0;)
      j++;
    if (j - i > 1)
      place(layers, members + i, j - i, reach);
  }
  vxm_free(layers->state->context, members);
  return status;
}
