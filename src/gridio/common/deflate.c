/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/deflate.h"
#include "config.h"

#include <string.h>

#ifdef HAVE_ZLIB
#define ZLIB_CONST
#include <zlib.h>

vxm_status vxm_deflate_check(const char *path, vxm_error *error) {
  (void)path, (void)error;
  return VXM_OK;
}

/* ---- Memory for zlib, which tells what stood against it only by NULL ---- */

typedef struct noting {
  vxm_context *context;
  vxm_error fault;
} noting;

static void *take(void *payload, unsigned count, unsigned size) {
  noting *n = payload;
  return vxm_alloc(n->context, count, size, &n->fault);
}

static void give(void *payload, void *block) {
  const noting *n = payload;
  vxm_free(n->context, block);
}

static vxm_status fail_memory(const noting *n, vxm_error *error) {
  if (n->fault.code == VXM_OK)
    return vxm_fail(error, VXM_ERROR_MEMORY, "out of memory");
  vxm_error_pass(error, &n->fault);
  return n->fault.code;
}

/* ---- Out ---- */

struct vxm_deflater {
  z_stream z;
  vxm_output *output;
  noting memory;
};

vxm_status vxm_deflater_create(vxm_deflater **out, vxm_context *context, vxm_output *output,
                               vxm_deflate_frame frame, vxm_error *error) {
  enum { GZIP = 16, MEMORY_LEVEL = 8 };
  *out = NULL;
  vxm_status status = VXM_OK;
  vxm_deflater *d = vxm_try_calloc(context, 1, sizeof *d, &status, error);
  if (!d)
    return status;
  *d = (vxm_deflater){.z = {.zalloc = take, .zfree = give, .opaque = &d->memory},
                      .output = output,
                      .memory = {context, VXM_ERROR_INIT}};
  int window = MAX_WBITS + (frame == VXM_DEFLATE_GZIP ? GZIP : 0);
  if (deflateInit2(&d->z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, window, MEMORY_LEVEL, Z_DEFAULT_STRATEGY) !=
      Z_OK) {
    status = fail_memory(&d->memory, error);
    vxm_free(context, d);
    return status;
  }
  *out = d;
  return VXM_OK;
}

/** Gives zlib what it asks for, until it has taken all. */
static void run(vxm_deflater *d, int flush) {
  enum { ROOM = 4096 };
  do {
    d->z.next_out = (unsigned char *)vxm_output_reserve(d->output, ROOM);
    d->z.avail_out = ROOM;
    deflate(&d->z, flush);
    vxm_output_advance(d->output, ROOM - d->z.avail_out);
  } while (d->z.avail_out == 0);
}

void vxm_deflater_write(vxm_deflater *d, const void *data, size_t size) {
  const size_t piece = (size_t)1 << 30; /* zlib counts in 32 bits */
  const unsigned char *from = data;
  while (size > 0 && !vxm_output_failed(d->output)) {
    size_t some = size < piece ? size : piece;
    d->z.next_in = from;
    d->z.avail_in = (unsigned)some;
    run(d, Z_NO_FLUSH);
    from += some;
    size -= some;
  }
}

void vxm_deflater_end(vxm_deflater *d) {
  d->z.next_in = (const unsigned char *)"";
  d->z.avail_in = 0;
  run(d, Z_FINISH);
}

void vxm_deflater_destroy(vxm_deflater *d) {
  if (!d)
    return;
  deflateEnd(&d->z);
  vxm_free(d->memory.context, d);
}

/* ---- Blocks ---- */

size_t vxm_deflate_bound(size_t size) {
  return compressBound(size);
}

vxm_status vxm_deflate_block(vxm_context *context, void *out, size_t *size, const void *data,
                             size_t data_size, vxm_error *error) {
  noting memory = {context, VXM_ERROR_INIT};
  z_stream z = {.zalloc = take, .zfree = give, .opaque = &memory};
  if (data_size > VXM_DEFLATE_BLOCK_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "a block of %zu bytes is too large to be compressed", data_size);
  if (deflateInit(&z, Z_DEFAULT_COMPRESSION) != Z_OK)
    return fail_memory(&memory, error);
  z.next_in = data;
  z.avail_in = (unsigned)data_size;
  z.next_out = out;
  z.avail_out = (unsigned)vxm_deflate_bound(data_size);
  deflate(&z, Z_FINISH); /* there is room for all of it */
  *size = z.total_out;
  deflateEnd(&z);
  return VXM_OK;
}

/* ---- In ---- */

struct vxm_inflater {
  z_stream z;
  const vxm_input *input;
  bool is_gzip; /**< and so may have several members */
  noting memory;
};

vxm_status vxm_inflater_create(vxm_inflater **out, const vxm_input *input, size_t offset, vxm_error *error) {
  enum { ANY_HEADER = 32 /* gzip's or zlib's own */ };
  *out = NULL;
  vxm_status status = VXM_OK;
  vxm_inflater *i = vxm_try_calloc(input->context, 1, sizeof *i, &status, error);
  if (!i)
    return status;
  *i = (vxm_inflater){.z = {.zalloc = take, .zfree = give, .next_in = input->data + offset},
                      .input = input,
                      .is_gzip = input->size - offset >= 2 && input->data[offset] == 0x1f,
                      .memory = {input->context, VXM_ERROR_INIT}};
  i->z.opaque = &i->memory;
  if (inflateInit2(&i->z, ANY_HEADER + MAX_WBITS) != Z_OK) {
    status = fail_memory(&i->memory, error);
    vxm_free(input->context, i);
    return status;
  }
  *out = i;
  return VXM_OK;
}

/** Goes on with the next member of a gzip file, of which pigz, bgzip and cat make several; false if there is
 * none.
 */
static bool next_member(vxm_inflater *i) {
  const unsigned char *at = i->z.next_in;
  size_t left = i->input->size - (size_t)(at - i->input->data);
  return i->is_gzip && left >= 2 && at[0] == 0x1f && at[1] == 0x8b && inflateReset(&i->z) == Z_OK;
}

vxm_status vxm_inflater_some(vxm_inflater *i, void *to, size_t room, size_t *out, vxm_error *error) {
  const size_t piece = (size_t)1 << 30; /* zlib counts in 32 bits */
  const vxm_input *input = i->input;
  z_stream *z = &i->z;
  z->next_out = to;
  for (*out = 0; *out < room;) {
    size_t left = input->size - (size_t)(z->next_in - input->data), step = room - *out;
    z->avail_in = (unsigned)(left < piece ? left : piece);
    z->avail_out = (unsigned)(step < piece ? step : piece);
    int result = inflate(z, Z_NO_FLUSH);
    *out = (size_t)(z->next_out - (unsigned char *)to);
    const vxm_place place = {input->name, 0, (int64_t)(z->next_in - input->data), -1};
    if (result == Z_STREAM_END && !next_member(i))
      return VXM_OK;
    if (result == Z_MEM_ERROR)
      return fail_memory(&i->memory, error);
    if (result == Z_BUF_ERROR)
      return vxm_fail_at(error, VXM_ERROR_FORMAT, place, "the compressed values end too early");
    if (result != Z_OK && result != Z_STREAM_END)
      return vxm_fail_at(error, VXM_ERROR_FORMAT, place, "the compressed values are damaged: %s",
                         z->msg ? z->msg : "not those of gzip or zlib");
  }
  return VXM_OK;
}

vxm_status vxm_inflater_read(vxm_inflater *i, void *to, size_t size, vxm_error *error) {
  size_t got;
  vxm_status status = vxm_inflater_some(i, to, size, &got, error);
  if (status != VXM_OK || got == size)
    return status;
  const vxm_place place = {i->input->name, 0, (int64_t)(i->z.next_in - i->input->data), -1};
  return vxm_fail_at(error, VXM_ERROR_FORMAT, place, "the compressed values end too early");
}

void vxm_inflater_destroy(vxm_inflater *i) {
  if (!i)
    return;
  inflateEnd(&i->z);
  vxm_free(i->input->context, i);
}

#else

vxm_status vxm_deflate_check(const char *path, vxm_error *error) {
  return vxm_fail_at(error, VXM_ERROR_UNAVAILABLE, (vxm_place){path, 0, -1, -1},
                     "compressed values need zlib, without which this build was made (configure --with-zlib; "
                     "Debian: zlib1g-dev)");
}

vxm_status vxm_deflater_create(vxm_deflater **out, vxm_context *context, vxm_output *output,
                               vxm_deflate_frame frame, vxm_error *error) {
  (void)context, (void)output, (void)frame;
  *out = NULL;
  return vxm_deflate_check(NULL, error);
}

void vxm_deflater_write(vxm_deflater *deflater, const void *data, size_t size) {
  (void)deflater, (void)data, (void)size;
}

void vxm_deflater_end(vxm_deflater *deflater) {
  (void)deflater;
}

void vxm_deflater_destroy(vxm_deflater *deflater) {
  (void)deflater;
}

vxm_status vxm_inflater_create(vxm_inflater **out, const vxm_input *input, size_t offset, vxm_error *error) {
  (void)offset;
  *out = NULL;
  return vxm_deflate_check(input->name, error);
}

vxm_status vxm_inflater_some(vxm_inflater *inflater, void *to, size_t room, size_t *out, vxm_error *error) {
  (void)inflater, (void)to, (void)room;
  *out = 0;
  return vxm_deflate_check(NULL, error);
}

vxm_status vxm_inflater_read(vxm_inflater *inflater, void *to, size_t size, vxm_error *error) {
  (void)inflater, (void)to, (void)size;
  return vxm_deflate_check(NULL, error);
}

size_t vxm_deflate_bound(size_t size) {
  return size;
}

vxm_status vxm_deflate_block(vxm_context *context, void *out, size_t *size, const void *data,
                             size_t data_size, vxm_error *error) {
  (void)context, (void)out, (void)data, (void)data_size;
  *size = 0;
  return vxm_deflate_check(NULL, error);
}

void vxm_inflater_destroy(vxm_inflater *inflater) {
  (void)inflater;
}
#endif
