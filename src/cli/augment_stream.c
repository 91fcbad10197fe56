/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend augment -o -: variants as records of equal size. All numbers are little-endian. */
#include "cli/augment.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

enum {
  HEADER_BYTES = 64,
  NAME_BYTES = 16, /**< before the voxels of each record: model, epoch, index, 0 */
  VERSION = 1,
  BATCH_BYTES = 8 << 20,
  BATCH_MOST = 256
};

static unsigned char *put(unsigned char *at, uint64_t value, int bytes) {
  for (int b = 0; b < bytes; b++)
    *at++ = (unsigned char)(value >> (8 * b));
  return at;
}

static bool write_header(const augment_request *given, size_t voxel_bytes) {
  unsigned char header[HEADER_BYTES] = "VOXMEND";
  unsigned char *at = header + 8;
  at = put(at, VERSION, 4);
  at = put(at, HEADER_BYTES, 4);
  at = put(at, (uint64_t)given->sampler.resolution, 4);
  at = put(at, (uint64_t)given->voxels, 4);
  at = put(at, NAME_BYTES + voxel_bytes, 8);
  at = put(at, (uint64_t)given->count, 8);
  at = put(at, given->sampler.seed, 8);
  at = put(at, given->variant.model, 4);
  at = put(at, given->variant.epoch, 4);
  put(at, (uint64_t)given->first, 8);
  return fwrite(header, 1, sizeof header, stdout) == sizeof header;
}

/** What a stream holds while it is written. */
typedef struct stream {
  const augment_request *given;
  vxm_sampler *sampler;
  size_t voxel_bytes, batch;
  unsigned char *voxels;
  vxm_variant *variants;
} stream;

/** Floats are written as the machine has them, and turned round where that is the other way. */
static void turn_floats(unsigned char *bytes, size_t count) {
  const uint16_t one = 1;
  if (*(const unsigned char *)&one == 1)
    return;
  for (size_t i = 0; i + 4 <= count; i += 4) {
    unsigned char swap[4] = {bytes[i + 3], bytes[i + 2], bytes[i + 1], bytes[i]};
    memcpy(bytes + i, swap, 4);
  }
}

static bool write_records(const stream *s, size_t count) {
  if (s->given->voxels == VXM_VOXEL_FORMAT_FLOAT32)
    turn_floats(s->voxels, count * s->voxel_bytes);
  for (size_t i = 0; i < count; i++) {
    unsigned char name[NAME_BYTES] = {0};
    put(put(put(name, s->variants[i].model, 4), s->variants[i].epoch, 4), s->variants[i].index, 4);
    if (fwrite(name, 1, sizeof name, stdout) != sizeof name ||
        fwrite(s->voxels + i * s->voxel_bytes, 1, s->voxel_bytes, stdout) != s->voxel_bytes)
      return false;
  }
  return true;
}

/** A reader that has enough closes its end; of a stream without one that is how it ends. */
static int end_of_writing(cli_run *cli, const stream *s) {
  int reason = errno;
  if (reason == EPIPE && s->given->count == 0) {
    clearerr(stdout);
    return CLI_DONE;
  }
  return cli_fail_text(cli, "<stdout>: cannot write: %s", strerror(reason));
}

static int write_all(cli_run *cli, stream *s, int64_t *made) {
  uint64_t index = (uint64_t)s->given->first;
  uint64_t end = s->given->count > 0 ? index + (uint64_t)s->given->count : (uint64_t)UINT32_MAX + 1;
  if (!write_header(s->given, s->voxel_bytes))
    return end_of_writing(cli, s);
  while (index < end) {
    size_t count = end - index < s->batch ? (size_t)(end - index) : s->batch;
    for (size_t i = 0; i < count; i++) {
      s->variants[i] = s->given->variant;
      s->variants[i].index = (uint32_t)(index + i);
    }
    if (vxm_sampler_batch(s->voxels, s->sampler, s->variants, count, s->given->voxels, &cli->error) != VXM_OK)
      return cli_fail(cli);
    if (!write_records(s, count))
      return end_of_writing(cli, s);
    index += count;
    *made = (int64_t)(index - (uint64_t)s->given->first);
  }
  return fflush(stdout) == 0 ? CLI_DONE : end_of_writing(cli, s);
}

/** A stream of known length that goes into a file needs room on its disk. */
static int check_room(cli_run *cli, const stream *s) {
  struct stat info;
  struct statvfs disk;
  char needed[24], room[24];
  if (s->given->count == 0 || fstat(STDOUT_FILENO, &info) != 0 || !S_ISREG(info.st_mode) ||
      fstatvfs(STDOUT_FILENO, &disk) != 0 || disk.f_blocks == 0)
    return CLI_DONE;
  double wanted = (double)s->given->count * (double)(s->voxel_bytes + NAME_BYTES);
  double available = (double)disk.f_frsize * (double)(geteuid() == 0 ? disk.f_bfree : disk.f_bavail);
  return wanted <= available
             ? CLI_DONE
             : cli_fail_text(cli, "<stdout>: cannot write: %s are needed, and %s are free on its disk",
                             cli_bytes_text(needed, (uint64_t)(wanted < 1e19 ? wanted : 1e19)),
                             cli_bytes_text(room, (uint64_t)available));
}

int augment_stream(cli_run *cli, const augment_request *given, vxm_sampler *sampler, int64_t *made) {
  stream s = {.given = given, .sampler = sampler, .voxel_bytes = vxm_sampler_bytes(sampler, given->voxels)};
  s.batch = BATCH_BYTES / s.voxel_bytes;
  s.batch = s.batch < 1 ? 1 : s.batch > BATCH_MOST ? BATCH_MOST : s.batch;
  s.voxels = malloc(s.batch * s.voxel_bytes);
  s.variants = malloc(s.batch * sizeof *s.variants);
  *made = 0;
  signal(SIGPIPE, SIG_IGN); /* write fails instead */
  int status = check_room(cli, &s) != CLI_DONE ? CLI_FAILED
               : s.voxels && s.variants        ? write_all(cli, &s, made)
                                        : cli_fail_text(cli, "out of memory for %zu variants", s.batch);
  free(s.voxels);
  free(s.variants);
  return status;
}
