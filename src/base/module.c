/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/module.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/error.h"
#include "config.h"

/* Writes DIRECTORY/SUBFOLDERvoxmend-NAME.so if there is such a file. */
static bool found_in(char path[VXM_MODULE_PATH_MAX], const char *directory, size_t length,
                     const char *subfolder, const char *name) {
  if (length == 0 || length >= VXM_MODULE_PATH_MAX)
    return false;
  int written =
      snprintf(path, VXM_MODULE_PATH_MAX, "%.*s/%svoxmend-%s.so", (int)length, directory, subfolder, name);
  return written > 0 && written < VXM_MODULE_PATH_MAX && access(path, R_OK) == 0;
}

static bool find_file(char path[VXM_MODULE_PATH_MAX], const char *name) {
  const char *chosen = secure_getenv("VOXMEND_MODULES");
  if (chosen != NULL) /* there and nowhere else */
    return found_in(path, chosen, strlen(chosen), "", name);
  Dl_info self;
  if (dladdr((void *)(uintptr_t)&vxm_module_open, &self) != 0 && self.dli_fname != NULL) {
    const char *end = strrchr(self.dli_fname, '/');
    size_t length = end == NULL ? 0 : (size_t)(end - self.dli_fname);
    if (found_in(path, self.dli_fname, length, "voxmend/", name) ||
        found_in(path, self.dli_fname, length, "", name))
      return true;
  }
  return found_in(path, VXM_MODULE_DIR, strlen(VXM_MODULE_DIR), "", name);
}

static vxm_status missing(const vxm_module_need *need, vxm_error *error) {
  return vxm_fail(
      error, VXM_ERROR_UNAVAILABLE,
      "%s needs voxmend's module \"%s\", which is not installed (configure --with-%s; Debian: %s)",
      need->purpose, need->name, need->name, need->package);
}

vxm_status vxm_module_find(char path[VXM_MODULE_PATH_MAX], const vxm_module_need *need, vxm_error *error) {
  return find_file(path, need->name) ? VXM_OK : missing(need, error);
}

vxm_status vxm_module_load(const vxm_module **out, const char *path, const char *purpose, vxm_error *error) {
  *out = NULL;
  /* Opening it again costs a look-up. It is never closed: libraries of C++ may leave threads and handlers
   * behind. */
  void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (handle == NULL)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "%s needs a module that cannot be loaded: %s", purpose,
                    dlerror());
  const vxm_module *module = dlsym(handle, VXM_MODULE_SYMBOL);
  if (module == NULL || strcmp(module->version, PACKAGE_VERSION) != 0)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                    "%s needs a module of voxmend %s; %s is of %s: install them together", purpose,
                    PACKAGE_VERSION, path, module == NULL ? "something else" : module->version);
  *out = module;
  return VXM_OK;
}

vxm_status vxm_module_open(const vxm_module **out, const vxm_module_need *need, vxm_error *error) {
  *out = NULL;
  char path[VXM_MODULE_PATH_MAX];
  vxm_status status = vxm_module_find(path, need, error);
  return status == VXM_OK ? vxm_module_load(out, path, need->purpose, error) : status;
}
