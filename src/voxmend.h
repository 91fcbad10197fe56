/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * voxmend: repairs messy meshes and turns them into voxel grids.
 *
 * Conventions (doc/conventions.md has them in full):
 *  - Every fallible call returns a vxm_status, 0 for success, and describes a failure in one line in the
 *    caller's vxm_error, which may be NULL. After a failure nothing is created and output arguments are
 *    NULL or 0.
 *  - `out` arguments come first, options next, the error last. A NULL options pointer means defaults; to set
 *    some options start from the matching VXM_..._INIT.
 *  - What a call creates belongs to the caller and has a destroy function that accepts NULL. What a getter
 *    returns belongs to its object and lives as long as it.
 *  - NULL is defined everywhere. A call that can fail returns VXM_ERROR_ARGUMENT for it where it is not said
 *    to be allowed; any other gives 0, false, NULL or "" for it, or does nothing. So does an index, an enum
 *    or a count that is out of range. What cannot be seen is that an array is shorter than it is said to be.
 *  - Distinct objects may be used from distinct threads at the same time, also when they share a context.
 *    One object may be read by many threads at once, and one model voxelized by many.
 *  - The same input gives the same bits whatever the number of threads.
 */
#ifndef VOXMEND_H
#define VOXMEND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define VXM_API __attribute__((visibility("default")))
#else
#define VXM_API
#endif

#define VXM_VERSION_MAJOR 0
#define VXM_VERSION_MINOR 1
#define VXM_VERSION_PATCH 0

/** Version of the library that runs, "MAJOR.MINOR.PATCH". */
VXM_API const char *vxm_version(void);

/* ---- Status and errors ---- */

/** What a call came to, and what its caller can do next. */
typedef enum vxm_status {
  VXM_OK = 0,         /**< done */
  VXM_ERROR_ARGUMENT, /**< an argument is out of its range: mend the call */
  VXM_ERROR_IO,       /**< the system refused to open, read, write or rename: check path, rights and space */
  VXM_ERROR_FORMAT,   /**< the content is not a known format or is damaged beyond reading: mend the file */
  VXM_ERROR_EMPTY,    /**< there is nothing to work on (no face): check the input */
  VXM_ERROR_MEMORY,   /**< the system has no memory left: free some, or lower the resolution */
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
  vxm_status code;
  int64_t line;    /**< 1-based line in a text file, 0 if none applies */
  int64_t offset;  /**< byte offset in a binary file, -1 if none applies */
  int64_t element; /**< 0-based vertex, face or record, -1 if none applies */
  char file[256];  /**< file concerned, "" if none, shortened at the front if long */
  char text[512];  /**< the whole message, file and line included, without a line end */
  int system;      /**< errno of what the system refused, with VXM_ERROR_IO; 0 if none applies */
} vxm_error;

#define VXM_ERROR_INIT \
  { VXM_OK, 0, -1, -1, "", "", 0 }

/* ---- Context: threads, memory limit, progress ---- */

/**
 * Called now and then from the thread that made the call; by several at once, where several make calls.
 *
 * @param phase     what is being done, such as "reading"
 * @param fraction  0 to 1 within the phase
 * @return 0 to go on; anything else cancels the call, which then returns VXM_ERROR_CANCELLED
 */
typedef int (*vxm_progress_fn)(const char *phase, double fraction, void *payload);

typedef struct vxm_context_options {
  uint32_t version;         /**< 1 */
  int threads;              /**< 0 = one per processor available */
  uint64_t memory_limit;    /**< bytes of all objects and scratch of the context together; 0 = no limit */
  vxm_progress_fn progress; /**< NULL = none */
  void *payload;            /**< handed to progress */
} vxm_context_options;

#define VXM_CONTEXT_OPTIONS_INIT \
  { 1, 0, 0, NULL, NULL }

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
VXM_API void vxm_context_destroy(vxm_context *context);
/** Number of threads that calls in this context use. */
VXM_API int vxm_context_threads(const vxm_context *context);
/** Largest number of bytes held at once by the context so far. */
VXM_API uint64_t vxm_context_peak_bytes(const vxm_context *context);

/* ---- Files ---- */

/*
 * A file that is written appears under its name when it is complete, and replaces what was there. Until then
 * it has no name where the file system can do that (O_TMPFILE), and only its user can read it. A new file has
 * the rights that the umask or its folder's default list gives; one that replaces a file of the same owner
 * keeps that one's, but never setuid, setgid and sticky bits. Links are followed, but no other user's in a
 * folder that everybody may write to. What goes to "-" (standard output), a pipe or a device is written as it
 * comes.
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

/* ---- Meshes ---- */

/** Vertices and polygons, with nothing assumed of them: a polygon soup, or a mesh after repair. */
typedef struct vxm_mesh vxm_mesh;

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

/** Caller-owned arrays that describe a mesh; they are copied. */
typedef struct vxm_mesh_arrays {
  uint32_t version;         /**< 1 */
  vxm_scalar vertex_scalar; /**< type of the coordinates: VXM_FLOAT64 or VXM_FLOAT32 */
  const void *vertices;     /**< vertex_count x 3 coordinates, x y z together, model units */
  int64_t vertex_count;
  const int64_t
      *offsets; /**< face f has corners indices[offsets[f]] to indices[offsets[f+1]-1]; NULL = triangles */
  const int64_t *indices; /**< 0-based vertices of the corners */
  int64_t face_count;
  const char *const *tags;   /**< tag_count names, as vxm_mesh_tag_name gives them */
  const uint32_t *face_tags; /**< face_count tag numbers; not looked at without tags */
  int64_t tag_count;         /**< 0 = faces have no tags */
} vxm_mesh_arrays;

#define VXM_MESH_ARRAYS_INIT \
  { 1, VXM_FLOAT64, NULL, 0, NULL, NULL, 0, NULL, NULL, 0 }

/**
 * Makes a mesh from arrays.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT with `element` the face whose offsets run backwards, that has fewer than
 * three corners, or that names a vertex or tag that does not exist; VXM_ERROR_RANGE beyond 2^32 - 2 vertices;
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_mesh_create(vxm_mesh **out, vxm_context *context, const vxm_mesh_arrays *arrays,
                                   vxm_error *error);

/**
 * Reads a mesh file, its format told by content first and by name second: OFF, OBJ, STL and PLY; glTF, 3MF,
 * COLLADA, FBX, 3DS and more where voxmend was built with Assimp; STEP and IGES where it was built with
 * OpenCASCADE. What the libraries read is read in a process of its own (doc/formats.md); names of parts
 * become face tags. What a damaged file still holds is read, and each kind of damage becomes a warning of the
 * mesh.
 *
 * @param path file to read; "-" reads standard input. A file is mapped: nobody may shorten it meanwhile
 * @return VXM_OK; VXM_ERROR_IO; VXM_ERROR_FORMAT with line or offset; VXM_ERROR_RANGE beyond 2^32 - 2
 * vertices; VXM_ERROR_UNAVAILABLE if the library that reads it is not there; VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_mesh_read(vxm_mesh **out, vxm_context *context, const char *path, vxm_error *error);

/** As vxm_mesh_read, from memory. `name` is used in messages and for its extension. */
VXM_API vxm_status vxm_mesh_read_memory(vxm_mesh **out, vxm_context *context, const void *data, size_t size,
                                        const char *name, vxm_error *error);

/** Which other files a mesh may refer to, such as the buffers of a glTF. What is refused becomes a warning of
 * the mesh, and an error where it cannot be read without. */
typedef enum vxm_external {
  VXM_EXTERNAL_FOLDER = 0, /**< regular files in the folder of the mesh or below, never by a way out of it;
                              none where the mesh comes from memory or standard input */
  VXM_EXTERNAL_ANY = 1,    /**< any regular file, by whatever path the mesh says; relative ones begin in the
                              folder of the mesh, or of the name that bytes in memory are given */
  VXM_EXTERNAL_NONE = 2    /**< none */
} vxm_external;

typedef struct vxm_mesh_read_options {
  uint32_t version;   /**< 1 */
  const char *format; /**< as vxm_mesh_format says, such as "off" or "step"; NULL = by content, then name */
  double deflection;  /**< STEP and IGES: how far triangles may lie from a curved surface, as a part of the
                         model's diagonal, at most 1; 0 = 0.001 */
  vxm_external external; /**< files that the mesh refers to */
} vxm_mesh_read_options;

#define VXM_MESH_READ_OPTIONS_INIT \
  { 1, NULL, 0.0, VXM_EXTERNAL_FOLDER }

/* As the two above, with options. @return also VXM_ERROR_ARGUMENT for options out of range */
VXM_API vxm_status vxm_mesh_read_with(vxm_mesh **out, vxm_context *context, const char *path,
                                      const vxm_mesh_read_options *options, vxm_error *error);
VXM_API vxm_status vxm_mesh_read_memory_with(vxm_mesh **out, vxm_context *context, const void *data,
                                             size_t size, const char *name,
                                             const vxm_mesh_read_options *options, vxm_error *error);

/** How meshes are read that are left to foreign libraries, each file in a process of its own. */
typedef struct vxm_reading_info {
  bool assimp, occt;                         /**< whether these libraries' modules are installed */
  const char *assimp_formats, *occt_formats; /**< the extensions of what they are given, such as "gltf glb" */
  bool filter;  /**< the process may make no system calls but those that computing takes (libseccomp) */
  int landlock; /**< version of Landlock in this kernel, by which the process has no files; 0 = none */
} vxm_reading_info;

/** @return VXM_OK, VXM_ERROR_ARGUMENT */
VXM_API vxm_status vxm_reading_find(vxm_reading_info *out, vxm_error *error);

typedef struct vxm_mesh_write_options {
  uint32_t version;   /**< 1 */
  const char *format; /**< "off", "obj", "stl" or "ply"; NULL = by the extension of the path */
  bool ascii;         /**< stl and ply as text rather than binary */
} vxm_mesh_write_options;

#define VXM_MESH_WRITE_OPTIONS_INIT \
  { 1, NULL, false }

/**
 * Writes a mesh, under a temporary name first, so that no half-written file is left. "-" writes standard
 * output. Coordinates come back bit for bit from OFF, OBJ and PLY; STL holds 32-bit floats and triangles
 * only.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT for an unknown format; VXM_ERROR_IO; VXM_ERROR_RANGE if the format
 * cannot hold the mesh; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_mesh_write(const vxm_mesh *mesh, const char *path,
                                  const vxm_mesh_write_options *options, vxm_error *error);
VXM_API void vxm_mesh_destroy(vxm_mesh *mesh);

VXM_API int64_t vxm_mesh_vertex_count(const vxm_mesh *mesh);
VXM_API int64_t vxm_mesh_face_count(const vxm_mesh *mesh);
/** vertex_count x 3 coordinates in model units. */
VXM_API const double *vxm_mesh_vertices(const vxm_mesh *mesh);
/** face_count + 1 offsets into vxm_mesh_indices. */
VXM_API const uint64_t *vxm_mesh_offsets(const vxm_mesh *mesh);
/** 0-based vertices of all corners, face after face. */
VXM_API const uint32_t *vxm_mesh_indices(const vxm_mesh *mesh);
/** Number of face tags (names of groups or parts, and of materials); 0 if the file had none. */
VXM_API int64_t vxm_mesh_tag_count(const vxm_mesh *mesh);
/** Name of a tag, UTF-8 as in the file, "group" or "group/material"; parts of one name are numbered "name#1",
 * "name#2". */
VXM_API const char *vxm_mesh_tag_name(const vxm_mesh *mesh, int64_t tag);
/** face_count tag numbers, or NULL if there are no tags. */
VXM_API const uint32_t *vxm_mesh_face_tags(const vxm_mesh *mesh);
/** Format the mesh was read from, such as "off" or "ply binary_little_endian"; "arrays" if made from arrays.
 */
VXM_API const char *vxm_mesh_format(const vxm_mesh *mesh);
/** Warnings from reading, one line each. */
VXM_API int64_t vxm_mesh_warning_count(const vxm_mesh *mesh);
VXM_API const char *vxm_mesh_warning(const vxm_mesh *mesh, int64_t index);

/* ---- Census: what is wrong with a mesh ---- */

/** Counts over a mesh. Edges, components and duplicates are taken after welding bit-identical positions. */
typedef struct vxm_census {
  int64_t vertices, faces;
  int64_t triangles;       /**< after splitting polygons: the sum of corners - 2 */
  int64_t components;      /**< connected by welded vertices; faces only */
  int64_t components_raw;  /**< connected by vertex index as in the file */
  int64_t duplicate_faces; /**< faces that repeat an earlier one with the same orientation */
  int64_t
      opposite_duplicate_faces; /**< faces that repeat an earlier one with the opposite orientation only */
  int64_t degenerate_faces;     /**< fewer than three distinct corners, or no area */
  int64_t boundary_edges;       /**< one incident face */
  int64_t nonmanifold_edges;    /**< more than two incident faces */
  int64_t inconsistent_edges;   /**< two incident faces that run along it in the same direction */
  int64_t nonfinite_vertices, unused_vertices;
  int64_t largest_face; /**< corners of the largest face */
  bool watertight;      /**< at least one face, no boundary and no non-manifold edge */
  bool closed;          /**< at least one face, and every edge has an even number of incident faces */
  double bounds[6]; /**< x0 y0 z0 x1 y1 z1 of the finite vertices used by faces; zeros if there are none */
  double area;      /**< model units squared; polygons by their vector area */
  double volume;    /**< signed; positive if faces point outward. Meaningful if closed. This and the area are
                       infinite where they are beyond the range of numbers */
} vxm_census;

/** @return VXM_OK, VXM_ERROR_ARGUMENT, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED */
VXM_API vxm_status vxm_mesh_census(vxm_census *out, const vxm_mesh *mesh, vxm_error *error);

/* ---- Repair ---- */

typedef enum vxm_weld {
  VXM_WELD_AUTO = 0, /**< bit-identical positions, then near ones where that closes cracks */
  VXM_WELD_OFF,      /**< bit-identical positions only */
  VXM_WELD_TOLERANCE /**< bit-identical positions, then all that are no farther apart than weld_tolerance */
} vxm_weld;

/**
 * How far a repair goes. Each level includes those before it, and holds of the mesh as it is read back from
 * its file and welded (vxm_mesh_write_verified).
 */
typedef enum vxm_level {
  VXM_LEVEL_CLEAN = 0, /**< the passes have nothing left to do: repairing again changes nothing */
  VXM_LEVEL_MANIFOLD, /**< no edge has more than two faces, those two run along it in opposite directions, and
                         the faces about a vertex form one fan */
  VXM_LEVEL_CLOSED,   /**< every edge has two faces */
  VXM_LEVEL_SOLID     /**< no face cuts through another: parts that did are united */
} vxm_level;

/** What holes are filled with. */
typedef enum vxm_fill {
  VXM_FILL_FAN = 0, /**< triangles from a new vertex in the middle of the rim */
  VXM_FILL_MINIMAL, /**< the triangulation of the rim with the least area; needs the module for OpenMesh */
  VXM_FILL_SMOOTH   /**< triangles as small as those about the rim, which continue its curvature; needs the
                       module for   CGAL */
} vxm_fill;

typedef struct vxm_repair_options {
  uint32_t version; /**< 1 */
  vxm_weld weld;
  double weld_tolerance; /**< model units, with VXM_WELD_TOLERANCE */
  bool keep_duplicates;  /**< leave repeated faces in */
  bool keep_orientation; /**< leave faces turned as they are; not with a level above VXM_LEVEL_CLEAN */
  vxm_level level;
  int64_t fill_holes; /**< fill holes with at most so many edges; 0 = none, and from VXM_LEVEL_CLOSED on all;
                         negative = all */
  vxm_fill fill;
  bool unite;         /**< unite closed parts that cut through each other, as VXM_LEVEL_SOLID does */
  double wrap_alpha;  /**< put a closed surface around everything instead: the size of the smallest hole that
                         it goes  into, as a fraction of the diagonal of the bounds; 0 = do not */
  double wrap_offset; /**< its distance from the mesh, in the same way; 0 = a thirtieth of wrap_alpha */
  bool single_precision; /**< keep to positions that 32-bit floats hold, as .stl files do */
  bool part_changes;     /**< keep account of every part: vxm_mesh_part_changes */
  double max_change;  /**< fail where the volume of a closed part, or the bounds of one, change by more than
                         this fraction (of its volume, of its diagonal); 0 = do not look */
  int64_t drop_faces; /**< drop components with fewer faces than this; 0 = none */
  double drop_volume; /**< drop closed components with less volume than this, model units cubed; 0 = none.
                         The component with the largest area always stays */
  bool intersections; /**< count self-intersections, before and after, in the report and in the account of
                         parts; needs the module for CGAL */
} vxm_repair_options;

#define VXM_REPAIR_OPTIONS_INIT                                                                           \
  {                                                                                                       \
    1, VXM_WELD_AUTO, 0.0, false, false, VXM_LEVEL_CLEAN, 0, VXM_FILL_FAN, false, 0.0, 0.0, false, false, \
        0.0, 0, 0.0, false                                                                                \
  }

#define VXM_REPAIR_PASSES_MAX 24

/** Self-intersections are counted up to this number, which then means that there are at least so many. */
#define VXM_SELF_INTERSECTIONS_MAX 4194304

typedef struct vxm_repair_report {
  int pass_count;
  struct {
    const char *pass; /**< fixed name such as "exact_weld" */
    int64_t count;    /**< vertices or faces that the pass removed, changed or added */
  } passes[VXM_REPAIR_PASSES_MAX];
  int64_t nonorientable_patches; /**< faces joined by edges that cannot all be turned consistently */
  int64_t open_parts;     /**< components whose holes were left open: sheets that their closing would cover */
  int64_t unfilled_holes; /**< that were to be filled and could not be */
  int64_t fanned_holes;   /**< that VXM_FILL_MINIMAL or VXM_FILL_SMOOTH left to fans */
  int64_t ununited_parts; /**< that were to be united and still cut through themselves or others: open ones,
                             which have no inside, and those where the union failed */
  int64_t self_intersections_before, self_intersections_after; /**< pairs of faces, counted up to
                                                                  VXM_SELF_INTERSECTIONS_MAX; -1 = not looked
                                                                  for */
  int64_t unparted_vertices; /**< that share a position and could not be moved apart: the numbers that hold
                                positions are too coarse for the faces about them */
  int64_t shared_faces; /**< at level clean: that repeat others and stay, as bodies overlap there and both
                           need theirs; from manifold on each body has its own */
  int64_t lost_parts;   /**< closed components of which something that they enclosed, by winding or by parity,
                           is enclosed no more and could not be kept; what levels and options beyond
                           VXM_LEVEL_CLEAN take away is not looked at */
  int64_t opened_parts; /**< closed before, open after; with options.part_changes, else 0 */
  double moved;         /**< no vertex was moved farther, model units; not by a wrap or union. With
                           options.part_changes, else 0 */
  vxm_census before, after;
} vxm_repair_report;

/**
 * Repairs a mesh into a new one: removes non-finite vertices with their faces, welds, removes repeated
 * corners, faces without area and repeated faces (a face and its reverse become one), and unused vertices;
 * turns faces consistently, outward where they enclose something; then goes as far as the level and the other
 * options say. Applying it to its own result changes nothing. Vertices keep their order and the position of
 * the first one welded; only where a soup was torn apart everywhere do they move, to the middle of the copies
 * joined, and where a vertex had to become several, which are moved apart by some 1e-9 of the diagonal so
 * that welding leaves them be.
 *
 * @param[out] report may be NULL (then no census is taken)
 * @return VXM_OK (the result may have no faces); VXM_ERROR_ARGUMENT; VXM_ERROR_UNREACHED beyond max_change;
 * VXM_ERROR_UNAVAILABLE if something asked for needs a module that is not there; VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_mesh_repair(vxm_mesh **out, vxm_repair_report *report, const vxm_mesh *mesh,
                                   const vxm_repair_options *options, vxm_error *error);

/**
 * Repairs a mesh to be voxelized: as vxm_mesh_repair; then closed bodies that share faces, edges or vertices
 * each get their own vertices, at the same positions, and what several of them cover becomes layers that
 * nest: together they would be one component, and its parity that of their difference. Where faces cut
 * through each other so that there are no layers, bodies that share faces are separated as at
 * VXM_LEVEL_MANIFOLD. With keep_orientation they stay together. It is what voxmend voxelize and the Python
 * package do.
 *
 * @return as vxm_mesh_repair
 */
VXM_API vxm_status vxm_mesh_prepare(vxm_mesh **out, vxm_repair_report *report, const vxm_mesh *mesh,
                                    const vxm_repair_options *options, vxm_error *error);

/** A part of a mesh, at one time. Edges and holes are taken after welding. */
typedef struct vxm_part_state {
  int64_t faces, boundary_edges, nonmanifold_edges, inconsistent_edges;
  int64_t holes;              /**< closed walks along edges with an odd number of faces */
  int64_t self_intersections; /**< pairs of its faces, or of one of them and another part's, that cut through
                                 each other; -1 = not looked for (vxm_repair_options.intersections) */
  bool closed;                /**< it has faces, and every edge has an even number of them */
  double area, volume;        /**< as in vxm_census */
  double bounds[6];
} vxm_part_state;

/** What a repair did to a connected component of the mesh that it was given. */
typedef struct vxm_part_change {
  vxm_part_state before, after; /**< after: of all faces that come from this part; none after a wrap */
  int64_t flipped;              /**< faces that were turned */
  double moved;                 /**< none of its vertices was moved farther, model units */
  uint32_t tag;                 /**< of its first face; UINT32_MAX if there are no tags */
  bool ununited;                /**< it counts among vxm_repair_report.ununited_parts */
} vxm_part_change;

/** Number of connected components (after welding) of the mesh that was repaired; 0 without
 * options.part_changes. */
VXM_API int64_t vxm_mesh_part_change_count(const vxm_mesh *repaired);
/** What became of each, in the order of their first faces. */
VXM_API const vxm_part_change *vxm_mesh_part_changes(const vxm_mesh *repaired);

/* ---- What a mesh guarantees, and what is wrong where ---- */

#define VXM_REMAINS_MAX 24

/** Whether a mesh is at a level, and what is in the way. */
typedef struct vxm_verification {
  bool reached;
  int count;
  struct {
    const char *what; /**< fixed name such as "boundary_edges" or a pass that would still change something */
    int64_t count;
    int64_t element; /**< the first one: a vertex, or for faces and edges a face, with its number in the mesh
                        that is verified, which is that of the file; -1 = none to tell */
    bool placed;     /**< whether `at` is known */
    double at[3];    /**< where that is, model units */
  } remains[VXM_REMAINS_MAX];
} vxm_verification;

/**
 * Checks what a level guarantees, after welding identical positions.
 *
 * @param options those of the repair: `level`, and what is to be kept; NULL = defaults
 * @return VXM_OK whether or not it is reached; VXM_ERROR_ARGUMENT; VXM_ERROR_UNAVAILABLE if VXM_LEVEL_SOLID
 * is asked for without the module for CGAL; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_mesh_verify(vxm_verification *out, const vxm_mesh *mesh,
                                   const vxm_repair_options *options, vxm_error *error);

/**
 * Writes a mesh as vxm_mesh_write, reads back what was written and verifies it. Where the level is not
 * reached nothing is left behind, unless `best_effort` is set.
 *
 * @param[out] out  filled if the file could be written and read
 * @return as vxm_mesh_write and vxm_mesh_verify; VXM_ERROR_UNREACHED
 */
VXM_API vxm_status vxm_mesh_write_verified(vxm_verification *out, const vxm_mesh *mesh, const char *path,
                                           const vxm_mesh_write_options *write,
                                           const vxm_repair_options *repair, bool best_effort,
                                           vxm_error *error);

typedef enum vxm_defect_kind {
  VXM_DEFECT_NONFINITE_VERTEX = 0,
  VXM_DEFECT_DEGENERATE_FACE,
  VXM_DEFECT_DUPLICATE_FACE,
  VXM_DEFECT_BOUNDARY_EDGE,
  VXM_DEFECT_NONMANIFOLD_EDGE,
  VXM_DEFECT_INCONSISTENT_EDGE,
  VXM_DEFECT_NONMANIFOLD_VERTEX, /**< its faces form more than one fan, though none of its edges is at fault
                                  */
  VXM_DEFECT_SELF_INTERSECTION,  /**< two faces that cut through each other */
  VXM_DEFECT_KINDS
} vxm_defect_kind;

/** Something that is wrong with a mesh, and where. */
typedef struct vxm_defect {
  vxm_defect_kind kind;
  int64_t element[2]; /**< a vertex or face, and -1; of an edge its vertices; of an intersection the faces */
  double at[6]; /**< the vertex, or the middle of the face, twice; the ends of the edge; the middles of both
                   faces */
} vxm_defect;

/** The defects of a mesh, ordered by kind, then by element. */
typedef struct vxm_defects vxm_defects;

/**
 * Finds what is wrong with a mesh, after welding identical positions.
 *
 * @param most          of each kind; 0 = all
 * @param intersections look for self-intersections too, which needs the module for CGAL
 * @return VXM_OK, VXM_ERROR_ARGUMENT, VXM_ERROR_UNAVAILABLE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 * VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_mesh_defects(vxm_defects **out, const vxm_mesh *mesh, int64_t most, bool intersections,
                                    vxm_error *error);
VXM_API void vxm_defects_destroy(vxm_defects *defects);
VXM_API int64_t vxm_defects_count(const vxm_defects *defects);
VXM_API const vxm_defect *vxm_defects_items(const vxm_defects *defects);
/** How many of a kind there are, listed or not; self-intersections are counted up to 4194304, -1 = not looked
 * for. */
VXM_API int64_t vxm_defects_total(const vxm_defects *defects, vxm_defect_kind kind);
/** Fixed name of a kind, such as "boundary_edge". */
VXM_API const char *vxm_defect_name(vxm_defect_kind kind);
/**
 * Writes the mesh as .ply with its defects in colour: faces and edges at fault, the edges as elements of
 * their own; the rest is grey. @return as vxm_mesh_write
 */
VXM_API vxm_status vxm_defects_write(const vxm_defects *defects, const vxm_mesh *mesh, const char *path,
                                     vxm_error *error);

/* ---- Grids ---- */

/** A box of dims[0] x dims[1] x dims[2] cells: the centre of (i,j,k) is origin + ((i,j,k) + 1/2) *
 * voxel_size. */
typedef struct vxm_space {
  int64_t dims[3];
  double origin[3];     /**< minimum corner, model units */
  double voxel_size[3]; /**< model units per axis */
} vxm_space;

/** One bit per voxel, x fastest, rows padded to whole 64-bit words with zero bits. */
typedef struct vxm_grid vxm_grid;

/** Makes an empty grid. @return VXM_OK, VXM_ERROR_ARGUMENT, VXM_ERROR_RANGE, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT */
VXM_API vxm_status vxm_grid_create(vxm_grid **out, vxm_context *context, const vxm_space *space,
                                   vxm_error *error);
VXM_API void vxm_grid_destroy(vxm_grid *grid);

VXM_API const vxm_space *vxm_grid_space(const vxm_grid *grid);
/** Whether voxel (i,j,k) is set; false outside the grid. */
VXM_API bool vxm_grid_get(const vxm_grid *grid, int64_t i, int64_t j, int64_t k);
/** Sets or clears voxel (i,j,k); outside the grid it does nothing. */
VXM_API void vxm_grid_set(vxm_grid *grid, int64_t i, int64_t j, int64_t k, bool value);
/** Words of a row: (dims[0] + 63) / 64. */
VXM_API int64_t vxm_grid_row_words(const vxm_grid *grid);
/** Row (j,k) starts at word (k * dims[1] + j) * row_words; voxel i is bit i % 64 of its word i / 64. */
VXM_API const uint64_t *vxm_grid_words(const vxm_grid *grid);
/** Number of set voxels. */
VXM_API int64_t vxm_grid_count(const vxm_grid *grid);
/** A 64-bit hash of dimensions and bits, the same on every machine. */
VXM_API uint64_t vxm_grid_hash(const vxm_grid *grid);
/** One byte, 0 or 1, per voxel into dims[0]*dims[1]*dims[2] bytes, as [x][y][z] in C order (z fastest). */
VXM_API void vxm_grid_unpack(const vxm_grid *grid, uint8_t *bytes);
/** Sets all voxels from such bytes: those that are not 0. */
VXM_API void vxm_grid_pack(vxm_grid *grid, const uint8_t *bytes);
/**
 * As vxm_grid_unpack, of the voxels (i,j,k) with i from begin to end - 1, into (end - begin)*dims[1]*dims[2]
 * bytes; with progress, and to be cancelled.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT if an argument is NULL or the range does not lie within the grid;
 *         VXM_ERROR_CANCELLED, then the bytes are unspecified
 */
VXM_API vxm_status vxm_grid_unpack_range(const vxm_grid *grid, int64_t begin, int64_t end, uint8_t *bytes,
                                         vxm_error *error);
/** The same the other way; voxels outside of the range stay. @return as vxm_grid_unpack_range; after
 * VXM_ERROR_CANCELLED some are set */
VXM_API vxm_status vxm_grid_pack_range(vxm_grid *grid, int64_t begin, int64_t end, const uint8_t *bytes,
                                       vxm_error *error);
/**
 * Sets all voxels from words as vxm_grid_words gives them; bits beyond the end of a row are left out.
 *
 * @param count row_words * dims[1] * dims[2]
 * @return VXM_OK; VXM_ERROR_ARGUMENT if an argument is NULL or `count` is another number
 */
VXM_API vxm_status vxm_grid_set_words(vxm_grid *grid, const uint64_t *words, size_t count, vxm_error *error);
/**
 * How sure each voxel is, 0 (a guess) to 255 (proven), dims[0]*dims[1]*dims[2] bytes with x fastest; NULL
 * unless the grid was made with vxm_voxelize_options.confidence. A voxel decided by closed parts alone has
 * 255, one decided by the winding number w has 255 times the smaller of 1 and |2 w - 1|, any other the share
 * of the voters x, y, z and tetra that agree with it; what the surface sets has 255.
 */
VXM_API const uint8_t *vxm_grid_confidence(const vxm_grid *grid);
/**
 * Writes the confidence as .npy: uint8, indexed [x][y][z], stored with x fastest.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT if the grid has none or the extension is another; VXM_ERROR_IO,
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_grid_write_confidence(const vxm_grid *grid, const char *path, vxm_error *error);
/** Warnings from voxelizing or reading, one line each. */
VXM_API int64_t vxm_grid_warning_count(const vxm_grid *grid);
VXM_API const char *vxm_grid_warning(const vxm_grid *grid, int64_t index);

/**
 * Reads a grid: .binvox, .npy, .raw (with its .json beside it), .rle, .nrrd or .vdb, told by content first
 * and by name second. Of .vdb, the first grid of bool, mask or float: of bool and mask, what is active (and
 * true) is set. "-" reads standard input (not .raw).
 *
 * Numbers are taken as voxels only if nothing is lost: where all of them are 0 or 1, whatever their type, or
 * unsigned bytes of which some are 0 and the others 255. Distances and confidences, and colours, never are.
 *
 * @return VXM_OK; VXM_ERROR_IO; VXM_ERROR_FORMAT with offset; VXM_ERROR_NUMBERS for other numbers, which
 *         vxm_field_read reads; VXM_ERROR_UNAVAILABLE for packed values without the library that unpacks them
 *         (zlib for .nrrd, OpenVDB for .vdb); VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_grid_read(vxm_grid **out, vxm_context *context, const char *path, vxm_error *error);

typedef struct vxm_grid_write_options {
  uint32_t version;   /**< 1 */
  const char *format; /**< "binvox", "npy", "raw", "rle", "nrrd", "vdb", or "obj", "ply", "stl", "off"; NULL =
                         by extension */
} vxm_grid_write_options;

#define VXM_GRID_WRITE_OPTIONS_INIT \
  { 1, NULL }

/**
 * Writes a grid, under a temporary name first. "-" writes standard output (not .raw). The mesh formats hold
 * the grid's surface as vxm_grid_surface_mesh makes it. .binvox pads a grid that is not cubic at its far
 * side.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT for an unknown format, or .binvox with voxels that are not cubes;
 * VXM_ERROR_UNAVAILABLE for .vdb without OpenVDB; VXM_ERROR_IO; VXM_ERROR_RANGE, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_grid_write(const vxm_grid *grid, const char *path,
                                  const vxm_grid_write_options *options, vxm_error *error);

/**
 * Makes a mesh of the exposed voxel faces in model units, facing outward, merged into rectangles that share
 * vertices. The mesh is closed mod 2: rectangles have a corner wherever a neighbour has one.
 */
VXM_API vxm_status vxm_grid_surface_mesh(vxm_mesh **out, const vxm_grid *grid, vxm_error *error);

typedef struct vxm_picture_options {
  uint32_t version;  /**< 1 */
  int width, height; /**< pixels; 0 = 800 x 600 */
  double azimuth;    /**< degrees about the up axis */
  double elevation;  /**< degrees above the horizon */
  int up;            /**< axis that points up: 0 = default (z), 1 = x, 2 = y, 3 = z */
} vxm_picture_options;

#define VXM_PICTURE_OPTIONS_INIT \
  { 1, 0, 0, 30.0, 25.0, 0 }

/**
 * Draws the grid as shaded voxels into a PNG file.
 *
 * @return VXM_OK; VXM_ERROR_UNAVAILABLE without libpng; VXM_ERROR_ARGUMENT, VXM_ERROR_IO, VXM_ERROR_MEMORY,
 *         VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_grid_picture(const vxm_grid *grid, const char *path,
                                    const vxm_picture_options *options, vxm_error *error);

/**
 * Reads only where the voxels of a grid or field lie: a grid in which none is set.
 *
 * @return as vxm_grid_read, without VXM_ERROR_NUMBERS
 */
VXM_API vxm_status vxm_grid_read_space(vxm_grid **out, vxm_context *context, const char *path,
                                       vxm_error *error);

typedef struct vxm_comparison {
  int64_t voxels_a, voxels_b, both, only_a, only_b;
  double iou; /**< both / (both + only_a + only_b); 1 if both grids are empty */
} vxm_comparison;

/** Compares two grids of equal dimensions. @return VXM_OK; VXM_ERROR_ARGUMENT if the dimensions differ */
VXM_API vxm_status vxm_grid_compare(vxm_comparison *out, const vxm_grid *a, const vxm_grid *b,
                                    vxm_error *error);

/* ---- Fields in files: numbers, labels and colours ---- */

/** What the numbers of a field are, as far as its file says. */
typedef enum vxm_field_kind {
  VXM_FIELD_NUMBERS = 0, /**< it does not say */
  VXM_FIELD_DISTANCE,    /**< model units, negative inside where it has a sign */
  VXM_FIELD_COVERAGE,    /**< the share of a voxel that is filled: 0 to 1, or 0 to 255 of unsigned bytes */
  VXM_FIELD_LABELS,      /**< 0 = none */
  VXM_FIELD_CONFIDENCE,  /**< 0 = a guess, to 255 = proven */
  VXM_FIELD_COLORS       /**< red, green, blue and opacity, 0 = no voxel: VXM_UINT8, four channels */
} vxm_field_kind;

/** One number (or colour) for each voxel of a space. It does not change once it is made. */
typedef struct vxm_field vxm_field;

/**
 * Makes a field of a copy of values.
 *
 * @param values [x][y][z] in C order (z fastest); of VXM_FIELD_COLORS [x][y][z][4]
 * @return VXM_OK; VXM_ERROR_ARGUMENT, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_field_create(vxm_field **out, vxm_context *context, const vxm_space *space,
                                    vxm_field_kind kind, vxm_scalar scalar, const void *values,
                                    vxm_error *error);

/**
 * Reads the numbers of a file as they are: .npy, .nrrd, .vdb, or .binvox. Files that hold bits give 0 and 1,
 * as VXM_UINT8. Floats of 16 bits in .vdb become VXM_FLOAT32.
 *
 * @return as vxm_grid_read, without VXM_ERROR_NUMBERS
 */
VXM_API vxm_status vxm_field_read(vxm_field **out, vxm_context *context, const char *path, vxm_error *error);

/**
 * Reads what a file holds: a grid where it stores bits (booleans, or unsigned bytes of which all are 0 or 1),
 * else a field. Of *grid and *field one is NULL. @return as vxm_field_read
 */
VXM_API vxm_status vxm_grid_or_field_read(vxm_grid **grid, vxm_field **field, vxm_context *context,
                                          const char *path, vxm_error *error);
VXM_API void vxm_field_destroy(vxm_field *field);

VXM_API const vxm_space *vxm_field_space(const vxm_field *field);
VXM_API vxm_field_kind vxm_field_kind_of(const vxm_field *field);
VXM_API vxm_scalar vxm_field_scalar(const vxm_field *field);
/** 4 of colours, else 1. */
VXM_API int vxm_field_channels(const vxm_field *field);
/** [x][y][z] in C order (z fastest), of colours [x][y][z][4]. */
VXM_API const void *vxm_field_values(const vxm_field *field);
/** Short fixed name of a kind, such as "distance", or "" for none. */
VXM_API const char *vxm_field_kind_name(vxm_field_kind kind);
/** Name of a type as numpy has it, such as "float32", or "" for none. */
VXM_API const char *vxm_scalar_name(vxm_scalar scalar);

typedef struct vxm_field_range {
  double least, greatest; /**< of those that are numbers; of colours the opacity; 0 and 0 if none are */
  int64_t not_numbers;    /**< NaN */
} vxm_field_range;

/** The range of the values. @return VXM_OK, VXM_ERROR_ARGUMENT */
VXM_API vxm_status vxm_field_measure(vxm_field_range *out, const vxm_field *field, vxm_error *error);

/** Number of labels that have an entry in the table beside the file, numbered from 1; 0 if there is none. */
VXM_API int64_t vxm_field_label_count(const vxm_field *field);
/** Name of label 1 to vxm_field_label_count; "" for others. */
VXM_API const char *vxm_field_label_name(const vxm_field *field, int64_t label);

/** What else a file says of its values, such as units, as pairs of texts; it goes along into .npy (its
 * .json), .nrrd and .vdb. */
VXM_API int64_t vxm_field_metadata_count(const vxm_field *field);
VXM_API const char *vxm_field_metadata_key(const vxm_field *field, int64_t index);
VXM_API const char *vxm_field_metadata_value(const vxm_field *field, int64_t index);

/**
 * Adds the next label to the table of a field that has just been made, or a pair to its metadata.
 *
 * @param voxels that have the label
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_RANGE beyond what a file may say, which is 1 MiB;
 * VXM_ERROR_MEMORY
 */
VXM_API vxm_status vxm_field_add_label(vxm_field *field, const char *name, int64_t voxels, vxm_error *error);
VXM_API vxm_status vxm_field_add_metadata(vxm_field *field, const char *key, const char *value,
                                          vxm_error *error);

/** Warnings from reading, one line each. */
VXM_API int64_t vxm_field_warning_count(const vxm_field *field);
VXM_API const char *vxm_field_warning(const vxm_field *field, int64_t index);

/** Whether the numbers are bits in another type, of which nothing is lost: see vxm_grid_read. */
VXM_API bool vxm_field_is_mask(const vxm_field *field);

typedef struct vxm_threshold_options {
  uint32_t version;  /**< 1 */
  bool use_at_least; /**< at least one of the two */
  double at_least;   /**< voxels are set where the value is this or greater */
  bool use_below;
  double below; /**< and less than this */
} vxm_threshold_options;

#define VXM_THRESHOLD_OPTIONS_INIT \
  { 1, false, 0.0, false, 0.0 }

/**
 * Makes a grid of a field: voxel (i,j,k) is set where its value is at least one number, below another, or
 * both. -0 counts as below 0: a distance has it inside, on the surface. What is not a number is never set. Of
 * colours the opacity counts.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT without a bound, or if one is not a number; VXM_ERROR_MEMORY,
 *         VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_field_threshold(vxm_grid **out, const vxm_field *field,
                                       const vxm_threshold_options *options, vxm_error *error);

/**
 * Writes a field, under a temporary name first; "-" writes standard output.
 *
 * .npy (with its .json beside it) and .nrrd hold every type (VXM_FLOAT16 becomes VXM_FLOAT32 in .nrrd), .vdb
 * 32-bit floats, if each value is one exactly; it remembers the type. .binvox (version 2) holds whole numbers
 * from 0 to 255. Colours go into .npy, .nrrd, .ply or .vox. Labels have their table in a .json beside the
 * file.
 *
 * @param options NULL = defaults
 * @return VXM_OK; VXM_ERROR_ARGUMENT for a format that holds only bits or is unknown; VXM_ERROR_RANGE if it
 *         cannot hold the values; as vxm_grid_write
 */
VXM_API vxm_status vxm_field_write(const vxm_field *field, const char *path,
                                   const vxm_grid_write_options *options, vxm_error *error);

/**
 * Draws a field into a PNG file as vxm_grid_picture does: of distances what is below 0, or nearer than half a
 * voxel's diagonal if none is; coverage from one half on; labels in colours that depend on the label alone;
 * confidence below 255; colours as they are. Numbers of which the file does not say what they are count as
 * labels if they are whole and not negative, as distances if some are below 0 and some above, as coverage if
 * all are from 0 to 1.
 *
 * @param options   NULL = defaults
 * @param threshold the voxels to be drawn; NULL = as above
 * @return as vxm_grid_picture; VXM_ERROR_NUMBERS for other numbers without a threshold
 */
VXM_API vxm_status vxm_field_picture(const vxm_field *field, const char *path,
                                     const vxm_picture_options *options,
                                     const vxm_threshold_options *threshold, vxm_error *error);

/* ---- Engines: what makes the bits ---- */

/** The CPU, a context of a graphics driver, or an OpenCL device. */
typedef struct vxm_engine vxm_engine;

/** What is known of an engine. */
typedef struct vxm_engine_info {
  char name[48];       /**< such as "cpu", "opengl:osmesa" or "opencl:0" */
  bool available;      /**< it can be made and works */
  bool hardware;       /**< not a renderer in software */
  char renderer[128];  /**< as the driver says; "" if there is none */
  char version[128];   /**< of OpenGL or OpenCL, and of the driver */
  int64_t block_bytes; /**< largest buffer that a shader may use; larger grids are made in tiles */
  int64_t viewport;    /**< columns that one pass draws along an axis; more are drawn in several */
  int64_t layers;      /**< of an array texture: slices drawn at a time */
  int subpixel_bits;   /**< of the rasterizer */
  bool int64;          /**< shaders have 64-bit integers, which VXM_GL_COLUMNS and the surface need */
  char attachment[16]; /**< format in which the XOR self-test passed: "r8ui", "r8" or "image"; "" = none */
  char platform[128];  /**< of OpenCL; "" for others, as all below is 0 */
  char driver[128];    /**< version of the OpenCL driver */
  int compute_units;
  int64_t global_bytes; /**< memory of the device */
  int64_t local_bytes;  /**< memory that a work-group shares */
  int64_t work_group;   /**< most work-items of a group */
  bool int64_atomics;   /**< not needed */
  bool moves;     /**< moves the vertices of variants for training (vxm_sampler) itself; else the CPU does */
  char note[256]; /**< why it is not available, or why another one was taken */
} vxm_engine_info;

/** How an engine of OpenGL makes solids. */
typedef enum vxm_gl_method {
  VXM_GL_COLUMNS = 0, /**< one pass along an axis, a bit flipped for each crossing; the bits of the CPU */
  VXM_GL_SLICES,      /**< slice by slice, tetrahedra cut in a geometry shader (Ogayar et al.) */
  VXM_GL_TETRA_VERTEX /**< the same by a vertex program (Rueda et al.) */
} vxm_gl_method;

/** How an engine of OpenCL makes solids; both have the bits of the CPU (Schwarz & Seidel 2010, section 4). */
typedef enum vxm_cl_method {
  VXM_CL_AUTO = 0,  /**< by tiles where many parts meet or rows have 1024 voxels, else by triangles */
  VXM_CL_TRIANGLES, /**< a work-item for each triangle, which flips bits by atomic XOR; then a prefix XOR */
  VXM_CL_TILES      /**< triangles sorted by tiles of columns, a work-group for each tile, no atomics */
} vxm_cl_method;

typedef struct vxm_engine_options {
  uint32_t version; /**< 1 */
  vxm_gl_method gl_method;
  int slice_axis;      /**< across which axis the slicing methods cut: 0 = x, 1 = y, 2 = z */
  double displacement; /**< slicing methods: each vertex is moved at random by up to so many voxels along each
                          axis (Ogayar et al., section III-B1) */
  uint64_t seed;       /**< of these moves */
  vxm_cl_method cl_method;
  const char *device; /**< OpenCL: the number of a device, or a part of its name or its platform's; NULL = a
                         GPU or accelerator, else the first */
} vxm_engine_options;

#define VXM_ENGINE_OPTIONS_INIT \
  { 1, VXM_GL_COLUMNS, 1, 0.0, 0, VXM_CL_AUTO, NULL }

/**
 * Makes an engine. One thread at a time may use it; many models may, one after another.
 *
 * @param context whose memory limit counts what it holds
 * @param name    "cpu"; "opencl", on the device that the options choose; "opengl", which prefers a hardware
 * device, then EGL without a surface, then OSMesa; one of them by the name that vxm_engines_find gives; or
 * "auto": a GPU by OpenCL or OpenGL that works, else, and wherever it fails later, the CPU
 * @param options NULL = defaults
 * @return VXM_OK; VXM_ERROR_ARGUMENT for an unknown name; VXM_ERROR_UNAVAILABLE with what is missing;
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_engine_create(vxm_engine **out, vxm_context *context, const char *name,
                                     const vxm_engine_options *options, vxm_error *error);
VXM_API void vxm_engine_destroy(vxm_engine *engine);
/** What the engine is, and under `note` what was taken in its place and why. */
VXM_API const vxm_engine_info *vxm_engine_describe(const vxm_engine *engine);
/**
 * Looks at every engine that this build knows, each tried out. Fills at most `capacity` of them.
 *
 * @param[out] count how many there are
 * @return VXM_OK, VXM_ERROR_ARGUMENT, VXM_ERROR_MEMORY
 */
VXM_API vxm_status vxm_engines_find(vxm_engine_info *out, int64_t capacity, int64_t *count, vxm_error *error);

/* ---- A published OpenCL program, for comparison ---- */

/** The voxels of a mesh in the memory of an OpenCL device, made by the program of Faieghi, Tutunea-Fatan and
 * Eagleson, "Fast and cross-vendor OpenCL-based implementation for voxelization of triangular mesh models".
 */
typedef struct vxm_published vxm_published;

typedef struct vxm_published_options {
  uint32_t version;  /**< 1 */
  double voxel_size; /**< model units; has no default */
  bool by_voxel; /**< a work-item for each voxel, over all facets until one meets it (their approach 1); else
                    one for each facet, over the voxels of its box (approach 2, their figure 5) */
  bool count_tests; /**< count the intersection tests as well, which costs memory on the device: 4 bytes per
                       voxel or 8 per facet */
  uint8_t material; /**< what a voxel gets that the surface touches; 0 = 1. Others are 0 */
} vxm_published_options;

#define VXM_PUBLISHED_OPTIONS_INIT \
  { 1, 0.0, false, false, 0 }

typedef struct vxm_published_report {
  double kernel_ms;   /**< of the kernel alone, by the device's own clock where `profiled` */
  bool profiled;      /**< the device has profiling events; else times are the host's */
  int64_t triangles;  /**< polygons are cut into triangles */
  int64_t work_group; /**< work-items of a group: as many as the device lets the kernel have (section 3.4) */
  int64_t tests;      /**< tests of a facet against a voxel, as in their table 1; 0 = not counted */
} vxm_published_report;

/** How voxels come from the device to the host; their figure 7 compares the two. */
typedef enum vxm_transfer {
  VXM_TRANSFER_MAP = 0, /**< clEnqueueMapBuffer */
  VXM_TRANSFER_READ     /**< clEnqueueReadBuffer */
} vxm_transfer;

/**
 * Brings the triangles of a mesh to a device, nine 32-bit floats for each (section 3.1), and makes room for a
 * byte for each voxel of the mesh's bounding box. All is in floats, as published: far from the origin, or
 * where voxels are small against coordinates, voxels at the edge of triangles may differ from
 * vxm_model_voxelize's conservative surface, which is exact.
 *
 * @param[out] out   owned by the caller (vxm_published_destroy); the engine must outlive it, the mesh need
 * not
 * @param[out] space what the grid covers; may be NULL. Its origin is the minimum of the vertices
 * @param engine     an engine of OpenCL
 * @param mesh       polygons in model units; need not be closed
 * @param options    not NULL: the voxel size has to be told
 * @return VXM_OK; VXM_ERROR_ARGUMENT for a voxel size that is not a positive number; VXM_ERROR_UNAVAILABLE
 * for an engine that is not of OpenCL; VXM_ERROR_EMPTY without triangles; VXM_ERROR_RANGE for a vertex that
 * is no finite float, for more than 2^24 voxels along an axis, or for more bytes than the device gives to a
 *         buffer; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT (what is on the device counts, too)
 */
VXM_API vxm_status vxm_published_create(vxm_published **out, vxm_space *space, vxm_engine *engine,
                                        const vxm_mesh *mesh, const vxm_published_options *options,
                                        vxm_error *error);
/**
 * Sets the voxels on the device. Both approaches set the same ones.
 *
 * @param[out] report may be NULL
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_UNAVAILABLE, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_published_voxelize(vxm_published_report *report, vxm_published *published,
                                          vxm_error *error);
/**
 * Brings the voxels to the host.
 *
 * @param[out] voxels a byte per voxel, x fastest, then y, then z (their equation 3.2); NULL = only map them
 * @param[out] ms     time of the transfer alone, as kernel_ms; may be NULL. What is mapped is copied off the
 * clock
 * @return VXM_OK; VXM_ERROR_ARGUMENT for no voxels with VXM_TRANSFER_READ; VXM_ERROR_MEMORY,
 *         VXM_ERROR_UNAVAILABLE
 */
VXM_API vxm_status vxm_published_take(uint8_t *voxels, double *ms, vxm_published *published, vxm_transfer how,
                                      vxm_error *error);
/** NULL is allowed. */
VXM_API void vxm_published_destroy(vxm_published *published);

/* ---- Voxelization ---- */

typedef enum vxm_fit {
  VXM_FIT_CUBE = 0, /**< equal dimensions; the longest side of the model fills them, the model is centred */
  VXM_FIT_TIGHT,    /**< the box of the model */
  VXM_FIT_SPHERE    /**< equal dimensions; the diagonal of the box fills them: safe under rotation */
} vxm_fit;

/** Which voxels of a mesh are set. */
typedef enum vxm_mode {
  VXM_MODE_SOLID = 0, /**< centre inside */
  VXM_MODE_SURFACE,   /**< on the surface, as vxm_surface_kind says */
  VXM_MODE_BOTH       /**< either: thin parts and sheets are kept */
} vxm_mode;

/** Which voxels are the surface. A shell is a part of the solid, so that it adds nothing in VXM_MODE_BOTH. */
typedef enum vxm_surface_kind {
  VXM_SURFACE_CONSERVATIVE = 0, /**< every voxel whose closed box meets a face, no more and no less */
  VXM_SURFACE_THIN,             /**< 6-separating: no path over 6-neighbours crosses a face outside of it */
  VXM_SURFACE_SHELL26, /**< voxels of the solid with an empty one among the 26 around; outside the grid all
                          are empty */
  VXM_SURFACE_SHELL18, /**< among the 18 that share a face or an edge */
  VXM_SURFACE_SHELL6   /**< among the 6 that share a face */
} vxm_surface_kind;

typedef enum vxm_method {
  VXM_METHOD_VOTE = 0, /**< parity along x, y, z and the tetrahedra, combined by vxm_vote */
  VXM_METHOD_X,        /**< parity of crossings along x */
  VXM_METHOD_Y,
  VXM_METHOD_Z,
  VXM_METHOD_TETRA,  /**< XOR of the tetrahedra from the centroid to every triangle (Rueda et al.) */
  VXM_METHOD_WINDING /**< winding number above 1/2 at every voxel, after turning all patches outward */
} vxm_method;

typedef enum vxm_vote {
  VXM_VOTE_AUTO = 0, /**< holes closed by caps over their rims; what stays open by agreement of x, y and z,
                        and by the winding number where they disagree */
  VXM_VOTE_MAJORITY, /**< at least two of x, y and z (Chen & Tu); the tetrahedra cannot overturn that */
  VXM_VOTE_ANY,      /**< at least one voter */
  VXM_VOTE_ALL       /**< every voter */
} vxm_vote;

typedef enum vxm_parts {
  VXM_PARTS_AUTO = 0, /**< every closed component alone, all others together; united */
  VXM_PARTS_GROUP,    /**< every component alone (Chen & Tu); united */
  VXM_PARTS_WHOLE     /**< no splitting */
} vxm_parts;

/** What a closed component inside another one is, with VXM_PARTS_AUTO. */
typedef enum vxm_cavities {
  VXM_CAVITIES_AUTO = 0, /**< a cavity if it is wound against the one around it, else solid */
  VXM_CAVITIES_KEEP,     /**< a cavity */
  VXM_CAVITIES_FILL      /**< solid */
} vxm_cavities;

/** Which voxel space to use. Give resolution or voxel_size, or `like`. */
typedef struct vxm_space_options {
  uint32_t version;      /**< 1 */
  int64_t resolution[3]; /**< voxels per axis; {N,0,0} = N along the longest side; all 0 and no voxel_size =
                            128 */
  double voxel_size;     /**< model units */
  vxm_fit fit;
  int64_t pad; /**< empty voxels kept free on each side; within `resolution`, in addition with voxel_size */
  bool use_bounds;       /**< cover `bounds` instead of fitting to the model: from their minimum corner
                              on, rounded up to whole voxels; exactly if three numbers are given */
  double bounds[6];      /**< x0 y0 z0 x1 y1 z1 */
  const vxm_space *like; /**< take exactly this space; overrides the rest */
} vxm_space_options;

#define VXM_SPACE_OPTIONS_INIT \
  { 1, {0, 0, 0}, 0.0, VXM_FIT_CUBE, 0, false, {0, 0, 0, 0, 0, 0}, NULL }

/**
 * Chooses a voxel space for a mesh.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_EMPTY if the mesh has no extent; VXM_ERROR_RANGE beyond 2^20
 * voxels along an axis
 */
VXM_API vxm_status vxm_space_fit(vxm_space *out, const vxm_mesh *mesh, const vxm_space_options *options,
                                 vxm_error *error);

typedef struct vxm_voxelize_options {
  uint32_t version; /**< 1 */
  vxm_space_options space;
  vxm_method method;
  vxm_vote vote;
  vxm_parts parts;
  vxm_cavities cavities;
  vxm_mode mode;
  bool confidence;  /**< keep for every voxel how sure it is: vxm_grid_confidence */
  bool vote_always; /**< with `vote` majority, any or all: on closed parts too, where the voters agree anyway
                     */
  vxm_surface_kind surface; /**< with `mode` surface and both */
  vxm_engine *engine;       /**< NULL = the CPU. Must outlive the models made with these options */
} vxm_voxelize_options;

#define VXM_VOXELIZE_OPTIONS_INIT                                                                 \
  {                                                                                               \
    1, VXM_SPACE_OPTIONS_INIT, VXM_METHOD_VOTE, VXM_VOTE_AUTO, VXM_PARTS_AUTO, VXM_CAVITIES_AUTO, \
        VXM_MODE_SOLID, false, false, VXM_SURFACE_CONSERVATIVE, NULL                              \
  }

typedef struct vxm_voxelize_report {
  int64_t parts;        /**< parts that were voxelized apart and united */
  int64_t closed_parts; /**< those in which every edge has an even number of faces: all voters agree there */
  int64_t capped_parts; /**< those that were closed by caps over the rims of their holes */
  int64_t cavities;     /**< components that were taken for cavities of the one around them */
  int64_t caps;         /**< rims that were capped */
  int64_t contested;    /**< voxels on which the voters of the parts that stayed open disagreed */
  int64_t escalated;    /**< voxels that the winding number decided: all with VXM_METHOD_WINDING */
  int64_t voxels;       /**< set voxels */
  uint64_t hash;        /**< vxm_grid_hash */
  int64_t empty_parts;  /**< parts that set no voxel; of open parts, all if together they set none */
  int64_t
      outside_parts; /**< parts that set none because they lie outside of the grid: not among empty_parts */
  double fill_ms, write_ms; /**< of vxm_model_write: time for making and for writing the voxels; else 0 */
} vxm_voxelize_report;

/**
 * Voxelizes the inside of a mesh: voxel (i,j,k) is set where its centre is inside.
 *
 * @param[out] out    new grid
 * @param[out] report may be NULL
 * @param mesh        polygons in model units; need not be closed, oriented or manifold; parts are found by
 * vertex index, so repair (or at least weld) it first
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_EMPTY if no face has three different corners;
 *         VXM_ERROR_RANGE if a vertex lies too far outside the grid; VXM_ERROR_MEMORY,
 *         VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 *
 * Parity is computed exactly on an integer lattice (at least 1/256 voxel). For parts closed mod 2 all methods
 * give the same bits, except the winding number where a part cuts through itself or a centre lies on a face.
 * With VXM_METHOD_WINDING the parts of the report are those of the solid that is made first, to turn the
 * faces.
 */
VXM_API vxm_status vxm_voxelize(vxm_grid **out, vxm_voxelize_report *report, const vxm_mesh *mesh,
                                const vxm_voxelize_options *options, vxm_error *error);

/* ---- Models: many grids of one mesh ---- */

/**
 * A mesh made ready for voxelizing: its parts are found, its holes capped. Making one costs more than a small
 * grid does; all its grids share its memory.
 *
 * Several threads may use one model at once, in any calls, each with memory of its own that is kept for the
 * next grid; the bits are the same. But a model with an engine other than the CPU may be used by one thread
 * at a time, as the engine may.
 */
typedef struct vxm_model vxm_model;

/**
 * Makes a model. Its space options are not used: each grid brings its own space.
 *
 * @param mesh as for vxm_voxelize; must outlive the model and stay as it is
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_EMPTY if no face has three different corners;
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_model_create(vxm_model **out, const vxm_mesh *mesh,
                                    const vxm_voxelize_options *options, vxm_error *error);
VXM_API void vxm_model_destroy(vxm_model *model);

/**
 * Voxelizes a model into a grid: all bits of the grid are replaced.
 *
 * @param grid      says the space
 * @param report    NULL = not wanted, nor are warnings, which saves counting and hashing
 * @param transform NULL, or the 3 x 4 matrix, row after row, that takes (x, y, z, 1) of the mesh to where it
 * is voxelized, in model units
 * @return as vxm_voxelize; VXM_ERROR_ARGUMENT too for a matrix that is not finite or has determinant 0. After
 *         a failure the content of the grid is unspecified
 */
VXM_API vxm_status vxm_model_voxelize(vxm_grid *grid, vxm_voxelize_report *report, vxm_model *model,
                                      const double transform[12], vxm_error *error);

/** What voxelizing a model into a file takes. */
typedef struct vxm_estimate {
  uint64_t grid_bytes;   /**< one bit per voxel; of a field, its values */
  uint64_t memory_bytes; /**< held at most, beyond what the context holds already */
  int64_t windows;       /**< ranges of slices that are made and written one after another; 1 = all at once */
} vxm_estimate;

/** Estimates vxm_model_write under the memory limit of the mesh's context. @return as vxm_model_write, before
 * the work. Nothing is opened */
VXM_API vxm_status vxm_model_estimate(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                                      const char *path, const vxm_grid_write_options *options,
                                      vxm_error *error);

/**
 * Voxelizes a model straight into a grid file. What does not fit the memory limit at once is made and written
 * range after range of slices, in the order of the file; the file is the same.
 *
 * @param report may be NULL
 * @param path, options as for vxm_grid_write. The mesh formats and the confidence need the whole grid in
 * memory
 * @return as vxm_voxelize and vxm_grid_write
 */
VXM_API vxm_status vxm_model_write(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                                   const char *path, const vxm_grid_write_options *options, vxm_error *error);

/* ---- Fields: a number per voxel ---- */

typedef struct vxm_coverage_options {
  uint32_t version;   /**< 1 */
  int subdivision;    /**< 2, 4 or 8: a voxel is cut into so many sub-voxels along each axis */
  vxm_scalar scalar;  /**< VXM_FLOAT32: the fraction, 0 to 1; VXM_UINT8: 255 times that, rounded, halves up */
  const char *format; /**< of a file: "npy", "nrrd" or "vdb"; NULL = by extension */
} vxm_coverage_options;

#define VXM_COVERAGE_OPTIONS_INIT \
  { 1, 4, VXM_FLOAT32, NULL }

typedef struct vxm_coverage_report {
  vxm_voxelize_report voxelize; /**< of the sub-voxels, without their hash */
  int64_t full, partial;        /**< voxels of which all sub-voxels are set, or some */
  double volume;                /**< sum of the fractions times the volume of a voxel */
} vxm_coverage_report;

/**
 * Computes how much of each voxel of a space the model fills: the fraction of its sub-voxels that are set, as
 * the options of the model say. They are made a few slices at a time, never all at once.
 *
 * @param values  room for dims[0]*dims[1]*dims[2] float or uint8_t, as [x][y][z] in C order (z fastest)
 * @param report  may be NULL
 * @param options NULL = defaults
 * @return as vxm_model_voxelize; VXM_ERROR_RANGE beyond 2^20 sub-voxels along an axis. After a failure the
 * values are unspecified
 */
VXM_API vxm_status vxm_model_coverage(void *values, vxm_coverage_report *report, vxm_model *model,
                                      const vxm_space *space, const vxm_coverage_options *options,
                                      vxm_error *error);

/** As vxm_model_coverage, into a file: .npy (with its .json beside it), .nrrd or .vdb; as much at a time as
 * the memory limit allows. @return as vxm_model_coverage and vxm_grid_write */
VXM_API vxm_status vxm_model_write_coverage(vxm_coverage_report *report, vxm_model *model,
                                            const vxm_space *space, const char *path,
                                            const vxm_coverage_options *options, vxm_error *error);

/** Estimates vxm_model_write_coverage, as vxm_model_estimate does; what a .vdb holds until it is written
 * follows the surface, and is not counted. */
VXM_API vxm_status vxm_model_estimate_coverage(vxm_estimate *out, const vxm_model *model,
                                               const vxm_space *space, const char *path,
                                               const vxm_coverage_options *options, vxm_error *error);

typedef struct vxm_distance_options {
  uint32_t version;   /**< 1 */
  bool is_unsigned;   /**< false = negative where the centre is inside the solid */
  double band;        /**< voxels, of the longest side; 0 = everywhere */
  const char *format; /**< of a file: "npy", "nrrd" or "vdb"; NULL = by extension */
} vxm_distance_options;

#define VXM_DISTANCE_OPTIONS_INIT \
  { 1, false, 3.0, NULL }

typedef struct vxm_distance_report {
  vxm_voxelize_report voxelize; /**< of the solid that gives the sign, without its hash; zeros if unsigned */
  int64_t exact;                /**< voxels that are not clamped */
  double least, greatest;       /**< of all values */
} vxm_distance_report;

/**
 * Computes the distance from the centre of each voxel to the faces of the mesh, in model units. Within the
 * band it is exact: off by some 1e-14 of the distance and the longest edges, and then rounded to the nearest
 * 32-bit float (which holds 1e-5 voxel up to 168 voxels). Beyond, it is plus or minus the width of the band,
 * which is `band` times the longest side of a voxel. The sign is that of the solid (vxm_voxelize). With a
 * band, time follows surface times band, beside that of the solid.
 *
 * @param values  room for dims[0]*dims[1]*dims[2] values, as [x][y][z] in C order (z fastest)
 * @param report  may be NULL
 * @param model   of VXM_MODE_SOLID
 * @param options NULL = defaults
 * @return as vxm_model_voxelize; VXM_ERROR_ARGUMENT for another mode. After a failure the values are
 * unspecified
 */
VXM_API vxm_status vxm_model_distance(float *values, vxm_distance_report *report, vxm_model *model,
                                      const vxm_space *space, const vxm_distance_options *options,
                                      vxm_error *error);

/** As vxm_model_distance, into a file: .npy (with its .json beside it), .nrrd or .vdb; as much at a time as
 * the memory limit allows. @return as vxm_model_distance and vxm_grid_write */
VXM_API vxm_status vxm_model_write_distance(vxm_distance_report *report, vxm_model *model,
                                            const vxm_space *space, const char *path,
                                            const vxm_distance_options *options, vxm_error *error);

/** Estimates vxm_model_write_distance, as vxm_model_estimate does; what a .vdb holds until it is written
 * follows the surface, and is not counted. */
VXM_API vxm_status vxm_model_estimate_distance(vxm_estimate *out, const vxm_model *model,
                                               const vxm_space *space, const char *path,
                                               const vxm_distance_options *options, vxm_error *error);

/* ---- Labels: which part, group or material a voxel belongs to ---- */

/** What faces are labelled by. */
typedef enum vxm_label_by {
  VXM_LABEL_PART = 0, /**< connected components */
  VXM_LABEL_GROUP,    /**< groups, or parts named in the file: of a face tag what lies before the first '/' */
  VXM_LABEL_MATERIAL  /**< materials: what lies behind it */
} vxm_label_by;

typedef struct vxm_label_options {
  uint32_t version; /**< 1 */
  vxm_label_by by;
  const char *format; /**< of a file: "npy", "nrrd" or "binvox"; NULL = by extension */
} vxm_label_options;

#define VXM_LABEL_OPTIONS_INIT \
  { 1, VXM_LABEL_PART, NULL }

typedef struct vxm_label_report {
  vxm_voxelize_report voxelize; /**< of the set voxels */
  int64_t labels;               /**< numbered from 1 in the order of their first faces */
  int64_t contested; /**< voxels that several labels claim: the one with the nearest face has them */
  int64_t unclaimed; /**< voxels that none claims: they have the label of the nearest face of all */
} vxm_label_report;

/**
 * Labels the voxels of a model: 0 where none is set, else the part, group or material that it belongs to. Set
 * are the voxels that vxm_model_voxelize sets. A label claims the voxels whose centres are inside its own
 * faces, voxelized alone as the options of the model say with VXM_MODE_SOLID, within their bounds. Of several
 * labels that claim a voxel, or of all where none does, it has the one with the face nearest to its centre;
 * among equally near ones, to seven digits, the lowest. The number of threads makes no difference.
 *
 * @param values  room for dims[0]*dims[1]*dims[2] values, as [x][y][z] in C order (z fastest)
 * @param report  may be NULL
 * @param options NULL = defaults
 * @return as vxm_model_voxelize; VXM_ERROR_RANGE beyond 65535 labels. After a failure the values are
 * unspecified
 */
VXM_API vxm_status vxm_model_labels(uint16_t *values, vxm_label_report *report, vxm_model *model,
                                    const vxm_space *space, const vxm_label_options *options,
                                    vxm_error *error);

/**
 * As vxm_model_labels, into a file: .npy, .nrrd, or .binvox (version 2), which holds 255 labels at most. The
 * table of labels goes into a .json beside it. All values are in memory meanwhile. @return as
 * vxm_model_labels and vxm_grid_write
 */
VXM_API vxm_status vxm_model_write_labels(vxm_label_report *report, vxm_model *model, const vxm_space *space,
                                          const char *path, const vxm_label_options *options,
                                          vxm_error *error);

/* ---- Colours ---- */

/** What gives a voxel its colour (Rueda et al., section 5). */
typedef enum vxm_color_by {
  VXM_COLOR_NOISE = 0, /**< Perlin's noise in three dimensions, four octaves */
  VXM_COLOR_POSITION,  /**< red, green and blue along x, y and z */
  VXM_COLOR_PART,      /**< a hue for each connected component */
  VXM_COLOR_GLSL       /**< a function in GLSL: needs an engine of OpenGL */
} vxm_color_by;

typedef struct vxm_color_options {
  uint32_t version; /**< 1 */
  vxm_color_by by;
  const char
      *source; /**< with VXM_COLOR_GLSL: defines vec3 color(vec3 position, vec3 unit, uint part), of the
                  centre in model units, the same from the grid's corner on with its longest side as 1,
                  and the number of the component, from 1 on; may call float noise(vec3), -1 to 1 */
  const char *format; /**< of a file: "npy", "ply" or "vox"; NULL = by extension */
} vxm_color_options;

#define VXM_COLOR_OPTIONS_INIT \
  { 1, VXM_COLOR_NOISE, NULL, NULL }

/**
 * Gives each set voxel of a model a colour.
 *
 * @param values  room for dims[0]*dims[1]*dims[2]*4 bytes, as [x][y][z][4] in C order: red, green, blue and
 *                255; zeros where no voxel is set
 * @param report  may be NULL
 * @param options NULL = defaults
 * @return as vxm_model_voxelize; VXM_ERROR_ARGUMENT too, with what the driver says, for a function that does
 *         not compile; VXM_ERROR_UNAVAILABLE for GLSL without an engine of OpenGL. The engine and the CPU may
 *         differ by 1 in the built-in functions. After a failure the values are unspecified
 */
VXM_API vxm_status vxm_model_colors(uint8_t *values, vxm_voxelize_report *report, vxm_model *model,
                                    const vxm_space *space, const vxm_color_options *options,
                                    vxm_error *error);

/**
 * As vxm_model_colors, into a file: .npy, uint8 [x][y][z][4] (with its .json beside it); .ply, the faces
 * between set and empty voxels with coloured corners; .vox of MagicaVoxel, where colours are
 * told apart by 5 bits each and reduced to at most 255, and every 256 voxels along an axis begin another
 * model. @return as vxm_model_colors and vxm_grid_write
 */
VXM_API vxm_status vxm_model_write_colors(vxm_voxelize_report *report, vxm_model *model,
                                          const vxm_space *space, const char *path,
                                          const vxm_color_options *options, vxm_error *error);

/* What a call leaves in the model, labels and warnings, belongs to the thread that made it, until that
 * thread's next call. A thread that has made nothing of the model is told what another has made last, which
 * it may read while that one is not at work. */

/** Number of labels of the last labels made of the model; 0 if there are none. */
VXM_API int64_t vxm_model_label_count(const vxm_model *model);
/** Name of label 1 to vxm_model_label_count: that of the group or material, or "unnamed"; of a part that of
 * its tag, or of its group, if its faces share one, else "part " and its number. Names may repeat. "" for
 * others. */
VXM_API const char *vxm_model_label_name(const vxm_model *model, int64_t label);
/** Voxels that have a label. */
VXM_API int64_t vxm_model_label_voxels(const vxm_model *model, int64_t label);

/** Warnings from the last grid or file made of the model, one line each. */
VXM_API int64_t vxm_model_warning_count(const vxm_model *model);
VXM_API const char *vxm_model_warning(const vxm_model *model, int64_t index);

/* ---- Variants: augmented voxel grids for training ---- */

/** How variants are rotated. */
typedef enum vxm_rotation {
  VXM_ROTATION_NONE = 0,
  VXM_ROTATION_ANY,  /**< uniform over all rotations (Marsaglia 1972) */
  VXM_ROTATION_AXIS, /**< about `axis`, uniform over all angles */
  VXM_ROTATION_LIST  /**< variant `index` has rotation `index` modulo `rotation_count` */
} vxm_rotation;

/** How vertices are displaced. */
typedef enum vxm_displacement {
  VXM_DISPLACEMENT_UNIFORM = 0, /**< each coordinate uniform in -displace to displace */
  VXM_DISPLACEMENT_NORMAL /**< each nearly normal with deviation `displace`, cut off at three times that */
} vxm_displacement;

/** What a voxel is in memory. */
typedef enum vxm_voxels {
  VXM_VOXELS_PACKED = 0, /**< a bit; each row along z begins with a byte of its own: numpy.unpackbits(...,
                            count=D, bitorder="little") */
  VXM_VOXELS_UINT8,      /**< a byte, 0 or 1 */
  VXM_VOXELS_FLOAT32     /**< a float, 0 or 1 */
} vxm_voxels;

/**
 * What is drawn at random for each variant. All of it starts from the same box: the model is scaled along its
 * own axes, mirrored, rotated, and fitted into the grid so that nothing can lie outside of it; then its
 * vertices are displaced, and it is moved.
 */
typedef struct vxm_sampler_options {
  uint32_t version;   /**< 1 */
  int64_t resolution; /**< voxels along each axis; 0 = 64 */
  int64_t pad;        /**< voxels kept free on each side of the model before it is moved */
  uint64_t seed;
  vxm_rotation rotation;
  double axis[3]; /**< with VXM_ROTATION_AXIS; all 0 = z */
  const double
      *rotations; /**< with VXM_ROTATION_LIST: rotation_count x 3 x 3, row after row; they are copied */
  int64_t rotation_count;
  double scale; /**< each axis is scaled by a factor of its own, uniform in 1 - scale to 1 + scale; below 1 */
  vxm_displacement displacement;
  double displace;  /**< as a fraction of the width of the grid; 0 = vertices stay */
  uint32_t noise;   /**< displacements in the circular buffer that all variants read, each from another place;
                       0 = 65536 */
  unsigned mirror;  /**< axes of the model, or-ed 1 (x), 2 (y) and 4 (z), along each of which half of the
                       variants  are mirrored */
  double translate; /**< moved along each axis by up to this part, 0 to 1, of the room on either side */
  bool fill;        /**< the longest side fills the grid rather than the diagonal; without rotation only */
  vxm_voxelize_options voxelize; /**< how; not its space or confidence. An engine, which must outlive the
                                    sampler, makes one variant after another, and moves the vertices if it
                                    says so (vxm_engine_info.moves) */
} vxm_sampler_options;

#define VXM_SAMPLER_OPTIONS_INIT                                                                             \
  {                                                                                                          \
    1, 0, 0, 0, VXM_ROTATION_NONE, {0, 0, 0}, NULL, 0, 0.0, VXM_DISPLACEMENT_UNIFORM, 0.0, 0, 0, 0.0, false, \
        VXM_VOXELIZE_OPTIONS_INIT                                                                            \
  }

/** Names a variant. Its voxels follow from this, the options and the mesh: on any machine, in any order. */
typedef struct vxm_variant {
  uint32_t model, epoch, index;
} vxm_variant;

/** How a variant lies in its grid, before its vertices are displaced. */
typedef struct vxm_pose {
  double transform[12]; /**< takes (x, y, z, 1) of the mesh to voxels: voxel (i,j,k) is i to i + 1, ... */
  double rotation[9];   /**< row after row */
  double scale[3];      /**< voxels per model unit along the model's axes; negative where it is mirrored */
  double shift[3];      /**< of the middle of its box from the middle of the grid, voxels */
} vxm_pose;

/**
 * Makes variants of meshes: Ogayar et al.'s direct connection, with an implicit dataset. Meshes are prepared
 * once; after the first few variants none takes memory, but what an engine takes. One sampler may be used by
 * one thread at a time, and works with all threads of its context.
 */
typedef struct vxm_sampler vxm_sampler;

/**
 * @param context NULL = a new one
 * @param options NULL = defaults: no augmentation
 * @return VXM_OK; VXM_ERROR_ARGUMENT, also if pad and displacement leave no room for a model; VXM_ERROR_RANGE
 *         beyond 1024 voxels along an axis; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_sampler_create(vxm_sampler **out, vxm_context *context,
                                      const vxm_sampler_options *options, vxm_error *error);
VXM_API void vxm_sampler_destroy(vxm_sampler *sampler);

/**
 * Puts a mesh in as model number `model`, in place of the one that had the number.
 *
 * @param mesh as for vxm_model_create; must outlive its use here. NULL takes the model out
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_EMPTY if no face has three different corners, or all vertices
 *         lie in one place; VXM_ERROR_RANGE for vertices that are not finite; VXM_ERROR_MEMORY,
 *         VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED. After a failure there is no model of this number
 */
VXM_API vxm_status vxm_sampler_put(vxm_sampler *sampler, uint32_t model, const vxm_mesh *mesh,
                                   vxm_error *error);

/** The space of all variants: a cube of side 1 at the origin. */
VXM_API vxm_space vxm_sampler_space(const vxm_sampler *sampler);
/** Bytes of one variant in memory; 0 if `voxels` is unknown. */
VXM_API size_t vxm_sampler_bytes(const vxm_sampler *sampler, vxm_voxels voxels);

/** Tells how a variant lies. @return VXM_OK, VXM_ERROR_ARGUMENT if there is no such model */
VXM_API vxm_status vxm_sampler_pose(vxm_pose *out, const vxm_sampler *sampler, const vxm_variant *variant,
                                    vxm_error *error);

/**
 * Makes one variant in a grid: all its bits are replaced.
 *
 * @param grid of the dimensions of vxm_sampler_space
 * @return VXM_OK; VXM_ERROR_ARGUMENT, also if there is no such model; VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED. After a failure the content of the grid is unspecified
 */
VXM_API vxm_status vxm_sampler_grid(vxm_grid *grid, vxm_sampler *sampler, const vxm_variant *variant,
                                    vxm_error *error);

/**
 * Makes many variants, of one model or of several, one after another in memory: each as [x][y][z] in C order.
 *
 * @param out  room for count * vxm_sampler_bytes bytes, aligned as floats are
 * @return as vxm_sampler_grid. After a failure the content of `out` is unspecified
 */
VXM_API vxm_status vxm_sampler_batch(void *out, vxm_sampler *sampler, const vxm_variant *variants,
                                     size_t count, vxm_voxels voxels, vxm_error *error);

/**
 * Makes many variants, and writes each into a file of its own.
 *
 * @param paths   one for each variant, all different; written as by vxm_grid_write
 * @param options NULL = defaults
 * @param[out] written NULL, or for each variant whether its file was written: after a failure some may be
 * @return as vxm_sampler_grid and vxm_grid_write
 */
VXM_API vxm_status vxm_sampler_files(const char *const *paths, vxm_sampler *sampler,
                                     const vxm_variant *variants, size_t count,
                                     const vxm_grid_write_options *options, bool *written, vxm_error *error);

/* ---- Sparse sets of voxels: memory follows the surface ---- */

/**
 * A set of voxels as a sparse octree over bricks of 4 x 4 x 4 voxels (Schwarz & Seidel 2010, section 5): only
 * bricks that are neither empty nor full are held. Equal sets in equal spaces have the same content.
 */
typedef struct vxm_sparse vxm_sparse;

/**
 * Voxelizes a model into an octree, straight from the triangles where its parts are closed, or closed by
 * caps (then an OpenCL engine makes it on its device); else, and for surfaces, by way of ranges of slices.
 * The voxels are those of vxm_model_voxelize.
 *
 * @param report    NULL = not wanted, which saves counting and hashing
 * @param space     the octree's
 * @param transform as for vxm_model_voxelize
 * @return as vxm_model_voxelize; VXM_ERROR_ARGUMENT too if the model's options ask for the confidence
 */
VXM_API vxm_status vxm_model_sparse(vxm_sparse **out, vxm_voxelize_report *report, vxm_model *model,
                                    const vxm_space *space, const double transform[12], vxm_error *error);
VXM_API void vxm_sparse_destroy(vxm_sparse *sparse);

VXM_API const vxm_space *vxm_sparse_space(const vxm_sparse *sparse);
/** Whether voxel (i,j,k) is set; false outside. */
VXM_API bool vxm_sparse_get(const vxm_sparse *sparse, int64_t i, int64_t j, int64_t k);
/** Number of set voxels. */
VXM_API int64_t vxm_sparse_count(const vxm_sparse *sparse);
/** vxm_grid_hash of the same voxels. */
VXM_API uint64_t vxm_sparse_hash(const vxm_sparse *sparse);
/** Bricks held, nodes of all levels, and the bytes they take. */
VXM_API int64_t vxm_sparse_bricks(const vxm_sparse *sparse);
VXM_API int64_t vxm_sparse_nodes(const vxm_sparse *sparse);
VXM_API uint64_t vxm_sparse_bytes(const vxm_sparse *sparse);

/** @return VXM_OK, VXM_ERROR_ARGUMENT, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
VXM_API vxm_status vxm_sparse_from_grid(vxm_sparse **out, const vxm_grid *grid, vxm_error *error);
/** A new grid. @return as vxm_grid_create */
VXM_API vxm_status vxm_sparse_to_grid(vxm_grid **out, const vxm_sparse *sparse, vxm_error *error);

typedef enum vxm_set_operation {
  VXM_SET_UNION = 0,
  VXM_SET_INTERSECTION,
  VXM_SET_DIFFERENCE, /**< what `a` has and `b` has not */
  VXM_SET_SYMMETRIC_DIFFERENCE,
  VXM_SET_COMPLEMENT /**< what `a` has not, within its box; `b` is NULL */
} vxm_set_operation;

/**
 * Makes a new set of two of equal dimensions; it takes the space of `a`.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT, also if the dimensions differ; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_sparse_combine(vxm_sparse **out, const vxm_sparse *a, const vxm_sparse *b,
                                      vxm_set_operation operation, vxm_error *error);

/** A cube of voxels that is full, or a brick of 4 x 4 x 4 that is not. */
typedef struct vxm_sparse_piece {
  int64_t at[3]; /**< its first voxel */
  int64_t side;  /**< voxels along it: 4 to the power of 1, 2, ... */
  uint64_t bits; /**< of a brick: voxel (x,y,z) of it is bit 16 z + 4 y + x; all set for a cube */
} vxm_sparse_piece;

typedef void (*vxm_sparse_fn)(const vxm_sparse_piece *piece, void *payload);

/** Calls for each piece, in Morton order. */
VXM_API void vxm_sparse_visit(const vxm_sparse *sparse, vxm_sparse_fn function, void *payload);

/** As vxm_grid_write, slice by slice, but for .vdb, whose tree is made of the octree's pieces; not as a mesh.
 */
VXM_API vxm_status vxm_sparse_write(const vxm_sparse *sparse, const char *path,
                                    const vxm_grid_write_options *options, vxm_error *error);

/**
 * Writes the coordinates of all set voxels as .npy: int32, n rows of (i, j, k), sorted by i, then j, then k,
 * as numpy.argwhere gives them for the .npy of the grid.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT if the extension is another; VXM_ERROR_IO, VXM_ERROR_MEMORY,
 *         VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_sparse_write_coords(const vxm_sparse *sparse, const char *path, vxm_error *error);
VXM_API vxm_status vxm_grid_write_coords(const vxm_grid *grid, const char *path, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
