/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Inputs that are not those that a batch began with. What was made has to stay that of its inputs, so it goes
 * on only where no output is of a file that is no longer there: with the same bytes in files of another time,
 * and with changed files whose turn comes anyway.
 */
#ifndef VXM_BATCH_CHANGES_H
#define VXM_BATCH_CHANGES_H

#include "batch/supervisor.h"

/**
 * Finds out what has changed against the plan, and renews that where the batch may go on. Only the files that
 * have another time are read.
 *
 * @param manifest its items have no status, before and after
 * @return false with what has changed and what helps, where it may not
 */
bool batch_changes_take(batch_manifest *manifest, const batch_settings *settings, batch_error *error);
/** Refuses, where files have changed that were read beside meshes that are not to be done, with what helps.
 */
bool batch_changes_beside(const batch_manifest *manifest, const batch_settings *settings, batch_error *error);

#endif
