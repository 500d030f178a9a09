#include "fem/levels/mesh_size.h"

#include <algorithm>
#include <cmath>

#include "fem/base/formatted.h"
#include "fem/problem/check_problem.h"

namespace softfinger::fem {

double rounded(double semi_axis) {
  constexpr double step = 1e-3;
  return std::exp(step * std::round(std::log(semi_axis) / step));
}

void fit_to(double a, double b, LayerDiscretisation& mesh) {
  mesh.a = rounded(a);
  mesh.b = rounded(b);
}

double misfit(const LayerDiscretisation& mesh, double a, double b) {
  return std::max(std::abs(std::log(a / mesh.a)), std::abs(std::log(b / mesh.b)));
}

void check_reach(const LayerDiscretisation& mesh, const Problem& problem) {
  if (mesh.is_within_reach()) return;
  const Eigen::Vector2d reach = mesh.needed_reach();
  const double mm = 1e3 * problem.contact.layer.thickness_m;
  throw too_much(problem,
                 formatted("less, or a larger pad: the contact needs the finger's surface up to "
                           "%.3g x %.3g mm from the contact point, and a layer fits on it up to "
                           "%.3g x %.3g mm",
                           mm * reach.x(), mm * reach.y(), mm * mesh.reach_x, mm * mesh.reach_y));
}

void tell_unknowns(const std::string& name, const LayerDiscretisation& mesh,
                   const ContactPhysics& physics, const ContactTask& task) {
  if (task.problem.mesh)
    task.progress(formatted("%s: the mesh from outside makes %ld unknowns", name.c_str(),
                            physics.predicted_unknowns(mesh)));
}

}  // namespace softfinger::fem
