/* SPDX-License-Identifier: BSD-3-Clause */
/** The parts of a document, each where the assembly puts it, as triangles. */
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_Triangulation.hxx>
#include <Precision.hxx>
#include <TDF_LabelIndexedMap.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Comment.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <cmath>
#include <vector>

#include "meshio/common/part_names.h"
#include "modules/occt/occt.h"

namespace {

/** Radians by which neighbouring triangles of a curved surface may turn: a circle gets 21 corners at least.
 */
const double angle = 0.3;
/** Edges that belong together lie no farther apart than this part of the model's diagonal. */
const double seam = 1e-6;

/** A place where a part stands; parts are made once, however often they stand. */
struct instance {
  size_t part;
  gp_Trsf where;
  size_t product;   /**< which of the products that stand somewhere it is, or is a body of */
  std::string body; /**< its name as one of several bodies of a product */
};

struct part {
  TDF_Label label;
  TopoDS_Shape shape;
};

class tessellation {
public:
  tessellation(vxm_soup *given_soup, const Handle(TDocStd_Document) & document, vxm_error *given_error)
      : soup(given_soup), shapes(XCAFDoc_DocumentTool::ShapeTool(document->Main())), error(given_error) {
    vxm_tagger_open(&tagger, soup);
  }
  tessellation(const tessellation &) = delete;
  tessellation &operator=(const tessellation &) = delete;
  ~tessellation() {
    vxm_tagger_close(&tagger);
  }

  void gather();
  double diagonal() const;
  void sew(double tolerance);
  void mesh(double deflection, const Handle(vxm_occt_progress) & progress);
  void emit();
  void note_losses() const;

private:
  vxm_soup *soup;
  Handle(XCAFDoc_ShapeTool) shapes;
  vxm_error *error;
  vxm_tagger tagger;
  TDF_LabelIndexedMap known;
  std::vector<part> parts;
  std::vector<instance> instances;
  std::vector<std::string> products; /**< their names, each as often as it stands */
  int64_t bare_faces = 0, loose_edges = 0;

  static std::string name_of(const TDF_Label &label);
  static std::string name_of_body(const TDF_Label &label);
  void gather_label(const TDF_Label &label, const gp_Trsf &outer, const std::string &name);
  void gather_assembly(const TDF_Label &label, const gp_Trsf &outer, const std::string &name);
  void gather_part(const TDF_Label &label, const instance &placed);
  void emit_instance(const instance &placed, uint32_t number);
  void emit_faces(const TopoDS_Shape &shape, TopAbs_ShapeEnum unless_within, const gp_Trsf &where);
  void emit_face(const TopoDS_Face &face, const gp_Trsf &where);
  void require(vxm_status status) const {
    if (status != VXM_OK)
      throw vxm_occt_failure{status};
  }
};

/* ---- The tree of the assembly ---- */

/** Whether a name was given by a person: tools put blanks, "NAUO12" or a pointer to a label there. */
bool is_telling(const std::string &name) {
  if (name.find_first_not_of(" \t") == std::string::npos || name.compare(0, 2, "=>") == 0)
    return false;
  return name.compare(0, 4, "NAUO") != 0 || name.find_first_not_of("0123456789", 4) != std::string::npos;
}

std::string told(const TCollection_ExtendedString &name) {
  std::vector<char> text(static_cast<size_t>(name.LengthOfCString()) + 1, '\0');
  char *begin = text.data();
  name.ToUTF8CString(begin);
  return is_telling(begin) ? begin : "";
}

/** The name of a product or of its use, "" if there is none that tells anything. */
std::string tessellation::name_of(const TDF_Label &label) {
  Handle(TDataStd_Name) name;
  return label.FindAttribute(TDataStd_Name::GetID(), name) ? told(name->Get()) : "";
}

std::string tessellation::name_of_body(const TDF_Label &label) {
  Handle(TDataStd_Comment) name;
  return label.FindAttribute(TDataStd_Comment::GetID(), name) ? told(name->Get()) : name_of(label);
}

void tessellation::gather_label(const TDF_Label &label, const gp_Trsf &outer, const std::string &name) {
  TDF_Label product;
  if (XCAFDoc_ShapeTool::GetReferredShape(label, product)) {
    gp_Trsf where = outer * XCAFDoc_ShapeTool::GetLocation(label).Transformation();
    std::string own = name_of(label);
    gather_label(product, where, own.empty() ? name_of(product) : own);
    return;
  }
  if (XCAFDoc_ShapeTool::IsAssembly(label)) {
    gather_assembly(label, outer, name);
    return;
  }
  products.push_back(name);
  gather_part(label, {0, outer, products.size() - 1, ""});
}

/** Uses of products, or the bodies of a product that has several: those have no use that could be named. */
void tessellation::gather_assembly(const TDF_Label &label, const gp_Trsf &outer, const std::string &name) {
  TDF_LabelSequence components;
  XCAFDoc_ShapeTool::GetComponents(label, components);
  bool has_bodies = false;
  size_t own = 0;
  for (const TDF_Label &component : components) {
    TDF_Label body;
    Handle(TDataStd_Name) use;
    if (component.FindAttribute(TDataStd_Name::GetID(), use) ||
        !XCAFDoc_ShapeTool::GetReferredShape(component, body) || XCAFDoc_ShapeTool::IsAssembly(body)) {
      gather_label(component, outer, "");
      continue;
    }
    if (!has_bodies) {
      own = products.size();
      products.push_back(name);
    }
    has_bodies = true;
    gp_Trsf where = outer * XCAFDoc_ShapeTool::GetLocation(component).Transformation();
    gather_part(body, {0, where, own, name_of_body(body)});
  }
}

void tessellation::gather_part(const TDF_Label &label, const instance &placed) {
  TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
  if (shape.IsNull())
    return;
  size_t index = static_cast<size_t>(known.Add(label)) - 1;
  if (index == parts.size())
    parts.push_back({label, shape});
  instances.push_back(placed);
  instances.back().part = index;
}

void tessellation::gather() {
  TDF_LabelSequence roots;
  shapes->GetFreeShapes(roots);
  for (const TDF_Label &root : roots)
    gather_label(root, gp_Trsf(), name_of(root));
}

/* ---- Triangles ---- */

/** Of the box around all that stands; 0 if there is nothing. */
double tessellation::diagonal() const {
  std::vector<Bnd_Box> boxes(parts.size());
  for (size_t p = 0; p < parts.size(); p++)
    BRepBndLib::Add(parts[p].shape, boxes[p], false);
  Bnd_Box all;
  for (const instance &placed : instances)
    if (!boxes[placed.part].IsVoid())
      all.Add(boxes[placed.part].Transformed(placed.where));
  return all.IsVoid() ? 0.0 : std::sqrt(all.SquareExtent());
}

/** Joins the faces of parts that are no more than lists of them, as in most IGES files. */
void tessellation::sew(double tolerance) {
  for (part &p : parts) {
    TopExp_Explorer shell(p.shape, TopAbs_SHELL);
    if (shell.More())
      continue;
    BRepBuilderAPI_Sewing sewing(tolerance);
    for (TopExp_Explorer face(p.shape, TopAbs_FACE); face.More(); face.Next())
      sewing.Add(face.Current());
    sewing.Perform();
    if (!sewing.SewedShape().IsNull())
      p.shape = sewing.SewedShape();
  }
}

void tessellation::mesh(double deflection, const Handle(vxm_occt_progress) & progress) {
  IMeshTools_Parameters parameters;
  parameters.Deflection = deflection;
  parameters.Angle = angle;
  if (!(parameters.Deflection > 0) || !std::isfinite(parameters.Deflection))
    return;
  Message_ProgressScope scope(progress->Start(), "reading", static_cast<double>(parts.size()));
  for (const part &p : parts) {
    BRepMesh_IncrementalMesh mesher(p.shape, parameters, scope.Next());
    progress->check();
  }
}

/* ---- The soup ---- */

void tessellation::emit_face(const TopoDS_Face &face, const gp_Trsf &where) {
  TopLoc_Location location;
  Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(face, location);
  if (triangles.IsNull()) {
    bare_faces++;
    return;
  }
  gp_Trsf place = where * location.Transformation();
  size_t first = soup->vertex_count;
  for (int n = 1; n <= triangles->NbNodes(); n++) {
    gp_Pnt p = triangles->Node(n).Transformed(place);
    require(vxm_soup_add_vertex(soup, p.X(), p.Y(), p.Z(), error));
  }
  bool is_turned = (face.Orientation() == TopAbs_REVERSED) != place.IsNegative();
  for (int t = 1; t <= triangles->NbTriangles(); t++) {
    int a, b, c;
    triangles->Triangle(t).Get(a, b, c);
    if (is_turned)
      std::swap(b, c);
    uint32_t corners[3] = {static_cast<uint32_t>(first + static_cast<size_t>(a) - 1),
                           static_cast<uint32_t>(first + static_cast<size_t>(b) - 1),
                           static_cast<uint32_t>(first + static_cast<size_t>(c) - 1)};
    require(vxm_tagger_face(&tagger, error));
    require(vxm_soup_add_face(soup, corners, 3, error));
  }
}

void tessellation::emit_faces(const TopoDS_Shape &shape, TopAbs_ShapeEnum unless_within,
                              const gp_Trsf &where) {
  for (TopExp_Explorer face(shape, TopAbs_FACE, unless_within); face.More(); face.Next())
    emit_face(TopoDS::Face(face.Current()), where);
}

/** The names of the bodies of a part that has several stand behind its own, as materials do. */
void tessellation::emit_instance(const instance &placed, uint32_t number) {
  const part &p = parts[placed.part];
  const std::string &product = products[placed.product];
  if (!product.empty() || tagger.named)
    vxm_part_names_tag(&tagger, product.c_str(), number);
  int bodies = 0;
  for (TopExp_Explorer body(p.shape, TopAbs_SOLID); body.More(); body.Next())
    bodies++;
  for (TopExp_Explorer body(p.shape, TopAbs_SOLID); body.More(); body.Next()) {
    TDF_Label label;
    std::string name = placed.body;
    if (bodies > 1 && shapes->FindSubShape(p.label, body.Current(), label))
      name = name_of(label);
    if (!name.empty() || tagger.named)
      vxm_tagger_material(&tagger, reinterpret_cast<const unsigned char *>(name.data()), name.size());
    emit_faces(body.Current(), TopAbs_SHAPE, placed.where);
  }
  if (tagger.named)
    vxm_tagger_material(&tagger, nullptr, 0);
  emit_faces(p.shape, TopAbs_SOLID, placed.where);
  for (TopExp_Explorer edge(p.shape, TopAbs_EDGE, TopAbs_FACE); edge.More(); edge.Next())
    loose_edges++;
}

void tessellation::emit() {
  std::vector<const char *> names;
  for (const std::string &name : products)
    names.push_back(name.c_str());
  std::vector<uint32_t> numbers(names.size());
  require(vxm_part_names_number(numbers.data(), soup->context, names.data(), names.size(), error));
  for (const instance &placed : instances)
    emit_instance(placed, numbers[placed.product]);
  if (soup->face_count == 0)
    vxm_tags_drop(soup);
}

void tessellation::note_losses() const {
  if (bare_faces > 0)
    vxm_warn(&soup->warnings, "OpenCASCADE could not make triangles of %lld faces; they are left out",
             static_cast<long long>(bare_faces));
  if (loose_edges > 0)
    vxm_warn(&soup->warnings, "curves that bound no face are skipped (curves: %lld)",
             static_cast<long long>(loose_edges));
  if (soup->face_count == 0)
    vxm_warn(&soup->warnings, "the file has no faces");
}

} // namespace

void vxm_occt_tessellate(vxm_soup *soup, const Handle(TDocStd_Document) & document, double deflection,
                         const Handle(vxm_occt_progress) & progress, vxm_error *error) {
  tessellation work(soup, document, error);
  work.gather();
  double diagonal = work.diagonal();
  work.sew(std::max(diagonal * seam, Precision::Confusion()));
  work.mesh(deflection * diagonal, progress);
  work.emit();
  work.note_losses();
}
