/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/array_place.h"

#include <string.h>

bool vxm_axes_parse(int axis[3], const char *text, size_t size) {
  unsigned seen = 0;
  int found[3], count = 0;
  for (size_t t = 0; t < size; t++) {
    int letter = text[t] | 0x20;
    if (text[t] == ',' || text[t] == ' ')
      continue;
    bool is_known = count == 3 ? letter == 'c' : letter >= 'x' && letter <= 'z';
    if (count == 4 || !is_known)
      return false;
    if (count < 3)
      seen |= 1u << (found[count] = letter - 'x');
    count++;
  }
  if (seen != 7)
    return false;
  memcpy(axis, found, sizeof found);
  return true;
}

void vxm_axes_warn(vxm_warnings *warnings) {
  vxm_warn(warnings,
           "its attribute \"axes\" is not x, y and z in some order, such as \"z,y,x\": x, y, z is taken");
}

void vxm_place_warn(vxm_warnings *warnings, unsigned known) {
  if (known == 0)
    vxm_warn(warnings, "no attributes \"origin\" and \"voxel_size\" of three numbers: 0 0 0 and 1 are taken");
  else if (!(known & VXM_PLACE_ORIGIN))
    vxm_warn(warnings, "no attribute \"origin\" of three numbers: 0 0 0 is taken");
  else if (!(known & VXM_PLACE_SIZE))
    vxm_warn(warnings, "no attribute \"voxel_size\" of one number or three: 1 is taken");
}
