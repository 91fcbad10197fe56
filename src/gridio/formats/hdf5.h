/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The module "hdf5": what the library asks of HDF5, as a table of functions. The file is made in memory, in
 * its compressed form, and written when it is complete. Files are read in a process of their own
 * (sandbox/reader_process.h), because HDF5 trusts them.
 */
#ifndef VXM_GRIDIO_FORMATS_HDF5_H
#define VXM_GRIDIO_FORMATS_HDF5_H

#include "base/module.h"
#include "base/output.h"
#include "sandbox/reader.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The array of a file, "voxels", and its attributes. */
typedef struct vxm_hdf5_array {
  vxm_space space;
  vxm_scalar scalar;
  int channels;     /**< 4 of colours: the last dimension; else 1, and there is none */
  const char *kind; /**< the attribute "kind" */
} vxm_hdf5_array;

/** A label, for the attributes "label_names" and "label_voxels". */
typedef struct vxm_hdf5_label {
  const char *name;
  int64_t voxels;
} vxm_hdf5_label;

/** What the key of a label's name begins with, before the count of its voxels, when it comes from the reader.
 */
#define VXM_HDF5_LABEL "label "

/** A file in the making. */
typedef struct vxm_hdf5 vxm_hdf5;

typedef struct vxm_hdf5_functions {
  /** Reads in a process of its own: texts "kind" and "axes", labels, and an array. */
  vxm_reader reader;
  /** @return VXM_OK; VXM_ERROR_MEMORY; VXM_ERROR_RANGE for what HDF5 refuses */
  vxm_status (*create)(vxm_hdf5 **out, vxm_context *context, const vxm_hdf5_array *array, vxm_error *error);
  /** Slices begin to end - 1 across x: z fastest, then y. */
  vxm_status (*put)(vxm_hdf5 *file, const void *values, int64_t begin, int64_t end, vxm_error *error);
  /** Adds the labels 1 to `count`. */
  vxm_status (*label)(vxm_hdf5 *file, const vxm_hdf5_label *labels, size_t count, vxm_error *error);
  vxm_status (*write)(vxm_hdf5 *file, vxm_output *output, vxm_error *error);
  void (*destroy)(vxm_hdf5 *file);
} vxm_hdf5_functions;

extern const vxm_module_need vxm_hdf5_need;

#ifdef __cplusplus
}
#endif
#endif
