/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/common/utf16.h"

enum { REPLACEMENT = 0xfffd, LOOKS = 64, UNITS_LOOKED_AT = 16 };

static uint32_t unit(const unsigned char *p, bool big) {
  return big ? (uint32_t)p[0] << 8 | p[1] : (uint32_t)p[1] << 8 | p[0];
}

bool vxm_utf16_is(const unsigned char *data, size_t size) {
  if (size < 4 || !((data[0] == 0xfe && data[1] == 0xff) || (data[0] == 0xff && data[1] == 0xfe)))
    return false;
  /* A binary file may begin with these two bytes as well, and go on as text for a while: the text of a mesh
     is all but wholly ASCII wherever one looks. */
  bool big = data[0] == 0xfe;
  size_t units = size / 2 - 1, looked = 0, plain = 0;
  size_t looks = units > LOOKS * UNITS_LOOKED_AT ? LOOKS : units / UNITS_LOOKED_AT + 1;
  for (size_t l = 0; l < looks; l++) {
    size_t first = units / looks * l;
    for (size_t i = first; i < units && i < first + UNITS_LOOKED_AT; i++, looked++) {
      uint32_t u = unit(data + 2 + 2 * i, big);
      plain += u < 0x80 && u >= '\t';
    }
  }
  return plain * 2 > looked;
}

static size_t put(unsigned char *out, uint32_t c) {
  if (c < 0x80) {
    out[0] = (unsigned char)c;
    return 1;
  }
  if (c < 0x800) {
    out[0] = (unsigned char)(0xc0 | c >> 6);
    out[1] = (unsigned char)(0x80 | (c & 63));
    return 2;
  }
  if (c < 0x10000) {
    out[0] = (unsigned char)(0xe0 | c >> 12);
    out[1] = (unsigned char)(0x80 | (c >> 6 & 63));
    out[2] = (unsigned char)(0x80 | (c & 63));
    return 3;
  }
  out[0] = (unsigned char)(0xf0 | c >> 18);
  out[1] = (unsigned char)(0x80 | (c >> 12 & 63));
  out[2] = (unsigned char)(0x80 | (c >> 6 & 63));
  out[3] = (unsigned char)(0x80 | (c & 63));
  return 4;
}

vxm_status vxm_utf16_to_utf8(unsigned char **out, size_t *out_size, vxm_context *context,
                             const unsigned char *data, size_t size, vxm_error *error) {
  vxm_status status = VXM_OK;
  bool big = data[0] == 0xfe;
  /* A unit of two bytes becomes at most three; a pair of four bytes becomes four. */
  unsigned char *text = vxm_try_alloc(context, size / 2, 3, &status, error);
  if (!text)
    return status;
  size_t used = 0;
  for (size_t at = 2; at + 2 <= size; at += 2) {
    uint32_t c = unit(data + at, big);
    if (c >= 0xd800 && c < 0xe000) {
      uint32_t low = c < 0xdc00 && at + 4 <= size ? unit(data + at + 2, big) : 0;
      if (low >= 0xdc00 && low < 0xe000) {
        c = 0x10000 + ((c - 0xd800) << 10) + (low - 0xdc00);
        at += 2;
      } else
        c = REPLACEMENT;
    }
    used += put(text + used, c);
  }
  *out = text;
  *out_size = used;
  return VXM_OK;
}
