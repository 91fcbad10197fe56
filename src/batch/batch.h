/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Many meshes, each in a process of its own. This folder belongs to the program: it knows processes, journals
 * and folders, and nothing of options; what a piece of work is its caller says (cli/batch_job.c).
 */
#ifndef VXM_BATCH_BATCH_H
#define VXM_BATCH_BATCH_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#define BATCH_PRINTF(text, first) __attribute__((format(printf, text, first)))

/** What became of a mesh. The names are in journals: they are added to, never changed. */
typedef enum batch_status {
  BATCH_PENDING = 0,
  BATCH_OK,
  BATCH_DEGRADED,   /**< done, with warnings */
  BATCH_DUPLICATE,  /**< has the bytes of one that is done: its outputs are the other's */
  BATCH_UNREADABLE, /**< the mesh could not be read */
  BATCH_FAILED,     /**< it could be read, and something else was refused */
  BATCH_TIMEOUT,
  BATCH_OOM,
  BATCH_CRASH,
  BATCH_QUARANTINED, /**< the machine, or this program, went down with it again and again */
  BATCH_STATUSES
} batch_status;

extern const char *const batch_status_names[BATCH_STATUSES + 1];

/** BATCH_STATUSES if there is none of that name. */
batch_status batch_status_of(const char *name);
static inline bool batch_is_done(batch_status status) {
  return status == BATCH_OK || status == BATCH_DEGRADED || status == BATCH_DUPLICATE;
}

/** One line for the user; the callers' own. */
typedef struct batch_error {
  char text[1024];
} batch_error;

/** Fills the error and returns false. */
bool batch_fail(batch_error *error, const char *format, ...) BATCH_PRINTF(2, 3);
/** The same, with what the system says of errno behind it. */
bool batch_fail_errno(batch_error *error, const char *format, ...) BATCH_PRINTF(2, 3);

/** Milliseconds since an arbitrary start. */
double batch_clock_ms(void);
/** Writes all of a text; false with errno. */
bool batch_write_all(int descriptor, const char *text, size_t size);

/** A text of an object, or NULL. */
const char *batch_json_text(const json_t *object, const char *key);
/** Any bytes as JSON text: what is not UTF-8 is replaced. */
json_t *batch_json_string(const char *text);

#endif
