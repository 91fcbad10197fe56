/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/meetings.h"

#include <math.h>
#include <string.h>

typedef vxm_link_frame frame;

static frame frame_of(const vxm_thin_job *job, vxm_meetings *meetings, int direction) {
  const int8_t *step = vxm_link_step[direction];
  const vxm_view *view = &job->view;
  int w = step[2] ? 2 : step[1] ? 1 : 0;
  frame f = {.kept = view->words ? NULL : vxm_view_kept_bricks(view),
             .job = job,
             .meetings = meetings,
             .direction = direction,
             .w = w,
             .inner = -1,
             .plain = direction < VXM_LINK_AXES};
  f.u = view->step[(w + 1) % 3] < view->step[(w + 2) % 3] ? (w + 1) % 3
                                                          : (w + 2) % 3; /* rows along near bits */
  f.v = 3 - f.u - w;
  for (int a = 0; a < 3; a++) {
    int64_t shear = a == w ? 0 : step[a], far = view->end[w];
    f.shear[a] = shear;
    f.begin[a] = view->begin[a] - (shear > 0 ? far : 0);
    f.end[a] = view->end[a] + (a == w ? 1 : shear < 0 ? far : 0);
  }
  return f;
}

static void measure(vxm_link_surface *surface) {
  const double *size = surface->size;
  int longest = size[1] > size[0];
  longest = size[2] > size[longest] ? 2 : longest;
  surface->dominant = longest;
  surface->link_share =
      size[longest] > 0 ? llrint(vxm_link_surface_length(surface) / size[longest] * VXM_OFFSET_UNIT) : 0;
  surface->is_measured = true;
}

/** The ends of the link to voxel `to` of a column. */
static inline void ends_of(const frame *f, int64_t ends[2][3], int64_t column_u, int64_t column_v,
                           int64_t to) {
  const int8_t *step = vxm_link_step[f->direction];
  int64_t *lower = ends[0], *upper = ends[1];
  upper[f->u] = column_u + f->shear[f->u] * to;
  upper[f->v] = column_v + f->shear[f->v] * to;
  upper[f->w] = to;
  for (int a = 0; a < 3; a++)
    lower[a] = upper[a] - step[a];
}

/** A triangle crosses a link without a voxel at its ends. */
static void put_link(const frame *f, int64_t ends[2][3], double offset) {
  const vxm_view *view = &f->job->view;
  const int64_t *lower = ends[0], *upper = ends[1];
  if (!f->surface->is_measured)
    measure(f->surface);
  bool dominant = f->plain && f->surface->dominant == f->w;
  int64_t slice = lower[f->job->slow] < view->begin[f->job->slow] ? upper[f->job->slow] : lower[f->job->slow];
  if (dominant && slice >= f->job->counted[0] && slice < f->job->counted[1])
    f->meetings->thin_area += f->surface->link_share;
  vxm_thin_stage stage = f->plain
                             ? (dominant ? VXM_THIN_DOMINANT_LINKS : VXM_THIN_LINKS)
                             : (f->direction < VXM_LINK_EDGES ? VXM_THIN_EDGE_LINKS : VXM_THIN_CORNER_LINKS);
  vxm_meetings_put_link(f->meetings, view, stage, lower, f->direction, offset);
}

/** A triangle crosses the link to voxel `to` of a column, `offset` voxels beyond its middle: looks at the
 * ends. */
void vxm_meet_link(const vxm_link_frame *f, int64_t column_u, int64_t column_v, int64_t to, double offset) {
  int64_t ends[2][3];
  bool held;
  if (to < f->begin[f->w] || to >= f->end[f->w])
    return;
  ends_of(f, ends, column_u, column_v, to);
  if (!vxm_view_any_set(&f->job->view, (const int64_t(*)[3])ends, 2, &held) && held)
    put_link(f, ends, offset);
}

void vxm_keep_link(const vxm_link_frame *f, const int64_t lower[3], double offset) {
  int64_t ends[2][3] = {{lower[0], lower[1], lower[2]}, {lower[0], lower[1], lower[2]}};
  ends[1][f->w]++;
  put_link(f, ends, offset);
}

#define INTEGER int64_t
#define NAME(name) name##_narrow
#define RULE(name) name##_64
#include "voxel/thin/links_body.inc"
#undef INTEGER
#undef NAME
#undef RULE

#define INTEGER vxm_int128
#define NAME(name) name##_wide
#define RULE(name) name##_128
#include "voxel/thin/links_body.inc"
#undef INTEGER
#undef NAME
#undef RULE

/** The voxels whose centres a triangle's box reaches over along each axis, and the longest side of the box.
 */
static int64_t box_of(int64_t range[3][2], const vxm_lattice *lattice, const vxm_point corner[3]) {
  int64_t longest = 0;
  for (int a = 0; a < 3; a++) {
    int64_t low = vxm_min(vxm_min(corner[0].at[a], corner[1].at[a]), corner[2].at[a]);
    int64_t high = vxm_max(vxm_max(corner[0].at[a], corner[1].at[a]), corner[2].at[a]);
    longest = vxm_max(longest, high - low);
    range[a][0] = vxm_lattice_first(lattice, low);
    range[a][1] = vxm_lattice_first(lattice, high);
  }
  return longest;
}

/** A triangle in the frame of a direction, with its box there. */
static void cross_box(const frame *f, const vxm_point corner[3], int64_t range[3][2], int64_t longest) {
  const int64_t u[2] = {vxm_max(range[f->u][0], f->begin[f->u]), vxm_min(range[f->u][1], f->end[f->u])};
  const int64_t v[2] = {vxm_max(range[f->v][0], f->begin[f->v]), vxm_min(range[f->v][1], f->end[f->v])};
  if (u[0] >= u[1] || v[0] >= v[1] || range[f->w][0] >= f->end[f->w] || range[f->w][1] < f->begin[f->w])
    return;
  if (longest <= VXM_LATTICE_NARROW)
    cross_narrow(f, corner, u, v);
  else
    cross_wide(f, corner, u, v);
}

/** A triangle that has to be sheared. */
static void cross_sheared(const frame *f, const vxm_point points[3]) {
  const vxm_lattice *lattice = &f->job->placed->lattice;
  vxm_point corner[3];
  int64_t range[3][2];
  for (int k = 0; k < 3; k++)
    for (int a = 0; a < 3; a++)
      corner[k].at[a] = points[k].at[a] - f->shear[a] * (points[k].at[f->w] - lattice->unit / 2);
  int64_t longest = box_of(range, lattice, corner);
  cross_box(f, corner, range, longest);
}

int64_t vxm_link_voxel(const vxm_link_frame *f, const vxm_point points[3], int64_t column_u, int64_t column_v,
                       double *rest) {
  int64_t range[3][2], longest = box_of(range, &f->job->placed->lattice, points);
  return longest <= VXM_LATTICE_NARROW ? voxel_narrow(f, points, column_u, column_v, rest)
                                       : voxel_wide(f, points, column_u, column_v, rest);
}

void vxm_link_frames(vxm_link_frame frames[VXM_LINK_DIRECTIONS], const vxm_thin_job *job,
                     vxm_meetings *meetings) {
  for (int d = 0; d < job->directions; d++)
    frames[d] = frame_of(job, meetings, d);
}

/** Columns that are looked at, of a box that need not have any. */
static void narrow_to(int64_t range[3][2], const frame *f, const int64_t begin[3], const int64_t end[3]) {
  for (int a = 0; a < 3; a++)
    if (a != f->w) {
      range[a][0] = vxm_max(range[a][0], begin[a]);
      range[a][1] = vxm_min(range[a][1], end[a]);
    }
}

void vxm_meet_links(vxm_link_frame *frames, size_t triangle, uint64_t differ,
                    const vxm_unsure_links *unsure) {
  const vxm_thin_job *job = frames[0].job;
  vxm_point points[3];
  for (int k = 0; k < 3; k++)
    points[k] = vxm_snapped_points_at(job->placed, job->corners[triangle][k]);
  vxm_link_surface surface = vxm_link_surface_of(points);
  int64_t range[3][2], longest = box_of(range, &job->placed->lattice, points);
  for (int d = 0; d < job->directions; d++) {
    if (d < VXM_LINK_AXES &&
        (!(differ & vxm_cell_mask((d + 1) % 3)) || !(differ & vxm_cell_mask((d + 2) % 3))))
      continue;
    frames[d].surface = &surface;
    if (d < VXM_LINK_AXES) {
      int64_t columns[3][2];
      memcpy(columns, range, sizeof columns);
      if (unsure)
        narrow_to(columns, &frames[d], unsure->begin[d], unsure->end[d]);
      cross_box(&frames[d], points, columns, longest);
    } else
      cross_sheared(&frames[d], points);
  }
}
