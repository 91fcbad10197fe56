/* SPDX-License-Identifier: BSD-3-Clause */
/** Formats that are read through Assimp and OpenCASCADE: how to tell them, and who reads them. */
#ifndef VXM_MESHIO_EXTERNAL_EXTERNAL_FORMATS_H
#define VXM_MESHIO_EXTERNAL_EXTERNAL_FORMATS_H

#include "mesh/soup.h"
#include "sandbox/reader.h"
#include "sandbox/references.h"

enum { VXM_EXTERNAL_EXTENSIONS = 4 };

/* The extensions of the table, for those who ask what is read (a test compares them). */
#define VXM_ASSIMP_FORMATS "gltf glb 3mf dae zae fbx 3ds x3d amf blend lwo lxo x ac ac3d acc ifc"
#define VXM_OCCT_FORMATS "step stp p21 iges igs"

typedef struct vxm_external_format {
  const char *name; /**< as vxm_mesh_format says */
  const char *extensions[VXM_EXTERNAL_EXTENSIONS];
  const char *hint; /**< extension that makes the library take content of this kind for what it is */
  bool (*sniff)(const unsigned char *data, size_t size); /**< NULL if the content does not tell */
  bool is_cad;                                           /**< read through OpenCASCADE, else through Assimp */
} vxm_external_format;

const vxm_external_format *vxm_external_format_by_content(const unsigned char *data, size_t size);
const vxm_external_format *vxm_external_format_by_extension(const char *extension);
/** By the name of a format; NULL if there is none. */
const vxm_external_format *vxm_external_format_by_name(const char *name);

/** What to say of a file with an extension that Assimp may know and we do not hand to it; NULL if it is none.
 */
const char *vxm_external_format_refusal(const char *extension);

/**
 * Reads into an empty soup through the library.
 *
 * @param extension  of the file, or what stands for it
 * @param file       its data, size and name, and the deflection
 * @param references where files may lie that it refers to
 * @return as vxm_reader_process_mesh
 */
vxm_status vxm_external_format_read(vxm_soup *soup, const vxm_external_format *format, const char *extension,
                                    const vxm_reader_request *file, vxm_references *references,
                                    vxm_error *error);

#endif
