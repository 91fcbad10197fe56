/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/minecraft/nbt_write.h"

#include <string.h>

#include "config.h"
#ifdef HAVE_ZLIB
#define ZLIB_CONST
#include <zlib.h>
#endif

enum { PIECE = 1 << 16 };

struct vxm_nbt_writer {
  vxm_context *context;
  vxm_output *output;
  vxm_error error;
#ifdef HAVE_ZLIB
  z_stream z;
#endif
  size_t used; /**< of `plain` */
  unsigned char plain[PIECE], packed[PIECE];
};

#ifdef HAVE_ZLIB
static void *take(void *payload, unsigned count, unsigned size) {
  vxm_nbt_writer *writer = payload;
  return vxm_alloc(writer->context, count, size, &writer->error);
}

static void give(void *payload, void *block) {
  const vxm_nbt_writer *writer = payload;
  vxm_free(writer->context, block);
}

/** Packs what waits. zlib has all its memory from the beginning, and does not fail here. */
static void pack(vxm_nbt_writer *writer, int flush) {
  z_stream *z = &writer->z;
  z->next_in = writer->plain;
  z->avail_in = (unsigned)writer->used;
  do {
    z->next_out = writer->packed;
    z->avail_out = PIECE;
    deflate(z, flush);
    vxm_output_write(writer->output, writer->packed, PIECE - z->avail_out);
  } while (z->avail_out == 0);
  writer->used = 0;
}

/** The header of gzip has neither name nor time: the same content gives the same file. */
vxm_status vxm_nbt_open(vxm_nbt_writer **out, vxm_context *context, vxm_output *output, vxm_error *error) {
  enum { GZIP = 16, MEMORY_LEVEL = 8 };
  vxm_error local = VXM_ERROR_INIT;
  vxm_nbt_writer *writer = vxm_alloc(context, 1, sizeof *writer, &local);
  if (!writer) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  writer->context = context;
  writer->output = output;
  writer->used = 0;
  writer->error = local;
  writer->z = (z_stream){.zalloc = take, .zfree = give, .opaque = writer};
  int result = deflateInit2(&writer->z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS + GZIP, MEMORY_LEVEL,
                            Z_DEFAULT_STRATEGY);
  if (result != Z_OK) {
    if (writer->error.code == VXM_OK)
      vxm_fail(&writer->error, VXM_ERROR_MEMORY, "out of memory for packing");
    vxm_status status = writer->error.code;
    vxm_error_pass(error, &writer->error);
    vxm_free(context, writer);
    return status;
  }
  *out = writer;
  return VXM_OK;
}

void vxm_nbt_close(vxm_nbt_writer *writer) {
  if (!writer)
    return;
  pack(writer, Z_FINISH);
  deflateEnd(&writer->z);
  vxm_free(writer->context, writer);
}

void vxm_nbt_put(vxm_nbt_writer *writer, const void *data, size_t size) {
  const unsigned char *from = data;
  while (size > 0) {
    size_t room = PIECE - writer->used, step = size < room ? size : room;
    memcpy(writer->plain + writer->used, from, step);
    writer->used += step;
    from += step;
    size -= step;
    if (writer->used == PIECE)
      pack(writer, Z_NO_FLUSH);
  }
}
#else
vxm_status vxm_nbt_open(vxm_nbt_writer **out, vxm_context *context, vxm_output *output, vxm_error *error) {
  (void)out, (void)context, (void)output;
  return vxm_fail(
      error, VXM_ERROR_UNAVAILABLE,
      "the files of Minecraft need zlib, without which this build was made (configure --with-zlib; "
      "Debian: zlib1g-dev)");
}

void vxm_nbt_close(vxm_nbt_writer *writer) {
  (void)writer;
}

void vxm_nbt_put(vxm_nbt_writer *writer, const void *data, size_t size) {
  (void)writer, (void)data, (void)size;
}
#endif

void vxm_nbt_number(vxm_nbt_writer *writer, uint64_t value, int bytes) {
  unsigned char text[8];
  for (int b = 0; b < bytes; b++)
    text[b] = (unsigned char)(value >> 8 * (bytes - 1 - b));
  vxm_nbt_put(writer, text, (size_t)bytes);
}

void vxm_nbt_text(vxm_nbt_writer *writer, const char *text) {
  size_t size = strnlen(text, UINT16_MAX);
  vxm_nbt_number(writer, size, 2);
  vxm_nbt_put(writer, text, size);
}

void vxm_nbt_tag(vxm_nbt_writer *writer, vxm_nbt_type type, const char *name) {
  vxm_nbt_number(writer, (uint64_t)type, 1);
  vxm_nbt_text(writer, name);
}

void vxm_nbt_string(vxm_nbt_writer *writer, const char *name, const char *text) {
  vxm_nbt_tag(writer, VXM_NBT_STRING, name);
  vxm_nbt_text(writer, text);
}

void vxm_nbt_integer(vxm_nbt_writer *writer, vxm_nbt_type type, const char *name, int64_t value) {
  static const int bytes[] = {0, 1, 2, 4, 8};
  vxm_nbt_tag(writer, type, name);
  vxm_nbt_number(writer, (uint64_t)value, bytes[type]);
}

void vxm_nbt_list(vxm_nbt_writer *writer, const char *name, vxm_nbt_type of, size_t count) {
  vxm_nbt_tag(writer, VXM_NBT_LIST, name);
  vxm_nbt_number(writer, (uint64_t)of, 1);
  vxm_nbt_number(writer, count, 4);
}

void vxm_nbt_triple(vxm_nbt_writer *writer, const char *name, const double values[3]) {
  vxm_nbt_list(writer, name, VXM_NBT_DOUBLE, 3);
  for (int v = 0; v < 3; v++) {
    uint64_t bits;
    memcpy(&bits, &values[v], sizeof bits);
    vxm_nbt_number(writer, bits, 8);
  }
}

void vxm_nbt_end(vxm_nbt_writer *writer) {
  vxm_nbt_number(writer, VXM_NBT_END, 1);
}
