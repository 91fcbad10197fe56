/* SPDX-License-Identifier: BSD-3-Clause */
/** .zarr in: chunks side by side, each into its place in a field. */
#include "base/open_beneath.h"
#include "base/threads.h"
#include "gridio/common/array_place.h"
#include "gridio/common/deflate.h"
#include "gridio/common/raster.h"
#include "gridio/formats/zarr.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct loading {
  const vxm_zarr_array *array;
  const vxm_input *input;
  int folder;
  vxm_field *field;
  unsigned char **room; /**< of each worker: an unpacked chunk */
  bool is_zero;         /**< the fill value, which the field has already */
  pthread_mutex_t mutex;
  size_t failed; /**< the first chunk that failed; SIZE_MAX = none */
  vxm_error error;
} loading;

bool vxm_zarr_sniff(const vxm_input *input) {
  static const char *const marks[] = {".zarray", ".zgroup", "zarr.json"};
  if (input->size > 0 || strcmp(input->name, "<stdin>") == 0)
    return false;
  int folder = open(input->name, O_PATH | O_DIRECTORY | O_CLOEXEC);
  bool found = false;
  for (int m = 0; folder >= 0 && !found && m < 3; m++)
    found = faccessat(folder, marks[m], F_OK, 0) == 0;
  if (folder >= 0)
    close(folder);
  return found;
}

/* ---- Where values go ---- */

/** The part of a chunk that lies in the array, and how far apart its values lie on both sides. */
typedef struct block {
  int64_t first[VXM_ZARR_RANK_MAX], count[VXM_ZARR_RANK_MAX];
  size_t from_step[VXM_ZARR_RANK_MAX], to_step[VXM_ZARR_RANK_MAX], to; /**< bytes */
} block;

static block block_of(const loading *l, const int64_t *chunk) {
  const vxm_zarr_array *a = l->array;
  const int64_t *n = a->space.dims;
  const size_t size = vxm_scalar_bytes(a->scalar), voxel = vxm_field_voxel_bytes(l->field),
               strides[3] = {(size_t)(n[1] * n[2]) * voxel, (size_t)n[2] * voxel, voxel};
  block b = {.count = {1, 1, 1, 1}, .to_step = {0, 0, 0, size}};
  size_t step = size;
  for (int i = 0; i < a->rank; i++) {
    b.first[i] = chunk[i] * a->chunk[i];
    int64_t left = a->shape[i] - b.first[i];
    b.count[i] = left < a->chunk[i] ? left : a->chunk[i];
    int axis = a->is_fortran ? i : a->rank - 1 - i;
    b.from_step[axis] = step;
    step *= (size_t)a->chunk[axis];
    if (i < 3)
      b.to_step[i] = strides[a->axis[i]];
    b.to += (size_t)b.first[i] * b.to_step[i];
  }
  return b;
}

static void put_value(unsigned char *to, const unsigned char *from, const vxm_zarr_array *a, size_t size) {
  if (a->is_bool)
    *to = *from != 0;
  else if (a->is_swapped)
    for (size_t b = 0; b < size; b++)
      to[b] = from[size - 1 - b];
  else
    memcpy(to, from, size);
}

/** Puts the values of a chunk, or fills its part. A colour without opacity gets the full one with its first
 * number. */
static void put_block(const loading *l, const block *b, const unsigned char *values) {
  const vxm_zarr_array *a = l->array;
  const size_t size = vxm_scalar_bytes(a->scalar);
  const bool is_opaque = a->rank == 4 && a->shape[3] == 3 && b->first[3] == 0;
  const bool is_run = values && !a->is_bool && !a->is_swapped && a->rank == 3 && b->from_step[2] == size &&
                      b->to_step[2] == size;
  for (int64_t i = 0; i < b->count[0]; i++)
    for (int64_t j = 0; j < b->count[1]; j++) {
      unsigned char *to = l->field->values + b->to + (size_t)i * b->to_step[0] + (size_t)j * b->to_step[1];
      const unsigned char *from =
          values ? values + (size_t)i * b->from_step[0] + (size_t)j * b->from_step[1] : NULL;
      if (is_run) {
        memcpy(to, from, (size_t)b->count[2] * size);
        continue;
      }
      for (int64_t k = 0; k < b->count[2]; k++) {
        unsigned char *voxel = to + (size_t)k * b->to_step[2];
        for (int64_t c = 0; c < b->count[3]; c++)
          if (from)
            put_value(voxel + (size_t)c * size,
                      from + (size_t)k * b->from_step[2] + (size_t)c * b->from_step[3], a, size);
          else
            memcpy(voxel + (size_t)c * size, a->fill, size);
        if (is_opaque)
          voxel[3] = UINT8_MAX;
      }
    }
}

/* ---- Chunks ---- */

/** The values of a chunk of which the file is there. */
static vxm_status unpack(const unsigned char **out, unsigned char **room, const loading *l,
                         const vxm_input *file, vxm_error *error) {
  const size_t size = vxm_zarr_chunk_values(l->array) * vxm_scalar_bytes(l->array->scalar);
  vxm_inflater *inflater;
  vxm_error local = VXM_ERROR_INIT;
  *out = file->data;
  if (!l->array->is_packed)
    return file->size == size
               ? VXM_OK
               : vxm_fail_byte(error, file, file->size, "a chunk of %zu bytes, not of %zu", file->size, size);
  if (file->size < size / VXM_INFLATE_RATIO_MAX)
    return vxm_fail_byte(error, file, file->size, "the file is cut short: a chunk has %zu bytes", size);
  if (!*room)
    *room = vxm_alloc(l->input->context, size, 1, &local);
  vxm_status status = local.code;
  if (status == VXM_OK)
    status = vxm_inflater_create(&inflater, file, 0, &local);
  if (status == VXM_OK) {
    status = vxm_inflater_read(inflater, *room, size, &local);
    vxm_inflater_destroy(inflater);
  }
  *out = *room;
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status load_chunk(const loading *l, const int64_t *chunk, unsigned char **room, vxm_error *error) {
  char key[VXM_ZARR_KEY_MAX], *path = NULL;
  vxm_input file;
  const block b = block_of(l, chunk);
  const unsigned char *values;
  vxm_zarr_key(key, l->array, chunk);
  int descriptor = vxm_regular_open(l->folder, key, VXM_BENEATH);
  if (descriptor < 0 && errno == ENOENT) {
    if (!l->is_zero)
      put_block(l, &b, NULL);
    return VXM_OK;
  }
  int reason = errno;
  if (asprintf(&path, "%s/%s", l->input->name, key) < 0)
    path = NULL;
  errno = reason;
  vxm_status status = descriptor < 0 ? vxm_fail_errno(error, path, "cannot read")
                      : path         ? vxm_input_take(&file, l->input->context, path, descriptor, error)
                                     : vxm_fail(error, VXM_ERROR_MEMORY, "out of memory");
  if (descriptor >= 0)
    close(descriptor);
  if (status == VXM_OK) {
    status = unpack(&values, room, l, &file, error);
    if (status == VXM_OK)
      put_block(l, &b, values);
    vxm_input_close(&file);
  }
  free(path);
  return status;
}

static void load_task(size_t task, int worker, void *payload) {
  loading *l = payload;
  int64_t chunk[VXM_ZARR_RANK_MAX] = {0};
  vxm_error local = VXM_ERROR_INIT;
  size_t rest = task;
  for (int a = l->array->rank - 1; a >= 0; a--) {
    size_t across = (size_t)vxm_zarr_chunks(l->array, a);
    chunk[a] = (int64_t)(rest % across);
    rest /= across;
  }
  pthread_mutex_lock(&l->mutex);
  bool goes_on = task < l->failed;
  pthread_mutex_unlock(&l->mutex);
  if (!goes_on || load_chunk(l, chunk, &l->room[worker], &local) == VXM_OK)
    return;
  pthread_mutex_lock(&l->mutex);
  if (task < l->failed) {
    l->failed = task;
    l->error = local;
  }
  pthread_mutex_unlock(&l->mutex);
}

static vxm_status load_chunks(loading *l, vxm_error *error) {
  vxm_context *context = l->input->context;
  size_t tasks = 1, workers = (size_t)vxm_context_threads(context);
  for (int a = 0; a < l->array->rank; a++)
    tasks *= (size_t)vxm_zarr_chunks(l->array, a);
  vxm_error local = VXM_ERROR_INIT;
  l->room = vxm_calloc(context, workers, sizeof *l->room, &local);
  vxm_status status = local.code;
  if (status == VXM_OK)
    status = vxm_parallel_cancellable(context, tasks, load_task, l, &local);
  if (status == VXM_OK && l->failed != SIZE_MAX) {
    local = l->error;
    status = local.code;
  }
  for (size_t w = 0; l->room && w < workers; w++)
    vxm_free(context, l->room[w]);
  vxm_free(context, l->room);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/* ---- The array ---- */

static void warn(const vxm_zarr_array *array, vxm_warnings *warnings) {
  if (array->has_odd_axes)
    vxm_axes_warn(warnings);
  vxm_place_warn(warnings, array->known_place);
}

static vxm_status load_values(vxm_field **out, vxm_zarr_array *array, int folder, const vxm_input *input,
                              vxm_error *error) {
  static const unsigned char zeros[8];
  loading l = {.array = array,
               .input = input,
               .folder = folder,
               .is_zero = memcmp(array->fill, zeros, sizeof zeros) == 0 &&
                          !(array->rank == 4 && array->shape[3] == 3),
               .mutex = PTHREAD_MUTEX_INITIALIZER,
               .failed = SIZE_MAX,
               .error = VXM_ERROR_INIT};
  const vxm_field_kind kind = array->rank == 4 ? VXM_FIELD_COLORS : VXM_FIELD_NUMBERS;
  vxm_status status =
      vxm_field_make_zeros(&l.field, input->context, &array->space, kind, array->scalar, error);
  if (status != VXM_OK)
    return status;
  status = load_chunks(&l, error);
  pthread_mutex_destroy(&l.mutex);
  vxm_field_describe(l.field, &array->about);
  warn(array, &l.field->warnings);
  return vxm_field_hand_over(out, l.field, status, error);
}

/** A file that lacks is a chunk of the fill value only while the array is whole: whoever takes it away begins
 * with .zarray. */
static bool stays(int folder) {
  return faccessat(folder, ".zarray", F_OK, 0) == 0;
}

/** Reads the description, and then, if `field` is not NULL, the values; else it makes a clear grid. */
static vxm_status read_folder(vxm_field **field, vxm_grid **grid, const vxm_input *input, vxm_error *error) {
  vxm_zarr_array array;
  int folder = open(input->name, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0)
    return vxm_fail_errno(error, input->name, "cannot read");
  vxm_status status = vxm_zarr_read_metadata(&array, folder, input, error);
  if (status == VXM_OK && field)
    status = load_values(field, &array, folder, input, error);
  else if (status == VXM_OK) {
    status = vxm_grid_create(grid, input->context, &array.space, error);
    if (status == VXM_OK)
      warn(&array, &(*grid)->warnings);
  }
  vxm_about_destroy(&array.about);
  if (status == VXM_OK && !stays(folder)) {
    status = vxm_fail_at(error, VXM_ERROR_IO, (vxm_place){input->name, 0, -1, -1},
                         "was replaced while it was read; read it again");
    if (field) {
      vxm_field_destroy(*field);
      *field = NULL;
    } else {
      vxm_grid_destroy(*grid);
      *grid = NULL;
    }
  }
  close(folder);
  return status;
}

vxm_status vxm_zarr_read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  return read_folder(out, NULL, input, error);
}

vxm_status vxm_zarr_read_bits(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  return rule == VXM_BITS_NONE ? read_folder(NULL, out, input, error)
                               : vxm_raster_bits_of_file(out, vxm_zarr_read_field, input, rule, error);
}
