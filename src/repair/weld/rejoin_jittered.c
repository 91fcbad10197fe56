/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/weld/rejoin_jittered.h"
#include "repair/weld/vertex_clusters.h"

#include "base/hash.h"
#include "mesh/geometry.h"
#include "mesh/sort.h"

#include <math.h>
#include <string.h>

static const double CLUSTER_WIDTH = 5e-4; /**< of the diagonal: that of a cluster's box */
static const double BOX_PART = 1.75;      /**< diagonal of a box of points that are no farther than 1 apart */
static const double REACH = 3e-4;         /**< of the diagonal: ends of mates are no farther apart */
static const double EDGE_PART = 0.35;     /**< of an edge: nearer ends make mates beyond doubt */
static const double PLAIN_PART = 0.15;    /**< of an edge: so near that it does not matter who comes first */

enum {
  CHAIN_MAX = 64,      /**< edges looked at in a cell; where more crowd, some find no mate */
  PAIRS_PER_EDGE = 16, /**< beyond, on average, nothing is mended: no torn surface has that many */
  ROUNDS_MAX = 8
};

static const uint32_t NO_EDGE = UINT32_MAX;

/** A boundary edge, as its face runs along it. */
typedef struct rim {
  uint32_t a, b;
  size_t face;
} rim;

/** Two boundary edges whose ends are near: a at a and b at b, or crosswise. */
typedef struct pair {
  uint32_t i, j;
  float cost; /**< the larger distance of the two ends, scaled */
  bool crosswise, folded;
  bool sure, plain; /**< by EDGE_PART, by PLAIN_PART */
} pair;

typedef struct search {
  vxm_repair_state *state;
  const vxm_soup *soup;
  vxm_error error;
  double scale, reach, width; /**< scaled */
  rim *rims;
  size_t rim_count;
  double per_unit; /**< cells per scaled length */
  uint32_t *head;  /**< per slot of the hash: its last rim */
  uint32_t *next;  /**< per rim: the one before in its slot */
  size_t slots;
  pair *pairs;
  size_t pair_count, pair_capacity;
  uint64_t *order; /**< cost << 32 | place among the pairs; sorted. Twice the room, for the sort */
  size_t order_count;
  uint8_t *joined; /**< per rim */
  vxm_vertex_clusters clusters;
} search;

/** Without the calls and the care for NaN of fmin and fmax. */
static inline double least(double a, double b) {
  return a < b ? a : b;
}

static inline double most(double a, double b) {
  return a > b ? a : b;
}

/** floor; 0 where that is no whole number of 64 bits, of a mesh that is tiny against its coordinates. */
static inline int64_t whole_below(double x) {
  if (!(fabs(x) < 0x1p62))
    return 0;
  int64_t toward_zero = (int64_t)x;
  return toward_zero - (x < (double)toward_zero);
}

static void *allocate(search *s, size_t count, size_t size) {
  return vxm_calloc(s->state->context, count, size, &s->error);
}

static vxm_vec3 between(const search *s, uint32_t p, uint32_t q) {
  return vxm_vec3_between(vxm_position(s->soup, p), vxm_position(s->soup, q), s->scale);
}

static double distance(const search *s, uint32_t p, uint32_t q) {
  return vxm_vec3_length(between(s, p, q));
}

/* ---- Boundary edges ---- */

/** Whether the side from a to b runs along an edge by itself; places[v] is where the edges of v begin. */
static bool is_rim(const vxm_edges *edges, const size_t *places, uint32_t a, uint32_t b) {
  enum { SCAN_MAX = 16 }; /* beyond, as at the hub of a large fan, a search over all edges is quicker */
  uint32_t low = a < b ? a : b, high = a < b ? b : a;
  size_t e = places[low], end = places[low + 1];
  if (end - e > SCAN_MAX)
    e = vxm_edges_find(edges, low, high);
  else
    while (e < end && edges->edges[e].b != high)
      e++;
  return e < end && edges->edges[e].count == 1;
}

static void list_rims(search *s, const size_t *places) {
  for (size_t f = 0; f < s->soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(s->soup, f, &count);
    if (!vxm_face_has_three(corner, count, NULL))
      continue;
    for (size_t c = 0; c < count; c++) {
      uint32_t a = corner[c], b = corner[c + 1 < count ? c + 1 : 0];
      if (a != b && is_rim(&s->state->edges, places, a, b))
        s->rims[s->rim_count++] = (rim){a, b, f};
    }
  }
}

static bool find_rims(search *s, size_t count) {
  const vxm_edges *edges = &s->state->edges;
  size_t *places = allocate(s, s->soup->vertex_count + 1, sizeof *places);
  s->rims = allocate(s, count, sizeof *s->rims);
  if (places && s->rims) {
    for (size_t e = 0; e < edges->count; e++)
      places[edges->edges[e].a + 1]++;
    for (size_t v = 0; v < s->soup->vertex_count; v++)
      places[v + 1] += places[v];
    list_rims(s, places);
  }
  bool found = places && s->rims;
  vxm_free(s->state->context, places);
  return found;
}

/* ---- Pairs of near edges ---- */

/** Seen from the edge, whether both faces lie on the same side, less than 60 degrees apart. */
static bool is_folded(const search *s, const rim *p, const rim *q) {
  vxm_vec3 out[2];
  const rim *both[2] = {p, q};
  for (int k = 0; k < 2; k++) {
    size_t count;
    const uint32_t *corner = vxm_face(s->soup, both[k]->face, &count);
    vxm_vec3 along = between(s, both[k]->b, both[k]->a), sum = {0, 0, 0};
    for (size_t c = 0; c < count; c++) {
      vxm_vec3 to = between(s, corner[c], both[k]->a);
      sum = vxm_vec3_sum(sum, to);
    }
    double part = vxm_vec3_dot(sum, along) / vxm_vec3_dot(along, along);
    out[k] = (vxm_vec3){sum.x - part * along.x, sum.y - part * along.y, sum.z - part * along.z};
  }
  return vxm_vec3_dot(out[0], out[1]) > 0.5 * vxm_vec3_length(out[0]) * vxm_vec3_length(out[1]);
}

static double squared(const search *s, uint32_t p, uint32_t q) {
  vxm_vec3 d = between(s, p, q);
  return vxm_vec3_dot(d, d);
}

static bool consider(search *s, uint32_t i, uint32_t j) {
  const rim *p = &s->rims[i], *q = &s->rims[j];
  double limit = s->reach * s->reach;
  double straight = squared(s, p->a, q->a), across = squared(s, p->a, q->b);
  if ((straight > limit && across > limit) || p->face == q->face)
    return true;
  straight = most(straight, squared(s, p->b, q->b));
  across = most(across, squared(s, p->b, q->a));
  double cost = sqrt(least(straight, across));
  if (!(cost <= s->reach))
    return true;
  if (s->pair_count == PAIRS_PER_EDGE * s->rim_count)
    return false;
  void *pairs = s->pairs;
  if (vxm_grow(s->state->context, &pairs, &s->pair_capacity, s->pair_count + 1, sizeof *s->pairs,
               &s->error) != VXM_OK)
    return false;
  s->pairs = pairs;
  double length = least(distance(s, p->a, p->b), distance(s, q->a, q->b));
  bool sure = cost <= EDGE_PART * length;
  s->pairs[s->pair_count++] = (pair){.i = i,
                                     .j = j,
                                     .cost = (float)cost,
                                     .crosswise = across < straight,
                                     .sure = sure,
                                     .plain = cost <= PLAIN_PART * length,
                                     .folded = sure && is_folded(s, p, q)};
  return true;
}

static size_t slot_of(const search *s, const int64_t cell[3]) {
  uint64_t hash = (uint64_t)cell[0] * UINT64_C(0x9e3779b97f4a7c15) ^
                  (uint64_t)cell[1] * UINT64_C(0xc2b2ae3d27d4eb4f) ^
                  (uint64_t)cell[2] * UINT64_C(0x165667b19e3779f9);
  return (size_t)vxm_mix(hash) & (s->slots - 1);
}

/** Slots of the cells, up to 8, that the ball of s->reach about a point meets, each once; the home first. */
static size_t slots_around(const search *s, const double middle[3], size_t slots[8]) {
  int64_t low[3], high[3], home[3];
  for (int a = 0; a < 3; a++) {
    low[a] = whole_below((middle[a] - s->reach) * s->per_unit);
    high[a] = whole_below((middle[a] + s->reach) * s->per_unit);
    home[a] = whole_below(middle[a] * s->per_unit);
  }
  size_t count = 0;
  slots[count++] = slot_of(s, home);
  for (int64_t z = low[2]; z <= high[2]; z++)
    for (int64_t y = low[1]; y <= high[1]; y++)
      for (int64_t x = low[0]; x <= high[0]; x++) {
        size_t slot = slot_of(s, (int64_t[3]){x, y, z}), known = 0;
        while (known < count && slots[known] != slot)
          known++;
        if (known == count && count < 8)
          slots[count++] = slot;
      }
  return count;
}

/** Meets every edge with the earlier ones near it, then adds it to its cell. */
static bool find_pairs(search *s) {
  for (s->slots = 64; s->slots < 2 * s->rim_count;)
    s->slots *= 2;
  s->per_unit = 1 / (4 * s->reach);
  s->head = allocate(s, s->slots, sizeof *s->head);
  s->next = allocate(s, s->rim_count, sizeof *s->next);
  if (!s->head || !s->next)
    return false;
  memset(s->head, 0xff, s->slots * sizeof *s->head);
  for (uint32_t i = 0; i < s->rim_count; i++) {
    const double *a = vxm_position(s->soup, s->rims[i].a), *b = vxm_position(s->soup, s->rims[i].b);
    double middle[3];
    for (int axis = 0; axis < 3; axis++)
      middle[axis] = 0.5 * (a[axis] * s->scale + b[axis] * s->scale);
    size_t slots[8], count = slots_around(s, middle, slots);
    for (size_t k = 0; k < count; k++) {
      int seen = 0;
      for (uint32_t j = s->head[slots[k]]; j != NO_EDGE && seen < CHAIN_MAX; j = s->next[j], seen++)
        if (!consider(s, i, j))
          return false;
    }
    s->next[i] = s->head[slots[0]];
    s->head[slots[0]] = i;
  }
  return true;
}

static uint64_t bits_of(float cost) {
  uint32_t bits; /* floats of no sign are ordered as their bits are */
  memcpy(&bits, &cost, sizeof bits);
  return bits;
}

/* ---- Whether the soup is torn, and how far ---- */

/** Marks the edges that have a sure mate on their other side; s->joined serves as the mark. */
static size_t count_mates(search *s) {
  size_t count = 0;
  memset(s->joined, 0, s->rim_count);
  for (size_t k = 0; k < s->pair_count; k++)
    if (s->pairs[k].sure && !s->pairs[k].folded)
      s->joined[s->pairs[k].i] = s->joined[s->pairs[k].j] = 1;
  for (size_t i = 0; i < s->rim_count; i++)
    count += s->joined[i];
  return count;
}

/** From the costs of sure pairs, sorted: nearly all, and a little more. */
static void set_width(search *s) {
  size_t count = 0;
  for (size_t k = 0; k < s->pair_count; k++)
    if (s->pairs[k].sure && !s->pairs[k].folded)
      s->order[count++] = bits_of(s->pairs[k].cost);
  vxm_sort_keys(s->order, s->order + count, count);
  uint32_t bits = (uint32_t)s->order[(count - 1) - count / 100];
  float cost;
  memcpy(&cost, &bits, sizeof cost);
  s->width = least(s->reach, 1.15 * (double)cost);
}

/** Of the pairs that are left, the nearest first. */
static void sort_pairs(search *s) {
  s->order_count = 0;
  for (size_t k = 0; k < s->pair_count; k++)
    if (!s->joined[s->pairs[k].i] || !s->joined[s->pairs[k].j])
      s->order[s->order_count++] = bits_of(s->pairs[k].cost) << 32 | k;
  vxm_sort_keys(s->order, s->order + s->order_count, s->order_count);
}

/* ---- Joining pairs ---- */

/** Which pairs a round may join. */
typedef enum round_kind {
  ROUND_SURE, /**< those without doubt */
  ROUND_ZIP,  /**< those of which one end is joined */
  ROUND_ANY
} round_kind;

static bool join_pair(search *s, const pair *k, round_kind kind) {
  if (s->joined[k->i] && s->joined[k->j])
    return false;
  vxm_vertex_clusters *clusters = &s->clusters;
  const rim *i = &s->rims[k->i], *j = &s->rims[k->j];
  uint32_t a = vxm_vertex_clusters_root(clusters, i->a), b = vxm_vertex_clusters_root(clusters, i->b);
  uint32_t c = vxm_vertex_clusters_root(clusters, k->crosswise ? j->b : j->a),
           d = vxm_vertex_clusters_root(clusters, k->crosswise ? j->a : j->b);
  if (kind == ROUND_ZIP && a != c && b != d)
    return false;
  if (!vxm_vertex_clusters_may_unite(clusters, a, c) || !vxm_vertex_clusters_may_unite(clusters, b, d))
    return false;
  vxm_vertex_clusters_unite(clusters, a, c);
  /* the first union may have changed what the second one would do */
  b = vxm_vertex_clusters_root(clusters, b);
  d = vxm_vertex_clusters_root(clusters, d);
  if (vxm_vertex_clusters_may_unite(clusters, b, d))
    vxm_vertex_clusters_unite(clusters, b, d);
  s->joined[k->i] = s->joined[k->j] = 1;
  return true;
}

/** In the order of the faces, which is that of the memory. */
static void join_plain(search *s) {
  for (size_t k = 0; k < s->pair_count; k++)
    if (s->pairs[k].plain && (double)s->pairs[k].cost <= s->width)
      join_pair(s, &s->pairs[k], ROUND_SURE);
}

/** The others, the nearest first. */
static size_t join_round(search *s, round_kind kind) {
  size_t joined = 0;
  for (size_t k = 0; k < s->order_count; k++) {
    const pair *p = &s->pairs[(uint32_t)s->order[k]];
    if ((double)p->cost > s->width)
      break;
    if (kind != ROUND_SURE || p->sure)
      joined += join_pair(s, p, kind);
  }
  return joined;
}

/** What is sure, then on from its ends along what is still open, then whatever else goes together. */
static void join_all(search *s) {
  memset(s->joined, 0, s->rim_count);
  join_plain(s);
  sort_pairs(s);
  join_round(s, ROUND_SURE);
  for (int round = 0; round < ROUNDS_MAX; round++)
    if (join_round(s, ROUND_ZIP) == 0)
      break;
  join_round(s, ROUND_ANY);
}

static double mean_length(const search *s) {
  double sum = 0;
  for (size_t i = 0; i < s->rim_count; i++)
    sum += distance(s, s->rims[i].a, s->rims[i].b);
  return sum / (double)s->rim_count;
}

/** false without an error if the soup is not torn. */
static bool match(search *s, size_t rims, const vxm_unit_scale *frame) {
  if (!find_rims(s, rims))
    return false;
  s->scale = frame->scale;
  s->reach = least(REACH * frame->diagonal, 0.5 * mean_length(s));
  s->joined = allocate(s, s->rim_count, sizeof *s->joined);
  if (!(s->reach > 1e-9) || !s->joined || !find_pairs(s) || 2 * count_mates(s) < s->rim_count)
    return false;
  s->order = allocate(s, s->pair_count, 2 * sizeof *s->order);
  if (!s->order)
    return false;
  set_width(s);
  double width = least(CLUSTER_WIDTH / REACH * s->reach, BOX_PART * s->width);
  if (vxm_vertex_clusters_create(&s->clusters, s->soup, s->scale, width, s->state->context, &s->error) !=
      VXM_OK)
    return false;
  join_all(s);
  return true;
}

static void release(search *s) {
  vxm_context *context = s->state->context;
  vxm_vertex_clusters_destroy(&s->clusters);
  vxm_free(context, s->joined);
  vxm_free(context, s->order);
  vxm_free(context, s->pairs);
  vxm_free(context, s->next);
  vxm_free(context, s->head);
  vxm_free(context, s->rims);
}

vxm_status vxm_rejoin_jittered(vxm_repair_state *state, uint32_t *map, vxm_error *error) {
  vxm_status status = vxm_repair_state_edges(state, error);
  if (status != VXM_OK)
    return status;
  size_t rims = 0, vertices = state->soup->vertex_count;
  for (size_t e = 0; e < state->edges.count; e++)
    rims += state->edges.edges[e].count == 1;
  for (size_t v = 0; v < vertices; v++)
    map[v] = (uint32_t)v;
  if (rims == 0 || 2 * rims < state->edges.count || rims > UINT32_MAX / PAIRS_PER_EDGE)
    return VXM_OK;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  vxm_unit_scale frame = vxm_unit_scale_of(extent.bounds);
  search s = {.state = state, .soup = state->soup, .error = VXM_ERROR_INIT};
  if (match(&s, rims, &frame))
    for (size_t v = 0; v < vertices; v++)
      map[v] = vxm_vertex_clusters_root(&s.clusters, (uint32_t)v);
  release(&s);
  if (s.error.code != VXM_OK)
    vxm_error_pass(error, &s.error);
  return s.error.code;
}
