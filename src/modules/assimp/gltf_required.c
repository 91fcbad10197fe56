/* SPDX-License-Identifier: BSD-3-Clause */
#include "modules/assimp/gltf_required.h"

#include <string.h>

/* Without these a mesh has the same shape, at the same place. Names that end in '_' stand for all that begin
 * so: materials, textures, light, and what is told of an object. */
static const char *const harmless[] = {"KHR_materials_",
                                       "KHR_texture_",
                                       "KHR_lights_",
                                       "KHR_xmp",
                                       "KHR_xmp_json_ld",
                                       "KHR_techniques_webgl",
                                       "KHR_animation_pointer",
                                       "KHR_audio",
                                       "KHR_audio_",
                                       "EXT_texture_",
                                       "EXT_lights_",
                                       "EXT_materials_",
                                       "EXT_mesh_features",
                                       "EXT_instance_features",
                                       "EXT_structural_metadata",
                                       "ADOBE_materials_",
                                       "MSFT_texture_",
                                       "MSFT_packing_",
                                       "MSFT_lod",
                                       "GOOGLE_texture_",
                                       "GRIFFEL_bim_data",
                                       "VRM",
                                       "VRMC_"};

/* Read here (gltf_floats.c), and by Assimp, which says so where it is built without. */
static const char *const known[] = {"KHR_mesh_quantization", "KHR_draco_mesh_compression"};

/* What others need. */
static const struct {
  const char *name, *advice;
} helped[] = {
    {"EXT_meshopt_compression", "unpack it with 'gltf-transform copy IN OUT.glb', or export it without"},
    {"KHR_meshopt_compression", "unpack it with 'gltf-transform copy IN OUT.glb', or export it without"},
    {"EXT_mesh_gpu_instancing", "export it with a node for each instance"},
};

static bool is_listed(const char *const *list, size_t count, const char *name) {
  for (size_t i = 0; i < count; i++) {
    size_t length = strlen(list[i]);
    bool is_prefix = list[i][length - 1] == '_';
    if (is_prefix ? strncmp(name, list[i], length) == 0 : strcmp(name, list[i]) == 0)
      return true;
  }
  return false;
}

static const char *advice_for(const char *name) {
  for (size_t i = 0; i < sizeof helped / sizeof *helped; i++)
    if (strcmp(name, helped[i].name) == 0)
      return helped[i].advice;
  return "export it without";
}

static vxm_status refuse(const char *extension, const char *name, vxm_error *error) {
  return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){name, 0, -1, -1},
                     "it needs the glTF extension %.60s, which is not read: %s", extension,
                     advice_for(extension));
}

/** Instances are lost without, whether the file says that it needs them or not. */
static bool has_instances(const json_t *root) {
  const json_t *node;
  size_t n;
  json_array_foreach(json_object_get(root, "nodes"), n, node) {
    if (json_object_get(json_object_get(node, "extensions"), "EXT_mesh_gpu_instancing"))
      return true;
  }
  return false;
}

vxm_status vxm_gltf_check_required(const json_t *root, const char *name, vxm_error *error) {
  const json_t *item;
  size_t i;
  json_array_foreach(json_object_get(root, "extensionsRequired"), i, item) {
    const char *extension = json_string_value(item);
    if (extension && !is_listed(known, sizeof known / sizeof *known, extension) &&
        !is_listed(harmless, sizeof harmless / sizeof *harmless, extension))
      return refuse(extension, name, error);
  }
  return has_instances(root) ? refuse("EXT_mesh_gpu_instancing", name, error) : VXM_OK;
}
