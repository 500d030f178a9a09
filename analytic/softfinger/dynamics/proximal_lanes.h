#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "softfinger/dynamics/contact_operator.h"
#include "softfinger/dynamics/proximal_course.h"
#include "softfinger/dynamics/velocity_factor.h"

/// Internal: proximal points from several starts at once.
namespace softfinger::internal {

/// ExactNewton::approach with friction of the unit ball, from kLanes starts at once: each has a
/// lane of the processor's vectors. An iteration of a lane costs a third of one alone with eight
/// lanes in an instruction (AVX-512), half with four (AVX2, FMA). The bits do not depend on it, nor
/// on what the other lanes do. Other processors round products and sums once by software, many
/// times slower: there one start after another is the better way.
///
/// Newton's steps are solved in the velocities that the contacts share. With y = L^T dr, of a
/// contact that touches dr = -A^-1 (F + B C L y), of one that opens dr = -r, so that
///   (1 + sum L_i^T A_i^-1 B_i C_i L_i) y = -sum L_i^T A_i^-1 F_i - sum over open ones L_i^T r_i.
/// Rows are not exchanged, because lanes would have to exchange different ones. A lane whose
/// pivots are too small for its digits makes a step that fails, after which its contacts give way
/// more. Velocities are C L L^T r + v_free, so that only a point's residual tells whether it is a
/// solution.
class ProximalLanes {
 public:
  static constexpr int kLanes = 8;

  ProximalLanes();
  ~ProximalLanes();

  /// Takes the memory that it needs: `memory` bytes.
  void begin_problem(const ContactOperator& contacts, const VelocityFactor& factor);
  static double memory(int contacts, int rank);

  /// From this impulse, which may be far away.
  void start(int lane, const Eigen::VectorXd& impulse, int most_iterations);
  void stop(int lane) { lanes_[lane].is_running = false; }
  /// One of Newton's steps in each lane that runs.
  void advance();

  bool is_running(int lane) const { return lanes_[lane].is_running; }
  double best(int lane) const { return lanes_[lane].course.best; }  ///< |F|
  void read_best(int lane, Eigen::VectorXd& impulse) const;

  /// One start's part in it.
  struct Lane {
    bool is_running = false, is_new = false;
    int most_iterations = 0;
    ProximalCourse course;
  };
  /// Lanes of one vector.
  class Vector;

 private:
  Lane lanes_[kLanes];
  std::vector<std::unique_ptr<Vector>> vectors_;
};

}  // namespace softfinger::internal
