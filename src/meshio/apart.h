/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Reading through a foreign library, apart from our process. Such libraries crash on many a damaged file
 * (doc/formats.md has figures), keep state of their own, print, and hold memory that our limit does not see;
 * the program voxmend-reader opens the module and sends the soup.
 */
#ifndef VXM_MESHIO_APART_H
#define VXM_MESHIO_APART_H

#include "base/module.h"
#include "meshio/reader.h"

/**
 * Fills an empty soup, but for its format. Under a memory limit the reading process may hold half of what is
 * left, otherwise what goes with the size of the file; its computing time goes with that size as well.
 *
 * @return VXM_OK; VXM_ERROR_UNAVAILABLE if module or program are missing, or the module does not know the
 *         format; VXM_ERROR_FORMAT, also if the library crashes; VXM_ERROR_RANGE, also if it computes for too
 *         long; VXM_ERROR_IO if the program cannot be started; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
vxm_status vxm_read_apart(vxm_soup *soup, const vxm_module_need *need, const vxm_reader_request *request,
                          vxm_error *error);

/** The arguments of voxmend-reader, in their order. */
enum {
  VXM_APART_PROGRAM,
  VXM_APART_MODULE, /**< path */
  VXM_APART_NAME,   /**< of the file, whose content is sent over the channel */
  VXM_APART_BESIDE, /**< "1" if files may lie beside it, else "0" */
  VXM_APART_HINT,
  VXM_APART_DEFLECTION, /**< %a */
  VXM_APART_MEMORY,     /**< bytes that it may hold */
  VXM_APART_SECONDS,    /**< of computing */
  VXM_APART_ARGUMENTS
};

#endif
