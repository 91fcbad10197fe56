/* SPDX-License-Identifier: BSD-3-Clause */
#include "modules/assimp/three_mf.h"

#include <stddef.h>
#include <string.h>

#include "modules/assimp/zip.h"

/** Some bytes of a text. */
typedef struct slice {
  const char *at;
  size_t size;
} slice;

enum { CARRIED = 256, NAMES = 24, PREFIX = 32, URI = 120 };

/** What is known of a model while it goes by. */
typedef struct look {
  size_t carried;
  bool knows_head;
  char path[PREFIX +
            8]; /**< the attribute that names another file, such as "p:path"; empty if there is none */
  bool has_path;
  double unit;                        /**< in millimetres; 0 = not told */
  char required[URI];                 /**< an extension that is not read; empty if there is none */
  char text[CARRIED + VXM_ZIP_PIECE]; /**< the last piece, and the end of the one before it */
} look;

/* ---- The first tag ---- */

static bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

static void skip_blanks(slice *text) {
  while (text->size > 0 && is_blank(*text->at)) {
    text->at++;
    text->size--;
  }
}

/** Takes what comes before one of some characters, and leaves the text at it; false if none comes. */
static bool take_until(slice *out, slice *text, const char *ends) {
  size_t n = 0;
  while (n < text->size && !strchr(ends, text->at[n]))
    n++;
  if (n == text->size)
    return false;
  *out = (slice){text->at, n};
  text->at += n;
  text->size -= n;
  return true;
}

/** Takes name and value of the next attribute; false behind the last one. */
static bool take_attribute(slice *name, slice *value, slice *text) {
  skip_blanks(text);
  if (!take_until(name, text, "= \t\r\n>/") || name->size == 0)
    return false;
  skip_blanks(text);
  if (text->size < 2 || *text->at != '=')
    return false;
  text->at++;
  text->size--;
  skip_blanks(text);
  if (text->size < 2 || (*text->at != '"' && *text->at != '\''))
    return false;
  const char quote[2] = {*text->at++, '\0'};
  text->size--;
  if (!take_until(value, text, quote))
    return false;
  text->at++;
  text->size--;
  return true;
}

static bool contains(slice text, const char *part) {
  return memmem(text.at, text.size, part, strlen(part)) != NULL;
}

static bool starts_with(slice text, const char *part) {
  return text.size >= strlen(part) && memcmp(text.at, part, strlen(part)) == 0;
}

static bool is_production(slice uri) {
  return contains(uri, "/3dmanufacturing/production/");
}

/** Extensions without which the shape is the same: colours, sets of triangles, names. Objects in other files
 * are found by their attribute. */
static bool is_harmless(slice uri) {
  return is_production(uri) || contains(uri, "/3dmanufacturing/material/") ||
         contains(uri, "/3dmanufacturing/trianglesets/") || contains(uri, "/3dmanufacturing/core/");
}

/** Prefixes of namespaces, and those that are required. */
typedef struct head {
  slice prefixes[NAMES], uris[NAMES], required, unit;
  int count;
} head;

/** Finds the tag of the model; false if it is not in the text. */
static bool find_tag(slice *out, slice text) {
  for (slice tag; take_until(&tag, &text, "<");) {
    text.at++;
    text.size--;
    slice name, rest = text;
    if (!take_until(&name, &rest, " \t\r\n>"))
      return false;
    bool is_model = name.size >= 5 && memcmp(name.at + name.size - 5, "model", 5) == 0 &&
                    (name.size == 5 || name.at[name.size - 6] == ':');
    if (is_model) {
      *out = rest;
      return true;
    }
  }
  return false;
}

static bool equals(slice text, const char *word) {
  return text.size == strlen(word) && memcmp(text.at, word, text.size) == 0;
}

static void read_head(head *out, slice tag) {
  slice name, value;
  *out = (head){.count = 0};
  while (take_attribute(&name, &value, &tag))
    if (starts_with(name, "xmlns:") && out->count < NAMES) {
      out->prefixes[out->count] = (slice){name.at + 6, name.size - 6};
      out->uris[out->count++] = value;
    } else if (equals(name, "requiredextensions"))
      out->required = value;
    else if (equals(name, "unit"))
      out->unit = value;
}

static void copy(char *out, size_t room, slice from, const char *behind) {
  size_t size = from.size < room - 1 - strlen(behind) ? from.size : room - 1 - strlen(behind);
  memcpy(out, from.at, size);
  strcpy(out + size, behind);
}

static bool is_required(const head *of, slice prefix) {
  slice rest = of->required;
  while (rest.size > 0) {
    skip_blanks(&rest);
    slice word = rest;
    if (!take_until(&word, &rest, " \t\r\n"))
      rest.size = 0;
    if (word.size == prefix.size && memcmp(word.at, prefix.at, word.size) == 0)
      return true;
  }
  return false;
}

/** In millimetres, as the core specification has them; what it does not know is left alone. */
static double unit_of(slice word) {
  static const struct {
    const char *name;
    double size;
  } units[] = {{"micron", 0.001}, {"millimeter", 1}, {"centimeter", 10},
               {"inch", 25.4},    {"foot", 304.8},   {"meter", 1000}};
  for (size_t u = 0; u < sizeof units / sizeof *units; u++)
    if (equals(word, units[u].name))
      return units[u].size;
  return 1;
}

static void look_at_head(look *of, slice text) {
  slice tag;
  head found;
  if (!find_tag(&tag, text))
    return;
  read_head(&found, tag);
  of->unit = unit_of(found.unit);
  for (int n = 0; n < found.count; n++) {
    if (is_production(found.uris[n]) && found.prefixes[n].size < PREFIX)
      copy(of->path, sizeof of->path, found.prefixes[n], ":path");
    if (!is_harmless(found.uris[n]) && is_required(&found, found.prefixes[n]))
      copy(of->required, sizeof of->required, found.uris[n], "");
  }
}

/* ---- The text ---- */

/** Whether the attribute that names another file stands in it. */
static bool has_path(slice text, const char *path) {
  size_t length = strlen(path);
  for (const char *found; (found = memmem(text.at, text.size, path, length));) {
    slice rest = {found + length, text.size - (size_t)(found - text.at) - length};
    bool is_word = found > text.at && is_blank(found[-1]);
    text = rest;
    skip_blanks(&rest);
    if (is_word && rest.size > 0 && *rest.at == '=')
      return true;
  }
  return false;
}

static bool look_at(void *payload, const char *bytes, size_t size) {
  look *of = payload;
  memcpy(of->text + of->carried, bytes, size);
  slice text = {of->text, of->carried + size};
  if (!of->knows_head)
    look_at_head(of, text);
  of->knows_head = true;
  if (of->required[0] || !of->path[0]) /* there is nothing to look for */
    return false;
  of->has_path = has_path(text, of->path);
  of->carried = text.size < CARRIED ? text.size : CARRIED;
  memmove(of->text, of->text + text.size - of->carried, of->carried);
  return !of->has_path;
}

/* ---- The archive ---- */

static vxm_status refuse_files(const char *name, vxm_error *error) {
  return vxm_fail_at(
      error, VXM_ERROR_FORMAT, (vxm_place){name, 0, -1, -1},
      "its objects lie in files of their own within it (the 3MF production extension, as Bambu "
      "Studio and OrcaSlicer write it), which is not read: export it as generic 3MF, .stl or .obj");
}

static vxm_status judge(const look *seen, const char *name, vxm_error *error) {
  if (seen->required[0])
    return vxm_fail_at(
        error, VXM_ERROR_FORMAT, (vxm_place){name, 0, -1, -1},
        "it needs the 3MF extension %s, which is not read: export it without, or as .stl or .obj",
        seen->required);
  return seen->has_path ? refuse_files(name, error) : VXM_OK;
}

static bool is_model(const vxm_zip_member *member) {
  static const char ending[] = ".model";
  size_t length = strlen(ending);
  return member->name_size > length && memcmp(member->name + member->name_size - length, ending, length) == 0;
}

vxm_status vxm_three_mf_check(double *unit, const vxm_reader_request *request, vxm_context *context,
                              vxm_error *error) {
  vxm_zip zip;
  vxm_zip_member member;
  vxm_status status = VXM_OK;
  int models = 0;
  *unit = 1;
  look *seen = vxm_try_alloc(context, 1, sizeof *seen, &status, error);
  if (!seen)
    return status;
  bool more = vxm_zip_open(&zip, request->data, request->size);
  while (more && status == VXM_OK && vxm_zip_next(&zip, &member)) {
    if (!is_model(&member))
      continue;
    memset(seen, 0, offsetof(look, text)); /* there may be many files of no size */
    bool is_seen = vxm_zip_unpack(&zip, &member, context, look_at, seen);
    status = judge(seen, request->name, error);
    if (seen->unit > 0)
      *unit = seen->unit;
    if (!is_seen && ++models > 1) /* only the production extension has more than one */
      status = refuse_files(request->name, error);
  }
  vxm_free(context, seen);
  return status;
}

vxm_status vxm_three_mf_narrow(unsigned char **out, const vxm_reader_request *request, vxm_context *context,
                               vxm_error *error) {
  vxm_status status = VXM_OK;
  *out = vxm_try_alloc(context, request->size, 1, &status, error);
  if (!*out)
    return status;
  memcpy(*out, request->data, request->size);
  if (!vxm_zip_narrow(*out, request->size)) {
    vxm_free(context, *out);
    *out = NULL;
  }
  return VXM_OK;
}
