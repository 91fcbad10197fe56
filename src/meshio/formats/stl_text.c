/* SPDX-License-Identifier: BSD-3-Clause */
/** STL as text: words in any case, any number of solids, facets of any size. */
#include "meshio/common/tags.h"
#include "meshio/common/truncation.h"
#include "meshio/formats/stl.h"

#include <inttypes.h>
#include <stdio.h>

typedef struct text_reader {
  vxm_tokenizer *scan;
  vxm_soup *soup;
  vxm_tagger tagger;
  const unsigned char *facet; /**< where the open facet began, NULL outside of facets */
  size_t facet_vertex;        /**< first vertex of the open facet */
  bool facet_bad;
  bool open; /**< a solid that has not ended */
  uint64_t solids;
  vxm_text_defect numbers, small, polygons, stray, unknown;
} text_reader;

/** Reads the word `rest` (lower case) after its first letter was told; the cursor moves only if it is there.
 */
static inline bool take_word(vxm_tokenizer *scan, const char *word, size_t length) {
  if ((size_t)(scan->end - scan->at) < length)
    return false;
  for (size_t i = 0; i < length; i++)
    if ((scan->at[i] | 0x20) != word[i])
      return false;
  const unsigned char *p = scan->at + length;
  if (p<scan->end && * p> ' ')
    return false;
  scan->at = p;
  return true;
}

/** Ends the open facet: its vertices become a face, or go. */
static vxm_status end_facet(text_reader *reader, vxm_error *error) {
  vxm_soup *soup = reader->soup;
  const unsigned char *facet = reader->facet;
  if (!facet)
    return VXM_OK;
  reader->facet = NULL;
  size_t corners = soup->vertex_count - reader->facet_vertex;
  if (reader->facet_bad || corners < 3) {
    vxm_text_defect_add(reader->facet_bad ? &reader->numbers : &reader->small, facet);
    soup->vertex_count = reader->facet_vertex;
    return VXM_OK;
  }
  if (corners > 3)
    vxm_text_defect_add(&reader->polygons, facet);
  vxm_status status = vxm_corners_reserve(soup, corners, error);
  for (size_t c = 0; status == VXM_OK && c < corners; c++)
    soup->indices[soup->corner_count + c] = (uint32_t)(reader->facet_vertex + c);
  if (status == VXM_OK)
    status = vxm_tagger_face(&reader->tagger, error);
  return status == VXM_OK ? vxm_face_end(soup, corners, error) : status;
}

static void begin_facet(text_reader *reader, const unsigned char *at) {
  reader->facet = at;
  reader->open = true;
  reader->facet_vertex = reader->soup->vertex_count;
  reader->facet_bad = false;
  /* The normal says nothing that the corners do not. */
  vxm_tokenizer *scan = reader->scan;
  if (vxm_more_on_line(scan) && take_word(scan, "normal", 6))
    for (int c = 0; c < 3 && vxm_more_on_line(scan); c++)
      vxm_skip_token(scan);
}

static vxm_status read_vertex(text_reader *reader, const unsigned char *at, vxm_error *error) {
  vxm_tokenizer *scan = reader->scan;
  double p[3];
  bool good = true;
  for (size_t c = 0; c < 3 && good; c++)
    good = vxm_more_on_line(scan) && vxm_tokenizer_double(scan, &p[c]);
  if (__builtin_expect(!good, 0)) {
    if (scan->at == scan->end) /* cut off: the facet ends before it */
      return VXM_OK;
    vxm_skip_rest(scan);
    reader->facet_bad = true;
    return VXM_OK;
  }
  if (!reader->facet) {
    vxm_text_defect_add(&reader->stray, at);
    return VXM_OK;
  }
  return vxm_soup_add_vertex(reader->soup, p[0], p[1], p[2], error);
}

static void begin_solid(text_reader *reader) {
  vxm_tokenizer *scan = reader->scan;
  const unsigned char *name = scan->at;
  vxm_skip_rest(scan);
  reader->solids++;
  reader->open = true;
  for (const unsigned char *p = name; p < scan->at; p++)
    if (*p > ' ') {
      vxm_tagger_group(&reader->tagger, name, (size_t)(scan->at - name));
      return;
    }
  char number[32];
  int length = snprintf(number, sizeof number, "solid %" PRIu64, reader->solids);
  vxm_tagger_group(&reader->tagger, (const unsigned char *)number, (size_t)length);
}

static vxm_status read_word(text_reader *reader, vxm_error *error) {
  vxm_tokenizer *scan = reader->scan;
  const unsigned char *at = scan->at;
  switch (*at | 0x20) {
  case 'v':
    if (take_word(scan, "vertex", 6))
      return read_vertex(reader, at, error);
    break;
  case 'o':
    if (take_word(scan, "outer", 5))
      return VXM_OK;
    break;
  case 'l':
    if (take_word(scan, "loop", 4))
      return VXM_OK;
    break;
  case 'f':
    if (take_word(scan, "facet", 5)) {
      vxm_status status = end_facet(reader, error);
      begin_facet(reader, at);
      return status;
    }
    break;
  case 'e':
    if (take_word(scan, "endloop", 7))
      return VXM_OK;
    if (take_word(scan, "endfacet", 8))
      return end_facet(reader, error);
    if (take_word(scan, "endsolid", 8)) {
      vxm_skip_rest(scan);
      reader->open = false;
      return end_facet(reader, error);
    }
    break;
  case 's':
    if (take_word(scan, "solid", 5)) {
      vxm_status status = end_facet(reader, error);
      begin_solid(reader);
      return status;
    }
    break;
  default:
    break;
  }
  vxm_text_defect_add(&reader->unknown, at);
  vxm_skip_token(scan);
  return VXM_OK;
}

static void note_damage(text_reader *reader, bool cut_off) {
  const vxm_tokenizer *scan = reader->scan;
  vxm_text_defect_warn_line(scan, &reader->numbers, "facet has a coordinate that is not a number; skipped",
                            "facets");
  vxm_text_defect_warn_line(scan, &reader->small, "facet has fewer than 3 vertices; skipped", "facets");
  vxm_text_defect_warn_line(scan, &reader->polygons, "facet has more than 3 vertices; kept as a polygon",
                            "facets");
  vxm_text_defect_warn_line(scan, &reader->stray, "vertex outside of a facet; skipped", "vertices");
  vxm_text_defect_warn_line(scan, &reader->unknown, "word that STL does not have; ignored", "words");
  if (cut_off)
    vxm_warn(&reader->soup->warnings, "line %" PRId64 ": the file ends within a facet",
             vxm_tokenizer_line(scan, scan->end));
  else if (reader->open)
    vxm_warn(&reader->soup->warnings, "line %" PRId64 ": the file ends without endsolid; it may be cut off",
             vxm_tokenizer_line(scan, scan->end));
  if (reader->soup->face_count == 0)
    vxm_warn(&reader->soup->warnings, "the file has no faces");
}

/** Makes about the room that will be needed, if each vertex has its line; else the soup grows as it is read.
 */
static void make_room(vxm_tokenizer *scan) {
  vxm_line_kinds kinds;
  vxm_sample_lines(scan, &kinds);
  size_t facets = (size_t)(1.03 * (kinds.longer['v'] + kinds.longer['V']) / 3.0);
  (void)vxm_soup_reserve(scan->soup, 3 * facets, facets, 3 * facets, NULL);
}

vxm_status vxm_stl_read_text(vxm_tokenizer *scan, vxm_error *error) {
  vxm_soup *soup = scan->soup;
  text_reader reader = {.scan = scan, .soup = soup};
  vxm_tagger_open(&reader.tagger, soup);
  make_room(scan);
  /* A number that touches the end of the file may be half a number. */
  const unsigned char *const end = scan->end, *const last = vxm_last_token(scan);
  if (last < end && strchr("+-.0123456789", *last))
    scan->end = last;
  vxm_status status = VXM_OK;
  while (status == VXM_OK && vxm_skip_space(scan)) {
    status = read_word(&reader, error);
    if (status == VXM_OK)
      status = vxm_tokenizer_progress(scan, error);
  }
  bool cut_off = reader.facet != NULL;
  if (status == VXM_OK)
    status = end_facet(&reader, error);
  vxm_tagger_close(&reader.tagger);
  scan->end = end;
  if (status != VXM_OK)
    return status;
  note_damage(&reader, cut_off);
  if (soup->tag_count < 2) /* one solid is the whole: its name sets nothing apart */
    vxm_tags_drop(soup);
  return VXM_OK;
}
