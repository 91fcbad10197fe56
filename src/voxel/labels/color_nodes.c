/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/color_nodes.h"
#include "grid/space.h"
#include "voxel/labels/mesh_colors.h"
#include "voxel/sparse/sparse.h"

#include <string.h>

enum { SIDE = VXM_NODE_SIDE, ROWS = SIDE * SIDE };

/** What a worker has of its own. */
typedef struct scratch {
  uint16_t *parts; /**< of the node at hand, where they are wanted */
  uint32_t near;
} scratch;

struct vxm_color_nodes {
  vxm_context *context;
  const vxm_space *space;
  const vxm_color_options *options;
  float longest;
  vxm_sparse *voxels; /**< NULL where those of the parts are used */
  vxm_face_labels labelling;
  vxm_label_nodes *parts;    /**< NULL = they are not wanted */
  vxm_mesh_painter *painter; /**< NULL = another way */
  vxm_color_fn color;        /**< from elsewhere */
  const void *payload;
  scratch *scratches;
  int workers;
};

bool vxm_color_nodes_are_for(const vxm_model *model, const vxm_color_options *options) {
  const vxm_engine *engine = model->options.engine;
  bool by_engine = engine && engine->ops && engine->ops->color;
  bool is_built_in = options->by != VXM_COLOR_MESH && options->by != VXM_COLOR_VOLUME;
  return options->by != VXM_COLOR_GLSL && !options->average && !(by_engine && is_built_in) &&
         !model->options.confidence;
}

/* ---- A node ---- */

static void color_each(const vxm_color_nodes *n, const int64_t at[3], uint8_t *values,
                       const uint64_t rows[ROWS], const uint16_t *parts) {
  for (size_t r = 0; r < ROWS; r++)
    for (uint64_t bits = rows[r]; bits; bits &= bits - 1) {
      const int x = __builtin_ctzll(bits);
      const size_t index = SIDE * r + (size_t)x;
      const int64_t voxel[3] = {at[0] + x, at[1] + (int64_t)(r % SIDE), at[2] + (int64_t)(r / SIDE)};
      if (n->color)
        n->color(values + 4 * index, voxel, n->payload);
      else
        vxm_color_voxel(values + 4 * index, n->options->by, n->space, n->longest, voxel,
                        parts ? parts[index] : 0);
    }
}

static bool make_node(void *payload, int worker, const int64_t at[3], void *to) {
  vxm_color_nodes *n = payload;
  scratch *d = &n->scratches[worker];
  uint8_t *values = to;
  uint64_t rows[ROWS];
  const vxm_sparse *voxels = n->parts ? vxm_label_nodes_voxels(n->parts) : n->voxels;
  if (vxm_node_bits(rows, voxels, at) && rows[0] == 0) {
    memset(values, 0, 4);
    return true;
  }
  if (n->parts) {
    vxm_node_maker maker = vxm_label_nodes_maker(n->parts);
    if (maker.make(maker.payload, worker, at, d->parts)) {
      vxm_color_voxel(values, VXM_COLOR_PART, n->space, n->longest, at, d->parts[0]);
      return true;
    }
  }
  memset(values, 0, (size_t)4 * VXM_NODE_VOXELS);
  if (n->painter)
    vxm_mesh_painter_node(n->painter, values, n->space, at, rows, &d->near);
  else
    color_each(n, at, values, rows, n->parts ? d->parts : NULL);
  return false;
}

vxm_node_maker vxm_color_nodes_maker(vxm_color_nodes *nodes) {
  return (vxm_node_maker){.boxes = nodes->parts ? vxm_label_nodes_maker(nodes->parts).boxes : NULL,
                          .make = make_node,
                          .payload = nodes,
                          .phase = "colouring"};
}

/* ---- Before and after ---- */

static vxm_status make_voxels(vxm_color_nodes *n, vxm_voxelize_report *report, vxm_model *model,
                              vxm_error *error) {
  if (!vxm_color_wants_parts(n->options))
    return vxm_sparse_make(&n->voxels, report, model, n->space, NULL, error);
  vxm_status status = vxm_face_labels_create(&n->labelling, model->analysis.soup, VXM_LABEL_PART, error);
  return status == VXM_OK ? vxm_label_nodes_create(&n->parts, report, model, n->space, &n->labelling, error)
                          : status;
}

static vxm_status make_scratches(vxm_color_nodes *n, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  n->scratches = vxm_calloc(n->context, (size_t)n->workers, sizeof *n->scratches, &local);
  for (int w = 0; w < n->workers && n->parts && local.code == VXM_OK; w++)
    n->scratches[w].parts = vxm_alloc(n->context, VXM_NODE_VOXELS, sizeof *n->scratches[w].parts, &local);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

vxm_status vxm_color_nodes_create(vxm_color_nodes **out, vxm_voxelize_report *report, vxm_model *model,
                                  const vxm_space *space, const vxm_color_options *options,
                                  vxm_color_fn color, const void *payload, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_color_nodes *n = vxm_calloc(model->context, 1, sizeof *n, &local);
  vxm_status status = local.code;
  if (n) {
    n->context = model->context;
    n->space = space;
    n->options = options;
    n->color = color;
    n->payload = payload;
    n->longest = (float)vxm_space_longest_side(space);
    n->workers = vxm_context_threads(model->context);
    status = make_voxels(n, report, model, &local);
  }
  if (status == VXM_OK && options->by == VXM_COLOR_MESH)
    status = vxm_mesh_painter_create(&n->painter, n->context, options->mesh, &local);
  if (status == VXM_OK)
    status = make_scratches(n, &local);
  if (status != VXM_OK) {
    vxm_color_nodes_destroy(n);
    vxm_error_pass(error, &local);
    n = NULL;
  }
  *out = n;
  return status;
}

void vxm_color_nodes_destroy(vxm_color_nodes *n) {
  if (!n)
    return;
  for (int w = 0; n->scratches && w < n->workers; w++)
    vxm_free(n->context, n->scratches[w].parts);
  vxm_free(n->context, n->scratches);
  vxm_mesh_painter_destroy(n->painter);
  if (n->labelling.soup)
    vxm_face_labels_destroy(&n->labelling);
  vxm_label_nodes_destroy(n->parts);
  vxm_sparse_destroy(n->voxels);
  vxm_free(n->context, n);
}
