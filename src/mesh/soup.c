/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/soup.h"

#include <string.h>

vxm_status vxm_soup_create(vxm_soup **out, vxm_context *context, const char *format, vxm_error *error) {
  *out = NULL;
  vxm_context *owner;
  vxm_status status = vxm_context_acquire(&owner, context, error);
  if (status != VXM_OK)
    return status;
  vxm_soup *soup = vxm_try_calloc(owner, 1, sizeof *soup, &status, error);
  if (soup) {
    soup->context = owner;
    soup->format = format;
    soup->offsets = vxm_try_calloc(owner, 1, sizeof *soup->offsets, &status, error);
    soup->indices = vxm_try_alloc(owner, 1, sizeof *soup->indices, &status, error);
    soup->corner_capacity = 1;
  }
  if (!soup || !soup->offsets || !soup->indices) {
    if (soup) {
      vxm_free(owner, soup->indices);
      vxm_free(owner, soup->offsets);
    }
    vxm_free(owner, soup);
    vxm_context_release(owner);
    return status;
  }
  *out = soup;
  return VXM_OK;
}

void vxm_soup_destroy(vxm_soup *soup) {
  if (!soup)
    return;
  vxm_context *context = soup->context;
  for (size_t t = 0; t < soup->tag_count; t++)
    vxm_free(context, soup->tags[t]);
  vxm_free(context, soup->tags);
  for (size_t c = 0; c < soup->companion_count; c++)
    vxm_free(context, soup->companions[c]);
  vxm_free(context, soup->companions);
  vxm_appearance_destroy(soup->appearance);
  vxm_free(context, soup->part_changes);
  vxm_free(context, soup->part_states);
  vxm_free(context, soup->face_sets);
  vxm_free(context, soup->face_parts);
  vxm_free(context, soup->components);
  vxm_free(context, soup->face_tags);
  vxm_free(context, soup->indices);
  vxm_free(context, soup->offsets);
  vxm_free(context, soup->positions);
  vxm_free(context, soup);
  vxm_context_release(context);
}

vxm_status vxm_soup_reserve(vxm_soup *soup, size_t vertices, size_t faces, size_t corners, vxm_error *error) {
  vxm_context *context = soup->context;
  if (vertices > VXM_VERTICES_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu vertices; at most %zu can be held: split the mesh", vertices,
                    VXM_VERTICES_MAX);
  vxm_status status = vxm_grow(context, (void **)&soup->positions, &soup->vertex_capacity, vertices,
                               3 * sizeof *soup->positions, error);
  if (status == VXM_OK && faces > soup->face_capacity) {
    /* offsets hold one more element than there are faces */
    size_t capacity = soup->face_capacity;
    status = vxm_grow(context, (void **)&soup->offsets, &capacity, faces + 1, sizeof *soup->offsets, error);
    if (status == VXM_OK)
      soup->face_capacity = capacity - 1;
  }
  if (status == VXM_OK)
    status = vxm_grow(context, (void **)&soup->indices, &soup->corner_capacity, corners,
                      sizeof *soup->indices, error);
  return status;
}

vxm_status vxm_soup_add_vertex(vxm_soup *soup, double x, double y, double z, vxm_error *error) {
  if (soup->vertex_count == soup->vertex_capacity) {
    vxm_status status = vxm_soup_reserve(soup, soup->vertex_count + 1, 0, 0, error);
    if (status != VXM_OK)
      return status;
  }
  double *p = soup->positions + 3 * soup->vertex_count++;
  p[0] = x;
  p[1] = y;
  p[2] = z;
  return VXM_OK;
}

vxm_status vxm_soup_add_vertices(vxm_soup *soup, const vxm_soup *from, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t v = 0; v < from->vertex_count && status == VXM_OK; v++) {
    const double *p = vxm_position(from, v);
    status = vxm_soup_add_vertex(soup, p[0], p[1], p[2], error);
  }
  return status;
}

vxm_status vxm_soup_add_face(vxm_soup *soup, const uint32_t *corners, size_t count, vxm_error *error) {
  if (soup->face_count == soup->face_capacity || count > soup->corner_capacity - soup->corner_count) {
    vxm_status status = vxm_soup_reserve(soup, 0, soup->face_count + 1, soup->corner_count + count, error);
    if (status != VXM_OK)
      return status;
  }
  if (count > 0)
    memcpy(soup->indices + soup->corner_count, corners, count * sizeof *corners);
  soup->corner_count += count;
  soup->offsets[++soup->face_count] = soup->corner_count;
  return VXM_OK;
}

vxm_status vxm_soup_add_tag(vxm_soup *soup, const char *name, size_t length, uint32_t *tag,
                            vxm_error *error) {
  vxm_status status = vxm_grow(soup->context, (void **)&soup->tags, &soup->tag_capacity, soup->tag_count + 1,
                               sizeof *soup->tags, error);
  if (status != VXM_OK)
    return status;
  char *copy = vxm_try_alloc(soup->context, length + 1, 1, &status, error);
  if (!copy)
    return status;
  memcpy(copy, name, length);
  copy[length] = '\0';
  *tag = (uint32_t)soup->tag_count;
  soup->tags[soup->tag_count++] = copy;
  return VXM_OK;
}

vxm_status vxm_soup_add_companion(vxm_soup *soup, const char *name, vxm_error *error) {
  for (size_t c = 0; c < soup->companion_count; c++)
    if (strcmp(soup->companions[c], name) == 0)
      return VXM_OK;
  vxm_status status = vxm_grow(soup->context, (void **)&soup->companions, &soup->companion_capacity,
                               soup->companion_count + 1, sizeof *soup->companions, error);
  if (status != VXM_OK)
    return status;
  char *copy = vxm_try_alloc(soup->context, strlen(name) + 1, 1, &status, error);
  if (!copy)
    return status;
  strcpy(copy, name);
  soup->companions[soup->companion_count++] = copy;
  return VXM_OK;
}

/** So much at a time that the copy of a large soup can be cancelled. */
static vxm_status copy_bytes(vxm_context *context, void *to, const void *from, size_t size,
                             vxm_error *error) {
  enum { CHUNK = 1 << 22 };
  vxm_status status = VXM_OK;
  for (size_t done = 0; done < size && status == VXM_OK; done += CHUNK) {
    memcpy((char *)to + done, (const char *)from + done, size - done < CHUNK ? size - done : CHUNK);
    status = vxm_check_cancelled(context, error);
  }
  return status;
}

vxm_status vxm_soup_copy(vxm_soup **out, const vxm_soup *soup, vxm_error *error) {
  vxm_soup *copy;
  vxm_status status = vxm_soup_create(&copy, soup->context, soup->format, error);
  if (status != VXM_OK)
    return status;
  status = vxm_soup_reserve(copy, soup->vertex_count, soup->face_count, soup->corner_count, error);
  if (status == VXM_OK && soup->face_tags) {
    vxm_error local = VXM_ERROR_INIT;
    copy->face_tags = vxm_alloc(copy->context, soup->face_count, sizeof *copy->face_tags, &local);
    if (!copy->face_tags) {
      status = local.code;
      vxm_error_pass(error, &local);
    } else
      memcpy(copy->face_tags, soup->face_tags, soup->face_count * sizeof *copy->face_tags);
  }
  for (size_t t = 0; status == VXM_OK && t < soup->tag_count; t++) {
    uint32_t tag;
    status = vxm_soup_add_tag(copy, soup->tags[t], strlen(soup->tags[t]), &tag, error);
  }
  vxm_context *context = copy->context;
  if (status == VXM_OK)
    status = copy_bytes(context, copy->positions, soup->positions,
                        3 * soup->vertex_count * sizeof *copy->positions, error);
  if (status == VXM_OK)
    status = copy_bytes(context, copy->offsets, soup->offsets, (soup->face_count + 1) * sizeof *copy->offsets,
                        error);
  if (status == VXM_OK)
    status =
        copy_bytes(context, copy->indices, soup->indices, soup->corner_count * sizeof *copy->indices, error);
  if (status != VXM_OK) {
    vxm_soup_destroy(copy);
    *out = NULL;
    return status;
  }
  copy->vertex_count = soup->vertex_count;
  copy->face_count = soup->face_count;
  copy->corner_count = soup->corner_count;
  copy->warnings = soup->warnings;
  *out = copy;
  return VXM_OK;
}

void vxm_soup_reverse_face(vxm_soup *soup, size_t face) {
  uint32_t *corner = soup->indices + soup->offsets[face];
  size_t count = (size_t)(soup->offsets[face + 1] - soup->offsets[face]);
  for (size_t i = 1, j = count; i < j; i++) {
    j--;
    uint32_t kept = corner[i];
    corner[i] = corner[j];
    corner[j] = kept;
  }
}
