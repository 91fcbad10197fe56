/* SPDX-License-Identifier: BSD-3-Clause */
/** What the tests of labels share: soups with tags on their faces, and the labels of their voxels. */
#ifndef TEST_VOXEL_LABEL_TEST_H
#define TEST_VOXEL_LABEL_TEST_H

#include "label_oracle.h"

#include "voxel/labels/labels.h"

#include <string.h>

/** Gives all faces from `first` on a tag. */
static inline void tag_faces(vxm_soup *soup, size_t first, const char *name) {
  uint32_t tag = UINT32_MAX;
  for (size_t t = 0; t < soup->tag_count; t++)
    if (strcmp(soup->tags[t], name) == 0)
      tag = (uint32_t)t;
  if (tag == UINT32_MAX)
    assert_int_equal(vxm_soup_add_tag(soup, name, strlen(name), &tag, NULL), VXM_OK);
  soup->face_tags =
      vxm_realloc(soup->context, soup->face_tags, soup->face_count, sizeof *soup->face_tags, NULL);
  assert_non_null(soup->face_tags);
  for (size_t f = first; f < soup->face_count; f++)
    soup->face_tags[f] = tag;
}

static inline void tagged_box(vxm_soup *soup, const double low[3], const double high[3], const char *tag) {
  size_t first = soup->face_count;
  shape_box(soup, low, high);
  tag_faces(soup, first, tag);
}

/** Turns faces from `first` on inside out. */
static inline void turn_faces(vxm_soup *soup, size_t first) {
  for (size_t f = first; f < soup->face_count; f++)
    for (uint64_t a = soup->offsets[f], b = soup->offsets[f + 1] - 1; a < b; a++, b--) {
      uint32_t kept = soup->indices[a];
      soup->indices[a] = soup->indices[b];
      soup->indices[b] = kept;
    }
}

static inline void sheet(vxm_soup *soup, vxm_rng *rng) {
  uint32_t v = (uint32_t)soup->vertex_count;
  double x = shape_quarter(rng, 0, 64), y = shape_quarter(rng, 0, 64), z = shape_quarter(rng, 0, 64);
  shape_vertex(soup, x, y, z);
  shape_vertex(soup, x + 4, y, z + 1);
  shape_vertex(soup, x + 4, y + 3, z + 1);
  shape_triangle(soup, v, v + 1, v + 2);
}

static inline uint16_t *labels_of(vxm_soup *soup, const vxm_space *space, vxm_label_by by,
                                  vxm_label_report *report) {
  vxm_model *model;
  vxm_error error = VXM_ERROR_INIT;
  vxm_label_options options = VXM_LABEL_OPTIONS_INIT;
  options.by = by;
  uint16_t *values = malloc(voxels_of(space) * sizeof *values);
  if (vxm_model_create(&model, soup, NULL, &error) != VXM_OK ||
      vxm_model_labels(values, report, model, space, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  vxm_model_destroy(model);
  return values;
}

static inline uint16_t at(const uint16_t *values, const vxm_space *space, int64_t i, int64_t j, int64_t k) {
  return values[(i * space->dims[1] + j) * space->dims[2] + k];
}

#endif
