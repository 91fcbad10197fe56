/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * What the process that reads foreign files gives up before it looks at one. A library that a file has taken
 * over may then compute, answer over the channel, and nothing else.
 */
#ifndef VXM_SANDBOX_CONFINE_H
#define VXM_SANDBOX_CONFINE_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

/* A sanitizer maps, opens and starts too much of its own: builds with one have limits, but neither the filter
 * nor Landlock. */
#if defined(__SANITIZE_ADDRESS__)
#define VXM_IS_SANITIZED 1
#else
#define VXM_IS_SANITIZED 0
#endif

typedef struct vxm_confinement {
  int channel;                 /**< the one descriptor that stays */
  uint64_t memory, memory_max; /**< bytes that may be held beyond what is held now: at first, and ever */
  uint64_t seconds;            /**< of computing, at first */
} vxm_confinement;

/** Before anything is loaded: no new rights, no descriptor but the standard ones, an end together with the
 * process `parent`. False if that has gone already. */
bool vxm_confine_early(pid_t parent);

/**
 * Before the file is looked at: no capabilities, no files, no sockets, no signals to others, no other
 * programs, no more memory and time than is given. Irrevocable.
 *
 * @return NULL, or what could not be given up although this build is made to
 */
const char *vxm_confine(const vxm_confinement *confinement);

#endif
