#pragma once

#include "fem/layer/layer_space.h"

namespace softfinger::fem {

/// While it exists, a space's mesh and bending are in metres instead of h, for output.
class MeshInMetres {
 public:
  MeshInMetres(LayerSpace& space, double thickness_m);
  ~MeshInMetres();
  MeshInMetres(const MeshInMetres&) = delete;
  MeshInMetres& operator=(const MeshInMetres&) = delete;

 private:
  LayerSpace& space_;
  double thickness_m_;
};

}  // namespace softfinger::fem
