/* SPDX-License-Identifier: BSD-3-Clause */
/** .tif in: stacks of uncompressed pages that are alike, TIFF or BigTIFF, of either byte order. */
#include "base/c_locale.h"
#include "base/endian.h"
#include "gridio/formats/tiff.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PAGES_MAX = 1 << 20, ENTRIES_MAX = 512, TEXT_MAX = 4096 };

/** A file, and what its first page says. */
typedef struct stack {
  const vxm_input *input;
  bool is_big, is_swapped;
  uint64_t first; /**< directory */
  int64_t pages;
  bool is_joined; /**< one directory stands for all pages, which lie behind one another */
  uint64_t page_bytes;
  vxm_raster raster;
  vxm_about about;
  bool has_place;
  char text[TEXT_MAX];
  /* While slices are taken. */
  uint64_t next; /**< directory */
  int64_t page;
} stack;

/** A field of a directory: where its values lie. */
typedef struct entry {
  uint16_t tag, type;
  uint64_t count, at;
} entry;

/* ---- Numbers ---- */

/** A whole number of 1 to 8 bytes; 0 beyond the end of the file. */
static uint64_t number_at(const stack *s, uint64_t at, size_t size) {
  unsigned char bytes[8] = {0};
  uint64_t value = 0;
  if (at > s->input->size || size > s->input->size - at)
    return 0;
  memcpy(bytes, s->input->data + at, size);
  bool is_big_endian = s->is_swapped == (vxm_le64(1) == 1);
  for (size_t b = 0; b < size; b++)
    value |= (uint64_t)bytes[is_big_endian ? size - 1 - b : b] << 8 * b;
  return value;
}

static size_t type_bytes(uint16_t type) {
  static const unsigned char bytes[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8};
  return type < sizeof bytes ? bytes[type] : 0;
}

static size_t offset_bytes(const stack *s) {
  return s->is_big ? 8 : 4;
}

static size_t count_bytes(const stack *s) {
  return s->is_big ? 8 : 2;
}

static size_t entry_bytes(const stack *s) {
  return s->is_big ? 20 : 12;
}

/** Entries of a directory; none if they do not fit the file, or are more than any page has. */
static uint64_t entries_of(const stack *s, uint64_t directory) {
  uint64_t count = number_at(s, directory, count_bytes(s)), there = s->input->size;
  return directory < there && count <= ENTRIES_MAX && count <= (there - directory) / entry_bytes(s) ? count
                                                                                                    : 0;
}

static bool find_entry(entry *out, const stack *s, uint64_t directory, uint16_t tag) {
  uint64_t count = entries_of(s, directory);
  for (uint64_t e = 0; e < count; e++) {
    uint64_t at = directory + count_bytes(s) + e * entry_bytes(s);
    if (number_at(s, at, 2) != tag)
      continue;
    *out = (entry){tag, (uint16_t)number_at(s, at + 2, 2), number_at(s, at + 4, offset_bytes(s)), 0};
    size_t size = type_bytes(out->type);
    uint64_t value = at + 4 + offset_bytes(s);
    bool is_inside = size > 0 && out->count <= offset_bytes(s) / size;
    out->at = is_inside ? value : number_at(s, value, offset_bytes(s));
    return size > 0 && out->at <= s->input->size && out->count <= (s->input->size - out->at) / size;
  }
  return false;
}

/** A whole number of a field, or `otherwise`. */
static uint64_t value_of(const stack *s, uint64_t directory, uint16_t tag, uint64_t index,
                         uint64_t otherwise) {
  entry e;
  if (!find_entry(&e, s, directory, tag) || index >= e.count)
    return otherwise;
  return number_at(s, e.at + index * type_bytes(e.type), type_bytes(e.type));
}

static double rational_of(const stack *s, uint64_t directory, uint16_t tag) {
  entry e;
  if (!find_entry(&e, s, directory, tag) || e.type != VXM_TIFF_RATIONAL || e.count != 1)
    return 0;
  double below = (double)number_at(s, e.at + 4, 4);
  return below > 0 ? (double)number_at(s, e.at, 4) / below : 0;
}

/** 0 behind the last; beyond the file if it is cut short. */
static uint64_t next_directory(const stack *s, uint64_t directory) {
  uint64_t at = directory + count_bytes(s) + entries_of(s, directory) * entry_bytes(s);
  return at <= s->input->size && s->input->size - at >= offset_bytes(s) ? number_at(s, at, offset_bytes(s))
                                                                        : UINT64_MAX;
}

static vxm_status fail(const stack *s, const char *why, vxm_error *error) {
  return vxm_fail_byte(error, s->input, s->first, "%s", why);
}

/* ---- What a page is ---- */

static vxm_status check_layout(const stack *s, uint64_t directory, vxm_error *error) {
  uint64_t samples = value_of(s, directory, VXM_TIFF_SAMPLES, 0, 1);
  if (value_of(s, directory, VXM_TIFF_COMPRESSION, 0, 1) != 1)
    return fail(s, "its pages are compressed; write them uncompressed", error);
  if (value_of(s, directory, VXM_TIFF_TILE_WIDTH, 0, 0) != 0)
    return fail(s, "its pages are tiled; write them in strips", error);
  if (samples > 1 && value_of(s, directory, VXM_TIFF_PLANAR, 0, 1) != 1)
    return fail(s, "its colours lie in planes; write them together", error);
  if (value_of(s, directory, VXM_TIFF_PHOTOMETRIC, 0, 1) - 1 > 1)
    return fail(s, "its pages are neither shades from black on nor RGB", error);
  return VXM_OK;
}

static vxm_status find_type(stack *s, vxm_error *error) {
  static const char kinds[] = {'u', 'i', 'f'};
  uint64_t bits = value_of(s, s->first, VXM_TIFF_BITS, 0, 1),
           format = value_of(s, s->first, VXM_TIFF_SAMPLE_FORMAT, 0, 1),
           samples = value_of(s, s->first, VXM_TIFF_SAMPLES, 0, 1);
  bool is_sized = bits == 8 || bits == 16 || bits == 32 || bits == 64;
  if (!is_sized || format < 1 || format > 3 || (format == 3 && bits == 8))
    return vxm_fail_byte(error, s->input, s->first,
                         "its pages have %" PRIu64 " bits of format %" PRIu64
                         ", which is no type of numbers here",
                         bits, format);
  if (samples != 1 && !((samples == 3 || samples == 4) && bits == 8 && format == 1))
    return vxm_fail_byte(error, s->input, s->first,
                         "its pages have %" PRIu64 " samples, not 1, or 3 or 4 bytes of a colour", samples);
  s->raster.scalar = vxm_scalar_of(kinds[format - 1], (size_t)bits / 8);
  s->raster.stored = (int)samples;
  s->raster.channels = samples > 1 ? 4 : 1;
  return VXM_OK;
}

/** Whether a page is as the first. */
static bool is_alike(const stack *s, uint64_t directory) {
  static const uint16_t tags[] = {VXM_TIFF_WIDTH, VXM_TIFF_LENGTH, VXM_TIFF_BITS, VXM_TIFF_SAMPLES,
                                  VXM_TIFF_SAMPLE_FORMAT};
  for (size_t t = 0; t < sizeof tags / sizeof tags[0]; t++)
    if (value_of(s, directory, tags[t], 0, 1) != value_of(s, s->first, tags[t], 0, 1))
      return false;
  return true;
}

/** Counts the pages. Directories of a sound file do not overlap, which ends a chain that runs in a circle. */
static vxm_status count_pages(stack *s, vxm_error *error) {
  uint64_t seen = 0;
  for (uint64_t at = s->first; at != 0; at = next_directory(s, at)) {
    seen += entries_of(s, at) * entry_bytes(s);
    if (s->pages == PAGES_MAX || entries_of(s, at) == 0 || seen > s->input->size)
      return vxm_fail_byte(error, s->input, at, "its directory of pages is damaged, or has over %d of them",
                           PAGES_MAX);
    if (!is_alike(s, at))
      return vxm_fail_byte(error, s->input, at, "page %" PRId64 " has another size or type than the first",
                           s->pages + 1);
    vxm_status status = check_layout(s, at, error);
    if (status != VXM_OK)
      return status;
    s->pages++;
  }
  return VXM_OK;
}

/* ---- What the description says ---- */

/** The number behind a word at the beginning of a line, or `otherwise`. */
static double text_number(const stack *s, const char *word, double otherwise) {
  size_t length = strlen(word);
  for (const char *line = s->text; line; line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL)
    if (strncmp(line, word, length) == 0)
      return strtod(line + length, NULL);
  return otherwise;
}

static bool take_own_line(stack *s) {
  const char *line = strstr(s->text, VXM_TIFF_LINE);
  char kind[32] = "";
  double v[6];
  vxm_field_kind found;
  if (!line || sscanf(line + strlen(VXM_TIFF_LINE), "%31s %lf %lf %lf %lf %lf %lf", kind, &v[0], &v[1], &v[2],
                      &v[3], &v[4], &v[5]) != 7)
    return false;
  for (int a = 0; a < 3; a++) {
    s->raster.space.origin[a] = v[a];
    s->raster.space.voxel_size[a] = v[3 + a];
  }
  if (vxm_field_kind_find(&found, kind) && found != VXM_FIELD_NUMBERS &&
      (found == VXM_FIELD_COLORS) == (s->raster.channels == 4))
    s->about = (vxm_about){.is_declared = true, .kind = found};
  return true;
}

static void take_lines(stack *s) {
  vxm_space *space = &s->raster.space;
  for (int a = 0; a < 3; a++) {
    space->origin[a] = 0;
    space->voxel_size[a] = 1;
  }
  s->has_place = take_own_line(s);
  if (s->has_place || strncmp(s->text, "ImageJ=", 7) != 0)
    return;
  static const char *const origins[3] = {"xorigin=", "yorigin=", "zorigin="};
  const double across[3] = {rational_of(s, s->first, VXM_TIFF_X_RESOLUTION),
                            rational_of(s, s->first, VXM_TIFF_Y_RESOLUTION),
                            1 / text_number(s, "spacing=", 1)};
  s->has_place = true;
  for (int a = 0; a < 3; a++) {
    double size = 1 / across[a];
    space->voxel_size[a] = isfinite(size) && size > 0 ? size : 1;
    space->origin[a] = 0 - text_number(s, origins[a], 0) * space->voxel_size[a];
  }
}

static void describe(stack *s) {
  entry e;
  if (find_entry(&e, s, s->first, VXM_TIFF_DESCRIPTION) && e.type == VXM_TIFF_ASCII) {
    size_t length = e.count < TEXT_MAX ? (size_t)e.count : TEXT_MAX - 1;
    memcpy(s->text, s->input->data + e.at, length);
    s->text[length] = '\0';
  }
  locale_t previous = uselocale(vxm_c_locale());
  take_lines(s);
  double images = text_number(s, "images=", 1);
  uselocale(previous);
  if (s->pages == 1 && images > 1 && images <= PAGES_MAX) {
    s->is_joined = true;
    s->pages = (int64_t)images;
  }
}

/* ---- A file ---- */

bool vxm_tiff_sniff(const vxm_input *input) {
  static const char *const magics[] = {"II\x2a\0", "MM\0\x2a", "II\x2b\0", "MM\0\x2b"};
  for (int m = 0; m < 4 && input->size >= 16; m++)
    if (memcmp(input->data, magics[m], 4) == 0)
      return true;
  return false;
}

static vxm_status read_header(stack *s, const vxm_input *input, vxm_error *error) {
  *s = (stack){.input = input, .raster = {.axis = {0, 1, 2}}};
  if (!vxm_tiff_sniff(input))
    return fail(s, "not a TIFF file", error);
  s->is_swapped = (input->data[0] == 'M') == (vxm_le64(1) == 1);
  s->is_big = number_at(s, 2, 2) == 43;
  s->first = number_at(s, s->is_big ? 8 : 4, offset_bytes(s));
  s->raster.is_swapped = s->is_swapped;
  vxm_status status = count_pages(s, error);
  if (status == VXM_OK && s->pages == 0)
    status = fail(s, "it has no page", error);
  if (status == VXM_OK)
    status = find_type(s, error);
  if (status != VXM_OK)
    return status;
  describe(s);
  uint64_t width = value_of(s, s->first, VXM_TIFF_WIDTH, 0, 0),
           length = value_of(s, s->first, VXM_TIFF_LENGTH, 0, 0);
  vxm_space *space = &s->raster.space;
  space->dims[0] = (int64_t)(width & UINT32_MAX);
  space->dims[1] = (int64_t)(length & UINT32_MAX);
  space->dims[2] = s->pages;
  status = vxm_space_check_file(space, input, (size_t)s->first, error);
  if (status != VXM_OK)
    return status;
  s->page_bytes = vxm_raster_bytes(&s->raster) / (uint64_t)s->pages;
  if (vxm_raster_bytes(&s->raster) > input->size)
    return vxm_fail_byte(error, input, input->size, "the file is cut short: %" PRIu64 " voxels are not in it",
                         vxm_space_voxels(space));
  s->next = s->first;
  return VXM_OK;
}

static vxm_status take_strip(const stack *s, unsigned char *to, uint64_t at, uint64_t size,
                             vxm_error *error) {
  if (at > s->input->size || size > s->input->size - at)
    return vxm_fail_byte(error, s->input, s->next, "the values of page %" PRId64 " lie beyond the file",
                         s->page + 1);
  memcpy(to, s->input->data + at, (size_t)size);
  return VXM_OK;
}

/** Takes the strips of the next page. */
static vxm_status take_page(void *payload, void *slice, size_t size, vxm_error *error) {
  stack *s = payload;
  uint64_t filled = 0;
  vxm_status status = VXM_OK;
  if (s->is_joined) {
    uint64_t at = value_of(s, s->first, VXM_TIFF_STRIP_OFFSETS, 0, 0);
    status = at > s->input->size ? fail(s, "its values lie beyond the file", error)
                                 : take_strip(s, slice, at + (uint64_t)s->page * size, size, error);
    s->page++;
    return status;
  }
  for (uint64_t strip = 0; filled < size && status == VXM_OK; strip++) {
    uint64_t at = value_of(s, s->next, VXM_TIFF_STRIP_OFFSETS, strip, UINT64_MAX),
             bytes = value_of(s, s->next, VXM_TIFF_STRIP_BYTES, strip, 0);
    if (bytes == 0 || bytes > size - filled)
      return vxm_fail_byte(error, s->input, s->next, "the strips of page %" PRId64 " do not make it up",
                           s->page + 1);
    status = take_strip(s, (unsigned char *)slice + filled, at, bytes, error);
    filled += bytes;
  }
  s->next = next_directory(s, s->next);
  s->page++;
  return status;
}

static void warn_place(const stack *s, vxm_warnings *warnings) {
  if (!s->has_place)
    vxm_warn(warnings, "the file says nothing of its place: origin 0 0 0 and voxel size 1 are taken");
}

vxm_status vxm_tiff_read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  stack s;
  vxm_status status = read_header(&s, input, error);
  if (status != VXM_OK)
    return status;
  vxm_sidecar_take_labels(&s.about, s.raster.space.dims, input);
  status = vxm_raster_read(out, &s.raster, input->context, &s.about, take_page, &s, error);
  if (status == VXM_OK)
    warn_place(&s, &(*out)->warnings);
  return status;
}

vxm_status vxm_tiff_read(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  if (rule != VXM_BITS_NONE)
    return vxm_raster_bits_of_file(out, vxm_tiff_read_field, input, rule, error);
  stack s;
  vxm_status status = read_header(&s, input, error);
  if (status == VXM_OK)
    status = vxm_grid_create(out, input->context, &s.raster.space, error);
  if (status == VXM_OK)
    warn_place(&s, &(*out)->warnings);
  return status;
}
