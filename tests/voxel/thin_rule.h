/* SPDX-License-Identifier: BSD-3-Clause */
/** The rule by which voxels are chosen that hold thin parts together, carried out cell by cell: links along
 * the axes of normals, other links, squares, cubes, in order of their lowest voxels. */
#ifndef TEST_VOXEL_THIN_RULE_H
#define TEST_VOXEL_THIN_RULE_H

#include "thin_oracle.h"

/** What a triangle has in a cell: a link (kinds 0 to 12), a square (13 to 15, by axis) or a cube (16). */
typedef struct thin_record {
  int64_t lowest[3];
  uint64_t order;
  int stage, kind;
  int64_t from_middle[3]; /**< 2^20 a voxel; of a link, the first one is along it */
} thin_record;

typedef struct thin_records {
  thin_record *list;
  size_t count, capacity;
  const vxm_space *space;
} thin_records;

static inline void thin_note(thin_records *records, int stage, int kind, const int64_t lowest[3],
                             const double from_middle[3]) {
  if (records->count == records->capacity) {
    records->capacity = 2 * records->capacity + 64;
    records->list = realloc(records->list, records->capacity * sizeof *records->list);
    assert_non_null(records->list);
  }
  thin_record *r = &records->list[records->count++];
  *r = (thin_record){.stage = stage, .kind = kind};
  for (int a = 2; a >= 0; a--) {
    r->lowest[a] = lowest[a];
    r->from_middle[a] = llrint(ldexp(from_middle[a], 20));
    r->order = r->order * (uint64_t)(records->space->dims[a] + 2) + (uint64_t)(lowest[a] + 1);
  }
}

static inline void thin_note_links(thin_records *records, const thin_mesh *mesh, const thin_triangle *t,
                                   int directions) {
  const int64_t *dims = records->space->dims;
  int64_t v[3];
  for (v[2] = -1; v[2] <= dims[2]; v[2]++)
    for (v[1] = -1; v[1] <= dims[1]; v[1]++)
      for (v[0] = -1; v[0] <= dims[0]; v[0]++)
        for (int d = 0; d < directions; d++) {
          double along[3] = {0, 0, 0};
          if (!thin_crosses_link(mesh, t, v, thin_steps[d], &along[0]))
            continue;
          along[0] -= 0.5;
          thin_note(records, d < 3 ? thin_dominant(t) != d : d < 9 ? 2 : 3, d, v, along);
        }
}

static inline void thin_note_squares(thin_records *records, const thin_mesh *mesh, const thin_triangle *t) {
  for (int axis = 0; axis < 3; axis++)
    for (int64_t plane = 0; plane < records->space->dims[axis]; plane++) {
      int64_t lowest[3][3];
      double offset[3][3] = {{0}};
      int ends = 0;
      for (int k = 0; k < 3; k++) {
        const vxm_point *p = &t->at[k], *q = &t->at[(k + 1) % 3];
        if (!thin_passes(mesh, p, q, axis, plane, lowest[ends], offset[ends]))
          continue;
        ends++;
      }
      if (ends == 2 && memcmp(lowest[0], lowest[1], sizeof lowest[0]) == 0)
        for (int e = 0; e < 2; e++)
          thin_note(records, 4, 13 + axis, lowest[e], offset[e]);
    }
}

static inline void thin_note_cube(thin_records *records, const thin_mesh *mesh, const thin_triangle *t) {
  int64_t lowest[3];
  for (int a = 0; a < 3; a++) {
    lowest[a] = vxm_lattice_last(&mesh->lattice, t->at[0].at[a]) - 1;
    lowest[a] += t->at[0].at[a] > vxm_lattice_centre(&mesh->lattice, lowest[a] + 1);
  }
  for (int k = 0; k < 3; k++)
    if (!thin_is_in_cube(mesh, &t->at[k], lowest))
      return;
  for (int k = 0; k < 3; k++) {
    double offset[3];
    for (int a = 0; a < 3; a++)
      offset[a] =
          (double)(t->at[k].at[a] - (lowest[a] + 1) * mesh->lattice.unit) / (double)mesh->lattice.unit;
    thin_note(records, 5, 16, lowest, offset);
  }
}

static inline int thin_record_order(const void *a, const void *b) {
  const thin_record *p = a, *q = b;
  if (p->stage != q->stage)
    return p->stage - q->stage;
  if (p->kind != q->kind)
    return p->kind - q->kind;
  return (p->order > q->order) - (p->order < q->order);
}

/** Whether an end is the upper one along an axis: 1 or -1; 0 where the cell does not span the axis. */
static inline int thin_side(int kind, int axis, int end) {
  if (kind < 13)
    return axis == 0 ? (end ? 1 : -1) : 0;
  return kind == 13 + axis ? 0 : end >> axis & 1 ? 1 : -1;
}

/** Sets the voxel that the records of one cell ask for if none was set at its ends. */
static inline void thin_choose(const thin_record *r, size_t count, const vxm_space *space,
                               const uint8_t *before, uint8_t *bytes) {
  int64_t sum[3] = {0, 0, 0}, best = 0, chosen[3] = {-1, -1, -1};
  for (size_t i = 0; i < count; i++)
    for (int a = 0; a < 3; a++)
      sum[a] += r[i].from_middle[a];
  for (int end = 0; end < 8; end++) { /* the first of equally near ones, x changing first */
    int64_t v[3], near = 0;
    bool met = false, is_end = true;
    for (int a = 0; a < 3; a++) {
      int side = thin_side(r->kind, a, end);
      v[a] = r->lowest[a] + (r->kind < 13 ? (end & 1) * thin_steps[r->kind][a] : side > 0);
      near += side * sum[a];
      is_end &= side != 0 || r->kind < 13 || !(end >> a & 1);
    }
    if (!is_end || (r->kind < 13 && end > 1) || !thin_inside(space, v))
      continue;
    if (before[thin_at(space, v)])
      return;
    for (size_t i = 0; i < count && !met; i++) {
      met = true;
      for (int a = 0; a < 3; a++)
        met &= thin_side(r->kind, a, end) * r[i].from_middle[a] >= 0;
    }
    if (!met || (chosen[0] >= 0 && near <= best))
      continue;
    best = near;
    memcpy(chosen, v, sizeof chosen);
  }
  if (chosen[0] >= 0)
    bytes[thin_at(space, chosen)] = 1;
}

/** Adds to a solid what the rule has in 3 or 13 directions. */
static inline void thin_apply_rule(const thin_mesh *mesh, uint8_t *bytes, int directions) {
  thin_records records = {.space = &mesh->lattice.space};
  for (size_t t = 0; t < mesh->count; t++) {
    thin_note_links(&records, mesh, &mesh->triangles[t], directions);
    thin_note_squares(&records, mesh, &mesh->triangles[t]);
    thin_note_cube(&records, mesh, &mesh->triangles[t]);
  }
  if (records.count > 0)
    qsort(records.list, records.count, sizeof *records.list, thin_record_order);
  size_t size = thin_size(records.space);
  uint8_t *before = malloc(size);
  assert_non_null(before);
  for (size_t i = 0, next; i < records.count; i = next) {
    const thin_record *r = &records.list[i];
    if (i == 0 || r->stage != r[-1].stage)
      memcpy(before, bytes,
             size); /* all of a stage are chosen at once, so that turning a mesh turns its voxels */
    for (next = i + 1; next < records.count && records.list[next].stage == r->stage &&
                       records.list[next].order == r->order && records.list[next].kind == r->kind;
         next++)
      ;
    thin_choose(r, next - i, records.space, before, bytes);
  }
  free(before);
  free(records.list);
}

#endif
