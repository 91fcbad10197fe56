/* SPDX-License-Identifier: BSD-3-Clause */
/** Named binary tags of a file, which may be anybody's: the tree is checked as a whole before it is walked.
 */
#ifndef VXM_GRIDIO_FORMATS_MINECRAFT_NBT_READ_H
#define VXM_GRIDIO_FORMATS_MINECRAFT_NBT_READ_H

#include "base/file.h"
#include "gridio/formats/minecraft/nbt.h"

/** The content of a tag within a checked tree. */
typedef struct vxm_nbt_value {
  vxm_nbt_type type;
  const unsigned char *at, *end;
} vxm_nbt_value;

/** A tree in memory. */
typedef struct vxm_nbt {
  vxm_context *context;
  unsigned char *bytes; /**< NULL = none */
  vxm_nbt_value root;   /**< a compound */
} vxm_nbt;

/** Whether a file seems to be such a tree, packed: it is unpacked for its first bytes. */
bool vxm_nbt_sniff(const vxm_input *input);
/**
 * Unpacks and checks a tree.
 *
 * @return VXM_OK; VXM_ERROR_FORMAT; VXM_ERROR_UNAVAILABLE without zlib; VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_nbt_load(vxm_nbt *out, const vxm_input *input, vxm_error *error);
void vxm_nbt_destroy(vxm_nbt *tree);

/** A child of a compound by name, if it has this type; false if there is none. */
bool vxm_nbt_find(vxm_nbt_value *out, const vxm_nbt_value *compound, const char *name, vxm_nbt_type type);
/** A whole number of any type by name. */
bool vxm_nbt_find_integer(int64_t *out, const vxm_nbt_value *compound, const char *name);
/** A list of three doubles by name. */
bool vxm_nbt_find_triple(double out[3], const vxm_nbt_value *compound, const char *name);

/** Walks the children of a compound: `at` begins as its `at`; false behind the last. The name is no C text.
 */
bool vxm_nbt_next(const unsigned char **at, const vxm_nbt_value *compound, const char **name,
                  size_t *name_size, vxm_nbt_value *value);
/** Elements of a list, or of an array. */
size_t vxm_nbt_count(const vxm_nbt_value *list);
/** Walks the elements of a list: `at` begins as NULL; false behind the last. */
bool vxm_nbt_next_item(const unsigned char **at, const vxm_nbt_value *list, vxm_nbt_value *value);

/** The text of a string, which is no C text. */
const char *vxm_nbt_string_of(const vxm_nbt_value *value, size_t *size);
/** The whole number of a value; 0 if it is none. */
int64_t vxm_nbt_integer_of(const vxm_nbt_value *value);
/** Bytes, highest first. */
uint64_t vxm_nbt_load_number(const unsigned char *bytes, int count);

#endif
