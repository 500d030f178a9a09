#include "meshes/generation/gmsh_session.h"

#include <gmsh.h>

namespace softfinger::meshes {
namespace {
int open_sessions = 0;
}

GmshSession::GmshSession(const std::string& model_name) {
  if (open_sessions++ == 0) gmsh::initialize(0, nullptr, /*readConfigFiles=*/false);
  gmsh::option::setNumber("General.Terminal", 0);
  gmsh::option::setNumber("General.NumThreads", 1);
  gmsh::model::add(model_name);
}

GmshSession::~GmshSession() {
  try {
    gmsh::model::remove();
    if (--open_sessions == 0) gmsh::finalize();
  } catch (...) {  // nothing is left to clean up that a destructor could report
  }
}

}  // namespace softfinger::meshes
