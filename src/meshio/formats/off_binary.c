/* SPDX-License-Identifier: BSD-3-Clause */
/** OFF BINARY: big-endian 32-bit numbers (geomview's manual, "OFF Files"). */
#include "base/endian.h"
#include "meshio/formats/off.h"

#include <inttypes.h>

enum { WORD = 4 };

static size_t left(const vxm_tokenizer *scan) {
  return (size_t)(scan->end - scan->at);
}

static vxm_place place_here(const vxm_tokenizer *scan) {
  return (vxm_place){scan->name, 0, (int64_t)(scan->at - scan->begin), -1};
}

static bool read_word(vxm_tokenizer *scan, uint32_t *word) {
  if (left(scan) < WORD)
    return false;
  *word = vxm_load_u32(scan->at, vxm_must_swap(true));
  scan->at += WORD;
  return true;
}

static vxm_status read_counts(vxm_tokenizer *scan, vxm_off_header *header, uint32_t *vertices,
                              uint32_t *faces, vxm_error *error) {
  uint32_t dimension = 3, edges;
  if ((header->n_dimensional && !read_word(scan, &dimension)) || !read_word(scan, vertices) ||
      !read_word(scan, faces) || !read_word(scan, &edges))
    return vxm_fail_at(error, VXM_ERROR_FORMAT, place_here(scan), "the file ends within its counts");
  if (dimension == 0 || dimension > left(scan))
    return vxm_fail_at(error, VXM_ERROR_FORMAT, place_here(scan), "%" PRIu32 " dimensions cannot be read",
                       dimension);
  header->dimension = (size_t)dimension + header->four;
  return VXM_OK;
}

static vxm_status read_vertices(vxm_tokenizer *scan, const vxm_off_header *header, size_t vertices,
                                vxm_error *error) {
  vxm_soup *soup = scan->soup;
  size_t stride = (header->dimension + vxm_off_extras(header)) * WORD;
  if (vertices > left(scan) / stride)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, place_here(scan),
                       "%zu vertices are announced, but the file has room for %zu at most", vertices,
                       left(scan) / stride);
  vxm_status status = vxm_soup_reserve(soup, vertices, 0, 0, error);
  const size_t kept = header->dimension < 3 ? header->dimension : 3;
  const bool swap = vxm_must_swap(true), has_colors = vxm_off_vertex_colors(soup, header);
  const size_t normal = header->normals ? 3 : 0;
  for (size_t v = 0; v < vertices && status == VXM_OK; v++) {
    double *p = soup->positions + 3 * v;
    for (size_t c = 0; c < 3; c++)
      p[c] = c < kept ? (double)vxm_load_f32(scan->at + c * WORD, swap) : 0.0;
    if (has_colors) {
      double rgba[4];
      for (size_t c = 0; c < 4; c++)
        rgba[c] = (double)vxm_load_f32(scan->at + (header->dimension + normal + c) * WORD, swap);
      status = vxm_gather_color(&soup->appearance->vertices, soup->context, v, rgba, error);
    }
    scan->at += stride;
    if (status == VXM_OK)
      status = vxm_tokenizer_progress(scan, error);
  }
  soup->vertex_count = vertices;
  return status;
}

/** Reads one face; false where the file ends within it. */
static vxm_status read_face(vxm_tokenizer *scan, bool *complete, vxm_text_defect *beyond,
                            vxm_text_defect *small, vxm_error *error) {
  vxm_soup *soup = scan->soup;
  const unsigned char *first = scan->at;
  uint32_t n, colours;
  *complete = false;
  if (!read_word(scan, &n) || n > left(scan) / WORD)
    return VXM_OK;
  vxm_status status = vxm_corners_reserve(soup, n, error);
  if (status != VXM_OK)
    return status;
  const unsigned char *from = scan->at;
  scan->at += (size_t)n * WORD;
  if (!read_word(scan, &colours) || colours > left(scan) / WORD)
    return VXM_OK;
  scan->at += (size_t)colours * WORD;
  *complete = true;
  bool outside = false;
  uint32_t *corner = soup->indices + soup->corner_count;
  for (size_t c = 0; c < n; c++) {
    corner[c] = vxm_load_u32(from + c * WORD, vxm_must_swap(true));
    outside |= corner[c] >= soup->vertex_count;
  }
  if (outside || n < 3) {
    vxm_text_defect_add(outside ? beyond : small, first);
    return VXM_OK;
  }
  status = vxm_face_end(soup, n, error);
  if (status == VXM_OK && soup->appearance && (colours == 3 || colours == 4)) {
    double rgba[4] = {0, 0, 0, 0};
    for (size_t c = 0; c < colours; c++)
      rgba[c] = (double)vxm_load_f32(from + (n + 1 + c) * WORD, vxm_must_swap(true));
    status = vxm_gather_color(&soup->appearance->faces, soup->context, soup->face_count - 1, rgba, error);
  }
  return status;
}

vxm_status vxm_off_read_binary(vxm_tokenizer *scan, vxm_off_header *header, vxm_error *error) {
  vxm_soup *soup = scan->soup;
  uint32_t vertices = 0, faces = 0, done = 0;
  vxm_text_defect beyond = {0}, small = {0};
  vxm_status status = read_counts(scan, header, &vertices, &faces, error);
  if (status == VXM_OK)
    status = read_vertices(scan, header, vertices, error);
  if (status != VXM_OK)
    return status;
  /* A triangle takes 20 bytes: its size, three indices and the number of colours. */
  size_t room = left(scan) / (5 * WORD) + 1, expected = faces < room ? faces : room;
  status = vxm_soup_reserve(soup, 0, expected, expected * 3, error);
  bool complete = true;
  const unsigned char *face = scan->at;
  for (; status == VXM_OK && done < faces; done += complete) {
    face = scan->at;
    status = read_face(scan, &complete, &beyond, &small, error);
    if (!complete)
      break;
    if (status == VXM_OK)
      status = vxm_tokenizer_progress(scan, error);
  }
  if (status != VXM_OK)
    return status;
  if (header->dimension != 3)
    vxm_warn(&soup->warnings, "vertices have %zu coordinates; only x y z are kept, missing ones are 0",
             header->dimension);
  vxm_text_defect_warn_byte(scan, &beyond, "face names a vertex that does not exist; skipped", "faces");
  vxm_text_defect_warn_byte(scan, &small, "face has fewer than 3 corners; skipped", "faces");
  int64_t offset = (int64_t)(face - scan->begin);
  if (done < faces && soup->face_count == 0)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){scan->name, 0, offset, (int64_t)done},
                       "face %" PRIu32 " of %" PRIu32 " is cut off, and none before it can be used", done,
                       faces);
  if (done < faces)
    vxm_warn(&soup->warnings, "byte %" PRId64 ": the file ends after %" PRIu32 " of %" PRIu32 " faces",
             offset, done, faces);
  else if (left(scan) > 0)
    vxm_warn(&soup->warnings, "byte %" PRId64 ": more than announced; ignored (bytes: %zu)",
             (int64_t)(scan->at - scan->begin), left(scan));
  if (done < faces || beyond.count > 0)
    vxm_warn_text_conversion(scan);
  if (soup->face_count == 0)
    vxm_warn(&soup->warnings, "the file has no faces");
  return VXM_OK;
}
