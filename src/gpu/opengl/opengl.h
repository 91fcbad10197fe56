/* SPDX-License-Identifier: BSD-3-Clause */
/** An engine on a context of OpenGL: its programs and buffers, kept from one grid to the next. */
#ifndef VXM_GPU_OPENGL_OPENGL_H
#define VXM_GPU_OPENGL_OPENGL_H

#include "gpu/common/device_cache.h"
#include "gpu/opengl/gl_context.h"
#include "voxel/engine/engine.h"

typedef enum vxm_gl_program_id {
  VXM_GL_FIND_COLUMNS = 0,
  VXM_GL_DRAW_COLUMNS,
  VXM_GL_FLIP,
  VXM_GL_FOLD_ROWS,
  VXM_GL_FOLD_ACROSS,
  VXM_GL_VOTE,
  VXM_GL_TOUCH,
  VXM_GL_DRAW_SLICES,
  VXM_GL_DRAW_TETRA,
  VXM_GL_PACK,
  VXM_GL_MERGE,
  VXM_GL_FIND_SURFACE,
  VXM_GL_DRAW_SURFACE,
  VXM_GL_MOVE,
  VXM_GL_DEVICE_VOXELS,
  VXM_GL_PROGRAMS
} vxm_gl_program_id;

typedef enum vxm_gl_buffer_id {
  VXM_GL_POINTS = VXM_CACHED_POINTS,
  VXM_GL_CORNERS = VXM_CACHED_CORNERS,
  VXM_GL_APEXES = VXM_CACHED_APEXES,
  VXM_GL_ORDER = VXM_CACHED_ORDER,
  VXM_GL_BOXES = VXM_CACHED_BOXES,
  VXM_GL_SURFACE_POINTS = VXM_CACHED_SURFACE_POINTS,
  VXM_GL_SURFACE_CORNERS = VXM_CACHED_SURFACE_CORNERS,
  VXM_GL_ORIGINALS = VXM_CACHED_ORIGINALS,
  VXM_GL_ENTRIES = VXM_CACHED_ENTRIES,
  VXM_GL_NOISE = VXM_CACHED_NOISE,
  VXM_GL_FLIPS = VXM_CACHED_COUNT, /**< a bit per voxel of a slab; zero between uses */
  VXM_GL_LARGE,                    /**< the indirect draw, and its triangles */
  VXM_GL_JOB,                      /**< vxm_gl_job */
  VXM_GL_RESULT,                   /**< what is inside, a bit per voxel of a slab */
  VXM_GL_VOTER_X,                  /**< four of them */
  VXM_GL_VOTER_T = VXM_GL_VOTER_X + 3,
  VXM_GL_TALLY,
  VXM_GL_RANDOM, /**< the circular buffer of displacements of slices */
  VXM_GL_TOUCHED,
  VXM_GL_STAYING, /**< the bits of a window that stays */
  VXM_GL_STAGING, /**< two, mapped while the next slab is drawn */
  VXM_GL_STAGING2,
  VXM_GL_BUFFERS
} vxm_gl_buffer_id;

typedef struct vxm_gl_buffer {
  GLuint name;
  size_t bytes; /**< counted against the memory limit */
} vxm_gl_buffer;

/** The uniform block of shaders/job.glsl. */
typedef struct vxm_gl_job {
  vxm_slab_columns columns;
  int32_t view[4];
} vxm_gl_job;

/** A format of presence buffers, and how fragments are written into them. */
typedef struct vxm_gl_format {
  const char *name, *defines;
  GLenum internal, read;
  size_t bytes; /**< of a voxel */
  bool is_image;
} vxm_gl_format;

/** Slices as layers of a texture, drawn into with XOR. */
typedef struct vxm_gl_presence {
  GLuint texture, framebuffer;
  int64_t size[3];
  size_t bytes; /**< counted against the memory limit */
} vxm_gl_presence;

typedef struct vxm_opengl {
  vxm_engine base; /**< first, so that an engine is one */
  vxm_engine_options options;
  vxm_gl_context context;
  GLuint vertex_array, framebuffer;
  GLuint programs[VXM_GL_PROGRAMS];
  vxm_gl_buffer buffers[VXM_GL_BUFFERS];
  const vxm_gl_format *format; /**< that passed the self-test */
  vxm_gl_presence presence;
  vxm_device_cache device_cache;
  /** Vertex and geometry shaders may read buffers; else compute shaders do all triangles, and slices are
   * refused. */
  bool can_pull, can_pull_late;
} vxm_opengl;

static inline vxm_opengl *vxm_opengl_of(vxm_engine *engine) {
  return (vxm_opengl *)engine;
}

/** Makes an engine on a new context; the reference to `context` is the caller's. @return VXM_OK,
 * VXM_ERROR_UNAVAILABLE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_opengl_create(vxm_engine **out, vxm_context *context, const vxm_gl_driver *driver, int index,
                             const vxm_engine_options *options, vxm_error *error);
/** "opengl:osmesa", "opengl:egl-device0" */
void vxm_opengl_name(char *out, size_t size, const vxm_gl_driver *driver, int index);

/* ---- Programs (gl_program.c) ---- */

/**
 * Compiles and links a program.
 *
 * @param stages  one string per stage: the names of its files in shaders/, the last of which tells the stage
 * @param defines lines put before each stage
 * @return VXM_OK; VXM_ERROR_UNAVAILABLE with the first lines of the driver's log
 */
vxm_status vxm_gl_program(GLuint *out, const vxm_gl *gl, const char *const stages[], const char *defines,
                          vxm_error *error);
/** As vxm_gl_program, with the caller's text in place of a file called "|". */
vxm_status vxm_gl_program_with(GLuint *out, const vxm_gl *gl, const char *const stages[], const char *defines,
                               const char *text, vxm_error *error);
/** A program of the engine, made when it is first asked for, and taken into use. */
vxm_status vxm_gl_use(vxm_opengl *engine, vxm_gl_program_id id, vxm_error *error);
/** Runs the program in use for at least `count` invocations, 64 or one group of 64 (`groups`) for each. */
void vxm_gl_dispatch(const vxm_gl *gl, uint64_t count, bool groups);

/* ---- Buffers (gl_buffer.c) ---- */

/** Room for so many bytes; what was in it is lost if it grows. @return VXM_OK, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_gl_reserve(vxm_opengl *engine, vxm_gl_buffer_id id, size_t bytes, vxm_error *error);
/** As vxm_gl_reserve, of VXM_GL_FLIPS, with all bytes zero if it grows. */
vxm_status vxm_gl_reserve_flips(vxm_opengl *engine, size_t bytes, vxm_error *error);
/** Frees a buffer. */
void vxm_gl_release(vxm_opengl *engine, vxm_gl_buffer_id id);
/** Room, and these bytes in it. */
vxm_status vxm_gl_upload(vxm_opengl *engine, vxm_gl_buffer_id id, const void *data, size_t bytes,
                         vxm_error *error);
/** Bytes in a buffer of their own (`data` or, where that is NULL, what BufferSubData then puts into
 * GL_COPY_READ_BUFFER), and their copy into a buffer of the engine. The copy keeps its place among what is
 * drawn. BufferSubData into the engine's buffer does not with NVIDIA's driver (580): it can overtake draws
 * whose shaders, or whose indirect parameters, still read the buffer, whatever barriers stand between. */
GLuint vxm_gl_send_begin(const vxm_gl *gl, const void *data, size_t bytes);
void vxm_gl_send_end(vxm_opengl *engine, GLuint sent, vxm_gl_buffer_id id, size_t offset, size_t bytes);
/** How buffers of the engine's device cache are filled and freed. */
vxm_status vxm_gl_device_cache_upload(vxm_engine *engine, vxm_device_cache_id id, size_t offset,
                                      const void *data, size_t bytes, vxm_error *error);
void vxm_gl_device_cache_release(vxm_engine *engine, vxm_device_cache_id id);
/** Binds a buffer to where shaders look for it. */
void vxm_gl_bind(vxm_opengl *engine, GLuint binding, vxm_gl_buffer_id id);
/** Reads the first bytes of a buffer, once all is done that writes them. */
vxm_status vxm_gl_download(vxm_opengl *engine, vxm_gl_buffer_id id, void *out, size_t bytes,
                           vxm_error *error);

void vxm_gl_presence_release(vxm_opengl *engine);

/* ---- Slabs (gl_slabs.c) ---- */

/** How many slices of a window fit a slab. @return VXM_OK; VXM_ERROR_RANGE if not even one does */
vxm_status vxm_gl_slab_slices(int64_t *out, const vxm_opengl *engine, const vxm_window *window,
                              vxm_error *error);
/** Puts the words of a slab into a buffer. */
vxm_status vxm_gl_slab_upload(vxm_opengl *engine, vxm_gl_buffer_id id, const vxm_slab *slab,
                              vxm_error *error);

/** A slab on its way back. Start from {0}. */
typedef struct vxm_gl_return {
  vxm_slab slab;
  bool is_or;   /**< added to the window's words */
  GLsync fence; /**< NULL: none is under way */
  int staging;  /**< 0 or 1 */
} vxm_gl_return;

/** Begins to take back a slab that lies in VXM_GL_RESULT. */
vxm_status vxm_gl_return_begin(vxm_opengl *engine, vxm_gl_return *back, vxm_error *error);
/** Waits for it and moves it into the window. Does nothing if none is under way. */
vxm_status vxm_gl_return_end(vxm_opengl *engine, vxm_gl_return *back, vxm_error *error);

/* ---- Methods ---- */

/** Notes which parts of a pass have bits in VXM_GL_FLIPS. */
vxm_status vxm_gl_touch(vxm_opengl *engine, const vxm_slab *slab, const vxm_disjoint_passes *passes,
                        size_t pass, vxm_error *error);

/** Parity of the job's parts along its axis, united, into VXM_GL_RESULT or a voter's buffer (gl_columns.c).
 * The passes are those of the job, and on the device. */
vxm_status vxm_gl_columns(vxm_opengl *engine, const vxm_slab *slab, const vxm_parity_union_job *job,
                          const vxm_disjoint_passes *passes, vxm_gl_buffer_id into, vxm_error *error);

/** Whether the job's triangles close all of its parts, as tetrahedra need. */
bool vxm_gl_can_slice(const vxm_parity_union_job *job);
/** The XOR of tetrahedra for such a job (gl_slices.c). The apexes have been placed. */
vxm_status vxm_gl_slices(vxm_opengl *engine, const vxm_slab *slab, const vxm_parity_union_job *job,
                         const vxm_disjoint_passes *passes, vxm_gl_buffer_id into, vxm_error *error);

#endif
