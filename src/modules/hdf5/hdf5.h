/* SPDX-License-Identifier: BSD-3-Clause */
/** What the files of the HDF5 module share. */
#ifndef VXM_MODULES_HDF5_HDF5_H
#define VXM_MODULES_HDF5_HDF5_H

#include <hdf5.h>

#include "gridio/formats/hdf5.h"

/** Make an array of a file, in a process of its own (vxm_reader). */
void vxm_hdf5_prepare(void);
vxm_status vxm_hdf5_read_array(vxm_voxel_sink *sink, vxm_context *context, const vxm_reader_request *request,
                               vxm_error *error);

/** Opens the file that these bytes are, which is the only one of the process. */
hid_t vxm_hdf5_open_image(const unsigned char *data, size_t size);

/** A dataset that was found in a file. */
typedef struct vxm_hdf5_set {
  hid_t set, type, read_as; /**< its numbers as they are in the file, and in memory; -1 = not open */
  int rank;
  hsize_t dims[4];
  vxm_scalar scalar; /**< what they are in memory */
} vxm_hdf5_set;

/** Datasets that can be read, or else all, as far as a message has room. */
typedef struct vxm_hdf5_survey {
  unsigned sets, fitting;
  bool has_own;   /**< one is called "voxels" as ours are */
  char name[512]; /**< of that, or of the first that fits */
  char fit[400], all[400];
} vxm_hdf5_survey;

/** Looks through a file. Links to other files are not followed. False if it cannot be walked through. */
bool vxm_hdf5_look(vxm_hdf5_survey *out, hid_t file);
/** Opens a dataset that fits; false if it does not, with nothing open. */
bool vxm_hdf5_open(vxm_hdf5_set *out, hid_t file, const char *name);
void vxm_hdf5_close(vxm_hdf5_set *set);

#endif
