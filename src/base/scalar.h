/* SPDX-License-Identifier: BSD-3-Clause */
/** The sizes of the types of numbers. */
#ifndef VXM_BASE_SCALAR_H
#define VXM_BASE_SCALAR_H

#include "voxmend/base.h"

/** Bytes of a value. */
static inline size_t vxm_scalar_bytes(vxm_scalar scalar) {
  switch (scalar) {
  case VXM_UINT8:
  case VXM_INT8:
    return 1;
  case VXM_FLOAT16:
  case VXM_UINT16:
  case VXM_INT16:
    return 2;
  case VXM_FLOAT32:
  case VXM_UINT32:
  case VXM_INT32:
    return 4;
  default:
    return 8;
  }
}

#endif
