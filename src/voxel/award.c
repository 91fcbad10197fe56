/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/award.h"

#include <math.h>

/** Voxels along an edge of the blocks to begin with: a part of a word. */
enum { BLOCK = 16 };

/** More than nearness and its distance round, in sides of a voxel, whatever the distance. */
static const double slack = 1e-3, relative_slack = 1e-6;

typedef struct job {
  const vxm_award *award;
  double step[3];    /**< from one voxel to the next, in the order of the layout */
  size_t row, plane; /**< values from one to the next */
} job;

/** Voxels of the box, in the order of the layout. */
typedef struct block {
  int64_t at[3], size[3];
} block;

/* ---- Voxels ---- */

/** The asked voxels of a row of a block, as bits. A block lies within a word. */
static uint64_t row_bits(const job *j, const block *b, int64_t middle, int64_t slow) {
  uint64_t word = vxm_window_row(j->award->asked, middle, slow)[b->at[0] / 64];
  return word >> (b->at[0] % 64) & vxm_low_bits((unsigned)b->size[0]);
}

static bool is_asked(const job *j, const block *b) {
  for (int64_t slow = b->at[2]; slow < b->at[2] + b->size[2]; slow++)
    for (int64_t middle = b->at[1]; middle < b->at[1] + b->size[1]; middle++)
      if (row_bits(j, b, middle, slow))
        return true;
  return false;
}

static uint16_t *value_at(const job *j, int64_t fast, int64_t middle, int64_t slow) {
  const int64_t *first = j->award->first;
  return j->award->values + (size_t)(slow + first[2]) * j->plane + (size_t)(middle + first[1]) * j->row +
         (size_t)(fast + first[0]);
}

/** Calls for each asked voxel of a block; whether all calls returned true. Inlined with the function. */
static inline __attribute__((always_inline)) bool
each_value(const job *j, const block *b, bool (*visit)(uint16_t *value, void *payload), void *payload) {
  for (int64_t slow = b->at[2]; slow < b->at[2] + b->size[2]; slow++)
    for (int64_t middle = b->at[1]; middle < b->at[1] + b->size[1]; middle++) {
      uint16_t *values = value_at(j, b->at[0], middle, slow);
      for (uint64_t bits = row_bits(j, b, middle, slow); bits; bits &= bits - 1)
        if (!visit(values + __builtin_ctzll(bits), payload))
          return false;
    }
  return true;
}

static inline bool set_value(uint16_t *value, void *payload) {
  *value = *(const uint16_t *)payload;
  return true;
}

/** Whether the value is that of the first voxel. */
static inline bool same_value(uint16_t *value, void *payload) {
  uint16_t *first = payload;
  *first = *first ? *first : *value;
  return *first == *value;
}

/* ---- Blocks ---- */

/** The middle of a block of the box as a point of the forest, and how far the centres of its voxels lie from
 * it. */
static double middle_of(const job *j, const block *b, double out[3]) {
  const vxm_layout *layout = &j->award->asked->layout;
  const int axis[3] = {layout->fast, layout->middle, layout->slow};
  double reach2 = 0;
  for (int a = 0; a < 3; a++) {
    double half = (double)(b->size[a] - 1) / 2 * j->step[a];
    out[axis[a]] = ((double)(b->at[a] + j->award->first[a]) + (double)b->size[a] / 2) * j->step[a];
    reach2 += half * half;
  }
  return sqrt(reach2);
}

/** The nearest label takes the block if no other is nearer anywhere in it. */
static bool settle_by_nearest(const job *j, const block *b, const double p[3], double reach, vxm_near *near) {
  const vxm_forest *forest = j->award->forest;
  *near = vxm_forest_nearest(forest, p, near);
  double distance = vxm_forest_distance(near->nearness);
  double beyond = (distance + 2 * reach) * (1 + relative_slack) + slack;
  if (reach > 0 && vxm_forest_has_other(forest, p, near->label, beyond))
    return false;
  uint16_t label = (uint16_t)near->label;
  each_value(j, b, set_value, &label);
  return true;
}

/** Either the label that a block has throughout keeps it, or that of the award takes it. */
static bool settle_by_two(const job *j, const block *b, const double p[3], double reach) {
  const vxm_award *award = j->award;
  uint16_t held = 0, label = (uint16_t)award->label;
  if (!each_value(j, b, same_value, &held))
    return false;
  float to_held = vxm_forest_nearness(award->forest, p, held),
        to_label = vxm_forest_nearness(award->forest, p, label);
  bool takes = to_label < to_held || (to_label == to_held && label < held);
  double near = vxm_forest_distance(takes ? to_label : to_held),
         far = vxm_forest_distance(takes ? to_held : to_label);
  if (reach > 0 && far <= (near + 2 * reach) * (1 + relative_slack) + slack)
    return false;
  if (takes)
    each_value(j, b, set_value, &label);
  return true;
}

/** Settles a block, or its eighths. */
static void settle(const job *j, const block *b, vxm_near near) {
  if (!is_asked(j, b))
    return;
  double p[3], reach = middle_of(j, b, p);
  if (j->award->label ? settle_by_two(j, b, p, reach) : settle_by_nearest(j, b, p, reach, &near))
    return;
  for (int part = 0; part < 8; part++) {
    block smaller = *b;
    bool is_there = true;
    for (int a = 0; a < 3; a++) {
      int64_t half = (b->size[a] + 1) / 2;
      bool is_upper = part >> a & 1;
      smaller.at[a] += is_upper ? half : 0;
      smaller.size[a] = is_upper ? b->size[a] - half : half;
      is_there = is_there && smaller.size[a] > 0;
    }
    if (is_there)
      settle(j, &smaller, near);
  }
}

void vxm_award_voxels(const vxm_award *award, const int64_t begin[3], const int64_t end[3]) {
  const vxm_layout *layout = &award->asked->layout;
  const int axis[3] = {layout->fast, layout->middle, layout->slow};
  const double *size = award->space->voxel_size;
  double side = fmax(size[0], fmax(size[1], size[2]));
  job j = {.award = award, .row = (size_t)award->space->dims[layout->fast]};
  j.plane = j.row * (size_t)award->space->dims[layout->middle];
  for (int a = 0; a < 3; a++)
    j.step[a] = size[axis[a]] / side;
  block b;
  for (b.at[2] = begin[2]; b.at[2] < end[2]; b.at[2] += BLOCK)
    for (b.at[1] = begin[1]; b.at[1] < end[1]; b.at[1] += BLOCK)
      for (b.at[0] = begin[0]; b.at[0] < end[0]; b.at[0] += BLOCK) {
        for (int a = 0; a < 3; a++)
          b.size[a] = vxm_min(end[a] - b.at[a], BLOCK);
        settle(&j, &b, (vxm_near){INFINITY, 0, 0});
      }
}
