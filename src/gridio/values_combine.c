/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/values_combine.h"
#include "base/hash.h"
#include "base/task_progress.h"
#include "base/threads.h"
#include "gridio/common/values_crop.h"

/* ---- Types ---- */

vxm_values_type vxm_values_result(vxm_values_type a) {
  return a.kind == VXM_FIELD_LABELS ? (vxm_values_type){a.kind, VXM_UINT16} : a;
}

static bool can_combine(vxm_values_type t) {
  switch (t.kind) {
  case VXM_FIELD_LABELS:
    return t.scalar == VXM_UINT8 || t.scalar == VXM_UINT16;
  case VXM_FIELD_DISTANCE:
    return t.scalar == VXM_FLOAT32 || t.scalar == VXM_FLOAT64;
  default:
    return true;
  }
}

static const char *kind_text(vxm_field_kind kind) {
  const char *name = vxm_field_kind_name(kind);
  return kind == VXM_FIELD_NUMBERS || !*name ? "numbers" : name;
}

vxm_status vxm_values_check(vxm_values_type a, vxm_values_type b, vxm_set_operation operation,
                            vxm_error *error) {
  vxm_values_type result = vxm_values_result(a), other = vxm_values_result(b);
  if ((unsigned)operation > VXM_SET_SYMMETRIC_DIFFERENCE)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "combine: operation %d is none of two fields", (int)operation);
  if (result.kind != other.kind || result.scalar != other.scalar)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "combine: the first has values of %s (%s) and the second of %s (%s); only values of one "
                    "kind and type go together",
                    kind_text(a.kind), vxm_scalar_name(a.scalar), kind_text(b.kind),
                    vxm_scalar_name(b.scalar));
  if (!can_combine(a) || !can_combine(b))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "combine: %s of %s cannot be combined; %s can",
                    kind_text(a.kind), vxm_scalar_name(can_combine(a) ? b.scalar : a.scalar),
                    a.kind == VXM_FIELD_LABELS ? "those of uint8 and uint16"
                                               : "those of float32 and float64");
  return VXM_OK;
}

/* ---- Values ---- */

/** Whether a voxel has a value: any but 0; of colours, any opacity but 0. */
static inline bool has_value(const unsigned char *value, vxm_values_type type, size_t size) {
  static const unsigned char none[8] = {0};
  if (type.kind == VXM_FIELD_COLORS)
    return value[3] != 0;
  if (memcmp(value, none, size) == 0)
    return false;
  float single;
  double whole;
  switch (type.scalar) { /* minus 0 is 0 */
  case VXM_FLOAT32:
    memcpy(&single, value, sizeof single);
    return single != 0;
  case VXM_FLOAT64:
    memcpy(&whole, value, sizeof whole);
    return whole != 0;
  default:
    return true;
  }
}

/** `size` is a constant where this is inlined. */
static inline void combine_sized(unsigned char *a, const unsigned char *b, size_t count, vxm_values_type type,
                                 vxm_set_operation operation, size_t size) {
  for (; count > 0; count--, a += size, b += size) {
    bool has_a = has_value(a, type, size), has_b = has_value(b, type, size), keeps = has_a, takes = false;
    switch (operation) {
    case VXM_SET_UNION:
      takes = !has_a && has_b;
      break;
    case VXM_SET_INTERSECTION:
      keeps = has_a && has_b;
      break;
    case VXM_SET_DIFFERENCE:
      keeps = has_a && !has_b;
      break;
    default:
      keeps = has_a && !has_b;
      takes = !has_a && has_b;
    }
    if (takes)
      memcpy(a, b, size);
    else if (!keeps)
      memset(a, 0, size);
  }
}

/** Of distances. */
#define COMBINE_DISTANCES(type)                                                                      \
  static void combine_##type##s(type *a, const type *b, size_t count, vxm_set_operation operation) { \
    for (size_t i = 0; i < count; i++) {                                                             \
      type least = a[i] < b[i] ? a[i] : b[i], most = a[i] < b[i] ? b[i] : a[i];                      \
      switch (operation) {                                                                           \
      case VXM_SET_UNION:                                                                            \
        a[i] = least;                                                                                \
        break;                                                                                       \
      case VXM_SET_INTERSECTION:                                                                     \
        a[i] = most;                                                                                 \
        break;                                                                                       \
      case VXM_SET_DIFFERENCE:                                                                       \
        a[i] = a[i] < -b[i] ? -b[i] : a[i];                                                          \
        break;                                                                                       \
      default:                                                                                       \
        a[i] = least < -most ? -most : least;                                                        \
      }                                                                                              \
    }                                                                                                \
  }
COMBINE_DISTANCES(float)
COMBINE_DISTANCES(double)

void vxm_values_combine(void *a, const void *b, size_t count, vxm_values_type type,
                        vxm_set_operation operation) {
  bool is_distance = type.kind == VXM_FIELD_DISTANCE;
  if (is_distance && type.scalar == VXM_FLOAT32)
    combine_floats(a, b, count, operation);
  else if (is_distance)
    combine_doubles(a, b, count, operation);
  else
    switch (vxm_values_bytes(type)) {
    case 1:
      combine_sized(a, b, count, type, operation, 1);
      break;
    case 2:
      combine_sized(a, b, count, type, operation, 2);
      break;
    case 4:
      combine_sized(a, b, count, type, operation, 4);
      break;
    default:
      combine_sized(a, b, count, type, operation, 8);
    }
}

void vxm_values_convert(void *out, const void *values, size_t count, vxm_values_type type,
                        const uint16_t *numbers) {
  if (type.kind != VXM_FIELD_LABELS) {
    memcpy(out, values, count * vxm_values_bytes(type));
    return;
  }
  const uint8_t *narrow = values;
  const uint16_t *wide = values;
  uint16_t *to = out;
  for (size_t i = 0; i < count; i++) {
    uint16_t label = type.scalar == VXM_UINT8 ? narrow[i] : wide[i];
    to[i] = numbers ? numbers[label] : label;
  }
}

/* ---- Labels ---- */

static uint64_t hash_of(const char *name) {
  uint64_t hash = 0;
  for (; *name; name++)
    hash = vxm_hash_word(hash, (unsigned char)*name);
  return hash;
}

/** The labels of a table by their names: label, 0 = free; open addressing. */
typedef struct name_index {
  uint32_t *slots;
  size_t mask;
} name_index;

/** The slot of a name, or a free one. */
static uint32_t *slot_of(const name_index *index, const vxm_label_table *table, const char *name) {
  size_t slot = (size_t)hash_of(name) & index->mask;
  while (index->slots[slot] && strcmp(vxm_label_table_name(table, index->slots[slot]), name) != 0)
    slot = (slot + 1) & index->mask;
  return &index->slots[slot];
}

vxm_status vxm_label_table_merge(vxm_label_table *to, uint16_t *numbers, const vxm_label_table *from,
                                 vxm_context *context, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  bool by_number = to->count == 0 || from->count == 0;
  name_index index = {NULL, 63};
  for (size_t n = 0; n < VXM_LABEL_NUMBERS; n++)
    numbers[n] = (uint16_t)n;
  while (index.mask < 2 * (to->count + from->count))
    index.mask = 2 * index.mask + 1;
  index.slots = vxm_calloc(context, index.mask + 1, sizeof *index.slots, &local);
  for (size_t label = to->count; label > 0 && index.slots; label--) /* of one name the lowest counts */
    if (*vxm_label_table_name(to, label))
      *slot_of(&index, to, vxm_label_table_name(to, label)) = (uint32_t)label;
  for (size_t label = 1; label <= from->count && local.code == VXM_OK; label++) {
    const char *name = vxm_label_table_name(from, label);
    uint32_t unnamed = 0,
             *slot = *name ? slot_of(&index, to, name) : &unnamed; /* each is a label of its own */
    if (by_number || !*slot) {
      if (to->count == VXM_LABELS_MAX)
        vxm_fail(&local, VXM_ERROR_RANGE, "combine: together they have more than %d labels", VXM_LABELS_MAX);
      else if (!vxm_label_table_add(to, context, name, 0))
        vxm_fail(&local, VXM_ERROR_MEMORY, "out of memory for the labels");
      else
        *slot = (uint32_t)to->count;
    }
    if (!by_number && label < VXM_LABEL_NUMBERS)
      numbers[label] = (uint16_t)*slot;
  }
  vxm_free(context, index.slots);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

/* ---- Fields ---- */

typedef struct job {
  const vxm_field *a, *b;
  vxm_field *out;
  vxm_values_type type; /**< of the result */
  vxm_set_operation operation;
  uint16_t *numbers;
  unsigned char *rows; /**< of each worker: a row of the second operand */
  vxm_task_progress progress;
} job;

static vxm_values_type type_of(const vxm_field *field) {
  return (vxm_values_type){field->about.kind, field->scalar};
}

static void combine_slice(size_t x, int worker, void *payload) {
  job *j = payload;
  const int64_t *dims = j->out->space.dims;
  size_t row = (size_t)dims[2], size = vxm_values_bytes(j->type);
  unsigned char *other = j->rows + (size_t)worker * row * size;
  if (vxm_task_progress_stopped(&j->progress, worker))
    return;
  for (size_t y = 0; y < (size_t)dims[1]; y++) {
    size_t first = (x * (size_t)dims[1] + y) * row;
    unsigned char *to = j->out->values + first * size;
    vxm_values_convert(to, j->a->values + first * vxm_field_voxel_bytes(j->a), row, type_of(j->a), NULL);
    vxm_values_convert(other, j->b->values + first * vxm_field_voxel_bytes(j->b), row, type_of(j->b),
                       j->numbers);
    vxm_values_combine(to, other, row, j->type, j->operation);
  }
  vxm_task_progress_step(&j->progress);
}

static vxm_status combine_all(job *j, vxm_error *error) {
  vxm_context *context = j->out->context;
  size_t slices = (size_t)j->out->space.dims[0], row = (size_t)j->out->space.dims[2];
  vxm_status status = VXM_OK;
  j->rows = vxm_try_alloc(context, (size_t)vxm_context_threads(context), row * vxm_values_bytes(j->type),
                          &status, error);
  if (!j->rows)
    return status;
  vxm_task_progress_start(&j->progress, context, "combining", slices, error);
  vxm_parallel(context, slices, combine_slice, j);
  vxm_free(context, j->rows);
  return vxm_task_progress_end(&j->progress);
}

/** Whether values of the second operand come into the result. */
static bool takes_second(vxm_set_operation operation) {
  return operation == VXM_SET_UNION || operation == VXM_SET_SYMMETRIC_DIFFERENCE;
}

static vxm_status merge_tables(job *j, vxm_label_table *table, vxm_error *error) {
  static const vxm_label_table none = {.count = 0};
  vxm_context *context = j->out->context;
  vxm_error local = VXM_ERROR_INIT;
  j->numbers = vxm_alloc(context, VXM_LABEL_NUMBERS, sizeof *j->numbers, &local);
  vxm_status status =
      j->numbers ? vxm_label_table_merge(table, j->numbers, &j->a->about.table, context, &local) : local.code;
  if (status == VXM_OK)
    status = vxm_label_table_merge(table, j->numbers, takes_second(j->operation) ? &j->b->about.table : &none,
                                   context, &local);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_gridio_combine_fields(vxm_field **out, const vxm_field *a, const vxm_field *b,
                                     vxm_set_operation operation, vxm_error *error) {
  job j = {.a = a, .b = b, .operation = operation, .type = vxm_values_result(type_of(a))};
  vxm_label_table table = {.context = a->context};
  vxm_status status = vxm_values_check(type_of(a), type_of(b), operation, error);
  if (status == VXM_OK)
    status = vxm_field_make(&j.out, a->context, &a->space, j.type.kind, j.type.scalar, error);
  if (status != VXM_OK)
    return status;
  j.out->about.is_declared = a->about.is_declared;
  if (j.type.kind == VXM_FIELD_LABELS)
    status = merge_tables(&j, &table, error);
  if (status == VXM_OK)
    status = combine_all(&j, error);
  if (status == VXM_OK && table.count > 0)
    status = vxm_field_add_table(j.out, &table, error);
  vxm_free(a->context, j.numbers);
  vxm_label_table_destroy(&table);
  return vxm_field_hand_over(out, j.out, status, error);
}
