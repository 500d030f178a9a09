#include "fem/finite/full_slip.h"

namespace softfinger::fem::finite {

Eigen::Vector3d relative(const FrictionWrench& wrench, double force, double torque) {
  return {wrench.force_x / force, wrench.force_y / force, wrench.torque / torque};
}

FullSlip full_slip(const SuperposedSlide& superposed, const PlaneMotion& velocity,
                   const std::vector<SolvedSlide>& solutions, double force, double torque) {
  const auto of_superposed = [&](double share) {
    return relative(superposed.slide(velocity, share).wrench, force, torque);
  };
  const auto neglected = [&](const SolvedSlide& solution) -> Eigen::Vector3d {
    const double share = solution.share;
    return (relative(solution.wrench, force, torque) - of_superposed(share)) /
           (share * share * share);
  };
  const SolvedSlide& last = solutions.back();
  FullSlip result;
  result.neglected = neglected(last);
  // One solution alone does not tell how c changes.
  result.added = (1 / (last.share * last.share) - 1) * result.neglected.cwiseAbs().maxCoeff();
  if (solutions.size() > 1) {
    const SolvedSlide& before = solutions[solutions.size() - 2];
    const Eigen::Vector3d growth =
        (result.neglected - neglected(before)) * ((1 - last.share) / (last.share - before.share));
    result.neglected += growth;
    result.added = growth.cwiseAbs().maxCoeff();
  }
  result.wrench = of_superposed(1) + result.neglected;
  return result;
}

}  // namespace softfinger::fem::finite
