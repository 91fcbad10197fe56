/* SPDX-License-Identifier: BSD-3-Clause */
/* Voxels that stay on a device are those of the grid that the CPU makes, in every format, whether they never
 * left it or the CPU had a share: read back by the driver's own functions. What is handed out is released
 * once, by whoever holds it last, and nothing is counted against the memory limit then. */
#include "gpu_test.h"
#include "voxmend/experimental.h"

#include "device_reading.h"

#if defined __has_include
#if __has_include(<dlpack/dlpack.h>)
#include <dlpack/dlpack.h>
#define HAVE_DLPACK 1
#endif
#endif
#ifndef HAVE_DLPACK
typedef struct DLManagedTensor { /* as DLPack has it */
  struct {
    void *data;
    struct {
      int32_t device_type;
      int32_t device_id;
    } device;
    int32_t ndim;
    struct {
      uint8_t code;
      uint8_t bits;
      uint16_t lanes;
    } dtype;
    int64_t *shape;
    int64_t *strides;
    uint64_t byte_offset;
  } dl_tensor;
  void *manager_ctx;
  void (*deleter)(struct DLManagedTensor *self);
} DLManagedTensor;
#endif

static const vxm_voxel_format formats[] = {VXM_VOXEL_FORMAT_PACKED, VXM_VOXEL_FORMAT_UINT8,
                                           VXM_VOXEL_FORMAT_FLOAT32};
enum { FORMATS = 3 };

static bool has_textures(void) {
  return strncmp(ENGINE, "opengl", 6) == 0;
}

/** A voxel in what was read; other values than 0 and 1 are 2. */
static int voxel_in(const void *data, const vxm_device_info *info, int64_t v, const int64_t at[3]) {
  const uint8_t *bytes = data;
  size_t index = (size_t)(at[0] + info->texels[0] * (at[1] + info->texels[1] * at[2]));
  bool is_texture = info->texture != 0;
  if (info->format == VXM_VOXEL_FORMAT_PACKED && is_texture) {
    index = (size_t)(at[0] / 32 + info->texels[0] * (at[1] + info->texels[1] * at[2]));
    return ((const uint32_t *)data)[index] >> (at[0] % 32) & 1;
  }
  if (!is_texture)
    index = (size_t)(v * info->step[0] + at[0] * info->step[1] + at[1] * info->step[2]);
  if (info->format == VXM_VOXEL_FORMAT_PACKED)
    return bytes[index + (size_t)at[2] / 8] >> (at[2] % 8) & 1;
  if (info->format == VXM_VOXEL_FORMAT_UINT8) {
    uint8_t voxel = bytes[is_texture ? index : index + (size_t)at[2]];
    return voxel < 2 ? voxel : 2;
  }
  float voxel;
  memcpy(&voxel, bytes + (is_texture ? index * sizeof voxel : index + (size_t)at[2] * sizeof voxel),
         sizeof voxel);
  return voxel == 0 ? 0 : voxel == 1 ? 1 : 2;
}

/** Everything that stays, on the host. */
static void *read_all(const vxm_device_info *info) {
  void *out = malloc((size_t)info->bytes);
  assert_non_null(out);
#ifdef HAVE_OPENCL
  if (info->kind == VXM_DEVICE_OPENCL) {
    assert_int_equal(buffer_bytes(info->buffer), info->bytes);
    read_buffer(out, info->context, info->device_id, info->buffer, (size_t)info->bytes);
  }
#endif
#ifdef HAVE_OPENGL
  if (info->kind != VXM_DEVICE_OPENCL) {
    static const GLenum kinds[] = {GL_UNSIGNED_INT, GL_UNSIGNED_BYTE, GL_FLOAT},
                        wanted[] = {GL_R32UI, GL_R8UI, GL_R32F};
    GLint size[3];
    assert_int_equal(info->texture_format, wanted[info->format]);
    read_texture(out, size, info->kind == VXM_DEVICE_OSMESA, info->display, info->context, info->texture,
                 info->format == VXM_VOXEL_FORMAT_FLOAT32 ? GL_RED : GL_RED_INTEGER, kinds[info->format]);
    for (int a = 0; a < 3; a++)
      assert_int_equal(size[a], info->texels[a]);
  }
#endif
  return out;
}

static vxm_device_info describe(const vxm_device_voxels *voxels) {
  vxm_device_info info = VXM_DEVICE_INFO_INIT;
  assert_int_equal(vxm_device_voxels_describe(&info, voxels, NULL), VXM_OK);
  assert_int_equal(info.texture != 0, has_textures());
  assert_int_equal(info.buffer != NULL, !has_textures());
  assert_non_null(info.context);
  return info;
}

static void check_equal(const vxm_device_info *info, int64_t variant, const vxm_grid *grid) {
  const int64_t *dims = vxm_grid_space(grid)->dims;
  int64_t at[3];
  void *data = read_all(info);
  for (int a = 0; a < 3; a++)
    assert_int_equal(info->dims[a], dims[a]);
  for (at[0] = 0; at[0] < dims[0]; at[0]++)
    for (at[1] = 0; at[1] < dims[1]; at[1]++)
      for (at[2] = 0; at[2] < dims[2]; at[2]++)
        if (voxel_in(data, info, variant, at) != vxm_grid_get(grid, at[0], at[1], at[2]))
          fail_msg("voxel %d %d %d of format %d differs", (int)at[0], (int)at[1], (int)at[2],
                   (int)info->format);
  free(data);
}

/** What the engine leaves is what the CPU makes. */
static void check_model(const vxm_soup *soup, const vxm_space *space, const vxm_voxelize_options *how,
                        bool stays) {
  vxm_voxelize_options options = *how;
  vxm_error error = VXM_ERROR_INIT;
  vxm_model *cpu = engine_model(soup, &options), *there;
  vxm_grid *grid = engine_grid(context, space);
  assert_int_equal(vxm_model_voxelize(grid, NULL, cpu, NULL, NULL), VXM_OK);
  assert_true(vxm_grid_count(grid) > 100);
  options.engine = engine;
  there = engine_model(soup, &options);
  for (int f = 0; f < FORMATS; f++) {
    vxm_device_voxels *voxels;
    if (vxm_model_voxelize_device(&voxels, there, space, NULL, formats[f], &error) != VXM_OK)
      fail_msg("%s", error.text);
    vxm_device_info info = describe(voxels);
    assert_int_equal(info.stayed, stays);
    assert_int_equal(info.format, formats[f]);
    check_equal(&info, 0, grid);
    vxm_device_voxels_destroy(voxels);
  }
  vxm_grid_destroy(grid);
  vxm_model_destroy(there);
  vxm_model_destroy(cpu);
}

static void test_models(void **state) {
  (void)state;
  vxm_voxelize_options how = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space space = {{37, 21, 70}, {-18, -10.3, -8.25}, {1, 1, 0.25}};
  vxm_soup *torus = shape_empty(context), *sheet = shape_empty(context);
  shape_torus(torus, 40, 20, 10, 4, (double[3]){0, 0, 0});
  shape_torus(sheet, 40, 20, 10, 4, (double[3]){0, 0, 0});
  sheet->face_count -= 31;
  vxm_soup *sieve = shape_sieve(torus);
  check_model(torus, &space, &how, false); /* thin parts are looked after */
  how.thin = VXM_THIN_DROP;
  check_model(torus, &space, &how, true);
  how.mode = VXM_MODE_BOTH;
  check_model(torus, &space, &how, true);
  how.mode = VXM_MODE_SURFACE;
  check_model(sheet, &space, &how, true);
  how.surface = VXM_SURFACE_SHELL6;
  check_model(torus, &space, &how, false);
  how = (vxm_voxelize_options)VXM_VOXELIZE_OPTIONS_INIT;
  how.thin = VXM_THIN_DROP;
  check_model(sheet, &space, &how, true);  /* its rim is capped */
  check_model(sieve, &space, &how, false); /* contested */
  how.vote = VXM_VOTE_MAJORITY;
  how.vote_always = true;
  check_model(sieve, &space, &how, true);
  how.method = VXM_METHOD_Y;
  check_model(sieve, &space, &how, true);
  how.method = VXM_METHOD_WINDING;
  check_model(sheet, &space, &how, false);
  vxm_soup_destroy(sieve);
  vxm_soup_destroy(torus);
  vxm_soup_destroy(sheet);
}

/** A triangle too large for the device makes the CPU take part, and tiles are put together. */
static void test_far_and_tiles(void **state) {
  (void)state;
  vxm_voxelize_options how = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space space = engine_space(70, 65, 33);
  vxm_soup *soup = shape_empty(context);
  shape_torus(soup, 40, 20, 20, 8, (double[3]){30, 30, 16});
  how.thin = VXM_THIN_DROP;
  int64_t before = engine->info.block_bytes;
  engine->info.block_bytes = has_textures() ? 40000 : before;
  check_model(soup, &space, &how, true);
  engine->info.block_bytes = before;
  shape_face(soup,
             (uint32_t[]){shape_vertex(soup, -3e7, 30, 16), shape_vertex(soup, 3e7, 31, 16),
                          shape_vertex(soup, 30, 3e7, 17)},
             3);
  how.mode = VXM_MODE_SURFACE;
  check_model(soup, &space, &how, false);
  vxm_soup_destroy(soup);
}

/* ---- Who holds what ---- */

static vxm_model *model_by(vxm_engine *by, const vxm_soup *soup) {
  vxm_voxelize_options how = VXM_VOXELIZE_OPTIONS_INIT;
  how.thin = VXM_THIN_DROP;
  how.engine = by;
  return engine_model(soup, &how);
}

static void test_holders(void **state) {
  (void)state;
  vxm_context *owner = context_of(1, 0);
  size_t used = memory_used(owner);
  vxm_space space = engine_space(40, 30, 20);
  vxm_soup *soup = box_with_ties(0.25, 0.5);
  vxm_grid *grid = engine_method(soup, &space, VXM_METHOD_VOTE, VXM_SPLIT_MODE_AUTO, NULL);
  vxm_engine *by;
  vxm_device_voxels *voxels[2];
  assert_int_equal(vxm_engine_create(&by, owner, ENGINE, NULL, NULL), VXM_OK);
  vxm_model *model = model_by(by, soup);
  for (int i = 0; i < 2; i++)
    assert_int_equal(vxm_model_voxelize_device(&voxels[i], model, &space, NULL, formats[i], NULL), VXM_OK);
  vxm_device_info info[2] = {describe(voxels[0]), describe(voxels[1])};
  size_t held = memory_used(owner);
#ifdef HAVE_OPENGL
  bool is_osmesa = info[0].kind == VXM_DEVICE_OSMESA;
  if (has_textures())
    assert_true(is_texture(is_osmesa, info[0].display, info[0].context, info[0].texture));
#endif
  vxm_device_voxels_destroy(voxels[0]);
  assert_int_equal(held - memory_used(owner) >= (size_t)info[0].bytes, true);
#ifdef HAVE_OPENGL
  if (has_textures())
    assert_false(is_texture(is_osmesa, info[0].display, info[0].context, info[0].texture));
#endif
  vxm_model_destroy(model);
  vxm_engine_destroy(by); /* the other voxels go on */
  check_equal(&info[1], 0, grid);
  vxm_device_voxels_destroy(voxels[1]);
  assert_int_equal(memory_used(owner), used);
  vxm_context_destroy(owner);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

#ifdef HAVE_OPENCL
/** The tensor says of its elements what the description says. */
static void check_tensor(const DLManagedTensor *tensor, const vxm_device_info *info, bool is_batch) {
  int64_t element = info->format == VXM_VOXEL_FORMAT_FLOAT32 ? 4 : 1;
  int64_t shape[4] = {info->count, info->dims[0], info->dims[1], info->dims[2]};
  if (info->format == VXM_VOXEL_FORMAT_PACKED)
    shape[3] = (info->dims[2] + 7) / 8;
  int first = is_batch ? 0 : 1;
  assert_int_equal(tensor->dl_tensor.device.device_type, 4);
  assert_int_equal(tensor->dl_tensor.device.device_id, info->device);
  assert_ptr_equal(tensor->dl_tensor.data, info->buffer);
  assert_int_equal(tensor->dl_tensor.byte_offset, 0);
  assert_int_equal(tensor->dl_tensor.dtype.code, element == 4 ? 2 : 1);
  assert_int_equal(tensor->dl_tensor.dtype.bits, 8 * element);
  assert_int_equal(tensor->dl_tensor.dtype.lanes, 1);
  assert_int_equal(tensor->dl_tensor.ndim, 4 - first);
  for (int d = first; d < 4; d++) {
    assert_int_equal(tensor->dl_tensor.shape[d - first], shape[d]);
    assert_int_equal(tensor->dl_tensor.strides[d - first] * element, d < 3 ? info->step[d] : element);
  }
}
#endif

static void test_dlpack(void **state) {
  (void)state;
  vxm_context *owner = context_of(1, 0);
  size_t used = memory_used(owner);
  vxm_space space = engine_space(40, 30, 20);
  vxm_soup *soup = box_with_ties(0.25, 0.5);
  vxm_grid *grid = engine_method(soup, &space, VXM_METHOD_VOTE, VXM_SPLIT_MODE_AUTO, NULL);
  vxm_engine *by;
  assert_int_equal(vxm_engine_create(&by, owner, ENGINE, NULL, NULL), VXM_OK);
  vxm_model *model = model_by(by, soup);
  vxm_device_voxels *voxels[FORMATS];
  struct DLManagedTensor *tensor[FORMATS][2];
  vxm_device_info info[FORMATS];
  for (int f = 0; f < FORMATS; f++) {
    assert_int_equal(vxm_model_voxelize_device(&voxels[f], model, &space, NULL, formats[f], NULL), VXM_OK);
    info[f] = describe(voxels[f]);
    for (int t = 0; t < 2; t++)
      assert_int_equal(vxm_device_voxels_dlpack(&tensor[f][t], voxels[f], NULL),
                       has_textures() ? VXM_ERROR_UNAVAILABLE : VXM_OK);
    vxm_device_voxels_destroy(voxels[f]);
  }
  vxm_model_destroy(model);
  vxm_engine_destroy(by); /* the tensors go on */
  (void)info;             /* in a build without OpenCL */
#ifdef HAVE_OPENCL
  for (int f = 0; f < FORMATS && !has_textures(); f++) {
    assert_int_equal(buffer_holders(info[f].buffer, 1), 2);
    check_tensor(tensor[f][0], &info[f], false);
    tensor[f][0]->deleter(tensor[f][0]);
    assert_int_equal(buffer_holders(info[f].buffer, 0), 2);
    check_equal(&info[f], 0, grid);
    tensor[f][1]->deleter(tensor[f][1]);
    assert_int_equal(buffer_holders(info[f].buffer, -1), 1); /* this test alone */
  }
#endif
  assert_int_equal(memory_used(owner), used);
  vxm_context_destroy(owner);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

/* ---- Variants ---- */

static vxm_sampler *make_sampler(const vxm_soup *soup, vxm_thin_parts thin, int64_t resolution,
                                 vxm_engine *by) {
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  vxm_voxelize_options how = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_sampler *sampler;
  options.voxelize = &how;
  options.resolution = resolution;
  options.rotation = VXM_ROTATION_ANY;
  options.displace = 0.01;
  how.thin = thin;
  how.engine = by;
  assert_int_equal(vxm_sampler_create(&sampler, context, &options, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_put(sampler, 3, soup, NULL), VXM_OK);
  return sampler;
}

static void check_variants(const vxm_soup *soup, vxm_thin_parts thin, int64_t resolution) {
  enum { COUNT = 5 };
  vxm_sampler *cpu = make_sampler(soup, thin, resolution, NULL),
              *there = make_sampler(soup, thin, resolution, engine);
  vxm_space space = vxm_sampler_space(cpu);
  vxm_grid *grid = engine_grid(context, &space);
  vxm_variant variants[COUNT];
  for (uint32_t v = 0; v < COUNT; v++)
    variants[v] = (vxm_variant){3, 1, v};
  for (int f = 0; f < FORMATS; f++) {
    vxm_device_voxels *voxels;
    vxm_error error = VXM_ERROR_INIT;
    vxm_status status = vxm_sampler_batch_device(&voxels, there, variants, COUNT, formats[f], &error);
    if (has_textures()) {
      assert_int_equal(status, VXM_ERROR_UNAVAILABLE);
      assert_null(voxels);
      continue;
    }
    if (status != VXM_OK)
      fail_msg("%s", error.text);
    vxm_device_info info = describe(voxels);
    assert_int_equal(info.count, COUNT);
    assert_int_equal(info.stayed, thin == VXM_THIN_DROP);
    for (int64_t v = 0; v < COUNT; v++) {
      assert_int_equal(vxm_sampler_grid(grid, cpu, &variants[v], NULL), VXM_OK);
      check_equal(&info, v, grid);
    }
#ifdef HAVE_OPENCL
    struct DLManagedTensor *tensor;
    assert_int_equal(vxm_device_voxels_dlpack(&tensor, voxels, NULL), VXM_OK);
    check_tensor(tensor, &info, true);
    tensor->deleter(tensor);
#endif
    vxm_device_voxels_destroy(voxels);
  }
  vxm_grid_destroy(grid);
  vxm_sampler_destroy(there);
  vxm_sampler_destroy(cpu);
}

static void test_variants(void **state) {
  (void)state;
  vxm_soup *torus = shape_empty(context);
  shape_torus(torus, 40, 20, 10, 4, (double[3]){0, 0, 0});
  check_variants(torus, VXM_THIN_DROP, 33);
  check_variants(torus, VXM_THIN_DROP, 64);
  check_variants(torus, VXM_THIN_AUTO, 21);
  vxm_soup_destroy(torus);
}

/* ---- What is refused ---- */

static void test_refused(void **state) {
  (void)state;
  vxm_space space = engine_space(40, 30, 20), large = engine_space(1 << 20, 1 << 20, 1 << 20);
  vxm_soup *soup = box_with_ties(0.25, 0.5);
  vxm_context *owner = context_of(1, 0);
  vxm_device_voxels *voxels;
  vxm_model *cpu = model_by(NULL, soup);
  assert_int_equal(vxm_model_voxelize_device(&voxels, cpu, &space, NULL, formats[0], NULL),
                   VXM_ERROR_UNAVAILABLE);
  vxm_model_destroy(cpu);
  vxm_engine *by;
  assert_int_equal(vxm_engine_create(&by, owner, ENGINE, NULL, NULL), VXM_OK);
  vxm_model *model = model_by(by, soup);
  assert_int_equal(vxm_model_voxelize_device(&voxels, model, &large, NULL, formats[2], NULL),
                   VXM_ERROR_RANGE);
  assert_int_equal(vxm_model_voxelize_device(&voxels, model, &space, NULL, (vxm_voxel_format)7, NULL),
                   VXM_ERROR_ARGUMENT);
  static const double flat[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0};
  assert_int_equal(vxm_model_voxelize_device(&voxels, model, &space, flat, formats[0], NULL),
                   VXM_ERROR_ARGUMENT);
  assert_null(voxels);
  int refused = 0;
  for (size_t left = 0;; left += 4000, refused++) {
    leave_memory(owner, left);
    vxm_status status = vxm_model_voxelize_device(&voxels, model, &space, NULL, formats[1], NULL);
    if (status == VXM_OK)
      break;
    assert_int_equal(status, VXM_ERROR_MEMORY_LIMIT);
    assert_null(voxels);
  }
  assert_true(refused > 5);
  leave_memory(owner, SIZE_MAX);
  vxm_device_voxels_destroy(voxels);
  vxm_model_destroy(model);
  vxm_engine_destroy(by);
  vxm_context_destroy(owner);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_models),   cmocka_unit_test(test_far_and_tiles),
                                     cmocka_unit_test(test_holders),  cmocka_unit_test(test_dlpack),
                                     cmocka_unit_test(test_variants), cmocka_unit_test(test_refused)};
  int status = gpu_test_start(NULL);
  if (status == 0)
    status = cmocka_run_group_tests_name("voxels that stay, by " ENGINE, tests, setup, teardown);
  vxm_engine_destroy(engine);
  return status;
}
