/* SPDX-License-Identifier: BSD-3-Clause */
/** Telling binary STL by what its facets are like: its header may hold anything, the first words of other
 * formats too. */
#include "base/endian.h"
#include "meshio/formats/stl.h"

#include <math.h>

/** Facets looked at, spread over the file. */
enum { LOOKS = 256 };

/** What a byte of a text never is: a control code other than blanks and line ends. */
static bool is_control(unsigned char c) {
  return c < ' ' && !(c >= '\t' && c <= '\r');
}

size_t vxm_control_bytes(const unsigned char *data, size_t size) {
  size_t count = 0;
  for (size_t i = 0; i < size; i++)
    count += is_control(data[i]);
  return count;
}

uint64_t vxm_stl_announced(const unsigned char *data) {
  return vxm_load_u32(data + VXM_STL_COUNT_AT, vxm_must_swap(false));
}

static bool all_zero(const unsigned char *facet) {
  for (size_t i = 0; i < VXM_STL_FACET; i++)
    if (facet[i] != 0)
      return false;
  return true;
}

/**
 * Whether 50 bytes look like a facet: finite corners behind a normal of length 1, or corners of ordinary size
 * and bytes that no text has. Indices, and other numbers read at the wrong place, come out as denormals or
 * huge.
 */
static bool is_sound(const unsigned char *facet) {
  const double least = 1e-37, most = 1e20;
  const bool swap = vxm_must_swap(false);
  bool finite = true, ordinary = true;
  for (size_t c = 3; c < 12; c++) {
    double x = fabs((double)vxm_load_f32(facet + 4 * c, swap));
    finite &= isfinite(x) != 0;
    ordinary &= x == 0 || (x >= least && x <= most);
  }
  if (ordinary && vxm_control_bytes(facet, VXM_STL_FACET) > 0)
    return true;
  double length = 0;
  for (size_t c = 0; c < 3; c++) {
    double x = (double)vxm_load_f32(facet + 4 * c, swap);
    length += x * x;
  }
  return finite && length > 0.98 && length < 1.02;
}

/** Whether nine in ten of the facets that are not blank look like facets; `*blank` if all are blank. */
static bool are_sound(const unsigned char *data, size_t facets, bool *blank) {
  size_t looks = facets < LOOKS ? facets : LOOKS, zero = 0, sound = 0;
  for (size_t l = 0; l < looks; l++) {
    size_t f = facets <= LOOKS ? l : (size_t)((double)l * (double)(facets - 1) / (LOOKS - 1));
    const unsigned char *facet = data + VXM_STL_FACETS_AT + f * VXM_STL_FACET;
    if (all_zero(facet))
      zero++;
    else
      sound += is_sound(facet);
  }
  *blank = zero == looks;
  return looks > zero && 10 * sound >= 9 * (looks - zero);
}

/** A binary OFF is the one other format whose small numbers could pass for a count of facets. */
static bool claims_binary_off(const unsigned char *data) {
  return memmem(data, VXM_STL_COUNT_AT, "OFF BINARY", 10) != NULL;
}

bool vxm_stl_is_binary(const unsigned char *data, size_t size) {
  if (size < VXM_STL_FACETS_AT)
    return false;
  size_t room = (size - VXM_STL_FACETS_AT) / VXM_STL_FACET;
  bool fits = (size - VXM_STL_FACETS_AT) % VXM_STL_FACET == 0, blank;
  uint64_t wanted = vxm_stl_announced(data);
  bool sound = are_sound(data, !fits && wanted > 0 && wanted < room ? (size_t)wanted : room, &blank);
  /* Four characters of text make a count beyond 150 million facets, so that a count which fits proves it. */
  if (fits && wanted == room && !claims_binary_off(data))
    return true;
  return sound || (fits && blank && room > 0);
}
