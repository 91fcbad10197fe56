/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Every function of the public headers with NULL for each of its pointers, and for all combinations of them:
 * an error where something must be there, 0, "" or NULL from getters, and never a crash. A function that is
 * not in these lists fails the test.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "voxmend.h"
#include "voxmend/experimental.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- What calls are made with ---- */

static char folder[] = "/tmp/voxmend-null.XXXXXX";
static vxm_error error;
static vxm_context *context;
static vxm_mesh *mesh;
static vxm_defects *defects;
static vxm_grid *grid;
static vxm_engine *engine;
static vxm_model *model;
static vxm_sampler *sampler;
static vxm_sparse *sparse;
static vxm_sparse_file *sparse_file;
static const vxm_sparse_file *values_files[2];
static const vxm_set_operation set_operations[] = {VXM_SET_UNION};
static vxm_carver *carver;
static vxm_field *field;

static const vxm_space space = {{4, 4, 4}, {0, 0, 0}, {0.25, 0.25, 0.25}};
static const uint64_t words_of_grid[16];
static const int64_t window_begin[3] = {0, 1, 2}, window_end[3] = {4, 3, 4};
static const int64_t first_cube[3] = {0, 0, 0}, last_cube[3] = {1, 1, 1};
static const double unmoved[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
static const char off_text[] = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
static const vxm_variant variant;
static const char *const variant_path[] = {"variant.npy"};
static vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
static vxm_context_options context_options = VXM_CONTEXT_OPTIONS_INIT;
static vxm_mesh_read_options read_options = VXM_MESH_READ_OPTIONS_INIT;
static vxm_mesh_write_options mesh_write = VXM_MESH_WRITE_OPTIONS_INIT;
static vxm_repair_options repair = VXM_REPAIR_OPTIONS_INIT;
static vxm_grid_write_options grid_write = VXM_GRID_WRITE_OPTIONS_INIT;
static vxm_threshold_options threshold = {sizeof(vxm_threshold_options), true, 0.5, false, 0};
static vxm_picture_options picture = VXM_PICTURE_OPTIONS_INIT;
static vxm_page_options page = VXM_PAGE_OPTIONS_INIT;
static vxm_engine_options engine_options = VXM_ENGINE_OPTIONS_INIT;
static vxm_published_options published_options = VXM_PUBLISHED_OPTIONS_INIT;
static vxm_baseline_options baseline_options = VXM_BASELINE_OPTIONS_INIT;
static vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
static vxm_voxelize_options voxelize_options = VXM_VOXELIZE_OPTIONS_INIT;
static vxm_coverage_options coverage_options = VXM_COVERAGE_OPTIONS_INIT;
static vxm_distance_options distance_options = VXM_DISTANCE_OPTIONS_INIT;
static vxm_label_options label_options = VXM_LABEL_OPTIONS_INIT;
static vxm_color_options color_options = VXM_COLOR_OPTIONS_INIT;
static vxm_sampler_options sampler_options = VXM_SAMPLER_OPTIONS_INIT;

/** Where calls put what they make. */
static struct {
  vxm_context *context;
  vxm_mesh *mesh;
  vxm_defects *defects;
  vxm_grid *grid;
  vxm_engine *engine;
  vxm_published *published;
  vxm_device_voxels *voxels;
  struct DLManagedTensor *tensor;
  vxm_model *model;
  vxm_sampler *sampler;
  vxm_sparse *sparse;
  vxm_sparse_file *sparse_file;
  vxm_carver *carver;
  vxm_carve_report carved;
  vxm_field *field;
  vxm_field_range range;
  vxm_reading_info reading;
  vxm_look look;
  vxm_texture texture;
  vxm_census census;
  vxm_repair_report repair;
  vxm_verification verification;
  vxm_comparison comparison;
  vxm_engine_info info;
  int64_t count;
  int64_t box_begin[3], box_end[3];
  vxm_space space;
  vxm_published_report published_report;
  vxm_baseline_report baseline;
  vxm_engine_stages stages;
  vxm_device_info device;
  vxm_voxelize_report voxelize;
  vxm_estimate estimate;
  vxm_coverage_report coverage;
  vxm_distance_report distance;
  vxm_label_report labels;
  vxm_pose pose;
  bool written;
  double ms;
  float values[4 * 4 * 4 * 4];
} out;

static void drop_made(void) {
  vxm_context_destroy(out.context);
  vxm_mesh_destroy(out.mesh);
  vxm_defects_destroy(out.defects);
  vxm_grid_destroy(out.grid);
  vxm_engine_destroy(out.engine);
  vxm_published_destroy(out.published);
  vxm_device_voxels_destroy(out.voxels);
  vxm_model_destroy(out.model);
  vxm_sampler_destroy(out.sampler);
  vxm_sparse_destroy(out.sparse);
  vxm_sparse_file_close(out.sparse_file);
  vxm_carver_destroy(out.carver);
  vxm_field_destroy(out.field);
  memset(&out, 0, sizeof out);
}

static void visit(const vxm_sparse_piece *piece, void *payload) {
  (void)piece;
  (void)payload;
}

/** Of a mesh of its own. */
static vxm_status prepare_in_place(vxm_mesh **at, vxm_repair_report *report,
                                   const vxm_repair_options *options, vxm_error *failure) {
  if (at)
    vxm_mesh_read_memory(at, context, off_text, strlen(off_text), "x", NULL);
  return vxm_mesh_prepare_in_place(at, report, options, failure);
}

/* ---- The calls ---- */

/** The i-th pointer of a call, or NULL in its place. */
#define P(i, pointer) (nulls >> (i)&1 ? NULL : (pointer))
/* Getters as calls that fail where they give nothing. */
#define GIVES(value) ((value) ? VXM_OK : VXM_ERROR_ARGUMENT)
#define GIVES_TEXT(text) GIVES(*(text))
#define DOES(call) ((call), nulls ? VXM_ERROR_ARGUMENT : VXM_OK)
/* What cannot be had of this object: looked at for crashes alone. */
#define ANYTHING(value) ((void)(value), nulls ? VXM_ERROR_ARGUMENT : VXM_OK)

/* X(function, number of pointers, those that must be there as bits, call) */
#define ERROR_AND_CONTEXT_CALLS(X)                                                                          \
  X(vxm_version, 0, 0, GIVES_TEXT(vxm_version()))                                                           \
  X(vxm_status_name, 0, 0, GIVES_TEXT(vxm_status_name(VXM_OK)))                                             \
  X(vxm_context_create, 3, 1, vxm_context_create(P(0, &out.context), P(1, &context_options), P(2, &error))) \
  X(vxm_context_destroy, 1, 0, (vxm_context_destroy(NULL), VXM_OK))                                         \
  X(vxm_context_threads, 1, 0, GIVES(vxm_context_threads(P(0, context))))                                   \
  X(vxm_context_peak_bytes, 1, 1, GIVES(vxm_context_peak_bytes(P(0, context))))                             \
  X(vxm_context_hold_files, 2, 1, vxm_context_hold_files(P(0, context), P(1, &error)))                      \
  X(vxm_context_publish_files, 2, 0, vxm_context_publish_files(P(0, context), P(1, &error)))                \
  X(vxm_file_write, 4, 6,                                                                                   \
    vxm_file_write(P(0, context), P(1, "out.off"), P(2, off_text), strlen(off_text), P(3, &error)))         \
  X(vxm_context_drop_files, 1, 0, (vxm_context_drop_files(P(0, context)), VXM_OK))

#define MESH_CALLS(X)                                                                                      \
  X(vxm_mesh_triangulate, 3, 3, vxm_mesh_triangulate(P(0, &out.mesh), P(1, mesh), P(2, &error)))           \
  X(vxm_mesh_create, 4, 5, vxm_mesh_create(P(0, &out.mesh), P(1, context), P(2, &arrays), P(3, &error)))   \
  X(vxm_mesh_read, 4, 5, vxm_mesh_read(P(0, &out.mesh), P(1, context), P(2, "in.off"), P(3, &error)))      \
  X(vxm_mesh_read_memory, 5, 5,                                                                            \
    vxm_mesh_read_memory(P(0, &out.mesh), P(1, context), P(2, off_text), strlen(off_text), P(3, "x"),      \
                         P(4, &error)))                                                                    \
  X(vxm_mesh_read_with, 5, 5,                                                                              \
    vxm_mesh_read_with(P(0, &out.mesh), P(1, context), P(2, "in.off"), P(3, &read_options), P(4, &error))) \
  X(vxm_mesh_read_memory_with, 6, 5,                                                                       \
    vxm_mesh_read_memory_with(P(0, &out.mesh), P(1, context), P(2, off_text), strlen(off_text), P(3, "x"), \
                              P(4, &read_options), P(5, &error)))                                          \
  X(vxm_mesh_divide, 3, 3, vxm_mesh_divide(P(0, &out.mesh), P(1, mesh), VXM_LABEL_GROUP, P(2, &error)))    \
  X(vxm_mesh_look, 3, 3, vxm_mesh_look(P(0, &out.look), P(1, mesh), P(2, &error)))                         \
  X(vxm_mesh_texture, 3, 3, vxm_mesh_texture(P(0, &out.texture), P(1, mesh), 0, P(2, &error)))             \
  X(vxm_reading_find, 2, 1, vxm_reading_find(P(0, &out.reading), P(1, &error)))                            \
  X(vxm_mesh_write, 4, 3, vxm_mesh_write(P(0, mesh), P(1, "out.off"), P(2, &mesh_write), P(3, &error)))    \
  X(vxm_mesh_destroy, 1, 0, (vxm_mesh_destroy(NULL), VXM_OK))                                              \
  X(vxm_mesh_vertex_count, 1, 1, GIVES(vxm_mesh_vertex_count(P(0, mesh))))                                 \
  X(vxm_mesh_face_count, 1, 1, GIVES(vxm_mesh_face_count(P(0, mesh))))                                     \
  X(vxm_mesh_vertices, 1, 1, GIVES(vxm_mesh_vertices(P(0, mesh))))                                         \
  X(vxm_mesh_offsets, 1, 1, GIVES(vxm_mesh_offsets(P(0, mesh))))                                           \
  X(vxm_mesh_indices, 1, 1, GIVES(vxm_mesh_indices(P(0, mesh))))                                           \
  X(vxm_mesh_tag_count, 1, 1, GIVES(vxm_mesh_tag_count(P(0, mesh))))                                       \
  X(vxm_mesh_tag_name, 1, 1, GIVES_TEXT(vxm_mesh_tag_name(P(0, mesh), 0)))                                 \
  X(vxm_mesh_face_tags, 1, 1, GIVES(vxm_mesh_face_tags(P(0, mesh))))                                       \
  X(vxm_mesh_format, 1, 1, GIVES_TEXT(vxm_mesh_format(P(0, mesh))))                                        \
  X(vxm_mesh_warning_count, 1, 1, GIVES(vxm_mesh_warning_count(P(0, mesh))))                               \
  X(vxm_mesh_warning, 1, 1, GIVES_TEXT(vxm_mesh_warning(P(0, mesh), 0)))                                   \
  X(vxm_mesh_companion_count, 1, 1, ANYTHING(vxm_mesh_companion_count(P(0, mesh))))                        \
  X(vxm_mesh_companion, 1, 1, ANYTHING(vxm_mesh_companion(P(0, mesh), 0)))                                 \
  X(vxm_mesh_census, 3, 3, vxm_mesh_census(P(0, &out.census), P(1, mesh), P(2, &error)))                   \
  X(vxm_mesh_repair, 5, 5,                                                                                 \
    vxm_mesh_repair(P(0, &out.mesh), P(1, &out.repair), P(2, mesh), P(3, &repair), P(4, &error)))          \
  X(vxm_mesh_prepare, 5, 5,                                                                                \
    vxm_mesh_prepare(P(0, &out.mesh), P(1, &out.repair), P(2, mesh), P(3, &repair), P(4, &error)))         \
  X(vxm_mesh_prepare_in_place, 4, 1,                                                                       \
    prepare_in_place(P(0, &out.mesh), P(1, &out.repair), P(2, &repair), P(3, &error)))                     \
  X(vxm_mesh_part_change_count, 1, 1, ANYTHING(vxm_mesh_part_change_count(P(0, mesh))))                    \
  X(vxm_mesh_part_change, 1, 1, ANYTHING(vxm_mesh_part_change(P(0, mesh), 0)))                             \
  X(vxm_mesh_verify, 4, 3,                                                                                 \
    vxm_mesh_verify(P(0, &out.verification), P(1, mesh), P(2, &repair), P(3, &error)))                     \
  X(vxm_mesh_write_verified, 6, 7,                                                                         \
    vxm_mesh_write_verified(P(0, &out.verification), P(1, mesh), P(2, "out.off"), P(3, &mesh_write),       \
                            P(4, &repair), true, P(5, &error)))                                            \
  X(vxm_mesh_defects, 3, 3, vxm_mesh_defects(P(0, &out.defects), P(1, mesh), 0, false, P(2, &error)))      \
  X(vxm_defects_destroy, 1, 0, (vxm_defects_destroy(NULL), VXM_OK))                                        \
  X(vxm_defects_count, 1, 1, GIVES(vxm_defects_count(P(0, defects))))                                      \
  X(vxm_defects_item, 1, 1, GIVES(vxm_defects_item(P(0, defects), 0)))                                     \
  X(vxm_defects_total, 1, 1, GIVES(vxm_defects_total(P(0, defects), VXM_DEFECT_BOUNDARY_EDGE)))            \
  X(vxm_defect_name, 0, 0, GIVES_TEXT(vxm_defect_name(VXM_DEFECT_BOUNDARY_EDGE)))                          \
  X(vxm_defects_write, 4, 7, vxm_defects_write(P(0, defects), P(1, mesh), P(2, "out.ply"), P(3, &error)))

#define GRID_CALLS(X)                                                                                      \
  X(vxm_grid_create, 4, 5, vxm_grid_create(P(0, &out.grid), P(1, context), P(2, &space), P(3, &error)))    \
  X(vxm_grid_destroy, 1, 0, (vxm_grid_destroy(NULL), VXM_OK))                                              \
  X(vxm_grid_space, 1, 1, GIVES(vxm_grid_space(P(0, grid))))                                               \
  X(vxm_grid_get, 1, 1, GIVES(vxm_grid_get(P(0, grid), 0, 0, 0)))                                          \
  X(vxm_grid_set, 1, 1, DOES(vxm_grid_set(P(0, grid), 0, 0, 0, true)))                                     \
  X(vxm_grid_row_words, 1, 1, GIVES(vxm_grid_row_words(P(0, grid))))                                       \
  X(vxm_grid_words, 1, 1, GIVES(vxm_grid_words(P(0, grid))))                                               \
  X(vxm_grid_count, 1, 1, GIVES(vxm_grid_count(P(0, grid))))                                               \
  X(vxm_grid_box, 3, 7, GIVES(vxm_grid_box(P(0, out.box_begin), P(1, out.box_end), P(2, grid))))           \
  X(vxm_grid_hash, 1, 1, GIVES(vxm_grid_hash(P(0, grid))))                                                 \
  X(vxm_grid_unpack, 2, 3, DOES(vxm_grid_unpack(P(0, grid), P(1, (uint8_t *)out.values))))                 \
  X(vxm_grid_pack, 2, 3, DOES(vxm_grid_pack(P(0, grid), P(1, (const uint8_t *)unmoved))))                  \
  X(vxm_grid_unpack_range, 3, 3,                                                                           \
    vxm_grid_unpack_range(P(0, grid), 0, 4, P(1, (uint8_t *)out.values), P(2, &error)))                    \
  X(vxm_grid_pack_range, 3, 3,                                                                             \
    vxm_grid_pack_range(P(0, grid), 0, 4, P(1, (const uint8_t *)unmoved), P(2, &error)))                   \
  X(vxm_grid_set_words, 3, 3, vxm_grid_set_words(P(0, grid), P(1, words_of_grid), 16, P(2, &error)))       \
  X(vxm_grid_confidence, 1, 1, GIVES(vxm_grid_confidence(P(0, grid))))                                     \
  X(vxm_grid_write_confidence, 3, 3, vxm_grid_write_confidence(P(0, grid), P(1, "out.npy"), P(2, &error))) \
  X(vxm_grid_warning_count, 1, 1, ANYTHING(vxm_grid_warning_count(P(0, grid))))                            \
  X(vxm_grid_warning, 1, 1, ANYTHING(vxm_grid_warning(P(0, grid), 0)))                                     \
  X(vxm_grid_read, 4, 5, vxm_grid_read(P(0, &out.grid), P(1, context), P(2, "in.npy"), P(3, &error)))      \
  X(vxm_grid_format_name, 0, 0, GIVES_TEXT(vxm_grid_format_name(0)))                                       \
  X(vxm_grid_format_of, 1, 1, GIVES_TEXT(vxm_grid_format_of(P(0, "a.npy"))))                               \
  X(vxm_grid_format_traits, 1, 0, ((void)vxm_grid_format_traits(P(0, "npy")), VXM_OK))                     \
  X(vxm_grid_read_space, 4, 5,                                                                             \
    vxm_grid_read_space(P(0, &out.grid), P(1, context), P(2, "in.npy"), P(3, &error)))                     \
  X(vxm_grid_write, 4, 3, vxm_grid_write(P(0, grid), P(1, "out.npy"), P(2, &grid_write), P(3, &error)))    \
  X(vxm_grid_surface_mesh, 3, 3, vxm_grid_surface_mesh(P(0, &out.mesh), P(1, grid), P(2, &error)))         \
  X(vxm_grid_picture, 4, 3, vxm_grid_picture(P(0, grid), P(1, "out.png"), P(2, &picture), P(3, &error)))   \
  X(vxm_grid_page, 4, 3, vxm_grid_page(P(0, grid), P(1, "out.html"), P(2, &page), P(3, &error)))           \
  X(vxm_grid_combine, 4, 7,                                                                                \
    vxm_grid_combine(P(0, &out.grid), P(1, grid), P(2, grid), VXM_SET_UNION, P(3, &error)))                \
  X(vxm_grid_compare, 4, 7, vxm_grid_compare(P(0, &out.comparison), P(1, grid), P(2, grid), P(3, &error))) \
  X(vxm_grid_write_coords, 3, 3, vxm_grid_write_coords(P(0, grid), P(1, "out.npy"), P(2, &error)))

#define FIELD_CALLS(X)                                                                                      \
  X(vxm_field_create, 5, 13,                                                                                \
    vxm_field_create(P(0, &out.field), P(1, context), P(2, &space), VXM_FIELD_LABELS, VXM_UINT8,            \
                     P(3, out.values), P(4, &error)))                                                       \
  X(vxm_field_read, 4, 5, vxm_field_read(P(0, &out.field), P(1, context), P(2, "in.npy"), P(3, &error)))    \
  X(vxm_grid_or_field_read, 5, 11,                                                                          \
    vxm_grid_or_field_read(P(0, &out.grid), P(1, &out.field), P(2, context), P(3, "in.npy"), P(4, &error))) \
  X(vxm_field_destroy, 1, 0, (vxm_field_destroy(NULL), VXM_OK))                                             \
  X(vxm_field_space, 1, 1, GIVES(vxm_field_space(P(0, field))))                                             \
  X(vxm_field_kind_of, 1, 1, GIVES(vxm_field_kind_of(P(0, field))))                                         \
  X(vxm_field_scalar, 1, 1, GIVES(vxm_field_scalar(P(0, field))))                                           \
  X(vxm_field_channels, 1, 1, GIVES(vxm_field_channels(P(0, field))))                                       \
  X(vxm_field_values, 1, 1, GIVES(vxm_field_values(P(0, field))))                                           \
  X(vxm_field_kind_name, 0, 0, GIVES_TEXT(vxm_field_kind_name(VXM_FIELD_NUMBERS)))                          \
  X(vxm_scalar_name, 0, 0, GIVES_TEXT(vxm_scalar_name(VXM_UINT8)))                                          \
  X(vxm_field_window, 5, 15,                                                                                \
    vxm_field_window(P(0, &out.field), P(1, field), P(2, window_begin), P(3, window_end), P(4, &error)))    \
  X(vxm_grid_window, 5, 15,                                                                                 \
    vxm_grid_window(P(0, &out.grid), P(1, grid), P(2, window_begin), P(3, window_end), P(4, &error)))       \
  X(vxm_field_measure, 3, 3, vxm_field_measure(P(0, &out.range), P(1, field), P(2, &error)))                \
  X(vxm_field_label_count, 1, 1, ANYTHING(vxm_field_label_count(P(0, field))))                              \
  X(vxm_field_label_name, 1, 1, ANYTHING(vxm_field_label_name(P(0, field), 1)))                             \
  X(vxm_field_metadata_count, 1, 1, ANYTHING(vxm_field_metadata_count(P(0, field))))                        \
  X(vxm_field_metadata_key, 1, 1, ANYTHING(vxm_field_metadata_key(P(0, field), 0)))                         \
  X(vxm_field_metadata_value, 1, 1, ANYTHING(vxm_field_metadata_value(P(0, field), 0)))                     \
  X(vxm_field_add_label, 3, 3, vxm_field_add_label(P(0, field), P(1, "label"), 1, P(2, &error)))            \
  X(vxm_field_add_metadata, 4, 7,                                                                           \
    vxm_field_add_metadata(P(0, field), P(1, "key"), P(2, "value"), P(3, &error)))                          \
  X(vxm_field_warning_count, 1, 1, ANYTHING(vxm_field_warning_count(P(0, field))))                          \
  X(vxm_field_warning, 1, 1, ANYTHING(vxm_field_warning(P(0, field), 0)))                                   \
  X(vxm_field_is_mask, 1, 1, GIVES(vxm_field_is_mask(P(0, field))))                                         \
  X(vxm_field_threshold, 4, 7,                                                                              \
    vxm_field_threshold(P(0, &out.grid), P(1, field), P(2, &threshold), P(3, &error)))                      \
  X(vxm_field_write, 4, 3, vxm_field_write(P(0, field), P(1, "out.npy"), P(2, &grid_write), P(3, &error)))  \
  X(vxm_field_picture, 5, 3,                                                                                \
    vxm_field_picture(P(0, field), P(1, "out.png"), P(2, &picture), P(3, &threshold), P(4, &error)))        \
  X(vxm_field_page, 5, 3,                                                                                   \
    vxm_field_page(P(0, field), P(1, "out.html"), P(2, &page), P(3, &threshold), P(4, &error)))

#define ENGINE_CALLS(X)                                                                                    \
  X(vxm_engine_create, 5, 5,                                                                               \
    vxm_engine_create(P(0, &out.engine), P(1, context), P(2, "cpu"), P(3, &engine_options), P(4, &error))) \
  X(vxm_engine_destroy, 1, 0, (vxm_engine_destroy(NULL), VXM_OK))                                          \
  X(vxm_engine_describe, 1, 1, GIVES(vxm_engine_describe(P(0, engine))))                                   \
  X(vxm_engines_find, 3, 3,                                                                                \
    nulls & 3 ? vxm_engines_find(P(0, &out.info), 1, P(1, &out.count), P(2, &error)) : VXM_OK)             \
  X(vxm_cpu_highest, 0, 0, (vxm_cpu_highest(), VXM_OK))                                                    \
  X(vxm_cpu_used, 0, 0, (vxm_cpu_used(), VXM_OK))                                                          \
  X(vxm_cpu_limit, 1, 0, vxm_cpu_limit(vxm_cpu_highest(), P(0, &error)))                                   \
  X(vxm_baseline_voxelize, 5, 5,                                                                           \
    vxm_baseline_voxelize(P(0, grid), P(1, &out.baseline), P(2, mesh), P(3, &baseline_options),            \
                          P(4, &error)))                                                                   \
  X(vxm_engine_measure, 3, 2,                                                                              \
    nulls & 2 ? vxm_engine_measure(P(0, &out.stages), P(1, engine), true, P(2, &error)) : VXM_OK)          \
  X(vxm_published_create, 6, 29,                                                                           \
    vxm_published_create(P(0, &out.published), P(1, &out.space), P(2, engine), P(3, mesh),                 \
                         P(4, &published_options), P(5, &error)))                                          \
  X(vxm_published_voxelize, 2, 3,                                                                          \
    nulls ? vxm_published_voxelize(P(0, &out.published_report), NULL, P(1, &error)) : VXM_OK)              \
  X(vxm_published_read, 3, 7,                                                                              \
    !nulls ? VXM_OK                                                                                        \
           : vxm_published_read(P(0, (uint8_t *)out.values), P(1, &out.ms), NULL, VXM_TRANSFER_MAP,        \
                                P(2, &error)))                                                             \
  X(vxm_published_destroy, 1, 0, (vxm_published_destroy(NULL), VXM_OK))                                    \
  X(vxm_model_voxelize_device, 5, 7,                                                                       \
    vxm_model_voxelize_device(P(0, &out.voxels), P(1, model), P(2, &space), P(3, unmoved),                 \
                              VXM_VOXEL_FORMAT_UINT8, P(4, &error)))                                       \
  X(vxm_sampler_batch_device, 4, 7,                                                                        \
    vxm_sampler_batch_device(P(0, &out.voxels), P(1, sampler), P(2, &variant), 1, VXM_VOXEL_FORMAT_UINT8,  \
                             P(3, &error)))                                                                \
  X(vxm_device_voxels_describe, 2, 3,                                                                      \
    nulls ? vxm_device_voxels_describe(P(0, &out.device), NULL, P(1, &error)) : VXM_OK)                    \
  X(vxm_device_voxels_dlpack, 2, 3,                                                                        \
    nulls ? vxm_device_voxels_dlpack(P(0, &out.tensor), NULL, P(1, &error)) : VXM_OK)                      \
  X(vxm_device_voxels_destroy, 1, 0, (vxm_device_voxels_destroy(NULL), VXM_OK))

#define MODEL_CALLS(X)                                                                                     \
  X(vxm_space_fit, 4, 3, vxm_space_fit(P(0, &out.space), P(1, mesh), P(2, &space_options), P(3, &error)))  \
  X(vxm_voxelize, 6, 5,                                                                                    \
    vxm_voxelize(P(0, &out.grid), P(1, &out.voxelize), P(2, mesh), P(3, &space_options),                   \
                 P(4, &voxelize_options), P(5, &error)))                                                   \
  X(vxm_mesh_remesh, 6, 5,                                                                                 \
    vxm_mesh_remesh(P(0, &out.mesh), P(1, &out.voxelize), P(2, mesh), P(3, &space_options),                \
                    P(4, &voxelize_options), P(5, &error)))                                                \
  X(vxm_model_create, 4, 3,                                                                                \
    vxm_model_create(P(0, &out.model), P(1, mesh), P(2, &voxelize_options), P(3, &error)))                 \
  X(vxm_model_destroy, 1, 0, (vxm_model_destroy(NULL), VXM_OK))                                            \
  X(vxm_model_voxelize, 5, 5,                                                                              \
    vxm_model_voxelize(P(0, grid), P(1, &out.voxelize), P(2, model), P(3, unmoved), P(4, &error)))         \
  X(vxm_model_estimate, 6, 15,                                                                             \
    vxm_model_estimate(P(0, &out.estimate), P(1, model), P(2, &space), P(3, "out.npy"), P(4, &grid_write), \
                       P(5, &error)))                                                                      \
  X(vxm_model_write, 6, 14,                                                                                \
    vxm_model_write(P(0, &out.voxelize), P(1, model), P(2, &space), P(3, "out.npy"), P(4, &grid_write),    \
                    P(5, &error)))                                                                         \
  X(vxm_model_coverage, 6, 13,                                                                             \
    vxm_model_coverage(P(0, out.values), P(1, &out.coverage), P(2, model), P(3, &space),                   \
                       P(4, &coverage_options), P(5, &error)))                                             \
  X(vxm_model_write_coverage, 6, 14,                                                                       \
    vxm_model_write_coverage(P(0, &out.coverage), P(1, model), P(2, &space), P(3, "out.npy"),              \
                             P(4, &coverage_options), P(5, &error)))                                       \
  X(vxm_model_estimate_coverage, 6, 15,                                                                    \
    vxm_model_estimate_coverage(P(0, &out.estimate), P(1, model), P(2, &space), P(3, "out.npy"),           \
                                P(4, &coverage_options), P(5, &error)))                                    \
  X(vxm_model_distance, 6, 13,                                                                             \
    vxm_model_distance(P(0, out.values), P(1, &out.distance), P(2, model), P(3, &space),                   \
                       P(4, &distance_options), P(5, &error)))                                             \
  X(vxm_model_write_distance, 6, 14,                                                                       \
    vxm_model_write_distance(P(0, &out.distance), P(1, model), P(2, &space), P(3, "out.npy"),              \
                             P(4, &distance_options), P(5, &error)))                                       \
  X(vxm_model_estimate_distance, 6, 15,                                                                    \
    vxm_model_estimate_distance(P(0, &out.estimate), P(1, model), P(2, &space), P(3, "out.npy"),           \
                                P(4, &distance_options), P(5, &error)))                                    \
  X(vxm_model_labels, 6, 13,                                                                               \
    vxm_model_labels(P(0, (uint16_t *)out.values), P(1, &out.labels), P(2, model), P(3, &space),           \
                     P(4, &label_options), P(5, &error)))                                                  \
  X(vxm_model_write_labels, 6, 14,                                                                         \
    vxm_model_write_labels(P(0, &out.labels), P(1, model), P(2, &space), P(3, "out.npy"),                  \
                           P(4, &label_options), P(5, &error)))                                            \
  X(vxm_model_colors, 6, 13,                                                                               \
    vxm_model_colors(P(0, (uint8_t *)out.values), P(1, &out.voxelize), P(2, model), P(3, &space),          \
                     P(4, &color_options), P(5, &error)))                                                  \
  X(vxm_model_write_colors, 6, 14,                                                                         \
    vxm_model_write_colors(P(0, &out.voxelize), P(1, model), P(2, &space), P(3, "out.npy"),                \
                           P(4, &color_options), P(5, &error)))                                            \
  X(vxm_model_label_count, 1, 1, GIVES(vxm_model_label_count(P(0, model))))                                \
  X(vxm_model_label_name, 1, 1, GIVES_TEXT(vxm_model_label_name(P(0, model), 1)))                          \
  X(vxm_model_label_voxels, 1, 1, GIVES(vxm_model_label_voxels(P(0, model), 1)))                           \
  X(vxm_model_warning_count, 1, 1, ANYTHING(vxm_model_warning_count(P(0, model))))                         \
  X(vxm_model_warning, 1, 1, ANYTHING(vxm_model_warning(P(0, model), 0)))

#define SAMPLER_CALLS(X)                                                                                    \
  X(vxm_sampler_create, 4, 1,                                                                               \
    vxm_sampler_create(P(0, &out.sampler), P(1, context), P(2, &sampler_options), P(3, &error)))            \
  X(vxm_sampler_destroy, 1, 0, (vxm_sampler_destroy(NULL), VXM_OK))                                         \
  X(vxm_sampler_put, 3, 1, vxm_sampler_put(P(0, sampler), 1, P(1, mesh), P(2, &error)))                     \
  X(vxm_sampler_space, 1, 1, GIVES(vxm_sampler_space(P(0, sampler)).dims[0]))                               \
  X(vxm_sampler_bytes, 1, 1, GIVES(vxm_sampler_bytes(P(0, sampler), VXM_VOXEL_FORMAT_UINT8)))               \
  X(vxm_sampler_pose, 4, 7, vxm_sampler_pose(P(0, &out.pose), P(1, sampler), P(2, &variant), P(3, &error))) \
  X(vxm_sampler_grid, 4, 7, vxm_sampler_grid(P(0, grid), P(1, sampler), P(2, &variant), P(3, &error)))      \
  X(vxm_sampler_batch, 4, 7,                                                                                \
    vxm_sampler_batch(P(0, out.values), P(1, sampler), P(2, &variant), 1, VXM_VOXEL_FORMAT_UINT8,           \
                      P(3, &error)))                                                                        \
  X(vxm_sampler_files, 6, 7,                                                                                \
    vxm_sampler_files(P(0, variant_path), P(1, sampler), P(2, &variant), 1, P(3, &grid_write),              \
                      P(4, &out.written), P(5, &error)))

#define SPARSE_CALLS(X)                                                                                      \
  X(vxm_model_sparse, 6, 13,                                                                                 \
    vxm_model_sparse(P(0, &out.sparse), P(1, &out.voxelize), P(2, model), P(3, &space), P(4, unmoved),       \
                     P(5, &error)))                                                                          \
  X(vxm_sparse_destroy, 1, 0, (vxm_sparse_destroy(NULL), VXM_OK))                                            \
  X(vxm_sparse_space, 1, 1, GIVES(vxm_sparse_space(P(0, sparse))))                                           \
  X(vxm_sparse_get, 1, 1, GIVES(vxm_sparse_get(P(0, sparse), 0, 0, 0)))                                      \
  X(vxm_sparse_count, 1, 1, GIVES(vxm_sparse_count(P(0, sparse))))                                           \
  X(vxm_sparse_hash, 1, 1, GIVES(vxm_sparse_hash(P(0, sparse))))                                             \
  X(vxm_sparse_bricks, 1, 1, ANYTHING(vxm_sparse_bricks(P(0, sparse))))                                      \
  X(vxm_sparse_nodes, 1, 1, ANYTHING(vxm_sparse_nodes(P(0, sparse))))                                        \
  X(vxm_sparse_bytes, 1, 1, GIVES(vxm_sparse_bytes(P(0, sparse))))                                           \
  X(vxm_sparse_from_grid, 3, 3, vxm_sparse_from_grid(P(0, &out.sparse), P(1, grid), P(2, &error)))           \
  X(vxm_sparse_to_grid, 3, 3, vxm_sparse_to_grid(P(0, &out.grid), P(1, sparse), P(2, &error)))               \
  X(vxm_sparse_combine, 4, 7,                                                                                \
    vxm_sparse_combine(P(0, &out.sparse), P(1, sparse), P(2, sparse), VXM_SET_UNION, P(3, &error)))          \
  X(vxm_sparse_warning_count, 1, 1, ANYTHING(vxm_sparse_warning_count(P(0, sparse))))                        \
  X(vxm_sparse_warning, 1, 1, ANYTHING(vxm_sparse_warning(P(0, sparse), 0)))                                 \
  X(vxm_sparse_window, 5, 15,                                                                                \
    vxm_sparse_window(P(0, &out.grid), P(1, sparse), P(2, window_begin), P(3, window_end), P(4, &error)))    \
  X(vxm_sparse_coverage, 6, 3,                                                                               \
    vxm_sparse_coverage(P(0, &out.field), P(1, sparse), P(2, &coverage_options), P(3, first_cube),           \
                        P(4, last_cube), P(5, &error)))                                                      \
  X(vxm_sparse_file_coverage, 6, 3,                                                                          \
    vxm_sparse_file_coverage(P(0, &out.field), P(1, sparse_file), P(2, &coverage_options), P(3, first_cube), \
                             P(4, last_cube), P(5, &error)))                                                 \
  X(vxm_sparse_read, 4, 5,                                                                                   \
    vxm_sparse_read(P(0, &out.sparse), P(1, context), P(2, "in.octree"), P(3, &error)))                      \
  X(vxm_sparse_file_open, 4, 5,                                                                              \
    vxm_sparse_file_open(P(0, &out.sparse_file), P(1, context), P(2, "in.octree"), P(3, &error)))            \
  X(vxm_field_combine, 4, 7,                                                                                 \
    vxm_field_combine(P(0, &out.field), P(1, field), P(2, field), VXM_SET_UNION, P(3, &error)))              \
  X(vxm_sparse_file_combine, 4, 7,                                                                           \
    vxm_sparse_file_combine(P(0, "out.octree"), P(1, values_files), 2, P(2, set_operations), P(3, &error)))  \
  X(vxm_sparse_file_close, 1, 0, (vxm_sparse_file_close(NULL), VXM_OK))                                      \
  X(vxm_sparse_file_space, 1, 1, GIVES(vxm_sparse_file_space(P(0, sparse_file))))                            \
  X(vxm_sparse_file_has_values, 1, 1, ANYTHING(vxm_sparse_file_has_values(P(0, sparse_file))))               \
  X(vxm_sparse_file_field, 5, 15,                                                                            \
    vxm_sparse_file_field(P(0, &out.field), P(1, sparse_file), P(2, window_begin), P(3, window_end),         \
                          P(4, &error)))                                                                     \
  X(vxm_sparse_file_count, 1, 1, GIVES(vxm_sparse_file_count(P(0, sparse_file))))                            \
  X(vxm_sparse_file_window, 5, 15,                                                                           \
    vxm_sparse_file_window(P(0, &out.grid), P(1, sparse_file), P(2, window_begin), P(3, window_end),         \
                           P(4, &error)))                                                                    \
  X(vxm_sparse_visit, 2, 3, DOES(vxm_sparse_visit(P(0, sparse), P(1, visit), NULL)))                         \
  X(vxm_sparse_write, 4, 3,                                                                                  \
    vxm_sparse_write(P(0, sparse), P(1, "out.npy"), P(2, &grid_write), P(3, &error)))                        \
  X(vxm_sparse_write_coords, 3, 3, vxm_sparse_write_coords(P(0, sparse), P(1, "out.npy"), P(2, &error)))

#define CARVE_CALLS(X)                                                                                      \
  X(vxm_carver_create, 4, 7, vxm_carver_create(P(0, &out.carver), P(1, grid), P(2, mesh), P(3, &error)))    \
  X(vxm_carver_create_sparse, 4, 7,                                                                         \
    vxm_carver_create_sparse(P(0, &out.carver), P(1, sparse), P(2, mesh), P(3, &error)))                    \
  X(vxm_carver_destroy, 1, 0, (vxm_carver_destroy(NULL), VXM_OK))                                           \
  X(vxm_carver_place, 4, 6, vxm_carver_place(P(0, &out.carved), P(1, carver), P(2, unmoved), P(3, &error))) \
  X(vxm_carver_move, 4, 6, vxm_carver_move(P(0, &out.carved), P(1, carver), P(2, unmoved), P(3, &error)))   \
  X(vxm_carver_sparse, 3, 3, vxm_carver_sparse(P(0, &out.sparse), P(1, carver), P(2, &error)))

#define CALLS(X)             \
  ERROR_AND_CONTEXT_CALLS(X) \
  MESH_CALLS(X)              \
  GRID_CALLS(X)              \
  FIELD_CALLS(X)             \
  ENGINE_CALLS(X)            \
  MODEL_CALLS(X)             \
  SAMPLER_CALLS(X)           \
  SPARSE_CALLS(X)            \
  CARVE_CALLS(X)

#define FUNCTION(name, pointers, needed, call)    \
  static vxm_status call_##name(unsigned nulls) { \
    (void)nulls;                                  \
    return call;                                  \
  }
CALLS(FUNCTION)

typedef struct row {
  const char *name;
  int pointers;
  unsigned needed;
  vxm_status (*call)(unsigned nulls);
} row;

#define ROW(name, pointers, needed, call) {#name, pointers, needed, call_##name},
static const row rows[] = {CALLS(ROW)};
enum { ROWS = sizeof rows / sizeof *rows };

/* ---- The tests ---- */

static void check(const row *r, unsigned nulls) {
  error = (vxm_error)VXM_ERROR_INIT;
  vxm_status status = r->call(nulls);
  drop_made();
  bool is_status = error.code != VXM_OK;
  if (nulls & r->needed) {
    if (status != VXM_ERROR_ARGUMENT)
      fail_msg("%s with NULL for %#x gives %s", r->name, nulls, vxm_status_name(status));
  } else if (status != VXM_OK && status != VXM_ERROR_UNAVAILABLE)
    fail_msg("%s with NULL for %#x gives %s: %s", r->name, nulls, vxm_status_name(status), error.text);
  if (is_status && (error.code != status || !error.text[0] || strchr(error.text, '\n')))
    fail_msg("%s with NULL for %#x says \"%s\"", r->name, nulls, error.text);
}

static void test_nulls(void **state) {
  (void)state;
  for (int i = 0; i < ROWS; i++)
    for (unsigned nulls = 0; nulls < 1U << rows[i].pointers; nulls++)
      check(&rows[i], nulls);
}

static bool is_listed(const char *name, size_t length) {
  for (int i = 0; i < ROWS; i++)
    if (strlen(rows[i].name) == length && memcmp(rows[i].name, name, length) == 0)
      return true;
  return false;
}

/** Every name behind VXM_API and before '(' in a header has its row; how many there are. */
static int check_header(const char *name) {
  const char *source = getenv("SRCDIR");
  char path[1024], *text = NULL;
  size_t size = 0;
  snprintf(path, sizeof path, "%s/src/voxmend/%s.h", source ? source : ".", name);
  FILE *header = fopen(source && source[0] == '/' ? path : "/dev/null", "r");
  if (!header || getdelim(&text, &size, '\0', header) < 0)
    skip();
  fclose(header);
  int found = 0;
  for (char *at = text; (at = strstr(at, "\nVXM_API ")) != NULL; found++) {
    char *end = strchr(at, '('), *begin = end;
    while (begin > at && (begin[-1] == '_' || (begin[-1] >= 'a' && begin[-1] <= 'z') ||
                          (begin[-1] >= '0' && begin[-1] <= '9')))
      begin--;
    if (!is_listed(begin, (size_t)(end - begin)))
      fail_msg("%.*s is not in the lists of this test", (int)(end - begin), begin);
    at = end;
  }
  free(text);
  return found;
}

static void test_all_are_listed(void **state) {
  (void)state;
  static const char *const headers[] = {"base", "carve",  "engine",  "experimental", "field",   "grid",
                                        "mesh", "repair", "sampler", "sparse",       "voxelize"};
  int found = 0;
  for (size_t h = 0; h < sizeof headers / sizeof *headers; h++)
    found += check_header(headers[h]);
  assert_int_equal(found, ROWS);
}

/* ---- Setting up ---- */

static void put_file(const char *name, const char *text) {
  FILE *file = fopen(name, "w");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

static int set_up(void **state) {
  (void)state;
  static const int64_t indices[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  static const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  assert_non_null(mkdtemp(folder));
  assert_int_equal(chdir(folder), 0);
  put_file("in.off", off_text);
  /* a group, a closed body, a sheet for the defects, and a line that warns */
  put_file("in.obj",
           "g body\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\ng sheet\n"
           "v 2 0 0\nv 3 0 0\nv 2 1 0\nf 5 6 7\nf 1 2 99\n");
  arrays.vertices = corners;
  arrays.vertex_count = 4;
  arrays.indices = indices;
  arrays.index_count = 12;
  arrays.face_count = 4;
  published_options.voxel_size = 0.25;
  space_options.resolution[0] = 4;
  voxelize_options.confidence = true;
  sampler_options.resolution = 4;
  picture.width = picture.height = 16;
  color_options.by = VXM_COLOR_PART;
  assert_int_equal(vxm_context_create(&context, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_mesh_read(&mesh, context, "in.obj", NULL), VXM_OK);
  assert_int_equal(vxm_mesh_defects(&defects, mesh, 0, false, NULL), VXM_OK);
  assert_int_equal(vxm_voxelize(&grid, NULL, mesh, &space_options, &voxelize_options, NULL), VXM_OK);
  assert_int_equal(vxm_grid_write(grid, "in.npy", NULL, NULL), VXM_OK);
  static const uint8_t labels[4 * 4 * 4] = {1, 0, 1};
  assert_int_equal(vxm_field_create(&field, context, &space, VXM_FIELD_LABELS, VXM_UINT8, labels, NULL),
                   VXM_OK);
  assert_int_equal(vxm_engine_create(&engine, context, "cpu", NULL, NULL), VXM_OK);
  voxelize_options.confidence = false;
  assert_int_equal(vxm_model_create(&model, mesh, &voxelize_options, NULL), VXM_OK);
  assert_int_equal(vxm_model_labels((uint16_t *)out.values, NULL, model, &space, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_create(&sampler, context, &sampler_options, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_put(sampler, 0, mesh, NULL), VXM_OK);
  vxm_grid_set(grid, 0, 0, 0, true);
  assert_int_equal(vxm_sparse_from_grid(&sparse, grid, NULL), VXM_OK);
  assert_int_equal(vxm_sparse_write(sparse, "in.octree", NULL, NULL), VXM_OK);
  assert_int_equal(vxm_sparse_file_open(&sparse_file, context, "in.octree", NULL), VXM_OK);
  vxm_sparse_file *values_file;
  assert_int_equal(vxm_field_write(field, "values.octree", NULL, NULL), VXM_OK);
  assert_int_equal(vxm_sparse_file_open(&values_file, context, "values.octree", NULL), VXM_OK);
  values_files[0] = values_files[1] = values_file;
  assert_int_equal(vxm_carver_create_sparse(&carver, sparse, mesh, NULL), VXM_OK);
  return 0;
}

/** In an order that no one would choose. */
static int tear_down(void **state) {
  (void)state;
  vxm_context_destroy(context);
  vxm_engine_destroy(engine);
  vxm_carver_destroy(carver);
  vxm_model_destroy(model);
  vxm_sampler_destroy(sampler);
  vxm_mesh_destroy(mesh);
  vxm_grid_destroy(grid);
  vxm_field_destroy(field);
  vxm_defects_destroy(defects);
  vxm_sparse_destroy(sparse);
  vxm_sparse_file_close(sparse_file);
  vxm_sparse_file_close((vxm_sparse_file *)values_files[0]);
  static const char *const files[] = {"in.off",     "in.obj",      "in.npy",          "in.npy.json",
                                      "in.octree",  "out.off",     "out.ply",         "values.octree",
                                      "out.octree", "out.npy",     "out.npy.json",    "out.png",
                                      "out.html",   "variant.npy", "variant.npy.json"};
  for (size_t f = 0; f < sizeof files / sizeof *files; f++)
    unlink(files[f]);
  return chdir("/") == 0 ? rmdir(folder) : 1;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_nulls),
      cmocka_unit_test(test_all_are_listed),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
