/* SPDX-License-Identifier: BSD-3-Clause */
/** Named binary tags into a file, packed by gzip as they come. */
#ifndef VXM_GRIDIO_FORMATS_MINECRAFT_NBT_WRITE_H
#define VXM_GRIDIO_FORMATS_MINECRAFT_NBT_WRITE_H

#include "base/output.h"
#include "gridio/formats/minecraft/nbt.h"

typedef struct vxm_nbt_writer vxm_nbt_writer;

/** @return VXM_OK; VXM_ERROR_UNAVAILABLE without zlib; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_nbt_open(vxm_nbt_writer **out, vxm_context *context, vxm_output *output, vxm_error *error);
/** Ends the packed bytes and frees the writer. A failed write is left to vxm_output_commit. NULL is allowed.
 */
void vxm_nbt_close(vxm_nbt_writer *writer);

/** Bytes as they are. */
void vxm_nbt_put(vxm_nbt_writer *writer, const void *data, size_t size);
/** The low bytes of a number, highest first. */
void vxm_nbt_number(vxm_nbt_writer *writer, uint64_t value, int bytes);
/** What stands before the content of a tag. */
void vxm_nbt_tag(vxm_nbt_writer *writer, vxm_nbt_type type, const char *name);
/** Texts have up to 65535 bytes; what goes beyond is left out. */
void vxm_nbt_text(vxm_nbt_writer *writer, const char *text);

void vxm_nbt_string(vxm_nbt_writer *writer, const char *name, const char *text);
/** @param type VXM_NBT_BYTE to VXM_NBT_LONG */
void vxm_nbt_integer(vxm_nbt_writer *writer, vxm_nbt_type type, const char *name, int64_t value);
/** A list of three doubles. */
void vxm_nbt_triple(vxm_nbt_writer *writer, const char *name, const double values[3]);
/** What stands before the elements of a list. */
void vxm_nbt_list(vxm_nbt_writer *writer, const char *name, vxm_nbt_type of, size_t count);
/** Ends a compound. */
void vxm_nbt_end(vxm_nbt_writer *writer);

#endif
