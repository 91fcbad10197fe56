/* SPDX-License-Identifier: BSD-3-Clause */
/** Which label each face of a soup has, and what labels are called. */
#ifndef VXM_VOXEL_PARTS_FACE_LABELS_H
#define VXM_VOXEL_PARTS_FACE_LABELS_H

#include "mesh/soup.h"
#include "voxmend/field.h"

/** Values have 16 bits, and 0 is none. */
enum { VXM_LABELS_MAX = 65535 };

/** The table of labels: label l has entry l - 1. */
typedef struct vxm_label_table {
  vxm_context *context;
  size_t count;
  char *text;      /**< the names, each with its zero byte */
  size_t *name;    /**< where in the text each begins */
  int64_t *voxels; /**< that have the label */
} vxm_label_table;

/** The faces of each label. */
typedef struct vxm_face_labels {
  const vxm_soup *soup;
  uint32_t *faces; /**< those of label 1 first, each in the order of the soup */
  size_t *begin;   /**< label l has faces[begin[l - 1]] to faces[begin[l] - 1] */
  vxm_label_table table;
  bool is_by_part;
  bool is_untagged; /**< groups or materials were asked for, and the soup names none */
} vxm_face_labels;

/**
 * Labels the faces of a soup, in the order in which labels first occur.
 *
 * A part is a connected component over vertices welded by position. Of a face tag "group/material" what lies
 * before the first slash is the group, and what lies behind it the material. A part is called like its tag if
 * its faces share one, or else like their group if they share that, or "part 7" by its number. Faces without
 * a group or material are "unnamed".
 *
 * @param[out] out destroyed with vxm_face_labels_destroy, also after a failure
 * @return VXM_OK; VXM_ERROR_RANGE beyond VXM_LABELS_MAX; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
vxm_status vxm_face_labels_create(vxm_face_labels *out, const vxm_soup *soup, vxm_label_by by,
                                  vxm_error *error);
void vxm_face_labels_destroy(vxm_face_labels *labelling);
void vxm_label_table_destroy(vxm_label_table *table);

/** Name of a label, 1 to count. */
static inline const char *vxm_label_table_name(const vxm_label_table *table, size_t label) {
  return table->text + table->name[label - 1];
}

#endif
