/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The inner loops, built for several processors from one source (kernels_body.inc) and chosen at run time.
 * All builds give the same bits: the arithmetic is in integers, or in doubles without contraction.
 */
#ifndef VXM_VOXEL_PARITY_KERNELS_H
#define VXM_VOXEL_PARITY_KERNELS_H

#include "base/cpu.h"
#include "voxel/parity/columns.h"
#include "voxel/parity/crossing_bins.h"

/** Takes (x, y, z, 1) to lattice steps: (column_0 x + column_1 y + column_2 z + column_3 + noise - origin) *
 * scale. The fourth number of each column, of `origin` and `scale` is 0. */
typedef struct vxm_affine {
  double column[4][4];
  double origin[4], scale[4];
  /** Looked at only where points have entries in it (voxel/lattice/vertex_transform.h). */
  const float (*noise)[4];
  uint32_t noise_size, offset;
  int bits;         /**< of the lattice */
  int32_t cells[4]; /**< the last cell along each axis */
} vxm_affine;

/** The triangles that one task rasters. */
typedef struct vxm_raster_task {
  const vxm_snapped_points *placed;
  const vxm_triangle_set *triangles;
  size_t begin, end; /**< triangles */
  const vxm_columns *columns;
  size_t columns_count;
  vxm_crossing_bins *bins; /**< voters as in `columns` */
  uint64_t *words; /**< NULL; or flips go straight to these: of a window that is one slab with one voter, the
                      slabs of which are cut along v, and of one part. Bins are not used then */
  size_t worker;
} vxm_raster_task;

typedef struct vxm_kernels {
  vxm_cpu_level level;
  /** Places `count` positions, with their cells (NULL = not asked for), each displaced by its entry of the
   * noise (NULL = none); false if one is not finite or beyond VXM_NARROW_MAX (it is stored as 0). */
  bool (*place)(int32_t (*out)[4], uint64_t *cells, const double *positions, const uint32_t *entries,
                size_t count, const vxm_affine *affine);
  /** Puts into the bins what the triangles flip (voxel/parity/columns.h). */
  void (*raster)(const vxm_raster_task *task);
  /** Prefix XOR along each of `rows` rows of row_words words, in place; the last word is masked. Returns
   * 0 if no bit is set. */
  uint64_t (*fold_rows)(uint64_t *words, size_t row_words, size_t rows, uint64_t tail_mask);
  /** The same with the result stored past the cache to `to`, and `words` cleared. */
  uint64_t (*fold_rows_streaming)(uint64_t *to, uint64_t *words, size_t row_words, size_t rows,
                                  uint64_t tail_mask);
  /** words[i] ^= words[i - distance] for i = distance to count - 1: prefix XOR of row onto row. */
  void (*fold_across)(uint64_t *words, size_t distance, size_t count);
  /** to |= from, from = 0; returns the OR of all words of `from`. */
  uint64_t (*move_or)(uint64_t *to, uint64_t *from, size_t count);
  /** vxm_vote_count for some words, of which `out` holds nothing yet if it is `fresh`; returns the contested
   * voxels, and ors into *added the bits newly set. `odd` is NULL, or says where each axis abstains, as in
   * vxm_odd_lines_abstain; then there is no fourth voter. With `streaming` they are stored past the cache
   * where lines are whole. */
  int64_t (*vote)(uint64_t *out, const uint64_t *const voters[4], const uint64_t *const odd[3],
                  uint64_t *mask, size_t count, vxm_vote rule, bool fresh, bool streaming, uint64_t *added);
  /** vxm_odd_lines_abstain for some words. */
  void (*abstain)(uint64_t *const voters[3], const uint64_t *const odd[3], size_t count);
  /** The bricks of a node of an octree, in the order of vxm_strip_add_node, of what is flipped in it, which
   * is cleared: a prefix XOR along the four voxels of a row and on into the next brick. `inside` says for
   * each row of bricks what is inside as the node begins, then as it ends. masks[0] are the bricks that are
   * not empty, masks[1] the full ones. Returns the OR of all bricks. */
  uint64_t (*fold_node)(uint64_t bricks[64], uint64_t flipped[64], uint64_t inside[16], uint64_t masks[2]);
  /** NULL, or flips records in the bricks of nodes with a slot, as vxm_flipped_nodes has them (voxel/sparse/
   * flipped_nodes.h), eight at a time. Returns how many: at least all but seven of those before the first
   * whose node has none. */
  size_t (*flip_nodes)(uint64_t *bricks, const uint32_t *slots, const uint64_t *records, size_t count,
                       int row_shift);
} vxm_kernels;

/** The best build that may run (base/cpu.h), or the one forced. */
const vxm_kernels *vxm_kernels_get(void);
/** All builds that may run, best last. */
size_t vxm_kernels_all(const vxm_kernels *out[3]);
/** Makes vxm_kernels_get return this one; NULL = the best again. For tests, while nothing runs. */
void vxm_kernels_force(const vxm_kernels *kernels);

#endif
