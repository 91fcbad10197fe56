/* SPDX-License-Identifier: BSD-3-Clause */
/** .vtk: an image in VTK's older format, lines of text with big-endian values behind them. */
#include "base/c_locale.h"
#include "base/endian.h"
#include "gridio/formats/vtk_image.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** VTK's names of the types. */
static const vxm_vtk_type types[] = {{"unsigned_char", VXM_UINT8}, {"signed_char", VXM_INT8},
                                     {"char", VXM_INT8},           {"unsigned_short", VXM_UINT16},
                                     {"short", VXM_INT16},         {"unsigned_int", VXM_UINT32},
                                     {"int", VXM_INT32},           {"vtktypeuint64", VXM_UINT64},
                                     {"vtktypeint64", VXM_INT64},  {"unsigned_long", VXM_UINT64},
                                     {"long", VXM_INT64},          {"float", VXM_FLOAT32},
                                     {"double", VXM_FLOAT64},      {NULL, VXM_UINT8}};

enum { LINE_MAX_BYTES = 256, LINES_MAX = 64 };

static const char signature[] = "# vtk DataFile Version";

static bool is_swapped(void) {
  return vxm_le64(1) == 1;
}

/* ---- Reading ---- */

/** A header on its way in, line after line. */
typedef struct scan {
  const vxm_input *input;
  size_t at;
  char line[LINE_MAX_BYTES];
  vxm_vtk_image image;
  bool has_dims, has_data, has_array;
  double cells; /**< or points, as the file says */
} scan;

/** The next line, cut, without its end; false at the end of the file. */
static bool next_line(scan *s) {
  const unsigned char *from = s->input->data + s->at;
  size_t left = s->input->size - s->at;
  if (left == 0)
    return false;
  const unsigned char *end = memchr(from, '\n', left < 4096 ? left : 4096);
  if (!end)
    return false;
  size_t length = (size_t)(end - from), kept = length < LINE_MAX_BYTES ? length : LINE_MAX_BYTES - 1;
  memcpy(s->line, from, kept);
  s->line[kept] = '\0';
  s->line[strcspn(s->line, "\r")] = '\0';
  s->at += length + 1;
  return true;
}

static bool begins(const char *line, const char *word) {
  size_t length = strlen(word);
  for (size_t c = 0; c < length; c++)
    if ((line[c] | 0x20) != (word[c] | 0x20))
      return false;
  return line[length] == ' ' || line[length] == '\0';
}

static vxm_status fail_line(const scan *s, const char *why, vxm_error *error) {
  return vxm_fail_byte(error, s->input, s->at, "%s", why);
}

static vxm_status take_numbers(const scan *s, double numbers[3], vxm_error *error) {
  const char *from = strchr(s->line, ' ');
  for (int a = 0; a < 3; a++) {
    char *end = NULL;
    numbers[a] = from ? strtod(from, &end) : 0;
    if (!from || end == from)
      return fail_line(s, "three numbers are expected before this", error);
    from = end;
  }
  return VXM_OK;
}

static vxm_status take_dims(scan *s, vxm_error *error) {
  double dims[3];
  vxm_status status = take_numbers(s, dims, error);
  for (int a = 0; a < 3 && status == VXM_OK; a++) {
    if (!(dims[a] >= 1 && dims[a] <= 0x1p31))
      return fail_line(s, "its dimensions are none of an image", error);
    s->image.points[a] = (int64_t)dims[a];
  }
  s->has_dims = true;
  return status;
}

static vxm_status take_type(scan *s, const char *name, vxm_error *error) {
  s->has_array = vxm_vtk_type_find(&s->image.scalar, types, name);
  return s->has_array ? VXM_OK
                      : vxm_fail_byte(error, s->input, s->at,
                                      "its values are of the type \"%.40s\"; numbers are expected", name);
}

/** "SCALARS name type [components]", and the line of the table behind it. */
static vxm_status take_scalars(scan *s, vxm_error *error) {
  char type[64] = "";
  s->image.components = 1;
  if (sscanf(s->line, "%*s %63s %63s %d", s->image.name, type, &s->image.components) < 2)
    return fail_line(s, "SCALARS without a name and a type", error);
  vxm_status status = take_type(s, type, error);
  size_t behind = s->at;
  if (status == VXM_OK && (!next_line(s) || !begins(s->line, "LOOKUP_TABLE")))
    s->at = behind;
  return status;
}

static vxm_status take_colors(scan *s, vxm_error *error) {
  s->image.scalar = VXM_UINT8;
  s->has_array = true;
  if (sscanf(s->line, "%*s %63s %d", s->image.name, &s->image.components) < 2)
    return fail_line(s, "COLOR_SCALARS without a name and a number", error);
  return VXM_OK;
}

static vxm_status take_line(scan *s, vxm_error *error) {
  if (begins(s->line, "DIMENSIONS"))
    return take_dims(s, error);
  if (begins(s->line, "ORIGIN"))
    return take_numbers(s, s->image.origin, error);
  if (begins(s->line, "SPACING") || begins(s->line, "ASPECT_RATIO"))
    return take_numbers(s, s->image.spacing, error);
  if (begins(s->line, "CELL_DATA") || begins(s->line, "POINT_DATA")) {
    s->image.is_points = begins(s->line, "POINT_DATA");
    s->has_data = true;
    return VXM_OK;
  }
  if (begins(s->line, "SCALARS"))
    return take_scalars(s, error);
  if (begins(s->line, "COLOR_SCALARS"))
    return take_colors(s, error);
  if (*s->line == '\0' || begins(s->line, "METADATA") || begins(s->line, "INFORMATION"))
    return VXM_OK;
  return vxm_fail_byte(error, s->input, s->at, "\"%.40s\" is not expected in an image of one array", s->line);
}

static vxm_status take_front(scan *s, vxm_error *error) {
  if (!next_line(s) || strncmp(s->line, signature, strlen(signature)) != 0 || !next_line(s) || !next_line(s))
    return fail_line(s, "not a file of VTK", error);
  if (!begins(s->line, "BINARY"))
    return fail_line(s, "its values are text; write the file as binary", error);
  if (!next_line(s) || !begins(s->line, "DATASET") || !strstr(s->line, "STRUCTURED_POINTS"))
    return fail_line(s, "it is not an image (DATASET STRUCTURED_POINTS)", error);
  return VXM_OK;
}

static vxm_status take_header(scan *s, vxm_error *error) {
  vxm_status status = take_front(s, error);
  for (int l = 0; status == VXM_OK && !s->has_array; l++) {
    if (l == LINES_MAX || !next_line(s))
      return fail_line(s, "it ends before the values", error);
    status = take_line(s, error);
  }
  if (status == VXM_OK && (!s->has_dims || !s->has_data))
    status = fail_line(s, "DIMENSIONS or CELL_DATA are missing before the values", error);
  return status;
}

/** Reads the header by the numbers of the locale "C". */
static vxm_status read_header(vxm_raster *raster, vxm_about *about, scan *s, vxm_error *error) {
  locale_t previous = uselocale(vxm_c_locale());
  for (int a = 0; a < 3; a++)
    s->image.spacing[a] = 1;
  vxm_status status = take_header(s, error);
  uselocale(previous);
  if (status == VXM_OK)
    status = vxm_vtk_raster(raster, about, &s->image, s->input, s->at, error);
  if (status != VXM_OK)
    return status;
  raster->is_swapped = is_swapped();
  if (vxm_raster_bytes(raster) > s->input->size - s->at)
    return vxm_fail_byte(error, s->input, s->input->size,
                         "the file is cut short: %" PRIu64 " voxels are not in it",
                         vxm_space_voxels(&raster->space));
  return VXM_OK;
}

static vxm_status read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  scan s = {.input = input};
  vxm_raster raster;
  vxm_about about;
  vxm_status status = read_header(&raster, &about, &s, error);
  if (status != VXM_OK)
    return status;
  vxm_vtk_source source = {input->data + s.at};
  vxm_sidecar_take_labels(&about, raster.space.dims, input);
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
  return input->size > strlen(signature) && memcmp(input->data, signature, strlen(signature)) == 0;
}

/* ---- Writing ---- */

static vxm_status begin(vxm_values_writer *w, vxm_error *error) {
  (void)error;
  const vxm_space *s = &w->space;
  const char *name = vxm_vtk_array_name(&w->values);
  locale_t previous = uselocale(vxm_c_locale());
  vxm_output_printf(w->output, "%s 3.0\nvoxmend\nBINARY\nDATASET STRUCTURED_POINTS\n", signature);
  vxm_output_printf(w->output, "DIMENSIONS %" PRId64 " %" PRId64 " %" PRId64 "\n", s->dims[0] + 1,
                    s->dims[1] + 1, s->dims[2] + 1);
  vxm_output_printf(w->output, "ORIGIN %.17g %.17g %.17g\n", s->origin[0], s->origin[1], s->origin[2]);
  vxm_output_printf(w->output, "SPACING %.17g %.17g %.17g\n", s->voxel_size[0], s->voxel_size[1],
                    s->voxel_size[2]);
  vxm_output_printf(w->output, "CELL_DATA %" PRIu64 "\n", vxm_space_voxels(s));
  if (w->values.channels == 4)
    vxm_output_printf(w->output, "COLOR_SCALARS %s 4\n", name);
  else
    vxm_output_printf(w->output, "SCALARS %s %s 1\nLOOKUP_TABLE default\n", name,
                      vxm_vtk_type_name(types, w->values.scalar));
  uselocale(previous);
  return VXM_OK;
}

/** Writes numbers with their last byte first. */
static void put_swapped(vxm_output *output, const unsigned char *from, size_t count, size_t size) {
  enum { ROOM = 4096 };
  while (count > 0) {
    size_t some = count < ROOM / size ? count : ROOM / size;
    unsigned char *to = (unsigned char *)vxm_output_reserve(output, ROOM);
    for (size_t v = 0; v < some; v++)
      for (size_t b = 0; b < size; b++)
        to[v * size + b] = from[v * size + size - 1 - b];
    vxm_output_advance(output, some * size);
    from += some * size;
    count -= some;
  }
}

static void put_bytes(vxm_values_writer *w, const void *bytes, size_t count) {
  size_t size = vxm_scalar_bytes(w->values.scalar);
  if (size > 1)
    put_swapped(w->output, bytes, count / size, size);
  else
    vxm_output_write(w->output, bytes, count);
}

static vxm_status end(vxm_values_writer *w, vxm_error *error) {
  (void)error;
  vxm_output_write(w->output, "\n", 1);
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
    .put_bytes = put_bytes,
    .end = end,
};

const vxm_grid_format vxm_format_vtk = {
    .name = "vtk",
    .holds = VXM_HOLDS_ALL,
    .sniff = sniff,
    .read = read_bits,
    .read_field = read_field,
    .values = &values_kind,
};
