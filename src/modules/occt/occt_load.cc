/* SPDX-License-Identifier: BSD-3-Clause */
/** STEP and IGES from memory into a document. */
#include <IGESCAFControl_Reader.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <ShapeExtend.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepShape_SolidModel.hxx>
#include <TCollection_AsciiString.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDataStd_Comment.hxx>
#include <TopoDS_Shape.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <istream>
#include <streambuf>
#include <sys/mman.h>
#include <unistd.h>

#include "base/file.h"
#include "modules/occt/occt.h"

namespace {

/** Keeps the first complaint about a file, without the stars around it. */
class complaints : public Message_Printer {
public:
  std::string first;

protected:
  void send(const TCollection_AsciiString &text, const Message_Gravity gravity) const override {
    std::string line = text.ToCString();
    if (!first.empty() || (gravity < Message_Warning && line.find("ERR") == std::string::npos))
      return;
    const char *const around = "* \t\r\n";
    size_t begin = line.find_first_not_of(around), end = line.find_last_not_of(around);
    if (begin != std::string::npos)
      const_cast<complaints *>(this)->first = line.substr(begin, end - begin + 1);
  }
};

/** A file in memory as a stream. */
class memory_buffer : public std::streambuf {
public:
  memory_buffer(const unsigned char *data, size_t size) {
    char *begin = reinterpret_cast<char *>(const_cast<unsigned char *>(data)); /* never written to */
    setg(begin, begin, begin + size);
  }
};

/** A file in memory under a name, for readers that want one. */
class memory_file {
public:
  memory_file(const unsigned char *data, size_t size) : descriptor(memfd_create("voxmend", MFD_CLOEXEC)) {
    while (descriptor >= 0 && size > 0) {
      ssize_t written = write(descriptor, data, size);
      if (written <= 0) {
        close(descriptor);
        descriptor = -1;
        return;
      }
      data += written;
      size -= static_cast<size_t>(written);
    }
  }
  memory_file(const memory_file &) = delete;
  memory_file &operator=(const memory_file &) = delete;
  ~memory_file() {
    if (descriptor >= 0)
      close(descriptor);
  }
  bool is_open() const {
    return descriptor >= 0;
  }
  std::string path() const {
    return "/proc/self/fd/" + std::to_string(descriptor);
  }

private:
  int descriptor;
};

/** What both loaders have at hand. */
struct load {
  const Handle(TDocStd_Document) & document;
  vxm_soup *soup;
  const vxm_reader_request *request;
  const Handle(vxm_occt_progress) & progress;
  vxm_error *error;
  Handle(complaints) heard = new complaints;

  [[noreturn]] void fail(const char *what) const {
    throw vxm_occt_failure{vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_place{request->name, 0, -1, -1},
                                       "OpenCASCADE cannot read it: %s%s%.200s", what,
                                       heard->first.empty() ? "" : ": ", heard->first.c_str())};
  }
};

bool is_number(const Handle(TCollection_HAsciiString) & text) {
  return !text.IsNull() && !text->IsEmpty() &&
         std::string(text->ToCString()).find_first_not_of("0123456789") == std::string::npos;
}

/** Uses of products that were only counted lose their numbers: the library takes them for names where there
 * are none. */
void forget_numbers(const Handle(Interface_InterfaceModel) & model) {
  Handle(TCollection_HAsciiString) blank = new TCollection_HAsciiString("");
  for (int e = 1; e <= model->NbEntities(); e++) {
    Handle(StepRepr_NextAssemblyUsageOccurrence) use =
        Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(model->Value(e));
    if (use.IsNull() || !is_number(use->Id()))
      continue;
    if (!use->Name().IsNull() && use->Name()->IsSameString(use->Id()))
      use->SetName(blank);
    use->SetId(blank);
  }
}

/** Notes the names of bodies beside those of the products that they are or belong to: the library makes an
 * assembly of a product that has several. */
void name_bodies(const Handle(TDocStd_Document) & document, const Handle(XSControl_WorkSession) & session) {
  Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  Handle(Interface_InterfaceModel) model = session->Model();
  Handle(Transfer_TransientProcess) made = session->TransferReader()->TransientProcess();
  for (int e = 1; e <= model->NbEntities(); e++) {
    Handle(StepShape_SolidModel) body = Handle(StepShape_SolidModel)::DownCast(model->Value(e));
    if (body.IsNull() || body->Name().IsNull() || body->Name()->IsEmpty())
      continue;
    TopoDS_Shape shape = TransferBRep::ShapeResult(made, body);
    TDF_Label label;
    if (!shape.IsNull() && shapes->FindShape(shape, label))
      TDataStd_Comment::Set(label, TCollection_ExtendedString(body->Name()->ToCString(), true));
  }
}

void load_step(const load &job) {
  STEPCAFControl_Reader reader; /* its controller makes the parameter known that is set next */
  Interface_Static::SetIVal("read.stepcaf.subshapes.name", 1);
  reader.SetNameMode(true);
  reader.SetColorMode(false);
  reader.SetLayerMode(false);
  reader.SetPropsMode(false);
  reader.SetSHUOMode(false);
  reader.SetGDTMode(false);
  reader.SetMatMode(false);
  reader.SetViewMode(false);
  memory_buffer buffer(job.request->data, job.request->size);
  std::istream stream(&buffer);
  if (reader.ChangeReader().ReadStream(job.request->name, stream) != IFSelect_RetDone)
    job.fail("no STEP file");
  forget_numbers(reader.Reader().WS()->Model());
  Handle(TDocStd_Document) document = job.document;
  bool is_done = reader.Transfer(document, job.progress->Start());
  job.progress->check();
  if (!is_done)
    job.fail("its shapes cannot be made");
  name_bodies(job.document, reader.Reader().WS());
}

void load_iges_from(const load &job, const char *path) {
  IGESCAFControl_Reader reader;
  reader.SetNameMode(true);
  reader.SetColorMode(false);
  reader.SetLayerMode(false);
  if (reader.ReadFile(path) != IFSelect_RetDone || reader.NbRootsForTransfer() == 0)
    job.fail("no IGES file with shapes");
  Handle(TDocStd_Document) document = job.document;
  bool is_done = reader.Transfer(document, job.progress->Start());
  job.progress->check();
  if (!is_done)
    job.fail("its shapes cannot be made");
}

void load_iges(const load &job) {
  if (job.request->path)
    return load_iges_from(job, job.request->path);
  memory_file file(job.request->data, job.request->size);
  if (!file.is_open())
    throw vxm_occt_failure{vxm_fail_at(job.error, VXM_ERROR_MEMORY, vxm_place{job.request->name, 0, -1, -1},
                                       "not enough memory for a copy of the file")};
  load_iges_from(job, file.path().c_str());
}

} // namespace

void vxm_occt_prepare() {
  STEPCAFControl_Reader step;
  IGESCAFControl_Reader iges;
  ShapeExtend::Init();
  Handle(TDocStd_Document) document;
  Handle(XCAFApp_Application) application = XCAFApp_Application::GetApplication();
  application->NewDocument("MDTV-XCAF", document);
  application->Close(document);
}

void vxm_occt_load(const Handle(TDocStd_Document) & document, vxm_soup *soup,
                   const vxm_reader_request *request, const Handle(vxm_occt_progress) & progress,
                   vxm_error *error) {
  load job{document, soup, request, progress, error};
  Message::DefaultMessenger()->AddPrinter(job.heard);
  if (request->hint[0] == 'i')
    load_iges(job);
  else
    load_step(job);
  Message::DefaultMessenger()->RemovePrinter(job.heard);
  if (!job.heard->first.empty())
    vxm_warn(&soup->warnings, "OpenCASCADE: %.200s", job.heard->first.c_str());
}
