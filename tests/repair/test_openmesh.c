/* SPDX-License-Identifier: BSD-3-Clause */
/** The module for OpenMesh: what it says of soups, and how it fails. */
#include "../base/rounds.h"
#include "halfedges.h"

#include "../mesh/shared.h"
#include "repair/manifold/cut_nonmanifold.h"

#include <math.h>
#include <pthread.h>
#include <time.h>
#include <unistd.h>

/* ---- The second opinion ---- */

/** Soups of all kinds, and what separating makes of them. */
static void opinions_agree(void **state) {
  vxm_rng rng = {1};
  int manifold = 0;
  for (int i = 0; i < ROUNDS(4000); i++) {
    vxm_soup *soup =
                 tangle(*state, &rng, 4 + (size_t)i % 30, (size_t)vxm_rng_below(&rng, i % 2 ? 8 : 40), 100),
             *apart;
    int64_t split, stitched;
    manifold += look_brute(soup).manifold;
    check_inspection(soup);
    assert_int_equal(vxm_cut_nonmanifold(&apart, &split, &stitched, soup, NULL), VXM_OK);
    check_inspection(apart);
    vxm_soup_destroy(apart);
    vxm_soup_destroy(soup);
  }
  assert_true(manifold > ROUNDS(400));
}

static void blocks_are_closed(void **state) {
  vxm_rng rng = {2};
  for (int i = 0; i < ROUNDS(400); i++) {
    uint8_t full[27];
    for (int c = 0; c < 27; c++)
      full[c] = vxm_rng_below(&rng, 2) == 0;
    vxm_soup *soup = cell_surface(*state, 3, full), *mixed = shuffled(soup, &rng, 0, i % 2), *apart;
    int64_t split, stitched;
    check_inspection(mixed);
    assert_int_equal(vxm_cut_nonmanifold(&apart, &split, &stitched, mixed, NULL), VXM_OK);
    check_inspection(apart);
    assert_int_equal(inspected(apart).boundary_edges, 0);
    vxm_soup_destroy(apart);
    vxm_soup_destroy(mixed);
    vxm_soup_destroy(soup);
  }
}

/** Anything goes: faces of no, one or two corners, corners twice. */
static void any_soup_is_inspected(void **state) {
  vxm_rng rng = {3};
  for (int i = 0; i < ROUNDS(2000); i++) {
    vxm_soup *soup = random_soup(*state, &rng, 1 + (size_t)vxm_rng_below(&rng, 20), 30, 4, 8);
    vxm_halfedge_report report = inspected(soup);
    int64_t bad = 0;
    for (size_t f = 0; f < soup->face_count; f++) {
      size_t n;
      bool twice = false;
      const uint32_t *corner = vxm_face(soup, f, &n);
      for (size_t c = 0; c < n; c++)
        for (size_t d = 0; d < c; d++)
          twice = twice || corner[c] == corner[d];
      bad += n < 3 || twice;
    }
    assert_true(report.rejected >= bad);
    assert_int_equal(report.faces + report.rejected, soup->face_count);
    vxm_soup_destroy(soup);
  }
}

/** OpenMesh reports what it does not take on stderr, of which users must not see anything. */
static void nothing_is_printed(void **state) {
  char name[] = "/tmp/voxmend-test-XXXXXX";
  int file = mkstemp(name), kept = dup(STDERR_FILENO);
  assert_true(file >= 0 && kept >= 0);
  unlink(name);
  dup2(file, STDERR_FILENO);
  vxm_rng rng = {4};
  vxm_soup *soup = tangle(*state, &rng, 6, 50, 100);
  vxm_halfedge_report report = inspected(soup);
  dup2(kept, STDERR_FILENO);
  close(kept);
  assert_true(report.rejected > 0);
  assert_int_equal(lseek(file, 0, SEEK_END), 0);
  close(file);
  vxm_soup_destroy(soup);
}

static void *inspect_often(void *payload) {
  const vxm_soup *soup = payload;
  vxm_halfedge_report first = inspected(soup);
  for (int i = 0; i < ROUNDS(100); i++) {
    vxm_halfedge_report again = inspected(soup);
    if (memcmp(&first, &again, sizeof first) != 0)
      return payload;
  }
  return NULL;
}

static void from_many_threads(void **state) {
  enum { THREADS = 4 };
  pthread_t threads[THREADS];
  vxm_soup *soups[THREADS];
  vxm_rng rng = {5};
  for (int t = 0; t < THREADS; t++) {
    soups[t] = tangle(*state, &rng, 8, 60, 100);
    assert_int_equal(pthread_create(&threads[t], NULL, inspect_often, soups[t]), 0);
  }
  for (int t = 0; t < THREADS; t++) {
    void *wrong;
    pthread_join(threads[t], &wrong);
    assert_null(wrong);
    vxm_soup_destroy(soups[t]);
  }
}

/* ---- Failures ---- */

static void must_be_manifold(void **state) {
  static const uint8_t full[8] = {1, 0, 0, 1, 0, 0, 0, 1};
  vxm_soup *soup = cell_surface(*state, 2, full), *out;
  uint64_t *origin;
  int64_t filled, left;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(openmesh->fill(&out, &origin, &filled, &left, soup, 0, &error), VXM_ERROR_ARGUMENT);
  assert_null(out);
  assert_null(origin);
  assert_non_null(strstr(error.text, "separate"));
  vxm_soup_destroy(soup);
}

static int cancel_at(const char *phase, double fraction, void *payload) {
  (void)phase, (void)fraction;
  return --*(int *)payload < 0;
}

static void failures(void **state) {
  (void)state;
  int done = 0, refused = 0, cancelled = 0;
  for (int round = 0; round < 48; round++) {
    int steps = round / 2;
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 1;
    if (round % 2) {
      options.progress = cancel_at;
      options.payload = &steps;
    } else
      options.memory_limit = 50000 + 60000 * (uint64_t)round;
    vxm_context *context;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    vxm_soup *soup = new_soup(context), *out;
    uint32_t n = 510;
    vxm_status status = vxm_soup_reserve(soup, 2 * n, n, 4 * n, NULL);
    for (uint32_t k = 0; k < 2 * n && status == VXM_OK; k++)
      add_vertex(soup, cos(2 * M_PI * k / n), sin(2 * M_PI * k / n), k < n ? 0 : 3);
    for (uint32_t k = 0; k < n && status == VXM_OK; k++) {
      uint32_t wall[4] = {k, (k + 1) % n, n + (k + 1) % n, n + k};
      add_face(soup, wall, 4);
    }
    if (status == VXM_OK) {
      uint64_t *origin;
      int64_t filled, left;
      vxm_halfedge_report report;
      vxm_error error = VXM_ERROR_INIT;
      status = openmesh->inspect(&report, soup, &error);
      if (status == VXM_OK)
        status = openmesh->fill(&out, &origin, &filled, &left, soup, 0, &error);
      else
        out = NULL, origin = NULL;
      assert_true(status == VXM_OK || status == (round % 2 ? VXM_ERROR_CANCELLED : VXM_ERROR_MEMORY_LIMIT));
      assert_int_equal(out == NULL, status != VXM_OK);
      assert_int_equal(origin == NULL, status != VXM_OK);
      assert_true(status == VXM_OK || error.text[0] != '\0');
      done += status == VXM_OK;
      cancelled += status == VXM_ERROR_CANCELLED;
      refused += status == VXM_ERROR_MEMORY_LIMIT;
      vxm_free(context, origin);
      vxm_soup_destroy(out);
    }
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
  assert_true(done > 0 && refused > 0 && cancelled > 0);
}

/* ---- Real meshes ---- */

static void shared_mesh_is_filled(const shared_mesh *mesh, void *payload) {
  vxm_soup *soup = read_soup(payload, mesh->path), *clean = NULL, *apart = NULL;
  vxm_error error = VXM_ERROR_INIT;
  if (soup->face_count < 8000) {
    int64_t split, stitched;
    if (vxm_repair_run(&clean, NULL, soup, NULL, &error) != VXM_OK ||
        vxm_cut_nonmanifold(&apart, &split, &stitched, clean, &error) != VXM_OK)
      fail_msg("%s: %s", mesh->path, error.text);
    drop(apart, fill(apart, 100));
    vxm_soup_destroy(apart);
    vxm_soup_destroy(clean);
  }
  vxm_soup_destroy(soup);
}

static void shared_meshes(void **state) {
  if (for_each_shared_mesh(shared_mesh_is_filled, *state) == 0)
    skip();
}

int main(void) {
  if (open_openmesh() != 0)
    return 77;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(opinions_agree),
      cmocka_unit_test(blocks_are_closed),
      cmocka_unit_test(any_soup_is_inspected),
      cmocka_unit_test(nothing_is_printed),
      cmocka_unit_test(from_many_threads),
      cmocka_unit_test(must_be_manifold),
      cmocka_unit_test(failures),
      cmocka_unit_test(shared_meshes),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
