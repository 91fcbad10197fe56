/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * What DLPack (https://dmlc.github.io/dlpack) passes between libraries: the binary interface of its versions
 * 0.2 to 0.8, which later ones keep under the same name, in own words. Only what is used here has a name.
 */
#ifndef VXM_BASE_DLPACK_H
#define VXM_BASE_DLPACK_H

#include <stdint.h>

enum { VXM_DLPACK_OPENCL = 4 /**< the kind of device */ };
enum { VXM_DLPACK_UINT = 1, VXM_DLPACK_FLOAT = 2 /**< kinds of elements */ };

typedef struct vxm_dlpack_tensor {
  void *data;
  int32_t device_kind, device_number;
  int32_t dims;
  uint8_t element_kind, element_bits;
  uint16_t lanes; /**< 1: elements are no vectors */
  int64_t *shape;
  int64_t *strides; /**< in elements; NULL = compact, the last axis fastest */
  uint64_t byte_offset;
} vxm_dlpack_tensor;

struct DLManagedTensor {
  vxm_dlpack_tensor tensor;
  void *owner; /**< of who made it */
  void (*deleter)(struct DLManagedTensor *self);
};

#endif
