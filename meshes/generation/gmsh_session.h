#pragma once

#include <string>

namespace softfinger::meshes {

/// gmsh has one global state. The first session initialises it, without messages and with one
/// thread, so that it makes the same mesh every time. Each session opens a model of its own and
/// removes it at its end.
class GmshSession {
 public:
  explicit GmshSession(const std::string& model_name);
  ~GmshSession();
  GmshSession(const GmshSession&) = delete;
  GmshSession& operator=(const GmshSession&) = delete;
};

}  // namespace softfinger::meshes
