/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opencl/cl_device.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PLATFORMS_MAX = 16, TEXT_MAX = 128 };

static void device_text(char out[TEXT_MAX], const vxm_cl *cl, cl_device_id device, cl_device_info what) {
  char text[1024] = "";
  if (cl->GetDeviceInfo(device, what, sizeof text, text, NULL) != CL_SUCCESS)
    text[0] = '\0';
  const char *from = text;
  while (*from == ' ')
    from++;
  snprintf(out, TEXT_MAX, "%.120s", from);
}

static void platform_name(char out[TEXT_MAX], const vxm_cl *cl, cl_platform_id platform) {
  char text[1024] = "";
  if (cl->GetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof text, text, NULL) != CL_SUCCESS)
    text[0] = '\0';
  snprintf(out, TEXT_MAX, "%.120s", text);
}

/** A number of 32 or 64 bits; 0 if the driver does not tell. */
static int64_t device_number(const vxm_cl *cl, cl_device_id device, cl_device_info what, size_t size) {
  uint64_t wide = 0;
  uint32_t narrow = 0;
  void *out = size == sizeof wide ? (void *)&wide : (void *)&narrow;
  if (cl->GetDeviceInfo(device, what, size, out, NULL) != CL_SUCCESS)
    return 0;
  wide = size == sizeof wide ? wide : narrow;
  return wide < INT64_MAX ? (int64_t)wide : INT64_MAX;
}

static cl_device_type type_of(const vxm_cl *cl, const vxm_cl_device *device) {
  return (cl_device_type)device_number(cl, device->id, CL_DEVICE_TYPE, sizeof(cl_device_type));
}

int vxm_cl_devices(vxm_cl_device out[VXM_CL_DEVICES_MAX], const vxm_cl *cl, vxm_error *error) {
  cl_platform_id platforms[PLATFORMS_MAX];
  cl_device_id devices[VXM_CL_DEVICES_MAX];
  cl_uint platform_count = 0, device_count;
  int count = 0;
  if (cl->GetPlatformIDs(PLATFORMS_MAX, platforms, &platform_count) != CL_SUCCESS)
    platform_count = 0; /* the loader calls it an error that there is none */
  for (cl_uint p = 0; p < platform_count && p < PLATFORMS_MAX; p++) {
    device_count = 0;
    if (cl->GetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, VXM_CL_DEVICES_MAX, devices, &device_count) !=
        CL_SUCCESS)
      continue;
    for (cl_uint d = 0; d < device_count && d < VXM_CL_DEVICES_MAX && count < VXM_CL_DEVICES_MAX; d++)
      out[count++] = (vxm_cl_device){.platform = platforms[p], .id = devices[d]};
  }
  if (count == 0)
    vxm_fail(error, VXM_ERROR_UNAVAILABLE,
             "no OpenCL device here: install the driver of your GPU, or pocl-opencl-icd, which runs on any "
             "CPU");
  return count;
}

/** Whether a text has a part, letters of either case being the same. */
static bool has_part(const char *text, const char *part) {
  size_t length = strlen(part);
  for (; *text; text++) {
    size_t i = 0;
    while (i < length && text[i] && tolower((unsigned char)text[i]) == tolower((unsigned char)part[i]))
      i++;
    if (i == length)
      return true;
  }
  return false;
}

static int find_named(const vxm_cl *cl, const vxm_cl_device *devices, int count, const char *name) {
  for (int d = 0; d < count; d++) {
    char text[TEXT_MAX], platform[TEXT_MAX];
    device_text(text, cl, devices[d].id, CL_DEVICE_NAME);
    platform_name(platform, cl, devices[d].platform);
    if (has_part(text, name) || has_part(platform, name))
      return d;
  }
  return -1;
}

/** What is missing, or NULL. */
static const char *lack_of(const vxm_cl *cl, cl_device_id device) {
  char version[TEXT_MAX], profile[TEXT_MAX];
  int major = 0, minor = 0;
  device_text(version, cl, device, CL_DEVICE_VERSION);
  device_text(profile, cl, device, CL_DEVICE_PROFILE);
  if (sscanf(version, "OpenCL %d.%d", &major, &minor) != 2 || major < 1 || (major == 1 && minor < 2))
    return "OpenCL 1.2 is needed";
  if (strcmp(profile, "FULL_PROFILE") != 0)
    return "the full profile of OpenCL is needed, for 64-bit integers";
  if (!device_number(cl, device, CL_DEVICE_ENDIAN_LITTLE, sizeof(cl_bool)))
    return "a little-endian device is needed";
  if (!device_number(cl, device, CL_DEVICE_COMPILER_AVAILABLE, sizeof(cl_bool)))
    return "the driver has no compiler";
  return device_number(cl, device, CL_DEVICE_AVAILABLE, sizeof(cl_bool)) ? NULL
                                                                         : "the device is not available";
}

int vxm_cl_device_find(const vxm_cl *cl, const vxm_cl_device *devices, int count, const char *choice,
                       vxm_error *error) {
  if (!choice || !*choice) {
    int first = -1;
    for (int d = 0; d < count; d++) {
      if (lack_of(cl, devices[d].id))
        continue;
      if (type_of(cl, &devices[d]) & (CL_DEVICE_TYPE_GPU | CL_DEVICE_TYPE_ACCELERATOR))
        return d;
      first = first < 0 ? d : first;
    }
    return first < 0 ? 0 : first;
  }
  if (strspn(choice, "0123456789") == strlen(choice)) {
    long number = strlen(choice) < 4 ? strtol(choice, NULL, 10) : VXM_CL_DEVICES_MAX;
    if (number < count)
      return (int)number;
    vxm_fail(error, VXM_ERROR_ARGUMENT, "there is no OpenCL device %.20s: 'voxmend engines' lists 0 to %d",
             choice, count - 1);
    return -1;
  }
  int found = find_named(cl, devices, count, choice);
  if (found < 0)
    vxm_fail(error, VXM_ERROR_ARGUMENT,
             "no OpenCL device or platform is called '%.60s'; 'voxmend engines' lists what there is", choice);
  return found;
}

static const char *kind_of(cl_device_type type) {
  return type & CL_DEVICE_TYPE_GPU           ? "gpu"
         : type & CL_DEVICE_TYPE_ACCELERATOR ? "accelerator"
         : type & CL_DEVICE_TYPE_CPU         ? "cpu"
                                             : "custom";
}

bool vxm_cl_device_read_part(char *choice, int *parts, int *part) {
  int used = 0;
  char *colon = strrchr(choice, ':');
  if (!colon || strspn(colon + 1, "0123456789.") != strlen(colon + 1) ||
      sscanf(colon + 1, "%3d.%3d%n", parts, part, &used) != 2 || colon[1 + used] != '\0')
    return false;
  *colon = '\0';
  return true;
}

vxm_status vxm_cl_device_divide(vxm_cl_device *device, const vxm_cl *cl, int parts, int part,
                                vxm_error *error) {
  enum { PARTS_MAX = 64 };
  cl_device_id made[PARTS_MAX];
  cl_uint count = 0;
  int units = (int)device_number(cl, device->id, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof(cl_uint));
  if (parts < 1 || parts > PARTS_MAX || part >= parts || units / parts < 1)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "part %d of %d: the OpenCL device has %d compute units", part,
                    parts, units);
  const cl_device_partition_property equally[] = {CL_DEVICE_PARTITION_EQUALLY, units / parts, 0};
  cl_int code = cl->CreateSubDevices(device->id, equally, 0, NULL, &count);
  if (code == CL_SUCCESS && (int)count >= parts && count <= PARTS_MAX)
    code = cl->CreateSubDevices(device->id, equally, count, made, NULL);
  else if (code == CL_SUCCESS)
    code = CL_DEVICE_PARTITION_FAILED;
  if (code != CL_SUCCESS)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "the OpenCL driver does not divide the device (error %d)",
                    (int)code);
  for (cl_uint d = 0; d < count; d++)
    if ((int)d != part)
      cl->ReleaseDevice(made[d]);
  *device = (vxm_cl_device){device->platform, made[part], parts, part};
  return VXM_OK;
}

void vxm_cl_device_release(const vxm_cl_device *device, const vxm_cl *cl) {
  if (device->parts > 0)
    cl->ReleaseDevice(device->id);
}

void vxm_cl_device_describe(vxm_engine_info *out, const vxm_cl *cl, const vxm_cl_device *device, int number) {
  char extensions[8192] = "";
  cl_device_id id = device->id;
  size_t group = 0;
  *out = (vxm_engine_info){.int64 = true};
  snprintf(out->name, sizeof out->name, "opencl:%d", number);
  if (device->parts > 0)
    snprintf(out->name, sizeof out->name, "opencl:%d:%d.%d", number, device->parts, device->part);
  out->devices = 1;
  device_text(out->renderer, cl, id, CL_DEVICE_NAME);
  device_text(out->version, cl, id, CL_DEVICE_VERSION);
  device_text(out->driver, cl, id, CL_DRIVER_VERSION);
  platform_name(out->platform, cl, device->platform);
  out->hardware = (type_of(cl, device) & (CL_DEVICE_TYPE_GPU | CL_DEVICE_TYPE_ACCELERATOR)) != 0;
  snprintf(out->kind, sizeof out->kind, "%s", kind_of(type_of(cl, device)));
  out->clock_mhz = (int)device_number(cl, id, CL_DEVICE_MAX_CLOCK_FREQUENCY, sizeof(cl_uint));
  out->cache_bytes = device_number(cl, id, CL_DEVICE_GLOBAL_MEM_CACHE_SIZE, sizeof(cl_ulong));
  out->shares_memory = device_number(cl, id, CL_DEVICE_HOST_UNIFIED_MEMORY, sizeof(cl_bool)) != 0;
  out->compute_units = (int)device_number(cl, id, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof(cl_uint));
  out->block_bytes = device_number(cl, id, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof(cl_ulong));
  out->global_bytes = device_number(cl, id, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof(cl_ulong));
  out->local_bytes = device_number(cl, id, CL_DEVICE_LOCAL_MEM_SIZE, sizeof(cl_ulong));
  if (cl->GetDeviceInfo(id, CL_DEVICE_MAX_WORK_GROUP_SIZE, sizeof group, &group, NULL) == CL_SUCCESS)
    out->work_group = (int64_t)group;
  if (cl->GetDeviceInfo(id, CL_DEVICE_EXTENSIONS, sizeof extensions, extensions, NULL) == CL_SUCCESS)
    out->int64_atomics = strstr(extensions, "cl_khr_int64_extended_atomics") != NULL;
  out->moves = device_number(cl, id, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof(cl_device_fp_config)) != 0;
  const char *lack = lack_of(cl, id);
  out->available = lack == NULL;
  if (lack)
    snprintf(out->note, sizeof out->note, "%s", lack);
}
