/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opencl/cl_cache.h"
#include "base/folders.h"
#include "base/hash.h"
#include "base/output.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH_BYTES = 1024 };

/** What a file begins with. */
typedef struct header {
  char magic[8];
  uint64_t key[2];
  uint64_t size, sum; /**< of the binary behind it */
} header;

static const char magic[8] = "VXMCL001";

static uint64_t sum_of(const unsigned char *data, size_t size, uint64_t seed) {
  uint64_t hash = vxm_hash_word(seed, size);
  for (size_t at = 0; at < size; at += sizeof(uint64_t)) {
    uint64_t word = 0;
    memcpy(&word, data + at, size - at < sizeof word ? size - at : sizeof word);
    hash = vxm_hash_word(hash, word);
  }
  return hash;
}

void vxm_cl_key_add(vxm_cl_key *key, const char *text) {
  for (int i = 0; i < 2; i++)
    key->hash[i] = sum_of((const unsigned char *)text, strlen(text), key->hash[i] + (uint64_t)i);
}

/** The folder, made if need be. */
static bool folder_of(char out[PATH_BYTES]) {
  const char *cache = vxm_folder_variable("XDG_CACHE_HOME"), *home = vxm_folder_variable("HOME");
  int used;
  if (cache)
    used = snprintf(out, PATH_BYTES, "%s", cache);
  else if (home)
    used = snprintf(out, PATH_BYTES, "%s/.cache", home);
  else
    return false;
  if (used < 0 || used >= PATH_BYTES - 16)
    return false;
  mkdir(out, 0700); /* what already is there stays as it is */
  if (!vxm_folder_is_safe(out))
    return false;
  strcat(out, "/voxmend");
  mkdir(out, 0700);
  /* A program is code: nobody else may have put it there. */
  struct stat found;
  return lstat(out, &found) == 0 && S_ISDIR(found.st_mode) && found.st_uid == geteuid() &&
         (found.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

static bool path_of(char out[PATH_BYTES + 64], const vxm_cl_key *key) {
  char folder[PATH_BYTES];
  if (!folder_of(folder))
    return false;
  snprintf(out, PATH_BYTES + 64, "%s/%016" PRIx64 "%016" PRIx64 ".clbin", folder, key->hash[0], key->hash[1]);
  return true;
}

unsigned char *vxm_cl_cache_load(const vxm_cl_key *key, vxm_context *context, size_t *size) {
  char path[PATH_BYTES + 64];
  vxm_input input;
  header head;
  unsigned char *binary = NULL;
  if (!path_of(path, key) || vxm_input_open(&input, context, path, NULL) != VXM_OK)
    return NULL;
  if (input.size > sizeof head) {
    memcpy(&head, input.data, sizeof head);
    const unsigned char *data = input.data + sizeof head;
    *size = input.size - sizeof head;
    if (memcmp(head.magic, magic, sizeof magic) == 0 && memcmp(head.key, key->hash, sizeof head.key) == 0 &&
        head.size == *size && head.sum == sum_of(data, *size, 0))
      binary = vxm_alloc(context, *size, 1, NULL);
    if (binary)
      memcpy(binary, data, *size);
  }
  vxm_input_close(&input);
  return binary;
}

void vxm_cl_cache_store(const vxm_cl_key *key, vxm_context *context, const unsigned char *binary,
                        size_t size) {
  char path[PATH_BYTES + 64];
  vxm_output *output;
  header head = {.size = size, .sum = sum_of(binary, size, 0)};
  memcpy(head.magic, magic, sizeof magic);
  memcpy(head.key, key->hash, sizeof head.key);
  if (!path_of(path, key) || vxm_output_open(&output, context, path, NULL) != VXM_OK)
    return;
  vxm_output_write(output, &head, sizeof head);
  vxm_output_write(output, binary, size);
  vxm_output_commit_now(output, NULL);
}
