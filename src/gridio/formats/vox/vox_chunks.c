/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/vox/vox_chunks.h"
#include "base/endian.h"
#include "gridio/common/format.h"

#include <stdlib.h>
#include <string.h>

enum { HEADER = 8, CHUNK = 12, MODEL_MOST = 256, PALETTE_BYTES = 1024 };

/* ---- Numbers and texts ---- */

bool vxm_vox_take(int32_t *out, const unsigned char **at, const unsigned char *end) {
  if (end - *at < 4)
    return false;
  *out = (int32_t)vxm_load_u32(*at, vxm_must_swap(false));
  *at += 4;
  return true;
}

/** Takes a text, which is no C text. */
static bool take_text(const char **text, size_t *size, const unsigned char **at, const unsigned char *end) {
  int32_t length;
  if (!vxm_vox_take(&length, at, end) || length < 0 || end - *at < length)
    return false;
  *text = (const char *)*at;
  *size = (size_t)length;
  *at += length;
  return true;
}

bool vxm_vox_skip_pairs(const unsigned char **at, const unsigned char *end) {
  int32_t count;
  const char *text;
  size_t size;
  bool is_whole = vxm_vox_take(&count, at, end) && count >= 0;
  for (int32_t i = 0; is_whole && i < count; i++)
    is_whole = take_text(&text, &size, at, end) && take_text(&text, &size, at, end);
  return is_whole;
}

bool vxm_vox_find(char *out, size_t room, const unsigned char *at, const unsigned char *end,
                  const char *key) {
  int32_t count;
  const char *name, *value;
  size_t name_size, size;
  if (!vxm_vox_take(&count, &at, end))
    return false;
  for (int32_t i = 0; i < count; i++) {
    if (!take_text(&name, &name_size, &at, end) || !take_text(&value, &size, &at, end))
      return false;
    if (name_size != strlen(key) || memcmp(name, key, name_size) != 0)
      continue;
    size = size < room ? size : room - 1;
    memcpy(out, value, size);
    out[size] = '\0';
    return true;
  }
  return false;
}

/* ---- Chunks ---- */

static vxm_status fail_chunk(const vxm_vox_file *file, const unsigned char *at, const char *why,
                             vxm_error *error) {
  return vxm_fail_byte(error, file->input, at - file->input->data, "%s", why);
}

/** SIZE, which stands before the voxels of its model. */
static vxm_status add_size(vxm_vox_file *file, const unsigned char *at, const unsigned char *end,
                           vxm_error *error) {
  const unsigned char *begin = at;
  int32_t size[3];
  for (int a = 0; a < 3; a++)
    if (!vxm_vox_take(&size[a], &at, end) || size[a] < 1 || size[a] > MODEL_MOST)
      return fail_chunk(file, begin, "SIZE is not three numbers from 1 to 256", error);
  vxm_status status = vxm_grow(file->context, (void **)&file->models, &file->model_capacity,
                               file->model_count + 1, sizeof *file->models, error);
  if (status == VXM_OK)
    file->models[file->model_count++] = (vxm_vox_model){{size[0], size[1], size[2]}, NULL, 0};
  return status;
}

static vxm_status add_voxels(vxm_vox_file *file, const unsigned char *at, const unsigned char *end,
                             vxm_error *error) {
  const unsigned char *begin = at;
  int32_t count;
  vxm_vox_model *model = file->model_count > 0 ? &file->models[file->model_count - 1] : NULL;
  if (!model || model->voxels)
    return fail_chunk(file, begin, "XYZI without a SIZE before it", error);
  if (!vxm_vox_take(&count, &at, end) || count < 0 || count > (end - at) / 4)
    return fail_chunk(file, begin, "XYZI has fewer voxels than it says", error);
  for (int32_t v = 0; v < count; v++)
    for (int a = 0; a < 3; a++)
      if (at[4 * v + a] >= model->size[a])
        return fail_chunk(file, at + 4 * v, "a voxel lies outside its model", error);
  model->voxels = at;
  model->count = (size_t)count;
  return VXM_OK;
}

static vxm_status add_node(vxm_vox_file *file, vxm_vox_node_type type, const unsigned char *at,
                           const unsigned char *end, vxm_error *error) {
  int32_t number;
  if (!vxm_vox_take(&number, &at, end))
    return fail_chunk(file, at, "a node without a number", error);
  vxm_status status = vxm_grow(file->context, (void **)&file->nodes, &file->node_capacity,
                               file->node_count + 1, sizeof *file->nodes, error);
  if (status == VXM_OK)
    file->nodes[file->node_count++] = (vxm_vox_node){number, type, false, at, end};
  return status;
}

static vxm_status add_chunk(vxm_vox_file *file, const unsigned char name[4], const unsigned char *at,
                            const unsigned char *end, vxm_error *error) {
  static const char *const nodes[] = {"nTRN", "nGRP", "nSHP"};
  if (memcmp(name, "SIZE", 4) == 0)
    return add_size(file, at, end, error);
  if (memcmp(name, "XYZI", 4) == 0)
    return add_voxels(file, at, end, error);
  for (int type = 0; type < 3; type++)
    if (memcmp(name, nodes[type], 4) == 0)
      return add_node(file, (vxm_vox_node_type)type, at, end, error);
  if (memcmp(name, "RGBA", 4) != 0)
    return VXM_OK;
  if (end - at < PALETTE_BYTES)
    return fail_chunk(file, at, "RGBA has fewer than 256 colours", error);
  file->palette = at;
  return VXM_OK;
}

/** The chunks within MAIN, one behind the other; those that are not known may hold others, and are left out.
 */
static vxm_status read_chunks(vxm_vox_file *file, const unsigned char *at, const unsigned char *end,
                              vxm_error *error) {
  vxm_status status = VXM_OK;
  while (status == VXM_OK && at < end) {
    const unsigned char *name = at;
    int32_t content, children;
    at += 4;
    if (end - name < CHUNK || !vxm_vox_take(&content, &at, end) || !vxm_vox_take(&children, &at, end) ||
        content < 0 || children < 0 || end - at < content || end - at - content < children)
      return fail_chunk(file, end, "the file is cut short within a chunk", error);
    status = add_chunk(file, name, at, at + content, error);
    at += (size_t)content + (size_t)children;
    if (status == VXM_OK)
      status = vxm_check_cancelled(file->context, error);
  }
  return status;
}

static int compare(const void *a, const void *b) {
  const vxm_vox_node *p = a, *q = b;
  return p->number != q->number ? (p->number < q->number ? -1 : 1) : (p->at > q->at) - (p->at < q->at);
}

static vxm_status check_nodes(vxm_vox_file *file, vxm_error *error) {
  if (file->node_count > 1)
    qsort(file->nodes, file->node_count, sizeof *file->nodes, compare);
  for (size_t n = 1; n < file->node_count; n++)
    if (file->nodes[n].number == file->nodes[n - 1].number)
      return fail_chunk(file, file->nodes[n].at, "two nodes have the same number", error);
  return VXM_OK;
}

static vxm_status read_main(vxm_vox_file *file, vxm_error *error) {
  const vxm_input *input = file->input;
  const unsigned char *at = input->data + HEADER + 4, *end = input->data + input->size;
  int32_t content, children;
  if (input->size < HEADER + CHUNK || memcmp(input->data, "VOX ", 4) != 0 ||
      memcmp(input->data + HEADER, "MAIN", 4) != 0)
    return vxm_fail_byte(error, input, 0,
                         "not a .vox file: it does not begin with \"VOX \", and a chunk MAIN");
  if (!vxm_vox_take(&content, &at, end) || !vxm_vox_take(&children, &at, end) || content < 0 ||
      children < 0 || end - at < content || end - at - content < children)
    return vxm_fail_byte(error, input, input->size, "the file is cut short: MAIN goes on behind its end");
  at += content;
  vxm_status status = read_chunks(file, at, at + children, error);
  for (size_t m = 0; status == VXM_OK && m < file->model_count; m++)
    if (!file->models[m].voxels)
      status = vxm_fail_byte(error, input, 0, "model %zu has a SIZE and no XYZI", m);
  if (status == VXM_OK && file->model_count == 0)
    status = vxm_fail_byte(error, input, 0, "the file has no model");
  return status == VXM_OK ? check_nodes(file, error) : status;
}

vxm_status vxm_vox_file_read(vxm_vox_file *out, const vxm_input *input, vxm_error *error) {
  *out = (vxm_vox_file){.context = input->context, .input = input};
  vxm_status status = read_main(out, error);
  if (status != VXM_OK)
    vxm_vox_file_destroy(out);
  return status;
}

void vxm_vox_file_destroy(vxm_vox_file *file) {
  vxm_free(file->context, file->models);
  vxm_free(file->context, file->nodes);
  file->models = NULL;
  file->nodes = NULL;
}

vxm_vox_node *vxm_vox_node_find(const vxm_vox_file *file, int32_t number) {
  size_t low = 0, high = file->node_count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (file->nodes[middle].number < number)
      low = middle + 1;
    else
      high = middle;
  }
  return low < file->node_count && file->nodes[low].number == number ? &file->nodes[low] : NULL;
}
