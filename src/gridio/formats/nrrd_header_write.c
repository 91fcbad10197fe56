/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/number.h"
#include "gridio/formats/nrrd_header.h"

#include <inttypes.h>

/** Writes a form in which stars stand for the numbers, which read back bit for bit, whatever the locale. */
static void write_numbers(vxm_output *output, const char *form, const double *values) {
  for (; *form; form++)
    if (*form == '*') {
      char number[VXM_NUMBER_ROOM];
      vxm_output_write(output, number, vxm_number_write(number, *values++));
    } else
      vxm_output_write(output, form, 1);
}

static const char *type_name(vxm_scalar scalar) {
  switch (scalar) {
  case VXM_UINT8:
    return "uchar";
  case VXM_INT8:
    return "signed char";
  case VXM_UINT16:
    return "ushort";
  case VXM_INT16:
    return "short";
  case VXM_UINT32:
    return "uint";
  case VXM_INT32:
    return "int";
  case VXM_UINT64:
    return "ulonglong";
  case VXM_INT64:
    return "longlong";
  case VXM_FLOAT64:
    return "double";
  default:
    return "float";
  }
}

/** Writes a text that stays in its line; in keys ':' would end them. */
static void write_text(vxm_output *output, const char *word, bool is_key) {
  for (; *word; word++)
    if ((unsigned char)*word < 0x20 || *word == 0x7f)
      vxm_output_write(output, *word == '\n' && !is_key ? "\\n" : " ", *word == '\n' && !is_key ? 2 : 1);
    else
      vxm_output_write(output, is_key && *word == ':' ? "_" : word, 1);
}

static void write_pair(vxm_output *output, const char *key, const char *value) {
  write_text(output, key, true);
  vxm_output_write(output, ":=", 2);
  write_text(output, value, false);
  vxm_output_write(output, "\n", 1);
}

static const char *pair_of(const vxm_nrrd_values *values, const char *key) {
  return values->about ? vxm_metadata_find(&values->about->pairs, key) : NULL;
}

/** The name of the space, where one is carried along, or else how many dimensions it has. */
static void write_space_name(vxm_output *output, const vxm_nrrd_values *values) {
  const char *name = pair_of(values, vxm_nrrd_carried_fields[0].key);
  if (!name) {
    vxm_output_printf(output, "space dimension: 3\n");
    return;
  }
  vxm_output_printf(output, "space: ");
  write_text(output, name, false);
  vxm_output_printf(output, "\n");
}

/** What was carried along. */
static void write_about(vxm_output *output, const vxm_nrrd_values *values) {
  const vxm_about *about = values->about;
  if (!about)
    return;
  for (int c = 1; c < VXM_NRRD_CARRIED; c++) {
    const char *value = pair_of(values, vxm_nrrd_carried_fields[c].key);
    if (!value)
      continue;
    vxm_output_printf(output, "%s: ", vxm_nrrd_carried_fields[c].field);
    write_text(output, value, false);
    vxm_output_printf(output, "\n");
  }
  if (about->is_declared)
    write_pair(output, VXM_NRRD_VALUES_KEY, vxm_field_kind_name(about->kind));
  for (const char *key = NULL; (key = vxm_metadata_next(&about->pairs, key)) != NULL;) {
    int c = 0;
    while (c < VXM_NRRD_CARRIED && strcmp(vxm_nrrd_carried_fields[c].key, key) != 0)
      c++;
    if (c == VXM_NRRD_CARRIED)
      write_pair(output, key, vxm_metadata_value(key));
  }
}

void vxm_nrrd_header_write(vxm_output *output, const vxm_nrrd_values *values, const vxm_space *space) {
  const int64_t *dims = space->dims;
  bool is_color = values->channels == 4;
  double first[3];
  for (int a = 0; a < 3; a++)
    first[a] = space->origin[a] + space->voxel_size[a] / 2;
  vxm_output_printf(output, "NRRD0004\n# %s\ntype: %s\ndimension: %d\n", values->what,
                    type_name(values->scalar), is_color ? 4 : 3);
  write_space_name(output, values);
  vxm_output_printf(output, "sizes: %s%" PRId64 " %" PRId64 " %" PRId64 "\n", is_color ? "4 " : "", dims[0],
                    dims[1], dims[2]);
  vxm_output_printf(output, "space directions: %s", is_color ? "none " : "");
  write_numbers(output, "(*,0,0) (0,*,0) (0,0,*)\n", space->voxel_size);
  vxm_output_printf(output, "kinds: %sdomain domain domain\ncenterings: %scell cell cell\n",
                    is_color ? "RGBA-color " : "", is_color ? "none " : "");
  if (vxm_scalar_bytes(values->scalar) > 1)
    vxm_output_printf(output, "endian: little\n");
  vxm_output_printf(output, "encoding: raw\n");
  write_numbers(output, "space origin: (*,*,*)\n", first);
  vxm_output_printf(output, "%s:=", VXM_NRRD_ORIGIN_KEY);
  write_numbers(output, "* * *\n", space->origin);
  write_about(output, values);
  vxm_output_write(output, "\n", 1);
}
