/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/nrrd_header.h"
#include "base/number.h"
#include "gridio/common/format.h"

#include <math.h>
#include <strings.h>

bool vxm_nrrd_sniff(const vxm_input *input) {
  return input->size >= 8 && memcmp(input->data, "NRRD000", 7) == 0 && input->data[7] >= '1' &&
         input->data[7] <= '5';
}

/* ---- Words of a line ---- */

/** A piece of the header. */
typedef struct text {
  const unsigned char *at, *end;
} text;

static bool is_blank(unsigned char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

static void trim(text *t) {
  while (t->at < t->end && is_blank(*t->at))
    t->at++;
  while (t->at < t->end && is_blank(t->end[-1]))
    t->end--;
}

/** The next word up to a blank or one of `stops`, which is not taken; false if there is none. */
static bool next_word(text *line, text *word, const char *stops) {
  trim(line);
  word->at = word->end = line->at;
  while (word->end < line->end && !is_blank(*word->end) && !strchr(stops, *word->end))
    word->end++;
  line->at = word->end;
  return word->end > word->at;
}

static bool equals(text t, const char *word) {
  size_t length = strlen(word);
  return (size_t)(t.end - t.at) == length && strncasecmp((const char *)t.at, word, length) == 0;
}

static bool accept(text *line, char c) {
  trim(line);
  if (line->at == line->end || *line->at != (unsigned char)c)
    return false;
  line->at++;
  return true;
}

/* ---- What the lines say ---- */

typedef struct fields {
  const vxm_input *input;
  vxm_error *error;
  vxm_nrrd_header *header;
  size_t line; /**< offset of the line at hand */
  bool has_type, has_dimension, has_sizes, has_encoding, has_endian, has_spacings, has_directions, has_origin,
      has_mins, has_maxs, has_corner;
  double spacings[3], directions[3], first[3], mins[3], maxs[3], corner[3];
  bool has_kinds, is_color; /**< the kinds are given, and the first axis is one of colours */
  bool at_nodes[3];         /**< samples lie at the ends of the axis, not in the middle of cells */
} fields;

static vxm_status fail(const fields *f, const char *what) {
  return vxm_fail_byte(f->error, f->input, f->line, "nrrd header: %s", what);
}

static bool read_number(text *line, const char *stops, double *value) {
  text word;
  return next_word(line, &word, stops) && vxm_number_parse(word.at, (size_t)(word.end - word.at), value);
}

/** Goes behind what is said of the axis of colours, where there is one. */
static void skip_color(const fields *f, text *line) {
  text word;
  if (f->header->channels == 4)
    next_word(line, &word, "");
}

/** Three numbers and nothing else. */
static bool read_three(text line, double values[3]) {
  for (int a = 0; a < 3; a++)
    if (!read_number(&line, "", &values[a]))
      return false;
  trim(&line);
  return line.at == line.end;
}

/** "(1,2,3)" */
static bool read_vector(text *line, double values[3]) {
  for (int a = 0; a < 3; a++)
    if (!accept(line, a == 0 ? '(' : ',') || !read_number(line, ",)", &values[a]))
      return false;
  return accept(line, ')');
}

static vxm_status read_type(fields *f, text line) {
  static const struct {
    const char *names[5];
    char kind;
    size_t size;
  } types[] = {
      {{"uchar", "unsigned char", "uint8", "uint8_t"}, 'u', 1},
      {{"signed char", "int8", "int8_t"}, 'i', 1},
      {{"short", "short int", "signed short", "int16", "int16_t"}, 'i', 2},
      {{"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"}, 'u', 2},
      {{"int", "signed int", "int32", "int32_t"}, 'i', 4},
      {{"uint", "unsigned int", "uint32", "uint32_t"}, 'u', 4},
      {{"longlong", "long long", "long long int", "int64", "int64_t"}, 'i', 8},
      {{"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"}, 'u', 8},
      {{"float"}, 'f', 4},
      {{"double"}, 'f', 8},
  };
  for (size_t t = 0; t < sizeof types / sizeof types[0]; t++)
    for (int n = 0; n < 5 && types[t].names[n]; n++)
      if (equals(line, types[t].names[n])) {
        f->header->kind = types[t].kind;
        f->header->size = types[t].size;
        return VXM_OK;
      }
  return fail(f, "the type must be an integer of 8 to 64 bits, float or double");
}

static const char dimensions[] = "a grid has three dimensions, and colours (of kind RGBA-color) a fourth";

static vxm_status read_dimension(fields *f, text line) {
  f->header->channels = equals(line, "4") ? 4 : 1;
  return f->header->channels == 4 || equals(line, "3") ? VXM_OK : fail(f, dimensions);
}

static vxm_status read_kinds(fields *f, text line) {
  text word;
  f->is_color = next_word(&line, &word, "") && (equals(word, "RGBA-color") || equals(word, "4-color"));
  return VXM_OK;
}

static vxm_status read_sizes(fields *f, text line) {
  double sizes[3];
  f->header->sizes_offset = f->line;
  text colors = line, word;
  if (f->header->channels == 4 && !(next_word(&colors, &word, "") && equals(word, "4")))
    return fail(f, dimensions);
  skip_color(f, &line);
  if (!read_three(line, sizes))
    return fail(f, "the sizes must be three whole numbers");
  for (int a = 0; a < 3; a++) {
    if (!(fabs(sizes[a]) < 0x1p53) || sizes[a] != trunc(sizes[a]))
      return fail(f, "the sizes must be three whole numbers");
    f->header->space.dims[a] = (int64_t)sizes[a];
  }
  return VXM_OK;
}

static vxm_status read_encoding(fields *f, text line) {
  f->header->gzip = equals(line, "gzip") || equals(line, "gz");
  if (f->header->gzip || equals(line, "raw"))
    return VXM_OK;
  return fail(f, "the encoding must be raw or gzip");
}

static vxm_status read_endian(fields *f, text line) {
  f->header->big_endian = equals(line, "big");
  return f->header->big_endian || equals(line, "little") ? VXM_OK : fail(f, "endian must be little or big");
}

static vxm_status read_spacings(fields *f, text line) {
  skip_color(f, &line);
  return read_three(line, f->spacings) ? VXM_OK : fail(f, "the spacings must be three numbers");
}

static vxm_status read_mins(fields *f, text line) {
  skip_color(f, &line);
  return read_three(line, f->mins) ? VXM_OK : fail(f, "the axis mins must be three numbers");
}

static vxm_status read_maxs(fields *f, text line) {
  skip_color(f, &line);
  return read_three(line, f->maxs) ? VXM_OK : fail(f, "the axis maxs must be three numbers");
}

static vxm_status read_centerings(fields *f, text line) {
  text word;
  skip_color(f, &line);
  for (int a = 0; a < 3 && next_word(&line, &word, ""); a++)
    f->at_nodes[a] = equals(word, "node");
  return VXM_OK;
}

/** Axes that are turned, swapped or mirrored are not those of a grid. */
static vxm_status read_directions(fields *f, text line) {
  skip_color(f, &line);
  for (int a = 0; a < 3; a++) {
    double v[3];
    if (!read_vector(&line, v))
      return fail(f, "the space directions must be three vectors like (1,0,0)");
    if (v[(a + 1) % 3] != 0 || v[(a + 2) % 3] != 0 || !(v[a] > 0))
      return fail(f, "the axes are turned, swapped or mirrored; only axes along x, y and z can be read");
    f->directions[a] = v[a];
  }
  return VXM_OK;
}

static vxm_status read_origin(fields *f, text line) {
  return read_vector(&line, f->first) ? VXM_OK : fail(f, "the space origin must be a vector like (0,0,0)");
}

static vxm_status read_skip(fields *f, text line) {
  return equals(line, "0") ? VXM_OK
                           : fail(f, "lines or bytes to be skipped before the values: not supported");
}

static vxm_status read_detached(fields *f, text line) {
  (void)line;
  return fail(f, "the values are in another file; only files that hold both can be read");
}

const vxm_nrrd_carried vxm_nrrd_carried_fields[VXM_NRRD_CARRIED] = {
    {"space", "nrrd_space"}, {"space units", "nrrd_space_units"}, {"content", "nrrd_content"}};

static void carry(fields *f, const char *key, text value) {
  vxm_metadata_add(&f->header->about.pairs, f->input->context, key, strlen(key), (const char *)value.at,
                   (size_t)(value.end - value.at));
}

/** Reads a field of the header; those not named here do not matter for a grid. */
static vxm_status read_field(fields *f, text name, text value) {
  const struct {
    const char *names[2];
    vxm_status (*read)(fields *f, text line);
    bool *seen; /**< set, and an error if it was: NULL = may be repeated */
  } known[] = {{{"type", NULL}, read_type, &f->has_type},
               {{"dimension", NULL}, read_dimension, &f->has_dimension},
               {{"sizes", NULL}, read_sizes, &f->has_sizes},
               {{"encoding", NULL}, read_encoding, &f->has_encoding},
               {{"endian", NULL}, read_endian, &f->has_endian},
               {{"spacings", NULL}, read_spacings, &f->has_spacings},
               {{"space directions", NULL}, read_directions, &f->has_directions},
               {{"space origin", NULL}, read_origin, &f->has_origin},
               {{"axis mins", "axismins"}, read_mins, &f->has_mins},
               {{"axis maxs", "axismaxs"}, read_maxs, &f->has_maxs},
               {{"kinds", NULL}, read_kinds, &f->has_kinds},
               {{"centerings", "centers"}, read_centerings, NULL},
               {{"line skip", "lineskip"}, read_skip, NULL},
               {{"byte skip", "byteskip"}, read_skip, NULL},
               {{"data file", "datafile"}, read_detached, NULL}};
  for (size_t k = 0; k < sizeof known / sizeof known[0]; k++)
    if (equals(name, known[k].names[0]) || (known[k].names[1] && equals(name, known[k].names[1]))) {
      if (known[k].seen && *known[k].seen)
        return fail(f, "a field is repeated");
      if (known[k].seen)
        *known[k].seen = true;
      return known[k].read(f, value);
    }
  for (int c = 0; c < VXM_NRRD_CARRIED; c++)
    if (equals(name, vxm_nrrd_carried_fields[c].field))
      carry(f, vxm_nrrd_carried_fields[c].key, value);
  return VXM_OK;
}

static vxm_status read_pair(fields *f, text name, text value) {
  vxm_about *about = &f->header->about;
  char kind[16];
  size_t length = (size_t)(value.end - value.at);
  if (equals(name, VXM_NRRD_ORIGIN_KEY))
    f->has_corner = read_three(value, f->corner);
  else if (equals(name, VXM_NRRD_VALUES_KEY) && length < sizeof kind) {
    memcpy(kind, value.at, length);
    kind[length] = '\0';
    vxm_about_name(about, kind);
  } else
    vxm_metadata_add(&about->pairs, f->input->context, (const char *)name.at, (size_t)(name.end - name.at),
                     (const char *)value.at, length);
  return VXM_OK;
}

static vxm_status read_line(fields *f, text line) {
  trim(&line);
  if (line.at < line.end && *line.at == '#')
    return VXM_OK;
  text name = {line.at, memchr(line.at, ':', (size_t)(line.end - line.at))};
  if (!name.end)
    return fail(f, "a line is neither a comment nor \"field: value\" nor \"key:=value\"");
  text value = {name.end + 1, line.end};
  bool is_key = value.at < value.end && *value.at == '=';
  value.at += is_key;
  trim(&name);
  trim(&value);
  if (!is_key)
    return read_field(f, name, value);
  return read_pair(f, name, value);
}

/* ---- The transform ---- */

/** The origin of an NRRD file is the centre of its first sample; the ends of an axis are those of its cells,
 * or the first and last samples. */
static void find_axis(const fields *f, vxm_space *space, int a) {
  double cells = (double)(space->dims[a] - f->at_nodes[a]), size = 1;
  if (f->has_directions)
    size = f->directions[a];
  else if (f->has_spacings)
    size = f->spacings[a];
  else if (f->has_mins && f->has_maxs && cells > 0)
    size = (f->maxs[a] - f->mins[a]) / cells;
  space->voxel_size[a] = size;
  if (f->has_directions && f->has_origin)
    space->origin[a] = f->first[a] - size / 2;
  else if (f->has_mins && !f->has_directions)
    space->origin[a] = f->mins[a] - (f->at_nodes[a] ? size / 2 : 0);
  else
    space->origin[a] = 0;
}

/** The minimum corner, where the file says it bit for bit and nobody has moved the grid since. */
static void restore_corner(const fields *f, vxm_space *space) {
  for (int a = 0; a < 3; a++)
    if (!(f->corner[a] + space->voxel_size[a] / 2 == f->first[a]))
      return;
  memcpy(space->origin, f->corner, sizeof f->corner);
}

static void find_space(const fields *f, vxm_warnings *warnings) {
  vxm_space *space = &f->header->space;
  for (int a = 0; a < 3; a++)
    find_axis(f, space, a);
  if (f->has_corner && f->has_origin)
    restore_corner(f, space);
  if (!f->has_directions && !f->has_spacings && !(f->has_mins && f->has_maxs))
    vxm_warn(warnings, "the header has no voxel size: 1 is taken");
  if (!(f->has_directions ? f->has_origin : f->has_mins))
    vxm_warn(warnings, "the header has no origin: 0 0 0 is taken");
}

/* ---- The whole ---- */

static vxm_status check_fields(const fields *f) {
  if (!f->has_type || !f->has_dimension || !f->has_sizes || !f->has_encoding)
    return fail(f, "type, dimension, sizes and encoding are needed");
  if (f->header->size > 1 && !f->has_endian)
    return fail(f, "endian is needed for values longer than a byte");
  if (f->header->channels == 4 && (!f->is_color || f->header->kind != 'u' || f->header->size != 1))
    return fail(f, dimensions);
  return VXM_OK;
}

static vxm_status read_lines(fields *f) {
  const vxm_input *input = f->input;
  for (size_t at = 0, line = 0;; line++) {
    f->line = at;
    const unsigned char *begin = input->data + at, *end = memchr(begin, '\n', input->size - at);
    if (!end)
      return vxm_fail_byte(f->error, input, input->size, "nrrd header: it does not end with an empty line");
    at = (size_t)(end - input->data) + 1;
    if (line == 0)
      continue;
    if (end == begin || (end == begin + 1 && *begin == '\r')) {
      f->header->data = at;
      return check_fields(f);
    }
    vxm_status status = read_line(f, (text){begin, end});
    if (status != VXM_OK)
      return status;
  }
}

vxm_status vxm_nrrd_header_read(vxm_nrrd_header *out, const vxm_input *input, vxm_warnings *warnings,
                                vxm_error *error) {
  *out = (vxm_nrrd_header){.channels = 1};
  if (!vxm_nrrd_sniff(input))
    return vxm_fail_byte(error, input, 0, "not a nrrd file: it does not begin with \"NRRD000\"");
  fields f = {.input = input, .error = error, .header = out};
  vxm_status status = read_lines(&f);
  if (status == VXM_OK)
    find_space(&f, warnings);
  return status;
}
