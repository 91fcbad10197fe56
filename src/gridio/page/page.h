/* SPDX-License-Identifier: BSD-3-Clause */
/** Pages that show a grid or field in a browser, whole in one file. */
#ifndef VXM_GRIDIO_PAGE_PAGE_H
#define VXM_GRIDIO_PAGE_PAGE_H

#include "gridio/common/values.h"

/**
 * Writes a page.
 *
 * @param grid,field one of them is NULL
 * @param options    not NULL
 * @param threshold  of a field: what is shown at first; NULL = by what the numbers are
 * @return as vxm_grid_page
 */
vxm_status vxm_gridio_page(const vxm_grid *grid, const vxm_field *field, const char *path,
                           const vxm_page_options *options, const vxm_threshold_options *threshold,
                           vxm_error *error);

#endif
