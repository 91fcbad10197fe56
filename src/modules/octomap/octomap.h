/* SPDX-License-Identifier: BSD-3-Clause */
/** What the files of the OctoMap module share. */
#ifndef VXM_MODULES_OCTOMAP_OCTOMAP_H
#define VXM_MODULES_OCTOMAP_OCTOMAP_H

#include "gridio/formats/octomap.h"

/** Levels below the root: a leaf on the last is a voxel. */
enum { VXM_OCTOMAP_DEPTH = 16 };

/** Makes a grid of a file, in a process of its own (vxm_reader). */
extern const vxm_reader vxm_octomap_reader;

#endif
