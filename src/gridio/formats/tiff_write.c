/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * .tif out: the header, what all pages share, all values, and then a directory for each page. All sizes are
 * known before, so that the file is written from front to back; where it passes 4 GiB it is a BigTIFF.
 */
#include "base/c_locale.h"
#include "base/endian.h"
#include "gridio/common/values_writer.h"
#include "gridio/formats/tiff.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SHARED_MAX = 1024 };

/** What is known of a file before it is written. */
typedef struct tiff {
  bool is_big;
  uint64_t shared, description_bytes, resolution, bits, data, directories; /**< offsets, but for the second */
  char text[SHARED_MAX];                                                   /**< ImageDescription */
} tiff;

/** A directory in the making. */
typedef struct directory {
  unsigned char bytes[512];
  size_t size;
  uint64_t count;
  bool is_big;
} directory;

static void add_number(directory *d, uint64_t value, size_t size) {
  vxm_store_le(d->bytes + d->size, value, size);
  d->size += size;
}

/** A number of the width of an offset. */
static void add_offset(directory *d, uint64_t value) {
  add_number(d, value, d->is_big ? 8 : 4);
}

/** A field with its one value, or the offset of several. */
static void add_field(directory *d, uint16_t tag, uint16_t type, uint64_t count, uint64_t value) {
  add_number(d, tag, 2);
  add_number(d, type, 2);
  add_offset(d, count);
  add_offset(d, value); /* a shorter number stands first, before zeros */
  d->count++;
}

static uint16_t sample_format(vxm_scalar scalar) {
  switch (vxm_scalar_name(scalar)[0]) {
  case 'i':
    return 2;
  case 'f':
    return 3;
  default:
    return 1;
  }
}

static void make_directory(directory *out, const vxm_values_writer *w, const tiff *t, uint64_t page,
                           uint64_t next) {
  int channels = w->values.channels;
  uint16_t bits = (uint16_t)(8 * vxm_scalar_bytes(w->values.scalar)),
           wide = t->is_big ? VXM_TIFF_LONG8 : VXM_TIFF_LONG;
  directory d = {.is_big = t->is_big, .size = t->is_big ? 8 : 2};
  add_field(&d, VXM_TIFF_WIDTH, VXM_TIFF_LONG, 1, (uint64_t)w->space.dims[0]);
  add_field(&d, VXM_TIFF_LENGTH, VXM_TIFF_LONG, 1, (uint64_t)w->space.dims[1]);
  if (channels == 4)
    add_field(&d, VXM_TIFF_BITS, VXM_TIFF_SHORT, 4, t->is_big ? UINT64_C(0x0008000800080008) : t->bits);
  else
    add_field(&d, VXM_TIFF_BITS, VXM_TIFF_SHORT, 1, bits);
  add_field(&d, VXM_TIFF_COMPRESSION, VXM_TIFF_SHORT, 1, 1);
  add_field(&d, VXM_TIFF_PHOTOMETRIC, VXM_TIFF_SHORT, 1, channels == 4 ? 2 : 1);
  if (page == 0)
    add_field(&d, VXM_TIFF_DESCRIPTION, VXM_TIFF_ASCII, t->description_bytes, t->shared);
  add_field(&d, VXM_TIFF_STRIP_OFFSETS, wide, 1, t->data + page * w->slice_bytes);
  add_field(&d, VXM_TIFF_SAMPLES, VXM_TIFF_SHORT, 1, (uint64_t)channels);
  add_field(&d, VXM_TIFF_ROWS_PER_STRIP, VXM_TIFF_LONG, 1, (uint64_t)w->space.dims[1]);
  add_field(&d, VXM_TIFF_STRIP_BYTES, wide, 1, w->slice_bytes);
  if (!t->is_big) { /* a rational stands within the field of a BigTIFF, whose halves we would have to turn */
    add_field(&d, VXM_TIFF_X_RESOLUTION, VXM_TIFF_RATIONAL, 1, t->resolution);
    add_field(&d, VXM_TIFF_Y_RESOLUTION, VXM_TIFF_RATIONAL, 1, t->resolution + 8);
    add_field(&d, VXM_TIFF_UNIT, VXM_TIFF_SHORT, 1, 1);
  }
  if (channels == 4)
    add_field(&d, VXM_TIFF_EXTRA, VXM_TIFF_SHORT, 1, 2);
  else
    add_field(&d, VXM_TIFF_SAMPLE_FORMAT, VXM_TIFF_SHORT, 1, sample_format(w->values.scalar));
  add_offset(&d, next);
  vxm_store_le(d.bytes, d.count, t->is_big ? 8 : 2);
  *out = d;
}

/* ---- What all pages share ---- */

static const char *kind_of(const vxm_values_spec *values) {
  return values->is_bits ? "bits" : vxm_field_kind_name(values->about->kind);
}

/** ImageJ's lines, where origins are counted in voxels, and the exact one. */
static void describe(tiff *t, const vxm_values_writer *w) {
  const double *o = w->space.origin, *s = w->space.voxel_size;
  const char *range = w->values.is_bits ? "min=0.0\nmax=1.0\n" : "";
  locale_t previous = uselocale(vxm_c_locale());
  int length =
      snprintf(t->text, sizeof t->text,
               "ImageJ=1.11a\nimages=%" PRId64 "\nslices=%" PRId64
               "\nloop=false\n%sspacing=%.17g\nxorigin=%.9g\nyorigin=%.9g\nzorigin=%.9g\n" VXM_TIFF_LINE
               "%s %.17g %.17g %.17g %.17g %.17g %.17g\n",
               w->space.dims[2], w->space.dims[2], range, s[2], -o[0] / s[0], -o[1] / s[1], -o[2] / s[2],
               kind_of(&w->values), o[0], o[1], o[2], s[0], s[1], s[2]);
  uselocale(previous);
  t->description_bytes = (uint64_t)length + 1;
}

static void put_number(vxm_output *output, uint64_t value, size_t size) {
  unsigned char bytes[8];
  vxm_store_le(bytes, value, size);
  vxm_output_write(output, bytes, size);
}

/** Voxels in a unit of length, as near as 32 bits allow. */
static void put_resolution(vxm_output *output, double size) {
  const double most = UINT32_MAX;
  double across = 1 / size;
  double below = across >= 1 ? floor(most / across) : most, above = round(across * below);
  put_number(output, (uint64_t)fmin(fmax(above, 1), most), 4);
  put_number(output, (uint64_t)fmin(fmax(below, 1), most), 4);
}

/** Offsets of all parts; each begins at a multiple of 16. */
static void plan(tiff *t, const vxm_values_writer *w, bool is_big) {
  uint64_t slices = (uint64_t)w->space.dims[2], all = slices * w->slice_bytes;
  t->is_big = is_big;
  t->shared = 16;
  t->resolution = (t->shared + t->description_bytes + 15) / 16 * 16;
  t->bits = t->resolution + 16;
  t->data = t->bits + 16;
  t->directories = (t->data + all + 15) / 16 * 16;
}

static uint64_t directory_bytes(const vxm_values_writer *w, const tiff *t) {
  directory first, other;
  make_directory(&first, w, t, 0, 0);
  make_directory(&other, w, t, 1, 0);
  return first.size + ((uint64_t)w->space.dims[2] - 1) * other.size;
}

static void pad_to(vxm_output *output, uint64_t from, uint64_t to) {
  static const unsigned char zeros[16];
  vxm_output_write(output, zeros, (size_t)(to - from));
}

static void put_header(vxm_values_writer *w, const tiff *t) {
  vxm_output_write(w->output, "II", 2); /* little-endian */
  put_number(w->output, t->is_big ? 43 : 42, 2);
  if (t->is_big) {
    put_number(w->output, 8, 4); /* bytes of an offset */
    put_number(w->output, t->directories, 8);
  } else {
    put_number(w->output, t->directories, 4);
    pad_to(w->output, 8, 16);
  }
  vxm_output_write(w->output, t->text, t->description_bytes);
  pad_to(w->output, t->shared + t->description_bytes, t->resolution);
  put_resolution(w->output, w->space.voxel_size[0]);
  put_resolution(w->output, w->space.voxel_size[1]);
  put_number(w->output, UINT64_C(0x0008000800080008), 8);
  pad_to(w->output, 8, 16);
}

static vxm_status begin(vxm_values_writer *w, vxm_error *error) {
  vxm_status status = VXM_OK;
  tiff *t = vxm_try_calloc(w->context, 1, sizeof *t, &status, error);
  if (!t)
    return status;
  w->state = t;
  describe(t, w);
  plan(t, w, false);
  if (t->directories + directory_bytes(w, t) > UINT32_MAX)
    plan(t, w, true);
  put_header(w, t);
  return VXM_OK;
}

static vxm_status end(vxm_values_writer *w, vxm_error *error) {
  const tiff *t = w->state;
  uint64_t slices = (uint64_t)w->space.dims[2], at = t->directories;
  (void)error;
  pad_to(w->output, t->data + slices * w->slice_bytes, t->directories);
  for (uint64_t page = 0; page < slices && !vxm_output_failed(w->output); page++) {
    directory d;
    make_directory(&d, w, t, page, 0);
    at += d.size;
    make_directory(&d, w, t, page, page + 1 < slices ? at : 0);
    vxm_output_write(w->output, d.bytes, d.size);
  }
  return VXM_OK;
}

static const vxm_values_writer_kind values_kind = {
    .layout = VXM_LAYOUT_GRID,
    .holds = VXM_HOLDS_ALL,
    .sidecar = &vxm_sidecar_labels,
    .stored = vxm_values_no_halves,
    .convert = vxm_values_widen_halves,
    .file_bytes = vxm_values_plain_bytes,
    .begin = begin,
    .end = end,
};

vxm_status vxm_tiff_write_page(const vxm_values_writer *writer, vxm_output *output, const void *values,
                               int64_t z, vxm_error *error) {
  vxm_values_writer one = *writer;
  one.kind = &values_kind;
  one.output = output;
  one.state = NULL;
  one.space.dims[2] = 1;
  one.space.origin[2] += (double)z * one.space.voxel_size[2];
  vxm_status status = begin(&one, error);
  if (status == VXM_OK) {
    vxm_values_writer_pass(&one, values, one.slice_bytes);
    status = end(&one, error);
  }
  vxm_free(one.context, one.state);
  return status;
}

const vxm_grid_format vxm_format_tif = {
    .name = "tif",
    .holds = VXM_HOLDS_ALL,
    .sniff = vxm_tiff_sniff,
    .read = vxm_tiff_read,
    .read_field = vxm_tiff_read_field,
    .values = &values_kind,
};
