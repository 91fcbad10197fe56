/* SPDX-License-Identifier: BSD-3-Clause */
/** Levels, fans, defects, the account of parts, and files that are verified before they get their names. */
#include "repair_test.h"

#include "mesh/census.h"
#include "mesh/components.h"
#include "repair/defects.h"
#include "repair/state/vertex_fans.h"
#include "repair/verify.h"

#include <math.h>
#include <unistd.h>

/* ---- Soups ---- */

/** A cube of six quads, its least corner at (x, y, z), without the first `missing` faces. */
static void add_box(vxm_soup *soup, double x, double y, double z, double side, int missing) {
  static const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  uint32_t first = (uint32_t)soup->vertex_count;
  for (int v = 0; v < 8; v++)
    add_vertex(soup, x + side * (v & 1), y + side * (v >> 1 & 1), z + side * (v >> 2));
  for (int f = missing; f < 6; f++) {
    uint32_t corners[4];
    for (int i = 0; i < 4; i++)
      corners[i] = first + faces[f][i];
    add_face(soup, corners, 4);
  }
}

static vxm_soup *cubes(vxm_context *context, int count, const double (*at)[3], int missing) {
  vxm_soup *soup = new_soup(context);
  for (int i = 0; i < count; i++)
    add_box(soup, at[i][0], at[i][1], at[i][2], 1, missing);
  return soup;
}

static int64_t remains_of(const vxm_verification *found, const char *what) {
  for (int i = 0; i < found->count; i++)
    if (strcmp(found->findings[i].what, what) == 0)
      return found->findings[i].count;
  return 0;
}

static vxm_verification verified(const vxm_soup *soup, vxm_level level) {
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  vxm_verification found = VXM_VERIFICATION_INIT;
  options.level = level;
  assert_int_equal(vxm_verify(&found, soup, &options, NULL), VXM_OK);
  assert_int_equal(found.reached, found.count == 0);
  return found;
}

/* ---- Levels ---- */

static void levels(void **state) {
  static const double one[1][3] = {{0, 0, 0}}, edge[2][3] = {{0, 0, 0}, {1, 1, 0}},
                      corner[2][3] = {{0, 0, 0}, {1, 1, 1}};
  vxm_soup *soup = cubes(*state, 1, one, 0);
  assert_true(verified(soup, VXM_LEVEL_CLOSED).reached);
  vxm_soup_destroy(soup);

  soup = cubes(*state, 1, one, 1);
  assert_true(verified(soup, VXM_LEVEL_MANIFOLD).reached);
  vxm_verification found = verified(soup, VXM_LEVEL_CLOSED);
  assert_int_equal(remains_of(&found, "boundary_edges"), 4);
  assert_int_equal(found.count, 1);
  vxm_soup_destroy(soup);

  /* cubes with vertices of their own: they are welded before they are judged */
  soup = cubes(*state, 2, edge, 0);
  assert_true(verified(soup, VXM_LEVEL_CLEAN).reached);
  found = verified(soup, VXM_LEVEL_MANIFOLD);
  assert_int_equal(remains_of(&found, "nonmanifold_edges"), 1);
  assert_true(found.findings[0].position[0] == 1 && found.findings[0].position[1] == 1 &&
              found.findings[0].position[2] == 0.5);
  vxm_soup_destroy(soup);

  soup = cubes(*state, 2, corner, 0);
  found = verified(soup, VXM_LEVEL_MANIFOLD);
  assert_int_equal(found.count, 1);
  assert_int_equal(remains_of(&found, "nonmanifold_vertices"), 1);
  assert_true(found.findings[0].position[0] == 1 && found.findings[0].position[1] == 1 &&
              found.findings[0].position[2] == 1);
  vxm_soup_destroy(soup);

  soup = cubes(*state, 1, one, 0);
  add_box(soup, 0, 0, 0, 1, 5); /* a face again */
  found = verified(soup, VXM_LEVEL_CLEAN);
  assert_int_equal(remains_of(&found, "duplicate_faces"), 1);
  vxm_soup_destroy(soup);

  soup = new_soup(*state);
  assert_int_equal(verified(soup, VXM_LEVEL_CLEAN).reached, false);
  vxm_soup_destroy(soup);
}

/** Closing reaches the level closed for whatever is manifold and no sheet. */
static void closing_reaches(void **state) {
  static const double one[1][3] = {{0, 0, 0}};
  for (int missing = 1; missing <= 2; missing++) {
    vxm_soup *soup = cubes(*state, 1, one, missing);
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.level = VXM_LEVEL_CLOSED;
    vxm_soup *out = repaired(soup, &options, NULL);
    assert_true(verified(out, VXM_LEVEL_CLOSED).reached);
    vxm_soup_destroy(out);
    options.fill_holes = 3; /* the rim has more edges: what stays open is a sheet, by the same word */
    out = repaired(soup, &options, NULL);
    assert_true(verified(out, VXM_LEVEL_CLOSED).reached);
    vxm_soup_destroy(out);
    options.sheets = VXM_SHEETS_KEEP;
    out = repaired(soup, &options, NULL);
    assert_false(verified(out, VXM_LEVEL_CLOSED).reached);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/* ---- Fans, by walking ---- */

static bool has_edge(const uint32_t *t, uint32_t a, uint32_t b) {
  for (int i = 0; i < 3; i++)
    if ((t[i] == a && t[(i + 1) % 3] == b) || (t[i] == b && t[(i + 1) % 3] == a))
      return true;
  return false;
}

static bool share_edge_at(const uint32_t *s, const uint32_t *t, uint32_t v) {
  for (int i = 0; i < 3; i++)
    if (s[i] != v && has_edge(s, v, s[i]) && has_edge(t, v, s[i]))
      return true;
  return false;
}

static unsigned count_fans(const vxm_soup *soup, uint32_t v) {
  size_t about[64], count = 0;
  unsigned fans = 0;
  for (size_t f = 0; f < soup->face_count; f++)
    for (int i = 0; i < 3; i++)
      if (soup->indices[3 * f + (size_t)i] == v)
        about[count++] = f;
  bool seen[64] = {false};
  for (size_t start = 0; start < count; start++) {
    size_t queue[64], queued = 0;
    if (seen[start])
      continue;
    fans++;
    seen[start] = true;
    queue[queued++] = start;
    for (size_t next = 0; next < queued; next++)
      for (size_t other = 0; other < count; other++)
        if (!seen[other] &&
            share_edge_at(soup->indices + 3 * about[queue[next]], soup->indices + 3 * about[other], v)) {
          seen[other] = true;
          queue[queued++] = other;
        }
  }
  return fans;
}

static void fans_by_walking(void **state) {
  vxm_rng rng = {7};
  for (int trial = 0; trial < 2000; trial++) {
    vxm_soup *soup = new_soup(*state);
    size_t vertices = 4 + vxm_rng_below(&rng, 8), faces = 1 + vxm_rng_below(&rng, 20);
    for (size_t v = 0; v < vertices; v++)
      add_vertex(soup, (double)v, 0, 0);
    while (soup->face_count < faces) {
      uint32_t a = (uint32_t)vxm_rng_below(&rng, vertices), b = (uint32_t)vxm_rng_below(&rng, vertices),
               c = (uint32_t)vxm_rng_below(&rng, vertices);
      if (a != b && b != c && c != a)
        add_triangle(soup, a, b, c);
    }
    vxm_repair_state work = {.soup = soup, .context = *state};
    uint8_t *fans;
    assert_int_equal(vxm_vertex_fans_count(&fans, &work, NULL), VXM_OK);
    for (uint32_t v = 0; v < vertices; v++)
      assert_int_equal(fans[v], count_fans(soup, v));
    vxm_free(*state, fans);
    vxm_repair_state_touch(&work);
    vxm_soup_destroy(soup);
  }
}

/* ---- Defects and parts agree with the census ---- */

static void defects_as_counted(void **state) {
  vxm_rng rng = {8};
  for (int trial = 0; trial < 500; trial++) {
    vxm_soup *soup = random_soup(*state, &rng, 3 + vxm_rng_below(&rng, 10), vxm_rng_below(&rng, 16), 3, 6);
    vxm_census census = VXM_CENSUS_INIT;
    vxm_defects *found;
    assert_int_equal(vxm_soup_census(&census, soup, NULL), VXM_OK);
    assert_int_equal(vxm_defects_find(&found, soup, 0, false, NULL), VXM_OK);
    int64_t counts[VXM_DEFECT_KINDS] = {0};
    for (size_t i = 0; i < found->count; i++) {
      counts[found->items[i].kind]++;
      assert_true(i == 0 || found->items[i - 1].kind <= found->items[i].kind);
    }
    assert_int_equal(counts[VXM_DEFECT_BOUNDARY_EDGE], census.boundary_edges);
    assert_int_equal(counts[VXM_DEFECT_NONMANIFOLD_EDGE], census.nonmanifold_edges);
    assert_int_equal(counts[VXM_DEFECT_INCONSISTENT_EDGE], census.inconsistent_edges);
    assert_int_equal(counts[VXM_DEFECT_DEGENERATE_FACE], census.degenerate_faces);
    assert_true(counts[VXM_DEFECT_DUPLICATE_FACE] >= census.duplicate_faces);
    vxm_defects_destroy(found);
    vxm_soup_destroy(soup);
  }
}

/** Every face has the tag of the face that it was; its part has to be the component of that one. */
static void assert_parts_of_origin(const vxm_soup *soup, const vxm_soup *out) {
  uint32_t *map = calloc(soup->vertex_count + 1, sizeof *map),
           *part = calloc(soup->face_count + 1, sizeof *part);
  size_t count;
  assert_int_equal(vxm_weld_exact(soup->context, soup->positions, soup->vertex_count, map, NULL, NULL),
                   VXM_OK);
  assert_int_equal(vxm_components(soup->context, soup, map, part, &count, NULL), VXM_OK);
  for (size_t f = 0; f < out->face_count; f++)
    assert_int_equal(out->face_parts[f], part[out->face_tags[f]]);
  free(part);
  free(map);
}

static void parts_add_up(void **state) {
  vxm_rng rng = {9};
  for (int trial = 0; trial < 500; trial++) {
    vxm_soup *soup = random_soup(*state, &rng, 3 + vxm_rng_below(&rng, 14), vxm_rng_below(&rng, 16), 4, 6);
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    REPAIR_REPORT(report);
    options.part_changes = true;
    options.fill_holes = trial % 2 ? -1 : 0;
    tag_faces(soup);
    vxm_soup *out = repaired(soup, &options, &report);
    assert_int_equal(out->part_count, report.before->components);
    assert_parts_of_origin(soup, out);
    vxm_part_state before = {0}, after = {0};
    int64_t flipped = 0;
    for (size_t i = 0; i < out->part_count; i++) {
      const vxm_part_change *part = &out->part_changes[i];
      before.faces += part->before->faces;
      before.boundary_edges += part->before->boundary_edges;
      before.nonmanifold_edges += part->before->nonmanifold_edges;
      before.inconsistent_edges += part->before->inconsistent_edges;
      after.faces += part->after->faces;
      after.boundary_edges += part->after->boundary_edges;
      after.nonmanifold_edges += part->after->nonmanifold_edges;
      after.area += part->after->area;
      flipped += part->flipped;
      assert_true(part->max_displacement == 0 || options.weld != VXM_WELD_OFF);
    }
    assert_int_equal(before.faces, report.before->faces);
    assert_int_equal(before.boundary_edges, report.before->boundary_edges);
    assert_int_equal(before.nonmanifold_edges, report.before->nonmanifold_edges);
    assert_int_equal(before.inconsistent_edges, report.before->inconsistent_edges);
    assert_int_equal(after.faces, report.after->faces);
    assert_int_equal(after.boundary_edges, report.after->boundary_edges);
    assert_int_equal(after.nonmanifold_edges, report.after->nonmanifold_edges);
    assert_true(fabs(after.area - report.after->area) <= 1e-9 * (1 + report.after->area));
    assert_int_equal(flipped, count_of(&report, "orientation"));
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

static void moved_and_bounded(void **state) {
  static const double one[1][3] = {{0, 0, 0}};
  vxm_soup *soup = cubes(*state, 1, one, 0);
  add_vertex(soup, 1.0, 1.0, 1.25); /* a spike that the tolerance takes away again */
  add_triangle(soup, 7, 8, 6);
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  REPAIR_REPORT(report);
  options.weld = VXM_WELD_TOLERANCE;
  options.weld_tolerance = 0.3;
  options.part_changes = true;
  vxm_soup *out = repaired(soup, &options, &report);
  assert_true(report.max_displacement == 0.25);
  vxm_soup_destroy(out);
  options.max_change = 0.01;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_repair_run(&out, NULL, soup, &options, &error), VXM_ERROR_UNREACHED);
  assert_null(out);
  options.max_change = 0.5;
  assert_int_equal(vxm_repair_run(&out, NULL, soup, &options, &error), VXM_OK);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/* ---- Single precision ---- */

/** What a 32-bit file cannot tell apart is seen before it is written. */
static void fits_stl(void **state) {
  vxm_rng rng = {10};
  char path[] = "verify-XXXXXX.stl";
  int descriptor = mkstemps(path, 4);
  assert_true(descriptor >= 0);
  close(descriptor);
  for (int trial = 0; trial < 100; trial++) {
    vxm_soup *soup = new_soup(*state);
    for (int i = 0; i < 6; i++)
      add_box(soup, 100 + vxm_rng_unit(&rng) * 1e-4, i * 2 + vxm_rng_unit(&rng), 1e6 * vxm_rng_unit(&rng),
              1e-6 + vxm_rng_unit(&rng) * 1e-4, 0);
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    vxm_mesh_write_options write = VXM_MESH_WRITE_OPTIONS_INIT;
    options.single_precision = true;
    vxm_soup *out = repaired(soup, &options, NULL);
    for (size_t i = 0; i < 3 * out->vertex_count; i++)
      assert_true((double)(float)out->positions[i] == out->positions[i]);
    vxm_verification found = {.reached = true};
    if (out->face_count > 0)
      assert_int_equal(vxm_write_verified(&found, out, path, &write, &options, false, NULL), VXM_OK);
    assert_true(found.reached);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
  unlink(path);
}

/* ---- Files ---- */

static bool exists(const char *path) {
  return access(path, F_OK) == 0;
}

static void unreached_leaves_nothing(void **state) {
  static const double one[1][3] = {{0, 0, 0}};
  vxm_soup *open = cubes(*state, 1, one, 1), *closed = cubes(*state, 1, one, 0);
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  vxm_mesh_write_options write = VXM_MESH_WRITE_OPTIONS_INIT;
  vxm_verification found = VXM_VERIFICATION_INIT;
  vxm_error error = VXM_ERROR_INIT;
  char path[] = "verify-XXXXXX.ply";
  int descriptor = mkstemps(path, 4);
  assert_true(descriptor >= 0);
  close(descriptor);
  unlink(path);
  options.level = VXM_LEVEL_CLOSED;
  assert_int_equal(vxm_write_verified(&found, open, path, &write, &options, false, &error),
                   VXM_ERROR_UNREACHED);
  assert_false(exists(path));
  assert_int_equal(remains_of(&found, "boundary_edges"), 4);
  assert_int_equal(vxm_write_verified(&found, open, path, &write, &options, true, &error), VXM_OK);
  assert_true(exists(path) && !found.reached);
  assert_int_equal(vxm_write_verified(&found, closed, path, &write, &options, false, &error), VXM_OK);
  assert_true(found.reached);
  /* a file that is there stays as it is when the next one is refused */
  assert_int_equal(vxm_write_verified(&found, open, path, &write, &options, false, &error),
                   VXM_ERROR_UNREACHED);
  assert_true(exists(path));
  vxm_mesh *back;
  assert_int_equal(vxm_mesh_read(&back, *state, path, &error), VXM_OK);
  assert_int_equal(vxm_mesh_face_count(back), 12);
  vxm_mesh_destroy(back);
  write.keep_polygons = true;
  assert_int_equal(vxm_write_verified(&found, closed, path, &write, &options, false, &error), VXM_OK);
  assert_true(found.reached);
  assert_int_equal(vxm_mesh_read(&back, *state, path, &error), VXM_OK);
  assert_int_equal(vxm_mesh_face_count(back), 6);
  vxm_mesh_destroy(back);
  unlink(path);
  vxm_soup_destroy(closed);
  vxm_soup_destroy(open);
}

/* ---- After separation ---- */

/** What was cut apart is turned, counted once, and left as it is; a vertex that was in the way is told by its
 * number in the mesh that is verified. */
static void after_separation(void **state) {
  static const double edge[2][3] = {{0, 0, 0}, {1, 1, 0}};
  for (int turned = 0; turned < 3; turned++) {
    vxm_soup *soup = cubes(*state, 2, edge, 0);
    for (size_t c = 24; c < (turned == 0   ? 24u
                             : turned == 1 ? 28u
                                           : 48u);
         c += 4) { /* none, a face, or all of a cube */
      uint32_t kept = soup->indices[c + 1];
      soup->indices[c + 1] = soup->indices[c + 3];
      soup->indices[c + 3] = kept;
    }
    for (int single = 0; single < 2; single++) {
      vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
      REPAIR_REPORT(report);
      options.level = VXM_LEVEL_CLOSED;
      options.part_changes = true;
      options.single_precision = single;
      vxm_soup *out = repaired(soup, &options, &report);
      int64_t faces = turned == 0 ? 0 : turned == 1 ? 1 : 6;
      assert_int_equal(count_of(&report, "orientation"), faces * (single ? 2 : 1));
      assert_int_equal(out->part_changes[0].flipped, faces * (single ? 2 : 1));
      assert_true(fabs(report.after->volume - 2) < 1e-5);
      vxm_verification found = VXM_VERIFICATION_INIT;
      assert_int_equal(vxm_verify(&found, out, &options, NULL), VXM_OK);
      assert_true(found.reached);
      assert_repair_is_done(out, &options);
      vxm_soup_destroy(out);
    }
    vxm_soup_destroy(soup);
  }
}

/** Numbers are those of the mesh that is verified, also behind what a repair would remove. */
static void elements_of_the_file(void **state) {
  static const double one[1][3] = {{0, 0, 0}};
  vxm_soup *soup = new_soup(*state);
  add_box(soup, 0, 0, 0, 1, 0);
  add_triangle(soup, 3, 3, 4);  /* face 6: none */
  add_box(soup, 0, 0, 0, 1, 5); /* face 7: again, on vertices 11 to 18 */
  vxm_verification found = verified(soup, VXM_LEVEL_CLEAN);
  assert_int_equal(remains_of(&found, "repeated_corners"), 1);
  assert_int_equal(remains_of(&found, "duplicate_faces"), 1);
  for (int i = 0; i < found.count; i++) {
    assert_true(found.findings[i].placed);
    if (strcmp(found.findings[i].what, "repeated_corners") == 0)
      assert_int_equal(found.findings[i].element, 6);
  }
  vxm_soup_destroy(soup);
  /* an open edge behind a face that would go */
  soup = new_soup(*state);
  add_box(soup, 0, 0, 0, 1, 0);
  add_triangle(soup, 0, 0, 1);
  add_box(soup, 4, 0, 0, 1, 1);
  found = verified(soup, VXM_LEVEL_CLOSED);
  assert_int_equal(remains_of(&found, "boundary_edges"), 4);
  assert_int_equal(found.findings[0].element, 8); /* the second box begins with face 7, which has none */
  vxm_soup_destroy(soup);
  soup = cubes(*state, 1, one, 0);
  uint32_t kept = soup->indices[9];
  soup->indices[9] = soup->indices[11];
  soup->indices[11] = kept;
  found = verified(soup, VXM_LEVEL_CLEAN);
  assert_int_equal(found.count, 1);
  assert_string_equal(found.findings[0].what, "orientation");
  assert_int_equal(found.findings[0].element, 2);
  vxm_soup_destroy(soup);
}

/** Options are checked as for a repair. */
static void options_are_checked(void **state) {
  static const double one[1][3] = {{0, 0, 0}};
  vxm_soup *soup = cubes(*state, 1, one, 0);
  vxm_repair_options keep = VXM_REPAIR_OPTIONS_INIT, wrap = keep, version = keep, faces[2] = {keep, keep};
  vxm_verification found = VXM_VERIFICATION_INIT;
  keep.keep_orientation = true;
  keep.level = VXM_LEVEL_CLOSED;
  wrap.wrap_alpha = NAN;
  version.size = 2;
  faces[0].wrap_alpha = faces[1].wrap_alpha = 0.1; /* whose faces are all new */
  faces[0].keep_duplicates = faces[1].keep_orientation = true;
  assert_int_equal(vxm_mesh_verify(&found, soup, &keep, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_mesh_verify(&found, soup, &wrap, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_mesh_verify(&found, soup, &version, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_mesh_verify(&found, soup, &faces[0], NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_mesh_verify(&found, soup, &faces[1], NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_mesh_verify(&found, soup, NULL, NULL), VXM_OK);
  vxm_soup_destroy(soup);
}

/* ---- Parts ---- */

/** A box without its bottom, and half of the bottom a crack apart: edges are of the part that their faces are
 * of. */
static void joined_parts(void **state) {
  static const double one[1][3] = {{0, 0, 0}};
  static const uint32_t bottom[3] = {0, 2, 3};
  vxm_soup *soup = cubes(*state, 1, one, 1);
  uint32_t first = (uint32_t)soup->vertex_count;
  for (int i = 0; i < 3; i++) {
    const double p[3] = {vxm_position(soup, bottom[i])[0], vxm_position(soup, bottom[i])[1], 0};
    add_vertex(soup, p[0] + 1e-7, p[1], p[2]);
  }
  add_triangle(soup, first, first + 1, first + 2);
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  REPAIR_REPORT(report);
  options.part_changes = true;
  vxm_soup *out = repaired(soup, &options, &report);
  assert_int_equal(out->part_count, 2);
  const vxm_part_change *box = &out->part_changes[0], *half = &out->part_changes[1];
  assert_int_equal(box->before->boundary_edges, 4);
  assert_int_equal(half->before->boundary_edges, 3);
  /* of the box's rim two edges are left open, of the triangle's the long one */
  assert_int_equal(box->after->boundary_edges, 2);
  assert_int_equal(half->after->boundary_edges, 1);
  assert_int_equal(report.after->boundary_edges, 3);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/** What changes no more than it has to passes, and what vanishes does not. */
static void bounded_changes(void **state) {
  static const double one[1][3] = {{0, 0, 0}}, same[2][3] = {{0, 0, 0}, {0, 0, 0}},
                      two[2][3] = {{0, 0, 0}, {5, 0, 0}};
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.max_change = 1e-9;
  vxm_soup *soup = cubes(*state, 1, one, 0), *out;
  uint32_t kept = soup->indices[1];
  soup->indices[1] = soup->indices[3];
  soup->indices[3] = kept;
  assert_int_equal(vxm_repair_run(&out, NULL, soup, &options, NULL), VXM_OK); /* a face was turned */
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  soup = cubes(*state, 2, same, 0);
  assert_int_equal(vxm_repair_run(&out, NULL, soup, &options, NULL), VXM_OK); /* a part was there twice */
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  soup = cubes(*state, 1, one, 0);
  add_box(soup, 5, 0, 0, 0.125, 0);
  options.weld = VXM_WELD_TOLERANCE;
  options.weld_tolerance = 0.3;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_repair_run(&out, NULL, soup, &options, &error),
                   VXM_ERROR_UNREACHED); /* one vanishes */
  assert_non_null(strstr(error.text, "nothing of part 1"));
  options.weld = VXM_WELD_AUTO;
  options.drop_volume = 0.5;
  assert_int_equal(vxm_repair_run(&out, NULL, soup, &options, NULL), VXM_OK); /* as it is to */
  assert_int_equal(out->face_count, 6);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  /* with faces of both, a volume that does change is seen */
  soup = cubes(*state, 2, two, 0);
  kept = soup->indices[1];
  soup->indices[1] = soup->indices[3];
  soup->indices[3] = kept;
  soup->positions[3 * 15 + 2] = 1.2;
  options = (vxm_repair_options)VXM_REPAIR_OPTIONS_INIT;
  options.max_change = 1e-3;
  options.weld = VXM_WELD_TOLERANCE;
  options.weld_tolerance = 0.5;
  assert_int_equal(vxm_repair_run(&out, NULL, soup, &options, NULL), VXM_OK);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static int set_up(void **state) {
  *state = context_of_threads(2);
  return 0;
}

static int tear_down(void **state) {
  vxm_context_destroy(*state);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(levels),
      cmocka_unit_test(closing_reaches),
      cmocka_unit_test(fans_by_walking),
      cmocka_unit_test(defects_as_counted),
      cmocka_unit_test(parts_add_up),
      cmocka_unit_test(moved_and_bounded),
      cmocka_unit_test(after_separation),
      cmocka_unit_test(elements_of_the_file),
      cmocka_unit_test(options_are_checked),
      cmocka_unit_test(joined_parts),
      cmocka_unit_test(bounded_changes),
      cmocka_unit_test(fits_stl),
      cmocka_unit_test(unreached_leaves_nothing),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
