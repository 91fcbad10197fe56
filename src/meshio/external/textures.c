/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/external/textures.h"
#include "base/file.h"
#include "meshio/formats/mtl.h"
#include "sandbox/reader_process.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { LIBRARIES_MAX = 64 };

/** Where the last refusal is told, in the words of `references`. */
static void take_refusal(char *out, size_t size, const vxm_references *references, int before) {
  const vxm_warnings *warnings = &references->warnings;
  bool is_new = warnings->count > before;
  snprintf(out, size, "%.*s", (int)size - 1,
           is_new ? warnings->text[warnings->count - 1] : "it was not opened");
}

/** Opens what the mesh refers to and maps it; false if it is not to be had. */
static bool open_reference(vxm_input *input, vxm_soup *soup, vxm_references *references, const char *name,
                           vxm_status *status, vxm_error *error) {
  uint64_t size;
  size_t left = vxm_memory_left(soup->context);
  int file = vxm_reference_open(references, name, left < SIZE_MAX ? left : UINT64_MAX, &size);
  if (file < 0)
    return false;
  *status = vxm_input_take(input, soup->context, name, file, error);
  close(file);
  return *status == VXM_OK;
}

/* ---- Materials ---- */

static vxm_status read_library(vxm_soup *soup, vxm_references *references, const char *name,
                               vxm_error *error) {
  vxm_input input;
  vxm_status status = VXM_OK;
  char *failure = soup->appearance->library_failure;
  int before = references->warnings.count;
  if (!open_reference(&input, soup, references, name, &status, error)) {
    if (!failure[0])
      take_refusal(failure, VXM_APPEARANCE_FAILURE, references, before);
    return status;
  }
  status = vxm_mtl_read(soup->appearance, input.data, input.size, name, error);
  vxm_input_close(&input);
  return status;
}

/** Where the first name of a line ends: names may have blanks, so behind ".mtl" where a blank follows. */
static size_t first_name(const char *line, size_t length) {
  const char *found = memmem(line, length, ".mtl ", 5);
  return found ? (size_t)(found - line) + 4 : length;
}

/** Reads the files that the lines of `libraries` name. */
static vxm_status read_libraries(vxm_soup *soup, vxm_references *references, vxm_error *error) {
  vxm_appearance *appearance = soup->appearance;
  const char *at = appearance->libraries, *end = at + appearance->library_bytes;
  vxm_status status = VXM_OK;
  char name[VXM_APPEARANCE_NAME];
  for (int n = 0; at < end && n < LIBRARIES_MAX && status == VXM_OK; n++) {
    const char *line_end = memchr(at, '\n', (size_t)(end - at));
    size_t length = first_name(at, (size_t)(line_end - at));
    if (length < sizeof name && !memchr(at, 0, length)) {
      memcpy(name, at, length);
      name[length] = '\0';
      for (char *c = name; *c; c++)
        *c = *c == '\\' ? '/' : *c;
      status = read_library(soup, references, name, error);
    } else
      vxm_warn(&soup->warnings, "the name of a file of materials has more than %d bytes; passed over",
               VXM_APPEARANCE_NAME - 1);
    at += length;
    at += *at == ' ' ? strspn(at, " ") : 1;
  }
  return status;
}

/** Materials that no file describes: told together. */
static void note_missing(vxm_soup *soup) {
  const vxm_appearance *appearance = soup->appearance;
  const char *first = NULL;
  size_t missing = 0;
  for (size_t m = 0; m < appearance->material_count; m++)
    if (!appearance->materials[m].has_color && appearance->materials[m].image == VXM_APPEARANCE_NONE) {
      first = first ? first : appearance->materials[m].name;
      missing++;
    }
  if (missing == 1 && appearance->library_bytes > 0)
    vxm_warn(&soup->warnings,
             "the material \"%.100s\" has no colour: no .mtl file that could be read describes it", first);
  else if (missing > 0 && appearance->library_bytes > 0)
    vxm_warn(
        &soup->warnings,
        "%zu of %zu materials have no colour, \"%.100s\" first: no .mtl file that could be read describes "
        "them",
        missing, appearance->material_count, first);
}

/* ---- Pictures ---- */

static vxm_status fetch(vxm_image *image, vxm_soup *soup, vxm_references *references, vxm_error *error) {
  vxm_input input;
  vxm_status status = VXM_OK;
  int before = references->warnings.count;
  if (!open_reference(&input, soup, references, image->name, &status, error)) {
    if (status == VXM_OK)
      take_refusal(image->failure, sizeof image->failure, references, before);
    return status;
  }
  image->bytes = vxm_try_alloc(soup->context, input.size, 1, &status, error);
  if (image->bytes) {
    memcpy(image->bytes, input.data, input.size);
    image->size = input.size;
  }
  vxm_input_close(&input);
  return status;
}

static bool is_fatal(vxm_status status) {
  return vxm_is_memory(status) || status == VXM_ERROR_CANCELLED;
}

/** Puts the picture that the reading process has made in the place of its file. */
static void take_decoded(vxm_image *image, vxm_appearance *from) {
  vxm_image *decoded = &from->images[0];
  vxm_free(from->context, image->bytes);
  image->bytes = decoded->bytes;
  image->size = decoded->size;
  image->width = decoded->width;
  image->height = decoded->height;
  decoded->bytes = NULL;
}

static void drop_bytes(vxm_image *image, vxm_context *context, const char *failure) {
  vxm_free(context, image->bytes);
  image->bytes = NULL;
  image->size = 0;
  snprintf(image->failure, sizeof image->failure, "%.*s", VXM_APPEARANCE_FAILURE - 1, failure);
}

static vxm_status decode(vxm_image *image, vxm_soup *soup, vxm_error *error) {
  const vxm_reader_request request = {
      .data = image->bytes, .size = (size_t)image->size, .name = image->name, .hint = "image"};
  vxm_error local = VXM_ERROR_INIT;
  vxm_soup *made;
  vxm_status status = vxm_reader_process_picture(&made, soup->context, "reading textures", &request, &local);
  if (status == VXM_OK && made->appearance->image_count == 1 && made->appearance->images[0].width > 0)
    take_decoded(image, made->appearance);
  else if (status == VXM_OK)
    drop_bytes(image, soup->context, "no picture was made of it");
  else if (!is_fatal(status)) {
    drop_bytes(image, soup->context, local.text);
    status = VXM_OK;
  } else
    vxm_error_pass(error, &local);
  vxm_soup_destroy(made);
  return status;
}

/** The first material that a picture is for. */
static const char *user_of(const vxm_appearance *appearance, size_t image) {
  for (size_t m = 0; m < appearance->material_count; m++)
    if (appearance->materials[m].image == image)
      return appearance->materials[m].name;
  return "";
}

static vxm_status read_image(vxm_soup *soup, size_t index, vxm_references *references, vxm_error *error) {
  vxm_appearance *appearance = soup->appearance;
  vxm_image *image = &appearance->images[index];
  bool is_refused = false;
  vxm_status status = VXM_OK;
  if (!image->bytes && !image->failure[0]) {
    status = fetch(image, soup, references, error);
    is_refused = image->failure[0];
  }
  if (status == VXM_OK && image->bytes && image->width == 0)
    status = decode(image, soup, error);
  if (status == VXM_OK && image->failure[0] && !is_refused) /* a refusal has been told as such */
    vxm_warn(&soup->warnings, "the texture %.100s of material %.60s cannot be read: %.120s", image->name,
             user_of(appearance, index), image->failure);
  return status;
}

vxm_status vxm_textures_read(vxm_soup *soup, vxm_references *references, vxm_error *error) {
  vxm_appearance *appearance = soup->appearance;
  vxm_status status = vxm_appearance_settle(appearance, soup->vertex_count, soup->face_count, error);
  const vxm_warnings refused_before = references->warnings;
  references->warnings.count = 0;
  if (status == VXM_OK && appearance->library_bytes > 0) {
    status = read_libraries(soup, references, error);
    note_missing(soup);
  }
  for (size_t i = 0; i < appearance->image_count && status == VXM_OK; i++)
    status = read_image(soup, i, references, error);
  for (int n = 0; n < references->warnings.count; n++)
    vxm_warn(&soup->warnings, "%s", references->warnings.text[n]);
  references->warnings = refused_before;
  return status;
}
