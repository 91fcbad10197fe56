/* SPDX-License-Identifier: BSD-3-Clause */
/** What a mesh looks like: colours of vertices and faces, materials and their textures, as they were read. */
#ifndef VXM_MESH_APPEARANCE_H
#define VXM_MESH_APPEARANCE_H

#include "base/context.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { VXM_APPEARANCE_NAME = 128, VXM_APPEARANCE_FAILURE = 200 };

/** A picture of more is refused: four bytes each are 1 GiB. */
#define VXM_PIXELS_MAX (UINT64_C(1) << 28)

/** No material, or no image. */
#define VXM_APPEARANCE_NONE UINT32_MAX

/** What a texture shows beyond its borders. */
typedef enum vxm_wrap { VXM_WRAP_REPEAT, VXM_WRAP_CLAMP, VXM_WRAP_MIRROR } vxm_wrap;

/** A picture. Its rows go from the top down; the texture coordinate v goes up from the last row. */
typedef struct vxm_image {
  unsigned char *bytes; /**< once it is decoded 4 for each pixel: red, green, blue (sRGB), alpha; before that
                           the file, or NULL if there is none */
  uint64_t size;        /**< of the bytes */
  uint32_t width, height; /**< 0 = not decoded */
  char name[VXM_APPEARANCE_NAME];
  char failure[VXM_APPEARANCE_FAILURE]; /**< why it cannot be had; "" if it can */
} vxm_image;

typedef struct vxm_material {
  float color[3]; /**< in linear light */
  bool has_color;
  uint8_t wrap[2]; /**< vxm_wrap, along u and v */
  uint32_t image;  /**< or VXM_APPEARANCE_NONE */
  char name[VXM_APPEARANCE_NAME];
} vxm_material;

/** Where names stand in a list: a hash table of their numbers. */
typedef struct vxm_name_index {
  uint32_t *slots; /**< number + 1; 0 = free */
  size_t capacity; /**< a power of two, or 0 */
  size_t count;
} vxm_name_index;

/** Colours on their way from a file. */
typedef struct vxm_gathered {
  float (*rgb)[3]; /**< NaN where there is none */
  size_t count, capacity;
  float unit;    /**< what stands for full light: 1, 255; 0 = 255 if anything exceeds 1, otherwise 1 */
  float largest; /**< of all, alpha too */
} vxm_gathered;

/** Belongs to the faces of a soup as they were read. Arrays are NULL where the file has nothing of the kind.
 */
typedef struct vxm_appearance {
  vxm_context *context;        /**< that of the soup, which holds the reference */
  uint8_t (*vertex_colors)[4]; /**< red, green, blue in sRGB; the fourth is 0 where there is no colour */
  uint8_t (*face_colors)[4];
  float (*corner_uvs)[2];   /**< for each corner of the soup; NaN where there is none */
  uint32_t *face_materials; /**< or VXM_APPEARANCE_NONE */
  vxm_material *materials;
  vxm_image *images;
  size_t vertex_color_count, face_color_count, corner_uv_count, face_material_count;
  size_t material_count, image_count;
  bool is_product; /**< material, texture and vertex colour are multiplied, as in glTF; else the first of
                      texture, vertex, face and material counts */
  /* While it is read. */
  vxm_gathered vertices, faces;
  char *libraries;                              /**< names of .mtl files, a line each */
  char library_failure[VXM_APPEARANCE_FAILURE]; /**< why the first that was not opened was not; or "" */
  size_t library_bytes, library_capacity, material_capacity, image_capacity, face_material_capacity;
  vxm_name_index material_names, image_names;
} vxm_appearance;

vxm_status vxm_appearance_create(vxm_appearance **out, vxm_context *context, vxm_error *error);
/** NULL is allowed. */
void vxm_appearance_destroy(vxm_appearance *appearance);

/** Gives element `index` a colour; those left out before it have none. The fourth is alpha, which only tells
 * the unit. */
vxm_status vxm_gather_color(vxm_gathered *gathered, vxm_context *context, size_t index, const double rgba[4],
                            vxm_error *error);
/** Turns what was gathered into colours. */
vxm_status vxm_appearance_settle(vxm_appearance *appearance, size_t vertices, size_t faces, vxm_error *error);

/** Adds a material without colour and texture, or finds it by its name, which is cut if it is long. */
vxm_status vxm_appearance_material(vxm_appearance *appearance, const char *name, size_t length,
                                   uint32_t *material, vxm_error *error);
/** Finds a material that was added by its name. */
bool vxm_appearance_find_material(const vxm_appearance *appearance, const char *name, size_t length,
                                  uint32_t *material);
/** Adds a material, whatever its name. */
vxm_status vxm_appearance_add_material(vxm_appearance *appearance, const char *name, size_t length,
                                       uint32_t *material, vxm_error *error);
/** Adds an image that is not there yet, or finds it by its name. */
vxm_status vxm_appearance_image(vxm_appearance *appearance, const char *name, size_t length, uint32_t *image,
                                vxm_error *error);
/** Gives a face a material; those left out before it have none. */
vxm_status vxm_appearance_set_material(vxm_appearance *appearance, size_t face, uint32_t material,
                                       vxm_error *error);

/** A face, and `corners` of its corners from `from_corner` on, move toward the beginning. */
void vxm_appearance_move_face(vxm_appearance *appearance, size_t to, size_t from, size_t to_corner,
                              size_t from_corner, size_t corners);

/** Whether anything has a colour: a vertex, a face, or a material by itself or by a texture that is there. */
bool vxm_appearance_has_colors(const vxm_appearance *appearance);

/** The byte of linear light, and the light of a byte (IEC 61966-2-1). */
uint8_t vxm_srgb_encode(double light);
double vxm_srgb_decode(double value);

#ifdef __cplusplus
}
#endif
#endif
