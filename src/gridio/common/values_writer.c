/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/values_writer.h"
#include "base/endian.h"
#include "base/file_transaction.h"

#include <string.h>

/** More than a vxm_output takes, its buffer included. */
enum { OUTPUT_BYTES = 72 << 10 };

static size_t slice_values(const vxm_space *space, vxm_layout layout) {
  return (size_t)(space->dims[layout.fast] * space->dims[layout.middle]);
}

static size_t voxel_bytes(const vxm_values_spec *values) {
  return vxm_scalar_bytes(values->scalar) * (size_t)values->channels;
}

uint64_t vxm_values_plain_bytes(const vxm_space *space, const vxm_values_spec *values) {
  return vxm_space_voxels(space) * voxel_bytes(values);
}

vxm_scalar vxm_values_no_halves(vxm_scalar scalar) {
  return scalar == VXM_FLOAT16 ? VXM_FLOAT32 : scalar;
}

void vxm_values_widen_halves(void *out, const vxm_field *slice, size_t count) {
  float *wide = out;
  for (size_t v = 0; v < count; v++) {
    uint16_t bits;
    memcpy(&bits, slice->values + 2 * v, sizeof bits);
    wide[v] = vxm_half_value(bits);
  }
}

uint64_t vxm_values_writer_bytes(const vxm_values_writer_kind *kind, const vxm_space *space,
                                 const vxm_values_spec *values) {
  return sizeof(vxm_values_writer) + (kind->has_sidecar ? 2 : 1) * (uint64_t)OUTPUT_BYTES +
         (kind->held_bytes ? kind->held_bytes(space, values) : 0);
}

/* ---- A file in the making ---- */

static const vxm_sidecar_text *text_of(const vxm_values_writer *w) {
  const vxm_values_writer_kind *kind = w->kind;
  if (!kind->has_sidecar && w->values.about->table.count == 0)
    return NULL;
  return w->values.channels == 4 && kind->color_sidecar ? kind->color_sidecar : kind->sidecar;
}

static vxm_status open_files(vxm_values_writer *w, vxm_error *error) {
  const vxm_values_writer_kind *kind = w->kind;
  vxm_status status = kind->has_own_files ? VXM_OK : vxm_output_open(&w->output, w->context, w->path, error);
  if (status == VXM_OK && w->output && kind->file_bytes)
    status = vxm_output_expect(w->output, kind->file_bytes(&w->space, &w->values), error);
  if (status == VXM_OK)
    status = kind->begin(w, error);
  return status;
}

vxm_status vxm_values_writer_open(vxm_values_writer *out, const vxm_values_writer_kind *kind,
                                  vxm_context *context, const vxm_space *space, const vxm_values_spec *values,
                                  const char *path, vxm_error *error) {
  *out = (vxm_values_writer){.context = context,
                             .kind = kind,
                             .path = path,
                             .space = *space,
                             .values = *values,
                             .slice_bytes = slice_values(space, kind->layout) * voxel_bytes(values)};
  vxm_status status = open_files(out, error);
  if (status != VXM_OK)
    vxm_values_writer_abort(out);
  return status;
}

/** After a failed write; says why. */
static vxm_status give_up(vxm_values_writer *w, vxm_error *error) {
  vxm_output *output = w->output;
  w->output = NULL;
  return vxm_output_commit(output, error);
}

static bool has_failed(const vxm_values_writer *w) {
  return w->output && vxm_output_failed(w->output);
}

vxm_status vxm_values_writer_put(vxm_values_writer *w, const void *values, int64_t begin, int64_t end,
                                 vxm_error *error) {
  if (begin != w->next)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "slices: they are not next");
  w->next = end;
  if (!w->kind->put)
    return vxm_values_writer_put_bytes(w, values, (size_t)(end - begin) * w->slice_bytes, error);
  vxm_status status = w->kind->put(w, values, begin, end, error);
  return has_failed(w) ? give_up(w, error) : status;
}

static void put_little(vxm_values_writer *w, const void *bytes, size_t size) {
  if (w->kind->put_bytes)
    w->kind->put_bytes(w, bytes, size);
  else
    vxm_output_write(w->output, bytes, size);
}

void vxm_values_writer_pass(vxm_values_writer *w, const void *values, size_t size) {
  enum { ROOM = 4096 };
  unsigned char room[ROOM];
  const size_t each = vxm_scalar_bytes(w->values.scalar);
  const unsigned char *from = values;
  if (each == 1 || !vxm_must_swap(false)) {
    put_little(w, values, size);
    return;
  }
  while (size > 0) {
    size_t some = size < ROOM ? size : ROOM;
    memcpy(room, from, some);
    vxm_swap_each(room, some / each, each);
    put_little(w, room, some);
    from += some;
    size -= some;
  }
}

vxm_status vxm_values_writer_put_bytes(vxm_values_writer *w, const void *bytes, size_t size,
                                       vxm_error *error) {
  const size_t piece = (size_t)1 << 24; /* so that a full disk is noticed */
  const char *from = bytes;
  while (size > 0 && !has_failed(w)) {
    size_t some = size < piece ? size : piece;
    vxm_values_writer_pass(w, from, some);
    from += some;
    size -= some;
  }
  return has_failed(w) ? give_up(w, error) : VXM_OK;
}

/** Gives the files of a kind their names, and the one beside them. */
static vxm_status commit_kept(vxm_values_writer *w, vxm_error *error) {
  vxm_status status = w->sidecar ? vxm_output_keep(w->sidecar, &w->kept, error) : VXM_OK;
  w->sidecar = NULL;
  if (status != VXM_OK)
    return status;
  vxm_file_transaction_file *list = w->kept;
  w->kept = NULL;
  return vxm_file_transaction_take(w->context, list, error);
}

static void close_state(vxm_values_writer *w) {
  if (w->kind && w->kind->drop)
    w->kind->drop(w);
  vxm_free(w->context, w->state);
  *w = (vxm_values_writer){0};
}

vxm_status vxm_values_writer_commit(vxm_values_writer *w, vxm_error *error) {
  vxm_status status = w->kind->end ? w->kind->end(w, error) : VXM_OK;
  const vxm_sidecar_text *text = text_of(w);
  if (status != VXM_OK && has_failed(w))
    status = give_up(w, error);
  /* Only now: a table of labels may have been made together with them. */
  if (status == VXM_OK && text)
    status = vxm_sidecar_open(&w->sidecar, w->context, &w->space, w->path, text, w->values.about, error);
  if (status == VXM_OK) {
    if (w->kept)
      status = commit_kept(w, error);
    else if (w->output)
      status = vxm_output_commit_both(w->output, w->sidecar, error);
    else if (w->sidecar)
      status = vxm_output_commit(w->sidecar, error);
    w->output = w->sidecar = NULL;
  }
  if (status == VXM_OK && !text)
    vxm_sidecar_remove_labels(w->context, w->path); /* which would name the labels of what was there before */
  vxm_values_writer_abort(w);
  return status;
}

void vxm_values_writer_abort(vxm_values_writer *w) {
  if (!w->kind)
    return;
  vxm_output_abort(w->sidecar);
  vxm_output_abort(w->output);
  vxm_file_transaction_drop(w->kept);
  close_state(w);
}

/* ---- Whole fields ---- */

/** A slice across x, y fastest. */
static void turn_slice(unsigned char *out, const vxm_field *field, int64_t x) {
  size_t ny = (size_t)field->space.dims[1], nz = (size_t)field->space.dims[2],
         size = vxm_field_voxel_bytes(field);
  const unsigned char *from = field->values + (size_t)x * ny * nz * size;
  for (size_t y = 0; y < ny; y++)
    for (size_t z = 0; z < nz; z++, from += size)
      memcpy(out + (z * ny + y) * size, from, size);
}

/** A slice in the order of a layout: in `room`, or, where the field has that order, in the field itself. */
static const unsigned char *take_slice(unsigned char *room, const vxm_field *field, vxm_layout layout,
                                       int64_t slice) {
  if (vxm_layout_is_grid(layout))
    vxm_field_take_slices(room, field, slice, slice + 1);
  else if (layout.fast == 1)
    turn_slice(room, field, slice);
  else
    return field->values + (size_t)slice * slice_values(&field->space, layout) * vxm_field_voxel_bytes(field);
  return room;
}

/** Room for a slice as it is in the field, and as it is put; NULL where none is needed. */
typedef struct slice_room {
  unsigned char *turned, *stored;
} slice_room;

static vxm_status put_slices(vxm_values_writer *w, const vxm_field *field, const slice_room *room,
                             vxm_error *error) {
  size_t count = slice_values(&field->space, w->kind->layout);
  int64_t slices = field->space.dims[w->kind->layout.slow];
  vxm_status status = VXM_OK;
  for (int64_t s = 0; s < slices && status == VXM_OK; s++) {
    const unsigned char *slice = take_slice(room->turned, field, w->kind->layout, s);
    if (room->stored) {
      vxm_field part = *field;
      part.values = (unsigned char *)slice;
      w->kind->convert(room->stored, &part, count);
      slice = room->stored;
    }
    status = vxm_values_writer_put(w, slice, s, s + 1, error);
    if (status == VXM_OK)
      status = vxm_progress(field->context, "writing", (double)(s + 1) / (double)slices, error);
  }
  return status;
}

vxm_status vxm_values_write_field(const vxm_values_writer_kind *kind, const vxm_field *field,
                                  const char *path, vxm_error *error) {
  vxm_values_spec spec = {.scalar = kind->stored ? kind->stored(field->scalar) : field->scalar,
                          .channels = field->channels,
                          .about = &field->about};
  bool is_turned = kind->layout.fast != 2, is_converted = spec.scalar != field->scalar;
  size_t count = slice_values(&field->space, kind->layout);
  vxm_values_writer writer = {0};
  slice_room room = {NULL, NULL};
  vxm_error local = VXM_ERROR_INIT;
  if (is_turned)
    room.turned = vxm_alloc(field->context, count, vxm_field_voxel_bytes(field), &local);
  if (is_converted && local.code == VXM_OK)
    room.stored = vxm_alloc(field->context, count, voxel_bytes(&spec), &local);
  vxm_status status = local.code;
  if (status == VXM_OK)
    status = vxm_values_writer_open(&writer, kind, field->context, &field->space, &spec, path, &local);
  if (status == VXM_OK)
    status = put_slices(&writer, field, &room, &local);
  if (status == VXM_OK)
    status = vxm_values_writer_commit(&writer, &local);
  else
    vxm_values_writer_abort(&writer);
  vxm_free(field->context, room.stored);
  vxm_free(field->context, room.turned);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
