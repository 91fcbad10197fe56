/* SPDX-License-Identifier: BSD-3-Clause */
/** .raw: one bit per voxel, x fastest, nothing else; a JSON file beside it holds dims and transform. */
#include "base/threads.h"
#include "gridio/bytes.h"
#include "gridio/format.h"
#include "gridio/sidecar.h"

#include <inttypes.h>

static const vxm_sidecar_text description = {"voxmend raw", "x fastest, then y, then z",
                                             "least significant first"};

/** Any bytes may be a raw grid: what tells is the name, with the JSON beside it. */
static bool sniff(const vxm_input *input) {
  return vxm_text_equal_nocase(vxm_path_extension(input->name), "raw") && vxm_sidecar_exists(input->name);
}

/* ---- Reading ---- */

enum { ROWS_PER_TASK = 256, ROWS_PER_STEP = 1 << 18 };

typedef struct unpacking {
  vxm_grid *grid;
  const vxm_input *input;
  size_t row, rows; /**< those of this step */
} unpacking;

/** The 64 bits from bit `at` on; beyond the end of the file they are 0. */
static uint64_t load_bits(const vxm_input *input, uint64_t at) {
  size_t byte = (size_t)(at / 8);
  unsigned shift = (unsigned)(at % 8);
  unsigned char tail[16] = {0};
  const unsigned char *from = input->data + byte;
  if (input->size - byte < 9) {
    memcpy(tail, from, input->size - byte);
    from = tail;
  }
  uint64_t word = vxm_load_le64(from) >> shift;
  return shift ? word | (uint64_t)from[8] << (64 - shift) : word;
}

static void unpack_rows(size_t task, int worker, void *payload) {
  (void)worker;
  const unpacking *u = payload;
  vxm_grid *grid = u->grid;
  uint64_t nx = (uint64_t)grid->space.dims[0];
  size_t begin = task * ROWS_PER_TASK,
         end = begin + ROWS_PER_TASK < u->rows ? begin + ROWS_PER_TASK : u->rows;
  for (size_t r = u->row + begin; r < u->row + end; r++) {
    uint64_t *row = grid->words + r * grid->row_words;
    for (size_t w = 0; w < grid->row_words; w++)
      row[w] = load_bits(u->input, r * nx + w * 64);
    row[grid->row_words - 1] &= vxm_grid_tail_mask(grid);
  }
}

static vxm_status check_length(const vxm_input *input, uint64_t voxels, vxm_error *error) {
  uint64_t bytes = (voxels + 7) / 8;
  if (input->size < bytes)
    return vxm_fail_byte(error, input, input->size,
                         "the file is cut short: %" PRIu64 " voxels take %" PRIu64 " bytes", voxels, bytes);
  if (input->size > bytes)
    return vxm_fail_byte(error, input, bytes, "%" PRIu64 " bytes too many: %" PRIu64 " voxels take %" PRIu64,
                         input->size - bytes, voxels, bytes);
  if (voxels % 8 != 0 && input->data[bytes - 1] >> (voxels % 8) != 0)
    return vxm_fail_byte(error, input, bytes - 1, "the bits behind the last voxel are not 0");
  return VXM_OK;
}

static vxm_status read_raw(vxm_grid **out, const vxm_input *input, vxm_error *error) {
  vxm_space space;
  if (!vxm_sidecar_exists(input->name))
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){input->name, 0, -1, -1},
                       "a raw grid needs the file of the same name with .json added, which holds its dims");
  vxm_status status = vxm_sidecar_read(&space, input->context, input->name, description.format, error);
  if (status == VXM_OK)
    status = check_length(input, vxm_space_voxels(&space), error);
  vxm_grid *grid = NULL;
  if (status == VXM_OK)
    status = vxm_grid_create(&grid, input->context, &space, error);
  if (status != VXM_OK)
    return status;
  size_t rows = grid->word_count / grid->row_words;
  for (size_t row = 0; status == VXM_OK && row < rows; row += ROWS_PER_STEP) {
    unpacking u = {grid, input, row, rows - row < ROWS_PER_STEP ? rows - row : ROWS_PER_STEP};
    vxm_parallel(grid->context, (u.rows + ROWS_PER_TASK - 1) / ROWS_PER_TASK, unpack_rows, &u);
    status = vxm_progress(grid->context, "reading", (double)(row + u.rows) / (double)rows, error);
  }
  if (status != VXM_OK) {
    vxm_grid_destroy(grid);
    return status;
  }
  *out = grid;
  return VXM_OK;
}

/* ---- Writing ---- */

/** Bits that do not fill a word yet, and the words that wait in the output's buffer. */
typedef struct packer {
  vxm_output *output;
  unsigned char *room;
  size_t used;
  uint64_t pending;
  unsigned bits; /**< of pending, below 64 */
} packer;

enum { ROOM = 4096 };

static void put_word(packer *p, uint64_t word) {
  if (p->used == ROOM) {
    vxm_output_advance(p->output, p->used);
    p->room = (unsigned char *)vxm_output_reserve(p->output, ROOM);
    p->used = 0;
  }
  vxm_store_le64(p->room + p->used, word);
  p->used += 8;
}

/** Appends the `count` low bits of a word whose other bits are 0; 1 to 64. */
static void put_bits(packer *p, uint64_t word, unsigned count) {
  p->pending |= word << p->bits;
  if (p->bits + count < 64) {
    p->bits += count;
    return;
  }
  put_word(p, p->pending);
  p->pending = p->bits ? word >> (64 - p->bits) : 0;
  p->bits = p->bits + count - 64;
}

static vxm_status write_rows(vxm_output *output, const vxm_grid *grid, vxm_error *error) {
  packer p = {output, (unsigned char *)vxm_output_reserve(output, ROOM), 0, 0, 0};
  size_t rows = grid->word_count / grid->row_words;
  unsigned tail = (unsigned)((grid->space.dims[0] - 1) % 64 + 1);
  for (size_t r = 0; r < rows && !vxm_output_failed(output); r++) {
    const uint64_t *row = grid->words + r * grid->row_words;
    for (size_t w = 0; w + 1 < grid->row_words; w++)
      put_bits(&p, row[w], 64);
    put_bits(&p, row[grid->row_words - 1], tail);
    if (r % 65536 != 0)
      continue;
    vxm_status status = vxm_progress(grid->context, "writing", (double)r / (double)rows, error);
    if (status != VXM_OK)
      return status;
  }
  vxm_output_advance(output, p.used);
  unsigned char last[8];
  vxm_store_le64(last, p.pending);
  vxm_output_write(output, last, (p.bits + 7) / 8);
  return VXM_OK;
}

static vxm_status write_raw(const vxm_grid *grid, const char *path, vxm_error *error) {
  if (strcmp(path, "-") == 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "raw needs a file, since its dims go into another beside it; use binvox, npy or rle");
  vxm_output *output = NULL, *sidecar = NULL;
  vxm_status status = vxm_output_open(&output, grid->context, path, error);
  if (status == VXM_OK)
    status = vxm_sidecar_open(&sidecar, grid, path, &description, error);
  if (status == VXM_OK)
    status = write_rows(output, grid, error);
  if (status == VXM_OK)
    return vxm_sidecar_commit(output, sidecar, path, error);
  vxm_output_abort(sidecar);
  vxm_output_abort(output);
  return status;
}

const vxm_grid_format vxm_format_raw = {"raw", sniff, read_raw, write_raw};
