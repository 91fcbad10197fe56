/* SPDX-License-Identifier: BSD-3-Clause */
/** Prefix sums and sorting on the device. They are kernels of our own: the libraries for it (clogs,
 * Boost.Compute) are C++, and would have to be there where voxmend runs. */
#ifndef VXM_GPU_OPENCL_CL_SORT_H
#define VXM_GPU_OPENCL_CL_SORT_H

#include "gpu/opencl/opencl.h"

/** Makes exclusive prefix sums of `count` 32-bit numbers in place; element `count`, for which there is room,
 * becomes the sum of all, mod 2^32. */
vxm_status vxm_cl_scan(vxm_opencl *engine, vxm_cl_buffer_id numbers, size_t count, vxm_error *error);

/**
 * Sorts 64-bit keys by their low `bits` bits, and 32-bit values with them; equal keys keep their order. The
 * two buffers change places with VXM_CL_SORT_KEYS and VXM_CL_SORT_VALUES along the way.
 */
vxm_status vxm_cl_sort(vxm_opencl *engine, vxm_cl_buffer_id keys, vxm_cl_buffer_id values, size_t count,
                       int bits, vxm_error *error);

#endif
