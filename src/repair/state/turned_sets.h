/* SPDX-License-Identifier: BSD-3-Clause */
/** Sets of faces of which it is known which ones run the other way than others of their set. */
#ifndef VXM_REPAIR_STATE_TURNED_SETS_H
#define VXM_REPAIR_STATE_TURNED_SETS_H

#include <stdbool.h>
#include <stddef.h>

/** A face in its set. */
typedef struct vxm_turned_link {
  size_t parent; /**< another face of it, or itself */
  bool against;  /**< it runs the other way than that */
} vxm_turned_link;

/** Each face a set of its own. */
static inline void vxm_turned_sets_begin(vxm_turned_link *links, size_t count) {
  for (size_t f = 0; f < count; f++)
    links[f] = (vxm_turned_link){.parent = f};
}

/** The face that stands for a set, and whether this one runs the other way; shortens the way there. */
static inline size_t vxm_turned_set_of(vxm_turned_link *links, size_t face, bool *against) {
  size_t root = face;
  bool turned = false;
  for (; links[root].parent != root; root = links[root].parent)
    turned ^= links[root].against;
  *against = turned;
  for (size_t at = face; at != root;) {
    size_t next = links[at].parent;
    bool own = links[at].against;
    links[at].parent = root;
    links[at].against = turned;
    turned ^= own;
    at = next;
  }
  return root;
}

/** Makes one set of those of two faces, of which it is known whether they run the same way along an edge and
 * so against each other; does nothing if they are in one set. */
static inline void vxm_turned_sets_join(vxm_turned_link *links, size_t a, size_t b, bool same_way) {
  bool turned[2];
  size_t root = vxm_turned_set_of(links, a, &turned[0]), other = vxm_turned_set_of(links, b, &turned[1]);
  if (root == other)
    return;
  links[root].parent = other;
  links[root].against = (turned[0] != turned[1]) != same_way;
}

#endif
