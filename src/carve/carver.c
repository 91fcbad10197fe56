/* SPDX-License-Identifier: BSD-3-Clause */
/** Carvers are made and freed, and tools turned and put into the stock. */
#include "carve/carver.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum {
  EDGE_BITS = 19,       /**< of an edge of the tool, in lattice steps; with the path it stays below
                           VXM_CONVEX_BITS */
  BITS_MIN = 8,         /**< of a voxel, in lattice steps */
  PIECE_VOXELS = 2,     /**< of a straight path, unless the tool's faces are larger */
  STAMP_WORDS = 1 << 18 /**< of a window in which the tool is put into the stock */
};

/* ---- Making and freeing ---- */

/** Copies the triangles of faces and caps; corners are in an order that does not depend on how the mesh
 * numbers them, so that the quadrilateral that an edge sweeps is cut along the same diagonal for both its
 * faces. */
static vxm_status copy_triangles(vxm_carver *carver, vxm_error *error) {
  const vxm_triangle_set *set = &carver->model->analysis.triangles;
  vxm_status status = VXM_OK;
  carver->triangles =
      vxm_try_alloc(carver->context, set->triangle_count, sizeof *carver->triangles, &status, error);
  if (!carver->triangles)
    return status;
  for (size_t t = 0; t < set->triangle_count; t++) {
    if (vxm_role_of(set, t) == VXM_ROLE_CONE)
      continue;
    uint32_t *c = carver->triangles[carver->triangle_count++];
    memcpy(c, set->corners[t], sizeof set->corners[t]);
    for (int pass = 0; pass < 3; pass++) {
      uint32_t *pair = c + pass % 2, first = pair[0];
      const double *p = set->positions[pair[0]], *q = set->positions[pair[1]];
      int a = p[0] != q[0] ? 0 : p[1] != q[1] ? 1 : 2;
      if (p[a] > q[a]) {
        pair[0] = pair[1];
        pair[1] = first;
      }
    }
  }
  return VXM_OK;
}

/** Measures the tool in voxels. @return VXM_ERROR_RANGE for points that are not finite */
static vxm_status measure(vxm_carver *carver, double *longest, double *mean, vxm_error *error) {
  const vxm_triangle_set *set = &carver->model->analysis.triangles;
  const double *size = vxm_stock_space(&carver->stock)->voxel_size;
  double least = fmin(size[0], fmin(size[1], size[2])), sum = 0;
  *longest = 0;
  for (size_t p = 0; p < set->first_apex; p++) {
    const double *at = set->positions[p];
    double squared = at[0] * at[0] + at[1] * at[1] + at[2] * at[2];
    if (!isfinite(squared))
      return vxm_lattice_refuse(set->vertex[p], at, error);
    carver->reach = fmax(carver->reach, sqrt(squared) / least);
  }
  for (size_t t = 0; t < carver->triangle_count; t++)
    for (int e = 0; e < 3; e++) {
      const double *p = set->positions[carver->triangles[t][e]],
                   *q = set->positions[carver->triangles[t][(e + 1) % 3]];
      double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2], edge = sqrt(x * x + y * y + z * z) / least;
      *longest = fmax(*longest, edge);
      sum += edge;
    }
  *mean = sum / (3 * fmax(1, (double)carver->triangle_count));
  return VXM_OK;
}

/** Chooses a lattice on which faces and paths fit what is computed with. */
static vxm_status choose_lattice(vxm_carver *carver, vxm_error *error) {
  double longest = 0, mean = 0;
  vxm_status status = vxm_space_check_sizes(vxm_stock_space(&carver->stock), error);
  if (status == VXM_OK)
    status = measure(carver, &longest, &mean, error);
  if (status != VXM_OK)
    return status;
  carver->lattice = vxm_lattice_of(vxm_stock_space(&carver->stock));
  int bits = carver->lattice.bits;
  while (bits > BITS_MIN && ldexp(longest, bits) > ldexp(1, EDGE_BITS))
    bits--;
  if (ldexp(longest, bits) > ldexp(1, EDGE_BITS))
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "carver: an edge of the tool is %.6g voxels long; at most %d can be computed with",
                    longest, 1 << (EDGE_BITS - BITS_MIN));
  if (!(ldexp(carver->reach, bits) < (double)(VXM_LATTICE_MAX / 4)))
    return vxm_fail(error, VXM_ERROR_RANGE, "carver: the tool lies %.6g voxels from its origin",
                    carver->reach);
  carver->lattice.bits = bits;
  carver->lattice.unit = INT64_C(1) << bits;
  double piece = fmin(ldexp(fmax(PIECE_VOXELS, mean), bits), ldexp(1, EDGE_BITS - 1));
  carver->piece = (int64_t)piece;
  return VXM_OK;
}

static vxm_status make_room(vxm_carver *carver, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_context *context = carver->context;
  size_t count = carver->point_count;
  carver->from.at = vxm_alloc(context, count, sizeof *carver->from.at, &local);
  if (local.code == VXM_OK)
    carver->to.at = vxm_alloc(context, count, sizeof *carver->to.at, &local);
  if (local.code == VXM_OK)
    carver->moved = vxm_alloc(context, count, sizeof *carver->moved, &local);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

vxm_status vxm_carver_make(vxm_carver **out, vxm_context *context, const vxm_stock *stock,
                           const vxm_soup *tool, vxm_error *error) {
  vxm_context *own = NULL;
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = vxm_context_acquire(&own, context, error);
  if (status != VXM_OK)
    return status;
  vxm_carver *carver = vxm_calloc(own, 1, sizeof *carver, &local);
  if (!carver) {
    vxm_context_release(own);
    vxm_error_pass(error, &local);
    return local.code;
  }
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = VXM_THIN_DROP; /* what is cut are centres within the tool */
  carver->context = own;
  carver->stock = *stock;
  carver->instance.context = own;
  status = vxm_model_make(&carver->model, tool, &options, &local);
  if (status == VXM_OK) {
    carver->point_count = carver->model->analysis.triangles.first_apex;
    status = copy_triangles(carver, &local);
  }
  if (status == VXM_OK)
    status = choose_lattice(carver, &local);
  if (status == VXM_OK)
    status = make_room(carver, &local);
  if (status == VXM_OK)
    status = vxm_model_instance_prepare(carver->model, &local);
  if (status == VXM_OK)
    status = vxm_model_instance_attach(&carver->instance, carver->model, &local);
  if (status == VXM_OK) {
    *out = carver;
    return VXM_OK;
  }
  vxm_carver_destroy(carver);
  vxm_error_pass(error, &local);
  return status;
}

void vxm_carver_destroy(vxm_carver *carver) {
  if (!carver)
    return;
  vxm_context *context = carver->context;
  vxm_model_instance_destroy(&carver->instance);
  vxm_model_destroy(carver->model);
  vxm_stock_destroy(&carver->stock);
  vxm_free(context, carver->triangles);
  vxm_free(context, carver->from.at);
  vxm_free(context, carver->to.at);
  vxm_free(context, carver->moved);
  vxm_free(context, carver->words);
  vxm_free(context, carver);
  vxm_context_release(context);
}

/* ---- Putting the tool into the stock ---- */

/** Sets the points in a window whose first voxel is `begin`, as doubles that the lattice holds exactly. */
static void place_in_window(vxm_carver *carver, const int64_t place[3], const int64_t begin[3]) {
  for (size_t p = 0; p < carver->point_count; p++)
    for (int a = 0; a < 3; a++)
      carver->moved[p][a] = (double)(carver->from.at[p].at[a] + place[a] - begin[a] * carver->lattice.unit);
}

/** Voxelizes the tool in a window. */
static vxm_status fill_window(vxm_carver *carver, const vxm_window *window, const vxm_space *space,
                              vxm_error *error) {
  static const double unmoved[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  vxm_lattice lattice = {carver->lattice.bits, carver->lattice.unit, *space};
  vxm_variation variation = {
      .points = {.from = (const double(*)[3])carver->moved, .count = carver->point_count, .matrix = unmoved}};
  vxm_status status = vxm_model_instance_place(&carver->instance, &lattice, &variation, error);
  return status == VXM_OK ? vxm_model_pass_fill(&carver->instance.pass, window, error) : status;
}

static void clear_window(vxm_stock *stock, const vxm_window *window, const int64_t begin[3]) {
  for (int64_t k = 0; k < window->slow_dim; k++)
    for (int64_t j = 0; j < window->middle_dim; j++) {
      const uint64_t *row = vxm_window_row(window, j, k);
      for (size_t w = 0; w < window->row_words; w++)
        if (row[w])
          vxm_stock_clear(stock, begin[0] / 64 + (int64_t)w, begin[1] + j, begin[2] + k, row[w]);
    }
}

/** Cuts the voxels of a box that the tool has, whose first one is the first of its word. */
static vxm_status stamp_box(vxm_carver *carver, const int64_t place[3], const vxm_voxel_box *box,
                            vxm_error *error) {
  double unit = (double)carver->lattice.unit;
  vxm_space space = {.voxel_size = {unit, unit, unit}};
  for (int a = 0; a < 3; a++)
    space.dims[a] = box->last[a] - box->first[a] + 1;
  vxm_window window = vxm_window_of(&space, (vxm_layout)VXM_LAYOUT_GRID, 0, space.dims[2]);
  size_t words = window.slice_words * (size_t)space.dims[2];
  vxm_status status = vxm_renew(carver->context, (void **)&carver->words, &carver->word_capacity, words,
                                sizeof *carver->words, error);
  if (status != VXM_OK)
    return status;
  window.words = carver->words;
  place_in_window(carver, place, box->first);
  status = fill_window(carver, &window, &space, error);
  if (status == VXM_OK)
    clear_window(&carver->stock, &window, box->first);
  return status;
}

vxm_status vxm_carver_stamp(vxm_carver *carver, const vxm_tool_pose *pose, vxm_error *error) {
  int64_t place[3], low[3], high[3];
  vxm_status status = vxm_carver_steps(place, carver, pose, error);
  if (status != VXM_OK)
    return status;
  vxm_carver_turn(carver, &carver->from, pose);
  carver->from_pose = *pose;
  for (int a = 0; a < 3; a++) {
    low[a] = carver->from.low[a] + place[a];
    high[a] = carver->from.high[a] + place[a];
  }
  vxm_voxel_box box = vxm_voxel_box_of(&carver->lattice, low, high);
  if (!vxm_voxel_box_is_empty(&box)) {
    box.first[0] -= box.first[0] % 64;
    int64_t words = ((box.last[0] - box.first[0]) / 64 + 1) * (box.last[1] - box.first[1] + 1),
            slices = vxm_max(STAMP_WORDS / words, 1), end = box.last[2];
    for (int64_t k = box.first[2]; k <= end && status == VXM_OK; k += slices) {
      box.first[2] = k;
      box.last[2] = vxm_min(k + slices - 1, end);
      status = stamp_box(carver, place, &box, error);
    }
  }
  if (status == VXM_OK)
    status = carver->stock.status;
  if (status == VXM_OK) {
    carver->pose = *pose;
    carver->is_placed = true;
  }
  return status;
}
