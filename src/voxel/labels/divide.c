/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/divide.h"
#include "mesh/face_sets.h"
#include "voxel/labels/open_labels.h"

/** Numbers the sets of all faces; returns how many there are, 1 if no label is a body. */
static size_t number_sets(uint32_t *sets, const vxm_face_labels *labelling, const uint8_t *open) {
  size_t count = 1;
  for (size_t l = 1; l <= labelling->table.count; l++) {
    size_t begin = labelling->begin[l - 1], end = labelling->begin[l];
    const uint32_t *faces = labelling->faces + begin;
    if (open[l - 1] || vxm_faces_winding(labelling->soup, faces, end - begin) == 0)
      continue;
    for (size_t i = begin; i < end; i++)
      sets[labelling->faces[i]] = (uint32_t)count;
    count++;
  }
  return count;
}

static vxm_status divide(vxm_soup *soup, const vxm_face_labels *labelling, const uint8_t *open,
                         vxm_error *error) {
  vxm_status status = VXM_OK;
  uint32_t *sets = vxm_try_calloc(soup->context, soup->face_count, sizeof *sets, &status, error);
  if (!sets)
    return status;
  size_t count = number_sets(sets, labelling, open);
  if (count == 1) {
    vxm_free(soup->context, sets);
    return VXM_OK;
  }
  vxm_free(soup->context, soup->face_sets);
  soup->face_sets = sets;
  soup->set_count = count;
  return vxm_face_sets_part(soup, error);
}

vxm_status vxm_labels_divide(vxm_soup *soup, vxm_label_by by, vxm_error *error) {
  vxm_face_labels labelling;
  uint8_t *open = NULL;
  if (by == VXM_LABEL_PART)
    return VXM_OK;
  vxm_status status = vxm_face_labels_create(&labelling, soup, by, error);
  if (status == VXM_OK)
    status = vxm_open_labels_create(&open, &labelling, error);
  if (status == VXM_OK && open) /* else there are not several labels */
    status = divide(soup, &labelling, open, error);
  vxm_free(soup->context, open);
  vxm_face_labels_destroy(&labelling);
  return status;
}
