/* SPDX-License-Identifier: BSD-3-Clause */
/** The header of PLY: lines of words, ended by LF, CR LF or CR (Turk's "The PLY Polygon File Format"). */
#include "meshio/formats/ply.h"

#include <inttypes.h>

/** A word of a header line. */
typedef struct word {
  const unsigned char *text;
  size_t length;
} word;

static bool is(word w, const char *text) {
  return strlen(text) == w.length && memcmp(w.text, text, w.length) == 0;
}

/** The next word of the line; of length 0 if there is none. */
static word next_word(vxm_tokenizer *scan) {
  vxm_skip_blanks(scan);
  word w = {scan->at, 0};
  vxm_skip_token(scan);
  w.length = (size_t)(scan->at - w.text);
  return w;
}

size_t vxm_ply_size(vxm_ply_type type) {
  static const size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[type];
}

static bool find_type(word w, uint8_t *type) {
  static const struct {
    const char *name;
    vxm_ply_type type;
  } types[] = {
      {"char", VXM_PLY_I8},    {"int8", VXM_PLY_I8},     {"uchar", VXM_PLY_U8},   {"uint8", VXM_PLY_U8},
      {"short", VXM_PLY_I16},  {"int16", VXM_PLY_I16},   {"ushort", VXM_PLY_U16}, {"uint16", VXM_PLY_U16},
      {"int", VXM_PLY_I32},    {"int32", VXM_PLY_I32},   {"uint", VXM_PLY_U32},   {"uint32", VXM_PLY_U32},
      {"int64", VXM_PLY_I64},  {"uint64", VXM_PLY_U64},  {"float", VXM_PLY_F32},  {"float32", VXM_PLY_F32},
      {"double", VXM_PLY_F64}, {"float64", VXM_PLY_F64},
  };
  for (size_t t = 0; t < sizeof types / sizeof *types; t++)
    if (is(w, types[t].name)) {
      *type = (uint8_t)types[t].type;
      return true;
    }
  return false;
}

static vxm_status fail_line(const vxm_tokenizer *scan, const unsigned char *at, vxm_error *error,
                            const char *what, word w) {
  char quote[VXM_QUOTE];
  return vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_tokenizer_place(scan, at), "%s: \"%s\"", what,
                     vxm_quote(quote, w.text, w.length));
}

static vxm_status read_format(vxm_tokenizer *scan, vxm_ply_header *header, bool *known, vxm_error *error) {
  word w = next_word(scan);
  *known = true;
  header->ascii = is(w, "ascii");
  header->big_endian = is(w, "binary_big_endian");
  if (!header->ascii && !header->big_endian && !is(w, "binary_little_endian"))
    return fail_line(scan, w.text, error, "unknown PLY format", w);
  return VXM_OK;
}

static vxm_status read_element(vxm_tokenizer *scan, vxm_ply_header *header, vxm_error *error) {
  vxm_status status = vxm_grow(scan->soup->context, (void **)&header->elements, &header->element_capacity,
                               header->element_count + 1, sizeof *header->elements, error);
  if (status != VXM_OK)
    return status;
  word name = next_word(scan);
  vxm_ply_element *element = &header->elements[header->element_count];
  *element = (vxm_ply_element){.role = VXM_PLY_PASSED,
                               .first = header->property_count,
                               .name_at = (size_t)(name.text - scan->begin),
                               .name_length = name.length};
  if (is(name, "vertex"))
    element->role = VXM_PLY_VERTICES;
  else if (is(name, "face"))
    element->role = VXM_PLY_FACES;
  else if (is(name, "tristrips"))
    element->role = VXM_PLY_STRIPS;
  vxm_skip_blanks(scan);
  word number = {scan->at, vxm_token_length(scan)};
  if (number.length == 0 || !vxm_tokenizer_uint(scan, &element->count))
    return fail_line(scan, name.text, error, "the number of elements is not a whole number", number);
  header->element_count++;
  return VXM_OK;
}

static uint8_t use_of(const vxm_ply_element *element, word name, bool is_list) {
  if (element->role == VXM_PLY_VERTICES && !is_list && name.length == 1 && name.text[0] >= 'x' &&
      name.text[0] <= 'z')
    return (uint8_t)(VXM_PLY_X + (name.text[0] - 'x'));
  if ((element->role == VXM_PLY_FACES || element->role == VXM_PLY_STRIPS) && is_list &&
      (is(name, "vertex_indices") || is(name, "vertex_index")))
    return VXM_PLY_CORNERS;
  return VXM_PLY_OTHER;
}

/** Which light a property gives; names of two spellings. */
static uint8_t channel_of(word name, bool is_list) {
  static const char *const names[3][3] = {
      {"red", "diffuse_red", "r"}, {"green", "diffuse_green", "g"}, {"blue", "diffuse_blue", "b"}};
  for (int c = 0; c < 3 && !is_list; c++)
    for (int n = 0; n < 3; n++)
      if (is(name, names[c][n]))
        return (uint8_t)(c + 1);
  return 0;
}

static vxm_status read_property(vxm_tokenizer *scan, vxm_ply_header *header, vxm_error *error) {
  if (header->element_count == 0)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_tokenizer_place(scan, scan->at),
                       "a property before any element");
  vxm_status status = vxm_grow(scan->soup->context, (void **)&header->properties, &header->property_capacity,
                               header->property_count + 1, sizeof *header->properties, error);
  if (status != VXM_OK)
    return status;
  vxm_ply_element *element = &header->elements[header->element_count - 1];
  vxm_ply_property *property = &header->properties[header->property_count];
  *property = (vxm_ply_property){.use = VXM_PLY_OTHER};
  word w = next_word(scan);
  property->is_list = is(w, "list");
  if (property->is_list) {
    word count = next_word(scan);
    if (!find_type(count, &property->count_type) || property->count_type >= VXM_PLY_F32)
      return fail_line(scan, w.text, error, "unknown type of a list's length", count);
    w = next_word(scan);
  }
  if (!find_type(w, &property->type))
    return fail_line(scan, w.text, error, "unknown property type", w);
  word name = next_word(scan);
  property->use = use_of(element, name, property->is_list);
  property->channel = channel_of(name, property->is_list);
  element->has_list |= property->is_list;
  element->least += vxm_ply_size(property->is_list ? property->count_type : property->type);
  element->properties++;
  header->property_count++;
  return VXM_OK;
}

static bool has_use(const vxm_ply_header *header, const vxm_ply_element *element, vxm_ply_use use) {
  for (size_t p = 0; p < element->properties; p++)
    if (header->properties[element->first + p].use == use)
      return true;
  return false;
}

/** A property named twice counts once. */
static void drop_repeated_uses(vxm_ply_header *header, const vxm_ply_element *element) {
  bool seen[VXM_PLY_OTHER] = {false};
  for (size_t p = 0; p < element->properties; p++) {
    vxm_ply_property *property = &header->properties[element->first + p];
    if (property->use == VXM_PLY_OTHER)
      continue;
    if (seen[property->use])
      property->use = VXM_PLY_OTHER;
    else
      seen[property->use] = true;
  }
}

static bool has_colors(const vxm_ply_header *header, const vxm_ply_element *element) {
  unsigned seen = 0;
  for (size_t p = 0; p < element->properties; p++)
    seen |= 1U << header->properties[element->first + p].channel;
  return (seen & 14U) == 14U;
}

bool vxm_ply_wants_colors(const vxm_soup *soup, const vxm_ply_header *header,
                          const vxm_ply_element *element) {
  if (!soup->appearance || !element->has_colors || element->role == VXM_PLY_STRIPS)
    return false;
  float unit = 0;
  for (size_t p = 0; p < element->properties; p++) {
    const vxm_ply_property *property = &header->properties[element->first + p];
    if (property->channel)
      unit = property->type == VXM_PLY_U8 ? 255 : property->type == VXM_PLY_U16 ? 65535 : 0;
  }
  if (element->role == VXM_PLY_VERTICES)
    soup->appearance->vertices.unit = unit;
  else
    soup->appearance->faces.unit = unit;
  return true;
}

/** Settles which elements give vertices and faces once all properties are known. */
static vxm_status settle_roles(vxm_tokenizer *scan, vxm_ply_header *header, vxm_error *error) {
  bool vertices = false;
  for (size_t e = 0; e < header->element_count; e++) {
    vxm_ply_element *element = &header->elements[e];
    drop_repeated_uses(header, element);
    element->has_corners = has_use(header, element, VXM_PLY_CORNERS);
    element->has_colors = has_colors(header, element);
    if (element->role == VXM_PLY_VERTICES && vertices)
      element->role = VXM_PLY_PASSED; /* only the first counts */
    if (element->role == VXM_PLY_VERTICES) {
      vertices = true;
      header->vertices = element->count;
      if (!has_use(header, element, VXM_PLY_X) || !has_use(header, element, VXM_PLY_Y))
        return vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_tokenizer_place(scan, scan->begin + element->name_at),
                           "the vertices have no x and y");
      if (!has_use(header, element, VXM_PLY_Z))
        vxm_warn(&scan->soup->warnings, "line %" PRId64 ": vertices have no z; taken as 0",
                 vxm_tokenizer_line(scan, scan->begin + element->name_at));
    }
    if ((element->role == VXM_PLY_FACES || element->role == VXM_PLY_STRIPS) && !element->has_corners) {
      if (element->count > 0)
        vxm_text_defect_add(&header->no_corners, scan->begin + element->name_at);
      element->role = VXM_PLY_PASSED;
    }
  }
  return VXM_OK;
}

/** Reads one line; *ended when it is end_header. */
static vxm_status read_line(vxm_tokenizer *scan, vxm_ply_header *header, bool *format_known, bool *ended,
                            vxm_error *error) {
  word w = next_word(scan);
  if (is(w, "format"))
    return read_format(scan, header, format_known, error);
  if (is(w, "element"))
    return read_element(scan, header, error);
  if (is(w, "property"))
    return read_property(scan, header, error);
  *ended = is(w, "end_header");
  if (*ended || w.length == 0 || is(w, "comment") || is(w, "obj_info"))
    return VXM_OK;
  return fail_line(scan, w.text, error, "unknown word in the PLY header", w);
}

/** Passes the end of a line; where lines end in CR alone a LF is the first byte of a binary body. */
static void pass_line_end(vxm_tokenizer *scan, bool cr_alone) {
  vxm_skip_rest(scan);
  if (scan->at == scan->end)
    return;
  if (*scan->at++ == '\r' && !cr_alone && scan->at < scan->end && *scan->at == '\n')
    scan->at++;
}

vxm_status vxm_ply_read_header(vxm_tokenizer *scan, vxm_ply_header *header, vxm_error *error) {
  bool format_known = false, ended = false;
  vxm_skip_rest(scan);
  bool cr_alone = scan->end - scan->at > 1 && scan->at[0] == '\r' && scan->at[1] != '\n';
  vxm_status status = VXM_OK;
  while (status == VXM_OK && !ended) {
    pass_line_end(scan, cr_alone);
    if (scan->at == scan->end)
      return vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_tokenizer_place(scan, scan->end),
                         "the PLY header never ends: no end_header");
    status = read_line(scan, header, &format_known, &ended, error);
  }
  if (status != VXM_OK)
    return status;
  pass_line_end(scan, cr_alone);
  if (!format_known)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_tokenizer_place(scan, scan->at),
                       "the PLY header has no format line");
  return settle_roles(scan, header, error);
}

void vxm_ply_header_destroy(vxm_ply_header *header, vxm_context *context) {
  vxm_free(context, header->elements);
  vxm_free(context, header->properties);
}
