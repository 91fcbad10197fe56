/* SPDX-License-Identifier: BSD-3-Clause */
/** Reports that point to the report of the voxelization behind them: of coverage, distances and labels. */
#ifndef VXM_API_API_RESULTS_H
#define VXM_API_API_RESULTS_H

#include "base/sized.h"
#include "voxmend/field.h"

#include <string.h>

/** What is made, and where it goes; pointers of the caller stay. */
#define VXM_RESULTS(type)         \
  struct {                        \
    type *report;                 \
    vxm_voxelize_report *to;      \
    type made;                    \
    vxm_voxelize_report voxelize; \
  }

/** Clears what the caller hands in, which may be NULL, and makes `results->made` ready to be filled. */
#define VXM_RESULTS_BEGIN(results, given)                                                    \
  do {                                                                                       \
    memset((results), 0, sizeof *(results));                                                 \
    (results)->report = (given);                                                             \
    (results)->to = (given) && VXM_RESULT_HAS((given), voxelize) ? (given)->voxelize : NULL; \
    (results)->made.voxelize = (results)->to;                                                \
    VXM_RESULT_WRITE((results)->report, &(results)->made);                                   \
    VXM_RESULT_CLEAR((results)->to);                                                         \
    (results)->made.voxelize = &(results)->voxelize;                                         \
  } while (0)

/** Hands over what was made, after a success only. */
#define VXM_RESULTS_END(results, status)                     \
  do {                                                       \
    if ((status) == VXM_OK) {                                \
      (results)->made.voxelize = (results)->to;              \
      VXM_RESULT_WRITE((results)->report, &(results)->made); \
      VXM_RESULT_WRITE((results)->to, &(results)->voxelize); \
    }                                                        \
  } while (0)

#endif
