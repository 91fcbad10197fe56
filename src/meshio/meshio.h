/* SPDX-License-Identifier: BSD-3-Clause */
/** Mesh files in and out: OFF, OBJ, STL and PLY; others are read through libraries (external/). */
#ifndef VXM_MESHIO_MESHIO_H
#define VXM_MESHIO_MESHIO_H

#include "base/file.h"
#include "mesh/soup.h"
#include "meshio/common/write_flags.h"

/**
 * Reads a mesh from memory, with options; NULL means defaults. The format is told by content first and by the
 * extension of `name` second. Text in UTF-16 with a byte order mark is read too.
 *
 * What a damaged file still holds is read; each kind of damage becomes one line of the soup's warnings with
 * the line or byte offset where it was met first.
 *
 * @param data need not be terminated; not kept
 * @param name for messages and for its extension
 * @return VXM_OK; VXM_ERROR_FORMAT with line or offset; VXM_ERROR_RANGE beyond VXM_VERTICES_MAX vertices;
 *         VXM_ERROR_ARGUMENT for a format that is not known; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED; what vxm_external_format_read returns. With our own readers memory stays below
 *         a fixed multiple of `size`, whatever the file claims.
 */
vxm_status vxm_meshio_read(vxm_soup **out, vxm_context *context, const unsigned char *data, size_t size,
                           const char *name, const vxm_mesh_read_options *options, vxm_error *error);

/** As vxm_meshio_read, from a file; "-" is standard input. Files that the mesh refers to are those of
 * its folder, or as options->external says. @return also VXM_ERROR_IO */
vxm_status vxm_meshio_read_file(vxm_soup **out, vxm_context *context, const char *path,
                                const vxm_mesh_read_options *options, vxm_error *error);

/**
 * Writes a mesh; the file appears under its name when it is complete.
 *
 * @param path   "-" is standard output
 * @param format "off", "obj", "stl" or "ply" in any case; NULL = by the extension of `path`
 * @param flags  VXM_WRITE_ASCII and others (meshio/common/write_flags.h); off and obj are always text
 * @return VXM_OK; VXM_ERROR_ARGUMENT for a format that is not known; VXM_ERROR_IO; VXM_ERROR_RANGE where STL
 *         cannot hold the mesh; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_meshio_write(const vxm_soup *soup, const char *path, const char *format, unsigned flags,
                            vxm_error *error);

/** Looks at what was written, as it was read back. A status other than VXM_OK drops the file. */
typedef vxm_status (*vxm_meshio_check)(const vxm_soup *read_back, void *payload, vxm_error *error);

/** As vxm_meshio_write, but before the file gets its name it is read back and checked. */
vxm_status vxm_meshio_write_checked(const vxm_soup *soup, const char *path, const char *format,
                                    unsigned flags, vxm_meshio_check check, void *payload, vxm_error *error);

#endif
