/* SPDX-License-Identifier: BSD-3-Clause */
/** Numbers as pixels. */
#ifndef VXM_GRIDIO_PICTURE_DIGITS_H
#define VXM_GRIDIO_PICTURE_DIGITS_H

#include <stdbool.h>

/** Pixels of a character with the space behind it, and its height. */
enum { VXM_DIGIT_WIDTH = 6, VXM_DIGIT_HEIGHT = 7 };

/** Whether a pixel of a text, from its upper left corner on, is ink. Of characters it knows those that
 * numbers are printed with. */
bool vxm_digits_ink(const char *text, int x, int y);

#endif
