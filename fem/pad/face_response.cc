#include "fem/pad/face_response.h"

#include <cmath>
#include <map>
#include <utility>

#include "fem/algebra/positive_definite.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

using Eigen::Index;

/// Gauss points on the unit interval: exact to degree 7, because the distance from a point is no
/// polynomial.
constexpr std::array<double, 4> gauss_point{0.06943184420297371, 0.33000947820757187,
                                            0.6699905217924281, 0.9305681557970262};
constexpr std::array<double, 4> gauss_weight{0.17392742256872692, 0.3260725774312731,
                                             0.3260725774312731, 0.17392742256872692};

std::array<double, 3> quadratic(double at) {
  return {(1 - at) * (1 - 2 * at), 4 * at * (1 - at), at * (2 * at - 1)};
}
std::array<double, 3> quadratic_slope(double at) { return {4 * at - 3, 4 - 8 * at, 4 * at - 1}; }

/// A quadrature point of a face.
struct FacePoint {
  std::array<double, 9> shape;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double weight = 0;
};

/// Calls `use` with the quadrature points of a biquadratic face.
template <class Use>
void for_each_point(const std::array<int, 9>& face, const Eigen::Matrix2Xd& place, const Use& use) {
  for (std::size_t i = 0; i < gauss_point.size(); ++i)
    for (std::size_t j = 0; j < gauss_point.size(); ++j) {
      const auto u = quadratic(gauss_point[i]), v = quadratic(gauss_point[j]);
      const auto slope_u = quadratic_slope(gauss_point[i]),
                 slope_v = quadratic_slope(gauss_point[j]);
      FacePoint point;
      Eigen::Vector2d along_u = Eigen::Vector2d::Zero(), along_v = along_u;
      for (std::size_t b = 0; b < 3; ++b)
        for (std::size_t a = 0; a < 3; ++a) {
          const Eigen::Vector2d at = place.col(face[a + 3 * b]);
          point.shape[a + 3 * b] = u[a] * v[b];
          point.place += u[a] * v[b] * at;
          along_u += slope_u[a] * v[b] * at;
          along_v += u[a] * slope_v[b] * at;
        }
      point.weight = gauss_weight[i] * gauss_weight[j] *
                     std::abs(along_u.x() * along_v.y() - along_u.y() * along_v.x());
      use(point);
    }
}

/// Displacement of a place by a motion of size 1: along x, y and into the pad.
Eigen::Vector3d moved(int motion, const Eigen::Vector2d& place) {
  switch (motion) {
    case approach:
      return {0, 0, 1};
    case tilt_x:
      return {0, 0, place.x()};
    case tilt_y:
      return {0, 0, place.y()};
    case shear_x:
      return {1, 0, 0};
    case shear_y:
      return {0, 1, 0};
    default:
      return {-place.y(), place.x(), 0};
  }
}

/// The parity of a motion about mirror planes.
Parity parity_of(int motion) {
  return {motion == tilt_x || motion == shear_x || motion == twist,
          motion == tilt_y || motion == shear_y || motion == twist};
}

bool is_of(int motion, Parity parity, MirrorPlanes planes) {
  const Parity own = parity_of(motion);
  return (!planes.x || own.odd_x == parity.odd_x) && (!planes.y || own.odd_y == parity.odd_y);
}

/// Sign of a field's component at a mirror image of a node.
double sign_at(Parity parity, int component, bool mirror_x, bool mirror_y) {
  double sign = 1;
  if (mirror_x && (component == 0) != parity.odd_x) sign = -sign;
  if (mirror_y && (component == 1) != parity.odd_y) sign = -sign;
  return sign;
}

Eigen::Vector2d place_of(const SurfaceNode& node) { return {node.x, node.y}; }

}  // namespace

FaceResponse::FaceResponse(PadModel& model) {
  number_images(model);
  find_mass();
  stuck_ = Eigen::MatrixXd::Zero(size(), face_motions);
  frictionless_ = Eigen::MatrixXd::Zero(size(), 3);
  stuck_resultants_.setZero();
  frictionless_resultants_.setZero();
  const MirrorPlanes planes = model.planes();
  std::vector<Parity> parities = {{}};
  if (planes.x) parities.push_back({true, false});
  if (planes.y) parities.push_back({false, true});
  if (planes.both()) parities.push_back({true, true});
  for (const Parity parity : parities) add_parity(model.face_stiffness(parity), model);
}

void FaceResponse::number_images(const PadModel& model) {
  const auto& nodes = model.nodes();
  const MirrorPlanes planes = model.planes();
  meshed_images_ = planes.images();
  constexpr double on_plane = 1e-9;
  std::vector<std::array<int, 4>> number(nodes.size());
  std::vector<Eigen::Vector2d> places;
  std::vector<double> weights;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Eigen::Vector2d at = place_of(nodes[i]);
    const bool on_x = planes.x && std::abs(at.x()) < on_plane;
    const bool on_y = planes.y && std::abs(at.y()) < on_plane;
    for (int k = 0; k < planes.images(); ++k) {
      const Image image = planes.image(k);
      // On a plane the image is the node itself, which comes first.
      int same = -1;
      for (int earlier = 0; earlier < k && same < 0; ++earlier) {
        const Image other = planes.image(earlier);
        if ((on_x || other.mirror_x == image.mirror_x) &&
            (on_y || other.mirror_y == image.mirror_y))
          same = earlier;
      }
      if (same >= 0) {
        number[i][static_cast<std::size_t>(k)] = number[i][static_cast<std::size_t>(same)];
        continue;
      }
      const int images = (on_x ? 2 : 1) * (on_y ? 2 : 1);
      number[i][static_cast<std::size_t>(k)] = static_cast<int>(image_.size());
      image_.push_back({static_cast<int>(i), image.mirror_x, image.mirror_y, images});
      places.push_back(image.signs().head<2>().cwiseProduct(at));
      weights.push_back(images * nodes[i].weight);
    }
  }
  place_.resize(2, static_cast<Index>(places.size()));
  weight_.resize(place_.cols());
  for (std::size_t i = 0; i < places.size(); ++i) {
    place_.col(static_cast<Index>(i)) = places[i];
    weight_[static_cast<Index>(i)] = weights[i];
  }
  for (int k = 0; k < planes.images(); ++k)
    for (const SurfaceFace& face : model.faces()) {
      faces_.emplace_back();
      for (std::size_t i = 0; i < 9; ++i)
        faces_.back()[i] =
            number[static_cast<std::size_t>(face.node[i])][static_cast<std::size_t>(k)];
    }
}

void FaceResponse::find_mass() {
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& face : faces_)
    for_each_point(face, place_, [&](const FacePoint& point) {
      for (std::size_t a = 0; a < 9; ++a)
        for (std::size_t b = 0; b < 9; ++b)
          entries.emplace_back(face[a], face[b], point.weight * point.shape[a] * point.shape[b]);
    });
  Eigen::SparseMatrix<double> mass(size(), size());
  mass.setFromTriplets(entries.begin(), entries.end());
  mass_ = std::make_unique<Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>>(mass);
  if (mass_->info() != Eigen::Success)
    throw ConvergenceError("pressure of the pad's nodes", 0, 0, "the face's mesh is inverted");
}

void FaceResponse::add_parity(const FaceStiffness& face, const PadModel& model) {
  const auto& nodes = model.nodes();
  std::vector<Index> normal, tangential;
  for (std::size_t i = 0; i < face.node.size(); ++i)
    (face.component[i] == 2 ? normal : tangential).push_back(static_cast<Index>(i));
  NormalStiffness condensed;
  condensed.parity = face.parity;
  condensed.row_of_node.assign(nodes.size(), -1);
  for (std::size_t i = 0; i < normal.size(); ++i)
    condensed
        .row_of_node[static_cast<std::size_t>(face.node[static_cast<std::size_t>(normal[i])])] =
        static_cast<int>(i);
  // Without friction the face's tangential displacements are free.
  {
    Eigen::MatrixXd factor = face.stiffness(tangential, tangential);
    const Eigen::MatrixXd coupling = face.stiffness(tangential, normal);
    if (!factorise_positive_definite(factor))
      throw ConvergenceError("condensation of the pad's face", 0, 0,
                             "its stiffness is not positive definite; is nu too near 1/2?");
    condensed.stiffness = face.stiffness(normal, normal);
    condensed.stiffness.noalias() -= coupling.transpose() * solve_by_factor(factor, coupling);
  }
  Eigen::MatrixXd motions(static_cast<Index>(face.node.size()), face_motions);
  std::vector<Index> own;
  for (int m = 0; m < face_motions; ++m) {
    if (is_of(m, face.parity, model.planes())) own.push_back(m);
    for (std::size_t i = 0; i < face.node.size(); ++i)
      motions(static_cast<Index>(i), m) =
          moved(m, place_of(nodes[static_cast<std::size_t>(face.node[i])]))[face.component[i]];
  }
  const Eigen::MatrixXd own_motions = motions(Eigen::all, own);
  const Eigen::MatrixXd forces = face.stiffness * own_motions;
  stuck_resultants_(own, own) += meshed_images_ * (own_motions.transpose() * forces);
  std::vector<Index> own_tilts;
  for (const Index m : own)
    if (m <= tilt_y) own_tilts.push_back(m);
  const Eigen::MatrixXd tilts = motions(normal, own_tilts);
  const Eigen::MatrixXd tilt_forces = condensed.stiffness * tilts;
  frictionless_resultants_(own_tilts, own_tilts) +=
      meshed_images_ * (tilts.transpose() * tilt_forces);
  for (std::size_t i = 0; i < image_.size(); ++i) {
    const ImageNode& image = image_[i];
    const int row = condensed.row_of_node[static_cast<std::size_t>(image.node)];
    if (row < 0) continue;
    const double share = image.images * sign_at(face.parity, 2, image.mirror_x, image.mirror_y);
    const auto at = static_cast<Index>(i);
    for (std::size_t k = 0; k < own.size(); ++k)
      stuck_(at, own[k]) +=
          share * forces(normal[static_cast<std::size_t>(row)], static_cast<Index>(k));
    for (std::size_t k = 0; k < own_tilts.size(); ++k)
      frictionless_(at, own_tilts[k]) += share * tilt_forces(row, static_cast<Index>(k));
  }
  normal_.push_back(std::move(condensed));
}

Eigen::MatrixXd FaceResponse::frictionless_stiffness() const {
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(size(), size());
  for (const NormalStiffness& of_parity : normal_) {
    // A field's part of this parity, at a node of what is meshed, is the mean over its images.
    std::vector<int> row(image_.size());
    Eigen::VectorXd share(size());
    for (std::size_t i = 0; i < image_.size(); ++i) {
      row[i] = of_parity.row_of_node[static_cast<std::size_t>(image_[i].node)];
      share[static_cast<Index>(i)] =
          image_[i].images * sign_at(of_parity.parity, 2, image_[i].mirror_x, image_[i].mirror_y) /
          meshed_images_;
    }
    for (std::size_t j = 0; j < image_.size(); ++j)
      for (std::size_t i = 0; i < image_.size(); ++i)
        if (row[i] >= 0 && row[j] >= 0)
          whole(static_cast<Index>(i), static_cast<Index>(j)) +=
              meshed_images_ * share[static_cast<Index>(i)] * share[static_cast<Index>(j)] *
              of_parity.stiffness(row[i], row[j]);
  }
  return whole;
}

double FaceResponse::integral(
    const Eigen::VectorXd& pressure,
    const std::function<double(const Eigen::Vector2d&, double)>& of) const {
  double sum = 0;
  for (const auto& face : faces_)
    for_each_point(face, place_, [&](const FacePoint& point) {
      double value = 0;
      for (std::size_t a = 0; a < 9; ++a) value += point.shape[a] * pressure[face[a]];
      sum += point.weight * of(point.place, value);
    });
  return sum;
}

}  // namespace softfinger::fem
