/* SPDX-License-Identifier: BSD-3-Clause */
/** .vti: an image in VTK's XML, with the values appended as raw bytes. */
#include "base/c_locale.h"
#include "base/endian.h"
#include "gridio/common/deflate.h"
#include "gridio/formats/vtk_image.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** VTK's names of the types. */
static const vxm_vtk_type types[] = {
    {"UInt8", VXM_UINT8},     {"Int8", VXM_INT8},       {"UInt16", VXM_UINT16}, {"Int16", VXM_INT16},
    {"UInt32", VXM_UINT32},   {"Int32", VXM_INT32},     {"UInt64", VXM_UINT64}, {"Int64", VXM_INT64},
    {"Float32", VXM_FLOAT32}, {"Float64", VXM_FLOAT64}, {NULL, VXM_UINT8}};

enum { TAG_MAX = 2048, VALUE_MAX = 256, XML_MAX = 1 << 20 };

/* ---- Reading: the few tags that matter ---- */

/** The XML of a file: what stands before the appended values. */
typedef struct scan {
  const vxm_input *input;
  size_t end;  /**< of the XML */
  size_t data; /**< offset of the appended values */
  vxm_vtk_image image;
  bool is_swapped, is_packed;
  int header_bytes; /**< of the numbers before the values: 4 or 8 */
  uint64_t offset;  /**< of the array in the appended values */
} scan;

static const unsigned char *find_bytes(const scan *s, const char *word, size_t from) {
  return from < s->end ? memmem(s->input->data + from, s->end - from, word, strlen(word)) : NULL;
}

/** The first tag of a name from an offset on, with its attributes; `from` moves behind it. */
static bool find_tag(const scan *s, char tag[TAG_MAX], const char *name, size_t *from) {
  char opening[40];
  snprintf(opening, sizeof opening, "<%s", name);
  const unsigned char *at;
  while ((at = find_bytes(s, opening, *from)) != NULL) {
    size_t begin = (size_t)(at - s->input->data);
    const unsigned char *close = memchr(at, '>', s->end - begin);
    char behind = close ? (char)at[strlen(opening)] : '\0';
    *from = begin + 1;
    if (!close || (size_t)(close - at) >= TAG_MAX)
      return false;
    if (behind != ' ' && behind != '>' && behind != '/' && behind != '\n' && behind != '\r' && behind != '\t')
      continue;
    memcpy(tag, at, (size_t)(close - at));
    tag[close - at] = '\0';
    *from = (size_t)(close - s->input->data) + 1;
    return true;
  }
  return false;
}

/** The value of an attribute of a tag, cut; false if it has none. */
static bool find_value(char value[VALUE_MAX], const char *tag, const char *name) {
  size_t length = strlen(name);
  for (const char *at = tag; (at = strstr(at, name)) != NULL; at += length) {
    const char *from = at + length;
    if (at == tag || !strchr(" \t\r\n", at[-1]) || *from != '=' || (from[1] != '"' && from[1] != '\''))
      continue;
    const char *end = strchr(from + 2, from[1]);
    if (!end)
      return false;
    size_t size = (size_t)(end - from - 2), kept = size < VALUE_MAX ? size : VALUE_MAX - 1;
    memcpy(value, from + 2, kept);
    value[kept] = '\0';
    return true;
  }
  return false;
}

static vxm_status fail_xml(const scan *s, size_t at, const char *why, vxm_error *error) {
  return vxm_fail_byte(error, s->input, at, "%s", why);
}

static bool read_numbers(double *numbers, int count, const char *text) {
  for (int n = 0; n < count; n++) {
    char *end;
    numbers[n] = strtod(text, &end);
    if (end == text)
      return false;
    text = end;
  }
  return true;
}

static vxm_status take_file(scan *s, const char *tag, vxm_error *error) {
  char value[VALUE_MAX];
  if (!find_value(value, tag, "type") || strcmp(value, "ImageData") != 0)
    return fail_xml(s, 0, "it is not an image (VTKFile type=\"ImageData\")", error);
  bool is_big = find_value(value, tag, "byte_order") && strcmp(value, "BigEndian") == 0;
  s->is_swapped = is_big == (vxm_le64(1) == 1);
  s->header_bytes = find_value(value, tag, "header_type") && strcmp(value, "UInt64") == 0 ? 8 : 4;
  s->is_packed = find_value(value, tag, "compressor");
  if (s->is_packed && strcmp(value, "vtkZLibDataCompressor") != 0)
    return fail_xml(s, 0, "its values are compressed, but not by zlib; write them so, or uncompressed",
                    error);
  return VXM_OK;
}

static vxm_status take_image(scan *s, const char *tag, size_t at, vxm_error *error) {
  static const double along[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  char value[VALUE_MAX];
  double extent[6], direction[9];
  vxm_vtk_image *image = &s->image;
  if (!find_value(value, tag, "WholeExtent") || !read_numbers(extent, 6, value))
    return fail_xml(s, at, "ImageData without a WholeExtent", error);
  if (find_value(value, tag, "Origin") && !read_numbers(image->origin, 3, value))
    return fail_xml(s, at, "an Origin of three numbers is expected", error);
  if (find_value(value, tag, "Spacing") && !read_numbers(image->spacing, 3, value))
    return fail_xml(s, at, "a Spacing of three numbers is expected", error);
  if (find_value(value, tag, "Direction") &&
      (!read_numbers(direction, 9, value) || memcmp(direction, along, sizeof along) != 0))
    return fail_xml(s, at, "the image is turned against the axes of space; resample it along them first",
                    error);
  for (int a = 0; a < 3; a++) {
    double low = extent[2 * a], high = extent[2 * a + 1];
    if (!(low >= -0x1p31 && high >= low && high <= 0x1p31))
      return fail_xml(s, at, "its WholeExtent is none of an image", error);
    image->points[a] = (int64_t)high - (int64_t)low + 1;
    image->origin[a] += (double)(int64_t)low * image->spacing[a];
  }
  return VXM_OK;
}

static vxm_status take_array(scan *s, const char *tag, size_t at, vxm_error *error) {
  char value[VALUE_MAX];
  if (!find_value(value, tag, "format") || strcmp(value, "appended") != 0)
    return fail_xml(s, at, "its values stand within the XML; write them appended, as raw bytes", error);
  if (find_value(value, tag, "Name"))
    snprintf(s->image.name, sizeof s->image.name, "%.63s", value);
  s->image.components = find_value(value, tag, "NumberOfComponents") ? (int)strtol(value, NULL, 10) : 1;
  s->offset = find_value(value, tag, "offset") ? strtoull(value, NULL, 10) : 0;
  bool is_known = find_value(value, tag, "type") && vxm_vtk_type_find(&s->image.scalar, types, value);
  return is_known ? VXM_OK : fail_xml(s, at, "an array of numbers is expected, up to 64 bits", error);
}

/** The first array of cells, or else of points. */
static vxm_status find_array(scan *s, char tag[TAG_MAX], size_t from, vxm_error *error) {
  static const char *const kinds[] = {"CellData", "PointData"};
  for (int k = 0; k < 2; k++) {
    char closing[40];
    size_t at = from;
    snprintf(closing, sizeof closing, "</%s>", kinds[k]);
    if (!find_tag(s, tag, kinds[k], &at) || tag[strlen(tag) - 1] == '/')
      continue;
    const unsigned char *end = find_bytes(s, closing, at);
    if (find_tag(s, tag, "DataArray", &at) && end && s->input->data + at <= end) {
      s->image.is_points = k == 1;
      return take_array(s, tag, at, error);
    }
  }
  return fail_xml(s, from, "it has no array of cells or points", error);
}

static vxm_status take_xml(scan *s, vxm_error *error) {
  char tag[TAG_MAX], value[VALUE_MAX];
  size_t at = 0, end = 0;
  const vxm_input *input = s->input;
  s->end = input->size < XML_MAX ? input->size : XML_MAX;
  for (int a = 0; a < 3; a++)
    s->image.spacing[a] = 1;
  if (!find_tag(s, tag, "VTKFile", &at))
    return fail_xml(s, 0, "not a file of VTK's XML", error);
  vxm_status status = take_file(s, tag, error);
  if (status != VXM_OK)
    return status;
  bool is_raw = find_tag(s, tag, "AppendedData", &end) && find_value(value, tag, "encoding") &&
                strcmp(value, "raw") == 0;
  const unsigned char *mark = is_raw ? find_bytes(s, "_", end) : NULL;
  if (!mark)
    return fail_xml(s, end, "its values are not appended as raw bytes; write them so", error);
  s->data = (size_t)(mark - input->data) + 1;
  s->end = end;
  if (!find_tag(s, tag, "ImageData", &at))
    return fail_xml(s, at, "ImageData is missing", error);
  status = take_image(s, tag, at, error);
  return status == VXM_OK ? find_array(s, tag, at, error) : status;
}

/* ---- Reading: the values ---- */

/** The number before the values at an index, or UINT64_MAX behind the end of the file. */
static uint64_t header_number(const scan *s, uint64_t index) {
  size_t size = (size_t)s->header_bytes;
  uint64_t there = s->input->size - s->data;
  unsigned char bytes[8];
  if (s->offset > there || index > (there - s->offset) / size || (index + 1) * size > there - s->offset)
    return UINT64_MAX;
  const unsigned char *at = s->input->data + s->data + s->offset + index * size;
  for (size_t b = 0; b < size; b++)
    bytes[b] = at[s->is_swapped ? size - 1 - b : b];
  if (size == 8) {
    uint64_t whole;
    memcpy(&whole, bytes, sizeof whole);
    return whole;
  }
  uint32_t word;
  memcpy(&word, bytes, sizeof word);
  return word;
}

/** Values in blocks, each compressed on its own. */
typedef struct block_source {
  const scan *scan;
  uint64_t blocks, block_bytes, last_bytes;
  uint64_t next, at,
      left; /**< the block to come, where it begins in the file, and what is left of the last */
  vxm_inflater *inflater;
} block_source;

static vxm_status open_block(block_source *b, vxm_error *error) {
  const scan *s = b->scan;
  uint64_t packed = b->next < b->blocks ? header_number(s, 3 + b->next) : UINT64_MAX;
  if (packed == UINT64_MAX || b->at > s->input->size || packed > s->input->size - b->at)
    return vxm_fail_byte(error, s->input, s->input->size, "the file is cut short");
  vxm_inflater_destroy(b->inflater);
  vxm_status status = vxm_inflater_create(&b->inflater, s->input, (size_t)b->at, error);
  bool is_last = b->next + 1 == b->blocks;
  b->left = is_last && b->last_bytes > 0 ? b->last_bytes : b->block_bytes;
  b->at += packed;
  b->next++;
  return status;
}

static vxm_status take_blocks(void *payload, void *slice, size_t size, vxm_error *error) {
  block_source *b = payload;
  unsigned char *to = slice;
  vxm_status status = VXM_OK;
  while (size > 0 && status == VXM_OK) {
    if (b->left == 0) {
      status = open_block(b, error);
      continue;
    }
    size_t some = size < b->left ? size : (size_t)b->left;
    status = vxm_inflater_read(b->inflater, to, some, error);
    to += some;
    size -= some;
    b->left -= some;
  }
  return status;
}

static vxm_status check_length(const scan *s, const vxm_raster *raster, vxm_error *error) {
  uint64_t bytes = vxm_raster_bytes(raster), there = s->input->size - s->data;
  bool fits = s->is_packed ? bytes / VXM_INFLATE_RATIO_MAX <= there
                           : header_number(s, 0) != UINT64_MAX &&
                                 there - s->offset - (uint64_t)s->header_bytes >= bytes;
  if (!fits)
    return vxm_fail_byte(error, s->input, s->input->size,
                         "the file is cut short: %" PRIu64 " voxels are not in it",
                         vxm_space_voxels(&raster->space));
  if (!s->is_packed && header_number(s, 0) != bytes)
    return vxm_fail_byte(error, s->input, s->data, "its array has %" PRIu64 " bytes, not %" PRIu64,
                         header_number(s, 0), bytes);
  return VXM_OK;
}

static vxm_status read_packed(vxm_field **out, const vxm_raster *raster, vxm_about *about, const scan *s,
                              vxm_error *error) {
  block_source b = {.scan = s,
                    .blocks = header_number(s, 0),
                    .block_bytes = header_number(s, 1),
                    .last_bytes = header_number(s, 2)};
  /* What is added here is far below 2^64: the numbers lie within the file. */
  bool is_there = b.blocks != UINT64_MAX && b.block_bytes - 1 < UINT64_MAX - 1 &&
                  b.last_bytes != UINT64_MAX && b.blocks <= s->input->size;
  if (!is_there) {
    vxm_about_destroy(about);
    return vxm_fail_byte(error, s->input, s->data, "the sizes of its compressed blocks are damaged");
  }
  b.at = s->data + s->offset + (3 + b.blocks) * (uint64_t)s->header_bytes;
  vxm_status status = vxm_raster_read(out, raster, s->input->context, about, take_blocks, &b, error);
  vxm_inflater_destroy(b.inflater);
  return status;
}

/** Reads the XML by the numbers of the locale "C". */
static vxm_status read_header(vxm_raster *raster, vxm_about *about, scan *s, vxm_error *error) {
  locale_t previous = uselocale(vxm_c_locale());
  vxm_status status = take_xml(s, error);
  uselocale(previous);
  if (status == VXM_OK)
    status = vxm_vtk_raster(raster, about, &s->image, s->input, 0, error);
  if (status != VXM_OK)
    return status;
  raster->is_swapped = s->is_swapped;
  return check_length(s, raster, error);
}

static vxm_status read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  scan s = {.input = input};
  vxm_raster raster;
  vxm_about about;
  vxm_status status = read_header(&raster, &about, &s, error);
  if (status != VXM_OK)
    return status;
  vxm_sidecar_take_labels(&about, raster.space.dims, input);
  if (s.is_packed)
    return read_packed(out, &raster, &about, &s, error);
  vxm_vtk_source source = {input->data + s.data + s.offset + (size_t)s.header_bytes};
  return vxm_raster_read(out, &raster, input->context, &about, vxm_vtk_take, &source, error);
}

static vxm_status read_bits(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  if (rule != VXM_BITS_NONE)
    return vxm_raster_bits_of_file(out, read_field, input, rule, error);
  scan s = {.input = input};
  vxm_raster raster;
  vxm_about about;
  vxm_status status = read_header(&raster, &about, &s, error);
  return status == VXM_OK ? vxm_grid_create(out, input->context, &raster.space, error) : status;
}

static bool sniff(const vxm_input *input) {
  size_t front = input->size < 512 ? input->size : 512;
  return memmem(input->data, front, "<VTKFile", 8) != NULL;
}

/* ---- Writing ---- */

static void put_extent(vxm_output *output, const vxm_space *s) {
  vxm_output_printf(output, "\"0 %" PRId64 " 0 %" PRId64 " 0 %" PRId64 "\"", s->dims[0], s->dims[1],
                    s->dims[2]);
}

static void put_xml(vxm_values_writer *w) {
  const vxm_space *s = &w->space;
  const char *name = vxm_vtk_array_name(&w->values);
  vxm_output_printf(w->output,
                    "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" "
                    "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <ImageData WholeExtent=");
  put_extent(w->output, s);
  vxm_output_printf(w->output, " Origin=\"%.17g %.17g %.17g\" Spacing=\"%.17g %.17g %.17g\">\n", s->origin[0],
                    s->origin[1], s->origin[2], s->voxel_size[0], s->voxel_size[1], s->voxel_size[2]);
  vxm_output_printf(w->output, "    <Piece Extent=");
  put_extent(w->output, s);
  vxm_output_printf(w->output,
                    ">\n      <CellData Scalars=\"%s\">\n        <DataArray type=\"%s\" Name=\"%s\" "
                    "NumberOfComponents=\"%d\" format=\"appended\" offset=\"0\"/>\n      </CellData>\n"
                    "    </Piece>\n  </ImageData>\n  <AppendedData encoding=\"raw\">\n   _",
                    name, vxm_vtk_type_name(types, w->values.scalar), name, w->values.channels);
}

static vxm_status begin(vxm_values_writer *w, vxm_error *error) {
  (void)error;
  locale_t previous = uselocale(vxm_c_locale());
  put_xml(w);
  uselocale(previous);
  uint64_t bytes = vxm_le64(vxm_values_plain_bytes(&w->space, &w->values));
  vxm_output_write(w->output, &bytes, sizeof bytes);
  return VXM_OK;
}

static vxm_status end(vxm_values_writer *w, vxm_error *error) {
  (void)error;
  vxm_output_printf(w->output, "\n  </AppendedData>\n</VTKFile>\n");
  return VXM_OK;
}

static const vxm_values_writer_kind values_kind = {
    .layout = VXM_LAYOUT_GRID,
    .holds = VXM_HOLDS_ALL,
    .sidecar = &vxm_sidecar_labels,
    .stored = vxm_values_no_halves,
    .convert = vxm_values_widen_halves,
    .file_bytes = vxm_values_plain_bytes,
    .begin = begin,
    .end = end,
};

const vxm_grid_format vxm_format_vti = {
    .name = "vti",
    .holds = VXM_HOLDS_ALL,
    .sniff = sniff,
    .read = read_bits,
    .read_field = read_field,
    .values = &values_kind,
};
