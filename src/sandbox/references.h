/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Files that a mesh file refers to, such as the buffers of a glTF. The process that reads the mesh opens
 * nothing itself: it asks for them by the names that stand in the file, and we decide. The name may be a
 * stranger's, and what it leads to anything at all.
 */
#ifndef VXM_SANDBOX_REFERENCES_H
#define VXM_SANDBOX_REFERENCES_H

#include "base/context.h"
#include "base/warnings.h"
#include "mesh/soup.h"

/** Where the files of a mesh may lie, and what was asked for so far. Start from VXM_REFERENCES_NONE. */
typedef struct vxm_references {
  vxm_external allowed;
  int folder;       /**< of the mesh file; AT_FDCWD, or -1 if there is none */
  bool is_inside;   /**< the mesh file itself lies in it: not somewhere else, at the end of a link */
  uint64_t asked;   /**< how many times */
  uint64_t refused; /**< of them */
  char first[VXM_WARNING_LENGTH]; /**< the first that was refused, and why */
  vxm_warnings warnings;          /**< a line for each that was refused, as far as there is room */
  vxm_soup *soup;                 /**< which notes what was opened, or NULL */
} vxm_references;

/** For a mesh that is in memory. */
#define VXM_REFERENCES_NONE \
  { .folder = -1 }

/**
 * Opens what is asked for, or notes in a warning that it is refused.
 *
 * @param largest bytes that may be handed over
 * @return a descriptor of a regular file with its size, or -1
 */
int vxm_reference_open(vxm_references *references, const char *name, uint64_t largest, uint64_t *size);

#endif
