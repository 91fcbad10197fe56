/* SPDX-License-Identifier: BSD-3-Clause */
/** .nrrd: a byte per voxel behind a header with the transform, x fastest, then y, then z. */
#include "config.h"
#include "gridio/byte_rows.h"
#include "gridio/elements.h"
#include "gridio/nrrd_header.h"

#include <inttypes.h>
#include <string.h>
#if HAVE_ZLIB
#define ZLIB_CONST
#include <zlib.h>
#endif

/* ---- Reading ---- */

static vxm_status check_length(const vxm_nrrd_header *h, const vxm_input *input, vxm_notes *notes,
                               vxm_error *error) {
  /* Deflate makes at most 1032 bytes of one. */
  enum { LARGEST_RATIO = 1032 };
  uint64_t voxels = vxm_space_voxels(&h->space), there = input->size - h->data;
  if (h->gzip && voxels * h->size / LARGEST_RATIO <= there)
    return VXM_OK;
  if (h->gzip || there / h->size < voxels)
    return vxm_fail_byte(error, input, input->size,
                         "the file is cut short: %" PRIu64 " bytes cannot hold %" PRIu64 " values", there,
                         voxels);
  if (there > voxels * h->size)
    vxm_note(notes, "%" PRIu64 " bytes behind the values are ignored", there - voxels * h->size);
  return VXM_OK;
}

#if HAVE_ZLIB
/** zlib at work, with memory of the context. */
typedef struct unpacking {
  z_stream z;
  const vxm_input *input;
  vxm_error error;
} unpacking;

static void *take(void *payload, unsigned count, unsigned size) {
  unpacking *u = payload;
  return vxm_alloc(u->input->context, count, size, &u->error);
}

static void give(void *payload, void *block) {
  const unpacking *u = payload;
  vxm_free(u->input->context, block);
}

/** Fills `size` bytes; the compressed values may end behind them, not before. */
static vxm_status unpack_bytes(unpacking *u, unsigned char *to, size_t size) {
  const size_t piece = (size_t)1 << 30; /* zlib counts in 32 bits */
  z_stream *z = &u->z;
  z->next_out = to;
  while (size > 0) {
    size_t left = u->input->size - (size_t)(z->next_in - u->input->data), room = size < piece ? size : piece;
    z->avail_in = (unsigned)(left < piece ? left : piece);
    z->avail_out = (unsigned)room;
    int result = inflate(z, Z_NO_FLUSH);
    size -= room - z->avail_out;
    size_t at = (size_t)(z->next_in - u->input->data);
    if (result == Z_MEM_ERROR)
      return u->error.code;
    if (size > 0 && (result == Z_STREAM_END || result == Z_BUF_ERROR))
      return vxm_fail_byte(&u->error, u->input, at, "the compressed values end too early");
    if (result != Z_OK && result != Z_STREAM_END)
      return vxm_fail_byte(&u->error, u->input, at, "the compressed values are damaged: %s",
                           z->msg ? z->msg : "not those of gzip");
  }
  return VXM_OK;
}

/** Rows that are unpacked together: up to 4 MiB, but at least one. */
static size_t rows_at_once(const vxm_grid *grid, size_t row_bytes) {
  enum { CHUNK = 1 << 22 };
  size_t all = grid->word_count / grid->row_words, some = row_bytes < CHUNK ? CHUNK / row_bytes : 1;
  return some < all ? some : all;
}

static vxm_status unpack_rows(unpacking *u, vxm_grid *grid, const vxm_nrrd_header *h) {
  size_t row_bytes = (size_t)grid->space.dims[0] * h->size, all = grid->word_count / grid->row_words,
         most = rows_at_once(grid, row_bytes);
  vxm_element element = vxm_element_of(h->kind, h->size, h->big_endian);
  unsigned char *bytes = vxm_alloc(grid->context, most, row_bytes, &u->error);
  vxm_status status = u->error.code;
  for (size_t row = 0; row < all && status == VXM_OK; row += most) {
    size_t rows = all - row < most ? all - row : most;
    status = unpack_bytes(u, bytes, rows * row_bytes);
    if (status != VXM_OK)
      break;
    vxm_elements_to_rows(grid, row, rows, bytes, element);
    status = vxm_progress(grid->context, "reading", (double)(row + rows) / (double)all, &u->error);
  }
  vxm_free(grid->context, bytes);
  return status;
}

static vxm_status read_gzip(vxm_grid *grid, const vxm_nrrd_header *h, const vxm_input *input,
                            vxm_error *error) {
  enum { ANY_HEADER = 32 /* gzip's or zlib's own */ };
  unpacking u = {.z = {.zalloc = take, .zfree = give, .next_in = input->data + h->data},
                 .input = input,
                 .error = VXM_ERROR_INIT};
  u.z.opaque = &u;
  vxm_status status = VXM_OK;
  if (inflateInit2(&u.z, ANY_HEADER + MAX_WBITS) != Z_OK)
    status = u.error.code != VXM_OK ? u.error.code : vxm_fail(&u.error, VXM_ERROR_MEMORY, "out of memory");
  if (status == VXM_OK) {
    status = unpack_rows(&u, grid, h);
    inflateEnd(&u.z);
  }
  if (status != VXM_OK && error)
    *error = u.error;
  return status;
}
#else
static vxm_status read_gzip(vxm_grid *grid, const vxm_nrrd_header *h, const vxm_input *input,
                            vxm_error *error) {
  (void)grid;
  return vxm_fail_at(error, VXM_ERROR_UNAVAILABLE, (vxm_place){input->name, 0, (int64_t)h->data, -1},
                     "compressed values need zlib, without which this build was made (configure --with-zlib; "
                     "Debian: zlib1g-dev); write the file with the encoding raw");
}
#endif

static vxm_status read_nrrd(vxm_grid **out, const vxm_input *input, vxm_error *error) {
  vxm_nrrd_header h;
  vxm_notes notes = {0};
  vxm_status status = vxm_nrrd_header_read(&h, input, &notes, error);
  if (status == VXM_OK)
    status = vxm_space_check_file(&h.space, input, h.sizes_offset, error);
  if (status == VXM_OK)
    status = check_length(&h, input, &notes, error);
  vxm_grid *grid = NULL;
  if (status == VXM_OK)
    status = vxm_grid_create(&grid, input->context, &h.space, error);
  if (status == VXM_OK && h.gzip)
    status = read_gzip(grid, &h, input, error);
  else if (status == VXM_OK)
    status =
        vxm_elements_to_grid(grid, input->data + h.data, vxm_element_of(h.kind, h.size, h.big_endian), error);
  if (status != VXM_OK) {
    vxm_grid_destroy(grid);
    return status;
  }
  grid->notes = notes;
  *out = grid;
  return VXM_OK;
}

/* ---- Writing ---- */

static size_t state_bytes(const vxm_space *space) {
  return vxm_byte_rows_bytes(space, (vxm_layout)VXM_LAYOUT_GRID);
}

static vxm_status begin(vxm_slices *slices, vxm_error *error) {
  return vxm_nrrd_header_write(slices->output, "1 where a voxel is set", "uchar", 1, &slices->space, error);
}

static vxm_status end(vxm_slices *slices, vxm_error *error) {
  (void)slices;
  (void)error;
  return VXM_OK;
}

static const vxm_slices_kind slices_kind = {
    .layout = VXM_LAYOUT_GRID,
    .state_bytes = state_bytes,
    .begin = begin,
    .put = vxm_byte_rows_put,
    .end = end,
    .file_bytes = vxm_space_voxels,
};

const vxm_grid_format vxm_format_nrrd = {"nrrd", vxm_nrrd_sniff, read_nrrd, &slices_kind, NULL};
