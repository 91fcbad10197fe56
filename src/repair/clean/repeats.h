/* SPDX-License-Identifier: BSD-3-Clause */
/** What is known of faces that repeat each other, while it is decided how many of them stay. */
#ifndef VXM_REPAIR_CLEAN_REPEATS_H
#define VXM_REPAIR_CLEAN_REPEATS_H

#include "mesh/duplicate_faces.h"
#include "repair/state/edge_groups.h"
#include "repair/state/repair_state.h"

/** What is to be decided about a kind: all faces with the same corners. */
typedef enum vxm_face_kind {
  VXM_KIND_PLAIN = 0, /**< nothing */
  VXM_KIND_SHEET,     /**< as many of one orientation as of the other, or, where the group is not balanced, an
                         even     number in both */
  VXM_KIND_SAME_WAY   /**< several more of one orientation than of the other; where the group is not balanced,
                         an even number, all of one orientation */
} vxm_face_kind;

/** A set of kinds of faces that edges connect, all of them sheets or all of copies that run the same way;
 * stored at the face that stands for the set. */
typedef struct vxm_fin {
  bool touches;    /**< along an edge there are other faces */
  bool hangs;      /**< along such an edge an odd number of its kinds end */
  bool rimmed;     /**< the same along an edge without others */
  bool ends;       /**< along such an edge one of them ends alone */
  bool unbalanced; /**< of its kinds, taken once, more sides run along an edge one way than the other */
  int overlaps;    /**< edges with all other faces on one side of it, less those with some on either side */
  uint32_t least, most; /**< copies of any of its kinds that stay */
  size_t largest;       /**< its largest face */
  double area;          /**< of that */
} vxm_fin;

typedef struct vxm_repeats {
  vxm_repair_state *state;
  const vxm_soup *soup;
  const vxm_copies *copies;
  vxm_edge_groups groups;
  vxm_unit_scale frame;
  uint8_t *kinds;   /**< per face: of the first of its kind */
  uint8_t *turned;  /**< per first face that is there as often either way: 1 = the other side stays */
  uint32_t *keep;   /**< per first face: how many copies stay of its orientation, and of the other */
  size_t *parent;   /**< per first face: another one of its fin, or itself */
  vxm_fin *fins;    /**< per face that stands for one */
  size_t *at_edge;  /**< per edge, twice: 1 + the first sheet at it; the same for the same way */
  uint32_t *single; /**< per edge, twice: sides of such kinds, each taken once */
  uint32_t *sides;  /**< per edge, twice: sides of all their faces */
  int32_t *balance; /**< per edge, twice: of those of `single`, the ones that run forward less the others */
  double *fin_area, *rest_area; /**< per group: of the rimmed sheets, taken once, and of plain faces */
  uint8_t *tangled; /**< per group: without its fins, too, it has edges with more than two sides */
} vxm_repeats;

static inline bool vxm_repeats_is_first(const vxm_repeats *d, size_t face) {
  return d->copies[face].first == face;
}

static inline int64_t vxm_repeats_surplus(const vxm_copies *c) {
  return (int64_t)c->same - (int64_t)c->opposite;
}

static inline uint32_t vxm_repeats_kept(const vxm_repeats *d, size_t face) {
  return d->keep[2 * face] + d->keep[2 * face + 1];
}

/** Of a first face: whether one copy that stays is to run the other way than it. Most copies tell; where
 * there are as many of one orientation as of the other the side that looks away from the middle of the model
 * does, for all that hang together alike, whichever of them comes first in the file. */
bool vxm_repeats_is_turned(const vxm_repeats *d, size_t face);

/** Keeps one copy. */
static inline void vxm_repeats_keep_one(const vxm_repeats *d, size_t face, bool turned) {
  d->keep[2 * face + turned] = 1;
  d->keep[2 * face + !turned] = 0;
}

/** Joins kinds to fins, and sees what the edges tell of these. */
void vxm_repeats_find_fins(vxm_repeats *d);

/** A body that is there several times needs no more than one of them: takes away copies of such, and finds
 * the fins anew, until there is none. */
void vxm_repeats_peel(vxm_repeats *d);

#endif
