/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/vox/vox_scene.h"
#include "gridio/common/format.h"

#include <stdio.h>
#include <string.h>

/** As far from the origin as a model may stand; sums of two are far from overflow. */
static const int64_t step_most = INT64_C(1) << 30;

static const vxm_vox_place nowhere = {{0, 1, 2}, {1, 1, 1}, {0, 0, 0}};

/** A node that waits, and where what is below it stands. */
typedef struct waiting {
  vxm_vox_node *node;
  vxm_vox_place place;
} waiting;

typedef struct walk {
  const vxm_vox_file *file;
  vxm_vox_scene *scene;
  waiting *stack; /**< no recursion: files may be as deep as they like */
  size_t count, capacity;
} walk;

static vxm_status fail_node(const walk *w, const unsigned char *at, const char *why, vxm_error *error) {
  return vxm_fail_byte(error, w->file->input, at - w->file->input->data, "%s", why);
}

/* ---- Places ---- */

/** Rows of the turn have one number that is not 0: two bits each for its column in the first two, and three
 * for the signs. */
static bool read_turn(vxm_vox_place *place, const char *text) {
  int bits;
  if (sscanf(text, "%d", &bits) != 1)
    return false;
  int first = bits & 3, second = bits >> 2 & 3;
  if (first > 2 || second > 2 || first == second)
    return false;
  place->of[0] = first;
  place->of[1] = second;
  place->of[2] = 3 - first - second;
  for (int a = 0; a < 3; a++)
    place->sign[a] = bits >> (4 + a) & 1 ? -1 : 1;
  return true;
}

static bool read_step(vxm_vox_place *place, const char *text) {
  long long step[3];
  if (sscanf(text, "%lld %lld %lld", &step[0], &step[1], &step[2]) != 3)
    return false;
  for (int a = 0; a < 3; a++) {
    if (step[a] > step_most || step[a] < -step_most)
      return false;
    place->step[a] = step[a];
  }
  return true;
}

/** What is inside an inside, as seen from outside. */
static bool combine(vxm_vox_place *out, const vxm_vox_place *outer, const vxm_vox_place *inner) {
  bool is_near = true;
  for (int a = 0; a < 3; a++) {
    int b = outer->of[a];
    out->of[a] = inner->of[b];
    out->sign[a] = outer->sign[a] * inner->sign[b];
    out->step[a] = outer->sign[a] * inner->step[b] + outer->step[a];
    is_near = is_near && out->step[a] <= step_most && out->step[a] >= -step_most;
  }
  return is_near;
}

void vxm_vox_voxel_at(int64_t at[3], const vxm_vox_instance *instance, const unsigned char voxel[4]) {
  const vxm_vox_place *place = &instance->place;
  /* Turns are about the middle, rounded down to a corner of voxels; twice the centre of a voxel is odd. */
  for (int a = 0; a < 3; a++) {
    int b = place->of[a];
    int64_t twice = 2 * (voxel[b] - instance->model->size[b] / 2) + 1;
    at[a] = (place->sign[a] * twice - 1) / 2 + place->step[a]; /* even before it is halved */
  }
}

/* ---- Nodes ---- */

static vxm_status push(walk *w, int32_t number, const vxm_vox_place *place, const unsigned char *at,
                       vxm_error *error) {
  vxm_vox_node *node = vxm_vox_node_find(w->file, number);
  if (!node)
    return fail_node(w, at, "a node has a child that is not there", error);
  if (node->is_taken)
    return fail_node(w, at, "a node is the child of two, or of itself", error);
  node->is_taken = true;
  vxm_status status =
      vxm_grow(w->scene->context, (void **)&w->stack, &w->capacity, w->count + 1, sizeof *w->stack, error);
  if (status == VXM_OK)
    w->stack[w->count++] = (waiting){node, *place};
  return status;
}

/** Attributes, the child, two numbers that do not matter here, and frames, of which the first counts. */
static vxm_status do_transform(walk *w, const waiting *entry, vxm_error *error) {
  const unsigned char *at = entry->node->at, *end = entry->node->end;
  int32_t child, reserved, layer, frames;
  char text[128];
  vxm_vox_place own = nowhere, place;
  if (!vxm_vox_skip_pairs(&at, end) || !vxm_vox_take(&child, &at, end) ||
      !vxm_vox_take(&reserved, &at, end) || !vxm_vox_take(&layer, &at, end) ||
      !vxm_vox_take(&frames, &at, end))
    return fail_node(w, entry->node->at, "nTRN is cut short", error);
  if (frames > 0) {
    const unsigned char *frame = at;
    if (!vxm_vox_skip_pairs(&at, end))
      return fail_node(w, frame, "nTRN is cut short in its first frame", error);
    if (vxm_vox_find(text, sizeof text, frame, end, "_r") && !read_turn(&own, text))
      return fail_node(w, frame, "_r is no turn", error);
    if (vxm_vox_find(text, sizeof text, frame, end, "_t") && !read_step(&own, text))
      return fail_node(w, frame, "_t is not three whole numbers, or too far away", error);
  }
  if (!combine(&place, &entry->place, &own))
    return fail_node(w, at, "a model stands too far away", error);
  return push(w, child, &place, at, error);
}

static vxm_status do_group(walk *w, const waiting *entry, vxm_error *error) {
  const unsigned char *at = entry->node->at, *end = entry->node->end;
  int32_t count, child;
  if (!vxm_vox_skip_pairs(&at, end) || !vxm_vox_take(&count, &at, end) || count < 0 || count > (end - at) / 4)
    return fail_node(w, entry->node->at, "nGRP is cut short", error);
  /* from the last on, so that the first comes off the stack first */
  for (int32_t i = count - 1; i >= 0; i--) {
    const unsigned char *here = at + 4 * (size_t)i;
    vxm_vox_take(&child, &here, end);
    vxm_status status = push(w, child, &entry->place, here, error);
    if (status != VXM_OK)
      return status;
  }
  return VXM_OK;
}

/** Of several models, which are frames of an animation, the first. */
static vxm_status do_shape(walk *w, const waiting *entry, vxm_error *error) {
  const unsigned char *at = entry->node->at, *end = entry->node->end;
  int32_t count, model;
  if (!vxm_vox_skip_pairs(&at, end) || !vxm_vox_take(&count, &at, end) || count < 1 ||
      !vxm_vox_take(&model, &at, end))
    return fail_node(w, entry->node->at, "nSHP is cut short, or has no model", error);
  if (model < 0 || (size_t)model >= w->file->model_count)
    return fail_node(w, at, "nSHP has a model that is not there", error);
  vxm_vox_scene *scene = w->scene;
  vxm_status status = vxm_grow(scene->context, (void **)&scene->items, &scene->capacity, scene->count + 1,
                               sizeof *scene->items, error);
  if (status == VXM_OK)
    scene->items[scene->count++] = (vxm_vox_instance){&w->file->models[model], entry->place};
  return status;
}

static vxm_status walk_all(walk *w, vxm_error *error) {
  vxm_status status = push(w, w->file->nodes[0].number, &nowhere, w->file->nodes[0].at, error);
  while (status == VXM_OK && w->count > 0) {
    waiting entry = w->stack[--w->count];
    status = entry.node->type == VXM_VOX_TRANSFORM ? do_transform(w, &entry, error)
             : entry.node->type == VXM_VOX_GROUP   ? do_group(w, &entry, error)
                                                   : do_shape(w, &entry, error);
    if (status == VXM_OK)
      status = vxm_check_cancelled(w->scene->context, error);
  }
  return status;
}

/* ---- The scene ---- */

/** A model without nodes has its corner at 0. */
static vxm_status take_first(vxm_vox_scene *scene, const vxm_vox_file *file, vxm_error *error) {
  vxm_status status =
      vxm_grow(scene->context, (void **)&scene->items, &scene->capacity, 1, sizeof *scene->items, error);
  if (status != VXM_OK)
    return status;
  vxm_vox_instance first = {&file->models[0], nowhere};
  for (int a = 0; a < 3; a++)
    first.place.step[a] = file->models[0].size[a] / 2;
  scene->items[scene->count++] = first;
  return VXM_OK;
}

/** The corners of all models. */
static void find_box(vxm_vox_scene *scene) {
  for (size_t i = 0; i < scene->count; i++) {
    const vxm_vox_instance *instance = &scene->items[i];
    const int64_t *size = instance->model->size;
    const unsigned char ends[2][4] = {
        {0, 0, 0, 0},
        {(unsigned char)(size[0] - 1), (unsigned char)(size[1] - 1), (unsigned char)(size[2] - 1), 0}};
    for (int e = 0; e < 2; e++) {
      int64_t at[3];
      vxm_vox_voxel_at(at, instance, ends[e]);
      for (int a = 0; a < 3; a++) {
        bool is_first = i == 0 && e == 0;
        scene->low[a] = is_first || at[a] < scene->low[a] ? at[a] : scene->low[a];
        scene->high[a] = is_first || at[a] + 1 > scene->high[a] ? at[a] + 1 : scene->high[a];
      }
    }
  }
}

vxm_status vxm_vox_scene_read(vxm_vox_scene *out, const vxm_vox_file *file, vxm_error *error) {
  *out = (vxm_vox_scene){.context = file->context};
  walk w = {.file = file, .scene = out};
  vxm_status status = file->node_count > 0 ? walk_all(&w, error) : take_first(out, file, error);
  vxm_free(out->context, w.stack);
  if (status == VXM_OK && out->count == 0)
    status = vxm_fail_byte(error, file->input, 0, "the scene shows no model");
  if (status != VXM_OK) {
    vxm_vox_scene_destroy(out);
    return status;
  }
  find_box(out);
  out->left_out = file->node_count > 0 ? 0 : file->model_count - 1;
  return VXM_OK;
}

void vxm_vox_scene_destroy(vxm_vox_scene *scene) {
  vxm_free(scene->context, scene->items);
  scene->items = NULL;
}
