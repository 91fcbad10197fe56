/* SPDX-License-Identifier: BSD-3-Clause */
/** .npy: an array [x][y][z] of numpy. It holds no transform: that goes into a JSON file beside it. */
#include "base/threads.h"
#include "gridio/bytes.h"
#include "gridio/format.h"
#include "gridio/npy_header.h"
#include "gridio/planes.h"
#include "gridio/sidecar.h"

#include <inttypes.h>

static const vxm_sidecar_text description = {"voxmend npy", "z fastest, then y, then x", NULL};

enum { ROWS_PER_TASK = 64, ROWS_PER_STEP = 1 << 16 };

/* ---- Reading ---- */

/** What of an element makes it nonzero: all bytes, but for the sign of a floating-point number (-0 is 0). */
typedef struct element {
  size_t size;
  uint64_t mask; /**< over the bytes as they lie in the file, the first lowest */
} element;

static element element_of(const vxm_npy_header *h) {
  element e = {h->size, vxm_low_bits((unsigned)h->size * 8)};
  if (h->kind == 'f')
    e.mask &= ~(UINT64_C(0x80) << (h->big_endian ? 0 : 8 * (h->size - 1)));
  return e;
}

/** Bits of up to 64 consecutive elements; `size` is a constant where this is inlined. */
static inline __attribute__((always_inline)) uint64_t pack_elements(const unsigned char *from, size_t size,
                                                                    uint64_t mask, size_t count) {
  uint64_t word = 0;
  for (size_t n = 0; n < count; n++) {
    uint64_t value = 0;
    memcpy(&value, from + n * size, size);
    word |= (uint64_t)((vxm_le64(value) & mask) != 0) << n;
  }
  return word;
}

static uint64_t pack_word(const unsigned char *from, element e, size_t count) {
  if (e.size == 8)
    return pack_elements(from, 8, e.mask, count);
  if (e.size == 4)
    return pack_elements(from, 4, e.mask, count);
  if (e.size == 2)
    return pack_elements(from, 2, e.mask, count);
  uint64_t word = 0;
  size_t n = 0;
  for (; n + 8 <= count; n += 8)
    word |= vxm_pack_bytes(vxm_nonzero_bytes(vxm_load_le64(from + n))) << n;
  return n < count ? word | pack_elements(from + n, 1, e.mask, count - n) << n : word;
}

typedef struct loading {
  const unsigned char *data; /**< of row 0 of this step */
  element e;
  size_t rows, length;
  const vxm_planes *planes; /**< NULL: rows of the grid itself, from `words` on */
  uint64_t *words;
  size_t row_words;
} loading;

static void load_rows(size_t task, int worker, void *payload) {
  (void)worker;
  const loading *l = payload;
  size_t begin = task * ROWS_PER_TASK,
         end = begin + ROWS_PER_TASK < l->rows ? begin + ROWS_PER_TASK : l->rows;
  for (size_t r = begin; r < end; r++) {
    uint64_t *row = l->planes ? vxm_plane_row(l->planes, r / l->planes->rows, r % l->planes->rows)
                              : l->words + r * l->row_words;
    const unsigned char *from = l->data + r * l->length * l->e.size;
    for (size_t n = 0; n < l->length; n += 64)
      row[n / 64] = pack_word(from + n * l->e.size, l->e, l->length - n < 64 ? l->length - n : 64);
  }
}

static void load_step(vxm_grid *grid, loading *l) {
  vxm_parallel(grid->context, (l->rows + ROWS_PER_TASK - 1) / ROWS_PER_TASK, load_rows, l);
}

/** C order: z fastest and x slowest, through planes. */
static vxm_status read_c_order(vxm_grid *grid, const unsigned char *data, element e, vxm_error *error) {
  vxm_planes planes;
  vxm_status status =
      vxm_planes_create(&planes, grid->context, &grid->space, (vxm_layout)VXM_PLANE_Z_FAST, error);
  if (status != VXM_OK)
    return status;
  for (size_t w = 0; status == VXM_OK && w < grid->row_words; w++) {
    loading l = {data, e, vxm_planes_in(grid, w) * planes.rows, planes.length, &planes, NULL, 0};
    load_step(grid, &l);
    data += l.rows * l.length * e.size;
    vxm_planes_scatter(&planes, grid, w);
    status = vxm_progress(grid->context, "reading", (double)(w + 1) / (double)grid->row_words, error);
  }
  vxm_planes_destroy(&planes);
  return status;
}

/** Fortran order: x fastest, as in the grid. */
static vxm_status read_fortran_order(vxm_grid *grid, const unsigned char *data, element e, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t rows = grid->word_count / grid->row_words, length = (size_t)grid->space.dims[0];
  for (size_t row = 0; status == VXM_OK && row < rows; row += ROWS_PER_STEP) {
    loading l = {data + row * length * e.size,
                 e,
                 rows - row < ROWS_PER_STEP ? rows - row : ROWS_PER_STEP,
                 length,
                 NULL,
                 grid->words + row * grid->row_words,
                 grid->row_words};
    load_step(grid, &l);
    status = vxm_progress(grid->context, "reading", (double)(row + l.rows) / (double)rows, error);
  }
  return status;
}

/** The transform from the JSON, if there is one and it is of this array. */
static void find_space(vxm_space *space, const vxm_input *input, vxm_notes *notes) {
  for (int a = 0; a < 3; a++) {
    space->origin[a] = 0;
    space->voxel_size[a] = 1;
  }
  bool is_file = input->mapping || strcmp(input->name, "<stdin>") != 0;
  if (!is_file || !vxm_sidecar_exists(input->name)) {
    vxm_note(notes, "no .json beside the array: origin 0 0 0 and voxel size 1 are taken");
    return;
  }
  vxm_space beside;
  vxm_error why = VXM_ERROR_INIT;
  if (vxm_sidecar_read(&beside, input->context, input->name, description.format, &why) != VXM_OK)
    vxm_note(notes, "origin 0 0 0 and voxel size 1 are taken: %s", why.text);
  else if (memcmp(beside.dims, space->dims, sizeof space->dims) != 0)
    vxm_note(notes, "origin 0 0 0 and voxel size 1 are taken: the .json beside the array has other dims");
  else
    *space = beside;
}

static vxm_status check_length(const vxm_npy_header *h, const vxm_space *space, const vxm_input *input,
                               vxm_notes *notes, vxm_error *error) {
  uint64_t voxels = vxm_space_voxels(space), there = input->size - h->data;
  if (there / h->size < voxels)
    return vxm_fail_byte(error, input, input->size,
                         "the file is cut short: it has %" PRIu64 " of %" PRIu64 " elements", there / h->size,
                         voxels);
  if (there > voxels * h->size)
    vxm_note(notes, "%" PRIu64 " bytes behind the array are ignored", there - voxels * h->size);
  return VXM_OK;
}

static vxm_status read_npy(vxm_grid **out, const vxm_input *input, vxm_error *error) {
  vxm_npy_header h;
  vxm_notes notes = {0};
  vxm_space space;
  vxm_status status = vxm_npy_header_read(&h, input, error);
  if (status != VXM_OK)
    return status;
  memcpy(space.dims, h.shape, sizeof space.dims);
  find_space(&space, input, &notes);
  status = vxm_space_check_file(&space, input, h.shape_offset, error);
  if (status == VXM_OK)
    status = check_length(&h, &space, input, &notes, error);
  vxm_grid *grid = NULL;
  if (status == VXM_OK)
    status = vxm_grid_create(&grid, input->context, &space, error);
  if (status == VXM_OK)
    status =
        (h.fortran ? read_fortran_order : read_c_order)(grid, input->data + h.data, element_of(&h), error);
  if (status != VXM_OK) {
    vxm_grid_destroy(grid);
    return status;
  }
  grid->notes = notes;
  *out = grid;
  return VXM_OK;
}

/* ---- Writing ---- */

enum { CHUNK = 1 << 22 };

/** Rows that are turned into bytes together, at most CHUNK of them; a row is below 2^20 + 1. */
static size_t chunk_rows(const vxm_space *space) {
  size_t all = (size_t)space->dims[0] * (size_t)space->dims[1], rows = CHUNK / (size_t)space->dims[2];
  return rows < all ? rows : all;
}

typedef struct storing {
  const vxm_window *window;
  unsigned char *bytes;
  size_t row, rows; /**< those in `bytes`, counted over all slices of the window */
} storing;

static void store_row(unsigned char *to, const uint64_t *row, size_t count) {
  size_t n = 0;
  for (; n + 8 <= count; n += 8)
    vxm_store_le64(to + n, vxm_unpack_bits(row[n / 64] >> (n % 64)));
  for (; n < count; n++)
    to[n] = (unsigned char)(row[n / 64] >> (n % 64) & 1);
}

static void store_rows(size_t task, int worker, void *payload) {
  (void)worker;
  const storing *s = payload;
  size_t begin = task * ROWS_PER_TASK, length = (size_t)s->window->fast_dim,
         end = begin + ROWS_PER_TASK < s->rows ? begin + ROWS_PER_TASK : s->rows;
  for (size_t r = begin; r < end; r++) {
    int64_t row = (int64_t)(s->row + r), middles = s->window->middle_dim;
    store_row(s->bytes + r * length,
              vxm_window_row(s->window, row % middles, s->window->begin + row / middles), length);
  }
}

static vxm_status put(vxm_slices *slices, const vxm_window *window, vxm_error *error) {
  size_t rows = (size_t)(window->end - window->begin) * (size_t)window->middle_dim,
         most = chunk_rows(&slices->space);
  for (size_t row = 0; row < rows; row += most) {
    storing s = {window, slices->state, row, rows - row < most ? rows - row : most};
    vxm_parallel(slices->context, (s.rows + ROWS_PER_TASK - 1) / ROWS_PER_TASK, store_rows, &s);
    vxm_output_write(slices->output, s.bytes, s.rows * (size_t)window->fast_dim);
    vxm_status status = vxm_slices_step_rows(slices, window, row + s.rows, error);
    if (status != VXM_OK)
      return status;
  }
  return VXM_OK;
}

static size_t state_bytes(const vxm_space *space) {
  return chunk_rows(space) * (size_t)space->dims[2];
}

static vxm_status begin(vxm_slices *slices, vxm_error *error) {
  (void)error;
  vxm_npy_header_write(slices->output, "|b1", false, slices->space.dims);
  return VXM_OK;
}

static vxm_status end(vxm_slices *slices, vxm_error *error) {
  (void)slices;
  (void)error;
  return VXM_OK;
}

static const vxm_slices_kind slices_kind = {
    VXM_PLANE_Z_FAST, &description, NULL, state_bytes, begin, put, end,
};

const vxm_grid_format vxm_format_npy = {"npy", vxm_npy_sniff, read_npy, &slices_kind};
