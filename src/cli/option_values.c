/* SPDX-License-Identifier: BSD-3-Clause */
/** The values of options: texts become numbers and choices. */
#include "cli/cli.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const cli_axes[] = {"x", "y", "z", NULL};
const char *const cli_external_files[] = {"folder", "any", "none", NULL}; /* as vxm_external */
const char *const cli_polygon_kinds[] = {"split", "keep", NULL};

/* ---- Texts ---- */

bool cli_read_integer(int64_t *out, const char *text, int64_t low, int64_t high) {
  if (!*text || strspn(text, "0123456789") != strlen(text))
    return false;
  errno = 0;
  long long value = strtoll(text, NULL, 10);
  if (errno || value < low || value > high)
    return false;
  *out = value;
  return true;
}

/** As strtod, which the program uses in the C locale only, without hexadecimal, infinities and blanks. */
static const char *read_number(double *out, const char *text) {
  size_t length = strspn(text, "0123456789+-.eE");
  char *end;
  *out = strtod(text, &end);
  return length > 0 && end == text + length && isfinite(*out) ? end : NULL;
}

bool cli_read_number(double *out, const char *text) {
  const char *end = read_number(out, text);
  return end && !*end;
}

bool cli_read_numbers(double *out, int count, const char *text) {
  for (int i = 0; i < count; i++) {
    text = read_number(&out[i], text);
    if (!text || *text != (i + 1 < count ? ',' : '\0'))
      return false;
    text++;
  }
  return true;
}

bool cli_read_size(uint64_t *out, const char *text) {
  static const char suffixes[] = "KMGT";
  size_t digits = strspn(text, "0123456789");
  char number[24];
  if (digits == 0 || digits >= sizeof number)
    return false;
  memcpy(number, text, digits);
  number[digits] = '\0';
  int64_t value;
  if (!cli_read_integer(&value, number, 1, INT64_MAX))
    return false;
  text += digits;
  unsigned shift = 0;
  if (*text) {
    char letter = (char)(*text >= 'a' && *text <= 'z' ? *text - 'a' + 'A' : *text);
    const char *found = strchr(suffixes, letter);
    if (!found || text[1])
      return false;
    shift = 10 * (unsigned)(found - suffixes + 1);
  }
  if (value > INT64_MAX >> shift)
    return false;
  *out = (uint64_t)value << shift;
  return true;
}

int cli_read_choice(const char *text, const char *const *choices) {
  for (int i = 0; choices[i]; i++)
    if (strcmp(text, choices[i]) == 0)
      return i;
  return -1;
}

const char *cli_list(char list[CLI_LIST_MAX], const char *const *choices) {
  list[0] = '\0';
  for (size_t i = 0, used = 0; choices[i] && used < CLI_LIST_MAX; i++)
    used += (size_t)snprintf(list + used, CLI_LIST_MAX - used, "%s%s", i > 0 ? ", " : "", choices[i]);
  return list;
}

int cli_choose(cli_run *cli, int *choice, const char *option, const char *value, const char *const *choices) {
  char list[CLI_LIST_MAX];
  int found = cli_read_choice(value, choices);
  if (found < 0)
    return cli_usage(cli, "--%s '%s' is none of %s", option, value, cli_list(list, choices));
  *choice = found;
  return CLI_END;
}

/* ---- Options ---- */

int cli_take_flag(cli_run *cli, const cli_option *option, const char *value, void *member) {
  (void)cli, (void)option, (void)value;
  *(bool *)member = true;
  return CLI_END;
}

int cli_take_text(cli_run *cli, const cli_option *option, const char *value, void *member) {
  (void)cli, (void)option;
  *(const char **)member = value;
  return CLI_END;
}

/** Into a whole number, an enumeration or a bool. */
static void store(void *member, size_t size, int64_t value) {
  if (size == sizeof(int64_t))
    *(int64_t *)member = value;
  else if (size == sizeof(int32_t))
    *(uint32_t *)member = (uint32_t)value;
  else
    *(bool *)member = value != 0;
}

int cli_take_choice(cli_run *cli, const cli_option *option, const char *value, void *member) {
  int choice = 0;
  if (cli_choose(cli, &choice, option->name, value, option->to.choices) == CLI_STOP)
    return CLI_STOP;
  store(member, option->to.size, option->to.min + choice);
  return CLI_END;
}

int cli_take_number(cli_run *cli, const cli_option *option, const char *value, void *member) {
  const cli_target *to = &option->to;
  int64_t number;
  if (!cli_read_integer(&number, value, to->min, to->max))
    return cli_usage(cli, "--%s '%s' is not a number from %lld to %lld", option->name, value,
                     (long long)to->min, (long long)to->max);
  store(member, to->size, number);
  return CLI_END;
}

int cli_take_real(cli_run *cli, const cli_option *option, const char *value, void *member) {
  const cli_target *to = &option->to;
  double number;
  if (!cli_read_number(&number, value) || number < to->low || number > to->high)
    return cli_usage(cli, "--%s '%s' is not %s", option->name, value, to->what);
  *(double *)member = number;
  return CLI_END;
}

int cli_take_size(cli_run *cli, const cli_option *option, const char *value, void *member) {
  if (cli_read_size(member, value))
    return CLI_END;
  return cli_usage(cli, "--%s '%s' is not a size such as 512M or 4G", option->name, value);
}
