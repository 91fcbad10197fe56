/* SPDX-License-Identifier: BSD-3-Clause */
/** What a Zarr array says of itself, in and out. */
#include "base/endian.h"
#include "base/open_beneath.h"
#include "gridio/common/array_place.h"
#include "gridio/common/json_text.h"
#include "gridio/formats/zarr.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/** Attributes with 65535 labels of 511 letters have some 40 million bytes; whatever is far longer is no text.
 */
enum { LENGTH_MAX = 1 << 27 };

/** What numcodecs compresses at once. */
static const uint64_t CHUNK_BYTES_MAX = INT32_MAX;

/** Each chunk is looked for by its name, also where there is none. */
static const uint64_t CHUNKS_MAX = UINT64_C(1) << 22;

void vxm_zarr_key(char out[VXM_ZARR_KEY_MAX], const vxm_zarr_array *array, const int64_t *chunk) {
  int used = 0;
  for (int a = 0; a < array->rank; a++)
    used += snprintf(out + used, (size_t)(VXM_ZARR_KEY_MAX - used), "%s%" PRId64,
                     a == 0                    ? ""
                     : array->separator == '/' ? "/"
                                               : ".",
                     chunk[a]);
}

/* ---- Out ---- */

static json_t *list_numbers(const int64_t *numbers, int count) {
  json_t *array = json_array();
  for (int a = 0; array && a < count; a++)
    if (json_array_append_new(array, json_integer((json_int_t)numbers[a])) != 0) {
      json_decref(array);
      return NULL;
    }
  return array;
}

static void name_type(char out[8], const vxm_zarr_array *array) {
  size_t size = vxm_scalar_bytes(array->scalar);
  const char *name = vxm_scalar_name(array->scalar);
  char kind = array->is_bool ? 'b' : *name; /* uint8, int16, float32 */
  snprintf(out, 8, "%c%c%zu", size == 1 ? '|' : '<', kind, size);
}

/** The whole text of a tree that it takes over, or of NULL. */
static char *text_of(json_t *root) {
  char *text = root ? vxm_json_text(root, JSON_INDENT(4)) : NULL;
  json_decref(root);
  return text;
}

char *vxm_zarr_array_text(const vxm_zarr_array *array) {
  char type[8];
  name_type(type, array);
  json_t *fill = array->is_bool                       ? json_false()
                 : vxm_scalar_is_float(array->scalar) ? json_real(0)
                                                      : json_integer(0),
         *packed = array->is_packed ? json_pack("{s:s, s:i}", "id", "zlib", "level", 6) : json_null();
  return text_of(json_pack("{s:o, s:o, s:s, s:s, s:o, s:n, s:s, s:o, s:i}", "chunks",
                           list_numbers(array->chunk, array->rank), "compressor", packed,
                           "dimension_separator", ".", "dtype", type, "fill_value", fill, "filters", "order",
                           "C", "shape", list_numbers(array->shape, array->rank), "zarr_format", 2));
}

static bool add_labels(json_t *root, const vxm_label_table *table) {
  json_t *names = json_array(), *voxels = json_array();
  bool good = names && voxels;
  for (size_t l = 1; good && l <= table->count; l++)
    good = json_array_append_new(names, vxm_json_name(vxm_label_table_name(table, l))) == 0 &&
           json_array_append_new(voxels, json_integer((json_int_t)table->voxels[l - 1])) == 0;
  good = good && json_object_set(root, "label_names", names) == 0 &&
         json_object_set(root, "label_voxels", voxels) == 0;
  json_decref(names);
  json_decref(voxels);
  return good;
}

static bool add_pairs(json_t *root, const vxm_metadata *pairs) {
  json_t *object = json_object();
  bool good = object != NULL;
  for (const char *key = NULL; good && (key = vxm_metadata_next(pairs, key)) != NULL;) {
    json_t *name = vxm_json_name(key);
    good = name &&
           json_object_set_new(object, json_string_value(name), vxm_json_name(vxm_metadata_value(key))) == 0;
    json_decref(name);
  }
  good = good && json_object_set(root, "metadata", object) == 0;
  json_decref(object);
  return good;
}

char *vxm_zarr_attributes_text(const vxm_zarr_array *array, const char *kind, const vxm_about *about) {
  const double *o = array->space.origin, *s = array->space.voxel_size;
  json_t *root = json_pack("{s:[s,s,s], s:s, s:s, s:s, s:[f,f,f], s:[f,f,f]}", "_ARRAY_DIMENSIONS", "x", "y",
                           "z", "axes", "x,y,z", "creator", "voxmend", "kind", kind, "origin", o[0], o[1],
                           o[2], "voxel_size", s[0], s[1], s[2]);
  json_t *names = root && array->rank == 4 ? json_object_get(root, "_ARRAY_DIMENSIONS") : NULL;
  bool good = root && (!names || json_array_append_new(names, json_string("color")) == 0) &&
              (about->table.count == 0 || add_labels(root, &about->table)) &&
              (about->pairs.count == 0 || add_pairs(root, &about->pairs));
  if (!good) {
    json_decref(root);
    return NULL;
  }
  return text_of(root);
}

/* ---- In: files ---- */

/** A file of the folder as JSON; *out is NULL if there is none. `path` is for messages. */
static vxm_status load(json_t **out, int folder, const char *name, const char *path, vxm_context *context,
                       vxm_error *error) {
  vxm_input input;
  json_error_t what;
  *out = NULL;
  int descriptor = vxm_regular_open(folder, name, VXM_BENEATH);
  if (descriptor < 0)
    return errno == ENOENT ? VXM_OK : vxm_fail_errno(error, path, "cannot read");
  vxm_status status = vxm_input_take(&input, context, path, descriptor, error);
  close(descriptor);
  if (status != VXM_OK)
    return status;
  if (input.size > LENGTH_MAX)
    status = vxm_fail_byte(error, &input, LENGTH_MAX, "too long to be the description of an array");
  else {
    const char *text = (const char *)input.data;
    *out = json_loadb(text, input.size, 0, &what);
    if (!*out) /* it calls a want of memory by many names; what is damaged fails again */
      *out = json_loadb(text, input.size, 0, &what);
    if (!*out)
      status = vxm_fail_byte(error, &input, what.position, "not JSON: %s", what.text);
    else if (!json_is_object(*out))
      status = vxm_fail_byte(error, &input, 0, "not a JSON object");
  }
  vxm_input_close(&input);
  if (status != VXM_OK) {
    json_decref(*out);
    *out = NULL;
  }
  return status;
}

/** Where a fault lies: ".zarray" of the folder. */
typedef struct location {
  const char *path;
  const vxm_input *input;
} location;

#define FAIL(p, error, ...) \
  vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){(p)->path, 0, -1, -1}, __VA_ARGS__)

/* ---- In: the array ---- */

static bool read_dims(const json_t *root, const char *key, int64_t *out, int rank) {
  const json_t *array = json_object_get(root, key);
  if (json_array_size(array) != (size_t)rank)
    return false;
  for (int a = 0; a < rank; a++) {
    const json_t *number = json_array_get(array, (size_t)a);
    out[a] = (int64_t)json_integer_value(number);
    if (!json_is_integer(number) || out[a] < 1)
      return false;
  }
  return true;
}

static vxm_status read_shape(vxm_zarr_array *out, const json_t *root, const location *p, vxm_error *error) {
  size_t rank = json_array_size(json_object_get(root, "shape"));
  if (rank != 3 && rank != 4)
    return FAIL(p, error,
                "its array has %zu dimensions; read are 3, and 4 of colours, which come last with 3 or 4 "
                "numbers",
                rank);
  out->rank = (int)rank;
  if (!read_dims(root, "shape", out->shape, out->rank))
    return FAIL(p, error, "\"shape\" must be whole numbers of at least 1");
  if (!read_dims(root, "chunks", out->chunk, out->rank))
    return FAIL(p, error, "\"chunks\" must be as many whole numbers as \"shape\", of at least 1");
  return VXM_OK;
}

static vxm_status read_type(vxm_zarr_array *out, const json_t *root, const location *p, vxm_error *error) {
  const char *type = json_string_value(json_object_get(root, "dtype"));
  bool is_sized = type && strlen(type) == 3 && strchr("|<>", type[0]) && strchr("1248", type[2]);
  size_t size = is_sized ? (size_t)(type[2] - '0') : 0;
  char kind = is_sized ? type[1] : ' ';
  bool is_known = (kind == 'b' && size == 1) || kind == 'i' || kind == 'u' || (kind == 'f' && size > 1);
  if (!is_known || (type[0] == '|' && size > 1))
    return FAIL(p, error, "numbers of the type %s are not read; save it as one such as \"|u1\" or \"<f4\"",
                type ? type : "(no text)");
  out->is_bool = kind == 'b';
  out->scalar = vxm_scalar_of(kind == 'b' ? 'u' : kind, size);
  out->is_swapped = size > 1 && vxm_must_swap(type[0] == '>');
  if (out->rank == 4 &&
      (out->scalar != VXM_UINT8 || out->is_bool || (out->shape[3] != 3 && out->shape[3] != 4)))
    return FAIL(p, error, "its array has 4 dimensions, but is not 3 or 4 bytes of a colour for each voxel");
  return VXM_OK;
}

static vxm_status read_packing(vxm_zarr_array *out, const json_t *root, const location *p, vxm_error *error) {
  const json_t *packed = json_object_get(root, "compressor"), *filters = json_object_get(root, "filters");
  const char *id = json_string_value(json_object_get(packed, "id"));
  const char *order = json_string_value(json_object_get(root, "order")),
             *separator = json_string_value(json_object_get(root, "dimension_separator"));
  if (filters && !json_is_null(filters) && json_array_size(filters) > 0)
    return FAIL(p, error, "its chunks go through filters, which are not read; save it with filters=None");
  out->is_packed = packed && !json_is_null(packed);
  if (out->is_packed && (!id || (strcmp(id, "zlib") != 0 && strcmp(id, "gzip") != 0)))
    return FAIL(
        p, error,
        "its chunks are compressed by %s, which is not read; save it with compressor=numcodecs.Zlib() "
        "or None",
        id ? id : "what has no name");
  if (!order || (strcmp(order, "C") != 0 && strcmp(order, "F") != 0))
    return FAIL(p, error, "\"order\" must be \"C\" or \"F\"");
  out->is_fortran = *order == 'F';
  out->separator = separator && strcmp(separator, "/") == 0 ? '/' : '.';
  return VXM_OK;
}

static vxm_status check_chunk(const vxm_zarr_array *array, const location *p, vxm_error *error) {
  uint64_t bytes = vxm_scalar_bytes(array->scalar);
  for (int a = 0; a < array->rank; a++) {
    if ((uint64_t)array->chunk[a] > CHUNK_BYTES_MAX / bytes)
      return FAIL(p, error, "its chunks have over 2 GiB; save it with smaller ones");
    bytes *= (uint64_t)array->chunk[a];
  }
  uint64_t chunks = 1;
  for (int a = 0; a < array->rank; a++) {
    if ((uint64_t)vxm_zarr_chunks(array, a) > CHUNKS_MAX / chunks)
      return FAIL(p, error, "it has over %" PRIu64 " chunks; save it with larger ones", CHUNKS_MAX);
    chunks *= (uint64_t)vxm_zarr_chunks(array, a);
  }
  return VXM_OK;
}

/* ---- In: the fill value ---- */

static void put_integer(unsigned char *to, uint64_t number, size_t size) {
  for (size_t b = 0; b < size; b++)
    to[vxm_must_swap(false) ? size - 1 - b : b] = (unsigned char)(number >> 8 * b);
}

static bool put_float(unsigned char *to, double number, vxm_scalar scalar) {
  enum { HALF_NAN = 0x7e00 };
  float narrow = (float)number;
  if (scalar == VXM_FLOAT64)
    memcpy(to, &number, sizeof number);
  else if (scalar == VXM_FLOAT32)
    memcpy(to, &narrow, sizeof narrow);
  else
    put_integer(to, isnan(number) ? HALF_NAN : 0, 2);
  return scalar != VXM_FLOAT16 || isnan(number) || number == 0;
}

static vxm_status read_fill(vxm_zarr_array *out, const json_t *root, const location *p, vxm_error *error) {
  const json_t *fill = json_object_get(root, "fill_value");
  const char *text = json_string_value(fill);
  bool is_float = vxm_scalar_is_float(out->scalar), good = true;
  if (!fill || json_is_null(fill)) /* it may be anything */
    return VXM_OK;
  if (is_float && text) {
    double number = strcmp(text, "NaN") == 0         ? (double)NAN
                    : strcmp(text, "Infinity") == 0  ? HUGE_VAL
                    : strcmp(text, "-Infinity") == 0 ? -HUGE_VAL
                                                     : 0;
    good = number != 0 && put_float(out->fill, number, out->scalar);
  } else if (is_float)
    good = json_is_number(fill) && put_float(out->fill, json_number_value(fill), out->scalar);
  else if (json_is_boolean(fill))
    out->fill[vxm_must_swap(false) ? vxm_scalar_bytes(out->scalar) - 1 : 0] = json_is_true(fill);
  else {
    json_int_t number = json_integer_value(fill);
    good = json_is_integer(fill) || (json_is_real(fill) && fabs(json_real_value(fill)) < 0x1p53);
    if (good && json_is_real(fill))
      number = (json_int_t)json_real_value(fill);
    if (out->is_bool)
      number = number != 0;
    put_integer(out->fill, (uint64_t)number, vxm_scalar_bytes(out->scalar));
  }
  return good ? VXM_OK : FAIL(p, error, "its \"fill_value\" is not one that is read");
}

/* ---- In: attributes ---- */

/** Takes a text, or a list of texts of which the first three count; false if they are no axes. */
static bool take_axes(int axis[3], const json_t *from) {
  char letters[3];
  if (json_is_string(from))
    return vxm_axes_parse(axis, json_string_value(from), json_string_length(from));
  for (size_t a = 0; a < 3; a++) {
    const json_t *name = json_array_get(from, a);
    if (!json_is_string(name) || json_string_length(name) != 1)
      return false;
    letters[a] = *json_string_value(name);
  }
  return vxm_axes_parse(axis, letters, sizeof letters);
}

/** By our own attribute or that of xarray, whose names may be anything. Without one of them the axes are x,
 * y, z. */
static void read_axes(vxm_zarr_array *out, const json_t *root) {
  const json_t *own = json_object_get(root, "axes");
  if (!take_axes(out->axis, own) && !take_axes(out->axis, json_object_get(root, "_ARRAY_DIMENSIONS")))
    out->has_odd_axes = own && !json_is_null(own);
}

/** One number stands for all axes. */
static bool read_size(double size[3], const json_t *root) {
  const json_t *one = json_object_get(root, "voxel_size");
  if (!json_is_number(one))
    return vxm_json_triple(size, root, "voxel_size");
  size[0] = size[1] = size[2] = json_number_value(one);
  return true;
}

static void read_labels(vxm_about *about, vxm_context *context, const json_t *root) {
  const json_t *names = json_object_get(root, "label_names"), *voxels = json_object_get(root, "label_voxels");
  size_t count = json_array_size(names);
  for (size_t l = 0; l < count && l < VXM_LABELS_MAX; l++) {
    const char *name = json_string_value(json_array_get(names, l));
    if (!name)
      break;
    if (!vxm_label_table_add(&about->table, context, name,
                             (int64_t)json_integer_value(json_array_get(voxels, l)))) {
      about->starved = true;
      break;
    }
  }
}

static void read_about(vxm_about *about, vxm_context *context, const json_t *root) {
  const char *kind = json_string_value(json_object_get(root, "kind"));
  json_t *metadata = json_object_get(root, "metadata");
  vxm_about_name(about, kind);
  read_labels(about, context, root);
  if (about->table.count > 0 && !about->is_declared) {
    about->is_declared = true;
    about->kind = VXM_FIELD_LABELS;
  }
  for (void *at = json_object_iter(metadata); at; at = json_object_iter_next(metadata, at)) {
    const char *key = json_object_iter_key(at);
    const json_t *value = json_object_iter_value(at);
    if (json_is_string(value))
      vxm_metadata_add(&about->pairs, context, key, strlen(key), json_string_value(value),
                       json_string_length(value));
  }
}

static void read_attributes(vxm_zarr_array *out, vxm_context *context, const json_t *root) {
  vxm_space place = out->space;
  read_axes(out, root);
  if (vxm_json_triple(place.origin, root, "origin")) {
    memcpy(out->space.origin, place.origin, sizeof place.origin);
    out->known_place |= VXM_PLACE_ORIGIN;
  }
  if (read_size(place.voxel_size, root)) {
    memcpy(out->space.voxel_size, place.voxel_size, sizeof place.voxel_size);
    out->known_place |= VXM_PLACE_SIZE;
  }
  read_about(&out->about, context, root);
}

/* ---- In: all of it ---- */

/** What else the folder is, if it has no .zarray. */
static vxm_status fail_missing(int folder, const location *p, vxm_error *error) {
  const char *name = p->input->name;
  const vxm_place where = {name, 0, -1, -1};
  if (faccessat(folder, ".zgroup", F_OK, 0) == 0)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, where,
                       "a group of Zarr arrays; give the array in it, such as %s/voxels", name);
  if (faccessat(folder, "zarr.json", F_OK, 0) == 0)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, where,
                       "Zarr's format 3 is not read; save it with zarr_format=2");
  return vxm_fail_at(error, VXM_ERROR_FORMAT, where, "not a Zarr array: it has no .zarray");
}

static vxm_status read_array(vxm_zarr_array *out, const json_t *root, const location *p, vxm_error *error) {
  if (json_integer_value(json_object_get(root, "zarr_format")) != 2)
    return FAIL(p, error, "its \"zarr_format\" is not 2");
  vxm_status status = read_shape(out, root, p, error);
  if (status == VXM_OK)
    status = read_type(out, root, p, error);
  if (status == VXM_OK)
    status = read_packing(out, root, p, error);
  if (status == VXM_OK)
    status = check_chunk(out, p, error);
  return status == VXM_OK ? read_fill(out, root, p, error) : status;
}

static vxm_status read_both(vxm_zarr_array *out, int folder, const vxm_input *input, const char *array_path,
                            const char *attributes_path, vxm_error *error) {
  const location p = {array_path, input};
  json_t *root;
  vxm_status status = load(&root, folder, ".zarray", array_path, input->context, error);
  if (status == VXM_OK)
    status = root ? read_array(out, root, &p, error) : fail_missing(folder, &p, error);
  json_decref(root);
  if (status == VXM_OK)
    status = load(&root, folder, ".zattrs", attributes_path, input->context, error);
  if (status != VXM_OK)
    return status;
  if (root)
    read_attributes(out, input->context, root);
  json_decref(root);
  for (int a = 0; a < 3; a++)
    out->space.dims[out->axis[a]] = out->shape[a];
  const vxm_input named = {.name = array_path};
  return vxm_space_check_file(&out->space, &named, 0, error);
}

vxm_status vxm_zarr_read_metadata(vxm_zarr_array *out, int folder, const vxm_input *input, vxm_error *error) {
  static const char *const names[2] = {"/.zarray", "/.zattrs"};
  char *paths[2] = {NULL, NULL};
  *out = (vxm_zarr_array){.separator = '.', .axis = {0, 1, 2}, .space.voxel_size = {1, 1, 1}};
  for (int f = 0; f < 2; f++)
    if (asprintf(&paths[f], "%s%s", input->name, names[f]) < 0)
      paths[f] = NULL;
  vxm_status status = paths[0] && paths[1] ? read_both(out, folder, input, paths[0], paths[1], error)
                                           : vxm_fail(error, VXM_ERROR_MEMORY, "out of memory");
  free(paths[0]);
  free(paths[1]);
  return status;
}
