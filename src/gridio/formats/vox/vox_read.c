/* SPDX-License-Identifier: BSD-3-Clause */
/** .vox in: the models of the scene in one grid. */
#include "base/number.h"
#include "gridio/common/format.h"
#include "gridio/formats/vox/vox.h"
#include "gridio/formats/vox/vox_palette.h"
#include "gridio/formats/vox/vox_scene.h"

#include <stdio.h>
#include <string.h>

/** Voxels of a box: models far apart ask for more than their bytes are worth. */
static const uint64_t voxels_most = UINT64_C(1) << 30;

typedef struct loaded {
  vxm_vox_file file;
  vxm_vox_scene scene;
  vxm_space space;
  const char *values; /**< what voxmend wrote: "bits", "labels", "colors"; "" if it did not */
} loaded;

bool vxm_vox_sniff(const vxm_input *input) {
  return input->size >= 12 && memcmp(input->data, "VOX ", 4) == 0 && memcmp(input->data + 8, "MAIN", 4) == 0;
}

static void unload(loaded *l) {
  vxm_vox_scene_destroy(&l->scene);
  vxm_vox_file_destroy(&l->file);
}

/* ---- What voxmend wrote beside the format ---- */

/** Attributes of the root; false without one. */
static bool find_attribute(char *out, size_t room, const loaded *l, const char *key) {
  const vxm_vox_file *file = &l->file;
  return file->node_count > 0 && file->nodes[0].type == VXM_VOX_TRANSFORM &&
         vxm_vox_find(out, room, file->nodes[0].at, file->nodes[0].end, key);
}

/** Three numbers with a space between. */
static bool parse_numbers(double out[3], const char *text) {
  bool good = true;
  for (int a = 0; good && a < 3; a++) {
    size_t length = strcspn(text, " ");
    good = vxm_number_parse((const unsigned char *)text, length, &out[a]);
    text += length + (text[length] == ' ');
  }
  return good;
}

static bool find_numbers(double out[3], const loaded *l, const char *key) {
  char text[128];
  return find_attribute(text, sizeof text, l, key) && parse_numbers(out, text);
}

static void find_values(loaded *l) {
  static const char *const kinds[] = {"bits", "labels", "colors"};
  char text[16];
  l->values = "";
  if (find_attribute(text, sizeof text, l, VXM_VOX_VALUES_KEY))
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
      if (strcmp(kinds[k], text) == 0)
        l->values = kinds[k];
}

/** Voxels of 1 at the places of the scene, unless voxmend has written where the scene's origin lies. */
static vxm_status find_space(loaded *l, const vxm_input *input, vxm_error *error) {
  double origin[3] = {0, 0, 0}, size[3] = {1, 1, 1};
  if (!find_numbers(origin, l, VXM_VOX_ORIGIN_KEY) || !find_numbers(size, l, VXM_VOX_SIZE_KEY))
    for (int a = 0; a < 3; a++) {
      origin[a] = 0;
      size[a] = 1;
    }
  for (int a = 0; a < 3; a++) {
    l->space.dims[a] = l->scene.high[a] - l->scene.low[a];
    l->space.origin[a] = origin[a] + (double)l->scene.low[a] * size[a];
    l->space.voxel_size[a] = size[a];
  }
  vxm_status status = vxm_space_check_file(&l->space, input, 0, error);
  if (status == VXM_OK && vxm_space_voxels(&l->space) > voxels_most)
    status = vxm_fail_at(error, VXM_ERROR_RANGE, (vxm_place){input->name, 0, -1, -1},
                         "the models stand so far apart that a grid of all has more than 2^30 voxels");
  return status;
}

static vxm_status load(loaded *l, const vxm_input *input, vxm_error *error) {
  *l = (loaded){.values = ""};
  vxm_status status = vxm_vox_file_read(&l->file, input, error);
  if (status != VXM_OK)
    return status;
  status = vxm_vox_scene_read(&l->scene, &l->file, error);
  if (status == VXM_OK)
    status = find_space(l, input, error);
  if (status == VXM_OK)
    find_values(l);
  else
    unload(l);
  return status;
}

static void add_warnings(vxm_warnings *warnings, const loaded *l) {
  if (l->scene.left_out > 0)
    vxm_warn(warnings, "%zu models behind the first are left out: without a scene they are an animation",
             l->scene.left_out);
}

/* ---- The voxels ---- */

typedef void (*put_fn)(void *payload, const int64_t at[3], uint8_t number);

/** Calls for each voxel, its place counted from the corner of the grid; number 0 is none. */
static vxm_status for_voxels(const loaded *l, put_fn put, void *payload, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t i = 0; i < l->scene.count && status == VXM_OK; i++) {
    const vxm_vox_instance *instance = &l->scene.items[i];
    for (size_t v = 0; v < instance->model->count && status == VXM_OK; v++) {
      const unsigned char *voxel = instance->model->voxels + 4 * v;
      int64_t at[3];
      status = vxm_check_cancelled_at(v, l->file.context, error);
      if (voxel[3] == 0)
        continue;
      vxm_vox_voxel_at(at, instance, voxel);
      for (int a = 0; a < 3; a++)
        at[a] -= l->scene.low[a];
      put(payload, at, voxel[3]);
    }
  }
  return status;
}

/** Whether there are two colours. */
static bool has_colors(const loaded *l) {
  uint8_t first = 0;
  for (size_t i = 0; i < l->scene.count; i++)
    for (size_t v = 0; v < l->scene.items[i].model->count; v++) {
      uint8_t number = l->scene.items[i].model->voxels[4 * v + 3];
      if (number != 0 && first != 0 && number != first)
        return true;
      first = number != 0 ? number : first;
    }
  return false;
}

static void put_bit(void *payload, const int64_t at[3], uint8_t number) {
  vxm_grid *grid = payload;
  (void)number;
  vxm_grid_row(grid, at[1], at[2])[at[0] / 64] |= UINT64_C(1) << (at[0] % 64);
}

vxm_status vxm_vox_read_bits(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  loaded l;
  vxm_grid *grid = NULL;
  vxm_status status = load(&l, input, error);
  if (status != VXM_OK)
    return status;
  bool are_values = *l.values ? strcmp(l.values, "bits") != 0 : has_colors(&l);
  if (rule != VXM_BITS_NONE && are_values)
    status = vxm_fail_numbers(error, input->name, strcmp(l.values, "labels") == 0 ? "labels" : "colors");
  if (status == VXM_OK)
    status = vxm_grid_create(&grid, input->context, &l.space, error);
  if (status == VXM_OK && rule != VXM_BITS_NONE)
    status = for_voxels(&l, put_bit, grid, error);
  if (status == VXM_OK)
    status = vxm_progress(input->context, "reading", 1, error);
  if (status == VXM_OK)
    add_warnings(&grid->warnings, &l);
  unload(&l);
  if (status != VXM_OK) {
    vxm_grid_destroy(grid);
    return status;
  }
  *out = grid;
  return VXM_OK;
}

/* ---- Colours and labels ---- */

/** Where values go. */
typedef struct values {
  vxm_field *field;
  uint8_t rgba[256][4]; /**< by the numbers of the palette */
  int64_t voxels[256];
} values;

static size_t index_of(const vxm_field *field, const int64_t at[3]) {
  const int64_t *n = field->space.dims;
  return (size_t)((at[0] * n[1] + at[1]) * n[2] + at[2]);
}

static void put_color(void *payload, const int64_t at[3], uint8_t number) {
  values *v = payload;
  memcpy(v->field->values + 4 * index_of(v->field, at), v->rgba[number], 4);
}

static void put_label(void *payload, const int64_t at[3], uint8_t number) {
  values *v = payload;
  v->field->values[index_of(v->field, at)] = number;
}

/** Those that MagicaVoxel takes for a file without a palette: six steps of red, green and blue, the brightest
 * first, and ten of each and of grey between these. */
static void default_color(uint8_t rgba[4], int number) {
  static const uint8_t between[10] = {0xee, 0xdd, 0xbb, 0xaa, 0x88, 0x77, 0x55, 0x44, 0x22, 0x11};
  enum { STEPS = 6, CUBE = STEPS * STEPS * STEPS - 1 /* without black */ };
  int index = number - 1, ramp = (index - CUBE) / 10;
  for (int c = 0, part = STEPS * STEPS; c < 3; c++, part /= STEPS)
    rgba[c] = (uint8_t)(255 - 51 * (index / part % STEPS));
  for (int c = 0; c < 3 && index >= CUBE; c++)
    rgba[c] = ramp == c || ramp == 3 ? between[(index - CUBE) % 10] : 0;
}

static void load_palette(values *v, const vxm_vox_file *file) {
  for (int number = 1; number < 256; number++) {
    default_color(v->rgba[number], number);
    if (file->palette)
      memcpy(v->rgba[number], file->palette + 4 * (number - 1), 3);
    v->rgba[number][3] = 255; /* that of the file is for glass */
  }
}

static void count_labels(values *v) {
  size_t count = vxm_field_count(v->field);
  for (size_t i = 0; i < count; i++)
    v->voxels[v->field->values[i]]++;
}

/** The names that voxmend wrote, from 1 on. */
static void find_names(vxm_about *about, const loaded *l, const values *v) {
  char key[sizeof VXM_VOX_LABEL_KEY + 12], name[512];
  for (int label = 1; label <= VXM_VOX_COLORS && !about->starved; label++) {
    snprintf(key, sizeof key, VXM_VOX_LABEL_KEY "%d", label);
    if (!find_attribute(name, sizeof name, l, key))
      return;
    about->starved = !vxm_label_table_add(&about->table, l->file.context, name, v->voxels[label]);
  }
}

static vxm_status fill(values *v, const loaded *l, bool are_labels, vxm_error *error) {
  vxm_field *field = v->field;
  vxm_about about = {.is_declared = true, .kind = are_labels ? VXM_FIELD_LABELS : VXM_FIELD_COLORS};
  memset(field->values, 0, vxm_field_count(field) * vxm_field_voxel_bytes(field));
  load_palette(v, &l->file);
  vxm_status status = for_voxels(l, are_labels ? put_label : put_color, v, error);
  if (are_labels && status == VXM_OK) {
    count_labels(v);
    find_names(&about, l, v);
  }
  vxm_field_describe(field, &about);
  add_warnings(&field->warnings, l);
  return status == VXM_OK ? vxm_progress(field->context, "reading", 1, error) : status;
}

vxm_status vxm_vox_read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  loaded l;
  values v = {.field = NULL};
  vxm_status status = load(&l, input, error);
  if (status != VXM_OK)
    return status;
  bool are_labels = strcmp(l.values, "labels") == 0;
  status = vxm_field_make(&v.field, input->context, &l.space,
                          are_labels ? VXM_FIELD_LABELS : VXM_FIELD_COLORS, VXM_UINT8, error);
  if (status == VXM_OK)
    status = vxm_field_hand_over(out, v.field, fill(&v, &l, are_labels, error), error);
  unload(&l);
  return status;
}
