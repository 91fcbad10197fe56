/* SPDX-License-Identifier: BSD-3-Clause */
#include "augment/worker.h"
#include "augment/density.h"
#include "augment/unpack_bits.h"
#include "gridio/gridio.h"
#include "voxel/model/model_device_voxels.h"

#include <math.h>
#include <string.h>

/** z runs fastest, as in numpy arrays. */
static const vxm_layout layout_of_arrays = {2, 1, 0};

vxm_space vxm_worker_space(int64_t resolution) {
  double size = 1 / (double)resolution;
  return (vxm_space){{resolution, resolution, resolution}, {0, 0, 0}, {size, size, size}};
}

vxm_status vxm_worker_create(vxm_worker *out, vxm_context *context, bool alone, vxm_error *error) {
  *out = (vxm_worker){0};
  vxm_status status = vxm_context_child(&out->context, context, alone, error);
  out->instance.context = out->context;
  return status;
}

void vxm_worker_destroy(vxm_worker *worker) {
  if (!worker->context)
    return;
  vxm_model_instance_destroy(&worker->instance);
  vxm_free(worker->context, worker->words);
  vxm_grid_destroy(worker->grid);
  vxm_context_release(worker->context);
  *worker = (vxm_worker){0};
}

/* ---- Variants ---- */

/** How the points of a subject move; those of its triangles, or the vertices of its mesh. */
static vxm_vertex_transform motion_of(const vxm_sampler_model *subject, const vxm_placement *placement,
                                      const vxm_noise *noise, bool vertices) {
  const vxm_triangle_set *triangles = &subject->model->analysis.triangles;
  return (vxm_vertex_transform){.from = vertices ? (const double(*)[3])triangles->soup->positions
                                                 : (const double(*)[3])triangles->positions,
                                .count = vertices ? triangles->soup->vertex_count : triangles->first_apex,
                                .matrix = placement->matrix,
                                .entry = vertices ? subject->vertex_entry : subject->entry,
                                .noise = (const float(*)[4])noise->vectors,
                                .noise_size = noise->size,
                                .offset = noise->size > 0 ? placement->offset % noise->size : 0,
                                .stretch = placement->stretch,
                                /* Both ends of an edge may be displaced, along three axes. */
                                .reach = 2 * sqrt(3.0) * noise->reach,
                                .from_serial = vertices ? 0 : triangles->serial,
                                .noise_serial = noise->serial};
}

static vxm_status place(vxm_worker *worker, int64_t resolution, const vxm_sampler_model *subject,
                        const vxm_placement *placement, const vxm_noise *noise, bool is_field,
                        vxm_error *error) {
  vxm_model_instance *instance = &worker->instance;
  vxm_status status = vxm_model_instance_attach(instance, subject->model, error);
  if (status != VXM_OK)
    return status;
  if (worker->engine)
    instance->pass.solid.engine = worker->engine;
  vxm_space space = vxm_worker_space(resolution);
  vxm_lattice lattice = vxm_lattice_of(&space);
  vxm_variation variation = {.points = motion_of(subject, placement, noise, false),
                             .vertices = motion_of(subject, placement, noise, true),
                             .mirrored = placement->mirrored,
                             .is_field = is_field};
  return vxm_model_instance_place(instance, &lattice, &variation, error);
}

static vxm_status fill(vxm_worker *worker, const vxm_window *window, const vxm_sampler_model *subject,
                       const vxm_placement *placement, const vxm_noise *noise, bool is_field,
                       vxm_error *error) {
  vxm_status status = place(worker, window->fast_dim, subject, placement, noise, is_field, error);
  return status == VXM_OK ? vxm_model_pass_fill(&worker->instance.pass, window, error) : status;
}

vxm_status vxm_worker_keep(vxm_worker *worker, vxm_device_voxels *voxels, int64_t index,
                           const vxm_sampler_model *subject, const vxm_placement *placement,
                           const vxm_noise *noise, vxm_error *error) {
  vxm_status status = place(worker, voxels->info.dims[0], subject, placement, noise, false, error);
  return status == VXM_OK ? vxm_model_pass_keep_on_device(&worker->instance.pass, voxels, index, error)
                          : status;
}

vxm_status vxm_worker_fill(vxm_worker *worker, const vxm_window *window, const vxm_sampler_model *subject,
                           const vxm_placement *placement, const vxm_noise *noise, vxm_error *error) {
  return fill(worker, window, subject, placement, noise, false, error);
}

static vxm_status make_room(vxm_worker *worker, size_t words, vxm_error *error) {
  return vxm_renew(worker->context, (void **)&worker->words, &worker->word_capacity, words,
                   sizeof *worker->words, error);
}

/** Whether packed voxels have the form of a window's words, so that it can be filled where they belong. */
static bool is_window(const void *out, vxm_voxel_format voxels, int64_t resolution) {
  const uint16_t one = 1;
  return voxels == VXM_VOXEL_FORMAT_PACKED && resolution % 64 == 0 &&
         (uintptr_t)out % sizeof(uint64_t) == 0 && *(const unsigned char *)&one == 1;
}

/** The shares of voxels. */
static vxm_status write_shares(vxm_worker *worker, void *out, vxm_voxel_format voxels, int64_t resolution,
                               int coverage, const vxm_sampler_model *subject, const vxm_placement *placement,
                               const vxm_noise *noise, vxm_error *error) {
  vxm_space space = vxm_worker_space(resolution * coverage);
  vxm_window window = vxm_window_of(&space, layout_of_arrays, 0, space.dims[0]);
  vxm_status status = make_room(worker, window.slice_words * (size_t)space.dims[0], error);
  if (status != VXM_OK)
    return status;
  window.words = worker->words;
  status = fill(worker, &window, subject, placement, noise, true, error);
  if (status == VXM_OK)
    vxm_density_write(out, worker->context, &window, coverage, voxels);
  return status;
}

vxm_status vxm_worker_write(vxm_worker *worker, void *out, vxm_voxel_format voxels, int64_t resolution,
                            int coverage, const vxm_sampler_model *subject, const vxm_placement *placement,
                            const vxm_noise *noise, vxm_error *error) {
  if (coverage > 0)
    return write_shares(worker, out, voxels, resolution, coverage, subject, placement, noise, error);
  vxm_space space = vxm_worker_space(resolution);
  vxm_window window = vxm_window_of(&space, layout_of_arrays, 0, resolution);
  bool direct = is_window(out, voxels, resolution);
  if (!direct) {
    vxm_status status = make_room(worker, window.slice_words * (size_t)resolution, error);
    if (status != VXM_OK)
      return status;
  }
  window.words = direct ? out : worker->words;
  vxm_status status = vxm_worker_fill(worker, &window, subject, placement, noise, error);
  if (status == VXM_OK && !direct)
    vxm_unpack_row(out, voxels, window.words, (size_t)resolution * (size_t)resolution, resolution,
                   worker->streaming);
  return status;
}

vxm_status vxm_worker_save(vxm_worker *worker, const char *path, const char *format, int64_t resolution,
                           const vxm_sampler_model *subject, const vxm_placement *placement,
                           const vxm_noise *noise, vxm_error *error) {
  vxm_space space = vxm_worker_space(resolution);
  vxm_status status = worker->grid ? VXM_OK : vxm_grid_create(&worker->grid, worker->context, &space, error);
  if (status != VXM_OK)
    return status;
  vxm_window window = vxm_window_of_grid(worker->grid);
  status = vxm_worker_fill(worker, &window, subject, placement, noise, error);
  if (status != VXM_OK)
    return status;
  status = vxm_gridio_write(worker->grid, path, format, error);
  worker->write_failed = status != VXM_OK;
  return status;
}
