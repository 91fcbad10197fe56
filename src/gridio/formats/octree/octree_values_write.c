/* SPDX-License-Identifier: BSD-3-Clause */
/** .octree of values as they are made: slices are kept until they make a strip. */
#include "grid/octree_build.h"
#include "gridio/formats/octree/octree_values.h"

typedef struct state {
  vxm_octree_encoder *encoder;
  unsigned char *kept; /**< slices begin to end - 1; NULL = none has been kept so far */
  int64_t begin, end;
} state;

static vxm_status begin(vxm_values_writer *w, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  state *s = vxm_calloc(w->context, 1, sizeof *s, &local);
  w->state = s;
  if (s)
    vxm_octree_encoder_create(&s->encoder, w->context, &w->space, &w->values, &local);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

/** Keeps a slice, and encodes those that are kept once they make a strip. */
static vxm_status keep(vxm_values_writer *w, const unsigned char *slice, vxm_error *error) {
  state *s = w->state;
  vxm_status status = VXM_OK;
  if (!s->kept)
    s->kept = vxm_try_alloc(w->context, (size_t)vxm_min(VXM_STRIP_VOXELS, w->space.dims[2]), w->slice_bytes,
                            &status, error);
  if (!s->kept)
    return status;
  memcpy(s->kept + (size_t)(s->end - s->begin) * w->slice_bytes, slice, w->slice_bytes);
  s->end++;
  if (s->end % VXM_STRIP_VOXELS != 0 && s->end != w->space.dims[2])
    return VXM_OK;
  status = vxm_octree_encoder_put(s->encoder, s->kept, s->begin, s->end, error);
  s->begin = s->end;
  return status;
}

/** Whole strips come as they are, others by way of the slices that are kept. */
static vxm_status put(vxm_values_writer *w, const void *values, int64_t first, int64_t end,
                      vxm_error *error) {
  state *s = w->state;
  const unsigned char *at = values;
  vxm_status status = VXM_OK;
  for (int64_t slice = first; slice < end && status == VXM_OK;) {
    int64_t whole = end == w->space.dims[2] ? end - slice : (end - slice) & -VXM_STRIP_VOXELS;
    if (slice % VXM_STRIP_VOXELS == 0 && whole > 0) {
      status = vxm_octree_encoder_put(s->encoder, at, slice, slice + whole, error);
      s->begin = s->end = slice + whole;
    } else {
      whole = 1;
      status = keep(w, at, error);
    }
    slice += whole;
    at += (size_t)whole * w->slice_bytes;
  }
  return status;
}

vxm_status vxm_octree_values_make(vxm_values_writer *w, const vxm_node_maker *maker, vxm_error *error) {
  state *s = w->state;
  return vxm_octree_encoder_make(s->encoder, maker, error);
}

static vxm_status end(vxm_values_writer *w, vxm_error *error) {
  state *s = w->state;
  return vxm_octree_encoder_end(s->encoder, w->output, error);
}

static void drop(vxm_values_writer *w) {
  state *s = w->state;
  if (!s)
    return;
  vxm_octree_encoder_destroy(s->encoder);
  vxm_free(w->context, s->kept);
}

/** What is known before: the slices that are kept. The octree follows what it is of. */
static uint64_t held_bytes(const vxm_space *space, const vxm_values_spec *values) {
  return VXM_STRIP_VOXELS * (uint64_t)space->dims[0] * (uint64_t)space->dims[1] *
         vxm_scalar_bytes(values->scalar) * (uint64_t)values->channels;
}

const vxm_values_writer_kind vxm_octree_values = {
    .layout = VXM_LAYOUT_GRID,
    .holds = VXM_HOLDS_NUMBERS | VXM_HOLDS_LABELS | VXM_HOLDS_COLORS,
    .sidecar = &vxm_sidecar_labels,
    .held_bytes = held_bytes,
    .begin = begin,
    .put = put,
    .end = end,
    .drop = drop,
};
