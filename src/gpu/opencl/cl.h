/* SPDX-License-Identifier: BSD-3-Clause */
/** The functions of OpenCL 1.2 that are used. Nothing is linked: the loader of the vendors' drivers (ICD) is
 * opened when an engine is asked for. */
#ifndef VXM_GPU_OPENCL_CL_H
#define VXM_GPU_OPENCL_CL_H

#include "base/error.h"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#define VXM_CL_FUNCTIONS(X)    \
  X(BuildProgram)              \
  X(CreateBuffer)              \
  X(CreateCommandQueue)        \
  X(CreateContext)             \
  X(CreateKernel)              \
  X(CreateProgramWithBinary)   \
  X(CreateProgramWithSource)   \
  X(CreateSubDevices)          \
  X(EnqueueCopyBuffer)         \
  X(EnqueueFillBuffer)         \
  X(EnqueueMapBuffer)          \
  X(EnqueueMarkerWithWaitList) \
  X(EnqueueNDRangeKernel)      \
  X(EnqueueReadBuffer)         \
  X(EnqueueUnmapMemObject)     \
  X(EnqueueWriteBuffer)        \
  X(Finish)                    \
  X(Flush)                     \
  X(GetDeviceIDs)              \
  X(GetDeviceInfo)             \
  X(GetEventProfilingInfo)     \
  X(GetKernelWorkGroupInfo)    \
  X(GetPlatformIDs)            \
  X(GetPlatformInfo)           \
  X(GetProgramBuildInfo)       \
  X(GetProgramInfo)            \
  X(ReleaseCommandQueue)       \
  X(ReleaseContext)            \
  X(ReleaseDevice)             \
  X(ReleaseEvent)              \
  X(ReleaseKernel)             \
  X(ReleaseMemObject)          \
  X(ReleaseProgram)            \
  X(RetainCommandQueue)        \
  X(RetainContext)             \
  X(SetKernelArg)              \
  X(WaitForEvents)

typedef struct vxm_cl {
#define VXM_CL_FIELD(name) __typeof__(&cl##name) name;
  VXM_CL_FUNCTIONS(VXM_CL_FIELD)
#undef VXM_CL_FIELD
} vxm_cl;

/** The functions of the loader, looked up once. @return NULL where there is none, and `error` says what to
 * install */
const vxm_cl *vxm_cl_load(vxm_error *error);

/** Turns what a call returned into a status. @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_UNAVAILABLE (the
 * driver refused something, or the device is lost) */
vxm_status vxm_cl_check(cl_int code, const char *doing, vxm_error *error);

#endif
