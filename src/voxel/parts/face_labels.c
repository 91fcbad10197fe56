/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parts/face_labels.h"
#include "mesh/components.h"
#include "mesh/weld.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** The name of a group or material inside that of a tag. */
typedef struct key {
  const char *at;
  size_t length;
  uint32_t tag;
} key;

/** What is needed while faces are labelled. */
typedef struct builder {
  vxm_face_labels *out;
  const vxm_soup *soup;
  uint32_t *label; /**< of every face, from 0 on */
  size_t count;
  vxm_error error; /**< of the last failure */
} builder;

static const char unnamed[] = "unnamed";

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_calloc(b->soup->context, count, size, &b->error);
}

/* ---- Parts ---- */

static vxm_status find_parts(builder *b) {
  vxm_context *context = b->soup->context;
  uint32_t *map = allocate(b, b->soup->vertex_count, sizeof *map);
  if (!map)
    return b->error.code;
  vxm_status status =
      vxm_weld_exact(context, b->soup->positions, b->soup->vertex_count, map, NULL, &b->error);
  if (status == VXM_OK)
    status = vxm_components(context, b->soup, map, b->label, &b->count, &b->error);
  vxm_free(context, map);
  return status;
}

/* ---- Groups and materials ---- */

static key group_of(const vxm_soup *soup, uint32_t tag) {
  const char *name = soup->tags[tag], *slash = strchr(name, '/');
  return (key){name, slash ? (size_t)(slash - name) : strlen(name), tag};
}

static key material_of(const vxm_soup *soup, uint32_t tag) {
  const char *slash = strchr(soup->tags[tag], '/');
  return slash ? (key){slash + 1, strlen(slash + 1), tag} : (key){"", 0, tag};
}

static key key_of(const vxm_soup *soup, vxm_label_by by, uint32_t tag) {
  key k = by == VXM_LABEL_MATERIAL ? material_of(soup, tag) : group_of(soup, tag);
  return k.length > 0 ? k : (key){unnamed, sizeof unnamed - 1, tag};
}

static int compare_keys(const void *a, const void *b) {
  const key *p = a, *q = b;
  int order = memcmp(p->at, q->at, p->length < q->length ? p->length : q->length);
  return order != 0 ? order : (p->length > q->length) - (p->length < q->length);
}

/** Gives tags with equal keys the same number. */
static vxm_status number_keys(builder *b, vxm_label_by by, uint32_t *number) {
  size_t count = b->soup->tag_count, next = 0;
  key *keys = allocate(b, count, sizeof *keys);
  if (!keys)
    return b->error.code;
  for (size_t t = 0; t < count; t++)
    keys[t] = key_of(b->soup, by, (uint32_t)t);
  qsort(keys, count, sizeof *keys, compare_keys);
  for (size_t t = 0; t < count; t++) {
    next += t > 0 && compare_keys(&keys[t - 1], &keys[t]) != 0;
    number[keys[t].tag] = (uint32_t)next;
  }
  vxm_free(b->soup->context, keys);
  return VXM_OK;
}

static vxm_status find_named(builder *b, vxm_label_by by) {
  const vxm_soup *soup = b->soup;
  if (!soup->face_tags) {
    b->out->is_untagged = true;
    b->count = soup->face_count > 0;
    return VXM_OK; /* all labels are 0 */
  }
  uint32_t *number = allocate(b, soup->tag_count, sizeof *number),
           *label = allocate(b, soup->tag_count, sizeof *label); /* of a number, from 1 on */
  vxm_status status = label && number ? number_keys(b, by, number) : b->error.code;
  for (size_t f = 0; status == VXM_OK && f < soup->face_count; f++) {
    uint32_t *found = &label[number[soup->face_tags[f]]];
    if (*found == 0)
      *found = (uint32_t)++b->count;
    b->label[f] = *found - 1;
  }
  vxm_free(soup->context, label);
  vxm_free(soup->context, number);
  return status;
}

/* ---- Faces in the order of their labels ---- */

static vxm_status check_count(const builder *b, vxm_label_by by, vxm_error *error) {
  static const char *const what[] = {"parts", "groups", "materials"};
  if (b->count <= VXM_LABELS_MAX)
    return VXM_OK;
  return vxm_fail(error, VXM_ERROR_RANGE, "%zu %s are more labels than 16 bits tell apart, which is %d; %s",
                  b->count, what[by], VXM_LABELS_MAX,
                  by == VXM_LABEL_PART ? "label by group, or drop small parts first (repair --drop-parts)"
                                       : "label by part, or give several the same name");
}

static vxm_status sort_faces(builder *b) {
  vxm_face_labels *out = b->out;
  out->faces = allocate(b, b->soup->face_count, sizeof *out->faces);
  out->begin = allocate(b, b->count + 2, sizeof *out->begin);
  if (!out->faces || !out->begin)
    return b->error.code;
  /* Counted two places on: as faces are put in place the ends of labels become their beginnings. */
  for (size_t f = 0; f < b->soup->face_count; f++)
    out->begin[b->label[f] + 2]++;
  for (size_t l = 2; l < b->count + 2; l++)
    out->begin[l] += out->begin[l - 1];
  for (size_t f = 0; f < b->soup->face_count; f++)
    out->faces[out->begin[b->label[f] + 1]++] = (uint32_t)f;
  return VXM_OK;
}

/* ---- Names ---- */

/** The name that all faces of a part share, if there is one. */
static bool shared_name(const vxm_face_labels *l, size_t label, key *out) {
  const vxm_soup *soup = l->soup;
  if (!soup->face_tags)
    return false;
  uint32_t first = soup->face_tags[l->faces[l->begin[label - 1]]];
  bool same_tag = true, same_group = true;
  key group = group_of(soup, first);
  for (size_t i = l->begin[label - 1] + 1; i < l->begin[label] && same_group; i++) {
    uint32_t tag = soup->face_tags[l->faces[i]];
    if (tag == first)
      continue;
    key other = group_of(soup, tag);
    same_tag = false;
    same_group = compare_keys(&group, &other) == 0;
  }
  *out = same_tag ? (key){soup->tags[first], strlen(soup->tags[first]), first} : group;
  return same_group && out->length > 0;
}

/** The name of a label; `room` holds it if it has to be made. */
static key name_of(const vxm_face_labels *l, vxm_label_by by, size_t label, char room[32]) {
  key name;
  if (by != VXM_LABEL_PART)
    return l->is_untagged ? (key){unnamed, sizeof unnamed - 1, 0}
                          : key_of(l->soup, by, l->soup->face_tags[l->faces[l->begin[label - 1]]]);
  if (shared_name(l, label, &name))
    return name;
  int length = snprintf(room, 32, "part %zu", label);
  return (key){room, (size_t)length, 0};
}

static vxm_status make_table(builder *b, vxm_label_by by) {
  vxm_face_labels *l = b->out;
  vxm_label_table *table = &l->table;
  char room[32];
  size_t size = 0;
  for (size_t label = 1; label <= b->count; label++)
    size += name_of(l, by, label, room).length + 1;
  table->text = allocate(b, size, 1);
  table->name = allocate(b, b->count, sizeof *table->name);
  table->voxels = allocate(b, b->count, sizeof *table->voxels);
  if (!table->text || !table->name || !table->voxels)
    return b->error.code;
  table->count = b->count;
  size_t at = 0;
  for (size_t label = 1; label <= b->count; label++) {
    key name = name_of(l, by, label, room);
    table->name[label - 1] = at;
    memcpy(table->text + at, name.at, name.length);
    at += name.length + 1;
  }
  return VXM_OK;
}

vxm_status vxm_face_labels_create(vxm_face_labels *out, const vxm_soup *soup, vxm_label_by by,
                                  vxm_error *error) {
  *out = (vxm_face_labels){
      .soup = soup, .table = {.context = soup->context}, .is_by_part = by == VXM_LABEL_PART};
  builder b = {.out = out, .soup = soup, .error = VXM_ERROR_INIT};
  if (soup->face_count > UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu faces are too many to number; split the mesh",
                    soup->face_count);
  b.label = allocate(&b, soup->face_count, sizeof *b.label);
  vxm_status status = !b.label ? b.error.code : by == VXM_LABEL_PART ? find_parts(&b) : find_named(&b, by);
  if (status == VXM_OK)
    status = check_count(&b, by, &b.error);
  if (status == VXM_OK)
    status = sort_faces(&b);
  if (status == VXM_OK)
    status = make_table(&b, by);
  vxm_free(soup->context, b.label);
  if (status != VXM_OK)
    vxm_error_pass(error, &b.error);
  return status;
}

void vxm_label_table_destroy(vxm_label_table *table) {
  vxm_free(table->context, table->text);
  vxm_free(table->context, table->name);
  vxm_free(table->context, table->voxels);
  *table = (vxm_label_table){.context = table->context};
}

void vxm_face_labels_destroy(vxm_face_labels *labelling) {
  vxm_context *context = labelling->soup->context;
  vxm_free(context, labelling->faces);
  vxm_free(context, labelling->begin);
  vxm_label_table_destroy(&labelling->table);
  labelling->faces = NULL;
  labelling->begin = NULL;
}
