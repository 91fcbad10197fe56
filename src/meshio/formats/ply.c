/* SPDX-License-Identifier: BSD-3-Clause */
/** PLY: header, body and what they came to. */
#include "meshio/formats/ply.h"
#include "meshio/common/format.h"
#include "meshio/common/truncation.h"

#include <inttypes.h>

vxm_likeness vxm_ply_sniff(const unsigned char *data, size_t size) {
  return size >= 4 && memcmp(data, "ply", 3) == 0 && data[3] <= ' ' ? VXM_LIKENESS_CERTAIN
                                                                    : VXM_LIKENESS_NONE;
}

vxm_status vxm_ply_strip_add(vxm_ply_strip *strip, vxm_soup *soup, int64_t index, uint64_t limit,
                             const unsigned char *at, vxm_ply_body *body, vxm_error *error) {
  if (index < 0 || (uint64_t)index >= limit) {
    if (index != -1)
      vxm_text_defect_add(&body->bad_strips, at);
    strip->count = 0;
    return VXM_OK;
  }
  uint32_t a = strip->a, b = strip->b, c = (uint32_t)index;
  strip->a = b;
  strip->b = c;
  if (++strip->count < 3 || a == b || b == c || a == c)
    return VXM_OK;
  vxm_status status = vxm_corners_reserve(soup, 3, error);
  if (status != VXM_OK)
    return status;
  bool turned = strip->count % 2 == 0; /* the 1st triangle ends with the 3rd corner */
  uint32_t *corner = soup->indices + soup->corner_count;
  corner[0] = turned ? b : a;
  corner[1] = turned ? a : b;
  corner[2] = c;
  return vxm_face_end(soup, 3, error);
}

static uint64_t announced_faces(const vxm_ply_header *header) {
  uint64_t faces = 0;
  for (size_t e = 0; e < header->element_count; e++)
    if (header->elements[e].role == VXM_PLY_FACES || header->elements[e].role == VXM_PLY_STRIPS)
      faces += header->elements[e].count > 0;
  return faces;
}

typedef void warn_fn(const vxm_tokenizer *scan, const vxm_text_defect *tally, const char *what,
                     const char *things);

static void warn_of_damage(const vxm_tokenizer *scan, const vxm_ply_header *header,
                           const vxm_ply_body *body) {
  warn_fn *warn = header->ascii ? vxm_text_defect_warn_line : vxm_text_defect_warn_byte;
  vxm_text_defect_warn_line(scan, &header->no_corners, "faces have no list vertex_indices; passed over",
                            "elements");
  warn(scan, &body->numbers, "coordinate is not a number; taken as NaN", "numbers");
  warn(scan, &body->short_lines, "line has fewer values than the header says", "lines");
  warn(scan, &body->long_lines, "line has more values than the header says; the rest is ignored", "lines");
  warn(scan, &body->bad_faces, "face is not a list of whole numbers; skipped", "faces");
  warn(scan, &body->beyond, "face names a vertex that does not exist; skipped", "faces");
  warn(scan, &body->small_faces, "face has fewer than 3 corners; skipped", "faces");
  warn(scan, &body->bad_strips, "strip names a vertex that does not exist; broken off there", "numbers");
}

static vxm_place place_of_end(const vxm_tokenizer *scan, const vxm_ply_header *header) {
  if (header->ascii)
    return vxm_tokenizer_place(scan, scan->end);
  return (vxm_place){scan->name, 0, (int64_t)(scan->end - scan->begin), -1};
}

/** The file ended early: what was read is worth having only if it has faces, or was meant to have none. */
static vxm_status judge_cut(const vxm_tokenizer *scan, const vxm_ply_header *header, const vxm_ply_body *body,
                            vxm_error *error) {
  vxm_soup *soup = scan->soup;
  const vxm_ply_element *cut = body->cut;
  if (!cut)
    return VXM_OK;
  char name[VXM_QUOTE];
  vxm_quote(name, scan->begin + cut->name_at, cut->name_length);
  if (soup->vertex_count == 0 || (soup->face_count == 0 && announced_faces(header) > 0))
    return vxm_fail_at(error, VXM_ERROR_FORMAT, place_of_end(scan, header),
                       "the file ends after %" PRIu64 " of %" PRIu64
                       " elements \"%s\"; what it holds up to there is no mesh",
                       body->cut_done, cut->count, name);
  vxm_place end = place_of_end(scan, header);
  vxm_warn(&soup->warnings, "%s %" PRId64 ": the file ends after %" PRIu64 " of %" PRIu64 " elements \"%s\"",
           header->ascii ? "line" : "byte", header->ascii ? end.line : end.offset, body->cut_done, cut->count,
           name);
  return VXM_OK;
}

static vxm_status finish(vxm_tokenizer *scan, const vxm_ply_header *header, vxm_ply_body *body,
                         vxm_error *error) {
  vxm_soup *soup = scan->soup;
  if (body->faces_first && soup->vertex_count < header->vertices) {
    size_t dropped = vxm_soup_drop_bad_faces(soup);
    if (dropped > 0)
      vxm_warn(&soup->warnings, "faces name vertices that are cut off; skipped (faces: %zu)", dropped);
  }
  vxm_status status = judge_cut(scan, header, body, error);
  if (status != VXM_OK)
    return status;
  warn_of_damage(scan, header, body);
  if (header->ascii && vxm_skip_space(scan))
    vxm_warn(&soup->warnings, "line %" PRId64 ": more than announced; ignored (lines: %" PRIu64 ")",
             vxm_tokenizer_line(scan, scan->at), vxm_lines_with_data(scan, 0, UINT64_MAX));
  else if (!header->ascii && scan->at < scan->end && !body->cut)
    vxm_warn(&soup->warnings, "byte %zu: more than announced; ignored (bytes: %zu)",
             (size_t)(scan->at - scan->begin), (size_t)(scan->end - scan->at));
  if (!header->ascii && (body->cut || body->beyond.count > 0))
    vxm_warn_text_conversion(scan);
  if (body->last && vxm_last_token(scan) < scan->end &&
      (body->faces_first || vxm_last_index_may_be_truncated(soup, 0)))
    vxm_warn(&soup->warnings,
             "line %" PRId64 ": the file ends without a line end; its last number may be cut off",
             vxm_tokenizer_line(scan, body->last));
  if (soup->vertex_count == 0)
    vxm_warn(&soup->warnings, "the file has no vertices");
  else if (soup->face_count == 0)
    vxm_warn(&soup->warnings, "the file has no faces");
  return VXM_OK;
}

static vxm_status read_body(vxm_tokenizer *scan, const vxm_ply_header *header, vxm_error *error) {
  vxm_ply_body body = {0};
  for (size_t e = 0; e < header->element_count && header->elements[e].role != VXM_PLY_VERTICES; e++)
    body.faces_first |= header->elements[e].role != VXM_PLY_PASSED;
  vxm_status status = header->ascii ? vxm_ply_read_text(scan, header, &body, error)
                                    : vxm_ply_read_binary(scan, header, &body, error);
  return status == VXM_OK ? finish(scan, header, &body, error) : status;
}

vxm_status vxm_ply_read(vxm_soup *soup, const unsigned char *data, size_t size, const char *name,
                        vxm_error *error) {
  vxm_tokenizer scan = vxm_tokenizer_of(soup, data, size, name);
  vxm_ply_header header = {0};
  vxm_status status = vxm_ply_read_header(&scan, &header, error);
  if (status == VXM_OK) {
    soup->format = header.ascii        ? "ply ascii"
                   : header.big_endian ? "ply binary_big_endian"
                                       : "ply binary_little_endian";
    status = read_body(&scan, &header, error);
  }
  vxm_ply_header_destroy(&header, soup->context);
  if (status == VXM_OK)
    vxm_soup_trim(soup);
  return status;
}
