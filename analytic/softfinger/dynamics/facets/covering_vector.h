#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/dynamics/contacts/contact_operator.h"
#include "softfinger/dynamics/facets/contact_pairs.h"
#include "softfinger/dynamics/facets/friction_vertices.h"

/// Internal: the covering vector of the contact problem.
namespace softfinger::internal {

/// d of w = M z + q + d z0: how much z0 adds to each row. Lemke's path depends on d. Where the path
/// of one covering vector fails, that of another one may succeed. Random vectors avoid ties; they
/// are the same in every run.
class CoveringVector {
 public:
  CoveringVector(int contact_capacity, int vertex_capacity);

  /// The random vector with this number: d in [1, 2) for rows P and lambda. Rows of vertices get
  /// theirs when the vertex takes part.
  void choose(int number, int contacts);
  int number() const { return number_; }

  void forget_vertices();
  /// d of a new vertex: nearly the same for all vertices of a contact, within a tenth, so that the
  /// path turns with the slip from vertex to vertex.
  /// @param slot  see ContactPairs
  void cover_vertex(int contact, int vertex, int slot);

  /// Chooses a vector whose path is a straight line to the solution z* with these basic z, if there
  /// is one. It is d = w0 - q, where w0 is zero in the rows of these z. On z = (1 - z0) z* then
  /// w = (1 - z0) w* + z0 w0 for all z0 in [0, 1], so that the line fulfils all conditions.
  ///
  /// In fact w0 is small and random in these rows, which avoids ties. And d > 0 everywhere, so that
  /// the path ends like that of any other covering vector.
  void lead_towards(const int* basic, int k, const ContactOperator& contacts,
                    const FrictionVertices& vertices, const ContactPairs& pairs);

  /// Sets d = 0 in these rows.
  void cover_all_but(const int* rows, int k);

  double normal(int contact) const { return normal_[contact]; }
  double slack(int contact) const { return slack_[contact]; }
  double vertex(int slot) const { return vertex_[std::size_t(slot)]; }
  double least_of_vertices(int contact) const { return least_of_vertices_[contact]; }
  bool covers(int row) const { return !uncovered_[std::size_t(row)]; }
  bool covers_all() const { return uncovered_rows_.empty(); }

 private:
  void set_vertex(int contact, int slot, double value);

  int number_ = 0;
  Eigen::VectorXd normal_, slip_, slack_;
  std::vector<double> vertex_;         ///< by slot, of vertices that take part
  Eigen::VectorXd least_of_vertices_;  ///< per contact; infinity where none takes part
  std::vector<char> uncovered_, is_basic_;
  std::vector<int> uncovered_rows_;  ///< where uncovered_ is true
};

}  // namespace softfinger::internal
