/* SPDX-License-Identifier: BSD-3-Clause */
/** What the files of the OpenCASCADE module share. C++ within the module only. */
#ifndef VXM_MODULES_OCCT_OCCT_H
#define VXM_MODULES_OCCT_OCCT_H

#include <Message_ProgressIndicator.hxx>
#include <TDocStd_Document.hxx>
#include <string>

#include "sandbox/reader.h"

/** A failure on its way to the caller: the status is returned, the error filled. */
struct vxm_occt_failure {
  vxm_status status;
};

/** Tells progress, and remembers whether it was asked to stop. */
class vxm_occt_progress : public Message_ProgressIndicator {
public:
  vxm_occt_progress(vxm_context *given_context, vxm_error *given_error)
      : context(given_context), error(given_error) {
  }
  /** Throws if the work is to stop; libraries end their loops at the next UserBreak. */
  void check() const;

protected:
  Standard_Boolean UserBreak() override;
  void Show(const Message_ProgressScope &scope, const Standard_Boolean is_forced) override;

private:
  vxm_context *context;
  vxm_error *error;
  vxm_status status = VXM_OK;
};

/** Reads the file into a document of shapes, names and places. Throws vxm_occt_failure. */
void vxm_occt_load(const Handle(TDocStd_Document) & document, vxm_soup *soup,
                   const vxm_reader_request *request, const Handle(vxm_occt_progress) & progress,
                   vxm_error *error);

/** Makes the library read its message files and settings, and look up what it writes into headers. */
void vxm_occt_prepare();

/** Turns the shapes of a document into triangles. Throws vxm_occt_failure. */
void vxm_occt_tessellate(vxm_soup *soup, const Handle(TDocStd_Document) & document, double deflection,
                         const Handle(vxm_occt_progress) & progress, vxm_error *error);

#endif
