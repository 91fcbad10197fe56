/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Lengths and angles by operations that IEEE 754 rounds in one way only, so that they have the same bits on
 * every machine: hypot and atan2 are rounded as the C library and the processor have it.
 */
#ifndef VXM_BASE_EXACT_MATH_H
#define VXM_BASE_EXACT_MATH_H

#include <math.h>

/** sqrt(x^2 + y^2 + z^2), which overflows and underflows only if the length does. */
static inline double vxm_length3(double x, double y, double z) {
  double most = fmax(fabs(x), fmax(fabs(y), fabs(z)));
  int exponent;
  if (!(most > 0) || isinf(most))
    return most;
  frexp(most, &exponent); /* scaled by a power of two the numbers keep their bits */
  x = ldexp(x, -exponent);
  y = ldexp(y, -exponent);
  z = ldexp(z, -exponent);
  return ldexp(sqrt(x * x + y * y + z * z), exponent);
}

/**
 * The angle, 0 to pi, of which sine >= 0 and cosine are given, both times the same number; 0 if both are 0.
 * The tangent of its sixteenth, at most 0.2, goes into the series of atan; the error is some units in the
 * last place.
 */
static inline double vxm_angle(double sine, double cosine) {
  const double pi = 3.141592653589793;
  double length = vxm_length3(sine, cosine, 0);
  if (sine == 0)
    return cosine < 0 ? pi : 0;
  double t = cosine < 0 ? (length - cosine) / sine : sine / (length + cosine);
  if (t > 1e15)
    return pi;
  for (int halving = 0; halving < 3; halving++)
    t = t / (1 + sqrt(1 + t * t));
  double square = t * t, sum = 0;
  for (int n = 19; n >= 1; n -= 2)
    sum = 1.0 / n - square * sum;
  return 16 * t * sum;
}

#endif
