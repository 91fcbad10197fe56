/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/sort.h"
#include "repair/bodies/layer_stacks.h"

#include <stdlib.h>

/* Every layer is a closed surface: along each edge as many of its faces run one way as the other. What the
   patches that are known leave open along an edge, layer by layer, the others there have to close. */

enum { LEVELS_MAX = 64, TRIES_MAX = 64 };

typedef vxm_patch_border border;

/** A patch in the queue: how well its best layer fits. Those of more copies, which have less choice, come
 * first. */
typedef struct entry {
  double fit;
  int64_t copies;
  size_t patch;
} entry;

typedef struct balancing {
  vxm_layers *layers;
  const int32_t *reach;
  border *by_patch, *by_edge;
  size_t count;
  size_t *edge_number; /**< per edge: 1 + its number among those at borders, or 0 */
  size_t *begin;       /**< per face that stands for a patch: 1 + where its borders begin, or 0 */
  size_t *edge_begin;  /**< the same per number of an edge; one more */
  struct level {
    int32_t open;  /**< sides that run along the edge less those that run the other way */
    int32_t sides; /**< both together */
  } * level;       /**< per number of an edge and level */
  int32_t lowest;  /**< level 0 lies between winding numbers lowest - 1 and lowest */
  int levels;
  entry *heap;
  size_t waiting, capacity;
  uint8_t *tries; /**< per face that stands for a patch: how often it was queued */
  vxm_error error;
} balancing;

/* ---- The borders ---- */

static int by_patch_then_edge(const void *a, const void *b) {
  const border *s = a, *t = b;
  return vxm_compare_pairs(s->patch, s->edge, t->patch, t->edge);
}

static int by_edge_then_patch(const void *a, const void *b) {
  const border *s = a, *t = b;
  return vxm_compare_pairs(s->edge, s->patch, t->edge, t->patch);
}

/** Lists the sides where patches of groups that are asked for end; without a list only counts them. */
static size_t list_borders(balancing *b, const uint8_t *kinds) {
  const vxm_layers *l = b->layers;
  const vxm_soup *soup = l->state->soup;
  size_t count = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    if (!l->asked[l->groups->of_face[f]] || !vxm_layers_stands(l, f))
      continue;
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++) {
      size_t e = l->groups->sides[c];
      if (e == VXM_NO_EDGE || kinds[e] == 2)
        continue;
      if (b->by_patch)
        b->by_patch[count] =
            (border){vxm_set_of(l->patch, f), e, soup->indices[c] == l->state->edges.edges[e].a ? 1 : -1};
      count++;
    }
  }
  return count;
}

static void count_kinds(const vxm_layers *l, uint8_t *kinds) {
  const vxm_soup *soup = l->state->soup;
  for (size_t f = 0; f < soup->face_count; f++)
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1] && vxm_layers_stands(l, f); c++)
      if (l->groups->sides[c] != VXM_NO_EDGE && kinds[l->groups->sides[c]] < 3)
        kinds[l->groups->sides[c]]++;
}

static void number_borders(balancing *b) {
  qsort(b->by_patch, b->count, sizeof *b->by_patch, by_patch_then_edge);
  for (size_t i = b->count; i-- > 0;)
    b->begin[b->by_patch[i].patch] = i + 1;
  for (size_t i = 0; i < b->count; i++)
    b->by_edge[i] = b->by_patch[i];
  qsort(b->by_edge, b->count, sizeof *b->by_edge, by_edge_then_patch);
  size_t numbers = 0;
  for (size_t i = 0; i < b->count; i++) {
    if (i == 0 || b->by_edge[i].edge != b->by_edge[i - 1].edge) {
      b->edge_begin[numbers] = i;
      b->edge_number[b->by_edge[i].edge] = ++numbers;
    }
  }
  b->edge_begin[numbers] = b->count;
}

/* ---- How well a patch fits ---- */

static struct level *level_at(const balancing *b, size_t edge, int64_t level) {
  return &b->level[(b->edge_number[edge] - 1) * (size_t)b->levels + (size_t)(level - b->lowest)];
}

static bool has_levels(const balancing *b, int64_t front, int64_t surplus) {
  return front + 1 >= b->lowest && front + surplus < b->lowest + b->levels;
}

/** Of a side: as much as it speaks against a layer that this is closed along the edge already. */
static const double CLOSED_ALREADY = 0.25;

/** How much less is open along its border with the patch before this winding number, per side: -1 to 1. */
static double fit_of(const balancing *b, size_t patch, int64_t front) {
  int64_t surplus = vxm_layers_surplus(b->layers, patch);
  double gain = 0, sides = 0;
  for (size_t i = b->begin[patch] - 1; i < b->count && b->by_patch[i].patch == patch; i++)
    for (int64_t k = front + 1; k <= front + surplus; k++) {
      const struct level *level = level_at(b, b->by_patch[i].edge, k);
      gain += abs(level->open) - abs(level->open + b->by_patch[i].turn);
      gain -= level->open == 0 && level->sides > 0 ? CLOSED_ALREADY : 0;
      sides++;
    }
  return sides > 0 ? gain / sides : 0;
}

/** Whether a layer lies on the other side of 0 than what the rays of its patch have met. That is empty, so
 * that every closed patch would suit it, and would be turned inside out. */
static bool is_beyond_zero(const balancing *b, size_t patch, int64_t front, int64_t surplus) {
  int64_t least = b->reach[2 * patch], most = b->reach[2 * patch + 1];
  return least + most >= 0 ? front < 0 && front < least : front + surplus > 0 && front + surplus > most;
}

/** The winding number before a patch that suits its border best: of several the one nearest to its rays. */
static double best_fit(const balancing *b, size_t patch, int64_t *front) {
  int64_t surplus = vxm_layers_surplus(b->layers, patch);
  int64_t least = b->reach[2 * patch], most = b->reach[2 * patch + 1];
  double best = -3;
  for (int64_t outside = 0; outside <= surplus; outside++)
    for (int64_t f = least - outside; f + surplus <= most + outside; f++) {
      if (is_beyond_zero(b, patch, f, surplus))
        continue;
      double fit = has_levels(b, f, surplus) ? fit_of(b, patch, f) : -2;
      if (fit > best) {
        best = fit;
        *front = f;
      }
    }
  return best;
}

/** Puts a patch into the layers behind this winding number. */
static void place(balancing *b, size_t patch, int64_t front) {
  int64_t surplus = vxm_layers_surplus(b->layers, patch);
  for (size_t i = b->begin[patch] - 1; i < b->count && b->by_patch[i].patch == patch; i++)
    for (int64_t k = front + 1; k <= front + surplus; k++) {
      struct level *level = level_at(b, b->by_patch[i].edge, k);
      level->open += b->by_patch[i].turn;
      level->sides++;
    }
  b->layers->front[patch] = front;
  b->layers->known[patch] = true;
}

/* ---- The queue: a heap, the best fit first and of equal ones the lowest number ---- */

static bool comes_first(entry a, entry b) {
  if (a.fit != b.fit)
    return a.fit > b.fit;
  return a.copies != b.copies ? a.copies > b.copies : a.patch < b.patch;
}

static bool push(balancing *b, entry e) {
  if (b->waiting == b->capacity) {
    void *block = b->heap;
    if (vxm_grow(b->layers->state->context, &block, &b->capacity, b->waiting + 1, sizeof *b->heap,
                 &b->error) != VXM_OK)
      return false;
    b->heap = block;
  }
  size_t at = b->waiting++;
  for (; at > 0 && comes_first(e, b->heap[(at - 1) / 2]); at = (at - 1) / 2)
    b->heap[at] = b->heap[(at - 1) / 2];
  b->heap[at] = e;
  return true;
}

static entry pop(balancing *b) {
  entry first = b->heap[0], last = b->heap[--b->waiting];
  size_t at = 0;
  for (size_t child; (child = 2 * at + 1) < b->waiting; at = child) {
    if (child + 1 < b->waiting && comes_first(b->heap[child + 1], b->heap[child]))
      child++;
    if (!comes_first(b->heap[child], last))
      break;
    b->heap[at] = b->heap[child];
  }
  if (b->waiting > 0)
    b->heap[at] = last;
  return first;
}

static bool push_patch(balancing *b, size_t patch) {
  int64_t front;
  if (b->layers->known[patch] || b->tries[patch] >= TRIES_MAX)
    return true;
  b->tries[patch]++;
  double fit = best_fit(b, patch, &front);
  return push(b, (entry){fit, vxm_layers_surplus(b->layers, patch), patch});
}

static bool push_neighbours(balancing *b, size_t patch) {
  for (size_t i = b->begin[patch] - 1; i < b->count && b->by_patch[i].patch == patch; i++) {
    size_t number = b->edge_number[b->by_patch[i].edge] - 1;
    for (size_t j = b->edge_begin[number]; j < b->edge_begin[number + 1]; j++)
      if (!push_patch(b, b->by_edge[j].patch))
        return false;
  }
  return true;
}

static bool place_all(balancing *b) {
  for (size_t i = 0; i < b->count; i++)
    if (i == 0 || b->by_patch[i].patch != b->by_patch[i - 1].patch) {
      size_t patch = b->by_patch[i].patch;
      if (b->layers->known[patch])
        place(b, patch, b->layers->front[patch]);
    }
  for (size_t i = 0; i < b->count; i++)
    if ((i == 0 || b->by_patch[i].patch != b->by_patch[i - 1].patch) && !push_patch(b, b->by_patch[i].patch))
      return false;
  while (b->waiting > 0) {
    entry next = pop(b);
    int64_t front = 0;
    if (b->layers->known[next.patch])
      continue;
    double fit = best_fit(b, next.patch, &front);
    if (fit < next.fit) { /* what it was fitted to has been taken since */
      if (!push(b, (entry){fit, next.copies, next.patch}))
        return false;
      continue;
    }
    place(b, next.patch, front);
    if (!push_neighbours(b, next.patch))
      return false;
  }
  return true;
}

/* ---- All of it ---- */

/** The levels between the winding numbers of all patches, and as many copies more; false if they are too
 * many. */
static bool find_levels(balancing *b) {
  int64_t low = 0, high = 0, more = 0;
  for (size_t i = 0; i < b->count; i++) {
    size_t patch = b->by_patch[i].patch;
    int64_t surplus = vxm_layers_surplus(b->layers, patch);
    low = b->reach[2 * patch] < low ? b->reach[2 * patch] : low;
    high = b->reach[2 * patch + 1] > high ? b->reach[2 * patch + 1] : high;
    more = surplus > more ? surplus : more;
  }
  b->lowest = (int32_t)(low - more + 1);
  b->levels = high - low + 2 * more <= LEVELS_MAX ? (int)(high - low + 2 * more) : 0;
  return b->levels > 0;
}

static void *scratch(balancing *b, size_t count, size_t size) {
  vxm_status status = VXM_OK;
  return vxm_repair_state_scratch(b->layers->state, count, size, &status, &b->error);
}

static bool balance(balancing *b, uint8_t *kinds) {
  size_t faces = b->layers->state->soup->face_count, edges = b->layers->state->edges.count;
  count_kinds(b->layers, kinds);
  b->count = list_borders(b, kinds);
  b->by_edge = scratch(b, b->count, sizeof *b->by_edge);
  b->by_patch = b->by_edge ? scratch(b, b->count, sizeof *b->by_patch) : NULL;
  b->edge_number = b->by_patch ? scratch(b, edges, sizeof *b->edge_number) : NULL;
  b->edge_begin = b->edge_number ? scratch(b, b->count + 1, sizeof *b->edge_begin) : NULL;
  b->begin = b->edge_begin ? scratch(b, faces, sizeof *b->begin) : NULL;
  b->tries = b->begin ? scratch(b, faces, sizeof *b->tries) : NULL;
  if (!b->tries)
    return false;
  list_borders(b, kinds);
  number_borders(b);
  if (vxm_layers_stack(b->layers, b->by_patch, b->count, b->reach, &b->error) != VXM_OK)
    return false;
  if (b->count == 0 || !find_levels(b))
    return true;
  size_t numbers = b->edge_number[b->by_edge[b->count - 1].edge];
  b->level = scratch(b, numbers, (size_t)b->levels * sizeof *b->level);
  return b->level && place_all(b);
}

vxm_status vxm_layers_balance(vxm_layers *layers, const int32_t *reach, vxm_error *error) {
  balancing b = {.layers = layers, .reach = reach, .error = VXM_ERROR_INIT};
  vxm_context *context = layers->state->context;
  uint8_t *kinds = scratch(&b, layers->state->edges.count, sizeof *kinds);
  bool done = kinds && balance(&b, kinds);
  vxm_free(context, b.heap);
  vxm_free(context, b.level);
  vxm_free(context, b.tries);
  vxm_free(context, b.begin);
  vxm_free(context, b.edge_begin);
  vxm_free(context, b.edge_number);
  vxm_free(context, b.by_patch);
  vxm_free(context, b.by_edge);
  vxm_free(context, kinds);
  if (!done)
    vxm_error_pass(error, &b.error);
  return done ? VXM_OK : b.error.code;
}
