/* SPDX-License-Identifier: BSD-3-Clause */
/** What the passes of a repair work on, and what they share. */
#ifndef VXM_REPAIR_STATE_REPAIR_STATE_H
#define VXM_REPAIR_STATE_REPAIR_STATE_H

#include "mesh/patches.h"
#include "mesh/surface_sums.h"
#include "mesh/unit_scale.h"
#include "repair/state/lost_parts.h"
#include "repair/state/merge_rule.h"
#include "repair/state/provenance.h"

/**
 * Of the diagonal of the bounds. A crack is two runs of boundary edges with vertices that should be the same
 * and are not, mostly because coordinates were rounded on the way, to a float or to the six digits of "%g":
 * by some 1e-6 of the model's size. On real meshes nearly all that can be closed up to 1e-5 is closed from
 * 1e-7 on; beyond, sheets begin to merge that are meant to be two.
 */
#define VXM_CRACK_WIDTH 5e-6

typedef enum vxm_pass {
  VXM_PASS_ROUNDING = 0,
  VXM_PASS_NONFINITE,
  VXM_PASS_EXACT_WELD,
  VXM_PASS_TOLERANT_WELD,
  VXM_PASS_REPEATED_CORNERS,
  VXM_PASS_DEGENERATE_FACES,
  VXM_PASS_T_JUNCTIONS,
  VXM_PASS_DUPLICATES,
  VXM_PASS_OPPOSITE_DUPLICATES,
  VXM_PASS_INNER_WALLS,
  VXM_PASS_ORIENTATION,
  VXM_PASS_WRAP,
  VXM_PASS_CUT_NONMANIFOLD,
  VXM_PASS_CLOSING,
  VXM_PASS_SMALL_COMPONENTS,
  VXM_PASS_SHEETS,
  VXM_PASS_UNION,
  VXM_PASS_PERTURB_COINCIDENT,
  VXM_PASS_UNUSED,
  VXM_PASS_COUNT
} vxm_pass;

/** What a pass would change, or has changed. */
typedef struct vxm_pass_finding {
  const char *pass;
  int64_t count;
  int64_t element; /**< of the first one: the number that a vertex or face came in with; -1 = not known */
  bool placed;     /**< `at` is set */
  double at[3];    /**< where the first one is */
} vxm_pass_finding;

/** What has become of a face. */
enum vxm_turned {
  VXM_TURNED = 1, /**< it runs the other way than when it came in */
  VXM_ADDED = 2   /**< it did not come in */
};

/** How a level that unites parts is tried. */
typedef struct vxm_union_try {
  int bits;          /**< of the lattice that vertices are moved to before; 0 = none */
  bool collapses;    /**< the shortest edges of unions are collapsed */
  bool doubles_only; /**< vertices are not to differ as 32-bit floats: that would have faces meet */
  bool outward_only; /**< unions leave out what parts wind round the other way */
} vxm_union_try;

/** A soup under repair. Vertices keep their numbers until the last pass removes those that are not used. */
typedef struct vxm_repair_state {
  vxm_soup *soup;
  vxm_context *context;
  vxm_repair_options options;
  bool divides;    /**< bodies that share faces, edges or vertices each get their own in the end */
  uint8_t *gone;   /**< vertex_count; 1 = removed or merged by a pass that counted it */
  uint8_t *used;   /**< vertex_count; as the last vxm_repair_state_extent has found */
  uint8_t *turned; /**< face_count, or NULL as long as no face was turned: see vxm_turned */
  bool has_counts, has_edges, has_patches, has_extent, has_sums;
  bool is_manifold;      /**< the present faces are known to be (vxm_is_manifold) */
  vxm_edges edges;       /**< of the present faces, if has_edges; if only has_counts, their numbers */
  vxm_patches patches;   /**< of the present faces, if has_patches */
  vxm_extent extent;     /**< of the present soup, if has_extent */
  vxm_surface_sums sums; /**< of the present soup, if has_sums */
  int64_t counts[VXM_PASS_COUNT];
  vxm_pass_finding firsts[VXM_PASS_COUNT]; /**< of which `element`, `placed` and `at` are kept */
  bool renumbered;                         /**< faces have other numbers than they came in with */
  int64_t nonorientable_patches;           /**< in the last pass of orientation */
  bool has_held_patches;                   /**< it met patches that hold each other (vxm_held_patches_find) */
  int64_t shared_faces;                    /**< repeated faces that the last pass of duplicates left */
  int64_t open_parts;                      /**< that the last pass of closing left open */
  int64_t sheets;                          /**< open components that became plates, or went */
  int64_t filled_holes;                    /**< holes that were filled */
  int64_t unfilled_holes;                  /**< holes that were to be filled and could not be */
  int64_t fan_fallbacks;                   /**< holes that were not a module's, but filled by fans */
  int64_t union_failures; /**< parts that were to be united and still cut through themselves or others */
  bool union_may_succeed; /**< some of those have an inside, so that another try may unite them */
  int64_t emptied_parts;  /**< closed parts of whose inside unions have taken something away */
  int64_t union_tries;    /**< how often parts were united */
  int64_t wrapped_parts;  /**< parts that were wrapped as the union had left them */
  vxm_union_try union_try;
  int64_t self_intersections[2]; /**< before and after, or -1 */
  int64_t unparted_vertices;     /**< vertices that were to be moved apart and could not be */
  vxm_provenance *provenance;    /**< what becomes of the parts, or NULL */
  vxm_lost_parts lost;    /**< parts that a first run would have lost; while soup->face_parts tells a face's
                             part, no kind of repeated face of theirs goes altogether */
  bool guards_lost_parts; /**< this run is to keep those */
  int64_t lost_parts;     /**< that are lost for all that */
} vxm_repair_state;

/** Runs a pass, adds to the counts and says whether it changed anything. */
typedef vxm_status (*vxm_pass_fn)(vxm_repair_state *state, bool *changed, vxm_error *error);

vxm_status vxm_pass_rounding(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_nonfinite(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_exact_weld(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_tolerant_weld(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_t_junctions(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_repeated_corners(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_degenerate_faces(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_duplicates(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_orientation(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_wrap(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_cut_nonmanifold(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_meeting_holes(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_closing(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_small_components(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_sheets(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_union(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_fallback(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_short_edges(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_reunion(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_perturb_coincident(vxm_repair_state *state, bool *changed, vxm_error *error);
vxm_status vxm_pass_unused(vxm_repair_state *state, bool *changed, vxm_error *error);

/** A block of scratch, zeroed; on failure NULL, with *status and *error set. */
void *vxm_repair_state_scratch(vxm_repair_state *state, size_t count, size_t size, vxm_status *status,
                               vxm_error *error);
/** The edge map of the present faces, with their sides, built if need be. */
vxm_status vxm_repair_state_edges(vxm_repair_state *state, vxm_error *error);
/** How many edges there are of each kind, counted if need be: less than a map where all is closed, else just
 * that (vxm_edges_build_pairs). */
vxm_status vxm_repair_state_count_edges(vxm_repair_state *state, vxm_error *error);
/** The patches of the present faces, built if need be; there are none (count = 0) where an edge has more than
 * two sides. */
vxm_status vxm_repair_state_patches(vxm_repair_state *state, vxm_error *error);
/** Which vertices are used (state->used), and the bounds of these, looked at if need be. */
void vxm_repair_state_extent(vxm_repair_state *state, vxm_extent *extent);
/** Areas and volume of the present soup (state->sums), looked at if need be or `flat` is not NULL, as for
 * vxm_surface_sums_of. */
vxm_status vxm_repair_state_measure(vxm_repair_state *state, uint8_t *flat, vxm_error *error);
/** Puts map[v] in the place of each corner v; vertices that lose their place are marked gone. Returns how
 * many were not gone before. */
int64_t vxm_repair_state_merge(vxm_repair_state *state, const uint32_t *map);
/** Moves what is known of a face, beside its corners, to the number `to`, which is not above `from`. */
void vxm_repair_state_renumber(vxm_repair_state *state, size_t from, size_t to);
/** Takes out the faces marked in `remove` (face_count elements), keeping the order of the others. Returns how
 * many. */
int64_t vxm_repair_state_remove_faces(vxm_repair_state *state, const uint8_t *remove);
/**
 * Takes a soup that a module has made in the place of the present one, and frees both it and `origin`.
 *
 * @param origin face that each face of `soup` is (a piece of), or VXM_NO_FACE; NULL = none is
 */
vxm_status vxm_repair_state_adopt(vxm_repair_state *state, vxm_soup *soup, uint64_t *origin,
                                  vxm_error *error);
/** Faces from `first` on did not come in, though they come from some that did. */
void vxm_repair_state_mark_added(vxm_repair_state *state, size_t first);
/** Makes room for the marks of `to` vertices, of which those from `from` on are new. */
bool vxm_repair_state_grow_marks(vxm_repair_state *state, size_t from, size_t to, vxm_error *error);
/** Makes the marks of vertices anew, after the soup was exchanged. */
vxm_status vxm_repair_state_renew(vxm_repair_state *state, vxm_error *error);
/** What a position becomes where positions are to be held by 32-bit floats, else itself. */
static inline double vxm_repair_state_round(const vxm_repair_state *state, double x) {
  return state->options.single_precision ? vxm_single(x) : x;
}
/** Whether the level asks for this much. */
static inline bool vxm_repair_state_reaches(const vxm_repair_state *state, vxm_level level) {
  return state->options.level >= level;
}
/** Whether a face is of a part that a first run would have lost. */
static inline bool vxm_repair_state_guards(const vxm_repair_state *state, size_t face) {
  return state->guards_lost_parts && state->soup->face_parts &&
         state->lost.lost[state->soup->face_parts[face]];
}
/** Says that a pass changes a vertex or a face, if it is the first one of the pass. */
void vxm_repair_state_note_vertex(vxm_repair_state *state, vxm_pass pass, size_t vertex);
void vxm_repair_state_note_face(vxm_repair_state *state, vxm_pass pass, size_t face);
/** The first vertex with map[v] != v, if there is one. */
void vxm_repair_state_note_merge(vxm_repair_state *state, vxm_pass pass, const uint32_t *map);
/** The first face with a mark, if there is one. */
void vxm_repair_state_note_marked(vxm_repair_state *state, vxm_pass pass, const uint8_t *marks);
/** Says that faces have changed: what was derived from them is dropped. */
void vxm_repair_state_touch(vxm_repair_state *state);
/** Says that the faces marked in `turned` (face_count elements) run the other way from their first corner,
 * and nothing else. */
void vxm_repair_state_turn(vxm_repair_state *state, const uint8_t *turned);
/** Says that vertices have moved, and no face has changed. */
void vxm_repair_state_move(vxm_repair_state *state);

/**
 * Repairs a copy, and tells what there was to do, without a census.
 *
 * @return as vxm_repair_run
 */
vxm_status vxm_repair_try(vxm_pass_finding findings[VXM_PASS_COUNT], const vxm_soup *in,
                          const vxm_repair_options *options, vxm_error *error);

#endif
