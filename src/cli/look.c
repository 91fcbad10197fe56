/* SPDX-License-Identifier: BSD-3-Clause */
/** What a mesh looks like, in reports: colours, materials and textures. */
#include "cli/field.h"

#include <inttypes.h>
#include <string.h>

/** Whether there is anything to tell. */
static bool get(vxm_look *look, const vxm_mesh *mesh) {
  *look = (vxm_look)VXM_LOOK_INIT;
  return vxm_mesh_look(look, mesh, NULL) == VXM_OK &&
         (look->vertex_colors || look->face_colors || look->materials > 0);
}

static json_t *textures_json(const vxm_mesh *mesh, const vxm_look *look) {
  json_t *array = json_array();
  for (int64_t t = 0; t < look->textures; t++) {
    vxm_texture texture = VXM_TEXTURE_INIT;
    json_t *object = json_object();
    if (vxm_mesh_texture(&texture, mesh, t, NULL) == VXM_OK) {
      json_object_set_new(object, "name", cli_json_text(texture.name));
      json_object_set_new(object, "width", json_integer(texture.width));
      json_object_set_new(object, "height", json_integer(texture.height));
      if (texture.failure[0])
        json_object_set_new(object, "failure", cli_json_text(texture.failure));
    }
    json_array_append_new(array, object);
  }
  return array;
}

void cli_look_json(json_t *report, const vxm_mesh *mesh) {
  vxm_look look;
  if (!get(&look, mesh))
    return;
  json_t *object = json_object();
  json_object_set_new(object, "vertices", json_boolean(look.vertex_colors));
  json_object_set_new(object, "faces", json_boolean(look.face_colors));
  json_object_set_new(object, "materials", json_integer(look.materials));
  json_object_set_new(object, "textures", textures_json(mesh, &look));
  json_object_set_new(report, "colors", object);
}

static void print_textures(const cli_run *cli, const vxm_mesh *mesh, int64_t count) {
  enum { SHOWN = 4 };
  for (int64_t t = 0; t < count && (t < SHOWN || cli->verbose); t++) {
    vxm_texture texture = VXM_TEXTURE_INIT;
    if (vxm_mesh_texture(&texture, mesh, t, NULL) != VXM_OK)
      continue;
    fprintf(cli->text, "%s%s ", t == 0 ? " (" : ", ", texture.name[0] ? texture.name : "unnamed");
    if (texture.width > 0)
      fprintf(cli->text, "%" PRId64 " x %" PRId64, texture.width, texture.height);
    else
      fputs("cannot be read", cli->text);
  }
  fputs(count > SHOWN && !cli->verbose ? ", ...)" : count > 0 ? ")" : "", cli->text);
}

void cli_look_print(const cli_run *cli, const vxm_mesh *mesh) {
  vxm_look look;
  if (!get(&look, mesh))
    return;
  if (look.vertex_colors || look.face_colors)
    fprintf(cli->text, "  %-26s %12s\n", "colours",
            !look.face_colors     ? "per vertex"
            : !look.vertex_colors ? "per face"
                                  : "per vertex and face");
  if (look.materials > 0)
    fprintf(cli->text, "  %-26s %12" PRId64 "\n", "materials", look.materials);
  if (look.textures > 0) {
    fprintf(cli->text, "  %-26s %12" PRId64, "textures", look.textures);
    print_textures(cli, mesh, look.textures);
    fputc('\n', cli->text);
  }
}
