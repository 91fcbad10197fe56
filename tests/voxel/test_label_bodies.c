/* SPDX-License-Identifier: BSD-3-Clause */
/** Labels of bodies that share walls: blocks of cells, each with a label or none, whose labels are known. */
#include "../base/rounds.h"
#include "label_test.h"

#include <stdio.h>

enum { SIDE = 5, CELLS_MAX = SIDE * SIDE * SIDE };

typedef struct block {
  int dims[3], labels;
  int cell[CELLS_MAX]; /**< label, or 0 */
} block;

typedef struct drawing {
  bool shares;        /**< bodies have the vertices of their walls in common */
  bool same_diagonal; /**< a wall has the same triangles on both sides */
  bool is_inside_out; /**< all faces are wound inward */
} drawing;

static int cell_at(const block *b, const int at[3]) {
  for (int a = 0; a < 3; a++)
    if (at[a] < 0 || at[a] >= b->dims[a])
      return 0;
  return b->cell[(at[0] * b->dims[1] + at[1]) * b->dims[2] + at[2]];
}

/* ---- The faces of a block ---- */

/** Corner of a lattice with a point more than cells along each axis. */
static uint32_t corner_of(const block *b, uint32_t first, const int at[3]) {
  return first + (uint32_t)((at[0] * (b->dims[1] + 1) + at[1]) * (b->dims[2] + 1) + at[2]);
}

static void add_points(const block *b, vxm_soup *soup) {
  for (int i = 0; i <= b->dims[0]; i++)
    for (int j = 0; j <= b->dims[1]; j++)
      for (int k = 0; k <= b->dims[2]; k++)
        shape_vertex(soup, i, j, k);
}

/** The side of a cell along an axis, seen from outside counterclockwise. */
static void add_side(const block *b, vxm_soup *soup, uint32_t first, const int at[3], int axis, bool upper,
                     const drawing *how, int label) {
  uint32_t v[4];
  for (int i = 0; i < 4; i++) {
    static const int u[4] = {0, 1, 1, 0}, w[4] = {0, 0, 1, 1};
    int p[3] = {at[0], at[1], at[2]};
    p[axis] += upper;
    p[(axis + 1) % 3] += u[i];
    p[(axis + 2) % 3] += w[i];
    v[i] = corner_of(b, first, p);
  }
  size_t before = soup->face_count;
  bool other = !how->same_diagonal && label % 2;
  shape_triangle(soup, v[other], v[other + 1], v[other + 2]);
  shape_triangle(soup, v[other], v[other + 2], v[(other + 3) % 4]);
  if (upper == how->is_inside_out)
    turn_faces(soup, before);
}

static void add_label(const block *b, vxm_soup *soup, const drawing *how, int label) {
  size_t before = soup->face_count;
  uint32_t first = how->shares ? 0 : (uint32_t)soup->vertex_count;
  if (!how->shares)
    add_points(b, soup);
  int at[3];
  for (at[0] = 0; at[0] < b->dims[0]; at[0]++)
    for (at[1] = 0; at[1] < b->dims[1]; at[1]++)
      for (at[2] = 0; at[2] < b->dims[2]; at[2]++)
        for (int side = 0; side < 6 && cell_at(b, at) == label; side++) {
          int next[3] = {at[0], at[1], at[2]};
          next[side / 2] += side % 2 ? 1 : -1;
          if (cell_at(b, next) != label)
            add_side(b, soup, first, at, side / 2, side % 2, how, label);
        }
  char tag[32];
  snprintf(tag, sizeof tag, "b%d/m%d", label, label);
  if (soup->face_count > before)
    tag_faces(soup, before, tag);
}

static vxm_soup *draw(const block *b, const drawing *how) {
  vxm_soup *soup = shape_empty(context);
  if (how->shares)
    add_points(b, soup);
  for (int label = 1; label <= b->labels; label++)
    add_label(b, soup, how, label);
  return soup;
}

/* ---- Their voxels ---- */

/** Labels by the names of the bodies. @param scale voxels along a cell */
static void check_values(const block *b, const uint16_t *values, const vxm_space *space, vxm_model *model,
                         int scale) {
  size_t wrong = 0;
  for (int64_t i = 0; i < space->dims[0]; i++)
    for (int64_t j = 0; j < space->dims[1]; j++)
      for (int64_t k = 0; k < space->dims[2]; k++) {
        int at[3] = {(int)i / scale, (int)j / scale, (int)k / scale};
        const char *name = vxm_model_label_name(model, values[(i * space->dims[1] + j) * space->dims[2] + k]);
        wrong += cell_at(b, at) != (*name ? atoi(name + 1) : 0);
      }
  assert_int_equal(wrong, 0);
}

static void check_block(const block *b, const drawing *how, vxm_label_by by, bool repairs, int scale) {
  vxm_soup *soup = draw(b, how);
  vxm_mesh *apart, *prepared = NULL;
  vxm_model *model = NULL;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_label_options labels = VXM_LABEL_OPTIONS_INIT;
  vxm_space space = {.origin = {0, 0, 0}};
  vxm_error error = VXM_ERROR_INIT;
  options.thin = VXM_THIN_DROP;
  labels.by = by;
  for (int a = 0; a < 3; a++) {
    space.voxel_size[a] = 1.0 / scale;
    space.dims[a] = (int64_t)b->dims[a] * scale;
  }
  uint16_t *values = malloc(voxels_of(&space) * sizeof *values);
  if (vxm_mesh_divide(&apart, soup, by, &error) != VXM_OK ||
      (repairs && vxm_mesh_prepare(&prepared, NULL, apart, NULL, &error) != VXM_OK) ||
      vxm_model_create(&model, repairs ? prepared : apart, &options, &error) != VXM_OK ||
      vxm_model_labels(values, NULL, model, &space, &labels, &error) != VXM_OK)
    fail_msg("%s", error.text);
  check_values(b, values, &space, model, scale);
  vxm_model_destroy(model);
  vxm_mesh_destroy(prepared);
  vxm_mesh_destroy(apart);
  vxm_soup_destroy(soup);
  free(values);
}

/** In each way of drawing it. */
static void check_drawings(const block *b, bool is_inside_out) {
  for (int i = 0; i < 16; i++) {
    drawing how = {.shares = i & 1, .same_diagonal = i & 2, .is_inside_out = is_inside_out};
    check_block(b, &how, i & 4 ? VXM_LABEL_MATERIAL : VXM_LABEL_GROUP, i & 8, 1 + (i & 1));
  }
}

/* ---- Random blocks ---- */

static block fill_block(vxm_rng *rng, int least) {
  block b = {.labels = 2 + (int)vxm_rng_below(rng, 3)};
  for (int a = 0; a < 3; a++)
    b.dims[a] = 2 + (int)vxm_rng_below(rng, SIDE - 1);
  for (int i = 0; i < b.dims[0] * b.dims[1] * b.dims[2]; i++)
    b.cell[i] = least + (int)vxm_rng_below(rng, (uint64_t)(b.labels + 1 - least));
  return b;
}

static void test_full_blocks(void **state) {
  (void)state;
  vxm_rng rng = {1};
  for (int round = 0; round < ROUNDS(60); round++) {
    block b = fill_block(&rng, 1);
    check_drawings(&b, round % 4 == 3);
  }
}

static void test_blocks_with_voids(void **state) {
  (void)state;
  vxm_rng rng = {2};
  for (int round = 0; round < ROUNDS(60); round++) {
    block b = fill_block(&rng, 0);
    check_drawings(&b, round % 4 == 3);
  }
}

/** A shell of one label around a block of others and of nothing. */
static void test_inserts(void **state) {
  (void)state;
  vxm_rng rng = {3};
  for (int round = 0; round < ROUNDS(60); round++) {
    block b = fill_block(&rng, 0);
    for (int a = 0; a < 3; a++)
      b.dims[a] = 3 + (int)vxm_rng_below(&rng, SIDE - 2);
    for (int i = 0; i < b.dims[0]; i++)
      for (int j = 0; j < b.dims[1]; j++)
        for (int k = 0; k < b.dims[2]; k++) {
          int *cell = &b.cell[(i * b.dims[1] + j) * b.dims[2] + k];
          bool is_shell =
              i == 0 || j == 0 || k == 0 || i == b.dims[0] - 1 || j == b.dims[1] - 1 || k == b.dims[2] - 1;
          int within = (int)vxm_rng_below(&rng, (uint64_t)b.labels);
          *cell = is_shell ? 1 : within > 0 ? within + 1 : 0;
        }
    check_drawings(&b, round % 4 == 3);
  }
}

/* ---- What is no body of its own ---- */

/** Labels of a soup as it is made for them. */
static uint16_t *divided_labels(vxm_soup *soup, const vxm_space *space, vxm_label_report *report) {
  vxm_mesh *apart;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_mesh_divide(&apart, soup, VXM_LABEL_GROUP, &error) != VXM_OK ||
      vxm_mesh_prepare_in_place(&apart, NULL, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  uint16_t *values = labels_of(apart, space, VXM_LABEL_GROUP, report);
  vxm_mesh_destroy(apart);
  return values;
}

static vxm_space cube_of(int64_t side) {
  return (vxm_space){.dims = {side, side, side}, .voxel_size = {1, 1, 1}};
}

/** A skin that is wound inward is the cavity of another label, as it is without labels. */
static void test_inner_skin(void **state) {
  (void)state;
  vxm_space space = cube_of(8);
  for (int turned = 0; turned < 2; turned++) {
    vxm_soup *soup = shape_empty(context);
    tagged_box(soup, (double[]){0, 0, 0}, (double[]){8, 8, 8}, "outer");
    size_t first = soup->face_count;
    tagged_box(soup, (double[]){2, 2, 2}, (double[]){6, 6, 6}, "inner");
    if (turned)
      turn_faces(soup, first);
    uint16_t *values = divided_labels(soup, &space, NULL);
    assert_int_equal(at(values, &space, 0, 0, 0), 1);
    assert_int_equal(at(values, &space, 4, 4, 4), turned ? 0 : 2);
    free(values);
    vxm_soup_destroy(soup);
  }
}

/** An insert that reaches into the walls of a cavity and has a hole: the cavity is that of its own label,
 * though the insert is the smaller one around most of it. */
static void test_overlapping_insert(void **state) {
  (void)state;
  vxm_space space = cube_of(SIDE);
  vxm_soup *soup = shape_empty(context);
  block ring = {.dims = {SIDE, SIDE, SIDE}}, hollow = ring;
  for (int i = 0; i < CELLS_MAX; i++) {
    int x = i / (SIDE * SIDE), y = i / SIDE % SIDE, z = i % SIDE;
    bool is_within = x % (SIDE - 1) && y % (SIDE - 1) && z % (SIDE - 1);
    ring.cell[i] = x != 2 || y != 2;
    hollow.cell[i] = is_within ? 0 : 2;
  }
  const drawing how = {.shares = false};
  add_label(&ring, soup, &how, 1);
  add_label(&hollow, soup, &how, 2);
  uint16_t *values = divided_labels(soup, &space, NULL);
  for (int i = 0; i < CELLS_MAX; i++)
    assert_int_equal(values[i] != 0, ring.cell[i] || hollow.cell[i]);
  free(values);
  vxm_soup_destroy(soup);
}

/** Patches of a cube stay one surface beside a body, and labels keep their numbers. */
static void test_patches_beside_a_body(void **state) {
  (void)state;
  vxm_space space = cube_of(8);
  vxm_soup *soup = shape_empty(context);
  vxm_label_report report = VXM_LABEL_REPORT_INIT;
  tagged_box(soup, (double[]){0, 0, 0}, (double[]){4, 8, 8}, "low x");
  for (uint32_t f = 0; f < 6; f++)
    soup->face_tags[f] = 0;
  tagged_box(soup, (double[]){4, 0, 0}, (double[]){8, 8, 8}, "body");
  uint32_t tag;
  assert_int_equal(vxm_soup_add_tag(soup, "high z", 6, &tag, NULL), VXM_OK);
  soup->face_tags[1] = tag; /* first there before those of the body */
  uint16_t *values = divided_labels(soup, &space, &report);
  assert_int_equal(report.labels, 3);
  assert_int_equal(report.contested, 0);
  for (int64_t k = 0; k < 8; k++) {
    assert_int_equal(at(values, &space, 1, 4, k), k == 7 ? 2 : 1);
    assert_int_equal(at(values, &space, 6, 4, k), 3);
  }
  free(values);
  vxm_soup_destroy(soup);
}

/** A sheet drawn from both sides is closed, and no body: it stays with the box that it closes. */
static void test_sheet_of_two_sides(void **state) {
  (void)state;
  vxm_space space = cube_of(8);
  vxm_soup *soup = shape_empty(context);
  tagged_box(soup, (double[]){0, 0, 0}, (double[]){8, 8, 8}, "box");
  size_t n;
  uint32_t corner[4], back[4];
  memcpy(corner, vxm_face(soup, 1, &n), sizeof corner);
  for (int c = 0; c < 4; c++)
    back[c] = corner[3 - c];
  size_t first = soup->face_count;
  shape_face(soup, corner, 4);
  shape_face(soup, back, 4);
  tag_faces(soup, first, "lid");
  vxm_mesh *apart;
  assert_int_equal(vxm_mesh_divide(&apart, soup, VXM_LABEL_GROUP, NULL), VXM_OK);
  assert_int_equal(apart->set_count, 2);
  for (size_t f = 0; f < first + 2; f++)
    assert_int_equal(apart->face_sets[f], f < first);
  vxm_mesh_destroy(apart);
  uint16_t *values = divided_labels(soup, &space, NULL);
  for (int64_t k = 0; k < 8; k++)
    assert_int_equal(at(values, &space, 4, 4, k), 1);
  free(values);
  vxm_soup_destroy(soup);
}

static void test_what_is_refused(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  tagged_box(soup, (double[]){0, 0, 0}, (double[]){1, 1, 1}, "a");
  tagged_box(soup, (double[]){1, 0, 0}, (double[]){2, 1, 1}, "b");
  vxm_mesh *apart, *made;
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.part_changes = true;
  assert_int_equal(vxm_mesh_divide(&apart, soup, (vxm_label_by)3, NULL), VXM_ERROR_ARGUMENT);
  assert_null(apart);
  assert_int_equal(vxm_mesh_divide(&apart, soup, VXM_LABEL_GROUP, NULL), VXM_OK);
  assert_int_equal(vxm_mesh_prepare(&made, NULL, apart, &options, NULL), VXM_ERROR_ARGUMENT);
  assert_null(made);
  assert_int_equal(vxm_mesh_repair(&made, NULL, apart, &options, NULL), VXM_OK);
  vxm_mesh_destroy(made);
  vxm_mesh_destroy(apart);
  vxm_soup_destroy(soup);
}

/** Whatever the limit beyond what the mesh itself takes, there is an error or the whole result, and nothing
 * is left. */
static void test_any_limit(void **state) {
  (void)state;
  vxm_rng rng = {4};
  block b = fill_block(&rng, 0);
  const drawing how = {.shares = true, .same_diagonal = true};
  vxm_context *usual = context;
  int64_t faces = -1;
  int refused = 0;
  bool done = false;
  for (uint64_t limit = 0; !done; limit = limit ? limit + 1024 : 1) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 1;
    options.memory_limit = faces < 0 ? 0 : limit;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    vxm_soup *soup = draw(&b, &how);
    vxm_mesh *apart = NULL, *made = NULL;
    vxm_error error = VXM_ERROR_INIT;
    uint64_t taken = vxm_context_peak_bytes(context);
    vxm_status status = vxm_mesh_divide(&apart, soup, VXM_LABEL_GROUP, &error);
    if (status == VXM_OK)
      status = vxm_mesh_prepare(&made, NULL, apart, NULL, &error);
    if (faces < 0) { /* without a limit, to begin with */
      assert_int_equal(status, VXM_OK);
      faces = vxm_mesh_face_count(made);
      limit = taken;
    } else if (status == VXM_OK) {
      assert_int_equal(vxm_mesh_face_count(made), faces);
      done = true;
    } else {
      assert_int_equal(status, VXM_ERROR_MEMORY_LIMIT);
      assert_int_equal(error.code, VXM_ERROR_MEMORY_LIMIT);
      assert_null(made);
      refused++;
    }
    vxm_mesh_destroy(made);
    vxm_mesh_destroy(apart);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
  assert_true(refused > 20);
  context = usual;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_full_blocks),
      cmocka_unit_test(test_blocks_with_voids),
      cmocka_unit_test(test_inserts),
      cmocka_unit_test(test_inner_skin),
      cmocka_unit_test(test_overlapping_insert),
      cmocka_unit_test(test_patches_beside_a_body),
      cmocka_unit_test(test_sheet_of_two_sides),
      cmocka_unit_test(test_what_is_refused),
      cmocka_unit_test(test_any_limit),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
