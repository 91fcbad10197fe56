/* SPDX-License-Identifier: BSD-3-Clause */
/** .zarr out: slices across x are gathered until they make up chunks, which are compressed side by side. */
#include "base/endian.h"
#include "base/file_transaction.h"
#include "base/threads.h"
#include "grid/bit_transpose.h"
#include "gridio/common/deflate.h"
#include "gridio/common/values_writer.h"
#include "gridio/formats/zarr.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 64, CHUNK_X_MIN = 8 };

/** Slices that wait for their chunks take about so much. */
static const uint64_t SLAB_BYTES = UINT64_C(64) << 20;

typedef struct state {
  vxm_atomic_folder folder;
  bool is_open;
  vxm_zarr_array array;
  size_t voxel_bytes;
  unsigned char *slab;   /**< chunk[0] slices: z fastest, then y, then x, little-endian */
  int64_t filled, first; /**< slices in the slab, and the first of them */
  size_t workers;
  unsigned char **room; /**< of each worker: a chunk, and behind it the compressed one */
} state;

/* ---- Sizes ---- */

static size_t voxel_bytes(const vxm_values_spec *values) {
  return vxm_scalar_bytes(values->scalar) * (size_t)values->channels;
}

static uint64_t slice_bytes(const vxm_space *space, const vxm_values_spec *values) {
  return (uint64_t)space->dims[1] * (uint64_t)space->dims[2] * voxel_bytes(values);
}

static vxm_zarr_array describe(const vxm_space *space, const vxm_values_spec *values) {
  vxm_zarr_array a = {.rank = values->channels == 4 ? 4 : 3,
                      .shape = {space->dims[0], space->dims[1], space->dims[2], 4},
                      .scalar = values->scalar,
                      .is_bool = values->is_bits,
                      .is_packed = vxm_deflate_check("", NULL) == VXM_OK,
                      .separator = '.',
                      .space = *space,
                      .axis = {0, 1, 2}};
  for (int i = 0; i < 3; i++)
    a.chunk[i] = a.shape[i] < CHUNK ? a.shape[i] : CHUNK;
  a.chunk[3] = 4;
  while (a.chunk[0] > CHUNK_X_MIN && (uint64_t)a.chunk[0] * slice_bytes(space, values) > SLAB_BYTES)
    a.chunk[0] = a.chunk[0] / 2 > CHUNK_X_MIN ? a.chunk[0] / 2 : CHUNK_X_MIN;
  return a;
}

static size_t chunk_bytes(const vxm_zarr_array *array) {
  return vxm_zarr_chunk_values(array) * vxm_scalar_bytes(array->scalar);
}

static size_t room_bytes(const vxm_zarr_array *array) {
  size_t bytes = chunk_bytes(array);
  return bytes + (array->is_packed ? vxm_deflate_bound(bytes) : 0);
}

static uint64_t held_bytes(const vxm_space *space, const vxm_values_spec *values) {
  const vxm_zarr_array a = describe(space, values);
  return (uint64_t)a.chunk[0] * slice_bytes(space, values) + 2 * (room_bytes(&a) + VXM_DEFLATE_BYTES);
}

/* ---- Beginning ---- */

/** What the folder of an array has: .zarray, .zattrs, and chunks, "0.3.1" or "0/3/1", of 3 or 4 numbers. */
static bool is_part(const char *name, bool is_folder, int depth) {
  int numbers = 1;
  if (!is_folder && depth == 0 && (strcmp(name, ".zarray") == 0 || strcmp(name, ".zattrs") == 0))
    return true;
  for (const char *at = name;; at++, numbers++) {
    size_t digits = strspn(at, "0123456789");
    at += digits;
    if (digits == 0 || (*at && *at != '.'))
      return false;
    if (!*at)
      break;
  }
  if (is_folder)
    return numbers == 1 && depth < VXM_ZARR_RANK_MAX - 1;
  int rank = depth + numbers;
  return (depth == 0 || numbers == 1) && (rank == 3 || rank == VXM_ZARR_RANK_MAX);
}

static vxm_status check(const vxm_space *space, const vxm_values_spec *values, const char *path,
                        vxm_error *error) {
  (void)space, (void)values;
  if (strcmp(path, "-") != 0)
    return VXM_OK;
  return vxm_fail(error, VXM_ERROR_ARGUMENT, ".zarr is a folder, which cannot go to standard output");
}

static vxm_status check_field(const vxm_field *field, const char *path, vxm_error *error) {
  return check(&field->space, NULL, path, error);
}

static vxm_status begin(vxm_values_writer *w, vxm_error *error) {
  vxm_status status = check(&w->space, &w->values, w->path, error);
  if (status != VXM_OK)
    return status;
  state *s = w->state = vxm_try_calloc(w->context, 1, sizeof *s, &status, error);
  if (!s)
    return status;
  s->array = describe(&w->space, &w->values);
  s->voxel_bytes = voxel_bytes(&w->values);
  s->workers = (size_t)vxm_context_threads(w->context);
  s->slab = vxm_try_alloc(w->context, (size_t)s->array.chunk[0], w->slice_bytes, &status, error);
  if (s->slab)
    s->room = vxm_try_calloc(w->context, s->workers, sizeof *s->room, &status, error);
  if (!s->room)
    return status;
  status = vxm_atomic_folder_open(&s->folder, w->path, ".zarray", is_part, "a Zarr array", error);
  s->is_open = status == VXM_OK;
  return status;
}

/* ---- Chunks ---- */

/** Chunks of a slab, and the first fault by their order, whichever thread meets it. */
typedef struct flushing {
  vxm_values_writer *writer;
  state *state;
  pthread_mutex_t mutex;
  size_t failed; /**< task; SIZE_MAX = none */
  vxm_error error;
} flushing;

static bool is_zero(const unsigned char *bytes, size_t size) {
  return bytes[0] == 0 && memcmp(bytes, bytes + 1, size - 1) == 0;
}

/** Takes a chunk out of the slab; beyond the array there are zeros. */
static void gather(unsigned char *to, const state *s, const int64_t *chunk) {
  const vxm_zarr_array *a = &s->array;
  const size_t row = (size_t)a->chunk[2] * s->voxel_bytes;
  const int64_t y_first = chunk[1] * a->chunk[1], z_first = chunk[2] * a->chunk[2];
  int64_t rows = a->shape[1] - y_first, left = a->shape[2] - z_first;
  size_t there = (size_t)(left < a->chunk[2] ? left : a->chunk[2]) * s->voxel_bytes;
  for (int64_t x = 0; x < a->chunk[0]; x++)
    for (int64_t y = 0; y < a->chunk[1]; y++, to += row) {
      bool is_inside = x < s->filled && y < rows;
      const int64_t from = (x * a->shape[1] + y_first + y) * a->shape[2] + z_first;
      if (is_inside)
        memcpy(to, s->slab + (size_t)from * s->voxel_bytes, there);
      memset(to + (is_inside ? there : 0), 0, row - (is_inside ? there : 0));
    }
}

static vxm_status put_chunk(const flushing *f, const int64_t *chunk, unsigned char *room, vxm_error *error) {
  const state *s = f->state;
  char key[VXM_ZARR_KEY_MAX];
  size_t size = chunk_bytes(&s->array);
  unsigned char *bytes = room;
  gather(room, s, chunk);
  if (is_zero(room, size)) /* a chunk that is not there is one of the fill value, 0 */
    return VXM_OK;
  if (s->array.is_packed) {
    bytes = room + size;
    vxm_status status = vxm_deflate_block(f->writer->context, bytes, &size, room, size, error);
    if (status != VXM_OK)
      return status;
  }
  vxm_zarr_key(key, &s->array, chunk);
  return vxm_atomic_folder_put(&s->folder, key, bytes, size)
             ? VXM_OK
             : vxm_fail_errno(error, f->writer->path, "cannot write");
}

static void put_task(size_t task, int worker, void *payload) {
  flushing *f = payload;
  state *s = f->state;
  const size_t across = (size_t)vxm_zarr_chunks(&s->array, 2);
  const int64_t chunk[VXM_ZARR_RANK_MAX] = {s->first / s->array.chunk[0], (int64_t)(task / across),
                                            (int64_t)(task % across), 0};
  vxm_error local = VXM_ERROR_INIT;
  unsigned char **room = &s->room[worker];
  pthread_mutex_lock(&f->mutex);
  bool goes_on = task < f->failed;
  pthread_mutex_unlock(&f->mutex);
  if (!goes_on)
    return;
  if (!*room)
    *room = vxm_alloc(f->writer->context, room_bytes(&s->array), 1, &local);
  if (*room)
    put_chunk(f, chunk, *room, &local);
  if (local.code == VXM_OK)
    return;
  pthread_mutex_lock(&f->mutex);
  if (task < f->failed) {
    f->failed = task;
    f->error = local;
  }
  pthread_mutex_unlock(&f->mutex);
}

static vxm_status flush(vxm_values_writer *w, vxm_error *error) {
  state *s = w->state;
  flushing f = {.writer = w,
                .state = s,
                .mutex = PTHREAD_MUTEX_INITIALIZER,
                .failed = SIZE_MAX,
                .error = VXM_ERROR_INIT};
  size_t tasks = (size_t)(vxm_zarr_chunks(&s->array, 1) * vxm_zarr_chunks(&s->array, 2));
  vxm_status status = vxm_parallel_cancellable(w->context, tasks, put_task, &f, error);
  pthread_mutex_destroy(&f.mutex);
  if (status == VXM_OK && f.failed != SIZE_MAX) {
    vxm_error_pass(error, &f.error);
    status = f.error.code;
  }
  s->first += s->filled;
  s->filled = 0;
  return status;
}

static vxm_status put(vxm_values_writer *w, const void *values, int64_t first, int64_t end,
                      vxm_error *error) {
  state *s = w->state;
  const unsigned char *slice = values;
  vxm_status status = VXM_OK;
  const size_t each = vxm_scalar_bytes(w->values.scalar);
  for (int64_t x = first; x < end && status == VXM_OK; x++, slice += w->slice_bytes) {
    unsigned char *to = s->slab + (size_t)s->filled * w->slice_bytes;
    memcpy(to, slice, w->slice_bytes);
    if (vxm_must_swap(false))
      vxm_swap_each(to, w->slice_bytes / each, each);
    s->filled++;
    if (s->filled == s->array.chunk[0] || x + 1 == w->space.dims[0])
      status = flush(w, error);
  }
  return status;
}

/* ---- Ending ---- */

static vxm_status put_text(const vxm_values_writer *w, const char *name, char *text, vxm_error *error) {
  const state *s = w->state;
  vxm_status status = VXM_OK;
  if (!text)
    return vxm_fail(error, VXM_ERROR_MEMORY, "out of memory");
  size_t size = strlen(text);
  text[size] = '\n'; /* in the place of the zero byte */
  if (!vxm_atomic_folder_put(&s->folder, name, text, size + 1))
    status = vxm_fail_errno(error, w->path, "cannot write");
  free(text);
  return status;
}

static vxm_status end(vxm_values_writer *w, vxm_error *error) {
  state *s = w->state;
  const char *kind = w->values.is_bits ? "bits" : vxm_field_kind_name(w->values.about->kind);
  vxm_status status = put_text(w, ".zarray", vxm_zarr_array_text(&s->array), error);
  if (status == VXM_OK)
    status = put_text(w, ".zattrs", vxm_zarr_attributes_text(&s->array, kind, w->values.about), error);
  if (status != VXM_OK)
    return status;
  w->kept = vxm_file_transaction_folder_create(&s->folder, w->path);
  if (!w->kept)
    return vxm_fail(error, VXM_ERROR_MEMORY, "out of memory");
  s->is_open = false;
  return VXM_OK;
}

static void drop(vxm_values_writer *w) {
  state *s = w->state;
  if (!s)
    return;
  if (s->is_open)
    vxm_atomic_folder_close(&s->folder);
  for (size_t r = 0; s->room && r < s->workers; r++)
    vxm_free(w->context, s->room[r]);
  vxm_free(w->context, s->room);
  vxm_free(w->context, s->slab);
}

static const vxm_values_writer_kind values_kind = {
    .layout = VXM_PLANE_Z_FAST,
    .holds = VXM_HOLDS_ALL,
    .has_own_files = true,
    .check = check,
    .held_bytes = held_bytes,
    .begin = begin,
    .put = put,
    .end = end,
    .drop = drop,
};

const vxm_grid_format vxm_format_zarr = {
    .name = "zarr",
    .holds = VXM_HOLDS_ALL,
    .sniff = vxm_zarr_sniff,
    .is_told_by_name = true,
    .is_folder = true,
    .read = vxm_zarr_read_bits,
    .read_field = vxm_zarr_read_field,
    .values = &values_kind,
    .check_field = check_field,
};
