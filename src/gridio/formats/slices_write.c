/* SPDX-License-Identifier: BSD-3-Clause */
/** Slices out, as pictures. None gets its name before all are complete; until then each is an open file. */
#include "gridio/common/png_write.h"
#include "gridio/common/values_writer.h"
#include "gridio/formats/slices.h"
#include "gridio/formats/tiff.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

/* ---- Names ---- */

/** The '%' of a pattern, and the digits of its numbers; NULL if it is none. */
static const char *find_number(const char *path, int *digits, const char **rest) {
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *sign = strchr(name, '%'),
             *at = sign ? sign + 1 : name;
  if (!sign || strchr(at, '%'))
    return NULL;
  *digits = 1;
  if (at[0] == '0' && at[1] >= '1' && at[1] <= '9') {
    *digits = at[1] - '0';
    at += 2;
  }
  *rest = at + 1;
  return *at == 'd' ? sign : NULL;
}

static bool is_numbered(const char *path, const char *extension) {
  int digits;
  const char *rest;
  return vxm_text_equal_nocase(vxm_path_extension(path), extension) && find_number(path, &digits, &rest);
}

bool vxm_slices_are_tiff(const char *path) {
  return is_numbered(path, "tif");
}

bool vxm_slices_is_pattern(const char *path) {
  return is_numbered(path, "png") || vxm_slices_are_tiff(path);
}

bool vxm_slices_name(char out[PATH_MAX], const char *path, int64_t number) {
  int digits = 0;
  const char *rest = "", *sign = find_number(path, &digits, &rest);
  if (!sign)
    return false;
  int length = snprintf(out, PATH_MAX, "%.*s%0*" PRId64 "%s", (int)(sign - path), path, digits, number, rest);
  return length > 0 && length < PATH_MAX;
}

vxm_status vxm_slices_check_pattern(const char *path, vxm_error *error) {
  if (vxm_slices_is_pattern(path))
    return VXM_OK;
  return vxm_fail_at(error, VXM_ERROR_ARGUMENT, (vxm_place){path, 0, -1, -1},
                     ".png is a picture for each slice: the name needs one %%d or %%04d for their numbers, "
                     "such as slice_%%04d.png");
}

/* ---- What can be written ---- */

/** Each slice is two open files until all are complete. */
static vxm_status make_room(int64_t slices, const char *path, vxm_error *error) {
  const rlim_t needed = 2 * (rlim_t)slices + 128;
  struct rlimit limit;
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur >= needed)
    return VXM_OK;
  struct rlimit more = limit;
  more.rlim_cur = needed;
  if ((limit.rlim_max == RLIM_INFINITY || limit.rlim_max >= needed) && setrlimit(RLIMIT_NOFILE, &more) == 0)
    return VXM_OK;
  return vxm_fail_at(error, VXM_ERROR_RANGE, (vxm_place){path, 0, -1, -1},
                     "%" PRId64 " slices need %" PRIu64 " open files, and %" PRIu64
                     " are allowed (ulimit -n); choose .tif",
                     slices, (uint64_t)needed, (uint64_t)limit.rlim_max);
}

static vxm_status check(const vxm_space *space, const vxm_values_spec *values, const char *path,
                        vxm_error *error) {
  const vxm_place place = {path, 0, -1, -1};
  vxm_status status = vxm_slices_check_pattern(path, error);
  if (status == VXM_OK && vxm_slices_are_tiff(path))
    return make_room(space->dims[2], path, error);
  if (status == VXM_OK)
    status = vxm_png_check(error);
  if (status != VXM_OK)
    return status;
  if (values->scalar != VXM_UINT8 && values->scalar != VXM_UINT16)
    return vxm_fail_at(error, VXM_ERROR_ARGUMENT, place,
                       "%s numbers do not go into .png, which holds uint8 and uint16; choose .tif",
                       vxm_scalar_name(values->scalar));
  if (space->dims[0] > VXM_SLICES_SIDE_MAX || space->dims[1] > VXM_SLICES_SIDE_MAX)
    return vxm_fail_at(error, VXM_ERROR_RANGE, place, "pictures have at most %d pixels a side; choose .tif",
                       VXM_SLICES_SIDE_MAX);
  return make_room(space->dims[2], path, error);
}

vxm_status vxm_slices_check_field(const vxm_field *field, const char *path, vxm_error *error) {
  const vxm_values_spec values = {
      .scalar = field->scalar, .channels = field->channels, .about = &field->about};
  return check(&field->space, &values, path, error);
}

/* ---- Writing ---- */

/** A row as PNG has it. */
typedef struct state {
  unsigned char *row;
  size_t row_bytes;
} state;

static vxm_status begin(vxm_values_writer *w, vxm_error *error) {
  vxm_status status = check(&w->space, &w->values, w->path, error);
  if (status != VXM_OK)
    return status;
  state *s = vxm_try_calloc(w->context, 1, sizeof *s, &status, error);
  if (!s)
    return status;
  w->state = s;
  s->row_bytes = w->slice_bytes / (size_t)w->space.dims[1];
  s->row = vxm_try_alloc(w->context, s->row_bytes, 1, &status, error);
  return status;
}

/** Bits become black and white, and numbers of 16 bits have their high byte first. */
static void make_row(const state *s, const vxm_values_writer *w, const unsigned char *from) {
  if (w->values.scalar == VXM_UINT16)
    for (size_t b = 0; b < s->row_bytes; b += 2) {
      uint16_t number;
      memcpy(&number, from + b, sizeof number);
      s->row[b] = (unsigned char)(number >> 8);
      s->row[b + 1] = (unsigned char)number;
    }
  else
    for (size_t b = 0; b < s->row_bytes; b++)
      s->row[b] = w->values.is_bits && from[b] ? UINT8_MAX : from[b];
}

static vxm_status put_picture(vxm_values_writer *w, vxm_output *output, const unsigned char *slice,
                              vxm_error *error) {
  const state *s = w->state;
  const vxm_png_pixels pixels = {w->values.channels, w->values.scalar == VXM_UINT16 ? 16 : 8};
  vxm_png *png;
  vxm_status status = vxm_png_create_of(&png, w->context, output, (int)w->space.dims[0],
                                        (int)w->space.dims[1], pixels, error);
  for (int64_t y = 0; y < w->space.dims[1] && status == VXM_OK; y++) {
    make_row(s, w, slice + (size_t)y * s->row_bytes);
    status = vxm_png_rows(png, s->row, 1, error);
  }
  if (status == VXM_OK)
    status = vxm_png_finish(png, error);
  vxm_png_destroy(png);
  return status;
}

static vxm_status put_slice(vxm_values_writer *w, const unsigned char *slice, int64_t z, vxm_error *error) {
  char path[PATH_MAX];
  vxm_output *output;
  if (!vxm_slices_name(path, w->path, z)) {
    errno = ENAMETOOLONG;
    return vxm_fail_errno(error, w->path, "cannot write");
  }
  vxm_status status = vxm_output_open(&output, w->context, path, error);
  if (status != VXM_OK)
    return status;
  status = vxm_slices_are_tiff(w->path) ? vxm_tiff_write_page(w, output, slice, z, error)
                                        : put_picture(w, output, slice, error);
  if (status == VXM_OK)
    return vxm_output_keep(output, &w->kept, error);
  vxm_output_abort(output);
  return status;
}

static vxm_status put(vxm_values_writer *w, const void *values, int64_t begin_slice, int64_t end_slice,
                      vxm_error *error) {
  const unsigned char *slice = values;
  vxm_status status = VXM_OK;
  for (int64_t z = begin_slice; z < end_slice && status == VXM_OK; z++, slice += w->slice_bytes)
    status = put_slice(w, slice, z, error);
  return status;
}

static void drop(vxm_values_writer *w) {
  const state *s = w->state;
  if (s)
    vxm_free(w->context, s->row);
}

static const vxm_sidecar_text description = {
    "voxmend slices", "a picture for each z, its rows along x, the first that of y 0", NULL};

const vxm_values_writer_kind vxm_slices_values = {
    .layout = VXM_LAYOUT_GRID,
    .holds = VXM_HOLDS_ALL,
    .sidecar = &description,
    .has_sidecar = true,
    .has_own_files = true,
    .check = check,
    .begin = begin,
    .put = put,
    .drop = drop,
};

/** TIFF takes the values as they are, without rows of pixels. */
static vxm_status begin_tiff(vxm_values_writer *w, vxm_error *error) {
  return check(&w->space, &w->values, w->path, error);
}

const vxm_values_writer_kind vxm_slices_tiff_values = {
    .layout = VXM_LAYOUT_GRID,
    .holds = VXM_HOLDS_ALL,
    .sidecar = &description,
    .has_sidecar = true,
    .has_own_files = true,
    .stored = vxm_values_no_halves,
    .convert = vxm_values_widen_halves,
    .check = check,
    .begin = begin_tiff,
    .put = put,
};
