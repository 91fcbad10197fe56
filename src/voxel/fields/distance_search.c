/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/fields/distance_search.h"
#include "base/threads.h"

#include <math.h>
#include <string.h>

/** Bands up to that are measured from the triangles; wider ones, and all of space, by the tree. */
static const double widest_band = 6;

/** The side of a voxel that a band is counted in. */
static double longest_side(const vxm_space *space) {
  const double *size = space->voxel_size;
  return fmax(fmax(size[0], size[1]), size[2]);
}

float vxm_distance_limit(const vxm_distance_options *options, const vxm_space *space) {
  return (float)((options->band > 0 ? options->band : INFINITY) * longest_side(space));
}

bool vxm_distance_is_narrow(const vxm_distance_options *options) {
  return options->band > 0 && options->band <= widest_band;
}

/* ---- Triangles ---- */

enum { PLACE_TASKS = 64 };

static void place_vertices(size_t task, int worker, void *payload) {
  (void)worker;
  const vxm_distance_search *s = payload;
  const vxm_soup *soup = s->surface->soup;
  size_t end = vxm_slice_begin(soup->vertex_count, PLACE_TASKS, task + 1);
  for (size_t v = vxm_slice_begin(soup->vertex_count, PLACE_TASKS, task); v < end; v++)
    for (int a = 0; a < 3; a++)
      s->places[v][a] = (vxm_position(soup, v)[a] - s->space->origin[a]) / s->side;
}

static void corners_of(double out[3][3], size_t triangle, const void *payload) {
  const vxm_distance_search *s = payload;
  for (size_t c = 0; c < 3; c++)
    memcpy(out[c], s->places[s->surface->corners[3 * triangle + c]], sizeof out[c]);
}

/** For distances within a narrow band. */
static void make_clusters(vxm_distance_search *s, vxm_error *error) {
  vxm_band_grid grid = {.band = s->band};
  for (int a = 0; a < 3; a++) {
    grid.axes[a] = s->axes[a];
    grid.dims[a] = s->space->dims[s->axes[a]];
    grid.step[a] = s->space->voxel_size[a] / s->side;
  }
  const vxm_band_soup soup = {(const double(*)[3])s->places,
                              (const uint32_t(*)[3])(const void *)s->surface->corners,
                              s->surface->triangle_count};
  vxm_band_clusters_create(&s->clusters, s->context, &soup, &grid, error);
}

static vxm_status take_triangles(vxm_distance_search *s, bool is_narrow, vxm_error *error) {
  vxm_context *context = s->context;
  vxm_error local = VXM_ERROR_INIT;
  s->places = vxm_alloc(context, s->surface->soup->vertex_count, sizeof *s->places, &local);
  if (s->places) {
    vxm_parallel(context, PLACE_TASKS, place_vertices, s);
    if (is_narrow)
      make_clusters(s, &local);
    else
      vxm_distance_bvh_create(&s->tree, context, s->surface->triangle_count, corners_of, s, &local);
  }
  if (!is_narrow) {
    vxm_free(context, s->places);
    s->places = NULL;
  }
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

vxm_status vxm_distance_search_create(vxm_distance_search *out, vxm_context *context, const vxm_soup *soup,
                                      const vxm_space *space, vxm_layout layout,
                                      const vxm_distance_options *options, vxm_error *error) {
  vxm_lattice lattice = vxm_lattice_of(space);
  *out = (vxm_distance_search){.context = context,
                               .space = space,
                               .axes = {layout.fast, layout.middle, layout.slow},
                               .side = longest_side(space),
                               .band = options->band > 0 ? options->band : INFINITY};
  vxm_status status = vxm_surface_create(&out->surface, soup, &lattice, NULL, error);
  return status == VXM_OK ? take_triangles(out, vxm_distance_is_narrow(options), error) : status;
}

void vxm_distance_search_destroy(vxm_distance_search *search) {
  vxm_band_clusters_destroy(search->clusters);
  vxm_free(search->context, search->places);
  vxm_distance_bvh_destroy(search->tree);
  vxm_surface_destroy(search->surface);
  *search = (vxm_distance_search){.context = search->context};
}

uint64_t vxm_distance_search_bytes(const vxm_soup *soup, const vxm_distance_options *options,
                                   size_t *triangles) {
  uint64_t held = vxm_surface_held_bytes(soup, triangles) + soup->vertex_count * sizeof(double[3]);
  return held + (vxm_distance_is_narrow(options) ? vxm_band_clusters_bytes(*triangles)
                                                 : vxm_distance_bvh_bytes(*triangles));
}

/* ---- Values ---- */

void vxm_distance_finish(const vxm_distance_search *search, float *values, const double *squares,
                         ptrdiff_t stride, uint64_t inside, int count, vxm_band_tally *tally) {
  for (int i = 0; i < count; i++) {
    double distance = sqrt(squares[i * stride]);
    tally->exact += distance < search->band;
    float value = (float)((distance < search->band ? distance : search->band) * search->side);
    values[i] = inside >> i & 1 ? -value : value;
    vxm_band_tally_add(tally, values[i]);
  }
}
