/* SPDX-License-Identifier: BSD-3-Clause */
/** What the two readers of STL share: where a binary file has its facets. */
#ifndef VXM_MESHIO_STL_H
#define VXM_MESHIO_STL_H

#include "meshio/scan.h"

/** 80 bytes of text, a 32-bit count, then 50 bytes for each facet: normal, three corners, two spare bytes. */
enum { VXM_STL_COUNT_AT = 80, VXM_STL_FACETS_AT = 84, VXM_STL_FACET = 50 };

vxm_status vxm_stl_read_text(vxm_scan *scan, vxm_error *error);

#endif
