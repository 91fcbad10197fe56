/* SPDX-License-Identifier: BSD-3-Clause */
/** The body of an ascii PLY: one element to a line, or any run of tokens where the file does not keep to
 * that. */
#include "meshio/common/truncation.h"
#include "meshio/formats/ply.h"

#include <inttypes.h>
#include <math.h>

/** What is needed to read one element after the other. */
typedef struct text_reader {
  vxm_tokenizer *scan;
  vxm_soup *soup;
  const vxm_ply_header *header;
  const vxm_ply_element *element;
  const vxm_ply_property *properties;
  vxm_ply_body *body;
  bool by_lines;
  bool has_look;                    /**< colours of these elements are kept */
  bool is_last;                     /**< no element behind this one has lines */
  const unsigned char *end, *whole; /**< of the file, and before the token that touches its end */
} text_reader;

/** Moves to the next value of the element; false at the end of its line or of the file. */
static inline bool more(text_reader *reader) {
  return reader->by_lines ? vxm_more_on_line(reader->scan) : vxm_skip_space(reader->scan);
}

static vxm_status fail_length(const text_reader *reader, vxm_error *error) {
  const vxm_tokenizer *scan = reader->scan;
  char quote[VXM_QUOTE];
  return vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_tokenizer_place(scan, scan->at),
                     "the length of a list is not a whole number: \"%s\"%s",
                     vxm_quote(quote, scan->at, vxm_token_length(scan)),
                     reader->element->role == VXM_PLY_VERTICES ? " (does the header lack \"element face\"?)"
                                                               : "");
}

/* ---- The layout ---- */

/** Lines that the elements from this one on take, if each has its own. */
static uint64_t lines_announced(const text_reader *reader) {
  const vxm_ply_header *header = reader->header;
  uint64_t lines = 0;
  for (const vxm_ply_element *e = reader->element; e < header->elements + header->element_count; e++)
    if (e->properties > 0 && __builtin_add_overflow(lines, e->count, &lines))
      return UINT64_MAX;
  return lines;
}

/** Looks at the first line of an element, whose first token is at the cursor. */
static bool is_by_lines(const text_reader *reader) {
  vxm_tokenizer ahead = *reader->scan;
  for (size_t p = 0; p < reader->element->properties; p++) {
    uint64_t tokens = 1;
    if (!vxm_more_on_line(&ahead))
      return false;
    if (reader->properties[p].is_list && !vxm_tokenizer_uint(&ahead, &tokens))
      return true;
    for (; tokens > 0; tokens--) {
      if (!vxm_more_on_line(&ahead))
        return false;
      vxm_skip_token(&ahead);
    }
  }
  if (!vxm_more_on_line(&ahead))
    return true;
  /* More values than one element has: values that the header does not know, or several elements to a line.
     The lines are counted once, whatever the number of elements. */
  vxm_ply_body *body = reader->body;
  if (!body->lines_counted) {
    uint64_t lines = lines_announced(reader);
    body->few_lines = vxm_lines_with_data(reader->scan, 0, lines) < lines;
    body->lines_counted = true;
  }
  /* Few lines may mean that the file is cut off: lines of one width all through an element are its own. */
  if (body->few_lines && !body->by_tokens) {
    size_t width = vxm_tokens_on_line(reader->scan, 0);
    uint64_t count = reader->element->count;
    body->by_tokens = vxm_lines_of_width(reader->scan, 0, width, count) < count;
  }
  if (body->by_tokens)
    return false;
  vxm_text_defect_add(&reader->body->long_lines, reader->scan->at);
  return true;
}

/* ---- Values that are passed over ---- */

/** Passes over a list; *there is false if the line or the file ends within it. */
static vxm_status skip_list(text_reader *reader, bool *there, vxm_error *error) {
  uint64_t n;
  *there = more(reader);
  if (!*there)
    return VXM_OK;
  if (!vxm_tokenizer_uint(reader->scan, &n))
    return fail_length(reader, error);
  for (; n > 0; n--) {
    *there = more(reader);
    if (!*there)
      return VXM_OK;
    vxm_skip_token(reader->scan);
  }
  return VXM_OK;
}

/** Passes over the properties from `from` to before `to`. */
static vxm_status skip_properties(text_reader *reader, size_t from, size_t to, bool *there,
                                  vxm_error *error) {
  *there = true;
  for (size_t p = from; p < to && *there; p++) {
    if (reader->properties[p].is_list) {
      vxm_status status = skip_list(reader, there, error);
      if (status != VXM_OK)
        return status;
    } else {
      *there = more(reader);
      vxm_skip_token(reader->scan);
    }
  }
  return VXM_OK;
}

static vxm_status skip_passed(text_reader *reader, bool *there, vxm_error *error) {
  if (reader->by_lines) {
    vxm_skip_rest(reader->scan);
    return VXM_OK;
  }
  return skip_properties(reader, 0, reader->element->properties, there, error);
}

/* ---- Vertices ---- */

static inline double read_number(text_reader *reader) {
  double value;
  if (__builtin_expect(vxm_tokenizer_double(reader->scan, &value), 1))
    return value;
  vxm_text_defect_add(&reader->body->numbers, reader->scan->at);
  vxm_skip_token(reader->scan);
  return (double)NAN;
}

static bool has_xyz_first(const text_reader *reader) {
  return reader->element->properties >= 3 && reader->properties[0].use == VXM_PLY_X &&
         reader->properties[1].use == VXM_PLY_Y && reader->properties[2].use == VXM_PLY_Z;
}

/** Looks for a colour among the values of the line from `from` on, which begin with property `first`.
 * Whatever is wrong with them is not the mesh's, and makes no colour. */
static bool find_color(const text_reader *reader, const unsigned char *from, size_t first, double rgba[4]) {
  vxm_tokenizer ahead = *reader->scan;
  unsigned found = 0;
  ahead.at = from;
  for (size_t i = first; i < reader->element->properties && vxm_more_on_line(&ahead); i++) {
    const vxm_ply_property *property = &reader->properties[i];
    uint64_t passed = 1;
    if (property->channel && vxm_tokenizer_double(&ahead, &rgba[property->channel - 1])) {
      found |= 1U << property->channel;
      continue;
    }
    if (property->channel || (property->is_list && !vxm_tokenizer_uint(&ahead, &passed)))
      return false;
    for (; passed > 0 && vxm_more_on_line(&ahead); passed--)
      vxm_skip_token(&ahead);
  }
  return found == 14U;
}

/** Reads the properties of a vertex one by one; *there is false if not all were there. */
static vxm_status read_vertex_values(text_reader *reader, double p[3], double rgba[4], bool *there,
                                     vxm_error *error) {
  for (size_t i = 0; i < reader->element->properties; i++) {
    const vxm_ply_property *property = &reader->properties[i];
    bool is_color = reader->has_look && property->channel;
    if (property->use == VXM_PLY_OTHER && !is_color) {
      vxm_status status = skip_properties(reader, i, i + 1, there, error);
      if (status != VXM_OK || !*there)
        return status;
      continue;
    }
    *there = more(reader);
    if (!*there)
      return VXM_OK;
    *(is_color ? &rgba[property->channel - 1] : &p[property->use]) = read_number(reader);
  }
  return VXM_OK;
}

static inline vxm_status read_vertex(text_reader *reader, bool xyz_first, bool *there, vxm_error *error) {
  vxm_soup *soup = reader->soup;
  vxm_tokenizer *scan = reader->scan;
  const unsigned char *first = scan->at;
  double p[3] = {0.0, 0.0, 0.0}, rgba[4] = {0, 0, 0, 0};
  vxm_status status = VXM_OK;
  bool has_color = reader->has_look;
  if (xyz_first && reader->by_lines) {
    for (size_t c = 0; c < 3 && *there; c++) {
      *there = vxm_more_on_line(scan);
      if (__builtin_expect(*there, 1))
        p[c] = read_number(reader);
    }
  } else
    status = read_vertex_values(reader, p, rgba, there, error);
  if (has_color && xyz_first && reader->by_lines)
    has_color = find_color(reader, first, 0, rgba);
  if (status != VXM_OK)
    return status;
  if (__builtin_expect(!*there, 0)) {
    if (!reader->by_lines || scan->at == scan->end)
      return VXM_OK;
    /* Half a vertex is none, but it keeps its number, so that the faces stay right. */
    vxm_text_defect_add(&reader->body->short_lines, first);
    p[0] = p[1] = p[2] = (double)NAN;
    *there = true;
  }
  if (reader->by_lines && vxm_more_on_line(scan))
    vxm_skip_rest(scan);
  if (has_color)
    status = vxm_gather_color(&soup->appearance->vertices, soup->context, soup->vertex_count, rgba, error);
  return status == VXM_OK ? vxm_soup_add_vertex(soup, p[0], p[1], p[2], error) : status;
}

/* ---- Faces and strips ---- */

/** Reads a whole number with a sign; a token that is none is passed over. */
static bool read_signed(vxm_tokenizer *scan, int64_t *value) {
  uint64_t size;
  bool negative = *scan->at == '-';
  scan->at += negative;
  if (!vxm_tokenizer_uint(scan, &size)) {
    vxm_skip_token(scan);
    return false;
  }
  *value = size > INT64_MAX ? INT64_MAX : (int64_t)size;
  if (negative)
    *value = -*value;
  return true;
}

/** What became of a face's list. */
typedef enum list_outcome { LIST_KEPT, LIST_BEYOND, LIST_BAD, LIST_CUT } list_outcome;

/** Reads n corners behind those of the soup. */
static inline list_outcome read_corners(text_reader *reader, uint64_t n, uint64_t limit) {
  vxm_tokenizer *scan = reader->scan;
  uint32_t *corner = reader->soup->indices + reader->soup->corner_count;
  bool beyond = false, bad = false;
  for (uint64_t c = 0; c < n; c++) {
    uint64_t index;
    if (__builtin_expect(!more(reader), 0))
      return LIST_CUT;
    if (__builtin_expect(!vxm_tokenizer_uint(scan, &index), 0)) {
      int64_t value;
      bad |= !read_signed(scan, &value);
      index = UINT64_MAX;
    }
    beyond |= index >= limit;
    corner[c] = (uint32_t)index;
  }
  return bad ? LIST_BAD : beyond ? LIST_BEYOND : LIST_KEPT;
}

static vxm_status keep_face(text_reader *reader, list_outcome outcome, uint64_t n, const unsigned char *first,
                            vxm_error *error) {
  vxm_ply_body *body = reader->body;
  if (__builtin_expect(outcome == LIST_KEPT && n >= 3, 1))
    return vxm_face_end(reader->soup, (size_t)n, error);
  if (outcome == LIST_BAD)
    vxm_text_defect_add(&body->bad_faces, first);
  else if (outcome == LIST_BEYOND)
    vxm_text_defect_add(&body->beyond, first);
  else if (outcome == LIST_KEPT)
    vxm_text_defect_add(&body->small_faces, first);
  return VXM_OK;
}

static vxm_status read_strip_numbers(text_reader *reader, uint64_t n, uint64_t limit, bool *there,
                                     vxm_error *error) {
  vxm_ply_strip strip = {0};
  vxm_status status = VXM_OK;
  for (; n > 0 && status == VXM_OK; n--) {
    *there = more(reader);
    if (!*there)
      return VXM_OK;
    const unsigned char *at = reader->scan->at;
    int64_t index;
    if (!read_signed(reader->scan, &index))
      index = INT64_MIN;
    status = vxm_ply_strip_add(&strip, reader->soup, index, limit, at, reader->body, error);
  }
  return status;
}

/** Takes the colour of the face `face` from the properties behind its corners. */
static vxm_status read_face_color(text_reader *reader, size_t corners, size_t face, bool *there,
                                  vxm_error *error) {
  vxm_soup *soup = reader->soup;
  double rgba[4] = {0, 0, 0, 0};
  if (reader->by_lines && !find_color(reader, reader->scan->at, corners + 1, rgba))
    return VXM_OK;
  for (size_t i = corners + 1; !reader->by_lines && i < reader->element->properties; i++) {
    const vxm_ply_property *property = &reader->properties[i];
    vxm_status status = VXM_OK;
    if (!property->channel)
      status = skip_properties(reader, i, i + 1, there, error);
    else if ((*there = more(reader)))
      rgba[property->channel - 1] = read_number(reader);
    if (status != VXM_OK || !*there)
      return status;
  }
  if (soup->face_count == face)
    return VXM_OK;
  return vxm_gather_color(&soup->appearance->faces, soup->context, face, rgba, error);
}

/** Reads a face or a strip; `corners` is the property that lists its corners. */
static vxm_status read_polygon(text_reader *reader, size_t corners, uint64_t limit, bool *there,
                               vxm_error *error) {
  vxm_tokenizer *scan = reader->scan;
  const unsigned char *first = scan->at;
  uint64_t n;
  vxm_status status = skip_properties(reader, 0, corners, there, error);
  *there = *there && more(reader);
  if (status != VXM_OK || !*there)
    return status;
  if (__builtin_expect(!vxm_tokenizer_uint(scan, &n), 0)) {
    if (!reader->by_lines)
      return fail_length(reader, error);
    vxm_text_defect_add(&reader->body->bad_faces, first);
    return VXM_OK;
  }
  if (n > (uint64_t)(scan->end - scan->at)) {
    *there = false;
    return VXM_OK;
  }
  if (reader->element->role == VXM_PLY_STRIPS)
    status = read_strip_numbers(reader, n, limit, there, error);
  else {
    status = vxm_corners_reserve(reader->soup, (size_t)n, error);
    if (status != VXM_OK)
      return status;
    size_t face = reader->soup->face_count;
    list_outcome outcome = read_corners(reader, n, limit);
    *there = outcome != LIST_CUT;
    status = keep_face(reader, outcome, n, first, error);
    if (reader->has_look && status == VXM_OK && outcome != LIST_CUT && outcome != LIST_BAD)
      return read_face_color(reader, corners, face, there, error);
  }
  if (status == VXM_OK && *there && !reader->by_lines)
    status = skip_properties(reader, corners + 1, reader->element->properties, there, error);
  return status;
}

/* ---- The body ---- */

static size_t corners_of(const text_reader *reader) {
  size_t p = 0;
  while (p < reader->element->properties && reader->properties[p].use != VXM_PLY_CORNERS)
    p++;
  return p;
}

/** Makes room for what is announced, as far as the file can hold it: a value takes two bytes at least. */
static vxm_status reserve(text_reader *reader, vxm_error *error) {
  uint64_t room = (uint64_t)(reader->scan->end - reader->scan->at) / 2 + 1;
  uint64_t count = reader->element->count;
  if (reader->element->role == VXM_PLY_VERTICES) {
    room = room / reader->element->properties + 1;
    return vxm_soup_reserve(reader->soup, (size_t)(count < room ? count : room), 0, 0, error);
  }
  if (reader->element->role != VXM_PLY_FACES)
    return VXM_OK;
  room = room / 4 + 1;
  size_t faces = (size_t)(count < room ? count : room);
  return vxm_soup_reserve(reader->soup, 0, reader->soup->face_count + faces,
                          reader->soup->corner_count + 3 * faces, error);
}

static vxm_status read_element(text_reader *reader, vxm_error *error) {
  vxm_tokenizer *scan = reader->scan;
  const vxm_ply_element *element = reader->element;
  if (element->count == 0 || element->properties == 0)
    return VXM_OK;
  reader->by_lines = !vxm_skip_space(scan) || is_by_lines(reader);
  vxm_status status = reserve(reader, error);
  bool xyz_first = has_xyz_first(reader);
  size_t corners = corners_of(reader);
  bool more_behind = element->role == VXM_PLY_FACES && corners + 1 < element->properties;
  uint64_t limit = vxm_ply_index_limit(scan, reader->header, reader->body);
  for (uint64_t i = 0; i < element->count && status == VXM_OK; i++) {
    /* Half a number may touch the end of the file: it is believed only where it completes all that is
     * announced. */
    bool is_last = reader->is_last && i + 1 == element->count && !more_behind;
    scan->end = is_last ? reader->end : reader->whole;
    bool there = vxm_skip_space(scan), any = there;
    const unsigned char *first = scan->at;
    if (there && element->role == VXM_PLY_VERTICES)
      status = read_vertex(reader, xyz_first, &there, error);
    else if (there && element->role == VXM_PLY_PASSED)
      status = skip_passed(reader, &there, error);
    else if (there) {
      status = read_polygon(reader, corners, limit, &there, error);
      if (reader->by_lines && !there && scan->at < scan->end) {
        vxm_text_defect_add(&reader->body->short_lines, first);
        there = true;
      }
      if (reader->by_lines)
        vxm_skip_rest(scan);
    }
    if (status == VXM_OK && (!any || !there)) {
      reader->body->cut = element;
      reader->body->cut_done = i;
      return VXM_OK;
    }
    if (is_last && (element->role == VXM_PLY_FACES || reader->body->faces_first))
      reader->body->last = first;
    if (status == VXM_OK)
      status = vxm_tokenizer_progress(scan, error);
  }
  return status;
}

/** No element with lines follows the one at `e`. */
static bool is_last_element(const vxm_ply_header *header, size_t e) {
  while (++e < header->element_count)
    if (header->elements[e].count > 0 && header->elements[e].properties > 0)
      return false;
  return true;
}

vxm_status vxm_ply_read_text(vxm_tokenizer *scan, const vxm_ply_header *header, vxm_ply_body *body,
                             vxm_error *error) {
  vxm_status status = VXM_OK;
  const unsigned char *const end = scan->end, *const whole = vxm_last_token(scan);
  for (size_t e = 0; e < header->element_count && status == VXM_OK && !body->cut; e++) {
    const vxm_ply_element *element = &header->elements[e];
    text_reader reader = {.scan = scan,
                          .soup = scan->soup,
                          .header = header,
                          .element = element,
                          .properties = element->properties ? header->properties + element->first : NULL,
                          .body = body,
                          .has_look = vxm_ply_wants_colors(scan->soup, header, element),
                          .is_last = is_last_element(header, e),
                          .end = end,
                          .whole = whole};
    scan->end = end;
    status = read_element(&reader, error);
  }
  scan->end = end;
  if (body->cut)
    scan->at = end;
  return status;
}
