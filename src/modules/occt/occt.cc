/* SPDX-License-Identifier: BSD-3-Clause */
/** The module voxmend-occt.so: STEP and IGES through OpenCASCADE. */
#include "modules/occt/occt.h"

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>
#include <Standard_Version.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cstring>
#include <exception>
#include <new>

#include "base/module.h"
#include "config.h"

/* ---- Progress ---- */

Standard_Boolean vxm_occt_progress::UserBreak() {
  return status != VXM_OK;
}

void vxm_occt_progress::Show(const Message_ProgressScope &, const Standard_Boolean) {
  if (status == VXM_OK)
    status = vxm_progress(context, "reading", GetPosition(), error);
}

void vxm_occt_progress::check() const {
  if (status != VXM_OK)
    throw vxm_occt_failure{status};
}

/* ---- The entry ---- */

static void read_document(vxm_soup *soup, const vxm_reader_request *request, vxm_error *error) {
  /* The library prints to standard output unless its printers are taken away. */
  Message::DefaultMessenger()->ChangePrinters().Clear();
  XCAFDoc_ShapeTool::SetAutoNaming(false);
  Handle(XCAFApp_Application) application = XCAFApp_Application::GetApplication();
  Handle(TDocStd_Document) document;
  application->NewDocument("MDTV-XCAF", document);
  Handle(vxm_occt_progress) progress = new vxm_occt_progress(soup->context, error);
  vxm_occt_load(document, soup, request, progress, error);
  vxm_occt_tessellate(soup, document, request->deflection, progress, error);
  application->Close(document);
}

static vxm_status fail(const vxm_reader_request *request, vxm_error *error, const char *reason) {
  return vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_place{request->name, 0, -1, -1},
                     "OpenCASCADE cannot read it: %.200s", reason && *reason ? reason : "no reason given");
}

static vxm_status fail_memory(const vxm_reader_request *request, vxm_error *error) {
  return vxm_fail_at(error, VXM_ERROR_MEMORY, vxm_place{request->name, 0, -1, -1},
                     "not enough memory to read it");
}

extern "C" {

static vxm_status read_cad(vxm_soup *soup, const vxm_reader_request *request, vxm_error *error) {
  try {
    read_document(soup, request, error);
    return VXM_OK;
  } catch (const vxm_occt_failure &failure) {
    return failure.status;
  } catch (const Standard_OutOfMemory &) {
    return fail_memory(request, error);
  } catch (const Standard_Failure &failure) {
    return fail(request, error, failure.GetMessageString());
  } catch (const std::bad_alloc &) {
    return fail_memory(request, error);
  } catch (const std::exception &failure) {
    return fail(request, error, failure.what());
  } catch (...) {
    return fail(request, error, nullptr);
  }
}

/** What fails now fails again, and then there is somebody to tell. */
static void prepare() {
  try {
    Message::DefaultMessenger()->ChangePrinters().Clear();
    vxm_occt_prepare();
  } catch (...) {
  }
}

static const vxm_reader reader = {prepare, read_cad, nullptr};

VXM_API extern const vxm_module vxm_module_table;
const vxm_module vxm_module_table = {VXM_BUILD, "OpenCASCADE " OCC_VERSION_COMPLETE,
                                     "BSD-3-Clause AND LGPL-2.1-only WITH OCCT-exception-1.0", &reader};
}
