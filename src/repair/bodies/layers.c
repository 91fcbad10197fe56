/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/bodies/layers.h"

#include "repair/state/face_set_sides.h"

#include <stdlib.h>

enum { SAMPLES = 5, MORE_FACES = 16 /**< of a patch of which those do not tell enough */ };

static bool is_asked(const vxm_layers *l, size_t face) {
  return l->asked[l->groups->of_face[face]] && vxm_layers_stands(l, face);
}

/** Joins the faces that stand for their kinds over edges where two of them meet and no others do. */
static vxm_status find_patches(vxm_layers *l, vxm_error *error) {
  const vxm_soup *soup = l->state->soup;
  vxm_status status = VXM_OK;
  size_t edges = l->state->edges.count;
  size_t *pair = vxm_repair_state_scratch(l->state, edges, 2 * sizeof *pair, &status, error);
  uint8_t *count = pair ? vxm_repair_state_scratch(l->state, edges, sizeof *count, &status, error) : NULL;
  for (size_t f = 0; status == VXM_OK && f < soup->face_count; f++) {
    l->patch[f] = f;
    status = vxm_check_cancelled_at(f, l->state->context, error);
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1] && is_asked(l, f); c++) {
      size_t e = l->groups->sides[c];
      if (e == VXM_NO_EDGE || count[e] > 2)
        continue;
      if (count[e] < 2)
        pair[2 * e + count[e]] = f;
      count[e]++;
    }
  }
  for (size_t e = 0; status == VXM_OK && e < edges; e++)
    if (count[e] == 2)
      vxm_set_unite(l->patch, pair[2 * e], pair[2 * e + 1]);
  vxm_free(l->state->context, count);
  vxm_free(l->state->context, pair);
  return status;
}

/** Whether a face stands for a sheet of a group that is asked for. */
static bool is_sheet(const vxm_layers *l, size_t face) {
  return l->asked[l->groups->of_face[face]] && vxm_layers_surplus(l, face) == 0 &&
         l->copies[face].first == face;
}

/** Lists some faces of each patch, spread over it, and all sheets; marks all that count, those around a group
 * too. @param size scratch per face, twice */
static size_t list_samples(vxm_layers *l, uint8_t *bound, vxm_face_set_side *sets, size_t *size) {
  size_t faces = l->state->soup->face_count, count = 0, *seen = size + faces;
  for (size_t f = 0; f < faces; f++) {
    int64_t surplus = vxm_layers_surplus(l, f);
    bound[f] = l->groups->groups[l->groups->of_face[f]].balanced
                   ? surplus > 0 && l->copies[f].rank < (uint64_t)surplus
                   : l->copies[f].first == f;
    size[vxm_set_of(l->patch, f)] += is_asked(l, f);
  }
  for (size_t f = 0; f < faces; f++) {
    if (is_sheet(l, f))
      sets[count++] = (vxm_face_set_side){.face = f, .set = f};
    if (!is_asked(l, f))
      continue;
    size_t root = vxm_set_of(l->patch, f), step = size[root] / SAMPLES + 1;
    if (seen[root]++ % step == 0)
      sets[count++] = (vxm_face_set_side){.face = f, .set = root};
  }
  return count;
}

/** Takes what most of the samples of a patch say; where none has sides that differ by its copies, finds
 * between what they lie. */
static void take_answers(vxm_layers *l, const vxm_face_set_side *sets, size_t count, int32_t *reach) {
  size_t root = sets[0].set;
  int64_t surplus = vxm_layers_surplus(l, root);
  int most = 0;
  for (size_t i = 0; i < count; i++) {
    int votes = 0;
    for (size_t j = 0; j < count; j++)
      votes += sets[j].front == sets[i].front && sets[j].back == sets[i].back;
    bool fits = sets[i].back - sets[i].front == surplus;
    l->cut[root] = l->cut[root] || (fits && l->known[root] && sets[i].front != l->front[root]);
    if (votes > (fits && !l->known[root] ? 0 : most) && (fits || !l->known[root])) {
      most = votes;
      l->known[root] = fits;
      l->front[root] = sets[i].front;
      reach[2 * root] = sets[i].front < sets[i].back ? sets[i].front : sets[i].back;
      reach[2 * root + 1] = sets[i].front < sets[i].back ? sets[i].back : sets[i].front;
    }
  }
}

static int by_set_then_place(const void *a, const void *b) {
  const vxm_face_set_side *s = a, *t = b;
  if (s->set != t->set)
    return s->set < t->set ? -1 : 1;
  if (s->face != t->face)
    return s->face < t->face ? -1 : 1;
  return s->place < t->place ? -1 : s->place > t->place;
}

/** Sorts answers by their patches, and takes them; whether all patches are known then. */
static bool take_all(vxm_layers *l, vxm_face_set_side *sets, size_t count, int32_t *reach) {
  bool all = true;
  qsort(sets, count, sizeof *sets, by_set_then_place);
  for (size_t i = 0, j; i < count; i = j) {
    for (j = i; j < count && sets[j].set == sets[i].set;)
      j++;
    take_answers(l, sets + i, j - i, reach);
    all = all && (l->known[sets[i].set] || is_sheet(l, sets[i].set));
  }
  return all;
}

/** Lists places on faces of patches that are not known; without a list only counts them. @param size as
 * list_samples has left it */
static size_t list_more(vxm_layers *l, vxm_face_set_side *sets, size_t *size) {
  size_t faces = l->state->soup->face_count, count = 0, *seen = size + faces;
  for (size_t f = 0; f < faces; f++)
    seen[f] = 0;
  for (size_t f = 0; f < faces; f++) {
    size_t root = is_asked(l, f) ? vxm_set_of(l->patch, f) : f;
    if (!is_asked(l, f) || l->known[root])
      continue;
    if (seen[root]++ % (size[root] / MORE_FACES + 1) != 0)
      continue;
    for (int place = 0; place < VXM_FACE_PLACES; place++, count++)
      if (sets)
        sets[count] = (vxm_face_set_side){.face = f, .set = root, .place = place};
  }
  return count;
}

/** Leaves only the answers that have sides which differ by the copies of a face: those of places where no
 * other face lies. */
static size_t keep_fitting(const vxm_layers *l, vxm_face_set_side *sets, size_t count) {
  size_t kept = 0;
  for (size_t i = 0; i < count; i++)
    if (sets[i].back - sets[i].front == vxm_layers_surplus(l, sets[i].set))
      sets[kept++] = sets[i];
  return kept;
}

/** Asks patches that are not known elsewhere: other faces may lie on theirs in part. */
static vxm_status ask_again(vxm_layers *l, const uint8_t *bound, size_t *size, int32_t *reach,
                            vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t count = list_more(l, NULL, size);
  vxm_face_set_side *sets = vxm_repair_state_scratch(l->state, count, sizeof *sets, &status, error);
  if (sets) {
    list_more(l, sets, size);
    status = vxm_face_set_sides_find(sets, count, l->state, l->groups, bound, true, error);
  }
  if (status == VXM_OK)
    take_all(l, sets, keep_fitting(l, sets, count), reach);
  vxm_free(l->state->context, sets);
  return status;
}

static vxm_status ask_patches(vxm_layers *l, uint8_t *bound, vxm_face_set_side *sets, size_t *size,
                              int32_t *reach, vxm_error *error) {
  size_t count = list_samples(l, bound, sets, size);
  vxm_status status = vxm_check_cancelled(l->state->context, error);
  if (status == VXM_OK)
    status = vxm_face_set_sides_find(sets, count, l->state, l->groups, bound, true, error);
  if (status != VXM_OK || take_all(l, sets, count, reach))
    return status;
  status = ask_again(l, bound, size, reach, error);
  return status == VXM_OK ? vxm_layers_balance(l, reach, error) : status;
}

vxm_status vxm_layers_find(vxm_layers *layers, vxm_error *error) {
  vxm_repair_state *state = layers->state;
  size_t faces = state->soup->face_count;
  vxm_face_set_side *sets = NULL;
  size_t *size = NULL;
  int32_t *reach = NULL;
  vxm_status status = find_patches(layers, error);
  uint8_t *bound =
      status == VXM_OK ? vxm_repair_state_scratch(state, faces, sizeof *bound, &status, error) : NULL;
  if (bound)
    sets = vxm_repair_state_scratch(state, faces, sizeof *sets, &status, error);
  if (sets)
    size = vxm_repair_state_scratch(state, 2 * faces, sizeof *size, &status, error);
  if (size)
    reach = vxm_repair_state_scratch(state, 2 * faces, sizeof *reach, &status, error);
  if (reach)
    status = ask_patches(layers, bound, sets, size, reach, error);
  vxm_free(state->context, reach);
  vxm_free(state->context, size);
  vxm_free(state->context, sets);
  vxm_free(state->context, bound);
  return status;
}
