/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/thin.h"
#include "base/threads.h"
#include "voxel/thin/added_voxels.h"
#include "voxel/thin/sieve.h"
#include "voxel/thin/sieve_kernels.h"

enum {
  TASK_LEAST = 256,    /**< triangles, as a task takes its time to begin */
  FEW_TRIANGLES = 64,  /**< for all threads: some may be large */
  TASK_MOST = 1 << 14, /**< triangles of which maps leave few */
  TASKS_PER_THREAD = 8
};

typedef struct search {
  vxm_thin_adder *thin;
  const vxm_thin_job *job;
  size_t task; /**< triangles of one */
} search;

static size_t least(size_t a, size_t b) {
  return a < b ? a : b;
}

/** A triangle whose cells say nothing. */
static void look_at(vxm_link_frame *frames, size_t triangle) {
  const vxm_thin_job *job = frames[0].job;
  if (vxm_role_of(job->triangles, triangle) != VXM_ROLE_FACE)
    return;
  vxm_meet_cube(frames[0].meetings, job, triangle);
  vxm_meet_sections(frames, triangle, ~UINT64_C(0));
}

/** Whether numbers of cells leave a bit free (small_triangles.c). */
static bool cells_are_short(const vxm_thin_job *job) {
  const int64_t *dims = job->placed->lattice.space.dims, longest = (INT64_C(1) << (VXM_CELL_BITS - 1)) - 1;
  return !job->placed->wide && dims[0] < longest && dims[1] < longest && dims[2] < longest;
}

/** How many triangles are looked at. */
static size_t count_looked_at(const vxm_thin_job *job) {
  return job->order ? job->order_count : job->triangles->triangle_count;
}

/**
 * From `begin` on, before `end`: the end of triangles that are faces, or of them and a few caps and cones
 * between. *next becomes the first triangle behind the caps and cones that follow.
 */
static size_t faces_end(const vxm_triangle_set *triangles, size_t begin, size_t end, size_t *next) {
  const size_t few = 64; /* the sieve takes many at a time, and is not to stop for these */
  for (uint32_t part = triangles->part[begin];; part++) {
    const vxm_part *p = &triangles->parts[part];
    *next = least(p->end, end);
    if (p->end - p->caps > few || *next == end)
      return p->caps < begin ? begin : least(p->caps, end);
  }
}

static void look_at_some(size_t task, int worker, void *payload) {
  const search *s = payload;
  const vxm_thin_job *job = s->job;
  vxm_link_frame frames[VXM_LINK_DIRECTIONS];
  vxm_link_frames(frames, job, &s->thin->found[worker]);
  size_t begin = task * s->task, end = least(count_looked_at(job), begin + s->task);
  if (s->thin->found[worker].is_full)
    return;
  bool by_cells = cells_are_short(job) && job->directions == VXM_LINK_AXES;
  for (size_t next = end, last; begin < end; begin = next) {
    last = job->order ? end : faces_end(job->triangles, begin, end, &next);
    if (by_cells)
      vxm_meet_by_cells(frames, begin, last);
    else
      for (size_t t = begin; t < last; t++)
        look_at(frames, t);
  }
}

static void look_at_cubes(size_t list, int worker, void *payload) {
  (void)worker;
  const search *s = payload;
  vxm_meet_cubes(&s->thin->found[list], s->job);
}

/** Whether the lists did not have room for all. */
static bool are_too_many(const vxm_thin_adder *thin) {
  bool full = false;
  for (int w = 0; w < thin->threads; w++)
    full |= thin->found[w].is_full;
  return full;
}

uint64_t vxm_thin_budget(const vxm_context *context) {
  const uint64_t most = UINT64_C(1) << 27, least_bytes = UINT64_C(1) << 18, share = 4;
  uint64_t left = vxm_memory_left(context) / share;
  return left > most ? most : left < least_bytes ? least_bytes : left;
}

/** Meetings that a thread may find before slices are taken apart. */
static size_t most_of(const vxm_thin_adder *thin) {
  return (size_t)(vxm_thin_budget(thin->context) / VXM_THIN_COPIES / sizeof(vxm_meeting)) /
         (size_t)vxm_context_threads(thin->context);
}

/** Empty lists for all threads. @param limited whether they may become full */
static vxm_status make_room(vxm_thin_adder *thin, bool limited, vxm_error *error) {
  int threads = vxm_context_threads(thin->context);
  size_t most = most_of(thin);
  for (int w = 0; w < thin->threads; w++) {
    thin->found[w].count = 0;
    thin->found[w].in_cubes_count = 0;
    thin->found[w].thin_area = 0;
    thin->found[w].is_full = false;
    thin->found[w].most = limited ? most : SIZE_MAX;
    thin->found[w].error = (vxm_error)VXM_ERROR_INIT;
  }
  if (threads <= thin->threads)
    return VXM_OK;
  vxm_error local = VXM_ERROR_INIT;
  vxm_meetings *found = vxm_realloc(thin->context, thin->found, (size_t)threads, sizeof *found, &local);
  if (!found) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  thin->found = found;
  for (; thin->threads < threads; thin->threads++)
    found[thin->threads] = (vxm_meetings){.context = thin->context, .most = limited ? most : SIZE_MAX};
  return VXM_OK;
}

/** Triangles of a task: many where there are, as they are sifted together, and maps leave few of them. */
static size_t task_of(const vxm_thin_adder *thin, const vxm_thin_job *job) {
  size_t count = count_looked_at(job), threads = (size_t)vxm_context_threads(thin->context),
         share = count / (threads * TASKS_PER_THREAD);
  if (threads > 1 && count <= FEW_TRIANGLES)
    return share > 0 ? share : 1;
  size_t task = least(share, job->middles ? TASK_MOST : VXM_SIEVE_BATCH),
         smallest = threads > 1 ? TASK_LEAST : VXM_SIEVE_BATCH;
  return task < smallest ? smallest : task;
}

/** Sets the voxels that what has been found asks for. */
static vxm_status apply_found(vxm_thin_adder *thin, const vxm_thin_job *job, const vxm_added_voxels *to,
                              vxm_error *error) {
  thin->slabs.context = thin->context;
  vxm_status status = vxm_meeting_slabs_sort(&thin->slabs, thin->found, thin->threads, error);
  return status == VXM_OK ? vxm_add_voxels(to, job, &thin->slabs, &thin->added, error) : status;
}

/** Sets the voxels of cubes, behind all others. */
static vxm_status add_cubes(vxm_thin_adder *thin, search *s, const vxm_added_voxels *to, vxm_error *error) {
  bool any = false;
  for (int w = 0; w < thin->threads; w++) {
    thin->found[w].count = 0;
    any |= thin->found[w].in_cubes_count > 0;
  }
  if (!any)
    return VXM_OK;
  vxm_status status = vxm_parallel_cancellable(thin->context, (size_t)thin->threads, look_at_cubes, s, error);
  return status == VXM_OK ? apply_found(thin, s->job, to, error) : status;
}

/** Frees what is larger than it would be if it were limited: a slice may have that much, the others need not.
 */
static void release_excess(vxm_thin_adder *thin) {
  size_t most = most_of(thin), all = VXM_THIN_COPIES * most * (size_t)thin->threads;
  for (int w = 0; w < thin->threads; w++)
    if (thin->found[w].capacity > 2 * most) {
      vxm_free(thin->context, thin->found[w].list);
      thin->found[w].list = NULL;
      thin->found[w].capacity = thin->found[w].count = 0;
    }
  if (thin->slabs.capacity + thin->slabs.scratch_capacity > all)
    vxm_meeting_slabs_destroy(&thin->slabs);
}

/** Whether several times as many slices would do, too. */
static bool are_few(const vxm_thin_adder *thin) {
  size_t most = most_of(thin) / 4;
  bool few = true;
  for (int w = 0; w < thin->threads; w++)
    few &= thin->found[w].count + thin->found[w].in_cubes_count <= most;
  return few;
}

static vxm_status add(vxm_thin_adder *thin, vxm_thin_job *job, const vxm_added_voxels *to, bool *too_many,
                      vxm_error *error) {
  search s = {thin, job, task_of(thin, job)};
  size_t tasks = (count_looked_at(job) + s.task - 1) / s.task;
  vxm_status status = make_room(thin, too_many != NULL, error);
  if (status == VXM_OK)
    status = vxm_parallel_cancellable(thin->context, tasks, look_at_some, &s, error);
  if (status == VXM_OK && too_many && are_too_many(thin)) {
    *too_many = true;
    return VXM_OK;
  }
  thin->is_slack = are_few(thin);
  for (int w = 0; w < thin->threads; w++)
    thin->area += thin->found[w].thin_area;
  job->view.added = to->set;
  if (status == VXM_OK)
    status = apply_found(thin, job, to, error);
  if (status == VXM_OK)
    status = add_cubes(thin, &s, to, error);
  if (!too_many)
    release_excess(thin);
  return status;
}

/** Shortens the numbers of cells where that is possible, and there is memory. */
static void make_short_cells(vxm_thin_adder *thin, vxm_thin_job *job, const vxm_window *window) {
  const size_t points = job->triangles->point_count;
  if (job->directions > VXM_LINK_AXES || job->placed->wide || !vxm_cells_fit_short(window) ||
      vxm_renew(thin->context, (void **)&thin->short_cells, &thin->short_capacity, points,
                sizeof *thin->short_cells, NULL) != VXM_OK)
    return;
  vxm_sieve_kernels_of(NULL)->shorten(thin->short_cells, job->placed->cells, points, job->view.axis);
  job->short_cells = thin->short_cells;
}

/** Makes the maps where they cost less than they save, and there is memory. */
static void make_middles(vxm_thin_adder *thin, vxm_thin_job *job, const vxm_window *window) {
  size_t words = (size_t)(window->end - window->begin) * window->slice_words;
  if (!job->short_cells || words > job->triangles->triangle_count || !vxm_middles_fit(window) ||
      vxm_renew(thin->context, (void **)&thin->maps, &thin->map_words, vxm_all_middle_words(words),
                sizeof *thin->maps, NULL) != VXM_OK)
    return;
  vxm_middles_fill(thin->maps, window);
  job->middles = thin->maps;
}

/** Orders the triangles where the window does not stay in the cache, and the sieve is for all of them; not
 * without memory, as this only saves time. */
static vxm_status make_order(vxm_thin_adder *thin, vxm_thin_job *job, const vxm_window *window,
                             vxm_error *error) {
  const size_t large = 1 << 22; /* 32 MiB */
  size_t words = (size_t)(window->end - window->begin) * window->slice_words;
  vxm_sieve sieve;
  if (words <= large || job->directions > VXM_LINK_AXES || !cells_are_short(job) ||
      !vxm_sieve_of(&sieve, job))
    return VXM_OK;
  thin->order.context = thin->context;
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = vxm_slice_order_make(&thin->order, job, &local);
  if (vxm_is_memory(status))
    return VXM_OK;
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  job->order = thin->order.triangles;
  job->order_count = thin->order.count;
  return status;
}

vxm_status vxm_thin_add(vxm_thin_adder *thin, const vxm_window *window, int64_t begin, int64_t end,
                        const vxm_triangle_set *triangles, const vxm_snapped_points *placed, int separating,
                        uint8_t *confidence, bool *too_many, vxm_error *error) {
  vxm_thin_job job = {.triangles = triangles,
                      .corners = (const uint32_t(*)[3])triangles->corners,
                      .placed = placed,
                      .view = vxm_view_of(window),
                      .counted = {begin, end},
                      .slow = window->layout.slow,
                      .directions = separating == 26 ? VXM_LINK_DIRECTIONS : VXM_LINK_AXES};
  vxm_added_voxels to = {NULL, confidence};
  vxm_status status = VXM_OK;
  make_short_cells(thin, &job, window);
  make_middles(thin, &job, window);
  if (!job.middles)
    status = make_order(thin, &job, window, error);
  return status == VXM_OK ? add(thin, &job, &to, too_many, error) : status;
}

vxm_status vxm_thin_find(vxm_thin_adder *thin, vxm_voxel_set *added, const vxm_sparse *solid, int64_t begin,
                         int64_t end, const vxm_triangle_set *triangles, const vxm_snapped_points *placed,
                         int separating, bool *too_many, vxm_error *error) {
  vxm_thin_job job = {.triangles = triangles,
                      .corners = (const uint32_t(*)[3])triangles->corners,
                      .placed = placed,
                      .view = vxm_view_of_octree(solid),
                      .counted = {begin, end},
                      .slow = 2,
                      .directions = separating == 26 ? VXM_LINK_DIRECTIONS : VXM_LINK_AXES};
  vxm_added_voxels to = {added, NULL};
  job.view.begin[2] = vxm_max(begin - vxm_thin_margin(separating), 0);
  job.view.end[2] = vxm_min(end + vxm_thin_margin(separating), solid->space.dims[2]);
  return add(thin, &job, &to, too_many, error);
}

void vxm_thin_destroy(vxm_thin_adder *thin) {
  for (int w = 0; w < thin->threads; w++) {
    vxm_free(thin->context, thin->found[w].list);
    vxm_free(thin->context, thin->found[w].in_cubes);
  }
  vxm_free(thin->context, thin->found);
  vxm_free(thin->context, thin->maps);
  vxm_free(thin->context, thin->short_cells);
  vxm_slice_order_destroy(&thin->order);
  vxm_meeting_slabs_destroy(&thin->slabs);
  *thin = (vxm_thin_adder){.context = thin->context};
}
