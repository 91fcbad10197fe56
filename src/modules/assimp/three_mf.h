/* SPDX-License-Identifier: BSD-3-Clause */
/** 3MF: what Assimp passes over without a word is refused, but for the unit, which is applied. */
#ifndef VXM_MODULES_ASSIMP_THREE_MF_H
#define VXM_MODULES_ASSIMP_THREE_MF_H

#include "sandbox/reader.h"

/**
 * Looks at the models of an archive: whether objects lie in files of their own (the production extension),
 * which Assimp looks for in the main file, and whether an extension is required that makes another shape.
 *
 * @param unit becomes what the model says that its coordinates are in, in millimetres: 1 where it says
 * nothing
 * @return VXM_OK, also for what is damaged; VXM_ERROR_FORMAT; VXM_ERROR_MEMORY
 */
vxm_status vxm_three_mf_check(double *unit, const vxm_reader_request *request, vxm_context *context,
                              vxm_error *error);

/**
 * Makes an archive that Assimp can read: with minizip 1.1 it finds nothing where numbers have 64 bits, as
 * lib3mf writes them all.
 *
 * @param out becomes a block of the context in place of the file's data, of the same size; NULL if Assimp can
 * read it as it is
 */
vxm_status vxm_three_mf_narrow(unsigned char **out, const vxm_reader_request *request, vxm_context *context,
                               vxm_error *error);

#endif
