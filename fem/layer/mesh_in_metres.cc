#include "fem/layer/mesh_in_metres.h"

#include <deal.II/grid/grid_tools.h>

namespace softfinger::fem {

MeshInMetres::MeshInMetres(LayerSpace& space, double thickness_m)
    : space_(space), thickness_m_(thickness_m) {
  dealii::GridTools::scale(thickness_m_, space_.triangulation);
  space_.bending *= thickness_m_;
}

MeshInMetres::~MeshInMetres() {
  space_.bending /= thickness_m_;
  dealii::GridTools::scale(1 / thickness_m_, space_.triangulation);
}

}  // namespace softfinger::fem
