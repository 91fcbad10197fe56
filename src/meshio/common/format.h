/* SPDX-License-Identifier: BSD-3-Clause */
/** The table of mesh formats; a new format is one more row and its functions. */
#ifndef VXM_MESHIO_COMMON_FORMAT_H
#define VXM_MESHIO_COMMON_FORMAT_H

#include "base/output.h"
#include "mesh/soup.h"

/** How sure a format is, from the content alone, that it is its own. */
typedef enum vxm_likeness {
  VXM_LIKENESS_NONE = 0,
  VXM_LIKENESS_POSSIBLE, /**< decides only where no extension does */
  VXM_LIKENESS_CERTAIN   /**< decides against any extension */
} vxm_likeness;

typedef struct vxm_format {
  const char *name;
  const char *extensions[2]; /**< without the dot; NULL where there is no second one */
  vxm_likeness (*sniff)(const unsigned char *data, size_t size);
  /** Fills an empty soup; on failure the caller destroys it. */
  vxm_status (*read)(vxm_soup *soup, const unsigned char *data, size_t size, const char *name,
                     vxm_error *error);
  /** Writes all of a soup, `flags` being VXM_WRITE_ASCII and others; the caller commits the output or drops
   * it.
   */
  vxm_status (*write)(const vxm_soup *soup, vxm_output *output, unsigned flags, vxm_error *error);
} vxm_format;

vxm_likeness vxm_off_sniff(const unsigned char *data, size_t size);
vxm_likeness vxm_obj_sniff(const unsigned char *data, size_t size);
vxm_likeness vxm_stl_sniff(const unsigned char *data, size_t size);
vxm_likeness vxm_ply_sniff(const unsigned char *data, size_t size);

vxm_status vxm_off_read(vxm_soup *soup, const unsigned char *data, size_t size, const char *name,
                        vxm_error *error);
vxm_status vxm_obj_read(vxm_soup *soup, const unsigned char *data, size_t size, const char *name,
                        vxm_error *error);
vxm_status vxm_stl_read(vxm_soup *soup, const unsigned char *data, size_t size, const char *name,
                        vxm_error *error);
vxm_status vxm_ply_read(vxm_soup *soup, const unsigned char *data, size_t size, const char *name,
                        vxm_error *error);

vxm_status vxm_off_write(const vxm_soup *soup, vxm_output *output, unsigned flags, vxm_error *error);
vxm_status vxm_obj_write(const vxm_soup *soup, vxm_output *output, unsigned flags, vxm_error *error);
vxm_status vxm_stl_write(const vxm_soup *soup, vxm_output *output, unsigned flags, vxm_error *error);
vxm_status vxm_ply_write(const vxm_soup *soup, vxm_output *output, unsigned flags, vxm_error *error);

#endif
