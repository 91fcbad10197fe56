/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend engines: what can make voxels on this machine, and what reads foreign formats. */
#include "cli/cli.h"

#include <inttypes.h>

enum { ENGINES_MAX = 80 };

static const cli_option known_options[] = {CLI_OPTIONS_END};

static void add_opencl(json_t *object, const vxm_engine_info *info) {
  json_object_set_new(object, "platform", cli_json_text(info->platform));
  json_object_set_new(object, "driver", cli_json_text(info->driver));
  json_object_set_new(object, "compute_units", json_integer(info->compute_units));
  json_object_set_new(object, "global_bytes", json_integer(info->global_bytes));
  json_object_set_new(object, "local_bytes", json_integer(info->local_bytes));
  json_object_set_new(object, "work_group", json_integer(info->work_group));
  json_object_set_new(object, "int64_atomics", json_boolean(info->int64_atomics));
  json_object_set_new(object, "kind", json_string(info->kind));
  json_object_set_new(object, "clock_mhz", json_integer(info->clock_mhz));
  json_object_set_new(object, "cache_bytes", json_integer(info->cache_bytes));
  json_object_set_new(object, "shares_memory", json_boolean(info->shares_memory));
}

static json_t *engine_json(const vxm_engine_info *info) {
  json_t *object = json_object();
  json_object_set_new(object, "name", json_string(info->name));
  json_object_set_new(object, "available", json_boolean(info->available));
  if (*info->renderer) {
    json_object_set_new(object, "hardware", json_boolean(info->hardware));
    json_object_set_new(object, "renderer", cli_json_text(info->renderer));
    json_object_set_new(object, "version", cli_json_text(info->version));
    json_object_set_new(object, "block_bytes", json_integer(info->block_bytes));
    json_object_set_new(object, "moves", json_boolean(info->moves));
  }
  if (*info->platform)
    add_opencl(object, info);
  else if (*info->renderer) {
    json_object_set_new(object, "viewport", json_integer(info->viewport));
    json_object_set_new(object, "layers", json_integer(info->layers));
    json_object_set_new(object, "subpixel_bits", json_integer(info->subpixel_bits));
    json_object_set_new(object, "int64", json_boolean(info->int64));
    json_object_set_new(object, "xor_test", json_string(info->attachment));
  }
  if (*info->note)
    json_object_set_new(object, "note", cli_json_text(info->note));
  return object;
}

static void print_engine(const cli_run *cli, const vxm_engine_info *info) {
  fprintf(cli->text, "%-24s %s%s\n", info->name, info->available ? "works" : "not here: ", info->note);
  if (!info->available || !*info->renderer)
    return;
  bool is_opencl = *info->platform != '\0';
  if (is_opencl)
    fprintf(cli->text, "  platform               %s, driver %s\n", info->platform, info->driver);
  fprintf(cli->text, "  %-22s %s%s\n", is_opencl ? "device" : "renderer", info->renderer,
          info->hardware ? "" : ", in software: slower than cpu");
  fprintf(cli->text, "  version                %s\n", info->version);
  fprintf(cli->text, "  moves variants         %s\n",
          info->moves ? "yes" : "no: the CPU does (voxmend augment)");
  char memory[24], buffers[24], cache[24];
  cli_bytes_text(memory, (uint64_t)info->global_bytes);
  cli_bytes_text(buffers, (uint64_t)info->block_bytes);
  if (is_opencl) {
    fprintf(cli->text,
            "  limits                 %d compute units, groups of %" PRId64
            "; memory of %s, buffers of %s,\n                         %" PRId64 " KiB shared by a group\n",
            info->compute_units, info->work_group, memory, buffers, info->local_bytes >> 10);
    cli_bytes_text(cache, (uint64_t)info->cache_bytes);
    fprintf(cli->text, "  %-22s up to %d MHz, cache of %s%s\n", info->kind, info->clock_mhz, cache,
            info->shares_memory ? "; its memory is the host's" : "");
    fprintf(cli->text, "  64-bit atomics         %s\n", info->int64_atomics ? "yes" : "no (not needed)");
    return;
  }
  fprintf(cli->text,
          "  limits                 buffers of %s, viewports of %" PRId64 ", %" PRId64
          " layers, %d sub-pixel bits\n",
          buffers, info->viewport, info->layers, info->subpixel_bits);
  fprintf(cli->text, "  64-bit integers        %s\n",
          info->int64 ? "yes" : "no: --gl-method slices and tetra-vertex only");
  fprintf(cli->text, "  XOR self-test          passed with %s\n", info->attachment);
}

static const char *presence(bool is_there) {
  return is_there ? "reads" : "not here, would read";
}

/** What reads foreign formats, and how little the process that does may do. */
static void print_reading(const cli_run *cli, const vxm_reading_info *info) {
  fprintf(cli->text, "%-24s %s %s\n", "assimp", presence(info->assimp), info->assimp_formats);
  fprintf(cli->text, "%-24s %s %s\n", "occt", presence(info->occt), info->occt_formats);
  char landlock[40] = "no Landlock in this kernel";
  if (info->landlock > 0)
    snprintf(landlock, sizeof landlock, "Landlock %d", info->landlock);
  fprintf(cli->text, "  reader process         %s, %s\n",
          info->filter ? "system calls are filtered" : "no filter of system calls in this build", landlock);
}

static json_t *reading_json(const vxm_reading_info *info) {
  return json_pack("{s{sbss}s{sbss}sbsi}", "assimp", "available", info->assimp, "formats",
                   info->assimp_formats, "occt", "available", info->occt, "formats", info->occt_formats,
                   "filter", info->filter, "landlock", info->landlock);
}

static int run(cli_run *cli) {
  static vxm_engine_info found[ENGINES_MAX];
  int64_t count;
  vxm_reading_info reading = VXM_READING_INFO_INIT;
  if (cli_read_options(cli, NULL) == CLI_STOP)
    return cli->status;
  if (cli->argument_count != 0) {
    cli_usage(cli, "no argument is expected, not %d", cli->argument_count);
    return cli->status;
  }
  if (!cli_start(cli))
    return CLI_FAILED;
  if (vxm_engines_find(found, ENGINES_MAX, &count, &cli->error) != VXM_OK ||
      vxm_reading_find(&reading, &cli->error) != VXM_OK)
    return cli_fail(cli);
  json_t *report = json_object(), *list = json_array();
  for (int64_t i = 0; i < count && i < ENGINES_MAX; i++) {
    if (cli_summary(cli))
      print_engine(cli, &found[i]);
    json_array_append_new(list, engine_json(&found[i]));
  }
  if (cli_summary(cli))
    print_reading(cli, &reading);
  json_object_set_new(report, "engines", list);
  json_object_set_new(report, "reading", reading_json(&reading));
  json_object_set(report, "warnings", cli->warnings);
  return cli_finish(cli, report);
}

const cli_command cli_command_engines = {
    .name = "engines",
    .arguments = "[OPTION]...",
    .summary = "list what can make voxels on this machine, and what reads further formats",
    .notes =
        "Each is tried out. --engine of 'voxmend voxelize' and 'voxmend bench' takes its name; 'opencl'\n"
        "takes a GPU, or else the first device (--device chooses); 'opengl' the first that works of a\n"
        "hardware device, EGL without a surface, and OSMesa. Names joined by '+' work at once, and\n"
        "so do 'opencl:all', 'opengl:all', and the parts of a device: 'opencl:0:2' is two halves.\n\n"
        "Below stand the libraries that read further mesh formats, with the extensions of what they are\n"
        "given, and how the process that they work in is confined.\n\n"
        "Example:\n"
        "  voxmend engines --json",
    .options = known_options,
    .run = run,
};
