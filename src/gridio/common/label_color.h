/* SPDX-License-Identifier: BSD-3-Clause */
/** The colours of labels. */
#ifndef VXM_GRIDIO_COMMON_LABEL_COLOR_H
#define VXM_GRIDIO_COMMON_LABEL_COLOR_H

#include <stdint.h>

/** The colour of a label as sRGB from 0 to 1: hues a golden section apart, so that labels near each other
 * look different; every other one is paler. */
void vxm_label_color(double rgb[3], double label);
/** The same from 0 to 255. */
void vxm_label_color_bytes(uint8_t rgb[3], double label);

#endif
