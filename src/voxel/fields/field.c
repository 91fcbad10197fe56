/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/fields/field.h"

/** Bytes of bits and values that are made at once though more would fit; larger ones gain nothing. */
static const uint64_t most_bytes = UINT64_C(1) << 27;

static uint64_t saturating_sum(uint64_t a, uint64_t b) {
  return a > UINT64_MAX - b ? UINT64_MAX : a + b;
}

vxm_status vxm_field_plan_of(vxm_field_plan *out, const vxm_model *model, const vxm_space *space,
                             vxm_layout layout, int subdivision, bool centres, uint64_t fixed,
                             uint64_t value_bytes, int64_t least, vxm_error *error) {
  uint64_t left = vxm_memory_left(model->context);
  left = left == SIZE_MAX ? UINT64_MAX : left - left / 16;
  *out = (vxm_field_plan){.bits = vxm_window_of(space, layout, 0, 0)};
  int64_t length = out->bits.slow_dim / (subdivision > 0 ? subdivision : 1);
  uint64_t slice = out->bits.slice_words * sizeof(uint64_t) * (uint64_t)subdivision;
  uint64_t most = most_bytes / (slice + value_bytes + 1);
  for (int worst = 0; worst < 2; worst++) {
    vxm_memory_need need = {0, 0};
    if (subdivision > 0)
      need = vxm_model_memory_need(model, space, &out->bits, worst, centres);
    uint64_t beside = saturating_sum(need.fixed, fixed);
    uint64_t each = slice * (uint64_t)need.windows + value_bytes + 1;
    uint64_t room = left > beside ? (left - beside) / each : 0;
    int64_t slices = vxm_min(vxm_max((int64_t)(room < most ? room : most), least), length);
    uint64_t memory = saturating_sum(beside, (uint64_t)slices * each);
    if (slices > out->slices || (slices == out->slices && memory < out->memory)) {
      out->slices = slices;
      out->memory = memory;
    }
  }
  return vxm_memory_check(model->context, out->memory, "a number per voxel", error);
}
