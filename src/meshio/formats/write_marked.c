/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * PLY with coloured faces, and edges and vertices as thin rods. Few programs read edges of a .ply, and some
 * refuse the file for them, or for colours of faces where it is binary; triangles in text are shown by all.
 */
#include "meshio/formats/write_marked.h"
#include "base/exact_math.h"
#include "base/output.h"
#include "mesh/unit_scale.h"
#include "meshio/common/faces_out.h"
#include "meshio/common/text_out.h"

#include <inttypes.h>
#include <math.h>

/** Of the diagonal: the thickness of a rod. */
static const double THICK = 0.001;
enum { ROD_VERTICES = 6, ROD_FACES = 8 };

typedef struct marking {
  const vxm_soup *soup;
  const vxm_marks *marks;
  vxm_output *output;
  double thick;
  vxm_text_out text;
} marking;

static bool is_shown(const marking *m, const vxm_marked_edge *edge) {
  return vxm_is_finite(vxm_position(m->soup, edge->a)) && vxm_is_finite(vxm_position(m->soup, edge->b));
}

static size_t count_rods(const marking *m) {
  size_t count = 0;
  for (size_t e = 0; e < m->marks->edge_count; e++)
    count += is_shown(m, &m->marks->edges[e]);
  return count;
}

static void write_header(const marking *m, uint64_t vertices, uint64_t faces) {
  /* Readers know int for indices best; uint is for those beyond it. */
  vxm_output_printf(m->output,
                    "ply\nformat ascii 1.0\ncomment voxmend: what is wrong, in colour\n"
                    "element vertex %" PRIu64 "\nproperty double x\nproperty double y\nproperty double z\n"
                    "element face %" PRIu64 "\nproperty list uchar %s vertex_indices\n"
                    "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
                    vertices, faces, vertices > INT32_MAX ? "uint" : "int");
}

static void put_triangle(marking *m, const uint32_t corners[3], vxm_colour colour) {
  vxm_output_printf(m->output, "3 %" PRIu32 " %" PRIu32 " %" PRIu32 " %u %u %u\n", corners[0], corners[1],
                    corners[2], (unsigned)colour.red, (unsigned)colour.green, (unsigned)colour.blue);
}

/** Three corners around each end of an edge; a vertex is an edge of a rod's thickness. */
static void put_rod(marking *m, const vxm_marked_edge *edge) {
  const double *ends[2] = {vxm_position(m->soup, edge->a), vxm_position(m->soup, edge->b)};
  double along[3], u[3], v[3];
  for (size_t a = 0; a < 3; a++)
    along[a] = ends[1][a] / 2 - ends[0][a] / 2;
  double length = vxm_length3(along[0], along[1], along[2]);
  size_t least = 0;
  for (size_t a = 0; a < 3; a++) {
    along[a] = length > 0 ? along[a] / length : (double)(a == 2);
    least = fabs(along[a]) < fabs(along[least]) ? a : least;
  }
  for (size_t a = 0; a < 3; a++) /* the axis that it is farthest from, without its part along the edge */
    u[a] = (double)(a == least) - along[least] * along[a];
  for (size_t a = 0; a < 3; a++)
    v[a] = along[(a + 1) % 3] * u[(a + 2) % 3] - along[(a + 2) % 3] * u[(a + 1) % 3];
  for (int end = 0; end < 2; end++)
    for (int i = 0; i < 3; i++) {
      static const double circle[3][2] = {{1, 0}, {-0.5, 0.8660254037844386}, {-0.5, -0.8660254037844386}};
      double p[3], beyond = edge->a == edge->b ? (end ? 1 : -1) : 0;
      for (size_t a = 0; a < 3; a++)
        p[a] = ends[end][a] + m->thick * (beyond * along[a] + circle[i][0] * u[a] + circle[i][1] * v[a]);
      vxm_text_vertex(&m->text, "", p);
    }
}

/** The triangles of a face have its colour. */
static vxm_status write_faces(marking *m, vxm_error *error) {
  vxm_faces_out faces;
  vxm_status status = VXM_OK;
  vxm_faces_out_open(&faces, m->soup, false);
  for (size_t f = 0; f < m->soup->face_count && status == VXM_OK; f++) {
    status = vxm_faces_out_take(&faces, f, error);
    for (size_t p = 0; p < faces.pieces && status == VXM_OK; p++)
      put_triangle(m, faces.corners + 3 * p, m->marks->faces[f]);
  }
  vxm_faces_out_close(&faces);
  return status;
}

static void write_rod_faces(marking *m) {
  static const uint32_t faces[ROD_FACES][3] = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                                               {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  uint32_t first = (uint32_t)m->soup->vertex_count;
  for (size_t e = 0; e < m->marks->edge_count; e++) {
    if (!is_shown(m, &m->marks->edges[e]))
      continue;
    for (int f = 0; f < ROD_FACES; f++)
      put_triangle(m, (uint32_t[]){first + faces[f][0], first + faces[f][1], first + faces[f][2]},
                   m->marks->edges[e].colour);
    first += ROD_VERTICES;
  }
}

static vxm_status write_all(marking *m, vxm_error *error) {
  size_t rods = count_rods(m), vertices = m->soup->vertex_count;
  if (rods > (VXM_VERTICES_MAX - vertices) / ROD_VERTICES)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu edges and vertices at fault are more than .ply can show",
                    rods);
  write_header(m, vertices + ROD_VERTICES * (uint64_t)rods,
               vxm_faces_out_count(m->soup, false) + ROD_FACES * (uint64_t)rods);
  for (size_t v = 0; v < vertices; v++)
    vxm_text_vertex(&m->text, "", vxm_position(m->soup, v));
  for (size_t e = 0; e < m->marks->edge_count; e++)
    if (is_shown(m, &m->marks->edges[e]))
      put_rod(m, &m->marks->edges[e]);
  vxm_status status = write_faces(m, error);
  if (status == VXM_OK)
    write_rod_faces(m);
  return status;
}

/** The diagonal of what is finite. */
static double diagonal_of(const vxm_soup *soup) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t v = 0; v < soup->vertex_count; v++)
    for (size_t a = 0; a < 3 && vxm_is_finite(vxm_position(soup, v)); a++) {
      low[a] = fmin(low[a], vxm_position(soup, v)[a]);
      high[a] = fmax(high[a], vxm_position(soup, v)[a]);
    }
  double diagonal = vxm_length3(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  return isfinite(diagonal) ? diagonal : 0;
}

vxm_status vxm_meshio_write_marked(const vxm_soup *soup, const vxm_marks *marks, const char *path,
                                   vxm_error *error) {
  marking m = {.soup = soup, .marks = marks};
  if (!vxm_text_equal_nocase(vxm_path_extension(path), "ply"))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "%s: what is wrong is shown in .ply files; name one", path);
  m.thick = THICK * diagonal_of(soup);
  vxm_status status = vxm_output_open(&m.output, soup->context, path, error);
  if (status != VXM_OK)
    return status;
  m.text = (vxm_text_out){.output = m.output, .soup = soup};
  status = write_all(&m, error);
  if (status == VXM_OK)
    return vxm_output_commit(m.output, error);
  vxm_output_abort(m.output);
  return status;
}
