/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/model/model.h"

static vxm_status fill_model(vxm_model *model, const vxm_soup *soup, vxm_error *error) {
  const vxm_voxelize_options *options = &model->options;
  vxm_split_rule rule = {options->split_mode, options->cavities, vxm_caps_wanted(options)};
  vxm_status status = vxm_model_results_create(&model->results, model->context, error);
  return status == VXM_OK
             ? vxm_mesh_analysis_create(&model->analysis, soup, rule, vxm_fills_overlaps(options), error)
             : status;
}

vxm_status vxm_model_make(vxm_model **out, const vxm_soup *soup, const vxm_voxelize_options *options,
                          vxm_error *error) {
  vxm_status status = VXM_OK;
  vxm_model *model = vxm_try_calloc(soup->context, 1, sizeof *model, &status, error);
  *out = NULL;
  if (!model)
    return status;
  status = vxm_context_acquire(&model->context, soup->context, error);
  pthread_mutex_init(&model->mutex, NULL);
  model->options = *options;
  if (status == VXM_OK)
    status = fill_model(model, soup, error);
  if (status != VXM_OK) {
    vxm_model_destroy(model);
    return status;
  }
  *out = model;
  return VXM_OK;
}

static void destroy_pass(vxm_model *model, vxm_model_pass *pass) {
  vxm_model_pass_end(pass);
  vxm_free(model->context, pass);
}

void vxm_model_destroy(vxm_model *model) {
  if (!model)
    return;
  vxm_context *context = model->context;
  for (vxm_model_pass *pass = model->idle, *next; pass; pass = next) {
    next = pass->next;
    destroy_pass(model, pass);
  }
  vxm_model_results_destroy(model->results);
  vxm_mesh_analysis_destroy(&model->analysis);
  pthread_mutex_destroy(&model->mutex);
  vxm_free(context, model);
  vxm_context_release(context);
}

/* ---- Passes ---- */

static vxm_model_pass *take_idle(vxm_model *model) {
  pthread_mutex_lock(&model->mutex);
  vxm_model_pass *pass = model->idle;
  if (pass)
    model->idle = pass->next;
  pthread_mutex_unlock(&model->mutex);
  return pass;
}

static vxm_status make_pass(vxm_model_pass **out, vxm_model *model, vxm_error *error) {
  vxm_status status = VXM_OK;
  vxm_model_pass *pass = vxm_try_alloc(model->context, 1, sizeof *pass, &status, error);
  if (!pass)
    return status;
  vxm_model_pass_start(pass, model->context);
  status = vxm_model_pass_attach(pass, &model->analysis, &model->options, error);
  if (status == VXM_OK)
    *out = pass;
  else
    destroy_pass(model, pass);
  return status;
}

void vxm_model_close(vxm_model *model, vxm_model_pass *pass) {
  if (!pass)
    return;
  pthread_mutex_lock(&model->mutex);
  pass->next = model->idle;
  model->idle = pass;
  pthread_mutex_unlock(&model->mutex);
}

vxm_status vxm_model_begin(vxm_model_pass **out, vxm_model *model, const vxm_space *space,
                           const double transform[12], uint8_t *confidence, vxm_error *error) {
  vxm_lattice lattice = vxm_lattice_of(space);
  return vxm_model_begin_on(out, model, &lattice, transform, confidence, error);
}

vxm_status vxm_model_begin_on(vxm_model_pass **out, vxm_model *model, const vxm_lattice *lattice,
                              const double transform[12], uint8_t *confidence, vxm_error *error) {
  *out = NULL;
  vxm_model_result *mine;
  vxm_status status = vxm_space_check_sizes(&lattice->space, error);
  if (status == VXM_OK)
    status = vxm_model_results_mine(&mine, model->results, error);
  if (status != VXM_OK)
    return status;
  mine->warnings.count = 0;
  vxm_model_pass *pass = take_idle(model);
  if (!pass)
    status = make_pass(&pass, model, error);
  if (status != VXM_OK)
    return status;
  pass->warnings = &mine->warnings;
  status = vxm_model_pass_place(pass, lattice, transform, confidence, error);
  if (status == VXM_OK)
    *out = pass;
  else
    vxm_model_close(model, pass);
  return status;
}
