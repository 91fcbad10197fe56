/* SPDX-License-Identifier: BSD-3-Clause */
/** .h5 files in, through HDF5 in a process of its own. */
#ifndef VXM_GRIDIO_FORMATS_HDF5_READ_H
#define VXM_GRIDIO_FORMATS_HDF5_READ_H

#include "gridio/common/format.h"

bool vxm_hdf5_sniff(const vxm_input *input);
vxm_status vxm_hdf5_read(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error);
vxm_status vxm_hdf5_read_field(vxm_field **out, const vxm_input *input, vxm_error *error);

#endif
