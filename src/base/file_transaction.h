/* SPDX-License-Identifier: BSD-3-Clause */
/** Complete files that wait for others, to get their names together: all or none. */
#ifndef VXM_BASE_FILE_TRANSACTION_H
#define VXM_BASE_FILE_TRANSACTION_H

#include "base/atomic_file.h"
#include "base/atomic_folder.h"
#include "base/context.h"

#include <pthread.h>

/** A prepared file, or folder. */
typedef struct vxm_file_transaction_file {
  struct vxm_file_transaction_file *next;
  vxm_atomic_file file;
  vxm_atomic_folder *folder; /**< instead of the file; or NULL */
  char *path;                /**< for messages */
} vxm_file_transaction_file;

/** Of a context. */
typedef struct vxm_file_transaction {
  pthread_mutex_t mutex;
  bool holds;
  vxm_file_transaction_file *first;
} vxm_file_transaction;

/** NULL without memory, then the file is still the caller's. */
vxm_file_transaction_file *vxm_file_transaction_file_create(const vxm_atomic_file *file, const char *path);
/** The same for a folder, which is taken over. */
vxm_file_transaction_file *vxm_file_transaction_folder_create(const vxm_atomic_folder *folder,
                                                              const char *path);
/** Names all files of a list, or, after a failure, none. Frees the list. */
vxm_status vxm_file_transaction_publish(vxm_file_transaction_file *list, vxm_error *error);
void vxm_file_transaction_drop(vxm_file_transaction_file *list);
/**
 * Takes a list over if the context holds files, else names them.
 *
 * @return VXM_OK; VXM_ERROR_IO; VXM_ERROR_ARGUMENT if a file of that name is held already
 */
vxm_status vxm_file_transaction_take(vxm_context *context, vxm_file_transaction_file *list, vxm_error *error);

#endif
