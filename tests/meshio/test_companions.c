/* SPDX-License-Identifier: BSD-3-Clause */
/* Which files were opened beside a mesh. */
#include "meshio_test.h"

#include "voxmend.h"

#include <stdlib.h>
#include <unistd.h>

/** A file of that text. */
static void put_text(const char *folder, const char *name, const char *text) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  assert_true(fputs(text, file) >= 0 && fclose(file) == 0);
}

/** What was opened beside a mesh is told, once each, and what is not there is not. */
static void test_companions(void **unused) {
  (void)unused;
  char folder[] = "companions-XXXXXX", path[64];
  vxm_mesh_read_options options = VXM_MESH_READ_OPTIONS_INIT;
  vxm_mesh *mesh;
  assert_non_null(mkdtemp(folder));
  put_text(folder, "a.obj",
           "mtllib a.mtl gone.mtl\nmtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  put_text(folder, "a.mtl", "newmtl a\nKd 1 0 0\nmap_Kd skin.png\n");
  put_text(folder, "skin.png", "no picture");
  snprintf(path, sizeof path, "%s/a.obj", folder);
  for (int colors = 0; colors < 2; colors++) {
    options.colors = colors == 1;
    assert_int_equal(vxm_mesh_read_with(&mesh, NULL, path, &options, NULL), VXM_OK);
    assert_int_equal(vxm_mesh_companion_count(mesh), 2 * colors);
    assert_string_equal(vxm_mesh_companion(mesh, 0), colors ? "a.mtl" : "");
    assert_string_equal(vxm_mesh_companion(mesh, 1), colors ? "skin.png" : "");
    assert_string_equal(vxm_mesh_companion(mesh, 2), "");
    vxm_mesh_destroy(mesh);
  }
  static const char *const names[] = {"a.obj", "a.mtl", "skin.png"};
  for (int n = 0; n < 3; n++) {
    snprintf(path, sizeof path, "%s/%s", folder, names[n]);
    assert_int_equal(unlink(path), 0);
  }
  assert_int_equal(rmdir(folder), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_companions)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
