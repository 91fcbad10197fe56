/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/duplicate_faces.h"
#include "repair/bodies/hanging_sheets.h"
#include "repair/clean/repeated_faces.h"

/** What is counted: faces that go, and how many stay beside another one with the same corners. */
static void count_faces(vxm_repair_state *state, const vxm_copies *copies, const uint8_t *kinds,
                        const uint8_t *remove, uint8_t *seen) {
  int64_t same = 0, opposite = 0;
  for (size_t f = 0; f < state->soup->face_count; f++) {
    same += remove[f] && kinds[f] == VXM_REPEAT_SAME;
    opposite += remove[f] && kinds[f] != VXM_REPEAT_SAME;
    state->shared_faces += !remove[f] && seen[copies[f].first];
    seen[copies[f].first] |= !remove[f];
  }
  if (same + opposite > 0)
    vxm_repair_state_note_marked(state, same > 0 ? VXM_PASS_DUPLICATES : VXM_PASS_OPPOSITE_DUPLICATES,
                                 remove);
  state->counts[VXM_PASS_DUPLICATES] += same;
  state->counts[VXM_PASS_OPPOSITE_DUPLICATES] += opposite;
}

/** Marks those that are to go. A sheet that hangs on a closed body does not make it an open one, of which but
 * one of several equal faces would stay. */
static vxm_status mark_repeated(vxm_repair_state *state, const vxm_copies *copies, uint8_t *remove,
                                vxm_error *error) {
  vxm_hung_sheets off;
  vxm_status status = vxm_take_sheets_off(&off, state, error);
  if (status == VXM_OK)
    status = vxm_repeated_faces_mark(state, copies, remove, error);
  vxm_hang_sheets_again(&off, state);
  return status;
}

/** Decides about them, and takes out those that are not needed; fills `kinds` and `copies`, which are scratch
 * per face. */
static vxm_status remove_repeated(vxm_repair_state *state, uint8_t *kinds, vxm_copies *copies, bool *changed,
                                  vxm_error *error) {
  size_t faces = state->soup->face_count;
  vxm_duplicates found;
  uint8_t *seen = NULL;
  vxm_status status = vxm_duplicates_find(&found, state->context, state->soup, kinds, copies, error);
  uint8_t *remove =
      status == VXM_OK ? vxm_repair_state_scratch(state, faces, sizeof *remove, &status, error) : NULL;
  if (remove)
    seen = vxm_repair_state_scratch(state, faces, sizeof *seen, &status, error);
  if (seen)
    status = mark_repeated(state, copies, remove, error);
  if (status == VXM_OK) {
    count_faces(state, copies, kinds, remove, seen);
    *changed = vxm_repair_state_remove_faces(state, remove) > 0;
  }
  vxm_free(state->context, seen);
  vxm_free(state->context, remove);
  return status;
}

/** Whether there are any, as in few meshes: where no edge has more than two sides the patches tell mostly. */
static vxm_status look_for_repeated(vxm_repair_state *state, bool *any, vxm_error *error) {
  vxm_duplicates found = {0};
  vxm_status status = vxm_repair_state_patches(state, error);
  if (status == VXM_OK && (!state->has_patches || state->patches.may_repeat))
    status = vxm_duplicates_find(&found, state->context, state->soup, NULL, NULL, error);
  *any = found.same + found.opposite_pairs > 0;
  return status;
}

/** Of the faces that repeat each other leaves as many as are needed. */
vxm_status vxm_pass_duplicates(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  state->shared_faces = 0;
  if (state->options.keep_duplicates)
    return VXM_OK;
  bool found = true;
  vxm_status status = look_for_repeated(state, &found, error);
  if (status != VXM_OK || !found)
    return status;
  size_t faces = state->soup->face_count;
  uint8_t *kinds = vxm_repair_state_scratch(state, faces, sizeof *kinds, &status, error);
  vxm_copies *copies = kinds ? vxm_repair_state_scratch(state, faces, sizeof *copies, &status, error) : NULL;
  if (copies)
    status = remove_repeated(state, kinds, copies, changed, error);
  vxm_free(state->context, copies);
  vxm_free(state->context, kinds);
  return status;
}
