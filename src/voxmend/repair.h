/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file voxmend/repair.h
 * Repair of meshes, the levels that it reaches, and what stands in the way of them.
 */
#ifndef VOXMEND_REPAIR_H
#define VOXMEND_REPAIR_H

#include "voxmend/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Repair ---- */

/** Which vertices are welded. */
typedef enum vxm_weld {
  VXM_WELD_AUTO = 0, /**< bit-identical positions, then near ones where that closes cracks */
  VXM_WELD_OFF,      /**< bit-identical positions only */
  VXM_WELD_TOLERANCE /**< bit-identical positions, then all that are no farther apart than weld_tolerance:
                        groups that lie within it go to their first vertex; of chains and crowds that are
                        wider, each that is near to none before it stays, in their order, and the others go to
                        the nearest of these. No two that stay are within it of each other */
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
typedef enum vxm_hole_fill {
  VXM_HOLE_FILL_FAN = 0, /**< triangles from a new vertex in the middle of the rim */
  VXM_HOLE_FILL_MINIMAL, /**< the triangulation of the rim with the least area; needs the module for OpenMesh
                          */
  VXM_HOLE_FILL_SMOOTH /**< triangles as small as those about the rim, which continue its curvature; needs the
                          module for CGAL */
} vxm_hole_fill;

/** What becomes of open sheets: components of which closing would fill holes that cover three quarters of
 * their area or more, and others that could not be closed. */
typedef enum vxm_sheets {
  VXM_SHEETS_THICKEN = 0, /**< plates, from VXM_LEVEL_CLOSED on; below that they stay as they are */
  VXM_SHEETS_KEEP,        /**< they stay open, and VXM_LEVEL_CLOSED is not reached */
  VXM_SHEETS_DROP         /**< they go, from VXM_LEVEL_CLOSED on */
} vxm_sheets;

/** What a repair does. */
typedef struct vxm_repair_options {
  size_t size;           /**< as the initializer sets it */
  vxm_weld weld;         /**< which vertices are welded */
  double weld_tolerance; /**< model units, with VXM_WELD_TOLERANCE */
  bool keep_duplicates;  /**< leave repeated faces in */
  bool keep_orientation; /**< leave faces turned as they are; not with a level above VXM_LEVEL_CLEAN */
  vxm_level level;       /**< how far it goes */
  int64_t fill_holes; /**< fill holes with at most so many edges; 0 = none, and from VXM_LEVEL_CLOSED on all;
                         negative = all */
  vxm_hole_fill hole_fill; /**< with what */
  bool boolean_union;      /**< unite closed parts that cut through each other, as VXM_LEVEL_SOLID does */
  double wrap_alpha;  /**< put a closed surface around everything instead: the size of the smallest hole that
                         it goes into, as a fraction of the diagonal of the bounds; 0 = do not. Excludes
                         keep_duplicates, keep_orientation, fill_holes, hole_fill, boolean_union, max_change */
  double wrap_offset; /**< its distance from the mesh, in the same way; 0 = a thirtieth of wrap_alpha */
  bool single_precision; /**< keep to positions that 32-bit floats hold, as .stl files do */
  bool part_changes;     /**< keep account of every part: vxm_mesh_part_change */
  double max_change; /**< fail where the volume of a closed part, or the bounds of one, change by more than
                        this fraction (of its volume, of its diagonal); 0 = do not look */
  int64_t
      drop_faces; /**< drop components with fewer faces than this, triangles if they are split; 0 = none */
  double drop_volume;    /**< drop closed components with less volume than this, model units cubed; 0 = none.
                            The component with the largest area always stays, and cavities stay as long as what
                            they are in does */
  bool intersections;    /**< count self-intersections, before and after, in the report and in the account of
                            parts; needs the module for CGAL */
  double fallback_alpha; /**< wrap those parts alone that cannot be united: as wrap_alpha, of their own
                            bounds; 0 = leave them */
  vxm_sheets sheets;     /**< what becomes of open sheets, from VXM_LEVEL_CLOSED on */
  double
      thickness;  /**< of the plates that sheets become, model units, half of it to each side; 0 = 0.002 of
                     the diagonal of the bounds. More than that diagonal is refused where there are sheets */
  bool triangles; /**< split polygons before anything else happens to them, so that the levels hold of the
                     triangles that vxm_mesh_write makes of them; single_precision does that too */
} vxm_repair_options;

/** Initial value of vxm_repair_options. */
#define VXM_REPAIR_OPTIONS_INIT                                                                          \
  {                                                                                                      \
    sizeof(vxm_repair_options), VXM_WELD_AUTO, 0.0, false, false, VXM_LEVEL_CLEAN, 0, VXM_HOLE_FILL_FAN, \
        false, 0.0, 0.0, false, false, 0.0, 0, 0.0, false, 0.0, VXM_SHEETS_THICKEN, 0.0, false           \
  }

/** Room for passes in a report. */
#define VXM_REPAIR_PASSES_MAX 24

/** Self-intersections are counted up to this number, which then means that there are at least so many. */
#define VXM_SELF_INTERSECTIONS_MAX 4194304

/** What a repair has done. */
typedef struct vxm_repair_report {
  size_t size;    /**< as the initializer sets it, or 0 */
  int pass_count; /**< passes that are listed */
  struct {
    const char *pass;              /**< fixed name such as "exact_weld" */
    int64_t count;                 /**< vertices or faces that the pass removed, changed or added */
  } passes[VXM_REPAIR_PASSES_MAX]; /**< in the order of the work */
  int64_t nonorientable_patches;   /**< faces joined by edges that cannot all be turned consistently */
  int64_t open_parts;     /**< components whose holes were left open: sheets that their closing would cover */
  int64_t filled_holes;   /**< holes that were filled */
  int64_t unfilled_holes; /**< that were to be filled and could not be */
  int64_t fan_fallbacks;  /**< that VXM_HOLE_FILL_MINIMAL or VXM_HOLE_FILL_SMOOTH left to fans */
  int64_t union_failures; /**< that were to be united and still cut through themselves or others: open ones,
                             which have no inside, and those where the union failed */
  int64_t union_tries; /**< how often parts were united at VXM_LEVEL_SOLID; above 1 slivers were in the way */
  int64_t wrapped_parts;             /**< that could not be united, and were wrapped (fallback_alpha) */
  int64_t self_intersections_before; /**< pairs of faces, counted up to VXM_SELF_INTERSECTIONS_MAX; -1 = not
                                        looked for */
  int64_t self_intersections_after;  /**< in the same way */
  int64_t
      unparted_vertices; /**< that share a position, or would after rounding to 1e-8, and could not be moved
                            apart: the numbers that hold positions are too coarse for the faces there */
  int64_t shared_faces;  /**< at level clean: that repeat others and stay, as bodies overlap there and both
                            need theirs; from manifold on each body has its own */
  int64_t lost_parts;   /**< closed components of which something that they enclosed, by winding or by parity,
                           is enclosed no more and could not be kept; what levels and options beyond
                           VXM_LEVEL_CLEAN take away is not looked at */
  int64_t sheets;       /**< open components that became plates, or were dropped (vxm_sheets) */
  int64_t opened_parts; /**< closed before, open after; with options.part_changes, else 0 */
  double max_displacement; /**< no vertex was moved farther, model units; not by a wrap or union. With
                           options.part_changes, else 0 */
  vxm_census *before;      /**< set by the caller: NULL, or where the census of the mesh that is given goes */
  vxm_census *after; /**< set by the caller: NULL, or where that of the result goes; each takes some time */
  int64_t emptied_parts; /**< closed components that lost more than a hundredth of their inside to a union,
                            such as some that lie in a cavity */
} vxm_repair_report;

/** Initial value of vxm_repair_report. */
#define VXM_REPAIR_REPORT_INIT                                                                               \
  {                                                                                                          \
    sizeof(vxm_repair_report), 0, {{NULL, 0}}, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.0, NULL, NULL, \
        0                                                                                                    \
  }

/**
 * Repairs a mesh into a new one: removes non-finite vertices with their faces, welds, removes repeated
 * corners, faces without area and repeated faces (a face and its reverse become one), and unused vertices;
 * turns faces consistently, outward where they enclose something; then goes as far as the level and the other
 * options say. Applying it to its own result changes nothing. Vertices keep their order and the position of
 * the first one welded; only where a soup was torn apart everywhere do they move, to the middle of the copies
 * joined, and where a vertex had to become several, or lies within 1e-8 of another: these are moved apart, by
 * some 1e-7 of the diagonal but at least 5e-8 model units, so that programs that merge vertices leave them
 * be.
 *
 * @param[out] report may be NULL
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
 * VXM_LEVEL_MANIFOLD. Walls of one sheet that divide a body into chambers are left out. With keep_orientation
 * they stay, and bodies stay together. It is what voxmend voxelize and the Python
 * package do. What vxm_mesh_divide took apart is repaired one by one, and no account of parts is kept of it.
 *
 * @return as vxm_mesh_repair
 */
VXM_API vxm_status vxm_mesh_prepare(vxm_mesh **out, vxm_repair_report *report, const vxm_mesh *mesh,
                                    const vxm_repair_options *options, vxm_error *error);

/**
 * As vxm_mesh_prepare, with the result in the place of the mesh: a large one does not lie in memory beside
 * what becomes of it.
 *
 * @param[in,out] mesh what it points to is destroyed, also after a failure; then it points to NULL
 * @return as vxm_mesh_repair
 */
VXM_API vxm_status vxm_mesh_prepare_in_place(vxm_mesh **mesh, vxm_repair_report *report,
                                             const vxm_repair_options *options, vxm_error *error);

/** A part of a mesh, at one time. Edges and holes are taken after welding. */
typedef struct vxm_part_state {
  size_t size;                /**< bytes that there are of it */
  int64_t faces;              /**< of the part */
  int64_t boundary_edges;     /**< as in vxm_census */
  int64_t nonmanifold_edges;  /**< as in vxm_census */
  int64_t inconsistent_edges; /**< as in vxm_census */
  int64_t holes;              /**< closed walks along edges with an odd number of faces */
  int64_t self_intersections; /**< pairs of its faces, or of one of them and another part's, that cut through
                                 each other; -1 = not looked for (vxm_repair_options.intersections) */
  bool closed;                /**< it has faces, and every edge has an even number of them */
  double area;                /**< as in vxm_census */
  double volume;              /**< as in vxm_census */
  double bounds[6];           /**< as in vxm_census */
} vxm_part_state;

/** What a repair did to a connected component of the mesh that it was given. */
typedef struct vxm_part_change {
  size_t size;                  /**< bytes that there are of it */
  const vxm_part_state *before; /**< of the mesh that was given */
  const vxm_part_state *after;  /**< of all faces that come from this part; none after a wrap */
  int64_t flipped;              /**< faces that were turned */
  double max_displacement;      /**< none of its vertices was moved farther, model units */
  uint32_t tag;                 /**< of its first face; UINT32_MAX if there are no tags */
  bool union_failed;            /**< it counts among vxm_repair_report.union_failures */
} vxm_part_change;

/** Number of connected components (after welding) of the mesh that was repaired; 0 without
 * options.part_changes. */
VXM_API int64_t vxm_mesh_part_change_count(const vxm_mesh *repaired);
/** What became of one, in the order of their first faces; NULL if there is none of this number. */
VXM_API const vxm_part_change *vxm_mesh_part_change(const vxm_mesh *repaired, int64_t index);

/* ---- What a mesh guarantees, and what is wrong where ---- */

/** Room for findings in a verification. */
#define VXM_FINDINGS_MAX 24

/** Whether a mesh is at a level, and what is in the way. */
typedef struct vxm_verification {
  size_t size;  /**< as the initializer sets it, or 0 */
  bool reached; /**< nothing is in the way */
  int count;    /**< findings that are listed */
  struct {
    const char *what; /**< fixed name such as "boundary_edges" or a pass that would still change something */
    int64_t count;
    int64_t element; /**< the first one: a vertex, or for faces and edges a face, with its number in the mesh
                        that is verified, which is that of the file; -1 = none to tell */
    bool placed;     /**< whether `position` is known */
    double position[3];         /**< where that is, model units */
  } findings[VXM_FINDINGS_MAX]; /**< what is in the way */
} vxm_verification;

/** Initial value of vxm_verification. */
#define VXM_VERIFICATION_INIT             \
  {                                       \
    sizeof(vxm_verification), false, 0, { \
      {                                   \
        NULL, 0, 0, false, {              \
          0, 0, 0                         \
        }                                 \
      }                                   \
    }                                     \
  }

/**
 * Checks what a level guarantees, after welding identical positions; and from VXM_LEVEL_MANIFOLD on that no
 * vertices are one to programs that round positions to 1e-8 (in a mesh with a diagonal of 1e-3 at least).
 *
 * @param options those of the repair: `level`, and what is to be kept; NULL = defaults
 * @return VXM_OK whether or not it is reached; VXM_ERROR_ARGUMENT; VXM_ERROR_UNAVAILABLE if VXM_LEVEL_SOLID
 * is asked for without the module for CGAL; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_mesh_verify(vxm_verification *out, const vxm_mesh *mesh,
                                   const vxm_repair_options *options, vxm_error *error);

/**
 * Writes a mesh as vxm_mesh_write, reads back what was written and verifies it. Where the level is not
 * reached nothing is left behind, unless `best_effort` is set. Polygons are written as triangles, unless
 * write->keep_polygons is set: repair with vxm_repair_options.triangles, so that the level holds of those.
 *
 * @param[out] out  filled if the file could be written and read
 * @return as vxm_mesh_write and vxm_mesh_verify; VXM_ERROR_UNREACHED
 */
VXM_API vxm_status vxm_mesh_write_verified(vxm_verification *out, const vxm_mesh *mesh, const char *path,
                                           const vxm_mesh_write_options *write,
                                           const vxm_repair_options *repair, bool best_effort,
                                           vxm_error *error);

/** What is wrong with a vertex, edge or face. */
typedef enum vxm_defect_kind {
  VXM_DEFECT_NONFINITE_VERTEX = 0, /**< with a coordinate that is not a finite number */
  VXM_DEFECT_DEGENERATE_FACE,      /**< of finite ones: fewer than three distinct corners, or no area */
  VXM_DEFECT_DUPLICATE_FACE,       /**< repeats another one, with either orientation */
  VXM_DEFECT_BOUNDARY_EDGE,        /**< of one face */
  VXM_DEFECT_NONMANIFOLD_EDGE,     /**< of more than two faces */
  VXM_DEFECT_INCONSISTENT_EDGE,    /**< of two faces that run along it in the same direction */
  VXM_DEFECT_NONMANIFOLD_VERTEX,   /**< its faces form more than one fan, though none of its edges is at fault
                                    */
  VXM_DEFECT_SELF_INTERSECTION,    /**< two faces that cut through each other */
  VXM_DEFECT_KINDS                 /**< how many kinds there are */
} vxm_defect_kind;

/** Something that is wrong with a mesh, and where. */
typedef struct vxm_defect {
  size_t size;          /**< bytes that there are of it */
  vxm_defect_kind kind; /**< what it is */
  int64_t element[2]; /**< a vertex or face, and -1; of an edge its vertices; of an intersection the faces */
  double position[6]; /**< the vertex, or the middle of the face, twice; the ends of the edge; the middles of
                   both faces */
} vxm_defect;

/** The defects of a mesh, ordered by kind, then by element. */
typedef struct vxm_defects vxm_defects;

/**
 * Finds what is wrong with a mesh, after welding identical positions.
 *
 * @param max_count     of each kind to list; 0 = all
 * @param intersections look for self-intersections too, which needs the module for CGAL
 * @return VXM_OK, VXM_ERROR_ARGUMENT, VXM_ERROR_UNAVAILABLE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 * VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_mesh_defects(vxm_defects **out, const vxm_mesh *mesh, int64_t max_count,
                                    bool intersections, vxm_error *error);
/** Drops it; NULL is allowed. */
VXM_API void vxm_defects_destroy(vxm_defects *defects);
/** How many are listed. */
VXM_API int64_t vxm_defects_count(const vxm_defects *defects);
/** One of those that are listed; NULL if there is none of this number. */
VXM_API const vxm_defect *vxm_defects_item(const vxm_defects *defects, int64_t index);
/** How many of a kind there are, listed or not; self-intersections are counted up to
 * VXM_SELF_INTERSECTIONS_MAX, -1 = not looked for. */
VXM_API int64_t vxm_defects_total(const vxm_defects *defects, vxm_defect_kind kind);
/** Fixed name of a kind, such as "boundary_edge". */
VXM_API const char *vxm_defect_name(vxm_defect_kind kind);
/**
 * Writes the mesh as .ply, in text and triangles, with its defects in colour: faces at fault, and edges and
 * vertices as rods a thousandth of the diagonal thick, of eight triangles each after those of the faces; the
 * rest is grey. @return as vxm_mesh_write
 */
VXM_API vxm_status vxm_defects_write(const vxm_defects *defects, const vxm_mesh *mesh, const char *path,
                                     vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
