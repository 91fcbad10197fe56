/* SPDX-License-Identifier: BSD-3-Clause */
/** Reads the path of a tool: a pose in each line. */
#include "cli/toolpath.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <strings.h>

enum { LINE_SIZE = 4096, MATRIX = 12, QUATERNION = 7, PLACE = 3 };

int cli_toolpath_open(cli_run *cli, cli_toolpath *toolpath, const char *path) {
  *toolpath = (cli_toolpath){.name = cli_shown(path, "<stdin>")};
  toolpath->file = strcmp(path, "-") == 0 ? stdin : fopen(path, "re");
  if (!toolpath->file)
    return cli_fail_text(cli, "%s: cannot open: %s", path, strerror(errno));
  return CLI_DONE;
}

void cli_toolpath_close(cli_toolpath *toolpath) {
  if (toolpath->file && toolpath->file != stdin)
    fclose(toolpath->file);
  toolpath->file = NULL;
}

static bool is_blank(char c) {
  return isspace((unsigned char)c) != 0;
}

/** Removes blanks beside commas and at both ends, so that "1, 2" is what "1,2" is, and "1 2" is no number. */
static void squeeze(char *text) {
  char *to = text;
  for (const char *from = text; *from; from++) {
    const char *next = from;
    while (is_blank(*next))
      next++;
    if (next == from)
      *to++ = *from;
    else if (to > text && to[-1] != ',' && *next && *next != ',')
      *to++ = ' ';
    from = next > from ? next - 1 : from;
  }
  *to = '\0';
}

static int columns_of(const char *text) {
  int count = 1;
  for (; *text; text++)
    count += *text == ',';
  return count;
}

/** A rotation as w,x,y,z, of any length, as a matrix. */
static bool turn(double pose[12], const double q[4]) {
  double n = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], s = 2 / n;
  if (!(n > 0) || !isfinite(n) || !isfinite(s))
    return false;
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3, c = (a + 2) % 3;
    double x = q[1 + a], y = q[1 + b], z = q[1 + c];
    pose[4 * a + a] = 1 - s * (y * y + z * z);
    pose[4 * a + b] = s * (x * y - q[0] * z);
    pose[4 * a + c] = s * (x * z + q[0] * y);
  }
  return true;
}

static bool make_pose(double pose[12], const double *numbers, int columns) {
  if (columns == MATRIX) {
    memcpy(pose, numbers, MATRIX * sizeof *pose);
    return true;
  }
  const double straight[4] = {1, 0, 0, 0};
  for (int a = 0; a < 3; a++)
    pose[4 * a + 3] = numbers[a];
  return turn(pose, columns == QUATERNION ? numbers + PLACE : straight);
}

/** Whether a field is a word, and no damaged number. */
static bool is_word(const char *text) {
  return isalpha((unsigned char)*text) && strncasecmp(text, "nan", 3) != 0 &&
         strncasecmp(text, "inf", 3) != 0;
}

/** Whether all columns have names: of a line with numbers one may be damaged. */
static bool is_heading_line(const char *text) {
  for (const char *field = text; field; field = strchr(field, ',')) {
    field += *field == ',';
    if (!is_word(field))
      return false;
  }
  return true;
}

/** Reads a line that is not empty; a first one of words is a heading. */
static int read_pose(cli_run *cli, cli_toolpath *toolpath, const char *text, double pose[12],
                     bool *is_heading) {
  double numbers[MATRIX];
  *is_heading = toolpath->columns == 0 && !toolpath->has_heading && is_heading_line(text);
  toolpath->has_heading |= *is_heading;
  int columns = columns_of(text);
  if (columns != MATRIX && columns != QUATERNION && columns != PLACE)
    return cli_fail_text(cli,
                         "%s:%" PRId64 ": %d columns: x,y,z are expected, x,y,z,qw,qx,qy,qz or the 12 "
                         "numbers of a matrix",
                         toolpath->name, toolpath->line, columns);
  if (*is_heading)
    return CLI_DONE;
  if (toolpath->columns != 0 && toolpath->columns != columns)
    return cli_fail_text(cli, "%s:%" PRId64 ": %d columns, and %d before", toolpath->name, toolpath->line,
                         columns, toolpath->columns);
  if (!cli_read_numbers(numbers, columns, text))
    return cli_fail_text(cli, "%s:%" PRId64 ": not %d numbers with commas between them", toolpath->name,
                         toolpath->line, columns);
  if (!make_pose(pose, numbers, columns))
    return cli_fail_text(cli, "%s:%" PRId64 ": the quaternion is no rotation", toolpath->name,
                         toolpath->line);
  toolpath->columns = columns;
  return CLI_DONE;
}

int cli_toolpath_next(cli_run *cli, cli_toolpath *toolpath, double pose[12], bool *is_lifted, bool *is_end) {
  char text[LINE_SIZE];
  *is_lifted = *is_end = false;
  while (fgets(text, sizeof text, toolpath->file)) {
    toolpath->line++;
    if (!strchr(text, '\n') && !feof(toolpath->file))
      return cli_fail_text(cli, "%s:%" PRId64 ": longer than %d bytes", toolpath->name, toolpath->line,
                           LINE_SIZE - 2);
    if (toolpath->line == 1 &&
        strncmp(text, "\xef\xbb\xbf", 3) == 0) /* which spreadsheets put before UTF-8 */
      memmove(text, text + 3, strlen(text + 3) + 1);
    squeeze(text);
    *is_lifted |= !*text;
    if (!*text || *text == '#')
      continue;
    bool is_heading;
    int status = read_pose(cli, toolpath, text, pose, &is_heading);
    if (status != CLI_DONE || !is_heading)
      return status;
  }
  if (ferror(toolpath->file))
    return cli_fail_text(cli, "%s: cannot read: %s", toolpath->name, strerror(errno));
  *is_end = true;
  return CLI_DONE;
}
