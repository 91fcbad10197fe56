/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opencl/faieghi.h"
#include "base/clock.h"
#include "voxel/surface/surface.h"

#include <math.h>
#include <string.h>

enum {
  AXIS_MOST = 1 << 24,      /**< whole numbers up to this are floats */
  FACETS_AT_ONCE = 1 << 20, /**< between two looks at whether to stop */
  TESTS_AT_ONCE = 1 << 28,  /**< the same, voxel by voxel */
  COUNTS_AT_ONCE = 1 << 17
};

/** As in shaders/published.cl. */
typedef struct vxm_published_job {
  float first[3], per_unit;
  float size[3];
  uint32_t facets;
  uint32_t dims[3], material;
  uint32_t is_counted, unused[3];
} vxm_published_job;

struct vxm_published {
  vxm_opencl *engine;
  cl_command_queue queue; /**< its own: with profiling */
  bool is_profiled, by_voxel;
  vxm_cl_buffer vertices, voxels, tests;
  size_t voxel_count;
  vxm_published_job job;
};

/* ---- Buffers ---- */

static void drop_buffer(vxm_published *published, vxm_cl_buffer *buffer) {
  if (buffer->mem)
    published->engine->cl->ReleaseMemObject(buffer->mem);
  vxm_memory_give(published->engine->base.context, buffer->bytes);
  *buffer = (vxm_cl_buffer){0};
}

/** Each is made once, of its final size. */
static vxm_status make_buffer(vxm_cl_buffer *out, vxm_published *published, uint64_t count, size_t size,
                              const char *what, vxm_error *error) {
  vxm_opencl *engine = published->engine;
  uint64_t most = (uint64_t)engine->base.info.block_bytes;
  cl_int code;
  if (count > most / size || count > SIZE_MAX / size)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "%llu bytes of %s are more than the %llu that %s gives to a buffer; use larger voxels",
                    (unsigned long long)(count * size), what, (unsigned long long)most,
                    engine->base.info.renderer);
  size_t bytes = (size_t)count * size;
  vxm_status status = vxm_memory_take(engine->base.context, bytes, error);
  if (status != VXM_OK)
    return status;
  out->bytes = bytes;
  out->mem = engine->cl->CreateBuffer(engine->context, CL_MEM_READ_WRITE, bytes, NULL, &code);
  if (code == CL_SUCCESS)
    return VXM_OK;
  out->mem = NULL;
  drop_buffer(published, out);
  return vxm_cl_check(code, "making a buffer", error);
}

static vxm_status clear_voxels(vxm_published *published, vxm_error *error) {
  static const cl_uchar zero = 0;
  return vxm_cl_check(published->engine->cl->EnqueueFillBuffer(published->queue, published->voxels.mem, &zero,
                                                               sizeof zero, 0, published->voxels.bytes, 0,
                                                               NULL, NULL),
                      "clearing voxels", error);
}

/* ---- Triangles and the grid ---- */

/** The corners of each triangle, one triangle after another (section 3.1), and their box. */
static vxm_status sort_vertices(float *out, float low[3], float high[3], const vxm_surface *surface,
                                vxm_error *error) {
  for (size_t c = 0; c < 3 * surface->triangle_count; c++) {
    const double *p = vxm_position(surface->soup, surface->corners[c]);
    for (int a = 0; a < 3; a++) {
      float value = (float)p[a];
      if (!isfinite(value))
        return vxm_fail(error, VXM_ERROR_RANGE,
                        "vertex %lu is not finite as 32-bit floats; repair or scale the mesh first",
                        (unsigned long)surface->corners[c]);
      out[3 * c + (size_t)a] = value;
      low[a] = c == 0 || value < low[a] ? value : low[a];
      high[a] = c == 0 || value > high[a] ? value : high[a];
    }
  }
  return VXM_OK;
}

/** Divides the box into cubes (section 3.2.1); a millionth of a voxel is rounding, and no further voxel. */
static vxm_status make_grid(vxm_space *out, vxm_published *published, const float low[3], const float high[3],
                            double voxel_size, vxm_error *error) {
  const double rounding = 1e-6;
  vxm_published_job *job = &published->job;
  uint64_t count = 1;
  float size = (float)voxel_size;
  job->per_unit = 1 / size;
  for (int a = 0; a < 3; a++) {
    double cells = ceil(((double)high[a] - (double)low[a]) / (double)size - rounding);
    if (cells > AXIS_MOST)
      return vxm_fail(
          error, VXM_ERROR_RANGE,
          "%.3g voxels along an axis are more than the %d that 32-bit floats tell apart; use larger "
          "voxels",
          cells, AXIS_MOST);
    job->first[a] = low[a];
    job->size[a] = size;
    job->dims[a] = cells > 1 ? (uint32_t)cells : 1;
    out->dims[a] = job->dims[a];
    out->origin[a] = (double)low[a];
    out->voxel_size[a] = (double)size;
    if (count > UINT64_MAX / 8 / job->dims[a])
      return vxm_fail(error, VXM_ERROR_RANGE, "the grid has too many voxels; use larger ones");
    count *= job->dims[a];
  }
  vxm_status status = make_buffer(&published->voxels, published, count, 1, "voxels", error);
  published->voxel_count = (size_t)count;
  return status;
}

static vxm_status send_vertices(vxm_published *published, const float *vertices, vxm_error *error) {
  size_t bytes = published->vertices.bytes;
  return vxm_cl_check(published->engine->cl->EnqueueWriteBuffer(published->queue, published->vertices.mem,
                                                                CL_TRUE, 0, bytes, vertices, 0, NULL, NULL),
                      "sending the triangles", error);
}

static vxm_status place(vxm_published *published, vxm_space *space, const vxm_surface *surface,
                        double voxel_size, vxm_error *error) {
  vxm_context *context = published->engine->base.context;
  vxm_error local = VXM_ERROR_INIT;
  float low[3] = {0}, high[3] = {0};
  if (surface->triangle_count == 0)
    return vxm_fail(error, VXM_ERROR_EMPTY, "the mesh has no triangles to voxelize");
  published->job.facets = (uint32_t)surface->triangle_count;
  float *vertices = vxm_alloc(context, surface->triangle_count, 9 * sizeof *vertices, &local);
  vxm_status status = vertices ? sort_vertices(vertices, low, high, surface, &local) : local.code;
  if (status == VXM_OK)
    status = make_grid(space, published, low, high, voxel_size, &local);
  if (status == VXM_OK)
    status = make_buffer(&published->vertices, published, surface->triangle_count, 9 * sizeof(float),
                         "triangles", &local);
  if (status == VXM_OK)
    status = send_vertices(published, vertices, &local);
  vxm_free(context, vertices);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/* ---- Making one ---- */

static vxm_status make_queue(vxm_published *published, vxm_error *error) {
  vxm_opencl *engine = published->engine;
  const vxm_cl *cl = engine->cl;
  cl_command_queue_properties properties = 0;
  cl_int code =
      cl->GetDeviceInfo(engine->device.id, CL_DEVICE_QUEUE_PROPERTIES, sizeof properties, &properties, NULL);
  published->is_profiled = code == CL_SUCCESS && (properties & CL_QUEUE_PROFILING_ENABLE) != 0;
  published->queue = cl->CreateCommandQueue(engine->context, engine->device.id,
                                            published->is_profiled ? CL_QUEUE_PROFILING_ENABLE : 0, &code);
  return vxm_cl_check(code, "making a queue", error);
}

static vxm_status fill(vxm_published *published, vxm_space *space, const vxm_soup *soup,
                       const vxm_published_options *options, vxm_error *error) {
  vxm_surface *surface = NULL;
  vxm_status status = vxm_cl_ready(published->engine, VXM_CL_PUBLISHED, error);
  if (status == VXM_OK)
    status = make_queue(published, error);
  if (status == VXM_OK)
    status = vxm_surface_make(&surface, soup->context, soup, error);
  if (status == VXM_OK)
    status = place(published, space, surface, options->voxel_size, error);
  vxm_surface_destroy(surface);
  size_t items = options->by_voxel ? published->voxel_count : published->job.facets;
  size_t size = options->by_voxel ? sizeof(cl_uint) : sizeof(cl_ulong);
  if (status == VXM_OK)
    status =
        make_buffer(&published->tests, published, options->count_tests ? items : 1, size, "counts", error);
  return status == VXM_OK ? clear_voxels(published, error) : status;
}

vxm_status vxm_cl_published_create(vxm_published **out, vxm_space *space, vxm_opencl *engine,
                                   const vxm_soup *soup, const vxm_published_options *options,
                                   vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_published *published = vxm_calloc(engine->base.context, 1, sizeof *published, &local);
  *space = (vxm_space){0};
  vxm_status status = published ? VXM_OK : local.code;
  if (published) {
    published->engine = engine;
    published->by_voxel = options->by_voxel;
    published->job.material = options->material;
    published->job.is_counted = options->count_tests;
    status = fill(published, space, soup, options, &local);
  }
  if (status == VXM_OK) {
    *out = published;
    return VXM_OK;
  }
  vxm_cl_published_destroy(published);
  *space = (vxm_space){0};
  vxm_error_pass(error, &local);
  return status;
}

void vxm_cl_published_destroy(vxm_published *published) {
  if (!published)
    return;
  const vxm_cl *cl = published->engine->cl;
  if (published->queue)
    cl->Finish(published->queue);
  drop_buffer(published, &published->vertices);
  drop_buffer(published, &published->voxels);
  drop_buffer(published, &published->tests);
  if (published->queue)
    cl->ReleaseCommandQueue(published->queue);
  vxm_free(published->engine->base.context, published);
}

/* ---- Voxelizing ---- */

/** Waits for what began at `start` by the host's clock, and adds how long it took. */
static vxm_status await(double *ms, const vxm_published *published, cl_event event, double start,
                        const char *doing, vxm_error *error) {
  const vxm_cl *cl = published->engine->cl;
  cl_ulong begin = 0, end = 0;
  cl_int code = cl->WaitForEvents(1, &event);
  double passed = vxm_clock_ms() - start;
  if (published->is_profiled &&
      cl->GetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof begin, &begin, NULL) ==
          CL_SUCCESS &&
      cl->GetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, NULL) == CL_SUCCESS)
    passed = (double)(end - begin) * 1e-6;
  cl->ReleaseEvent(event);
  *ms += passed;
  return vxm_cl_check(code, doing, error);
}

/** Runs the work-items from `first` on. */
static vxm_status run_some(double *ms, const vxm_published *published, cl_kernel kernel, size_t first,
                           size_t items, size_t group, vxm_error *error) {
  const vxm_cl *cl = published->engine->cl;
  cl_event event = NULL;
  double start = vxm_clock_ms();
  size_t global = (items + group - 1) / group * group;
  cl_int code =
      cl->EnqueueNDRangeKernel(published->queue, kernel, 1, &first, &global, &group, 0, NULL, &event);
  if (code != CL_SUCCESS)
    return vxm_cl_check(code, "running the published program", error);
  return await(ms, published, event, start, "running the published program", error);
}

static vxm_status set_arguments(const vxm_published *published, cl_kernel kernel, vxm_error *error) {
  const vxm_cl *cl = published->engine->cl;
  cl_int code = cl->SetKernelArg(kernel, 0, sizeof(cl_mem), &published->vertices.mem);
  if (code == CL_SUCCESS)
    code = cl->SetKernelArg(kernel, 1, sizeof(cl_mem), &published->voxels.mem);
  if (code == CL_SUCCESS)
    code = cl->SetKernelArg(kernel, 2, sizeof(cl_mem), &published->tests.mem);
  if (code == CL_SUCCESS)
    code = cl->SetKernelArg(kernel, 3, sizeof published->job, &published->job);
  return vxm_cl_check(code, "running the published program", error);
}

/** Adds up what the work-items have counted: of 4 bytes each by voxels, else of 8. */
static vxm_status add_tests(int64_t *sum, const vxm_published *published, vxm_error *error) {
  vxm_context *context = published->engine->base.context;
  vxm_error local = VXM_ERROR_INIT;
  uint64_t *block = vxm_alloc(context, COUNTS_AT_ONCE, sizeof *block, &local);
  vxm_status status = block ? VXM_OK : local.code;
  for (size_t at = 0, left = published->tests.bytes; left > 0 && status == VXM_OK;) {
    size_t bytes = left < COUNTS_AT_ONCE * sizeof *block ? left : COUNTS_AT_ONCE * sizeof *block;
    status = vxm_cl_check(published->engine->cl->EnqueueReadBuffer(published->queue, published->tests.mem,
                                                                   CL_TRUE, at, bytes, block, 0, NULL, NULL),
                          "reading counts", &local);
    for (size_t i = 0; i < bytes / sizeof(uint32_t) && status == VXM_OK && published->by_voxel; i++)
      *sum += ((const uint32_t *)(const void *)block)[i];
    for (size_t i = 0; i < bytes / sizeof(uint64_t) && status == VXM_OK && !published->by_voxel; i++)
      *sum += (int64_t)block[i];
    at += bytes;
    left -= bytes;
  }
  vxm_free(context, block);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/** Work-items between two looks at whether to stop: whole groups, and enough to keep the device busy. */
static size_t items_at_once(const vxm_published *published, size_t group) {
  size_t units = (size_t)vxm_max(1, published->engine->base.info.compute_units);
  size_t items = published->by_voxel ? (size_t)TESTS_AT_ONCE / published->job.facets : FACETS_AT_ONCE;
  return items > units * group ? items / group * group : units * group;
}

/** An `auto` engine may have given way to the CPU meanwhile. */
static vxm_status check_engine(const vxm_published *published, vxm_error *error) {
  if (published->engine->base.ops)
    return VXM_OK;
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "published: the OpenCL engine has failed before: %s",
                  published->engine->base.info.note);
}

vxm_status vxm_cl_published_voxelize(vxm_published_report *report, vxm_published *published,
                                     vxm_error *error) {
  vxm_opencl *engine = published->engine;
  size_t items = published->by_voxel ? published->voxel_count : published->job.facets, group = 1;
  vxm_status status = check_engine(published, error);
  if (status == VXM_OK)
    status = vxm_cl_ready(engine, VXM_CL_PUBLISHED, error);
  if (status != VXM_OK)
    return status;
  cl_kernel kernel = engine->kernels[published->by_voxel ? VXM_CL_PUBLISHED_VOXELS : VXM_CL_PUBLISHED_FACETS];
  *report = (vxm_published_report){.profiled = published->is_profiled, .triangles = published->job.facets};
  status = vxm_cl_check(engine->cl->GetKernelWorkGroupInfo(
                            kernel, engine->device.id, CL_KERNEL_WORK_GROUP_SIZE, sizeof group, &group, NULL),
                        "asking for the size of groups", error);
  if (status == VXM_OK)
    status = set_arguments(published, kernel, error);
  if (status == VXM_OK)
    status = clear_voxels(published, error);
  report->work_group = (int64_t)group;
  size_t step = items_at_once(published, group);
  for (size_t first = 0; first < items && status == VXM_OK; first += step) {
    size_t some = items - first < step ? items - first : step;
    status = vxm_progress(engine->base.context, "running the published program",
                          (double)first / (double)items, error);
    if (status == VXM_OK)
      status = run_some(&report->kernel_ms, published, kernel, first, some, group, error);
  }
  if (status == VXM_OK && published->job.is_counted)
    status = add_tests(&report->tests, published, error);
  return status;
}

/* ---- Taking voxels back ---- */

static vxm_status read_voxels(uint8_t *voxels, double *ms, const vxm_published *published, vxm_error *error) {
  cl_event event = NULL;
  double start = vxm_clock_ms();
  cl_int code = published->engine->cl->EnqueueReadBuffer(published->queue, published->voxels.mem, CL_FALSE, 0,
                                                         published->voxel_count, voxels, 0, NULL, &event);
  if (code != CL_SUCCESS)
    return vxm_cl_check(code, "reading voxels", error);
  return await(ms, published, event, start, "reading voxels", error);
}

static vxm_status map_voxels(uint8_t *voxels, double *ms, const vxm_published *published, vxm_error *error) {
  const vxm_cl *cl = published->engine->cl;
  cl_event event = NULL;
  cl_int code;
  double start = vxm_clock_ms();
  void *mapped = cl->EnqueueMapBuffer(published->queue, published->voxels.mem, CL_FALSE, CL_MAP_READ, 0,
                                      published->voxel_count, 0, NULL, &event, &code);
  if (code != CL_SUCCESS)
    return vxm_cl_check(code, "mapping voxels", error);
  vxm_status status = await(ms, published, event, start, "mapping voxels", error);
  if (status == VXM_OK && voxels)
    memcpy(voxels, mapped, published->voxel_count);
  code = cl->EnqueueUnmapMemObject(published->queue, published->voxels.mem, mapped, 0, NULL, NULL);
  if (code == CL_SUCCESS)
    code = cl->Finish(published->queue);
  return status == VXM_OK ? vxm_cl_check(code, "unmapping voxels", error) : status;
}

vxm_status vxm_cl_published_read(uint8_t *voxels, double *ms, vxm_published *published, vxm_transfer how,
                                 vxm_error *error) {
  vxm_status status = check_engine(published, error);
  /* What was queued before is not the transfer's. */
  if (status == VXM_OK)
    status =
        vxm_cl_check(published->engine->cl->Finish(published->queue), "running the published program", error);
  if (status != VXM_OK)
    return status;
  return how == VXM_TRANSFER_READ ? read_voxels(voxels, ms, published, error)
                                  : map_voxels(voxels, ms, published, error);
}
