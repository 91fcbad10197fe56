/* SPDX-License-Identifier: BSD-3-Clause */
/* .binvox: a text header, then pairs (value, count) over voxels with y fastest, then z, then x. */
#include "gridio/formats/binvox.h"
#include "base/c_locale.h"
#include "base/size_text.h"
#include "grid/bit_transpose.h"
#include "gridio/common/format.h"
#include "gridio/formats/rle_encoder.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool sniff(const vxm_input *input) {
  return input->size >= 7 && memcmp(input->data, "#binvox", 7) == 0;
}

/* ---- Reading the header ---- */

typedef struct header {
  int64_t dims[3]; /**< x, z, y: slowest first, as in the file */
  double translate[3];
  double scale;
  bool has_dims, has_translate, has_scale;
  bool is_of_trimesh; /**< a comment says so */
  size_t unknown;     /**< lines with a key that is not known */
  size_t dims_offset; /**< of the line */
  size_t data;        /**< offset of the first pair */
} header;

/** Splits a line into words; returns how many, at most `most`. A word too long to be a number becomes "". */
static int split(const unsigned char *line, size_t length, char words[][64], int most) {
  int count = 0;
  for (size_t at = 0; count < most;) {
    while (at < length && (line[at] == ' ' || line[at] == '\t' || line[at] == '\r'))
      at++;
    if (at == length)
      break;
    size_t used = 0;
    for (; at < length && line[at] != ' ' && line[at] != '\t' && line[at] != '\r'; at++, used++)
      if (used < 63)
        words[count][used] = (char)line[at];
    words[count++][used < 64 ? used : 0] = '\0';
  }
  return count;
}

static bool parse_integer(const char *word, int64_t *value) {
  char *end;
  errno = 0;
  *value = strtoll(word, &end, 10);
  return end != word && *end == '\0' && errno == 0;
}

/** A number with a decimal point whatever the locale. */
static bool parse_number(const char *word, double *value) {
  char *end;
  *value = strtod_l(word, &end, vxm_c_locale());
  return end != word && *end == '\0' && isfinite(*value);
}

static vxm_status read_dims(header *h, char words[][64], int count, const vxm_input *input, size_t offset,
                            vxm_error *error) {
  for (int a = 0; a < 3; a++)
    if (count != 4 || !parse_integer(words[a + 1], &h->dims[a]))
      return vxm_fail_byte(error, input, offset, "the dim line needs three whole numbers");
  h->has_dims = true;
  h->dims_offset = offset;
  return VXM_OK;
}

static vxm_status read_header_line(header *h, char words[][64], int count, const vxm_input *input,
                                   size_t offset, vxm_error *error) {
  if (strcmp(words[0], "dim") == 0)
    return read_dims(h, words, count, input, offset, error);
  if (strcmp(words[0], "translate") == 0) {
    for (int a = 0; a < 3; a++)
      if (count != 4 || !parse_number(words[a + 1], &h->translate[a]))
        return vxm_fail_byte(error, input, offset, "the translate line needs three finite numbers");
    h->has_translate = true;
  } else if (strcmp(words[0], "scale") == 0) {
    if (count != 2 || !parse_number(words[1], &h->scale) || h->scale <= 0)
      return vxm_fail_byte(error, input, offset, "the scale line needs one positive number");
    h->has_scale = true;
  } else
    h->unknown++;
  return VXM_OK;
}

static vxm_status read_header(header *h, const vxm_input *input, vxm_error *error) {
  *h = (header){.scale = 1};
  if (!sniff(input))
    return vxm_fail_byte(error, input, 0, "not a binvox file: it does not begin with \"#binvox\"");
  for (size_t at = 0; at < input->size;) {
    const unsigned char *line = input->data + at;
    const unsigned char *end = memchr(line, '\n', input->size - at);
    if (!end)
      break;
    char words[5][64];
    h->is_of_trimesh |= *line == '#' && memmem(line, (size_t)(end - line), "`trimesh`", 9) != NULL;
    int count = *line == '#' ? 0 : split(line, (size_t)(end - line), words, 5);
    size_t offset = at;
    at = (size_t)(end - input->data) + 1;
    if (count == 0)
      continue;
    if (strcmp(words[0], "data") == 0) {
      h->data = at;
      if (!h->has_dims)
        return vxm_fail_byte(error, input, offset, "the header has no dim line");
      return VXM_OK;
    }
    vxm_status status = read_header_line(h, words, count, input, offset, error);
    if (status != VXM_OK)
      return status;
  }
  return vxm_fail_byte(error, input, input->size, "the header has no data line");
}

/** Three different dims are x, z and y, the order in which the voxels vary; the scale is the longest side. */
static void header_space(const header *h, vxm_space *space) {
  int64_t longest = h->dims[0];
  for (int a = 1; a < 3; a++)
    longest = h->dims[a] > longest ? h->dims[a] : longest;
  const int source[3] = {0, 2, 1};
  for (int a = 0; a < 3; a++) {
    space->dims[a] = h->dims[source[a]];
    space->origin[a] = h->translate[a];
    space->voxel_size[a] = h->scale / (double)longest;
  }
}

/* ---- Reading the voxels ---- */

typedef struct oddities {
  bool odd; /**< a lone byte at the end */
  unsigned seen;
} oddities;

/** Adds up the counts before anything is allocated. */
static vxm_status check_runs(oddities *found, const vxm_input *input, size_t data, uint64_t voxels,
                             vxm_error *error) {
  const unsigned char *pairs = input->data + data;
  size_t pair_count = (input->size - data) / 2;
  uint64_t sum = 0;
  unsigned seen = 0;
  for (size_t p = 0; p < pair_count; p++) {
    unsigned value = pairs[2 * p];
    sum += pairs[2 * p + 1];
    if (pairs[2 * p + 1] > 0)
      seen |= value == 0     ? VXM_SEEN_ZERO
              : value == 1   ? VXM_SEEN_ONE
              : value == 255 ? VXM_SEEN_FULL
                             : VXM_SEEN_OTHER;
  }
  if (sum > voxels) {
    uint64_t before = 0;
    size_t p = 0;
    while (before + pairs[2 * p + 1] <= voxels)
      before += pairs[2 * p++ + 1];
    return vxm_fail_byte(error, input, data + 2 * p, "the runs go beyond the %" PRIu64 " voxels of the grid",
                         voxels);
  }
  if (sum < voxels)
    return vxm_fail_byte(error, input, input->size,
                         "the data end after %" PRIu64 " of %" PRIu64 " voxels: the file is cut short", sum,
                         voxels);
  *found = (oddities){(input->size - data) % 2 != 0, seen};
  return VXM_OK;
}

/** Where the next voxel lies: plane x % 64, row z, bit y. */
typedef struct cursor {
  size_t plane, row, bit;
} cursor;

/** Sets or skips `count` voxels, but not beyond the planes; returns how many are left. */
static unsigned advance(cursor *at, const vxm_bit_transpose *planes, size_t used, bool value,
                        unsigned count) {
  while (count > 0 && at->plane < used) {
    size_t room = planes->length - at->bit, step = count < room ? count : room;
    if (value)
      vxm_row_set_span(vxm_plane_row(planes, at->plane, at->row), (int64_t)at->bit,
                       (int64_t)(at->bit + step));
    count -= (unsigned)step;
    at->bit += step;
    if (at->bit < planes->length)
      break;
    at->bit = 0;
    if (++at->row == planes->rows) {
      at->row = 0;
      at->plane++;
    }
  }
  return count;
}

static vxm_status read_runs(vxm_grid *grid, const vxm_input *input, size_t data, vxm_error *error) {
  vxm_bit_transpose planes;
  vxm_status status =
      vxm_bit_transpose_create(&planes, grid->context, &grid->space, (vxm_layout)VXM_PLANE_Y_FAST, error);
  if (status != VXM_OK)
    return status;
  size_t at = data;
  unsigned left = 0; /* of the pair before `at` */
  for (size_t w = 0; status == VXM_OK && w < grid->row_words; w++) {
    cursor place = {0, 0, 0};
    size_t used = vxm_bit_transpose_in(grid, w);
    left = left ? advance(&place, &planes, used, input->data[at - 2] != 0, left) : 0;
    while (place.plane < used) {
      left = advance(&place, &planes, used, input->data[at] != 0, input->data[at + 1]);
      at += 2;
    }
    vxm_bit_transpose_scatter(&planes, grid, w);
    vxm_bit_transpose_clear(&planes);
    status = vxm_progress(grid->context, "reading", (double)(w + 1) / (double)grid->row_words, error);
  }
  vxm_bit_transpose_destroy(&planes);
  return status;
}

static void add_warnings(vxm_warnings *warnings, const header *h, const oddities *found) {
  if (!h->has_translate)
    vxm_warn(warnings, "the header has no translate line: 0 0 0 is taken");
  if (!h->has_scale)
    vxm_warn(warnings, "the header has no scale line: 1 is taken");
  if (h->unknown)
    vxm_warn(warnings, "%zu header line%s with an unknown key skipped", h->unknown,
             h->unknown == 1 ? "" : "s");
  if (h->dims[0] != h->dims[1] || h->dims[1] != h->dims[2])
    vxm_warn(warnings, "the dims differ: they are taken as x, z and y, slowest first");
  if (h->is_of_trimesh && h->dims[0] > 1)
    vxm_warn(warnings,
             "written by trimesh, which has its voxels scale / (dim - 1) apart and the centre of the first "
             "at translate: taken are scale / dim and its corner, as binvox has them; "
             "in Python, VoxelGrid.from_trimesh keeps their place");
  if (found->odd)
    vxm_warn(warnings, "a lone byte behind the last run is ignored");
}

/** All that stands before the voxels, and the sum of the runs. */
static vxm_status read_front(header *h, vxm_space *space, oddities *found, const vxm_input *input,
                             vxm_error *error) {
  vxm_status status = read_header(h, input, error);
  if (status != VXM_OK)
    return status;
  header_space(h, space);
  status = vxm_space_check_file(space, input, h->dims_offset, error);
  return status == VXM_OK ? check_runs(found, input, h->data, vxm_space_voxels(space), error) : status;
}

/** Version 2 is meant for labels, even if there is only one. */
static bool holds_labels(const vxm_input *input) {
  return input->size > 8 && input->data[7] == ' ' && input->data[8] == '2';
}

static vxm_status read_binvox(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  header h;
  vxm_space space;
  oddities found;
  vxm_grid *grid = NULL;
  const vxm_scalar_type byte = vxm_scalar_type_of('u', 1, false);
  vxm_status status = read_front(&h, &space, &found, input, error);
  bool is_meant = rule == VXM_BITS_STORED && holds_labels(input);
  if (status == VXM_OK && (is_meant || !vxm_seen_bits(found.seen, byte, rule)))
    status = vxm_fail_numbers(error, input->name, "labels");
  if (status == VXM_OK)
    status = vxm_grid_create(&grid, input->context, &space, error);
  if (status == VXM_OK)
    status = read_runs(grid, input, h.data, error);
  if (status != VXM_OK) {
    vxm_grid_destroy(grid);
    return status;
  }
  add_warnings(&grid->warnings, &h, &found);
  *out = grid;
  return VXM_OK;
}

/* ---- Labels ---- */

/** Fills a field of the cube, or of its near corner; false if a label lies outside of that. */
static bool fill_labels(vxm_field *field, const header *h, const vxm_input *input) {
  const int64_t *n = field->space.dims;
  const unsigned char *pair = input->data + h->data;
  int64_t at[3] = {0, 0, 0}; /* x, z, y */
  bool is_whole = true;
  for (; at[0] < h->dims[0]; pair += 2)
    for (unsigned left = pair[1]; left > 0; left--) {
      if (at[0] < n[0] && at[1] < n[2] && at[2] < n[1])
        field->values[(at[0] * n[1] + at[2]) * n[2] + at[1]] = pair[0];
      else if (pair[0] != 0)
        is_whole = false;
      if (++at[2] < h->dims[2])
        continue;
      at[2] = 0;
      if (++at[1] < h->dims[1])
        continue;
      at[1] = 0;
      at[0]++;
    }
  return is_whole;
}

/** Whether a space is one that would be padded to the cube of another, with its voxels in the same places. */
static bool is_padded(const vxm_space *space, const vxm_space *cube) {
  bool is_same = vxm_binvox_side(space) == (uint64_t)cube->dims[0];
  for (int a = 0; a < 3; a++) {
    double slack = 1e-6 * cube->voxel_size[a];
    is_same = is_same && fabs(space->voxel_size[a] - cube->voxel_size[a]) <= slack &&
              fabs(space->origin[a] - cube->origin[a]) <= slack + 1e-8 * fabs(cube->origin[a]);
  }
  return is_same;
}

static vxm_status read_labels(vxm_field **out, const vxm_space *space, const header *h, bool *is_whole,
                              const vxm_input *input, vxm_error *error) {
  vxm_status status = vxm_field_make(out, input->context, space, VXM_FIELD_LABELS, VXM_UINT8, error);
  if (status == VXM_OK)
    *is_whole = fill_labels(*out, h, input);
  return status;
}

static vxm_status read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  header h;
  vxm_space cube, beside;
  oddities found;
  vxm_field *field = NULL;
  vxm_about about = {.is_declared = false};
  bool is_whole = false;
  vxm_status status = read_front(&h, &cube, &found, input, error);
  if (status != VXM_OK)
    return status;
  if (vxm_sidecar_read_labels(&beside, &about, input) && is_padded(&beside, &cube))
    status = read_labels(&field, &beside, &h, &is_whole, input, error);
  if (status == VXM_OK && !is_whole) {
    vxm_field_destroy(field);
    status = read_labels(&field, &cube, &h, &is_whole, input, error);
  }
  if (status != VXM_OK) {
    vxm_about_destroy(&about);
    return status;
  }
  vxm_field_describe(field, &about);
  add_warnings(&field->warnings, &h, &found);
  return vxm_field_hand_over(out, field, vxm_progress(input->context, "reading", 1, error), error);
}

/* ---- Writing ---- */

uint64_t vxm_binvox_side(const vxm_space *space) {
  return (uint64_t)vxm_max(space->dims[0], vxm_max(space->dims[1], space->dims[2]));
}

/** One scale holds the size of all voxels, and all three sides. */
vxm_status vxm_binvox_check(const vxm_space *space, const char *path, vxm_error *error) {
  (void)path;
  const double *size = space->voxel_size;
  uint64_t side = vxm_binvox_side(space);
  if (fabs(size[1] - size[0]) > 1e-9 * size[0] || fabs(size[2] - size[0]) > 1e-9 * size[0])
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "binvox holds only voxels that are cubes, these are %g x %g x %g; use .npy, .raw or .rle",
                    size[0], size[1], size[2]);
  if (!isfinite(size[0] * (double)side))
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "the side of the grid is too long for binvox; use .npy, .raw or .rle");
  /* 2 bytes for 255 voxels of padding: a rod of a million voxels would become petabytes. */
  uint64_t padding = (side * side * side - vxm_space_voxels(space)) / 255 * 2;
  if (padding >> 34)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "binvox would pad this grid to a cube with %s; use .npy, .raw or .rle",
                    vxm_size_text_of(padding).text);
  return VXM_OK;
}

/** A slice of the cube: the rows of the grid, each followed by padding, then rows of padding. */
static vxm_rle_shape shape_of(const vxm_space *space) {
  uint64_t side = vxm_binvox_side(space), ny = (uint64_t)space->dims[1], nz = (uint64_t)space->dims[2];
  return (vxm_rle_shape){VXM_RUN_PAIRS, (size_t)ny, side - ny, (side - nz) * side};
}

static size_t state_bytes(const vxm_space *space) {
  vxm_rle_shape shape = shape_of(space);
  return vxm_rle_encoder_bytes(&shape, (uint64_t)space->dims[0] * (uint64_t)space->dims[2]);
}

void vxm_binvox_header_write(vxm_output *output, const vxm_space *space, int version) {
  uint64_t side = vxm_binvox_side(space);
  locale_t previous = uselocale(vxm_c_locale());
  vxm_output_printf(output,
                    "#binvox %d\ndim %" PRIu64 " %" PRIu64 " %" PRIu64 "\ntranslate %.9g %.9g %.9g\n"
                    "scale %.9g\ndata\n",
                    version, side, side, side, space->origin[0], space->origin[1], space->origin[2],
                    space->voxel_size[0] * (double)side);
  uselocale(previous);
}

static vxm_status begin(vxm_grid_writer *writer, vxm_error *error) {
  (void)error;
  const vxm_space *space = &writer->space;
  vxm_rle_shape shape = shape_of(space);
  writer->length = (int64_t)vxm_binvox_side(space);
  vxm_rle_encoder_begin(writer->state, &shape, (uint64_t)space->dims[0] * (uint64_t)space->dims[2]);
  vxm_binvox_header_write(writer->output, space, 1);
  return VXM_OK;
}

/** Writes a run, however long. */
static void put_run(vxm_output *output, unsigned value, uint64_t length) {
  while (length > 0) {
    unsigned count = length < 255 ? (unsigned)length : 255;
    unsigned char *pair = (unsigned char *)vxm_output_reserve(output, 2);
    pair[0] = (unsigned char)value;
    pair[1] = (unsigned char)count;
    vxm_output_advance(output, 2);
    length -= count;
  }
}

void vxm_binvox_put_slice(vxm_output *output, const vxm_space *space, const uint16_t *values) {
  uint64_t side = vxm_binvox_side(space), run = 0;
  size_t length = (size_t)space->dims[1], rows = (size_t)space->dims[2];
  unsigned value = values[0];
  for (size_t row = 0; row < rows; row++, values += length) {
    for (size_t i = 0; i < length; i++, run++)
      if (values[i] != value) {
        put_run(output, value, run);
        value = values[i];
        run = 0;
      }
    if (side == length)
      continue;
    if (value != 0) {
      put_run(output, value, run);
      value = 0;
      run = 0;
    }
    run += side - length;
  }
  put_run(output, value, run);
  put_run(output, 0, (side - rows) * side);
}

void vxm_binvox_put_end(vxm_output *output, const vxm_space *space) {
  uint64_t side = vxm_binvox_side(space);
  put_run(output, 0, (side - (uint64_t)space->dims[0]) * side * side);
}

/** The padding beyond the grid along x. */
static vxm_status end(vxm_grid_writer *writer, vxm_error *error) {
  uint64_t side = vxm_binvox_side(&writer->space);
  for (uint64_t x = (uint64_t)writer->space.dims[0]; x < side; x++) {
    vxm_rle_encoder_skip(writer, side * side);
    vxm_status status = vxm_grid_writer_step(writer, (double)(x + 1), error);
    if (status != VXM_OK)
      return status;
  }
  vxm_rle_encoder_end(writer);
  return VXM_OK;
}

uint64_t vxm_binvox_bytes(const vxm_space *space) {
  uint64_t side = vxm_binvox_side(space);
  return side * side * side / 255 * 2;
}

static const vxm_grid_writer_kind writer_kind = {
    .layout = VXM_PLANE_Y_FAST,
    .check = vxm_binvox_check,
    .state_bytes = state_bytes,
    .begin = begin,
    .put = vxm_rle_encoder_put,
    .end = end,
    .file_bytes = vxm_binvox_bytes,
};

const vxm_grid_format vxm_format_binvox = {
    .name = "binvox",
    .holds = VXM_HOLDS_BITS | VXM_HOLDS_LABELS,
    .sniff = sniff,
    .read = read_binvox,
    .read_field = read_field,
    .writer = &writer_kind,
    .values = &vxm_binvox_labels,
    .check_field = vxm_binvox_check_field,
};
