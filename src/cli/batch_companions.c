/* SPDX-License-Identifier: BSD-3-Clause */
/** Files beside a mesh that it refers to, and those that options name. */
#include "batch/inputs.h"
#include "batch/outputs.h"
#include "cli/batch.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

/* ---- Whether there are any ---- */

/** Reads `size` bytes from `from` on, or those that there are; -1 with errno. */
static ssize_t read_at(int file, char *out, size_t size, off_t from) {
  ssize_t got;
  do
    got = pread(file, out, size, from);
  while (got < 0 && errno == EINTR);
  return got;
}

/** Whether a word stands in a file from its beginning to `end`; true where it cannot be read. */
static bool has_word(int file, const char *word, off_t end) {
  static char block[1 << 16];
  const size_t length = strlen(word);
  for (off_t at = 0; at < end;) {
    size_t wanted = end - at < (off_t)sizeof block ? (size_t)(end - at) : sizeof block;
    ssize_t got = read_at(file, block, wanted, at);
    if (got < 0 || (got > 0 && memmem(block, (size_t)got, word, length)))
      return true;
    if ((size_t)got < length)
      return false;
    at += got - (ssize_t)length + 1; /* it may stand across the end of a block */
  }
  return false;
}

/** Where the text of a .glb ends, in which names of files stand; the whole file where it is none. */
static off_t end_of_json(const unsigned char head[20]) {
  if (memcmp(head, "glTF", 4) != 0 || memcmp(head + 16, "JSON", 4) != 0)
    return (off_t)1 << 62;
  return 20 + ((off_t)head[12] | (off_t)head[13] << 8 | (off_t)head[14] << 16 | (off_t)head[15] << 24);
}

bool batch_refers_to_others(const char *path, bool with_colors) {
  unsigned char head[20] = {0};
  int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0)
    return true;
  bool refers = read_at(file, (char *)head, sizeof head, 0) < 0;
  /* as meshes are read: by content, whatever the name */
  if (!refers && (memcmp(head, "glTF", 4) == 0 || strcasecmp(batch_extension(path), "glb") == 0))
    refers = has_word(file, "\"uri\"", end_of_json(head));
  else if (!refers && with_colors)
    refers = has_word(file, "mtllib", (off_t)1 << 62);
  close(file);
  return refers;
}

/* ---- Files of options ---- */

/** The digest of a file or folder, to be released; NULL if it is not there. */
static json_t *describe(const char *path) {
  const char *slash = strrchr(path, '/');
  char *folder = slash ? strndup(path, (size_t)(slash - path)) : strdup(".");
  json_t *described = folder ? batch_output_describe(folder, slash ? slash + 1 : path) : NULL;
  free(folder);
  return described;
}

char *batch_file_digest(const char *path) {
  char *beside = NULL, *text = NULL;
  json_t *file = describe(path), *json = asprintf(&beside, "%s.json", path) >= 0 ? describe(beside) : NULL;
  const char *digest = batch_json_text(file, "sha256"), *other = batch_json_text(json, "sha256");
  if (digest && asprintf(&text, "%s%s%s", digest, other ? " " : "", other ? other : "") < 0)
    text = NULL;
  json_decref(file);
  json_decref(json);
  free(beside);
  return text;
}
