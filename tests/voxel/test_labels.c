/* SPDX-License-Identifier: BSD-3-Clause */
/** Labels against brute force, and what they mean. */
#include "../base/rounds.h"
#include "label_test.h"

#include "mesh/containment.h"

#include <string.h>

/* ---- Against brute force ---- */

/** Whether a label may be the one of a voxel: the nearest of those asked, the lowest of equally near ones. */
static bool is_right(uint16_t label, const double *distance, const bool *asked, size_t count, double side) {
  double least = INFINITY;
  size_t lowest = 0;
  if (!asked[label - 1])
    return false;
  for (size_t l = 1; l <= count; l++)
    if (asked[l - 1])
      least = fmin(least, distance[l - 1]);
  for (size_t l = count; l >= 1; l--)
    if (asked[l - 1] && distance[l - 1] <= least + 1e-9 * side)
      lowest = l;
  /* Between 1e-9 and what seven digits tell apart either may be taken. */
  return label == lowest || (distance[label - 1] > least + 1e-9 * side &&
                             distance[label - 1] <= least * (1 + 2e-7) + 1e-6 * side);
}

/** How many sides of faces of a label lie on the edge between two points. */
static size_t sides_at(const vxm_face_labels *l, size_t label, const double *p, const double *q) {
  size_t sides = 0;
  for (size_t i = l->begin[label - 1]; i < l->begin[label]; i++) {
    size_t n;
    const uint32_t *corner = vxm_face(l->soup, l->faces[i], &n);
    for (size_t c = 0; c < n; c++) {
      const double *a = vxm_position(l->soup, corner[c]), *b = vxm_position(l->soup, corner[(c + 1) % n]);
      sides += (memcmp(a, p, 3 * sizeof *a) == 0 && memcmp(b, q, 3 * sizeof *a) == 0) ||
               (memcmp(a, q, 3 * sizeof *a) == 0 && memcmp(b, p, 3 * sizeof *a) == 0);
    }
  }
  return sides;
}

/** Whether a label has an odd edge, or its solid no voxel. */
static bool is_open(const vxm_face_labels *l, size_t label, const vxm_grid *claims) {
  for (size_t i = l->begin[label - 1]; i < l->begin[label]; i++) {
    size_t n;
    const uint32_t *corner = vxm_face(l->soup, l->faces[i], &n);
    for (size_t c = 0; c < n; c++)
      if (sides_at(l, label, vxm_position(l->soup, corner[c]), vxm_position(l->soup, corner[(c + 1) % n])) %
          2)
        return true;
  }
  return !claims || vxm_grid_count(claims) == 0;
}

/** Whether a voxel of one label may have another where the nearest of open labels are preferred. */
static bool may_become(uint16_t label, size_t from, const double *distance, const bool *open, size_t count,
                       double side) {
  double least = INFINITY;
  size_t lowest = 0;
  for (size_t l = 1; l <= count; l++)
    least = fmin(least, distance[l - 1]);
  if (!open[from - 1] || least > side * (1 + 1e-6))
    return label == from;
  if (distance[from - 1] <= least + 1e-9 * side)
    return label == from;
  for (size_t l = count; l >= 1; l--)
    if (distance[l - 1] <= least + 1e-9 * side)
      lowest = l;
  if (label == (open[lowest - 1] ? lowest : from) && least <= side * (1 + 1e-9))
    return true;
  /* What seven digits do not tell apart may be either. */
  double most = least * (1 + 2e-7) + 1e-6 * side;
  if (label == from && (least > side * (1 + 1e-9) || distance[from - 1] <= most))
    return true;
  for (size_t l = 1; l <= count; l++)
    if (distance[l - 1] > least + 1e-9 * side && distance[l - 1] <= most && label == (open[l - 1] ? l : from))
      return true;
  return false;
}

/** What is added for thin parts no label claims: there the nearest face decides. */
static vxm_voxelize_options without_thin(const vxm_voxelize_options *options) {
  vxm_voxelize_options centres = *options;
  centres.thin = VXM_THIN_DROP;
  return centres;
}

/** Takes away what parts claim that are cavities. */
static void drop_cavities(vxm_grid **claims, const vxm_face_labels *l) {
  const size_t count = l->table.count;
  uint32_t *part = malloc((l->soup->face_count + 1) * sizeof *part);
  uint8_t closed[64];
  assert_true(count <= sizeof closed);
  for (size_t c = 0; c < count; c++) {
    for (size_t i = l->begin[c]; i < l->begin[c + 1]; i++)
      part[l->faces[i]] = (uint32_t)c;
    closed[c] = 1;
  }
  for (size_t c = 0; c < count; c++)
    for (size_t i = l->begin[c]; i < l->begin[c + 1] && closed[c]; i++) {
      size_t n;
      const uint32_t *corner = vxm_face(l->soup, l->faces[i], &n);
      for (size_t k = 0; k < n; k++)
        closed[c] &=
            sides_at(l, c + 1, vxm_position(l->soup, corner[k]), vxm_position(l->soup, corner[(k + 1) % n])) %
                2 ==
            0;
    }
  vxm_containment inside;
  assert_int_equal(vxm_containment_build(&inside, l->soup, part, count, closed, NULL), VXM_OK);
  for (size_t c = 0; c < count; c++)
    if (inside.body[c] != VXM_NO_COMPONENT) {
      vxm_grid_destroy(claims[c]);
      claims[c] = NULL;
    }
  vxm_containment_destroy(&inside);
  free(part);
}

static void check(const vxm_soup *soup, const vxm_space *space, const vxm_voxelize_options *options,
                  vxm_label_by by) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_face_labels l;
  assert_int_equal(vxm_face_labels_create(&l, soup, by, &error), VXM_OK);
  size_t count = l.table.count, voxels = voxels_of(space);
  vxm_model *model;
  vxm_grid *set;
  assert_int_equal(vxm_model_make(&model, soup, options, &error), VXM_OK);
  assert_int_equal(vxm_voxelize_grid(&set, &(vxm_voxelize_report){0}, model, space, &error), VXM_OK);
  vxm_grid **claims = calloc(count, sizeof *claims);
  const vxm_voxelize_options centres = without_thin(options);
  for (size_t c = 0; c < count; c++)
    claims[c] = claims_of(&l, c + 1, space, &centres);
  if (by == VXM_LABEL_PART && count > 1 && options->cavities == VXM_CAVITIES_AUTO &&
      options->split_mode == VXM_SPLIT_MODE_AUTO)
    drop_cavities(claims, &l);
  bool open[64] = {false};
  for (size_t c = 0; c < count && count > 1 && by != VXM_LABEL_PART; c++)
    open[c] = is_open(&l, c + 1, claims[c]);
  vxm_label_options label_options = VXM_LABEL_OPTIONS_INIT;
  label_options.by = by;
  vxm_voxelize_report voxelize = VXM_VOXELIZE_REPORT_INIT;
  vxm_label_report report = VXM_LABEL_REPORT_INIT;
  report.voxelize = &voxelize;
  uint16_t *values = malloc(voxels * sizeof *values);
  if (vxm_model_labels(values, &report, model, space, &label_options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_int_equal(report.labels, count);
  assert_true(report.voxelize->hash == vxm_grid_hash(set));
  int64_t several = 0, none = 0, *counted = calloc(count, sizeof *counted);
  double side = fmax(space->voxel_size[0], fmax(space->voxel_size[1], space->voxel_size[2]));
  size_t at = 0;
  for (int64_t i = 0; i < space->dims[0]; i++)
    for (int64_t j = 0; j < space->dims[1]; j++)
      for (int64_t k = 0; k < space->dims[2]; k++, at++) {
        bool asked[64] = {false};
        double distance[64];
        size_t claiming = 0;
        assert_int_equal(values[at] != 0, vxm_grid_get(set, i, j, k));
        if (values[at] == 0)
          continue;
        assert_true(values[at] <= count && count <= 64);
        for (size_t c = 0; c < count; c++) {
          asked[c] = claims[c] && vxm_grid_get(claims[c], i, j, k);
          claiming += asked[c];
          distance[c] = to_label(&l, c + 1, centre_of(space, i, j, k));
        }
        for (size_t c = 0; c < count && claiming == 0; c++)
          asked[c] = true;
        several += claiming > 1;
        none += claiming == 0;
        counted[values[at] - 1]++;
        bool is_good = false;
        for (size_t c = 1; c <= count && !is_good; c++)
          is_good = is_right((uint16_t)c, distance, asked, count, side) &&
                    may_become(values[at], c, distance, open, count, side);
        if (!is_good)
          fail_msg("(%d, %d, %d): label %u, claimed by %zu", (int)i, (int)j, (int)k, values[at], claiming);
      }
  assert_int_equal(report.contested, several);
  assert_int_equal(report.unassigned, none);
  for (size_t c = 0; c < count; c++) {
    assert_int_equal(vxm_model_label_voxels(model, (int64_t)c + 1), counted[c]);
    vxm_grid_destroy(claims[c]);
  }
  free(counted);
  free(values);
  free(claims);
  vxm_grid_destroy(set);
  vxm_model_destroy(model);
  vxm_face_labels_destroy(&l);
}

/** Bodies, cavities and sheets in some groups and materials. */
static vxm_soup *random_soup(vxm_rng *rng, int bodies) {
  static const char *const tags[] = {"a/red", "b/red", "c", "a/blue", "d/green", "b"};
  vxm_soup *soup = shape_empty(context);
  for (int b = 0; b < bodies; b++) {
    size_t first = soup->face_count;
    double low[3], high[3];
    switch (vxm_rng_below(rng, 5)) {
    case 0:
      shape_random_octahedron(soup, rng, 0, 60);
      break;
    case 1:
      sheet(soup, rng);
      break;
    case 2:
      shape_torus(soup, 7, 5, 3 + vxm_rng_unit(rng), 1.5,
                  (double[]){16 * vxm_rng_unit(rng), 16 * vxm_rng_unit(rng), 8});
      break;
    default:
      for (int a = 0; a < 3; a++) {
        low[a] = shape_quarter(rng, 0, 44);
        high[a] = low[a] + shape_quarter(rng, 2, 30);
      }
      shape_box(soup, low, high);
      if (vxm_rng_below(rng, 4) == 0)
        turn_faces(soup, first);
    }
    tag_faces(soup, first, tags[vxm_rng_below(rng, 6)]);
  }
  return soup;
}

static void test_equals_brute_force(void **state) {
  (void)state;
  vxm_rng rng = {31};
  for (int round = 0; round < ROUNDS(60); round++) {
    vxm_soup *soup = random_soup(&rng, 1 + (int)vxm_rng_below(&rng, 12));
    vxm_space space = {{1 + (int64_t)vxm_rng_below(&rng, 18), 1 + (int64_t)vxm_rng_below(&rng, 18),
                        1 + (int64_t)vxm_rng_below(&rng, 18)},
                       {0, 0, 0},
                       {1, 1, 1}};
    if (round % 3 == 1)
      for (int a = 0; a < 3; a++) {
        space.voxel_size[a] = 0.5 + vxm_rng_unit(&rng);
        space.origin[a] = 3 * vxm_rng_unit(&rng) - 1;
      }
    if (round % 3 == 2)
      space.dims[round / 3 % 3] = 70;
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.mode = round % 5 == 3 ? VXM_MODE_SURFACE : round % 5 == 4 ? VXM_MODE_BOTH : VXM_MODE_SOLID;
    options.split_mode = (vxm_split_mode)(round % 7 == 5   ? VXM_SPLIT_MODE_GROUP
                                          : round % 7 == 6 ? VXM_SPLIT_MODE_WHOLE
                                                           : 0);
    options.cavities = (vxm_cavities)(round % 11 == 9    ? VXM_CAVITIES_KEEP
                                      : round % 11 == 10 ? VXM_CAVITIES_FILL
                                                         : VXM_CAVITIES_AUTO);
    options.method = round % 13 == 12 ? VXM_METHOD_X : VXM_METHOD_VOTE;
    options.vote = round % 13 == 11 ? VXM_VOTE_MAJORITY : VXM_VOTE_AUTO;
    check(soup, &space, &options, (vxm_label_by)(round % 3));
    vxm_soup_destroy(soup);
  }
}

/** Many faces to each block of voxels, whose labels meet inside a solid. */
static void test_patches_of_a_body(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_torus(soup, 60, 40, 8, 5, (double[]){13, 13.1, 5.3});
  for (size_t f = 0; f < soup->face_count; f++) {
    char name[8] = "/m0";
    name[2] = (char)('0' + f * 7 / soup->face_count);
    tag_faces(soup, f, name);
  }
  vxm_space space = {{27, 27, 11}, {0, 0, 0}, {1, 1, 1}};
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  check(soup, &space, &options, VXM_LABEL_MATERIAL);
  options.mode = VXM_MODE_SURFACE;
  options.surface = VXM_SURFACE_THIN;
  check(soup, &space, &options, VXM_LABEL_MATERIAL);
  options.surface = VXM_SURFACE_SHELL6;
  check(soup, &space, &options, VXM_LABEL_MATERIAL);
  vxm_soup_destroy(soup);
}

/** Bodies whose faces have labels by chance, among others that have one each. */
static void test_patches_equal_brute_force(void **state) {
  (void)state;
  static const char *const tags[] = {"a/red", "b/red", "c", "a/blue", "d/green", "b"};
  vxm_rng rng = {35};
  for (int round = 0; round < ROUNDS(120); round++) {
    vxm_soup *soup = shape_empty(context);
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
      low[a] = round % 4 ? 1 + 3 * vxm_rng_unit(&rng) : shape_quarter(&rng, 0, 12);
      high[a] = low[a] + (round % 4 ? 2 + 8 * vxm_rng_unit(&rng) : shape_quarter(&rng, 8, 40));
    }
    if (round % 3 == 0)
      shape_torus(soup, 9, 6, 5 + vxm_rng_unit(&rng), 3, (double[]){8, 8.1, 4});
    else
      shape_box(soup, low, high);
    tag_faces(soup, 0, tags[0]);
    for (size_t f = 1; f < soup->face_count; f++)
      if (vxm_rng_below(&rng, 2))
        tag_faces(soup, f, tags[vxm_rng_below(&rng, 6)]);
    if (round % 2) { /* closed, but as a rule without the centre of a voxel */
      const int across = round / 2 % 3;
      low[across] += 0.7 * vxm_rng_unit(&rng);
      high[across] = low[across] + 0.02;
      tagged_box(soup, low, high, "thin/thin");
    }
    vxm_soup *others = random_soup(&rng, (int)vxm_rng_below(&rng, 4));
    for (size_t f = 0; f < others->face_count; f++) {
      size_t n, first = soup->vertex_count;
      const uint32_t *corner = vxm_face(others, f, &n);
      uint32_t numbers[16];
      assert_true(n <= 16);
      for (size_t c = 0; c < n; c++) {
        const double *p = vxm_position(others, corner[c]);
        shape_vertex(soup, p[0], p[1], p[2]);
        numbers[c] = (uint32_t)(first + c);
      }
      shape_face(soup, numbers, n);
      tag_faces(soup, soup->face_count - 1, others->tags[others->face_tags[f]]);
    }
    vxm_soup_destroy(others);
    vxm_space space = {{14, 13, 12}, {0, 0, 0}, {1, 1, 1}};
    if (round % 2)
      for (int a = 0; a < 3; a++)
        space.voxel_size[a] = 0.4 + vxm_rng_unit(&rng);
    if (round % 8 == 5)
      space.dims[2] = 70;
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.mode = round % 5 == 4 ? VXM_MODE_BOTH : VXM_MODE_SOLID;
    check(soup, &space, &options, (vxm_label_by)(round % 7 == 6 ? 0 : 1 + round % 2));
    vxm_soup_destroy(soup);
  }
}

/* ---- What they mean ---- */

/** Overlapping boxes share what both claim by the nearest face; nested ones too. */
static void test_overlap_and_nesting(void **state) {
  (void)state;
  vxm_voxelize_report voxelize = VXM_VOXELIZE_REPORT_INIT;
  vxm_label_report report = VXM_LABEL_REPORT_INIT;
  report.voxelize = &voxelize;
  vxm_space space = {{16, 8, 8}, {0, 0, 0}, {1, 1, 1}};
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[]){0, 0, 0}, (double[]){10, 8, 8});
  shape_box(soup, (double[]){6, 0, 0}, (double[]){16, 8, 8});
  uint16_t *values = labels_of(soup, &space, VXM_LABEL_PART, &report);
  assert_int_equal(report.labels, 2);
  assert_int_equal(report.contested, 4 * 8 * 8);
  assert_int_equal(report.unassigned, 0);
  /* In the middle of the overlap box 2 begins on the left, and box 1 ends on the right. */
  static const uint16_t row[16] = {1, 1, 1, 1, 1, 1, 2, 2, 1, 1, 2, 2, 2, 2, 2, 2};
  for (int64_t i = 0; i < 16; i++)
    assert_int_equal(at(values, &space, i, 3, 3), row[i]);
  /* Along the walls that both have they are equally near: the lower label. */
  assert_int_equal(at(values, &space, 7, 0, 0), 1);
  free(values);
  vxm_soup_destroy(soup);
  soup = shape_empty(context);
  shape_box(soup, (double[]){2, 2, 2}, (double[]){6, 6, 6});
  shape_box(soup, (double[]){0, 0, 0}, (double[]){16, 8, 8});
  values = labels_of(soup, &space, VXM_LABEL_PART, &report);
  assert_int_equal(report.contested, 4 * 4 * 4);
  for (int64_t i = 0; i < 16; i++)
    for (int64_t j = 0; j < 8; j++)
      for (int64_t k = 0; k < 8; k++) {
        bool is_inside = i >= 2 && i < 6 && j >= 2 && j < 6 && k >= 2 && k < 6;
        assert_int_equal(at(values, &space, i, j, k), is_inside ? 1 : 2);
      }
  free(values);
  vxm_soup_destroy(soup);
}

/** A cube with one side of another material has a layer of it, and one inside that is closed keeps its own.
 */
static void test_open_sides(void **state) {
  (void)state;
  vxm_voxelize_report voxelize = VXM_VOXELIZE_REPORT_INIT;
  vxm_label_report report = VXM_LABEL_REPORT_INIT;
  report.voxelize = &voxelize;
  vxm_space space = {{10, 10, 10}, {0, 0, 0}, {1, 1, 1}};
  vxm_soup *soup = shape_empty(context);
  tagged_box(soup, (double[]){0, 0, 0}, (double[]){10, 10, 10}, "/a");
  size_t sides = soup->face_count;
  tagged_box(soup, (double[]){3, 3, 3}, (double[]){7, 7, 7}, "/c");
  for (size_t f = 0; f < sides; f++) { /* that at x = 10 */
    size_t n, there = 0;
    const uint32_t *corner = vxm_face(soup, f, &n);
    for (size_t c = 0; c < n; c++)
      there += vxm_position(soup, corner[c])[0] == 10;
    if (there == n)
      soup->face_tags[f] = UINT32_MAX;
  }
  uint32_t tag;
  assert_int_equal(vxm_soup_add_tag(soup, "/b", 2, &tag, NULL), VXM_OK);
  size_t changed = 0;
  for (size_t f = 0; f < sides; f++)
    if (soup->face_tags[f] == UINT32_MAX) {
      soup->face_tags[f] = tag;
      changed++;
    }
  assert_true(changed > 0 && changed < sides);
  vxm_model *model;
  vxm_label_options options = VXM_LABEL_OPTIONS_INIT;
  options.by = VXM_LABEL_MATERIAL;
  uint16_t *values = malloc(voxels_of(&space) * sizeof *values);
  assert_int_equal(vxm_model_create(&model, soup, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_model_labels(values, &report, model, &space, &options, NULL), VXM_OK);
  size_t a = 0, b = 0;
  for (size_t label = 1; label <= 3; label++) {
    a = vxm_model_label_name(model, (int64_t)label)[0] == 'a' ? label : a;
    b = vxm_model_label_name(model, (int64_t)label)[0] == 'b' ? label : b;
  }
  /* Where the layer meets the sides beside it a face of each is as near: what encloses all keeps it. */
  for (int64_t i = 0; i < 10; i++)
    for (int64_t j = 0; j < 10; j++)
      for (int64_t k = 0; k < 10; k++) {
        bool is_inside = i >= 3 && i < 7 && j >= 3 && j < 7 && k >= 3 && k < 7,
             is_layer = i == 9 && j >= 1 && j < 9 && k >= 1 && k < 9;
        assert_int_equal(at(values, &space, i, j, k), is_inside ? 6 - a - b : is_layer ? b : a);
      }
  assert_int_equal(vxm_model_label_voxels(model, (int64_t)b), 64);
  free(values);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
}

/** A screw where two blocks overlap has its own voxels and no more, though its faces are the nearest around.
 */
static void test_bystanders_take_nothing(void **state) {
  (void)state;
  vxm_voxelize_report voxelize = VXM_VOXELIZE_REPORT_INIT;
  vxm_label_report report = VXM_LABEL_REPORT_INIT;
  report.voxelize = &voxelize;
  vxm_space space = {{24, 24, 24}, {0, 0, 0}, {1, 1, 1}};
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[]){11, 11, 11}, (double[]){13, 13, 13});
  shape_box(soup, (double[]){0, 0, 0}, (double[]){23, 24, 24});
  shape_box(soup, (double[]){1, 0, 0}, (double[]){24, 24, 24});
  uint16_t *values = labels_of(soup, &space, VXM_LABEL_PART, &report);
  int64_t screw = 0;
  for (size_t v = 0; v < voxels_of(&space); v++)
    screw += values[v] == 1;
  assert_int_equal(screw, 8);
  free(values);
  vxm_soup_destroy(soup);
}

/** The skin of a cavity is a part as well, but what stands in the cavity is not its own: a block between
 * floor and ceiling, all of which is nearer to the cavity's walls than to its own. */
static void test_a_body_in_a_cavity(void **state) {
  (void)state;
  vxm_label_report report = VXM_LABEL_REPORT_INIT;
  vxm_space space = {{16, 16, 16}, {0, 0, 0}, {1, 1, 1}};
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[]){0, 0, 0}, (double[]){16, 16, 16});
  shape_box(soup, (double[]){2, 2, 2}, (double[]){14, 14, 14});
  for (size_t f = 6; f < 12; f++) { /* inward */
    uint32_t *corner = soup->indices + soup->offsets[f], swap = corner[1];
    corner[1] = corner[3];
    corner[3] = swap;
  }
  shape_box(soup, (double[]){2.25, 2.25, 2.25}, (double[]){13.75, 13.75, 7.5});
  uint16_t *values = labels_of(soup, &space, VXM_LABEL_PART, &report);
  assert_int_equal(report.labels, 3);
  for (int64_t i = 0; i < 16; i++)
    for (int64_t j = 0; j < 16; j++)
      for (int64_t k = 0; k < 16; k++) {
        bool is_wall = i < 2 || i >= 14 || j < 2 || j >= 14 || k < 2 || k >= 14;
        assert_int_equal(at(values, &space, i, j, k), is_wall ? 1 : k < 7 ? 3 : 0);
      }
  free(values);
  vxm_soup_destroy(soup);
}

/** The same faces twice, and the same body under two labels: the lower one. */
static void test_ties(void **state) {
  (void)state;
  vxm_voxelize_report voxelize = VXM_VOXELIZE_REPORT_INIT;
  vxm_label_report report = VXM_LABEL_REPORT_INIT;
  report.voxelize = &voxelize;
  vxm_space space = {{12, 12, 12}, {-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}};
  vxm_soup *soup = shape_empty(context);
  tagged_box(soup, (double[]){0.03, 0.03, 0.03}, (double[]){0.7, 0.7, 0.7}, "low");
  tagged_box(soup, (double[]){0.03, 0.03, 0.03}, (double[]){0.7, 0.7, 0.7}, "high");
  uint16_t *values = labels_of(soup, &space, VXM_LABEL_GROUP, &report);
  assert_int_equal(report.contested, report.voxelize->voxels);
  for (size_t v = 0; v < voxels_of(&space); v++)
    assert_true(values[v] <= 1);
  free(values);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_overlap_and_nesting),       cmocka_unit_test(test_bystanders_take_nothing),
      cmocka_unit_test(test_a_body_in_a_cavity),        cmocka_unit_test(test_ties),
      cmocka_unit_test(test_equals_brute_force),        cmocka_unit_test(test_patches_of_a_body),
      cmocka_unit_test(test_patches_equal_brute_force), cmocka_unit_test(test_open_sides),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
