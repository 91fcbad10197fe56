/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/octree_build.h"
#include "gridio/common/deflate.h"
#include "gridio/common/values_writer.h"
#include "gridio/formats/slices.h"
#include "gridio/formats/zarr.h"
#include "gridio/gridio.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* ---- The table ---- */

/** The surface of what is set, by the writers of meshes. */
static const vxm_grid_format mesh_formats[] = {
    {.name = "obj", .holds = VXM_HOLDS_BITS, .is_surface = true},
    {.name = "stl", .holds = VXM_HOLDS_BITS, .is_surface = true},
    {.name = "off", .holds = VXM_HOLDS_BITS, .is_surface = true},
};

/** In the order in which they are named, and their content is asked. */
static const vxm_grid_format *const formats[] = {
    &vxm_format_binvox, &vxm_format_npy,    &vxm_format_raw,       &vxm_format_rle,  &vxm_format_nrrd,
    &vxm_format_vdb,    &vxm_format_octree, &vxm_format_bt,        &vxm_format_nii,  &vxm_format_nii_gz,
    &vxm_format_vti,    &vxm_format_vtk,    &vxm_format_tif,       &vxm_format_h5,   &vxm_format_zarr,
    &mesh_formats[0],   &vxm_format_ply,    &mesh_formats[1],      &mesh_formats[2], &vxm_format_glb,
    &vxm_format_vox,    &vxm_format_schem,  &vxm_format_litematic, &vxm_format_png,
};

enum { FORMATS = sizeof formats / sizeof formats[0] };

const vxm_grid_format *vxm_grid_format_named(const char *name) {
  for (size_t f = 0; f < FORMATS; f++)
    if (vxm_text_equal_nocase(formats[f]->name, name))
      return formats[f];
  return NULL;
}

/** Whether a path ends in a format's name; that of a folder may have slashes behind it. */
static bool has_name(const char *path, const vxm_grid_format *format) {
  size_t length = strlen(path), size = strlen(format->name);
  while (format->is_folder && length > 0 && path[length - 1] == '/')
    length--;
  char end[16];
  if (length <= size || path[length - size - 1] != '.' || size >= sizeof end)
    return false;
  memcpy(end, path + length - size, size);
  end[size] = '\0';
  return vxm_text_equal_nocase(end, format->name);
}

/** Under a name with a pattern, such as slice_%04d.tif, TIFF is a sequence of files, else a stack in one. */
static const vxm_grid_format *of_pattern(const vxm_grid_format *format, const char *path) {
  return format == &vxm_format_tif && vxm_slices_are_tiff(path) ? &vxm_format_tif_slices : format;
}

/** The longest extension counts: .nii.gz is not a .gz. */
const vxm_grid_format *vxm_grid_format_of_path(const char *path) {
  const vxm_grid_format *found = NULL;
  size_t best = 0;
  for (size_t f = 0; f < FORMATS; f++) {
    size_t size = strlen(formats[f]->name);
    if (size > best && has_name(path, formats[f])) {
      found = formats[f];
      best = size;
    }
  }
  return of_pattern(found, path);
}

const vxm_grid_format *vxm_grid_format_chosen(const char *path, const char *format) {
  return format ? of_pattern(vxm_grid_format_named(format), path) : vxm_grid_format_of_path(path);
}

const char *vxm_grid_format_name(int64_t index) {
  return index >= 0 && index < FORMATS ? formats[index]->name : "";
}

const char *vxm_grid_format_of(const char *path) {
  const vxm_grid_format *found = path ? vxm_grid_format_of_path(path) : NULL;
  return found ? found->name : "";
}

/** What is written beside it. */
static unsigned json_traits(const vxm_grid_format *format) {
  unsigned traits = 0;
  if (format->writer && format->writer->sidecar)
    traits |= VXM_FORMAT_JSON;
  if (format->values && format->values->sidecar)
    traits |= format->values->has_sidecar ? VXM_FORMAT_JSON : VXM_FORMAT_LABELS_JSON;
  return traits;
}

unsigned vxm_grid_format_traits(const char *name) {
  const vxm_grid_format *format = name ? vxm_grid_format_named(name) : NULL;
  if (!format)
    return 0;
  bool is_sliced = (format->holds & VXM_HOLDS_BITS) && vxm_grid_format_streams(format);
  return format->holds | (format->read ? VXM_FORMAT_READ : 0) |
         (format->is_surface || format->is_mesh ? VXM_FORMAT_SURFACE : 0) |
         (is_sliced ? VXM_FORMAT_SLICES : 0) | json_traits(format);
}

static const vxm_grid_format *find_content(const vxm_input *input) {
  for (int by_name = 1; by_name >= 0; by_name--)
    for (size_t f = 0; f < FORMATS; f++)
      if (formats[f]->sniff && formats[f]->is_told_by_name == by_name && formats[f]->sniff(input))
        return formats[f];
  return NULL;
}

/* ---- Lists ---- */

typedef bool (*choose_fn)(const vxm_grid_format *format, unsigned holds);

static vxm_format_list list_formats(choose_fn choose, unsigned holds, const char *before) {
  vxm_format_list list = {""};
  size_t count = 0, named = 0, used = 0;
  for (size_t f = 0; f < FORMATS; f++)
    count += choose(formats[f], holds);
  for (size_t f = 0; f < FORMATS; f++)
    if (choose(formats[f], holds)) {
      const char *joint = named == 0 ? "" : named + 1 == count ? " or " : ", ";
      int length =
          snprintf(list.text + used, sizeof list.text - used, "%s%s%s", joint, before, formats[f]->name);
      used += (size_t)length < sizeof list.text - used ? (size_t)length : sizeof list.text - 1 - used;
      named++;
    }
  return list;
}

static bool holds_one(const vxm_grid_format *format, unsigned holds) {
  return (format->holds & holds) != 0;
}

static bool is_read(const vxm_grid_format *format, unsigned holds) {
  (void)holds;
  return format->read != NULL;
}

vxm_format_list vxm_grid_formats_holding(unsigned holds, const char *before) {
  return list_formats(holds_one, holds, before);
}

vxm_format_list vxm_grid_formats_read(void) {
  return list_formats(is_read, 0, ".");
}

/* ---- Reading ---- */

vxm_status vxm_space_check_file(const vxm_space *space, const vxm_input *input, size_t offset,
                                vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = vxm_space_check(space, &local);
  if (status == VXM_OK)
    return VXM_OK;
  if (status == VXM_ERROR_ARGUMENT)
    status = VXM_ERROR_FORMAT;
  return vxm_fail_at(error, status, (vxm_place){input->name, 0, (int64_t)offset, -1}, "%s", local.text);
}

static vxm_status find_format(const vxm_grid_format **out, const vxm_input *input, const char *path,
                              vxm_error *error) {
  const vxm_grid_format *format = find_content(input);
  if (!format)
    format = vxm_grid_format_of_path(path);
  *out = format;
  if (!format && vxm_is_gzip(input))
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){input->name, 0, -1, -1},
                       "compressed by gzip: unpack it first, or read a .nii.gz from a file of that name");
  if (!format)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){input->name, 0, -1, -1},
                       "not a grid: neither content nor name are those of %s", vxm_grid_formats_read().text);
  if (!format->read && !format->is_surface && !format->is_mesh)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){input->name, 0, -1, -1},
                       ".%s is written but not read; choose %s", format->name, vxm_grid_formats_read().text);
  if (!format->read)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){input->name, 0, -1, -1},
                       "not a grid but a mesh, by its name; voxelize it first");
  return VXM_OK;
}

static bool is_folder(const char *path) {
  struct stat info;
  return strcmp(path, "-") != 0 && stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

/** Opens a file; slices of a sequence and what is in a folder are opened by their reader, one by one. */
static vxm_status open_file(vxm_input *out, vxm_context *context, const char *path, vxm_error *error) {
  const vxm_grid_format *format = vxm_grid_format_of_path(path);
  bool is_several =
      (format && format->is_sequence) || (is_folder(path) && vxm_zarr_sniff(&(vxm_input){.name = path}));
  if (!is_several)
    return vxm_input_open(out, context, path, error);
  *out = (vxm_input){.data = (const unsigned char *)"", .name = path, .context = context};
  return VXM_OK;
}

/** Opens a file, finds its format, and reads bits by a rule, or else, if `field` is not NULL, numbers. */
static vxm_status read_file(vxm_grid **grid, vxm_field **field, vxm_bits_rule rule, vxm_context *context,
                            const char *path, vxm_error *error) {
  const vxm_grid_format *format;
  vxm_input input;
  vxm_error local = VXM_ERROR_INIT;
  *grid = NULL;
  vxm_status status = open_file(&input, context, path, error);
  if (status != VXM_OK)
    return status;
  status = find_format(&format, &input, path, &local);
  if (status == VXM_OK)
    status = format->read(grid, &input, rule, &local);
  if (status == VXM_ERROR_NUMBERS && field && format->read_field) {
    local = (vxm_error)VXM_ERROR_INIT;
    status = format->read_field(field, &input, &local);
  }
  vxm_input_close(&input);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_gridio_read(vxm_grid **out, vxm_context *context, const char *path, vxm_error *error) {
  return read_file(out, NULL, VXM_BITS_ANY, context, path, error);
}

vxm_status vxm_gridio_read_either(vxm_grid **grid, vxm_field **field, vxm_context *context, const char *path,
                                  vxm_error *error) {
  *field = NULL;
  return read_file(grid, field, VXM_BITS_STORED, context, path, error);
}

vxm_status vxm_gridio_read_space(vxm_grid **out, vxm_context *context, const char *path, vxm_error *error) {
  vxm_status status = read_file(out, NULL, VXM_BITS_NONE, context, path, error);
  if (status == VXM_OK)
    memset((*out)->words, 0, (*out)->word_count * sizeof *(*out)->words);
  return status;
}

/** Reads a grid and makes an octree of it. */
static vxm_status read_dense(vxm_sparse **out, const vxm_grid_format *format, const vxm_input *input,
                             vxm_error *error) {
  vxm_grid *grid;
  vxm_status status = format->read(&grid, input, VXM_BITS_STORED, error);
  if (status != VXM_OK)
    return status;
  status = vxm_octree_from_grid(out, grid, error);
  if (status == VXM_OK)
    (*out)->warnings = grid->warnings;
  vxm_grid_destroy(grid);
  return status;
}

vxm_status vxm_gridio_read_sparse(vxm_sparse **out, vxm_context *context, const char *path,
                                  vxm_error *error) {
  const vxm_grid_format *format;
  vxm_input input;
  vxm_error local = VXM_ERROR_INIT;
  *out = NULL;
  vxm_status status = open_file(&input, context, path, error);
  if (status != VXM_OK)
    return status;
  status = find_format(&format, &input, path, &local);
  if (status == VXM_OK)
    status = format->read_sparse ? format->read_sparse(out, &input, &local)
                                 : read_dense(out, format, &input, &local);
  vxm_input_close(&input);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/* ---- Writing ---- */

const vxm_grid_format *vxm_grid_format_for(const char *path, const char *format, vxm_error *error) {
  const vxm_place place = {path, 0, -1, -1};
  const char *name = format ? format : vxm_path_extension(path);
  const vxm_grid_format *found = vxm_grid_format_chosen(path, format);
  if (found && (found->holds & VXM_HOLDS_BITS))
    return found;
  vxm_format_list list = vxm_grid_formats_holding(VXM_HOLDS_BITS, "");
  if (found)
    vxm_fail_at(error, VXM_ERROR_ARGUMENT, place,
                ".%s holds %s, not set and clear voxels; make them first, or choose %s", found->name,
                (found->holds & VXM_HOLDS_COLORS) ? "colours" : "numbers", list.text);
  else if (!format && !*name)
    vxm_fail_at(error, VXM_ERROR_ARGUMENT, place,
                "no format is given and the name has no extension; choose %s", list.text);
  else
    vxm_fail_at(error, VXM_ERROR_ARGUMENT, place, "unknown grid format \"%s\"; choose %s", name, list.text);
  return NULL;
}

const vxm_grid_format *vxm_grid_format_holding(const char *path, const char *format, unsigned holds,
                                               const char *what, vxm_error *error) {
  const char *name = format ? format : vxm_path_extension(path);
  const vxm_grid_format *found = vxm_grid_format_chosen(path, format);
  if (found && (found->holds & holds))
    return found;
  vxm_fail_at(error, VXM_ERROR_ARGUMENT, (vxm_place){path, 0, -1, -1}, "%s into %s, not \"%s\"", what,
              vxm_grid_formats_holding(holds, ".").text, name);
  return NULL;
}
