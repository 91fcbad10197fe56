/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/module.h"

#include <dlfcn.h>
#include <elf.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/auxv.h>
#include <unistd.h>

#include "base/error.h"
#include "config.h"
#include "module_folder.h"

/* Writes DIRECTORY/SUBFOLDERvoxmend-NAME.so if there is such a file. */
static bool found_in(char path[VXM_MODULE_PATH_MAX], const char *directory, size_t length,
                     const char *subfolder, const char *name) {
  if (length == 0 || length >= VXM_MODULE_PATH_MAX)
    return false;
  int written =
      snprintf(path, VXM_MODULE_PATH_MAX, "%.*s/%svoxmend-%s.so", (int)length, directory, subfolder, name);
  return written > 0 && written < VXM_MODULE_PATH_MAX && access(path, R_OK) == 0;
}

/** What this code lies in, a library or a program. */
typedef struct code_file {
  size_t seen;         /**< files of the process that were looked at */
  bool is_program;     /**< it is the first of them */
  bool needs_loader;   /**< the program names one */
  const char *library; /**< the loader's path; NULL if it is not known */
} code_file;

static bool holds(const struct dl_phdr_info *file, uintptr_t address) {
  for (size_t p = 0; p < file->dlpi_phnum; p++) {
    const ElfW(Phdr) *part = &file->dlpi_phdr[p];
    uintptr_t begin = (uintptr_t)file->dlpi_addr + (uintptr_t)part->p_vaddr;
    if (part->p_type == PT_LOAD && address >= begin && address - begin < part->p_memsz)
      return true;
  }
  return false;
}

static int look_at_file(struct dl_phdr_info *file, size_t size, void *payload) {
  code_file *s = payload;
  (void)size;
  bool is_program = s->seen++ == 0;
  for (size_t p = 0; is_program && p < file->dlpi_phnum; p++)
    s->needs_loader |= file->dlpi_phdr[p].p_type == PT_INTERP;
  if (!holds(file, (uintptr_t)&vxm_module_open))
    return 0;
  s->is_program = is_program;
  s->library = is_program ? NULL : file->dlpi_name;
  return 1;
}

static code_file look_at_self(void) {
  code_file s = {0};
  dl_iterate_phdr(look_at_file, &s);
  return s;
}

/** A static program has no loader, with which to open anything. */
static bool is_static(void) {
  code_file s = look_at_self();
  return s.is_program && !s.needs_loader;
}

/**
 * The file that this code lies in. Only what is beyond doubt is believed: the loader's path of a library if
 * it is absolute, and what the kernel says of the program, never argv[0].
 */
static bool find_self(char path[VXM_MODULE_PATH_MAX]) {
  code_file s = look_at_self();
  ssize_t length = 0;
  if (s.is_program)
    length = readlink("/proc/self/exe", path, VXM_MODULE_PATH_MAX - 1);
  else if (s.library)
    length = snprintf(path, VXM_MODULE_PATH_MAX, "%s", s.library);
  if (length <= 0 || length >= VXM_MODULE_PATH_MAX - 1 || path[0] != '/')
    return false;
  path[length] = '\0';
  return true;
}

static bool find_beside(char path[VXM_MODULE_PATH_MAX], const char *name) {
  char self[VXM_MODULE_PATH_MAX];
  if (!find_self(self))
    return false;
  size_t length = (size_t)(strrchr(self, '/') - self);
  return found_in(path, self, length, "voxmend/", name) || found_in(path, self, length, "", name);
}

/** A program with rights that its user lacks opens what was installed, and nothing else. */
static bool find_file(char path[VXM_MODULE_PATH_MAX], const char *name) {
  const char *chosen = secure_getenv("VOXMEND_MODULES");
  if (chosen != NULL) /* there and nowhere else */
    return found_in(path, chosen, strlen(chosen), "", name);
  if (getauxval(AT_SECURE) == 0 && find_beside(path, name))
    return true;
  return !VXM_WHEEL && found_in(path, VXM_MODULE_DIR, strlen(VXM_MODULE_DIR), "", name);
}

/** The option of configure that a module takes: that of its first library. */
static const char *option_of(const char *module) {
  return strcmp(module, "images") == 0 ? "png" : module;
}

static vxm_status missing(const vxm_module_need *need, vxm_error *error) {
  if (VXM_WHEEL && strcmp(need->name, "cgal") == 0)
    return vxm_fail(
        error, VXM_ERROR_UNAVAILABLE,
        "%s needs voxmend's module \"cgal\", which is under the GPL and in no package of PyPI: build "
        "voxmend from its own sources (configure --with-cgal; Debian: %s)",
        need->purpose, need->package);
  if (VXM_WHEEL)
    return vxm_fail(
        error, VXM_ERROR_UNAVAILABLE,
        "%s needs voxmend's module \"%s\", which is not in this wheel: install its libraries (Debian: "
        "%s), and then voxmend by pip from its archive of sources",
        need->purpose, need->name, need->package);
  return vxm_fail(
      error, VXM_ERROR_UNAVAILABLE,
      "%s needs voxmend's module \"%s\", which is not installed (configure --with-%s; Debian: %s)",
      need->purpose, need->name, option_of(need->name), need->package);
}

vxm_status vxm_module_find(char path[VXM_MODULE_PATH_MAX], const vxm_module_need *need, vxm_error *error) {
  if (is_static())
    return vxm_fail(
        error, VXM_ERROR_UNAVAILABLE,
        "%s needs voxmend's module \"%s\", and this is a static program, which cannot open modules: "
        "use one that is linked with the C library's loader",
        need->purpose, need->name);
  const char *chosen = secure_getenv("VOXMEND_MODULES");
  if (chosen != NULL && chosen[0] != '/')
    return vxm_fail(
        error, VXM_ERROR_UNAVAILABLE,
        "%s: the variable VOXMEND_MODULES has to name a folder by an absolute path, not \"%.200s\"",
        need->purpose, chosen);
  return find_file(path, need->name) ? VXM_OK : missing(need, error);
}

bool vxm_module_exists(const char *name) {
  char path[VXM_MODULE_PATH_MAX];
  const vxm_module_need need = {name, "", ""};
  return vxm_module_find(path, &need, NULL) == VXM_OK;
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
  if (module == NULL || strcmp(module->build, VXM_BUILD) != 0)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                    "%s needs a module of voxmend %s; %s is of %s: install them together", purpose, VXM_BUILD,
                    path, module == NULL ? "something else" : module->build);
  *out = module;
  return VXM_OK;
}

vxm_status vxm_module_open(const vxm_module **out, const vxm_module_need *need, vxm_error *error) {
  *out = NULL;
  char path[VXM_MODULE_PATH_MAX];
  vxm_status status = vxm_module_find(path, need, error);
  return status == VXM_OK ? vxm_module_load(out, path, need->purpose, error) : status;
}
