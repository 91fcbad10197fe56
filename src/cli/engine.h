/* SPDX-License-Identifier: BSD-3-Clause */
/** Who makes the voxels: --engine and the options of its devices. */
#ifndef VXM_CLI_ENGINE_H
#define VXM_CLI_ENGINE_H

#include "cli/cli.h"

/** The words for --cl-method and --gl-method, in the order of their enums; NULL ends each list. */
extern const char *const cli_cl_methods[], *const cli_gl_methods[];

typedef struct cli_engine {
  const char *name; /**< NULL = not given */
  vxm_engine_options options;
  vxm_engine *engine; /**< made by cli_engine_open; NULL = the CPU, as nothing was asked for */
} cli_engine;

#define CLI_ENGINE_INIT \
  { NULL, VXM_ENGINE_OPTIONS_INIT, NULL }

/** Of --gl-displace, into vxm_engine_options. */
cli_reader cli_take_displacement;
/** CLI_STOP if the options contradict each other. */
int cli_engine_check(cli_run *cli, const cli_engine *engine);
/** Makes the engine, if one was named; a failure is in cli->error. */
vxm_status cli_engine_open(cli_run *cli, cli_engine *engine);
/** The row, and the object of the report; only where one was named. */
void cli_engine_summarize(const cli_run *cli, const cli_engine *engine);
json_t *cli_engine_json(const cli_engine *engine);
/** Warns of devices that failed while others went on. */
void cli_engine_warn(cli_run *cli, const cli_engine *engine);

#endif
