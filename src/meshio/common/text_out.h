/* SPDX-License-Identifier: BSD-3-Clause */
/** Text of vertices and faces on its way to an output. */
#ifndef VXM_MESHIO_COMMON_TEXT_OUT_H
#define VXM_MESHIO_COMMON_TEXT_OUT_H

#include "base/number.h"
#include "base/output.h"
#include "mesh/soup.h"

typedef struct vxm_text_out {
  vxm_output *output;
  const vxm_soup *soup;
} vxm_text_out;

/** `lead`, then x y z, then a line end. */
void vxm_text_vertex(vxm_text_out *text, const char *lead, const double position[3]);
/** As vxm_text_vertex, in the fewest digits that give the same floats. */
void vxm_text_vertex_float(vxm_text_out *text, const char *lead, const float position[3]);
/** A whole number without a line end. */
void vxm_text_uint(vxm_text_out *text, uint64_t value);
/** Corners of a face, each after a blank and with `first` added, then a line end. */
void vxm_text_corners(vxm_text_out *text, const uint32_t *corner, size_t count, uint64_t first);

/**
 * To be called for each element with its number: now and then tells the progress, from `begin` to `end`
 * within 0 to 1, and stops a hopeless output early (commit tells why).
 */
vxm_status vxm_write_progress(const vxm_soup *soup, const vxm_output *output, size_t done, size_t count,
                              double begin, double end, vxm_error *error);

#endif
