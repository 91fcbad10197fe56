/* SPDX-License-Identifier: BSD-3-Clause */
/** JSON as text, without memory too. */
#ifndef VXM_GRIDIO_COMMON_JSON_TEXT_H
#define VXM_GRIDIO_COMMON_JSON_TEXT_H

#include <jansson.h>

/** A name, with '?' for what is no UTF-8; NULL without memory. */
json_t *vxm_json_name(const char *name);
/** The whole text, to be freed; NULL without memory. 17 digits bring every double back bit for bit.
 * @param how of jansson, such as JSON_INDENT(2) */
char *vxm_json_text(const json_t *root, size_t how);

#endif
