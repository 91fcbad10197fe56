/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/digest.h"

#include <errno.h>
#include <fcntl.h>
#include <nettle/base16.h>
#include <nettle/sha2.h>
#include <unistd.h>

static void finish(char out[BATCH_DIGEST], struct sha256_ctx *state) {
  uint8_t digest[SHA256_DIGEST_SIZE];
  sha256_digest(state, sizeof digest, digest);
  base16_encode_update(out, sizeof digest, digest);
  out[BATCH_DIGEST - 1] = '\0';
}

void batch_digest(char out[BATCH_DIGEST], const void *data, size_t size) {
  struct sha256_ctx state;
  sha256_init(&state);
  sha256_update(&state, size, data);
  finish(out, &state);
}

bool batch_digest_open(char out[BATCH_DIGEST], uint64_t *bytes, int descriptor) {
  static uint8_t block[1 << 16];
  struct sha256_ctx state;
  sha256_init(&state);
  *bytes = 0;
  for (;;) {
    ssize_t got = pread(descriptor, block, sizeof block, (off_t)*bytes);
    if (got < 0 && errno == EINTR)
      continue;
    if (got < 0)
      return false;
    if (got == 0)
      break;
    sha256_update(&state, (size_t)got, block);
    *bytes += (uint64_t)got;
  }
  finish(out, &state);
  return true;
}

bool batch_digest_file(char out[BATCH_DIGEST], uint64_t *bytes, const char *path) {
  int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe by that name is not waited for */
  if (descriptor < 0)
    return false;
  bool good = batch_digest_open(out, bytes, descriptor);
  close(descriptor);
  return good;
}
