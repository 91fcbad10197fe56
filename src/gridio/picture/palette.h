/* SPDX-License-Identifier: BSD-3-Clause */
/** Colours of numbers, as 8-bit sRGB, which pictures and pages have in common. */
#ifndef VXM_GRIDIO_PICTURE_PALETTE_H
#define VXM_GRIDIO_PICTURE_PALETTE_H

#include <stdint.h>

/** -1 (inside) to 1 (outside): blue, white at 0, red. */
void vxm_palette_diverging(uint8_t rgb[3], double value);
/** 0 to 1: white to black. */
void vxm_palette_grey(uint8_t rgb[3], double value);
/** 0 to 1: dark blue over green to yellow, evenly lighter. */
void vxm_palette_sequential(uint8_t rgb[3], double value);

#endif
