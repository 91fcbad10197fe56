/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * write_iges FILE.igs KIND: a block of 10 x 20 x 30 and a cylinder of radius 5 and height 40 beside it, as a
 * list of faces, which is what most IGES files are (KIND 0), or as solids (KIND 1).
 */
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Standard_Failure.hxx>
#include <cstdio>
#include <cstdlib>
#include <gp_Ax2.hxx>

/** OpenCASCADE leaves parameters and translators of IGES behind; not ours to free. */
extern "C" __attribute__((visibility("default"))) const char *__lsan_default_suppressions();
extern "C" const char *__lsan_default_suppressions() {
  return "leak:libTK\n";
}

static bool write(const char *path, int kind) {
  IGESControl_Controller::Init();
  IGESControl_Writer writer("MM", kind);
  writer.AddShape(BRepPrimAPI_MakeBox(10, 20, 30).Shape());
  writer.AddShape(BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(100, 0, 0), gp_Dir(0, 0, 1)), 5, 40).Shape());
  writer.ComputeModel();
  return writer.Write(path);
}

int main(int argc, char **argv) {
  if (argc != 3)
    return 2;
  Message::DefaultMessenger()->ChangePrinters().Clear();
  try {
    return write(argv[1], atoi(argv[2])) ? 0 : 1;
  } catch (const Standard_Failure &failure) {
    fprintf(stderr, "write_iges: %s\n", failure.GetMessageString());
    return 1;
  }
}
