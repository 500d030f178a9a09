#include "fem/finite/solved_slides.h"

#include <Eigen/QR>
#include <algorithm>
#include <utility>

#include "fem/base/formatted.h"

namespace softfinger::fem::finite {

SolvedSlides::SolvedSlides(FinitePressing& pressed, const FrictionBound& bound, bool has_room,
                           double force, double torque, double aim,
                           std::function<void(const std::string&)> on_failure,
                           const Eigen::MatrixXd& tangent)
    : force_(force),
      torque_(torque),
      on_failure_(std::move(on_failure)),
      superposed_(tangent.size() > 0 ? SuperposedSlide(pressed, bound, tangent)
                                     : SuperposedSlide(pressed, bound)),
      solved_(pressed, bound, has_room),
      aim_(aim) {}

SolvedSlides::Neglected SolvedSlides::of(const PlaneMotion& velocity,
                                         const FrictionalPressing::State* guess) {
  std::vector<SolvedSlide> solutions;
  const double share = solved_.slide(
      velocity, aim_,
      [&](double at) {
        solutions.push_back({at, solved_.wrench()});
      },
      guess);
  std::sort(
      solutions.begin(), solutions.end(),
      [](const SolvedSlide& one, const SolvedSlide& other) { return one.share < other.share; });
  if (share < aim_)
    on_failure_(formatted("a slide is solved to %.3g of full friction: %s", share,
                          solved_.failure().c_str()));
  aim_ = std::clamp(share, FrictionalPressing::telling_share, aim_);
  Neglected result;
  result.superposed = superposed_.slide(velocity).wrench;
  if (solutions.empty()) {
    result.is_known = false;
    return result;
  }
  if (share == 1) result.sheared = solved_.sheared();
  const FullSlip full = full_slip(superposed_, velocity, solutions, force_, torque_);
  result.wrench = {full.neglected.x() * force_, full.neglected.y() * force_,
                   full.neglected.z() * torque_};
  result.inferred = full.added;
  return result;
}

namespace {

/// Some of the velocities, evenly spread, each followed by the nearest of the others.
/// @param wrenches  a row for each velocity, relative
std::vector<Eigen::Index> tour(const Eigen::MatrixX3d& wrenches, Eigen::Index count) {
  std::vector<Eigen::Index> result;
  for (Eigen::Index k = 0; k < count; ++k) result.push_back(k * wrenches.rows() / count);
  for (auto last = result.begin(); last + 1 < result.end(); ++last)
    std::iter_swap(last + 1, std::min_element(last + 1, result.end(), [&](auto one, auto other) {
                     return (wrenches.row(one) - wrenches.row(*last)).norm() <
                            (wrenches.row(other) - wrenches.row(*last)).norm();
                   }));
  return result;
}

}  // namespace

std::vector<SolvedSlides::Neglected> SolvedSlides::of(const std::vector<PlaneMotion>& velocities,
                                                      double& spread) {
  const auto all = static_cast<Eigen::Index>(velocities.size());
  Eigen::MatrixX3d wrenches(all, 3);
  for (Eigen::Index i = 0; i < all; ++i)
    wrenches.row(i) = relative(superposed_.slide(velocities[static_cast<std::size_t>(i)]).wrench,
                               force_, torque_);
  const std::vector<Eigen::Index> chosen =
      tour(wrenches, std::min(all, static_cast<Eigen::Index>(most_solved)));
  std::vector<Neglected> result(velocities.size());
  Eigen::MatrixX3d solved(chosen.size(), 3);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const auto i = static_cast<std::size_t>(chosen[k]);
    result[i] = of(velocities[i]);
    solved.row(static_cast<Eigen::Index>(k)) = relative(result[i].wrench, force_, torque_);
  }
  if (chosen.size() == velocities.size()) return result;
  const Eigen::MatrixX3d of_solved = wrenches(chosen, Eigen::all);
  const Eigen::Matrix3d linear = of_solved.colPivHouseholderQr().solve(solved);
  spread = std::max(spread, (of_solved * linear - solved).cwiseAbs().maxCoeff());
  std::vector<bool> is_solved(velocities.size());
  for (const Eigen::Index i : chosen) is_solved[static_cast<std::size_t>(i)] = true;
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    if (is_solved[i]) continue;
    const Eigen::Vector3d guess =
        linear.transpose() * wrenches.row(static_cast<Eigen::Index>(i)).transpose();
    result[i].wrench = {guess.x() * force_, guess.y() * force_, guess.z() * torque_};
  }
  return result;
}

}  // namespace softfinger::fem::finite
