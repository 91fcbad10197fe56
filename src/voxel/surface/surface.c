/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/surface/surface.h"
#include "base/threads.h"
#include "mesh/triangulate.h"
#include "voxel/parity/kernels.h"

#include <stdatomic.h>
#include <string.h>

/* ---- Triangles ---- */

static bool has_triangles_only(const vxm_soup *soup) {
  for (size_t f = 0; f < soup->face_count; f++)
    if (soup->offsets[f + 1] - soup->offsets[f] != 3)
      return false;
  return true;
}

/** The triangles that the faces of a soup give. */
static size_t count_triangles(const vxm_soup *soup) {
  size_t count = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    vxm_face(soup, f, &n);
    count += n > 2 ? n - 2 : 0;
  }
  return count;
}

static vxm_status cut_polygons(uint32_t *out, vxm_context *context, const vxm_soup *soup, vxm_error *error) {
  vxm_triangulator triangulator;
  vxm_status status = VXM_OK;
  vxm_triangulator_open(&triangulator, context);
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n), *cut = corner;
    if (n < 3)
      continue;
    if (n > 3)
      status = vxm_triangulate(&triangulator, soup->positions, corner, n, &cut, error);
    if (status == VXM_OK)
      memcpy(out, cut, 3 * (n - 2) * sizeof *out);
    out += 3 * (n - 2);
  }
  vxm_triangulator_close(&triangulator);
  return status;
}

static vxm_status list_triangles(vxm_surface *surface, const vxm_soup *soup, vxm_error *error) {
  vxm_status status = VXM_OK;
  if (has_triangles_only(soup)) {
    surface->triangle_count = soup->face_count;
    surface->corners = soup->indices;
  } else {
    surface->triangle_count = count_triangles(soup);
    surface->cut =
        vxm_try_alloc(surface->context, surface->triangle_count, 3 * sizeof *surface->cut, &status, error);
    if (!surface->cut)
      return status;
    surface->corners = surface->cut;
  }
  if (surface->triangle_count > UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "the mesh has more than 2^32 triangles");
  return surface->cut ? cut_polygons(surface->cut, surface->context, soup, error) : VXM_OK;
}

/* ---- Points ---- */

enum { SLICE_POINTS = 8192 };

typedef struct snap_job {
  const vxm_surface *surface;
  const double (*positions)[3];
  const vxm_kernels *kernels;
  vxm_affine affine;
  size_t slices;
  atomic_bool beyond; /**< a point does not fit, used or not */
} snap_job;

static void snap_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  snap_job *job = payload;
  size_t count = job->surface->soup->vertex_count, begin = vxm_slice_begin(count, job->slices, slice);
  size_t end = vxm_slice_begin(count, job->slices, slice + 1);
  if (!job->kernels->place(job->surface->narrow + begin, NULL, job->positions[begin], NULL, end - begin,
                           &job->affine))
    atomic_store_explicit(&job->beyond, true, memory_order_relaxed);
}

/** Whether all points fit. */
static bool snap_narrow(const vxm_surface *surface, const double (*positions)[3],
                        const double transform[12]) {
  static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const double *matrix = transform ? transform : identity;
  snap_job job = {.surface = surface,
                  .positions = positions,
                  .kernels = vxm_kernels_get(),
                  .affine = {.bits = surface->lattice.bits},
                  .slices = 1 + surface->soup->vertex_count / SLICE_POINTS};
  for (int a = 0; a < 3; a++) {
    for (int c = 0; c < 4; c++)
      job.affine.column[c][a] = matrix[4 * a + c];
    job.affine.origin[a] = surface->lattice.space.origin[a];
    job.affine.scale[a] = (double)surface->lattice.unit / surface->lattice.space.voxel_size[a];
  }
  vxm_parallel(surface->context, job.slices, snap_slice, &job);
  return !atomic_load(&job.beyond);
}

/** Marks a vertex that has no place on the lattice. */
static const int64_t off_lattice = INT64_MIN;

static vxm_status check_used(const vxm_surface *surface, const double (*positions)[3], vxm_error *error) {
  for (size_t c = 0; c < 3 * surface->triangle_count; c++) {
    uint32_t vertex = surface->corners[c];
    if (surface->wide[vertex].at[0] == off_lattice)
      return vxm_lattice_refuse(vertex, positions[vertex], error);
  }
  return VXM_OK;
}

static vxm_status snap_wide(vxm_surface *surface, const double (*positions)[3], const double transform[12],
                            vxm_error *error) {
  size_t count = surface->soup->vertex_count;
  vxm_free(surface->context, surface->narrow);
  surface->narrow = NULL;
  vxm_status status = VXM_OK;
  surface->wide = vxm_try_alloc(surface->context, count, sizeof *surface->wide, &status, error);
  if (!surface->wide)
    return status;
  bool is_off = false;
  for (size_t v = 0; v < count; v++) {
    double moved[3];
    const double *p = positions[v];
    if (transform) {
      vxm_transform_position(transform, p, moved);
      p = moved;
    }
    if (vxm_lattice_place(&surface->lattice, p, &surface->wide[v]))
      continue;
    surface->wide[v] = (vxm_point){{off_lattice, 0, 0}};
    is_off = true;
  }
  return is_off ? check_used(surface, positions, error) : VXM_OK;
}

static vxm_status place(vxm_surface *surface, const double (*positions)[3], const vxm_lattice *lattice,
                        const double transform[12], vxm_error *error) {
  static atomic_uint_fast64_t last_serial;
  vxm_status status = VXM_OK;
  surface->serial = atomic_fetch_add(&last_serial, 1) + 1;
  surface->lattice = *lattice;
  vxm_free(surface->context, surface->wide);
  surface->wide = NULL;
  if (!surface->narrow)
    surface->narrow =
        vxm_try_alloc(surface->context, surface->soup->vertex_count, sizeof *surface->narrow, &status, error);
  if (surface->narrow && !snap_narrow(surface, positions, transform))
    status = snap_wide(surface, positions, transform, error);
  return status;
}

vxm_status vxm_surface_place(vxm_surface *surface, const vxm_lattice *lattice, const double transform[12],
                             vxm_error *error) {
  return place(surface, (const double(*)[3])surface->soup->positions, lattice, transform, error);
}

vxm_status vxm_surface_place_moved(vxm_surface *surface, const double (*positions)[3],
                                   const vxm_lattice *lattice, vxm_error *error) {
  return place(surface, positions, lattice, NULL, error);
}

vxm_status vxm_surface_make(vxm_surface **out, vxm_context *context, const vxm_soup *soup, vxm_error *error) {
  *out = NULL;
  static atomic_uint_fast64_t last_corners;
  vxm_status status = VXM_OK;
  vxm_surface *surface = vxm_try_calloc(context, 1, sizeof *surface, &status, error);
  if (surface)
    status = vxm_context_acquire(&surface->context, context, error);
  if (status == VXM_OK) {
    surface->soup = soup;
    surface->corners_serial = atomic_fetch_add(&last_corners, 1) + 1;
    status = list_triangles(surface, soup, error);
  }
  if (status == VXM_OK) {
    *out = surface;
    return VXM_OK;
  }
  vxm_surface_destroy(surface);
  return status;
}

vxm_status vxm_surface_create(vxm_surface **out, const vxm_soup *soup, const vxm_lattice *lattice,
                              const double transform[12], vxm_error *error) {
  vxm_status status = vxm_surface_make(out, soup->context, soup, error);
  if (status == VXM_OK)
    status = vxm_surface_place(*out, lattice, transform, error);
  if (status != VXM_OK) {
    vxm_surface_destroy(*out);
    *out = NULL;
  }
  return status;
}

void vxm_surface_destroy(vxm_surface *surface) {
  if (!surface)
    return;
  vxm_context *context = surface->context;
  vxm_free(context, surface->narrow);
  vxm_free(context, surface->wide);
  vxm_free(context, surface->cut);
  vxm_free(context, surface);
  vxm_context_release(context);
}

/* ---- Onto a grid ---- */

/** Bytes of a window that is drawn beside the grid. */
enum { ASIDE_BYTES = 1 << 22 };

/** Joins a window drawn aside to the grid, and marks its voxels. */
static void join(const vxm_window *whole, const vxm_window *window, uint8_t *confidence) {
  uint64_t *to = vxm_window_row(whole, 0, window->begin);
  size_t rows = (size_t)((window->end - window->begin) * window->middle_dim);
  uint8_t *sure = confidence + (size_t)(window->begin * window->middle_dim * window->fast_dim);
  for (size_t r = 0; r < rows; r++, sure += window->fast_dim)
    for (size_t w = 0; w < window->row_words; w++) {
      uint64_t word = window->words[r * window->row_words + w];
      to[r * window->row_words + w] |= word;
      for (; word; word &= word - 1)
        sure[w * 64 + (size_t)__builtin_ctzll(word)] = 255;
    }
}

/* Which voxels the surface sets cannot be told in the grid any more, so they are drawn beside it first. */
vxm_status vxm_surface_add_sure(const vxm_surface *surface, const vxm_window *whole, vxm_surface_kind kind,
                                uint8_t *confidence, vxm_error *error) {
  int64_t slices = vxm_max(1, (int64_t)(ASIDE_BYTES / 8 / whole->slice_words)), dim = whole->slow_dim;
  vxm_window window = *whole;
  window.end = vxm_min(slices, dim);
  vxm_error local = VXM_ERROR_INIT;
  window.words =
      vxm_alloc(surface->context, (size_t)window.end * window.slice_words, sizeof *window.words, &local);
  vxm_status status = local.code;
  for (int64_t begin = 0; begin < dim && status == VXM_OK; begin += slices) {
    window.begin = begin;
    window.end = vxm_min(begin + slices, dim);
    status = vxm_surface_add(surface, &window, kind, true, &local);
    if (status == VXM_OK)
      join(whole, &window, confidence);
  }
  vxm_free(surface->context, window.words);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

uint64_t vxm_surface_held_bytes(const vxm_soup *soup, size_t *triangles) {
  *triangles = count_triangles(soup);
  uint64_t corners = has_triangles_only(soup) ? 0 : 3 * sizeof(uint32_t);
  return soup->vertex_count * sizeof(vxm_point) + *triangles * corners + sizeof(vxm_surface);
}

uint64_t vxm_surface_bytes(const vxm_soup *soup, int threads) {
  /* A place and, as tiles are listed in turn, some five entries for each triangle; the tiles
   * and counters of the threads. Or instead of both windows of threads, 4 MiB in all. */
  size_t triangles;
  uint64_t held = vxm_surface_held_bytes(soup, &triangles);
  return held + triangles * 6 * sizeof(uint32_t) + ((uint64_t)threads + 6) * (UINT64_C(1) << 20);
}
