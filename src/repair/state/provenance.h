/* SPDX-License-Identifier: BSD-3-Clause */
/** What becomes of every part of a mesh under repair. */
#ifndef VXM_REPAIR_STATE_PROVENANCE_H
#define VXM_REPAIR_STATE_PROVENANCE_H

#include "mesh/soup.h"

/**
 * Parts are the connected components of the mesh that came in, after welding. Faces know theirs by
 * soup->face_parts, which passes carry along; vertices are followed in stages, while they keep their numbers.
 */
typedef struct vxm_provenance vxm_provenance;

/** The first stage begins with it. @param copy gets its face_parts @param in has to stay */
vxm_status vxm_provenance_create(vxm_provenance **out, vxm_soup *copy, const vxm_soup *in, vxm_error *error);
void vxm_provenance_destroy(vxm_provenance *provenance);
/** Begins a stage. */
vxm_status vxm_provenance_start(vxm_provenance *provenance, const vxm_soup *soup, vxm_error *error);
/** Vertices merge: map[v] takes the place of v. Between stages nobody looks. */
void vxm_provenance_merge(vxm_provenance *provenance, const uint32_t *map);
/** Ends a stage: sees how far vertices were moved in it. */
vxm_status vxm_provenance_settle(vxm_provenance *provenance, const vxm_soup *soup, vxm_error *error);
/** Notes the volumes that max_change refers to, in the first stage, once faces are turned and repeated ones
 * gone. */
vxm_status vxm_provenance_refer(vxm_provenance *provenance, const vxm_soup *soup, vxm_error *error);
/** A face of a part was turned, in the end. */
void vxm_provenance_turn(vxm_provenance *provenance, uint32_t part);
size_t vxm_provenance_part_count(const vxm_provenance *provenance);
/** A part was to be united and could not be; false if that was known. */
bool vxm_provenance_leave(vxm_provenance *provenance, uint32_t part);
/** What was left so far is not any more: something else was done with it. */
void vxm_provenance_forget_left(vxm_provenance *provenance);
/** Notes what is known of the parts by now, between stages, and goes back to it. @return VXM_OK,
 * VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_provenance_remember(vxm_provenance *provenance, vxm_error *error);
void vxm_provenance_recall(vxm_provenance *provenance);
/** A part is to have no faces. */
void vxm_provenance_drop(vxm_provenance *provenance, uint32_t part);
/**
 * Fills soup->part_changes.
 *
 * @param max_change see vxm_repair_options; 0 = any
 * @return VXM_OK; VXM_ERROR_UNREACHED if a part changed by more; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_provenance_finish(vxm_provenance *provenance, vxm_soup *soup, double max_change,
                                 vxm_error *error);
/** Then counts self-intersections, by part and in all: before and after. */
vxm_status vxm_provenance_count_crossings(vxm_provenance *provenance, vxm_soup *soup, int64_t totals[2],
                                          vxm_error *error);

#endif
