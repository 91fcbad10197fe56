/* SPDX-License-Identifier: BSD-3-Clause */
/** The shared meshes and what is known of them, for tests that skip where they are missing. */
#ifndef VXM_TESTS_SHARED_H
#define VXM_TESTS_SHARED_H

#include "soups.h"

#include "meshio/meshio.h"

enum { SHARED_COLUMNS_MAX = 32 };

/** One line of MANIFEST.tsv, cut into its columns. */
typedef struct shared_mesh {
  char path[1024];
  char line[4096];
  const char *names[SHARED_COLUMNS_MAX], *values[SHARED_COLUMNS_MAX];
  size_t columns;
} shared_mesh;

static inline size_t cut_columns(char *line, const char **columns) {
  size_t count = 0;
  line[strcspn(line, "\r\n")] = '\0';
  for (char *at = line; count < SHARED_COLUMNS_MAX;) {
    columns[count++] = at;
    at = strchr(at, '\t');
    if (!at)
      break;
    *at++ = '\0';
  }
  return count;
}

static inline const char *shared_value(const shared_mesh *mesh, const char *name) {
  for (size_t i = 0; i < mesh->columns; i++)
    if (strcmp(mesh->names[i], name) == 0)
      return mesh->values[i];
  fail_msg("no column %s", name);
  return "";
}

/** Calls `visit` for every mesh outside malformed/; returns how many there were, 0 if they are not here. */
static inline size_t for_each_shared_mesh(void (*visit)(const shared_mesh *mesh, void *payload),
                                          void *payload) {
  const char *source = getenv("SRCDIR");
  char folder[512], path[600];
  snprintf(folder, sizeof folder, "%s/../shared/meshes", source ? source : ".");
  snprintf(path, sizeof path, "%s/MANIFEST.tsv", folder);
  FILE *manifest = fopen(path, "r");
  if (!manifest)
    return 0;
  static char header[4096];
  static shared_mesh mesh;
  assert_non_null(fgets(header, sizeof header, manifest));
  mesh.columns = cut_columns(header, mesh.names);
  size_t count = 0;
  while (fgets(mesh.line, sizeof mesh.line, manifest)) {
    size_t columns = cut_columns(mesh.line, mesh.values);
    if (columns < 2 || strncmp(mesh.values[0], "malformed/", 10) == 0)
      continue;
    for (; columns < mesh.columns; columns++)
      mesh.values[columns] = "";
    snprintf(mesh.path, sizeof mesh.path, "%s/%s", folder, mesh.values[0]);
    visit(&mesh, payload);
    count++;
  }
  fclose(manifest);
  return count;
}

static inline vxm_soup *read_soup(vxm_context *context, const char *path) {
  vxm_input input;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_input_open(&input, context, path, &error) != VXM_OK)
    fail_msg("%s", error.text);
  vxm_soup *soup;
  if (vxm_meshio_read(&soup, context, input.data, input.size, path, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  vxm_input_close(&input);
  return soup;
}

#endif
