/* SPDX-License-Identifier: BSD-3-Clause */
/** JSON as text, without memory too, and what is often read from it. */
#ifndef VXM_GRIDIO_COMMON_JSON_TEXT_H
#define VXM_GRIDIO_COMMON_JSON_TEXT_H

#include <jansson.h>

/** A name, with '?' for what is no UTF-8; NULL without memory. */
json_t *vxm_json_name(const char *name);
/** The whole text, to be freed; NULL without memory. 17 digits bring every double back bit for bit.
 * @param how of jansson, such as JSON_INDENT(2) */
char *vxm_json_text(const json_t *root, size_t how);

/** Takes an array of three numbers; false if `key` is not one. */
static inline bool vxm_json_triple(double out[3], const json_t *object, const char *key) {
  const json_t *array = json_object_get(object, key);
  if (json_array_size(array) != 3)
    return false;
  for (size_t a = 0; a < 3; a++) {
    const json_t *number = json_array_get(array, a);
    if (!json_is_number(number))
      return false;
    out[a] = json_number_value(number);
  }
  return true;
}

#endif
