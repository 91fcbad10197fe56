/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file voxmend/base.h
 * What all of voxmend has in common: status and errors, contexts, files.
 *
 * voxmend repairs messy meshes and turns them into voxel grids. Conventions (doc/conventions.md has them in
 * full):
 *  - Every fallible call returns a vxm_status, 0 for success, and describes a failure in one line in the
 *    caller's vxm_error, which may be NULL. After a failure nothing is created and output arguments are
 *    NULL or 0.
 *  - `out` arguments come first, options next, the error last. A NULL options pointer means defaults; to set
 *    some options start from the matching VXM_..._INIT.
 *  - Sizes. Structs begin with their size, as the program that uses them was compiled, so that later versions
 *    can add fields at their ends. Options that are shorter than the library's have the defaults for what
 *    they lack; of longer ones the rest has to be 0, as the library does not know what it asks for. Of
 *    results (errors, reports) the library writes no more than their size says, and leaves what it does not
 *    know as it is. A result whose size is 0, such as `vxm_census census = {0}`, is taken for one of version
 *    1.0; options have to be initialized. What getters and callbacks hand out begins with its size too. Two
 *    values have none, as they do not grow: vxm_space and vxm_variant.
 *  - What a call creates belongs to the caller and has a destroy function that accepts NULL. What a getter
 *    returns belongs to its object and lives as long as it.
 *  - NULL is defined everywhere. A call that can fail returns VXM_ERROR_ARGUMENT for it where it is not said
 *    to be allowed; any other gives 0, false, NULL or "" for it, or does nothing. So does an index, an enum
 *    or a count that is out of range. What cannot be seen is that an array is shorter than it is said to be.
 *  - Callbacks have to return. Between a callback and the call that it serves there are frames of C that hold
 *    memory, files and threads: a C++ exception that leaves a callback, or a longjmp out of it, is undefined
 *    behaviour. Catch it, keep it (std::current_exception), ask to stop, and throw it again once the call is
 *    back. A callback may use other objects, but not those that the call works on.
 *  - Distinct objects may be used from distinct threads at the same time, also when they share a context.
 *    One object may be read by many threads at once, and one model voxelized by many.
 *  - The same input gives the same bits whatever the number of threads.
 */
#ifndef VOXMEND_BASE_H
#define VOXMEND_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
/** Marks what the library exports. */
#define VXM_API __attribute__((visibility("default")))
#else
/** Marks what the library exports. */
#define VXM_API
#endif

#define VXM_VERSION_MAJOR 1 /**< of these headers */
#define VXM_VERSION_MINOR 0 /**< of these headers */
#define VXM_VERSION_PATCH 0 /**< of these headers */

/** Version of the library that runs, "MAJOR.MINOR.PATCH". */
VXM_API const char *vxm_version(void);

/* ---- Status and errors ---- */

/** What a call came to, and what its caller can do next. */
typedef enum vxm_status {
  VXM_OK = 0,         /**< done */
  VXM_ERROR_ARGUMENT, /**< an argument is out of its range: mend the call */
  VXM_ERROR_IO, /**< the system refused to open, read, write or rename: check path, permissions and space */
  VXM_ERROR_FORMAT, /**< the content is not a known format or is damaged beyond reading: mend the file */
  VXM_ERROR_EMPTY,  /**< there is nothing to work on (no face): check the input */
  VXM_ERROR_MEMORY, /**< the system has no memory left: free some, or lower the resolution */
  VXM_ERROR_MEMORY_LIMIT, /**< the context's limit would be exceeded: raise it, or lower the resolution */
  VXM_ERROR_RANGE, /**< a size or coordinate is beyond what can be computed: scale down or choose another grid
                    */
  VXM_ERROR_UNAVAILABLE, /**< this build or machine lacks an optional library: install it, or do without */
  VXM_ERROR_CANCELLED,   /**< the progress callback asked to stop: nothing was made */
  VXM_ERROR_UNREACHED, /**< a repair did not come as far as it was asked to: ask for less, or take what there
                        * is */
  VXM_ERROR_NUMBERS    /**< the file holds numbers, not set and clear voxels: vxm_field_read takes them */
} vxm_status;

/** Short fixed name of a status, such as "format". */
VXM_API const char *vxm_status_name(vxm_status status);

/** The one line that describes a failure; owned by the caller, written only by a call that fails. */
typedef struct vxm_error {
  size_t size;     /**< as the initializer sets it, or 0 */
  vxm_status code; /**< what the call returned */
  int64_t line;    /**< 1-based line in a text file, 0 if none applies */
  int64_t offset;  /**< byte offset in a binary file, -1 if none applies */
  int64_t element; /**< 0-based vertex, face or record, -1 if none applies */
  char file[256];  /**< file concerned, "" if none, shortened at the front if long */
  char text[512];  /**< the whole message, file and line included, without a line end */
  int system;      /**< errno of what the system refused, with VXM_ERROR_IO; 0 if none applies */
} vxm_error;

/** Initial value of vxm_error. */
#define VXM_ERROR_INIT \
  { sizeof(vxm_error), VXM_OK, 0, -1, -1, "", "", 0 }

/* ---- Types of numbers ---- */

/** Types of numbers. Those from VXM_FLOAT16 on occur only in fields (vxm_field). */
typedef enum vxm_scalar {
  VXM_FLOAT64 = 0,
  VXM_FLOAT32 = 1,
  VXM_UINT8 = 2,
  VXM_FLOAT16,
  VXM_INT8,
  VXM_UINT16,
  VXM_INT16,
  VXM_UINT32,
  VXM_INT32,
  VXM_UINT64,
  VXM_INT64
} vxm_scalar;

/** Name of a type as numpy has it, such as "float32", or "" for none. */
VXM_API const char *vxm_scalar_name(vxm_scalar scalar);

/* ---- Context: threads, memory limit, progress ---- */

/**
 * Called now and then from the thread that made the call; by several at once, where several make calls. It
 * has to return: see "Callbacks" above.
 *
 * @param phase     what is being done, such as "reading"
 * @param fraction  0 to 1 within the phase
 * @return 0 to go on; anything else cancels the call, which then returns VXM_ERROR_CANCELLED
 */
typedef int (*vxm_progress_fn)(const char *phase, double fraction, void *payload);

/** How a context works. */
typedef struct vxm_context_options {
  size_t size;           /**< as the initializer sets it */
  int threads;           /**< 0 = one per processor available */
  uint64_t memory_limit; /**< bytes of all objects and scratch of the context together; 0 = what the machine,
                            or its container, has */
  vxm_progress_fn progress; /**< NULL = none */
  void *payload;            /**< handed to progress */
} vxm_context_options;

/** Initial value of vxm_context_options. */
#define VXM_CONTEXT_OPTIONS_INIT \
  { sizeof(vxm_context_options), 0, 0, NULL, NULL }

/** Worker threads, a memory budget and a progress callback shared by the objects made in it. */
typedef struct vxm_context vxm_context;

/**
 * Makes a context. It lives until it is destroyed and the last object made in it is destroyed too.
 * Wherever a function takes a context, NULL stands for a new one with default options.
 *
 * @return VXM_OK, VXM_ERROR_ARGUMENT, VXM_ERROR_MEMORY
 */
VXM_API vxm_status vxm_context_create(vxm_context **out, const vxm_context_options *options,
                                      vxm_error *error);
/** Drops it; NULL is allowed. */
VXM_API void vxm_context_destroy(vxm_context *context);
/** Number of threads that calls in this context use. */
VXM_API int vxm_context_threads(const vxm_context *context);
/** Largest number of bytes held at once by the context so far. */
VXM_API uint64_t vxm_context_peak_bytes(const vxm_context *context);

/* ---- Files ---- */

/*
 * A file that is written appears under its name when it is complete, and replaces what was there. Until then
 * it has no name where the file system can do that (O_TMPFILE), and only its user can read it. A new file has
 * the permissions that the umask or its folder's default ACL gives; one that replaces a file of the same
 * owner keeps that one's, but never setuid, setgid and sticky bits. Links are followed, but no other user's
 * in a folder that everybody may write to. What goes to "-" (standard output), a pipe or a device is written
 * as it comes.
 */

/**
 * From now on files that are written with this context, or with objects made in it, wait when they are
 * complete, until vxm_context_publish_files names all of them. A second one of the same name is refused.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT if the context is NULL
 */
VXM_API vxm_status vxm_context_hold_files(vxm_context *context, vxm_error *error);
/**
 * Names the files that wait, and ends the waiting. They appear in the order in which they were written.
 *
 * @return VXM_OK; VXM_ERROR_IO: none appears, and those that were replaced are back (a file system without
 *         renameat2 cannot give these back: then the new ones stay)
 */
VXM_API vxm_status vxm_context_publish_files(vxm_context *context, vxm_error *error);
/** Drops the files that wait, and ends the waiting; so does destroying the context. */
VXM_API void vxm_context_drop_files(vxm_context *context);
/**
 * Writes a file as this library writes its own.
 *
 * @param context may be NULL
 * @return VXM_OK; VXM_ERROR_ARGUMENT, VXM_ERROR_IO, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_file_write(vxm_context *context, const char *path, const void *data, size_t size,
                                  vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
