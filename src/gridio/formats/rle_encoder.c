/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Threads code pieces of the sequence, each from a row's start on, into buffers of their own. The first and
 * the last run of a piece, which may go on beyond it, are handed over as numbers, and joined in order.
 */
#include "gridio/formats/rle_encoder.h"
#include "base/endian.h"
#include "base/threads.h"
#include "gridio/formats/runs.h"

/* A piece of PIECE_WORDS is coded at a time into a buffer of at least BUFFER bytes, which only rough surfaces
 * fill. */
enum { PIECES = 64, PIECE_WORDS = 1 << 12, BUFFER = 1 << 16, BUFFERS_MAX = PIECES * BUFFER };

typedef struct piece {
  size_t row, end; /**< rows to be coded, counted through the slices of the window */
  bool has_first;  /**< a run has ended: otherwise all is one run, `last` */
  vxm_bit_run first, last;
  size_t used; /**< bytes between them */
} piece;

typedef struct rle_encoder {
  vxm_rle_shape shape;
  vxm_bit_run run; /**< not written yet */
  size_t pieces, piece_rows, buffer_bytes;
  const vxm_window *window; /**< in vxm_rle_encoder_put */
  piece piece[PIECES];
  _Alignas(64) unsigned char buffers[];
} rle_encoder;

/** Bytes that a row takes at most: no more codes than voxels, as a code covers at least one. */
static size_t row_room(const vxm_rle_shape *shape) {
  return shape->length * (shape->code == VXM_RUN_PAIRS ? 2 : 1) + 64;
}

/** How many buffers of which size. */
static void plan(const vxm_rle_shape *shape, uint64_t rows, rle_encoder *out) {
  size_t row_words = (shape->length + 63) / 64, room = row_room(shape);
  out->shape = *shape;
  out->piece_rows = row_words < PIECE_WORDS ? PIECE_WORDS / row_words : 1;
  out->buffer_bytes = room < BUFFER ? (size_t)(rows < BUFFER / room ? rows * room : BUFFER) : room;
  uint64_t wanted = (rows + out->piece_rows - 1) / out->piece_rows;
  out->pieces = BUFFERS_MAX / out->buffer_bytes; /* at least 1: a row takes at most 2^21 + 64 bytes */
  if (wanted < out->pieces)
    out->pieces = (size_t)wanted;
}

size_t vxm_rle_encoder_bytes(const vxm_rle_shape *shape, uint64_t rows) {
  rle_encoder w;
  plan(shape, rows, &w);
  return sizeof w + w.pieces * w.buffer_bytes;
}

void vxm_rle_encoder_begin(void *state, const vxm_rle_shape *shape, uint64_t rows) {
  rle_encoder *w = state;
  plan(shape, rows, w);
  w->run = (vxm_bit_run){false, 0};
}

/* ---- Coding a piece ---- */

typedef struct sink {
  piece *piece;
  unsigned char *at;
} sink;

static inline bool take_first(sink *s, bool value, uint64_t length) {
  if (s->piece->has_first)
    return false;
  s->piece->has_first = true;
  s->piece->first = (vxm_bit_run){value, length};
  return true;
}

static inline void put_pairs(bool value, uint64_t length, void *payload) {
  sink *s = payload;
  if (take_first(s, value, length))
    return;
  unsigned char *at = s->at;
  for (; length > 255; length -= 255) {
    *at++ = value;
    *at++ = 255;
  }
  *at++ = value;
  *at++ = (unsigned char)length;
  s->at = at;
}

static inline void put_bytes(bool value, uint64_t length, void *payload) {
  sink *s = payload;
  if (take_first(s, value, length))
    return;
  unsigned char *at = s->at;
  for (; length >= 255; length -= 255)
    *at++ = 255;
  *at++ = (unsigned char)length;
  s->at = at;
}

/**
 * Codes rows while the buffer has room: for a row, and for the run before it, which takes at most 2 bytes for
 * 255 voxels. The first row always fits, since its first run takes none.
 */
static inline __attribute__((always_inline)) void code_rows(const rle_encoder *w, piece *p,
                                                            unsigned char *buffer, vxm_run_fn put) {
  const vxm_window *window = w->window;
  const vxm_rle_shape shape = w->shape;
  const size_t room = row_room(&shape);
  int64_t middle = (int64_t)p->row % window->middle_dim;
  int64_t slow = window->begin + (int64_t)p->row / window->middle_dim;
  /* It begins as the first voxel is, so that its first run is not empty. */
  vxm_bit_run run = {*vxm_window_row(window, middle, slow) & 1, 0};
  sink s = {p, buffer};
  p->has_first = false;
  do {
    if (p->has_first && (size_t)(s.at - buffer) + (run.length >> 6) + room > w->buffer_bytes)
      break;
    vxm_run_scan(&run, vxm_window_row(window, middle, slow), shape.length, put, &s);
    vxm_run_skip(&run, shape.row_gap, put, &s);
    if (++middle == window->middle_dim) {
      vxm_run_skip(&run, shape.slice_gap, put, &s);
      middle = 0;
      slow++;
    }
  } while (++p->row < p->end);
  p->used = (size_t)(s.at - buffer);
  p->last = run;
}

static void code_piece(size_t task, int worker, void *payload) {
  (void)worker;
  rle_encoder *w = payload;
  unsigned char *buffer = w->buffers + task * w->buffer_bytes;
  if (w->shape.code == VXM_RUN_PAIRS)
    code_rows(w, &w->piece[task], buffer, put_pairs);
  else
    code_rows(w, &w->piece[task], buffer, put_bytes);
}

/* ---- Joining them ---- */

/** Writes all codes of 255 voxels that the run has by now. */
static void put_full(rle_encoder *w, vxm_output *output) {
  enum { ROOM = 4096 };
  bool pairs = w->shape.code == VXM_RUN_PAIRS;
  uint64_t codes = w->run.length / 255;
  w->run.length %= 255;
  uint64_t four = UINT64_C(0xff00ff00ff00ff00) | (w->run.value ? UINT64_C(0x0001000100010001) : 0);
  while (codes > 0) {
    char *room = vxm_output_reserve(output, ROOM);
    size_t most = pairs ? ROOM / 2 : ROOM, count = codes < most ? (size_t)codes : most;
    if (pairs)
      for (size_t at = 0; at < count; at += 4)
        vxm_store_le64((unsigned char *)room + 2 * at, four);
    else
      memset(room, 255, count);
    vxm_output_advance(output, pairs ? 2 * count : count);
    codes -= count;
  }
}

/** Writes what put_full leaves, if anything. */
static void put_rest(rle_encoder *w, vxm_output *output) {
  const unsigned char code[2] = {w->run.value, (unsigned char)w->run.length};
  bool pairs = w->shape.code == VXM_RUN_PAIRS;
  vxm_output_write(output, pairs ? code : code + 1, pairs ? 2 : 1);
}

static void end_run(rle_encoder *w, vxm_output *output) {
  put_full(w, output);
  if (w->run.length > 0 || w->shape.code == VXM_RUN_BYTES)
    put_rest(w, output);
}

/** Goes on with a run that is not empty. */
static void join(rle_encoder *w, vxm_output *output, vxm_bit_run run) {
  if (run.value == w->run.value) {
    w->run.length += run.length;
    return;
  }
  end_run(w, output);
  w->run = run;
}

static void join_piece(rle_encoder *w, vxm_output *output, const piece *p, const unsigned char *buffer) {
  if (p->has_first) {
    join(w, output, p->first);
    end_run(w, output);
    vxm_output_write(output, buffer, p->used);
    w->run = p->last;
  } else
    join(w, output, p->last);
}

/** Joins the pieces in order, and codes here what did not fit their buffers. */
static void join_pieces(rle_encoder *w, vxm_output *output, size_t count) {
  for (size_t n = 0; n < count; n++) {
    join_piece(w, output, &w->piece[n], w->buffers + n * w->buffer_bytes);
    while (w->piece[n].row < w->piece[n].end) {
      code_piece(n, 0, w);
      join_piece(w, output, &w->piece[n], w->buffers + n * w->buffer_bytes);
    }
  }
  put_full(w, output);
}

vxm_status vxm_rle_encoder_put(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error) {
  rle_encoder *w = writer->state;
  size_t rows = (size_t)(window->end - window->begin) * (size_t)window->middle_dim;
  w->window = window;
  for (size_t row = 0; row < rows;) {
    size_t count = 0;
    for (; count < w->pieces && row < rows; count++) {
      size_t end = rows - row < w->piece_rows ? rows : row + w->piece_rows;
      w->piece[count] = (piece){.row = row, .end = end};
      row = end;
    }
    vxm_parallel(writer->context, count, code_piece, w);
    join_pieces(w, writer->output, count);
    vxm_status status = vxm_grid_writer_step_rows(writer, window, row, error);
    if (status != VXM_OK)
      return status;
  }
  return VXM_OK;
}

void vxm_rle_encoder_skip(vxm_grid_writer *writer, uint64_t count) {
  rle_encoder *w = writer->state;
  if (count > 0)
    join(w, writer->output, (vxm_bit_run){false, count});
  put_full(w, writer->output);
}

void vxm_rle_encoder_end(vxm_grid_writer *writer) {
  rle_encoder *w = writer->state;
  put_full(w, writer->output);
  if (w->run.length > 0)
    put_rest(w, writer->output);
}
