/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/orient2d.h"

#include <math.h>

enum { TERMS = 12 };

/** A sum of doubles that do not overlap, from the least to the greatest; zeros between them are allowed. */
typedef struct expansion {
  double term[TERMS];
  int count;
} expansion;

/** Adds a number, exactly (Shewchuk's GROW-EXPANSION): each step leaves what rounding took away. */
static void add(expansion *sum, double number) {
  for (int i = 0; i < sum->count; i++) {
    double most = number + sum->term[i], part = most - number;
    sum->term[i] = (number - (most - part)) + (sum->term[i] - part);
    number = most;
  }
  sum->term[sum->count++] = number;
}

static void add_product(expansion *sum, double a, double b) {
  double product = a * b;
  add(sum, fma(a, b, -product));
  add(sum, product);
}

int vxm_orient2d_exact(const double a[2], const double b[2], const double c[2]) {
  expansion sum = {.count = 0};
  add_product(&sum, a[0], b[1]);
  add_product(&sum, -a[1], b[0]);
  add_product(&sum, b[0], c[1]);
  add_product(&sum, -b[1], c[0]);
  add_product(&sum, c[0], a[1]);
  add_product(&sum, -c[1], a[0]);
  for (int i = TERMS - 1; i >= 0; i--)
    if (sum.term[i] != 0)
      return sum.term[i] > 0 ? 1 : sum.term[i] < 0 ? -1 : 0;
  return 0;
}
