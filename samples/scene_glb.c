/* SPDX-License-Identifier: BSD-3-Clause */
/** The stool as binary glTF 2.0 (Khronos specification, "GLB File Format Specification"). */
#include "scenes.h"

#include "shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Little-endian whatever the machine. */

static void put_u16(FILE *file, unsigned value) {
  fputc((int)(value & 0xff), file);
  fputc((int)(value >> 8 & 0xff), file);
}

static void put_u32(FILE *file, uint32_t value) {
  put_u16(file, value & 0xffff);
  put_u16(file, value >> 16);
}

static void put_f32(FILE *file, double value) {
  float narrow = (float)value;
  uint32_t bits;
  memcpy(&bits, &narrow, sizeof bits);
  put_u32(file, bits);
}

/** Bytes of a shape's positions, and of all that is written for it: triangles, indices of 16 bits, padded. */
static size_t position_bytes(const shape *s) {
  return s->vertex_count * 12;
}

static size_t index_bytes(const shape *s) {
  return s->face_count * 6;
}

static size_t all_bytes(const shape *s) {
  return (position_bytes(s) + index_bytes(s) + 3) / 4 * 4;
}

static void write_binary(FILE *file, const shape *s) {
  for (size_t c = 0; c < 3 * s->vertex_count; c++)
    put_f32(file, s->positions[c]);
  for (size_t c = 0; c < 3 * s->face_count; c++)
    put_u16(file, (unsigned)s->indices[c]);
  for (size_t c = position_bytes(s) + index_bytes(s); c < all_bytes(s); c++)
    fputc(0, file);
}

static void write_view(FILE *file, size_t offset, size_t bytes, int target) {
  fprintf(file, "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,\"target\":%d}", offset, bytes, target);
}

static void write_accessors(FILE *file, const shape *s, int view) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t c = 0; c < 3 * s->vertex_count; c++) {
    low[c % 3] = fmin(low[c % 3], s->positions[c]);
    high[c % 3] = fmax(high[c % 3], s->positions[c]);
  }
  fprintf(
      file,
      "{\"bufferView\":%d,\"componentType\":5126,\"count\":%zu,\"type\":\"VEC3\",\"min\":[%.9g,%.9g,%.9g],"
      "\"max\":[%.9g,%.9g,%.9g]},{\"bufferView\":%d,\"componentType\":5123,\"count\":%zu,\"type\":"
      "\"SCALAR\"}",
      view, s->vertex_count, low[0], low[1], low[2], high[0], high[1], high[2], view + 1, 3 * s->face_count);
}

/** Turns are by right angles, so that every coordinate is exact. */
static void write_nodes(FILE *file) {
  double x = STOOL_WIDTH / 2e3 - 0.05, y = STOOL_DEPTH / 2e3 - 0.05;
  fprintf(file,
          "\"nodes\":[{\"name\":\"stool\",\"matrix\":[1,0,0,0,0,0,-1,0,0,1,0,0,0,0,0,1],\"children\":[1,2,3,"
          "4,5]},"
          "{\"name\":\"seat\",\"mesh\":0,\"translation\":[0,0,%.9g]},"
          "{\"name\":\"leg\",\"mesh\":1,\"translation\":[%.9g,%.9g,0]},"
          "{\"name\":\"leg\",\"mesh\":1,\"translation\":[%.9g,%.9g,0],\"scale\":[-1,1,1]},"
          "{\"name\":\"leg\",\"mesh\":1,\"translation\":[%.9g,%.9g,0],\"rotation\":[0,0,1,0]},"
          "{\"name\":\"leg\",\"mesh\":1,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,%.9g,%.9g,0,1]}],",
          STOOL_LEG / 1e3, x, y, -x, y, -x, -y, x, -y);
}

static void write_json(FILE *file, const shape *seat, const shape *leg) {
  size_t second = all_bytes(seat);
  fprintf(file, "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],");
  write_nodes(file);
  fprintf(file,
          "\"meshes\":[{\"name\":\"block\",\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,"
          "\"material\":0}]},{\"name\":\"rod\",\"primitives\":[{\"attributes\":{\"POSITION\":2},"
          "\"indices\":3,\"material\":1}]}],\"materials\":[{\"name\":\"oak\"},{\"name\":\"steel\"}],");
  fprintf(file, "\"accessors\":[");
  write_accessors(file, seat, 0);
  fputc(',', file);
  write_accessors(file, leg, 2);
  fprintf(file, "],\"bufferViews\":[");
  enum { VERTICES = 34962, INDICES = 34963 };
  write_view(file, 0, position_bytes(seat), VERTICES);
  fputc(',', file);
  write_view(file, position_bytes(seat), index_bytes(seat), INDICES);
  fputc(',', file);
  write_view(file, second, position_bytes(leg), VERTICES);
  fputc(',', file);
  write_view(file, second + position_bytes(leg), index_bytes(leg), INDICES);
  fprintf(file, "],\"buffers\":[{\"byteLength\":%zu}]}", second + all_bytes(leg));
}

static shape make_seat(void) {
  double x = STOOL_WIDTH / 2e3, y = STOOL_DEPTH / 2e3;
  shape seat = shape_box(-x, -y, 0, x, y, STOOL_SEAT / 1e3);
  shape_split_triangles(&seat);
  return seat;
}

static shape make_leg(void) {
  double corners[2 * STOOL_CORNERS];
  for (int i = 0; i < STOOL_CORNERS; i++) {
    double angle = 2 * 3.14159265358979323846 * i / STOOL_CORNERS;
    corners[2 * i] = STOOL_RADIUS / 1e3 * cos(angle);
    corners[2 * i + 1] = STOOL_RADIUS / 1e3 * sin(angle);
  }
  shape leg = shape_prism(STOOL_CORNERS, corners, 0, STOOL_LEG / 1e3);
  shape_split_triangles(&leg);
  return leg;
}

bool scene_write_glb(FILE *file) {
  enum { HEADER = 12, CHUNK = 8, JSON = 0x4e4f534a, BIN = 0x004e4942, MAGIC = 0x46546c67, VERSION = 2 };
  shape seat = make_seat(), leg = make_leg();
  char *json = NULL;
  size_t size = 0;
  FILE *text = open_memstream(&json, &size);
  if (text) {
    write_json(text, &seat, &leg);
    while (ftell(text) % 4 != 0)
      fputc(' ', text);
    fclose(text);
    size_t binary = all_bytes(&seat) + all_bytes(&leg);
    put_u32(file, MAGIC);
    put_u32(file, VERSION);
    put_u32(file, (uint32_t)(HEADER + CHUNK + size + CHUNK + binary));
    put_u32(file, (uint32_t)size);
    put_u32(file, JSON);
    fwrite(json, 1, size, file);
    put_u32(file, (uint32_t)binary);
    put_u32(file, BIN);
    write_binary(file, &seat);
    write_binary(file, &leg);
  }
  free(json);
  shape_free(&seat);
  shape_free(&leg);
  return text != NULL && !ferror(file);
}
