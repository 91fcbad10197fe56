/* SPDX-License-Identifier: BSD-3-Clause */
#include "modules/assimp/zip.h"
#include "base/endian.h"
#include "config.h"

#include <string.h>

#ifdef HAVE_ZLIB
#define ZLIB_CONST
#include <zlib.h>
#endif

enum { END_SIZE = 22, ENTRY_SIZE = 46, LOCAL_SIZE = 30, COMMENT_MAX = 65535, PIECE = 1 << 16 };
enum { STORED = 0, DEFLATED = 8 };

/* ---- The directory ---- */

bool vxm_zip_open(vxm_zip *zip, const unsigned char *data, size_t size) {
  size_t reach = size < END_SIZE + COMMENT_MAX ? size : END_SIZE + COMMENT_MAX;
  for (size_t back = END_SIZE; back <= reach; back++) {
    const unsigned char *at = data + size - back;
    if (memcmp(at, "PK\5\6", 4) != 0)
      continue;
    size_t length = vxm_load_le32(at + 12), offset = vxm_load_le32(at + 16);
    if (offset > size - back || length > size - back - offset)
      continue;
    *zip = (vxm_zip){.data = data, .at = data + offset, .end = data + offset + length};
    return true;
  }
  return false;
}

/** The bytes of a file, behind a head of its own. */
static bool find_data(vxm_zip_member *out, const vxm_zip *zip, size_t offset) {
  size_t size = (size_t)(zip->end - zip->data);
  const unsigned char *local = zip->data + offset;
  if (size < LOCAL_SIZE || offset > size - LOCAL_SIZE || memcmp(local, "PK\3\4", 4) != 0)
    return false;
  size_t head = LOCAL_SIZE + vxm_load_le16(local + 26) + vxm_load_le16(local + 28);
  out->data = local + head;
  return head <= size - offset && out->size <= size - offset - head;
}

bool vxm_zip_next(vxm_zip *zip, vxm_zip_member *out) {
  const unsigned char *at = zip->at;
  size_t left = (size_t)(zip->end - at);
  if (left < ENTRY_SIZE || memcmp(at, "PK\1\2", 4) != 0)
    return false;
  size_t name = vxm_load_le16(at + 28),
         length = ENTRY_SIZE + name + vxm_load_le16(at + 30) + vxm_load_le16(at + 32);
  if (length > left)
    return false;
  *out = (vxm_zip_member){.name = (const char *)at + ENTRY_SIZE,
                          .name_size = name,
                          .size = vxm_load_le32(at + 20),
                          .method = vxm_load_le16(at + 10)};
  zip->at += length;
  return find_data(out, zip, vxm_load_le32(at + 42));
}

/* ---- Unpacking ---- */

#ifdef HAVE_ZLIB
static void *take(void *payload, unsigned count, unsigned size) {
  return vxm_alloc(payload, count, size, NULL);
}

static void give(void *payload, void *block) {
  vxm_free(payload, block);
}

static bool unpack(const vxm_zip_member *member, vxm_context *context, vxm_zip_look look, void *payload) {
  char *piece = vxm_alloc(context, PIECE, 1, NULL);
  z_stream z = {.zalloc = take, .zfree = give, .opaque = context, .next_in = member->data};
  int state = piece && inflateInit2(&z, -MAX_WBITS) == Z_OK ? Z_OK : Z_MEM_ERROR;
  bool is_open = state == Z_OK;
  z.avail_in = (unsigned)member->size; /* the field in the archive has 32 bits as well */
  while (state == Z_OK) {
    z.next_out = (unsigned char *)piece;
    z.avail_out = PIECE;
    state = inflate(&z, Z_NO_FLUSH);
    if ((state == Z_OK || state == Z_STREAM_END) && !look(payload, piece, PIECE - z.avail_out))
      break;
  }
  if (is_open)
    inflateEnd(&z);
  vxm_free(context, piece);
  return is_open;
}
#else
static bool unpack(const vxm_zip_member *member, vxm_context *context, vxm_zip_look look, void *payload) {
  (void)member, (void)context, (void)look, (void)payload;
  return false;
}
#endif

bool vxm_zip_unpack(const vxm_zip_member *member, vxm_context *context, vxm_zip_look look, void *payload) {
  if (member->method == DEFLATED)
    return unpack(member, context, look, payload);
  const char *at = (const char *)member->data;
  size_t left = member->method == STORED ? member->size : 0;
  while (left > 0) {
    size_t some = left < PIECE ? left : PIECE;
    if (!look(payload, at, some))
      break;
    at += some;
    left -= some;
  }
  return member->method == STORED;
}
