/* SPDX-License-Identifier: BSD-3-Clause */
/** The solid by OpenGL; see vxm_engine_ops. */
#ifndef VXM_GPU_OPENGL_GL_SOLID_H
#define VXM_GPU_OPENGL_GL_SOLID_H

#include "gpu/common/slab_solid.h"
#include "gpu/opengl/opengl.h"

vxm_status vxm_gl_move(vxm_engine *engine, vxm_snapped_points *placed, const vxm_move_job *job, bool *done,
                       vxm_error *error);
vxm_status vxm_gl_unite(vxm_engine *engine, const vxm_window *window, const vxm_parity_union_job *job,
                        vxm_error *error);
vxm_status vxm_gl_vote(vxm_engine *engine, const vxm_window *window, const vxm_vote_job *job,
                       vxm_vote_tally *tally, vxm_error *error);

/** As vxm_surface_add (gl_surface.c). */
vxm_status vxm_gl_surface(vxm_engine *engine, const vxm_surface *surface, const vxm_window *window,
                          vxm_surface_kind kind, bool is_fresh, vxm_error *error);

/** See vxm_engine_ops (gl_color.c). */
vxm_status vxm_gl_color(vxm_engine *engine, uint8_t *values, const vxm_color_job *job, vxm_error *error);

/** See vxm_engine_ops (gl_device_voxels.c). */
vxm_status vxm_gl_device_voxels(vxm_engine *engine, vxm_device_voxels **out, const vxm_device_info *shape,
                                vxm_error *error);
vxm_status vxm_gl_device_voxels_begin(vxm_engine *engine, const vxm_window *window, vxm_error *error);
vxm_status vxm_gl_device_voxels_end(vxm_engine *engine, vxm_device_voxels *voxels, int64_t index,
                                    const vxm_window *window, vxm_error *error);
/** Puts what is in VXM_GL_RESULT where it belongs in a window that stays. */
vxm_status vxm_gl_slab_stay(vxm_opengl *engine, const vxm_slab *slab, vxm_error *error);
/** The other way. */
vxm_status vxm_gl_slab_bring(vxm_opengl *engine, const vxm_slab *slab, vxm_error *error);

/** See vxm_slab_solid. */
vxm_status vxm_gl_each_slab(vxm_engine *engine, const vxm_window *window, bool is_or, vxm_slab_fn make,
                            void *payload, vxm_error *error);

#endif
