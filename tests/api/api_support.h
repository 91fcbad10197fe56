/* SPDX-License-Identifier: BSD-3-Clause */
/** What the tests of the public functions share. They see the library through voxmend.h only. */
#ifndef VXM_TESTS_API_SUPPORT_H
#define VXM_TESTS_API_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "models.h"
#include "voxmend.h"

#include <string.h>

/** Copies a shape into a mesh. */
static inline vxm_mesh *mesh_of_shape(vxm_context *context, const shape *s) {
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  arrays.vertices = s->positions;
  arrays.vertex_count = (int64_t)s->vertex_count;
  arrays.offsets = s->offsets;
  arrays.indices = s->indices;
  arrays.index_count = s->offsets[s->face_count];
  arrays.face_count = (int64_t)s->face_count;
  vxm_mesh *mesh = NULL;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_mesh_create(&mesh, context, &arrays, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return mesh;
}

static inline const model *find_model(const char *name) {
  for (size_t i = 0; i < model_count; i++)
    if (strcmp(models[i].name, name) == 0)
      return &models[i];
  fail_msg("no model %s", name);
  return NULL;
}

static inline vxm_mesh *mesh_of_model(vxm_context *context, const char *name) {
  shape made = find_model(name)->make();
  vxm_mesh *mesh = mesh_of_shape(context, &made);
  shape_free(&made);
  return mesh;
}

#endif
