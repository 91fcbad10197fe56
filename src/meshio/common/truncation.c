/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/common/truncation.h"

const unsigned char *vxm_last_token(const vxm_tokenizer *scan) {
  const unsigned char *at = scan->end;
  while (at > scan->begin && !vxm_is_blank(at[-1]) && !vxm_is_newline(at[-1]))
    at--;
  return at;
}

/** Whether a face other than the last has the edge a-b. */
static bool is_shared(const vxm_soup *soup, uint32_t a, uint32_t b) {
  for (size_t f = 0; f + 1 < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    uint32_t before = corner[n - 1];
    for (size_t c = 0; c < n; before = corner[c++])
      if ((before == a && corner[c] == b) || (before == b && corner[c] == a))
        return true;
  }
  return false;
}

bool vxm_last_index_may_be_truncated(const vxm_soup *soup, uint64_t first_number) {
  if (soup->face_count == 0)
    return false;
  size_t n;
  const uint32_t *corner = vxm_face(soup, soup->face_count - 1, &n);
  uint64_t number = corner[n - 1] + first_number, last_number = soup->vertex_count - 1 + first_number;
  if (number == 0 || number * 10 > last_number)
    return false;
  return !is_shared(soup, corner[n - 2], corner[n - 1]) || !is_shared(soup, corner[n - 1], corner[0]);
}

bool vxm_last_face_may_be_short(const vxm_soup *soup) {
  if (soup->face_count < 2)
    return false;
  size_t before, n;
  (void)vxm_face(soup, soup->face_count - 2, &before);
  const uint32_t *corner = vxm_face(soup, soup->face_count - 1, &n);
  return n < before && !is_shared(soup, corner[n - 1], corner[0]);
}
