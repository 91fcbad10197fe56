/* SPDX-License-Identifier: BSD-3-Clause */
/** The stool as STEP (ISO 10303-21, schema AP214): exact boundaries, products, and where they are used. */
#include "scenes.h"

#include <stdarg.h>
#include <stddef.h>

/** A file under way; entities are known by their numbers. */
typedef struct step_file {
  FILE *file;
  int last;
  int context; /**< units and precision, for all representations */
} step_file;

/** Writes one entity and gives its number. */
static int entity(step_file *out, const char *format, ...) {
  fprintf(out->file, "#%d = ", ++out->last);
  va_list arguments;
  va_start(arguments, format);
  vfprintf(out->file, format, arguments);
  va_end(arguments);
  fprintf(out->file, ";\n");
  return out->last;
}

/* ---- Geometry ---- */

static int point(step_file *out, const double p[3]) {
  return entity(out, "CARTESIAN_POINT('',(%#.9g,%#.9g,%#.9g))", p[0], p[1], p[2]);
}

static int direction(step_file *out, const double d[3]) {
  return entity(out, "DIRECTION('',(%#.9g,%#.9g,%#.9g))", d[0], d[1], d[2]);
}

static int placement(step_file *out, const double at[3], const double axis[3], const double side[3]) {
  int p = point(out, at), a = direction(out, axis), s = direction(out, side);
  return entity(out, "AXIS2_PLACEMENT_3D('',#%d,#%d,#%d)", p, a, s);
}

static const double origin[3] = {0, 0, 0}, x_axis[3] = {1, 0, 0}, z_axis[3] = {0, 0, 1};

/** A straight edge along an axis between two vertices. */
static int straight_edge(step_file *out, int from, int to, const double start[3], const double along[3]) {
  int p = point(out, start), d = direction(out, along);
  int vector = entity(out, "VECTOR('',#%d,1.)", d), line = entity(out, "LINE('',#%d,#%d)", p, vector);
  return entity(out, "EDGE_CURVE('',#%d,#%d,#%d,.T.)", from, to, line);
}

/** A face around the edges of a loop, which looks along its plane's axis or against it. */
static int plane_face(step_file *out, int loop, int axes, bool is_along) {
  int bound = entity(out, "FACE_OUTER_BOUND('',#%d,.T.)", loop), plane = entity(out, "PLANE('',#%d)", axes);
  return entity(out, "ADVANCED_FACE('',(#%d),#%d,%s)", bound, plane, is_along ? ".T." : ".F.");
}

static int oriented(step_file *out, int edge, bool is_forward) {
  return entity(out, "ORIENTED_EDGE('',*,*,#%d,%s)", edge, is_forward ? ".T." : ".F.");
}

/* ---- A block ---- */

typedef struct block {
  double corner[8][3]; /**< bit c of the number: at the far side along axis c */
  int vertex[8];
  int edge[8][3]; /**< from a corner at the near side along an axis to the one at the far side */
} block;

static void block_edges(step_file *out, block *b) {
  for (int v = 0; v < 8; v++)
    b->vertex[v] = entity(out, "VERTEX_POINT('',#%d)", point(out, b->corner[v]));
  for (int v = 0; v < 8; v++)
    for (int axis = 0; axis < 3; axis++) {
      double along[3] = {axis == 0, axis == 1, axis == 2};
      if (!(v >> axis & 1))
        b->edge[v][axis] = straight_edge(out, b->vertex[v], b->vertex[v | 1 << axis], b->corner[v], along);
    }
}

/** The face at one side along an axis, its edges counterclockwise as seen from outside. */
static int block_face(step_file *out, const block *b, int axis, bool is_far) {
  int u = (axis + 1) % 3, v = (axis + 2) % 3, base = is_far ? 1 << axis : 0;
  int low_u = oriented(out, b->edge[base][u], is_far),
      high_u = oriented(out, b->edge[base | 1 << v][u], !is_far);
  int low_v = oriented(out, b->edge[base][v], !is_far),
      high_v = oriented(out, b->edge[base | 1 << u][v], is_far);
  int loop = entity(out, "EDGE_LOOP('',(#%d,#%d,#%d,#%d))", low_u, is_far ? high_v : low_v, high_u,
                    is_far ? low_v : high_v);
  double normal[3] = {0}, side[3] = {0};
  normal[axis] = 1;
  side[u] = 1;
  return plane_face(out, loop, placement(out, b->corner[base], normal, side), is_far);
}

/** A block about the z axis, from z = 0 upward. */
static int make_block(step_file *out, double width, double depth, double height) {
  block b;
  for (int v = 0; v < 8; v++) {
    b.corner[v][0] = v & 1 ? width / 2 : -width / 2;
    b.corner[v][1] = v & 2 ? depth / 2 : -depth / 2;
    b.corner[v][2] = v & 4 ? height : 0;
  }
  block_edges(out, &b);
  int face[6];
  for (int f = 0; f < 6; f++)
    face[f] = block_face(out, &b, f / 2, f % 2);
  int shell = entity(out, "CLOSED_SHELL('',(#%d,#%d,#%d,#%d,#%d,#%d))", face[0], face[1], face[2], face[3],
                     face[4], face[5]);
  return entity(out, "MANIFOLD_SOLID_BREP('',#%d)", shell);
}

/* ---- A cylinder ---- */

static int round_edge(step_file *out, int vertex, double z, double radius) {
  const double at[3] = {0, 0, z};
  int circle = entity(out, "CIRCLE('',#%d,%#.9g)", placement(out, at, z_axis, x_axis), radius);
  return entity(out, "EDGE_CURVE('',#%d,#%d,#%d,.T.)", vertex, vertex, circle);
}

/** The wall: up its seam and down again, between the circles. */
static int wall_face(step_file *out, int bottom, int seam, int top, double radius) {
  int b = oriented(out, bottom, true), up = oriented(out, seam, true), t = oriented(out, top, false),
      down = oriented(out, seam, false);
  int loop = entity(out, "EDGE_LOOP('',(#%d,#%d,#%d,#%d))", b, up, t, down);
  int bound = entity(out, "FACE_OUTER_BOUND('',#%d,.T.)", loop);
  int surface =
      entity(out, "CYLINDRICAL_SURFACE('',#%d,%#.9g)", placement(out, origin, z_axis, x_axis), radius);
  return entity(out, "ADVANCED_FACE('',(#%d),#%d,.T.)", bound, surface);
}

static int lid_face(step_file *out, int circle, double z, bool is_top) {
  const double at[3] = {0, 0, z};
  int loop = entity(out, "EDGE_LOOP('',(#%d))", oriented(out, circle, is_top));
  return plane_face(out, loop, placement(out, at, z_axis, x_axis), is_top);
}

static int make_cylinder(step_file *out, double radius, double height) {
  const double low[3] = {radius, 0, 0}, high[3] = {radius, 0, height};
  int first = entity(out, "VERTEX_POINT('',#%d)", point(out, low));
  int second = entity(out, "VERTEX_POINT('',#%d)", point(out, high));
  int bottom = round_edge(out, first, 0, radius), top = round_edge(out, second, height, radius);
  int seam = straight_edge(out, first, second, low, z_axis);
  int wall = wall_face(out, bottom, seam, top, radius);
  int floor = lid_face(out, bottom, 0, false), lid = lid_face(out, top, height, true);
  int shell = entity(out, "CLOSED_SHELL('',(#%d,#%d,#%d))", wall, floor, lid);
  return entity(out, "MANIFOLD_SOLID_BREP('',#%d)", shell);
}

/* ---- Products ---- */

/** A product: its definition, its representation, and the axes that it is placed by. */
typedef struct product {
  int definition, representation, axes;
} product;

typedef struct product_contexts {
  int product, definition;
} product_contexts;

static product_contexts begin_products(step_file *out) {
  int application = entity(out, "APPLICATION_CONTEXT('automotive design')");
  entity(out, "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#%d)",
         application);
  return (product_contexts){
      entity(out, "PRODUCT_CONTEXT('',#%d,'mechanical')", application),
      entity(out, "PRODUCT_DEFINITION_CONTEXT('part definition',#%d,'design')", application)};
}

static int make_context(step_file *out) {
  int length = entity(out, "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )");
  int angle = entity(out, "( NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.) )");
  int solid = entity(out, "( NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT() )");
  int precision = entity(
      out, "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),#%d,'distance_accuracy_value','')", length);
  return entity(out,
                "( GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#%d)) "
                "GLOBAL_UNIT_ASSIGNED_CONTEXT((#%d,#%d,#%d)) REPRESENTATION_CONTEXT('','') )",
                precision, length, angle, solid);
}

/** `solid` is 0 for an assembly, which has no shape of its own. */
static product make_product(step_file *out, const product_contexts *contexts, const char *name, int solid) {
  product made;
  int item = entity(out, "PRODUCT('%s','%s','',(#%d))", name, name, contexts->product);
  int formation = entity(out, "PRODUCT_DEFINITION_FORMATION('','',#%d)", item);
  made.definition = entity(out, "PRODUCT_DEFINITION('design','',#%d,#%d)", formation, contexts->definition);
  int shape = entity(out, "PRODUCT_DEFINITION_SHAPE('','',#%d)", made.definition);
  made.axes = placement(out, origin, z_axis, x_axis);
  made.representation = solid ? entity(out, "ADVANCED_BREP_SHAPE_REPRESENTATION('',(#%d,#%d),#%d)", made.axes,
                                       solid, out->context)
                              : entity(out, "SHAPE_REPRESENTATION('',(#%d),#%d)", made.axes, out->context);
  entity(out, "SHAPE_DEFINITION_REPRESENTATION(#%d,#%d)", shape, made.representation);
  return made;
}

/** Puts a product into an assembly; `number` tells its uses apart. */
static void use_product(step_file *out, const product *assembly, const product *part, int number,
                        const double at[3]) {
  int where = placement(out, at, z_axis, x_axis);
  int use = entity(out, "NEXT_ASSEMBLY_USAGE_OCCURRENCE('NAUO%d','','',#%d,#%d,$)", number,
                   assembly->definition, part->definition);
  int shape = entity(out, "PRODUCT_DEFINITION_SHAPE('','',#%d)", use);
  int move = entity(out, "ITEM_DEFINED_TRANSFORMATION('','',#%d,#%d)", part->axes, where);
  int relation =
      entity(out,
             "( REPRESENTATION_RELATIONSHIP('','',#%d,#%d) "
             "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#%d) SHAPE_REPRESENTATION_RELATIONSHIP() )",
             part->representation, assembly->representation, move);
  entity(out, "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#%d,#%d)", relation, shape);
}

static void write_stool(step_file *out) {
  product_contexts contexts = begin_products(out);
  out->context = make_context(out);
  product seat = make_product(out, &contexts, "seat", make_block(out, STOOL_WIDTH, STOOL_DEPTH, STOOL_SEAT));
  product leg = make_product(out, &contexts, "leg", make_cylinder(out, STOOL_RADIUS, STOOL_LEG));
  product stool = make_product(out, &contexts, "stool", 0);
  const double top[3] = {0, 0, STOOL_LEG};
  use_product(out, &stool, &seat, 1, top);
  for (int l = 0; l < STOOL_LEGS; l++) {
    double x = STOOL_WIDTH / 2.0 - 50, y = STOOL_DEPTH / 2.0 - 50;
    const double at[3] = {l & 1 ? -x : x, l & 2 ? -y : y, 0};
    use_product(out, &stool, &leg, l + 2, at);
  }
}

bool scene_write_step(FILE *file) {
  step_file out = {.file = file};
  fprintf(file, "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
                "FILE_NAME('stool','2000-01-01T00:00:00',(''),(''),'','voxmend samples','');\n"
                "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n");
  write_stool(&out);
  fprintf(file, "ENDSEC;\nEND-ISO-10303-21;\n");
  return !ferror(file);
}
