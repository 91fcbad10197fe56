/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/duplicate_faces.h"

#include "base/hash.h"
#include "base/threads.h"
#include "mesh/radix_partition.h"
#include "mesh/side_table.h"

#include <stdatomic.h>
#include <string.h>

/* ---- The least form of a face ---- */

/** A face read from one of its corners in one of its directions. */
typedef struct reading {
  const uint32_t *corners;
  size_t count, start;
  bool backward;
} reading;

static inline uint32_t read_corner(const reading *r, size_t i) {
  size_t at = r->backward ? r->start + r->count - i : r->start + i;
  return r->corners[at >= r->count ? at - r->count : at];
}

static int compare(const reading *a, const reading *b) {
  for (size_t i = 0; i < a->count; i++) {
    uint32_t u = read_corner(a, i), v = read_corner(b, i);
    if (u != v)
      return u < v ? -1 : 1;
  }
  return 0;
}

/**
 * Starts the reading where it is least in lexicographic order, in linear time: of two candidate starts the
 * one that loses after k equal corners takes the k starts behind it with it.
 */
static void turn_to_least(reading *r) {
  size_t i = 0, j = 1, k = 0, n = r->count;
  r->start = 0;
  while (i < n && j < n && k < n) {
    size_t p = i + k, q = j + k;
    uint32_t u = read_corner(r, p >= n ? p - n : p), v = read_corner(r, q >= n ? q - n : q);
    if (u == v) {
      k++;
      continue;
    }
    if (u > v)
      i += k + 1;
    else
      j += k + 1;
    if (i == j)
      j++;
    k = 0;
  }
  size_t least = i < j ? i : j;
  r->start = r->backward && least > 0 ? n - least : least;
}

/** The least of all readings in both directions: the same for all faces that repeat each other. */
static reading least_reading(const uint32_t *corners, size_t count) {
  reading forward = {.corners = corners, .count = count};
  if (count == 3) {
    uint32_t a = read_corner(&forward, 0), b = read_corner(&forward, 1), c = read_corner(&forward, 2);
    forward.start = a < b ? (a < c ? 0 : 2) : (b < c ? 1 : 2);
    forward.backward = read_corner(&forward, 1) > read_corner(&forward, 2);
    return forward;
  }
  reading backward = forward;
  backward.backward = true;
  turn_to_least(&forward);
  turn_to_least(&backward);
  return compare(&forward, &backward) <= 0 ? forward : backward;
}

/* ---- The search ---- */

/* A record is (24 bits of the hash, 39 bits of the face number, direction of the least reading); the top of
   the hash tells the bucket. Face numbers fit, as 2^39 faces would take more memory than machines have. */
enum { FACE_BITS = 39, HASH_SHIFT = FACE_BITS + 1 };

static inline uint64_t record_of(uint64_t hash, size_t face, bool backward) {
  return hash << HASH_SHIFT | (uint64_t)face << 1 | backward;
}

static inline size_t record_face(uint64_t record) {
  return (size_t)(record >> 1 & ((UINT64_C(1) << FACE_BITS) - 1));
}

/** Of the first record of a kind; that of another one has the place of the first one for `forward`, and 0. */
typedef struct tally {
  uint32_t forward, backward; /**< faces of a kind so far, by direction of their least reading */
} tally;

typedef struct search {
  const vxm_soup *soup;
  uint8_t *kinds;
  vxm_copies *copies;
  unsigned bucket_shift;
  vxm_radix_partition buckets;
  uint32_t *tables; /**< one hash table per worker: place of a record in its bucket + 1, or 0 */
  size_t table_size;
  tally *tallies; /**< per worker, by place of the first record of a kind */
  atomic_size_t same, opposite_pairs;
} search;

/** The reading of a face that its record tells. */
static reading least_of_face(const search *s, uint64_t record) {
  size_t count;
  const uint32_t *corners = vxm_face(s->soup, record_face(record), &count);
  return least_reading(corners, count);
}

/** Triangles are told apart by their sorted corners: (a b c), (b c a) and (c a b) run forward if a < b < c.
 */
static void put_triangle(const search *s, vxm_sink *sink, size_t face, const uint32_t *corners) {
  uint32_t a = corners[0], b = corners[1], c = corners[2];
  if (a == b || b == c || c == a)
    return;
  bool backward = (a < b) + (b < c) + (c < a) == 1;
  uint32_t low = a < b ? a : b, high = a < b ? b : a;
  uint32_t least = low < c ? low : c, most = high > c ? high : c, middle = a ^ b ^ c ^ least ^ most;
  uint64_t hash = vxm_mix(((uint64_t)least << 32 | middle) ^ most * UINT64_C(0x9e3779b97f4a7c15));
  vxm_sink_put(sink, (size_t)(hash >> s->bucket_shift), record_of(hash, face, backward));
}

static void emit_faces(size_t begin, size_t end, vxm_sink *sink, void *payload) {
  const search *s = payload;
  for (size_t f = begin; f < end; f++) {
    size_t count;
    const uint32_t *corners = vxm_face(s->soup, f, &count);
    if (count == 3) {
      put_triangle(s, sink, f, corners);
      continue;
    }
    if (!vxm_face_has_three(corners, count, NULL))
      continue;
    reading r = least_reading(corners, count);
    uint64_t hash = vxm_hash_word(0, count);
    for (size_t i = 0; i < count; i++)
      hash = vxm_hash_word(hash, read_corner(&r, i));
    vxm_sink_put(sink, (size_t)(hash >> s->bucket_shift), record_of(hash, f, r.backward));
  }
}

/** Whether two records are of faces with the same least reading. */
static bool same_kind(const search *s, uint64_t record, uint64_t other) {
  if (record >> HASH_SHIFT != other >> HASH_SHIFT)
    return false;
  reading r = least_of_face(s, record), q = least_of_face(s, other);
  return q.count == r.count && compare(&q, &r) == 0;
}

static vxm_repeat count_face(tally *t, bool backward) {
  uint32_t *mine = backward ? &t->backward : &t->forward, theirs = backward ? t->forward : t->backward;
  if ((*mine)++ > 0)
    return VXM_REPEAT_SAME;
  return theirs > 0 ? VXM_REPEAT_OPPOSITE : VXM_REPEAT_NONE;
}

/** Tells of every face of a bucket what it repeats. */
static void list_copies(const search *s, const uint64_t *records, size_t count, const tally *tallies) {
  for (size_t i = 0; i < count; i++) {
    size_t face = record_face(records[i]), first = s->kinds[face] == VXM_REPEAT_NONE ? i : tallies[i].forward;
    const tally *t = &tallies[first];
    bool backward = records[i] & 1;
    vxm_copies *c = &s->copies[face];
    c->first = record_face(records[first]);
    c->turned = backward != (records[first] & 1);
    c->same = backward ? t->backward : t->forward;
    c->opposite = backward ? t->forward : t->backward;
  }
}

static void search_bucket(size_t bucket, int worker, void *payload) {
  search *s = payload;
  const uint64_t *records = s->buckets.records + s->buckets.begin[bucket];
  size_t count = s->buckets.begin[bucket + 1] - s->buckets.begin[bucket];
  uint32_t *table = s->tables + (size_t)worker * s->table_size;
  tally *tallies = s->tallies + (size_t)worker * s->buckets.largest;
  size_t mask = vxm_hash_slots(count) - 1, same = 0, pairs = 0;
  memset(table, 0, (mask + 1) * sizeof *table);
  memset(tallies, 0, count * sizeof *tallies);
  for (size_t i = 0; i < count; i++) {
    size_t slot = (size_t)(records[i] >> HASH_SHIFT) & mask;
    while (table[slot] != 0 && !same_kind(s, records[i], records[table[slot] - 1]))
      slot = (slot + 1) & mask;
    if (table[slot] == 0)
      table[slot] = (uint32_t)i + 1;
    else
      tallies[i].forward = table[slot] - 1;
    tally *of_kind = &tallies[table[slot] - 1];
    if (s->copies)
      s->copies[record_face(records[i])].rank = records[i] & 1 ? of_kind->backward : of_kind->forward;
    vxm_repeat kind = count_face(of_kind, records[i] & 1);
    same += kind == VXM_REPEAT_SAME;
    if (s->kinds)
      s->kinds[record_face(records[i])] = (uint8_t)kind;
  }
  for (size_t i = 0; i < count; i++)
    pairs += tallies[i].forward < tallies[i].backward ? tallies[i].forward : tallies[i].backward;
  if (s->copies)
    list_copies(s, records, count, tallies);
  atomic_fetch_add_explicit(&s->same, same, memory_order_relaxed);
  atomic_fetch_add_explicit(&s->opposite_pairs, pairs, memory_order_relaxed);
}

vxm_status vxm_duplicates_find(vxm_duplicates *out, vxm_context *context, const vxm_soup *soup,
                               uint8_t *kinds, vxm_copies *copies, vxm_error *error) {
  *out = (vxm_duplicates){0};
  size_t bucket_count = vxm_radix_partition_advise(soup->face_count);
  search s = {.soup = soup, .kinds = kinds, .copies = copies};
  s.bucket_shift = 64 - (unsigned)__builtin_ctzll(bucket_count);
  vxm_status status =
      vxm_radix_partition_fill(&s.buckets, context, soup->face_count, bucket_count, emit_faces, &s, error);
  if (status != VXM_OK)
    return status;
  if (kinds && soup->face_count > 0)
    memset(kinds, VXM_REPEAT_NONE, soup->face_count);
  for (size_t f = 0; copies && f < soup->face_count; f++)
    copies[f] = (vxm_copies){.first = f, .same = 1};
  size_t workers = (size_t)vxm_context_threads(context);
  s.table_size = vxm_hash_slots(s.buckets.largest);
  vxm_error local = VXM_ERROR_INIT;
  s.tables = vxm_alloc(context, workers * s.table_size, sizeof *s.tables, &local);
  s.tallies = s.tables ? vxm_alloc(context, workers * s.buckets.largest, sizeof *s.tallies, &local) : NULL;
  status =
      s.tallies ? vxm_parallel_cancellable(context, bucket_count, search_bucket, &s, &local) : local.code;
  if (status == VXM_OK)
    *out = (vxm_duplicates){atomic_load(&s.same), atomic_load(&s.opposite_pairs)};
  else
    vxm_error_pass(error, &local);
  vxm_free(context, s.tallies);
  vxm_free(context, s.tables);
  vxm_radix_partition_destroy(&s.buckets);
  return status;
}
