/* SPDX-License-Identifier: BSD-3-Clause */
/** What a module that reads foreign formats offers. It runs in a process of its own (reader_process.h). */
#ifndef VXM_SANDBOX_READER_H
#define VXM_SANDBOX_READER_H

#include "mesh/soup.h"
#include "sandbox/voxel_sink.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The deflection of vxm_mesh_read_options where it is 0. */
#define VXM_DEFLECTION_DEFAULT 0.001

/** A file that a mesh refers to. */
typedef struct vxm_reader_file {
  unsigned char *data; /**< a block of the context */
  size_t size;
} vxm_reader_file;

typedef struct vxm_reader_request {
  const unsigned char *data; /**< the file */
  size_t size;
  const char *name; /**< of the file, for messages */
  const char *hint; /**< the extension that stands for its format, without the dot */
  /** How far triangles may lie from a curved surface, as a part of the model's diagonal; 0 where none are
   * made. */
  double deflection;
  const char *path; /**< under which fopen finds the file; NULL if it does not */
  /** Gets a file by the name that stands in the mesh; false if it is not to be had. NULL if none is. */
  bool (*fetch)(void *payload, vxm_context *context, const char *name, vxm_reader_file *out);
  void *payload;
} vxm_reader_request;

/** The functions of such a module, or the first of them. It reads meshes or grids. */
typedef struct vxm_reader {
  /**
   * Makes the library load what it loads when it is first used. Files can be opened until this returns, and
   * none after it.
   */
  void (*prepare)(void);
  /**
   * Fills an empty soup, but for its format; on failure the caller destroys it. NULL if it reads no meshes.
   *
   * @return VXM_OK; VXM_ERROR_FORMAT; VXM_ERROR_UNAVAILABLE if the format is none of the module's;
   *         VXM_ERROR_RANGE, VXM_ERROR_MEMORY
   */
  vxm_status (*read)(vxm_soup *soup, const vxm_reader_request *request, vxm_error *error);
  /**
   * Hands a grid to the sink, and reports progress to the context; NULL if it reads no grids. The process
   * ends after it: what the library holds then is left as it is.
   *
   * @return VXM_OK; VXM_ERROR_FORMAT, VXM_ERROR_MEMORY; what the sink returns
   */
  vxm_status (*read_grid)(vxm_voxel_sink *sink, vxm_context *context, const vxm_reader_request *request,
                          vxm_error *error);
} vxm_reader;

#ifdef __cplusplus
}
#endif
#endif
