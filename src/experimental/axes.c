/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Slices along three axes, of which two decide: Fang and Chen 2000 with the whole mesh, Chen and Tu with each
 * of its groups of vertices. What a slice's frame buffer holds in the papers, the parity of the faces before
 * it, is a bit that a face flips and that is handed on from slice to slice.
 */
#include "experimental/columns.h"
#include "experimental/vertex_groups.h"

#include <string.h>

/** Bits of the grid's layout. */
typedef struct planes {
  const vxm_baseline_job *job;
  uint64_t *part;    /**< of a group along one axis */
  uint64_t *axis[3]; /**< of all groups, united along each */
} planes;

static void flip(void *payload, const int64_t voxel[3]) {
  const planes *p = payload;
  const vxm_grid *grid = p->job->grid;
  p->job->report->tests++;
  for (int a = 0; a < 3; a++)
    if (voxel[a] == grid->space.dims[a])
      return; /* behind the grid */
  p->part[(size_t)voxel[2] * grid->slice_words + (size_t)voxel[1] * grid->row_words +
          (size_t)voxel[0] / 64] ^= UINT64_C(1) << (voxel[0] % 64);
}

/** What is flipped stays so up to the next flip along the axis. */
static void hand_on(uint64_t *words, const vxm_grid *grid, int axis) {
  size_t back = axis == 1 ? grid->row_words : grid->slice_words;
  if (axis > 0) {
    for (size_t w = back; w < grid->word_count; w++)
      if (axis == 2 || w % grid->slice_words >= back)
        words[w] ^= words[w - back];
    return;
  }
  for (size_t w = 0; w < grid->word_count; w++) {
    bool is_first = w % grid->row_words == 0, is_last = (w + 1) % grid->row_words == 0;
    words[w] = vxm_prefix_xor(words[w]);
    if (!is_first && words[w - 1] >> 63)
      words[w] = ~words[w];
    if (is_last)
      words[w] &= vxm_grid_tail_mask(grid);
  }
}

/** Adds a group to what the groups before have along each axis: step 1 of section 2.3. */
static vxm_status add_group(const planes *p, const vxm_vertex_groups *groups, size_t group,
                            vxm_error *error) {
  const vxm_grid *grid = p->job->grid;
  for (int axis = 0; axis < 3; axis++) {
    memset(p->part, 0, grid->word_count * sizeof *p->part);
    for (size_t m = groups->begin[group]; m < groups->begin[group + 1]; m++) {
      vxm_point corners[3];
      vxm_baseline_triangle(corners, p->job, groups->members[m]);
      vxm_for_columns(&p->job->surface->lattice, corners, axis, flip, (void *)p);
    }
    hand_on(p->part, grid, axis);
    for (size_t w = 0; w < grid->word_count; w++)
      p->axis[axis][w] |= p->part[w];
  }
  return vxm_check_cancelled(p->job->context, error);
}

/** Step 2. */
static void decide(const planes *p) {
  for (size_t w = 0; w < p->job->grid->word_count; w++) {
    uint64_t x = p->axis[0][w], y = p->axis[1][w], z = p->axis[2][w];
    p->job->grid->words[w] = (x & y) | (y & z) | (z & x);
  }
}

vxm_status vxm_baseline_axes(const vxm_baseline_job *job, vxm_error *error) {
  planes p = {.job = job};
  vxm_vertex_groups groups;
  double start = vxm_clock_ms();
  bool grouped = job->options->method == VXM_BASELINE_CHEN_TU;
  vxm_status status = vxm_vertex_groups_find(&groups, job, grouped, error);
  job->report->setup_ms = vxm_clock_ms() - start;
  job->report->parts = (int64_t)groups.count;
  size_t words = job->grid->word_count;
  uint64_t *all = status == VXM_OK ? vxm_baseline_block(job, 4 * words, sizeof *all, error) : NULL;
  if (all) {
    p.part = all;
    for (int axis = 0; axis < 3; axis++)
      p.axis[axis] = all + (size_t)(axis + 1) * words;
    for (size_t g = 0; g < groups.count && status == VXM_OK; g++)
      status = add_group(&p, &groups, g, error);
    decide(&p);
  } else if (status == VXM_OK)
    status = error->code;
  vxm_free(job->context, all);
  vxm_vertex_groups_destroy(&groups);
  return status;
}
