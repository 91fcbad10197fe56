/* SPDX-License-Identifier: BSD-3-Clause */
#include "remesh/dual_surface.h"

#include "remesh/cube_cycles.h"

#include <math.h>
#include <string.h>

/** The surface keeps at least this share of a link away from the centres at its ends, so that no two
 * vertices of a cell, or of neighbours, come to lie upon each other. */
static const double AWAY = 0.02;

/** Vertices of the four cells around a link: cell b + 2 c is on the side b along the next axis, c along the
 * one after. */
typedef uint32_t around[4];

struct vxm_dual_surface {
  vxm_context *context;
  vxm_soup *soup;
  vxm_space space;
  size_t nx, ny, row_words;
  int64_t slices;        /**< that were put in */
  uint64_t *bits[2];     /**< of the last slice and the one before it */
  float (*shares[2])[3]; /**< of the links that begin in these slices */
  around *flat[2][2];    /**< of the links along x and y in these slices, by the centre they begin at */
  around *upright;       /**< of the links between them */
  vxm_cube_cycles cycles[VXM_CUBE_CONFIGURATIONS];
  bool meets_itself;
};

static size_t centre(const vxm_dual_surface *s, size_t i, size_t j) {
  return j * s->nx + i;
}

static unsigned bit_at(const vxm_dual_surface *s, int slice, size_t i, size_t j) {
  return s->bits[slice][j * s->row_words + i / 64] >> (i % 64) & 1;
}

static void release(vxm_context *context, vxm_dual_surface *s) {
  if (!s)
    return;
  vxm_free(context, s->upright);
  for (int k = 0; k < 2; k++) {
    for (int a = 0; a < 2; a++)
      vxm_free(context, s->flat[k][a]);
    vxm_free(context, s->shares[k]);
    vxm_free(context, s->bits[k]);
  }
  vxm_soup_destroy(s->soup);
  vxm_free(context, s);
}

vxm_status vxm_dual_surface_create(vxm_dual_surface **out, vxm_context *context, const vxm_space *space,
                                   vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_dual_surface *s = *out = vxm_calloc(context, 1, sizeof *s, &local);
  if (s && vxm_soup_create(&s->soup, context, "remesh", &local) == VXM_OK) {
    s->context = context;
    s->space = *space;
    s->nx = (size_t)space->dims[0];
    s->ny = (size_t)space->dims[1];
    s->row_words = (s->nx + 63) / 64;
    size_t area = s->nx * s->ny;
    bool room = true;
    for (int k = 0; k < 2 && room; k++) {
      s->bits[k] = vxm_alloc(context, s->row_words * s->ny, sizeof *s->bits[k], &local);
      s->shares[k] = s->bits[k] ? vxm_alloc(context, area, sizeof *s->shares[k], &local) : NULL;
      for (int a = 0; a < 2 && s->shares[k]; a++)
        s->flat[k][a] = vxm_alloc(context, area, sizeof *s->flat[k][a], &local);
      room = local.code == VXM_OK;
    }
    if (room)
      s->upright = vxm_alloc(context, area, sizeof *s->upright, &local);
    vxm_cube_cycles_find(s->cycles);
  }
  if (local.code != VXM_OK) {
    release(context, s);
    *out = NULL;
    vxm_error_pass(error, &local);
  }
  return local.code;
}

void vxm_dual_surface_destroy(vxm_dual_surface *s) {
  if (s)
    release(s->context, s);
}

vxm_soup *vxm_dual_surface_take(vxm_dual_surface *s, bool *meets_itself) {
  vxm_soup *soup = s->soup;
  *meets_itself = s->meets_itself;
  s->soup = NULL;
  return soup;
}

/* ---- Vertices ---- */

/** Where the vertices of a cell are kept for a link of it: in which the cell is on the far side of where the
 * link is near, and the other way. */
static around *around_link(vxm_dual_surface *s, int link, size_t i, size_t j) {
  int corner = vxm_cube_link_begin(link), axis = link / 4;
  size_t at = centre(s, i + (size_t)(corner & 1), j + (size_t)(corner >> 1 & 1));
  return axis == 2 ? &s->upright[at] : &s->flat[corner >> 2][axis][at];
}

/** Gives the sheets of a cell their vertices. */
static vxm_status add_vertices(vxm_dual_surface *s, size_t i, size_t j, unsigned set, vxm_error *error) {
  const vxm_cube_cycles *c = &s->cycles[set];
  double sum[4][3] = {{0}};
  int count[4] = {0};
  for (int link = 0; link < VXM_CUBE_LINKS; link++) {
    if (c->cycle[link] == VXM_NO_CYCLE)
      continue;
    int p = vxm_cube_link_begin(link), axis = link / 4;
    double *at = sum[c->cycle[link]];
    for (int a = 0; a < 3; a++)
      at[a] += p >> a & 1;
    double share = (double)s->shares[p >> 2][centre(s, i + (size_t)(p & 1), j + (size_t)(p >> 1 & 1))][axis];
    at[axis] += fmin(fmax(share, AWAY), 1 - AWAY);
    count[c->cycle[link]]++;
    (*around_link(s, link, i, j))[3 - link % 4] = (uint32_t)(s->soup->vertex_count + c->cycle[link]);
  }
  const double cell[3] = {(double)i, (double)j, (double)(s->slices - 2)};
  vxm_status status = VXM_OK;
  for (int k = 0; k < c->count && status == VXM_OK; k++) {
    double p[3];
    for (int a = 0; a < 3; a++)
      p[a] = s->space.origin[a] + (cell[a] + 0.5 + sum[k][a] / count[k]) * s->space.voxel_size[a];
    status = vxm_soup_add_vertex(s->soup, p[0], p[1], p[2], error);
  }
  return status;
}

/** The cells between the last two slices. */
static vxm_status add_layer(vxm_dual_surface *s, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t j = 0; j + 1 < s->ny; j++) {
    const uint64_t *rows[4];
    for (size_t r = 0; r < 4; r++)
      rows[r] = s->bits[r / 2] + (j + r % 2) * s->row_words;
    for (size_t w = 0; w < s->row_words; w++) {
      uint64_t any = 0, all = ~UINT64_C(0), next_any = 0, next_all = 1;
      for (int r = 0; r < 4; r++) {
        any |= rows[r][w];
        all &= rows[r][w];
        next_any |= w + 1 < s->row_words ? rows[r][w + 1] & 1 : 0;
        next_all &= w + 1 < s->row_words ? rows[r][w + 1] : 0;
      }
      uint64_t mixed = (any | any >> 1 | next_any << 63) & ~(all & (all >> 1 | next_all << 63));
      for (; mixed && status == VXM_OK; mixed &= mixed - 1) {
        size_t i = 64 * w + (size_t)__builtin_ctzll(mixed);
        unsigned set = 0;
        for (unsigned c = 0; c < 8 && i + 1 < s->nx; c++)
          set |= bit_at(s, (int)(c >> 2), i + (c & 1), j + (c >> 1 & 1)) << c;
        s->meets_itself = s->meets_itself || s->cycles[set].meets_itself;
        status = add_vertices(s, i, j, set, error);
      }
    }
  }
  return status;
}

/* ---- Triangles ---- */

static double square_between(const vxm_soup *soup, uint32_t p, uint32_t q) {
  const double *a = vxm_position(soup, p), *b = vxm_position(soup, q);
  double sum = 0;
  for (int i = 0; i < 3; i++)
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

/** The quadrangle about a link, cut along its shorter diagonal; `outward`: the link begins at a set centre.
 */
static vxm_status add_quadrangle(vxm_dual_surface *s, const around cells, bool outward, vxm_error *error) {
  uint32_t ring[4] = {cells[0], cells[1], cells[3], cells[2]};
  if (!outward) {
    ring[1] = cells[2];
    ring[3] = cells[1];
  }
  size_t turn = square_between(s->soup, ring[0], ring[2]) > square_between(s->soup, ring[1], ring[3]);
  uint32_t first[3] = {ring[turn], ring[turn + 1], ring[turn + 2]};
  uint32_t second[3] = {ring[turn], ring[turn + 2], ring[(turn + 3) % 4]};
  vxm_status status = vxm_soup_add_face(s->soup, first, 3, error);
  return status == VXM_OK ? vxm_soup_add_face(s->soup, second, 3, error) : status;
}

/** Those of the links that begin in a row and are crossed, as `crossed` tells for word w. */
static vxm_status add_row(vxm_dual_surface *s, const around *links, const uint64_t *row, size_t w,
                          uint64_t crossed, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (; crossed && status == VXM_OK; crossed &= crossed - 1) {
    size_t bit = (size_t)__builtin_ctzll(crossed);
    status = add_quadrangle(s, links[64 * w + bit], row[w] >> bit & 1, error);
  }
  return status;
}

/** The links in a slice, once the cells on both its sides are done, and those upward from it. */
static vxm_status add_faces(vxm_dual_surface *s, int slice, bool upward, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t j = 0; j < s->ny; j++)
    for (size_t w = 0; w < s->row_words && status == VXM_OK; w++) {
      const uint64_t *row = s->bits[slice] + j * s->row_words;
      uint64_t after = row[w] >> 1 | (w + 1 < s->row_words ? row[w + 1] << 63 : 0);
      size_t first = centre(s, 0, j);
      status = add_row(s, s->flat[slice][0] + first, row, w, row[w] ^ after, error);
      if (status == VXM_OK && j + 1 < s->ny)
        status = add_row(s, s->flat[slice][1] + first, row, w, row[w] ^ row[w + s->row_words], error);
      if (status == VXM_OK && upward)
        status = add_row(s, s->upright + first, row, w, row[w] ^ s->bits[1][j * s->row_words + w], error);
    }
  return status;
}

static void exchange(vxm_dual_surface *s) {
  uint64_t *bits = s->bits[0];
  float(*shares)[3] = s->shares[0];
  s->bits[0] = s->bits[1];
  s->bits[1] = bits;
  s->shares[0] = s->shares[1];
  s->shares[1] = shares;
  for (int a = 0; a < 2; a++) {
    around *links = s->flat[0][a];
    s->flat[0][a] = s->flat[1][a];
    s->flat[1][a] = links;
  }
}

/** The outermost voxels count as empty: there is nothing beyond them to close the surface over. */
static void clear_border(vxm_dual_surface *s) {
  uint64_t *bits = s->bits[1];
  size_t slice_words = s->row_words * s->ny;
  if (s->slices == 0 || s->slices + 1 == s->space.dims[2])
    memset(bits, 0, slice_words * sizeof *bits);
  memset(bits, 0, s->row_words * sizeof *bits);
  memset(bits + slice_words - s->row_words, 0, s->row_words * sizeof *bits);
  for (size_t j = 0; j < s->ny; j++) {
    bits[j * s->row_words] &= ~UINT64_C(1);
    bits[j * s->row_words + (s->nx - 1) / 64] &= vxm_low_bits((unsigned)((s->nx - 1) % 64));
  }
}

vxm_status vxm_dual_surface_put(vxm_dual_surface *s, const uint64_t *bits, const float (*shares)[3],
                                vxm_error *error) {
  exchange(s);
  memcpy(s->bits[1], bits, s->row_words * s->ny * sizeof *bits);
  clear_border(s);
  memcpy(s->shares[1], shares, s->nx * s->ny * sizeof *shares);
  if (s->slices++ == 0)
    return VXM_OK;
  vxm_status status = add_layer(s, error);
  return status == VXM_OK ? add_faces(s, 0, true, error) : status;
}
