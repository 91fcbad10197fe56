/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/engines.h"
#include "config.h"
#include "gpu/multi_device_names.h"

#include <stdio.h>
#include <string.h>

#ifdef HAVE_OPENGL
#include "gpu/opengl/opengl.h"
#endif
#ifdef HAVE_OPENCL
#include "gpu/opencl/opencl.h"
#endif

#if defined HAVE_OPENGL || defined HAVE_OPENCL
/** Frees an engine; the reference to the context stays the caller's. */
static void drop(vxm_engine *engine, vxm_context *context) {
  engine->ops->destroy(engine);
  vxm_free(context, engine);
}
#endif

/** Lists a kind of engine of which there is none here, and why. */
static void list_missing(vxm_engine_info *out, int64_t capacity, int64_t *count, const char *name,
                         const vxm_error *error) {
  if (*count < capacity) {
    out[*count] = (vxm_engine_info){0};
    snprintf(out[*count].name, sizeof out->name, "%s", name);
    snprintf(out[*count].note, sizeof out->note, "%.250s", error->text);
  }
  ++*count;
}

#ifdef HAVE_OPENGL
/* Those that may be hardware come first; `opengl` takes a software renderer of the last two only. */
static const vxm_gl_driver *const drivers[] = {&vxm_gl_egl_device, &vxm_gl_egl_surfaceless, &vxm_gl_osmesa};
enum { DRIVERS = sizeof drivers / sizeof drivers[0] };

/** The first hardware device of a driver, or its first context of any kind. */
static vxm_status make_first(vxm_engine **out, vxm_context *context, const vxm_gl_driver *driver,
                             bool hardware, const vxm_engine_options *options, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  int count = driver->count(&local);
  if (count == 0)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "%s: %s", driver->name, local.text);
  for (int i = 0; i < count; i++) {
    vxm_status status = vxm_opengl_create(out, context, driver, i, options, &local);
    if (status == VXM_OK && (!hardware || (*out)->info.hardware))
      return VXM_OK;
    if (status == VXM_OK) {
      vxm_fail(&local, VXM_ERROR_UNAVAILABLE, "%s is a renderer in software", (*out)->info.renderer);
      drop(*out, context);
      *out = NULL;
    } else if (status != VXM_ERROR_UNAVAILABLE) {
      vxm_error_pass(error, &local);
      return status;
    }
  }
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "%s: %s", driver->name, local.text);
}

/** A hardware device, else whatever there is unless only hardware will do. */
static vxm_status make_any(vxm_engine **out, vxm_context *context, bool hardware,
                           const vxm_engine_options *options, vxm_error *error) {
  vxm_error reasons[DRIVERS] = {{0}};
  for (int d = 0; d < DRIVERS; d++) {
    bool only_hardware = hardware || drivers[d] == &vxm_gl_egl_device;
    vxm_status status = make_first(out, context, drivers[d], only_hardware, options, &reasons[d]);
    if (status == VXM_OK)
      return VXM_OK;
    if (status != VXM_ERROR_UNAVAILABLE) {
      vxm_error_pass(error, &reasons[d]);
      return status;
    }
  }
  if (hardware)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "no hardware device with OpenGL 4.3 is found through EGL");
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                  "no OpenGL 4.3 here (%.110s; %.110s; %.110s): install libegl1 and libgl1-mesa-dri, or "
                  "libosmesa6",
                  reasons[0].text, reasons[1].text, reasons[2].text);
}

/** "osmesa", "egl-surfaceless", "egl-device" (the first hardware one) or "egl-device0". */
static vxm_status make_named(vxm_engine **out, vxm_context *context, const char *name,
                             const vxm_engine_options *options, vxm_error *error) {
  for (int d = 0; d < DRIVERS; d++) {
    size_t length = strlen(drivers[d]->name);
    int index = 0, used = 0;
    if (strcmp(name, drivers[d]->name) == 0)
      return make_first(out, context, drivers[d], drivers[d] == &vxm_gl_egl_device, options, error);
    if (drivers[d] == &vxm_gl_egl_device && strncmp(name, drivers[d]->name, length) == 0 &&
        name[length] >= '0' && name[length] <= '9' && sscanf(name + length, "%2d%n", &index, &used) == 1 &&
        name[length + (size_t)used] == '\0')
      return vxm_opengl_create(out, context, drivers[d], index, options, error);
  }
  return vxm_fail(error, VXM_ERROR_ARGUMENT,
                  "engine: 'opengl:%s' is none of opengl:egl-device, opengl:egl-surfaceless, opengl:osmesa",
                  name);
}

static vxm_status make_opengl(vxm_engine **out, vxm_context *context, const char *name, bool hardware,
                              const vxm_engine_options *options, vxm_error *error) {
  return name ? make_named(out, context, name, options, error)
              : make_any(out, context, hardware, options, error);
}

/** Tries out context number `index` of a driver. */
static void look_at(vxm_engine_info *out, const vxm_gl_driver *driver, int index, vxm_context *context) {
  static const vxm_engine_options options = VXM_ENGINE_OPTIONS_INIT;
  vxm_error local = VXM_ERROR_INIT;
  vxm_engine *engine = NULL;
  *out = (vxm_engine_info){0};
  if (vxm_opengl_create(&engine, context, driver, index, &options, &local) == VXM_OK) {
    *out = engine->info;
    drop(engine, context);
    return;
  }
  vxm_opengl_name(out->name, sizeof out->name, driver, index);
  snprintf(out->note, sizeof out->note, "%.250s", local.text);
}

static void list_opengl(vxm_engine_info *out, int64_t capacity, int64_t *count, vxm_context *context) {
  for (int d = 0; d < DRIVERS; d++) {
    int found = drivers[d]->count(NULL),
        contexts = found > 0 ? found : 1; /* also one that is missing, and why */
    for (int i = 0; i < contexts; i++, ++*count)
      if (*count < capacity)
        look_at(&out[*count], drivers[d], i, context);
  }
}

#else

static vxm_status make_opengl(vxm_engine **out, vxm_context *context, const char *name, bool hardware,
                              const vxm_engine_options *options, vxm_error *error) {
  (void)context, (void)name, (void)hardware, (void)options;
  *out = NULL;
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                  "this voxmend was built without OpenGL (configure --with-opengl; Debian: libgl-dev, "
                  "libegl-dev)");
}

static void list_opengl(vxm_engine_info *out, int64_t capacity, int64_t *count, vxm_context *context) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_engine *none;
  make_opengl(&none, context, NULL, false, NULL, &local);
  list_missing(out, capacity, count, "opengl", &local);
}

#endif

#ifdef HAVE_OPENCL

/** The device that `name` (a number, or NULL) or the options choose. */
static vxm_status make_opencl(vxm_engine **out, vxm_context *context, const char *name, bool hardware,
                              const vxm_engine_options *options, vxm_error *error) {
  vxm_cl_device devices[VXM_CL_DEVICES_MAX];
  const vxm_cl *cl = vxm_cl_load(error);
  if (!cl)
    return VXM_ERROR_UNAVAILABLE;
  int count = vxm_cl_devices(devices, cl, error);
  if (count == 0)
    return VXM_ERROR_UNAVAILABLE;
  vxm_error local = VXM_ERROR_INIT;
  const char *choice = name ? name : options->device;
  int parts = 0, part = 0;
  char whole[64];
  snprintf(whole, sizeof whole, "%s", choice ? choice : "");
  if (vxm_cl_device_read_part(whole, &parts, &part))
    choice = whole;
  int chosen = vxm_cl_device_find(cl, devices, count, choice, &local);
  if (chosen < 0) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  vxm_engine_info info;
  vxm_cl_device_describe(&info, cl, &devices[chosen], chosen);
  if (hardware && !info.hardware)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "no OpenCL device here is a GPU or an accelerator");
  vxm_status status = parts > 0 ? vxm_cl_device_divide(&devices[chosen], cl, parts, part, error) : VXM_OK;
  if (status != VXM_OK)
    return status;
  return vxm_opencl_create(out, context, cl, &devices[chosen], chosen, options, error);
}

static void list_opencl(vxm_engine_info *out, int64_t capacity, int64_t *count, vxm_context *context) {
  static const vxm_engine_options options = VXM_ENGINE_OPTIONS_INIT;
  vxm_cl_device devices[VXM_CL_DEVICES_MAX];
  vxm_error local = VXM_ERROR_INIT;
  const vxm_cl *cl = vxm_cl_load(&local);
  int found = cl ? vxm_cl_devices(devices, cl, &local) : 0;
  for (int d = 0; d < found; d++, ++*count) {
    vxm_engine *engine;
    if (*count >= capacity)
      continue;
    vxm_cl_device_describe(&out[*count], cl, &devices[d], d);
    vxm_status status = vxm_opencl_create(&engine, context, cl, &devices[d], d, &options, &local);
    if (status == VXM_OK) {
      status = vxm_cl_ready(vxm_opencl_of(engine), VXM_CL_SOLID, &local);
      drop(engine, context);
    }
    if (status == VXM_OK)
      continue;
    out[*count].available = false;
    snprintf(out[*count].note, sizeof out->note, "%.250s", local.text);
  }
  if (found == 0)
    list_missing(out, capacity, count, "opencl", &local);
}

#else

static vxm_status make_opencl(vxm_engine **out, vxm_context *context, const char *name, bool hardware,
                              const vxm_engine_options *options, vxm_error *error) {
  (void)context, (void)name, (void)hardware, (void)options;
  *out = NULL;
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                  "this voxmend was built without OpenCL (configure --with-opencl; Debian: opencl-headers)");
}

static void list_opencl(vxm_engine_info *out, int64_t capacity, int64_t *count, vxm_context *context) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_engine *none;
  make_opencl(&none, context, NULL, false, NULL, &local);
  list_missing(out, capacity, count, "opencl", &local);
}

#endif

static const vxm_engine_info cpu_info = {.name = "cpu", .available = true, .hardware = true, .devices = 1};

static vxm_status make_cpu(vxm_engine **out, vxm_context *context, const char *note, vxm_error *error) {
  vxm_status status = VXM_OK;
  *out = vxm_try_calloc(context, 1, sizeof **out, &status, error);
  if (!*out)
    return status;
  (*out)->context = context;
  (*out)->info = cpu_info;
  snprintf((*out)->info.note, sizeof(*out)->info.note, "%.250s", note);
  return VXM_OK;
}

int vxm_engines_opencl_count(void) {
#ifdef HAVE_OPENCL
  vxm_cl_device devices[VXM_CL_DEVICES_MAX];
  const vxm_cl *cl = vxm_cl_load(NULL);
  return cl ? vxm_cl_devices(devices, cl, NULL) : 0;
#else
  return 0;
#endif
}

int vxm_engines_opengl_count(void) {
#ifdef HAVE_OPENGL
  return vxm_gl_egl_device.count(NULL);
#else
  return 0;
#endif
}

vxm_status vxm_engines_make_one(vxm_engine **out, vxm_context *context, const char *name,
                                const vxm_engine_options *options, vxm_error *error) {
  vxm_error reason = VXM_ERROR_INIT;
  if (strcmp(name, "cpu") == 0)
    return make_cpu(out, context, "", error);
  if (strcmp(name, "opengl") == 0)
    return make_opengl(out, context, NULL, false, options, error);
  if (strncmp(name, "opengl:", 7) == 0)
    return make_opengl(out, context, name + 7, false, options, error);
  if (strcmp(name, "opencl") == 0)
    return make_opencl(out, context, NULL, false, options, error);
  if (strncmp(name, "opencl:", 7) == 0)
    return make_opencl(out, context, name + 7, false, options, error);
  if (strcmp(name, "auto") != 0)
    return vxm_fail(
        error, VXM_ERROR_ARGUMENT,
        "engine: '%.40s' is none of auto, cpu, opencl, opengl and the names that 'voxmend engines' "
        "lists",
        name);
  vxm_status status = make_opencl(out, context, NULL, true, options, &reason);
  if (status == VXM_ERROR_UNAVAILABLE && !options->device) {
    vxm_error other = VXM_ERROR_INIT;
    status = make_opengl(out, context, NULL, true, options, &other);
    vxm_error both = VXM_ERROR_INIT;
    vxm_fail(&both, other.code, "%.200s; %.200s", reason.text, other.text);
    reason = both;
  }
  if (status == VXM_ERROR_ARGUMENT) /* a device that is not there */
    return vxm_fail(error, status, "%s", reason.text);
  if (status == VXM_OK)
    (*out)->falls_back = true;
  return status == VXM_OK ? VXM_OK : make_cpu(out, context, reason.text, error);
}

vxm_status vxm_engines_make(vxm_engine **out, vxm_context *context, const char *name,
                            const vxm_engine_options *options, vxm_error *error) {
  vxm_context *held = NULL;
  *out = NULL;
  vxm_status status = vxm_context_acquire(&held, context, error);
  if (status != VXM_OK)
    return status;
  status = vxm_multi_device_is_named(name) ? vxm_multi_device_make(out, held, name, options, error)
                                           : vxm_engines_make_one(out, held, name, options, error);
  if (status == VXM_OK) {
    (*out)->info.size = sizeof(*out)->info;
    atomic_init(&(*out)->reference_count, 1);
  } else
    vxm_context_release(held);
  return status;
}

void vxm_engine_destroy(vxm_engine *engine) {
  if (!engine || atomic_fetch_sub(&engine->reference_count, 1) > 1)
    return;
  vxm_context *context = engine->context;
  if (engine->ops)
    engine->ops->destroy(engine);
  vxm_free(context, engine);
  vxm_context_release(context);
}

vxm_status vxm_engines_list(vxm_engine_info *out, int64_t capacity, int64_t *count, vxm_context *context,
                            vxm_error *error) {
  vxm_context *held = NULL;
  vxm_status status = vxm_context_acquire(&held, context, error);
  if (status != VXM_OK)
    return status;
  *count = 1;
  if (capacity > 0)
    out[0] = cpu_info;
  list_opencl(out, capacity, count, held);
  list_opengl(out, capacity, count, held);
  vxm_context_release(held);
  return VXM_OK;
}
