/* SPDX-License-Identifier: BSD-3-Clause */
/** The OpenCL program of Faieghi, Tutunea-Fatan and Eagleson, for comparison; the kernels are in
 * shaders/published.cl. The functions of the same names in voxmend/experimental.h check arguments and call
 * these. */
#ifndef VXM_GPU_OPENCL_FAIEGHI_H
#define VXM_GPU_OPENCL_FAIEGHI_H

#include "gpu/opencl/opencl.h"
#include "voxmend/experimental.h"

/** @param options checked, with a material */
vxm_status vxm_cl_published_create(vxm_published **out, vxm_space *space, vxm_opencl *engine,
                                   const vxm_soup *soup, const vxm_published_options *options,
                                   vxm_error *error);
vxm_status vxm_cl_published_voxelize(vxm_published_report *report, vxm_published *published,
                                     vxm_error *error);
vxm_status vxm_cl_published_read(uint8_t *voxels, double *ms, vxm_published *published, vxm_transfer how,
                                 vxm_error *error);
void vxm_cl_published_destroy(vxm_published *published);

#endif
