/* SPDX-License-Identifier: BSD-3-Clause */
/** Whether the kernels for particular x86 processors are built. */
#ifndef VXM_VOXEL_KERNELS_X86_H
#define VXM_VOXEL_KERNELS_X86_H

#if defined(__x86_64__) && defined(__GNUC__)
#define VXM_KERNELS_X86 1
#else
#define VXM_KERNELS_X86 0
typedef int vxm_no_kernels; /* a source file may not be empty */
#endif

#endif
