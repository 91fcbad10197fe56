/* SPDX-License-Identifier: BSD-3-Clause */
/** OFF as text: by lines where the file keeps to lines, by tokens where it does not. */
#include "meshio/formats/off.h"
#include "meshio/common/format.h"
#include "meshio/common/truncation.h"

#include <inttypes.h>
#include <math.h>

/** The damage a text file can have. */
typedef struct off_damage {
  vxm_text_defect numbers, short_vertices, beyond, small_faces, bad_faces, short_faces, cut;
} off_damage;

/** Every number takes a digit and a separator, so the file's size bounds what it can hold. */
static vxm_status check_vertex_count(const vxm_tokenizer *scan, uint64_t vertices, size_t dimension,
                                     vxm_error *error) {
  uint64_t room = ((uint64_t)(scan->end - scan->at) + 1) / (2 * (uint64_t)dimension);
  if (vertices > room)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_tokenizer_place(scan, scan->at),
                       "%" PRIu64 " vertices are announced, but the file has room for %" PRIu64 " at most",
                       vertices, room);
  return VXM_OK;
}

/* ---- Vertices ---- */

/** How a list of vertices or faces is laid out. */
typedef enum off_layout {
  BY_TOKENS, /**< line ends are blanks */
  BY_LINES   /**< each begins on its own line, and what follows on that line belongs to it */
} off_layout;

static off_layout vertex_layout(const vxm_tokenizer *scan, const vxm_off_header *header, uint64_t vertices,
                                uint64_t faces) {
  size_t tokens = vxm_tokens_on_line(scan, '#');
  size_t position = header->dimension, whole = position + vxm_off_extras(header);
  if (tokens == whole)
    return BY_LINES;
  if (tokens < position)
    return BY_TOKENS;
  vxm_tokenizer second = *scan;
  vxm_skip_line(&second);
  bool own_lines = vxm_off_skip_to_data(&second) && vxm_tokens_on_line(&second, '#') == whole - position;
  if (tokens == position && whole != 2 * position) /* no colours here: left out, or on lines of their own? */
    return own_lines ? BY_TOKENS : BY_LINES;
  if (tokens == position)
    return vxm_lines_with_data(scan, '#', 2 * vertices + faces) == 2 * vertices + faces ? BY_TOKENS
                                                                                        : BY_LINES;
  /* More numbers than announced, colours of another length, or several vertices to a line. How many lines
     there are says less than how wide they are, as the file may be cut off. */
  if (vxm_lines_of_width(scan, '#', tokens, vertices) == vertices)
    return BY_LINES;
  uint64_t lines = vxm_lines_with_data(scan, '#', vertices + faces);
  return lines < vertices || (tokens % whole == 0 && lines < vertices + faces) ? BY_TOKENS : BY_LINES;
}

/** One number of a vertex, whose token is at the cursor. */
static inline double read_number(vxm_tokenizer *scan, off_damage *damage) {
  double value;
  if (__builtin_expect(vxm_tokenizer_double(scan, &value), 1))
    return value;
  vxm_text_defect_add(&damage->numbers, scan->at);
  vxm_skip_token(scan);
  return (double)NAN;
}

/** Takes the colour of the next vertex from the numbers behind its coordinates, which follow a normal where
 * there are normals; on its line, or wherever they are. */
static vxm_status read_vertex_color(vxm_tokenizer *scan, const vxm_off_header *header, bool by_tokens,
                                    vxm_error *error) {
  double rgba[4] = {0, 0, 0, 0}, passed;
  vxm_soup *soup = scan->soup;
  vxm_tokenizer ahead = *scan;
  int count = 0;
  for (int n = header->normals ? -3 : 0; n < 4; n++) {
    bool more = by_tokens ? vxm_off_skip_to_data(&ahead) : vxm_more_on_line(&ahead) && *ahead.at != '#';
    if (!more || !vxm_tokenizer_double(&ahead, n < 0 ? &passed : &rgba[n]))
      break;
    count = n + 1;
  }
  if (count < 3)
    return VXM_OK;
  return vxm_gather_color(&soup->appearance->vertices, soup->context, soup->vertex_count, rgba, error);
}

static void skip_tokens(vxm_tokenizer *scan, size_t count) {
  while (count-- > 0 && vxm_off_skip_to_data(scan))
    vxm_skip_token(scan);
}

/** Reads `kept` coordinates; false where the file ends first. */
static bool read_vertex_by_tokens(vxm_tokenizer *scan, double p[3], size_t kept, off_damage *damage) {
  for (size_t c = 0; c < kept; c++) {
    if (!vxm_off_skip_to_data(scan))
      return false;
    p[c] = read_number(scan, damage);
  }
  return true;
}

static inline bool read_vertex_by_line(vxm_tokenizer *scan, double p[3], size_t kept, off_damage *damage) {
  if (!vxm_off_skip_to_data(scan))
    return false;
  for (size_t c = 0; c < kept; c++) {
    if (__builtin_expect(!vxm_more_on_line(scan), 0)) {
      vxm_text_defect_add(&damage->short_vertices, scan->at);
      for (; c < kept; c++)
        p[c] = (double)NAN;
      break;
    }
    p[c] = read_number(scan, damage);
  }
  return true;
}

static vxm_status read_vertices(vxm_tokenizer *scan, const vxm_off_header *header, uint64_t vertices,
                                uint64_t faces, off_damage *damage, vxm_error *error) {
  vxm_soup *soup = scan->soup;
  vxm_status status = vxm_soup_reserve(soup, (size_t)vertices, 0, 0, error);
  if (status != VXM_OK || vertices == 0)
    return status;
  size_t kept = header->dimension < 3 ? header->dimension : 3;
  size_t skipped = header->dimension - kept + vxm_off_extras(header);
  const bool has_colors = vxm_off_vertex_colors(soup, header) && kept == header->dimension;
  bool by_tokens = vxm_off_skip_to_data(scan) && vertex_layout(scan, header, vertices, faces) == BY_TOKENS;
  const unsigned char *const end = scan->end, *const last = vxm_last_token(scan);
  for (; soup->vertex_count < vertices && status == VXM_OK; soup->vertex_count++) {
    double *p = soup->positions + 3 * soup->vertex_count;
    p[2] = p[1] = 0.0;
    scan->end = soup->vertex_count + 1 < vertices ? last : end;
    if (by_tokens ? !read_vertex_by_tokens(scan, p, kept, damage)
                  : !read_vertex_by_line(scan, p, kept, damage))
      break;
    if (__builtin_expect(has_colors, 0))
      status = read_vertex_color(scan, header, by_tokens, error);
    if (by_tokens)
      skip_tokens(scan, skipped);
    else if (vxm_more_on_line(scan))
      vxm_skip_rest(scan);
    if (status == VXM_OK)
      status = vxm_tokenizer_progress(scan, error);
  }
  scan->end = end;
  return status;
}

/* ---- Faces ---- */

/** Whether the line from the cursor to its end is one face after the other; the last may be cut off with the
 * file. */
static bool is_run_of_faces(const vxm_tokenizer *scan, uint64_t vertices) {
  vxm_tokenizer ahead = *scan;
  while (vxm_more_on_line(&ahead) && *ahead.at != '#') {
    uint64_t n, index;
    if (!vxm_tokenizer_uint(&ahead, &n) || n < 3)
      return false;
    for (; n > 0; n--)
      if (!vxm_more_on_line(&ahead))
        return ahead.at == ahead.end;
      else if (!vxm_tokenizer_uint(&ahead, &index) || index >= vertices)
        return false;
  }
  return true;
}

/**
 * A line ended after `there` of `n` indices: is the next one its continuation, or a face of its own?
 */
static bool is_continued(const vxm_tokenizer *scan, uint64_t n, uint64_t there) {
  vxm_tokenizer ahead = *scan;
  uint64_t next;
  if (there == 0) /* a count alone on its line is a habit, not damage */
    return true;
  if (!vxm_off_skip_to_data(&ahead))
    return false;
  size_t tokens = vxm_tokens_on_line(&ahead, '#');
  if (!vxm_tokenizer_uint(&ahead, &next))
    return false;
  bool whole_face = next >= 3 && (next + 1 == tokens || (next + 1 < tokens && tokens != n - there));
  return !whole_face;
}

static off_layout face_layout(const vxm_tokenizer *scan, uint64_t vertices, uint64_t faces) {
  uint64_t n;
  vxm_tokenizer ahead = *scan;
  if (!vxm_tokenizer_uint(&ahead, &n))
    return BY_LINES;
  size_t tokens = vxm_tokens_on_line(&ahead, '#');
  vxm_skip_rest(&ahead);
  if (tokens < n && is_continued(&ahead, n, tokens))
    return BY_TOKENS;
  /* Colours follow the indices on their line, unless the lines are too few for that. */
  bool few = tokens > n && vxm_lines_with_data(scan, '#', faces) < faces;
  return few && is_run_of_faces(scan, vertices) ? BY_TOKENS : BY_LINES;
}

/** How reading a face came out. */
typedef enum off_outcome { FACE_READ, FACE_DROPPED, FACE_MISSING } off_outcome;

/**
 * Reads the corners of a face of n behind those the soup has. The cursor stands behind n.
 * `first` is where the face began, for messages; `behind` becomes the end of the corners.
 */
static inline off_outcome read_corners(vxm_tokenizer *scan, uint64_t n, bool by_lines, off_damage *damage,
                                       const unsigned char *first, const unsigned char **behind) {
  vxm_soup *soup = scan->soup;
  uint32_t *corner = soup->indices + soup->corner_count;
  const size_t vertices = soup->vertex_count;
  bool beyond = false;
  for (uint64_t c = 0; c < n; c++) {
    if (__builtin_expect(!vxm_more_on_line(scan) || *scan->at == '#', 0)) {
      bool continued = !by_lines || is_continued(scan, n, c);
      if (!vxm_off_skip_to_data(scan))
        return FACE_MISSING;
      if (!continued) {
        vxm_text_defect_add(&damage->short_faces, first);
        return FACE_DROPPED;
      }
    }
    uint64_t index;
    if (__builtin_expect(!vxm_tokenizer_uint(scan, &index), 0)) {
      vxm_text_defect_add(&damage->bad_faces, first);
      if (by_lines)
        vxm_skip_rest(scan);
      else
        vxm_skip_token(scan);
      return FACE_DROPPED;
    }
    beyond |= index >= vertices;
    corner[c] = (uint32_t)index;
  }
  *behind = scan->at;
  if (by_lines && vxm_more_on_line(scan))
    vxm_skip_rest(scan);
  if (__builtin_expect(beyond, 0)) {
    vxm_text_defect_add(&damage->beyond, first);
    return FACE_DROPPED;
  }
  if (__builtin_expect(n < 3, 0)) {
    vxm_text_defect_add(&damage->small_faces, first);
    return FACE_DROPPED;
  }
  return FACE_READ;
}

/** Takes the colour of the soup's last face from the numbers behind its corners: one is a place in a table
 * that nobody has, three or four are a colour. */
static vxm_status read_face_color(const vxm_tokenizer *scan, const unsigned char *behind, vxm_error *error) {
  vxm_soup *soup = scan->soup;
  vxm_tokenizer ahead = *scan;
  double rgba[4] = {0, 0, 0, 0};
  int count = 0;
  ahead.at = behind;
  while (count < 4 && vxm_more_on_line(&ahead) && *ahead.at != '#' &&
         vxm_tokenizer_double(&ahead, &rgba[count]))
    count++;
  if (count < 3)
    return VXM_OK;
  return vxm_gather_color(&soup->appearance->faces, soup->context, soup->face_count - 1, rgba, error);
}

/** Whether the token that touches the end of the file is the last index of the face of n that begins at
 * `first`. */
static bool ends_in_index(const vxm_tokenizer *scan, const unsigned char *first, uint64_t n) {
  vxm_tokenizer ahead = *scan;
  ahead.at = first;
  for (uint64_t t = 0; t < n && vxm_off_skip_to_data(&ahead); t++)
    vxm_skip_token(&ahead);
  const unsigned char *last = vxm_last_token(scan);
  return last < scan->end && vxm_off_skip_to_data(&ahead) && ahead.at == last;
}

/**
 * Reads the faces; *done is how many of those announced were met. The token that touches the end of the file,
 * which may be half a number, is believed only where it completes the last of them.
 */
static vxm_status read_faces(vxm_tokenizer *scan, uint64_t faces, uint64_t *done, off_damage *damage,
                             vxm_error *error) {
  vxm_soup *soup = scan->soup;
  *done = 0;
  if (faces == 0 || !vxm_off_skip_to_data(scan))
    return VXM_OK;
  bool by_lines = face_layout(scan, soup->vertex_count, faces) == BY_LINES;
  /* A triangle takes 8 bytes at least. */
  uint64_t room = (uint64_t)(scan->end - scan->at) / 8 + 1, expected = faces < room ? faces : room;
  vxm_status status = vxm_soup_reserve(soup, 0, (size_t)expected, (size_t)expected * 3, error);
  const unsigned char *const end = scan->end, *const last = vxm_last_token(scan);
  for (; status == VXM_OK && *done < faces; ++*done) {
    scan->end = *done + 1 < faces ? last : end;
    if (!vxm_off_skip_to_data(scan))
      break;
    const unsigned char *first = scan->at;
    uint64_t n;
    if (!vxm_tokenizer_uint(scan, &n)) {
      vxm_text_defect_add(&damage->bad_faces, first);
      if (by_lines)
        vxm_skip_rest(scan);
      else
        vxm_skip_token(scan);
      continue;
    }
    /* Each index takes a byte at least: a count beyond that meets the end of the file first. */
    uint64_t rest = (uint64_t)(scan->end - scan->at);
    status = vxm_corners_reserve(soup, (size_t)(n < rest ? n : rest), error);
    if (status != VXM_OK)
      break;
    const unsigned char *behind;
    off_outcome outcome = read_corners(scan, n, by_lines, damage, first, &behind);
    if (outcome == FACE_MISSING)
      break;
    if (outcome == FACE_READ)
      status = vxm_face_end(soup, (size_t)n, error);
    if (__builtin_expect(soup->appearance != NULL, 0) && by_lines && outcome == FACE_READ && status == VXM_OK)
      status = read_face_color(scan, behind, error);
    if (status == VXM_OK)
      status = vxm_tokenizer_progress(scan, error);
    if (outcome == FACE_READ && *done + 1 == faces && ends_in_index(scan, first, n) &&
        vxm_last_index_may_be_truncated(soup, 0))
      vxm_text_defect_add(&damage->cut, first);
  }
  scan->end = end;
  return status;
}

/* ---- The file ---- */

static void note_damage(vxm_tokenizer *scan, const vxm_off_header *header, const off_damage *damage) {
  vxm_warnings *warnings = &scan->soup->warnings;
  int64_t line = vxm_tokenizer_line(scan, header->at);
  if (header->missing)
    vxm_warn(warnings, "line %" PRId64 ": no OFF keyword; the file begins with its counts", line);
  if (header->dimension > 3)
    vxm_warn(warnings, "line %" PRId64 ": vertices have %zu coordinates; the first three are taken as x y z",
             line, header->dimension);
  if (header->dimension < 3)
    vxm_warn(warnings, "line %" PRId64 ": vertices have %zu coordinates; the missing ones are 0", line,
             header->dimension);
  vxm_text_defect_warn_line(scan, &damage->numbers, "coordinate is not a number; taken as NaN", "numbers");
  vxm_text_defect_warn_line(scan, &damage->short_vertices, "vertex has too few coordinates; taken as NaN",
                            "vertices");
  vxm_text_defect_warn_line(scan, &damage->bad_faces, "face is not a list of whole numbers; skipped",
                            "faces");
  vxm_text_defect_warn_line(scan, &damage->short_faces, "face has fewer indices than it announces; skipped",
                            "faces");
  vxm_text_defect_warn_line(scan, &damage->beyond, "face names a vertex that does not exist; skipped",
                            "faces");
  vxm_text_defect_warn_line(scan, &damage->small_faces, "face has fewer than 3 corners; skipped", "faces");
  vxm_text_defect_warn_line(scan, &damage->cut,
                            "the file ends without a line end; its last number may be cut off", "");
}

static vxm_status finish(vxm_tokenizer *scan, uint64_t vertices, uint64_t faces, uint64_t done,
                         vxm_error *error) {
  vxm_soup *soup = scan->soup;
  vxm_place end = vxm_tokenizer_place(scan, scan->end);
  if (soup->vertex_count < vertices && faces > 0)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, end,
                       "the file ends after %zu of %" PRIu64 " vertices, before any face", soup->vertex_count,
                       vertices);
  if (soup->vertex_count < vertices)
    vxm_warn(&soup->warnings, "line %" PRId64 ": the file ends after %zu of %" PRIu64 " vertices", end.line,
             soup->vertex_count, vertices);
  else if (done < faces && soup->face_count == 0)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, end,
                       "the file ends after %" PRIu64 " of %" PRIu64 " faces, none of which can be used",
                       done, faces);
  else if (done < faces)
    vxm_warn(&soup->warnings, "line %" PRId64 ": the file ends after %" PRIu64 " of %" PRIu64 " faces",
             end.line, done, faces);
  else if (vxm_off_skip_to_data(scan))
    vxm_warn(&soup->warnings, "line %" PRId64 ": more than announced; ignored (lines: %" PRIu64 ")",
             vxm_tokenizer_line(scan, scan->at), vxm_lines_with_data(scan, '#', UINT64_MAX));
  if (soup->face_count == 0)
    vxm_warn(&soup->warnings, "the file has no faces");
  return VXM_OK;
}

static vxm_status read_text(vxm_tokenizer *scan, vxm_off_header *header, vxm_error *error) {
  uint64_t vertices = 0, faces = 0, done = 0;
  off_damage damage = {0};
  vxm_status status = vxm_off_read_counts(scan, header, &vertices, &faces, error);
  if (status == VXM_OK)
    status = check_vertex_count(scan, vertices, header->dimension, error);
  if (status == VXM_OK)
    status = read_vertices(scan, header, vertices, faces, &damage, error);
  if (status == VXM_OK)
    status = read_faces(scan, faces, &done, &damage, error);
  if (status != VXM_OK)
    return status;
  note_damage(scan, header, &damage);
  return finish(scan, vertices, faces, done, error);
}

vxm_status vxm_off_read(vxm_soup *soup, const unsigned char *data, size_t size, const char *name,
                        vxm_error *error) {
  vxm_tokenizer scan = vxm_tokenizer_of(soup, data, size, name);
  vxm_off_header header;
  vxm_status status = vxm_off_read_header(&scan, &header, error);
  if (status == VXM_OK) {
    soup->format = header.binary ? "off binary" : "off";
    status = header.binary ? vxm_off_read_binary(&scan, &header, error) : read_text(&scan, &header, error);
  }
  if (status == VXM_OK)
    vxm_soup_trim(soup);
  return status;
}
