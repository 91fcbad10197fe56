/* SPDX-License-Identifier: BSD-3-Clause */
/** The module voxmend-assimp.so: glTF, 3MF, COLLADA, FBX, 3DS and the rest through Assimp's C functions. */
#include "modules/assimp/assimp.h"
#include "modules/assimp/three_mf.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <stdio.h>
#include <string.h>

#include "base/module.h"
#include "config.h"

/** The message of the last failure as one line. */
static void last_message(char *text, size_t size) {
  const char *message = aiGetErrorString();
  snprintf(text, size, "%s", message && *message ? message : "no reason given");
  for (char *c = text; *c; c++)
    if ((unsigned char)*c < ' ')
      *c = ' ';
}

/** The name that Assimp knows is none of the user's, and messages with it tell no more than that it is not as
 * it should be. */
static vxm_status fail_import(const char *name, const char *path, vxm_error *error) {
  char message[300];
  last_message(message, sizeof message);
  if (strstr(message, path))
    snprintf(message, sizeof message, "it is likely cut off or damaged, or no %s file", strrchr(path, '.'));
  if (strstr(message, "bad_alloc"))
    return vxm_fail_at(error, VXM_ERROR_MEMORY, (vxm_place){name, 0, -1, -1}, "not enough memory to read it");
  return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){name, 0, -1, -1}, "Assimp cannot read it: %s",
                     message);
}

/** Only what helps to find the meshes; what would change them stays off. */
static struct aiPropertyStore *make_properties(void) {
  struct aiPropertyStore *properties = aiCreatePropertyStore();
  if (!properties)
    return NULL;
  aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1);
  aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, 1);
  aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, 0);
  return properties;
}

/** Assimp goes by the extension, and puts the folder of this name before those that the file refers to: it
 * gets a name without one, and so asks for what stands in the file. */
static void make_path(char *path, size_t size, const vxm_reader_request *request) {
  snprintf(path, size, "voxmend-mesh.%s", request->hint);
}

static bool is_gltf(const vxm_reader_request *request) {
  return strcmp(request->hint, "gltf") == 0 || strcmp(request->hint, "glb") == 0;
}

static vxm_status import(vxm_soup *soup, const vxm_reader_request *request, const char *path,
                         const vxm_gltf *gltf, vxm_error *error) {
  vxm_assimp_files files;
  vxm_assimp_files_init(&files, request, soup->context, path, gltf);
  struct aiPropertyStore *properties = make_properties();
  if (!properties)
    return vxm_fail(error, VXM_ERROR_MEMORY, "not enough memory to read the file");
  const struct aiScene *scene = aiImportFileExWithProperties(path, 0, &files.io, properties);
  aiReleasePropertyStore(properties);
  if (!scene)
    return fail_import(request->name, path, error);
  if (soup->appearance)
    soup->appearance->is_product = is_gltf(request);
  vxm_status status = vxm_assimp_flatten(soup, scene, error);
  aiReleaseImport(scene);
  return status;
}

/** Assimp takes any bytes for an empty scene of X3D. */
static bool is_no_x3d(const vxm_reader_request *request) {
  return strcmp(request->hint, "x3d") == 0 && !memmem(request->data, request->size, "<X3D", 4);
}

/** Brings a soup to millimetres. */
static void apply_unit(vxm_soup *soup, double unit) {
  for (size_t i = 0; unit != 1 && i < 3 * (size_t)soup->vertex_count; i++)
    soup->positions[i] *= unit;
}

static vxm_status read_scene(vxm_soup *soup, const vxm_reader_request *request, vxm_error *error) {
  char extension[24], path[48];
  snprintf(extension, sizeof extension, ".%s", request->hint);
  if (!aiIsExtensionSupported(extension))
    return vxm_fail_at(error, VXM_ERROR_UNAVAILABLE, (vxm_place){request->name, 0, -1, -1},
                       "this build of Assimp does not read %s files", extension);
  make_path(path, sizeof path, request);
  vxm_gltf gltf = {0};
  vxm_status status = VXM_OK;
  if (is_gltf(request))
    status = vxm_gltf_prepare(&gltf, request, soup->context, &soup->warnings, error);
  vxm_reader_request narrowed = *request;
  unsigned char *archive = NULL;
  double unit = 1;
  if (strcmp(request->hint, "3mf") == 0) {
    status = vxm_three_mf_check(&unit, request, soup->context, error);
    if (status == VXM_OK)
      status = vxm_three_mf_narrow(&archive, request, soup->context, error);
    if (archive)
      narrowed.data = archive;
  }
  if (status == VXM_OK)
    status = import(soup, &narrowed, path, is_gltf(request) ? &gltf : NULL, error);
  if (status == VXM_OK && soup->face_count == 0 && is_no_x3d(request))
    status = vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){request->name, 0, -1, -1},
                         "Assimp cannot read it: no X3D element");
  if (status == VXM_OK)
    apply_unit(soup, unit);
  vxm_free(soup->context, archive);
  vxm_gltf_destroy(&gltf, soup->context);
  return status;
}

/** The first question makes all importers; nothing is loaded later. */
static void prepare(void) {
  aiIsExtensionSupported(".glb");
  vxm_gltf_start();
}

static const vxm_reader reader = {prepare, read_scene, NULL};

__attribute__((visibility("default"))) extern const vxm_module vxm_module_table;
const vxm_module vxm_module_table = {VXM_BUILD, "Assimp " VXM_ASSIMP_VERSION, "BSD-3-Clause", &reader};
