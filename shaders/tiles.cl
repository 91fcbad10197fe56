/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Solids tile by tile (Schwarz & Seidel 2010, section 4.2): triangles are listed for each tile of columns whose centres
 * they may cover, the lists are sorted by tile, and a work-group does each tile: its work-items first make ready some
 * triangles, then each of them goes through these with a column of its own. No two write the same word, so that nothing
 * is atomic. As a list keeps the order of triangles, parts follow each other in it, and each is folded and united as it
 * ends: parts may meet. Columns run along the bits.
 */
enum {
  TILE_U = GROUP >= 32 ? 8 : 4,
  TILE_V = GROUP / TILE_U,
  BATCH = GROUP < 32 ? GROUP : 32,
  ROLE_SHIFT = 29 /* of the number of a triangle's part; its role is above */
};

/* What a triangle covers of the columns. */
typedef struct Cover {
  vxm_side side[3];
  int4 area, tiles; /* columns; tiles: first along u and v, last along u and v */
} Cover;

static inline bool cover_of(Cover *cover, Triangle *t, const Job *job, __global const int4 *points,
                     __global const uint *corners, __global const uint *parts, uint triangle, uint roles) {
  if (((roles >> (parts[triangle] >> ROLE_SHIFT)) & 1) == 0 || !load_triangle(t, job, points, corners, triangle))
    return false;
  int4 area = columns_of(t, job);
  if (area.z <= area.x || area.w <= area.y)
    return false;
  cover->area = area;
  cover->tiles = (int4)((area.x - job->first[0]) / TILE_U, (area.y - job->first[1]) / TILE_V,
                        (area.z - 1 - job->first[0]) / TILE_U, (area.w - 1 - job->first[1]) / TILE_V);
  int middle = (1 << job->bits) / 2;
  int pu = (area.x << job->bits) + middle - t->a.x, pv = (area.y << job->bits) + middle - t->a.y;
  for (int s = 0; s < 3; s++)
    cover->side[s] = side_of(t, job, s, pu, pv);
  return true;
}

/* Whether a side leaves any column of a tile: the one that lies farthest inside tells. */
static inline bool leaves_some(const vxm_side *side, int u0, int v0, int u1, int v1) {
  long u = side->u_step > 0 ? u1 : u0, v = side->v_step > 0 ? v1 : v0;
  return side->value + side->u_step * u + side->v_step * v >= 0;
}

/* Columns of the area that a tile has, relative to the area's first. */
static inline bool meets_tile(const Cover *cover, const Job *job, int tu, int tv) {
  int u0 = max(job->first[0] + tu * TILE_U - cover->area.x, 0), v0 = max(job->first[1] + tv * TILE_V - cover->area.y, 0);
  int u1 = min(job->first[0] + (tu + 1) * TILE_U, cover->area.z) - 1 - cover->area.x;
  int v1 = min(job->first[1] + (tv + 1) * TILE_V, cover->area.w) - 1 - cover->area.y;
  return leaves_some(&cover->side[0], u0, v0, u1, v1) && leaves_some(&cover->side[1], u0, v0, u1, v1) &&
         leaves_some(&cover->side[2], u0, v0, u1, v1);
}

/* `total`: the sum of all counts, its low and its high half; those of a group fit the low half. */
__kernel void count_tiles(__global const int4 *points, __global const uint *corners, __global const uint *parts,
                          __global uint *counts, __global uint *total, const Job job, const uint roles) {
  __local uint all;
  uint i = (uint)get_global_id(0), count = 0;
  if (get_local_id(0) == 0)
    all = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (i < job.triangle_count) {
    Cover cover;
    Triangle t;
    if (cover_of(&cover, &t, &job, points, corners, parts, job.triangle_first + i, roles))
      for (int v = cover.tiles.y; v <= cover.tiles.w; v++)
        for (int u = cover.tiles.x; u <= cover.tiles.z; u++)
          count += meets_tile(&cover, &job, u, v) ? 1 : 0;
    counts[i] = count;
    if (count > 0)
      atomic_add(&all, count);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (get_local_id(0) == 0 && all > 0 && atomic_add(&total[0], all) > ~0u - all)
    atomic_inc(&total[1]);
}

__kernel void list_tiles(__global const int4 *points, __global const uint *corners, __global const uint *parts,
                         __global const uint *starts, __global ulong *keys, __global uint *values, const Job job,
                         const uint roles, const uint tiles_u) {
  uint i = (uint)get_global_id(0);
  Cover cover;
  Triangle t;
  if (i >= job.triangle_count || starts[i] == starts[i + 1])
    return;
  uint at = starts[i];
  cover_of(&cover, &t, &job, points, corners, parts, job.triangle_first + i, roles);
  for (int v = cover.tiles.y; v <= cover.tiles.w; v++)
    for (int u = cover.tiles.x; u <= cover.tiles.z; u++)
      if (meets_tile(&cover, &job, u, v)) {
        keys[at] = (ulong)v * tiles_u + u;
        values[at++] = job.triangle_first + i;
      }
}

/* Where the list of each tile begins and ends; both are 0 for others. Two work-items write these, so that they are no
   uint2, which a compiler may write as a whole. */
__kernel void find_tiles(__global const ulong *keys, __global uint *lists, const uint count) {
  uint i = (uint)get_global_id(0);
  if (i >= count)
    return;
  if (i == 0 || keys[i - 1] != keys[i])
    lists[2 * keys[i]] = i;
  if (i + 1 == count || keys[i + 1] != keys[i])
    lists[2 * keys[i] + 1] = i + 1;
}

/* A triangle as the columns of a tile ask it; numbers belong to the tile's first column. */
typedef struct Ready {
  vxm_side side[3];
  vxm_plane plane;
  uint part;
} Ready;

/* Unites what a part has inside a column; the flips are cleared. `shape`: words of the column, valid bits of the
   last. */
static inline bool fold_column(__local uint *flips, __global uint *column, uint low, uint high, uint2 shape) {
  uint carry = 0, some = 0;
  for (uint w = low; w < shape.x && (w <= high || carry != 0); w++) {
    uint x = flips[w * GROUP];
    flips[w * GROUP] = 0;
    x ^= x << 1;
    x ^= x << 2;
    x ^= x << 4;
    x ^= x << 8;
    x ^= x << 16;
    x ^= carry;
    carry = 0 - (x >> 31);
    if (w + 1 == shape.x)
      x &= shape.y;
    if (x != 0)
      column[w] |= x;
    some |= x;
  }
  return some != 0;
}

/* `job` says which voxels of the columns this is about, the first of which begins a word of theirs: number
   `first_word`. `flips` has a word for each work-item and word of a column. */
__kernel void fill_tiles(__global const int4 *points, __global const uint *corners, __global const uint *parts,
                         __global const uint *values, __global const uint2 *lists, __global uint *inside,
                         __global uint *touched, const Job job, const uint tiles_u, const uint first_word,
                         const uint2 shape, __local uint *flips) {
  __local Ready ready[BATCH];
  uint me = (uint)get_local_id(0), tile = (uint)get_group_id(0);
  uint2 list = lists[tile];
  int tile_u = job.first[0] + (int)(tile % tiles_u) * TILE_U, tile_v = job.first[1] + (int)(tile / tiles_u) * TILE_V;
  int du = (int)me % TILE_U, dv = (int)me / TILE_U;
  bool is_mine = list.x < list.y && tile_u + du < job.last[0] && tile_v + dv < job.last[1];
  uint part = ~0u, low = shape.x, high = 0;
  __global uint *column = inside + first_word;
  if (is_mine)
    column += ((ulong)(tile_u + du - job.first[0]) * job.step[0] + (ulong)(tile_v + dv - job.first[1]) * job.step[1]) / 32;
  for (uint w = 0; w < shape.x && list.x < list.y; w++)
    flips[w * GROUP + me] = 0;
  for (uint from = list.x; from < list.y; from += BATCH) {
    uint count = min(list.y - from, (uint)BATCH);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (me < count) {
      uint triangle = values[from + me];
      Triangle t;
      int middle = (1 << job.bits) / 2;
      load_triangle(&t, &job, points, corners, triangle);
      int pu = (tile_u << job.bits) + middle - t.a.x, pv = (tile_v << job.bits) + middle - t.a.y;
      for (int s = 0; s < 3; s++)
        ready[me].side[s] = side_of(&t, &job, s, pu, pv);
      ready[me].plane = plane_of(&t, &job, pu, pv);
      ready[me].part = parts[triangle] & ((1u << ROLE_SHIFT) - 1);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint r = 0; r < count; r++) {
      __local const Ready *t = &ready[r];
      if (t->part != part) {
        if (is_mine && low < shape.x && fold_column(flips + me, column, low, high, shape))
          touched[part] = 1;
        part = t->part;
        low = shape.x;
        high = 0;
      }
      long s0 = t->side[0].value + t->side[0].u_step * du + t->side[0].v_step * dv;
      long s1 = t->side[1].value + t->side[1].u_step * du + t->side[1].v_step * dv;
      long s2 = t->side[2].value + t->side[2].u_step * du + t->side[2].v_step * dv;
      if (!is_mine || (s0 | s1 | s2) < 0)
        continue;
      vxm_plane plane = t->plane;
      int w = crossing(&plane, plane.across + plane.u_step * du + plane.v_step * dv);
      if (w >= job.last[2] || (w < job.first[2] && !job.keep_before))
        continue;
      uint bit = (uint)max(w - job.first[2], 0);
      flips[(bit >> 5) * GROUP + me] ^= 1u << (bit & 31u);
      low = min(low, bit >> 5);
      high = max(high, bit >> 5);
    }
  }
  if (is_mine && low < shape.x && fold_column(flips + me, column, low, high, shape))
    touched[part] = 1;
}
