/* SPDX-License-Identifier: BSD-3-Clause */
/** The files of binvox that are no grids of voxmend: bytes, VTK's structured points, Minecraft and Gmsh. */
#include "cli/binvox.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "config.h"
#ifdef HAVE_ZLIB
#include <zlib.h>
#endif

/** A text that grows; `bytes` NULL after a lack of memory, or beyond what is let be. */
typedef struct buffer {
  unsigned char *bytes;
  size_t size, capacity;
  bool lacks;
} buffer;

static void put(buffer *out, const void *data, size_t size) {
  if (!out->lacks && size > out->capacity - out->size) {
    size_t room = 2 * (out->capacity + size) + 4096; /* of what is in memory already: it does not wrap */
    unsigned char *bytes = realloc(out->bytes, room);
    out->lacks = !bytes;
    if (bytes) {
      out->bytes = bytes;
      out->capacity = room;
    }
  }
  if (out->lacks)
    return;
  memcpy(out->bytes + out->size, data, size);
  out->size += size;
}

CLI_PRINTF(2, 3) static void print(buffer *out, const char *format, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, format);
  int length = vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  put(out, text, (size_t)length);
}

static vxm_status lack(cli_run *cli, const char *path) {
  cli->error.code = VXM_ERROR_MEMORY;
  snprintf(cli->error.text, sizeof cli->error.text, "%.300s: out of memory for the file", path);
  return VXM_ERROR_MEMORY;
}

static vxm_status write_buffer(cli_run *cli, buffer *out, const char *path) {
  vxm_status status =
      out->lacks ? lack(cli, path) : vxm_file_write(cli->context, path, out->bytes, out->size, &cli->error);
  free(out->bytes);
  return status;
}

/* ---- Bytes ---- */

static unsigned char value_at(const vxm_grid *grid, unsigned char value, const binvox_blocks *blocks,
                              const int64_t at[3]) {
  unsigned char own = blocks && blocks->ids ? binvox_block_at(blocks, vxm_grid_space(grid), at) : 0;
  return own ? own : value;
}

/** All voxels as a byte each, with the axes in this order, the slowest first. */
static void put_voxels(buffer *out, const vxm_grid *grid, const int order[3], unsigned char value,
                       const binvox_blocks *blocks) {
  const int64_t *dims = vxm_grid_space(grid)->dims;
  unsigned char *row = malloc((size_t)dims[order[2]]);
  out->lacks |= !row;
  int64_t at[3];
  for (at[order[0]] = 0; at[order[0]] < dims[order[0]] && !out->lacks; at[order[0]]++)
    for (at[order[1]] = 0; at[order[1]] < dims[order[1]] && !out->lacks; at[order[1]]++) {
      for (at[order[2]] = 0; at[order[2]] < dims[order[2]]; at[order[2]]++)
        row[at[order[2]]] = vxm_grid_get(grid, at[0], at[1], at[2]) ? value_at(grid, value, blocks, at) : 0;
      put(out, row, (size_t)dims[order[2]]);
    }
  free(row);
}

static vxm_status write_raw(cli_run *cli, const vxm_grid *grid, const char *path) {
  buffer out = {.lacks = false};
  put_voxels(&out, grid, (const int[3]){0, 2, 1}, 1, NULL);
  return write_buffer(cli, &out, path);
}

static vxm_status write_vtk(cli_run *cli, const vxm_grid *grid, const char *path) {
  const vxm_space *s = vxm_grid_space(grid);
  buffer out = {.lacks = false};
  print(&out, "# vtk DataFile Version 3.0\nvoxels by voxmend\nBINARY\nDATASET STRUCTURED_POINTS\n");
  print(&out, "DIMENSIONS %" PRId64 " %" PRId64 " %" PRId64 "\n", s->dims[0], s->dims[1], s->dims[2]);
  print(&out, "ORIGIN %.17g %.17g %.17g\n", s->origin[0] + s->voxel_size[0] / 2,
        s->origin[1] + s->voxel_size[1] / 2, s->origin[2] + s->voxel_size[2] / 2);
  print(&out, "SPACING %.17g %.17g %.17g\n", s->voxel_size[0], s->voxel_size[1], s->voxel_size[2]);
  print(&out, "POINT_DATA %" PRId64 "\nSCALARS voxels unsigned_char 1\nLOOKUP_TABLE default\n",
        s->dims[0] * s->dims[1] * s->dims[2]);
  put_voxels(&out, grid, (const int[3]){2, 1, 0}, 1, NULL);
  print(&out, "\n");
  return write_buffer(cli, &out, path);
}

/* ---- Minecraft ---- */

#ifdef HAVE_ZLIB
enum {
  TAG_SHORT = 2,
  TAG_BYTES = 7,
  TAG_STRING = 8,
  TAG_LIST = 9,
  TAG_COMPOUND = 10,
  SCHEMATIC_MOST = 32767
};

static void put_number(buffer *out, uint32_t value, int bytes) {
  for (int b = bytes - 1; b >= 0; b--) {
    unsigned char byte = (unsigned char)(value >> 8 * b);
    put(out, &byte, 1);
  }
}

static void put_name(buffer *out, int tag, const char *name) {
  put_number(out, (uint32_t)tag, 1);
  put_number(out, (uint32_t)strlen(name), 2);
  put(out, name, strlen(name));
}

static void put_short(buffer *out, const char *name, int64_t value) {
  put_name(out, TAG_SHORT, name);
  put_number(out, (uint32_t)value, 2);
}

/** As MCEdit's: y is up; blocks with x fastest, then z, then y. */
static void put_schematic(buffer *out, const vxm_grid *grid, unsigned char block,
                          const binvox_blocks *blocks) {
  static const char materials[] = "Alpha";
  const int64_t *dims = vxm_grid_space(grid)->dims;
  uint32_t count = (uint32_t)(dims[0] * dims[1] * dims[2]);
  put_name(out, TAG_COMPOUND, "Schematic");
  put_short(out, "Width", dims[0]);
  put_short(out, "Height", dims[1]);
  put_short(out, "Length", dims[2]);
  put_name(out, TAG_STRING, "Materials");
  put_number(out, sizeof materials - 1, 2);
  put(out, materials, sizeof materials - 1);
  put_name(out, TAG_BYTES, "Blocks");
  put_number(out, count, 4);
  put_voxels(out, grid, (const int[3]){1, 2, 0}, block, blocks);
  put_name(out, TAG_BYTES, "Data");
  put_number(out, count, 4);
  put_voxels(out, grid, (const int[3]){1, 2, 0}, 0, NULL);
  for (int list = 0; list < 2; list++) {
    put_name(out, TAG_LIST, list == 0 ? "Entities" : "TileEntities");
    put_number(out, TAG_COMPOUND, 1);
    put_number(out, 0, 4);
  }
  put_number(out, 0, 1);
}

/** The same bytes on every machine: no name and no time in the header. */
static void compress_into(buffer *out, const buffer *in) {
  z_stream stream = {.next_in = in->bytes};
  unsigned char part[1 << 16];
  size_t left = in->size;
  if (in->lacks || deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
    out->lacks = true;
    return;
  }
  int state = Z_OK;
  while (state == Z_OK && !out->lacks) {
    if (stream.avail_in == 0) {
      stream.avail_in = (uInt)(left < sizeof part ? left : sizeof part);
      left -= stream.avail_in;
    }
    stream.next_out = part;
    stream.avail_out = sizeof part;
    state = deflate(&stream, left > 0 ? Z_NO_FLUSH : Z_FINISH);
    put(out, part, sizeof part - stream.avail_out);
  }
  out->lacks |= state != Z_STREAM_END;
  deflateEnd(&stream);
}

static vxm_status write_schematic(cli_run *cli, const vxm_grid *grid, const char *path, int64_t block,
                                  const binvox_blocks *blocks) {
  const int64_t *dims = vxm_grid_space(grid)->dims;
  buffer plain = {.lacks = false}, packed = {.lacks = false};
  if (dims[0] > SCHEMATIC_MOST || dims[1] > SCHEMATIC_MOST || dims[2] > SCHEMATIC_MOST ||
      dims[0] * dims[1] * dims[2] > INT32_MAX) {
    cli->error.code = VXM_ERROR_RANGE;
    snprintf(cli->error.text, sizeof cli->error.text,
             "%.300s: a schematic holds up to 2^31 - 1 blocks; lower -d, or give -fit", path);
    return VXM_ERROR_RANGE;
  }
  put_schematic(&plain, grid, (unsigned char)block, blocks);
  compress_into(&packed, &plain);
  free(plain.bytes);
  return write_buffer(cli, &packed, path);
}
#else
static vxm_status write_schematic(cli_run *cli, const vxm_grid *grid, const char *path, int64_t block,
                                  const binvox_blocks *blocks) {
  (void)grid;
  (void)block;
  (void)blocks;
  cli->error.code = VXM_ERROR_UNAVAILABLE;
  snprintf(cli->error.text, sizeof cli->error.text,
           "%.300s: a schematic needs zlib, without which voxmend was built (Debian: zlib1g-dev)", path);
  return VXM_ERROR_UNAVAILABLE;
}
#endif

/* ---- Gmsh ---- */

/** Corners of voxel (0,0,0) in the order of Gmsh's hexahedra. */
static const int corners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                  {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

static bool is_used(const vxm_grid *grid, int64_t i, int64_t j, int64_t k) {
  for (int c = 0; c < 8; c++)
    if (vxm_grid_get(grid, i - corners[c][0], j - corners[c][1], k - corners[c][2]))
      return true;
  return false;
}

/** Numbers the corners of voxels from 1 on, and returns how many there are. */
static int64_t number_nodes(int64_t *numbers, const vxm_grid *grid) {
  const int64_t *dims = vxm_grid_space(grid)->dims;
  int64_t count = 0, at = 0;
  for (int64_t k = 0; k <= dims[2]; k++)
    for (int64_t j = 0; j <= dims[1]; j++)
      for (int64_t i = 0; i <= dims[0]; i++, at++)
        numbers[at] = is_used(grid, i, j, k) ? ++count : 0;
  return count;
}

static void put_nodes(buffer *out, const int64_t *numbers, const vxm_space *s) {
  int64_t at = 0;
  for (int64_t k = 0; k <= s->dims[2]; k++)
    for (int64_t j = 0; j <= s->dims[1]; j++)
      for (int64_t i = 0; i <= s->dims[0]; i++, at++)
        if (numbers[at] > 0)
          print(out, "%" PRId64 " %.9g %.9g %.9g\n", numbers[at], s->origin[0] + (double)i * s->voxel_size[0],
                s->origin[1] + (double)j * s->voxel_size[1], s->origin[2] + (double)k * s->voxel_size[2]);
}

static void put_hexahedra(buffer *out, const int64_t *numbers, const vxm_grid *grid) {
  const int64_t *dims = vxm_grid_space(grid)->dims;
  int64_t element = 0;
  for (int64_t k = 0; k < dims[2]; k++)
    for (int64_t j = 0; j < dims[1]; j++)
      for (int64_t i = 0; i < dims[0]; i++) {
        if (!vxm_grid_get(grid, i, j, k))
          continue;
        print(out, "%" PRId64 " 5 2 1 1", ++element);
        for (int c = 0; c < 8; c++)
          print(out, " %" PRId64,
                numbers[((k + corners[c][2]) * (dims[1] + 1) + j + corners[c][1]) * (dims[0] + 1) + i +
                        corners[c][0]]);
        print(out, "\n");
      }
}

static vxm_status write_msh(cli_run *cli, const vxm_grid *grid, const char *path) {
  const int64_t *dims = vxm_grid_space(grid)->dims;
  size_t nodes = (size_t)(dims[0] + 1) * (size_t)(dims[1] + 1) * (size_t)(dims[2] + 1);
  int64_t *numbers = calloc(nodes, sizeof *numbers);
  if (!numbers)
    return lack(cli, path);
  buffer out = {.lacks = false};
  print(&out, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%" PRId64 "\n", number_nodes(numbers, grid));
  put_nodes(&out, numbers, vxm_grid_space(grid));
  print(&out, "$EndNodes\n$Elements\n%" PRId64 "\n", vxm_grid_count(grid));
  put_hexahedra(&out, numbers, grid);
  print(&out, "$EndElements\n");
  free(numbers);
  return write_buffer(cli, &out, path);
}

/* ---- Grids of voxmend ---- */

static vxm_status write_grid(cli_run *cli, const vxm_grid *grid, const char *path, const char *format) {
  vxm_grid_write_options options = VXM_GRID_WRITE_OPTIONS_INIT;
  options.format = format;
  return vxm_grid_write(grid, path, &options, &cli->error);
}

vxm_status binvox_write(cli_run *cli, const binvox_request *given, const vxm_grid *grid,
                        const binvox_blocks *blocks, const char *path) {
  switch (given->type) {
  case BINVOX_RAW:
    return write_raw(cli, grid, path);
  case BINVOX_VTK:
    return write_vtk(cli, grid, path);
  case BINVOX_SCHEMATIC:
    return write_schematic(cli, grid, path, given->block, blocks);
  case BINVOX_MSH:
    return write_msh(cli, grid, path);
  default:
    return write_grid(cli, grid, path, binvox_types[given->type]);
  }
}
