/* SPDX-License-Identifier: BSD-3-Clause */
/** Wavefront OBJ: vertices and polygons, with groups and materials as face tags, and colours where they are
 * asked for; the rest is passed over. */
#include "meshio/common/format.h"
#include "meshio/common/tags.h"
#include "meshio/common/tokenizer.h"
#include "meshio/common/truncation.h"
#include "meshio/formats/obj_colors.h"

#include <inttypes.h>
#include <math.h>

/** The state of a reader; the soup grows as the file goes. */
typedef struct obj_reader {
  vxm_tokenizer scan;
  vxm_soup *soup;
  vxm_tagger tagger;
  uint64_t largest; /**< 1-based, among the positive indices of the faces that were kept */
  uint64_t lines_and_points;
  bool any_statement;
  bool ends_in_face;                /**< the last line is a face that was kept */
  const unsigned char *last_vertex; /**< the vertex in the last line, if that has no end */
  const unsigned char *cut_vertex;  /**< a vertex within which the file ends */
  bool has_look;                    /**< colours are asked for */
  vxm_obj_colors colors;
  vxm_text_defect numbers, flat, short_vertices, zero, beyond, small_faces, bad_faces;
} obj_reader;

/* ---- Statements ---- */

/** Skips blanks and continuations (a backslash before the line end); true if something is left. */
static inline bool more(vxm_tokenizer *scan) {
  for (;;) {
    vxm_skip_blanks(scan);
    if (vxm_at_line_end(scan))
      return false;
    if (__builtin_expect(*scan->at != '\\', 1))
      return true;
    const unsigned char *p = scan->at + 1;
    while (p < scan->end && vxm_is_blank(*p))
      p++;
    if (p < scan->end && !vxm_is_newline(*p))
      return true;
    scan->at = p;
    vxm_skip_line(scan);
  }
}

static bool is_comment(const vxm_tokenizer *scan) {
  return *scan->at == '#';
}

static vxm_status read_vertex(obj_reader *reader, vxm_error *error) {
  vxm_tokenizer *scan = &reader->scan;
  const unsigned char *first = scan->at;
  double p[3] = {0.0, 0.0, 0.0};
  int count = 0;
  uint64_t words = 0;
  for (; count < 3 && more(scan); count++)
    if (__builtin_expect(!vxm_tokenizer_double(scan, &p[count]), 0)) {
      if (is_comment(scan))
        break;
      words++;
      p[count] = (double)NAN;
      vxm_skip_token(scan);
    }
  if (__builtin_expect((count < 3 || words > 0) && scan->at == scan->end, 0) && reader->flat.count == 0) {
    reader->cut_vertex = first;
    return VXM_OK;
  }
  for (; words > 0; words--)
    vxm_text_defect_add(&reader->numbers, first);
  if (__builtin_expect(count == 2, 0))
    vxm_text_defect_add(&reader->flat, first);
  else if (__builtin_expect(count < 2, 0)) {
    vxm_text_defect_add(&reader->short_vertices, first);
    for (; count < 3; count++)
      p[count] = (double)NAN;
  }
  reader->last_vertex = scan->at == scan->end ? first : NULL;
  if (__builtin_expect(reader->has_look, 0)) {
    vxm_status status = vxm_obj_colors_vertex(scan, error);
    if (status != VXM_OK)
      return status;
  }
  return vxm_soup_add_vertex(reader->soup, p[0], p[1], p[2], error);
}

/** One index of a face: "v", "v/t", "v//n" or "v/t/n", where v may be negative. 0 if it is none of these. */
static inline int64_t read_index(vxm_tokenizer *scan) {
  bool negative = *scan->at == '-';
  uint64_t value;
  scan->at += negative;
  if (__builtin_expect(!vxm_tokenizer_digits(scan, &value), 0))
    return 0;
  if (scan->at<scan->end && * scan->at> ' ') {
    if (*scan->at != '/' && *scan->at != '\\')
      return 0;
    while (scan->at<scan->end && * scan->at> ' ' && *scan->at != '\\')
      scan->at++;
  }
  if (value > INT64_MAX)
    value = INT64_MAX;
  return negative ? -(int64_t)value : (int64_t)value;
}

/** Reads the corners behind those the soup has; *corners is 0 if the face must be dropped. */
static vxm_status read_corners(obj_reader *reader, const unsigned char *first, size_t *corners,
                               uint64_t *largest, vxm_error *error) {
  vxm_tokenizer *scan = &reader->scan;
  vxm_soup *soup = reader->soup;
  size_t count = 0;
  *corners = 0;
  for (; more(scan); count++) {
    if (__builtin_expect(count == soup->corner_capacity - soup->corner_count, 0)) {
      vxm_status status = vxm_corners_reserve(soup, count + 1, error);
      if (status != VXM_OK)
        return status;
    }
    const unsigned char *token = scan->at;
    int64_t index = read_index(scan);
    if (__builtin_expect(index <= 0, 0)) {
      if (index == 0) {
        if (*token == '#')
          break;
        vxm_text_defect_add(token < scan->end && *token == '0' ? &reader->zero : &reader->bad_faces, first);
        return VXM_OK;
      }
      /* Negative indices count back from the last vertex read so far. */
      index += (int64_t)soup->vertex_count + 1;
      if (index <= 0) {
        vxm_text_defect_add(&reader->beyond, first);
        return VXM_OK;
      }
    }
    if ((uint64_t)index > *largest)
      *largest = (uint64_t)index;
    soup->indices[soup->corner_count + count] = (uint32_t)(index - 1);
  }
  if (*largest > VXM_VERTICES_MAX)
    vxm_text_defect_add(&reader->beyond, first);
  else if (count < 3)
    vxm_text_defect_add(&reader->small_faces, first);
  else
    *corners = count;
  return VXM_OK;
}

static vxm_status read_face(obj_reader *reader, vxm_error *error) {
  size_t corners;
  uint64_t largest = reader->largest;
  const unsigned char *first = reader->scan.at;
  vxm_status status = read_corners(reader, first, &corners, &largest, error);
  if (status != VXM_OK || corners == 0)
    return status;
  reader->largest = largest;
  status = vxm_tagger_face(&reader->tagger, error);
  if (status != VXM_OK)
    return status;
  status = vxm_face_end(reader->soup, corners, error);
  if (__builtin_expect(reader->has_look, 0) && status == VXM_OK)
    status = vxm_obj_colors_face(&reader->colors, &reader->scan, first, error);
  return status;
}

/** Whether the line at the cursor is the statement `word`; the cursor moves behind it. */
static bool take_word(vxm_tokenizer *scan, const char *word) {
  size_t length = strlen(word);
  if ((size_t)(scan->end - scan->at) < length || memcmp(scan->at, word, length) != 0)
    return false;
  const unsigned char *p = scan->at + length;
  if (p<scan->end && * p> ' ')
    return false;
  scan->at = p;
  return true;
}

static vxm_status read_name(obj_reader *reader, bool material, vxm_error *error) {
  const unsigned char *name = reader->scan.at;
  vxm_skip_rest(&reader->scan);
  size_t length = (size_t)(reader->scan.at - name);
  if (material)
    vxm_tagger_material(&reader->tagger, name, length);
  else
    vxm_tagger_group(&reader->tagger, name, length);
  return material && reader->has_look
             ? vxm_obj_colors_material(&reader->colors, reader->soup, name, length, error)
             : VXM_OK;
}

/** What only colours need. */
static vxm_status read_for_colors(obj_reader *reader, vxm_error *error) {
  vxm_tokenizer *scan = &reader->scan;
  if (take_word(scan, "vt"))
    return vxm_obj_colors_uv(&reader->colors, scan, error);
  if (!take_word(scan, "mtllib"))
    return VXM_OK;
  const unsigned char *names = scan->at;
  vxm_skip_rest(scan);
  return vxm_obj_colors_library(reader->soup, names, (size_t)(scan->at - names), error);
}

/** Statements that are rarer than v, vt, vn and f. */
static vxm_status read_rare(obj_reader *reader, vxm_error *error) {
  vxm_tokenizer *scan = &reader->scan;
  if (take_word(scan, "g") || take_word(scan, "o"))
    return read_name(reader, false, error);
  else if (take_word(scan, "usemtl"))
    return read_name(reader, true, error);
  else if (take_word(scan, "l") || take_word(scan, "p"))
    reader->lines_and_points++;
  else if (take_word(scan, "fo")) { /* f of the format's first version */
    reader->any_statement = true;
    return read_face(reader, error);
  }
  return reader->has_look ? read_for_colors(reader, error) : VXM_OK;
}

/** Makes about the room that will be needed; where that fails or is too little the soup grows as it is read.
 */
static void make_room(obj_reader *reader) {
  vxm_line_kinds kinds;
  vxm_sample_lines(&reader->scan, &kinds);
  const double margin = 1.03;
  double corners = kinds.letter_tokens['f'] - kinds.letter['f'];
  (void)vxm_soup_reserve(reader->soup, (size_t)(margin * kinds.letter['v']),
                         (size_t)(margin * kinds.letter['f']), (size_t)(margin * corners), NULL);
}

static vxm_status read_statements(obj_reader *reader, vxm_error *error) {
  vxm_tokenizer *scan = &reader->scan;
  vxm_status status = VXM_OK;
  while (status == VXM_OK && vxm_skip_space(scan)) {
    unsigned char c = *scan->at, next = scan->end - scan->at > 1 ? scan->at[1] : '\n';
    if (c == 'v' && next <= ' ') {
      scan->at++;
      reader->any_statement = true;
      status = read_vertex(reader, error);
    } else if (c == 'f' && (next <= ' ' || next == '\\')) {
      scan->at++;
      reader->any_statement = true;
      status = read_face(reader, error);
      reader->ends_in_face = scan->at == scan->end;
    } else if (c != '#' && (c != 'v' || reader->has_look))
      status = read_rare(reader, error);
    if (status == VXM_OK)
      status = vxm_tokenizer_progress(scan, error);
    if (scan->at < scan->end && !vxm_is_newline(*scan->at))
      vxm_skip_line(scan);
  }
  return status;
}

/* ---- The end ---- */

/** Finds the first face that names a vertex beyond the last: positive indices may run ahead of vertices. */
static const unsigned char *find_beyond(const obj_reader *reader, size_t vertices) {
  vxm_tokenizer scan = reader->scan;
  for (scan.at = scan.begin; vxm_skip_space(&scan); vxm_skip_line(&scan)) {
    const unsigned char *first = scan.at;
    if (!take_word(&scan, "f") && !take_word(&scan, "fo"))
      continue;
    while (more(&scan)) {
      int64_t index = read_index(&scan);
      if (index > 0 && (uint64_t)index > vertices)
        return first;
      if (index == 0)
        break;
    }
  }
  return scan.begin;
}

static void drop_beyond(obj_reader *reader) {
  vxm_soup *soup = reader->soup;
  if (reader->largest <= soup->vertex_count)
    return;
  const unsigned char *first = find_beyond(reader, soup->vertex_count);
  if (reader->beyond.count == 0 || first < reader->beyond.first)
    reader->beyond.first = first;
  reader->beyond.count += vxm_soup_drop_bad_faces(soup);
}

/** Vertices that no face uses, and how many of them are the last ones. */
static vxm_status count_unused(const vxm_soup *soup, size_t *unused, size_t *last, vxm_error *error) {
  size_t words = soup->vertex_count / 64 + 1;
  vxm_status status = VXM_OK;
  uint64_t *used = vxm_try_calloc(soup->context, words, sizeof *used, &status, error);
  if (!used)
    return status;
  for (size_t c = 0; c < soup->corner_count; c++)
    used[soup->indices[c] / 64] |= UINT64_C(1) << soup->indices[c] % 64;
  *unused = soup->vertex_count;
  for (size_t w = 0; w < words; w++)
    *unused -= (size_t)__builtin_popcountll(used[w]);
  size_t v = soup->vertex_count;
  while (v > 0 && !(used[(v - 1) / 64] >> (v - 1) % 64 & 1))
    v--;
  *last = soup->vertex_count - v;
  vxm_free(soup->context, used);
  return VXM_OK;
}

static size_t count_slashes(const unsigned char *from, const unsigned char *to) {
  size_t slashes = 0;
  for (; from < to; from++)
    slashes += *from == '/';
  return slashes;
}

/** Whether the last corner has fewer numbers than the one before it, as "3/4" behind "1/2/1". */
static bool ends_in_part_of_corner(const vxm_tokenizer *scan) {
  vxm_tokenizer before = *scan;
  const unsigned char *last = vxm_last_token(scan);
  before.end = last;
  while (before.end > before.begin && vxm_is_blank(before.end[-1]))
    before.end--;
  return last < scan->end &&
         count_slashes(last, scan->end) < count_slashes(vxm_last_token(&before), before.end);
}

/**
 * Nothing in this format says how much there should be. Signs of a file that was cut off are vertices that no
 * face uses, most of all the last ones, and in a last line without an end a face that does not fit those
 * before it.
 */
static vxm_status note_cut(const obj_reader *reader, vxm_error *error) {
  const vxm_tokenizer *scan = &reader->scan;
  vxm_soup *soup = reader->soup;
  if (reader->cut_vertex)
    vxm_warn(&soup->warnings, "line %" PRId64 ": the file ends within a vertex; skipped",
             vxm_tokenizer_line(scan, reader->cut_vertex));
  if (soup->face_count == 0 || reader->lines_and_points > 0 || reader->cut_vertex)
    return VXM_OK;
  size_t unused = 0, last = 0;
  vxm_status status = count_unused(soup, &unused, &last, error);
  if (status != VXM_OK)
    return status;
  bool no_line_end = scan->end > scan->begin && !vxm_is_newline(scan->end[-1]);
  bool skipped =
      reader->zero.count + reader->beyond.count + reader->small_faces.count + reader->bad_faces.count > 0;
  if (no_line_end &&
      (unused > 0 || reader->last_vertex ||
       (reader->ends_in_face && (ends_in_part_of_corner(scan) || vxm_last_index_may_be_truncated(soup, 1) ||
                                 vxm_last_face_may_be_short(soup)))))
    vxm_warn(&soup->warnings,
             "line %" PRId64 ": the file ends without a line end; its last line may be cut off",
             vxm_tokenizer_line(scan, scan->end));
  else if (!skipped && (last > 0 || unused > soup->vertex_count / 100))
    vxm_warn(&soup->warnings,
             "line %" PRId64 ": the file may be cut off: no face uses %zu of its %zu vertices",
             vxm_tokenizer_line(scan, scan->end), unused, soup->vertex_count);
  return VXM_OK;
}

static vxm_status finish(obj_reader *reader, vxm_error *error) {
  const vxm_tokenizer *scan = &reader->scan;
  vxm_soup *soup = reader->soup;
  if (!reader->any_statement)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){scan->name, 0, -1, -1},
                       "not a mesh: no line is an OBJ vertex (v x y z) or face (f a b c)");
  if (reader->last_vertex && reader->largest > soup->vertex_count) { /* more should follow */
    soup->vertex_count--;
    reader->cut_vertex = reader->last_vertex;
  }
  if (reader->has_look) {
    vxm_status status = vxm_obj_colors_finish(&reader->colors, soup, error);
    if (status != VXM_OK)
      return status;
  }
  drop_beyond(reader);
  if (soup->face_count == 0)
    vxm_tags_drop(soup);
  vxm_text_defect_warn_line(scan, &reader->numbers, "coordinate is not a number; taken as NaN", "numbers");
  vxm_text_defect_warn_line(scan, &reader->flat, "vertex has two coordinates; z taken as 0", "vertices");
  vxm_text_defect_warn_line(scan, &reader->short_vertices, "vertex has too few coordinates; taken as NaN",
                            "vertices");
  vxm_text_defect_warn_line(scan, &reader->zero, "face names vertex 0 (numbering starts at 1); skipped",
                            "faces");
  vxm_text_defect_warn_line(scan, &reader->beyond, "face names a vertex that does not exist; skipped",
                            "faces");
  vxm_text_defect_warn_line(scan, &reader->small_faces, "face has fewer than 3 corners; skipped", "faces");
  vxm_text_defect_warn_line(scan, &reader->bad_faces, "face has a corner that is no vertex number; skipped",
                            "faces");
  if (soup->face_count == 0 && reader->lines_and_points > 0)
    vxm_warn(&soup->warnings, "the file has no faces, only %" PRIu64 " lines (l) or points (p)",
             reader->lines_and_points);
  else if (soup->face_count == 0)
    vxm_warn(&soup->warnings, "the file has no faces");
  return note_cut(reader, error);
}

vxm_status vxm_obj_read(vxm_soup *soup, const unsigned char *data, size_t size, const char *name,
                        vxm_error *error) {
  obj_reader reader = {
      .soup = soup, .scan = vxm_tokenizer_of(soup, data, size, name), .has_look = soup->appearance != NULL};
  soup->format = "obj";
  vxm_tagger_open(&reader.tagger, soup);
  make_room(&reader);
  vxm_status status = read_statements(&reader, error);
  if (status == VXM_OK)
    status = finish(&reader, error);
  vxm_obj_colors_destroy(&reader.colors, soup->context);
  vxm_tagger_close(&reader.tagger);
  if (status == VXM_OK)
    vxm_soup_trim(soup);
  return status;
}

/* ---- Sniffing ---- */

vxm_likeness vxm_obj_sniff(const unsigned char *data, size_t size) {
  static const char *const words[] = {"v", "vt", "vn", "f", "g", "o", "s", "usemtl", "mtllib", "l", "p"};
  vxm_tokenizer scan = {.begin = data, .at = data, .end = data + size};
  while (vxm_skip_space(&scan) && *scan.at == '#')
    vxm_skip_line(&scan);
  for (size_t w = 0; w < sizeof words / sizeof *words; w++)
    if (take_word(&scan, words[w]) && vxm_more_on_line(&scan))
      return VXM_LIKENESS_CERTAIN;
  return VXM_LIKENESS_NONE;
}
