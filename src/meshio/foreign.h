/* SPDX-License-Identifier: BSD-3-Clause */
/** Formats that are read through Assimp and OpenCASCADE: how to tell them, and who reads them. */
#ifndef VXM_MESHIO_FOREIGN_H
#define VXM_MESHIO_FOREIGN_H

#include "mesh/soup.h"

enum { VXM_FOREIGN_EXTENSIONS = 4 };

typedef struct vxm_foreign {
  const char *name; /**< as vxm_mesh_format says */
  const char *extensions[VXM_FOREIGN_EXTENSIONS];
  const char *hint; /**< extension that makes the library take content of this kind for what it is */
  bool (*sniff)(const unsigned char *data, size_t size); /**< NULL if the content does not tell */
  bool is_cad;                                           /**< read through OpenCASCADE, else through Assimp */
} vxm_foreign;

const vxm_foreign *vxm_foreign_by_content(const unsigned char *data, size_t size);
const vxm_foreign *vxm_foreign_by_extension(const char *extension);
/** By the name of a format; NULL if there is none. */
const vxm_foreign *vxm_foreign_by_name(const char *name);

/**
 * Reads into an empty soup through the library.
 *
 * @param format    NULL lets Assimp say whether it knows files with this extension
 * @param extension of the file, or what stands for it
 * @param name      of the file; those that it refers to are looked for beside it
 * @return as vxm_read_apart; VXM_ERROR_UNAVAILABLE without a message if `format` is NULL and Assimp is not
 *         there or does not know the extension
 */
vxm_status vxm_foreign_read(vxm_soup *soup, const vxm_foreign *format, const char *extension,
                            const unsigned char *data, size_t size, const char *name, double deflection,
                            vxm_error *error);

#endif
