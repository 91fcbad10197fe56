/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/label_solid.h"
#include "base/hash.h"
#include "voxel/fields/field.h"
#include "voxel/solid/self_overlap_fill.h"
#include "voxel/sparse/sparse.h"

#include <string.h>

/* ---- The faces of a piece as a soup of their own ---- */

static size_t corners_of(const vxm_label_components *pieces, const vxm_label_component *piece) {
  size_t sum = 0;
  for (size_t i = piece->first_face; i < piece->face_end; i++) {
    size_t n;
    vxm_face(pieces->soup, pieces->faces[i], &n);
    sum += n;
  }
  return sum;
}

/** The least power of two that leaves half of the slots free. */
static size_t slots_for(size_t corners) {
  size_t count = 64;
  while (count < 2 * corners)
    count *= 2;
  return count;
}

static vxm_status clear_scratch(vxm_label_component_scratch *scratch, vxm_context *context, size_t faces,
                                size_t corners, vxm_error *error) {
  vxm_status status = VXM_OK;
  if (!scratch->soup)
    status = vxm_soup_create(&scratch->soup, context, "piece", error);
  if (status == VXM_OK)
    status = vxm_soup_reserve(scratch->soup, 0, faces, corners, error);
  if (status == VXM_OK)
    status = vxm_grow(context, (void **)&scratch->vertex, &scratch->vertex_capacity, corners,
                      sizeof *scratch->vertex, error);
  if (status == VXM_OK)
    status = vxm_grow(context, (void **)&scratch->slots, &scratch->slot_capacity, slots_for(corners),
                      sizeof *scratch->slots, error);
  if (status != VXM_OK)
    return status;
  memset(scratch->slots, 0, slots_for(corners) * sizeof *scratch->slots);
  scratch->soup->vertex_count = scratch->soup->face_count = scratch->soup->corner_count = 0;
  return VXM_OK;
}

/** The place of a vertex in the soup, where it is put if it is not there. */
static vxm_status take_vertex(vxm_label_component_scratch *scratch, const vxm_soup *from, uint32_t vertex,
                              size_t mask, uint32_t *out, vxm_error *error) {
  size_t slot = (size_t)vxm_mix(vertex) & mask;
  for (; scratch->slots[slot]; slot = (slot + 1) & mask) {
    *out = scratch->slots[slot] - 1;
    if (scratch->vertex[*out] == vertex)
      return VXM_OK;
  }
  const double *p = vxm_position(from, vertex);
  *out = (uint32_t)scratch->soup->vertex_count;
  scratch->vertex[*out] = vertex;
  scratch->slots[slot] = *out + 1;
  return vxm_soup_add_vertex(scratch->soup, p[0], p[1], p[2], error);
}

static vxm_status gather_faces(vxm_label_component_scratch *scratch, const vxm_label_components *pieces,
                               const vxm_label_component *piece, vxm_error *error) {
  size_t corners = corners_of(pieces, piece), mask = slots_for(corners) - 1;
  vxm_status status =
      clear_scratch(scratch, pieces->context, piece->face_end - piece->first_face, corners, error);
  vxm_soup *soup = scratch->soup;
  for (size_t i = piece->first_face; i < piece->face_end && status == VXM_OK; i++) {
    size_t n;
    const uint32_t *corner = vxm_face(pieces->soup, pieces->faces[i], &n);
    for (size_t c = 0; c < n && status == VXM_OK; c++)
      status =
          take_vertex(scratch, pieces->soup, corner[c], mask, &soup->indices[soup->corner_count++], error);
    soup->offsets[++soup->face_count] = soup->corner_count;
  }
  return status;
}

void vxm_label_component_scratch_destroy(vxm_label_component_scratch *scratch, vxm_context *context) {
  vxm_soup_destroy(scratch->soup);
  vxm_free(context, scratch->vertex);
  vxm_free(context, scratch->slots);
  *scratch = (vxm_label_component_scratch){.soup = NULL};
}

uint64_t vxm_label_component_bytes(const vxm_label_components *pieces, const vxm_label_component *piece) {
  enum { BYTES = 256 }; /* of all the arrays, for each corner */
  return corners_of(pieces, piece) * BYTES;
}

/* ---- Its solid ---- */

vxm_space vxm_label_component_space(const vxm_label_component *piece, const vxm_space *whole) {
  vxm_space space = *whole;
  for (int a = 0; a < 3; a++) {
    space.origin[a] += (double)piece->begin[a] * space.voxel_size[a];
    space.dims[a] = piece->end[a] - piece->begin[a];
  }
  return space;
}

/**
 * Whether one component stays open: a sheet, or a patch of a surface whose other patches have other labels.
 * It bounds nothing, while to find out how it is turned would cost more than all else. Several may be panels
 * of one body, on which the voters agree.
 */
static bool has_lone_sheet(const vxm_model *model) {
  const vxm_split *split = &model->analysis.triangles.split;
  const vxm_voxelize_options *options = &model->options;
  if (options->method != VXM_METHOD_VOTE || options->vote != VXM_VOTE_AUTO ||
      options->split_mode == VXM_SPLIT_MODE_WHOLE)
    return false;
  return split->component_count - split->cavity_count - split->kind_end[VXM_PART_CAPPED] == 1;
}

/** Fills slices with the parts that are closed, or closed by caps. */
static vxm_status fill_without_sheets(vxm_voxel_pass *pass, const vxm_window *window, vxm_error *error) {
  size_t end = pass->analysis->triangles.split.kind_end[VXM_PART_CAPPED];
  if (end > 0) {
    vxm_status status =
        vxm_voxel_pass_unite(pass, window, window->layout.fast, 0, end, VXM_ROLE_FACE | VXM_ROLE_CAP, error);
    return status == VXM_OK ? vxm_self_overlap_fill(pass, window, error) : status;
  }
  memset(window->words, 0,
         window->slice_words * (size_t)(window->end - window->begin) * sizeof *window->words);
  return VXM_OK;
}

static vxm_status fill(vxm_model *model, const vxm_window *window, const vxm_lattice *lattice, bool at_once,
                       vxm_error *error) {
  vxm_field_plan plan = {.slices = window->slow_dim};
  vxm_model_pass *pass = NULL;
  bool is_without = has_lone_sheet(model);
  vxm_status status = VXM_OK;
  if (!at_once)
    status = vxm_field_plan_of(&plan, model, &lattice->space, window->layout, 1, true, 0, 0, 1, error);
  if (status == VXM_OK)
    status = vxm_model_begin_on(&pass, model, lattice, NULL, NULL, error);
  vxm_window part = *window;
  for (int64_t begin = 0; begin < window->slow_dim && status == VXM_OK; begin = part.end) {
    part.begin = begin;
    part.end = vxm_min(begin + plan.slices, window->slow_dim);
    part.words = window->words + (size_t)begin * window->slice_words;
    status = is_without ? fill_without_sheets(&pass->solid, &part, error)
                        : vxm_model_pass_fill(pass, &part, error);
  }
  vxm_model_close(model, pass);
  return status;
}

/** The faces of a piece as a model; NULL where none has an area. */
static vxm_status make_model(vxm_model **out, vxm_label_component_scratch *scratch,
                             const vxm_label_components *pieces, const vxm_label_component *piece,
                             const vxm_voxelize_options *options, vxm_error *error) {
  vxm_voxelize_options solid = *options;
  solid.mode = VXM_MODE_SOLID;
  solid.confidence = false;
  solid.thin = VXM_THIN_DROP; /* what holds thin parts together has the label of the nearest face */
  solid.engine = NULL;        /* pieces are too small for what an engine costs to start */
  vxm_error local = VXM_ERROR_INIT;
  *out = NULL;
  vxm_status status = gather_faces(scratch, pieces, piece, &local);
  if (status == VXM_OK)
    status = vxm_model_make(out, scratch->soup, &solid, &local);
  if (status == VXM_ERROR_EMPTY)
    return VXM_OK;
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_label_component_fill(vxm_label_component_scratch *scratch, const vxm_window *window,
                                    const vxm_label_components *pieces, const vxm_label_component *piece,
                                    const vxm_voxelize_options *options, const vxm_lattice *lattice,
                                    bool at_once, vxm_error *error) {
  vxm_lattice own = *lattice;
  own.space = vxm_label_component_space(piece, &lattice->space);
  vxm_model *model;
  vxm_status status = make_model(&model, scratch, pieces, piece, options, error);
  if (status == VXM_OK && model)
    status = fill(model, window, &own, at_once, error);
  else if (status == VXM_OK)
    memset(window->words, 0, window->slice_words * (size_t)window->slow_dim * sizeof *window->words);
  vxm_model_destroy(model);
  return status;
}

/* ---- As an octree ---- */

/** Slices of a box's window that begin and end at nodes of the whole space. */
static int64_t next_slice(const vxm_label_component *piece, int64_t begin, int64_t slices, int64_t end) {
  enum { NODE = 16 };
  int64_t next = begin + slices, over = (piece->begin[2] + next) % NODE;
  return vxm_min(next - (over < slices ? over : 0), end);
}

/** Range of slices after range, each as a window. */
static vxm_status add_windows(vxm_octree_pieces *out, vxm_model *model, const vxm_label_component *piece,
                              const vxm_lattice *whole, bool is_without, vxm_error *error) {
  const vxm_layout layout = VXM_LAYOUT_GRID;
  vxm_lattice own = *whole;
  vxm_field_plan plan;
  vxm_model_pass *pass = NULL;
  vxm_error local = VXM_ERROR_INIT;
  own.space = vxm_label_component_space(piece, &whole->space);
  vxm_window part = vxm_window_of(&own.space, layout, 0, 0);
  vxm_status status = vxm_field_plan_of(&plan, model, &own.space, layout, 1, true, 0, 0, 1, &local);
  if (status == VXM_OK) {
    part.words =
        vxm_alloc(model->context, (size_t)plan.slices * part.slice_words, sizeof *part.words, &local);
    status = local.code;
  }
  if (status == VXM_OK)
    status = vxm_model_begin_on(&pass, model, &own, NULL, NULL, &local);
  for (; part.end < part.slow_dim && status == VXM_OK;) {
    part.begin = part.end;
    part.end = next_slice(piece, part.begin, plan.slices, part.slow_dim);
    status = is_without ? fill_without_sheets(&pass->solid, &part, &local)
                        : vxm_model_pass_fill(pass, &part, &local);
    if (status == VXM_OK)
      vxm_octree_pieces_window(out, &part, piece->begin);
    if (status == VXM_OK)
      status = out->status;
  }
  vxm_model_close(model, pass);
  vxm_free(model->context, part.words);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/** Straight from the triangles. */
static vxm_status make_octree(vxm_sparse **out, vxm_model *model, const vxm_lattice *whole, bool is_without,
                              vxm_error *error) {
  vxm_model_pass *pass;
  vxm_status status = vxm_model_begin_on(&pass, model, whole, NULL, NULL, error);
  if (status == VXM_OK)
    status = is_without ? vxm_sparse_closed(out, pass, error) : vxm_sparse_of_pass(out, model, pass, error);
  vxm_model_close(model, pass);
  return status;
}

typedef struct clip {
  vxm_octree_pieces *out;
  const vxm_label_component *piece;
} clip;

/** What lies in the piece's box. */
static void add_clipped(const vxm_sparse_piece *from, void *payload) {
  const clip *c = payload;
  int64_t begin[3], end[3];
  bool is_inside = true;
  for (int a = 0; a < 3; a++) {
    begin[a] = vxm_max(from->position[a], c->piece->begin[a]);
    end[a] = vxm_min(from->position[a] + from->side, c->piece->end[a]);
    is_inside &= end[a] - begin[a] == from->side;
  }
  if (from->bits == ~UINT64_C(0))
    vxm_octree_pieces_box(c->out, begin, end);
  else if (is_inside)
    vxm_octree_pieces_brick(c->out, from->position, from->bits);
  else
    vxm_octree_pieces_brick(c->out, from->position,
                            from->bits & vxm_octree_bits_within(from->position, begin, end));
}

vxm_status vxm_label_component_add(vxm_octree_pieces *out, vxm_label_component_scratch *scratch,
                                   const vxm_label_components *pieces, const vxm_label_component *piece,
                                   const vxm_voxelize_options *options, const vxm_lattice *lattice,
                                   bool is_small, vxm_error *error) {
  vxm_model *model;
  vxm_sparse *octree = NULL;
  vxm_status status = make_model(&model, scratch, pieces, piece, options, error);
  if (status != VXM_OK || !model)
    return status;
  bool is_without = has_lone_sheet(model);
  bool is_empty = is_without && model->analysis.triangles.split.kind_end[VXM_PART_CAPPED] == 0;
  if (!is_empty && !is_small && (is_without || vxm_sparse_is_direct(model)))
    status = make_octree(&octree, model, lattice, is_without, error);
  else if (!is_empty)
    status = add_windows(out, model, piece, lattice, is_without, error);
  if (octree && status == VXM_OK) {
    clip c = {out, piece};
    vxm_octree_walk(octree, piece->begin, piece->end, add_clipped, &c);
    status = out->status;
  }
  vxm_sparse_destroy(octree);
  vxm_model_destroy(model);
  return status;
}
