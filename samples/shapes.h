/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Small closed bodies, and the ways in which meshes come broken. They are made without the library, so that
 * they can test it. A shape that cannot be allocated ends the program.
 */
#ifndef VXM_SAMPLES_SHAPES_H
#define VXM_SAMPLES_SHAPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Polygons over shared vertices; all zero is an empty shape. */
typedef struct shape {
  double *positions; /**< vertex_count x 3 */
  int64_t *offsets;  /**< face_count + 1; NULL while there is no face */
  int64_t *indices;  /**< offsets[face_count] corners */
  size_t vertex_count, face_count;
  size_t vertex_room, face_room, corner_room;
} shape;

void shape_free(shape *s);
int64_t shape_add_vertex(shape *s, double x, double y, double z);
void shape_add_face(shape *s, size_t count, const int64_t *corners);

/* Of angles of few turns, by series of 113 bits, rounded once: those of the C library differ from one to
 * another in the last digit. */
double shape_cosine(double angle);
double shape_sine(double angle);

/* ---- Closed bodies, their faces wound to point outward ---- */

/** Six rectangles. */
shape shape_box(double x0, double y0, double z0, double x1, double y1, double z1);
/** A polygon of `count` corners x y, counterclockwise, from z0 to z1; top and bottom are one face each. */
shape shape_prism(size_t count, const double *corners, double z0, double z1);
/**
 * A profile of `count` points r z, turned about the z axis in `segments` steps. An open profile runs upward
 * from bottom to top and is closed by one polygon where it does not end on the axis; a ring's profile is a
 * counterclockwise polygon off the axis.
 */
shape shape_revolve(size_t count, const double *profile, bool ring, size_t segments);
/** Points r z of a half circle from pole to pole, or of a whole circle about (centre, 0); count x 2 numbers.
 */
void shape_half_circle(double *profile, size_t count, double radius);
void shape_circle(double *profile, size_t count, double centre, double radius);

/* ---- Changes that keep a shape whole ---- */

void shape_move(shape *s, double x, double y, double z);
/** Turns about an axis (0 = x, 1 = y, 2 = z). */
void shape_turn(shape *s, int axis, double degrees);
/** Factors of either sign; faces keep their corners' order. */
void shape_scale(shape *s, double x, double y, double z);
/** Adds a copy of `other`, sharing no vertex. */
void shape_append(shape *s, const shape *other);
/** Splits every face into a fan of triangles; right for convex faces. */
void shape_split_triangles(shape *s);

/* ---- Damage; `share` is the probability of each face, `seed` makes the choice ---- */

void shape_reverse_faces(shape *s, double share, uint64_t seed);
void shape_remove_faces(shape *s, double share, uint64_t seed);
/** Repeats faces, turned over or as they are. */
void shape_repeat_faces(shape *s, bool turned, double share, uint64_t seed);
/** Gives every face its own vertices and moves each by up to `distance` along every axis. */
void shape_crack(shape *s, double distance, uint64_t seed);

/** Writes an OFF file; `glued` puts the counts behind the word as in some ModelNet files. False on failure.
 */
bool shape_write_off(const shape *s, const char *path, bool glued);

#endif
