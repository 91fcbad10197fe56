/* SPDX-License-Identifier: BSD-3-Clause */
#include "sandbox/references.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/open_beneath.h"

/** More files than any model has; a file that asks for so many wants something else. */
enum { ASKED_MAX = 4096, NOTED_MAX = VXM_WARNINGS_MAX / 2 };

/** Why nothing is opened at all, or NULL. */
static const char *rule(const vxm_references *references) {
  if (references->allowed == VXM_EXTERNAL_NONE)
    return "--external none";
  if (references->allowed == VXM_EXTERNAL_FOLDER && references->folder < 0)
    return "a mesh that is not a file has no folder (--external any opens it)";
  if (references->allowed == VXM_EXTERNAL_FOLDER && !references->is_inside)
    return "the mesh itself is a link or a pipe, which has no folder (--external any opens it)";
  return NULL;
}

static const char *reason_of(int reason) {
  switch (reason) {
  case EXDEV:
  case ELOOP:
    return "it lies outside the folder of the mesh (--external any opens it)";
  case ENOENT:
  case ENOTDIR:
  case ENAMETOOLONG:
    return "there is no such file";
  case ENOTSUP:
  case ENXIO:
    return "it is not a regular file";
  case EACCES:
  case EPERM:
    return "permission denied";
  default:
    return "it cannot be opened";
  }
}

static int look_up(vxm_references *references, const char *name, uint64_t largest, uint64_t *size,
                   const char **reason) {
  bool is_free = references->allowed == VXM_EXTERNAL_ANY;
  int folder = references->folder >= 0 ? references->folder : AT_FDCWD;
  struct stat info;
  *reason = rule(references);
  if (*reason == NULL && references->asked > ASKED_MAX)
    *reason = "too many files are asked for";
  if (*reason)
    return -1;
  int descriptor = vxm_regular_open(folder, name, is_free ? VXM_BENEATH_NOT : VXM_BENEATH);
  if (descriptor < 0 || fstat(descriptor, &info) != 0) {
    *reason = reason_of(errno);
    return -1;
  }
  *size = (uint64_t)info.st_size;
  if (*size <= largest)
    return descriptor;
  close(descriptor);
  *reason = "it is larger than the memory for reading allows";
  return -1;
}

/** Quoted, and cut where it is too long for a line. */
static void describe(char *out, size_t size, const char *name, const char *reason) {
  enum { SHOWN = 120 };
  snprintf(out, size, "\"%.*s%s\", which it refers to, was not opened: %s", SHOWN, name,
           strlen(name) > SHOWN ? "..." : "", reason);
  for (char *c = out; *c; c++)
    if ((unsigned char)*c < ' ' || *c == 0x7f)
      *c = '?';
}

/** Libraries may ask for the same file again, also by another way to say the same. */
static void note_refusal(vxm_references *references, const char *name, const char *reason) {
  char line[VXM_WARNING_LENGTH];
  while (name[0] == '.' && name[1] == '/')
    name += 1 + strspn(name + 1, "/");
  describe(line, sizeof line, name, reason);
  if (references->refused++ == 0)
    memcpy(references->first, line, sizeof line);
  vxm_warnings *warnings = &references->warnings;
  for (int n = 0; n < warnings->count; n++)
    if (strcmp(warnings->text[n], line) == 0)
      return;
  if (warnings->count < NOTED_MAX - 1)
    vxm_warn(warnings, "%s", line);
  else {
    warnings->count = NOTED_MAX - 1; /* the last line is written anew */
    vxm_warn(warnings, "further files that it refers to were not opened (refused in all: %" PRIu64 ")",
             references->refused);
  }
}

int vxm_reference_open(vxm_references *references, const char *name, uint64_t largest, uint64_t *size) {
  const char *reason;
  references->asked++;
  *size = 0;
  int descriptor = look_up(references, name, largest, size, &reason);
  /* What is not noted is not read: who asks what a mesh is made of gets all of it. */
  if (descriptor >= 0 && references->soup && vxm_soup_add_companion(references->soup, name, NULL) != VXM_OK) {
    close(descriptor);
    descriptor = -1;
    reason = "there is no memory for it";
  }
  if (descriptor < 0)
    note_refusal(references, name, reason);
  return descriptor;
}
