/* SPDX-License-Identifier: BSD-3-Clause */
/** Any bytes as what a reading process sends back: it may have been taken over by the file that it read. */
#include "fuzz.h"
#include "fuzz_soup.h"

#include "sandbox/wire_format.h"

#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { MOST = 1 << 16 };

/** Bytes that the soup may take for each that is sent: none is believed before it has come. */
enum { RATE = 64, BESIDES = 1 << 20 };

/** Files are not to be had. */
static vxm_status refuse(void *payload, vxm_process *reader, const char *name, vxm_error *error) {
  (void)payload;
  (void)reader;
  (void)error;
  fuzz_require(strlen(name) <= VXM_WIRE_NAME_MAX, "a name has its length");
  return VXM_OK;
}

/** A sender that has sent these bytes, and has gone. */
static vxm_process sender_of(vxm_context *context, const uint8_t *data, size_t size) {
  int ends[2];
  fuzz_require(socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0, "there are sockets");
  fuzz_require(send(ends[1], data, size, MSG_DONTWAIT) == (ssize_t)size || size == 0,
               "a socket holds the bytes");
  close(ends[1]);
  return (vxm_process){.channel = ends[0], .context = context, .phase = "reading"};
}

/* ---- A soup ---- */

static void receive_soup(const uint8_t *data, size_t size) {
  vxm_context *context = fuzz_context(size, RATE, BESIDES);
  vxm_process sender = sender_of(context, data, size);
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  fuzz_require(vxm_soup_create(&soup, context, "", &error) == VXM_OK, "a soup can be made");
  vxm_wire_listener listener = {.soup = soup, .answer = refuse};
  vxm_status status = vxm_wire_receive(&sender, &listener, &error);
  if (status == VXM_OK)
    fuzz_check_soup(soup);
  else if (status != VXM_ERROR_IO) /* then the caller knows what became of the process */
    fuzz_check_error(&error, status);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
  close(sender.channel);
}

/* ---- A grid ---- */

/** What has come so far; sums of it make a sanitizer look at all of it. */
typedef struct arrival {
  bool has_grid, has_extent, has_array;
  uint64_t seen;
} arrival;

static vxm_status see_text(void *payload, const char *key, size_t key_size, const char *value,
                           size_t value_size, vxm_error *error) {
  (void)error;
  arrival *a = payload;
  fuzz_require(!a->has_grid, "texts come first");
  for (size_t i = 0; i < key_size; i++)
    a->seen += (unsigned char)key[i];
  for (size_t i = 0; i < value_size; i++)
    a->seen += (unsigned char)value[i];
  return VXM_OK;
}

static vxm_status see_grid(void *payload, const vxm_sink_grid *grid, vxm_error *error) {
  (void)error;
  arrival *a = payload;
  fuzz_require(!a->has_grid && memchr(grid->name, 0, sizeof grid->name) && !strchr(grid->name, '\n'),
               "one grid comes, whose name is a line");
  a->has_grid = true;
  return VXM_OK;
}

static vxm_status see_extent(void *payload, const vxm_sink_extent *extent, vxm_error *error) {
  (void)error;
  arrival *a = payload;
  fuzz_require(a->has_grid && !a->has_extent, "one extent comes, after the grid");
  for (int axis = 0; axis < 3; axis++)
    fuzz_require(extent->low[axis] <= extent->high[axis] && extent->low[axis] >= INT32_MIN &&
                     extent->high[axis] <= INT32_MAX,
                 "an extent has a size");
  a->has_extent = true;
  return VXM_OK;
}

static void see_bits(void *payload, const int64_t at[3], const uint64_t bits[VXM_SINK_SIDE]) {
  (void)at;
  arrival *a = payload;
  fuzz_require(a->has_extent, "voxels come last");
  for (int i = 0; i < VXM_SINK_SIDE; i++)
    a->seen += bits[i];
}

static void see_numbers(void *payload, const int64_t at[3], const float numbers[VXM_SINK_VOXELS]) {
  (void)at;
  arrival *a = payload;
  fuzz_require(a->has_extent, "voxels come last");
  for (int i = 0; i < VXM_SINK_VOXELS; i++)
    a->seen += numbers[i] > 0;
}

static void see_cube(void *payload, const int64_t at[3], int64_t side, float number) {
  (void)at;
  (void)number;
  arrival *a = payload;
  fuzz_require(a->has_extent && side > 0 && side <= VXM_SINK_CUBE_MAX, "cubes have a size");
}

static vxm_status see_array(void *payload, const vxm_sink_array *array, vxm_error *error) {
  (void)error;
  arrival *a = payload;
  fuzz_require(!a->has_grid && array->is_color <= 1 && array->scalar <= VXM_INT64, "one array comes");
  for (int axis = 0; axis < 3; axis++)
    fuzz_require(array->shape[axis] >= 1 && array->shape[axis] <= INT32_MAX, "an array has a size");
  a->has_grid = a->has_array = true;
  return VXM_OK;
}

static vxm_status see_values(void *payload, const void *values, size_t size, vxm_error *error) {
  (void)error;
  arrival *a = payload;
  fuzz_require(a->has_array, "values come after their array");
  for (size_t b = 0; b < size; b++)
    a->seen += ((const unsigned char *)values)[b];
  return VXM_OK;
}

static void receive_grid(const uint8_t *data, size_t size) {
  vxm_context *context = fuzz_context(size, RATE, BESIDES);
  vxm_process sender = sender_of(context, data, size);
  arrival came = {.has_grid = false};
  vxm_voxel_sink sink = {see_text, see_grid, see_extent, see_bits,   see_numbers,
                         see_cube, &came,    see_array,  see_values, false};
  vxm_wire_listener listener = {.sink = &sink};
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = vxm_wire_receive(&sender, &listener, &error);
  if (status == VXM_OK)
    fuzz_require(came.has_extent != came.has_array, "a whole grid comes");
  else if (status != VXM_ERROR_IO)
    fuzz_check_error(&error, status);
  vxm_context_destroy(context);
  close(sender.channel);
}

void fuzz_wire(const char *name, const uint8_t *data, size_t size) {
  (void)name;
  if (size > MOST) /* more than a socket holds without a reader */
    return;
  receive_soup(data, size);
  receive_grid(data, size);
}
