/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/sized.h"

#include <string.h>

#include "base/error.h"

/** No struct comes near; a larger size is of one that was never initialized. */
enum { SIZE_OF_NONE = 1 << 16 };

vxm_status vxm_options_read(void *chosen, size_t known, const void *given, const char *what,
                            vxm_error *error) {
  if (!given)
    return VXM_OK;
  size_t size;
  memcpy(&size, given, sizeof size);
  if (size < sizeof size || size >= SIZE_OF_NONE)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "%s: options have no size of %zu bytes; use the initializer",
                    what, size);
  const unsigned char *bytes = given;
  for (size_t i = known; i < size; i++)
    if (bytes[i] != 0)
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "%s: an option is set that came after version %s of the library; leave it out", what,
                      vxm_version());
  memcpy((char *)chosen + sizeof size, bytes + sizeof size, (size < known ? size : known) - sizeof size);
  return VXM_OK;
}

size_t vxm_result_stride(const void *first, size_t known) {
  size_t size;
  memcpy(&size, first, sizeof size);
  return size == 0 ? known : size;
}

void vxm_result_write(void *out, const void *made, size_t known) {
  if (!out)
    return;
  size_t size = vxm_result_stride(out, known), shared = size < known ? size : known;
  if (shared <= sizeof size)
    return;
  if (made)
    memcpy((char *)out + sizeof size, (const char *)made + sizeof size, shared - sizeof size);
  else
    memset((char *)out + sizeof size, 0, shared - sizeof size);
}
