/* SPDX-License-Identifier: BSD-3-Clause */
/** What is wrong with a mesh, and where: the options, list and picture of info and repair. */
#include "cli/defects.h"

#include <inttypes.h>
#include <string.h>

int cli_defects_check(cli_run *cli, const cli_defects *defects) {
  const char *locate = defects->locate;
  if (!locate)
    return CLI_END;
  if (!cli_is_extension(locate, "ply"))
    return cli_usage(cli, "--locate '%s': the name must end in .ply", locate);
  return CLI_END;
}

static json_t *defect_json(const vxm_defect *defect) {
  json_t *object = json_object(), *element = json_array();
  bool pair = defect->element[1] >= 0;
  bool is_edge = defect->kind >= VXM_DEFECT_BOUNDARY_EDGE && defect->kind <= VXM_DEFECT_INCONSISTENT_EDGE;
  bool is_vertex =
      defect->kind == VXM_DEFECT_NONFINITE_VERTEX || defect->kind == VXM_DEFECT_NONMANIFOLD_VERTEX;
  json_array_append_new(element, json_integer(defect->element[0]));
  if (pair)
    json_array_append_new(element, json_integer(defect->element[1]));
  json_object_set_new(object, "kind", json_string(vxm_defect_name(defect->kind)));
  json_object_set_new(object, is_edge || is_vertex ? "vertices" : "faces", element);
  json_t *places = json_array();
  for (int i = 0; i < (pair ? 2 : 1); i++)
    json_array_append_new(places, cli_json_numbers(defect->position + 3 * i, 3));
  json_object_set_new(object, "position", places);
  return object;
}

static json_t *list_json(const vxm_defects *found, int64_t most) {
  json_t *list = json_array();
  int64_t of_kind[VXM_DEFECT_KINDS] = {0};
  for (int64_t i = 0; i < vxm_defects_count(found); i++) {
    const vxm_defect *defect = vxm_defects_item(found, i);
    if (of_kind[defect->kind]++ < most)
      json_array_append_new(list, defect_json(defect));
  }
  return list;
}

int cli_defects_show(cli_run *cli, cli_found *out, const cli_defects *wanted, const vxm_mesh *mesh) {
  vxm_defects *found = NULL;
  *out = (cli_found){.intersections = -1};
  if (!wanted->list && !wanted->locate && !wanted->intersections)
    return CLI_DONE;
  int64_t most = wanted->locate ? 0 : wanted->list ? wanted->list : 1;
  vxm_status status = vxm_mesh_defects(&found, mesh, most, wanted->intersections, &cli->error);
  if (status == VXM_OK && wanted->locate)
    status = vxm_defects_write(found, mesh, wanted->locate, &cli->error);
  if (status == VXM_OK && wanted->list)
    out->list = list_json(found, wanted->list);
  if (status == VXM_OK)
    out->intersections = vxm_defects_total(found, VXM_DEFECT_SELF_INTERSECTION);
  vxm_defects_destroy(found);
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}

static void print_places(const cli_run *cli, const json_t *places) {
  size_t i;
  json_t *place;
  json_array_foreach(places, i, place) {
    fputs(i > 0 ? "," : "  at", cli->text);
    for (size_t axis = 0; axis < json_array_size(place); axis++) {
      const json_t *value = json_array_get(place, axis);
      if (json_is_number(value))
        fprintf(cli->text, " %.6g", json_number_value(value));
      else
        fputs(" ?", cli->text);
    }
  }
}

void cli_defects_print(const cli_run *cli, const json_t *list) {
  size_t i, e;
  json_t *defect, *number;
  if (!list)
    return;
  fprintf(cli->text, "\n%-20s %s\n", "Defect", json_array_size(list) > 0 ? "numbers and places" : "none");
  json_array_foreach(list, i, defect) {
    const json_t *vertices = json_object_get(defect, "vertices");
    const json_t *numbers = vertices ? vertices : json_object_get(defect, "faces");
    const char *plural = json_array_size(numbers) > 1 ? vertices ? "vertices" : "faces"
                         : vertices                   ? "vertex"
                                                      : "face";
    fprintf(cli->text, "  %-18s %s", json_string_value(json_object_get(defect, "kind")), plural);
    json_array_foreach(numbers, e, number)
        fprintf(cli->text, " %" JSON_INTEGER_FORMAT, json_integer_value(number));
    print_places(cli, json_object_get(defect, "position"));
    fputc('\n', cli->text);
  }
}

int cli_defects_check_file(cli_run *cli, const cli_defects *defects) {
  return defects->locate ? cli_check_surface_file(cli, defects->locate, "ply") : CLI_END;
}
