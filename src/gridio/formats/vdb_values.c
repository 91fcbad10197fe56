/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/vdb_values.h"
#include "base/bits.h"
#include "base/endian.h"
#include "gridio/common/format.h"

/** Which inactive values of a node stand in the file; the others are the background. */
enum {
  ALL_BACKGROUND,       /**< none */
  ALL_MINUS_BACKGROUND, /**< none */
  ALL_ONE_VALUE,        /**< one, of all */
  MINUS_OR_PLUS,        /**< a mask of which are plus and which minus the background */
  ONE_OR_BACKGROUND,    /**< one, and a mask of which are the background */
  ONE_OR_OTHER,         /**< two, and a mask of which are the second */
  EVERY_VALUE           /**< all, in their places */
};

float vxm_vdb_value_at(const vxm_vdb_grid *grid, const unsigned char *bytes) {
  if (grid->type != VXM_VDB_TYPE_FLOAT)
    return bytes[0] != 0;
  uint32_t word = vxm_load_le32(bytes);
  float value;
  memcpy(&value, &word, sizeof value);
  return value;
}

static vxm_status fail_short(const vxm_vdb_values *v) {
  return vxm_fail_byte(v->error, v->input, v->input->size, "the file is cut short");
}

/** The next bytes; NULL, with an error, if the file ends before. */
static const unsigned char *take(const vxm_vdb_values *v, size_t *at, uint64_t size) {
  const unsigned char *bytes = v->input->data + *at;
  if (v->input->size - *at < size) {
    fail_short(v);
    return NULL;
  }
  *at += (size_t)size;
  return bytes;
}

/** Bytes of one of many. */
static size_t item_bytes(const vxm_vdb_grid *grid) {
  return grid->type != VXM_VDB_TYPE_FLOAT ? 1 : grid->is_half ? 2 : 4;
}

static void convert(float *out, const vxm_vdb_grid *grid, const unsigned char *bytes, size_t count) {
  for (size_t i = 0; i < count; i++)
    out[i] = grid->is_half ? vxm_half_value(bytes[2 * i] | (unsigned)bytes[2 * i + 1] << 8)
                           : vxm_vdb_value_at(grid, bytes + i * item_bytes(grid));
}

/* ---- Chunks ---- */

/** What blosc says of itself must be what is there: it does not look at where its input ends. */
static bool is_blosc_sound(const unsigned char *chunk, size_t length, size_t bytes) {
  enum { HEAD = 8, BLOSC_HEAD = 16 };
  return length >= BLOSC_HEAD && vxm_load_le32(chunk + HEAD + 4) == bytes &&
         vxm_load_le32(chunk + HEAD + 12) == length;
}

/** Unpacks a chunk of `length` bytes behind the 8 of its length. */
static vxm_status unpack(vxm_vdb_values *v, size_t begin, size_t length, size_t bytes) {
  bool is_blosc = v->grid->compression & VXM_VDB_BLOSC;
  const unsigned char *chunk = v->input->data + begin;
  vxm_status status = VXM_OK;
  if (is_blosc && !is_blosc_sound(chunk, length, bytes))
    return vxm_fail_byte(v->error, v->input, begin, "the packed values are damaged");
  if (!v->functions)
    status = vxm_vdb_open(&v->functions, "unpacking the values of .vdb files", v->error);
  if (status != VXM_OK)
    return status;
  vxm_error why = VXM_ERROR_INIT;
  status = v->functions->unpack(v->room->bytes, bytes, chunk, 8 + length, is_blosc, &why);
  if (status == VXM_ERROR_FORMAT)
    return vxm_fail_byte(v->error, v->input, begin, "the packed values are damaged (%s)", why.text);
  if (status != VXM_OK && v->error)
    *v->error = why;
  return status;
}

/**
 * Values behind each other, in chunks where they are packed: 8 bytes of length, negative or 0 if the values
 * were not worth it. NULL with *status set if there is an error; where values are only skipped, any pointer.
 */
static const unsigned char *read_items(vxm_vdb_values *v, size_t *at, size_t count, bool is_wanted,
                                       vxm_status *status) {
  size_t bytes = count * item_bytes(v->grid), begin = *at;
  const unsigned char *plain = NULL;
  *status = VXM_ERROR_FORMAT;
  if (!(v->grid->compression & (VXM_VDB_BLOSC | VXM_VDB_ZIP)) || (v->grid->is_half && count == 0))
    plain = take(v, at, bytes);
  else {
    const unsigned char *head = take(v, at, 8);
    if (!head)
      return NULL;
    int64_t length = (int64_t)vxm_load_le64(head);
    if (length <= 0 && (uint64_t)0 - (uint64_t)length != bytes) {
      vxm_fail_byte(v->error, v->input, begin, "a length of values is damaged");
      return NULL;
    }
    plain = take(v, at, length <= 0 ? bytes : (uint64_t)length);
    if (plain && length > 0 && is_wanted) {
      *status = unpack(v, begin, (size_t)length, bytes);
      return *status == VXM_OK ? v->room->bytes : NULL;
    }
  }
  *status = plain ? VXM_OK : VXM_ERROR_FORMAT;
  return plain;
}

/* ---- Nodes ---- */

/** The values that inactive voxels may have, and the mask that chooses between them. */
typedef struct inactive {
  float first, second;
  const unsigned char *mask; /**< set = the second; NULL = all are the first */
} inactive;

/** @return the flag, or -1 with an error */
static int read_inactive(inactive *out, const vxm_vdb_values *v, size_t *at, size_t count) {
  size_t begin = *at, size = vxm_vdb_value_bytes(v->grid);
  const unsigned char *flag = take(v, at, 1);
  if (!flag)
    return -1;
  if (*flag > EVERY_VALUE) {
    vxm_fail_byte(v->error, v->input, begin, "the masks of a node are damaged");
    return -1;
  }
  float opposite = v->grid->type == VXM_VDB_TYPE_FLOAT ? -v->background : 1 - v->background;
  *out = (inactive){*flag == ALL_BACKGROUND ? v->background : opposite, v->background, NULL};
  int stored = *flag == ONE_OR_OTHER ? 2 : *flag == ALL_ONE_VALUE || *flag == ONE_OR_BACKGROUND ? 1 : 0;
  const unsigned char *values = take(v, at, (size_t)stored * size);
  if (!values)
    return -1;
  if (stored > 0)
    out->first = vxm_vdb_value_at(v->grid, values);
  if (stored > 1)
    out->second = vxm_vdb_value_at(v->grid, values + size);
  if (*flag >= MINUS_OR_PLUS && *flag <= ONE_OR_OTHER) {
    out->mask = take(v, at, count / 8);
    if (!out->mask)
      return -1;
  }
  return *flag;
}

/** Puts active values into their places, and inactive ones between them. */
static void spread(float *out, const float *active, const inactive *other, const uint64_t *mask,
                   size_t count) {
  for (size_t i = 0; i < count; i++) {
    bool is_active = mask[i / 64] >> (i % 64) & 1;
    bool is_second = other->mask && (other->mask[i / 8] >> (i % 8) & 1);
    out[i] = is_active ? *active++ : is_second ? other->second : other->first;
  }
}

vxm_status vxm_vdb_values_read(vxm_vdb_values *values, size_t *at, const uint64_t *mask, size_t count,
                               float *out) {
  inactive other;
  int flag = read_inactive(&other, values, at, count);
  if (flag < 0)
    return VXM_ERROR_FORMAT;
  size_t active = 0, there = count;
  for (size_t w = 0; w < count / 64; w++)
    active += (size_t)vxm_popcount(mask[w]);
  if ((values->grid->compression & VXM_VDB_ACTIVE_ONLY) && flag != EVERY_VALUE)
    there = active;
  vxm_status status;
  const unsigned char *bytes = read_items(values, at, there, out != NULL, &status);
  if (!bytes || !out)
    return status;
  if (there == count) {
    convert(out, values->grid, bytes, count);
    return VXM_OK;
  }
  convert(values->room->values, values->grid, bytes, there);
  spread(out, values->room->values, &other, mask, count);
  return VXM_OK;
}
