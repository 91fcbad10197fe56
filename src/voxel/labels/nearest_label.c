/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/nearest_label.h"

#include <math.h>

/** More than what rounds in distances. */
static const float slack = 1e-3F;

enum {
  BLOCK = 16, /**< voxels along an edge of the blocks to begin with: a part of a word */
  CROWD = 256 /**< triangles looked at for a block; where there are more it is cut first */
};

typedef struct job {
  const vxm_nearest_label *nearest;
  double step[3]; /**< from one voxel to the next, in the order of the layout */
} job;

/** Voxels of the box, in the order of the layout. */
typedef struct voxels {
  int64_t at[3], size[3];
} voxels;

/* ---- Voxels ---- */

/** The asked voxels of a row, as bits. They lie within a word. */
static uint64_t row_bits(const job *j, const voxels *v, int64_t middle, int64_t slow) {
  uint64_t word = vxm_window_row(j->nearest->asked, middle, slow)[v->at[0] / 64];
  return word >> (v->at[0] % 64) & vxm_low_bits((unsigned)v->size[0]);
}

static bool is_asked(const job *j, const voxels *v) {
  for (int64_t slow = v->at[2]; slow < v->at[2] + v->size[2]; slow++)
    for (int64_t middle = v->at[1]; middle < v->at[1] + v->size[1]; middle++)
      if (row_bits(j, v, middle, slow))
        return true;
  return false;
}

static uint16_t *value_at(const job *j, int64_t fast, int64_t middle, int64_t slow) {
  const vxm_nearest_label *nearest = j->nearest;
  return nearest->values + (size_t)slow * nearest->plane + (size_t)middle * nearest->row + (size_t)fast;
}

/** Calls for each asked voxel; whether all calls returned true. Inlined with the function. */
static inline __attribute__((always_inline)) bool
each_value(const job *j, const voxels *v, bool (*visit)(uint16_t *value, void *payload), void *payload) {
  for (int64_t slow = v->at[2]; slow < v->at[2] + v->size[2]; slow++)
    for (int64_t middle = v->at[1]; middle < v->at[1] + v->size[1]; middle++) {
      uint16_t *values = value_at(j, v->at[0], middle, slow);
      for (uint64_t bits = row_bits(j, v, middle, slow); bits; bits &= bits - 1)
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

static inline bool has_value(uint16_t *value, void *payload) {
  return *value == *(const uint16_t *)payload;
}

static void give(const job *j, const voxels *v, uint32_t label) {
  uint16_t value = (uint16_t)label;
  each_value(j, v, set_value, &value);
}

/** The label of a single voxel, which goes before others that are as near where labels are open. */
static uint32_t preferred_label(const job *j, const voxels *v) {
  return j->nearest->open ? *value_at(j, v->at[0], v->at[1], v->at[2]) : 0;
}

/** One of the eighths; false if it is empty. */
static bool eighth(voxels *out, const voxels *v, int number) {
  for (int a = 0; a < 3; a++) {
    int64_t half = (v->size[a] + 1) / 2;
    bool is_upper = number >> a & 1;
    out->at[a] = v->at[a] + (is_upper ? half : 0);
    out->size[a] = is_upper ? v->size[a] - half : half;
    if (out->size[a] == 0)
      return false;
  }
  return true;
}

/* ---- Labels ---- */

/** The voxels as points of the BVH. */
static vxm_bvh_block block_of(const job *j, const voxels *v) {
  const vxm_layout *layout = &j->nearest->asked->layout;
  const int axis[3] = {layout->fast, layout->middle, layout->slow};
  vxm_bvh_block block;
  double reach2 = 0;
  for (int a = 0; a < 3; a++) {
    double half = (double)(v->size[a] - 1) / 2 * j->step[a];
    block.half[axis[a]] = half;
    block.middle[axis[a]] = ((double)(v->at[a] + j->nearest->first[a]) + (double)v->size[a] / 2) * j->step[a];
    reach2 += half * half;
  }
  block.reach = sqrt(reach2);
  return block;
}

/** Triangles that may be the nearest to some voxels; of several labels. */
typedef struct crowd {
  size_t count;
  vxm_label_hit near[CROWD];
} crowd;

/** The nearest of a crowd to a single point; of equally near ones it has the label `kept`, or the lowest. */
static vxm_label_hit nearest_of(const job *j, const crowd *c, const double p[3], uint32_t kept) {
  vxm_label_hit nearest = {.nearness = INFINITY};
  for (size_t i = 0; i < c->count; i++) {
    const vxm_label_hit *near = &c->near[i];
    float nearness = vxm_label_bvh_nearness(j->nearest->bvh, near->triangle, p);
    if (nearness > nearest.nearness ||
        (nearness == nearest.nearness &&
         (nearest.label == kept || (near->label != kept && near->label >= nearest.label))))
      continue;
    nearest.nearness = nearness;
    nearest.label = near->label;
  }
  return nearest;
}

/* ---- Where labels are open ---- */

/** A nearness that all have that are no farther than the longest side of a voxel from voxels of a block. */
static float reach_nearness(const vxm_bvh_block *block) {
  return block->reach == 0 ? vxm_nearness_at(1) : vxm_nearness_at(1 + block->reach + (double)slack);
}

/** Whether there is nothing to give: all faces are too far from all voxels. */
static bool is_beyond(const job *j, const vxm_bvh_block *block, const vxm_label_hit *nearest) {
  return j->nearest->open && (nearest->label == 0 || nearest->nearness > reach_nearness(block));
}

/** Gives the one label that is the nearest in a block; false if the block has to be cut, as it is too far for
 * some voxels only. */
static bool give_nearest(const job *j, const voxels *v, const vxm_bvh_block *block,
                         const vxm_label_hit *nearest) {
  const uint8_t *open = j->nearest->open;
  uint16_t value = (uint16_t)nearest->label;
  if (open && (!open[nearest->label - 1] || each_value(j, v, has_value, &value)))
    return true;
  if (open && block->reach > 0 && (double)(nearest->distance + slack) + block->reach > 1)
    return false;
  give(j, v, nearest->label);
  return true;
}

/** Looks at a crowd from another point, and finds the nearest; which of several makes no difference. */
static vxm_label_hit look_from(const job *j, crowd *out, const crowd *from, const double p[3]) {
  vxm_label_hit nearest = {.nearness = INFINITY};
  for (size_t i = 0; i < from->count; i++) {
    out->near[i] = vxm_label_bvh_view(j->nearest->bvh, from->near[i].label, from->near[i].triangle, p);
    if (out->near[i].nearness < nearest.nearness)
      nearest = out->near[i];
  }
  out->count = from->count;
  return nearest;
}

/** Leaves out what cannot be the nearest in a block; whether more than one label is left. */
static bool thin_out(crowd *c, const vxm_bvh_block *block, const vxm_label_hit *nearest) {
  size_t kept = 0;
  bool is_mixed = false;
  for (size_t i = 0; i < c->count; i++)
    if (!vxm_bvh_block_excludes(block, nearest, &c->near[i])) {
      is_mixed |= c->near[i].label != nearest->label;
      c->near[kept++] = c->near[i];
    }
  c->count = kept;
  return is_mixed;
}

/** Whether all voxels keep their labels: only open labels take any, and of the crowd at most one is open,
 * which has them all. */
static bool keeps_all(const job *j, const voxels *v, const crowd *c) {
  const uint8_t *open = j->nearest->open;
  uint16_t taker = 0;
  for (size_t i = 0; i < c->count; i++) {
    uint32_t label = c->near[i].label;
    if (!open[label - 1] || label == taker)
      continue;
    if (taker)
      return false;
    taker = (uint16_t)label;
  }
  return taker == 0 || each_value(j, v, has_value, &taker);
}

/** Settles voxels, or their eighths, by a crowd that has the nearest of each of them. */
static void settle_by_crowd(const job *j, const voxels *v, const crowd *from) {
  if (!is_asked(j, v))
    return;
  vxm_bvh_block block = block_of(j, v);
  if (block.reach == 0) {
    vxm_label_hit nearest = nearest_of(j, from, block.middle, preferred_label(j, v));
    if (!is_beyond(j, &block, &nearest))
      give_nearest(j, v, &block, &nearest);
    return;
  }
  crowd c;
  vxm_label_hit nearest = look_from(j, &c, from, block.middle);
  if (is_beyond(j, &block, &nearest))
    return;
  bool is_mixed = thin_out(&c, &block, &nearest);
  if (j->nearest->open && keeps_all(j, v, &c))
    return;
  if (!is_mixed && give_nearest(j, v, &block, &nearest))
    return;
  voxels part;
  for (int n = 0; n < 8; n++)
    if (eighth(&part, v, n))
      settle_by_crowd(j, &part, &c);
}

/** Settles voxels by the nearest of the labels that a filter lets through; false if they are to be cut first.
 */
static bool settle_filtered(const job *j, const voxels *v, vxm_label_filter filter, vxm_label_hit *nearest) {
  const vxm_label_bvh *bvh = j->nearest->bvh;
  vxm_bvh_block block = block_of(j, v);
  if (j->nearest->open && nearest->label == 0)
    nearest->nearness = nextafterf(reach_nearness(&block), INFINITY);
  *nearest = vxm_label_bvh_nearest(bvh, filter, block.middle, nearest);
  if (is_beyond(j, &block, nearest))
    return true;
  if ((block.reach == 0 || !vxm_label_bvh_has_other(bvh, filter, &block, nearest)) &&
      give_nearest(j, v, &block, nearest))
    return true;
  crowd c;
  c.count = vxm_label_bvh_list(bvh, filter, &block, nearest, c.near, CROWD);
  if (c.count > CROWD)
    return false;
  voxels part;
  for (int n = 0; n < 8; n++)
    if (eighth(&part, v, n))
      settle_by_crowd(j, &part, &c);
  return true;
}

/** Settles voxels, or their eighths. `nearest` is that of a larger block. */
static void settle(const job *j, const voxels *v, vxm_label_hit nearest) {
  static const vxm_label_hit nothing = {.nearness = INFINITY};
  uint16_t held = 0;
  uint32_t label = j->nearest->label;
  vxm_label_filter filter = {{0, 0}, 0};
  if (!is_asked(j, v))
    return;
  if (j->nearest->open && v->size[0] * v->size[1] * v->size[2] == 1)
    filter.preferred = preferred_label(j, v);
  /* Where the label is weighed against that of the voxels, these must all have the same. */
  bool is_one = label == 0 || each_value(j, v, same_value, &held);
  if (label) {
    filter = (vxm_label_filter){{held, label}, 0};
    nearest = nothing;
  }
  if (is_one && settle_filtered(j, v, filter, &nearest))
    return;
  voxels part;
  for (int n = 0; n < 8; n++)
    if (eighth(&part, v, n))
      settle(j, &part, nearest);
}

void vxm_nearest_label_voxels(const vxm_nearest_label *nearest, const int64_t begin[3],
                              const int64_t end[3]) {
  const vxm_layout *layout = &nearest->asked->layout;
  const int axis[3] = {layout->fast, layout->middle, layout->slow};
  const double *size = nearest->space->voxel_size;
  double side = fmax(size[0], fmax(size[1], size[2]));
  job j = {.nearest = nearest};
  for (int a = 0; a < 3; a++)
    j.step[a] = size[axis[a]] / side;
  voxels v;
  for (v.at[2] = begin[2]; v.at[2] < end[2]; v.at[2] += BLOCK)
    for (v.at[1] = begin[1]; v.at[1] < end[1]; v.at[1] += BLOCK)
      for (v.at[0] = begin[0]; v.at[0] < end[0]; v.at[0] += BLOCK) {
        for (int a = 0; a < 3; a++)
          v.size[a] = vxm_min(end[a] - v.at[a], BLOCK);
        settle(&j, &v, (vxm_label_hit){.nearness = INFINITY});
      }
}

bool vxm_nearest_label_may_reach(const vxm_label_bvh *bvh, const vxm_space *space, const int64_t at[3],
                                 int64_t side) {
  const vxm_label_filter all = {{0, 0}, 0};
  const double *size = space->voxel_size;
  double longest = fmax(size[0], fmax(size[1], size[2]));
  vxm_bvh_block block;
  double reach2 = 0;
  for (int a = 0; a < 3; a++) {
    double step = size[a] / longest, half = (double)(side - 1) / 2 * step;
    block.middle[a] = ((double)at[a] + (double)side / 2) * step;
    reach2 += half * half;
  }
  block.reach = sqrt(reach2);
  vxm_label_hit bound = {.nearness = nextafterf(reach_nearness(&block), INFINITY)};
  return vxm_label_bvh_nearest(bvh, all, block.middle, &bound).label != 0;
}
