/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/nifti_header.h"
#include "base/c_locale.h"
#include "base/endian.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** NIfTI's numbers for the types. Those of 1, 32 (complex), 1536 and above 1280 have none of ours. */
static const struct {
  int code;
  vxm_scalar scalar;
  int stored; /**< numbers of a voxel */
} types[] = {{2, VXM_UINT8, 1},    {4, VXM_INT16, 1},     {8, VXM_INT32, 1},    {16, VXM_FLOAT32, 1},
             {64, VXM_FLOAT64, 1}, {256, VXM_INT8, 1},    {512, VXM_UINT16, 1}, {768, VXM_UINT32, 1},
             {1024, VXM_INT64, 1}, {1280, VXM_UINT64, 1}, {128, VXM_UINT8, 3},  {2304, VXM_UINT8, 4}};

enum { TYPES = sizeof types / sizeof types[0], INTENT_LABEL = 1002, ALIGNED = 2, COMMENT = 6 };

/** Where things stand in the two versions, and how wide numbers are. */
typedef struct places {
  int dim, pixdim, datatype, bitpix, offset, slope, intercept, intent, intent_name, text, qform, sform,
      quatern, rows;
  int dim_bytes, code_bytes; /**< of whole numbers; other numbers are floats of 4 bytes, or of 8 */
  bool is_wide;
} places;

static const places version_1 = {.dim = 40,
                                 .pixdim = 76,
                                 .datatype = 70,
                                 .bitpix = 72,
                                 .offset = 108,
                                 .slope = 112,
                                 .intercept = 116,
                                 .intent = 68,
                                 .intent_name = 328,
                                 .text = 148,
                                 .qform = 252,
                                 .sform = 254,
                                 .quatern = 256,
                                 .rows = 280,
                                 .dim_bytes = 2,
                                 .code_bytes = 2};
static const places version_2 = {.dim = 16,
                                 .pixdim = 104,
                                 .datatype = 12,
                                 .bitpix = 14,
                                 .offset = 168,
                                 .slope = 176,
                                 .intercept = 184,
                                 .intent = 504,
                                 .intent_name = 508,
                                 .text = 240,
                                 .qform = 344,
                                 .sform = 348,
                                 .quatern = 352,
                                 .rows = 400,
                                 .dim_bytes = 8,
                                 .code_bytes = 4,
                                 .is_wide = true};

/* ---- Numbers of either byte order ---- */

static void load(void *to, const unsigned char *from, size_t size, bool is_swapped) {
  unsigned char *bytes = to;
  for (size_t b = 0; b < size; b++)
    bytes[b] = from[is_swapped ? size - 1 - b : b];
}

static int64_t load_int(const unsigned char *from, int size, bool is_swapped) {
  int16_t half;
  int32_t word;
  int64_t whole;
  if (size == 2) {
    load(&half, from, sizeof half, is_swapped);
    return half;
  }
  if (size == 4) {
    load(&word, from, sizeof word, is_swapped);
    return word;
  }
  load(&whole, from, sizeof whole, is_swapped);
  return whole;
}

static double load_real(const unsigned char *from, bool is_wide, bool is_swapped) {
  float narrow;
  double wide;
  if (!is_wide) {
    load(&narrow, from, sizeof narrow, is_swapped);
    return (double)narrow;
  }
  load(&wide, from, sizeof wide, is_swapped);
  return wide;
}

static size_t real_bytes(const places *p) {
  return p->is_wide ? sizeof(double) : sizeof(float);
}

size_t vxm_nifti_header_size(const unsigned char *data, size_t size) {
  if (size >= VXM_NIFTI_1 && memcmp(data + 344, "n+1", 4) == 0)
    return VXM_NIFTI_1;
  return size >= VXM_NIFTI_2 && memcmp(data + 4, "n+2\0\r\n\032\n", 8) == 0 ? VXM_NIFTI_2 : 0;
}

/* ---- Reading ---- */

/** A header on its way in. */
typedef struct reading {
  vxm_nifti_header *header;
  const unsigned char *data;
  const places *at;
  const vxm_input *input;
  bool is_swapped;
} reading;

static double real_at(const reading *r, int place, int index) {
  return load_real(r->data + place + (size_t)index * real_bytes(r->at), r->at->is_wide, r->is_swapped);
}

static int64_t code_at(const reading *r, int place) {
  return load_int(r->data + place, r->at->code_bytes, r->is_swapped);
}

static int64_t dim_at(const reading *r, int index) {
  return load_int(r->data + r->at->dim + index * r->at->dim_bytes, r->at->dim_bytes, r->is_swapped);
}

static vxm_status read_dims(const reading *r, int64_t dims[3], vxm_error *error) {
  int64_t count = dim_at(r, 0);
  if (count < 1 || count > 7)
    return vxm_fail_byte(error, r->input, r->at->dim, "it has %" PRId64 " dimensions, not 1 to 7", count);
  for (int a = 0; a < 3; a++)
    dims[a] = a < count ? dim_at(r, a + 1) : 1;
  for (int a = 4; a <= count; a++)
    if (dim_at(r, a) > 1)
      return vxm_fail_byte(error, r->input, r->at->dim,
                           "it is a series (%" PRId64 " along dimension %d), not one volume", dim_at(r, a),
                           a);
  return VXM_OK;
}

static vxm_status read_type(const reading *r, vxm_error *error) {
  int64_t code = load_int(r->data + r->at->datatype, 2, r->is_swapped);
  vxm_raster *raster = &r->header->raster;
  for (size_t t = 0; t < TYPES; t++)
    if (types[t].code == code) {
      raster->scalar = types[t].scalar;
      raster->stored = types[t].stored;
      raster->channels = types[t].stored > 1 ? 4 : 1;
      return VXM_OK;
    }
  return vxm_fail_byte(error, r->input, r->at->datatype,
                       "its values are of type %" PRId64 ", which is none of whole or floating-point numbers "
                       "up to 64 bits, or colours",
                       code);
}

static void read_scale(const reading *r) {
  vxm_raster *raster = &r->header->raster;
  raster->slope = real_at(r, r->at->slope, 0);
  raster->intercept = real_at(r, r->at->intercept, 0);
  raster->is_scaled = raster->stored == 1 && isfinite(raster->slope) && isfinite(raster->intercept) &&
                      raster->slope != 0 && (raster->slope != 1 || raster->intercept != 0);
}

/** The world of the middle of voxel (i,j,k), from the columns of a matrix. */
static void read_sform(const reading *r, double m[3][4]) {
  for (int row = 0; row < 3; row++)
    for (int c = 0; c < 4; c++)
      m[row][c] = real_at(r, r->at->rows, 4 * row + c);
}

/** What is left of 1 below this is rounding: a half turn. */
static const double half_turn = 1e-6;

/** The same from a quaternion whose first number is left out, and the sizes of voxels. */
static void read_qform(const reading *r, double m[3][4]) {
  double b = real_at(r, r->at->quatern, 0), c = real_at(r, r->at->quatern, 1),
         d = real_at(r, r->at->quatern, 2), square = b * b + c * c + d * d,
         a = square < 1 - half_turn ? sqrt(1 - square) : 0, length = a > 0 ? 1 : sqrt(square);
  b /= length;
  c /= length;
  d /= length;
  const double turn[3][3] = {{a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
                             {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
                             {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c}};
  double side = real_at(r, r->at->pixdim, 0) < 0 ? -1 : 1;
  for (int row = 0; row < 3; row++) {
    for (int j = 0; j < 3; j++)
      m[row][j] = turn[row][j] * real_at(r, r->at->pixdim, j + 1) * (j == 2 ? side : 1);
    m[row][3] = real_at(r, r->at->quatern, 3 + row);
  }
}

static void read_sizes(const reading *r, double m[3][4]) {
  for (int row = 0; row < 3; row++)
    for (int j = 0; j < 4; j++)
      m[row][j] = row == j ? real_at(r, r->at->pixdim, j + 1) : 0;
}

/** The axis of the world that a column runs along, or -1 if it is turned. */
static int axis_of(double m[3][4], int column) {
  int axis = 0;
  double length = 0;
  for (int row = 0; row < 3; row++) {
    axis = fabs(m[row][column]) > fabs(m[axis][column]) ? row : axis;
    length = hypot(length, m[row][column]);
  }
  for (int row = 0; row < 3; row++)
    if (row != axis && fabs(m[row][column]) > 1e-4 * length)
      return -1;
  return length > 0 && isfinite(length) ? axis : -1;
}

static vxm_status read_place(const reading *r, const int64_t dims[3], vxm_error *error) {
  vxm_raster *raster = &r->header->raster;
  double m[3][4];
  bool is_taken[3] = {false, false, false};
  if (code_at(r, r->at->sform) > 0)
    read_sform(r, m);
  else if (code_at(r, r->at->qform) > 0)
    read_qform(r, m);
  else
    read_sizes(r, m);
  for (int j = 0; j < 3; j++) {
    int axis = axis_of(m, j);
    if (axis < 0 || is_taken[axis])
      return vxm_fail_byte(
          error, r->input, r->at->rows,
          "its voxels are turned against the axes of space, or have no size; resample it along "
          "them first");
    is_taken[axis] = true;
    raster->axis[j] = axis;
    raster->is_flipped[j] = m[axis][j] < 0;
    double size = fabs(m[axis][j]),
           low = raster->is_flipped[j] ? m[axis][3] - size * ((double)dims[j] - 1) : m[axis][3];
    raster->space.dims[axis] = dims[j];
    raster->space.voxel_size[axis] = size;
    raster->space.origin[axis] = low - size / 2;
  }
  return vxm_space_check_file(&raster->space, r->input, (size_t)r->at->dim, error);
}

static void read_about(const reading *r) {
  char name[17] = "";
  vxm_about *about = &r->header->about;
  vxm_field_kind kind;
  memcpy(name, r->data + r->at->intent_name, 16);
  if (code_at(r, r->at->intent) == INTENT_LABEL)
    *about = (vxm_about){.is_declared = true, .kind = VXM_FIELD_LABELS};
  else if (vxm_field_kind_find(&kind, name) && kind != VXM_FIELD_NUMBERS)
    *about = (vxm_about){.is_declared = true, .kind = kind};
  if (r->header->raster.channels == 4)
    *about = (vxm_about){.is_declared = true, .kind = VXM_FIELD_COLORS};
}

static vxm_status read_offset(const reading *r, size_t size, vxm_error *error) {
  double narrow = real_at(r, r->at->offset, 0);
  int64_t wide = r->at->is_wide                   ? load_int(r->data + r->at->offset, 8, r->is_swapped)
                 : narrow >= 0 && narrow < 0x1p40 ? (int64_t)narrow
                                                  : -1;
  if (wide < (int64_t)size + VXM_NIFTI_MARK)
    return vxm_fail_byte(error, r->input, r->at->offset, "its values begin within the header");
  r->header->data = (uint64_t)wide;
  return VXM_OK;
}

vxm_status vxm_nifti_header_read(vxm_nifti_header *out, const unsigned char *data, size_t size,
                                 const vxm_input *input, vxm_error *error) {
  int64_t dims[3];
  reading r = {out, data, size == VXM_NIFTI_1 ? &version_1 : &version_2, input, false};
  *out = (vxm_nifti_header){.raster = {.channels = 1}};
  r.is_swapped = load_int(data, 4, false) != (int64_t)size;
  if (r.is_swapped && load_int(data, 4, true) != (int64_t)size)
    return vxm_fail_byte(error, input, 0, "its header does not tell a size of %zu bytes", size);
  out->is_swapped = out->raster.is_swapped = r.is_swapped;
  vxm_status status = read_dims(&r, dims, error);
  if (status == VXM_OK)
    status = read_type(&r, error);
  if (status == VXM_OK)
    status = read_place(&r, dims, error);
  if (status == VXM_OK)
    status = read_offset(&r, size, error);
  if (status == VXM_OK) {
    read_scale(&r);
    read_about(&r);
  }
  return status;
}

/* ---- The extension: what floats of 32 bits do not hold ---- */

static const char signature[] = "voxmend place: ";

/** Numbers as written are taken if they are those of the header, up to its rounding. */
static bool is_near(double exact, double rounded, double size) {
  return fabs(exact - rounded) <= 1e-6 * (fabs(rounded) + size);
}

static void read_exact(vxm_space *space, const char *text) {
  double v[6];
  char *end = (char *)text;
  for (int n = 0; n < 6; n++) {
    const char *from = end;
    v[n] = strtod(from, &end);
    if (end == from || !isfinite(v[n]))
      return;
  }
  for (int a = 0; a < 3; a++)
    if (!(v[3 + a] > 0) || !is_near(v[a], space->origin[a], space->voxel_size[a]) ||
        !is_near(v[3 + a], space->voxel_size[a], 0))
      return;
  for (int a = 0; a < 3; a++) {
    space->origin[a] = v[a];
    space->voxel_size[a] = v[3 + a];
  }
}

void vxm_nifti_extension_read(vxm_nifti_header *h, const unsigned char *data, size_t size) {
  char text[512];
  size_t mark = strlen(signature);
  if (size < 8 + mark || load_int(data + 4, 4, h->is_swapped) != COMMENT ||
      memcmp(data + 8, signature, mark) != 0)
    return;
  size_t length = size - 8 - mark < sizeof text ? size - 8 - mark : sizeof text - 1;
  memcpy(text, data + 8 + mark, length);
  text[length] = '\0';
  locale_t previous = uselocale(vxm_c_locale());
  read_exact(&h->raster.space, text);
  uselocale(previous);
}

/* ---- Writing: little-endian ---- */

static void put_int(unsigned char *to, int64_t value, int size) {
  vxm_store_le(to, (uint64_t)value, (size_t)size);
}

static void put_real(unsigned char *to, double value, bool is_wide) {
  if (is_wide)
    vxm_store_double(to, value);
  else
    vxm_store_f32(to, (float)value, vxm_must_swap(false));
}

static const char *name_of(const vxm_values_spec *values) {
  return values->about->is_declared ? vxm_field_kind_name(values->about->kind) : "";
}

static void put_type(unsigned char *bytes, const places *p, const vxm_values_spec *values) {
  for (size_t t = 0; t < TYPES; t++)
    if (types[t].scalar == values->scalar && types[t].stored == values->channels) {
      put_int(bytes + p->datatype, types[t].code, 2);
      put_int(bytes + p->bitpix, 8 * (int64_t)vxm_scalar_bytes(values->scalar) * values->channels, 2);
      break;
    }
  if (values->about->is_declared && values->about->kind == VXM_FIELD_LABELS)
    put_int(bytes + p->intent, INTENT_LABEL, p->code_bytes);
  memcpy(bytes + p->intent_name, name_of(values), strlen(name_of(values)));
}

/** Whether an axis of the model runs against that of the world: where the values came from a file that named
 * its space, which then is to the left, or to the back (nrrd_header.c carries the name along). */
static bool is_turned(const vxm_values_spec *values, int axis) {
  const char *name = vxm_metadata_find(&values->about->pairs, "nrrd_space");
  if (!name || axis == 2)
    return false;
  if (strlen(name) == 3 && strchr("LR", name[0]) && strchr("AP", name[1]))
    return name[axis] == (axis == 0 ? 'L' : 'P');
  return axis == 0 ? strncmp(name, "left-", 5) == 0 : strstr(name, "-posterior-") != NULL;
}

/** Both forms of the transform. With axes along or against those of the world the quaternion is that of half
 * a turn, or of none, and a reflection of the last axis. */
static void put_place(unsigned char *bytes, const places *p, const vxm_space *space,
                      const vxm_values_spec *values) {
  size_t real = real_bytes(p);
  bool x = is_turned(values, 0), y = is_turned(values, 1);
  put_real(bytes + p->pixdim, x != y ? -1 : 1, p->is_wide);
  put_int(bytes + p->qform, ALIGNED, p->code_bytes);
  put_int(bytes + p->sform, ALIGNED, p->code_bytes);
  if (x || y)
    put_real(bytes + p->quatern + (size_t)(x && y ? 2 : x ? 1 : 0) * real, 1, p->is_wide);
  for (size_t a = 0; a < 3; a++) {
    double size = space->voxel_size[a], centre = space->origin[a] + size / 2,
           way = is_turned(values, (int)a) ? -1 : 1;
    put_real(bytes + p->pixdim + (a + 1) * real, size, p->is_wide);
    put_real(bytes + p->quatern + (3 + a) * real, way * centre, p->is_wide);
    put_real(bytes + p->rows + (4 * a + a) * real, way * size, p->is_wide);
    put_real(bytes + p->rows + (4 * a + 3) * real, way * centre, p->is_wide);
  }
}

static void put_dims(unsigned char *bytes, const places *p, const vxm_space *space) {
  for (int d = 0; d < 8; d++)
    put_int(bytes + p->dim + d * p->dim_bytes, d == 0 ? 3 : d <= 3 ? space->dims[d - 1] : 1, p->dim_bytes);
}

/** The extension with its size, a multiple of 16, first. */
static size_t put_extension(unsigned char *to, size_t room, const vxm_space *space) {
  const double *o = space->origin, *s = space->voxel_size;
  int length = snprintf((char *)to + 8, room - 8, "%s%.17g %.17g %.17g %.17g %.17g %.17g", signature, o[0],
                        o[1], o[2], s[0], s[1], s[2]);
  size_t size = (8 + (size_t)length + 15) / 16 * 16;
  put_int(to, (int64_t)size, 4);
  put_int(to + 4, COMMENT, 4);
  return size;
}

/** Whether the place can be told in 32-bit floats, as the first version does. */
static bool is_narrow(const vxm_space *space) {
  for (int a = 0; a < 3; a++) {
    double size = space->voxel_size[a];
    if (size < FLT_MIN || size > FLT_MAX || fabs(space->origin[a] + size / 2) > FLT_MAX)
      return false;
  }
  return true;
}

void vxm_nifti_header_make(vxm_nifti_block *out, const vxm_space *space, const vxm_values_spec *values) {
  const int64_t *n = space->dims;
  bool is_wide = n[0] > INT16_MAX || n[1] > INT16_MAX || n[2] > INT16_MAX || !is_narrow(space);
  const places *p = is_wide ? &version_2 : &version_1;
  size_t size = is_wide ? VXM_NIFTI_2 : VXM_NIFTI_1;
  unsigned char *bytes = out->bytes;
  memset(out, 0, sizeof *out);
  put_int(bytes, (int64_t)size, 4);
  memcpy(bytes + (is_wide ? 4 : 344), is_wide ? "n+2\0\r\n\032\n" : "n+1", is_wide ? 8 : 4);
  put_dims(bytes, p, space);
  put_type(bytes, p, values);
  put_place(bytes, p, space, values);
  memcpy(bytes + p->text, "voxmend", 7);
  locale_t previous = uselocale(vxm_c_locale());
  bytes[size] = 1; /* an extension follows */
  size_t front = size + VXM_NIFTI_MARK;
  out->size = front + put_extension(bytes + front, sizeof out->bytes - front, space);
  uselocale(previous);
  if (is_wide)
    put_int(bytes + p->offset, (int64_t)out->size, 8);
  else
    put_real(bytes + p->offset, (double)out->size, false);
}
