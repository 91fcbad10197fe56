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
  at = put(at, (uint64_t)given->count * (uint64_t)given->model_of, 8);
  at = put(at, given->sampler.seed, 8);
  at = put(at, given->variant.model, 4);
  at = put(at, given->variant.epoch, 4);
  put(at, (uint64_t)given->first, 8);
  return fwrite(header, 1, sizeof header, stdout) == sizeof header;
}

struct augment_stream {
  vxm_sampler *sampler;
  vxm_voxel_format format;
  bool is_endless, is_left; /**< its reader has enough */
  size_t voxel_bytes, batch;
  unsigned char *voxels;
  vxm_variant *variants;
};

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

static bool write_records(const augment_stream *s, size_t count) {
  if (s->format == VXM_VOXEL_FORMAT_FLOAT32)
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

/** After a failed write. A stream without end is to end so: its reader has enough and closes the pipe. */
static int end_of_writing(cli_run *cli, augment_stream *s) {
  int reason = errno;
  s->is_left = reason == EPIPE && s->is_endless;
  if (s->is_left) {
    clearerr(stdout);
    return CLI_DONE;
  }
  return cli_fail_text(cli, "<stdout>: cannot write: %s", strerror(reason));
}

/** A stream of known length that goes into a file needs room on its disk. */
static int check_room(cli_run *cli, const augment_request *given, size_t voxel_bytes) {
  struct stat info;
  struct statvfs disk;
  char needed[24], room[24];
  if (given->count == 0 || fstat(STDOUT_FILENO, &info) != 0 || !S_ISREG(info.st_mode) ||
      fstatvfs(STDOUT_FILENO, &disk) != 0 || disk.f_blocks == 0)
    return CLI_DONE;
  double wanted = (double)given->count * (double)given->model_of * (double)(voxel_bytes + NAME_BYTES);
  double available = (double)disk.f_frsize * (double)(geteuid() == 0 ? disk.f_bfree : disk.f_bavail);
  return wanted <= available
             ? CLI_DONE
             : cli_fail_text(cli, "<stdout>: cannot write: %s are needed, and %s are free on its disk",
                             cli_bytes_text(needed, (uint64_t)(wanted < 1e19 ? wanted : 1e19)),
                             cli_bytes_text(room, (uint64_t)available));
}

static void drop(augment_stream *s) {
  free(s->voxels);
  free(s->variants);
  free(s);
}

int augment_stream_open(cli_run *cli, augment_stream **out, const augment_request *given,
                        vxm_sampler *sampler) {
  const size_t bytes = vxm_sampler_bytes(sampler, given->voxels);
  *out = NULL;
  if (check_room(cli, given, bytes) != CLI_DONE)
    return CLI_FAILED;
  augment_stream *s = calloc(1, sizeof *s);
  if (!s)
    return cli_fail_text(cli, "out of memory");
  s->sampler = sampler;
  s->format = given->voxels;
  s->is_endless = given->count == 0;
  s->voxel_bytes = bytes;
  s->batch = BATCH_BYTES / bytes;
  s->batch = s->batch < 1 ? 1 : s->batch > BATCH_MOST ? BATCH_MOST : s->batch;
  s->voxels = malloc(s->batch * bytes);
  s->variants = malloc(s->batch * sizeof *s->variants);
  signal(SIGPIPE, SIG_IGN); /* write fails instead */
  int status = !s->voxels || !s->variants   ? cli_fail_text(cli, "out of memory for %zu variants", s->batch)
               : write_header(given, bytes) ? CLI_DONE
                                            : end_of_writing(cli, s);
  if (status == CLI_DONE)
    *out = s;
  else
    drop(s);
  return status;
}

int augment_stream_write(cli_run *cli, augment_stream *s, const augment_request *given, int64_t *made) {
  uint64_t index = (uint64_t)given->first;
  uint64_t end = given->count > 0 ? index + (uint64_t)given->count : (uint64_t)UINT32_MAX + 1;
  *made = 0;
  while (index < end && !s->is_left) {
    size_t count = end - index < s->batch ? (size_t)(end - index) : s->batch;
    for (size_t i = 0; i < count; i++) {
      s->variants[i] = given->variant;
      s->variants[i].index = (uint32_t)(index + i);
    }
    if (vxm_sampler_batch(s->voxels, s->sampler, s->variants, count, s->format, &cli->error) != VXM_OK)
      return cli_fail(cli);
    if (!write_records(s, count))
      return end_of_writing(cli, s);
    index += count;
    *made = (int64_t)(index - (uint64_t)given->first);
  }
  return CLI_DONE;
}

int augment_stream_close(cli_run *cli, augment_stream *s, int status) {
  if (!s)
    return status;
  if (status == CLI_DONE && !s->is_left && fflush(stdout) != 0)
    status = end_of_writing(cli, s);
  drop(s);
  return status;
}
