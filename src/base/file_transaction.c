/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/file_transaction.h"
#include "base/context_struct.h"

#include <stdlib.h>
#include <string.h>

/* ---- Lists ---- */

vxm_file_transaction_file *vxm_file_transaction_file_create(const vxm_atomic_file *file, const char *path) {
  vxm_file_transaction_file *held = malloc(sizeof *held);
  char *name = held ? strdup(path) : NULL;
  if (!name) {
    free(held);
    return NULL;
  }
  *held = (vxm_file_transaction_file){NULL, *file, NULL, name};
  return held;
}

vxm_file_transaction_file *vxm_file_transaction_folder_create(const vxm_atomic_folder *folder,
                                                              const char *path) {
  vxm_atomic_folder *taken = malloc(sizeof *taken);
  const vxm_atomic_file none = {.destination = {.folder = -1, .device = -1}, .descriptor = -1};
  vxm_file_transaction_file *held = taken ? vxm_file_transaction_file_create(&none, path) : NULL;
  if (!held) {
    free(taken);
    return NULL;
  }
  *taken = *folder;
  held->folder = taken;
  return held;
}

static void close_held(vxm_file_transaction_file *held) {
  if (held->folder)
    vxm_atomic_folder_close(held->folder);
  else
    vxm_atomic_file_close(&held->file);
  free(held->folder);
}

static vxm_status publish_held(vxm_file_transaction_file *held, bool keeps_old, vxm_error *error) {
  if (held->folder)
    return vxm_atomic_folder_publish(held->folder, held->path, error);
  return vxm_atomic_file_publish(&held->file, keeps_old) ? VXM_OK
                                                         : vxm_fail_errno(error, held->path, "cannot write");
}

static void revert_held(vxm_file_transaction_file *held) {
  if (held->folder)
    vxm_atomic_folder_revert(held->folder);
  else
    vxm_atomic_file_revert(&held->file);
}

static const vxm_output_path *spot_of(const vxm_file_transaction_file *held) {
  return held->folder ? &held->folder->destination : &held->file.destination;
}

void vxm_file_transaction_drop(vxm_file_transaction_file *list) {
  while (list) {
    vxm_file_transaction_file *next = list->next;
    close_held(list);
    free(list->path);
    free(list);
    list = next;
  }
}

vxm_status vxm_file_transaction_publish(vxm_file_transaction_file *list, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (vxm_file_transaction_file *held = list; held && status == VXM_OK; held = held->next)
    status = publish_held(held, held->next != NULL, error); /* the last one can only fail itself */
  for (vxm_file_transaction_file *held = list; held && status != VXM_OK; held = held->next)
    revert_held(held);
  vxm_file_transaction_drop(list);
  return status;
}

/* ---- Contexts ---- */

static bool is_same_spot(const vxm_output_path *a, const vxm_output_path *b) {
  struct stat first, second;
  return strcmp(a->name, b->name) == 0 && fstat(a->folder, &first) == 0 && fstat(b->folder, &second) == 0 &&
         first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

/** The place behind the last file; NULL if one of the list is there already. */
static vxm_file_transaction_file **find_end(vxm_file_transaction *held,
                                            const vxm_file_transaction_file *list) {
  vxm_file_transaction_file **at = &held->first;
  for (; *at; at = &(*at)->next)
    for (const vxm_file_transaction_file *other = list; other; other = other->next)
      if (is_same_spot(spot_of(*at), spot_of(other)))
        return NULL;
  return at;
}

vxm_status vxm_file_transaction_take(vxm_context *context, vxm_file_transaction_file *list,
                                     vxm_error *error) {
  vxm_file_transaction *held = context ? &context->account->held : NULL;
  bool holds = false;
  vxm_file_transaction_file **end = NULL;
  if (held) {
    pthread_mutex_lock(&held->mutex);
    holds = held->holds;
    end = holds ? find_end(held, list) : NULL;
    if (end)
      *end = list;
    pthread_mutex_unlock(&held->mutex);
  }
  if (!holds)
    return vxm_file_transaction_publish(list, error);
  if (end)
    return VXM_OK;
  vxm_fail(error, VXM_ERROR_ARGUMENT, "%s: two files are to be written under this name; choose another",
           list->path);
  vxm_file_transaction_drop(list);
  return VXM_ERROR_ARGUMENT;
}

/** Ends the holding, and hands the files to the caller. */
static vxm_file_transaction_file *take_all(vxm_context *context) {
  vxm_file_transaction *held = &context->account->held;
  pthread_mutex_lock(&held->mutex);
  vxm_file_transaction_file *list = held->first;
  held->first = NULL;
  held->holds = false;
  pthread_mutex_unlock(&held->mutex);
  return list;
}

vxm_status vxm_context_hold_files(vxm_context *context, vxm_error *error) {
  if (!context)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "context: files are held by a context, not by NULL");
  vxm_file_transaction *held = &context->account->held;
  pthread_mutex_lock(&held->mutex);
  held->holds = true;
  pthread_mutex_unlock(&held->mutex);
  return VXM_OK;
}

vxm_status vxm_context_publish_files(vxm_context *context, vxm_error *error) {
  return context ? vxm_file_transaction_publish(take_all(context), error) : VXM_OK;
}

void vxm_context_drop_files(vxm_context *context) {
  if (context)
    vxm_file_transaction_drop(take_all(context));
}
