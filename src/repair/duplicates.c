/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/duplicates.h"
#include "repair/fins.h"

/** Leaves the first of all faces with the same corners in the same or the opposite cyclic order, and none of
 * the faces of fins. */
vxm_status vxm_pass_duplicates(vxm_work *work, bool *changed, vxm_error *error) {
  *changed = false;
  work->shared = 0;
  if (work->options.keep_duplicates)
    return VXM_OK;
  vxm_status status = VXM_OK;
  vxm_soup *soup = work->soup;
  uint8_t *kinds = vxm_work_scratch(work, soup->face_count, sizeof *kinds, &status, error), *even = NULL;
  if (kinds)
    even = vxm_work_scratch(work, soup->face_count, sizeof *even, &status, error);
  vxm_duplicates found = {0};
  if (even)
    status = vxm_duplicates_find(&found, work->context, soup, NULL, kinds, even, error);
  bool any = found.same + found.opposite_pairs > 0;
  size_t kept = 0;
  /* a face that is not the first of its orientation repeats that one; the first may repeat the other's */
  if (status == VXM_OK && any)
    status = vxm_fins_mark(work, even, kinds, &kept, error);
  work->shared = (int64_t)kept;
  if (status == VXM_OK && (found.same > kept || found.opposite_pairs > 0)) {
    int64_t same = (int64_t)(found.same - kept);
    vxm_work_note_marked(work, same > 0 ? VXM_PASS_DUPLICATES : VXM_PASS_OPPOSITE_DUPLICATES, kinds);
    int64_t removed = vxm_work_remove_faces(work, kinds);
    work->counts[VXM_PASS_DUPLICATES] += same;
    work->counts[VXM_PASS_OPPOSITE_DUPLICATES] += removed - same;
    *changed = true;
  }
  vxm_free(work->context, even);
  vxm_free(work->context, kinds);
  return status;
}
