/* SPDX-License-Identifier: BSD-3-Clause */
/** The solid by OpenGL; see vxm_engine_ops. */
#ifndef VXM_GPU_GL_SOLID_H
#define VXM_GPU_GL_SOLID_H

#include "gpu/opengl.h"

vxm_status vxm_gl_unite(vxm_engine *engine, const vxm_window *window, const vxm_unite_job *job,
                        vxm_error *error);
vxm_status vxm_gl_elect(vxm_engine *engine, const vxm_window *window, const vxm_elect_job *job,
                        vxm_tally *tally, vxm_error *error);

#endif
