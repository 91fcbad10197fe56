/* SPDX-License-Identifier: BSD-3-Clause */
/** What a page is put together from: what its script is told, as JSON, and blocks of bytes. */
#ifndef VXM_GRIDIO_PAGE_PARTS_H
#define VXM_GRIDIO_PAGE_PARTS_H

#include "gridio/common/values.h"
#include "gridio/page/pack.h"

#include <jansson.h>

/** A page in the making. */
typedef struct vxm_page {
  vxm_context *context;
  vxm_output *output;
  const vxm_space *space;
  json_t *about; /**< what the script is told; one reference held */
} vxm_page;

/** Text as JSON: what is not UTF-8 becomes question marks. */
json_t *vxm_page_text(const char *text);
/** "#rrggbb" */
json_t *vxm_page_color(const uint8_t rgb[3]);

/** Adds the voxels of a grid, or the values of a field. */
vxm_status vxm_page_put_grid(vxm_page *page, const vxm_grid *grid, vxm_error *error);
vxm_status vxm_page_put_field(vxm_page *page, const vxm_field *field, const vxm_threshold_options *threshold,
                              vxm_error *error);
/** Adds a mesh with what is wrong with it, and with what repair changed if `repaired` is not NULL. */
vxm_status vxm_page_put_mesh(vxm_page *page, const vxm_soup *mesh, const vxm_soup *repaired,
                             vxm_error *error);

#endif
