/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Optional parts that need large libraries lie in modules of their own, voxmend-NAME.so, opened when they are
 * first needed: a program that reads an OFF file does not wait for the 50 ms that the libraries of STEP or
 * VDB files take to load. A module is made of an adapter and of the base folder, and exports one vxm_module.
 */
#ifndef VXM_BASE_MODULE_H
#define VXM_BASE_MODULE_H

#include "build_hash.h"
#include "voxmend/base.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Of which build code is: the version, and a hash of all headers; config.h comes first. */
#define VXM_BUILD PACKAGE_VERSION "+" VXM_BUILD_HASH

/** What a module exports under the name of VXM_MODULE_SYMBOL. */
typedef struct vxm_module {
  const char *build;     /**< VXM_BUILD: has to be that of the library, as both share structures */
  const char *library;   /**< what it is made with, such as "OpenVDB 10.0.1" */
  const char *licence;   /**< of the module, an SPDX expression */
  const void *functions; /**< a structure of function pointers, declared by the folder that uses the module */
} vxm_module;

#define VXM_MODULE_SYMBOL "vxm_module_table"

/** Which module, and how to say that it is missing. */
typedef struct vxm_module_need {
  const char *name;    /**< such as "openvdb"; also the name of the option of configure */
  const char *package; /**< Debian's package to build it with */
  const char *purpose; /**< what asks for it, such as "writing .vdb files" */
} vxm_module_need;

enum { VXM_MODULE_PATH_MAX = 4096 };

/**
 * Opens a module, which then stays open. It is looked for in $VOXMEND_MODULES, an absolute path, alone if
 * that is set, else beside the library and where it was installed; in a program that runs with rights of its
 * own (setuid, capabilities) only there. A wheel's library looks for them beside itself alone.
 *
 * @return VXM_OK; VXM_ERROR_UNAVAILABLE if it is missing, cannot be loaded, or belongs to another build
 */
vxm_status vxm_module_open(const vxm_module **out, const vxm_module_need *need, vxm_error *error);

/* The two steps of it, where another process is to open the module. */

/** Where a module lies. */
vxm_status vxm_module_find(char path[VXM_MODULE_PATH_MAX], const vxm_module_need *need, vxm_error *error);
/** Whether there is a module of this name. */
bool vxm_module_exists(const char *name);
/** Opens the module at a path; `purpose` is what asks for it. */
vxm_status vxm_module_load(const vxm_module **out, const char *path, const char *purpose, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
