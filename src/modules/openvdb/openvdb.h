/* SPDX-License-Identifier: BSD-3-Clause */
/** What the files of the OpenVDB module share. */
#ifndef VXM_MODULES_OPENVDB_OPENVDB_H
#define VXM_MODULES_OPENVDB_OPENVDB_H

#include <exception>
#include <new>

#include "gridio/formats/vdb/vdb.h"

/** A failure that is described already. */
struct vxm_vdb_failure {
  vxm_status status;
};

inline void vxm_vdb_check(vxm_status status) {
  if (status != VXM_OK)
    throw vxm_vdb_failure{status};
}

/** Makes a grid of a file, in a process of its own (vxm_reader). */
extern const vxm_reader vxm_vdb_reader;

#endif
