/* SPDX-License-Identifier: BSD-3-Clause */
/** The devices of all OpenCL platforms, numbered in the order in which the loader lists them. */
#ifndef VXM_GPU_OPENCL_CL_DEVICE_H
#define VXM_GPU_OPENCL_CL_DEVICE_H

#include "gpu/opencl/cl.h"
#include "voxmend.h"

enum { VXM_CL_DEVICES_MAX = 64 };

typedef struct vxm_cl_device {
  cl_platform_id platform;
  cl_device_id id;
  int parts; /**< it is one of so many equal parts of a device, and has to be released; 0 = a whole one */
  int part;  /**< from 0 on */
} vxm_cl_device;

/** Lists all devices. @return how many; 0, and why in `error`, where there is none */
int vxm_cl_devices(vxm_cl_device out[VXM_CL_DEVICES_MAX], const vxm_cl *cl, vxm_error *error);

/**
 * Finds a device by its number, or by a part of its name or its platform's, in any case of letters; the first
 * one that fits.
 *
 * @param choice NULL: the first GPU or accelerator that will do, else the first device that will
 * @return its number; -1, and which there are in `error`
 */
int vxm_cl_device_find(const vxm_cl *cl, const vxm_cl_device *devices, int count, const char *choice,
                       vxm_error *error);

/** Reads the parts off the end of a choice such as "0:2.1", which is shortened to "0". False if it has none.
 */
bool vxm_cl_device_read_part(char *choice, int *parts, int *part);
/** Makes a device one of its parts. @return VXM_OK; VXM_ERROR_ARGUMENT for fewer compute units than parts;
 * VXM_ERROR_UNAVAILABLE where the driver does not divide it */
vxm_status vxm_cl_device_divide(vxm_cl_device *device, const vxm_cl *cl, int parts, int part,
                                vxm_error *error);
/** Does nothing to a whole device. */
void vxm_cl_device_release(const vxm_cl_device *device, const vxm_cl *cl);

/** What a device says of itself; `available` where it has what the kernels need, else `note` says what it
 * lacks. */
void vxm_cl_device_describe(vxm_engine_info *out, const vxm_cl *cl, const vxm_cl_device *device, int number);

#endif
