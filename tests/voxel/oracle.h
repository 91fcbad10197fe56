/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A brute-force oracle for parity: every voxel centre is tested against every triangle on its own, with a
 * perturbation of real size instead of the symbolic rules. Coordinates are whole quarters of a voxel, |c| <=
 * 64, so that determinants are whole numbers far below 1/e: moving the centre by (e, e^2, e^3), e = 2^-24,
 * decides every tie as the symbolic perturbation does. Everything is computed in units of e^3.
 */
#ifndef TEST_VOXEL_ORACLE_H
#define TEST_VOXEL_ORACLE_H

#include <stdbool.h>
#include <stdint.h>

#define ORACLE_E 24

__extension__ typedef __int128 oracle_wide;

typedef struct oracle_triangle {
  int64_t at[3][3]; /* corner, axis; quarters of a voxel */
} oracle_triangle;

/* Does the ray from the moved centre of voxel (i,j,k) toward minus `axis` cross the triangle? */
static inline bool oracle_crosses(const oracle_triangle *t, const int64_t voxel[3], int axis) {
  oracle_wide one = (oracle_wide)1 << (3 * ORACLE_E), p[3];
  for (int a = 0; a < 3; a++)
    p[a] = (4 * voxel[a] + 2) * one + (one >> ((a + 1) * ORACLE_E));
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  int positive = 0, negative = 0;
  for (int s = 0; s < 3; s++) {
    const int64_t *a = t->at[s], *b = t->at[(s + 1) % 3];
    oracle_wide side = (b[u] - a[u]) * (p[v] - a[v] * one) - (b[v] - a[v]) * (p[u] - a[u] * one);
    positive += side > 0;
    negative += side < 0;
  }
  if (positive != 3 && negative != 3)
    return false;
  int64_t n[3];
  oracle_wide height = 0;
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3, c = (a + 2) % 3;
    n[a] = (t->at[1][b] - t->at[0][b]) * (t->at[2][c] - t->at[0][c]) -
           (t->at[1][c] - t->at[0][c]) * (t->at[2][b] - t->at[0][b]);
    height += (oracle_wide)n[a] * (p[a] - t->at[0][a] * one);
  }
  return (height > 0) == (n[axis] > 0) && n[axis] != 0 && height != 0;
}

static inline bool oracle_parity(const oracle_triangle *t, int count, const int64_t voxel[3], int axis) {
  int crossings = 0;
  for (int i = 0; i < count; i++)
    crossings += oracle_crosses(&t[i], voxel, axis);
  return crossings % 2 != 0;
}

#endif
