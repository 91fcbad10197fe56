/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/probe_lines.h"

#include "base/box.h"

#include <string.h>

/** Cells of parts with few points, which are not worth many. Both numbers are primes: places lie between
 * cells, and what people draw lies at halves, tenths and the like. */
enum { FEW_POINTS = 256, FEW_CELLS = 61 };

/** Parts with more points than that are told by a sixteenth of them. */
enum { ALL_POINTS = 2048, SAMPLED_BITS = 4 };

/** Chosen places: number i lies between cells i - 1 and i. */
typedef bool chosen_places[VXM_PROBE_CELLS + 1];

/** As far from both ends, whichever end is the first: `even` is even, and the number of cells odd. */
static void choose_even(chosen_places chosen, int cells, int even) {
  for (int i = 0; i < even; i++)
    chosen[((2 * i + 1) * cells + even) / (2 * even)] = true;
}

/** Behind the cells that hold the points at equal shares of all, counted from either end to the middle. */
static void choose_by_points(chosen_places chosen, const uint32_t *points, int cells, size_t all, int even) {
  for (int end = 0; end < 2; end++) {
    size_t passed = 0;
    for (int i = 0, next = 0; i < cells && next < even / 2; i++) {
      passed += points[end ? cells - 1 - i : i];
      bool reached = false;
      for (; next < even / 2 && passed * 2 * (size_t)even > (size_t)(2 * next + 1) * all; next++)
        reached = true;
      if (reached)
        chosen[end ? cells - 1 - i : i + 1] = true;
    }
  }
}

static void place(vxm_probe_places *p, const chosen_places chosen) {
  p->count = 0;
  for (int i = 0; i < p->cells; i++) {
    if (i > 0 && chosen[i])
      p->at[p->count++] = p->low + i / p->cells_per_unit;
    p->below[i] = (uint8_t)p->count;
  }
  for (int i = 0; i < p->count; i++) {
    double before = i > 0 ? (p->at[i - 1] + p->at[i]) / 2 : p->low;
    double behind = i + 1 < p->count ? (p->at[i] + p->at[i + 1]) / 2 : p->low + p->cells / p->cells_per_unit;
    p->width[i] = (behind - before) * p->cells_per_unit;
  }
}

/** Makes the cells of an axis as wide as the points need; false if there is nothing to divide. */
static bool span(vxm_probe_places *p, double low, double high, size_t count) {
  p->cells = count < FEW_POINTS ? FEW_CELLS : VXM_PROBE_CELLS;
  p->low = low;
  p->cells_per_unit = p->cells / (high - low);
  return isnormal(p->cells_per_unit) && isnormal((high - low) / p->cells);
}

static inline int cell_of(const vxm_probe_places *p, double at) {
  double cell = (at - p->low) * p->cells_per_unit;
  return cell > 0 ? cell < p->cells ? (int)cell : p->cells - 1 : 0;
}

/** Whether a point is one of those by which others are judged: which are, hangs on where they lie. */
static inline bool is_sampled(const double *p) {
  uint64_t bits[3];
  memcpy(bits, p, sizeof bits);
  uint64_t mixed = (bits[0] ^ bits[1] << 1 ^ bits[2] << 2) << 3; /* without signs */
  return mixed * UINT64_C(0x9e3779b97f4a7c15) >> (64 - SAMPLED_BITS) == 0;
}

/** Counts points by cell along two axes; returns how many of them were counted. */
static size_t count_points(uint32_t in_cell[2][VXM_PROBE_CELLS], const vxm_probe_places *const places[2],
                           const int axes[2], const double (*points)[3], size_t count) {
  size_t counted = 0;
  bool all = count <= ALL_POINTS;
  for (int a = 0; a < 2; a++)
    memset(in_cell[a], 0, (size_t)places[a]->cells * sizeof **in_cell);
  for (size_t i = 0; i < count; i++) {
    if (!all && !is_sampled(points[i]))
      continue;
    counted++;
    for (int a = 0; a < 2; a++)
      in_cell[a][cell_of(places[a], points[i][axes[a]])]++;
  }
  return counted;
}

static bool measure(vxm_probe_places places[3], int *along, const double (*points)[3], size_t count) {
  double low[3], high[3];
  vxm_box_empty(low, high);
  for (size_t i = 0; i < count; i++)
    vxm_box_include(low, high, points[i]);
  *along = 0;
  for (int a = 0; a < 3; a++) {
    places[a].count = 0;
    if (!span(&places[a], low[a], high[a], count))
      return false;
    *along = high[a] - low[a] <= high[*along] - low[*along] ? a : *along;
  }
  return true;
}

bool vxm_probe_lines_lay(int *along, vxm_probe_places places[3], vxm_probe_cell *cells,
                         const double (*points)[3], size_t count, int even) {
  if (!measure(places, along, points, count))
    return false;
  const int axes[2] = {(*along + 1) % 3, (*along + 2) % 3};
  vxm_probe_places *laid[2] = {&places[axes[0]], &places[axes[1]]};
  uint32_t in_cell[2][VXM_PROBE_CELLS];
  size_t counted =
      count_points(in_cell, (const vxm_probe_places *const[2]){laid[0], laid[1]}, axes, points, count);
  for (int a = 0; a < 2; a++) {
    chosen_places chosen = {false};
    choose_even(chosen, laid[a]->cells, even);
    choose_by_points(chosen, in_cell[a], laid[a]->cells, counted, even < VXM_PROBE_EVEN ? even - 2 : even);
    place(laid[a], chosen);
  }
  for (size_t i = 0; i < count; i++)
    cells[i] = (vxm_probe_cell)vxm_probe_below(laid[0], points[i][axes[0]]) << 8 * axes[0] |
               (vxm_probe_cell)vxm_probe_below(laid[1], points[i][axes[1]]) << 8 * axes[1];
  return true;
}
