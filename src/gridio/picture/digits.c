/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/picture/digits.h"

#include <string.h>

static const char characters[] = "0123456789.-+e";

/** Rows from the top down, the leftmost pixel in bit 4. */
static const unsigned char shapes[][VXM_DIGIT_HEIGHT] = {
    {14, 17, 19, 21, 25, 17, 14}, {4, 12, 4, 4, 4, 4, 14},   {14, 17, 1, 2, 4, 8, 31},
    {31, 2, 4, 2, 1, 17, 14},     {2, 6, 10, 18, 31, 2, 2},  {31, 16, 30, 1, 1, 17, 14},
    {6, 8, 16, 30, 17, 17, 14},   {31, 1, 2, 4, 8, 8, 8},    {14, 17, 17, 14, 17, 17, 14},
    {14, 17, 17, 15, 1, 2, 12},   {0, 0, 0, 0, 0, 12, 12},   {0, 0, 0, 31, 0, 0, 0},
    {0, 4, 4, 31, 4, 4, 0},       {0, 0, 14, 17, 31, 16, 14}};

bool vxm_digits_ink(const char *text, int x, int y) {
  if (x < 0 || y < 0 || y >= VXM_DIGIT_HEIGHT || x / VXM_DIGIT_WIDTH >= (int)strlen(text))
    return false;
  const char *known = strchr(characters, text[x / VXM_DIGIT_WIDTH]);
  int column = x % VXM_DIGIT_WIDTH, last = VXM_DIGIT_WIDTH - 2;
  return known && column <= last && (shapes[known - characters][y] >> (last - column) & 1);
}
