/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/repair_sets.h"
#include "mesh/census.h"
#include "mesh/face_sets.h"
#include "repair/repair.h"

#include <math.h>
#include <string.h>

#define NO_TAG UINT32_MAX

typedef struct work {
  const vxm_soup *in;
  vxm_context *context;
  vxm_set_faces sets;
  uint32_t *vertex; /**< of `in`: its number in its set, which has it alone */
  uint32_t *local;  /**< tag of `in`: its number in the set at hand, or NO_TAG */
  uint32_t *tags;   /**< those of the set at hand */
  size_t tag_count;
  vxm_soup *out;
  size_t tag_room, set_room; /**< of the faces of `out` */
  uint32_t *corners;         /**< of one face */
  size_t corner_room;
  vxm_repair_report report;
  vxm_error error; /**< of the last failure */
} work;

/* ---- A set as a soup of its own ---- */

static vxm_status take_tag(work *w, vxm_soup *piece, size_t face, uint32_t tag) {
  vxm_status status = VXM_OK;
  if (w->local[tag] == NO_TAG) {
    const char *name = w->in->tags[tag];
    w->tags[w->tag_count++] = tag;
    status = vxm_soup_add_tag(piece, name, strlen(name), &w->local[tag], &w->error);
  }
  piece->face_tags[face] = w->local[tag];
  return status;
}

static vxm_status take_face(work *w, vxm_soup *piece, size_t face) {
  size_t n;
  const uint32_t *corner = vxm_face(w->in, face, &n);
  vxm_status status =
      vxm_grow(w->context, (void **)&w->corners, &w->corner_room, n, sizeof *w->corners, &w->error);
  for (size_t c = 0; c < n && status == VXM_OK; c++) {
    uint32_t *at = &w->vertex[corner[c]];
    if (*at == VXM_NO_VERTEX) {
      const double *p = vxm_position(w->in, corner[c]);
      *at = (uint32_t)piece->vertex_count;
      status = vxm_soup_add_vertex(piece, p[0], p[1], p[2], &w->error);
    }
    w->corners[c] = *at;
  }
  return status == VXM_OK ? vxm_soup_add_face(piece, w->corners, n, &w->error) : status;
}

static vxm_status take_set(work *w, size_t set, vxm_soup **piece) {
  size_t begin = w->sets.begin[set], count = w->sets.begin[set + 1] - begin;
  vxm_status status = vxm_soup_create(piece, w->context, w->in->format, &w->error);
  if (status != VXM_OK)
    return status;
  (*piece)->face_tags = vxm_alloc(w->context, count, sizeof *(*piece)->face_tags, &w->error);
  status = (*piece)->face_tags ? vxm_soup_reserve(*piece, 0, count, 0, &w->error) : w->error.code;
  for (size_t i = 0; i < count && status == VXM_OK; i++) {
    size_t face = w->sets.faces[begin + i];
    status = take_face(w, *piece, face);
    if (status == VXM_OK)
      status = take_tag(w, *piece, i, w->in->face_tags[face]);
    if (status == VXM_OK)
      status = vxm_check_cancelled_at(i, w->context, &w->error);
  }
  return status;
}

/* ---- The repaired sets together ---- */

static vxm_status put_face(work *w, const vxm_soup *piece, size_t face, uint32_t first, bool turned) {
  size_t n;
  const uint32_t *corner = vxm_face(piece, face, &n);
  vxm_status status =
      vxm_grow(w->context, (void **)&w->corners, &w->corner_room, n, sizeof *w->corners, &w->error);
  for (size_t c = 0; c < n && status == VXM_OK; c++)
    w->corners[c] = first + corner[turned ? n - 1 - c : c];
  return status == VXM_OK ? vxm_soup_add_face(w->out, w->corners, n, &w->error) : status;
}

static vxm_status put_set(work *w, size_t set, const vxm_soup *piece, bool turned) {
  vxm_soup *out = w->out;
  uint32_t first = (uint32_t)out->vertex_count;
  size_t before = out->face_count, faces = before + piece->face_count;
  vxm_status status =
      vxm_grow(w->context, (void **)&out->face_tags, &w->tag_room, faces, sizeof *out->face_tags, &w->error);
  if (status == VXM_OK)
    status = vxm_grow(w->context, (void **)&out->face_sets, &w->set_room, faces, sizeof *out->face_sets,
                      &w->error);
  if (status == VXM_OK)
    status = vxm_soup_add_vertices(out, piece, &w->error);
  for (size_t f = 0; f < piece->face_count && status == VXM_OK; f++) {
    /* what was made anew may have no tag */
    uint32_t tag = piece->face_tags && piece->face_tags[f] < w->tag_count ? piece->face_tags[f] : 0;
    out->face_tags[before + f] = w->tags[tag];
    out->face_sets[before + f] = (uint32_t)set;
    status = put_face(w, piece, f, first, turned);
    if (status == VXM_OK)
      status = vxm_check_cancelled_at(f, w->context, &w->error);
  }
  for (int i = 0; i < piece->warnings.count; i++)
    vxm_warn(&out->warnings, "%s", piece->warnings.text[i]);
  return status;
}

static void add_report(vxm_repair_report *sum, const vxm_repair_report *one) {
  for (int i = 0; i < one->pass_count; i++) {
    sum->passes[i].pass = one->passes[i].pass;
    sum->passes[i].count += one->passes[i].count;
  }
  sum->pass_count = one->pass_count;
  sum->nonorientable_patches += one->nonorientable_patches;
  sum->open_parts += one->open_parts;
  sum->filled_holes += one->filled_holes;
  sum->unfilled_holes += one->unfilled_holes;
  sum->fan_fallbacks += one->fan_fallbacks;
  sum->union_failures += one->union_failures;
  sum->union_tries = one->union_tries > sum->union_tries ? one->union_tries : sum->union_tries;
  sum->wrapped_parts += one->wrapped_parts;
  sum->self_intersections_before = one->self_intersections_before; /* -1: they are not looked for */
  sum->self_intersections_after = one->self_intersections_after;
  sum->unparted_vertices += one->unparted_vertices;
  sum->shared_faces += one->shared_faces;
  sum->lost_parts += one->lost_parts;
  sum->opened_parts += one->opened_parts;
  sum->emptied_parts += one->emptied_parts;
  sum->sheets += one->sheets;
}

/** Repairs a set and adds it to the result. */
static vxm_status repair_set(work *w, size_t set, const vxm_repair_options *options) {
  vxm_repair_report one = VXM_REPAIR_REPORT_INIT;
  vxm_soup *piece = NULL, *made = NULL;
  w->tag_count = 0;
  vxm_status status = take_set(w, set, &piece);
  int wound = status == VXM_OK ? vxm_faces_winding(piece, NULL, piece->face_count) : 0;
  if (status == VXM_OK)
    status = vxm_repair_prepare_owned(&made, &one, piece, options, &w->error);
  else
    vxm_soup_destroy(piece);
  if (status == VXM_OK) {
    bool turned = set > 0 && wound < 0 && vxm_faces_winding(made, NULL, made->face_count) > 0;
    add_report(&w->report, &one);
    status = put_set(w, set, made, turned);
  }
  vxm_soup_destroy(made);
  for (size_t t = 0; t < w->tag_count; t++)
    w->local[w->tags[t]] = NO_TAG;
  return status;
}

/* ---- Their order ---- */

/** Gives each tag its place in the order in which they first occur. */
static void rank_tags(const vxm_soup *in, uint32_t *rank) {
  uint32_t next = 0;
  for (size_t t = 0; t < in->tag_count; t++)
    rank[t] = NO_TAG;
  for (size_t f = 0; f < in->face_count; f++)
    if (rank[in->face_tags[f]] == NO_TAG)
      rank[in->face_tags[f]] = next++;
}

/** Faces as they are to be ordered. */
typedef struct ordered {
  uint64_t *offsets;
  uint32_t *indices, *tags, *sets;
} ordered;

/** @param next of each rank the face and the corner to come, and of one rank more */
static void order_faces(ordered *to, const vxm_soup *from, const uint32_t *rank, size_t ranks,
                        uint64_t (*next)[2]) {
  for (size_t f = 0; f < from->face_count; f++) {
    uint32_t above = rank[from->face_tags[f]] + 1;
    next[above][0]++;
    next[above][1] += from->offsets[f + 1] - from->offsets[f];
  }
  for (size_t r = 1; r <= ranks; r++)
    for (int i = 0; i < 2; i++)
      next[r][i] += next[r - 1][i];
  for (size_t f = 0; f < from->face_count; f++) {
    uint64_t *at = next[rank[from->face_tags[f]]];
    size_t n;
    const uint32_t *corner = vxm_face(from, f, &n);
    memcpy(to->indices + at[1], corner, n * sizeof *corner);
    to->tags[at[0]] = from->face_tags[f];
    to->sets[at[0]] = from->face_sets[f];
    at[1] += n;
    to->offsets[++at[0]] = at[1];
  }
}

/** Sorts the faces of the result. */
static vxm_status sort_faces(work *w) {
  vxm_soup *out = w->out;
  vxm_context *context = w->context;
  size_t faces = out->face_count, ranks = w->in->tag_count;
  uint32_t *rank = w->local;
  uint64_t(*next)[2] = vxm_calloc(context, ranks + 1, sizeof *next, &w->error);
  ordered to = {vxm_calloc(context, faces + 1, sizeof *to.offsets, &w->error),
                vxm_alloc(context, out->corner_count + 1, sizeof *to.indices, &w->error),
                vxm_alloc(context, faces, sizeof *to.tags, &w->error),
                vxm_alloc(context, faces, sizeof *to.sets, &w->error)};
  bool done = next && to.offsets && to.indices && to.tags && to.sets;
  if (done) {
    rank_tags(w->in, rank);
    order_faces(&to, out, rank, ranks, next);
    ordered old = {out->offsets, out->indices, out->face_tags, out->face_sets};
    out->offsets = to.offsets;
    out->indices = to.indices;
    out->face_tags = to.tags;
    out->face_sets = to.sets;
    out->face_capacity = faces;
    out->corner_capacity = out->corner_count + 1;
    to = old;
  }
  vxm_free(context, next);
  vxm_free(context, to.offsets);
  vxm_free(context, to.indices);
  vxm_free(context, to.tags);
  vxm_free(context, to.sets);
  return done ? VXM_OK : w->error.code;
}

/* ---- All of it ---- */

static vxm_status begin(work *w) {
  const vxm_soup *in = w->in;
  vxm_status status = vxm_set_faces_create(&w->sets, in, &w->error);
  if (status != VXM_OK)
    return status;
  w->vertex = vxm_alloc(w->context, in->vertex_count, sizeof *w->vertex, &w->error);
  w->local = vxm_alloc(w->context, in->tag_count, sizeof *w->local, &w->error);
  w->tags = vxm_alloc(w->context, in->tag_count, sizeof *w->tags, &w->error);
  if (!w->vertex || !w->local || !w->tags)
    return w->error.code;
  memset(w->vertex, 0xff, in->vertex_count * sizeof *w->vertex);
  memset(w->local, 0xff, in->tag_count * sizeof *w->local);
  status = vxm_soup_create(&w->out, w->context, in->format, &w->error);
  for (size_t t = 0; t < in->tag_count && status == VXM_OK; t++) {
    uint32_t tag;
    status = vxm_soup_add_tag(w->out, in->tags[t], strlen(in->tags[t]), &tag, &w->error);
  }
  if (status == VXM_OK) {
    w->out->warnings = in->warnings;
    w->out->set_count = in->set_count;
  }
  return status;
}

static vxm_status repair_all(work *w, const vxm_repair_options *options) {
  vxm_status status = VXM_OK;
  size_t faces = w->in->face_count;
  for (size_t s = 0; s < w->in->set_count && status == VXM_OK; s++) {
    size_t from = w->sets.begin[s], to = w->sets.begin[s + 1];
    if (from == to)
      continue;
    vxm_progress_part before = vxm_progress_enter((double)from / (double)faces, (double)to / (double)faces);
    status = repair_set(w, s, options);
    vxm_progress_leave(before);
  }
  return status;
}

static bool keeps_account(const vxm_repair_options *options) {
  return options && (options->part_changes || options->max_change > 0 || options->intersections);
}

vxm_status vxm_repair_prepare_sets(vxm_soup **out, vxm_repair_report *report, const vxm_soup *in,
                                   const vxm_repair_options *options, vxm_error *error) {
  *out = NULL;
  if (keeps_account(options))
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "repair: no account is kept of a mesh in sets; leave out part_changes, "
                    "max_change and intersections, or repair the mesh that vxm_mesh_divide was given");
  work w = {.in = in, .context = in->context, .error = VXM_ERROR_INIT};
  if (report)
    w.report = (vxm_repair_report){.before = report->before, .after = report->after};
  vxm_status status = w.report.before ? vxm_soup_census(w.report.before, in, &w.error) : VXM_OK;
  if (status == VXM_OK)
    status = begin(&w);
  if (status == VXM_OK)
    status = repair_all(&w, options);
  if (status == VXM_OK)
    status = sort_faces(&w);
  if (status == VXM_OK && w.report.after)
    status = vxm_soup_census(w.report.after, w.out, &w.error);
  if (status == VXM_OK && report)
    *report = w.report;
  vxm_free(w.context, w.corners);
  vxm_free(w.context, w.tags);
  vxm_free(w.context, w.local);
  vxm_free(w.context, w.vertex);
  if (w.sets.context)
    vxm_set_faces_destroy(&w.sets);
  if (status == VXM_OK) {
    *out = w.out;
    return VXM_OK;
  }
  vxm_soup_destroy(w.out);
  vxm_error_pass(error, &w.error);
  return status;
}
