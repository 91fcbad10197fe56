/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * voxelize_arrays: voxelizes a mesh that lies in the program's own arrays, in a context with two threads, a
 * memory limit and a progress callback; then once more with a callback that cancels.
 */
#include <voxmend.h>

#include <stdio.h>

/* A house: walls of four corners, gables of five, floor and roof of four. */
static const float vertices[] = {0, 0, 0, 4, 0, 0, 4, 6, 0, 0, 6, 0, 0, 0, 3,
                                 4, 0, 3, 4, 6, 3, 0, 6, 3, 2, 0, 5, 2, 6, 5};
static const int64_t indices[] = {3, 2, 1, 0,    /* floor */
                                  0, 1, 5, 8, 4, /* front gable */
                                  2, 3, 7, 9, 6, /* back gable */
                                  1, 2, 6, 5,    /* right wall */
                                  3, 0, 4, 7,    /* left wall */
                                  5, 6, 9, 8,    /* right half of the roof */
                                  7, 4, 8, 9};   /* left half of the roof */
static const int64_t offsets[] = {0, 4, 9, 14, 18, 22, 26, 30};

typedef struct watch {
  long calls;
  bool cancel;
} watch;

/** Called from the thread that voxelizes; anything but 0 cancels. */
static int on_progress(const char *phase, double fraction, void *payload) {
  (void)phase;
  (void)fraction;
  watch *seen = payload;
  seen->calls++;
  return seen->cancel;
}

static vxm_status make_grid(vxm_grid **grid, watch *seen, vxm_error *error) {
  vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
  limits.threads = 2;
  limits.memory_limit = 64u << 20;
  limits.progress = on_progress;
  limits.payload = seen;
  vxm_context *context = NULL;
  vxm_status status = vxm_context_create(&context, &limits, error);
  if (status != VXM_OK)
    return status;

  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  arrays.vertex_scalar = VXM_FLOAT32;
  arrays.vertices = vertices;
  arrays.vertex_count = (int64_t)(sizeof vertices / sizeof vertices[0] / 3);
  arrays.offsets = offsets;
  arrays.indices = indices;
  arrays.index_count = (int64_t)(sizeof indices / sizeof indices[0]);
  arrays.face_count = (int64_t)(sizeof offsets / sizeof offsets[0]) - 1;
  vxm_mesh *mesh = NULL;
  status = vxm_mesh_create(&mesh, context, &arrays, error);

  vxm_space_options space = VXM_SPACE_OPTIONS_INIT;
  space.voxel_size = 0.25; /* model units */
  space.fit = VXM_FIT_TIGHT;
  if (status == VXM_OK)
    status = vxm_voxelize(grid, NULL, mesh, &space, NULL, error);

  vxm_mesh_destroy(mesh);
  vxm_context_destroy(context); /* the grid keeps what it needs of it */
  return status;
}

int main(void) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid = NULL;
  watch seen = {0, false};
  if (make_grid(&grid, &seen, &error) != VXM_OK) {
    fprintf(stderr, "%s\n", error.text);
    return 1;
  }
  const vxm_space *space = vxm_grid_space(grid);
  double volume =
      (double)vxm_grid_count(grid) * space->voxel_size[0] * space->voxel_size[1] * space->voxel_size[2];
  printf("%lld x %lld x %lld voxels, volume %g\n", (long long)space->dims[0], (long long)space->dims[1],
         (long long)space->dims[2], volume);
  for (int64_t k = space->dims[2] - 1; k >= 0; k -= 2) { /* a cut, seen from the front */
    for (int64_t i = 0; i < space->dims[0]; i++)
      putchar(vxm_grid_get(grid, i, space->dims[1] / 2, k) ? '#' : '.');
    putchar('\n');
  }
  vxm_grid_destroy(grid);

  seen.cancel = true;
  vxm_status status = make_grid(&grid, &seen, &error);
  printf("cancelled: %s\n", vxm_status_name(status));
  return status == VXM_ERROR_CANCELLED && grid == NULL && seen.calls > 0 ? 0 : 1;
}
