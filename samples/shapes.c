/* SPDX-License-Identifier: BSD-3-Clause */
#include "shapes.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- Storage ---- */

static void *grow(void *block, size_t *room, size_t needed, size_t size) {
  if (needed <= *room)
    return block;
  while (*room < needed)
    *room = *room ? 2 * *room : 64;
  block = realloc(block, *room * size);
  if (!block) {
    fprintf(stderr, "out of memory\n");
    exit(1);
  }
  return block;
}

static int64_t *make_indices(size_t count) {
  size_t room = 0;
  return grow(NULL, &room, count, sizeof(int64_t));
}

void shape_free(shape *s) {
  free(s->positions);
  free(s->offsets);
  free(s->indices);
  memset(s, 0, sizeof *s);
}

int64_t shape_add_vertex(shape *s, double x, double y, double z) {
  size_t n = s->vertex_count++;
  s->positions = grow(s->positions, &s->vertex_room, n + 1, 3 * sizeof(double));
  s->positions[3 * n] = x;
  s->positions[3 * n + 1] = y;
  s->positions[3 * n + 2] = z;
  return (int64_t)n;
}

void shape_add_face(shape *s, size_t count, const int64_t *corners) {
  size_t begin = s->face_count ? (size_t)s->offsets[s->face_count] : 0;
  s->offsets = grow(s->offsets, &s->face_room, s->face_count + 2, sizeof(int64_t));
  s->indices = grow(s->indices, &s->corner_room, begin + count, sizeof(int64_t));
  memcpy(s->indices + begin, corners, count * sizeof *corners);
  s->offsets[0] = 0;
  s->offsets[++s->face_count] = (int64_t)(begin + count);
}

static void add_quad(shape *s, int64_t a, int64_t b, int64_t c, int64_t d) {
  shape_add_face(s, 4, (int64_t[]){a, b, c, d});
}

/* ---- Bodies ---- */

#if LDBL_MANT_DIG >= 113
typedef long double quad;
#else
__extension__ typedef __float128 quad;
#endif

/** The sum of x^n / n! over every second n from `first` on, with signs in turn. */
static double sum_series(double x, int first) {
  quad square = (quad)x * (quad)x, term = first == 0 ? (quad)1 : (quad)x, sum = term;
  for (int n = first + 2; n < 80; n += 2) {
    term = -term * square / (quad)(n * (n - 1));
    sum += term;
  }
  return (double)sum;
}

double shape_cosine(double angle) {
  return sum_series(angle, 0);
}

double shape_sine(double angle) {
  return sum_series(angle, 1);
}

shape shape_box(double x0, double y0, double z0, double x1, double y1, double z1) {
  return shape_prism(4, (double[]){x0, y0, x1, y0, x1, y1, x0, y1}, z0, z1);
}

shape shape_prism(size_t count, const double *corners, double z0, double z1) {
  shape made = {0};
  for (int top = 0; top < 2; top++)
    for (size_t i = 0; i < count; i++)
      shape_add_vertex(&made, corners[2 * i], corners[2 * i + 1], top ? z1 : z0);
  int64_t n = (int64_t)count, *cap = make_indices(count);
  for (int64_t i = 0; i < n; i++)
    cap[i] = n - 1 - i;
  shape_add_face(&made, count, cap);
  for (int64_t i = 0; i < n; i++)
    cap[i] = n + i;
  shape_add_face(&made, count, cap);
  free(cap);
  for (int64_t i = 0; i < n; i++) {
    int64_t next = (i + 1) % n;
    add_quad(&made, i, next, n + next, n + i);
  }
  return made;
}

/** The ring of vertices that a profile point makes; a point on the axis makes one vertex. */
static int64_t *add_ring(shape *made, double r, double z, size_t segments) {
  int64_t *ring = make_indices(segments);
  if (r == 0)
    ring[0] = shape_add_vertex(made, 0, 0, z);
  for (size_t s = 0; s < segments; s++) {
    double angle = 2 * pi * (double)s / (double)segments;
    ring[s] = r == 0 ? ring[0] : shape_add_vertex(made, r * shape_cosine(angle), r * shape_sine(angle), z);
  }
  return ring;
}

/** The faces between two rings, of which one may be a point. */
static void add_band(shape *made, const int64_t *lower, const int64_t *upper, size_t segments) {
  for (size_t s = 0; s < segments; s++) {
    size_t t = (s + 1) % segments;
    if (lower[s] == lower[t])
      shape_add_face(made, 3, (int64_t[]){lower[s], upper[t], upper[s]});
    else if (upper[s] == upper[t])
      shape_add_face(made, 3, (int64_t[]){lower[s], lower[t], upper[s]});
    else
      add_quad(made, lower[s], lower[t], upper[t], upper[s]);
  }
}

static void add_cap(shape *made, int64_t *ring, size_t segments, bool bottom) {
  if (ring[0] == ring[1])
    return;
  for (size_t s = 0; bottom && s < segments / 2; s++) {
    int64_t swapped = ring[s];
    ring[s] = ring[segments - 1 - s];
    ring[segments - 1 - s] = swapped;
  }
  shape_add_face(made, segments, ring);
}

shape shape_revolve(size_t count, const double *profile, bool ring, size_t segments) {
  shape made = {0};
  int64_t *first = add_ring(&made, profile[0], profile[1], segments), *last = first;
  for (size_t i = 1; i < count; i++) {
    int64_t *next = add_ring(&made, profile[2 * i], profile[2 * i + 1], segments);
    add_band(&made, last, next, segments);
    if (last != first)
      free(last);
    last = next;
  }
  if (ring)
    add_band(&made, last, first, segments);
  else {
    add_cap(&made, first, segments, true);
    add_cap(&made, last, segments, false);
  }
  free(first);
  free(last);
  return made;
}

void shape_half_circle(double *profile, size_t count, double radius) {
  for (size_t i = 0; i < count; i++) {
    double angle = pi * ((double)i / (double)(count - 1) - 0.5);
    bool pole = i == 0 || i + 1 == count;
    profile[2 * i] = pole ? 0 : radius * shape_cosine(angle);
    profile[2 * i + 1] = radius * shape_sine(angle);
  }
}

void shape_circle(double *profile, size_t count, double centre, double radius) {
  for (size_t i = 0; i < count; i++) {
    double angle = 2 * pi * (double)i / (double)count;
    profile[2 * i] = centre + radius * shape_cosine(angle);
    profile[2 * i + 1] = radius * shape_sine(angle);
  }
}

/* ---- Changes that keep a shape whole ---- */

void shape_move(shape *s, double x, double y, double z) {
  const double by[3] = {x, y, z};
  for (size_t i = 0; i < 3 * s->vertex_count; i++)
    s->positions[i] += by[i % 3];
}

void shape_turn(shape *s, int axis, double degrees) {
  double cosine = shape_cosine(degrees * pi / 180), sine = shape_sine(degrees * pi / 180);
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (size_t i = 0; i < s->vertex_count; i++) {
    double *p = s->positions + 3 * i, a = p[u], b = p[v];
    p[u] = cosine * a - sine * b;
    p[v] = sine * a + cosine * b;
  }
}

void shape_scale(shape *s, double x, double y, double z) {
  const double by[3] = {x, y, z};
  for (size_t i = 0; i < 3 * s->vertex_count; i++)
    s->positions[i] *= by[i % 3];
}

void shape_append(shape *s, const shape *other) {
  int64_t base = (int64_t)s->vertex_count;
  for (size_t i = 0; i < other->vertex_count; i++)
    shape_add_vertex(s, other->positions[3 * i], other->positions[3 * i + 1], other->positions[3 * i + 2]);
  for (size_t f = 0; f < other->face_count; f++) {
    int64_t begin = other->offsets[f], count = other->offsets[f + 1] - begin;
    shape_add_face(s, (size_t)count, other->indices + begin);
    int64_t *copied = s->indices + s->offsets[s->face_count] - count;
    for (int64_t c = 0; c < count; c++)
      copied[c] += base;
  }
}

/** Moves the faces out, so that they can be put back changed. */
static shape take_faces(shape *from) {
  shape taken = *from;
  taken.positions = NULL;
  from->offsets = from->indices = NULL;
  from->face_count = from->face_room = from->corner_room = 0;
  return taken;
}

void shape_split_triangles(shape *s) {
  shape old = take_faces(s);
  for (size_t f = 0; f < old.face_count; f++)
    for (int64_t c = old.offsets[f] + 1; c + 1 < old.offsets[f + 1]; c++)
      shape_add_face(s, 3, (int64_t[]){old.indices[old.offsets[f]], old.indices[c], old.indices[c + 1]});
  shape_free(&old);
}

/* ---- Damage ---- */

/** splitmix64, to a number in [0, 1). */
static double next_random(uint64_t *state) {
  uint64_t x = *state += UINT64_C(0x9e3779b97f4a7c15);
  x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
  return (double)((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

static void turn_over(int64_t *corners, int64_t count) {
  for (int64_t a = 0, b = count - 1; a < b; a++, b--) {
    int64_t swapped = corners[a];
    corners[a] = corners[b];
    corners[b] = swapped;
  }
}

void shape_reverse_faces(shape *s, double share, uint64_t seed) {
  for (size_t f = 0; f < s->face_count; f++)
    if (next_random(&seed) < share)
      turn_over(s->indices + s->offsets[f], s->offsets[f + 1] - s->offsets[f]);
}

void shape_remove_faces(shape *s, double share, uint64_t seed) {
  shape old = take_faces(s);
  for (size_t f = 0; f < old.face_count; f++)
    if (next_random(&seed) >= share)
      shape_add_face(s, (size_t)(old.offsets[f + 1] - old.offsets[f]), old.indices + old.offsets[f]);
  shape_free(&old);
}

void shape_repeat_faces(shape *s, bool turned, double share, uint64_t seed) {
  shape old = take_faces(s);
  for (int round = 0; round < 2; round++)
    for (size_t f = 0; f < old.face_count; f++) {
      if (round == 1 && next_random(&seed) >= share)
        continue;
      int64_t *corners = old.indices + old.offsets[f], count = old.offsets[f + 1] - old.offsets[f];
      if (round == 1 && turned)
        turn_over(corners, count);
      shape_add_face(s, (size_t)count, corners);
    }
  shape_free(&old);
}

void shape_crack(shape *s, double distance, uint64_t seed) {
  shape old = *s;
  memset(s, 0, sizeof *s);
  for (size_t f = 0; f < old.face_count; f++) {
    int64_t begin = old.offsets[f], count = old.offsets[f + 1] - begin;
    for (int64_t c = begin; c < begin + count; c++) {
      const double *p = old.positions + 3 * old.indices[c];
      double moved[3];
      for (int axis = 0; axis < 3; axis++)
        moved[axis] = p[axis] + distance * (2 * next_random(&seed) - 1);
      old.indices[c] = shape_add_vertex(s, moved[0], moved[1], moved[2]);
    }
    shape_add_face(s, (size_t)count, old.indices + begin);
  }
  shape_free(&old);
}

bool shape_write_off(const shape *s, const char *path, bool glued) {
  FILE *file = fopen(path, "w");
  if (!file)
    return false;
  fprintf(file, "OFF%s%zu %zu 0\n", glued ? "" : "\n", s->vertex_count, s->face_count);
  for (size_t i = 0; i < s->vertex_count; i++) {
    const double *p = s->positions + 3 * i;
    fprintf(file, "%.9g %.9g %.9g\n", p[0], p[1], p[2]);
  }
  for (size_t f = 0; f < s->face_count; f++) {
    fprintf(file, "%" PRId64, s->offsets[f + 1] - s->offsets[f]);
    for (int64_t c = s->offsets[f]; c < s->offsets[f + 1]; c++)
      fprintf(file, " %" PRId64, s->indices[c]);
    fputc('\n', file);
  }
  bool good = !ferror(file);
  return fclose(file) == 0 && good;
}
