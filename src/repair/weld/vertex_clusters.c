/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/weld/vertex_clusters.h"

#include "base/box.h"

enum {
  CLUSTER_MAX = 256, /**< vertices of the smaller of two clusters that may still be joined */
  FACES_MAX = 4096   /**< at the vertices of the smaller of two clusters */
};

typedef struct vxm_vertex_box {
  double low[3], high[3];
} box;

/* ---- Before and after ---- */

static void list_faces(vxm_vertex_clusters *clusters) {
  size_t vertices = clusters->soup->vertex_count;
  /* counted two places on, the sums are the begins, and listing moves each to the next one's begin */
  for (size_t c = 0; c < clusters->soup->corner_count; c++)
    clusters->first_face[clusters->soup->indices[c] + 2]++;
  for (size_t v = 2; v < vertices + 2; v++)
    clusters->first_face[v] += clusters->first_face[v - 1];
  for (size_t f = 0; f < clusters->soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(clusters->soup, f, &count);
    for (size_t c = 0; c < count; c++)
      clusters->faces[clusters->first_face[corner[c] + 1]++] = f;
  }
}

vxm_status vxm_vertex_clusters_create(vxm_vertex_clusters *clusters, const vxm_soup *soup, double scale,
                                      double width, vxm_context *context, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  size_t vertices = soup->vertex_count;
  *clusters = (vxm_vertex_clusters){.context = context, .soup = soup, .scale = scale, .width = width};
  clusters->parent = vxm_alloc(context, vertices, sizeof *clusters->parent, &local);
  clusters->size = vxm_alloc(context, vertices, sizeof *clusters->size, &local);
  clusters->ring = vxm_alloc(context, vertices, sizeof *clusters->ring, &local);
  clusters->boxes = vxm_alloc(context, vertices, sizeof *clusters->boxes, &local);
  clusters->first_face = vxm_calloc(context, vertices + 2, sizeof *clusters->first_face, &local);
  clusters->faces = vxm_alloc(context, soup->corner_count, sizeof *clusters->faces, &local);
  if (local.code != VXM_OK) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  for (uint32_t v = 0; v < vertices; v++) {
    clusters->parent[v] = clusters->ring[v] = v;
    clusters->size[v] = 1;
  }
  list_faces(clusters);
  return VXM_OK;
}

void vxm_vertex_clusters_destroy(vxm_vertex_clusters *clusters) {
  vxm_free(clusters->context, clusters->faces);
  vxm_free(clusters->context, clusters->first_face);
  vxm_free(clusters->context, clusters->boxes);
  vxm_free(clusters->context, clusters->ring);
  vxm_free(clusters->context, clusters->size);
  vxm_free(clusters->context, clusters->parent);
}

/* ---- Clusters ---- */

static box box_of(const vxm_vertex_clusters *clusters, uint32_t root) {
  if (clusters->size[root] > 1)
    return clusters->boxes[root];
  box around;
  for (int a = 0; a < 3; a++)
    around.low[a] = around.high[a] = vxm_position(clusters->soup, root)[a] * clusters->scale;
  return around;
}

static box box_around(const box *p, const box *q) {
  box around = *p;
  vxm_box_join(around.low, around.high, q->low, q->high);
  return around;
}

static bool has_corner_in(const vxm_vertex_clusters *clusters, size_t face, uint32_t root) {
  size_t count;
  const uint32_t *corner = vxm_face(clusters->soup, face, &count);
  for (size_t c = 0; c < count; c++)
    if (vxm_vertex_clusters_root(clusters, corner[c]) == root)
      return true;
  return false;
}

bool vxm_vertex_clusters_may_unite(const vxm_vertex_clusters *clusters, uint32_t p, uint32_t q) {
  if (p == q)
    return true;
  double sum = 0;
  box of_p = box_of(clusters, p), of_q = box_of(clusters, q), around = box_around(&of_p, &of_q);
  for (int a = 0; a < 3; a++)
    sum += (around.high[a] - around.low[a]) * (around.high[a] - around.low[a]);
  if (!(sum <= clusters->width * clusters->width))
    return false;
  uint32_t small = clusters->size[p] < clusters->size[q] ? p : q, v = small;
  if (clusters->size[small] > CLUSTER_MAX)
    return false;
  size_t faces = 0;
  do {
    faces += clusters->first_face[v + 1] - clusters->first_face[v];
    if (faces > FACES_MAX)
      return false;
    for (size_t k = clusters->first_face[v]; k < clusters->first_face[v + 1]; k++)
      if (has_corner_in(clusters, clusters->faces[k], small == p ? q : p))
        return false;
    v = clusters->ring[v];
  } while (v != small);
  return true;
}

void vxm_vertex_clusters_unite(vxm_vertex_clusters *clusters, uint32_t p, uint32_t q) {
  if (p == q)
    return;
  uint32_t root = p < q ? p : q, other = p < q ? q : p;
  box of_p = box_of(clusters, p), of_q = box_of(clusters, q);
  clusters->boxes[root] = box_around(&of_p, &of_q);
  clusters->parent[other] = root;
  clusters->size[root] += clusters->size[other];
  uint32_t kept = clusters->ring[root];
  clusters->ring[root] = clusters->ring[other];
  clusters->ring[other] = kept;
}
