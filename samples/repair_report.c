/* SPDX-License-Identifier: BSD-3-Clause */
/** repair_report MESH [MESH]: what is wrong with a mesh, what a repair does about it; writes the repaired
 * mesh. */
#include <voxmend.h>

#include <stdio.h>

static void print_row(const char *what, int64_t before, int64_t after) {
  printf("%-26s %10lld %10lld\n", what, (long long)before, (long long)after);
}

static void print_report(const vxm_repair_report *report) {
  const vxm_census *before = report->before, *after = report->after;
  printf("%-26s %10s %10s\n", "", "before", "after");
  print_row("vertices", before->vertices, after->vertices);
  print_row("faces", before->faces, after->faces);
  print_row("components", before->components, after->components);
  print_row("duplicate faces", before->duplicate_faces, after->duplicate_faces);
  print_row("opposite duplicate faces", before->opposite_duplicate_faces, after->opposite_duplicate_faces);
  print_row("degenerate faces", before->degenerate_faces, after->degenerate_faces);
  print_row("boundary edges", before->boundary_edges, after->boundary_edges);
  print_row("non-manifold edges", before->nonmanifold_edges, after->nonmanifold_edges);
  printf("%-26s %10s %10s\n", "watertight", before->watertight ? "yes" : "no",
         after->watertight ? "yes" : "no");
  for (int i = 0; i < report->pass_count; i++)
    printf("pass %-21s %10lld\n", report->passes[i].pass, (long long)report->passes[i].count);
}

int main(int argc, char **argv) {
  if (argc < 2) {
    fprintf(stderr, "usage: repair_report MESH [MESH]\n");
    return 2;
  }
  vxm_mesh *mesh = NULL, *repaired = NULL;
  vxm_census before = VXM_CENSUS_INIT, after = VXM_CENSUS_INIT;
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  report.before = &before;
  report.after = &after;
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = vxm_mesh_read(&mesh, NULL, argv[1], &error);
  if (status == VXM_OK)
    status = vxm_mesh_repair(&repaired, &report, mesh, NULL, &error);
  if (status == VXM_OK)
    print_report(&report);
  if (status == VXM_OK && argc > 2)
    status = vxm_mesh_write(repaired, argv[2], NULL, &error);
  for (int64_t i = 0; mesh && i < vxm_mesh_warning_count(mesh); i++)
    printf("warning: %s\n", vxm_mesh_warning(mesh, i));
  if (status != VXM_OK)
    fprintf(stderr, "%s\n", error.text);
  vxm_mesh_destroy(repaired);
  vxm_mesh_destroy(mesh);
  return status == VXM_OK ? 0 : 1;
}
