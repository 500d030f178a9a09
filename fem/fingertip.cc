#include "fem/fingertip.h"

#include <Eigen/Geometry>

#include "meshes/generation/fingertip_layer.h"

namespace softfinger::fem {
namespace {

class BentLayer : public LayerShape {
 public:
  explicit BentLayer(meshes::FingertipLayer layer) : layer_(std::move(layer)) {}

  Eigen::Vector3d position(double x, double y, double z) const override {
    return layer_.position(h() * x, h() * y, z) / h();
  }
  Eigen::Vector3d normal(double x, double y) const override {
    return layer_.normal(h() * x, h() * y);
  }
  double area_ratio(double x, double y) const override {
    const Eigen::Matrix3d gradient = layer_.gradient(h() * x, h() * y, 0);
    return gradient.col(0).cross(gradient.col(1)).norm();
  }
  bool symmetric() const override { return layer_.symmetric(); }

 private:
  double h() const { return layer_.thickness(); }
  meshes::FingertipLayer layer_;
};

}  // namespace

FingertipShape shape_fingertip(const Fingertip& fingertip, double thickness_m) {
  meshes::FingertipLayer layer(fingertip.pad, thickness_m);
  FingertipShape result;
  result.reach_x = layer.reach_x() / thickness_m;
  result.reach_y = layer.reach_y() / thickness_m;
  result.shape = std::make_shared<BentLayer>(std::move(layer));
  return result;
}

}  // namespace softfinger::fem
