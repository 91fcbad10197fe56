/* SPDX-License-Identifier: BSD-3-Clause */
/** A scene of Assimp as one soup: transforms applied, instances repeated, names as tags. */
#include <assimp/material.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/context.h"
#include "meshio/common/part_names.h"
#include "modules/assimp/assimp.h"

/** Where a node puts its meshes: rows of three numbers and a shift. */
typedef struct placement {
  double m[3][4];
} placement;

/** A node, with what those above it do. */
typedef struct placed_node {
  const struct aiNode *node;
  placement where;
} placed_node;

/** The state of the flattening. */
typedef struct flattener {
  const struct aiScene *scene;
  vxm_soup *soup;
  vxm_tagger tagger;
  placed_node *nodes; /**< all, each before those below it */
  size_t node_count, node_capacity;
  size_t uv_capacity;
  uint64_t lines_and_points, beyond, missing; /**< faces and meshes that are left out */
} flattener;

/* ---- Placement ---- */

static const placement unmoved = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

/** `outer` after the node's own transform. */
static placement compose(const placement *outer, const struct aiMatrix4x4 *t) {
  const double inner[3][4] = {{(double)t->a1, (double)t->a2, (double)t->a3, (double)t->a4},
                              {(double)t->b1, (double)t->b2, (double)t->b3, (double)t->b4},
                              {(double)t->c1, (double)t->c2, (double)t->c3, (double)t->c4}};
  placement result;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 4; c++) {
      const double *o = outer->m[r];
      result.m[r][c] = o[0] * inner[0][c] + o[1] * inner[1][c] + o[2] * inner[2][c] + (c == 3 ? o[3] : 0.0);
    }
  return result;
}

/** Whether it turns right into left, so that faces must be turned over to look the same way. */
static bool is_mirrored(const placement *p) {
  const double(*m)[4] = p->m;
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
         0;
}

/* ---- Nodes ---- */

static vxm_status add_node(flattener *f, const struct aiNode *node, const placement *outer,
                           vxm_error *error) {
  vxm_status status = vxm_grow(f->soup->context, (void **)&f->nodes, &f->node_capacity, f->node_count + 1,
                               sizeof *f->nodes, error);
  if (status == VXM_OK)
    f->nodes[f->node_count++] = (placed_node){node, compose(outer, &node->mTransformation)};
  return status;
}

/** Lists the nodes level after level, without recursion: the tree may be of any depth. */
static vxm_status list_nodes(flattener *f, vxm_error *error) {
  const struct aiNode *node = f->scene->mRootNode;
  vxm_status status = node ? add_node(f, node, &unmoved, error) : VXM_OK;
  for (size_t n = 0; n < f->node_count && status == VXM_OK; n++) {
    const placed_node parent = f->nodes[n];
    for (unsigned c = 0; c < parent.node->mNumChildren && status == VXM_OK; c++)
      if (parent.node->mChildren[c])
        status = add_node(f, parent.node->mChildren[c], &parent.where, error);
  }
  return status;
}

/** The name that tells a node's part: where formats put a mesh under a nameless or made-up node, the mesh's.
 */
static const char *part_name(const flattener *f, const struct aiNode *node) {
  const struct aiScene *scene = f->scene;
  bool is_root = node == scene->mRootNode;
  if (node->mNumMeshes > 0 && (is_root || node->mName.length == 0) && node->mMeshes[0] < scene->mNumMeshes) {
    const struct aiMesh *mesh = scene->mMeshes[node->mMeshes[0]];
    if (mesh && mesh->mName.length > 0)
      return mesh->mName.data;
  }
  return node->mName.data;
}

/* ---- Meshes ---- */

static void take_material(flattener *f, const struct aiMesh *mesh) {
  struct aiString name = {.length = 0};
  const struct aiScene *scene = f->scene;
  if (mesh->mMaterialIndex < scene->mNumMaterials && scene->mMaterials[mesh->mMaterialIndex] &&
      (aiGetMaterialString(scene->mMaterials[mesh->mMaterialIndex], AI_MATKEY_NAME, &name) !=
           aiReturn_SUCCESS ||
       strcmp(name.data, AI_DEFAULT_MATERIAL_NAME) == 0))
    name.length = 0;
  vxm_tagger_material(&f->tagger, (const unsigned char *)name.data, name.length);
}

static vxm_status add_vertices(vxm_soup *soup, const struct aiMesh *mesh, const placement *p,
                               vxm_error *error) {
  vxm_status status = vxm_soup_reserve(soup, soup->vertex_count + mesh->mNumVertices, 0, 0, error);
  if (status != VXM_OK)
    return status;
  double *out = soup->positions + 3 * soup->vertex_count;
  for (unsigned v = 0; v < mesh->mNumVertices; v++, out += 3) {
    double x = (double)mesh->mVertices[v].x, y = (double)mesh->mVertices[v].y,
           z = (double)mesh->mVertices[v].z;
    for (int c = 0; c < 3; c++)
      out[c] = p->m[c][0] * x + p->m[c][1] * y + p->m[c][2] * z + p->m[c][3];
  }
  soup->vertex_count += mesh->mNumVertices;
  return VXM_OK;
}

/** Adds a face whose mesh begins at vertex `first`. */
static vxm_status add_face(flattener *f, const struct aiMesh *mesh, const struct aiFace *face, uint32_t first,
                           bool is_turned, vxm_error *error) {
  vxm_soup *soup = f->soup;
  unsigned n = face->mNumIndices;
  if (n < 3) {
    f->lines_and_points++;
    return VXM_OK;
  }
  vxm_status status = vxm_soup_reserve(soup, 0, soup->face_count + 1, soup->corner_count + n, error);
  if (status != VXM_OK)
    return status;
  uint32_t *corner = soup->indices + soup->corner_count;
  for (unsigned c = 0; c < n; c++) {
    if (face->mIndices[c] >= mesh->mNumVertices) {
      f->beyond++;
      return VXM_OK;
    }
    corner[is_turned ? n - 1 - c : c] = first + face->mIndices[c];
  }
  status = vxm_tagger_face(&f->tagger, error);
  if (status != VXM_OK)
    return status;
  soup->corner_count += n;
  soup->offsets[++soup->face_count] = soup->corner_count;
  return soup->appearance ? vxm_assimp_face_look(soup, &f->uv_capacity, mesh, first, error) : VXM_OK;
}

static vxm_status add_mesh(flattener *f, const struct aiMesh *mesh, const placement *where,
                           vxm_error *error) {
  if (!mesh || (mesh->mNumVertices > 0 && !mesh->mVertices) || (mesh->mNumFaces > 0 && !mesh->mFaces)) {
    f->missing++;
    return VXM_OK;
  }
  uint32_t first = (uint32_t)f->soup->vertex_count;
  bool is_turned = is_mirrored(where);
  take_material(f, mesh);
  vxm_status status = VXM_OK;
  if (f->soup->appearance)
    status = vxm_assimp_vertex_colors(f->soup, mesh, error);
  if (status == VXM_OK)
    status = add_vertices(f->soup, mesh, where, error);
  for (unsigned i = 0; i < mesh->mNumFaces && status == VXM_OK; i++)
    status = add_face(f, mesh, &mesh->mFaces[i], first, is_turned, error);
  return status;
}

static vxm_status add_node_meshes(flattener *f, const placed_node *placed, const char *name, uint32_t number,
                                  vxm_error *error) {
  const struct aiNode *node = placed->node;
  vxm_status status = VXM_OK;
  vxm_part_names_tag(&f->tagger, name, number);
  for (unsigned m = 0; m < node->mNumMeshes && status == VXM_OK; m++)
    if (node->mMeshes[m] < f->scene->mNumMeshes)
      status = add_mesh(f, f->scene->mMeshes[node->mMeshes[m]], &placed->where, error);
    else
      f->missing++;
  return status;
}

/* ---- The scene ---- */

/** Keeps only the nodes that have meshes, and finds their names and numbers. */
static vxm_status name_parts(flattener *f, const char **names, uint32_t *numbers, vxm_error *error) {
  size_t kept = 0;
  for (size_t n = 0; n < f->node_count; n++)
    if (f->nodes[n].node->mNumMeshes > 0) {
      f->nodes[kept] = f->nodes[n];
      names[kept++] = part_name(f, f->nodes[n].node);
    }
  f->node_count = kept;
  return vxm_part_names_number(numbers, f->soup->context, names, kept, error);
}

static vxm_status add_parts(flattener *f, vxm_error *error) {
  vxm_context *context = f->soup->context;
  vxm_error local = VXM_ERROR_INIT;
  const char **names = vxm_alloc(context, f->node_count, sizeof *names, &local);
  uint32_t *numbers = vxm_alloc(context, f->node_count, sizeof *numbers, &local);
  vxm_status status = names && numbers ? name_parts(f, names, numbers, &local) : local.code;
  for (size_t n = 0; n < f->node_count && status == VXM_OK; n++) {
    status = add_node_meshes(f, &f->nodes[n], names[n], numbers[n], &local);
    if (status == VXM_OK)
      status = vxm_progress(context, "reading", (double)n / (double)f->node_count, &local);
  }
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  vxm_free(context, numbers);
  vxm_free(context, names);
  return status;
}

static void note_losses(const flattener *f) {
  vxm_warnings *warnings = &f->soup->warnings;
  if (f->scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE)
    vxm_warn(warnings, "Assimp could not read all of the scene");
  if (f->beyond > 0)
    vxm_warn(warnings, "face names a vertex that does not exist; skipped (faces: %" PRIu64 ")", f->beyond);
  if (f->missing > 0)
    vxm_warn(warnings, "node names a mesh that does not exist; skipped (meshes: %" PRIu64 ")", f->missing);
  if (f->lines_and_points > 0)
    vxm_warn(warnings, "lines and points are skipped (elements: %" PRIu64 ")", f->lines_and_points);
  if (f->soup->face_count == 0)
    vxm_warn(warnings, "the file has no faces");
}

vxm_status vxm_assimp_flatten(vxm_soup *soup, const struct aiScene *scene, vxm_error *error) {
  flattener f = {.scene = scene, .soup = soup};
  vxm_tagger_open(&f.tagger, soup);
  vxm_status status = list_nodes(&f, error);
  if (status == VXM_OK && soup->appearance)
    status = vxm_assimp_materials(soup->appearance, scene, error);
  if (status == VXM_OK)
    status = add_parts(&f, error);
  if (status == VXM_OK) {
    if (soup->face_count == 0)
      vxm_tags_drop(soup);
    note_losses(&f);
  }
  vxm_tagger_close(&f.tagger);
  vxm_free(soup->context, f.nodes);
  return status;
}
