#include "meshes/generation/gmsh_session.h"

#include <dlfcn.h>
#include <gmsh.h>

#include <cstdlib>

namespace softfinger::meshes {
namespace {
int open_sessions = 0;

/// Keeps gmsh from changing files of the user.
/// - gmsh's graphics library FLTK rewrites its preference files when it first reads them. These are
///   the user's, and for root those in /etc. Here FLTK is made to believe that they have been read.
/// - At its end gmsh removes a file of its own from the home folder. It is given a home folder
///   that cannot contain files.
void leave_the_users_files_alone() {
  // The flag is private to FLTK 1.3, which has no other switch. A gmsh without FLTK does not have
  // it.
  if (void* const options_read = dlsym(RTLD_DEFAULT, "_ZN2Fl13options_read_E"))
    *static_cast<unsigned char*>(options_read) = 1;
  setenv("GMSH_HOME", "/dev/null", 1);
}

}  // namespace

GmshSession::GmshSession(const std::string& model_name) {
  if (open_sessions++ == 0) {
    leave_the_users_files_alone();
    gmsh::initialize(0, nullptr, /*readConfigFiles=*/false);
  }
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
