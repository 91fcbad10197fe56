/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend augment --coverage: a file of numbers for each variant. */
#include "cli/augment.h"

#include <stdlib.h>

enum { BATCH_BYTES = 64 << 20 /**< of variants that are made at once */ };

static vxm_status write_file(cli_run *cli, const char *path, const vxm_space *space, const uint8_t *values,
                             const char *format) {
  vxm_grid_write_options options = VXM_GRID_WRITE_OPTIONS_INIT;
  vxm_field *field = NULL;
  options.format = format;
  vxm_status status =
      vxm_field_create(&field, cli->context, space, VXM_FIELD_COVERAGE, VXM_UINT8, values, &cli->error);
  if (status == VXM_OK)
    status = vxm_field_write(field, path, &options, &cli->error);
  vxm_field_destroy(field);
  return status;
}

vxm_status augment_write_numbers(cli_run *cli, const char *const *paths, vxm_sampler *sampler,
                                 const vxm_variant *variants, size_t count, const char *format,
                                 bool *written) {
  const size_t bytes = vxm_sampler_bytes(sampler, VXM_VOXEL_FORMAT_UINT8);
  const vxm_space space = vxm_sampler_space(sampler);
  size_t batch = BATCH_BYTES / bytes < 1 ? 1 : BATCH_BYTES / bytes;
  batch = batch < count ? batch : count;
  uint8_t *values = malloc(batch * bytes);
  vxm_status status = VXM_OK;
  if (!values) {
    status = cli->error.code = VXM_ERROR_MEMORY;
    snprintf(cli->error.text, sizeof cli->error.text, "out of memory for %zu variants: lower the resolution",
             batch);
  }
  for (size_t first = 0; first < count && status == VXM_OK; first += batch) {
    size_t some = count - first < batch ? count - first : batch;
    status = vxm_sampler_batch(values, sampler, variants + first, some, VXM_VOXEL_FORMAT_UINT8, &cli->error);
    for (size_t i = 0; i < some && status == VXM_OK; i++) {
      status = write_file(cli, paths[first + i], &space, values + i * bytes, format);
      written[first + i] = status == VXM_OK;
    }
  }
  free(values);
  return status;
}
