/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions on meshes: they check arguments and call down. */
#include "base/file.h"
#include "base/sized.h"
#include "mesh/census.h"
#include "mesh/soup.h"
#include "meshio/common/faces_out.h"
#include "meshio/meshio.h"

#include <inttypes.h>
#include <string.h>

/** Whether the corners that faces have are as many as indices; an array is read no further than that. */
static vxm_status check_corners(const vxm_mesh_arrays *arrays, vxm_error *error) {
  int64_t count = arrays->index_count;
  if (!arrays->offsets && count != 3 * arrays->face_count)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "mesh: %" PRId64 " indices for %" PRId64 " triangles; there must be three for each",
                    count, arrays->face_count);
  if (!arrays->offsets)
    return VXM_OK;
  if (arrays->offsets[0] != 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: offsets[0] is %" PRId64 "; it must be 0",
                    arrays->offsets[0]);
  for (int64_t face = 0; face < arrays->face_count; face++) {
    int64_t begin = arrays->offsets[face], end = arrays->offsets[face + 1];
    if (end < begin || end - begin < 3)
      return vxm_fail_at(error, VXM_ERROR_ARGUMENT, (vxm_place){NULL, 0, -1, face},
                         "mesh: face %" PRId64 " has fewer than three corners (offsets %" PRId64
                         " to %" PRId64 ")",
                         face, begin, end);
  }
  if (arrays->offsets[arrays->face_count] != count)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "mesh: offsets end with %" PRId64 ", but there are %" PRId64 " indices",
                    arrays->offsets[arrays->face_count], count);
  return VXM_OK;
}

static vxm_status check_arrays(const vxm_mesh_arrays *arrays, vxm_error *error) {
  if (arrays->vertex_scalar != VXM_FLOAT64 && arrays->vertex_scalar != VXM_FLOAT32)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "mesh: vertex_scalar %d is neither VXM_FLOAT64 nor VXM_FLOAT32",
                    (int)arrays->vertex_scalar);
  if (arrays->index_scalar != VXM_INT64 && arrays->index_scalar != VXM_UINT32 &&
      arrays->index_scalar != VXM_INT32)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "mesh: index_scalar %d is none of VXM_INT64, VXM_UINT32 and VXM_INT32",
                    (int)arrays->index_scalar);
  if (arrays->vertex_count < 0 || arrays->face_count < 0 || arrays->index_count < 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: a count is negative");
  if ((arrays->vertex_count > 0 && !arrays->vertices) || (arrays->index_count > 0 && !arrays->indices))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: an array is NULL but its count is not 0");
  if ((uint64_t)arrays->vertex_count > VXM_VERTICES_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "%" PRId64 " vertices; at most %zu can be held: split the mesh",
                    arrays->vertex_count, VXM_VERTICES_MAX);
  if (arrays->face_count > INT64_MAX / 3)
    return vxm_fail(error, VXM_ERROR_RANGE, "%" PRId64 " faces are beyond what can be addressed",
                    arrays->face_count);
  if (arrays->tag_count < 0 || arrays->tag_count > UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: %" PRId64 " tags", arrays->tag_count);
  if (arrays->tag_count > 0 && (!arrays->tags || !arrays->face_tags))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: tags are NULL but their count is not 0");
  return check_corners(arrays, error);
}

static vxm_status copy_vertices(vxm_soup *soup, const vxm_mesh_arrays *arrays) {
  size_t count = 3 * (size_t)arrays->vertex_count;
  const float *single = arrays->vertices;
  if (arrays->vertex_scalar == VXM_FLOAT32)
    for (size_t i = 0; i < count; i++)
      soup->positions[i] = (double)single[i];
  else if (count > 0)
    memcpy(soup->positions, arrays->vertices, count * sizeof *soup->positions);
  soup->vertex_count = (size_t)arrays->vertex_count;
  return VXM_OK;
}

static int64_t index_at(const vxm_mesh_arrays *arrays, int64_t corner) {
  if (arrays->index_scalar == VXM_UINT32)
    return ((const uint32_t *)arrays->indices)[corner];
  if (arrays->index_scalar == VXM_INT32)
    return ((const int32_t *)arrays->indices)[corner];
  return ((const int64_t *)arrays->indices)[corner];
}

static vxm_status copy_face(vxm_soup *soup, const vxm_mesh_arrays *arrays, int64_t face, vxm_error *error) {
  int64_t begin = arrays->offsets ? arrays->offsets[face] : 3 * face;
  int64_t end = arrays->offsets ? arrays->offsets[face + 1] : begin + 3;
  for (int64_t c = begin; c < end; c++) {
    int64_t vertex = index_at(arrays, c);
    if (vertex < 0 || vertex >= arrays->vertex_count)
      return vxm_fail_at(error, VXM_ERROR_ARGUMENT, (vxm_place){NULL, 0, -1, face},
                         "mesh: face %" PRId64 " names vertex %" PRId64 ", but there are %" PRId64, face,
                         vertex, arrays->vertex_count);
    soup->indices[soup->corner_count++] = (uint32_t)vertex;
  }
  soup->offsets[++soup->face_count] = soup->corner_count;
  return VXM_OK;
}

/** Names of tags, and which tag each face has. */
static vxm_status copy_tags(vxm_soup *soup, const vxm_mesh_arrays *arrays, vxm_error *error) {
  if (arrays->tag_count == 0)
    return VXM_OK;
  vxm_status status = VXM_OK;
  soup->face_tags = vxm_try_alloc(soup->context, soup->face_count, sizeof *soup->face_tags, &status, error);
  if (!soup->face_tags)
    return status;
  uint32_t tag;
  for (int64_t t = 0; status == VXM_OK && t < arrays->tag_count; t++) {
    const char *name = arrays->tags[t] ? arrays->tags[t] : "";
    status = vxm_soup_add_tag(soup, name, strlen(name), &tag, error);
  }
  for (int64_t face = 0; status == VXM_OK && face < arrays->face_count; face++) {
    if (arrays->face_tags[face] >= arrays->tag_count)
      return vxm_fail_at(error, VXM_ERROR_ARGUMENT, (vxm_place){NULL, 0, -1, face},
                         "mesh: face %" PRId64 " has tag %" PRIu32 ", but there are %" PRId64, face,
                         arrays->face_tags[face], arrays->tag_count);
    soup->face_tags[face] = arrays->face_tags[face];
  }
  return status;
}

vxm_status vxm_mesh_create(vxm_mesh **out, vxm_context *context, const vxm_mesh_arrays *given,
                           vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !given)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: an argument is NULL");
  vxm_soup *soup;
  vxm_mesh_arrays chosen = VXM_MESH_ARRAYS_INIT, *arrays = &chosen;
  vxm_status status = VXM_OPTIONS_READ(arrays, given, "mesh", error);
  if (status == VXM_OK)
    status = check_arrays(arrays, error);
  if (status == VXM_OK)
    status = vxm_soup_create(&soup, context, "arrays", error);
  if (status != VXM_OK)
    return status;
  status = vxm_soup_reserve(soup, (size_t)arrays->vertex_count, (size_t)arrays->face_count,
                            (size_t)arrays->index_count, error);
  if (status == VXM_OK)
    status = copy_vertices(soup, arrays);
  for (int64_t face = 0; status == VXM_OK && face < arrays->face_count; face++)
    status = copy_face(soup, arrays, face, error);
  if (status == VXM_OK)
    status = copy_tags(soup, arrays, error);
  if (status != VXM_OK) {
    vxm_soup_destroy(soup);
    return status;
  }
  *out = soup;
  return VXM_OK;
}

vxm_status vxm_mesh_triangulate(vxm_mesh **out, const vxm_mesh *mesh, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: an argument is NULL");
  return vxm_faces_out_triangles(out, mesh, error);
}

/** NULL options are fine. */
static vxm_status choose_read_options(vxm_mesh_read_options *chosen, const vxm_mesh_read_options *options,
                                      vxm_error *error) {
  *chosen = (vxm_mesh_read_options)VXM_MESH_READ_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(chosen, options, "mesh", error);
  if (status != VXM_OK)
    return status;
  if (!(chosen->deflection >= 0 && chosen->deflection <= 1))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: deflection %g is not between 0 and 1",
                    chosen->deflection);
  if ((int)chosen->external < VXM_EXTERNAL_FOLDER || chosen->external > VXM_EXTERNAL_NONE)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: external %d is not known", (int)chosen->external);
  return VXM_OK;
}

vxm_status vxm_mesh_read_memory_with(vxm_mesh **out, vxm_context *context, const void *data, size_t size,
                                     const char *name, const vxm_mesh_read_options *options,
                                     vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || (!data && size > 0))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: an argument is NULL");
  if (size > PTRDIFF_MAX)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: %zu bytes are more than memory can hold", size);
  vxm_mesh_read_options chosen;
  vxm_status status = choose_read_options(&chosen, options, error);
  if (status != VXM_OK)
    return status;
  return vxm_meshio_read(out, context, data, size, name ? name : "<memory>", &chosen, error);
}

vxm_status vxm_mesh_read_memory(vxm_mesh **out, vxm_context *context, const void *data, size_t size,
                                const char *name, vxm_error *error) {
  return vxm_mesh_read_memory_with(out, context, data, size, name, NULL, error);
}

vxm_status vxm_mesh_read_with(vxm_mesh **out, vxm_context *context, const char *path,
                              const vxm_mesh_read_options *options, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: an argument is NULL");
  vxm_context *owner;
  vxm_mesh_read_options chosen;
  vxm_status status = choose_read_options(&chosen, options, error);
  if (status == VXM_OK)
    status = vxm_context_acquire(&owner, context, error);
  if (status != VXM_OK)
    return status;
  status = vxm_meshio_read_file(out, owner, path, &chosen, error);
  vxm_context_release(owner);
  return status;
}

vxm_status vxm_mesh_read(vxm_mesh **out, vxm_context *context, const char *path, vxm_error *error) {
  return vxm_mesh_read_with(out, context, path, NULL, error);
}

vxm_status vxm_mesh_write(const vxm_mesh *mesh, const char *path, const vxm_mesh_write_options *options,
                          vxm_error *error) {
  if (!mesh || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: an argument is NULL");
  vxm_mesh_write_options chosen = VXM_MESH_WRITE_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "mesh", error);
  return status == VXM_OK ? vxm_meshio_write(mesh, path, chosen.format, vxm_write_flags_of(&chosen), error)
                          : status;
}

void vxm_mesh_destroy(vxm_mesh *mesh) {
  vxm_soup_destroy(mesh);
}

int64_t vxm_mesh_vertex_count(const vxm_mesh *mesh) {
  return mesh ? (int64_t)mesh->vertex_count : 0;
}

int64_t vxm_mesh_face_count(const vxm_mesh *mesh) {
  return mesh ? (int64_t)mesh->face_count : 0;
}

const double *vxm_mesh_vertices(const vxm_mesh *mesh) {
  return mesh ? mesh->positions : NULL;
}

const uint64_t *vxm_mesh_offsets(const vxm_mesh *mesh) {
  return mesh ? mesh->offsets : NULL;
}

const uint32_t *vxm_mesh_indices(const vxm_mesh *mesh) {
  return mesh ? mesh->indices : NULL;
}

int64_t vxm_mesh_tag_count(const vxm_mesh *mesh) {
  return mesh ? (int64_t)mesh->tag_count : 0;
}

const char *vxm_mesh_tag_name(const vxm_mesh *mesh, int64_t tag) {
  return mesh && tag >= 0 && (size_t)tag < mesh->tag_count ? mesh->tags[tag] : "";
}

const uint32_t *vxm_mesh_face_tags(const vxm_mesh *mesh) {
  return mesh ? mesh->face_tags : NULL;
}

const char *vxm_mesh_format(const vxm_mesh *mesh) {
  return mesh ? mesh->format : "";
}

int64_t vxm_mesh_warning_count(const vxm_mesh *mesh) {
  return mesh ? mesh->warnings.count : 0;
}

const char *vxm_mesh_warning(const vxm_mesh *mesh, int64_t index) {
  return mesh && index >= 0 && index < mesh->warnings.count ? mesh->warnings.text[index] : "";
}

int64_t vxm_mesh_companion_count(const vxm_mesh *mesh) {
  return mesh ? (int64_t)mesh->companion_count : 0;
}

const char *vxm_mesh_companion(const vxm_mesh *mesh, int64_t index) {
  return mesh && index >= 0 && (size_t)index < mesh->companion_count ? mesh->companions[index] : "";
}

vxm_status vxm_mesh_census(vxm_census *out, const vxm_mesh *mesh, vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "census: an argument is NULL");
  vxm_census census = {0};
  vxm_status status = vxm_soup_census(&census, mesh, error);
  if (status == VXM_OK)
    VXM_RESULT_WRITE(out, &census);
  return status;
}
