/* SPDX-License-Identifier: BSD-3-Clause */
/** Parts that do not meet can be made in one pass: their parities do not mix. */
#include "gpu/common/disjoint_passes.h"

#include <string.h>

enum {
  CELLS = 32, /**< along each axis: one bit of a word for each along bits */
  PARTS_PER_PROGRESS = 1024
};

typedef struct division {
  vxm_context *context;
  const vxm_window *window;
  const vxm_parity_union_job *job;
  int64_t margin;
  size_t most; /**< passes */
  bool is_over;
  vxm_pass_box *boxes;              /**< of each part */
  uint32_t (*taken)[CELLS * CELLS]; /**< cells of each pass in which a part has its box */
  size_t taken_capacity;
  vxm_disjoint_passes *passes;
} division;

/** Where the triangles of a part that count lie; of one part they are two ranges at most. */
static void ranges_of(const vxm_parity_union_job *job, size_t part, size_t begin[2], size_t end[2]) {
  const vxm_part *p = &job->triangles->parts[part];
  bool caps = (job->roles & VXM_ROLE_CAP) != 0, cones = (job->roles & VXM_ROLE_CONE) != 0;
  begin[0] = p->begin;
  end[0] = caps ? p->cones : p->caps;
  begin[1] = p->cones;
  end[1] = cones ? p->end : p->cones;
}

static bool is_closed(const vxm_parity_union_job *job, size_t part) {
  const vxm_split *split = &job->triangles->split;
  return part < split->kind_end[VXM_PART_CLOSED] || (job->roles & VXM_ROLE_CONE) ||
         (part < split->kind_end[VXM_PART_CAPPED] && (job->roles & VXM_ROLE_CAP));
}

static vxm_pass_box box_of(const division *d, size_t part) {
  const vxm_parity_union_job *job = d->job;
  const vxm_layout *layout = &d->window->layout;
  const int axes[3] = {layout->fast, layout->middle, layout->slow};
  int64_t low[3] = {INT64_MAX, INT64_MAX, INT64_MAX}, high[3] = {INT64_MIN, INT64_MIN, INT64_MIN};
  size_t begin[2], end[2];
  ranges_of(job, part, begin, end);
  for (int r = 0; r < 2; r++)
    for (size_t f = begin[r]; f < end[r]; f++)
      for (int c = 0; c < 3; c++) {
        vxm_point p = vxm_snapped_points_at(job->placed, job->triangles->corners[f][c]);
        for (int a = 0; a < 3; a++) {
          low[a] = vxm_min(low[a], p.at[a]);
          high[a] = vxm_max(high[a], p.at[a]);
        }
      }
  vxm_pass_box out = {.part = (uint32_t)part, .row_bits = (uint32_t)(64 * d->window->row_words)};
  for (int i = 0; i < 3 && low[0] <= high[0]; i++) {
    int a = axes[i];
    int64_t dim = d->window->layout.fast == a     ? d->window->fast_dim
                  : d->window->layout.middle == a ? d->window->middle_dim
                                                  : d->window->slow_dim;
    int64_t first = vxm_lattice_first(&job->placed->lattice, low[a]);
    int64_t last = vxm_lattice_first(&job->placed->lattice, high[a]);
    first -= d->margin;
    last += d->margin;
    if (a == job->axis) /* what an open part flips stays flipped up to the end */
      last = is_closed(job, part) ? last + 2 : dim;
    out.first[i] = (uint32_t)vxm_min(vxm_max(first, 0), dim);
    out.last[i] = (uint32_t)vxm_min(vxm_max(last, 0), dim);
  }
  return out;
}

static bool is_empty(const vxm_pass_box *b) {
  return b->first[0] >= b->last[0] || b->first[1] >= b->last[1] || b->first[2] >= b->last[2];
}

/** The cells of a box: a mask along bits, ranges along rows and slices. */
static uint32_t cells_of(const division *d, const vxm_pass_box *b, size_t first[2], size_t last[2]) {
  const int64_t dims[3] = {d->window->fast_dim, d->window->middle_dim, d->window->slow_dim};
  size_t cell[3][2];
  for (int i = 0; i < 3; i++) {
    int64_t size = (dims[i] + CELLS - 1) / CELLS;
    cell[i][0] = (size_t)(b->first[i] / size);
    cell[i][1] = (size_t)((b->last[i] - 1) / size);
  }
  for (int i = 0; i < 2; i++) {
    first[i] = cell[i + 1][0];
    last[i] = cell[i + 1][1];
  }
  return (uint32_t)(vxm_low_bits((unsigned)cell[0][1] + 1) & ~vxm_low_bits((unsigned)cell[0][0]));
}

static bool is_free(const uint32_t *taken, uint32_t mask, const size_t first[2], const size_t last[2]) {
  for (size_t k = first[1]; k <= last[1]; k++)
    for (size_t j = first[0]; j <= last[0]; j++)
      if (taken[k * CELLS + j] & mask)
        return false;
  return true;
}

/** Finds the first pass in which the box meets no other one, or begins a pass. */
static vxm_status find_pass(division *d, size_t index, vxm_error *error) {
  vxm_disjoint_passes *passes = d->passes;
  const vxm_pass_box *b = &d->boxes[index];
  size_t first[2], last[2], pass = 0;
  if (is_empty(b)) { /* it flips nothing; any pass will do */
    passes->pass_of[index] = 0;
    return VXM_OK;
  }
  uint32_t mask = cells_of(d, b, first, last);
  while (pass < passes->count && !is_free(d->taken[pass], mask, first, last))
    pass++;
  d->is_over = pass == d->most;
  if (d->is_over)
    return VXM_OK;
  if (pass == passes->count) {
    vxm_status status =
        vxm_grow(d->context, (void **)&d->taken, &d->taken_capacity, pass + 1, sizeof *d->taken, error);
    if (status != VXM_OK)
      return status;
    memset(d->taken[pass], 0, sizeof d->taken[pass]);
    passes->count++;
  }
  for (size_t k = first[1]; k <= last[1]; k++)
    for (size_t j = first[0]; j <= last[0]; j++)
      d->taken[pass][k * CELLS + j] |= mask;
  passes->pass_of[index] = (uint32_t)pass;
  return VXM_OK;
}

/** Lists the triangles of each pass, or finds that they lie one behind the other. */
static vxm_status list_triangles(division *d, vxm_error *error) {
  vxm_disjoint_passes *passes = d->passes;
  const vxm_parity_union_job *job = d->job;
  size_t begin[2], end[2], parts = job->part_end - job->part_begin, total = 0, at = 0;
  if (parts == 1) {
    ranges_of(job, job->part_begin, begin, end);
    if (begin[1] == end[1] || end[0] == begin[1]) {
      passes->first = begin[0];
      passes->triangle_end[0] = begin[1] == end[1] ? end[0] - begin[0] : end[1] - begin[0];
      return VXM_OK;
    }
  }
  passes->ordered = true;
  for (size_t i = 0; i < parts; i++) {
    ranges_of(job, job->part_begin + i, begin, end);
    total += end[0] - begin[0] + (end[1] - begin[1]);
  }
  vxm_status status = VXM_OK;
  uint32_t *order = vxm_try_alloc(d->context, total, sizeof *order, &status, error);
  if (!order)
    return status;
  /* The place of each part's triangles: those of the passes before it, then of the parts before it. */
  memset(passes->triangle_end, 0, passes->count * sizeof *passes->triangle_end);
  for (size_t i = 0; i < parts; i++) {
    ranges_of(job, job->part_begin + i, begin, end);
    passes->triangle_end[passes->pass_of[i]] += end[0] - begin[0] + (end[1] - begin[1]);
  }
  for (size_t p = 0; p < passes->count; p++) {
    size_t size = passes->triangle_end[p];
    passes->triangle_end[p] = at;
    at += size;
  }
  for (size_t i = 0; i < parts; i++) {
    size_t *to = &passes->triangle_end[passes->pass_of[i]];
    ranges_of(job, job->part_begin + i, begin, end);
    for (int r = 0; r < 2; r++)
      for (size_t f = begin[r]; f < end[r]; f++)
        order[(*to)++] = (uint32_t)f;
  }
  passes->order = order;
  passes->order_count = total;
  return VXM_OK;
}

/** Puts the boxes that are not empty pass after pass. */
static vxm_status list_boxes(division *d, vxm_error *error) {
  vxm_disjoint_passes *passes = d->passes;
  size_t parts = d->job->part_end - d->job->part_begin, at = 0;
  vxm_status status = VXM_OK;
  vxm_pass_box *sorted = vxm_try_alloc(d->context, parts, sizeof *sorted, &status, error);
  if (!sorted)
    return status;
  memset(passes->box_end, 0, passes->count * sizeof *passes->box_end);
  for (size_t i = 0; i < parts; i++)
    passes->box_end[passes->pass_of[i]] += !is_empty(&d->boxes[i]);
  for (size_t p = 0; p < passes->count; p++) {
    size_t size = passes->box_end[p];
    passes->box_end[p] = at;
    at += size;
  }
  for (size_t i = 0; i < parts; i++)
    if (!is_empty(&d->boxes[i]))
      sorted[passes->box_end[passes->pass_of[i]]++] = d->boxes[i];
  passes->boxes = sorted;
  passes->box_count = at;
  return VXM_OK;
}

static vxm_status divide(division *d, vxm_error *error) {
  vxm_disjoint_passes *passes = d->passes;
  vxm_context *context = d->context;
  size_t parts = d->job->part_end - d->job->part_begin;
  vxm_status status = VXM_OK;
  passes->pass_of = vxm_try_calloc(context, parts, sizeof *passes->pass_of, &status, error);
  d->boxes = passes->pass_of ? vxm_try_alloc(context, parts, sizeof *d->boxes, &status, error) : NULL;
  if (!d->boxes)
    return status;
  for (size_t i = 0; i < parts && status == VXM_OK && !d->is_over; i++) {
    d->boxes[i] = box_of(d, d->job->part_begin + i);
    status = find_pass(d, i, error);
    if (status == VXM_OK && i % PARTS_PER_PROGRESS == 0) /* many that meet take long */
      status = vxm_progress(context, d->job->phase, 0.0, error);
  }
  if (status != VXM_OK || d->is_over) {
    passes->count = 0;
    return status;
  }
  passes->count = passes->count > 0 ? passes->count : 1;
  passes->triangle_end = vxm_try_alloc(context, passes->count, sizeof *passes->triangle_end, &status, error);
  passes->box_end = passes->triangle_end
                        ? vxm_try_alloc(context, passes->count, sizeof *passes->box_end, &status, error)
                        : NULL;
  if (!passes->box_end)
    return status;
  status = list_triangles(d, error);
  return status == VXM_OK && d->job->has_voxels ? list_boxes(d, error) : status;
}

vxm_status vxm_disjoint_passes_create(vxm_disjoint_passes *out, vxm_context *context,
                                      const vxm_window *window, const vxm_parity_union_job *job,
                                      int64_t margin, size_t most, vxm_error *error) {
  *out = (vxm_disjoint_passes){.context = context, .part_begin = job->part_begin};
  division d = {
      .context = context, .window = window, .job = job, .margin = margin, .most = most, .passes = out};
  vxm_status status = divide(&d, error);
  vxm_free(context, d.boxes);
  vxm_free(context, d.taken);
  return status;
}

void vxm_disjoint_passes_destroy(vxm_disjoint_passes *passes) {
  vxm_free(passes->context, passes->pass_of);
  vxm_free(passes->context, passes->order);
  vxm_free(passes->context, passes->triangle_end);
  vxm_free(passes->context, passes->box_end);
  vxm_free(passes->context, passes->boxes);
}
