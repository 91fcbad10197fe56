/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/multi_device_names.h"
#include "gpu/engines.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_MAX_LENGTH = 200 };

/** Engines as they are made. */
typedef struct crew {
  vxm_context *context;
  const vxm_engine_options *options;
  vxm_engine *engines[VXM_MULTI_DEVICE_MOST];
  int count;
} crew;

/** Where a '+' joins two names, which a device's own name may have, too; NULL = nowhere. */
static const char *find_joint(const char *name) {
  for (const char *plus = strchr(name, '+'); plus; plus = strchr(plus + 1, '+'))
    if (strncmp(plus + 1, "open", 4) == 0 || strcmp(plus + 1, "cpu") == 0 || plus[1] == '\0' ||
        strncmp(plus + 1, "cpu+", 4) == 0)
      return plus;
  return NULL;
}

/** The parts in "opencl:0:2"; 0 = it names a whole device, or one part. */
static int parts_of(const char *name) {
  const char *colon = strrchr(name, ':');
  if (strncmp(name, "opencl:", 7) != 0 || !colon || colon == name + 6)
    return 0;
  size_t digits = strspn(colon + 1, "0123456789");
  return digits > 0 && digits < 4 && colon[1 + digits] == '\0' ? atoi(colon + 1) : 0;
}

bool vxm_multi_device_is_named(const char *name) {
  return find_joint(name) || strcmp(name, "opencl:all") == 0 || strcmp(name, "opengl:all") == 0 ||
         parts_of(name) > 0;
}

/** Each has a context of its own, in whose memory nobody else counts on, and which reports nothing. */
static vxm_status add(crew *all, const char *name, vxm_error *error) {
  vxm_context *own = NULL;
  if (all->count == VXM_MULTI_DEVICE_MOST)
    return vxm_fail(error, VXM_ERROR_RANGE, "engine: more than %d devices at once", VXM_MULTI_DEVICE_MOST);
  vxm_status status = vxm_context_child(&own, all->context, true, error);
  if (status == VXM_OK)
    status = vxm_engines_make(&all->engines[all->count], own, name, all->options, error);
  vxm_context_release(own);
  all->count += status == VXM_OK;
  return status;
}

/** All devices of a kind that work; why the last one does not, where none does. */
static vxm_status add_all(crew *all, const char *kind, int number, const char *between, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  int before = all->count;
  vxm_fail(&local, VXM_ERROR_UNAVAILABLE, "engine: there is no device of %s here", kind);
  for (int d = 0; d < number; d++) {
    char name[48];
    snprintf(name, sizeof name, "%s:%s%d", kind, between, d);
    local = (vxm_error)VXM_ERROR_INIT;
    vxm_status status = add(all, name, &local);
    if (status != VXM_OK && status != VXM_ERROR_UNAVAILABLE)
      break;
  }
  if (all->count > before && (local.code == VXM_OK || local.code == VXM_ERROR_UNAVAILABLE))
    return VXM_OK;
  vxm_error_pass(error, &local);
  return local.code;
}

static vxm_status add_parts(crew *all, const char *name, int parts, vxm_error *error) {
  vxm_status status = VXM_OK;
  if (parts > VXM_MULTI_DEVICE_MOST)
    return vxm_fail(error, VXM_ERROR_RANGE, "engine: more than %d devices at once", VXM_MULTI_DEVICE_MOST);
  for (int p = 0; p < parts && status == VXM_OK; p++) {
    char part[NAME_MAX_LENGTH + 16];
    snprintf(part, sizeof part, "%s.%d", name, p);
    status = add(all, part, error);
  }
  return status;
}

static vxm_status add_named(crew *all, const char *name, vxm_error *error) {
  int parts = parts_of(name);
  if (strcmp(name, "opencl:all") == 0)
    return add_all(all, "opencl", vxm_engines_opencl_count(), "", error);
  if (strcmp(name, "opengl:all") == 0)
    return add_all(all, "opengl", vxm_engines_opengl_count(), "egl-device", error);
  if (parts > 0)
    return add_parts(all, name, parts, error);
  if (strncmp(name, "opencl", 6) != 0 && strncmp(name, "opengl", 6) != 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "engine: several work at once if each is of OpenCL or OpenGL, not '%.40s'", name);
  return add(all, name, error);
}

static vxm_status check(const crew *all, const vxm_engine_options *options, vxm_error *error) {
  bool slices = options->gl_method != VXM_GL_COLUMNS;
  for (int m = 0; m < all->count && all->count > 1; m++)
    if (slices && strncmp(all->engines[m]->info.name, "opengl", 6) != 0)
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "engine: of devices that work at once all or none make slices; leave out %s, or take "
                      "columns",
                      all->engines[m]->info.name);
  if (all->count > 1 && options->displacement > 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "engine: several devices displace no vertices");
  return VXM_OK;
}

vxm_status vxm_multi_device_make(vxm_engine **out, vxm_context *context, const char *name,
                                 const vxm_engine_options *options, vxm_error *error) {
  crew all = {.context = context, .options = options};
  vxm_status status = VXM_OK;
  if (options->device)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "engine: '%.100s' names its devices; leave out the other name",
                    name);
  for (const char *at = name; at && status == VXM_OK;) {
    const char *joint = find_joint(at);
    size_t length = joint ? (size_t)(joint - at) : strlen(at);
    char one[NAME_MAX_LENGTH];
    snprintf(one, sizeof one, "%.*s", (int)vxm_min((int64_t)length, NAME_MAX_LENGTH), at);
    status = length < sizeof one
                 ? add_named(&all, one, error)
                 : vxm_fail(error, VXM_ERROR_ARGUMENT, "engine: '%.100s...' is no name of a device", at);
    at = joint ? joint + 1 : NULL;
  }
  if (status == VXM_OK)
    status = check(&all, options, error);
  if (status == VXM_OK && all.count > 1)
    return vxm_multi_device_create(out, context, all.engines, all.count, error);
  char only[48] = "";
  if (status == VXM_OK)
    memcpy(only, all.engines[0]->info.name, sizeof only);
  for (int m = 0; m < all.count; m++)
    vxm_engine_destroy(all.engines[m]);
  return status == VXM_OK ? vxm_engines_make_one(out, context, only, options, error) : status;
}
