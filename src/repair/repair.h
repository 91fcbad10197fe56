/* SPDX-License-Identifier: BSD-3-Clause */
/** Repair of a soup: a repaired copy, and the report of what was done. */
#ifndef VXM_REPAIR_REPAIR_H
#define VXM_REPAIR_REPAIR_H

#include "mesh/soup.h"

/**
 * Repairs a soup into a new one (vxm_mesh_repair).
 *
 * The report lists, in this order:
 *  - rounding: vertices that were moved to where 32-bit floats are
 *  - nonfinite_vertices: vertices with a NaN or an infinity; they go with their faces
 *  - exact_weld: vertices merged into an earlier one of the same position
 *  - tolerant_weld: vertices merged into an earlier one near by (repair/weld/tolerant_weld.c)
 *  - repeated_corners: faces that lost corners which repeat the one before, or a spike there and back; below
 *    three corners the face goes
 *  - zero_area_faces: faces without area that went; those without which more edges would be odd stay
 * (repair/clean/degenerate_faces.c)
 *  - t_junctions: edges that were divided at vertices on them, where that closes edges
 * (repair/weld/t_junctions.c)
 *  - duplicate_faces: faces that repeat an earlier one with the same orientation (repair/bodies/duplicates.c)
 *  - opposite_duplicate_faces: faces that repeat an earlier one with the opposite orientation
 *  - inner_walls: faces of walls within bodies that went, at VXM_LEVEL_CLOSED and above and before voxelizing
 * (repair/bodies/inner_walls.h)
 *  - orientation: faces that were turned (repair/clean/orientation.c)
 *  - wrap: faces of the surface that was put around everything (repair/exact/wrap.c)
 *  - separation: faces that were detached where a vertex or edge had too many
 * (repair/manifold/cut_nonmanifold_pass.c)
 *  - closing: faces that were added to close holes (repair/holes/closing.c)
 *  - small_parts: faces of components that were dropped (repair/clean/small_components.c)
 *  - sheets: faces of the plates that open sheets became (repair/sheets/sheets_pass.c)
 *  - union: parts that were united with others, or cut along where they met (repair/exact/union.c)
 *  - apart: vertices that were moved apart from others at the same position
 * (repair/manifold/perturb_coincident.c)
 *  - unused_vertices: vertices without a face, apart from those counted above
 * The passes in the middle are run until none of them changes anything, and their counts are sums. A pass
 * that an option leaves out is listed with 0. Repairing the result again gives the same arrays and counts of
 * 0.
 *
 * @param report  may be NULL, then no census is taken
 * @param options NULL for defaults
 * @return VXM_OK, VXM_ERROR_ARGUMENT, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_repair_run(vxm_soup **out, vxm_repair_report *report, const vxm_soup *in,
                          const vxm_repair_options *options, vxm_error *error);

/** As vxm_repair_run, with bodies separated that share faces, and sets of faces each by itself; see
 * vxm_mesh_prepare and vxm_mesh_divide in voxmend.h. */
vxm_status vxm_repair_prepare(vxm_soup **out, vxm_repair_report *report, const vxm_soup *in,
                              const vxm_repair_options *options, vxm_error *error);

/**
 * As vxm_repair_prepare, of a soup that need not be kept: it is changed, or destroyed, as soon as that saves
 * memory.
 *
 * @param in destroyed, also after a failure
 */
vxm_status vxm_repair_prepare_owned(vxm_soup **out, vxm_repair_report *report, vxm_soup *in,
                                    const vxm_repair_options *options, vxm_error *error);

/** Checks options; NULL stands for the defaults. @return VXM_OK, VXM_ERROR_ARGUMENT */
vxm_status vxm_repair_check(vxm_repair_options *chosen, const vxm_repair_options *options, vxm_error *error);

#endif
