/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/external/external_formats.h"

#include <stdio.h>
#include <string.h>

#include "base/endian.h"
#include "base/file.h"
#include "sandbox/reader_process.h"

/* ---- Content ---- */

static bool has_at(const unsigned char *data, size_t size, size_t at, const char *magic) {
  size_t length = strlen(magic);
  return size >= at + length && memcmp(data + at, magic, length) == 0;
}

/** Whether a text stands within the first or the last bytes of the file. */
static bool has_near_ends(const unsigned char *data, size_t size, const char *text) {
  const size_t reach = 65536, near = size < reach ? size : reach, length = strlen(text);
  return memmem(data, near, text, length) != NULL || memmem(data + size - near, near, text, length) != NULL;
}

static bool has_in_head(const unsigned char *data, size_t size, const char *text) {
  const size_t head = 4096;
  return memmem(data, size < head ? size : head, text, strlen(text)) != NULL;
}

static unsigned char first_letter(const unsigned char *data, size_t size) {
  size_t at = 0;
  while (at < size && (data[at] == ' ' || data[at] == '\t' || data[at] == '\r' || data[at] == '\n'))
    at++;
  return at < size ? data[at] : 0;
}

static bool is_glb(const unsigned char *data, size_t size) {
  return has_at(data, size, 0, "glTF");
}

static bool is_gltf(const unsigned char *data, size_t size) {
  return first_letter(data, size) == '{' && has_near_ends(data, size, "\"asset\"") &&
         has_near_ends(data, size, "\"version\"");
}

/** A zip archive whose directory, at the end, names the model. */
static bool is_3mf(const unsigned char *data, size_t size) {
  return has_at(data, size, 0, "PK\x03\x04") && has_near_ends(data, size, ".model");
}

static bool is_collada(const unsigned char *data, size_t size) {
  return first_letter(data, size) == '<' && has_in_head(data, size, "<COLLADA");
}

static bool is_x3d(const unsigned char *data, size_t size) {
  return first_letter(data, size) == '<' && has_in_head(data, size, "<X3D");
}

static bool is_amf(const unsigned char *data, size_t size) {
  return first_letter(data, size) == '<' && has_in_head(data, size, "<amf");
}

static bool is_fbx(const unsigned char *data, size_t size) {
  return has_at(data, size, 0, "Kaydara FBX Binary") || has_at(data, size, 0, "; FBX");
}

/** The main chunk, which says how long the file is. */
static bool is_3ds(const unsigned char *data, size_t size) {
  return size >= 6 && data[0] == 0x4d && data[1] == 0x4d &&
         vxm_load_u32(data + 2, vxm_must_swap(false)) == size;
}

static bool is_blend(const unsigned char *data, size_t size) {
  return has_at(data, size, 0, "BLENDER_") || has_at(data, size, 0, "BLENDER-");
}

static bool is_lwo(const unsigned char *data, size_t size) {
  return has_at(data, size, 0, "FORM") &&
         (has_at(data, size, 8, "LWO") || has_at(data, size, 8, "LXOB") || has_at(data, size, 8, "LWLO"));
}

static bool is_x(const unsigned char *data, size_t size) {
  return has_at(data, size, 0, "xof 0");
}

static bool is_ac3d(const unsigned char *data, size_t size) {
  return has_at(data, size, 0, "AC3D");
}

static bool is_part21(const unsigned char *data, size_t size) {
  return has_at(data, size, 0, "ISO-10303-21;");
}

/** Buildings are STEP files of another schema, which OpenCASCADE does not know. */
static bool is_ifc(const unsigned char *data, size_t size) {
  return is_part21(data, size) && has_in_head(data, size, "('IFC");
}

/** Lines of 80 columns, of which the first bears the mark of the start section in column 73. */
static bool is_iges(const unsigned char *data, size_t size) {
  enum { MARK = 72, LINE = 80 };
  if (size < LINE + 1 || data[MARK] != 'S' || (data[LINE] != '\n' && data[LINE] != '\r'))
    return false;
  size_t at = MARK + 1;
  while (at < LINE - 1 && (data[at] == ' ' || data[at] == '0'))
    at++;
  return at == LINE - 1 && data[at] == '1';
}

/* ---- The table ---- */

/* A row is tried before those below it. */
static const vxm_external_format formats[] = {
    {"gltf", {"gltf"}, "gltf", is_gltf, false},
    {"gltf", {"glb"}, "glb", is_glb, false},
    {"3mf", {"3mf"}, "3mf", is_3mf, false},
    {"collada", {"dae"}, "dae", is_collada, false},
    {"collada", {"zae"}, "zae", NULL, false},
    {"fbx", {"fbx"}, "fbx", is_fbx, false},
    {"3ds", {"3ds"}, "3ds", is_3ds, false},
    {"x3d", {"x3d"}, "x3d", is_x3d, false},
    {"amf", {"amf"}, "amf", is_amf, false},
    {"blend", {"blend"}, "blend", is_blend, false},
    {"lwo", {"lwo", "lxo"}, "lwo", is_lwo, false},
    {"x", {"x"}, "x", is_x, false},
    {"ac3d", {"ac", "ac3d", "acc"}, "ac", is_ac3d, false},
    {"ifc", {"ifc"}, "ifc", is_ifc, false},
    {"step", {"step", "stp", "p21"}, "step", is_part21, true},
    {"iges", {"iges", "igs"}, "iges", is_iges, true},
};
enum { FORMATS = sizeof formats / sizeof *formats };

const vxm_external_format *vxm_external_format_by_content(const unsigned char *data, size_t size) {
  for (size_t f = 0; f < FORMATS; f++)
    if (formats[f].sniff && formats[f].sniff(data, size))
      return &formats[f];
  return NULL;
}

const vxm_external_format *vxm_external_format_by_extension(const char *extension) {
  for (size_t f = 0; f < FORMATS; f++)
    for (size_t e = 0; e < VXM_EXTERNAL_EXTENSIONS && formats[f].extensions[e]; e++)
      if (vxm_text_equal_nocase(extension, formats[f].extensions[e]))
        return &formats[f];
  return NULL;
}

const vxm_external_format *vxm_external_format_by_name(const char *name) {
  for (size_t f = 0; f < FORMATS; f++)
    if (vxm_text_equal_nocase(name, formats[f].name))
      return &formats[f];
  return NULL;
}

/* ---- What is not read ---- */

const char *vxm_external_format_refusal(const char *extension) {
  /* Scenes that place the models of other files. */
  static const char *const importing[] = {"lws", "irr", "mot", "scn", "pk3", "bsp", "md3", NULL};
  static const char *const usd[] = {"usd", "usda", "usdc", "usdz", NULL};
  /* Read by Assimp too, and by few others: their readers are not looked after. */
  static const char *const others[] = {"ase", "b3d",     "bvh",  "cob", "csm",     "dxf", "hmp",    "ifczip",
                                       "iqm", "irrmesh", "m3d",  "md2", "md5mesh", "mdc", "mdl",    "ms3d",
                                       "ndo", "nff",     "ogex", "pmx", "q3o",     "q3s", "sib",    "smd",
                                       "ter", "uc",      "vta",  "xgl", "zgl",     "wrl", "assbin", NULL};
  for (const char *const *e = importing; *e; e++)
    if (vxm_text_equal_nocase(extension, *e))
      return "this kind of scene imports other files, and is not read: export it as .glb or .obj";
  for (const char *const *e = usd; *e; e++)
    if (vxm_text_equal_nocase(extension, *e))
      return "USD is not read: export it as .glb or .obj";
  for (const char *const *e = others; *e; e++)
    if (vxm_text_equal_nocase(extension, *e))
      return "this kind of file is not read: export it as .glb or .obj";
  return NULL;
}

/* ---- Reading ---- */

/** Extensions are handed on in lower case, and only if they can be some. */
static bool take_extension(char hint[16], const char *extension) {
  size_t length = strlen(extension);
  if (length == 0 || length >= 16)
    return false;
  for (size_t i = 0; i <= length; i++) {
    char c = extension[i];
    hint[i] = (char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  }
  return strspn(hint, "abcdefghijklmnopqrstuvwxyz0123456789_.") == length;
}

vxm_status vxm_external_format_read(vxm_soup *soup, const vxm_external_format *format, const char *extension,
                                    const vxm_reader_request *file, vxm_references *references,
                                    vxm_error *error) {
  char purpose[48], hint[16];
  vxm_module_need need = {"assimp", "libassimp-dev", purpose};
  vxm_reader_request request = *file;
  request.hint = format->hint;
  if (vxm_external_format_by_extension(extension) == format)
    if (take_extension(hint, extension))
      request.hint = hint;
  snprintf(purpose, sizeof purpose, "reading .%s files", request.hint);
  if (format->is_cad) {
    need.name = "occt";
    need.package = "libocct-data-exchange-dev libocct-modeling-algorithms-dev libocct-ocaf-dev";
  }
  vxm_status status = vxm_reader_process_mesh(soup, &need, &request, references, error);
  soup->format = format->name;
  return status;
}
