/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * run NAME.dict [FILE...]: a fuzz target without libFuzzer, over its corpus, over the damaged meshes of
 * shared/ where those are at hand, and over mutations of the corpus with the words of its dictionary, the
 * same on every run; or over the files and folders that are given.
 */
#include "fuzz.h"

#include "base/module.h"
#include "base/rng.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
  SEEDS_MAX = 256,
  SEED_BYTES = 1 << 16,
  PATH_BYTES = 2048,
  WORDS_MAX = 128,
  WORD_BYTES = 64,
  SKIPPED = 77
};
/** How many mutations; of foreign formats each starts a process. */
enum { MUTATIONS = 10000, SLOW_MUTATIONS = 8 };

typedef struct seed {
  uint8_t *data;
  size_t size;
} seed;

static seed seeds[SEEDS_MAX];
static size_t seed_count;
static const fuzz_target *target;

static void run_one(const uint8_t *data, size_t size) {
  target->run(target->name, data, size);
}

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
    run_one(data, size);
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

/* ---- The dictionary ---- */

typedef struct word {
  uint8_t bytes[WORD_BYTES];
  size_t size;
} word;

static word words[WORDS_MAX];
static size_t word_count;

/** The bytes of a line "..." with \\, \" and \xAB in it; false for other lines. */
static bool read_word(word *out, const char *line) {
  const char *at = strchr(line, '"');
  if (line[0] == '#' || !at)
    return false;
  out->size = 0;
  for (at++; *at && *at != '"' && out->size < WORD_BYTES; out->size++) {
    char code[3] = "";
    if (at[0] == '\\' && at[1] == 'x' && at[2] && at[3]) {
      memcpy(code, at + 2, 2);
      out->bytes[out->size] = (uint8_t)strtoul(code, NULL, 16);
      at += 4;
    } else {
      at += at[0] == '\\' && at[1];
      out->bytes[out->size] = (uint8_t)*at++;
    }
  }
  return out->size > 0;
}

static void read_words(const char *path) {
  FILE *file = fopen(path, "r");
  char line[512];
  while (file && word_count < WORDS_MAX && fgets(line, sizeof line, file))
    word_count += read_word(&words[word_count], line);
  if (file)
    fclose(file);
  if (word_count > 0)
    return;
  fprintf(stderr, "%s: no words\n", path);
  exit(1);
}

/* ---- Mutations ---- */

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
  const word *token = &words[vxm_rng_below(rng, word_count)];
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
    replace(data, length, at, cut, token->bytes, token->size);
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
  int most = target->is_slow ? SLOW_MUTATIONS : MUTATIONS;
  for (int i = 0; buffer && i < most; i++) {
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
    run_one(data, length);
    free(data);
  }
  free(buffer);
}

/** The target that a dictionary is named after. */
static const fuzz_target *target_of(const char *dictionary) {
  const char *slash = strrchr(dictionary, '/'), *own = slash ? slash + 1 : dictionary;
  char name[32];
  snprintf(name, sizeof name, "%.*s", (int)strcspn(own, "."), own);
  return fuzz_find(name);
}

static bool has_module(void) {
  const vxm_module_need need = {target->module, "", "fuzzing"};
  char path[VXM_MODULE_PATH_MAX];
  return !target->module || vxm_module_find(path, &need, NULL) == VXM_OK;
}

static void run_given(char **paths) {
  for (; *paths; paths++)
    if (run_folder(*paths, false) == 0) {
      size_t size;
      uint8_t *data = load(*paths, &size);
      run_one(data, size);
      free(data);
    }
}

static int run_corpus(void) {
  const char *source = getenv("SRCDIR");
  char folder[PATH_BYTES];
  snprintf(folder, sizeof folder, "%s/tests/fuzz/corpus/%s", source ? source : ".", target->name);
  if (run_folder(folder, true) == 0) {
    fprintf(stderr, "%s: no seeds\n", folder);
    return 1;
  }
  snprintf(folder, sizeof folder, "%s/../shared/meshes/malformed", source ? source : ".");
  if (!target->is_slow)
    run_folder(folder, false);
  /* Folders have no order of their own. */
  qsort(seeds, seed_count, sizeof *seeds, by_content);
  run_mutations();
  for (size_t s = 0; s < seed_count; s++)
    free(seeds[s].data);
  return 0;
}

int main(int argc, char **argv) {
  target = argc > 1 ? target_of(argv[1]) : NULL;
  if (!target) {
    fprintf(stderr, "usage: run TARGET.dict [FILE...]\n");
    return 2;
  }
  if (!has_module())
    return SKIPPED;
  if (argc > 2) {
    run_given(argv + 2);
    return 0;
  }
  read_words(argv[1]);
  return run_corpus();
}
