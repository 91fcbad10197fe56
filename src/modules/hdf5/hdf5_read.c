/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Arrays in, by HDF5, in a process that ends afterwards (sandbox/reader_main.c): HDF5 trusts what it reads.
 * The file is an image in memory; other files that it names, and filters that would have to be loaded, are
 * not to be had.
 */
#include "config.h"

#include "base/scalar.h"
#include "modules/hdf5/hdf5.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SLAB_BYTES = 1 << 24, CACHE_BYTES = 1 << 28, CACHE_SLOTS = 12421, TEXT_MAX = 1 << 16 };

/** All that reading takes. */
typedef struct reading {
  vxm_voxel_sink *sink;
  vxm_context *context;
  const vxm_reader_request *request;
  vxm_hdf5_set set;
  int channels;       /**< in memory */
  hsize_t slices;     /**< that are read at once */
  size_t slice_bytes; /**< in memory */
} reading;

#define FAIL(r, status, error, ...) \
  vxm_fail_at(error, status, (vxm_place){(r)->request->name, 0, -1, -1}, __VA_ARGS__)

/* ---- What HDF5 says ---- */

/** The innermost of its complaints. */
typedef struct complaint {
  char text[160];
  bool is_memory;
} complaint;

static herr_t take_complaint(unsigned n, const H5E_error2_t *what, void *payload) {
  complaint *c = payload;
  if (n == 0 && what->desc)
    snprintf(c->text, sizeof c->text, ": %s", what->desc);
  c->is_memory |= what->maj_num == H5E_RESOURCE && what->min_num == H5E_NOSPACE;
  return 0;
}

static vxm_status fail_inside(const reading *r, const char *what, vxm_error *error) {
  complaint c = {.text = ""};
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_complaint, &c);
  if (c.is_memory)
    return vxm_fail(error, VXM_ERROR_MEMORY, "HDF5 is out of memory");
  return FAIL(r, VXM_ERROR_FORMAT, error, "HDF5 cannot read %s%s", what, c.text);
}

/* ---- Attributes ---- */

/** Takes three numbers; of "voxel_size" also one, for all axes. */
static bool read_triple(hid_t set, const char *name, bool may_be_one, double out[3]) {
  if (H5Aexists(set, name) <= 0)
    return false;
  hid_t attribute = H5Aopen(set, name, H5P_DEFAULT);
  hid_t space = attribute >= 0 ? H5Aget_space(attribute) : -1;
  hssize_t count = space >= 0 ? H5Sget_simple_extent_npoints(space) : 0;
  bool is_one = count == 1 && may_be_one;
  bool good = (count == 3 || is_one) && H5Aread(attribute, H5T_NATIVE_DOUBLE, out) >= 0;
  if (good && is_one)
    out[1] = out[2] = out[0];
  if (space >= 0)
    H5Sclose(space);
  if (attribute >= 0)
    H5Aclose(attribute);
  return good;
}

/** Texts of an attribute, of fixed lengths or of any. */
typedef struct texts {
  size_t count, width; /**< width 0: `any` has them */
  char **any;
  char *fixed;
} texts;

static texts read_texts(const reading *r, const char *name) {
  texts out = {.count = 0};
  vxm_error ignored = VXM_ERROR_INIT;
  hid_t attribute =
      H5Aexists(r->set.set, name) > 0 ? H5Aopen(r->set.set, name, H5P_DEFAULT) : H5I_INVALID_HID;
  if (attribute < 0)
    return out;
  hid_t space = H5Aget_space(attribute), type = H5Aget_type(attribute);
  hssize_t count = space >= 0 ? H5Sget_simple_extent_npoints(space) : 0;
  size_t width = type >= 0 && H5Tget_class(type) == H5T_STRING ? H5Tget_size(type) : 0;
  if (count > 0 && count <= TEXT_MAX && width > 0 && width <= TEXT_MAX) {
    bool is_any = H5Tis_variable_str(type) > 0;
    void *room = vxm_calloc(r->context, (size_t)count, is_any ? sizeof(char *) : width, &ignored);
    if (room && H5Aread(attribute, type, room) >= 0)
      out = (texts){(size_t)count, is_any ? 0 : width, is_any ? room : NULL, is_any ? NULL : room};
  }
  return out; /* the process ends; so does what is open */
}

/** Text `t`; it does not have to end in a zero byte. */
static const char *text_at(const texts *from, size_t t, size_t *size) {
  const char *text = from->width > 0 ? from->fixed + t * from->width : from->any[t] ? from->any[t] : "";
  *size = from->width > 0 ? strnlen(text, from->width) : strlen(text);
  return text;
}

static vxm_status send_text(const reading *r, const char *name, vxm_error *error) {
  const texts found = read_texts(r, name);
  size_t size;
  if (found.count != 1)
    return VXM_OK;
  const char *text = text_at(&found, 0, &size);
  return r->sink->text(r->sink->payload, name, strlen(name), text, size, error);
}

/** One text, or one for each axis, of which those of x, y and z are the first three. */
static vxm_status send_axes(const reading *r, vxm_error *error) {
  static const char key[] = "axes";
  const texts found = read_texts(r, key);
  char all[32] = "";
  size_t filled = 0;
  for (size_t t = 0; t < found.count && t < 3; t++) {
    size_t size;
    const char *text = text_at(&found, t, &size);
    if (size > sizeof all - filled)
      size = sizeof all - filled;
    memcpy(all + filled, text, size);
    filled += size;
  }
  /* What is there and no text, such as numbers, is told as well. */
  return found.count > 0 || H5Aexists(r->set.set, key) > 0
             ? r->sink->text(r->sink->payload, key, strlen(key), all, filled, error)
             : VXM_OK;
}

/** Each name of a label goes over under its count of voxels. */
static vxm_status send_labels(const reading *r, vxm_error *error) {
  const texts names = read_texts(r, "label_names");
  vxm_status status = VXM_OK;
  int64_t *voxels = vxm_try_calloc(r->context, names.count + 1, sizeof *voxels, &status, error);
  if (!voxels)
    return status;
  hid_t attribute = names.count > 0 && H5Aexists(r->set.set, "label_voxels") > 0
                        ? H5Aopen(r->set.set, "label_voxels", H5P_DEFAULT)
                        : H5I_INVALID_HID;
  hid_t space = attribute >= 0 ? H5Aget_space(attribute) : H5I_INVALID_HID;
  if (space >= 0 && H5Sget_simple_extent_npoints(space) == (hssize_t)names.count &&
      H5Aread(attribute, H5T_NATIVE_INT64, voxels) < 0)
    memset(voxels, 0, names.count * sizeof *voxels);
  for (size_t l = 0; l < names.count && status == VXM_OK; l++) {
    char key[40];
    size_t size;
    const char *name = text_at(&names, l, &size);
    int length = snprintf(key, sizeof key, VXM_HDF5_LABEL "%" PRId64, voxels[l]);
    status = r->sink->text(r->sink->payload, key, (size_t)length, name, size, error);
  }
  vxm_free(r->context, voxels);
  return status;
}

/* ---- The dataset ---- */

/** Refuses what lies in other files, or is packed by what is not here. */
static vxm_status check_storage(const reading *r, hid_t how, const char *name, vxm_error *error) {
  if (H5Pget_layout(how) == H5D_VIRTUAL || H5Pget_external_count(how) > 0)
    return FAIL(r, VXM_ERROR_FORMAT, error, "the values of %.80s lie in other files, which are not opened",
                name);
  int filters = H5Pget_nfilters(how);
  for (int f = 0; f < filters; f++) {
    unsigned flags, config;
    size_t values = 0;
    char title[64] = "";
    H5Z_filter_t filter =
        H5Pget_filter2(how, (unsigned)f, &flags, &values, NULL, sizeof title, title, &config);
    title[sizeof title - 1] = '\0';
    if (filter < 0 || H5Zfilter_avail(filter) <= 0)
      return FAIL(r, VXM_ERROR_FORMAT, error,
                  "%.80s is packed by the filter %d%s%.40s, which is not read; save it with "
                  "compression=\"gzip\" or none",
                  name, (int)filter, *title ? ", " : "", title);
  }
  return VXM_OK;
}

/** How many slices go at once: those of a chunk, so that none is unpacked twice, if these are not too many.
 */
static void plan(reading *r, hid_t how) {
  hsize_t chunk[4] = {1, 1, 1, 1}, most = SLAB_BYTES / r->slice_bytes;
  if (H5Pget_layout(how) == H5D_CHUNKED)
    H5Pget_chunk(how, r->set.rank, chunk);
  else
    chunk[0] = most;
  r->slices = chunk[0] < most ? chunk[0] : most;
  if (r->slices > r->set.dims[0])
    r->slices = r->set.dims[0];
  if (r->slices < 1)
    r->slices = 1;
}

/** Opens it again with room for all chunks that a slab meets, and finds out how to read it. */
static vxm_status open_set(reading *r, hid_t file, const char *name, vxm_error *error) {
  if (!vxm_hdf5_open(&r->set, file, name))
    return fail_inside(r, "the dataset", error);
  hid_t how = H5Dget_create_plist(r->set.set);
  vxm_status status =
      how < 0 ? fail_inside(r, "how its values lie", error) : check_storage(r, how, name, error);
  r->channels = r->set.rank == 4 ? 4 : 1;
  uint64_t bytes = vxm_scalar_bytes(r->set.scalar) * (uint64_t)r->channels;
  if (status == VXM_OK && r->set.dims[1] * r->set.dims[2] > INT32_MAX / bytes)
    status = FAIL(r, VXM_ERROR_RANGE, error, "a slice of %.80s has over 2 GiB", name);
  if (status != VXM_OK)
    return status;
  r->slice_bytes = (size_t)(r->set.dims[1] * r->set.dims[2] * bytes);
  plan(r, how);
  H5Pclose(how);
  hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
  H5Pset_chunk_cache(access, CACHE_SLOTS, CACHE_BYTES, 1.0);
  H5Dclose(r->set.set);
  r->set.set = H5Dopen2(file, name, access);
  H5Pclose(access);
  return r->set.set >= 0 ? VXM_OK : fail_inside(r, "the dataset", error);
}

static vxm_status send_head(const reading *r, const vxm_hdf5_survey *survey, vxm_error *error) {
  vxm_sink_array array = {.scalar = r->set.scalar, .is_color = r->set.rank == 4, .fits = survey->fitting};
  for (int a = 0; a < 3; a++)
    array.shape[a] = (int64_t)r->set.dims[a];
  array.known_place = read_triple(r->set.set, "origin", false, array.place) ? VXM_PLACE_ORIGIN : 0;
  array.known_place |= read_triple(r->set.set, "voxel_size", true, array.place + 3) ? VXM_PLACE_SIZE : 0;
  vxm_status status = send_text(r, "kind", error);
  if (status == VXM_OK)
    status = send_axes(r, error);
  if (status == VXM_OK)
    status = send_labels(r, error);
  return status == VXM_OK ? r->sink->array(r->sink->payload, &array, error) : status;
}

/** Some slices; colours without opacity get the full one. */
static vxm_status send_slab(const reading *r, unsigned char *room, hsize_t begin, hsize_t count,
                            vxm_error *error) {
  const hsize_t *n = r->set.dims, from[4] = {begin, 0, 0, 0}, part[4] = {count, n[1], n[2], n[3]},
                none[4] = {0, 0, 0, 0}, held[4] = {count, n[1], n[2], 4};
  size_t bytes = (size_t)count * r->slice_bytes;
  if (r->set.rank == 4)
    memset(room, UINT8_MAX, bytes);
  hid_t there = H5Dget_space(r->set.set), here = H5Screate_simple(r->set.rank, held, NULL);
  bool good = there >= 0 && here >= 0 &&
              H5Sselect_hyperslab(there, H5S_SELECT_SET, from, NULL, part, NULL) >= 0 &&
              H5Sselect_hyperslab(here, H5S_SELECT_SET, none, NULL, part, NULL) >= 0 &&
              H5Dread(r->set.set, r->set.read_as, here, there, H5P_DEFAULT, room) >= 0;
  vxm_status status = good ? VXM_OK : fail_inside(r, "its values", error);
  if (here >= 0)
    H5Sclose(here);
  if (there >= 0)
    H5Sclose(there);
  return status == VXM_OK ? r->sink->values(r->sink->payload, room, bytes, error) : status;
}

static vxm_status send_values(const reading *r, vxm_error *error) {
  vxm_status status = VXM_OK;
  unsigned char *room = vxm_try_alloc(r->context, (size_t)r->slices, r->slice_bytes, &status, error);
  for (hsize_t at = 0; at < r->set.dims[0] && status == VXM_OK; at += r->slices) {
    hsize_t left = r->set.dims[0] - at;
    status = send_slab(r, room, at, left < r->slices ? left : r->slices, error);
    if (status == VXM_OK)
      status = vxm_progress(r->context, "reading", (double)at / (double)r->set.dims[0], error);
  }
  vxm_free(r->context, room);
  return status;
}

/* ---- The file ---- */

static vxm_status choose(const reading *r, const vxm_hdf5_survey *survey, vxm_error *error) {
  if (survey->sets == 0)
    return FAIL(r, VXM_ERROR_FORMAT, error, "there is no dataset in it");
  if (survey->fitting == 0)
    return FAIL(r, VXM_ERROR_FORMAT, error,
                "no dataset has three dimensions of numbers (colours: a fourth of 3 or 4 bytes); there is %s",
                survey->all);
  if (survey->fitting > 1 && !survey->has_own)
    return FAIL(r, VXM_ERROR_FORMAT, error,
                "%u datasets could be the voxels, and none is called \"voxels\"; save one of them alone: %s",
                survey->fitting, survey->fit);
  return VXM_OK;
}

vxm_status vxm_hdf5_read_array(vxm_voxel_sink *sink, vxm_context *context, const vxm_reader_request *request,
                               vxm_error *error) {
  enum { NEEDED = 4 << 20 }; /* with less HDF5 crashes, where it should say so */
  static vxm_hdf5_survey survey;
  vxm_status status = VXM_OK;
  void *room = vxm_try_alloc(context, NEEDED, 1, &status, error);
  if (!room)
    return status;
  vxm_free(context, room);
  reading r = {.sink = sink, .context = context, .request = request};
  hid_t file = vxm_hdf5_open_image(request->data, request->size);
  if (file < 0)
    return fail_inside(&r, "it", error);
  if (!vxm_hdf5_look(&survey, file))
    return fail_inside(&r, "what is in it", error);
  status = choose(&r, &survey, error);
  if (status == VXM_OK)
    status = open_set(&r, file, survey.name, error);
  if (status == VXM_OK)
    status = send_head(&r, &survey, error);
  return status == VXM_OK ? send_values(&r, error) : status; /* the process ends; so does what is open */
}

/** No filter is loaded that a file asks for. */
void vxm_hdf5_prepare(void) {
  H5dont_atexit();
  H5open();
  H5PLset_loading_state(0);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}
