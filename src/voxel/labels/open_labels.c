/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/open_labels.h"
#include "base/hash.h"
#include "mesh/weld.h"

/**
 * A sum of the edges of a face, in which an edge that is there twice cancels: over all faces of a label it is
 * 0 if no edge is odd. That it is 0 by chance otherwise has the odds of one to 2^64; a file that is made for
 * it has labels of its own as if they were closed, and harms nothing else.
 */
static uint64_t sum_edges(const vxm_soup *soup, size_t face, const uint32_t *weld) {
  uint64_t sum = 0;
  size_t n;
  const uint32_t *corner = vxm_face(soup, face, &n);
  for (size_t c = 0; c < n; c++) {
    uint64_t a = weld[corner[c]], b = weld[corner[c + 1 < n ? c + 1 : 0]];
    sum ^= a < b ? vxm_mix(vxm_mix(a + 1) + b) : a > b ? vxm_mix(vxm_mix(b + 1) + a) : 0;
  }
  return sum;
}

vxm_status vxm_open_labels_create(uint8_t **out, const vxm_face_labels *labelling, vxm_error *error) {
  const vxm_soup *soup = labelling->soup;
  vxm_error local = VXM_ERROR_INIT;
  *out = NULL;
  if (labelling->is_by_part || labelling->table.count < 2)
    return VXM_OK;
  uint8_t *open = vxm_calloc(soup->context, labelling->table.count, sizeof *open, &local);
  uint32_t *weld = vxm_alloc(soup->context, soup->vertex_count, sizeof *weld, &local);
  vxm_status status = local.code;
  if (status == VXM_OK)
    status = vxm_weld_exact(soup->context, soup->positions, soup->vertex_count, weld, NULL, &local);
  for (size_t label = 1; label <= labelling->table.count && status == VXM_OK; label++) {
    uint64_t sum = 0;
    for (size_t i = labelling->begin[label - 1]; i < labelling->begin[label]; i++)
      sum ^= sum_edges(soup, labelling->faces[i], weld);
    open[label - 1] = sum != 0;
  }
  vxm_free(soup->context, weld);
  if (status == VXM_OK) {
    *out = open;
    return VXM_OK;
  }
  vxm_free(soup->context, open);
  vxm_error_pass(error, &local);
  return status;
}
