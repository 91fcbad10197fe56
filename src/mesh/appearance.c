/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/appearance.h"
#include "base/hash.h"

#include <math.h>
#include <string.h>

vxm_status vxm_appearance_create(vxm_appearance **out, vxm_context *context, vxm_error *error) {
  vxm_status status = VXM_OK;
  *out = vxm_try_calloc(context, 1, sizeof **out, &status, error);
  if (!*out)
    return status;
  (*out)->context = context;
  return VXM_OK;
}

void vxm_appearance_destroy(vxm_appearance *appearance) {
  if (!appearance)
    return;
  vxm_context *context = appearance->context;
  for (size_t i = 0; i < appearance->image_count; i++)
    vxm_free(context, appearance->images[i].bytes);
  vxm_free(context, appearance->libraries);
  vxm_free(context, appearance->vertices.rgb);
  vxm_free(context, appearance->faces.rgb);
  vxm_free(context, appearance->images);
  vxm_free(context, appearance->materials);
  vxm_free(context, appearance->material_names.slots);
  vxm_free(context, appearance->image_names.slots);
  vxm_free(context, appearance->face_materials);
  vxm_free(context, appearance->corner_uvs);
  vxm_free(context, appearance->face_colors);
  vxm_free(context, appearance->vertex_colors);
  vxm_free(context, appearance);
}

/* ---- Light ---- */

uint8_t vxm_srgb_encode(double light) {
  if (!(light > 0))
    return 0;
  double value = light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
  return value >= 1 ? 255 : (uint8_t)(value * 255 + 0.5);
}

double vxm_srgb_decode(double value) {
  return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

/* ---- Colours ---- */

vxm_status vxm_gather_color(vxm_gathered *gathered, vxm_context *context, size_t index, const double rgba[4],
                            vxm_error *error) {
  vxm_status status = vxm_grow(context, (void **)&gathered->rgb, &gathered->capacity, index + 1,
                               sizeof *gathered->rgb, error);
  if (status != VXM_OK)
    return status;
  for (; gathered->count < index; gathered->count++)
    for (int c = 0; c < 3; c++)
      gathered->rgb[gathered->count][c] = NAN;
  for (int c = 0; c < 3; c++)
    gathered->rgb[index][c] = isfinite(rgba[c]) ? (float)rgba[c] : 0;
  for (int c = 0; c < 4; c++)
    if (isfinite(rgba[c]) && (float)rgba[c] > gathered->largest)
      gathered->largest = (float)rgba[c];
  if (gathered->count <= index)
    gathered->count = index + 1;
  return VXM_OK;
}

static uint8_t byte_of(float value, float unit) {
  float scaled = value * (255 / unit);
  return !(scaled > 0) ? 0 : scaled >= 255 ? 255 : (uint8_t)(scaled + 0.5F);
}

static vxm_status settle(uint8_t (**out)[4], size_t *out_count, vxm_gathered *gathered, size_t count,
                         vxm_context *context, vxm_error *error) {
  if (gathered->count == 0 || count == 0)
    return VXM_OK;
  vxm_status status = VXM_OK;
  *out = vxm_try_calloc(context, count, sizeof **out, &status, error);
  if (!*out)
    return status;
  *out_count = count;
  float unit = gathered->unit > 0 ? gathered->unit : gathered->largest > 1 ? 255.0F : 1.0F;
  for (size_t i = 0; i < count && i < gathered->count; i++) {
    const float *rgb = gathered->rgb[i];
    for (int c = 0; c < 3; c++)
      (*out)[i][c] = byte_of(rgb[c], unit);
    (*out)[i][3] = isnan(rgb[0]) ? 0 : 255;
  }
  vxm_free(context, gathered->rgb);
  *gathered = (vxm_gathered){0};
  return VXM_OK;
}

vxm_status vxm_appearance_settle(vxm_appearance *appearance, size_t vertices, size_t faces,
                                 vxm_error *error) {
  vxm_status status = settle(&appearance->vertex_colors, &appearance->vertex_color_count,
                             &appearance->vertices, vertices, appearance->context, error);
  if (status == VXM_OK)
    status = settle(&appearance->face_colors, &appearance->face_color_count, &appearance->faces, faces,
                    appearance->context, error);
  return status;
}

/* ---- Materials and images ---- */

static void take_name(char out[VXM_APPEARANCE_NAME], const char *name, size_t length) {
  size_t kept = length < VXM_APPEARANCE_NAME - 1 ? length : VXM_APPEARANCE_NAME - 1;
  for (size_t i = 0; i < kept; i++) /* it will stand in messages */
    out[i] = (unsigned char)name[i] < ' ' || name[i] == 0x7f ? '?' : name[i];
  out[kept] = '\0';
}

/** Names in a list of structs. */
typedef struct name_list {
  const void *first; /**< name of the first struct */
  size_t stride;
} name_list;

static name_list materials_of(const vxm_appearance *appearance) {
  return (name_list){appearance->materials ? appearance->materials->name : NULL,
                     sizeof *appearance->materials};
}

static name_list images_of(const vxm_appearance *appearance) {
  return (name_list){appearance->images ? appearance->images->name : NULL, sizeof *appearance->images};
}

static const char *name_at(name_list list, size_t number) {
  return (const char *)list.first + number * list.stride;
}

/** The slot of a name, or the free one where it belongs. */
static uint32_t *find_slot(const vxm_name_index *index, name_list list, const char *name) {
  uint64_t hash = UINT64_C(14695981039346656037); /* FNV-1a, mixed */
  for (const char *c = name; *c; c++)
    hash = (hash ^ (unsigned char)*c) * UINT64_C(1099511628211);
  size_t mask = index->capacity - 1, at = (size_t)vxm_mix(hash) & mask;
  while (index->slots[at] && strcmp(name_at(list, index->slots[at] - 1), name) != 0)
    at = (at + 1) & mask;
  return &index->slots[at];
}

/** Makes room for one more, so that a quarter stays free at least. */
static vxm_status widen(vxm_name_index *index, vxm_context *context, name_list list, vxm_error *error) {
  if (4 * (index->count + 1) <= 3 * index->capacity)
    return VXM_OK;
  vxm_name_index wider = {.capacity = index->capacity ? 2 * index->capacity : 64, .count = index->count};
  vxm_status status = VXM_OK;
  wider.slots = vxm_try_calloc(context, wider.capacity, sizeof *wider.slots, &status, error);
  if (!wider.slots)
    return status;
  for (size_t s = 0; s < index->capacity; s++)
    if (index->slots[s])
      *find_slot(&wider, list, name_at(list, index->slots[s] - 1)) = index->slots[s];
  vxm_free(context, index->slots);
  *index = wider;
  return VXM_OK;
}

vxm_status vxm_appearance_add_material(vxm_appearance *appearance, const char *name, size_t length,
                                       uint32_t *material, vxm_error *error) {
  vxm_status status =
      vxm_grow(appearance->context, (void **)&appearance->materials, &appearance->material_capacity,
               appearance->material_count + 1, sizeof *appearance->materials, error);
  if (status != VXM_OK)
    return status;
  *material = (uint32_t)appearance->material_count++;
  vxm_material *made = &appearance->materials[*material];
  *made = (vxm_material){.color = {1, 1, 1}, .image = VXM_APPEARANCE_NONE};
  take_name(made->name, name, length);
  return VXM_OK;
}

vxm_status vxm_appearance_material(vxm_appearance *appearance, const char *name, size_t length,
                                   uint32_t *material, vxm_error *error) {
  char cut[VXM_APPEARANCE_NAME];
  take_name(cut, name, length);
  vxm_name_index *index = &appearance->material_names;
  vxm_status status = widen(index, appearance->context, materials_of(appearance), error);
  uint32_t *slot = status == VXM_OK ? find_slot(index, materials_of(appearance), cut) : NULL;
  if (!slot || *slot) {
    *material = slot ? *slot - 1 : 0;
    return status;
  }
  status = vxm_appearance_add_material(appearance, name, length, material, error);
  if (status == VXM_OK) {
    *slot = *material + 1;
    index->count++;
  }
  return status;
}

bool vxm_appearance_find_material(const vxm_appearance *appearance, const char *name, size_t length,
                                  uint32_t *material) {
  char cut[VXM_APPEARANCE_NAME];
  take_name(cut, name, length);
  if (appearance->material_names.capacity == 0)
    return false;
  const uint32_t *slot = find_slot(&appearance->material_names, materials_of(appearance), cut);
  *material = *slot - 1;
  return *slot != 0;
}

vxm_status vxm_appearance_image(vxm_appearance *appearance, const char *name, size_t length, uint32_t *image,
                                vxm_error *error) {
  char cut[VXM_APPEARANCE_NAME];
  take_name(cut, name, length);
  vxm_name_index *index = &appearance->image_names;
  vxm_status status = widen(index, appearance->context, images_of(appearance), error);
  if (status != VXM_OK)
    return status;
  uint32_t *slot = find_slot(index, images_of(appearance), cut);
  if (*slot) {
    *image = *slot - 1;
    return VXM_OK;
  }
  status = vxm_grow(appearance->context, (void **)&appearance->images, &appearance->image_capacity,
                    appearance->image_count + 1, sizeof *appearance->images, error);
  if (status != VXM_OK)
    return status;
  *image = (uint32_t)appearance->image_count++;
  *slot = *image + 1;
  index->count++;
  memset(&appearance->images[*image], 0, sizeof *appearance->images);
  memcpy(appearance->images[*image].name, cut, sizeof cut);
  return VXM_OK;
}

vxm_status vxm_appearance_set_material(vxm_appearance *appearance, size_t face, uint32_t material,
                                       vxm_error *error) {
  vxm_status status =
      vxm_grow(appearance->context, (void **)&appearance->face_materials, &appearance->face_material_capacity,
               face + 1, sizeof *appearance->face_materials, error);
  if (status != VXM_OK)
    return status;
  while (appearance->face_material_count < face)
    appearance->face_materials[appearance->face_material_count++] = VXM_APPEARANCE_NONE;
  appearance->face_materials[face] = material;
  appearance->face_material_count = face + 1;
  return VXM_OK;
}

/* ---- Faces that are left out ---- */

void vxm_appearance_move_face(vxm_appearance *appearance, size_t to, size_t from, size_t to_corner,
                              size_t from_corner, size_t corners) {
  if (from < appearance->faces.count)
    memcpy(appearance->faces.rgb[to], appearance->faces.rgb[from], sizeof appearance->faces.rgb[to]);
  if (from < appearance->face_material_count)
    appearance->face_materials[to] = appearance->face_materials[from];
  if (from_corner + corners <= appearance->corner_uv_count)
    memmove(appearance->corner_uvs + to_corner, appearance->corner_uvs + from_corner,
            corners * sizeof *appearance->corner_uvs);
}

bool vxm_appearance_has_colors(const vxm_appearance *appearance) {
  if (!appearance)
    return false;
  bool has = appearance->vertex_colors || appearance->face_colors;
  for (size_t m = 0; m < appearance->material_count && appearance->face_materials && !has; m++) {
    const vxm_material *material = &appearance->materials[m];
    has = material->has_color || (material->image < appearance->image_count &&
                                  appearance->images[material->image].width > 0 && appearance->corner_uvs);
  }
  return has;
}
