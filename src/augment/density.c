/* SPDX-License-Identifier: BSD-3-Clause */
#include "augment/density.h"
#include "base/threads.h"
#include "voxel/fields/coverage_values.h"

typedef struct density_job {
  unsigned char *out;
  const vxm_window *window;
  int n;
  vxm_coverage_values values;
} density_job;

/** How many bits are set in each field of n bits. */
static uint64_t count_fields(uint64_t word, int n) {
  word -= word >> 1 & UINT64_C(0x5555555555555555);
  if (n == 2)
    return word;
  word = (word & UINT64_C(0x3333333333333333)) + (word >> 2 & UINT64_C(0x3333333333333333));
  return n == 4 ? word : (word + (word >> 4)) & UINT64_C(0x0f0f0f0f0f0f0f0f);
}

/** Every other field of n bits: sums of n * n of them have room in 2 n bits, as n cubed is below 4^n. */
static uint64_t every_other(int n) {
  return n == 2   ? UINT64_C(0x3333333333333333)
         : n == 4 ? UINT64_C(0x0f0f0f0f0f0f0f0f)
                  : UINT64_C(0x00ff00ff00ff00ff);
}

/** Stores the voxels of a word of n * n rows, from `at` on. */
static void store_word(const density_job *job, size_t at, size_t some, const uint64_t sums[2]) {
  const int n = job->n;
  const uint64_t field = vxm_low_bits(2 * (unsigned)n);
  for (size_t v = 0; v < some; v++) {
    size_t count = (size_t)(sums[v % 2] >> (v / 2 * 2 * (size_t)n) & field);
    if (job->values.scalar == VXM_UINT8)
      job->out[at + v] = job->values.bytes[count];
    else
      ((float *)(void *)job->out)[at + v] = job->values.fractions[count];
  }
}

static void write_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const density_job *job = payload;
  const vxm_window *window = job->window;
  const int n = job->n;
  const uint64_t mask = every_other(n);
  const size_t length = (size_t)window->fast_dim / (size_t)n, rows = (size_t)window->middle_dim / (size_t)n,
               in_word = 64 / (size_t)n;
  for (size_t row = 0; row < rows; row++)
    for (size_t w = 0; w < window->row_words; w++) {
      uint64_t sums[2] = {0, 0};
      for (int s = 0; s < n * n; s++) {
        const uint64_t *fine = vxm_window_row(window, (int64_t)row * n + s % n, (int64_t)slice * n + s / n);
        uint64_t counts = count_fields(fine[w], n);
        sums[0] += counts & mask;
        sums[1] += counts >> n & mask;
      }
      size_t begin = w * in_word, some = length - begin < in_word ? length - begin : in_word;
      store_word(job, (slice * rows + row) * length + begin, some, sums);
    }
}

void vxm_density_write(void *out, vxm_context *context, const vxm_window *window, int n,
                       vxm_voxel_format voxels) {
  density_job job = {.out = out, .window = window, .n = n};
  job.values = vxm_coverage_values_of(n, voxels == VXM_VOXEL_FORMAT_UINT8 ? VXM_UINT8 : VXM_FLOAT32);
  vxm_parallel(context, (size_t)window->slow_dim / (size_t)n, write_slice, &job);
}
