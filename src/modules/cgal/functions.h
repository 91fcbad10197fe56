/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The functions of the module; what they do is told in repair/external/cgal.h. */
#ifndef VXM_MODULES_CGAL_FUNCTIONS_H
#define VXM_MODULES_CGAL_FUNCTIONS_H

#include "repair/external/cgal.h"

namespace vxm {

vxm_status self_intersections(vxm_face_pairs *out, const vxm_soup *soup, size_t most, vxm_error *error);
vxm_status fill(vxm_soup **out, uint64_t **origin, int64_t *filled, int64_t *left, const vxm_soup *soup,
                size_t max_edges, vxm_error *error);
vxm_status unite(vxm_soup **out, uint64_t **origin, vxm_union_report *report, const vxm_soup *soup,
                 const vxm_union_options *options, vxm_error *error);
vxm_status orient(vxm_soup **out, int64_t *turned, const vxm_soup *soup, vxm_error *error);
vxm_status wrap(vxm_soup **out, uint64_t **origin, const vxm_soup *soup, double alpha, double offset,
                vxm_error *error);

} // namespace vxm

#endif
