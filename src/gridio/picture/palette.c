/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/picture/palette.h"

/** Between colours at equal steps; `at` from 0 to 1. */
static void interpolate(uint8_t rgb[3], const uint8_t stops[][3], int count, double at) {
  double place = (at > 0 ? at < 1 ? at : 1 : 0) * (count - 1);
  int first = place < count - 1 ? (int)place : count - 2;
  double part = place - first;
  for (int n = 0; n < 3; n++)
    rgb[n] = (uint8_t)((1 - part) * stops[first][n] + part * stops[first + 1][n] + 0.5);
}

void vxm_palette_diverging(uint8_t rgb[3], double value) {
  static const uint8_t stops[][3] = {{5, 48, 97},     {33, 102, 172},  {67, 147, 195},  {146, 197, 222},
                                     {209, 229, 240}, {247, 247, 247}, {253, 219, 199}, {244, 165, 130},
                                     {214, 96, 77},   {178, 24, 43},   {103, 0, 31}};
  interpolate(rgb, stops, sizeof stops / sizeof *stops, (value + 1) / 2);
}

void vxm_palette_grey(uint8_t rgb[3], double value) {
  static const uint8_t stops[][3] = {{250, 250, 250}, {20, 20, 20}};
  interpolate(rgb, stops, 2, value);
}

void vxm_palette_sequential(uint8_t rgb[3], double value) {
  static const uint8_t stops[][3] = {
      {68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}};
  interpolate(rgb, stops, sizeof stops / sizeof *stops, value);
}
