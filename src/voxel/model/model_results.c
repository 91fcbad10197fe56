/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/model/model_results.h"

#include <pthread.h>

struct vxm_model_results {
  vxm_context *context;
  pthread_mutex_t mutex;
  vxm_model_result *first, *last; /**< of the list; and the one that was asked for last */
};

/** An address that no two living threads share. A new thread may have the address of one that has ended, so
 * that the list need not grow with every thread there ever was. */
static const void *this_thread(void) {
  static _Thread_local char place;
  return &place;
}

vxm_status vxm_model_results_create(vxm_model_results **out, vxm_context *context, vxm_error *error) {
  vxm_status status = VXM_OK;
  *out = vxm_try_calloc(context, 1, sizeof **out, &status, error);
  if (!*out)
    return status;
  (*out)->context = context;
  pthread_mutex_init(&(*out)->mutex, NULL);
  return VXM_OK;
}

void vxm_model_results_destroy(vxm_model_results *results) {
  if (!results)
    return;
  for (vxm_model_result *at = results->first, *next; at; at = next) {
    next = at->next;
    vxm_label_table_destroy(&at->labels);
    vxm_free(results->context, at);
  }
  pthread_mutex_destroy(&results->mutex);
  vxm_free(results->context, results);
}

static vxm_model_result *find(const vxm_model_results *results) {
  vxm_model_result *at = results->first;
  while (at && at->thread != this_thread())
    at = at->next;
  return at;
}

vxm_status vxm_model_results_mine(vxm_model_result **out, vxm_model_results *results, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  pthread_mutex_lock(&results->mutex);
  vxm_model_result *mine = find(results);
  if (!mine) {
    mine = vxm_calloc(results->context, 1, sizeof *mine, &local);
    if (mine) {
      mine->thread = this_thread();
      mine->labels.context = results->context;
      mine->next = results->first;
      results->first = mine;
    }
  }
  if (mine)
    results->last = mine;
  pthread_mutex_unlock(&results->mutex);
  if (!mine)
    vxm_error_pass(error, &local);
  *out = mine;
  return local.code;
}

const vxm_model_result *vxm_model_results_read(vxm_model_results *results) {
  pthread_mutex_lock(&results->mutex);
  const vxm_model_result *mine = find(results), *result = mine ? mine : results->last;
  pthread_mutex_unlock(&results->mutex);
  return result;
}
