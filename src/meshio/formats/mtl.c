/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/formats/mtl.h"
#include "base/number.h"

#include <stdio.h>
#include <string.h>

enum { WORD_MAX = 64, PATH_ROOM = VXM_APPEARANCE_NAME };

typedef struct mtl_reader {
  vxm_appearance *appearance;
  const char *at, *end; /**< of the line */
  const char *folder;   /**< of the file, with its slash */
  size_t folder_length;
  vxm_material *material; /**< that is described; NULL if nobody asked for it */
  bool *is_described;     /**< for each material */
} mtl_reader;

static bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

static void skip_blanks(mtl_reader *reader) {
  while (reader->at < reader->end && is_blank(*reader->at))
    reader->at++;
}

/** The next word of the line, cut where it is long; "" if there is none. */
static void next_word(mtl_reader *reader, char word[WORD_MAX]) {
  size_t length = 0;
  skip_blanks(reader);
  for (; reader->at < reader->end && !is_blank(*reader->at); reader->at++)
    if (length < WORD_MAX - 1)
      word[length++] = *reader->at;
  word[length] = '\0';
}

/** The number at the cursor; if there is none the cursor stays. */
static bool next_number(mtl_reader *reader, double *value) {
  char word[WORD_MAX];
  const char *before = reader->at;
  next_word(reader, word);
  if (word[0] && vxm_number_parse((const unsigned char *)word, strlen(word), value))
    return true;
  reader->at = before;
  return false;
}

/** What is left of the line, without blanks around it. */
static size_t rest(mtl_reader *reader) {
  skip_blanks(reader);
  while (reader->end > reader->at && is_blank(reader->end[-1]))
    reader->end--;
  return (size_t)(reader->end - reader->at);
}

/* ---- Statements ---- */

static void begin_material(mtl_reader *reader) {
  size_t length = rest(reader);
  reader->material = NULL;
  uint32_t m;
  if (!vxm_appearance_find_material(reader->appearance, (const char *)reader->at, length, &m) ||
      reader->is_described[m])
    return;
  reader->is_described[m] = true;
  reader->material = &reader->appearance->materials[m];
}

/** Kd r g b, of which the latter two may be left out; other forms (spectral, xyz) give no colour. */
static void read_color(mtl_reader *reader) {
  double rgb[3];
  if (!next_number(reader, &rgb[0]))
    return;
  rgb[1] = rgb[2] = rgb[0];
  if (next_number(reader, &rgb[1]) && !next_number(reader, &rgb[2]))
    return;
  for (int c = 0; c < 3; c++) {
    double value = rgb[c] > 0 ? rgb[c] < 1 ? rgb[c] : 1 : 0;
    reader->material->color[c] = (float)vxm_srgb_decode(value);
  }
  reader->material->has_color = true;
}

/** Passes over the options before the name of a picture; only -clamp matters. */
static void read_map_options(mtl_reader *reader) {
  static const struct {
    const char *name;
    int words; /**< that follow; below 0: up to so many numbers */
  } options[] = {{"-blendu", 1}, {"-blendv", 1},  {"-boost", 1}, {"-bm", 1},        {"-cc", 1},
                 {"-clamp", 1},  {"-imfchan", 1}, {"-mm", 2},    {"-o", -3},        {"-s", -3},
                 {"-t", -3},     {"-texres", 1},  {"-type", 1},  {"-colorspace", 1}};
  char word[WORD_MAX];
  double number;
  for (;;) {
    skip_blanks(reader);
    const char *before = reader->at;
    next_word(reader, word);
    size_t o = 0;
    while (o < sizeof options / sizeof *options && strcmp(options[o].name, word) != 0)
      o++;
    if (o == sizeof options / sizeof *options) {
      reader->at = before;
      return;
    }
    bool is_clamp = strcmp(word, "-clamp") == 0;
    for (int w = 0; w < options[o].words; w++)
      next_word(reader, word);
    for (int w = 0; w > options[o].words && next_number(reader, &number); w--)
      ;
    if (is_clamp && strcmp(word, "on") == 0)
      reader->material->wrap[0] = reader->material->wrap[1] = VXM_WRAP_CLAMP;
  }
}

static vxm_status read_map(mtl_reader *reader, vxm_error *error) {
  char path[PATH_ROOM];
  read_map_options(reader);
  size_t length = rest(reader), folder = reader->folder_length;
  if (length == 0)
    return VXM_OK;
  for (; length > 2 && reader->at[0] == '.' && reader->at[1] == '/'; length -= 2)
    reader->at += 2;
  if (folder + length >= sizeof path || *reader->at == '/')
    folder = 0;
  memcpy(path, reader->folder, folder);
  if (folder + length >= sizeof path)
    length = sizeof path - 1 - folder;
  memcpy(path + folder, reader->at, length);
  for (size_t i = 0; i < folder + length; i++)
    path[i] = path[i] == '\\' ? '/' : path[i];
  return vxm_appearance_image(reader->appearance, path, folder + length, &reader->material->image, error);
}

static vxm_status read_line(mtl_reader *reader, vxm_error *error) {
  char word[WORD_MAX];
  next_word(reader, word);
  if (strcmp(word, "newmtl") == 0)
    begin_material(reader);
  else if (reader->material && strcmp(word, "Kd") == 0)
    read_color(reader);
  else if (reader->material && strcasecmp(word, "map_Kd") == 0)
    return read_map(reader, error);
  return VXM_OK;
}

vxm_status vxm_mtl_read(vxm_appearance *appearance, const unsigned char *data, size_t size, const char *name,
                        vxm_error *error) {
  const char *slash = strrchr(name, '/'), *at = (const char *)data, *const end = at + size;
  vxm_error local = VXM_ERROR_INIT;
  bool *is_described =
      vxm_calloc(appearance->context, appearance->material_count + 1, sizeof *is_described, &local);
  mtl_reader reader = {.appearance = appearance,
                       .folder = name,
                       .folder_length = slash ? (size_t)(slash + 1 - name) : 0,
                       .is_described = is_described};
  vxm_status status = is_described ? VXM_OK : local.code;
  for (size_t m = 0; is_described && m < appearance->material_count; m++)
    is_described[m] =
        appearance->materials[m].has_color || appearance->materials[m].image != VXM_APPEARANCE_NONE;
  while (at < end && status == VXM_OK) {
    reader.at = at;
    while (at < end && *at != '\n')
      at++;
    reader.end = at;
    status = read_line(&reader, &local);
    at += at < end;
  }
  vxm_free(appearance->context, is_described);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
