/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Reading through a foreign library, apart from our process. Such libraries crash on many a damaged file
 * (doc/formats.md has figures), keep state of their own, print, and hold memory that our limit does not see;
 * the program voxmend-reader opens the module and sends the soup or the grid. It opens no files, and has none
 * but the channel to us (confine.h): what the mesh refers to it asks us for.
 */
#ifndef VXM_SANDBOX_READER_PROCESS_H
#define VXM_SANDBOX_READER_PROCESS_H

#include "base/module.h"
#include "sandbox/reader.h"
#include "sandbox/references.h"

/**
 * Fills an empty soup, but for its format. Under a memory limit the reading process may hold half of what is
 * left, otherwise what goes with the size of the file and of those that it refers to; so does its time,
 * counted both as computing and on the clock.
 *
 * @param request    its data, size, name, hint and deflection; the rest is the reader's
 * @param references where files may lie that the mesh refers to; those refused become warnings of the soup
 * @return VXM_OK; VXM_ERROR_UNAVAILABLE if module or program are missing, or the module does not know the
 *         format; VXM_ERROR_FORMAT, also if the library crashes or tries what a reader may not;
 * VXM_ERROR_RANGE, also if it takes too long; VXM_ERROR_IO if the program cannot be started;
 * VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_reader_process_mesh(vxm_soup *soup, const vxm_module_need *need,
                                   const vxm_reader_request *request, vxm_references *references,
                                   vxm_error *error);

/**
 * Decodes a picture, PNG or JPEG, with the module "images".
 *
 * @param[out] made    its appearance has the picture, if one was made; to be destroyed; NULL after a failure
 * @param      purpose what it is for, for the message where the module is missing
 * @return as vxm_reader_process_mesh
 */
vxm_status vxm_reader_process_picture(vxm_soup **made, vxm_context *context, const char *purpose,
                                      const vxm_reader_request *request, vxm_error *error);

/**
 * Reads a grid, under the same limits, and hands it to the sink, whose error comes back if it has one.
 *
 * @param warnings takes what is odd about the reading
 * @param request  its data, size, name and hint
 * @return as vxm_reader_process_mesh
 */
vxm_status vxm_reader_process_grid(vxm_voxel_sink *sink, vxm_warnings *warnings, vxm_context *context,
                                   const vxm_module_need *need, const vxm_reader_request *request,
                                   vxm_error *error);

/** The arguments of voxmend-reader, in their order. Over the channel it gets the size of the file in 64 bits,
 * and its bytes. */
enum {
  VXM_READER_ARG_PROGRAM,
  VXM_READER_ARG_MODULE, /**< path */
  VXM_READER_ARG_PARENT, /**< number of our process */
  VXM_READER_ARG_NAME,   /**< of the file */
  VXM_READER_ARG_HINT,
  VXM_READER_ARG_DEFLECTION, /**< the bits of the double, in decimal */
  VXM_READER_ARG_LOOK,       /**< "1" if the appearance of a mesh is wanted, else "0" */
  VXM_READER_ARG_MEMORY,     /**< bytes that it may hold */
  VXM_READER_ARG_MEMORY_MAX, /**< to which we may raise that, as further files come */
  VXM_READER_ARG_SECONDS,    /**< of computing */
  VXM_READER_ARGS
};

#endif
