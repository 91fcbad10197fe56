/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/model/model_instance.h"
#include "voxel/solid/solid_fill.h"

vxm_status vxm_model_instance_prepare(const vxm_model *model, vxm_error *error) {
  return vxm_solid_wanted(&model->options) ? vxm_solid_prepare(&model->analysis, &model->options, error)
                                           : VXM_OK;
}

/** Makes room for the vertices of a soup, and cuts its polygons: as they lie in the model, whatever variant
 * comes first. */
static vxm_status make_surface(vxm_model_instance *instance, const vxm_soup *soup, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  if (soup->vertex_count > instance->vertex_capacity) {
    vxm_free(instance->context, instance->vertices);
    instance->vertices = vxm_alloc(instance->context, soup->vertex_count, sizeof *instance->vertices, &local);
    instance->vertex_capacity = instance->vertices ? soup->vertex_count : 0;
  }
  if (local.code != VXM_OK) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  return vxm_surface_make(&instance->pass.surface, instance->context, soup, error);
}

vxm_status vxm_model_instance_attach(vxm_model_instance *instance, const vxm_model *of, vxm_error *error) {
  if (instance->of == of)
    return VXM_OK;
  if (!instance->is_started)
    vxm_model_pass_start(&instance->pass, instance->context);
  instance->is_started = true;
  instance->of = NULL;
  vxm_status status = vxm_model_pass_attach(&instance->pass, &of->analysis, &of->options, error);
  if (status == VXM_OK && vxm_faces_wanted(&of->options))
    status = make_surface(instance, of->analysis.soup, error);
  if (status == VXM_OK)
    instance->of = of;
  return status;
}

vxm_status vxm_model_instance_place(vxm_model_instance *instance, const vxm_lattice *lattice,
                                    const vxm_variation *variation, vxm_error *error) {
  vxm_model_pass *pass = &instance->pass;
  if (vxm_faces_wanted(&pass->solid.options)) {
    vxm_vertex_transform_apply(instance->context, instance->vertices, &variation->vertices);
    pass->vertices = (const double(*)[3])instance->vertices;
  }
  pass->solid.motion = &variation->points;
  vxm_status status = vxm_model_pass_place(pass, lattice, NULL, NULL, error);
  pass->solid.motion = NULL;
  if (variation->is_field)
    vxm_model_pass_make_field(pass);
  pass->solid.mirrored = variation->mirrored;
  return status;
}

void vxm_model_instance_destroy(vxm_model_instance *instance) {
  if (instance->is_started)
    vxm_model_pass_end(&instance->pass);
  vxm_free(instance->context, instance->vertices);
  *instance = (vxm_model_instance){.context = instance->context};
}
