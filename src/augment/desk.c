/* SPDX-License-Identifier: BSD-3-Clause */
#include "augment/desk.h"
#include "augment/spread.h"
#include "base/threads.h"
#include "gridio/gridio.h"

#include <math.h>
#include <string.h>

enum { SLICE_POINTS = 8192 };

/** z runs fastest, as in numpy arrays. */
static const vxm_layout layout_of_arrays = {2, 1, 0};

vxm_space vxm_desk_space(int64_t resolution) {
  double size = 1 / (double)resolution;
  return (vxm_space){{resolution, resolution, resolution}, {0, 0, 0}, {size, size, size}};
}

vxm_status vxm_desk_create(vxm_desk *out, vxm_context *context, bool alone, vxm_error *error) {
  *out = (vxm_desk){0};
  vxm_status status = vxm_context_child(&out->context, context, alone, error);
  out->twin.context = out->context;
  return status;
}

void vxm_desk_destroy(vxm_desk *desk) {
  if (!desk->context)
    return;
  vxm_twin_destroy(&desk->twin);
  vxm_free(desk->context, desk->words);
  vxm_grid_destroy(desk->grid);
  vxm_context_release(desk->context);
  *desk = (vxm_desk){0};
}

/* ---- Points ---- */

typedef struct move_job {
  double (*to)[3];
  const double (*from)[3];
  const uint32_t *entry; /**< of each point in the noise; NULL = not displaced */
  const float (*noise)[4];
  uint32_t offset, size; /**< of the noise */
  const double *matrix;
  size_t count, slices;
} move_job;

/** Adds the entries of the noise to points. */
static void displace(const move_job *job, size_t begin, size_t end) {
  double(*to)[3] = job->to;
  const uint32_t *entries = job->entry, offset = job->offset, size = job->size;
  const float(*noise)[4] = job->noise;
  for (size_t i = begin; i < end; i++) {
    uint32_t entry = entries[i] + offset; /* both are below 2^31 */
    const float *v = noise[entry < size ? entry : entry - size];
    for (int a = 0; a < 3; a++)
      to[i][a] += (double)v[a];
  }
}

static void move_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const move_job *job = payload;
  double(*to)[3] = job->to;
  const double(*from)[3] = job->from;
  double m[12]; /* a copy that no store can change */
  memcpy(m, job->matrix, sizeof m);
  size_t begin = vxm_slice_begin(job->count, job->slices, slice),
         end = vxm_slice_begin(job->count, job->slices, slice + 1);
  enum { BLOCK = 256 /**< points that stay in the first-level cache */ };
  for (; begin < end; begin += BLOCK) {
    size_t last = end - begin < BLOCK ? end : begin + BLOCK;
    for (size_t i = begin; i < last; i++) {
      const double x = from[i][0], y = from[i][1], z = from[i][2];
      to[i][0] = m[0] * x + m[1] * y + m[2] * z + m[3];
      to[i][1] = m[4] * x + m[5] * y + m[6] * z + m[7];
      to[i][2] = m[8] * x + m[9] * y + m[10] * z + m[11];
    }
    if (job->entry)
      displace(job, begin, last);
  }
}

/** Moves points to where they lie in the unit cube, each displaced by its entry of the noise. */
static void move(vxm_context *context, double (*to)[3], const double *from, const uint32_t *entry,
                 size_t count, const vxm_placement *placement, const vxm_noise *noise) {
  move_job job = {.to = to,
                  .from = (const double(*)[3])from,
                  .entry = entry,
                  .noise = (const float(*)[4])noise->vectors,
                  .offset = noise->size > 0 ? placement->offset % noise->size : 0,
                  .size = noise->size,
                  .matrix = placement->matrix,
                  .count = count,
                  .slices = 1 + count / SLICE_POINTS};
  vxm_parallel(context, job.slices, move_slice, &job);
}

/* ---- Variants ---- */

vxm_status vxm_desk_fill(vxm_desk *desk, const vxm_window *window, const vxm_subject *subject,
                         const vxm_placement *placement, const vxm_noise *noise, vxm_error *error) {
  vxm_twin *twin = &desk->twin;
  vxm_status status = vxm_twin_attach(twin, subject->model, error);
  if (status != VXM_OK)
    return status;
  const vxm_facets *facets = &subject->model->shape.facets;
  move(desk->context, twin->positions, &facets->positions[0][0], subject->entry, facets->first_apex,
       placement, noise);
  if (vxm_model_wants_faces(subject->model))
    move(desk->context, twin->vertices, facets->soup->positions, subject->vertex_entry,
         facets->soup->vertex_count, placement, noise);
  vxm_space space = vxm_desk_space(window->fast_dim);
  vxm_lattice lattice = vxm_lattice_of(&space);
  /* Both ends of an edge may be displaced, along three axes. */
  double reach = 2 * sqrt(3.0) * noise->reach;
  return vxm_twin_fill(twin, window, &lattice, placement->stretch, reach, placement->mirrored, error);
}

static vxm_status make_room(vxm_desk *desk, size_t words, vxm_error *error) {
  if (words <= desk->word_room)
    return VXM_OK;
  vxm_error local = VXM_ERROR_INIT;
  vxm_free(desk->context, desk->words);
  desk->words = vxm_alloc(desk->context, words, sizeof *desk->words, &local);
  desk->word_room = desk->words ? words : 0;
  if (!desk->words && error)
    *error = local;
  return local.code;
}

/** Whether packed voxels have the form of a window's words, so that it can be filled where they belong. */
static bool is_window(const void *out, vxm_voxels voxels, int64_t resolution) {
  const uint16_t one = 1;
  return voxels == VXM_VOXELS_PACKED && resolution % 64 == 0 && (uintptr_t)out % sizeof(uint64_t) == 0 &&
         *(const unsigned char *)&one == 1;
}

vxm_status vxm_desk_write(vxm_desk *desk, void *out, vxm_voxels voxels, int64_t resolution,
                          const vxm_subject *subject, const vxm_placement *placement, const vxm_noise *noise,
                          vxm_error *error) {
  vxm_space space = vxm_desk_space(resolution);
  vxm_window window = vxm_window_of(&space, layout_of_arrays, 0, resolution);
  bool direct = is_window(out, voxels, resolution);
  if (!direct) {
    vxm_status status = make_room(desk, window.slice_words * (size_t)resolution, error);
    if (status != VXM_OK)
      return status;
  }
  window.words = direct ? out : desk->words;
  vxm_status status = vxm_desk_fill(desk, &window, subject, placement, noise, error);
  if (status == VXM_OK && !direct)
    vxm_spread(out, voxels, window.words, (size_t)resolution * (size_t)resolution, resolution);
  return status;
}

vxm_status vxm_desk_save(vxm_desk *desk, const char *path, const char *format, int64_t resolution,
                         const vxm_subject *subject, const vxm_placement *placement, const vxm_noise *noise,
                         vxm_error *error) {
  vxm_space space = vxm_desk_space(resolution);
  vxm_status status = desk->grid ? VXM_OK : vxm_grid_create(&desk->grid, desk->context, &space, error);
  if (status != VXM_OK)
    return status;
  vxm_window window = vxm_window_of_grid(desk->grid);
  status = vxm_desk_fill(desk, &window, subject, placement, noise, error);
  return status == VXM_OK ? vxm_gridio_write(desk->grid, path, format, error) : status;
}
