/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/pipeline.h"
#include "repair/bodies/bodies.h"
#include "repair/bodies/flush_bodies.h"
#include "repair/bodies/inner_walls.h"
#include "repair/bodies/other_diagonals.h"
#include "repair/exact/on_lattice.h"
#include "repair/state/repair_state.h"

static vxm_status run_pass(vxm_repair_state *state, vxm_pass_fn pass, double fraction, bool *changed,
                           vxm_error *error) {
  vxm_status status = vxm_progress(state->context, "repairing", fraction, error);
  return status == VXM_OK ? pass(state, changed, error) : status;
}

enum { ROUNDS_MAX = 8 };

static const vxm_pass_fn round_passes[] = {vxm_pass_repeated_corners, vxm_pass_degenerate_faces,
                                           vxm_pass_t_junctions, vxm_pass_duplicates, vxm_pass_tolerant_weld};
enum { PASSES = sizeof round_passes / sizeof *round_passes };

/** How much these have done so far. */
static int64_t count_round(const vxm_repair_state *state) {
  return state->counts[VXM_PASS_REPEATED_CORNERS] + state->counts[VXM_PASS_DEGENERATE_FACES] +
         state->counts[VXM_PASS_DUPLICATES] + state->counts[VXM_PASS_OPPOSITE_DUPLICATES] +
         state->counts[VXM_PASS_TOLERANT_WELD] + state->counts[VXM_PASS_T_JUNCTIONS];
}

/**
 * Runs the passes that may make work for each other round and round, until each has found nothing to do since
 * the last change; as each change takes away vertices or corners, or closes edges, this ends. Cracks are
 * looked for last: doubled faces hide them, and faces without area may bridge them. T-junctions come before
 * doubled faces, of which it is asked whether they are closed.
 */
static vxm_status run_until_quiet(vxm_repair_state *state, bool *changed, vxm_error *error) {
  int64_t before = count_round(state);
  /* a given tolerance applies to the mesh as it is */
  int next = state->options.weld == VXM_WELD_TOLERANCE ? PASSES - 1 : 0, quiet = 0;
  double fraction = 0.3;
  while (quiet < PASSES) {
    vxm_status status = run_pass(state, round_passes[next], fraction, changed, error);
    if (status != VXM_OK)
      return status;
    /* welding may leave work to itself: a vertex that is no longer in the way lets others merge */
    bool settled = round_passes[next] != vxm_pass_tolerant_weld;
    quiet = *changed ? settled : quiet + 1;
    next = (next + 1) % PASSES;
    fraction += (0.9 - fraction) / 8;
  }
  *changed = count_round(state) > before;
  return VXM_OK;
}

/** Runs a pass that moves or merges vertices, so that the account of parts sees how far. */
static vxm_status run_followed(vxm_repair_state *state, vxm_pass_fn pass, bool *changed, vxm_error *error) {
  vxm_status status =
      state->provenance ? vxm_provenance_start(state->provenance, state->soup, error) : VXM_OK;
  if (status == VXM_OK)
    status = pass(state, changed, error);
  if (status == VXM_OK && state->provenance)
    status = vxm_provenance_settle(state->provenance, state->soup, error);
  return status;
}

/** The passes that make work for each other, once more; `changed`: they had some. */
static vxm_status settle_again(vxm_repair_state *state, bool *changed, vxm_error *error) {
  bool turned;
  vxm_status status = run_followed(state, run_until_quiet, changed, error);
  return status == VXM_OK && *changed ? vxm_pass_orientation(state, &turned, error) : status;
}

/** Cuts polygons that are there twice alike, if repeated faces are to be looked at. */
static vxm_status align_diagonals(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  return state->options.keep_duplicates ? VXM_OK : vxm_pass_other_diagonals(state, changed, error);
}

/** The passes that make work for each other; then walls in bodies go, if they are to, and faces are turned.
 * That polygons are there twice may show only when some of their triangles are gone or turned. */
static vxm_status settle(vxm_repair_state *state, vxm_error *error) {
  bool more, walls = false, changed;
  vxm_status status = align_diagonals(state, &more, error);
  more = true; /* whether there were any or not */
  for (int round = 0; round < ROUNDS_MAX && more && status == VXM_OK; round++) {
    status = run_until_quiet(state, &changed, error);
    if (status == VXM_OK)
      status = vxm_pass_inner_walls(state, &walls, error);
    if (status == VXM_OK)
      status = run_pass(state, vxm_pass_orientation, 0.85, &changed, error);
    if (status == VXM_OK)
      status = align_diagonals(state, &more, error);
    more = more || walls;
  }
  return status;
}

/** Separation, and what else it makes room for: where faces were cut apart others may come together. */
static vxm_status separate_until_quiet(vxm_repair_state *state, bool *changed, vxm_error *error) {
  bool more = true;
  vxm_status status = VXM_OK;
  *changed = false;
  for (int round = 0; round < ROUNDS_MAX && more && status == VXM_OK; round++) {
    bool turned;
    status = vxm_pass_cut_nonmanifold(state, &more, error);
    if (status != VXM_OK || !more)
      break;
    *changed = true;
    status = vxm_pass_orientation(state, &turned, error);
    if (status == VXM_OK)
      status = settle_again(state, &more, error);
  }
  return status;
}

static vxm_status move_apart(vxm_repair_state *state, bool *changed, vxm_error *error) {
  return run_followed(state, vxm_pass_perturb_coincident, changed, error);
}

static vxm_status collapse_short_edges(vxm_repair_state *state, bool *changed, vxm_error *error) {
  return run_followed(state, vxm_pass_short_edges, changed, error);
}

/** The union. Where it touches itself it has vertices of their own for each sheet, which vertices at one
 * position are only from VXM_LEVEL_MANIFOLD on. */
static vxm_status unite(vxm_repair_state *state, bool *changed, vxm_error *error) {
  bool welded = false, more;
  vxm_status status = vxm_pass_union(state, changed, error);
  if (status == VXM_OK && *changed && !vxm_repair_state_reaches(state, VXM_LEVEL_MANIFOLD))
    status = vxm_pass_exact_weld(state, &welded, error);
  return status == VXM_OK && welded ? settle_again(state, &more, error) : status;
}

/** What could not be united is wrapped, if that was asked for, and then united after all. */
static vxm_status wrap_the_rest(vxm_repair_state *state, bool *changed, vxm_error *error) {
  bool more;
  *changed = false;
  vxm_status status = state->union_failures > 0 ? vxm_pass_fallback(state, changed, error) : VXM_OK;
  return status == VXM_OK && *changed ? unite(state, &more, error) : status;
}

/** Takes apart what touches with its rims, so that holes go round each for itself. */
static vxm_status part_touching(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  return vxm_repair_state_reaches(state, VXM_LEVEL_MANIFOLD) ? vxm_part_flush_bodies(state, changed, error)
                                                             : VXM_OK;
}

/** The passes that a level or an option asks for; each does nothing where none does. `moved`: vertices were
 * moved apart. */
static vxm_status run_level(vxm_repair_state *state, bool *moved, vxm_error *error) {
  static const struct {
    vxm_pass_fn pass;
    bool turns; /**< what it changes may be turned otherwise */
  } further[] = {{part_touching, false},
                 {vxm_pass_meeting_holes, true},
                 {separate_until_quiet, true},
                 {vxm_pass_closing, true},
                 {vxm_pass_small_components, true},
                 {vxm_pass_sheets, false},
                 {unite, false},
                 {wrap_the_rest, false},
                 {collapse_short_edges, false},
                 {vxm_pass_cut_nonmanifold, false},
                 {move_apart, true},
                 {vxm_pass_reunion, false},
                 {collapse_short_edges, false},
                 {vxm_pass_cut_nonmanifold, false},
                 {move_apart, true},
                 {vxm_pass_reunion, false},
                 {collapse_short_edges, false},
                 {vxm_pass_cut_nonmanifold, false},
                 {move_apart, true}};
  enum { FURTHER = sizeof further / sizeof *further };
  vxm_status status = VXM_OK;
  *moved = false;
  for (int i = 0; i < FURTHER && status == VXM_OK; i++) {
    bool changed = false, turned;
    status = run_pass(state, further[i].pass, 0.9 + 0.1 * i / FURTHER, &changed, error);
    *moved = *moved || (changed && further[i].pass == move_apart);
    if (status == VXM_OK && changed && further[i].turns)
      status = run_pass(state, vxm_pass_orientation, 0.9 + 0.1 * i / FURTHER, &turned, error);
  }
  return status;
}

/** What was moved apart may let vertices merge that were not to before, which opens nothing but takes
 * vertices away. */
static vxm_status run_rounds(vxm_repair_state *state, vxm_error *error) {
  bool again = true;
  vxm_status status = VXM_OK;
  for (int round = 0; round < ROUNDS_MAX && again && status == VXM_OK; round++) {
    status = run_level(state, &again, error);
    if (status == VXM_OK && again)
      status = settle_again(state, &again, error);
  }
  return status;
}

/** Goes back before the union, for another try; on a lattice vertices may merge that it has in one place. */
static vxm_status begin_again(vxm_repair_state *state, const vxm_before_union *before,
                              const vxm_union_try *union_try, vxm_error *error) {
  bool more;
  vxm_status status = vxm_before_union_again(state, before, error);
  state->union_try = *union_try;
  if (status != VXM_OK || union_try->bits == 0)
    return status;
  status = run_followed(state, vxm_snap_to_lattice, &more, error);
  if (status == VXM_OK)
    status = vxm_pass_exact_weld(state, &more, error);
  return status == VXM_OK ? settle_again(state, &more, error) : status;
}

/** Runs a level that unites parts; from the second try on, from before the union. */
static vxm_status run_try(vxm_repair_state *state, const vxm_before_union *before,
                          const vxm_union_try *union_try, int number, vxm_error *error) {
  vxm_status status = number > 1 ? begin_again(state, before, union_try, error) : VXM_OK;
  state->union_tries = number;
  return status == VXM_OK ? run_rounds(state, error) : status;
}

/** Wraps what still cuts through something, if that was asked for. */
static vxm_status wrap_crossing(vxm_repair_state *state, vxm_error *error) {
  bool changed;
  vxm_status status = vxm_pass_fallback(state, &changed, error);
  return status == VXM_OK && changed ? run_rounds(state, error) : status;
}

/** Runs a level that unites parts; where slivers are in the way, once more without the shortest edges, and on
 * coarser and coarser lattices. A surface that runs through itself touches itself where it comes to be wound
 * the other way; at last what is wound so is left out, of which the check for losses tells.
 */
static vxm_status run_union(vxm_repair_state *state, vxm_error *error) {
  static const vxm_union_try tries[] = {{.bits = 0},
                                        {.bits = 0, .collapses = true},
                                        {.bits = 24},
                                        {.bits = 24, .collapses = true},
                                        {.bits = 21, .collapses = true},
                                        {.bits = 18, .collapses = true},
                                        {.bits = 0, .collapses = true, .doubles_only = true},
                                        {.bits = 24, .collapses = true, .doubles_only = true},
                                        {.bits = 0, .outward_only = true},
                                        {.bits = 0, .collapses = true, .outward_only = true}};
  enum { TRIES = sizeof tries / sizeof *tries };
  vxm_before_union before = {.soup = NULL};
  bool short_of = true;
  int64_t first_failures = 0;
  vxm_status status = vxm_before_union_keep(&before, state, error);
  for (int i = 0; i < TRIES && short_of && status == VXM_OK; i++) {
    status = run_try(state, &before, &tries[i], i + 1, error);
    if (status == VXM_OK)
      status = vxm_union_fell_short(&short_of, state, error);
    first_failures = i == 0 ? state->union_failures : first_failures;
    short_of = short_of || state->union_failures > first_failures;
  }
  if (status == VXM_OK && short_of) { /* then rather what moves nothing */
    status = run_try(state, &before, &tries[0], TRIES + 1, error);
    if (status == VXM_OK)
      status = wrap_crossing(state, error);
  }
  vxm_before_union_destroy(&before, state->context);
  return status;
}

static vxm_status run_further(vxm_repair_state *state, vxm_error *error) {
  bool changed;
  vxm_status status = vxm_pass_unused(state, &changed, error);
  if (status == VXM_OK)
    status = run_pass(state, vxm_pass_wrap, 0.9, &changed, error);
  if (status == VXM_OK)
    status = vxm_repair_state_reaches(state, VXM_LEVEL_SOLID) && !(state->options.wrap_alpha > 0)
                 ? run_union(state, error)
                 : run_rounds(state, error);
  return status == VXM_OK ? vxm_pass_unused(state, &changed, error) : status;
}

/** What comes once: polygons are cleaned before they become triangles and, for .stl, are rounded. */
static vxm_status run_first(vxm_repair_state *state, vxm_error *error) {
  static const vxm_pass_fn first[] = {vxm_pass_nonfinite,   vxm_pass_exact_weld, vxm_pass_repeated_corners,
                                      vxm_pass_t_junctions, vxm_pass_duplicates, vxm_pass_rounding,
                                      vxm_pass_exact_weld};
  enum { FIRST = sizeof first / sizeof *first, PLAIN = 2 };
  vxm_status status = VXM_OK;
  int passes = state->options.single_precision || state->options.triangles ? FIRST : PLAIN;
  for (int i = 0; i < passes && status == VXM_OK; i++) {
    bool changed;
    status = run_pass(state, first[i], 0.25 * i / passes, &changed, error);
  }
  return status;
}

/** Faces that run the other way in the end than when they came in. */
static void count_turned(vxm_repair_state *state) {
  for (size_t f = 0; f < state->soup->face_count && state->turned; f++) {
    if (state->turned[f] != VXM_TURNED)
      continue;
    vxm_repair_state_note_face(state, VXM_PASS_ORIENTATION, f);
    state->counts[VXM_PASS_ORIENTATION]++;
    if (state->provenance && state->soup->face_parts)
      vxm_provenance_turn(state->provenance, state->soup->face_parts[f]);
  }
}

/** Whether passes that came so far have taken away faces, or may have made some meet. */
static bool has_removed(const vxm_repair_state *state) {
  return count_round(state) > 0 || state->counts[VXM_PASS_NONFINITE] > 0;
}

/** Looks whether a part is lost; *again: then the repair is to begin anew, with more care. */
static vxm_status look_for_lost(vxm_repair_state *state, const vxm_soup *in, bool *again, vxm_error *error) {
  *again = false;
  if (!has_removed(state))
    return VXM_OK;
  vxm_lost_parts lost;
  vxm_status status = vxm_lost_parts_find(&lost, in, state->soup, error);
  if (status == VXM_OK && lost.count > 0 && !state->guards_lost_parts) {
    state->lost = lost;
    *again = true;
    return VXM_OK;
  }
  state->lost_parts = status == VXM_OK ? (int64_t)lost.count : 0;
  vxm_lost_parts_destroy(&lost, state->context);
  return status;
}

/** Whether bodies that touch may be turned against each other, and are to become a manifold as they are. */
static bool turns_bodies(const vxm_repair_state *state) {
  return state->has_held_patches && !state->divides && vxm_repair_state_reaches(state, VXM_LEVEL_MANIFOLD) &&
         !(state->options.wrap_alpha > 0);
}

vxm_status vxm_pipeline_run(vxm_repair_state *state, const vxm_soup *in, bool *again, vxm_error *error) {
  bool changed;
  vxm_status status = run_first(state, error);
  if (status == VXM_OK)
    status = settle(state, error);
  if (status == VXM_OK)
    status = look_for_lost(state, in, again, error);
  if (status != VXM_OK || *again)
    return status;
  if (state->provenance && state->options.max_change > 0)
    status = vxm_provenance_refer(state->provenance, state->soup, error);
  if (status == VXM_OK && state->provenance)
    status = vxm_provenance_settle(state->provenance, state->soup, error);
  if (status == VXM_OK && turns_bodies(state))
    status = vxm_pass_mixed_bodies(state, &changed, error);
  if (status == VXM_OK)
    status = run_further(state, error);
  if (status == VXM_OK && state->divides)
    status = vxm_pass_bodies(state, &changed, error);
  if (status == VXM_OK)
    count_turned(state);
  return status;
}
