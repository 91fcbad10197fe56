/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * .glb, glTF 2.0 in one file: the surface of voxels, a mesh for each label, colours at the vertices. Vertices
 * lie on the lattice, which 32-bit floats hold exactly; the root node has the place, the size of voxels, and
 * turns the axis that points up to y. Only written: as a mesh any reader of glTF has it.
 */
#include "base/endian.h"
#include "gridio/common/format.h"
#include "gridio/common/json_text.h"
#include "gridio/common/label_color.h"
#include "gridio/common/y_up.h"
#include "gridio/mesh/colored_quads.h"
#include "mesh/appearance.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
  VERTEX = 12, /**< bytes of three floats */
  COLOR = 8,   /**< of four numbers of 16 bits */
  INDEX = 4,
  CORNERS = 4, /**< of a rectangle */
  INDICES = 6,
  FLOAT_TYPE = 5126, /* glTF's names of types and uses */
  SHORT_TYPE = 5123,
  INT_TYPE = 5125,
  ARRAY_USE = 34962,
  INDEX_USE = 34963
};

/** Rectangles of one material. */
typedef struct part {
  size_t begin, end;
  uint32_t key;
} part;

typedef struct scene {
  const vxm_field *field;
  vxm_colored_quads quads;
  part *parts;
  size_t part_count, capacity;
  bool has_colors, has_labels;
  bool starved;                             /**< a part of the text found no memory */
  uint64_t normals, colors, indices, bytes; /**< where these begin in the binary chunk, and its size */
} scene;

/* ---- What there is ---- */

static vxm_status find_parts(scene *s, vxm_error *error) {
  const vxm_colored_quads *quads = &s->quads;
  vxm_status status = VXM_OK;
  for (size_t q = 0; q < quads->count && status == VXM_OK; q++) {
    bool is_new = q == 0 || (s->has_labels && quads->items[q].key != quads->items[q - 1].key);
    if (is_new) {
      status = vxm_grow(quads->context, (void **)&s->parts, &s->capacity, s->part_count + 1, sizeof *s->parts,
                        error);
      if (status == VXM_OK)
        s->parts[s->part_count++] = (part){q, q, quads->items[q].key};
    }
    if (status == VXM_OK)
      s->parts[s->part_count - 1].end = q + 1;
  }
  return status;
}

static vxm_status lay_out(scene *s, vxm_error *error) {
  uint64_t vertices = CORNERS * (uint64_t)s->quads.count;
  s->normals = VERTEX * vertices;
  s->colors = 2 * s->normals;
  s->indices = s->colors + (s->has_colors ? COLOR * vertices : 0);
  s->bytes = s->indices + (uint64_t)INDEX * INDICES * s->quads.count;
  /* less than 2^32 with the text, of which labels have the most */
  if (s->bytes > UINT32_MAX - (UINT64_C(1) << 29))
    return vxm_fail(
        error, VXM_ERROR_RANGE,
        ".glb holds less than 2^32 bytes, and this surface has %zu rectangles; lower the resolution",
        s->quads.count);
  return VXM_OK;
}

/** Lattice coordinates of the corners of a rectangle, running around to the left as seen from outside. */
static void corners_of(uint32_t out[CORNERS][3], const vxm_colored_quad *q) {
  unsigned axis = q->axis, u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  /* x cross z is -y, the other two products point forward */
  bool forward = (q->level % 2 == 1) != (axis == 1);
  const uint32_t us[CORNERS] = {q->u0, q->u1, q->u1, q->u0}, vs[CORNERS] = {q->v0, q->v0, q->v1, q->v1};
  for (int c = 0; c < CORNERS; c++) {
    int from = forward ? c : CORNERS - 1 - c;
    out[c][axis] = q->level / 2;
    out[c][u] = us[from];
    out[c][v] = vs[from];
  }
}

/* ---- The binary chunk ---- */

static void put_floats(vxm_output *output, const float values[3]) {
  unsigned char bytes[VERTEX];
  for (int a = 0; a < 3; a++)
    vxm_store_f32(bytes + 4 * a, values[a], vxm_must_swap(false));
  vxm_output_write(output, bytes, sizeof bytes);
}

static void put_positions(vxm_output *output, const vxm_colored_quads *quads) {
  for (size_t q = 0; q < quads->count; q++) {
    uint32_t corners[CORNERS][3];
    corners_of(corners, &quads->items[q]);
    for (int c = 0; c < CORNERS; c++)
      put_floats(output, (const float[3]){(float)corners[c][0], (float)corners[c][1], (float)corners[c][2]});
  }
}

static void put_normals(vxm_output *output, const vxm_colored_quads *quads) {
  for (size_t q = 0; q < quads->count; q++) {
    float normal[3] = {0, 0, 0};
    normal[quads->items[q].axis] = quads->items[q].level % 2 ? 1 : -1;
    for (int c = 0; c < CORNERS; c++)
      put_floats(output, normal);
  }
}

/** glTF's colours at vertices are linear light, for which 8 bits would be too coarse in the dark. */
static void put_colors(vxm_output *output, const vxm_colored_quads *quads) {
  uint16_t light[256];
  for (int v = 0; v < 256; v++)
    light[v] = (uint16_t)(65535 * vxm_srgb_decode(v / 255.0) + 0.5);
  for (size_t q = 0; q < quads->count; q++) {
    uint32_t key = quads->items[q].key;
    unsigned char bytes[COLOR] = {0, 0, 0, 0, 0, 0, 255, 255};
    for (int c = 0; c < 3; c++) {
      uint16_t value = light[key >> (16 - 8 * c) & 255];
      bytes[2 * c] = (unsigned char)value;
      bytes[2 * c + 1] = (unsigned char)(value >> 8);
    }
    for (int c = 0; c < CORNERS; c++)
      vxm_output_write(output, bytes, sizeof bytes);
  }
}

/** Numbers of vertices begin anew with each part. */
static void put_indices(vxm_output *output, const scene *s) {
  static const uint32_t order[INDICES] = {0, 1, 2, 0, 2, 3};
  for (size_t p = 0; p < s->part_count; p++)
    for (size_t q = 0; q < s->parts[p].end - s->parts[p].begin; q++)
      for (int i = 0; i < INDICES; i++) {
        unsigned char bytes[INDEX];
        vxm_store_le32(bytes, CORNERS * (uint32_t)q + order[i]);
        vxm_output_write(output, bytes, sizeof bytes);
      }
}

/* ---- The text ---- */

/* jansson goes on without what found no memory: it is noted. */
static void append(scene *s, json_t *list, json_t *value) {
  s->starved |= json_array_append_new(list, value) != 0;
}

static void set(scene *s, json_t *object, const char *name, json_t *value) {
  s->starved |= json_object_set_new(object, name, value) != 0;
}

static json_t *view(uint64_t offset, uint64_t bytes, int use) {
  return json_pack("{s:i, s:I, s:I, s:i}", "buffer", 0, "byteOffset", (json_int_t)offset, "byteLength",
                   (json_int_t)bytes, "target", use);
}

static json_t *list_views(scene *s) {
  json_t *list = json_array();
  append(s, list, view(0, s->normals, ARRAY_USE));
  append(s, list, view(s->normals, s->normals, ARRAY_USE));
  append(s, list, view(s->indices, s->bytes - s->indices, INDEX_USE));
  if (s->has_colors)
    append(s, list, view(s->colors, s->indices - s->colors, ARRAY_USE));
  return list;
}

static json_t *accessor(int of, uint64_t offset, uint64_t count, int number, const char *type) {
  return json_pack("{s:i, s:I, s:I, s:i, s:s}", "bufferView", of, "byteOffset", (json_int_t)offset, "count",
                   (json_int_t)count, "componentType", number, "type", type);
}

/** The box of a part, which readers need before they have its vertices. */
static void add_box(json_t *positions, scene *s, const part *p) {
  uint32_t low[3] = {UINT32_MAX, UINT32_MAX, UINT32_MAX}, high[3] = {0, 0, 0}, corners[CORNERS][3];
  for (size_t q = p->begin; q < p->end; q++) {
    corners_of(corners, &s->quads.items[q]);
    for (int i = 0; i < CORNERS * 3; i++) {
      uint32_t value = corners[i / 3][i % 3];
      low[i % 3] = value < low[i % 3] ? value : low[i % 3];
      high[i % 3] = value > high[i % 3] ? value : high[i % 3];
    }
  }
  set(s, positions, "min", json_pack("[f,f,f]", (double)low[0], (double)low[1], (double)low[2]));
  set(s, positions, "max", json_pack("[f,f,f]", (double)high[0], (double)high[1], (double)high[2]));
}

/** Three accessors of a part, or four. */
static void add_accessors(json_t *list, scene *s, const part *p) {
  uint64_t first = CORNERS * (uint64_t)p->begin, vertices = CORNERS * (uint64_t)(p->end - p->begin);
  json_t *positions = accessor(0, VERTEX * first, vertices, FLOAT_TYPE, "VEC3");
  add_box(positions, s, p);
  append(s, list, positions);
  append(s, list, accessor(1, VERTEX * first, vertices, FLOAT_TYPE, "VEC3"));
  append(s, list,
         accessor(2, (uint64_t)INDEX * INDICES * p->begin, vertices / CORNERS * INDICES, INT_TYPE, "SCALAR"));
  if (!s->has_colors)
    return;
  json_t *colors = accessor(3, COLOR * first, vertices, SHORT_TYPE, "VEC4");
  set(s, colors, "normalized", json_true());
  append(s, list, colors);
}

static json_t *name_of(scene *s, const part *p) {
  const vxm_label_table *table = &s->field->about.table;
  char text[32];
  if (!s->has_labels)
    return json_string("voxels");
  if (p->key <= table->count)
    return vxm_json_name(vxm_label_table_name(table, p->key));
  snprintf(text, sizeof text, "label %" PRIu32, p->key);
  return json_string(text);
}

static json_t *material(scene *s, const part *p) {
  static const double grey = 0.6;
  double rgb[3] = {grey, grey, grey};
  if (s->has_labels)
    vxm_label_color(rgb, p->key);
  for (int c = 0; c < 3; c++)
    rgb[c] = s->has_colors ? 1 : vxm_srgb_decode(rgb[c]);
  return json_pack("{s:o, s:{s:[f,f,f,f], s:f, s:f}}", "name", name_of(s, p), "pbrMetallicRoughness",
                   "baseColorFactor", rgb[0], rgb[1], rgb[2], 1.0, "metallicFactor", 0.0, "roughnessFactor",
                   1.0);
}

static json_t *mesh(scene *s, size_t index) {
  int each = s->has_colors ? 4 : 3, first = each * (int)index;
  json_t *attributes = json_pack("{s:i, s:i}", "POSITION", first, "NORMAL", first + 1);
  if (s->has_colors)
    set(s, attributes, "COLOR_0", json_integer(first + 3));
  return json_pack("{s:o, s:[{s:o, s:i, s:i}]}", "name", name_of(s, &s->parts[index]), "primitives",
                   "attributes", attributes, "indices", first + 2, "material", (int)index);
}

/** From the lattice to where y points up, column after column. */
static json_t *matrix_of(scene *s) {
  const vxm_field *field = s->field;
  const vxm_space *space = &field->space;
  vxm_y_up axes = vxm_y_up_of(field->style.up);
  double m[16] = {[15] = 1};
  for (int a = 0; a < 3; a++) {
    double sign = axes.back[a] ? -1 : 1;
    m[4 * axes.of[a] + a] = sign * space->voxel_size[axes.of[a]];
    m[12 + a] = sign * space->origin[axes.of[a]];
  }
  json_t *list = json_array();
  for (int i = 0; i < 16; i++)
    append(s, list, json_real(m[i]));
  return list;
}

/** The root, and a child for each part. */
static json_t *list_nodes(scene *s) {
  json_t *list = json_array(), *children = json_array();
  for (size_t p = 0; p < s->part_count; p++)
    append(s, children, json_integer((json_int_t)p + 1));
  append(s, list,
         json_pack("{s:s, s:o, s:o}", "name", "voxmend", "matrix", matrix_of(s), "children", children));
  for (size_t p = 0; p < s->part_count; p++)
    append(s, list, json_pack("{s:o, s:i}", "name", name_of(s, &s->parts[p]), "mesh", (int)p));
  return list;
}

static void add_content(json_t *root, scene *s) {
  json_t *accessors = json_array(), *meshes = json_array(), *materials = json_array();
  for (size_t p = 0; p < s->part_count; p++) {
    add_accessors(accessors, s, &s->parts[p]);
    append(s, meshes, mesh(s, p));
    append(s, materials, material(s, &s->parts[p]));
  }
  set(s, root, "nodes", list_nodes(s));
  set(s, root, "meshes", meshes);
  set(s, root, "materials", materials);
  set(s, root, "accessors", accessors);
  set(s, root, "bufferViews", list_views(s));
  set(s, root, "buffers", json_pack("[{s:I}]", "byteLength", (json_int_t)s->bytes));
}

/** The whole text, to be freed; NULL without memory. Nothing set is a scene without nodes. */
static char *describe(scene *s) {
  bool is_empty = s->part_count == 0;
  json_t *root =
      json_pack("{s:{s:s, s:s}, s:i}", "asset", "version", "2.0", "generator", "voxmend", "scene", 0);
  set(s, root, "scenes",
      is_empty ? json_pack("[{s:s}]", "name", "voxels") : json_pack("[{s:[i]}]", "nodes", 0));
  if (!is_empty)
    add_content(root, s);
  char *text = root && !s->starved ? vxm_json_text(root, JSON_COMPACT) : NULL;
  json_decref(root);
  return text;
}

/* ---- The file ---- */

static void put_word(vxm_output *output, uint64_t value) {
  unsigned char bytes[4];
  vxm_store_le32(bytes, (uint32_t)value);
  vxm_output_write(output, bytes, sizeof bytes);
}

static vxm_status put_chunks(vxm_output *output, const scene *s, const char *text, vxm_error *error) {
  static const char spaces[] = "   ";
  uint64_t length = strlen(text), padding = (4 - length % 4) % 4;
  uint64_t all = 12 + 8 + length + padding + (s->bytes > 0 ? 8 + s->bytes : 0);
  if (all > UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, ".glb holds less than 2^32 bytes; lower the resolution");
  vxm_status status = vxm_output_expect(output, all, error);
  if (status != VXM_OK)
    return status;
  vxm_output_write(output, "glTF", 4);
  put_word(output, 2);
  put_word(output, all);
  put_word(output, length + padding);
  vxm_output_write(output, "JSON", 4);
  vxm_output_write(output, text, (size_t)length);
  vxm_output_write(output, spaces, (size_t)padding);
  if (s->bytes == 0)
    return VXM_OK;
  put_word(output, s->bytes);
  vxm_output_write(output, "BIN\0", 4);
  put_positions(output, &s->quads);
  put_normals(output, &s->quads);
  if (s->has_colors)
    put_colors(output, &s->quads);
  put_indices(output, s);
  return vxm_progress(s->field->context, "writing", 1, error);
}

static vxm_status put_scene(vxm_output *output, scene *s, vxm_error *error) {
  vxm_status status = find_parts(s, error);
  if (status == VXM_OK)
    status = lay_out(s, error);
  if (status != VXM_OK)
    return status;
  char *text = describe(s);
  if (!text)
    return vxm_fail(error, VXM_ERROR_MEMORY, "out of memory for the text of the .glb");
  status = put_chunks(output, s, text, error);
  free(text);
  return status;
}

static vxm_status write_glb(vxm_output *output, const vxm_field *field, vxm_error *error) {
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  vxm_error local = VXM_ERROR_INIT;
  scene s = {.field = field, .has_colors = field->channels == 4};
  vxm_status status = vxm_field_measure(&range, field, &local);
  s.has_labels = !s.has_colors && (field->about.kind == VXM_FIELD_LABELS || range.max > 1);
  if (status == VXM_OK)
    status = vxm_colored_quads_make(&s.quads, field, &local);
  if (status == VXM_OK) {
    status = put_scene(output, &s, &local);
    vxm_colored_quads_destroy(&s.quads);
  }
  vxm_free(field->context, s.parts);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status check_field(const vxm_field *field, const char *path, vxm_error *error) {
  return vxm_field_check_labels(field, path, UINT16_MAX,
                                "has numbers that are no labels from 0 to 65535; choose a threshold", error);
}

static vxm_status write_field(const vxm_field *field, const char *path, vxm_error *error) {
  return vxm_field_write_file(field, path, write_glb, error);
}

const vxm_grid_format vxm_format_glb = {
    .name = "glb",
    .holds = VXM_HOLDS_BITS | VXM_HOLDS_LABELS | VXM_HOLDS_COLORS,
    .is_mesh = true,
    .check_field = check_field,
    .write_field = write_field,
};
