/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/sheets/offset_vector.h"

enum { ROUNDS = 16 };

void vxm_offset_sums_add(vxm_offset_sums *sums, vxm_vec3 normal, double weight) {
  double n[3] = {normal.x, normal.y, normal.z};
  for (int a = 0; a < 3; a++) {
    sums->normals[a] += weight * n[a] * n[a];
    sums->normals[3 + a] += weight * n[a] * n[(a + 1) % 3];
    sums->moved[a] += weight * n[a];
  }
  sums->weight += weight;
}

vxm_offset_sums vxm_offset_sums_without(const vxm_offset_sums *a, const vxm_offset_sums *b) {
  vxm_offset_sums rest = *a;
  for (int i = 0; i < 6; i++)
    rest.normals[i] -= b->normals[i];
  for (int i = 0; i < 3; i++)
    rest.moved[i] -= b->moved[i];
  rest.weight -= b->weight;
  return rest;
}

/** Turns axes p and q so that m[p][q] becomes 0 (Jacobi); the columns of `axes` follow. */
static void rotate(double m[3][3], double axes[3][3], int p, int q) {
  if (m[p][q] == 0)
    return;
  double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
  double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
  double c = 1 / sqrt(t * t + 1), s = t * c;
  for (int k = 0; k < 3; k++) {
    double kp = m[k][p], kq = m[k][q];
    m[k][p] = c * kp - s * kq;
    m[k][q] = s * kp + c * kq;
  }
  for (int k = 0; k < 3; k++) {
    double pk = m[p][k], qk = m[q][k];
    m[p][k] = c * pk - s * qk;
    m[q][k] = s * pk + c * qk;
    double kp = axes[k][p], kq = axes[k][q];
    axes[k][p] = c * kp - s * kq;
    axes[k][q] = s * kp + c * kq;
  }
}

vxm_vec3 vxm_offset_vector(const vxm_offset_sums *sums, double flat) {
  const double *n = sums->normals;
  double m[3][3] = {{n[0], n[3], n[5]}, {n[3], n[1], n[4]}, {n[5], n[4], n[2]}};
  double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, at[3] = {0, 0, 0};
  for (int round = 0; round < ROUNDS; round++) {
    rotate(m, axes, 0, 1);
    rotate(m, axes, 1, 2);
    rotate(m, axes, 0, 2);
  }
  double most = fmax(m[0][0], fmax(m[1][1], m[2][2]));
  for (int a = 0; a < 3 && most > 0; a++) {
    double along = 0;
    for (int k = 0; k < 3; k++)
      along += axes[k][a] * sums->moved[k];
    for (int k = 0; k < 3 && m[a][a] > flat * most; k++)
      at[k] += axes[k][a] * along / m[a][a];
  }
  double length = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
  double part = length > VXM_MITRE_LIMIT ? VXM_MITRE_LIMIT / length : 1;
  return (vxm_vec3){part * at[0], part * at[1], part * at[2]};
}

double vxm_offset_residual(const vxm_offset_sums *sums, vxm_vec3 vector) {
  const double *n = sums->normals, v[3] = {vector.x, vector.y, vector.z};
  double sum = sums->weight;
  for (int a = 0; a < 3; a++)
    sum += v[a] * (n[a] * v[a] + 2 * n[3 + a] * v[(a + 1) % 3] - 2 * sums->moved[a]);
  return sum > 0 ? sum : 0;
}
