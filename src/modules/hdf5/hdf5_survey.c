/* SPDX-License-Identifier: BSD-3-Clause */
/** Which datasets a file has, and which of them are voxels: numbers of three dimensions, or colours. */
#include "config.h"

#include "modules/hdf5/hdf5.h"

#include <stdio.h>
#include <string.h>

#if H5_VERSION_GE(1, 12, 0)
typedef H5O_info1_t object_info;
#else
typedef H5O_info_t object_info;
#endif

/* ---- One of them ---- */

/** The type in memory of the numbers of a file, or -1. Booleans of numpy are an enumeration of bytes. */
static hid_t find_type(vxm_scalar *scalar, hid_t type) {
  static const vxm_scalar whole[2][4] = {{VXM_UINT8, VXM_UINT16, VXM_UINT32, VXM_UINT64},
                                         {VXM_INT8, VXM_INT16, VXM_INT32, VXM_INT64}};
  const hid_t native[2][4] = {{H5T_NATIVE_UINT8, H5T_NATIVE_UINT16, H5T_NATIVE_UINT32, H5T_NATIVE_UINT64},
                              {H5T_NATIVE_INT8, H5T_NATIVE_INT16, H5T_NATIVE_INT32, H5T_NATIVE_INT64}};
  size_t size = H5Tget_size(type);
  int width = size == 1 ? 0 : size == 2 ? 1 : size == 4 ? 2 : size == 8 ? 3 : -1;
  H5T_class_t class = H5Tget_class(type);
  *scalar = VXM_UINT8;
  if (class == H5T_INTEGER && width >= 0) {
    int is_signed = H5Tget_sign(type) == H5T_SGN_2;
    *scalar = whole[is_signed][width];
    return H5Tcopy(native[is_signed][width]);
  }
  if (class == H5T_FLOAT && width > 0) {
    *scalar = size == 8 ? VXM_FLOAT64 : VXM_FLOAT32;
    return H5Tcopy(size == 8 ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT);
  }
  if (class == H5T_ENUM && size == 1)
    return H5Tget_native_type(type, H5T_DIR_DEFAULT);
  return class == H5T_BITFIELD && size == 1 ? H5Tcopy(H5T_NATIVE_B8) : -1;
}

static bool is_shaped(const vxm_hdf5_set *s) {
  bool has_voxels =
      s->rank == 3 || (s->rank == 4 && s->scalar == VXM_UINT8 && (s->dims[3] == 3 || s->dims[3] == 4) &&
                       H5Tget_class(s->type) == H5T_INTEGER);
  for (int a = 0; has_voxels && a < 3; a++)
    has_voxels = s->dims[a] >= 1 && s->dims[a] <= INT32_MAX;
  return has_voxels;
}

static void take_shape(vxm_hdf5_set *out) {
  hid_t space = H5Dget_space(out->set);
  int rank = space >= 0 ? H5Sget_simple_extent_ndims(space) : -1;
  out->rank = rank;
  if (rank < 0 || rank > 4 || H5Sget_simple_extent_dims(space, out->dims, NULL) != rank)
    out->rank = rank > 4 ? rank : -1;
  if (space >= 0)
    H5Sclose(space);
}

/** Opens whatever a dataset is; `read_as` stays -1 where it is no numbers. */
static bool open_any(vxm_hdf5_set *out, hid_t file, const char *name) {
  *out = (vxm_hdf5_set){.set = H5Dopen2(file, name, H5P_DEFAULT), .type = -1, .read_as = -1, .rank = -1};
  if (out->set < 0)
    return false;
  out->type = H5Dget_type(out->set);
  if (out->type >= 0)
    out->read_as = find_type(&out->scalar, out->type);
  take_shape(out);
  return true;
}

void vxm_hdf5_close(vxm_hdf5_set *set) {
  if (set->read_as >= 0)
    H5Tclose(set->read_as);
  if (set->type >= 0)
    H5Tclose(set->type);
  if (set->set >= 0)
    H5Dclose(set->set);
  set->set = set->type = set->read_as = -1;
}

static bool fits(const vxm_hdf5_set *set) {
  return set->read_as >= 0 && is_shaped(set);
}

bool vxm_hdf5_open(vxm_hdf5_set *out, hid_t file, const char *name) {
  if (open_any(out, file, name) && fits(out))
    return true;
  vxm_hdf5_close(out);
  return false;
}

/* ---- All of them ---- */

static const char *describe_type(const vxm_hdf5_set *set) {
  static const char *const names[] = {
      [VXM_FLOAT64] = "float64", [VXM_FLOAT32] = "float32", [VXM_UINT8] = "uint8",   [VXM_INT8] = "int8",
      [VXM_UINT16] = "uint16",   [VXM_INT16] = "int16",     [VXM_UINT32] = "uint32", [VXM_INT32] = "int32",
      [VXM_UINT64] = "uint64",   [VXM_INT64] = "int64"};
  switch (set->type >= 0 ? H5Tget_class(set->type) : H5T_NO_CLASS) {
  case H5T_STRING:
    return "texts";
  case H5T_COMPOUND:
    return "records";
  case H5T_ENUM:
    return set->read_as >= 0 ? "bool" : "an enumeration";
  default:
    return set->read_as >= 0 ? names[set->scalar] : "another type";
  }
}

/** Adds "name (10 x 20 uint8)" to a list, or an ellipsis where it has no room. */
static void list_set(char *list, size_t room, const char *name, const vxm_hdf5_set *set) {
  char line[200], *end = line + snprintf(line, sizeof line, "%s%.80s (", *list ? ", " : "", name);
  for (int a = 0; a < set->rank && set->rank <= 4; a++)
    end += snprintf(end, 40, "%s%llu", a > 0 ? " x " : "", (unsigned long long)set->dims[a]);
  if (set->rank > 4)
    end += snprintf(end, 40, "%d dimensions", set->rank);
  snprintf(end, sizeof line - (size_t)(end - line), "%s%s)", set->rank > 0 ? " " : "", describe_type(set));
  size_t used = strlen(list);
  if (used + strlen(line) + sizeof ", ..." < room)
    memcpy(list + used, line, strlen(line) + 1);
  else if (used < sizeof "..." || strcmp(list + used - 3, "...") != 0)
    snprintf(list + used, room - used, ", ...");
}

static herr_t visit(hid_t file, const char *name, const object_info *info, void *payload) {
  vxm_hdf5_survey *survey = payload;
  vxm_hdf5_set set;
  if (info->type != H5O_TYPE_DATASET || !open_any(&set, file, name))
    return 0;
  survey->sets++;
  list_set(survey->all, sizeof survey->all, name, &set);
  if (fits(&set) && strlen(name) < sizeof survey->name) {
    bool is_own = strcmp(name, "voxels") == 0;
    if (survey->fitting++ == 0 || is_own)
      memcpy(survey->name, name, strlen(name) + 1);
    survey->has_own |= is_own;
    list_set(survey->fit, sizeof survey->fit, name, &set);
  }
  vxm_hdf5_close(&set);
  return 0;
}

bool vxm_hdf5_look(vxm_hdf5_survey *out, hid_t file) {
  *out = (vxm_hdf5_survey){.sets = 0};
  return H5Ovisit1(file, H5_INDEX_NAME, H5_ITER_INC, visit, out) >= 0;
}
