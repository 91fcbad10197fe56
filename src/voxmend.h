/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file voxmend.h
 * voxmend: repairs messy meshes and turns them into voxel grids. All of the public interface that stays as it
 * is; voxmend/base.h has the conventions.
 */
#ifndef VOXMEND_H
#define VOXMEND_H

#include "voxmend/base.h"
#include "voxmend/carve.h"
#include "voxmend/engine.h"
#include "voxmend/field.h"
#include "voxmend/grid.h"
#include "voxmend/mesh.h"
#include "voxmend/repair.h"
#include "voxmend/sampler.h"
#include "voxmend/sparse.h"
#include "voxmend/voxelize.h"

#endif
