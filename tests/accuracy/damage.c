/* SPDX-License-Identifier: BSD-3-Clause */
#include "damage.h"

#include "base/rng.h"
#include "truth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const damage_names[DAMAGE_COUNT] = {
    [DAMAGE_NONE] = "none",
    [DAMAGE_DOUBLED] = "every triangle doubled, opposite",
    [DAMAGE_FLIPPED] = "30 % flipped",
    [DAMAGE_REMOVED_1] = "1 % removed",
    [DAMAGE_REMOVED_5] = "5 % removed",
    [DAMAGE_REMOVED_20] = "20 % removed",
    [DAMAGE_COPIES] = "two overlapping copies",
    [DAMAGE_SHAKEN] = "shared vertices moved by 1e-4",
    [DAMAGE_MOVED] = "unshared vertices moved by 1e-4",
    [DAMAGE_SHEET] = "open sheet inside",
    [DAMAGE_CAVITY] = "nested inward box",
    [DAMAGE_HOLE] = "one big hole",
    [DAMAGE_PANELS] = "six loose panels",
    [DAMAGE_PANELS_DOUBLED] = "six loose panels, doubled",
    [DAMAGE_ALL] = "flipped, doubled, removed and moved",
};

/** What is done to the faces, each with a probability; lengths are shares of the body's diagonal. */
typedef struct recipe {
  double turned, doubled, removed;
  double moved;  /**< every corner gets a vertex of its own, moved this far in a random direction */
  double shaken; /**< every vertex is moved this far; the mesh stays closed */
  double hole;   /**< diameter of the ball in which all faces are removed */
} recipe;

static const recipe recipes[DAMAGE_COUNT] = {
    [DAMAGE_DOUBLED] = {.doubled = 1},
    [DAMAGE_FLIPPED] = {.turned = 0.3},
    [DAMAGE_REMOVED_1] = {.removed = 0.01},
    [DAMAGE_REMOVED_5] = {.removed = 0.05},
    [DAMAGE_REMOVED_20] = {.removed = 0.2},
    [DAMAGE_SHAKEN] = {.shaken = 1e-4},
    [DAMAGE_MOVED] = {.moved = 1e-4},
    [DAMAGE_HOLE] = {.hole = 0.08},
    [DAMAGE_PANELS_DOUBLED] = {.doubled = 1},
    [DAMAGE_ALL] = {.turned = 0.3, .doubled = 0.2, .removed = 0.01, .moved = 1e-4},
};

/* ---- Geometry of a body ---- */

static double diagonal_of(const shape *body) {
  double squared = 0;
  for (size_t a = 0; a < 3; a++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < body->vertex_count; i++) {
      low = fmin(low, body->positions[3 * i + a]);
      high = fmax(high, body->positions[3 * i + a]);
    }
    squared += (high - low) * (high - low);
  }
  return sqrt(squared);
}

static const int64_t *corners_of(const shape *body, size_t face) {
  return body->indices + body->offsets[face];
}

static void middle_of(double out[3], const shape *body, size_t face) {
  const int64_t *corners = corners_of(body, face);
  for (int a = 0; a < 3; a++)
    out[a] = (body->positions[3 * corners[0] + a] + body->positions[3 * corners[1] + a] +
              body->positions[3 * corners[2] + a]) /
             3;
}

static double distance_to_face(const shape *body, size_t face, const double from[3]) {
  double middle[3];
  middle_of(middle, body, face);
  double squared = 0;
  for (int a = 0; a < 3; a++)
    squared += (middle[a] - from[a]) * (middle[a] - from[a]);
  return sqrt(squared);
}

/* ---- Damage to faces ---- */

/** A face of the damaged mesh: which face of the body it was, and what became of it. */
typedef struct fate {
  size_t face;
  bool turned;
} fate;

static size_t decide_fates(fate *fates, const shape *body, const recipe *apply, double diagonal,
                           vxm_rng *rng) {
  double centre[3];
  size_t count = 0;
  middle_of(centre, body, (size_t)vxm_rng_below(rng, body->face_count));
  for (size_t f = 0; f < body->face_count; f++) {
    bool turned = vxm_rng_unit(rng) < apply->turned, doubled = vxm_rng_unit(rng) < apply->doubled;
    if (distance_to_face(body, f, centre) < apply->hole / 2 * diagonal)
      continue;
    for (int repeat = 0; repeat <= doubled; repeat++)
      if (vxm_rng_unit(rng) >= apply->removed)
        fates[count++] = (fate){f, turned != (repeat == 1)};
  }
  return count;
}

static void random_direction(double out[3], vxm_rng *rng) {
  double squared;
  do {
    squared = 0;
    for (int a = 0; a < 3; a++) {
      out[a] = 2 * vxm_rng_unit(rng) - 1;
      squared += out[a] * out[a];
    }
  } while (squared > 1 || squared < 1e-6);
  for (int a = 0; a < 3; a++)
    out[a] /= sqrt(squared);
}

static int64_t add_moved(shape *to, const double p[3], double distance, vxm_rng *rng) {
  double d[3];
  random_direction(d, rng);
  return shape_add_vertex(to, p[0] + distance * d[0], p[1] + distance * d[1], p[2] + distance * d[2]);
}

/** The damaged faces, and in `oriented` those of them that are no repetition, turned as they were. */
static void apply_fates(shape *damaged, shape *oriented, const shape *body, const fate *fates, size_t count,
                        double distance, vxm_rng *rng) {
  size_t last = SIZE_MAX;
  for (size_t i = 0; i < count; i++) {
    int64_t corners[3];
    memcpy(corners, corners_of(body, fates[i].face), sizeof corners);
    for (int c = 0; c < 3 && distance > 0; c++)
      corners[c] = add_moved(damaged, body->positions + 3 * corners[c], distance, rng);
    if (fates[i].face != last)
      shape_add_face(oriented, 3, corners);
    last = fates[i].face;
    if (fates[i].turned)
      shape_add_face(damaged, 3, (int64_t[]){corners[0], corners[2], corners[1]});
    else
      shape_add_face(damaged, 3, corners);
  }
}

static void damage_faces(shape *damaged, shape *oriented, const shape *body, const recipe *apply,
                         uint64_t seed) {
  vxm_rng rng = {seed};
  double diagonal = diagonal_of(body);
  fate *fates = calloc(2 * body->face_count, sizeof *fates);
  if (!fates)
    exit(1);
  size_t count = decide_fates(fates, body, apply, diagonal, &rng);
  for (size_t v = 0; v < body->vertex_count && apply->moved == 0; v++)
    add_moved(damaged, body->positions + 3 * v, apply->shaken * diagonal, &rng);
  apply_fates(damaged, oriented, body, fates, count, apply->moved * diagonal, &rng);
  for (size_t v = 0; v < damaged->vertex_count; v++) {
    const double *p = damaged->positions + 3 * v;
    shape_add_vertex(oriented, p[0], p[1], p[2]);
  }
  free(fates);
}

/* ---- Things that are added ---- */

/** A second copy, so near that the two overlap. */
static shape shifted_copy(const shape *body) {
  shape copy = {0};
  shape_append(&copy, body);
  double diagonal = diagonal_of(body);
  shape_move(&copy, 0.11 * diagonal, 0.07 * diagonal, 0.05 * diagonal);
  return copy;
}

static void add_sheet(shape *to, const double low[3], const double high[3]) {
  int64_t a = shape_add_vertex(to, low[0], low[1], low[2]), b = shape_add_vertex(to, high[0], low[1], low[2]);
  int64_t c = shape_add_vertex(to, high[0], high[1], high[2]),
          d = shape_add_vertex(to, low[0], high[1], high[2]);
  shape_add_face(to, 3, (int64_t[]){a, b, c});
  shape_add_face(to, 3, (int64_t[]){a, c, d});
}

static shape inward_box(const double low[3], const double high[3]) {
  shape box = shape_box(low[0], low[1], low[2], high[0], high[1], high[2]);
  shape_split_triangles(&box);
  shape_reverse_faces(&box, 2, 0);
  return box;
}

/* ---- Questions ---- */

/** Starts the whole mesh, which faces may still be lost of, and its truth. */
static shape make_whole(vxm_grid **truth, vxm_context *context, const shape *body, damage kind,
                        int64_t resolution, uint64_t seed) {
  bool is_panels = kind == DAMAGE_PANELS || kind == DAMAGE_PANELS_DOUBLED;
  shape meant = {0}, second = {0}, whole = {0};
  if (is_panels) {
    meant = body_panels(PANELS_JOINED, seed);
    whole = body_panels(PANELS_TURNED, seed);
  } else {
    shape_append(&meant, body);
    shape_append(&whole, body);
  }
  if (kind == DAMAGE_COPIES) {
    second = shifted_copy(body);
    shape_append(&whole, &second);
  }
  vxm_space space = truth_space(context, &whole, resolution);
  *truth = truth_solid(context, &meant, &space);
  if (kind == DAMAGE_COPIES) {
    vxm_grid *other = truth_solid(context, &second, &space);
    truth_unite(*truth, other);
    vxm_grid_destroy(other);
  }
  shape_free(&meant);
  shape_free(&second);
  return whole;
}

/** Puts a sheet or a box into the deepest place of a body; false if there is none. */
static bool add_inside(shape *whole, vxm_grid *truth, vxm_context *context, damage kind) {
  double low[3], high[3];
  if (!truth_room(truth, low, high))
    return false;
  if (kind == DAMAGE_SHEET) {
    add_sheet(whole, low, high);
    return true;
  }
  shape box = inward_box(low, high);
  vxm_grid *hollow = truth_solid(context, &box, vxm_grid_space(truth));
  truth_subtract(truth, hollow);
  vxm_grid_destroy(hollow);
  shape_append(whole, &box);
  shape_free(&box);
  return true;
}

bool question_make(question *out, vxm_context *context, const shape *body, damage kind, int64_t resolution,
                   uint64_t seed) {
  memset(out, 0, sizeof *out);
  uint64_t mixed = vxm_mix(seed * DAMAGE_COUNT + (uint64_t)kind);
  shape whole = make_whole(&out->truth, context, body, kind, resolution, mixed);
  bool inside = kind == DAMAGE_SHEET || kind == DAMAGE_CAVITY;
  if (inside && !add_inside(&whole, out->truth, context, kind)) {
    shape_free(&whole);
    question_free(out);
    return false;
  }
  shape damaged = {0}, oriented = {0};
  damage_faces(&damaged, &oriented, &whole, &recipes[kind], mixed);
  if (kind == DAMAGE_PANELS || kind == DAMAGE_PANELS_DOUBLED) {
    shape_free(&oriented);
    oriented = body_panels(PANELS_LOOSE, mixed);
  }
  out->mesh = mesh_of_shape(context, &damaged);
  out->oriented = mesh_of_shape(context, &oriented);
  shape_free(&damaged);
  shape_free(&oriented);
  shape_free(&whole);
  return true;
}

void question_free(question *q) {
  vxm_mesh_destroy(q->mesh);
  vxm_mesh_destroy(q->oriented);
  vxm_grid_destroy(q->truth);
  memset(q, 0, sizeof *q);
}
