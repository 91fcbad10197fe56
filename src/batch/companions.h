/* SPDX-License-Identifier: BSD-3-Clause */
/** Files that were read beside a mesh: buffers, materials, textures. They decide about its outputs as it
 * does. */
#ifndef VXM_BATCH_COMPANIONS_H
#define VXM_BATCH_COMPANIONS_H

#include "batch/batch.h"

/**
 * What a journal tells of them: {"name", "bytes", "modified", "sha256"} of each.
 *
 * @param mesh  path of the mesh file
 * @param names as the mesh has them, relative to its folder; may repeat
 * @return an array, to be released, without those that cannot be read
 */
json_t *batch_companions_describe(const char *mesh, const json_t *names);
/** Whether they are as they were described: read again where their time is another. */
bool batch_companions_same(const char *mesh, const json_t *described);

#endif
