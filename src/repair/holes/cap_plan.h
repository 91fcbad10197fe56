/* SPDX-License-Identifier: BSD-3-Clause */
/** The rims of holes, the triangles that would close them, and adding those that are wanted. */
#ifndef VXM_REPAIR_HOLES_CAP_PLAN_H
#define VXM_REPAIR_HOLES_CAP_PLAN_H

#include "mesh/caps.h"
#include "repair/state/repair_state.h"

typedef struct vxm_cap_plan {
  vxm_repair_state *state;
  vxm_soup *soup;
  vxm_error error; /**< of the last step that failed */
  double scale;    /**< of lengths and areas, see vxm_unit_scale */
  size_t most;     /**< edges of a loop that is closed */
  vxm_boundary_loops loops;
  vxm_caps caps;
  size_t *edge_face;          /**< per edge: its first face */
  size_t *triangles, *points; /**< per loop, and one more: where those of its cap begin */
  uint8_t *wanted;            /**< per loop: whether its cap is added */
} vxm_cap_plan;

/** Finds the loops of odd edges; there are no caps as yet, and none is wanted. False: see p->error. */
bool vxm_cap_plan_begin(vxm_cap_plan *p, vxm_repair_state *state, size_t most);
/** Frees all, also after a failure. @return VXM_OK if `done`, else p->error */
vxm_status vxm_cap_plan_end(vxm_cap_plan *p, bool done, vxm_error *error);
/** Adds the caps that are wanted to the soup, and returns of how many loops; -1: see p->error. */
int64_t vxm_cap_plan_close(vxm_cap_plan *p);

/** A block of zeros, or NULL: see p->error. */
void *vxm_cap_plan_allocate(vxm_cap_plan *p, size_t count, size_t size);

static inline size_t vxm_cap_plan_edges(const vxm_cap_plan *p, size_t loop) {
  return p->loops.begin[loop + 1] - p->loops.begin[loop];
}

/** A face at the rim of a loop. */
static inline size_t vxm_cap_plan_face(const vxm_cap_plan *p, size_t loop) {
  return p->edge_face[p->loops.edge[p->loops.begin[loop]]];
}

/** Whether each edge of a loop has one face, and all these run one way along it. */
bool vxm_cap_plan_is_plain(const vxm_cap_plan *p, size_t loop);
/** Makes the cap of the next loop. False: see p->error. */
bool vxm_cap_plan_add(vxm_cap_plan *p, size_t loop);
/** Adds triangles between old vertices. False: see p->error. */
bool vxm_cap_plan_take(vxm_cap_plan *p, const uint32_t (*triangles)[3], size_t count);
/** The next loop has the triangles that were added since, or none. */
void vxm_cap_plan_pass(vxm_cap_plan *p, size_t loop);
/** The area of a cap. */
static inline double vxm_cap_plan_area(const vxm_cap_plan *p, size_t loop) {
  return vxm_caps_area(&p->caps, p->triangles[loop], p->triangles[loop + 1]);
}

#endif
