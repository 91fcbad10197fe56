/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/fields/distance_nodes.h"
#include "voxel/fields/distance_band.h"
#include "voxel/model/model_report.h"
#include "voxel/sparse/sparse.h"
#include "voxel/thin/thin_sparse.h"

#include <math.h>

enum { SIDE = VXM_NODE_SIDE };

/** What a worker has of its own. */
typedef struct scratch {
  vxm_band_tally tally;
  vxm_band_tile *tile; /**< with clusters */
  uint32_t *near;
  vxm_search *search; /**< with a tree */
  double *squares;
} scratch;

struct vxm_distance_nodes {
  vxm_context *context;
  vxm_model *model;
  const vxm_space *space;
  vxm_model_pass *pass; /**< NULL without a sign */
  int separating;       /**< of the pass, before it was of centres alone */
  vxm_sparse *solid;    /**< NULL without a sign */
  vxm_distance_search search;
  const vxm_band_kernels *kernels;
  vxm_distance_bvh_tile_fn *find;
  vxm_node_boxes boxes; /**< of the clusters */
  scratch *scratches;
  int workers;
};

/* ---- A node ---- */

/** The squares of a node by the clusters; false if none is near. */
static bool measure_by_clusters(vxm_distance_nodes *n, int worker, const int64_t at[3]) {
  const vxm_band_clusters *clusters = n->search.clusters;
  const uint32_t *row = n->boxes.row + (size_t)worker * n->boxes.count;
  scratch *d = &n->scratches[worker];
  if (n->boxes.row_count[worker] == 0)
    return false;
  for (int a = 0; a < 3; a++) {
    d->tile->first[a] = at[a];
    d->tile->count[a] = vxm_node_count(n->space, at, a);
  }
  size_t found = vxm_distance_band_near(clusters, d->near, row, n->boxes.row_count[worker], d->tile);
  if (found > 0)
    n->kernels->measure(d->tile, clusters, d->near, found);
  return found > 0;
}

/** The same by the tree. */
static bool measure_by_tree(vxm_distance_nodes *n, int worker, const int64_t at[3]) {
  vxm_point_block tile = {.max_distance = n->search.band};
  for (int a = 0; a < 3; a++) {
    tile.first[a] = at[a];
    tile.count[a] = vxm_node_count(n->space, at, a);
    tile.step[a] = n->space->voxel_size[a] / n->search.side;
  }
  return n->find(n->scratches[worker].search, n->scratches[worker].squares, &tile);
}

/** The values of a node that has been measured by the tree. */
static void finish_tree(const vxm_distance_nodes *n, int worker, const int64_t at[3], float *values,
                        const uint64_t *rows) {
  scratch *d = &n->scratches[worker];
  const int count = vxm_node_count(n->space, at, 0);
  for (int z = 0; z < vxm_node_count(n->space, at, 2); z++)
    for (int y = 0; y < vxm_node_count(n->space, at, 1); y++) {
      const size_t row = (size_t)(SIDE * z + y);
      d->tally.inside += vxm_popcount(rows[row]);
      vxm_distance_finish(&n->search, values + SIDE * row, d->squares + VXM_BVH_TILE * row, 1, rows[row],
                          count, &d->tally);
    }
}

static bool make_node(void *payload, int worker, const int64_t at[3], void *values) {
  vxm_distance_nodes *n = payload;
  scratch *d = &n->scratches[worker];
  uint64_t rows[SIDE * SIDE] = {0};
  const int64_t count[3] = {vxm_node_count(n->space, at, 0), vxm_node_count(n->space, at, 1),
                            vxm_node_count(n->space, at, 2)};
  vxm_band_values out = {.values = values,
                         .row = SIDE,
                         .slice = (size_t)SIDE * SIDE,
                         .words = n->solid ? rows : NULL,
                         .row_words = 1,
                         .slice_words = SIDE,
                         .band = n->search.band,
                         .side = n->search.side};
  bool is_alike = !n->solid || vxm_node_bits(rows, n->solid, at);
  bool is_near = n->search.clusters ? measure_by_clusters(n, worker, at) : measure_by_tree(n, worker, at);
  if (is_near && n->search.clusters)
    n->kernels->finish(&out, d->tile, &d->tally);
  else if (is_near)
    finish_tree(n, worker, at, values, rows);
  else if (is_alike) {
    const int64_t one[3] = {1, 1, 1};
    n->kernels->fill(&out, one, &d->tally);
    d->tally.inside += (int64_t)(rows[0] & 1) * (count[0] * count[1] * count[2] - 1);
    return true;
  } else
    n->kernels->fill(&out, count, &d->tally);
  return false;
}

vxm_node_maker vxm_distance_nodes_maker(vxm_distance_nodes *nodes) {
  return (vxm_node_maker){.boxes = nodes->search.clusters ? &nodes->boxes : NULL,
                          .make = make_node,
                          .payload = nodes,
                          .phase = "measuring distances"};
}

/* ---- Before and after ---- */

static vxm_status list_clusters(vxm_distance_nodes *n, vxm_error *error) {
  const vxm_band_clusters *clusters = n->search.clusters;
  vxm_status status = vxm_node_boxes_create(&n->boxes, n->context, clusters->count, error);
  for (size_t i = 0; i < clusters->count && status == VXM_OK; i++)
    for (int a = 0; a < 3; a++)
      for (int end = 0; end < 2; end++) {
        bool is_empty = clusters->clusters[i].box[0][0] >= clusters->clusters[i].box[0][1];
        n->boxes.box[i][a][end] = is_empty ? 0 : clusters->clusters[i].box[a][end];
      }
  return status;
}

static vxm_status make_scratches(vxm_distance_nodes *n, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  n->scratches = vxm_calloc(n->context, (size_t)n->workers, sizeof *n->scratches, &local);
  for (int w = 0; w < n->workers && local.code == VXM_OK; w++) {
    scratch *d = &n->scratches[w];
    d->tally = (vxm_band_tally){.min = INFINITY, .max = -INFINITY};
    if (n->search.clusters) {
      d->tile = vxm_alloc(n->context, 1, sizeof *d->tile, &local);
      d->near = vxm_alloc(n->context, n->boxes.count, sizeof *d->near, &local);
    } else if (vxm_search_create(&d->search, n->search.tree, &local) == VXM_OK)
      d->squares = vxm_alloc(n->context, VXM_BVH_TILE_POINTS, sizeof *d->squares, &local);
  }
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

/** The solid of voxel centres alone. */
static vxm_status make_solid(vxm_distance_nodes *n, vxm_error *error) {
  vxm_status status = vxm_model_begin(&n->pass, n->model, n->space, NULL, NULL, error);
  if (status != VXM_OK)
    return status;
  n->separating = n->pass->separating;
  vxm_model_pass_make_field(n->pass);
  return vxm_sparse_of_pass(&n->solid, n->model, n->pass, error);
}

uint64_t vxm_distance_nodes_bytes(const vxm_model *model, const vxm_distance_options *options) {
  size_t triangles;
  int workers = vxm_context_threads(model->context);
  uint64_t bytes = vxm_distance_search_bytes(model->analysis.soup, options, &triangles);
  uint64_t each = vxm_distance_is_narrow(options)
                      ? sizeof(vxm_band_tile) + triangles * sizeof(uint32_t)
                      : vxm_distance_bvh_search_bytes(triangles) + VXM_BVH_TILE_POINTS * sizeof(double);
  if (vxm_distance_is_narrow(options))
    bytes += vxm_node_boxes_bytes(triangles, workers);
  return bytes + (uint64_t)workers * (sizeof(scratch) + each);
}

static vxm_status make(vxm_distance_nodes *n, const vxm_distance_options *options, vxm_error *error) {
  const vxm_layout layout = VXM_LAYOUT_GRID;
  vxm_status status =
      vxm_memory_check(n->context, vxm_distance_nodes_bytes(n->model, options), "distances", error);
  if (status == VXM_OK && !options->is_unsigned)
    status = make_solid(n, error);
  if (status == VXM_OK)
    status = vxm_distance_search_create(&n->search, n->context, n->model->analysis.soup, n->space, layout,
                                        options, error);
  if (status == VXM_OK && n->search.clusters)
    status = list_clusters(n, error);
  return status == VXM_OK ? make_scratches(n, error) : status;
}

vxm_status vxm_distance_nodes_create(vxm_distance_nodes **out, vxm_model *model, const vxm_space *space,
                                     const vxm_distance_options *options, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_distance_nodes *n = vxm_calloc(model->context, 1, sizeof *n, &local);
  vxm_status status = local.code;
  if (n) {
    n->context = n->search.context = n->boxes.context = model->context;
    n->model = model;
    n->space = space;
    n->workers = vxm_context_threads(model->context);
    n->kernels = vxm_band_kernels_best();
    n->find = vxm_distance_bvh_tile_best();
    status = make(n, options, &local);
  }
  if (status != VXM_OK) {
    vxm_distance_nodes_destroy(n);
    vxm_error_pass(error, &local);
    n = NULL;
  }
  *out = n;
  return status;
}

void vxm_distance_nodes_destroy(vxm_distance_nodes *n) {
  if (!n)
    return;
  vxm_model_close(n->model, n->pass);
  for (int w = 0; n->scratches && w < n->workers; w++) {
    vxm_free(n->context, n->scratches[w].tile);
    vxm_free(n->context, n->scratches[w].near);
    vxm_search_destroy(n->scratches[w].search);
    vxm_free(n->context, n->scratches[w].squares);
  }
  vxm_free(n->context, n->scratches);
  vxm_node_boxes_destroy(&n->boxes);
  vxm_distance_search_destroy(&n->search);
  vxm_sparse_destroy(n->solid);
  vxm_free(n->context, n);
}

/** Finds out how much of the surface has no inside in the grid, for a warning. */
static vxm_status look_for_thin(vxm_distance_nodes *n, vxm_error *error) {
  const vxm_voxel_pass *solid = &n->pass->solid;
  vxm_error local = VXM_ERROR_INIT;
  if (n->separating == 0)
    return VXM_OK;
  vxm_thin_add_sparse(&n->pass->thin.thin, &n->solid, &solid->analysis->triangles, &solid->placed,
                      n->separating, &local);
  if (local.code != VXM_ERROR_CANCELLED) /* nothing that memory is short for */
    return VXM_OK;
  vxm_error_pass(error, &local);
  return local.code;
}

vxm_status vxm_distance_nodes_report(vxm_distance_report *report, vxm_distance_nodes *n, vxm_error *error) {
  int64_t inside = 0;
  *report = (vxm_distance_report){.voxelize = report->voxelize, .min = INFINITY, .max = -INFINITY};
  for (int w = 0; w < n->workers; w++) {
    const vxm_band_tally *t = &n->scratches[w].tally;
    report->exact += t->exact;
    report->min = fmin(report->min, (double)t->min);
    report->max = fmax(report->max, (double)t->max);
    inside += t->inside;
  }
  vxm_status status = n->pass ? look_for_thin(n, error) : VXM_OK;
  if (status == VXM_OK && n->pass)
    vxm_model_report(n->pass, report->voxelize, inside, 0);
  return status;
}
