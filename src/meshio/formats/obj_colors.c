/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/formats/obj_colors.h"

#include <math.h>

/** Reads up to `most` numbers from the cursor to the end of the line; returns how many there are. */
static int read_numbers(vxm_tokenizer *scan, double *out, int most) {
  int count = 0;
  while (count < most && vxm_more_on_line(scan) && vxm_tokenizer_double(scan, &out[count]))
    count++;
  return count;
}

vxm_status vxm_obj_colors_vertex(vxm_tokenizer *scan, vxm_error *error) {
  double rgba[4] = {0, 0, 0, 0};
  vxm_soup *soup = scan->soup;
  /* One more number is the weight of a rational curve, and no colour. */
  if (read_numbers(scan, rgba, 4) < 3)
    return VXM_OK;
  return vxm_gather_color(&soup->appearance->vertices, soup->context, soup->vertex_count, rgba, error);
}

vxm_status vxm_obj_colors_uv(vxm_obj_colors *colors, vxm_tokenizer *scan, vxm_error *error) {
  double uv[2] = {0, 0};
  vxm_status status = vxm_grow(scan->soup->context, (void **)&colors->uvs, &colors->uv_capacity,
                               colors->uv_count + 1, sizeof *colors->uvs, error);
  if (status != VXM_OK)
    return status;
  bool is_there = read_numbers(scan, uv, 2) > 0;
  for (int c = 0; c < 2; c++)
    colors->uvs[colors->uv_count][c] = is_there ? (float)uv[c] : NAN;
  colors->uv_count++;
  return VXM_OK;
}

/** The index between the first and the second slash of a corner; VXM_NO_VERTEX if there is none. */
static uint32_t uv_index(const vxm_obj_colors *colors, const unsigned char *at, const unsigned char *end) {
  const unsigned char *slash = memchr(at, '/', (size_t)(end - at));
  uint64_t value = 0;
  if (!slash)
    return VXM_NO_VERTEX;
  const unsigned char *p = slash + 1;
  bool is_back = p < end && *p == '-';
  for (p += is_back; p < end && vxm_is_digit(*p) && value < UINT32_MAX; p++)
    value = 10 * value + (uint64_t)(*p - '0');
  if (is_back)
    value = value <= colors->uv_count ? colors->uv_count + 1 - value : 0;
  return value == 0 || value > UINT32_MAX - 1 ? VXM_NO_VERTEX : (uint32_t)(value - 1);
}

static bool is_between(unsigned char c) {
  return vxm_is_blank(c) || vxm_is_newline(c) || c == '\\';
}

vxm_status vxm_obj_colors_face(vxm_obj_colors *colors, const vxm_tokenizer *scan, const unsigned char *first,
                               vxm_error *error) {
  vxm_soup *soup = scan->soup;
  vxm_status status = vxm_grow(soup->context, (void **)&colors->corner_uvs, &colors->corner_capacity,
                               soup->corner_count, sizeof *colors->corner_uvs, error);
  const unsigned char *at = first, *const end = scan->at;
  while (status == VXM_OK && colors->corner_count < soup->corner_count) {
    while (at < end && is_between(*at))
      at++;
    const unsigned char *from = at;
    while (at < end && !is_between(*at))
      at++;
    colors->corner_uvs[colors->corner_count++] = uv_index(colors, from, at);
  }
  if (status == VXM_OK && colors->material)
    status = vxm_appearance_set_material(soup->appearance, soup->face_count - 1, colors->material - 1, error);
  return status;
}

static void cut_blanks(const unsigned char **name, size_t *length) {
  while (*length > 0 && vxm_is_blank(**name)) {
    ++*name;
    --*length;
  }
  while (*length > 0 && vxm_is_blank((*name)[*length - 1]))
    --*length;
}

vxm_status vxm_obj_colors_material(vxm_obj_colors *colors, vxm_soup *soup, const unsigned char *name,
                                   size_t length, vxm_error *error) {
  uint32_t material = 0;
  cut_blanks(&name, &length);
  vxm_status status = vxm_appearance_material(soup->appearance, (const char *)name, length, &material, error);
  colors->material = material + 1;
  return status;
}

vxm_status vxm_obj_colors_library(vxm_soup *soup, const unsigned char *names, size_t length,
                                  vxm_error *error) {
  vxm_appearance *appearance = soup->appearance;
  cut_blanks(&names, &length);
  vxm_status status = vxm_grow(soup->context, (void **)&appearance->libraries, &appearance->library_capacity,
                               appearance->library_bytes + length + 1, 1, error);
  if (status != VXM_OK || length == 0)
    return status;
  memcpy(appearance->libraries + appearance->library_bytes, names, length);
  appearance->libraries[appearance->library_bytes + length] = '\n';
  appearance->library_bytes += length + 1;
  return VXM_OK;
}

vxm_status vxm_obj_colors_finish(vxm_obj_colors *colors, vxm_soup *soup, vxm_error *error) {
  vxm_appearance *appearance = soup->appearance;
  vxm_status status = VXM_OK;
  if (colors->uv_count == 0 || soup->corner_count == 0)
    return VXM_OK;
  appearance->corner_uvs =
      vxm_try_alloc(soup->context, soup->corner_count, sizeof *appearance->corner_uvs, &status, error);
  if (!appearance->corner_uvs)
    return status;
  appearance->corner_uv_count = soup->corner_count;
  for (size_t c = 0; c < soup->corner_count; c++) {
    uint32_t index = colors->corner_uvs[c];
    for (int a = 0; a < 2; a++)
      appearance->corner_uvs[c][a] = index < colors->uv_count ? colors->uvs[index][a] : NAN;
  }
  return VXM_OK;
}

void vxm_obj_colors_destroy(vxm_obj_colors *colors, vxm_context *context) {
  vxm_free(context, colors->uvs);
  vxm_free(context, colors->corner_uvs);
}
