/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Allocations that fail. Libraries do with them what they like: leave out what they were at, call the file
 * damaged, crash. Only what took place below them tells that it was for want of memory.
 */
#ifndef VXM_SANDBOX_ALLOC_FAILURE_H
#define VXM_SANDBOX_ALLOC_FAILURE_H

/** From now on the first allocation in this program that fails calls `end`, which does not return. Without
 * effect below a sanitizer, which has allocators of its own, and other C libraries than glibc. */
void vxm_alloc_failure_ends(void (*end)(void));

#endif
