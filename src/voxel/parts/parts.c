/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parts/parts.h"
#include "mesh/components.h"
#include "mesh/containment.h"
#include "mesh/disjoint_sets.h"
#include "mesh/geometry.h"
#include "mesh/unit_scale.h"
#include "voxel/parts/lone_sheets.h"

#include <string.h>

/** What is needed while parts are numbered. */
typedef struct builder {
  vxm_split *split;
  const vxm_soup *soup;
  vxm_split_rule rule;
  uint8_t *kind;            /**< of every component */
  uint32_t *loop_component; /**< of every loop */
  vxm_opening *openings;    /**< of every component */
  uint32_t *root;           /**< component whose part a component shares */
  vxm_error error;          /**< of the last allocation that failed */
} builder;

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_calloc(b->split->context, count, size, &b->error);
}

/* ---- Loops ---- */

static vxm_status find_loops(builder *b, vxm_error *error) {
  vxm_split *s = b->split;
  vxm_status status = vxm_edges_build(&s->edges, s->context, b->soup, NULL, error);
  if (status != VXM_OK)
    return status;
  s->odd_edge_count = s->edges.odd;
  return s->odd_edge_count > 0 ? vxm_boundary_loops_build(&s->loops, b->soup, &s->edges, error) : VXM_OK;
}

/* ---- Components ---- */

static vxm_status find_components(builder *b, vxm_error *error) {
  vxm_split *s = b->split;
  s->component = allocate(b, b->soup->face_count, sizeof *s->component);
  if (!s->component)
    return b->error.code;
  s->component_count = 1;
  if (b->rule.split_mode == VXM_SPLIT_MODE_WHOLE || b->soup->component_count == 1)
    return VXM_OK;
  if (b->soup->component_count > 1) {
    s->component_count = b->soup->component_count;
    memcpy(s->component, b->soup->components, b->soup->face_count * sizeof *s->component);
    return VXM_OK;
  }
  return vxm_components(s->context, b->soup, NULL, s->component, &s->component_count, error);
}

/** The loops of a component, found through the component of their first vertex. */
static vxm_status assign_loops(builder *b) {
  vxm_split *s = b->split;
  if (s->loops.count == 0)
    return VXM_OK;
  uint32_t *of_vertex = allocate(b, b->soup->vertex_count, sizeof *of_vertex);
  b->loop_component = allocate(b, s->loops.count, sizeof *b->loop_component);
  if (!of_vertex || !b->loop_component) {
    vxm_free(s->context, of_vertex);
    return b->error.code;
  }
  for (size_t f = 0; f < b->soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(b->soup, f, &n);
    for (size_t c = 0; c < n; c++)
      of_vertex[corner[c]] = s->component[f];
  }
  for (size_t l = 0; l < s->loops.count; l++)
    b->loop_component[l] = of_vertex[s->loops.vertex[s->loops.begin[l]]];
  vxm_free(s->context, of_vertex);
  return VXM_OK;
}

/* ---- Kinds ---- */

/** Closes every loop, whether its part will be capped or not: that is what the areas tell. */
static vxm_status make_caps(builder *b, double scale, double *area) {
  vxm_split *s = b->split;
  s->cap_begin = allocate(b, s->loops.count + 1, sizeof *s->cap_begin);
  if (!s->cap_begin)
    return b->error.code;
  s->caps = (vxm_caps){.soup = b->soup, .edges = &s->edges, .scale = scale};
  for (size_t l = 0; l < s->loops.count; l++) {
    vxm_status status = vxm_caps_add(&s->caps, &s->loops, l, true, &b->error);
    if (status != VXM_OK)
      return status;
    s->cap_begin[l + 1] = s->caps.triangle_count;
    double cap = vxm_caps_area(&s->caps, s->cap_begin[l], s->cap_begin[l + 1]);
    double *widest = &b->openings[b->loop_component[l]].widest_cap;
    area[b->loop_component[l]] += cap;
    *widest = cap > *widest ? cap : *widest;
  }
  return VXM_OK;
}

/** A scale in which areas neither overflow nor vanish. */
static vxm_status find_scale(builder *b, double *scale) {
  vxm_extent extent;
  if (vxm_extent_find(&extent, b->split->context, b->soup, &b->error) != VXM_OK)
    return b->error.code;
  *scale = vxm_unit_scale_of(extent.bounds).scale;
  return VXM_OK;
}

/** Open components of which one cap alone is about as large as they are: sheets, if they stand alone. */
static vxm_status find_lone_sheets(builder *b, const double *area) {
  vxm_split *s = b->split;
  bool any = false;
  for (size_t c = 0; c < s->component_count; c++) {
    vxm_opening *o = &b->openings[c];
    o->open = b->kind[c] == VXM_PART_OPEN;
    o->lone = o->open && area[c] > 0 && o->widest_cap >= VXM_SHEET_PART * area[c];
    any |= o->lone;
  }
  if (!any)
    return VXM_OK;
  vxm_status status = vxm_lone_sheets_keep(b->openings, b->soup, s->component, s->component_count, &b->error);
  any = false;
  for (size_t c = 0; c < s->component_count && status == VXM_OK; c++)
    any |= b->openings[c].lone;
  if (!any)
    return status;
  s->lone = allocate(b, s->component_count, sizeof *s->lone);
  for (size_t c = 0; s->lone && c < s->component_count; c++)
    s->lone[c] = b->openings[c].lone;
  return s->lone ? VXM_OK : b->error.code;
}

static vxm_status find_kinds(builder *b) {
  vxm_split *s = b->split;
  b->kind = allocate(b, s->component_count, sizeof *b->kind);
  double *area = allocate(b, s->component_count, sizeof *area);
  double *caps = allocate(b, s->component_count, sizeof *caps);
  b->openings = allocate(b, s->component_count, sizeof *b->openings);
  if (!b->kind || !area || !caps || !b->openings) {
    vxm_free(s->context, caps);
    vxm_free(s->context, area);
    return b->error.code;
  }
  bool measure = b->rule.cap && s->loops.count > 0;
  double scale = 1;
  vxm_status status = measure ? find_scale(b, &scale) : VXM_OK;
  if (measure && status == VXM_OK)
    status = make_caps(b, scale, caps);
  for (size_t f = 0; measure && f < b->soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(b->soup, f, &n);
    area[s->component[f]] += vxm_polygon_fan_area(b->soup->positions, corner, n, scale);
  }
  for (size_t l = 0; l < s->loops.count; l++)
    b->kind[b->loop_component[l]] = VXM_PART_OPEN;
  for (size_t c = 0; c < s->component_count; c++)
    if (measure && b->kind[c] == VXM_PART_OPEN && caps[c] < VXM_SHEET_PART * area[c])
      b->kind[c] = VXM_PART_CAPPED;
  if (measure && status == VXM_OK)
    status = find_lone_sheets(b, area);
  vxm_free(s->context, caps);
  vxm_free(s->context, area);
  return status;
}

/* ---- Cavities ---- */

static vxm_status find_cavities(builder *b, vxm_error *error) {
  vxm_split *s = b->split;
  size_t solid_count = 0;
  b->root = allocate(b, s->component_count, sizeof *b->root);
  uint8_t *solid = allocate(b, s->component_count, sizeof *solid);
  if (!b->root || !solid) {
    vxm_free(s->context, solid);
    return b->error.code;
  }
  for (size_t c = 0; c < s->component_count; c++) {
    b->root[c] = (uint32_t)c;
    solid[c] = b->kind[c] != VXM_PART_OPEN;
    solid_count += solid[c];
  }
  vxm_status status = VXM_OK;
  if (b->rule.split_mode == VXM_SPLIT_MODE_AUTO && b->rule.cavities != VXM_CAVITIES_FILL && solid_count > 1) {
    vxm_containment containment;
    status = vxm_containment_build(&containment, b->soup, s->component, s->component_count, solid, error);
    for (size_t c = 0; status == VXM_OK && c < s->component_count; c++) {
      bool keep = b->rule.cavities == VXM_CAVITIES_KEEP;
      uint32_t body = keep ? containment.parent[c] : containment.body[c];
      if (body == VXM_NO_COMPONENT)
        continue;
      b->root[c] = body;
      s->cavity_count++;
    }
    vxm_containment_destroy(&containment);
  }
  /* A part with a capped component is capped. */
  for (size_t c = 0; status == VXM_OK && c < s->component_count; c++)
    if (b->kind[c] == VXM_PART_CAPPED)
      b->kind[vxm_set_of_u32(b->root, (uint32_t)c)] = VXM_PART_CAPPED;
  vxm_free(s->context, solid);
  return status;
}

/* ---- Numbers ---- */

static vxm_status number_parts(builder *b) {
  vxm_split *s = b->split;
  s->part = allocate(b, s->component_count, sizeof *s->part);
  s->loop_part = allocate(b, s->loops.count, sizeof *s->loop_part);
  if (!s->part || !s->loop_part)
    return b->error.code;
  size_t next = 0;
  for (int kind = VXM_PART_CLOSED; kind <= VXM_PART_OPEN; kind++) {
    bool pool = kind == VXM_PART_OPEN && b->rule.split_mode == VXM_SPLIT_MODE_AUTO;
    size_t first = next;
    for (size_t c = 0; c < s->component_count; c++)
      if (b->root[c] == c && b->kind[c] == kind) {
        s->part[c] = (uint32_t)(pool ? first : next);
        next = pool ? first + 1 : next + 1;
      }
    s->kind_end[kind] = next;
  }
  s->part_count = next;
  for (size_t c = 0; c < s->component_count; c++)
    s->part[c] = s->part[vxm_set_of_u32(b->root, (uint32_t)c)];
  for (size_t l = 0; l < s->loops.count; l++) {
    s->loop_part[l] = s->part[b->loop_component[l]];
    s->capped_loops += s->loop_part[l] < s->kind_end[VXM_PART_CAPPED];
  }
  return VXM_OK;
}

vxm_status vxm_split_create(vxm_split *out, const vxm_soup *soup, vxm_split_rule rule, vxm_error *error) {
  *out = (vxm_split){.context = soup->context};
  builder b = {.split = out, .soup = soup, .rule = rule, .error = VXM_ERROR_INIT};
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = soup->is_closed ? VXM_OK : find_loops(&b, &local);
  if (status == VXM_OK)
    status = find_components(&b, &local);
  if (status == VXM_OK)
    status = assign_loops(&b);
  if (status == VXM_OK)
    status = find_kinds(&b);
  if (status == VXM_OK)
    status = find_cavities(&b, &local);
  if (status == VXM_OK)
    status = number_parts(&b);
  vxm_free(soup->context, b.root);
  vxm_free(soup->context, b.openings);
  vxm_free(soup->context, b.kind);
  vxm_free(soup->context, b.loop_component);
  if (status != VXM_OK)
    vxm_error_pass(error, local.code != VXM_OK ? &local : &b.error);
  return status;
}

void vxm_split_trim(vxm_split *split) {
  vxm_context *context = split->context;
  if (split->cap_begin)
    vxm_caps_destroy(&split->caps);
  vxm_free(context, split->cap_begin);
  vxm_free(context, split->loop_part);
  vxm_free(context, split->part);
  vxm_free(context, split->component);
  vxm_free(context, split->lone);
  if (split->loops.context)
    vxm_boundary_loops_destroy(&split->loops);
  if (split->edges.context)
    vxm_edges_destroy(&split->edges);
  split->cap_begin = NULL;
  split->loop_part = split->part = split->component = NULL;
  split->lone = NULL;
}

void vxm_split_destroy(vxm_split *split) {
  vxm_split_trim(split);
  *split = (vxm_split){.context = split->context};
}
