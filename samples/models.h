/* SPDX-License-Identifier: BSD-3-Clause */
/** The sample models: small meshes whose truth is known, clean and broken in each way. */
#ifndef VXM_SAMPLES_MODELS_H
#define VXM_SAMPLES_MODELS_H

#include "shapes.h"

/** What a census must count, by the definitions of vxm_census. */
typedef struct model_counts {
  int64_t vertices, faces, triangles, components, components_raw;
  int64_t duplicate_faces, opposite_duplicate_faces, degenerate_faces;
  int64_t boundary_edges, nonmanifold_edges, inconsistent_edges;
  int64_t nonfinite_vertices, unused_vertices;
  bool watertight, closed;
} model_counts;

typedef struct model {
  const char *name;
  const char *text; /**< what it is and how it is broken */
  shape (*make)(void);
  model_counts counts;
  double volume; /**< of the solid that is meant */
  const char
      *parts; /**< splitting that finds it: "auto" or "whole"; NULL = no voxelization finds it for sure */
  const char *same_as; /**< model of which the repaired mesh has the same voxels, or NULL */
} model;

extern const model models[];
extern const size_t model_count;

/** The model of the demonstration: a rocket with every fault at once. It has no exact truth. */
shape model_rocket(void);

#endif
