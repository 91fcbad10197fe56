/* SPDX-License-Identifier: BSD-3-Clause */
/** .raw: one bit per voxel, x fastest, nothing else; a JSON file beside it holds dims and transform. */
#include "base/endian.h"
#include "base/threads.h"
#include "gridio/common/format.h"
#include "gridio/common/sidecar.h"

#include <inttypes.h>

static const vxm_sidecar_text description = {"voxmend raw", "x fastest, then y, then z",
                                             "least significant first"};

/** By the name and the JSON beside it: the bytes could be anything. */
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

static vxm_status read_raw(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  (void)rule;
  vxm_space space;
  if (!vxm_sidecar_exists(input->name))
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){input->name, 0, -1, -1},
                       "a raw grid needs the file of the same name with .json added, which holds its dims");
  vxm_status status = vxm_sidecar_read(&space, NULL, input->context, input->name, description.format, error);
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

/** The bits that do not fill a word yet. */
typedef struct packer {
  uint64_t pending;
  unsigned bits; /**< of pending, below 64 */
} packer;

/** Words that wait in the output's buffer. */
typedef struct sink {
  vxm_output *output;
  unsigned char *room;
  size_t used;
} sink;

enum { ROOM = 4096 };

static void put_word(sink *s, uint64_t word) {
  if (s->used == ROOM) {
    vxm_output_advance(s->output, s->used);
    s->room = (unsigned char *)vxm_output_reserve(s->output, ROOM);
    s->used = 0;
  }
  vxm_store_le64(s->room + s->used, word);
  s->used += 8;
}

/** Appends the `count` low bits of a word whose other bits are 0; 1 to 64. */
static inline void put_bits(packer *p, sink *s, uint64_t word, unsigned count) {
  p->pending |= word << p->bits;
  if (p->bits + count < 64) {
    p->bits += count;
    return;
  }
  put_word(s, p->pending);
  p->pending = p->bits ? word >> (64 - p->bits) : 0;
  p->bits = p->bits + count - 64;
}

static void put_rows(packer *p, vxm_output *output, const vxm_window *window, int64_t slow, int64_t begin,
                     int64_t end) {
  sink s = {output, (unsigned char *)vxm_output_reserve(output, ROOM), 0};
  unsigned tail = (unsigned)((window->fast_dim - 1) % 64 + 1);
  for (int64_t middle = begin; middle < end; middle++) {
    const uint64_t *row = vxm_window_row(window, middle, slow);
    for (size_t w = 0; w + 1 < window->row_words; w++)
      put_bits(p, &s, row[w], 64);
    put_bits(p, &s, row[window->row_words - 1], tail);
  }
  vxm_output_advance(output, s.used);
}

/** Rows of whole words lie in the file as in memory, where that has the file's byte order. */
static bool is_plain(const vxm_window *window) {
  return window->fast_dim % 64 == 0 && vxm_le64(1) == 1;
}

static vxm_status put(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error) {
  enum { WORDS_PER_STEP = 1 << 19 };
  int64_t rows = window->middle_dim, some = WORDS_PER_STEP / (int64_t)window->row_words;
  size_t words = 0; /* since the last step */
  vxm_status status = VXM_OK;
  for (int64_t slow = window->begin; status == VXM_OK && slow < window->end; slow++)
    for (int64_t begin = 0, end; status == VXM_OK && begin < rows; begin = end) {
      end = vxm_min(begin + some, rows);
      if (is_plain(window))
        vxm_output_write(writer->output, vxm_window_row(window, begin, slow),
                         (size_t)(end - begin) * window->row_words * 8);
      else
        put_rows(writer->state, writer->output, window, slow, begin, end);
      words += (size_t)(end - begin) * window->row_words;
      bool last = slow + 1 == window->end && end == rows;
      if (words < WORDS_PER_STEP && !last)
        continue;
      words = 0;
      status = vxm_grid_writer_step(writer, (double)slow + (double)end / (double)rows, error);
    }
  return status;
}

static vxm_status check_path(const vxm_space *space, const char *path, vxm_error *error) {
  (void)space;
  if (strcmp(path, "-") != 0)
    return VXM_OK;
  return vxm_fail(error, VXM_ERROR_ARGUMENT,
                  "raw needs a file, since its dims go into another beside it; use binvox, npy or rle");
}

static size_t state_bytes(const vxm_space *space) {
  (void)space;
  return sizeof(packer);
}

static vxm_status begin(vxm_grid_writer *writer, vxm_error *error) {
  (void)error;
  *(packer *)writer->state = (packer){0, 0};
  return VXM_OK;
}

static vxm_status end(vxm_grid_writer *writer, vxm_error *error) {
  (void)error;
  const packer *p = writer->state;
  unsigned char last[8];
  vxm_store_le64(last, p->pending);
  vxm_output_write(writer->output, last, (p->bits + 7) / 8);
  return VXM_OK;
}

static uint64_t file_bytes(const vxm_space *space) {
  return (vxm_space_voxels(space) + 7) / 8;
}

static const vxm_grid_writer_kind writer_kind = {
    .layout = VXM_LAYOUT_GRID,
    .sidecar = &description,
    .check = check_path,
    .state_bytes = state_bytes,
    .begin = begin,
    .put = put,
    .end = end,
    .file_bytes = file_bytes,
};

const vxm_grid_format vxm_format_raw = {
    .name = "raw",
    .holds = VXM_HOLDS_BITS,
    .sniff = sniff,
    .is_told_by_name = true,
    .read = read_raw,
    .writer = &writer_kind,
};
