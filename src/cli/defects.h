/* SPDX-License-Identifier: BSD-3-Clause */
/** What is wrong with a mesh, in counts, in a sentence and place by place. */
#ifndef VXM_CLI_DEFECTS_H
#define VXM_CLI_DEFECTS_H

#include "cli/cli.h"

/* ---- census.c: the counts ---- */

/** A volume, or that it is beyond the range of numbers; "-" where nothing is enclosed that could have one. */
const char *cli_volume_text(char text[24], int digits, bool closed, double value);

/** A row for each count, with what it means where it is not zero. */
void cli_census_print(const cli_run *cli, const vxm_census *census);
/** A number of self-intersections, which is "at least" one where they were not counted to the end. */
const char *cli_intersections_text(char text[32], int64_t count);
/** Adds "self_intersections", and where they were not counted to the end "self_intersections_at_least": true;
 * nothing if they were not looked for (-1). */
void cli_intersections_json(json_t *object, int64_t count);
/** A row for self-intersections; nothing if they were not looked for (-1). */
void cli_census_print_intersections(const cli_run *cli, int64_t count);
/** Both in one table, "Original" and "Final". */
void cli_census_print_both(const cli_run *cli, const vxm_census *before, const vxm_census *after);
/** Adds the census's keys to an object. */
void cli_census_json(json_t *object, const vxm_census *census);

/* ---- verdict.c ---- */

enum { CLI_SENTENCE = 256 };

/** What has to be closed, as repair --level closed sees it. */
typedef struct cli_openings {
  bool known;
  bool empty; /**< no face is left */
  int64_t sheets, holes;
} cli_openings;

/**
 * What is wrong with a mesh in a sentence, and which command mends it.
 *
 * @param intersections pairs of faces that cut through each other; -1 = not looked for
 */
const char *cli_verdict(char text[CLI_SENTENCE], const vxm_census *census, const cli_openings *openings,
                        int64_t intersections);

/* ---- defects.c: where, for info and repair ---- */

enum { CLI_LISTED_MAX = 1000000 };

typedef struct cli_defects {
  const char *locate; /**< .ply to show them in, or NULL */
  int64_t list;       /**< list so many of each kind in the report, up to CLI_LISTED_MAX; 0 = none */
  bool intersections; /**< self-intersections too */
} cli_defects;

typedef struct cli_found {
  json_t *list;          /**< NULL = not wanted */
  int64_t intersections; /**< pairs of faces; -1 = not looked for */
} cli_found;

/** CLI_STOP if --locate has a wrong name. */
int cli_defects_check(cli_run *cli, const cli_defects *defects);
/** CLI_STOP if --locate would replace a file. */
int cli_defects_check_file(cli_run *cli, const cli_defects *defects);
/** Prints the list that cli_defects_show has made; NULL = none. */
void cli_defects_print(const cli_run *cli, const json_t *list);
/** Finds, lists, counts and draws the defects of a mesh; CLI_DONE or CLI_FAILED. */
int cli_defects_show(cli_run *cli, cli_found *out, const cli_defects *wanted, const vxm_mesh *mesh);

#endif
