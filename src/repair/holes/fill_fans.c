/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/holes/fill_fans.h"

#include "mesh/components.h"
#include "mesh/geometry.h"
#include "repair/holes/cap_plan.h"

typedef struct closing {
  vxm_cap_plan plan;
  uint32_t *label; /**< per face: its component */
  size_t component_count;
  double *area, *cap_area; /**< per component */
} closing;

static uint32_t component_of(const closing *c, size_t loop) {
  return c->label[vxm_cap_plan_face(&c->plan, loop)];
}

static void measure_components(closing *c) {
  const vxm_soup *soup = c->plan.soup;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    c->area[c->label[f]] += vxm_vec3_length(vxm_polygon_area(soup->positions, corner, count, c->plan.scale));
  }
}

static bool plan_caps(closing *c) {
  vxm_cap_plan *p = &c->plan;
  for (size_t l = 0; l < p->loops.count; l++) {
    if (!vxm_cap_plan_add(p, l))
      return false;
    c->cap_area[component_of(c, l)] += vxm_cap_plan_area(p, l);
  }
  return true;
}

static bool begin(closing *c, vxm_repair_state *state, size_t most) {
  vxm_cap_plan *p = &c->plan;
  *c = (closing){.label = NULL};
  if (!vxm_cap_plan_begin(p, state, most))
    return false;
  c->label = vxm_cap_plan_allocate(p, p->soup->face_count, sizeof *c->label);
  if (!c->label ||
      vxm_components(state->context, p->soup, NULL, c->label, &c->component_count, &p->error) != VXM_OK)
    return false;
  c->area = vxm_cap_plan_allocate(p, c->component_count, sizeof *c->area);
  c->cap_area = vxm_cap_plan_allocate(p, c->component_count, sizeof *c->cap_area);
  if (!c->area || !c->cap_area)
    return false;
  measure_components(c);
  return plan_caps(c);
}

static vxm_status end(closing *c, bool done, vxm_error *error) {
  vxm_context *context = c->plan.state->context;
  vxm_free(context, c->cap_area);
  vxm_free(context, c->area);
  vxm_free(context, c->label);
  return vxm_cap_plan_end(&c->plan, done, error);
}

static bool is_sheet(const closing *c, uint32_t component) {
  return !(c->cap_area[component] < VXM_SHEET_PART * c->area[component]);
}

/** Components with loops that stay open; each is counted at its first loop and then marked as counted. */
static int64_t count_sheets(closing *c) {
  int64_t count = 0;
  for (size_t l = 0; l < c->plan.loops.count; l++) {
    uint32_t component = component_of(c, l);
    if (is_sheet(c, component)) {
      count++;
      c->cap_area[component] = -1;
    }
  }
  return count;
}

static void want_all(closing *c) {
  vxm_cap_plan *p = &c->plan;
  for (size_t l = 0; l < p->loops.count; l++)
    p->wanted[l] = vxm_cap_plan_edges(p, l) <= p->most && !is_sheet(c, component_of(c, l));
}

vxm_status vxm_fill_fans(vxm_repair_state *state, size_t most, int64_t *closed, vxm_error *error) {
  closing c;
  int64_t count = -1;
  if (begin(&c, state, most)) {
    want_all(&c);
    count = vxm_cap_plan_close(&c.plan);
  }
  if (count >= 0)
    state->open_parts = count_sheets(&c);
  *closed = count < 0 ? 0 : count;
  return end(&c, count >= 0, error);
}

vxm_status vxm_find_sheets(uint8_t *faces, vxm_repair_state *state, vxm_error *error) {
  closing c;
  bool done = begin(&c, state, SIZE_MAX);
  for (size_t f = 0; done && f < state->soup->face_count; f++)
    faces[f] = is_sheet(&c, c.label[f]);
  if (done)
    state->open_parts = count_sheets(&c);
  return end(&c, done, error);
}
