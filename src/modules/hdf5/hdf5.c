/* SPDX-License-Identifier: BSD-3-Clause */
/** The module "hdf5" (gridio/formats/hdf5.h): arrays out. hdf5_read.c reads. */
#include "config.h"

#include "base/context.h"
#include "modules/hdf5/hdf5.h"

enum { CHUNK_X = 8, CHUNK = 64, LEVEL = 4, AXES = 4, CACHE_SLOTS = 12421 };

struct vxm_hdf5 {
  vxm_context *context;
  vxm_hdf5_array array;
  int rank;
  hsize_t dims[AXES];
  hid_t file, set, type;
};

static vxm_status fail(const char *what, vxm_error *error) {
  return vxm_fail(error, VXM_ERROR_RANGE, "HDF5 could not make %s, for lack of memory or of room", what);
}

static hid_t type_of(vxm_scalar scalar) {
  switch (scalar) {
  case VXM_FLOAT64:
    return H5T_NATIVE_DOUBLE;
  case VXM_FLOAT32:
    return H5T_NATIVE_FLOAT;
  case VXM_INT8:
    return H5T_NATIVE_INT8;
  case VXM_UINT16:
    return H5T_NATIVE_UINT16;
  case VXM_INT16:
    return H5T_NATIVE_INT16;
  case VXM_UINT32:
    return H5T_NATIVE_UINT32;
  case VXM_INT32:
    return H5T_NATIVE_INT32;
  case VXM_UINT64:
    return H5T_NATIVE_UINT64;
  case VXM_INT64:
    return H5T_NATIVE_INT64;
  default:
    return H5T_NATIVE_UINT8;
  }
}

/* ---- Attributes ---- */

/** Adds an attribute of `count` values; of one value without a dimension if `count` is 0. */
static bool put_attribute(hid_t set, const char *name, hid_t type, size_t count, const void *values) {
  hsize_t length = count;
  hid_t space = count > 0 ? H5Screate_simple(1, &length, NULL) : H5Screate(H5S_SCALAR);
  hid_t attribute = H5Acreate2(set, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  bool good = attribute >= 0 && H5Awrite(attribute, type, values) >= 0;
  if (attribute >= 0)
    H5Aclose(attribute);
  H5Sclose(space);
  return good;
}

/** Texts of any length, as numpy shows them best. */
static bool put_texts(hid_t set, const char *name, size_t count, const char *const *texts) {
  hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  bool good = put_attribute(set, name, type, count, texts);
  H5Tclose(type);
  return good;
}

static bool put_text(hid_t set, const char *name, const char *text) {
  return put_texts(set, name, 0, &text);
}

static bool put_attributes(const vxm_hdf5 *file) {
  const vxm_hdf5_array *array = &file->array;
  return put_attribute(file->set, "origin", H5T_NATIVE_DOUBLE, 3, array->space.origin) &&
         put_attribute(file->set, "voxel_size", H5T_NATIVE_DOUBLE, 3, array->space.voxel_size) &&
         put_text(file->set, "kind", array->kind) && put_text(file->set, "axes", "x,y,z") &&
         put_text(file->set, "creator", "voxmend");
}

/** Attributes hold less than 64 KiB in the usual format, 16 bytes for a text: longer tables are left to the
 * JSON beside the file. */
static vxm_status label(vxm_hdf5 *file, const vxm_hdf5_label *labels, size_t count, vxm_error *error) {
  enum { LABELS_MAX = 4000 };
  vxm_error local = VXM_ERROR_INIT;
  if (count > LABELS_MAX)
    return VXM_OK;
  const char **names = vxm_alloc(file->context, count, sizeof *names, &local);
  int64_t *voxels = names ? vxm_alloc(file->context, count, sizeof *voxels, &local) : NULL;
  for (size_t l = 0; voxels && l < count; l++) {
    names[l] = labels[l].name;
    voxels[l] = labels[l].voxels;
  }
  if (voxels && (!put_texts(file->set, "label_names", count, names) ||
                 !put_attribute(file->set, "label_voxels", H5T_NATIVE_INT64, count, voxels)))
    fail("the table of labels", &local);
  vxm_free(file->context, voxels);
  vxm_free(file->context, names);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

/* ---- The array ---- */

/** Chunks of some slices, compressed; the cache holds all chunks that a slice meets. */
static bool create_set(vxm_hdf5 *file) {
  hsize_t chunk[AXES], slices = file->dims[0] < CHUNK_X ? file->dims[0] : CHUNK_X;
  size_t held = H5Tget_size(file->type) * (size_t)slices;
  for (int a = 0; a < file->rank; a++) {
    chunk[a] = a == 0 ? slices : file->dims[a] < CHUNK ? file->dims[a] : CHUNK;
    held *= a == 0 ? 1 : (size_t)((file->dims[a] + chunk[a] - 1) / chunk[a] * chunk[a]);
  }
  hid_t space = H5Screate_simple(file->rank, file->dims, NULL), how = H5Pcreate(H5P_DATASET_CREATE),
        access = H5Pcreate(H5P_DATASET_ACCESS);
  H5Pset_chunk(how, file->rank, chunk);
  H5Pset_obj_track_times(how, false);
  if (H5Zfilter_avail(H5Z_FILTER_DEFLATE) > 0)
    H5Pset_deflate(how, LEVEL);
  H5Pset_chunk_cache(access, CACHE_SLOTS, held + ((size_t)1 << 20), 1.0);
  file->set = H5Dcreate2(file->file, "voxels", file->type, space, H5P_DEFAULT, how, access);
  H5Pclose(access);
  H5Pclose(how);
  H5Sclose(space);
  return file->set >= 0;
}

static void destroy(vxm_hdf5 *file) {
  if (!file)
    return;
  if (file->set >= 0)
    H5Dclose(file->set);
  if (file->file >= 0)
    H5Fclose(file->file);
  vxm_free(file->context, file);
}

static vxm_status create(vxm_hdf5 **out, vxm_context *context, const vxm_hdf5_array *array,
                         vxm_error *error) {
  const size_t step = (size_t)1 << 22;
  *out = NULL;
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  vxm_status status = VXM_OK;
  vxm_hdf5 *file = vxm_try_calloc(context, 1, sizeof *file, &status, error);
  if (!file)
    return status;
  *file = (vxm_hdf5){.context = context,
                     .array = *array,
                     .rank = array->channels > 1 ? 4 : 3,
                     .set = -1,
                     .type = type_of(array->scalar)};
  for (int a = 0; a < 3; a++)
    file->dims[a] = (hsize_t)array->space.dims[a];
  file->dims[3] = (hsize_t)array->channels;
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, step, false);
  file->file = H5Fcreate("voxels", H5F_ACC_TRUNC, H5P_DEFAULT, access);
  H5Pclose(access);
  if (file->file < 0 || !create_set(file) || !put_attributes(file)) {
    destroy(file);
    return fail("the array", error);
  }
  *out = file;
  return VXM_OK;
}

static vxm_status put(vxm_hdf5 *file, const void *values, int64_t begin, int64_t end, vxm_error *error) {
  hsize_t from[AXES] = {(hsize_t)begin, 0, 0, 0},
          count[AXES] = {(hsize_t)(end - begin), file->dims[1], file->dims[2], file->dims[3]};
  hid_t there = H5Dget_space(file->set), here = H5Screate_simple(file->rank, count, NULL);
  bool good = H5Sselect_hyperslab(there, H5S_SELECT_SET, from, NULL, count, NULL) >= 0 &&
              H5Dwrite(file->set, file->type, here, there, H5P_DEFAULT, values) >= 0;
  H5Sclose(here);
  H5Sclose(there);
  return good ? VXM_OK : fail("its slices", error);
}

static vxm_status write_file(vxm_hdf5 *file, vxm_output *output, vxm_error *error) {
  H5Dclose(file->set);
  file->set = -1;
  ssize_t size = H5Fflush(file->file, H5F_SCOPE_GLOBAL) >= 0 ? H5Fget_file_image(file->file, NULL, 0) : -1;
  if (size <= 0)
    return fail("the file", error);
  vxm_error local = VXM_ERROR_INIT;
  void *image = vxm_alloc(file->context, (size_t)size, 1, &local);
  if (image && H5Fget_file_image(file->file, image, (size_t)size) != size)
    fail("the file", &local);
  else if (image)
    vxm_output_write(output, image, (size_t)size);
  vxm_free(file->context, image);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

static const vxm_hdf5_functions functions = {
    {vxm_hdf5_prepare, NULL, vxm_hdf5_read_array}, create, put, label, write_file, destroy};

__attribute__((visibility("default"))) extern const vxm_module vxm_module_table;
const vxm_module vxm_module_table = {VXM_BUILD, "HDF5 " H5_VERS_INFO, "BSD-3-Clause", &functions};
