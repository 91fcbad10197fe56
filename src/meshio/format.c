/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/common/format.h"
#include "base/module.h"
#include "base/open_beneath.h"
#include "mesh/nonfinite.h"
#include "meshio/common/utf16.h"
#include "meshio/external/external_formats.h"
#include "meshio/external/textures.h"
#include "meshio/formats/stl.h"
#include "meshio/meshio.h"
#include "sandbox/reader.h"

#include <fcntl.h>
#include <string.h>
#include <unistd.h>

static const vxm_format formats[] = {
    {"off", {"off", NULL}, vxm_off_sniff, vxm_off_read, vxm_off_write},
    {"obj", {"obj", NULL}, vxm_obj_sniff, vxm_obj_read, vxm_obj_write},
    {"stl", {"stl", "stla"}, vxm_stl_sniff, vxm_stl_read, vxm_stl_write},
    {"ply", {"ply", NULL}, vxm_ply_sniff, vxm_ply_read, vxm_ply_write},
};
enum { FORMATS = sizeof formats / sizeof *formats };

static const vxm_format *by_name(const char *name) {
  for (size_t f = 0; f < FORMATS; f++)
    if (vxm_text_equal_nocase(name, formats[f].name))
      return &formats[f];
  return NULL;
}

static const vxm_format *of_extension(const char *extension) {
  for (size_t f = 0; f < FORMATS; f++)
    for (size_t e = 0; e < 2; e++)
      if (formats[f].extensions[e] && vxm_text_equal_nocase(extension, formats[f].extensions[e]))
        return &formats[f];
  return NULL;
}

static const vxm_format *by_extension(const char *path) {
  return of_extension(vxm_path_extension(path));
}

/** What a file is that is no mesh, or NULL. */
static const char *find_stranger(const unsigned char *data, size_t size);

/** Who reads a file: one of our own readers, or a library. */
typedef struct choice {
  const vxm_format *own;
  const vxm_external_format *foreign;
} choice;

static choice choose(const unsigned char *data, size_t size, const char *name) {
  const vxm_format *possible = NULL;
  /* Before all else: the first 80 bytes of such a file are free, and some begin like another format. */
  if (vxm_stl_is_binary(data, size))
    return (choice){.own = by_name("stl")};
  for (size_t f = 0; f < FORMATS; f++) {
    vxm_likeness likeness = formats[f].sniff(data, size);
    if (likeness == VXM_LIKENESS_CERTAIN)
      return (choice){.own = &formats[f]};
    if (likeness == VXM_LIKENESS_POSSIBLE && !possible)
      possible = &formats[f];
  }
  choice chosen = {.foreign = vxm_external_format_by_content(data, size)};
  if (!chosen.foreign && !find_stranger(data, size))
    chosen.own = by_extension(name);
  if (!chosen.foreign && !chosen.own)
    chosen.foreign = vxm_external_format_by_extension(vxm_path_extension(name));
  if (!chosen.foreign && !chosen.own)
    chosen.own = possible;
  return chosen;
}

/** The format that the caller names, also by an extension, in the form that the content has; false if there
 * is none. */
static bool choose_named(choice *out, const unsigned char *data, size_t size, const char *format) {
  *out = (choice){.own = by_name(format)};
  if (!out->own)
    out->own = of_extension(format);
  if (out->own)
    return true;
  const vxm_external_format *told = vxm_external_format_by_content(data, size);
  const vxm_external_format *named = vxm_external_format_by_name(format);
  if (!named)
    named = vxm_external_format_by_extension(format);
  bool is_form = told && named && strcmp(told->name, named->name) == 0;
  out->foreign = is_form ? told : named;
  return out->foreign != NULL;
}

/** The extension that the library goes by: that of the name, or what the caller says where the name has none
 * of the format. */
static const char *extension_for(const vxm_external_format *format, const char *name, const char *told) {
  const char *own = vxm_path_extension(name);
  return told && vxm_external_format_by_extension(own) != format ? told : own;
}

#define GRIDS_GO_TO "'voxmend view' and 'convert' take grids, and 'info' by their names"

/** What people hand in by mistake, by the first bytes. */
static const struct {
  const char *magic, *advice;
} strangers[] = {
    {"\x1f\x8b", "is compressed by gzip: unpack it first"},
    {"PK\x03\x04", "is a zip archive: unpack it first"},
    {"BZh", "is compressed by bzip2: unpack it first"},
    {"\xfd"
     "7zXZ",
     "is compressed by xz: unpack it first"},
    {"\x28\xb5\x2f\xfd", "is compressed by zstd: unpack it first"},
    {"version https://git-lfs", "is a Git LFS pointer, not the mesh itself: run git lfs pull"},
    {"<!DOCTYPE", "is a web page, not a mesh: download the file itself"},
    {"<!doctype", "is a web page, not a mesh: download the file itself"},
    {"<html", "is a web page, not a mesh: download the file itself"},
    {"NRRD000", "is an NRRD grid, not a mesh: " GRIDS_GO_TO},
    {"VXMOCT1", "is an octree, not a mesh: " GRIDS_GO_TO},
    {"VXMRLE1", "is a grid (.rle), not a mesh: " GRIDS_GO_TO},
    {"#binvox", "is a binvox grid, not a mesh: " GRIDS_GO_TO},
    {"\x93NUMPY", "is a numpy array, not a mesh: " GRIDS_GO_TO},
};

static const char *find_stranger(const unsigned char *data, size_t size) {
  for (size_t s = 0; s < sizeof strangers / sizeof *strangers; s++) {
    size_t length = strlen(strangers[s].magic);
    if (size >= length && memcmp(data, strangers[s].magic, length) == 0)
      return strangers[s].advice;
  }
  return NULL;
}

static vxm_status refuse_unknown(const unsigned char *data, size_t size, const char *name, vxm_error *error) {
  vxm_place place = {name, 0, -1, -1};
  /* The extension first: .usdz is a zip archive too, but to unpack it does not help. */
  const char *advice = vxm_external_format_refusal(vxm_path_extension(name));
  if (!advice)
    advice = find_stranger(data, size);
  if (advice)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, place, "%s", advice);
  return vxm_fail_at(
      error, VXM_ERROR_FORMAT, place,
      "not a known mesh format by content or extension; what is read here: off obj stl ply%s%s",
      vxm_module_exists("assimp") ? " " VXM_ASSIMP_FORMATS : "",
      vxm_module_exists("occt") ? " " VXM_OCCT_FORMATS : "");
}

/** Whatever the format and the command: such faces are gone once the mesh is repaired, and no voxel tells it.
 */
static void warn_nonfinite(vxm_soup *soup) {
  size_t first = 0, count = vxm_nonfinite_faces(&first, soup);
  if (count == 1)
    vxm_warn(&soup->warnings, "face %zu has a vertex that is not finite; repair removes it", first);
  else if (count > 1)
    vxm_warn(&soup->warnings,
             "face %zu has a vertex that is not finite; repair removes it; %zu such faces in all", first,
             count);
}

static vxm_status read_bytes(vxm_soup *soup, const unsigned char *data, size_t size, const char *name,
                             const vxm_mesh_read_options *options, vxm_references *references,
                             vxm_error *error) {
  if (size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0 && !vxm_stl_is_binary(data, size)) {
    data += 3;
    size -= 3;
  }
  if (size == 0)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){name, 0, -1, -1}, "the file is empty");
  choice chosen;
  if (!options->format)
    chosen = choose(data, size, name);
  else if (!choose_named(&chosen, data, size, options->format))
    return vxm_fail_at(error, VXM_ERROR_ARGUMENT, (vxm_place){name, 0, -1, -1},
                       "mesh format \"%.32s\" is not known", options->format);
  if (chosen.own)
    return chosen.own->read(soup, data, size, name, error);
  if (!chosen.foreign)
    return refuse_unknown(data, size, name, error);
  const vxm_reader_request file = {
      .data = data, .size = size, .name = name, .deflection = options->deflection};
  return vxm_external_format_read(soup, chosen.foreign, extension_for(chosen.foreign, name, options->format),
                                  &file, references, error);
}

static vxm_mesh_read_options chosen_options(const vxm_mesh_read_options *options) {
  vxm_mesh_read_options chosen = VXM_MESH_READ_OPTIONS_INIT;
  if (options)
    chosen = *options;
  if (chosen.deflection == 0)
    chosen.deflection = VXM_DEFLECTION_DEFAULT;
  return chosen;
}

static vxm_status read_with(vxm_soup **out, vxm_context *context, const unsigned char *data, size_t size,
                            const char *name, const vxm_mesh_read_options *chosen, vxm_references *references,
                            vxm_error *error) {
  vxm_soup *soup;
  vxm_status status = vxm_soup_create(&soup, context, "", error);
  if (status != VXM_OK)
    return status;
  references->soup = soup;
  unsigned char *text = NULL;
  if (vxm_utf16_is(data, size)) {
    size_t text_size;
    status = vxm_utf16_to_utf8(&text, &text_size, soup->context, data, size, error);
    data = text;
    size = text_size;
  }
  if (status == VXM_OK && chosen->colors)
    status = vxm_appearance_create(&soup->appearance, soup->context, error);
  if (status == VXM_OK)
    status = vxm_progress(soup->context, "reading", 0.0, error);
  if (status == VXM_OK)
    status = read_bytes(soup, data, size, name, chosen, references, error);
  if (status == VXM_OK)
    warn_nonfinite(soup);
  if (status == VXM_OK && chosen->colors)
    status = vxm_textures_read(soup, references, error);
  if (status == VXM_OK)
    status = vxm_progress(soup->context, "reading", 1.0, error);
  vxm_free(soup->context, text);
  if (status != VXM_OK) {
    vxm_soup_destroy(soup);
    return status;
  }
  *out = soup;
  return VXM_OK;
}

vxm_status vxm_meshio_read(vxm_soup **out, vxm_context *context, const unsigned char *data, size_t size,
                           const char *name, const vxm_mesh_read_options *options, vxm_error *error) {
  *out = NULL;
  vxm_mesh_read_options chosen = chosen_options(options);
  vxm_references references = {.allowed = chosen.external, .folder = -1};
  /* Bytes in memory have no folder, whatever they are called: a name is a stranger's as likely as not. */
  if (chosen.external == VXM_EXTERNAL_ANY)
    references.folder = vxm_folder_open(name);
  vxm_status status = read_with(out, context, data, size, name, &chosen, &references, error);
  if (references.folder >= 0)
    close(references.folder);
  return status;
}

/** Whether a folder is a Zarr array, so that the error can say so. */
static bool is_zarr(const char *path) {
  int folder = open(path, O_PATH | O_DIRECTORY | O_CLOEXEC);
  bool found = folder >= 0 && faccessat(folder, ".zarray", F_OK, 0) == 0;
  if (folder >= 0)
    close(folder);
  return found;
}

/** Opens a mesh file within its folder, so that the two belong together even if either is renamed meanwhile.
 * What does not lie in a folder (a link that leads elsewhere, a pipe, standard input) has none. */
static vxm_status open_file(vxm_input *input, vxm_references *references, vxm_context *context,
                            const char *path, vxm_error *error) {
  const char *slash = strrchr(path, '/');
  bool is_stream = strcmp(path, "-") == 0;
  references->folder = is_stream && references->allowed != VXM_EXTERNAL_ANY ? -1 : vxm_folder_open(path);
  int file = is_stream || references->folder < 0
                 ? -1
                 : vxm_regular_open(references->folder, slash ? slash + 1 : path, VXM_BENEATH);
  if (file < 0 && is_zarr(path))
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){path, 0, -1, -1},
                       "is a Zarr array, not a mesh: " GRIDS_GO_TO);
  if (file < 0)
    return vxm_input_open(input, context, path, error);
  references->is_inside = true;
  vxm_status status = vxm_input_take(input, context, path, file, error);
  close(file);
  return status;
}

vxm_status vxm_meshio_read_file(vxm_soup **out, vxm_context *context, const char *path,
                                const vxm_mesh_read_options *options, vxm_error *error) {
  *out = NULL;
  vxm_input input;
  vxm_mesh_read_options chosen = chosen_options(options);
  vxm_references references = {.allowed = chosen.external};
  vxm_status status = open_file(&input, &references, context, path, error);
  if (status == VXM_OK) {
    status = read_with(out, context, input.data, input.size, input.name, &chosen, &references, error);
    vxm_input_close(&input);
  }
  if (references.folder >= 0)
    close(references.folder);
  return status;
}

/** Reads what the output holds by now, as a file of the same format. */
static vxm_status read_back(vxm_soup **out, vxm_output *output, const vxm_soup *soup,
                            const vxm_format *format, vxm_error *error) {
  vxm_input input;
  vxm_status status = vxm_output_read_back(&input, output, error);
  *out = NULL;
  if (status != VXM_OK)
    return status;
  status = vxm_soup_create(out, soup->context, format->name, error);
  if (status == VXM_OK)
    status = format->read(*out, input.data, input.size, input.name, error);
  if (status != VXM_OK) {
    vxm_soup_destroy(*out);
    *out = NULL;
  }
  vxm_input_close(&input);
  return status;
}

/** What a file has at the least: each number of a text is a digit and what separates it. */
static uint64_t least_bytes(const vxm_soup *soup, const vxm_format *format, bool ascii) {
  uint64_t vertices = soup->vertex_count, faces = soup->face_count, corners = soup->corner_count;
  uint64_t triangles = corners > 2 * faces ? corners - 2 * faces : 0;
  if (strcmp(format->name, "stl") == 0)
    return triangles * (ascii ? 100 : 50);
  if (strcmp(format->name, "ply") == 0 && !ascii)
    return vertices * 24 + faces + corners * 4;
  return vertices * 6 + corners * 2;
}

static vxm_status write_and_check(vxm_output *output, const vxm_soup *soup, const vxm_format *format,
                                  unsigned flags, vxm_meshio_check check, void *payload, vxm_error *error) {
  vxm_soup *back = NULL;
  vxm_status status = vxm_output_expect(output, least_bytes(soup, format, flags & VXM_WRITE_ASCII), error);
  if (status == VXM_OK)
    status = format->write(soup, output, flags, error);
  if (status != VXM_OK || vxm_output_failed(output) || !check)
    return status;
  status = read_back(&back, output, soup, format, error);
  if (status == VXM_OK)
    status = check(back, payload, error);
  vxm_soup_destroy(back);
  return status;
}

vxm_status vxm_meshio_write_checked(const vxm_soup *soup, const char *path, const char *format,
                                    unsigned flags, vxm_meshio_check check, void *payload, vxm_error *error) {
  const char *wanted = format ? format : vxm_path_extension(path);
  const vxm_format *row = format ? by_name(format) : by_extension(path);
  if (!row) {
    if (*wanted == '\0')
      return vxm_fail(error, VXM_ERROR_ARGUMENT, "%s: name a mesh format: off, obj, stl or ply", path);
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "%s: mesh format \"%.32s\" is not known; choose off, obj, stl or ply", path, wanted);
  }
  vxm_output *output;
  vxm_status status =
      (check ? vxm_output_open_readable : vxm_output_open)(&output, soup->context, path, error);
  if (status != VXM_OK)
    return status;
  status = write_and_check(output, soup, row, flags, check, payload, error);
  /* A failed output is committed too, for the message that says why. */
  if (status == VXM_OK || vxm_output_failed(output))
    return vxm_output_commit(output, error);
  vxm_output_abort(output);
  return status;
}

vxm_status vxm_meshio_write(const vxm_soup *soup, const char *path, const char *format, unsigned flags,
                            vxm_error *error) {
  return vxm_meshio_write_checked(soup, path, format, flags, NULL, NULL, error);
}
