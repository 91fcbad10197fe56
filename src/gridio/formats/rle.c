/* SPDX-License-Identifier: BSD-3-Clause */
/** .rle: a fixed header with the transform, then one byte per run over voxels with x fastest. */
#include "base/endian.h"
#include "gridio/common/format.h"
#include "gridio/formats/rle_encoder.h"

#include <inttypes.h>
#include <string.h>

/* doc/formats.md: 8 bytes magic, 3 int64 dims, 3 double origin, 3 double voxel size. */
static const char magic[8] = {'V', 'X', 'M', 'R', 'L', 'E', '1', '\n'};

enum { HEADER = 80 };

static bool sniff(const vxm_input *input) {
  return input->size >= sizeof magic && memcmp(input->data, magic, sizeof magic) == 0;
}

/* ---- Reading ---- */

static vxm_status read_header(vxm_space *space, const vxm_input *input, vxm_error *error) {
  if (!sniff(input))
    return vxm_fail_byte(error, input, 0, "not an rle grid: it does not begin with \"VXMRLE1\"");
  if (input->size < HEADER)
    return vxm_fail_byte(error, input, input->size, "the file ends within its header of %d bytes", HEADER);
  for (int a = 0; a < 3; a++) {
    space->dims[a] = (int64_t)vxm_load_le64(input->data + 8 + 8 * a);
    space->origin[a] = vxm_load_double(input->data + 32 + 8 * a);
    space->voxel_size[a] = vxm_load_double(input->data + 56 + 8 * a);
  }
  return vxm_space_check_file(space, input, 8, error);
}

/** The runs must end exactly where the file ends; seen before anything is allocated. */
static vxm_status check_runs(const vxm_input *input, uint64_t voxels, vxm_error *error) {
  uint64_t sum = 0;
  for (size_t b = HEADER; b < input->size; b++)
    sum += input->data[b];
  if (sum < voxels)
    return vxm_fail_byte(error, input, input->size,
                         "the runs end after %" PRIu64 " of %" PRIu64 " voxels: the file is cut short", sum,
                         voxels);
  if (sum == voxels && input->data[input->size - 1] != 0)
    return VXM_OK;
  size_t b = HEADER;
  for (sum = 0; sum < voxels; b++) {
    if (sum + input->data[b] > voxels)
      return vxm_fail_byte(error, input, b, "the runs go beyond the %" PRIu64 " voxels of the grid", voxels);
    sum += input->data[b];
  }
  return vxm_fail_byte(error, input, b, "%zu bytes behind the last run", input->size - b);
}

/** Sets voxels from the word pointed at on, row after row; rows are padded, so a run is cut at row ends. */
typedef struct cursor {
  uint64_t *row;
  size_t bit;
} cursor;

static inline void advance(cursor *at, const vxm_grid *grid, bool value, size_t count) {
  size_t length = (size_t)grid->space.dims[0];
  while (count > 0) {
    size_t room = length - at->bit, step = count < room ? count : room;
    if (value)
      vxm_row_set_span(at->row, (int64_t)at->bit, (int64_t)(at->bit + step));
    count -= step;
    at->bit += step;
    if (at->bit == length)
      *at = (cursor){at->row + grid->row_words, 0};
  }
}

static vxm_status read_runs(vxm_grid *grid, const vxm_input *input, vxm_error *error) {
  enum { PIECE = 1 << 22 };
  cursor at = {grid->words, 0};
  bool value = false;
  for (size_t begin = HEADER; begin < input->size; begin += PIECE) {
    size_t end = input->size - begin < PIECE ? input->size : begin + PIECE;
    for (size_t b = begin; b < end; b++) {
      advance(&at, grid, value, input->data[b]);
      value ^= input->data[b] != 255;
    }
    vxm_status status = vxm_progress(grid->context, "reading", (double)end / (double)input->size, error);
    if (status != VXM_OK)
      return status;
  }
  return VXM_OK;
}

static vxm_status read_rle(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  (void)rule;
  vxm_space space;
  vxm_status status = read_header(&space, input, error);
  if (status == VXM_OK)
    status = check_runs(input, vxm_space_voxels(&space), error);
  vxm_grid *grid = NULL;
  if (status == VXM_OK)
    status = vxm_grid_create(&grid, input->context, &space, error);
  if (status == VXM_OK)
    status = read_runs(grid, input, error);
  if (status != VXM_OK) {
    vxm_grid_destroy(grid);
    return status;
  }
  *out = grid;
  return VXM_OK;
}

/* ---- Writing ---- */

static uint64_t row_count(const vxm_space *space) {
  return (uint64_t)space->dims[1] * (uint64_t)space->dims[2];
}

static size_t state_bytes(const vxm_space *space) {
  vxm_rle_shape shape = {VXM_RUN_BYTES, (size_t)space->dims[0], 0, 0};
  return vxm_rle_encoder_bytes(&shape, row_count(space));
}

static vxm_status begin(vxm_grid_writer *writer, vxm_error *error) {
  (void)error;
  const vxm_space *space = &writer->space;
  vxm_rle_shape shape = {VXM_RUN_BYTES, (size_t)space->dims[0], 0, 0};
  vxm_rle_encoder_begin(writer->state, &shape, row_count(space));
  unsigned char header[HEADER];
  memcpy(header, magic, sizeof magic);
  for (int a = 0; a < 3; a++) {
    vxm_store_le64(header + 8 + 8 * a, (uint64_t)space->dims[a]);
    vxm_store_double(header + 32 + 8 * a, space->origin[a]);
    vxm_store_double(header + 56 + 8 * a, space->voxel_size[a]);
  }
  vxm_output_write(writer->output, header, sizeof header);
  return VXM_OK;
}

static vxm_status end(vxm_grid_writer *writer, vxm_error *error) {
  (void)error;
  vxm_rle_encoder_end(writer);
  return VXM_OK;
}

static const vxm_grid_writer_kind writer_kind = {
    .layout = VXM_LAYOUT_GRID,
    .state_bytes = state_bytes,
    .begin = begin,
    .put = vxm_rle_encoder_put,
    .end = end,
};

const vxm_grid_format vxm_format_rle = {
    .name = "rle",
    .holds = VXM_HOLDS_BITS,
    .sniff = sniff,
    .read = read_rle,
    .writer = &writer_kind,
};
