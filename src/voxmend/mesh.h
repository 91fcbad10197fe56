/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file voxmend/mesh.h
 * Meshes: made from arrays, read, written, and what is wrong with them.
 */
#ifndef VOXMEND_MESH_H
#define VOXMEND_MESH_H

#include "voxmend/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Meshes ---- */

/** Vertices and polygons, with nothing assumed of them: a polygon soup, or a mesh after repair. */
typedef struct vxm_mesh vxm_mesh;

/** Caller-owned arrays that describe a mesh; they are copied. */
typedef struct vxm_mesh_arrays {
  size_t size;               /**< as the initializer sets it */
  vxm_scalar vertex_scalar;  /**< type of the coordinates: VXM_FLOAT64 or VXM_FLOAT32 */
  vxm_scalar index_scalar;   /**< type of the indices: VXM_INT64, VXM_UINT32 or VXM_INT32 */
  const void *vertices;      /**< vertex_count x 3 coordinates, x y z together, model units */
  int64_t vertex_count;      /**< 0 = none */
  const int64_t *offsets;    /**< face_count + 1 of them: face f has the corners indices[offsets[f]] to
                                indices[offsets[f+1]-1], the last is index_count; NULL = triangles */
  const void *indices;       /**< index_count 0-based vertices of the corners */
  int64_t index_count;       /**< of triangles 3 * face_count */
  int64_t face_count;        /**< 0 = none */
  const char *const *tags;   /**< tag_count names, as vxm_mesh_tag_name gives them */
  const uint32_t *face_tags; /**< face_count tag numbers; not looked at without tags */
  int64_t tag_count;         /**< 0 = faces have no tags */
} vxm_mesh_arrays;

/** Initial value of vxm_mesh_arrays. */
#define VXM_MESH_ARRAYS_INIT \
  { sizeof(vxm_mesh_arrays), VXM_FLOAT64, VXM_INT64, NULL, 0, NULL, NULL, 0, 0, NULL, NULL, 0 }

/**
 * Makes a mesh from arrays.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT if counts and offsets do not agree, or with `element` the face whose
 * offsets run backwards, that has fewer than three corners, or that names a vertex or tag that does not
 * exist; VXM_ERROR_RANGE beyond 2^32 - 2 vertices; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
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

/** As vxm_mesh_read, from memory. `name` is used in messages and for its extension.
 * @return as vxm_mesh_read */
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

/** How a mesh file is read. */
typedef struct vxm_mesh_read_options {
  size_t size;        /**< as the initializer sets it */
  const char *format; /**< as vxm_mesh_format says, such as "off" or "step", or an extension, such as "glb";
                         NULL = by content, then name */
  double deflection;  /**< STEP and IGES: how far triangles may lie from a curved surface, as a part of the
                         model's diagonal, at most 1; 0 = 0.001 */
  vxm_external external; /**< files that the mesh refers to */
  bool colors; /**< keep colours, materials and textures too, for VXM_COLOR_MESH and vxm_mesh_look */
} vxm_mesh_read_options;

/** Initial value of vxm_mesh_read_options. */
#define VXM_MESH_READ_OPTIONS_INIT \
  { sizeof(vxm_mesh_read_options), NULL, 0.0, VXM_EXTERNAL_FOLDER, false }

/** As vxm_mesh_read, with options. @return also VXM_ERROR_ARGUMENT for options out of range */
VXM_API vxm_status vxm_mesh_read_with(vxm_mesh **out, vxm_context *context, const char *path,
                                      const vxm_mesh_read_options *options, vxm_error *error);
/** As vxm_mesh_read_memory, with options. @return also VXM_ERROR_ARGUMENT for options out of range */
VXM_API vxm_status vxm_mesh_read_memory_with(vxm_mesh **out, vxm_context *context, const void *data,
                                             size_t size, const char *name,
                                             const vxm_mesh_read_options *options, vxm_error *error);

/** The appearance of a mesh that was read with its colours: which colours, materials and textures it has. */
typedef struct vxm_look {
  size_t size;        /**< as the initializer sets it, or 0 */
  bool has_colors;    /**< any of what follows is there, textures that cannot be read left out */
  bool vertex_colors; /**< vertices have colours */
  bool face_colors;   /**< faces have */
  int64_t materials;  /**< colours and textures of faces */
  int64_t textures;   /**< pictures that materials name, those that cannot be read among them */
} vxm_look;

/** Initial value of vxm_look. */
#define VXM_LOOK_INIT \
  { sizeof(vxm_look), false, false, false, 0, 0 }

/** A picture that the materials of a mesh name. */
typedef struct vxm_texture {
  size_t size;         /**< as the initializer sets it, or 0 */
  const char *name;    /**< as the mesh says; lives as long as the mesh */
  int64_t width;       /**< pixels; 0 if it cannot be read */
  int64_t height;      /**< also */
  const char *failure; /**< why it cannot be read; "" if it can */
} vxm_texture;

/** Initial value of vxm_texture. */
#define VXM_TEXTURE_INIT \
  { sizeof(vxm_texture), NULL, 0, 0, NULL }

/** Tells the appearance of a mesh; nothing if it was read without `colors`, or is the result of a repair.
 * @return VXM_OK, VXM_ERROR_ARGUMENT */
VXM_API vxm_status vxm_mesh_look(vxm_look *out, const vxm_mesh *mesh, vxm_error *error);
/** Tells of one of its textures, from 0 on; of one that is not there, that it is not. @return VXM_OK,
 * VXM_ERROR_ARGUMENT */
VXM_API vxm_status vxm_mesh_texture(vxm_texture *out, const vxm_mesh *mesh, int64_t index, vxm_error *error);

/** How meshes are read that are left to foreign libraries, each file in a process of its own. */
typedef struct vxm_reading_info {
  size_t size;                /**< as the initializer sets it, or 0 */
  bool assimp;                /**< whether the module for Assimp is installed */
  bool occt;                  /**< whether the module for OpenCASCADE is */
  const char *assimp_formats; /**< the extensions of what they are given, such as "gltf glb" */
  const char *occt_formats;   /**< of the other */
  bool filter;  /**< the process may make no system calls but those that computing takes (libseccomp) */
  int landlock; /**< version of Landlock in this kernel, by which the process has no files; 0 = none */
} vxm_reading_info;

/** Initial value of vxm_reading_info. */
#define VXM_READING_INFO_INIT \
  { sizeof(vxm_reading_info), false, false, NULL, NULL, false, 0 }

/** Tells which modules are there to read them, and what their process may do. @return VXM_OK,
 * VXM_ERROR_ARGUMENT */
VXM_API vxm_status vxm_reading_find(vxm_reading_info *out, vxm_error *error);

/** How a mesh file is written. */
typedef struct vxm_mesh_write_options {
  size_t size;        /**< as the initializer sets it */
  const char *format; /**< "off", "obj", "stl" or "ply"; NULL = by the extension of the path */
  bool ascii;         /**< stl and ply as text rather than binary; off and obj are text anyway */
  bool keep_polygons; /**< off, obj and ply with polygons as they are, rather than as triangles */
} vxm_mesh_write_options;

/** Initial value of vxm_mesh_write_options. */
#define VXM_MESH_WRITE_OPTIONS_INIT \
  { sizeof(vxm_mesh_write_options), NULL, false, false }

/**
 * Writes a mesh, under a temporary name first, so that no half-written file is left. "-" writes standard
 * output. Coordinates come back bit for bit from OFF, OBJ and PLY; STL holds 32-bit floats. Polygons become
 * the triangles that voxelizing takes them for, as many programs read nothing else; faces of fewer than three
 * corners are left out.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT for an unknown format; VXM_ERROR_IO; VXM_ERROR_RANGE if the format
 * cannot hold the mesh; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_mesh_write(const vxm_mesh *mesh, const char *path,
                                  const vxm_mesh_write_options *options, vxm_error *error);
/** Drops it; NULL is allowed. */
VXM_API void vxm_mesh_destroy(vxm_mesh *mesh);

/**
 * Makes a mesh of the triangles that voxelizing takes polygons for, and vxm_mesh_write writes: n - 2 of a
 * face with n corners, in its place, with its tag; none of fewer than three corners. Vertices are as they
 * were.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_mesh_triangulate(vxm_mesh **out, const vxm_mesh *mesh, vxm_error *error);

/** Number of vertices. */
VXM_API int64_t vxm_mesh_vertex_count(const vxm_mesh *mesh);
/** Number of faces. */
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
/** One of them; "" if there is none of this number. */
VXM_API const char *vxm_mesh_warning(const vxm_mesh *mesh, int64_t index);
/** Other files that were opened to read it: buffers of a glTF, and with `colors` .mtl files and textures. 0
 * of a mesh that another was made into. */
VXM_API int64_t vxm_mesh_companion_count(const vxm_mesh *mesh);
/** The name of one as the mesh has it, relative to its folder but for a '/' in front; "" if there is none of
 * this number. */
VXM_API const char *vxm_mesh_companion(const vxm_mesh *mesh, int64_t index);

/* ---- Census: what is wrong with a mesh ---- */

/** Counts over a mesh. Edges, components and duplicates are taken after welding bit-identical positions.
 * Faces of vertices that are not finite have no edges, as repair removes them: a mesh is not closed by them.
 */
typedef struct vxm_census {
  size_t size;             /**< as the initializer sets it, or 0 */
  int64_t vertices;        /**< as in the file */
  int64_t faces;           /**< as in the file */
  int64_t triangles;       /**< after splitting polygons: the sum of corners - 2 */
  int64_t components;      /**< connected by welded vertices; faces only */
  int64_t components_raw;  /**< connected by vertex index as in the file */
  int64_t duplicate_faces; /**< faces that repeat an earlier one with the same orientation */
  int64_t
      opposite_duplicate_faces; /**< faces that repeat an earlier one with the opposite orientation only */
  int64_t degenerate_faces;     /**< of finite ones: fewer than three distinct corners, or no area */
  int64_t boundary_edges;       /**< one incident face */
  int64_t nonmanifold_edges;    /**< more than two incident faces */
  int64_t inconsistent_edges;   /**< two incident faces that run along it in the same direction */
  int64_t nonfinite_vertices;   /**< with a coordinate that is not a finite number */
  int64_t unused_vertices;      /**< of no face */
  int64_t largest_face;         /**< corners of the largest face */
  bool watertight;              /**< some edges, and none of them open or non-manifold */
  bool closed;                  /**< some edges, and each has an even number of incident faces */
  double bounds[6]; /**< x0 y0 z0 x1 y1 z1 of the finite vertices used by faces; zeros if there are none */
  double area;      /**< model units squared; polygons by their vector area */
  double volume;    /**< signed; positive if faces point outward. Meaningful if closed. This and the area are
                       infinite where they are beyond the range of numbers */
} vxm_census;

/** Initial value of vxm_census. */
#define VXM_CENSUS_INIT \
  { sizeof(vxm_census), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, false, false, {0, 0, 0, 0, 0, 0}, 0.0, 0.0 }

/** Counts what a mesh has, and what is wrong with it. @return VXM_OK, VXM_ERROR_ARGUMENT, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED */
VXM_API vxm_status vxm_mesh_census(vxm_census *out, const vxm_mesh *mesh, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
