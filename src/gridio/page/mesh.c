/* SPDX-License-Identifier: BSD-3-Clause */
/** The mesh of a page: its triangles, and layers of what is wrong with it. */
#include "base/endian.h"
#include "grid/space.h"
#include "gridio/page/changes.h"
#include "gridio/page/parts.h"
#include "mesh/components.h"
#include "mesh/triangulate.h"
#include "mesh/weld.h"
#include "repair/defects.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/** What a face can be. */
enum { OPEN = 1, REMOVED = 2, REPEATED = 4 };

/** Triangles that browsers draw fluently; a mesh of more is left out. */
enum { TRIANGLES_MAX = 4000000 };

typedef struct drawn_mesh {
  vxm_page *page;
  const vxm_soup *soup, *repaired; /**< repaired may be NULL */
  vxm_defects *defects;
  uint8_t *flags; /**< of the faces of the soup */
  uint8_t *added; /**< the faces of `repaired` that are new */
  double scale;   /**< positions in the page are relative to the grid's corner, and its longest side is 1 */
  json_t *layers;
} drawn_mesh;

/* ---- Positions ---- */

/** A position that is not finite, or too far away, lies at the corner. */
static void put_position(vxm_pack *pack, const drawn_mesh *d, const double *p) {
  unsigned char bytes[12];
  for (int a = 0; a < 3; a++) {
    double at = (p[a] - d->page->space->origin[a]) * d->scale;
    float value = fabs(at) < 1e6 ? (float)at : 0;
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    vxm_store_le32(bytes + 4 * a, word);
  }
  vxm_pack_put(pack, bytes, sizeof bytes);
}

/* ---- Triangles ---- */

/** Gets the triangles of a face, one after the other. */
typedef void (*triangle_fn)(vxm_pack *pack, const drawn_mesh *d, size_t face, const uint32_t corners[3]);

static void put_corners(vxm_pack *pack, const drawn_mesh *d, size_t face, const uint32_t corners[3]) {
  (void)d, (void)face;
  unsigned char bytes[12];
  for (int c = 0; c < 3; c++)
    vxm_store_le32(bytes + 4 * c, corners[c]);
  vxm_pack_put(pack, bytes, sizeof bytes);
}

static void put_flags(vxm_pack *pack, const drawn_mesh *d, size_t face, const uint32_t corners[3]) {
  (void)corners;
  vxm_pack_put(pack, d->flags + face, 1);
}

static void put_added(vxm_pack *pack, const drawn_mesh *d, size_t face, const uint32_t corners[3]) {
  for (int c = 0; d->added[face] && c < 3; c++)
    put_position(pack, d, vxm_position(d->repaired, corners[c]));
}

/** A block of something about each triangle. */
static vxm_status put_triangles(const drawn_mesh *d, const vxm_soup *soup, const char *id, triangle_fn put,
                                vxm_error *error) {
  vxm_triangulator tri;
  vxm_pack *pack;
  vxm_status status = vxm_pack_begin(&pack, soup->context, d->page->output, id, error);
  if (status != VXM_OK)
    return status;
  vxm_triangulator_open(&tri, soup->context);
  for (size_t f = 0; status == VXM_OK && f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corners = vxm_face(soup, f, &count), *triangles = corners;
    if (count > 3)
      status = vxm_triangulate(&tri, soup->positions, corners, count, &triangles, error);
    for (size_t t = 0; status == VXM_OK && t + 2 < count; t++)
      put(pack, d, f, triangles + 3 * t);
  }
  vxm_triangulator_close(&tri);
  vxm_status ended = vxm_pack_end(pack, status == VXM_OK ? error : NULL);
  return status == VXM_OK ? ended : status;
}

static vxm_status put_vertices(const drawn_mesh *d, vxm_error *error) {
  vxm_pack *pack;
  vxm_status status = vxm_pack_begin(&pack, d->soup->context, d->page->output, "vertices", error);
  for (size_t v = 0; status == VXM_OK && v < d->soup->vertex_count; v++)
    put_position(pack, d, vxm_position(d->soup, v));
  return status == VXM_OK ? vxm_pack_end(pack, error) : status;
}

/* ---- Layers ---- */

static void add_layer(const drawn_mesh *d, const char *name, const char *what, int bit, int64_t count,
                      const char *color, const char *hint) {
  if (count > 0)
    json_array_append_new(d->layers,
                          json_pack("{s:s, s:s, s:i, s:I, s:s, s:s}", "name", name, "what", what, "bit", bit,
                                    "count", (json_int_t)count, "color", color, "hint", hint));
}

static int64_t count_flag(const drawn_mesh *d, int flag) {
  int64_t count = 0;
  for (size_t f = 0; f < d->soup->face_count; f++)
    count += (d->flags[f] & flag) != 0;
  return count;
}

/** Lines or points of one kind of defect: a block and its layer. */
static vxm_status put_defects(const drawn_mesh *d, vxm_defect_kind kind, bool is_edge, const char *name,
                              const char *color, const char *hint, vxm_error *error) {
  vxm_pack *pack;
  int64_t count = 0;
  vxm_status status = vxm_pack_begin(&pack, d->soup->context, d->page->output, vxm_defect_name(kind), error);
  for (size_t i = 0; status == VXM_OK && i < d->defects->count; i++) {
    const vxm_defect *defect = d->defects->items + i;
    if (defect->kind != kind)
      continue;
    put_position(pack, d, defect->position);
    if (is_edge)
      put_position(pack, d, defect->position + 3);
    count++;
  }
  if (status == VXM_OK)
    status = vxm_pack_end(pack, error);
  add_layer(d, name, vxm_defect_name(kind), is_edge ? -2 : -1, count, color, hint);
  return status;
}

static vxm_status put_all_defects(const drawn_mesh *d, vxm_error *error) {
  static const struct {
    vxm_defect_kind kind;
    bool is_edge;
    const char *name, *color, *hint;
  } all[] = {
      {VXM_DEFECT_BOUNDARY_EDGE, true, "open edges", "#e6194b",
       "edges of one face: rims of holes and sheets"},
      {VXM_DEFECT_NONMANIFOLD_EDGE, true, "non-manifold edges", "#c000c0", "edges of more than two faces"},
      {VXM_DEFECT_INCONSISTENT_EDGE, true, "inconsistent edges", "#b07000",
       "edges whose two faces look to different sides"},
      {VXM_DEFECT_NONMANIFOLD_VERTEX, false, "non-manifold vertices", "#7000ff",
       "vertices in which several surfaces touch"},
      {VXM_DEFECT_DEGENERATE_FACE, false, "faces without area", "#008080", "marked by their middle"},
  };
  vxm_status status = VXM_OK;
  for (size_t k = 0; status == VXM_OK && k < sizeof all / sizeof *all; k++)
    status = put_defects(d, all[k].kind, all[k].is_edge, all[k].name, all[k].color, all[k].hint, error);
  return status;
}

/** Marks faces that repeat others, and those of components with an open edge. */
static vxm_status mark_faces(const drawn_mesh *d, vxm_error *error) {
  const vxm_soup *soup = d->soup;
  vxm_error local = VXM_ERROR_INIT;
  uint32_t *map = vxm_alloc(soup->context, soup->vertex_count, sizeof *map, &local);
  uint32_t *labels = map ? vxm_alloc(soup->context, soup->face_count, sizeof *labels, &local) : NULL;
  uint8_t *rim = labels ? vxm_calloc(soup->context, soup->vertex_count, 1, &local) : NULL, *open = NULL;
  size_t count = 0;
  if (rim)
    vxm_weld_exact(soup->context, soup->positions, soup->vertex_count, map, NULL, &local);
  if (local.code == VXM_OK)
    vxm_components(soup->context, soup, map, labels, &count, &local);
  if (local.code == VXM_OK)
    open = vxm_calloc(soup->context, count, 1, &local);
  for (size_t i = 0; open && i < d->defects->count; i++) {
    const vxm_defect *defect = d->defects->items + i;
    if (defect->kind == VXM_DEFECT_BOUNDARY_EDGE)
      rim[map[defect->element[0]]] = 1;
    if (defect->kind == VXM_DEFECT_DUPLICATE_FACE)
      d->flags[defect->element[0]] |= REPEATED;
  }
  for (int round = 0; open && round < 2; round++)
    for (size_t f = 0; f < soup->face_count; f++) {
      size_t corners;
      const uint32_t *corner = vxm_face(soup, f, &corners);
      for (size_t c = 0; round == 0 && c < corners; c++)
        open[labels[f]] |= rim[map[corner[c]]];
      d->flags[f] |= round == 1 && open[labels[f]] ? OPEN : 0;
    }
  vxm_free(soup->context, open);
  vxm_free(soup->context, rim);
  vxm_free(soup->context, labels);
  vxm_free(soup->context, map);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

static vxm_status find_changes(drawn_mesh *d, vxm_error *error) {
  vxm_context *context = d->soup->context;
  vxm_error local = VXM_ERROR_INIT;
  uint8_t *removed = vxm_calloc(context, d->soup->face_count, 1, &local);
  d->added = removed ? vxm_calloc(context, d->repaired->face_count, 1, &local) : NULL;
  if (d->added)
    vxm_mesh_changes(removed, d->added, d->soup, d->repaired, &local);
  for (size_t f = 0; local.code == VXM_OK && f < d->soup->face_count; f++)
    d->flags[f] |= removed[f] ? REMOVED : 0;
  vxm_free(context, removed);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

/** Everything about the faces, and their layers. */
static vxm_status put_faces(drawn_mesh *d, vxm_error *error) {
  vxm_status status = mark_faces(d, error);
  int64_t added = 0;
  if (status == VXM_OK && d->repaired)
    status = find_changes(d, error);
  if (status == VXM_OK)
    status = put_vertices(d, error);
  if (status == VXM_OK)
    status = put_triangles(d, d->soup, "triangles", put_corners, error);
  if (status == VXM_OK)
    status = put_triangles(d, d->soup, "flags", put_flags, error);
  if (status == VXM_OK && d->repaired)
    status = put_triangles(d, d->repaired, "added", put_added, error);
  for (size_t f = 0; status == VXM_OK && d->repaired && f < d->repaired->face_count; f++)
    added += d->added[f];
  add_layer(d, "open parts", "faces", OPEN, count_flag(d, OPEN), "#f2a900",
            "faces of parts that have open edges: sheets, and bodies with holes");
  add_layer(d, "repeated faces", "faces", REPEATED, count_flag(d, REPEATED), "#00a0d0",
            "faces that repeat an earlier one");
  add_layer(d, "taken away by repair", "faces", REMOVED, count_flag(d, REMOVED), "#d04060",
            "faces that the repaired mesh does not have");
  add_layer(d, "added by repair", "added", 0, added, "#20a060", "faces that only the repaired mesh has");
  return status;
}

vxm_status vxm_page_put_mesh(vxm_page *page, const vxm_soup *mesh, const vxm_soup *repaired,
                             vxm_error *error) {
  size_t triangles =
      mesh->corner_count > 2 * mesh->face_count ? mesh->corner_count - 2 * mesh->face_count : 0;
  json_t *about = json_pack("{s:I, s:I, s:I}", "vertices", (json_int_t)mesh->vertex_count, "faces",
                            (json_int_t)mesh->face_count, "triangles", (json_int_t)triangles);
  json_object_set_new(page->about, "mesh", about);
  if (triangles > TRIANGLES_MAX) {
    json_object_set_new(about, "omitted", json_true());
    return VXM_OK;
  }
  drawn_mesh d = {.page = page, .soup = mesh, .repaired = repaired, .layers = json_array()};
  json_object_set_new(about, "layers", d.layers);
  double longest = vxm_space_longest_side(page->space);
  d.scale = longest > 0 ? 1 / longest : 1;
  vxm_error local = VXM_ERROR_INIT;
  d.flags = vxm_calloc(mesh->context, mesh->face_count, 1, &local);
  if (!d.flags)
    vxm_error_pass(error, &local);
  vxm_status status = d.flags ? vxm_defects_find(&d.defects, mesh, SIZE_MAX, false, error) : local.code;
  if (status == VXM_OK)
    status = put_faces(&d, error);
  if (status == VXM_OK)
    status = put_all_defects(&d, error);
  vxm_defects_destroy(d.defects);
  vxm_free(mesh->context, d.added);
  vxm_free(mesh->context, d.flags);
  return status;
}
