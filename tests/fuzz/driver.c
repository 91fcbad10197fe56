/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Runs a fuzz target without libFuzzer: over its corpus, over the damaged meshes of shared/ where those are
 * at hand, and over some thousand mutations of the corpus, the same on every run.
 */
#include "fuzz_mesh.h"

#include "base/rng.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEEDS_MAX = 256, SEED_BYTES = 1 << 16, MUTATIONS = 10000, PATH_BYTES = 2048 };

typedef struct seed {
  uint8_t *data;
  size_t size;
} seed;

static seed seeds[SEEDS_MAX];
static size_t seed_count;

static uint8_t *load(const char *path, size_t *size) {
  FILE *file = fopen(path, "rb");
  if (!file || fseek(file, 0, SEEK_END) != 0) {
    perror(path);
    exit(1);
  }
  long end = ftell(file);
  rewind(file);
  uint8_t *data = malloc(end > 0 ? (size_t)end : 1);
  *size = data ? fread(data, 1, (size_t)end, file) : 0;
  fclose(file);
  if (!data || *size != (size_t)end) {
    fprintf(stderr, "%s: cannot read\n", path);
    exit(1);
  }
  return data;
}

/** Runs all files of a folder; small ones become seeds if asked for. Returns how many there were. */
static int run_folder(const char *folder, bool keep) {
  DIR *dir = opendir(folder);
  if (!dir)
    return 0;
  int files = 0;
  for (struct dirent *entry; (entry = readdir(dir)) != NULL;) {
    if (entry->d_name[0] == '.')
      continue;
    char path[PATH_BYTES];
    snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
    size_t size;
    uint8_t *data = load(path, &size);
    LLVMFuzzerTestOneInput(data, size);
    files++;
    if (keep && seed_count < SEEDS_MAX && size <= SEED_BYTES)
      seeds[seed_count++] = (seed){data, size};
    else
      free(data);
  }
  closedir(dir);
  return files;
}

static int by_content(const void *a, const void *b) {
  const seed *x = a, *y = b;
  if (x->size != y->size)
    return x->size < y->size ? -1 : 1;
  return memcmp(x->data, y->data, x->size);
}

/** Numbers and words at which readers stumble. */
static const char *const tokens[] = {"0",
                                     "-1",
                                     "1",
                                     "2147483648",
                                     "4294967295",
                                     "nan",
                                     "1e9",
                                     "4294967296",
                                     "18446744073709551616",
                                     "-",
                                     "\n",
                                     "#",
                                     "\\\n",
                                     "999999999999999999",
                                     "1e-400",
                                     "\r\n",
                                     " ",
                                     "f",
                                     "v",
                                     "0x1p3"};

/** Puts `size` bytes in place of the `cut` bytes at `at`, as far as the buffer has room. */
static void replace(uint8_t *data, size_t *length, size_t at, size_t cut, const void *bytes, size_t size) {
  if (*length - cut + size > SEED_BYTES)
    return;
  memmove(data + at + size, data + at + cut, *length - at - cut);
  memcpy(data + at, bytes, size);
  *length = *length - cut + size;
}

static void mutate(vxm_rng *rng, uint8_t *data, size_t *length) {
  size_t at = (size_t)vxm_rng_below(rng, *length + 1), rest = *length - at;
  size_t cut = (size_t)vxm_rng_below(rng, rest < 32 ? rest + 1 : 32);
  const seed *other = &seeds[vxm_rng_below(rng, seed_count)];
  const char *token = tokens[vxm_rng_below(rng, sizeof tokens / sizeof *tokens)];
  uint8_t piece[64];
  switch (vxm_rng_below(rng, 7)) {
  case 0: /* one bit */
    if (rest > 0)
      data[at] ^= (uint8_t)(1u << vxm_rng_below(rng, 8));
    break;
  case 1: /* one byte */
    if (rest > 0)
      data[at] = (uint8_t)vxm_rng_next(rng);
    break;
  case 2: /* a number of four bytes that is large or negative */
    if (rest >= 4)
      memcpy(data + at, vxm_rng_below(rng, 2) ? "\xff\xff\xff\xff" : "\xff\xff\xff\x7f", 4);
    break;
  case 3:
    replace(data, length, at, cut, token, strlen(token));
    break;
  case 4: /* a piece is left out, or the end is */
    replace(data, length, at, vxm_rng_below(rng, 4) ? cut : rest, "", 0);
    break;
  case 5: /* a piece again */
    cut = cut < sizeof piece ? cut : sizeof piece;
    memcpy(piece, data + at, cut);
    replace(data, length, at, 0, piece, cut);
    break;
  default: /* the end of another file */
    if (other->size > 0) {
      size_t from = (size_t)vxm_rng_below(rng, other->size);
      replace(data, length, at, rest, other->data + from, other->size - from);
    }
    break;
  }
}

static void run_mutations(void) {
  uint8_t *buffer = malloc(SEED_BYTES);
  vxm_rng rng = {1};
  for (int i = 0; buffer && i < MUTATIONS; i++) {
    const seed *from = &seeds[vxm_rng_below(&rng, seed_count)];
    size_t length = from->size;
    memcpy(buffer, from->data, length);
    for (uint64_t times = 1 + vxm_rng_below(&rng, 4); times > 0; times--)
      mutate(&rng, buffer, &length);
    /* A block of just this size, so that a sanitizer sees what is read beyond it. */
    uint8_t *data = malloc(length ? length : 1);
    if (!data)
      break;
    memcpy(data, buffer, length);
    LLVMFuzzerTestOneInput(data, length);
    free(data);
  }
  free(buffer);
}

int main(int argc, char **argv) {
  const char *source = getenv("SRCDIR");
  char folder[PATH_BYTES];
  for (int i = 1; i < argc; i++)
    if (run_folder(argv[i], false) == 0) {
      size_t size;
      uint8_t *data = load(argv[i], &size);
      LLVMFuzzerTestOneInput(data, size);
      free(data);
    }
  if (argc > 1)
    return 0;
  snprintf(folder, sizeof folder, "%s/tests/fuzz/corpus/%s", source ? source : ".", fuzz_corpus);
  if (run_folder(folder, true) == 0) {
    fprintf(stderr, "%s: no seeds\n", folder);
    return 1;
  }
  snprintf(folder, sizeof folder, "%s/../shared/meshes/malformed", source ? source : ".");
  run_folder(folder, false);
  /* Folders have no order of their own. */
  qsort(seeds, seed_count, sizeof *seeds, by_content);
  run_mutations();
  for (size_t s = 0; s < seed_count; s++)
    free(seeds[s].data);
  return 0;
}
