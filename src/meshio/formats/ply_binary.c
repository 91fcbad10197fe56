/* SPDX-License-Identifier: BSD-3-Clause */
/** The body of a binary PLY, with loops of their own for the usual layouts. */
#include "meshio/formats/ply.h"

#include <math.h>

/** Elements between two looks at the progress. */
enum { PIECE = 1 << 16 };

typedef struct binary_reader {
  vxm_tokenizer *scan;
  vxm_soup *soup;
  const vxm_ply_header *header;
  const vxm_ply_element *element;
  const vxm_ply_property *properties;
  vxm_ply_body *body;
  bool swap;
  bool has_look; /**< colours of these elements are kept */
} binary_reader;

static size_t left(const vxm_tokenizer *scan) {
  return (size_t)(scan->end - scan->at);
}

static vxm_status cut_off(binary_reader *reader, uint64_t done) {
  reader->body->cut = reader->element;
  reader->body->cut_done = done;
  return VXM_OK;
}

/* ---- Any number of any type ---- */

static double load_number(const unsigned char *at, uint8_t type, bool swap) {
  switch ((vxm_ply_type)type) {
  case VXM_PLY_I8:
    return (double)(int8_t)*at;
  case VXM_PLY_U8:
    return (double)*at;
  case VXM_PLY_I16:
    return (double)(int16_t)vxm_load_u16(at, swap);
  case VXM_PLY_U16:
    return (double)vxm_load_u16(at, swap);
  case VXM_PLY_I32:
    return (double)(int32_t)vxm_load_u32(at, swap);
  case VXM_PLY_U32:
    return (double)vxm_load_u32(at, swap);
  case VXM_PLY_I64:
    return (double)(int64_t)vxm_load_u64(at, swap);
  case VXM_PLY_U64:
    return (double)vxm_load_u64(at, swap);
  case VXM_PLY_F32:
    return (double)vxm_load_f32(at, swap);
  case VXM_PLY_F64:
    return vxm_load_f64(at, swap);
  }
  return 0.0;
}

/** An index or the length of a list; INT64_MIN for a float that is no whole number. */
static int64_t load_index(const unsigned char *at, uint8_t type, bool swap) {
  switch ((vxm_ply_type)type) {
  case VXM_PLY_I8:
    return (int8_t)*at;
  case VXM_PLY_U8:
    return *at;
  case VXM_PLY_I16:
    return (int16_t)vxm_load_u16(at, swap);
  case VXM_PLY_U16:
    return vxm_load_u16(at, swap);
  case VXM_PLY_I32:
    return (int32_t)vxm_load_u32(at, swap);
  case VXM_PLY_U32:
    return vxm_load_u32(at, swap);
  case VXM_PLY_I64:
    return (int64_t)vxm_load_u64(at, swap);
  case VXM_PLY_U64: {
    uint64_t value = vxm_load_u64(at, swap);
    return value > INT64_MAX ? INT64_MAX : (int64_t)value;
  }
  case VXM_PLY_F32:
  case VXM_PLY_F64: {
    double value = load_number(at, type, swap);
    return value >= -1.0 && value <= (double)UINT32_MAX && value == floor(value) ? (int64_t)value : INT64_MIN;
  }
  }
  return INT64_MIN;
}

/** The length of the list at the cursor, which moves behind it; false if the list is cut off. */
static bool read_length(binary_reader *reader, const vxm_ply_property *property, size_t *n) {
  vxm_tokenizer *scan = reader->scan;
  size_t size = vxm_ply_size((vxm_ply_type)property->count_type);
  if (left(scan) < size)
    return false;
  int64_t length = load_index(scan->at, property->count_type, reader->swap);
  scan->at += size;
  if (length < 0 || (uint64_t)length > left(scan) / vxm_ply_size((vxm_ply_type)property->type))
    return false;
  *n = (size_t)length;
  return true;
}

/** Passes over one property; false if it is cut off. */
static bool skip_property(binary_reader *reader, const vxm_ply_property *property) {
  size_t n = 1, size = vxm_ply_size((vxm_ply_type)property->type);
  if (property->is_list ? !read_length(reader, property, &n) : left(reader->scan) < size)
    return false;
  reader->scan->at += n * size;
  return true;
}

/* ---- Vertices ---- */

/** Where x, y and z lie in a vertex without lists, and their types. */
typedef struct vertex_layout {
  size_t offset[3], stride;
  uint8_t type[3];
  bool has[3];
} vertex_layout;

static vertex_layout layout_of(const binary_reader *reader) {
  vertex_layout layout = {.stride = reader->element->least};
  size_t at = 0;
  for (size_t p = 0; p < reader->element->properties; p++) {
    const vxm_ply_property *property = &reader->properties[p];
    if (property->use <= VXM_PLY_Z) {
      layout.offset[property->use] = at;
      layout.type[property->use] = property->type;
      layout.has[property->use] = true;
    }
    at += vxm_ply_size((vxm_ply_type)property->type);
  }
  return layout;
}

/** Reads `count` vertices whose coordinates all have one type; inlined with constants for each kind. */
__attribute__((always_inline)) static inline void read_plain_vertices(const unsigned char *from, double *to,
                                                                      size_t count,
                                                                      const vertex_layout *layout,
                                                                      bool is_double, bool swap) {
  const size_t x = layout->offset[0], y = layout->offset[1], z = layout->offset[2], stride = layout->stride;
  for (size_t v = 0; v < count; v++, from += stride, to += 3)
    if (is_double) {
      to[0] = vxm_load_f64(from + x, swap);
      to[1] = vxm_load_f64(from + y, swap);
      to[2] = vxm_load_f64(from + z, swap);
    } else {
      to[0] = (double)vxm_load_f32(from + x, swap);
      to[1] = (double)vxm_load_f32(from + y, swap);
      to[2] = (double)vxm_load_f32(from + z, swap);
    }
}

static void read_piece(const binary_reader *reader, const vertex_layout *layout, double *to, size_t count) {
  const unsigned char *from = reader->scan->at;
  bool all = layout->has[0] && layout->has[1] && layout->has[2];
  bool same = all && layout->type[0] == layout->type[1] && layout->type[1] == layout->type[2];
  if (same && layout->type[0] == VXM_PLY_F32 && !reader->swap)
    read_plain_vertices(from, to, count, layout, false, false);
  else if (same && layout->type[0] == VXM_PLY_F32)
    read_plain_vertices(from, to, count, layout, false, true);
  else if (same && layout->type[0] == VXM_PLY_F64 && !reader->swap)
    read_plain_vertices(from, to, count, layout, true, false);
  else if (same && layout->type[0] == VXM_PLY_F64)
    read_plain_vertices(from, to, count, layout, true, true);
  else
    for (size_t v = 0; v < count; v++)
      for (size_t c = 0; c < 3; c++)
        to[3 * v + c] = layout->has[c] ? load_number(from + v * layout->stride + layout->offset[c],
                                                     layout->type[c], reader->swap)
                                       : 0.0;
}

/** Keeps the colours of vertices without lists, from the cursor on. */
static vxm_status read_fixed_colors(const binary_reader *reader, size_t count, vxm_error *error) {
  vxm_soup *soup = reader->soup;
  vxm_status status = VXM_OK;
  for (size_t v = 0; v < count && status == VXM_OK; v++) {
    const unsigned char *at = reader->scan->at + v * reader->element->least;
    double rgba[4] = {0, 0, 0, 0};
    for (size_t p = 0; p < reader->element->properties; p++) {
      const vxm_ply_property *property = &reader->properties[p];
      if (property->channel)
        rgba[property->channel - 1] = load_number(at, property->type, reader->swap);
      at += vxm_ply_size((vxm_ply_type)property->type);
    }
    status =
        vxm_gather_color(&soup->appearance->vertices, soup->context, soup->vertex_count + v, rgba, error);
  }
  return status;
}

static vxm_status read_fixed_vertices(binary_reader *reader, vxm_error *error) {
  vxm_tokenizer *scan = reader->scan;
  vxm_soup *soup = reader->soup;
  vertex_layout layout = layout_of(reader);
  uint64_t room = left(scan) / layout.stride;
  size_t count = (size_t)(reader->element->count < room ? reader->element->count : room);
  vxm_status status = vxm_soup_reserve(soup, count, 0, 0, error);
  while (status == VXM_OK && soup->vertex_count < count) {
    size_t piece = count - soup->vertex_count < PIECE ? count - soup->vertex_count : PIECE;
    read_piece(reader, &layout, soup->positions + 3 * soup->vertex_count, piece);
    if (reader->has_look)
      status = read_fixed_colors(reader, piece, error);
    soup->vertex_count += piece;
    scan->at += piece * layout.stride;
    if (status == VXM_OK)
      status = vxm_tokenizer_progress(scan, error);
  }
  if (status == VXM_OK && count < reader->element->count)
    return cut_off(reader, count);
  return status;
}

static vxm_status read_vertices_with_lists(binary_reader *reader, vxm_error *error) {
  vxm_tokenizer *scan = reader->scan;
  vxm_status status = VXM_OK;
  for (uint64_t v = 0; v < reader->element->count && status == VXM_OK; v++) {
    double position[3] = {0.0, 0.0, 0.0}, rgba[4] = {0, 0, 0, 0};
    for (size_t p = 0; p < reader->element->properties; p++) {
      const vxm_ply_property *property = &reader->properties[p];
      const unsigned char *at = scan->at;
      if (!skip_property(reader, property))
        return cut_off(reader, v);
      if (property->use <= VXM_PLY_Z)
        position[property->use] = load_number(at, property->type, reader->swap);
      if (property->channel)
        rgba[property->channel - 1] = load_number(at, property->type, reader->swap);
    }
    if (reader->has_look)
      status = vxm_gather_color(&reader->soup->appearance->vertices, reader->soup->context,
                                reader->soup->vertex_count, rgba, error);
    if (status == VXM_OK)
      status = vxm_soup_add_vertex(reader->soup, position[0], position[1], position[2], error);
    if (status == VXM_OK)
      status = vxm_tokenizer_progress(scan, error);
  }
  return status;
}

/* ---- Faces ---- */

/** A face of one list with an 8-bit length and 32-bit indices, and a fixed number of bytes around it. */
typedef struct face_layout {
  size_t before, after;
  bool usual;
} face_layout;

static face_layout face_layout_of(const binary_reader *reader) {
  face_layout layout = {0};
  size_t lists = 0;
  for (size_t p = 0; p < reader->element->properties; p++) {
    const vxm_ply_property *property = &reader->properties[p];
    if (property->is_list)
      lists++;
    if (property->use == VXM_PLY_CORNERS)
      layout.usual = property->count_type == VXM_PLY_U8 &&
                     (property->type == VXM_PLY_I32 || property->type == VXM_PLY_U32);
    else if (layout.usual)
      layout.after += vxm_ply_size((vxm_ply_type)property->type);
    else
      layout.before += vxm_ply_size((vxm_ply_type)property->type);
  }
  layout.usual = layout.usual && lists == 1;
  return layout;
}

static void drop_face(binary_reader *reader, const unsigned char *at, bool beyond) {
  vxm_text_defect_add(beyond ? &reader->body->beyond : &reader->body->small_faces, at);
}

/**
 * Reads up to `count` faces of the usual layout, inlined with a constant for either byte order. Returns how
 * many were whole; fewer than asked for only where the file ends.
 */
__attribute__((always_inline)) static inline uint64_t
read_usual_piece(binary_reader *reader, const face_layout *layout, uint64_t count, uint64_t limit, bool swap,
                 vxm_status *status, vxm_error *error) {
  vxm_soup *soup = reader->soup;
  const unsigned char *p = reader->scan->at, *const end = reader->scan->end;
  const size_t before = layout->before, after = layout->after;
  uint64_t done = 0;
  for (; done < count; done++) {
    if ((size_t)(end - p) < before + 1)
      break;
    size_t n = p[before];
    const unsigned char *from = p + before + 1;
    if ((size_t)(end - from) < 4 * n + after)
      break;
    if (__builtin_expect(n > soup->corner_capacity - soup->corner_count, 0)) {
      *status = vxm_corners_reserve(soup, n, error);
      if (*status != VXM_OK)
        break;
    }
    uint32_t *corner = soup->indices + soup->corner_count;
    bool beyond = false;
    if (__builtin_expect(n == 3, 1)) {
      corner[0] = vxm_load_u32(from, swap);
      corner[1] = vxm_load_u32(from + 4, swap);
      corner[2] = vxm_load_u32(from + 8, swap);
      beyond = corner[0] >= limit || corner[1] >= limit || corner[2] >= limit;
    } else
      for (size_t c = 0; c < n; c++) {
        corner[c] = vxm_load_u32(from + 4 * c, swap);
        beyond |= corner[c] >= limit;
      }
    if (__builtin_expect(beyond || n < 3, 0))
      drop_face(reader, p, beyond);
    else {
      *status = vxm_face_end(soup, n, error);
      if (__builtin_expect(*status != VXM_OK, 0))
        break;
    }
    p = from + 4 * n + after;
  }
  reader->scan->at = p;
  return done;
}

static vxm_status read_usual_faces(binary_reader *reader, const face_layout *layout, uint64_t limit,
                                   vxm_error *error) {
  uint64_t count = reader->element->count, done = 0;
  vxm_status status = VXM_OK;
  while (status == VXM_OK && done < count) {
    uint64_t piece = count - done < PIECE ? count - done : PIECE, got;
    if (reader->swap)
      got = read_usual_piece(reader, layout, piece, limit, true, &status, error);
    else
      got = read_usual_piece(reader, layout, piece, limit, false, &status, error);
    done += got;
    if (status == VXM_OK && got < piece)
      return cut_off(reader, done);
    if (status == VXM_OK)
      status = vxm_tokenizer_progress(reader->scan, error);
  }
  return status;
}

/** Adds the face whose n indices begin at `from`. */
static vxm_status add_face(binary_reader *reader, const vxm_ply_property *property, const unsigned char *from,
                           size_t n, const unsigned char *first, uint64_t limit, vxm_error *error) {
  vxm_soup *soup = reader->soup;
  size_t size = vxm_ply_size((vxm_ply_type)property->type);
  vxm_status status = vxm_corners_reserve(soup, n, error);
  if (status != VXM_OK)
    return status;
  uint32_t *corner = soup->indices + soup->corner_count;
  bool beyond = false;
  for (size_t c = 0; c < n; c++) {
    int64_t index = load_index(from + c * size, property->type, reader->swap);
    beyond |= index < 0 || (uint64_t)index >= limit;
    corner[c] = (uint32_t)index;
  }
  if (!beyond && n >= 3)
    return vxm_face_end(soup, n, error);
  drop_face(reader, first, beyond);
  return VXM_OK;
}

static vxm_status add_strip(binary_reader *reader, const vxm_ply_property *property,
                            const unsigned char *from, size_t n, uint64_t limit, vxm_error *error) {
  size_t size = vxm_ply_size((vxm_ply_type)property->type);
  vxm_ply_strip strip = {0};
  vxm_status status = VXM_OK;
  for (size_t c = 0; c < n && status == VXM_OK; c++, from += size)
    status = vxm_ply_strip_add(&strip, reader->soup, load_index(from, property->type, reader->swap), limit,
                               from, reader->body, error);
  return status;
}

/** Reads faces or strips of any layout. */
static vxm_status read_any_faces(binary_reader *reader, uint64_t limit, vxm_error *error) {
  vxm_tokenizer *scan = reader->scan;
  vxm_status status = VXM_OK;
  for (uint64_t f = 0; f < reader->element->count && status == VXM_OK; f++) {
    const unsigned char *first = scan->at, *from = NULL;
    const vxm_ply_property *corners = NULL;
    size_t n = 0, face = reader->soup->face_count;
    double rgba[4] = {0, 0, 0, 0};
    for (size_t p = 0; p < reader->element->properties; p++) {
      const vxm_ply_property *property = &reader->properties[p];
      if (property->use != VXM_PLY_CORNERS) {
        const unsigned char *at = scan->at;
        if (!skip_property(reader, property))
          return cut_off(reader, f);
        if (property->channel)
          rgba[property->channel - 1] = load_number(at, property->type, reader->swap);
        continue;
      }
      corners = property;
      if (!read_length(reader, property, &n))
        return cut_off(reader, f);
      from = scan->at;
      scan->at += n * vxm_ply_size((vxm_ply_type)property->type);
    }
    status = reader->element->role == VXM_PLY_STRIPS
                 ? add_strip(reader, corners, from, n, limit, error)
                 : add_face(reader, corners, from, n, first, limit, error);
    if (status == VXM_OK && reader->has_look && reader->soup->face_count > face)
      status = vxm_gather_color(&reader->soup->appearance->faces, reader->soup->context, face, rgba, error);
    if (status == VXM_OK)
      status = vxm_tokenizer_progress(scan, error);
  }
  return status;
}

static vxm_status read_faces(binary_reader *reader, vxm_error *error) {
  const vxm_ply_element *element = reader->element;
  uint64_t limit = vxm_ply_index_limit(reader->scan, reader->header, reader->body);
  if (element->role == VXM_PLY_STRIPS)
    return read_any_faces(reader, limit, error);
  /* Three indices of one byte are the least that makes a face. */
  face_layout layout = face_layout_of(reader);
  size_t least = element->least + (layout.usual ? 12 : 3), room = left(reader->scan) / least + 1;
  size_t faces = (size_t)(element->count < room ? element->count : room);
  vxm_soup *soup = reader->soup;
  vxm_status status =
      vxm_soup_reserve(soup, 0, soup->face_count + faces, soup->corner_count + 3 * faces, error);
  if (status != VXM_OK)
    return status;
  return layout.usual && !reader->has_look ? read_usual_faces(reader, &layout, limit, error)
                                           : read_any_faces(reader, limit, error);
}

/* ---- The body ---- */

static vxm_status skip_element(binary_reader *reader, vxm_error *error) {
  vxm_tokenizer *scan = reader->scan;
  const vxm_ply_element *element = reader->element;
  if (element->properties == 0)
    return VXM_OK;
  if (!element->has_list) {
    uint64_t room = left(scan) / element->least;
    if (element->count > room)
      return cut_off(reader, room);
    scan->at += (size_t)element->count * element->least;
    return VXM_OK;
  }
  vxm_status status = VXM_OK;
  for (uint64_t i = 0; i < element->count && status == VXM_OK; i++) {
    for (size_t p = 0; p < element->properties; p++)
      if (!skip_property(reader, &reader->properties[p]))
        return cut_off(reader, i);
    status = vxm_tokenizer_progress(scan, error);
  }
  return status;
}

vxm_status vxm_ply_read_binary(vxm_tokenizer *scan, const vxm_ply_header *header, vxm_ply_body *body,
                               vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t e = 0; e < header->element_count && status == VXM_OK && !body->cut; e++) {
    const vxm_ply_element *element = &header->elements[e];
    binary_reader reader = {.scan = scan,
                            .soup = scan->soup,
                            .header = header,
                            .element = element,
                            .properties = element->properties ? header->properties + element->first : NULL,
                            .body = body,
                            .swap = vxm_must_swap(header->big_endian),
                            .has_look = vxm_ply_wants_colors(scan->soup, header, element)};
    if (element->role == VXM_PLY_VERTICES)
      status =
          element->has_list ? read_vertices_with_lists(&reader, error) : read_fixed_vertices(&reader, error);
    else if (element->role == VXM_PLY_PASSED)
      status = skip_element(&reader, error);
    else
      status = read_faces(&reader, error);
  }
  return status;
}
