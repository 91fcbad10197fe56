/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/values.h"
#include "base/endian.h"
#include "base/threads.h"

#include <string.h>

/* ---- Names ---- */

static const struct {
  const char *name;
  vxm_scalar scalar;
  char kind;
} scalars[] = {{"float64", VXM_FLOAT64, 'f'}, {"float32", VXM_FLOAT32, 'f'}, {"float16", VXM_FLOAT16, 'f'},
               {"uint8", VXM_UINT8, 'u'},     {"int8", VXM_INT8, 'i'},       {"uint16", VXM_UINT16, 'u'},
               {"int16", VXM_INT16, 'i'},     {"uint32", VXM_UINT32, 'u'},   {"int32", VXM_INT32, 'i'},
               {"uint64", VXM_UINT64, 'u'},   {"int64", VXM_INT64, 'i'}};

enum { SCALARS = sizeof scalars / sizeof scalars[0] };

static const char *const kinds[] = {"numbers", "distance", "coverage", "labels", "confidence", "colors"};

enum { FIELD_KINDS = sizeof kinds / sizeof kinds[0] };

const char *vxm_scalar_name(vxm_scalar scalar) {
  for (int s = 0; s < SCALARS; s++)
    if (scalars[s].scalar == scalar)
      return scalars[s].name;
  return "";
}

const char *vxm_field_kind_name(vxm_field_kind kind) {
  return (unsigned)kind < FIELD_KINDS ? kinds[kind] : "";
}

vxm_scalar vxm_scalar_of(char kind, size_t size) {
  for (int s = 0; s < SCALARS; s++)
    if (scalars[s].kind == kind && vxm_scalar_bytes(scalars[s].scalar) == size)
      return scalars[s].scalar;
  return VXM_UINT8;
}

bool vxm_scalar_find(vxm_scalar *out, const char *name) {
  for (int s = 0; s < SCALARS; s++)
    if (strcmp(scalars[s].name, name) == 0) {
      *out = scalars[s].scalar;
      return true;
    }
  return false;
}

bool vxm_field_kind_find(vxm_field_kind *out, const char *name) {
  for (int k = 0; k < FIELD_KINDS; k++)
    if (strcmp(kinds[k], name) == 0) {
      *out = (vxm_field_kind)k;
      return true;
    }
  return false;
}

vxm_status vxm_fail_numbers(vxm_error *error, const char *file, const char *what) {
  return vxm_fail_at(error, VXM_ERROR_NUMBERS, (vxm_place){file, 0, -1, -1},
                     "it holds numbers (%s), not set and clear voxels; make them so with 'voxmend convert "
                     "--threshold' or '--below' (in C vxm_field_read, vxm_field_threshold)",
                     what);
}

/* ---- What a file says ---- */

void vxm_about_name(vxm_about *about, const char *name) {
  vxm_field_kind kind = VXM_FIELD_NUMBERS;
  about->is_declared = name && vxm_field_kind_find(&kind, name) && kind != VXM_FIELD_NUMBERS;
  if (about->is_declared)
    about->kind = kind;
}

void vxm_about_destroy(vxm_about *about) {
  vxm_label_table_destroy(&about->table);
  vxm_metadata_destroy(&about->pairs);
}

bool vxm_about_may_be_bits(const vxm_about *about, vxm_bits_rule rule) {
  if (rule == VXM_BITS_NONE || !about->is_declared)
    return true;
  return rule == VXM_BITS_ANY && about->kind != VXM_FIELD_DISTANCE && about->kind != VXM_FIELD_CONFIDENCE &&
         about->kind != VXM_FIELD_COLORS;
}

void vxm_field_describe(vxm_field *field, vxm_about *about) {
  vxm_field_kind kind = field->about.kind;
  bool fits = about->is_declared && (about->kind == VXM_FIELD_COLORS) == (kind == VXM_FIELD_COLORS);
  field->about = *about;
  if (!fits) {
    field->about.kind = kind;
    field->about.is_declared = kind != VXM_FIELD_NUMBERS;
  }
  *about = (vxm_about){.is_declared = false};
}

/** The power of two that holds so many: blocks grow only when that changes. */
static size_t room_for(size_t count) {
  size_t room = 16;
  while (room < count)
    room *= 2;
  return room;
}

/** A block with room for `count` items, of which `had` are there; NULL without memory. */
static void *grow(vxm_context *context, void *block, size_t had, size_t count, size_t size) {
  return block && room_for(had) == room_for(count) ? block
                                                   : vxm_realloc(context, block, room_for(count), size, NULL);
}

bool vxm_label_table_add(vxm_label_table *table, vxm_context *context, const char *name, int64_t voxels) {
  size_t had = 0, length = strlen(name) + 1, l = table->count;
  if (l > 0)
    had = table->name[l - 1] + strlen(vxm_label_table_name(table, l)) + 1;
  table->context = context;
  char *text = grow(context, table->text, had, had + length, 1);
  if (text)
    table->text = text;
  size_t *names = grow(context, table->name, l, l + 1, sizeof *names);
  if (names)
    table->name = names;
  int64_t *counts = grow(context, table->voxels, l, l + 1, sizeof *counts);
  if (counts)
    table->voxels = counts;
  if (!text || !names || !counts)
    return false;
  memcpy(text + had, name, length);
  names[l] = had;
  counts[l] = voxels;
  table->count++;
  return true;
}

vxm_status vxm_field_put_label(vxm_field *field, const char *name, int64_t voxels, vxm_error *error) {
  bool is_there = vxm_label_table_add(&field->about.table, field->context, name, voxels);
  return is_there ? VXM_OK : vxm_fail(error, VXM_ERROR_MEMORY, "field: no room for another label");
}

vxm_status vxm_field_put_pair(vxm_field *field, const char *key, const char *value, vxm_error *error) {
  bool is_there =
      vxm_metadata_add(&field->about.pairs, field->context, key, strlen(key), value, strlen(value));
  return is_there ? VXM_OK : vxm_fail(error, VXM_ERROR_RANGE, "field: no room for more metadata");
}

/* ---- Life ---- */

typedef void *(*allocate_fn)(vxm_context *context, size_t count, size_t size, vxm_error *error);

static vxm_status make_by(allocate_fn allocate, vxm_field **out, vxm_context *context, const vxm_space *space,
                          vxm_field_kind kind, vxm_scalar scalar, vxm_error *error) {
  *out = NULL;
  int channels = kind == VXM_FIELD_COLORS ? 4 : 1;
  uint64_t voxels = (uint64_t)space->dims[0] * (uint64_t)space->dims[1] * (uint64_t)space->dims[2],
           size = vxm_scalar_bytes(scalar) * (size_t)channels,
           bytes = voxels > UINT64_MAX / size ? UINT64_MAX : voxels * size;
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = vxm_memory_check(context, bytes, "a number per voxel", error);
  if (status != VXM_OK)
    return status;
  vxm_field *field = vxm_calloc(context, 1, sizeof *field, &local);
  unsigned char *values = field ? allocate(context, (size_t)voxels, (size_t)size, &local) : NULL;
  vxm_context *owner = NULL;
  if (values)
    vxm_context_acquire(&owner, context, &local);
  if (!owner) {
    vxm_free(context, values);
    vxm_free(context, field);
    vxm_error_pass(error, &local);
    return local.code;
  }
  *field = (vxm_field){.context = owner,
                       .space = *space,
                       .scalar = scalar,
                       .channels = channels,
                       .values = values,
                       .about = {.kind = kind}};
  *out = field;
  return VXM_OK;
}

vxm_status vxm_field_make(vxm_field **out, vxm_context *context, const vxm_space *space, vxm_field_kind kind,
                          vxm_scalar scalar, vxm_error *error) {
  return make_by(vxm_alloc, out, context, space, kind, scalar, error);
}

vxm_status vxm_field_make_zeros(vxm_field **out, vxm_context *context, const vxm_space *space,
                                vxm_field_kind kind, vxm_scalar scalar, vxm_error *error) {
  return make_by(vxm_calloc, out, context, space, kind, scalar, error);
}

void vxm_field_destroy(vxm_field *field) {
  if (!field)
    return;
  vxm_context *context = field->context;
  vxm_about_destroy(&field->about);
  vxm_free(context, field->values);
  vxm_free(context, field);
  vxm_context_release(context);
}

/* ---- Numbers as doubles ---- */

#define AS_DOUBLES(type, convert)                           \
  do {                                                      \
    const type *from = (const type *)field->values + begin; \
    for (size_t n = 0; n < count; n++)                      \
      out[n] = (double)convert(from[n]);                    \
  } while (0)

void vxm_field_doubles(double *out, const vxm_field *field, size_t begin, size_t count) {
  if (field->channels == 4) {
    for (size_t n = 0; n < count; n++)
      out[n] = field->values[4 * (begin + n) + 3];
    return;
  }
  switch (field->scalar) {
  case VXM_FLOAT64:
    AS_DOUBLES(double, );
    break;
  case VXM_FLOAT32:
    AS_DOUBLES(float, );
    break;
  case VXM_FLOAT16:
    AS_DOUBLES(uint16_t, vxm_half_value);
    break;
  case VXM_UINT8:
    AS_DOUBLES(uint8_t, );
    break;
  case VXM_INT8:
    AS_DOUBLES(int8_t, );
    break;
  case VXM_UINT16:
    AS_DOUBLES(uint16_t, );
    break;
  case VXM_INT16:
    AS_DOUBLES(int16_t, );
    break;
  case VXM_UINT32:
    AS_DOUBLES(uint32_t, );
    break;
  case VXM_INT32:
    AS_DOUBLES(int32_t, );
    break;
  case VXM_UINT64:
    AS_DOUBLES(uint64_t, );
    break;
  case VXM_INT64:
    AS_DOUBLES(int64_t, );
    break;
  }
}

/* ---- Order ---- */

/** One way through a field: slices across z on one side, all of it on the other. */
typedef struct turning {
  const vxm_field *field;
  unsigned char *to;
  const unsigned char *from;
  int64_t begin, end; /**< slices across z */
  bool is_put, is_swapped;
} turning;

static inline __attribute__((always_inline)) void copy_block(unsigned char *to, size_t to_step,
                                                             const unsigned char *from, size_t from_step,
                                                             size_t count, size_t size) {
  for (size_t n = 0; n < count; n++)
    memcpy(to + n * to_step, from + n * from_step, size);
}

static void copy_step(unsigned char *to, size_t to_step, const unsigned char *from, size_t from_step,
                      size_t count, size_t size) {
  switch (size) {
  case 1:
    copy_block(to, to_step, from, from_step, count, 1);
    break;
  case 2:
    copy_block(to, to_step, from, from_step, count, 2);
    break;
  case 4:
    copy_block(to, to_step, from, from_step, count, 4);
    break;
  default:
    copy_block(to, to_step, from, from_step, count, 8);
  }
}

/** One row j: the square of all i and the slices, in pieces that stay in the cache. */
static void turn_row(size_t task, int worker, void *payload) {
  enum { PIECE = 32 };
  (void)worker;
  const turning *t = payload;
  const int64_t *n = t->field->space.dims;
  size_t size = vxm_field_voxel_bytes(t->field), scalar = vxm_scalar_bytes(t->field->scalar), j = task,
         nx = (size_t)n[0], ny = (size_t)n[1], nz = (size_t)n[2], slices = (size_t)(t->end - t->begin);
  for (size_t i = 0; i < nx; i += PIECE)
    for (size_t k = 0; k < slices; k += PIECE)
      for (size_t x = i; x < nx && x < i + PIECE; x++) {
        size_t count = slices - k < PIECE ? slices - k : PIECE;
        size_t in_field = ((x * ny + j) * nz + (size_t)t->begin + k) * size,
               in_file = ((k * ny + j) * nx + x) * size, step = nx * ny * size;
        if (t->is_put) {
          copy_step(t->to + in_field, size, t->from + in_file, step, count, size);
          if (t->is_swapped)
            vxm_swap_each(t->to + in_field, count * size / scalar, scalar);
        } else
          copy_step(t->to + in_file, step, t->from + in_field, size, count, size);
      }
}

void vxm_field_put_slices(vxm_field *field, const unsigned char *data, int64_t begin, int64_t end,
                          bool is_swapped) {
  turning t = {field, field->values, data, begin, end, true, is_swapped};
  vxm_parallel(field->context, (size_t)field->space.dims[1], turn_row, &t);
}

void vxm_field_take_slices(unsigned char *out, const vxm_field *field, int64_t begin, int64_t end) {
  turning t = {field, out, field->values, begin, end, false, false};
  vxm_parallel(field->context, (size_t)field->space.dims[1], turn_row, &t);
}

static void copy_slice(size_t task, int worker, void *payload) {
  (void)worker;
  const turning *t = payload;
  size_t scalar = vxm_scalar_bytes(t->field->scalar),
         bytes =
             (size_t)(t->field->space.dims[1] * t->field->space.dims[2]) * vxm_field_voxel_bytes(t->field);
  memcpy(t->to + task * bytes, t->from + task * bytes, bytes);
  if (t->is_swapped)
    vxm_swap_each(t->to + task * bytes, bytes / scalar, scalar);
}

void vxm_field_put_all(vxm_field *field, const unsigned char *data, bool is_swapped) {
  turning t = {.field = field, .to = field->values, .from = data, .is_swapped = is_swapped};
  vxm_parallel(field->context, (size_t)field->space.dims[0], copy_slice, &t);
}

void vxm_field_put_grid(vxm_field *field, const vxm_grid *grid) {
  vxm_grid_unpack(grid, field->values);
}
