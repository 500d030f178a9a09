#include "softfinger/dynamics/step/contact_lcp_solver.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "softfinger/dynamics/contacts/contact_residual.h"
#include "softfinger/dynamics/exact/exact_solver.h"
#include "softfinger/dynamics/facets/facet_solver.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

using internal::all_finite;
using internal::ContactStart;
using internal::ExactSolver;
using internal::FacetSolver;
using internal::is_exact;

[[noreturn]] void refuse(const char* field, const std::string& value, const std::string& allowed) {
  throw InputError("contact problem", field, value, allowed);
}

void check_sizes(const ContactLcp& problem, int contact_capacity, int vertex_capacity) {
  const int nc = problem.contacts(), u = int(problem.vertices.cols());
  if (nc > contact_capacity)
    refuse("contacts", std::to_string(nc), "at most " + std::to_string(contact_capacity));
  if (!is_exact(problem) && u > vertex_capacity)
    refuse("vertices", std::to_string(u), "at most " + std::to_string(vertex_capacity));
  if (problem.delassus.rows() != 4 * nc || problem.delassus.cols() != 4 * nc ||
      problem.free_velocity.size() != 4 * nc || problem.eccentricity_m.size() != nc)
    refuse("size", "", "4 rows per contact and one friction coefficient, one e_n");
  if (problem.root.cols() > 0 && problem.root.rows() != 4 * nc)
    refuse("G", std::to_string(problem.root.rows()) + " rows", "4 rows per contact");
  if (problem.friction_rule == FrictionRule::limit_surface && int(problem.shapes.size()) != nc)
    refuse("shapes", std::to_string(problem.shapes.size()), "one per contact");
}

void check_values(const ContactLcp& problem) {
  if (!all_finite(problem.delassus)) refuse("W", "", "finite numbers");
  for (Eigen::Index column = 0; column < problem.root.cols(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator one(problem.root, column); one; ++one)
      if (!std::isfinite(one.value())) refuse("G", "", "finite numbers");
  if (!all_finite(problem.free_velocity)) refuse("free velocity", "", "finite numbers");
  if (!is_exact(problem) && !all_finite(problem.vertices)) refuse("V", "", "finite numbers");
  for (int i = 0; i < problem.contacts(); ++i) {
    const double mu = problem.friction_coefficient[i], arm_m = problem.eccentricity_m[i];
    const double inverse_mass = problem.delassus(4 * i, 4 * i);
    if (!(mu >= 0 && std::isfinite(mu)))
      refuse("mu", std::to_string(mu), "finite numbers >= 0, one per contact");
    if (!(arm_m >= 0 && std::isfinite(arm_m)))
      refuse("en", std::to_string(arm_m), "finite numbers >= 0, one per contact");
    if (!(inverse_mass > 0))
      refuse("W_nn", std::to_string(inverse_mass) + " of contact " + std::to_string(i),
             "> 0: one of the two bodies has to be movable");
  }
}

/// The last problem, and what the next one continues of it.
class LastProblem {
 public:
  explicit LastProblem(int contact_capacity)
      : impulse_(4 * contact_capacity), continued_impulse_(4 * contact_capacity) {}

  void check_continued(const ContactLcp& problem, const std::vector<int>& continued) const {
    if (int(continued.size()) != problem.contacts())
      refuse("continued", std::to_string(continued.size()), "one per contact");
    for (const int contact : continued)
      if (contact < -1 || contact >= contacts_)
        refuse("continued", std::to_string(contact), "a contact of the last problem, or -1");
  }

  /// The start of a problem of exact friction whose contacts continue those of the last one.
  ContactStart start(const ContactLcp& problem, const std::vector<int>& continued) {
    if (rule_ != problem.friction_rule) return {};
    bool is_next_step = true;
    for (int i = 0; i < problem.contacts(); ++i) {
      const int before = continued[std::size_t(i)];
      is_next_step = is_next_step && before == i;
      auto own = continued_impulse_.segment<4>(4 * i);
      if (before < 0)
        own.setZero();
      else
        own = impulse_.segment<4>(4 * before);
    }
    return {&continued_impulse_, is_next_step};
  }

  void keep(const ContactLcp& problem, const ContactSolution& solution) {
    contacts_ = problem.contacts();
    rule_ = problem.friction_rule;
    impulse_.head(4 * contacts_) = solution.impulse;
  }

 private:
  int contacts_ = -1;  ///< -1: there was none
  FrictionRule rule_ = FrictionRule::facets;
  Eigen::VectorXd impulse_, continued_impulse_;  ///< in the problem's units
};

}  // namespace

void ContactSolution::resize(int contacts) {
  impulse.setZero(4 * contacts);
  velocity.setZero(4 * contacts);
  slip.setZero(contacts);
  ray.setZero(4 * contacts);
  weights.clear();
  weights.reserve(std::size_t(4 * contacts));
}

struct ContactLcpSolver::Workspace {
  Workspace(int contacts, int vertices)
      : contact_capacity(contacts), vertex_capacity(vertices), exact(contacts), last(contacts) {
    if (vertices > 0) facets.emplace(contacts, vertices);
  }

  int contact_capacity, vertex_capacity;
  std::optional<FacetSolver> facets;  ///< of problems with facets
  ExactSolver exact;
  LastProblem last;
};

ContactLcpSolver::ContactLcpSolver(int largest_contacts, int largest_vertices)
    : workspace_(std::make_unique<Workspace>(std::max(largest_contacts, 0),
                                             std::max(largest_vertices, 0))) {}
ContactLcpSolver::~ContactLcpSolver() = default;
ContactLcpSolver::ContactLcpSolver(ContactLcpSolver&&) noexcept = default;
ContactLcpSolver& ContactLcpSolver::operator=(ContactLcpSolver&&) noexcept = default;

LcpResult ContactLcpSolver::solve(const ContactLcp& problem, ContactSolution& solution,
                                  const std::vector<int>* continued) {
  Workspace& work = *workspace_;
  check_sizes(problem, work.contact_capacity, work.vertex_capacity);
  check_values(problem);
  if (continued) work.last.check_continued(problem, *continued);
  solution.resize(problem.contacts());
  LcpResult result;
  if (is_exact(problem)) {
    const ContactStart start = continued ? work.last.start(problem, *continued) : ContactStart();
    result = work.exact.solve(problem, start, solution);
  } else {
    if (!work.facets) work.facets.emplace(work.contact_capacity, work.vertex_capacity);
    result = work.facets->solve(problem, problem.vertices, solution);
  }
  work.last.keep(problem, solution);
  return result;
}

}  // namespace softfinger
