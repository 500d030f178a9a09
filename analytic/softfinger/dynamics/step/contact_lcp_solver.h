#pragma once

#include <memory>
#include <vector>

#include "softfinger/dynamics/contacts/contact_lcp.h"
#include "softfinger/dynamics/contacts/lcp_result.h"

namespace softfinger {

/// Solves ContactLcp, by one of two solvers:
/// - friction as facets by Lemke's path, the method of the publication (facets/facet_solver.h);
/// - exact friction by proximal points and Newton's method (exact/exact_solver.h). The path is its
///   last start. LcpResult::solved_by records which of its rungs found the solution.
///
/// Each contact is scaled by 1/sqrt(W_nn), so that masses, units and time steps do not matter.
///
/// M is copositive. If v_free is the velocity of bodies, J u, a solution exists (Anitescu, Potra
/// 1997). Prescribed motions can exclude one, such as a body between closing walls. A ray of normal
/// impulses alone proves that (RayProof::infeasible): no impulses at all keep every v_n >= 0. A ray
/// with friction in it (RayProof::ray_only) shows which contacts jam, but a solution may exist.
///
/// Sized once: `solve` then allocates nothing, for solutions that have been resized before. The
/// only exception is exact friction whose first start fails for the first time, which one of ten
/// problems of 100 contacts does.
class ContactLcpSolver {
 public:
  /// @param largest_vertices  of the facets; 0 for exact friction alone
  ContactLcpSolver(int largest_contacts, int largest_vertices);
  ~ContactLcpSolver();
  ContactLcpSolver(ContactLcpSolver&&) noexcept;
  ContactLcpSolver& operator=(ContactLcpSolver&&) noexcept;

  /// `residual` of the result is that of `contact_residual` or `exact_contact_residual`. Solved
  /// means 1e-10 or less. Impulses can be so large that the rounding of W r alone makes more: then
  /// it means four such roundings or less, at most 1e-9.
  /// @param continued  null for a cold start. Else, per contact, the contact of the last problem of
  ///   this object that it continues, or -1 for a new one: a warm start from the last impulses,
  ///   followed by a cold one if that fails. It solves the same problems; if there are several
  ///   solutions it may find another one. Facets always start cold.
  /// @throws InputError for sizes that do not fit each other or the solver, for values that are not
  ///   finite or are negative where they must not be, and for a contact whose bodies cannot move,
  ///   W_nn <= 0.
  LcpResult solve(const ContactLcp& problem, ContactSolution& solution,
                  const std::vector<int>* continued = nullptr);

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace softfinger
