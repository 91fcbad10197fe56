/* SPDX-License-Identifier: BSD-3-Clause */
/** What becomes of every part of a mesh under repair. */
#ifndef VXM_REPAIR_TRACK_H
#define VXM_REPAIR_TRACK_H

#include "mesh/soup.h"

/**
 * Parts are the connected components of the mesh that came in, after welding. Faces know theirs by
 * soup->face_parts, which passes carry along; vertices are followed in stages, while they keep their numbers.
 */
typedef struct vxm_track vxm_track;

/** The first stage begins with it. @param copy gets its face_parts @param in has to stay */
vxm_status vxm_track_create(vxm_track **out, vxm_soup *copy, const vxm_soup *in, vxm_error *error);
void vxm_track_destroy(vxm_track *track);
/** Begins a stage. */
vxm_status vxm_track_start(vxm_track *track, const vxm_soup *soup, vxm_error *error);
/** Vertices merge: map[v] takes the place of v. Between stages nobody looks. */
void vxm_track_merge(vxm_track *track, const uint32_t *map);
/** Ends a stage: sees how far vertices were moved in it. */
vxm_status vxm_track_settle(vxm_track *track, const vxm_soup *soup, vxm_error *error);
/** Notes the volumes that max_change refers to, in the first stage, once faces are turned and repeated ones
 * gone. */
vxm_status vxm_track_refer(vxm_track *track, const vxm_soup *soup, vxm_error *error);
/** A face of a part was turned, in the end. */
void vxm_track_turn(vxm_track *track, uint32_t part);
size_t vxm_track_part_count(const vxm_track *track);
/** A part was to be united and could not be; false if that was known. */
bool vxm_track_leave(vxm_track *track, uint32_t part);
/** A part is to have no faces. */
void vxm_track_drop(vxm_track *track, uint32_t part);
/**
 * Fills soup->part_changes.
 *
 * @param max_change see vxm_repair_options; 0 = any
 * @return VXM_OK; VXM_ERROR_UNREACHED if a part changed by more; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_track_finish(vxm_track *track, vxm_soup *soup, double max_change, vxm_error *error);
/** Then counts self-intersections, by part and in all: before and after. */
vxm_status vxm_track_count_crossings(vxm_track *track, vxm_soup *soup, int64_t totals[2], vxm_error *error);

#endif
