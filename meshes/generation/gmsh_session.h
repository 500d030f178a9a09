#pragma once

#include <string>

namespace softfinger::meshes {

/// gmsh is one global state: a session initialises it when it is the first, silently and on one
/// thread (the same mesh every time), opens a model of its own, and cleans up after itself.
class GmshSession {
 public:
  explicit GmshSession(const std::string& model_name);
  ~GmshSession();
  GmshSession(const GmshSession&) = delete;
  GmshSession& operator=(const GmshSession&) = delete;
};

}  // namespace softfinger::meshes
