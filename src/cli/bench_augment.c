/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The phases that make variants for training, in Ogayar et al.'s three ways: each by a process of its own
 * (standard), many by one process (batch), both through files that are read back, and within this process
 * (direct).
 */
#include "cli/bench.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { DIRECT_MOST = 64, DIRECT_BYTES = 1 << 26, BATCH_MOST = 16, PATH_SIZE = 512 };

struct bench_augment {
  char folder[PATH_SIZE]; /**< for files; "" = none */
  char program[PATH_SIZE];
  vxm_sampler *sampler;
  void *voxels;
  uint64_t file_bytes; /**< of all files of the last run */
};

static vxm_status fail(bench_stage *stage, vxm_status code, const char *what, int reason) {
  vxm_error *error = &stage->cli->error;
  *error = (vxm_error)VXM_ERROR_INIT;
  error->code = code;
  snprintf(error->text, sizeof error->text, "%.200s: %.100s", what, strerror(reason));
  return code;
}

static vxm_status begin(bench_stage *stage, int64_t variants) {
  stage->variants = variants;
  stage->augment = calloc(1, sizeof *stage->augment);
  return stage->augment ? VXM_OK : fail(stage, VXM_ERROR_MEMORY, "out of memory", ENOMEM);
}

static vxm_status begin_sampler(bench_stage *stage) {
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  options.resolution = stage->space.dims[0];
  options.rotation = VXM_ROTATION_ANY;
  options.scale = 0.5;
  options.displace = stage->displace;
  options.mirror = 7;
  options.translate = 1;
  vxm_voxelize_options voxelize = VXM_VOXELIZE_OPTIONS_INIT;
  voxelize.engine = stage->engines[stage->engine];
  options.voxelize = &voxelize;
  vxm_error *error = &stage->cli->error;
  vxm_status status = vxm_sampler_create(&stage->augment->sampler, stage->cli->context, &options, error);
  return status == VXM_OK ? vxm_sampler_put(stage->augment->sampler, 0, stage->mesh, error) : status;
}

static vxm_status begin_folder(bench_stage *stage) {
  bench_augment *augment = stage->augment;
  const char *parent = secure_getenv("TMPDIR");
  snprintf(augment->folder, sizeof augment->folder, "%s/voxmend-bench.XXXXXX",
           parent && *parent == '/' ? parent : "/tmp");
  if (mkdtemp(augment->folder))
    return VXM_OK;
  int reason = errno;
  vxm_status status = fail(stage, VXM_ERROR_IO, augment->folder, reason);
  augment->folder[0] = '\0';
  return status;
}

static void name_file(char path[2 * PATH_SIZE], const bench_augment *augment, uint32_t index) {
  snprintf(path, 2 * PATH_SIZE, "%s/%06" PRIu32 ".rle", augment->folder, index);
}

/** Reads a file back, as the one who trains would. */
static vxm_status read_back(bench_stage *stage, uint32_t index) {
  char path[2 * PATH_SIZE];
  struct stat info;
  vxm_grid *grid;
  name_file(path, stage->augment, index);
  vxm_status status = vxm_grid_read(&grid, stage->cli->context, path, &stage->cli->error);
  if (status != VXM_OK)
    return status;
  vxm_grid_destroy(grid);
  if (stat(path, &info) == 0)
    stage->augment->file_bytes += (uint64_t)info.st_size;
  unlink(path);
  return VXM_OK;
}

/** The variant that a run begins with. */
static uint32_t first_of(const bench_stage *stage) {
  return (uint32_t)(stage->run * stage->variants);
}

/* ---- Standard ---- */

vxm_status bench_begin_standard(bench_stage *stage) {
  vxm_status status = begin(stage, 1);
  if (status == VXM_OK)
    status = begin_folder(stage);
  if (status != VXM_OK)
    return status;
  ssize_t length = readlink("/proc/self/exe", stage->augment->program, PATH_SIZE - 1);
  return length > 0 ? VXM_OK : fail(stage, VXM_ERROR_UNAVAILABLE, "/proc/self/exe", errno);
}

vxm_status bench_run_standard(bench_stage *stage) {
  bench_augment *augment = stage->augment;
  char resolution[24], threads[16], first[16], displace[32];
  snprintf(resolution, sizeof resolution, "%" PRId64, stage->space.dims[0]);
  snprintf(threads, sizeof threads, "%d", stage->threads);
  snprintf(first, sizeof first, "%" PRIu32, first_of(stage));
  snprintf(displace, sizeof displace, "%.17g", stage->displace);
  char *const arguments[] = {"voxmend",
                             "augment",
                             "-q",
                             "-n",
                             "1",
                             "-r",
                             resolution,
                             "--first",
                             first,
                             "--rotate",
                             "any",
                             "--scale",
                             "0.5",
                             "--mirror",
                             "xyz",
                             "--translate",
                             "1",
                             "--displace",
                             displace,
                             "--threads",
                             threads,
                             "--engine",
                             (char *)(uintptr_t)vxm_engine_describe(stage->engines[0])->name,
                             "-o",
                             augment->folder,
                             "--",
                             (char *)(uintptr_t)stage->path,
                             NULL};
  pid_t process;
  int ended = 0, reason = posix_spawn(&process, augment->program, NULL, NULL, arguments, environ);
  if (reason != 0)
    return fail(stage, VXM_ERROR_IO, augment->program, reason);
  while (waitpid(process, &ended, 0) < 0 && errno == EINTR)
    ;
  if (!WIFEXITED(ended) || WEXITSTATUS(ended) != 0)
    return fail(stage, VXM_ERROR_IO, "voxmend augment failed", ECHILD);
  augment->file_bytes = 0;
  return read_back(stage, first_of(stage));
}

/* ---- Batch ---- */

vxm_status bench_begin_batch(bench_stage *stage) {
  vxm_status status = begin(stage, BATCH_MOST);
  if (status == VXM_OK)
    status = begin_folder(stage);
  return status == VXM_OK ? begin_sampler(stage) : status;
}

vxm_status bench_run_batch(bench_stage *stage) {
  bench_augment *augment = stage->augment;
  static char names[BATCH_MOST][2 * PATH_SIZE];
  const char *paths[BATCH_MOST];
  vxm_variant variants[BATCH_MOST];
  size_t count = (size_t)stage->variants;
  augment->file_bytes = 0;
  for (size_t i = 0; i < count; i++) {
    variants[i] = (vxm_variant){0, 0, first_of(stage) + (uint32_t)i};
    name_file(names[i], augment, variants[i].index);
    paths[i] = names[i];
  }
  vxm_status status =
      vxm_sampler_files(paths, augment->sampler, variants, count, NULL, NULL, &stage->cli->error);
  for (size_t i = 0; i < count && status == VXM_OK; i++)
    status = read_back(stage, variants[i].index);
  return status;
}

/* ---- Direct ---- */

vxm_status bench_begin_direct(bench_stage *stage) {
  int64_t n = stage->space.dims[0], bytes = n * n * n * (int64_t)sizeof(float);
  int64_t count = DIRECT_BYTES / bytes;
  count = count < 1 ? 1 : count > DIRECT_MOST ? DIRECT_MOST : count;
  vxm_status status = begin(stage, count);
  if (status == VXM_OK)
    status = begin_sampler(stage);
  if (status != VXM_OK)
    return status;
  stage->augment->voxels = malloc((size_t)(count * bytes));
  return stage->augment->voxels ? VXM_OK : fail(stage, VXM_ERROR_MEMORY, "out of memory", ENOMEM);
}

vxm_status bench_run_direct(bench_stage *stage) {
  vxm_variant variants[DIRECT_MOST];
  for (uint32_t i = 0; i < (uint32_t)stage->variants; i++)
    variants[i] = (vxm_variant){0, 0, first_of(stage) + i};
  return vxm_sampler_batch(stage->augment->voxels, stage->augment->sampler, variants, (size_t)stage->variants,
                           VXM_VOXEL_FORMAT_FLOAT32, &stage->cli->error);
}

/* ---- After ---- */

void bench_tell_augment(bench_output *out, const bench_stage *stage) {
  out->bytes = stage->augment->file_bytes / (uint64_t)stage->variants;
}

/** Removes a folder with what a run that failed has left in it. */
static void empty_folder(const char *folder) {
  DIR *files = *folder ? opendir(folder) : NULL;
  if (!files)
    return;
  for (const struct dirent *file; (file = readdir(files));)
    unlinkat(dirfd(files), file->d_name, 0);
  closedir(files);
  rmdir(folder);
}

void bench_augment_end(bench_stage *stage) {
  bench_augment *augment = stage->augment;
  stage->augment = NULL;
  stage->variants = 0;
  if (!augment)
    return;
  empty_folder(augment->folder);
  vxm_sampler_destroy(augment->sampler);
  free(augment->voxels);
  free(augment);
}
