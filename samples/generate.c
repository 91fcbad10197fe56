/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * generate_samples FOLDER: writes every sample model as OFF, rocket.off, and truth.tsv into a folder; and a
 * stool of several parts as stool.glb and stool.step.
 */
#include "models.h"
#include "scenes.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static bool write_shape(shape made, const char *folder, const char *name, bool glued) {
  char path[4096];
  int length = snprintf(path, sizeof path, "%s/%s.off", folder, name);
  bool good = length > 0 && (size_t)length < sizeof path && shape_write_off(&made, path, glued);
  if (!good)
    fprintf(stderr, "generate_samples: cannot write %s\n", path);
  shape_free(&made);
  return good;
}

static void write_truth(FILE *file, const model *entry) {
  const model_counts *c = &entry->counts;
  fprintf(file, "%s.off\t%.9g\t%s\t%s", entry->name, entry->volume, entry->parts ? entry->parts : "-",
          entry->same_as ? entry->same_as : "-");
  const int64_t counts[] = {c->vertices,
                            c->faces,
                            c->triangles,
                            c->components,
                            c->components_raw,
                            c->duplicate_faces,
                            c->opposite_duplicate_faces,
                            c->degenerate_faces,
                            c->boundary_edges,
                            c->nonmanifold_edges,
                            c->inconsistent_edges,
                            c->nonfinite_vertices,
                            c->unused_vertices,
                            c->watertight,
                            c->closed};
  for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
    fprintf(file, "\t%" PRId64, counts[i]);
  fprintf(file, "\t%s\n", entry->text);
}

static bool write_scene(bool (*write)(FILE *), const char *folder, const char *name) {
  char path[4096];
  int length = snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = length > 0 && (size_t)length < sizeof path ? fopen(path, "wb") : NULL;
  bool good = file && write(file);
  if (file)
    good = fclose(file) == 0 && good;
  if (!good)
    fprintf(stderr, "generate_samples: cannot write %s\n", path);
  return good;
}

int main(int argc, char **argv) {
  if (argc != 2) {
    fprintf(stderr, "usage: generate_samples FOLDER\n");
    return 2;
  }
  char path[4096];
  snprintf(path, sizeof path, "%s/truth.tsv", argv[1]);
  FILE *truth = fopen(path, "w");
  if (!truth) {
    fprintf(stderr, "generate_samples: cannot write %s\n", path);
    return 1;
  }
  fprintf(truth, "file\tvolume\tparts\tsame_as\tvertices\tfaces\ttriangles\tcomponents\tcomponents_raw\t"
                 "duplicate_faces\topposite_duplicate_faces\tdegenerate_faces\tboundary_edges\t"
                 "nonmanifold_edges\tinconsistent_edges\tnonfinite_vertices\tunused_vertices\twatertight\t"
                 "closed\ttext\n");
  bool good = true;
  for (size_t i = 0; i < model_count && good; i++) {
    good = write_shape(models[i].make(), argv[1], models[i].name, false);
    write_truth(truth, &models[i]);
  }
  good = good && write_shape(model_rocket(), argv[1], "rocket", true);
  good = good && write_scene(scene_write_glb, argv[1], "stool.glb");
  good = good && write_scene(scene_write_step, argv[1], "stool.step");
  good = !ferror(truth) && good;
  return fclose(truth) == 0 && good ? 0 : 1;
}
