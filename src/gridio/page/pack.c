/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/page/pack.h"
#include "config.h"

#include <string.h>
#ifdef HAVE_ZLIB
#define ZLIB_CONST
#include <zlib.h>
#endif

enum { PIECE = 1 << 15 };

struct vxm_pack {
  vxm_context *context;
  vxm_output *output;
  vxm_error error;
  unsigned char waiting[3]; /**< bytes that are less than a group of base64 */
  int waiting_count;
#ifdef HAVE_ZLIB
  z_stream z;
  unsigned char packed[PIECE];
#else
  unsigned char stored[PIECE];
  size_t stored_count;
  uint32_t sums[2]; /**< Adler-32 */
#endif
};

/* ---- base64 ---- */

static void put_group(char text[4], const unsigned char group[3]) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  unsigned bits = (unsigned)group[0] << 16 | (unsigned)group[1] << 8 | group[2];
  for (int n = 0; n < 4; n++)
    text[n] = digits[bits >> (18 - 6 * n) & 63];
}

static void put_base64(vxm_pack *pack, const unsigned char *bytes, size_t count) {
  for (size_t i = 0; i < count; i++) {
    pack->waiting[pack->waiting_count++] = bytes[i];
    if (pack->waiting_count == 3) {
      put_group(vxm_output_reserve(pack->output, 4), pack->waiting);
      vxm_output_advance(pack->output, 4);
      pack->waiting_count = 0;
    }
  }
}

static void end_base64(vxm_pack *pack) {
  if (pack->waiting_count == 0)
    return;
  char text[4];
  memset(pack->waiting + pack->waiting_count, 0, (size_t)(3 - pack->waiting_count));
  put_group(text, pack->waiting);
  memset(text + 1 + pack->waiting_count, '=', (size_t)(3 - pack->waiting_count));
  vxm_output_write(pack->output, text, 4);
}

/* ---- Packing ---- */

#ifdef HAVE_ZLIB

static void *take(void *payload, unsigned count, unsigned size) {
  vxm_pack *pack = payload;
  return vxm_alloc(pack->context, count, size, &pack->error);
}

static void give(void *payload, void *block) {
  const vxm_pack *pack = payload;
  vxm_free(pack->context, block);
}

static vxm_status open_stream(vxm_pack *pack) {
  pack->z = (z_stream){.zalloc = take, .zfree = give, .opaque = pack};
  if (deflateInit(&pack->z, 6) == Z_OK || pack->error.code != VXM_OK)
    return pack->error.code;
  return vxm_fail(&pack->error, VXM_ERROR_MEMORY, "page: zlib cannot begin");
}

static void work(vxm_pack *pack, int flush) {
  do {
    pack->z.next_out = pack->packed;
    pack->z.avail_out = PIECE;
    deflate(&pack->z, flush);
    put_base64(pack, pack->packed, PIECE - pack->z.avail_out);
  } while (pack->z.avail_out == 0);
}

static void put_stream(vxm_pack *pack, const unsigned char *bytes, size_t size) {
  while (size > 0) {
    size_t part = size < (1U << 30) ? size : 1U << 30; /* zlib counts in 32 bits */
    pack->z.next_in = bytes;
    pack->z.avail_in = (unsigned)part;
    work(pack, Z_NO_FLUSH);
    bytes += part;
    size -= part;
  }
}

static void close_stream(vxm_pack *pack) {
  pack->z.avail_in = 0;
  work(pack, Z_FINISH);
  deflateEnd(&pack->z);
}

#else

static vxm_status open_stream(vxm_pack *pack) {
  static const unsigned char header[2] = {0x78, 0x01};
  pack->sums[0] = 1;
  put_base64(pack, header, sizeof header);
  return VXM_OK;
}

/** A block as it is (RFC 1951, 3.2.4). */
static void store(vxm_pack *pack, bool is_last) {
  unsigned count = (unsigned)pack->stored_count;
  unsigned char low = (unsigned char)(count & 255), high = (unsigned char)(count >> 8 & 255);
  const unsigned char header[5] = {is_last, low, high, (unsigned char)(low ^ 255),
                                   (unsigned char)(high ^ 255)};
  put_base64(pack, header, sizeof header);
  put_base64(pack, pack->stored, count);
  pack->stored_count = 0;
}

static void put_stream(vxm_pack *pack, const unsigned char *bytes, size_t size) {
  for (size_t i = 0; i < size; i++) {
    if (pack->stored_count == PIECE)
      store(pack, false);
    pack->stored[pack->stored_count++] = bytes[i];
    pack->sums[0] = (pack->sums[0] + bytes[i]) % 65521;
    pack->sums[1] = (pack->sums[1] + pack->sums[0]) % 65521;
  }
}

static void close_stream(vxm_pack *pack) {
  store(pack, true);
  unsigned char sum[4];
  for (int b = 0; b < 4; b++) /* the second sum first, high bytes before low ones */
    sum[b] = (unsigned char)(pack->sums[b < 2] >> (b % 2 ? 0 : 8) & 255);
  put_base64(pack, sum, sizeof sum);
}

#endif

/* ---- Blocks ---- */

vxm_status vxm_pack_begin(vxm_pack **out, vxm_context *context, vxm_output *output, const char *id,
                          vxm_error *error) {
  vxm_status status = VXM_OK;
  *out = NULL;
  vxm_pack *pack = vxm_try_calloc(context, 1, sizeof *pack, &status, error);
  if (!pack)
    return status;
  pack->context = context;
  pack->output = output;
  pack->error = (vxm_error)VXM_ERROR_INIT;
  vxm_output_printf(output, "<script type=\"application/octet-stream;base64\" id=\"%s\">", id);
  status = open_stream(pack);
  if (status != VXM_OK) {
    vxm_error_pass(error, &pack->error);
    vxm_free(context, pack);
    return status;
  }
  *out = pack;
  return VXM_OK;
}

void vxm_pack_put(vxm_pack *pack, const void *data, size_t size) {
  put_stream(pack, data, size);
}

vxm_status vxm_pack_end(vxm_pack *pack, vxm_error *error) {
  if (!pack)
    return VXM_OK;
  close_stream(pack);
  end_base64(pack);
  vxm_output_printf(pack->output, "</script>\n");
  vxm_status status = pack->error.code;
  if (status != VXM_OK)
    vxm_error_pass(error, &pack->error);
  vxm_free(pack->context, pack);
  return status;
}
