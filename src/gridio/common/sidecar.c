/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/sidecar.h"
#include "gridio/common/format.h"
#include "gridio/common/json_text.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const vxm_sidecar_text vxm_sidecar_labels = {"voxmend labels", "x fastest, then y, then z", NULL};

/* A description has some 300 bytes, and that of 65535 labels with names of 511 up to 70 million; whatever is
 * far longer is another file. */
enum { LENGTH_MAX = 1 << 27 };

/** The JSON's path; false if no file can have so long a one. */
static bool sidecar_path(char path[PATH_MAX], const char *data_path) {
  int length = snprintf(path, PATH_MAX, "%s.json", data_path);
  return length > 0 && length < PATH_MAX;
}

static vxm_status fail_path(const char *data_path, vxm_error *error) {
  errno = ENAMETOOLONG;
  return vxm_fail_errno(error, data_path, "cannot have a .json beside it");
}

static vxm_status fail_memory(vxm_error *error) {
  return vxm_fail(error, VXM_ERROR_MEMORY, "out of memory");
}

bool vxm_sidecar_exists(const char *data_path) {
  char path[PATH_MAX];
  return sidecar_path(path, data_path) && access(path, F_OK) == 0;
}

/* ---- Writing ---- */

json_t *vxm_json_name(const char *name) {
  json_t *value = json_string(name);
  value = value ? value : json_string(name); /* was it for want of memory? */
  char *copy = value ? NULL : strdup(name);
  for (char *c = copy; c && *c; c++)
    *c = (unsigned char)*c < 0x80 ? *c : '?';
  if (copy)
    value = json_string(copy);
  free(copy);
  return value;
}

/** The table of labels; NULL without memory. */
static json_t *list_labels(const vxm_label_table *table) {
  json_t *array = json_array();
  for (size_t label = 1; array && label <= table->count; label++) {
    json_t *entry = json_pack("{s:I, s:o, s:I}", "label", (json_int_t)label, "name",
                              vxm_json_name(vxm_label_table_name(table, label)), "voxels",
                              (json_int_t)table->voxels[label - 1]);
    if (json_array_append_new(array, entry) != 0) {
      json_decref(array);
      return NULL;
    }
  }
  return array;
}

static json_t *list_pairs(const vxm_metadata *pairs) {
  json_t *object = json_object();
  for (const char *key = NULL; object && (key = vxm_metadata_next(pairs, key)) != NULL;) {
    json_t *name = vxm_json_name(key);
    int result = json_object_set_new(object, json_string_value(name), vxm_json_name(vxm_metadata_value(key)));
    json_decref(name);
    if (result != 0) {
      json_decref(object);
      return NULL;
    }
  }
  return object;
}

/** Adds what is said of the values; false without memory. */
static bool add_about(json_t *root, const vxm_about *about) {
  if (!about)
    return true;
  if (about->is_declared &&
      json_object_set_new(root, "values", json_string(vxm_field_kind_name(about->kind))) != 0)
    return false;
  if (about->table.count > 0 && json_object_set_new(root, "labels", list_labels(&about->table)) != 0)
    return false;
  return about->pairs.count == 0 || json_object_set_new(root, "metadata", list_pairs(&about->pairs)) == 0;
}

/** A growing text; NULL as soon as memory failed, of which jansson does not always tell. */
typedef struct json_text {
  char *data;
  size_t size, capacity;
  bool failed;
} json_text;

static int append_text(const char *data, size_t size, void *payload) {
  json_text *text = payload;
  size_t needed = text->size + size + 1;
  if (!text->failed && needed > text->capacity) {
    char *grown = realloc(text->data, 2 * needed);
    text->failed = !grown;
    text->data = grown ? grown : text->data;
    text->capacity = grown ? 2 * needed : text->capacity;
  }
  if (text->failed)
    return -1;
  memcpy(text->data + text->size, data, size);
  text->size += size;
  text->data[text->size] = '\0';
  return 0;
}

char *vxm_json_text(const json_t *root, size_t how) {
  json_text text = {0};
  if (json_dump_callback(root, append_text, &text, how | JSON_REAL_PRECISION(17)) == 0 && !text.failed)
    return text.data;
  free(text.data);
  return NULL;
}

/** The whole text, to be freed. */
static char *describe(const vxm_space *space, const vxm_sidecar_text *text, const vxm_about *about) {
  const int64_t *d = space->dims;
  const double *o = space->origin, *s = space->voxel_size;
  json_t *root = json_pack("{s:s, s:i, s:[I,I,I], s:[f,f,f], s:[f,f,f], s:s}", "format", text->format,
                           "version", 1, "dims", (json_int_t)d[0], (json_int_t)d[1], (json_int_t)d[2],
                           "origin", o[0], o[1], o[2], "voxel_size", s[0], s[1], s[2], "order", text->order);
  bool is_whole = root && (!text->bits || json_object_set_new(root, "bits", json_string(text->bits)) == 0) &&
                  add_about(root, about);
  if (!is_whole) {
    json_decref(root);
    return NULL;
  }
  char *json = vxm_json_text(root, JSON_INDENT(2));
  json_decref(root);
  return json;
}

static bool has_neighbours(const char *data_path) {
  struct stat info;
  return strcmp(data_path, "-") != 0 && (stat(data_path, &info) != 0 || S_ISREG(info.st_mode));
}

vxm_status vxm_sidecar_open(vxm_output **out, vxm_context *context, const vxm_space *space,
                            const char *data_path, const vxm_sidecar_text *text, const vxm_about *about,
                            vxm_error *error) {
  *out = NULL;
  if (!has_neighbours(data_path))
    return VXM_OK;
  char path[PATH_MAX];
  if (!sidecar_path(path, data_path))
    return fail_path(data_path, error);
  char *json = describe(space, text, about);
  vxm_status status = json ? vxm_output_open(out, context, path, error) : fail_memory(error);
  if (status == VXM_OK) {
    vxm_output_write(*out, json, strlen(json));
    vxm_output_write(*out, "\n", 1);
  }
  free(json);
  return status;
}

/* ---- Reading ---- */

static bool read_dims(const json_t *root, int64_t dims[3]) {
  const json_t *array = json_object_get(root, "dims");
  if (json_array_size(array) != 3)
    return false;
  for (size_t a = 0; a < 3; a++) {
    const json_t *number = json_array_get(array, a);
    if (!json_is_integer(number))
      return false;
    dims[a] = (int64_t)json_integer_value(number);
  }
  return true;
}

/** The table, if it numbers its labels from 1 on. */
static void read_labels(vxm_about *about, vxm_context *context, const json_t *root) {
  const json_t *array = json_object_get(root, "labels");
  size_t count = json_array_size(array);
  for (size_t l = 0; l < count && l < VXM_LABELS_MAX; l++) {
    const json_t *entry = json_array_get(array, l);
    const char *name = json_string_value(json_object_get(entry, "name"));
    int64_t voxels = (int64_t)json_integer_value(json_object_get(entry, "voxels"));
    if (!name || json_integer_value(json_object_get(entry, "label")) != (json_int_t)l + 1)
      break;
    if (!vxm_label_table_add(&about->table, context, name, voxels)) {
      about->starved = true;
      break;
    }
  }
  if (about->table.count > 0 && !about->is_declared) {
    about->is_declared = true;
    about->kind = VXM_FIELD_LABELS;
  }
}

static void read_about(vxm_about *about, vxm_context *context, const json_t *root) {
  const char *kind = json_string_value(json_object_get(root, "values")), *key;
  const json_t *metadata = json_object_get(root, "metadata");
  vxm_about_name(about, kind);
  read_labels(about, context, root);
  for (void *at = json_object_iter((json_t *)metadata); at;
       at = json_object_iter_next((json_t *)metadata, at)) {
    const json_t *value = json_object_iter_value(at);
    key = json_object_iter_key(at);
    if (json_is_string(value))
      vxm_metadata_add(&about->pairs, context, key, strlen(key), json_string_value(value),
                       json_string_length(value));
  }
}

static vxm_status read_root(vxm_space *space, const json_t *root, const vxm_input *input, const char *format,
                            vxm_error *error) {
  const char *name = json_string_value(json_object_get(root, "format"));
  if (!name || strcmp(name, format) != 0)
    return vxm_fail_byte(error, input, 0, "its \"format\" is not \"%s\"", format);
  if (json_integer_value(json_object_get(root, "version")) != 1)
    return vxm_fail_byte(error, input, 0, "its \"version\" is not 1");
  if (!read_dims(root, space->dims))
    return vxm_fail_byte(error, input, 0, "\"dims\" must be three whole numbers");
  if (!vxm_json_triple(space->origin, root, "origin") ||
      !vxm_json_triple(space->voxel_size, root, "voxel_size"))
    return vxm_fail_byte(error, input, 0, "\"origin\" and \"voxel_size\" must be three numbers each");
  return vxm_space_check_file(space, input, 0, error);
}

static vxm_status parse(vxm_space *space, vxm_about *about, const vxm_input *input, const char *format,
                        vxm_error *error) {
  if (input->size > LENGTH_MAX)
    return vxm_fail_byte(error, input, LENGTH_MAX, "too long to be the description of a grid");
  json_error_t what;
  const char *text = (const char *)input->data;
  json_t *root = json_loadb(text, input->size, JSON_REJECT_DUPLICATES, &what);
  if (!root) /* it calls a want of memory by many names; what is damaged fails again */
    root = json_loadb(text, input->size, JSON_REJECT_DUPLICATES, &what);
  if (!root)
    return vxm_fail_byte(error, input, what.position, "not JSON: %s", what.text);
  vxm_status status = read_root(space, root, input, format, error);
  if (status == VXM_OK && about)
    read_about(about, input->context, root);
  json_decref(root);
  return status;
}

vxm_status vxm_sidecar_read(vxm_space *space, vxm_about *about, vxm_context *context, const char *data_path,
                            const char *format, vxm_error *error) {
  char path[PATH_MAX];
  if (!sidecar_path(path, data_path))
    return fail_path(data_path, error);
  vxm_input input;
  vxm_status status = vxm_input_open(&input, context, path, error);
  if (status == VXM_OK) {
    status = parse(space, about, &input, format, error);
    vxm_input_close(&input);
  }
  return status;
}

void vxm_sidecar_remove_labels(vxm_context *context, const char *data_path) {
  char path[PATH_MAX];
  vxm_space space;
  if (strcmp(data_path, "-") != 0 && vxm_sidecar_exists(data_path) && sidecar_path(path, data_path) &&
      vxm_sidecar_read(&space, NULL, context, data_path, "voxmend labels", NULL) == VXM_OK)
    unlink(path);
}

bool vxm_sidecar_read_labels(vxm_space *space, vxm_about *about, const vxm_input *input) {
  bool is_file = input->mapping || strcmp(input->name, "<stdin>") != 0;
  if (!is_file || !vxm_sidecar_exists(input->name) || (about->is_declared && about->kind != VXM_FIELD_LABELS))
    return false;
  vxm_status status = vxm_sidecar_read(space, about, input->context, input->name, "voxmend labels", NULL);
  about->starved |= vxm_is_memory(status);
  return status == VXM_OK;
}

void vxm_sidecar_take_labels(vxm_about *about, const int64_t dims[3], const vxm_input *input) {
  vxm_space space;
  vxm_about found = {.is_declared = about->is_declared, .kind = about->kind};
  if (vxm_sidecar_read_labels(&space, &found, input) && memcmp(space.dims, dims, sizeof space.dims) == 0) {
    about->table = found.table;
    about->is_declared = found.is_declared;
    about->kind = found.kind;
    found.table = (vxm_label_table){.count = 0};
  }
  about->starved |= found.starved;
  vxm_about_destroy(&found);
}
