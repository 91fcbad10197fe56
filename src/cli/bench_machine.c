/* SPDX-License-Identifier: BSD-3-Clause */
/** What the machine is, as far as it tells: figures mean nothing without it. */
#include "cli/bench.h"

#include <ctype.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

/** The first line of a file without blanks at its end; "" where there is none. */
static void read_line(char *out, int size, const char *path) {
  *out = '\0';
  FILE *file = fopen(path, "re");
  if (!file)
    return;
  if (!fgets(out, size, file))
    *out = '\0';
  fclose(file);
  size_t length = strlen(out);
  while (length > 0 && isspace((unsigned char)out[length - 1]))
    out[--length] = '\0';
}

/** The processor's name in /proc/cpuinfo; ARM has none there, then "". */
static void read_processor(bench_machine *out) {
  FILE *file = fopen("/proc/cpuinfo", "re");
  char line[256];
  while (file && !*out->processor && fgets(line, sizeof line, file)) {
    char *value = strchr(line, ':');
    if (!value || strncmp(line, "model name", 10) != 0)
      continue;
    value += 1 + strspn(value + 1, " \t");
    value[strcspn(value, "\n")] = '\0';
    snprintf(out->processor, sizeof out->processor, "%.120s", value);
  }
  if (file)
    fclose(file);
}

static void read_caches(bench_machine *out) {
  enum { CACHES = sizeof out->caches / sizeof out->caches[0] };
  for (int i = 0; i < CACHES; i++) {
    char path[96], text[32];
    const char *folder = "/sys/devices/system/cpu/cpu0/cache/index";
    int64_t level;
    uint64_t bytes;
    snprintf(path, sizeof path, "%s%d/size", folder, i);
    read_line(text, sizeof text, path);
    if (!cli_read_size(&bytes, text))
      return;
    snprintf(path, sizeof path, "%s%d/level", folder, i);
    read_line(text, sizeof text, path);
    if (!cli_read_integer(&level, text, 1, 9))
      return;
    snprintf(path, sizeof path, "%s%d/type", folder, i);
    read_line(text, sizeof text, path);
    out->caches[i].level = (int)level;
    out->caches[i].bytes = bytes;
    snprintf(out->caches[i].type, sizeof out->caches[i].type, "%.15s", text);
    out->cache_count = i + 1;
  }
}

/** The choice in brackets: "always [madvise] never". */
static void read_huge_pages(bench_machine *out) {
  char text[64];
  read_line(text, sizeof text, "/sys/kernel/mm/transparent_hugepage/enabled");
  const char *begin = strchr(text, '['), *end = strchr(text, ']');
  if (begin && end && end > begin)
    snprintf(out->huge_pages, sizeof out->huge_pages, "%.*s", (int)(end - begin - 1), begin + 1);
}

const char *const bench_cpu_names[] = {"plain", "avx2", "avx512", NULL};

void bench_machine_read(bench_machine *out) {
  *out = (bench_machine){0};
  struct utsname name;
  if (uname(&name) == 0) {
    snprintf(out->system, sizeof out->system, "%.40s %.80s", name.sysname, name.release);
    snprintf(out->architecture, sizeof out->architecture, "%.31s", name.machine);
  }
  read_processor(out);
  read_caches(out);
  read_huge_pages(out);
  out->vectors = vxm_cpu_used();
  out->cores = (int)sysconf(_SC_NPROCESSORS_ONLN);
  out->memory_bytes = (uint64_t)sysconf(_SC_PHYS_PAGES) * (uint64_t)sysconf(_SC_PAGESIZE);
#if defined(__clang__)
  snprintf(out->compiler, sizeof out->compiler, "%s", __VERSION__);
#else
  snprintf(out->compiler, sizeof out->compiler, "gcc %s", __VERSION__);
#endif
}

json_t *bench_machine_json(const bench_machine *machine) {
  json_t *caches = json_array();
  for (int i = 0; i < machine->cache_count; i++) {
    json_t *cache = json_object();
    json_object_set_new(cache, "level", json_integer(machine->caches[i].level));
    json_object_set_new(cache, "type", cli_json_text(machine->caches[i].type));
    json_object_set_new(cache, "bytes", json_integer((json_int_t)machine->caches[i].bytes));
    json_array_append_new(caches, cache);
  }
  json_t *object = json_object();
  json_object_set_new(object, "processor", cli_json_text(machine->processor));
  json_object_set_new(object, "architecture", cli_json_text(machine->architecture));
  json_object_set_new(object, "vectors", json_string(bench_cpu_names[machine->vectors]));
  json_object_set_new(object, "cores", json_integer(machine->cores));
  json_object_set_new(object, "caches", caches);
  json_object_set_new(object, "memory_bytes", json_integer((json_int_t)machine->memory_bytes));
  json_object_set_new(object, "huge_pages", cli_json_text(machine->huge_pages));
  json_object_set_new(object, "system", cli_json_text(machine->system));
  json_object_set_new(object, "compiler", cli_json_text(machine->compiler));
  json_object_set_new(object, "voxmend", json_string(vxm_version()));
  return object;
}

uint64_t bench_peak_rss(void) {
  struct rusage usage;
  return getrusage(RUSAGE_SELF, &usage) == 0 ? (uint64_t)usage.ru_maxrss * 1024 : 0; /* Linux counts KiB */
}
