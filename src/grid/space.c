/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/space.h"
#include "base/exact_math.h"
#include "grid/bitgrid.h"
#include "mesh/unit_scale.h"

#include <inttypes.h>
#include <math.h>

/** A model side that is a whole number of voxels must not gain one through rounding. */
static const double rounding_slack = 1e-9;

typedef struct box {
  double low[3], high[3];
} box;

static double extent(const box *b, int axis) {
  return b->high[axis] - b->low[axis];
}

static double longest(const box *b) {
  return fmax(extent(b, 0), fmax(extent(b, 1), extent(b, 2)));
}

static double diagonal(const box *b) {
  return vxm_length3(extent(b, 0), extent(b, 1), extent(b, 2));
}

/** Box of the finite vertices that faces use. */
static vxm_status box_of_soup(box *out, const vxm_soup *soup, vxm_error *error) {
  vxm_extent extent;
  vxm_status status = vxm_extent_find(&extent, soup->context, soup, error);
  if (status != VXM_OK)
    return status;
  for (int a = 0; a < 3; a++) {
    out->low[a] = extent.bounds[a];
    out->high[a] = extent.bounds[a + 3];
  }
  return VXM_OK;
}

/** Voxels of size `size` needed for a length; at least 1, and at most more than any grid may have. */
static int64_t voxels_for(double length, double size) {
  double count = ceil(length / size * (1 - rounding_slack));
  if (!(count >= 1))
    return 1;
  return count < (double)(2 * VXM_DIM_MAX) ? (int64_t)count : 2 * VXM_DIM_MAX;
}

/** What the options ask for, taken apart. */
typedef struct request {
  bool by_size;       /**< voxel sizes are given rather than a resolution */
  double sizes[3];    /**< the voxel sizes */
  bool one_number;    /**< the resolution is one number, for the longest side */
  int64_t voxels[3];  /**< the resolution */
  int64_t content[3]; /**< the resolution without the pad */
} request;

/** One size for all axes, or three. */
static vxm_status read_sizes(request *out, const vxm_space_options *o, vxm_error *error) {
  const double *s = o->voxel_sizes;
  bool three = s[0] != 0 || s[1] != 0 || s[2] != 0;
  if (three && o->voxel_size != 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "both one voxel size and three are given; choose");
  out->by_size = three || o->voxel_size != 0;
  for (int a = 0; a < 3; a++) {
    out->sizes[a] = three ? s[a] : o->voxel_size;
    if (out->by_size && !(isfinite(out->sizes[a]) && out->sizes[a] > 0))
      return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxel size %g; it must be positive", out->sizes[a]);
  }
  return VXM_OK;
}

static vxm_status read_request(request *out, const vxm_space_options *o, vxm_error *error) {
  const int64_t *r = o->resolution;
  bool none = r[0] == 0 && r[1] == 0 && r[2] == 0;
  bool one = r[0] > 0 && r[1] == 0 && r[2] == 0;
  bool three = r[0] > 0 && r[1] > 0 && r[2] > 0;
  if (!none && !one && !three)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "resolution %" PRId64 "x%" PRId64 "x%" PRId64
                    "; give one number or three, each at least 1",
                    r[0], r[1], r[2]);
  vxm_status status = read_sizes(out, o, error);
  if (status != VXM_OK)
    return status;
  if (out->by_size && !none)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "both a resolution and a voxel size are given; choose one");
  if (o->pad < 0 || o->pad > VXM_DIM_MAX)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "pad %" PRId64 "; it must be 0 or more voxels", o->pad);
  out->one_number = !three;
  for (int a = 0; a < 3; a++) {
    out->voxels[a] = none ? 128 : one ? r[0] : r[a];
    if (out->voxels[a] > VXM_DIM_MAX)
      return vxm_fail(error, VXM_ERROR_RANGE, "%" PRId64 " voxels along an axis; at most %" PRId64,
                      out->voxels[a], VXM_DIM_MAX);
    out->content[a] = out->voxels[a] - 2 * o->pad;
    if (!out->by_size && out->content[a] < 1)
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "a pad of %" PRId64 " voxels on both sides leaves nothing of %" PRId64
                      "; raise the resolution",
                      o->pad, out->voxels[a]);
  }
  return VXM_OK;
}

/** The sizes that are asked for, or else cubes. */
static void set_sizes(vxm_space *space, const request *r, double size) {
  for (int a = 0; a < 3; a++)
    space->voxel_size[a] = r->by_size ? r->sizes[a] : size;
}

/** Whether what is divided by a resolution is large enough for it. */
static vxm_status check_divided(const request *r, double size, const char *text, vxm_error *error) {
  if (r->by_size || size >= VXM_VOXEL_SIZE_MIN)
    return VXM_OK;
  return vxm_fail(error, VXM_ERROR_RANGE, "%s", text);
}

/** Cells that cover a box from its minimum corner on; three numbers divide each side exactly. */
static vxm_status cover_bounds(vxm_space *out, const box *b, const request *r, vxm_error *error) {
  for (int a = 0; a < 3; a++)
    if (!isfinite(b->low[a]) || !isfinite(b->high[a]) || !(extent(b, a) > 0) || !isfinite(extent(b, a)))
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "bounds %g to %g along %c; the second corner must lie beyond the first", b->low[a],
                      b->high[a], "xyz"[a]);
  set_sizes(out, r, longest(b) / (double)r->voxels[0]);
  for (int a = 0; a < 3; a++) {
    if (!r->by_size && !r->one_number)
      out->voxel_size[a] = extent(b, a) / (double)r->voxels[a];
    out->dims[a] =
        !r->by_size && !r->one_number ? r->voxels[a] : voxels_for(extent(b, a), out->voxel_size[a]);
    out->origin[a] = b->low[a];
    vxm_status status = check_divided(
        r, out->voxel_size[a],
        "the bounds are too small to be divided into voxels; scale them and the model up", error);
    if (status != VXM_OK)
      return status;
  }
  return vxm_space_check(out, error);
}

/** Size of cubic voxels with which the model fills the content of the grid. */
static double fitted_size(const box *b, const request *r, vxm_fit fit) {
  double size = 0;
  for (int a = 0; a < 3; a++) {
    double side = fit == VXM_FIT_SPHERE ? diagonal(b) : r->one_number ? longest(b) : extent(b, a);
    size = fmax(size, side / (double)r->content[a]);
  }
  return size;
}

static vxm_status fit_model(vxm_space *out, const box *b, const request *r, const vxm_space_options *o,
                            vxm_error *error) {
  set_sizes(out, r, fitted_size(b, r, o->fit));
  for (int a = 0; a < 3; a++) {
    double size = out->voxel_size[a];
    vxm_status status =
        check_divided(r, size, "the model is too small to be divided into voxels; scale it up", error);
    if (status != VXM_OK)
      return status;
    double side = o->fit == VXM_FIT_TIGHT    ? extent(b, a)
                  : o->fit == VXM_FIT_SPHERE ? diagonal(b)
                                             : longest(b);
    bool from_model = r->by_size || (o->fit == VXM_FIT_TIGHT && r->one_number);
    out->dims[a] = from_model ? voxels_for(side, size) + 2 * o->pad : r->voxels[a];
    /* Halves first: the sum of two huge corners could overflow. */
    out->origin[a] = (b->low[a] / 2 + b->high[a] / 2) - (double)out->dims[a] * size / 2;
    if (!isfinite(out->origin[a]))
      return vxm_fail(error, VXM_ERROR_RANGE,
                      "the grid would reach beyond the largest number; scale the model down");
  }
  return vxm_space_check(out, error);
}

static vxm_status choose(vxm_space *out, const vxm_soup *soup, const vxm_space_options *options,
                         vxm_error *error) {
  if (options->like) {
    *out = *options->like;
    return vxm_space_check(out, error);
  }
  if ((unsigned)options->fit > VXM_FIT_SPHERE)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxel space: fit %d is unknown", (int)options->fit);
  request wanted = {0};
  vxm_status status = read_request(&wanted, options, error);
  if (status != VXM_OK)
    return status;
  box b = {{0}, {0}};
  if (options->use_bounds) {
    if (options->pad != 0)
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "bounds say what is covered, and take no pad; widen the bounds instead");
    for (int a = 0; a < 3; a++) {
      b.low[a] = options->bounds[a];
      b.high[a] = options->bounds[a + 3];
    }
    return cover_bounds(out, &b, &wanted, error);
  }
  status = box_of_soup(&b, soup, error);
  if (status != VXM_OK)
    return status;
  if (!(longest(&b) > 0))
    return vxm_fail(
        error, VXM_ERROR_EMPTY,
        "the mesh has no faces with finite vertices, or all of them lie in one point, so there is nothing "
        "to voxelize");
  if (!isfinite(diagonal(&b)))
    return vxm_fail(error, VXM_ERROR_RANGE, "the model is larger than the largest number; scale it down");
  return fit_model(out, &b, &wanted, options, error);
}

vxm_status vxm_space_choose(vxm_space *out, const vxm_soup *soup, const vxm_space_options *options,
                            vxm_error *error) {
  vxm_status status = choose(out, soup, options, error);
  return status == VXM_OK ? vxm_space_check_sizes(out, error) : status;
}

double vxm_space_longest_side(const vxm_space *space) {
  double longest = 0;
  for (int a = 0; a < 3; a++)
    longest = fmax(longest, (double)space->dims[a] * space->voxel_size[a]);
  return longest;
}
