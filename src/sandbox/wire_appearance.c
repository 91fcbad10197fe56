/* SPDX-License-Identifier: BSD-3-Clause */
#include "sandbox/wire_appearance.h"

#include <math.h>
#include <string.h>

#include "sandbox/wire_message.h"

/** Ahead of the arrays, which follow in the order of these counts; behind each image its bytes. */
typedef struct look_counts {
  uint64_t vertex_colors, face_colors, corner_uvs, face_materials, materials, images, is_product;
} look_counts;

/* ---- Sending ---- */

bool vxm_wire_send_appearance(int channel, const vxm_appearance *appearance) {
  const look_counts counts = {.vertex_colors = appearance->vertex_color_count,
                              .face_colors = appearance->face_color_count,
                              .corner_uvs = appearance->corner_uv_count,
                              .face_materials = appearance->face_material_count,
                              .materials = appearance->material_count,
                              .images = appearance->image_count,
                              .is_product = appearance->is_product};
  bool sent = vxm_message_send(channel, &counts, sizeof counts) &&
              vxm_message_send(channel, appearance->vertex_colors,
                               appearance->vertex_color_count * sizeof *appearance->vertex_colors) &&
              vxm_message_send(channel, appearance->face_colors,
                               appearance->face_color_count * sizeof *appearance->face_colors) &&
              vxm_message_send(channel, appearance->corner_uvs,
                               appearance->corner_uv_count * sizeof *appearance->corner_uvs) &&
              vxm_message_send(channel, appearance->face_materials,
                               appearance->face_material_count * sizeof *appearance->face_materials) &&
              vxm_message_send(channel, appearance->materials,
                               appearance->material_count * sizeof *appearance->materials);
  for (size_t i = 0; i < appearance->image_count && sent; i++) {
    vxm_image image = appearance->images[i];
    image.bytes = NULL;
    sent = vxm_message_send(channel, &image, sizeof image) &&
           vxm_message_send(channel, appearance->images[i].bytes, (size_t)image.size);
  }
  return sent;
}

/* ---- Receiving ---- */

/** Fills a new array; none where the count is 0. */
static vxm_status receive_array(void **out, size_t *out_count, uint64_t count, size_t size,
                                vxm_context *context, vxm_process *sender, vxm_error *error) {
  vxm_status status = VXM_OK;
  if (count == 0)
    return VXM_OK;
  *out = vxm_try_alloc(context, (size_t)count, size, &status, error);
  if (!*out)
    return status;
  *out_count = (size_t)count;
  return vxm_process_receive(sender, *out, (size_t)count * size, error);
}

static bool is_sound_material(vxm_material *material, uint64_t images) {
  bool good = (material->image == VXM_APPEARANCE_NONE || material->image < images) &&
              material->wrap[0] <= VXM_WRAP_MIRROR && material->wrap[1] <= VXM_WRAP_MIRROR;
  unsigned char has_color;
  memcpy(&has_color, &material->has_color, 1); /* as a byte: a bool may hold anything */
  for (int c = 0; c < 3; c++)
    good = good && isfinite(material->color[c]);
  vxm_message_sanitize(material->name, sizeof material->name);
  return good && has_color <= 1;
}

static vxm_status receive_image(vxm_image *image, vxm_context *context, vxm_process *sender,
                                vxm_error *error) {
  vxm_status status = vxm_process_receive(sender, image, sizeof *image, error);
  image->bytes = NULL;
  if (status != VXM_OK)
    return status;
  vxm_message_sanitize(image->name, sizeof image->name);
  vxm_message_sanitize(image->failure, sizeof image->failure);
  uint64_t pixels = (uint64_t)image->width * image->height;
  bool is_decoded = image->width > 0 || image->height > 0;
  if ((is_decoded && (pixels == 0 || pixels > VXM_PIXELS_MAX || image->size != 4 * pixels)) ||
      image->size > UINT64_C(1) << 40)
    return vxm_message_damaged(error);
  size_t size = 0;
  return receive_array((void **)&image->bytes, &size, image->size, 1, context, sender, error);
}

static vxm_status receive_images(vxm_appearance *appearance, uint64_t count, vxm_process *sender,
                                 vxm_error *error) {
  vxm_status status = VXM_OK;
  if (count == 0)
    return VXM_OK;
  appearance->images =
      vxm_try_calloc(appearance->context, (size_t)count, sizeof *appearance->images, &status, error);
  if (!appearance->images)
    return status;
  appearance->image_capacity = (size_t)count;
  while (appearance->image_count < count &&
         status == VXM_OK) /* counted first, as it may have bytes by then */
    status =
        receive_image(&appearance->images[appearance->image_count++], appearance->context, sender, error);
  return status;
}

vxm_status vxm_wire_receive_appearance(vxm_soup *soup, vxm_process *sender, vxm_error *error) {
  vxm_appearance *appearance = soup->appearance;
  vxm_context *context = soup->context;
  look_counts counts;
  vxm_status status = vxm_process_receive(sender, &counts, sizeof counts, error);
  if (status != VXM_OK)
    return status;
  enum { MOST = 1 << 24 };
  if ((counts.vertex_colors && counts.vertex_colors != soup->vertex_count) ||
      (counts.face_colors && counts.face_colors != soup->face_count) ||
      (counts.corner_uvs && counts.corner_uvs != soup->corner_count) ||
      counts.face_materials > soup->face_count || counts.materials > MOST || counts.images > MOST ||
      counts.is_product > 1)
    return vxm_message_damaged(error);
  appearance->is_product = counts.is_product;
  status = receive_array((void **)&appearance->vertex_colors, &appearance->vertex_color_count,
                         counts.vertex_colors, sizeof *appearance->vertex_colors, context, sender, error);
  if (status == VXM_OK)
    status = receive_array((void **)&appearance->face_colors, &appearance->face_color_count,
                           counts.face_colors, sizeof *appearance->face_colors, context, sender, error);
  if (status == VXM_OK)
    status = receive_array((void **)&appearance->corner_uvs, &appearance->corner_uv_count, counts.corner_uvs,
                           sizeof *appearance->corner_uvs, context, sender, error);
  if (status == VXM_OK)
    status = receive_array((void **)&appearance->face_materials, &appearance->face_material_count,
                           counts.face_materials, sizeof *appearance->face_materials, context, sender, error);
  if (status == VXM_OK)
    status = receive_array((void **)&appearance->materials, &appearance->material_count, counts.materials,
                           sizeof *appearance->materials, context, sender, error);
  bool good = true;
  for (size_t f = 0; f < appearance->face_material_count && status == VXM_OK; f++)
    good = good && (appearance->face_materials[f] == VXM_APPEARANCE_NONE ||
                    appearance->face_materials[f] < counts.materials);
  for (size_t m = 0; m < appearance->material_count && status == VXM_OK; m++)
    good = is_sound_material(&appearance->materials[m], counts.images) && good;
  if (status == VXM_OK && !good)
    status = vxm_message_damaged(error);
  return status == VXM_OK ? receive_images(appearance, counts.images, sender, error) : status;
}
