/* SPDX-License-Identifier: BSD-3-Clause */
#include "modules/assimp/zip.h"
#include "base/endian.h"
#include "config.h"

#include <limits.h>
#include <string.h>

#ifdef HAVE_ZLIB
#define ZLIB_CONST
#include <zlib.h>
#endif

enum { END_SIZE = 22, END64_SIZE = 56, LOCATOR_SIZE = 20, ENTRY_SIZE = 46, LOCAL_SIZE = 30 };
enum { COMMENT_MAX = 65535 };
enum { STORED = 0, DEFLATED = 8 };

/* ---- The directory ---- */

/** Finds the larger end record (4.3.14, 4.3.15) that stands before the plain one at `place`. */
static bool find_end64(size_t *out, const unsigned char *data, size_t place) {
  if (place < END64_SIZE + LOCATOR_SIZE || memcmp(data + place - LOCATOR_SIZE, "PK\6\7", 4) != 0)
    return false;
  uint64_t at = vxm_load_le64(data + place - LOCATOR_SIZE + 8);
  if (at > place - LOCATOR_SIZE - END64_SIZE || memcmp(data + at, "PK\6\6", 4) != 0)
    return false;
  *out = (size_t)at;
  return true;
}

/** Opens the directory that the end record at `place` tells of. */
static bool open_at(vxm_zip *zip, const unsigned char *data, size_t place) {
  uint64_t length = vxm_load_le32(data + place + 12), offset = vxm_load_le32(data + place + 16);
  if (length == UINT32_MAX || offset == UINT32_MAX) {
    if (!find_end64(&place, data, place))
      return false;
    length = vxm_load_le64(data + place + 40);
    offset = vxm_load_le64(data + place + 48);
  }
  if (offset > place || length > place - offset)
    return false;
  zip->data = data;
  zip->at = data + offset;
  zip->end = zip->at + length;
  zip->left = (size_t)offset;
  return true;
}

bool vxm_zip_open(vxm_zip *zip, const unsigned char *data, size_t size) {
  size_t reach = size < END_SIZE + COMMENT_MAX ? size : END_SIZE + COMMENT_MAX;
  for (size_t back = END_SIZE; back <= reach; back++)
    if (memcmp(data + size - back, "PK\5\6", 4) == 0 && open_at(zip, data, size - back))
      return true;
  return false;
}

/** The numbers of 8 bytes that stand in for those of an entry that are all ones (4.5.3). */
typedef struct wide {
  const unsigned char *at;
  size_t size;
} wide;

static wide find_wide(const unsigned char *extra, size_t size) {
  while (size >= 4) {
    size_t length = vxm_load_le16(extra + 2);
    if (length > size - 4)
      break;
    if (vxm_load_le16(extra) == 1)
      return (wide){extra + 4, length};
    extra += 4 + length;
    size -= 4 + length;
  }
  return (wide){NULL, 0};
}

/** A number of an entry, or what stands in for it. */
static uint64_t take_number(wide *from, const unsigned char *at) {
  uint64_t number = vxm_load_le32(at);
  if (number == UINT32_MAX && from->size >= 8) {
    number = vxm_load_le64(from->at);
    from->at += 8;
    from->size -= 8;
  }
  return number;
}

/** The bytes of a file, behind a head of its own. */
static bool find_data(vxm_zip_member *out, const vxm_zip *zip, uint64_t size, uint64_t offset) {
  uint64_t all = (uint64_t)(zip->end - zip->data);
  if (all < LOCAL_SIZE || offset > all - LOCAL_SIZE || memcmp(zip->data + offset, "PK\3\4", 4) != 0)
    return false;
  const unsigned char *local = zip->data + offset;
  uint64_t head = (uint64_t)LOCAL_SIZE + vxm_load_le16(local + 26) + vxm_load_le16(local + 28);
  if (head > all - offset || size > all - offset - head)
    return false;
  out->data = local + head;
  out->size = (size_t)size;
  return true;
}

bool vxm_zip_next(vxm_zip *zip, vxm_zip_member *out) {
  for (;;) {
    const unsigned char *at = zip->at;
    size_t left = (size_t)(zip->end - at);
    if (left < ENTRY_SIZE || memcmp(at, "PK\1\2", 4) != 0)
      return false;
    size_t name = vxm_load_le16(at + 28), extra = vxm_load_le16(at + 30);
    size_t length = ENTRY_SIZE + name + extra + vxm_load_le16(at + 32);
    if (length > left)
      return false;
    *out = (vxm_zip_member){
        .name = (const char *)at + ENTRY_SIZE, .name_size = name, .method = vxm_load_le16(at + 10)};
    wide numbers = find_wide(at + ENTRY_SIZE + name, extra);
    take_number(&numbers, at + 24); /* the size as it is unpacked comes first */
    uint64_t size = take_number(&numbers, at + 20), offset = take_number(&numbers, at + 42);
    zip->at += length;
    if (find_data(out, zip, size, offset))
      return true;
  }
}

/** Narrows an entry; its wide numbers get a tag that nobody reads. */
static bool narrow_entry(unsigned char *at, size_t name, size_t extra) {
  enum { NO_TAG = 0xffff };
  wide numbers = find_wide(at + ENTRY_SIZE + name, extra);
  const unsigned char *first = numbers.at;
  if (!first)
    return false;
  uint64_t whole = take_number(&numbers, at + 24), size = take_number(&numbers, at + 20),
           offset = take_number(&numbers, at + 42);
  if (whole >= UINT32_MAX || size >= UINT32_MAX || offset >= UINT32_MAX)
    return false;
  vxm_store_le32(at + 24, (uint32_t)whole);
  vxm_store_le32(at + 20, (uint32_t)size);
  vxm_store_le32(at + 42, (uint32_t)offset);
  vxm_store_le(at + (first - at) - 4, NO_TAG, 2);
  return true;
}

bool vxm_zip_narrow(unsigned char *data, size_t size) {
  vxm_zip zip;
  bool any = false;
  if (!vxm_zip_open(&zip, data, size))
    return false;
  size_t at = (size_t)(zip.at - data), end = (size_t)(zip.end - data);
  while (end - at >= ENTRY_SIZE && memcmp(data + at, "PK\1\2", 4) == 0) {
    size_t name = vxm_load_le16(data + at + 28), extra = vxm_load_le16(data + at + 30);
    size_t length = ENTRY_SIZE + name + extra + vxm_load_le16(data + at + 32);
    if (length > end - at)
      break;
    any |= narrow_entry(data + at, name, extra);
    at += length;
  }
  return any;
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
  char *piece = vxm_alloc(context, VXM_ZIP_PIECE, 1, NULL);
  z_stream z = {.zalloc = take, .zfree = give, .opaque = context, .next_in = member->data};
  int state = piece && inflateInit2(&z, -MAX_WBITS) == Z_OK ? Z_OK : Z_MEM_ERROR;
  bool is_open = state == Z_OK;
  for (size_t left = member->size; state == Z_OK;) {
    if (z.avail_in == 0) { /* which may hold less than the size */
      z.avail_in = left < UINT_MAX ? (unsigned)left : UINT_MAX;
      left -= z.avail_in;
    }
    z.next_out = (unsigned char *)piece;
    z.avail_out = VXM_ZIP_PIECE;
    state = inflate(&z, Z_NO_FLUSH);
    if ((state == Z_OK || state == Z_STREAM_END) && !look(payload, piece, VXM_ZIP_PIECE - z.avail_out))
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

bool vxm_zip_unpack(vxm_zip *zip, const vxm_zip_member *member, vxm_context *context, vxm_zip_look look,
                    void *payload) {
  if (member->size > zip->left)
    return false;
  zip->left -= member->size;
  if (member->method == DEFLATED)
    return unpack(member, context, look, payload);
  const char *at = (const char *)member->data;
  size_t left = member->method == STORED ? member->size : 0;
  while (left > 0) {
    size_t some = left < VXM_ZIP_PIECE ? left : VXM_ZIP_PIECE;
    if (!look(payload, at, some))
      break;
    at += some;
    left -= some;
  }
  return member->method == STORED;
}
