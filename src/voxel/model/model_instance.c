/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/model/model_instance.h"
#include "voxel/solid/orient_by_vote.h"

#include <string.h>

vxm_status vxm_model_instance_prepare(vxm_model *model, vxm_error *error) {
  vxm_mesh_analysis *shape = &model->shape;
  const vxm_voxelize_options *options = &model->options;
  if (!vxm_model_wants_solid(model))
    return VXM_OK;
  if (options->method == VXM_METHOD_WINDING) {
    vxm_status status = vxm_orient_all(shape, error);
    if (status != VXM_OK)
      return status;
  }
  bool decides = vxm_caps_wanted(options) && vxm_voted_begin(shape) < shape->facets.split.part_count;
  return decides ? vxm_orient_open(shape, error) : VXM_OK;
}

/** Makes room for `count` elements, whose content is lost. */
static vxm_status make_room(vxm_context *context, void **block, size_t *room, size_t count, size_t size,
                            vxm_error *error) {
  if (count <= *room)
    return VXM_OK;
  vxm_error local = VXM_ERROR_INIT;
  vxm_free(context, *block);
  *block = vxm_alloc(context, count, size, &local);
  *room = *block ? count : 0;
  if (!*block)
    vxm_error_pass(error, &local);
  return local.code;
}

static void begin(vxm_model_instance *twin) {
  vxm_model *model = &twin->model;
  model->context = twin->context;
  model->shape.context = twin->context;
  model->shape.workspace = vxm_workspace_of(twin->context);
  model->run = (vxm_voxel_pass){.shape = &model->shape, .placed = {.context = twin->context}};
  model->run.open_wound.context = model->run.all_wound.context = twin->context;
}

static vxm_status reserve(vxm_model_instance *twin, const vxm_model *of, vxm_error *error) {
  const vxm_triangle_set *facets = &of->shape.facets;
  void *vertices = twin->vertices, *has_voxels = twin->model.run.has_voxels;
  vxm_status status = VXM_OK;
  if (vxm_model_wants_faces(of))
    status = make_room(twin->context, &vertices, &twin->vertex_room, facets->soup->vertex_count,
                       sizeof *twin->vertices, error);
  if (status == VXM_OK)
    status = make_room(twin->context, &has_voxels, &twin->part_room, facets->split.part_count,
                       sizeof *twin->model.run.has_voxels, error);
  twin->vertices = vertices;
  twin->model.run.has_voxels = has_voxels;
  return status;
}

vxm_status vxm_model_instance_attach(vxm_model_instance *twin, const vxm_model *of, vxm_error *error) {
  if (twin->of == of)
    return VXM_OK;
  vxm_model *model = &twin->model;
  if (!model->context)
    begin(twin);
  twin->of = NULL;
  vxm_surface_destroy(model->surface);
  model->surface = NULL;
  vxm_status status = reserve(twin, of, error);
  if (status != VXM_OK)
    return status;
  vxm_workspace workspace = model->shape.workspace;
  model->options = of->options;
  model->run.engine = of->options.engine;
  model->shape = of->shape;
  model->shape.context = twin->context;
  model->shape.options = &model->options;
  model->shape.workspace = workspace;
  model->shape.facets.context = twin->context;
  if (vxm_model_wants_faces(of)) {
    twin->soup = *of->shape.soup;
    twin->soup.context = twin->context;
    twin->soup.positions = (double *)twin->vertices;
    model->shape.soup = model->shape.facets.soup = &twin->soup;
    /* Polygons are cut as they lie in the other's mesh, whatever variant comes first. */
    memcpy(twin->vertices, of->shape.soup->positions, twin->soup.vertex_count * sizeof *twin->vertices);
    status = vxm_surface_make(&model->surface, &twin->soup, error);
    if (status != VXM_OK)
      return status;
  }
  twin->of = of;
  return VXM_OK;
}

vxm_status vxm_model_instance_fill(vxm_model_instance *twin, const vxm_window *window,
                                   const vxm_lattice *lattice, const vxm_variation *variation,
                                   vxm_error *error) {
  vxm_model *model = &twin->model;
  vxm_triangle_set *facets = &model->shape.facets;
  const vxm_triangle_set *own = &twin->of->shape.facets;
  double count = (double)facets->facet_count, stretch = variation->stretch, reach = variation->reach;
  /* (a + b)^2 <= 2 a^2 + 2 b^2 */
  facets->length = own->length * stretch + count * reach;
  facets->squared_length = 2 * (own->squared_length * stretch * stretch + count * reach * reach);
  model->run.motion = &variation->points;
  if (vxm_model_wants_faces(model))
    vxm_vertex_transform_apply(twin->context, twin->vertices, &variation->vertices);
  vxm_status status = vxm_model_begin_on(model, lattice, NULL, NULL, error);
  model->run.motion = NULL;
  model->run.mirrored = variation->mirrored;
  return status == VXM_OK ? vxm_model_fill(model, window, error) : status;
}

void vxm_model_instance_destroy(vxm_model_instance *twin) {
  vxm_model *model = &twin->model;
  if (model->context) {
    vxm_surface_destroy(model->surface);
    vxm_free(twin->context, model->run.has_voxels);
    vxm_voxel_pass_destroy(&model->run);
    vxm_shell_window_destroy(&model->shelling, twin->context);
    vxm_workspace_destroy(&model->shape.workspace);
  }
  vxm_free(twin->context, twin->vertices);
  *twin = (vxm_model_instance){.context = twin->context};
}
