/* SPDX-License-Identifier: BSD-3-Clause */
#include "modules/assimp/uri.h"

#include <string.h>

/** The value of a hexadecimal digit, or -1. */
static int hex_digit(char c) {
  return c >= '0' && c <= '9'   ? c - '0'
         : c >= 'a' && c <= 'f' ? c - 'a' + 10
         : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                : -1;
}

void vxm_uri_decode(char *name) {
  char *out = name;
  for (const char *c = name; *c; c++) {
    int high = *c == '%' ? hex_digit(c[1]) : -1;
    int low = high >= 0 ? hex_digit(c[2]) : -1;
    bool is_code = low >= 0 && high + low > 0;
    *out++ = is_code ? (char)(16 * high + low) : *c;
    c += is_code ? 2 : 0;
  }
  *out = '\0';
}

/** Where the data begins; NULL if the URI is another. */
static const char *find_data(const char *uri, size_t length) {
  static const char scheme[] = "data:", mark[] = ";base64,";
  if (length < strlen(scheme) || memcmp(uri, scheme, strlen(scheme)) != 0)
    return NULL;
  const char *found = memmem(uri, length, mark, strlen(mark));
  return found ? found + strlen(mark) : NULL;
}

bool vxm_uri_is_data(const char *uri, size_t length) {
  return find_data(uri, length) != NULL;
}

/** The value of a digit of base64, of either alphabet (RFC 4648), or -1. */
static int base64_digit(char c) {
  return c >= 'A' && c <= 'Z'   ? c - 'A'
         : c >= 'a' && c <= 'z' ? c - 'a' + 26
         : c >= '0' && c <= '9' ? c - '0' + 52
         : c == '+' || c == '-' ? 62
         : c == '/' || c == '_' ? 63
                                : -1;
}

bool vxm_uri_data(unsigned char **out, size_t *size, vxm_context *context, const char *uri, size_t length) {
  const char *end = uri + length, *c = find_data(uri, length);
  unsigned char *bytes = c ? vxm_alloc(context, (size_t)(end - c) / 4 + 1, 3, NULL) : NULL;
  uint32_t bits = 0;
  int count = 0;
  *size = 0;
  if (!bytes)
    return false;
  for (; c < end && *c != '='; c++) {
    int digit = base64_digit(*c);
    if (digit < 0) {
      vxm_free(context, bytes);
      return false;
    }
    bits = bits << 6 | (uint32_t)digit;
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes[(*size)++] = (unsigned char)(bits >> count);
    }
  }
  *out = bytes;
  return true;
}
