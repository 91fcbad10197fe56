/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/duplicates.h"
#include "repair/fins.h"

/** Leaves the first of all faces with the same corners in the same or the opposite cyclic order, and none of
 * the faces of fins. */
vxm_status vxm_pass_duplicates(vxm_work *work, bool *changed, vxm_error *error) {
  *changed = false;
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
  /* a face that is not the first of its orientation repeats that one; the first may repeat the other's */
  if (status == VXM_OK && any)
    status = vxm_fins_mark(work, even, kinds, error);
  if (status == VXM_OK && any) {
    vxm_work_note_marked(work, found.same > 0 ? VXM_PASS_DUPLICATES : VXM_PASS_OPPOSITE_DUPLICATES, kinds);
    int64_t removed = vxm_work_remove_faces(work, kinds);
    work->counts[VXM_PASS_DUPLICATES] += (int64_t)found.same;
    work->counts[VXM_PASS_OPPOSITE_DUPLICATES] += removed - (int64_t)found.same;
    *changed = true;
  }
  vxm_free(work->context, even);
  vxm_free(work->context, kinds);
  return status;
}
