/* SPDX-License-Identifier: BSD-3-Clause */
/** Every shared mesh goes through repair; what comes out needs none, also when written and read back. */
#include "repair_test.h"

#include "../mesh/shared.h"

#include <unistd.h>

typedef struct travel {
  vxm_context *context;
  char folder[64];
} travel;

/** The same arrays come back, so that repairing them finds as little as before. */
static void check_written_and_read(const travel *t, const vxm_soup *soup, const char *format, bool ascii) {
  char path[128];
  snprintf(path, sizeof path, "%s/mesh.%s", t->folder, format);
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_meshio_write(soup, path, format, VXM_WRITE_POLYGONS | (ascii ? VXM_WRITE_ASCII : 0), &error) !=
      VXM_OK)
    fail_msg("%s", error.text);
  vxm_soup *back = read_soup(t->context, path);
  assert_int_equal(back->vertex_count, soup->vertex_count);
  assert_memory_equal(back->positions, soup->positions, 3 * soup->vertex_count * sizeof *soup->positions);
  assert_memory_equal(back->offsets, soup->offsets, (soup->face_count + 1) * sizeof *soup->offsets);
  assert_memory_equal(back->indices, soup->indices, soup->corner_count * sizeof *soup->indices);
  vxm_soup_destroy(back);
  unlink(path);
}

static void repair_mesh(const shared_mesh *mesh, void *payload) {
  const travel *t = payload;
  vxm_soup *soup = read_soup(t->context, mesh->path);
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, NULL, &report);
  const vxm_census *before = report.before, *after = report.after;
  bool fine = after->duplicate_faces == report.shared_faces && after->opposite_duplicate_faces == 0 &&
              after->unused_vertices == 0 && after->nonfinite_vertices == 0 &&
              after->components == after->components_raw &&
              after->degenerate_faces <= before->degenerate_faces && after->components <= before->components;
  /* what was closed stays so, but for sheets of two sides, which become sheets */
  if (before->closed && 10 * (before->duplicate_faces + before->opposite_duplicate_faces) < before->faces)
    fine &= after->closed;
  if (!fine)
    fail_msg("%s is not fine after repair", mesh->values[0]);
  assert_repair_is_done(out, NULL);
  if (out->corner_count < 120000)
    check_written_and_read(t, out, "ply", false);
  if (out->corner_count < 6000) {
    check_written_and_read(t, out, "ply", true);
    check_written_and_read(t, out, "off", false);
    check_written_and_read(t, out, "obj", false);
  }
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void shared_meshes(void **state) {
  (void)state;
  travel t = {.context = context_of_threads(2), .folder = "/tmp/voxmend-repair-XXXXXX"};
  assert_non_null(mkdtemp(t.folder));
  size_t count = for_each_shared_mesh(repair_mesh, &t);
  rmdir(t.folder);
  vxm_context_destroy(t.context);
  if (count == 0)
    skip();
}

typedef struct closing {
  vxm_context *context;
  const char *file;
  int64_t boundary;
} closing;

static void check_closing(const shared_mesh *mesh, void *payload) {
  closing *c = payload;
  if (strcmp(mesh->values[0], c->file) != 0)
    return;
  vxm_soup *soup = read_soup(c->context, mesh->path);
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, NULL, &report);
  c->boundary = report.before->boundary_edges > 0 ? report.after->boundary_edges : -2;
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/** CAD exports with rounding cracks: all of them close. */
static void real_cracks_close(void **state) {
  (void)state;
  static const char *const files[] = {"cad/trimesh-angle_block.STL", "cad/trimesh-featuretype.STL",
                                      "cad/trimesh-idler_riser.STL", "cad/trimesh-octagonal_pocket.stl"};
  closing c = {.context = context_of_threads(2)};
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    c.file = files[i];
    c.boundary = -1;
    size_t count = for_each_shared_mesh(check_closing, &c);
    if (count == 0) {
      vxm_context_destroy(c.context);
      skip();
    }
    if (c.boundary != 0)
      fail_msg("%s has %lld boundary edges", files[i], (long long)c.boundary);
  }
  vxm_context_destroy(c.context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shared_meshes),
      cmocka_unit_test(real_cracks_close),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
