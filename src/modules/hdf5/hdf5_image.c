/* SPDX-License-Identifier: BSD-3-Clause */
/** A driver by which HDF5 reads a file that is in memory. HDF5's own for that (core) also looks for the file
 * on the disk. */
#include "config.h"

#include "modules/hdf5/hdf5.h"

#include <string.h>

/** The one file of the process. */
static struct {
  const unsigned char *data;
  size_t size;
} image;

/** A file as HDF5 has it, whose part comes first. */
typedef struct opened {
  H5FD_t base;
  haddr_t end; /**< of what HDF5 takes for allocated */
} opened;

static opened the_file;

static H5FD_t *open_image(const char *name, unsigned flags, hid_t access, haddr_t most) {
  (void)name, (void)access, (void)most;
  if (flags & H5F_ACC_RDWR)
    return NULL;
  the_file = (opened){.end = 0};
  return &the_file.base;
}

static herr_t close_image(H5FD_t *file) {
  (void)file;
  return 0;
}

static herr_t query(const H5FD_t *file, unsigned long *flags) {
  (void)file;
  *flags = H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_METADATA;
  return 0;
}

static haddr_t get_eoa(const H5FD_t *file, H5FD_mem_t type) {
  (void)type;
  return ((const opened *)(const void *)file)->end;
}

static herr_t set_eoa(H5FD_t *file, H5FD_mem_t type, haddr_t end) {
  (void)type;
  ((opened *)(void *)file)->end = end;
  return 0;
}

static haddr_t get_eof(const H5FD_t *file, H5FD_mem_t type) {
  (void)file, (void)type;
  return image.size;
}

static herr_t read_image(H5FD_t *file, H5FD_mem_t type, hid_t how, haddr_t at, size_t size, void *to) {
  (void)file, (void)type, (void)how;
  if (at > image.size || size > image.size - at)
    return -1;
  memcpy(to, image.data + at, size);
  return 0;
}

static herr_t write_image(H5FD_t *file, H5FD_mem_t type, hid_t how, haddr_t at, size_t size,
                          const void *from) {
  (void)file, (void)type, (void)how, (void)at, (void)size, (void)from;
  return -1;
}

static const H5FD_class_t driver = {
#if H5_VERSION_GE(1, 14, 0)
    .version = H5FD_CLASS_VERSION,
    .value = (H5FD_class_value_t)600,
#endif
    .name = "voxmend",
    .maxaddr = INT64_MAX,
    .fc_degree = H5F_CLOSE_WEAK,
    .open = open_image,
    .close = close_image,
    .query = query,
    .get_eoa = get_eoa,
    .set_eoa = set_eoa,
    .get_eof = get_eof,
    .read = read_image,
    .write = write_image,
    .fl_map = H5FD_FLMAP_DICHOTOMY,
};

hid_t vxm_hdf5_open_image(const unsigned char *data, size_t size) {
  image.data = data;
  image.size = size;
  hid_t access = H5Pcreate(H5P_FILE_ACCESS), kind = H5FDregister(&driver);
  hid_t file = kind >= 0 && H5Pset_driver(access, kind, NULL) >= 0
                   ? H5Fopen("/voxels", H5F_ACC_RDONLY, access)
                   : H5I_INVALID_HID;
  H5Pclose(access);
  return file;
}
