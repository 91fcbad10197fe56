/* SPDX-License-Identifier: BSD-3-Clause */
/** Numbers of bytes as people read them. */
#ifndef VXM_BASE_SIZE_TEXT_H
#define VXM_BASE_SIZE_TEXT_H

#include <stdint.h>
#include <stdio.h>

typedef struct vxm_size_text {
  char text[24];
} vxm_size_text;

/** In the largest unit that leaves at least one: "512 bytes", "1.5 KiB", "64.0 MiB", "2.5 GiB", "1.1 TiB". */
static inline vxm_size_text vxm_size_text_of(uint64_t bytes) {
  static const char *const units[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
  vxm_size_text out;
  double value = (double)bytes;
  int unit = 0;
  for (; unit < 4 && value >= (unit == 0 ? 1024 : 1023.95); unit++) /* 1024.0 of one is 1.0 of the next */
    value /= 1024;
  snprintf(out.text, sizeof out.text, unit == 0 ? "%.0f %s" : "%.1f %s", value, units[unit]);
  return out;
}

#endif
