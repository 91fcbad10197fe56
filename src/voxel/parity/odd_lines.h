/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Lines of voxel centres that meet an odd number of a part's faces, of those before the grid and behind it
 * too: somewhere along such a line the surface is open.
 *
 * Seen from the other end of such a line every voxel has the other parity, so what it tells of inside and
 * outside depends on where one stands: an axis along which a voxel lies on one abstains. On all others both
 * ends tell the same. So a mirrored mesh gets mirrored voxels.
 *
 * A surface and a line meet as often, mod 2, as the surface's border, seen along the line, winds round it. So
 * odd edges alone tell these lines: along an axis, each flips in every row across it the voxels behind it.
 */
#ifndef VXM_VOXEL_PARITY_ODD_LINES_H
#define VXM_VOXEL_PARITY_ODD_LINES_H

#include "grid/window.h"
#include "voxel/parity/snapped_points.h"

/** A bit for each line of a window. Those along the slow axis are of the whole grid. */
typedef struct vxm_odd_lines {
  vxm_context *context;
  vxm_window window;
  uint64_t
      *along[3]; /**< the fast axis: bits along the middle one, a row a slice; the middle axis: bits along
                    the fast one, a row a slice; the slow axis: bits along the fast one, as in a slice */
  bool has_slow; /**< whether one of those along the slow axis is odd */
} vxm_odd_lines;

/**
 * Finds the lines that are odd for a part of part_begin..part_end-1 or more.
 *
 * @param context whose threads work, and which counts the lines
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED; then it holds nothing
 */
vxm_status vxm_odd_lines_find(vxm_odd_lines *out, vxm_context *context, const vxm_window *window,
                              const vxm_snapped_points *placed, const vxm_triangle_set *triangles,
                              size_t part_begin, size_t part_end, vxm_error *error);
void vxm_odd_lines_destroy(vxm_odd_lines *lines);
/** Bytes that they take at most. */
uint64_t vxm_odd_lines_bytes(const vxm_window *window, size_t parts);

/** Whether a line through a slice, counted from the window's first, is odd. */
bool vxm_odd_lines_in(const vxm_odd_lines *lines, size_t slice);

/** Some words of a slice, with a bit wherever an axis abstains: `odd` points into itself, so that it cannot
 * be copied once words were taken. */
enum { VXM_ODD_WORDS = 64 };
typedef struct vxm_odd_words {
  const vxm_odd_lines *lines;
  size_t slice, at, count; /**< words at..at+count-1 */
  const uint64_t *odd[3];  /**< the fast, the middle and the slow axis */
  uint64_t along_fast[VXM_ODD_WORDS], along_middle[VXM_ODD_WORDS];
} vxm_odd_words;

/** Before the first words of a slice. */
vxm_odd_words vxm_odd_words_of(const vxm_odd_lines *lines, size_t slice);
/** Goes on to the next words; false behind the last ones. */
bool vxm_odd_words_next(vxm_odd_words *words);

/**
 * Takes the votes of axes that abstain out of a slice. How many of the three say inside then tells all that
 * the votes do: three where no axis abstains and all say inside; none where two axes or three are left and
 * say outside; elsewhere one or two, and two where two axes or three are left and most of these say inside:
 * what a single axis says is no evidence, as beside a bent sheet.
 *
 * @param voters words of the slice for the fast, the middle and the slow axis
 */
void vxm_odd_lines_abstain(const vxm_odd_lines *lines, size_t slice, uint64_t *const voters[3]);

#endif
