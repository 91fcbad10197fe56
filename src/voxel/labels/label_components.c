/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/label_components.h"
#include "base/box.h"
#include "mesh/components.h"
#include "mesh/containment.h"
#include "mesh/edges.h"
#include "mesh/geometry.h"
#include "mesh/unit_scale.h"

#include <string.h>

/** A label that is none. */
#define SEVERAL UINT32_MAX

/** A component of the soup. */
typedef struct body {
  uint32_t label; /**< of all its faces; 0 = none so far, or SEVERAL */
  bool is_open;   /**< or it shares its label, or may have to do with another: not a piece of its own */
  double low[3], high[3], volume; /**< in the frame */
  size_t piece;
} body;

typedef struct builder {
  vxm_label_components *out;
  const vxm_face_labels *labelling;
  const vxm_soup *soup;
  uint32_t *component; /**< of every face */
  body *bodies;
  size_t body_count;
  vxm_error error; /**< of the last failure */
} builder;

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_calloc(b->soup->context, count, size, &b->error);
}

/* ---- Components ---- */

static vxm_status find_bodies(builder *b) {
  const vxm_face_labels *l = b->labelling;
  b->component = allocate(b, b->soup->face_count, sizeof *b->component);
  if (!b->component)
    return b->error.code;
  vxm_status status =
      vxm_components(b->soup->context, b->soup, NULL, b->component, &b->body_count, &b->error);
  b->bodies = status == VXM_OK ? allocate(b, b->body_count, sizeof *b->bodies) : NULL;
  if (!b->bodies)
    return b->error.code;
  for (size_t label = 1; label <= l->table.count; label++)
    for (size_t i = l->begin[label - 1]; i < l->begin[label]; i++) {
      body *of = &b->bodies[b->component[l->faces[i]]];
      of->label = of->label == 0 || of->label == label ? (uint32_t)label : SEVERAL;
    }
  return VXM_OK;
}

/** A component with an odd edge is open. */
static vxm_status find_open(builder *b) {
  vxm_edges edges;
  uint32_t *of_vertex = allocate(b, b->soup->vertex_count, sizeof *of_vertex);
  if (!of_vertex)
    return b->error.code;
  vxm_status status = vxm_edges_build(&edges, b->soup->context, b->soup, NULL, &b->error);
  for (size_t f = 0; status == VXM_OK && f < b->soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(b->soup, f, &n);
    for (size_t c = 0; c < n; c++)
      of_vertex[corner[c]] = b->component[f];
  }
  for (size_t e = 0; status == VXM_OK && e < edges.count; e++)
    if (vxm_edge_is_odd(&edges.edges[e]))
      b->bodies[of_vertex[edges.edges[e].a]].is_open = true;
  if (status == VXM_OK)
    vxm_edges_destroy(&edges);
  vxm_free(b->soup->context, of_vertex);
  return status;
}

/* ---- Cavities ---- */

static void bound_bodies(builder *b, double scale) {
  for (size_t i = 0; i < b->body_count; i++)
    vxm_box_empty(b->bodies[i].low, b->bodies[i].high);
  for (size_t f = 0; f < b->soup->face_count; f++) {
    body *of = &b->bodies[b->component[f]];
    size_t n;
    const uint32_t *corner = vxm_face(b->soup, f, &n);
    for (size_t c = 0; c < n; c++)
      for (int a = 0; a < 3; a++) {
        double x = vxm_position(b->soup, corner[c])[a] * scale;
        of->low[a] = x < of->low[a] ? x : of->low[a];
        of->high[a] = x > of->high[a] ? x : of->high[a];
      }
  }
}

/** Signed volumes; a corner that is not finite makes one NaN. */
static vxm_status measure_bodies(builder *b) {
  vxm_extent extent;
  if (vxm_extent_find(&extent, b->soup->context, b->soup, &b->error) != VXM_OK)
    return b->error.code;
  double scale = vxm_unit_scale_of(extent.bounds).scale;
  bound_bodies(b, scale);
  for (size_t f = 0; f < b->soup->face_count; f++) {
    body *of = &b->bodies[b->component[f]];
    size_t n;
    const uint32_t *corner = vxm_face(b->soup, f, &n);
    if (n < 3)
      continue;
    const double *p = vxm_position(b->soup, corner[0]);
    vxm_vec3 first = {p[0] * scale - (of->low[0] + of->high[0]) / 2,
                      p[1] * scale - (of->low[1] + of->high[1]) / 2,
                      p[2] * scale - (of->low[2] + of->high[2]) / 2};
    of->volume += vxm_polygon_cone(first, vxm_polygon_area(b->soup->positions, corner, n, scale));
  }
  return VXM_OK;
}

/** 1 = wound outward, -1 = inward, 0 = it cannot be told. */
static int sign_of(const body *of) {
  const double least = 1e-9;
  double box = (of->high[0] - of->low[0]) * (of->high[1] - of->low[1]) * (of->high[2] - of->low[2]);
  return of->volume > least * box ? 1 : of->volume < -least * box ? -1 : 0;
}

static bool boxes_meet(const body *p, const body *q) {
  for (int a = 0; a < 3; a++)
    if (p->low[a] > q->high[a] || q->low[a] > p->high[a])
      return false;
  return true;
}

/** Where most closed components of a label are wound one way, those that are not, and those beside them, may
 * be cavities and what has them. `list` are the closed components of the label. */
static void pool_cavities(builder *b, const uint32_t *list, size_t count) {
  const size_t most = (size_t)1 << 24; /* pairs to be looked at */
  size_t outward = 0;
  for (size_t i = 0; i < count; i++)
    outward += sign_of(&b->bodies[list[i]]) > 0;
  int usual = 2 * outward >= count ? 1 : -1;
  size_t others = 0;
  for (size_t i = 0; i < count; i++)
    others += sign_of(&b->bodies[list[i]]) != usual;
  for (size_t i = 0; i < count && others > 0; i++) {
    body *other = &b->bodies[list[i]];
    if (sign_of(other) == usual && others <= most / count)
      continue;
    other->is_open = true;
    for (size_t k = 0; k < count && others <= most / count; k++)
      if (boxes_meet(other, &b->bodies[list[k]]))
        b->bodies[list[k]].is_open = true;
  }
}

/** Lists the closed components of each label: the other ones cannot be pieces. */
static vxm_status pool_all_cavities(builder *b) {
  const vxm_face_labels *l = b->labelling;
  uint32_t *list = allocate(b, b->body_count, sizeof *list);
  if (!list)
    return b->error.code;
  for (size_t i = 0; i < b->body_count; i++)
    b->bodies[i].piece = SIZE_MAX; /* not listed so far */
  for (size_t label = 1; label <= l->table.count; label++) {
    size_t count = 0;
    for (size_t i = l->begin[label - 1]; i < l->begin[label]; i++) {
      uint32_t c = b->component[l->faces[i]];
      body *of = &b->bodies[c];
      if (of->is_open || of->label == SEVERAL || of->piece != SIZE_MAX)
        continue;
      of->piece = 0;
      list[count++] = c;
    }
    pool_cavities(b, list, count);
  }
  vxm_free(b->soup->context, list);
  return VXM_OK;
}

/* ---- Pieces ---- */

/** Each label is a piece, made of the labelling's own list of faces. */
static vxm_status take_labels(builder *b) {
  const vxm_face_labels *l = b->labelling;
  vxm_label_components *out = b->out;
  out->faces = allocate(b, b->soup->face_count, sizeof *out->faces);
  out->pieces = allocate(b, l->table.count, sizeof *out->pieces);
  if (!out->faces || !out->pieces)
    return b->error.code;
  if (b->soup->face_count > 0)
    memcpy(out->faces, l->faces, b->soup->face_count * sizeof *out->faces);
  out->count = l->table.count;
  for (size_t p = 0; p < out->count; p++)
    out->pieces[p] = (vxm_label_component){
        .label = (uint32_t)p + 1, .first_face = l->begin[p], .face_end = l->begin[p + 1]};
  return VXM_OK;
}

/** The piece that a face of a body belongs to, made if it is new: the body's own, or `pool`, which the
 * label's faces share that have none of their own. */
static size_t piece_of(builder *b, size_t label, body *of, size_t *pool) {
  vxm_label_components *out = b->out;
  size_t *piece = of->is_open || of->label == SEVERAL ? pool : &of->piece;
  if (*piece == SIZE_MAX) {
    *piece = out->count++;
    out->pieces[*piece] = (vxm_label_component){.label = (uint32_t)label};
  }
  return *piece;
}

/** Counts the faces of each piece. */
static void number_pieces(builder *b, uint32_t *number) {
  const vxm_face_labels *l = b->labelling;
  for (size_t i = 0; i < b->body_count; i++)
    b->bodies[i].piece = SIZE_MAX;
  for (size_t label = 1; label <= l->table.count; label++) {
    size_t pool = SIZE_MAX;
    for (size_t i = l->begin[label - 1]; i < l->begin[label]; i++) {
      uint32_t f = l->faces[i];
      size_t piece = piece_of(b, label, &b->bodies[b->component[f]], &pool);
      number[f] = (uint32_t)piece;
      b->out->pieces[piece].face_end++;
    }
  }
}

static vxm_status take_bodies(builder *b) {
  vxm_label_components *out = b->out;
  uint32_t *number = allocate(b, b->soup->face_count, sizeof *number);
  out->faces = allocate(b, b->soup->face_count, sizeof *out->faces);
  out->pieces = allocate(b, b->labelling->table.count + b->body_count, sizeof *out->pieces);
  if (!number || !out->faces || !out->pieces) {
    vxm_free(b->soup->context, number);
    return b->error.code;
  }
  number_pieces(b, number);
  size_t first = 0;
  for (size_t p = 0; p < out->count; p++) {
    size_t count = out->pieces[p].face_end;
    out->pieces[p].first_face = out->pieces[p].face_end = first;
    first += count;
  }
  for (size_t f = 0; f < b->soup->face_count; f++)
    out->faces[out->pieces[number[f]].face_end++] = (uint32_t)f;
  vxm_free(b->soup->context, number);
  return VXM_OK;
}

/* ---- Parts ---- */

/** Makes each part a body. */
static vxm_status find_parts(builder *b) {
  const vxm_face_labels *l = b->labelling;
  b->body_count = l->table.count;
  b->component = allocate(b, b->soup->face_count, sizeof *b->component);
  b->bodies = allocate(b, b->body_count, sizeof *b->bodies);
  if (!b->component || !b->bodies)
    return b->error.code;
  for (size_t label = 1; label <= l->table.count; label++)
    for (size_t i = l->begin[label - 1]; i < l->begin[label]; i++)
      b->component[l->faces[i]] = (uint32_t)label - 1;
  return find_open(b);
}

/** A part that is the skin of a cavity claims nothing: what stands in the cavity is not its own. */
static vxm_status empty_cavities(builder *b) {
  vxm_status status = find_parts(b);
  uint8_t *is_solid = status == VXM_OK ? allocate(b, b->body_count, sizeof *is_solid) : NULL;
  if (!is_solid)
    return b->error.code;
  for (size_t p = 0; p < b->body_count; p++)
    is_solid[p] = !b->bodies[p].is_open;
  vxm_containment inside;
  status = vxm_containment_build(&inside, b->soup, b->component, b->body_count, is_solid, &b->error);
  for (size_t p = 0; p < b->body_count && status == VXM_OK; p++)
    if (inside.body[p] != VXM_NO_COMPONENT)
      b->out->pieces[p].face_end = b->out->pieces[p].first_face;
  vxm_containment_destroy(&inside);
  vxm_free(b->soup->context, is_solid);
  return status;
}

/* ---- Boxes ---- */

static void add_to_box(vxm_label_component *piece, const vxm_lattice *lattice, const double p[3]) {
  vxm_point point;
  if (!vxm_lattice_place(lattice, p, &point))
    return;
  for (int a = 0; a < 3; a++) {
    piece->begin[a] = vxm_min(piece->begin[a], vxm_lattice_first(lattice, point.at[a]) - 1);
    piece->end[a] = vxm_max(piece->end[a], vxm_lattice_last(lattice, point.at[a]) + 2);
  }
}

/** Voxels whose centres lie within the bounds of the faces, and one more on all sides. */
static void find_box(const vxm_label_components *pieces, vxm_label_component *piece,
                     const vxm_lattice *lattice, int fast) {
  bool is_empty = false;
  for (int a = 0; a < 3; a++) {
    piece->begin[a] = INT64_MAX;
    piece->end[a] = INT64_MIN;
  }
  for (size_t i = piece->first_face; i < piece->face_end; i++) {
    size_t n;
    const uint32_t *corner = vxm_face(pieces->soup, pieces->faces[i], &n);
    for (size_t c = 0; c < n; c++)
      add_to_box(piece, lattice, vxm_position(pieces->soup, corner[c]));
  }
  for (int a = 0; a < 3; a++) {
    piece->begin[a] = vxm_max(piece->begin[a], 0);
    piece->end[a] = vxm_min(piece->end[a], lattice->space.dims[a]);
    is_empty = is_empty || piece->begin[a] >= piece->end[a];
  }
  if (is_empty)
    memset(piece->end, 0, sizeof piece->end);
  piece->begin[fast] = is_empty ? 0 : piece->begin[fast] / 64 * 64;
}

/* ---- All of it ---- */

/** Whether the solid of a label is that of its closed components apart and of the rest. */
static bool can_cut(const vxm_voxelize_options *options) {
  return options->split_mode != VXM_SPLIT_MODE_WHOLE && options->method != VXM_METHOD_WINDING &&
         options->cavities != VXM_CAVITIES_KEEP;
}

/** Whether components that are wound the other way are cavities of those around them. */
static bool has_cavities(const vxm_voxelize_options *options) {
  return options->cavities == VXM_CAVITIES_AUTO && options->split_mode == VXM_SPLIT_MODE_AUTO;
}

static vxm_status cut_labels(builder *b, const vxm_voxelize_options *options) {
  vxm_status status = find_bodies(b);
  if (status == VXM_OK)
    status = find_open(b);
  if (status == VXM_OK && has_cavities(options)) {
    status = measure_bodies(b);
    if (status == VXM_OK)
      status = pool_all_cavities(b);
  }
  return status == VXM_OK ? take_bodies(b) : status;
}

vxm_status vxm_label_components_create(vxm_label_components *out, const vxm_face_labels *labelling,
                                       const vxm_voxelize_options *options, const vxm_lattice *lattice,
                                       int fast, vxm_error *error) {
  const vxm_soup *soup = labelling->soup;
  builder b = {.out = out, .labelling = labelling, .soup = soup, .error = VXM_ERROR_INIT};
  *out = (vxm_label_components){.context = soup->context, .soup = soup};
  bool cuts = !labelling->is_by_part && can_cut(options);
  vxm_status status = cuts ? cut_labels(&b, options) : take_labels(&b);
  if (status == VXM_OK && labelling->is_by_part && out->count > 1 && has_cavities(options))
    status = empty_cavities(&b);
  for (size_t p = 0; p < out->count && status == VXM_OK; p++)
    find_box(out, &out->pieces[p], lattice, fast);
  vxm_free(soup->context, b.bodies);
  vxm_free(soup->context, b.component);
  if (status != VXM_OK)
    vxm_error_pass(error, &b.error);
  return status;
}

void vxm_label_components_destroy(vxm_label_components *pieces) {
  vxm_free(pieces->context, pieces->pieces);
  vxm_free(pieces->context, pieces->faces);
  pieces->pieces = NULL;
  pieces->faces = NULL;
}
