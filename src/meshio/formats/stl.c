/* SPDX-License-Identifier: BSD-3-Clause */
/** STL: telling text from binary, and the binary reader. */
#include "meshio/formats/stl.h"
#include "base/endian.h"
#include "meshio/common/format.h"

#include <inttypes.h>

/* ---- Which of the two ---- */

enum { HEAD = 4096 };

static bool starts_with(const unsigned char *data, size_t size, const char *word) {
  size_t at = 0;
  while (at < size && (vxm_is_blank(data[at]) || vxm_is_newline(data[at])))
    at++;
  for (size_t i = 0; word[i]; i++, at++)
    if (at == size || (data[at] | 0x20) != word[i])
      return false;
  return at == size || data[at] <= ' ';
}

/** Whether a word stands near the beginning, in any case. */
static bool has_word(const unsigned char *data, size_t size, const char *word) {
  size_t length = strlen(word), head = size < HEAD ? size : HEAD;
  for (size_t at = 0; at + length <= head; at++) {
    size_t i = 0;
    while (i < length && (data[at + i] | 0x20) == word[i])
      i++;
    if (i == length)
      return true;
  }
  return false;
}

/** Text may lack its first line, or have a stray control code in its name; binary facets have many. */
static bool is_text(const unsigned char *data, size_t size) {
  size_t head = size < HEAD ? size : HEAD;
  if (vxm_stl_is_binary(data, size) || vxm_control_bytes(data, head) * 16 > head)
    return false;
  return starts_with(data, size, "solid") ||
         (has_word(data, size, "facet") && has_word(data, size, "vertex"));
}

vxm_likeness vxm_stl_sniff(const unsigned char *data, size_t size) {
  if (vxm_stl_is_binary(data, size) || starts_with(data, size, "solid") || starts_with(data, size, "facet"))
    return VXM_LIKENESS_CERTAIN;
  return VXM_LIKENESS_NONE;
}

/* ---- Binary ---- */

static inline void read_facet(const unsigned char *from, double *to, bool swap) {
  for (size_t c = 0; c < 9; c++)
    to[c] = (double)vxm_load_f32(from + 12 + 4 * c, swap);
}

static vxm_status read_facets(vxm_tokenizer *scan, size_t count, vxm_error *error) {
  vxm_soup *soup = scan->soup;
  vxm_status status = vxm_soup_reserve(soup, 3 * count, count, 3 * count, error);
  size_t done = 0;
  while (status == VXM_OK && done < count) {
    /* Some tens of kilobytes at a time, so that all arrays stay in cache between the loops. */
    size_t piece = count - done < 1024 ? count - done : 1024;
    double *position = soup->positions + 9 * done;
    if (vxm_must_swap(false))
      for (size_t f = 0; f < piece; f++)
        read_facet(scan->at + f * VXM_STL_FACET, position + 9 * f, true);
    else
      for (size_t f = 0; f < piece; f++)
        read_facet(scan->at + f * VXM_STL_FACET, position + 9 * f, false);
    for (size_t c = 3 * done; c < 3 * (done + piece); c++)
      soup->indices[c] = (uint32_t)c;
    for (size_t f = done + 1; f <= done + piece; f++)
      soup->offsets[f] = 3 * f;
    done += piece;
    scan->at += piece * VXM_STL_FACET;
    status = vxm_tokenizer_progress(scan, error);
  }
  soup->vertex_count = soup->corner_count = 3 * done;
  soup->face_count = done;
  return status;
}

static vxm_status read_binary(vxm_tokenizer *scan, vxm_error *error) {
  vxm_soup *soup = scan->soup;
  size_t size = (size_t)(scan->end - scan->begin);
  if (size < VXM_STL_FACETS_AT)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){scan->name, 0, (int64_t)size, -1},
                       "neither text (no \"solid\") nor binary STL, which has at least 84 bytes");
  uint64_t wanted = vxm_stl_announced(scan->begin), room = (size - VXM_STL_FACETS_AT) / VXM_STL_FACET;
  uint64_t count = wanted < room ? wanted : room;
  bool sound = vxm_stl_is_binary(scan->begin, size);
  if (!sound && vxm_control_bytes(scan->begin + VXM_STL_COUNT_AT, size - VXM_STL_COUNT_AT) == 0)
    return vxm_fail_at(
        error, VXM_ERROR_FORMAT, (vxm_place){scan->name, 0, 0, -1},
        "neither text STL (no \"facet\" with \"vertex\") nor binary: all of it is some other text");
  /* A count of 0 before facets was never filled in; another count that is too small is believed less than the
     size of the file too. */
  if (wanted < room && ((wanted == 0 && sound) || (size - VXM_STL_FACETS_AT) % VXM_STL_FACET == 0))
    count = room;
  if (wanted > 0 && room == 0)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){scan->name, 0, (int64_t)size, 0},
                       "%" PRIu64 " facets are announced, but the file holds none", wanted);
  scan->at = scan->begin + VXM_STL_FACETS_AT;
  vxm_status status = read_facets(scan, (size_t)count, error);
  if (status != VXM_OK)
    return status;
  if (count != wanted)
    vxm_warn(&soup->warnings,
             "byte %d: %" PRIu64 " facets are announced, but the file holds %" PRIu64 "; those are read",
             VXM_STL_COUNT_AT, wanted, count);
  size_t rest = (size_t)(scan->end - scan->at);
  if (rest > 0)
    vxm_warn(&soup->warnings, "byte %zu: more after the last facet; ignored (bytes: %zu)", size - rest, rest);
  if (count != wanted || rest > 0)
    vxm_warn_text_conversion(scan);
  if (count == 0)
    vxm_warn(&soup->warnings, "the file has no faces");
  return VXM_OK;
}

vxm_status vxm_stl_read(vxm_soup *soup, const unsigned char *data, size_t size, const char *name,
                        vxm_error *error) {
  vxm_tokenizer scan = vxm_tokenizer_of(soup, data, size, name);
  bool text = is_text(data, size);
  soup->format = text ? "stl ascii" : "stl binary";
  vxm_status status = text ? vxm_stl_read_text(&scan, error) : read_binary(&scan, error);
  if (status == VXM_OK)
    vxm_soup_trim(soup);
  return status;
}
