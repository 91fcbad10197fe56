/* SPDX-License-Identifier: BSD-3-Clause */
/** Soups made manifold. */
#include "../base/rounds.h"
#include "manifold.h"
#include "outlines.h"
#include "repair_test.h"

#include "../mesh/shared.h"
#include "mesh/components.h"
#include "repair/manifold/cut_nonmanifold.h"

#include <math.h>

typedef struct outcome {
  vxm_soup *soup;
  int64_t split, stitched;
} outcome;

static outcome separated(const vxm_soup *soup) {
  outcome out;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_cut_nonmanifold(&out.soup, &out.split, &out.stitched, soup, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return out;
}

/** Every face is there once, at its place, with its corners where they were, and the vertices between are as
 * before. */
static void check_faces(const vxm_soup *in, const vxm_soup *out) {
  assert_int_equal(in->face_count, out->face_count);
  assert_memory_equal(in->offsets, out->offsets, (in->face_count + 1) * sizeof *in->offsets);
  for (size_t c = 0; c < in->corner_count; c++)
    for (int a = 0; a < 3; a++)
      assert_true(vxm_position(in, in->indices[c])[a] == vxm_position(out, out->indices[c])[a]);
  assert_int_equal(in->face_tags != NULL, out->face_tags != NULL);
  if (in->face_tags)
    assert_memory_equal(in->face_tags, out->face_tags, in->face_count * sizeof *in->face_tags);
}

/** Separates, checks what has to hold of any soup, and gives the result to look at. */
static outcome check(const vxm_soup *soup) {
  outcome out = separated(soup);
  check_faces(soup, out.soup);
  brute_report before = look_brute(soup), after = look_brute(out.soup);
  assert_true(after.manifold);
  /* along every edge as many sides find a partner as can; more of them where rims are stitched */
  assert_int_equal(after.boundary_edges, before.unpaired - 2 * out.stitched);
  if (before.manifold && out.stitched == 0) {
    assert_int_equal(out.split, 0);
    assert_same_soup(soup, out.soup);
  }
  outcome again = separated(out.soup);
  assert_int_equal(again.split, 0);
  assert_int_equal(again.stitched, 0);
  assert_same_soup(out.soup, again.soup);
  vxm_soup_destroy(again.soup);
  return out;
}

static void drop(outcome out) {
  vxm_soup_destroy(out.soup);
}

/* ---- What has to come out ---- */

/** Two cubes that touch along an edge, on shared vertices, are two again, however their faces come. */
static void cubes_touch_along_an_edge(void **state) {
  static const uint8_t full[8] = {1, 0, 0, 1, 0, 0, 0, 0};
  vxm_soup *soup = cell_surface(*state, 2, full);
  assert_int_equal(look_brute(soup).complex_edges, 1);
  vxm_rng rng = {1};
  for (int i = 0; i < ROUNDS(200); i++) {
    vxm_soup *mixed = shuffled(soup, &rng, 0, i % 2);
    outcome out = check(mixed);
    assert_int_equal(out.split, 2);
    uint32_t *label = malloc(out.soup->face_count * sizeof *label);
    size_t count;
    assert_int_equal(vxm_components(*state, out.soup, NULL, label, &count, NULL), VXM_OK);
    assert_int_equal(count, 2);
    for (size_t f = 0; f < out.soup->face_count; f++)
      for (size_t g = 0; g < f; g++) {
        size_t n;
        bool low[2] = {true, true};
        for (int s = 0; s < 2; s++) {
          const uint32_t *corner = vxm_face(out.soup, s ? g : f, &n);
          for (size_t c = 0; c < n; c++)
            low[s] = low[s] && vxm_position(out.soup, corner[c])[0] <= 1 &&
                     vxm_position(out.soup, corner[c])[1] <= 1;
        }
        assert_int_equal(label[f] == label[g], low[0] == low[1]);
      }
    free(label);
    drop(out);
    vxm_soup_destroy(mixed);
  }
  vxm_soup_destroy(soup);
}

/** Parts that overlap stay whole, also where one begins within the other, and along more than one edge. */
static void prisms_overlap_at_an_edge(void **state) {
  vxm_rng rng = {2};
  for (int i = 0; i < ROUNDS(300); i++) {
    /* wedges about the z axis, from one angle to another, all with the axis as their edge */
    size_t wedges = 2 + (size_t)vxm_rng_below(&rng, 3);
    uint32_t levels = 1 + (uint32_t)vxm_rng_below(&rng, 3);
    vxm_soup *soup = new_soup(*state);
    for (uint32_t z = 0; z <= levels; z++)
      add_vertex(soup, 0, 0, z);
    for (size_t w = 0; w < wedges; w++) {
      double from = 6.28 * vxm_rng_unit(&rng), to = from + 0.2 + 2.5 * vxm_rng_unit(&rng),
             size = 1 + (double)w;
      uint32_t v = (uint32_t)soup->vertex_count, top = v + 2 * levels;
      for (uint32_t z = 0; z <= levels; z++) {
        add_vertex(soup, size * cos(from), size * sin(from), z);
        add_vertex(soup, size * cos(to), size * sin(to), z);
      }
      for (uint32_t z = 0; z < levels; z++) {
        uint32_t at = v + 2 * z;
        uint32_t faces[3][4] = {
            {z, at, at + 2, z + 1}, {at, at + 1, at + 3, at + 2}, {at + 1, z, z + 1, at + 3}};
        for (int f = 0; f < 3; f++)
          add_face(soup, faces[f], 4);
      }
      add_triangle(soup, 0, v + 1, v);
      add_triangle(soup, levels, top, top + 1);
    }
    vxm_soup *mixed = shuffled(soup, &rng, 0, false);
    outcome out = check(mixed);
    assert_int_equal(count_components_brute(out.soup), wedges);
    assert_int_equal(look_brute(out.soup).boundary_edges, 0);
    drop(out);
    vxm_soup_destroy(mixed);
    vxm_soup_destroy(soup);
  }
}

/** Two rooms, each with its half of the wall between them, whatever triangles the halves are of. */
static void rooms_with_a_wall_each(void **state) {
  vxm_rng rng = {11};
  for (int i = 0; i < ROUNDS(300); i++) {
    vxm_soup *soup = new_soup(*state);
    static const uint8_t full[2][8] = {{1}, {0, 1}};
    for (int room = 0; room < 2; room++) {
      vxm_soup *one = cell_surface(*state, 2, full[room]);
      for (size_t v = 0; v < one->vertex_count && room == 0; v++)
        add_vertex(soup, vxm_position(one, v)[0], vxm_position(one, v)[1], vxm_position(one, v)[2]);
      for (size_t f = 0; f < one->face_count; f++)
        add_face(soup, one->indices + one->offsets[f], 4);
      vxm_soup_destroy(one);
    }
    turning turn = random_turning(&rng);
    for (size_t v = 0; v < soup->vertex_count; v++) {
      double p[3] = {soup->positions[3 * v], soup->positions[3 * v + 1], soup->positions[3 * v + 2]};
      for (int a = 0; a < 3; a++)
        soup->positions[3 * v + (size_t)a] = turn.m[a][0] * p[0] + turn.m[a][1] * p[1] + turn.m[a][2] * p[2];
    }
    vxm_soup *mixed = shuffled(soup, &rng, 0, true);
    outcome out = check(mixed);
    assert_int_equal(look_brute(out.soup).boundary_edges, 0);
    assert_int_equal(count_components_brute(out.soup), 2);
    assert_int_equal(out.split, 4);
    drop(out);
    vxm_soup_destroy(mixed);
    vxm_soup_destroy(soup);
  }
}

/** Of three sides along an edge two belong together: the wall between two rooms goes with the one that it is
 * turned for, and the other room stays open. */
static void wall_between_two_rooms(void **state) {
  static const uint8_t full[8] = {1, 1, 0, 0, 0, 0, 0, 0};
  for (int turned = 0; turned < 2; turned++) {
    vxm_soup *soup = cell_surface(*state, 2, full);
    uint32_t wall[4] = {1, 4, 13, 10}; /* at x = 1, facing x */
    for (int i = 0; i < 2 && turned; i++) {
      uint32_t kept = wall[i];
      wall[i] = wall[3 - i];
      wall[3 - i] = kept;
    }
    add_face(soup, wall, 4);
    outcome out = check(soup);
    assert_int_equal(look_brute(out.soup).boundary_edges, 4);
    assert_int_equal(count_components_brute(out.soup), 2);
    /* the wall is connected to a face with a corner at the far end of its room */
    uint32_t vertex = out.soup->indices[out.soup->corner_count - 1];
    for (size_t f = 0; f + 1 < out.soup->face_count; f++) {
      size_t n;
      const uint32_t *corner = vxm_face(out.soup, f, &n);
      for (size_t c = 0; c < n; c++)
        if (corner[c] == vertex)
          for (size_t d = 0; d < n; d++)
            assert_true((turned ? 1 : -1) * (vxm_position(out.soup, corner[d])[0] - 1) >= 0);
    }
    drop(out);
    vxm_soup_destroy(soup);
  }
}

/** Blocks of cells: closed, and whatever touches along edges or at corners is parted without a gap. */
static void blocks_of_cells(void **state) {
  vxm_rng rng = {3};
  size_t split = 0;
  for (int i = 0; i < ROUNDS(1500); i++) {
    uint8_t full[64];
    unsigned n = 2 + (unsigned)vxm_rng_below(&rng, 3);
    double share = 0.2 + 0.6 * vxm_rng_unit(&rng);
    size_t cells = 0;
    for (unsigned c = 0; c < n * n * n; c++)
      cells += full[c] = vxm_rng_unit(&rng) < share;
    vxm_soup *soup = cell_surface(*state, n, full), *mixed = shuffled(soup, &rng, 0, i % 2);
    outcome out = check(mixed);
    assert_int_equal(out.stitched, 0);
    assert_int_equal(look_brute(out.soup).boundary_edges, 0);
    assert_true(fabs(volume_of(out.soup) - (double)cells) < 1e-9);
    split += (size_t)out.split;
    drop(out);
    vxm_soup_destroy(mixed);
    vxm_soup_destroy(soup);
  }
  assert_true(split > ROUNDS(10000));
}

/** Two cells that touch along an edge, and are connected by others around both of its ends: either way of
 * joining its four faces, one of them makes an edge twice between the same two vertices. */
static void edge_twice_between_two_vertices(void **state) {
  uint8_t full[64] = {0};
#define CELL(x, y, z) full[(x) + 4 * (y) + 16 * (z)]
  CELL(1, 1, 1) = CELL(2, 2, 1) = 1;
  for (int z = 0; z < 3; z += 2)
    CELL(1, 1, z) = CELL(2, 1, z) = CELL(2, 2, z) = 1;
#undef CELL
  vxm_soup *soup = cell_surface(*state, 4, full);
  assert_int_equal(look_brute(soup).complex_edges, 1);
  outcome out = check(soup);
  assert_int_equal(out.split, 2);
  assert_int_equal(look_brute(out.soup).boundary_edges, 0);
  drop(out);
  vxm_soup_destroy(soup);
}

/** Anything at all. */
static void tangles(void **state) {
  vxm_rng rng = {4};
  int64_t split = 0, stitched = 0;
  for (int i = 0; i < ROUNDS(6000); i++) {
    size_t vertices = 5 + (size_t)vxm_rng_below(&rng, 20), faces = (size_t)vxm_rng_below(&rng, 60);
    vxm_soup *soup = tangle(*state, &rng, vertices, faces, i % 3 ? 100 : 3);
    if (i % 5 == 0 && faces > 0)
      tag_faces(soup);
    outcome out = check(soup);
    split += out.split;
    stitched += out.stitched;
    drop(out);
    vxm_soup_destroy(soup);
  }
  assert_true(split > 10000 && stitched > 1000);
}

/** Faces that were turned against their neighbours have a border there; all else holds. */
static void turned_faces(void **state) {
  vxm_rng rng = {5};
  for (int i = 0; i < ROUNDS(300); i++) {
    uint8_t full[27];
    for (int c = 0; c < 27; c++)
      full[c] = vxm_rng_below(&rng, 2) == 0;
    vxm_soup *soup = cell_surface(*state, 3, full), *mixed = shuffled(soup, &rng, 0.2, i % 2);
    drop(check(mixed));
    vxm_soup_destroy(mixed);
    vxm_soup_destroy(soup);
  }
}

/** What is separated stays so for readers that weld. */
static void repaired_to_manifold(void **state) {
  vxm_rng rng = {10};
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_MANIFOLD;
  for (int i = 0; i < ROUNDS(600); i++) {
    uint8_t full[27];
    for (int c = 0; c < 27; c++)
      full[c] = vxm_rng_below(&rng, 2) == 0;
    vxm_soup *soup = i % 2 ? cell_surface(*state, 3, full)
                           : tangle(*state, &rng, 5 + (size_t)vxm_rng_below(&rng, 20), 40, 100);
    vxm_soup *out = repaired(soup, &options, NULL);
    weld_positions(out);
    assert_true(look_brute(out).manifold);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/* ---- Stitching ---- */

/** Panels that share nothing become what they are the panels of. */
static void panels_are_stitched(void **state) {
  static const uint8_t cubes[3][8] = {
      {1, 0, 0, 0, 0, 0, 0, 0}, {1, 0, 0, 1, 0, 0, 0, 0}, {1, 0, 0, 0, 0, 0, 0, 1}};
  vxm_rng rng = {6};
  for (int i = 0; i < ROUNDS(300); i++) {
    vxm_soup *soup = cell_surface(*state, 2, cubes[i % 3]), *mixed = shuffled(soup, &rng, 0, i % 2);
    vxm_soup *panels = unshared(mixed);
    outcome out = check(panels);
    size_t bodies = i % 3 ? 2 : 1;
    assert_int_equal(out.stitched, bodies * (i % 2 ? 18 : 12));
    assert_int_equal(out.soup->vertex_count, 8 * bodies);
    assert_int_equal(count_components_brute(out.soup), bodies);
    drop(out);
    vxm_soup_destroy(panels);
    vxm_soup_destroy(mixed);
    vxm_soup_destroy(soup);
  }
}

/** Of blocks of cells, too, nearly everything finds together; and nothing wrongly. */
static void panels_of_blocks(void **state) {
  vxm_rng rng = {7};
  int64_t open = 0, edges = 0;
  for (int i = 0; i < ROUNDS(300); i++) {
    uint8_t full[27];
    for (int c = 0; c < 27; c++)
      full[c] = vxm_rng_below(&rng, 2) == 0;
    vxm_soup *soup = cell_surface(*state, 3, full), *panels = unshared(soup);
    outcome out = check(panels);
    open += look_brute(out.soup).boundary_edges;
    edges += (int64_t)panels->corner_count / 2;
    drop(out);
    vxm_soup_destroy(panels);
    vxm_soup_destroy(soup);
  }
  assert_true(open * 20 < edges);
}

/** Rims upon each other that must not be stitched: it would fold a face, or make an edge of four. */
static void stitches_refused(void **state) {
  /* a square whose opposite sides lie upon each other */
  static const double folded[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 0, 0}, {2, 2, 2}};
  static const int square[] = {0, 1, 2, 3, -1};
  vxm_soup *soup = soup_of(*state, folded, 5, square, 1);
  outcome out = check(soup);
  assert_int_equal(out.stitched, 0);
  assert_int_equal(out.soup->vertex_count, 5); /* also the unused one */
  drop(out);
  vxm_soup_destroy(soup);
  /* a sheet upon itself, turned: each side lies against its own copy, but two faces would be left without
     anything between them; they are as closed as a pillow is, and manifold */
  static const double twice[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  static const int pillow[] = {0, 1, 2, -1, 3, 5, 4, -1};
  soup = soup_of(*state, twice, 6, pillow, 2);
  out = check(soup);
  assert_int_equal(out.stitched, 3);
  assert_int_equal(out.soup->vertex_count, 3);
  drop(out);
  vxm_soup_destroy(soup);
  /* both signs of zero are one position */
  static const double zeros[6][3] = {{0, 0, 0},       {1, 0, 0},    {0, 1, 0},
                                     {-0.0, 0, -0.0}, {1, -0.0, 0}, {0, -1, 0}};
  static const int two[] = {0, 1, 2, -1, 4, 3, 5, -1};
  soup = soup_of(*state, zeros, 6, two, 2);
  out = check(soup);
  assert_int_equal(out.stitched, 1);
  drop(out);
  vxm_soup_destroy(soup);
}

/* ---- Real meshes, odd numbers, failures ---- */

static void shared_mesh_is_separated(const shared_mesh *mesh, void *payload) {
  vxm_soup *soup = read_soup(payload, mesh->path), *clean;
  vxm_error error = VXM_ERROR_INIT;
  if (soup->face_count < 20000) {
    if (vxm_repair_run(&clean, NULL, soup, NULL, &error) != VXM_OK)
      fail_msg("%s: %s", mesh->path, error.text);
    drop(check(clean));
    vxm_soup_destroy(clean);
  }
  vxm_soup_destroy(soup);
}

static void shared_meshes(void **state) {
  if (for_each_shared_mesh(shared_mesh_is_separated, *state) == 0)
    skip();
}

static void odd_positions(void **state) {
  static const double values[] = {NAN, INFINITY, -INFINITY, 1e308, -1e308, 5e-324, 1e-200, 0, 1};
  vxm_rng rng = {8};
  for (int i = 0; i < ROUNDS(500); i++) {
    vxm_soup *soup = tangle(*state, &rng, 12, 40, 100);
    for (size_t k = 0; k < 3 * soup->vertex_count; k++)
      if (vxm_rng_below(&rng, 2))
        soup->positions[k] = values[vxm_rng_below(&rng, sizeof values / sizeof *values)];
    outcome out = separated(soup);
    assert_true(look_brute(out.soup).manifold);
    drop(out);
    vxm_soup_destroy(soup);
  }
}

static void faces_refused(void **state) {
  static const double positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  static const int bad[3][10] = {{0, 1, 2, -1, 0, 1, 3, 0, -1}, {0, 1, 2, -1, 0, 1, -1}, {0, 1, 2, -1, -1}};
  for (int i = 0; i < 3; i++) {
    vxm_soup *soup = soup_of(*state, positions, 4, bad[i], 2), *out;
    int64_t split, stitched;
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_cut_nonmanifold(&out, &split, &stitched, soup, &error), VXM_ERROR_ARGUMENT);
    assert_int_equal(error.element, 1);
    assert_null(out);
    vxm_soup_destroy(soup);
  }
  vxm_soup *empty = new_soup(*state);
  drop(check(empty));
  vxm_soup_destroy(empty);
}

static int cancel_at(const char *phase, double fraction, void *payload) {
  (void)phase, (void)fraction;
  return --*(int *)payload < 0;
}

/** Whatever fails, the result is NULL, the error is told, and nothing is left behind. */
static void failures(void **state) {
  (void)state;
  for (int round = 0; round < ROUNDS(60); round++) {
    int left = round;
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 1;
    if (round % 2) {
      options.progress = cancel_at;
      options.payload = &left;
    }
    vxm_context *context;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    uint8_t full[27];
    vxm_rng rng = {9};
    for (int c = 0; c < 27; c++)
      full[c] = vxm_rng_below(&rng, 2) == 0;
    vxm_soup *soup = cell_surface(context, 3, full), *panels = unshared(soup), *copy = NULL, *out;
    vxm_soup_destroy(soup);
    vxm_context *tight = NULL;
    if (round % 2 == 0) {
      options.memory_limit = 30000 + 2000 * (uint64_t)round;
      assert_int_equal(vxm_context_create(&tight, &options, NULL), VXM_OK);
      copy = new_soup(tight);
      vxm_status status = VXM_OK;
      for (size_t v = 0; v < panels->vertex_count && status == VXM_OK; v++) {
        const double *p = vxm_position(panels, v);
        status = vxm_soup_add_vertex(copy, p[0], p[1], p[2], NULL);
      }
      for (size_t f = 0; f < panels->face_count && status == VXM_OK; f++) {
        size_t n;
        const uint32_t *face = vxm_face(panels, f, &n);
        status = vxm_soup_add_face(copy, face, n, NULL);
      }
      if (status != VXM_OK) {
        vxm_soup_destroy(copy);
        vxm_context_destroy(tight);
        vxm_soup_destroy(panels);
        vxm_context_destroy(context);
        continue;
      }
    }
    int64_t split, stitched;
    vxm_error error = VXM_ERROR_INIT;
    vxm_status status = vxm_cut_nonmanifold(&out, &split, &stitched, copy ? copy : panels, &error);
    assert_int_equal(out == NULL, status != VXM_OK);
    assert_true(status == VXM_OK || status == (round % 2 ? VXM_ERROR_CANCELLED : VXM_ERROR_MEMORY_LIMIT));
    assert_true(status == VXM_OK || error.text[0] != '\0');
    vxm_soup_destroy(out);
    vxm_soup_destroy(copy);
    vxm_context_destroy(tight);
    vxm_soup_destroy(panels);
    vxm_context_destroy(context);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cubes_touch_along_an_edge),
      cmocka_unit_test(prisms_overlap_at_an_edge),
      cmocka_unit_test(rooms_with_a_wall_each),
      cmocka_unit_test(wall_between_two_rooms),
      cmocka_unit_test(blocks_of_cells),
      cmocka_unit_test(edge_twice_between_two_vertices),
      cmocka_unit_test(tangles),
      cmocka_unit_test(turned_faces),
      cmocka_unit_test(repaired_to_manifold),
      cmocka_unit_test(panels_are_stitched),
      cmocka_unit_test(panels_of_blocks),
      cmocka_unit_test(stitches_refused),
      cmocka_unit_test(shared_meshes),
      cmocka_unit_test(odd_positions),
      cmocka_unit_test(faces_refused),
      cmocka_unit_test(failures),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
