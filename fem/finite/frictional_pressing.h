#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/algebra/fixed_point.h"
#include "fem/finite/finite_layer.h"
#include "fem/finite/finite_pressing.h"
#include "fem/friction/frictional_contact.h"
#include "fem/output/surface_series.h"
#include "fem/problem/result.h"

namespace softfinger::fem::finite {

/// Coulomb friction on a contact at finite strain, solved: the layer is in equilibrium, where it
/// lies deformed, with normal forces and friction; in units of h and E.
///
/// The contact starts as it was pressed without friction; from then on friction resists motions of
/// the object, at constant load and without tilt, and more load (`press_to`). A node that sticks
/// stays at its place on the moving object.
/// One that slips carries the bound of its N in the tangent plane at its present place, against the
/// slip since the last increment. Pressure, touching nodes and friction change together.
///
/// Newton's method with a tangent that is kept while it serves: each iteration is one contact
/// problem with friction on the tangent condensed to the surface, normal and tangential part in
/// turn.
class FrictionalPressing {
 public:
  /// @param pressed   in its equilibrium; friction takes its layer over, and gives it back as it
  ///                  was. Motions are those of a whole layer; a layer with mirror planes can only
  ///                  be pressed
  /// @param has_room  whether a larger patch can be meshed: a motion that needs one then ends with
  ///                  EdgeLeftMargin, otherwise with the last state within the patch
  FrictionalPressing(const FinitePressing& pressed, FrictionBound bound, bool has_room = false);
  ~FrictionalPressing();
  FrictionalPressing(const FrictionalPressing&) = delete;
  FrictionalPressing& operator=(const FrictionalPressing&) = delete;

  /// A state of layer and contact: one in equilibrium, or an iterate of Newton's method.
  struct State {
    std::shared_ptr<const FiniteLayer::State> layer;
    Eigen::Matrix3Xd force;  ///< per node: along the tangents of its frame, and into the layer
    double approach;
  };
  State present() const;

  /// Moves the object from where it is to `motion`, about the contact plane's origin, in one
  /// increment with the slip law at its end, or in shorter ones where that does not converge.
  /// @throws ConvergenceError; the state is then the last one that converged
  void move_to(const PlaneMotion& motion);

  /// Presses the object where it is to this load or approach in one increment, or in shorter ones
  /// where that does not converge. A node that touches keeps its place on the object while it
  /// sticks.
  /// @throws ConvergenceError; the state is then the last one that converged
  void press_to(const Drive& drive);

  /// The places on the object where the nodes stick, or slipped to in the last increment: what the
  /// contact remembers of its way.
  Eigen::Matrix3Xd places() const;
  /// Solves the contact under this load or approach as if its way had led to these places.
  /// @throws ConvergenceError; the state is then the last one that converged
  void settle_at(const Eigen::Matrix3Xd& places, const Drive& drive);

  /// Slides from where the contact was pressed with the given velocity until every point slips. The
  /// object stays where it is. Friction is raised from none, or the slide starts from what those
  /// before let expect, which leads to the same state: nothing of a slide depends on how it was
  /// begun. The nearer their velocities are, the less it takes.
  /// @param aim       share of full friction to stop at. Where it is not all, half of that share is
  ///                  solved too
  /// @param on_share  called with each share that is solved, in its state
  /// @param guess     a state that may be near, where to start the first slide
  /// @returns the share that was reached, mostly `aim`: soft layers under much friction fold before
  /// it. A share that shows how friction's effects grow is not refined further (`telling_share`).
  double slide(
      const PlaneMotion& velocity, double aim = 1,
      const std::function<void(double share)>& on_share = [](double) {},
      const State* guess = nullptr);
  static constexpr double telling_share = 0.5;

  /// Goes back to the contact as it was pressed, without friction.
  void restart();

  /// The wrench of friction alone, about the contact plane's origin.
  FrictionWrench wrench() const;
  /// Share of the touching area that slips, 0 to 1.
  double slip_fraction() const;
  /// The largest nodal force out of balance before the last of Newton's steps over the largest
  /// contact force.
  double out_of_balance() const { return out_of_balance_; }
  ShearedContact sheared() const;
  /// The deformed surface. Slip counts since the contact was pressed.
  RubbedSurface surface() const;
  /// Why the latest motion or slide that went not all the way stopped.
  const std::string& failure() const { return failure_; }
  /// The iterations of Newton's method so far, and the factorisations among them.
  int iterations() const { return iterations_; }
  int factorisations() const { return factorisations_; }

 private:
  struct Touch;
  struct Tangent;
  struct SurfaceStep;
  /// The inputs of Coulomb's problem, per node and along the tangents.
  struct Rubbed {
    const std::vector<Touch>& touching;
    const Eigen::VectorXd& normal_force;
    const Eigen::VectorXd target;  ///< displacement that friction's own has to be where all sticks
    const Eigen::VectorXd moved;   ///< displacement with the present friction
  };
  using Rub = std::function<void(const Rubbed&, Eigen::VectorXd& friction)>;

  /// Friction opposes this velocity everywhere, with a share of its bound.
  struct Slide {
    PlaneMotion velocity;
    double share = 0;
  };
  /// A solved one.
  struct Slid {
    Eigen::Vector3d place;
    State state;
  };

  std::vector<Touch> touches() const;
  Eigen::VectorXd stuck_target(const std::vector<Touch>& touching, double approach) const;
  Rub rub_by_coulomb();
  bool try_motion(const PlaneMotion& motion, const Rub& rub, double tolerance);
  SurfaceStep step_of_surface(const std::vector<Touch>& touching, const Eigen::VectorXd& rest,
                              const Rub& rub);
  SurfaceStep settle_surface(const std::vector<Touch>& touching, const Eigen::VectorXd& rest,
                             const Rub& rub) const;
  void mix(const Eigen::VectorXd& step, FixedPoint& mixing, std::vector<State>& history);
  double advance(
      double& length, double shortest, double enough,
      const std::function<bool(double, bool again)>& try_share,
      const std::function<void(double)>& on_share = [](double) {});
  void extrapolate(const State& earlier, double share);
  Rub rub_of(const Slide& slide) const;
  Eigen::Vector3d place_of(const Slide& slide) const;
  void start_near(const Slide& slide);
  bool combine(const std::vector<State>& states, const Eigen::VectorXd& weights);
  bool start_from(const std::vector<State>& states, const Eigen::VectorXd& weights);
  void remember(const Slide& slide) { slid_.push_back({place_of(slide), present()}); }
  bool go_on_to(const Slide& next);
  bool try_guess(const PlaneMotion& velocity, const State& guess);
  void keep();
  void take_back();
  bool slips(Eigen::Index node) const;
  double projected_area() const;
  double peak_pressure() const;

  std::shared_ptr<FiniteLayer> layer_;
  std::shared_ptr<const RigidObject> object_;
  const double offset_;
  Drive drive_;                ///< of what is meshed
  const FrictionBound bound_;  ///< per node
  const bool has_room_;
  const std::shared_ptr<const FiniteLayer::State> pressed_state_;
  const Eigen::Matrix3Xd pressed_force_;
  const double pressed_approach_;
  Eigen::Matrix3Xd pressed_position_;
  double pressed_area_ = 0, pressed_peak_ = 0;
  double spacing_ = 0;  ///< of the nodes

  // Present:
  Eigen::Matrix3Xd force_;  ///< per node: along the tangents of its frame, and into the layer
  double approach_ = 0;
  double out_of_balance_ = 0;
  PlaneMotion motion_;
  // State at the end of the last increment:
  std::shared_ptr<const FiniteLayer::State> kept_state_;
  Eigen::Matrix3Xd kept_force_, kept_position_;
  double kept_approach_ = 0;
  PlaneMotion kept_motion_;

  std::vector<State> pressed_to_;  ///< ends of the latest load steps, latest first
  std::unique_ptr<Tangent> tangent_;
  std::optional<Slide> slide_;  ///< that the present state is in
  std::vector<Slid> slid_;      ///< the first one without friction
  double arm_ = 0;              ///< lever of a turn's friction, as pressed
  /// Step of friction's share that the last slide ended with: the next one begins with it.
  double ramp_ = 1;
  int iterations_ = 0, factorisations_ = 0;
  std::string failure_;  ///< why the last try did not converge
};

}  // namespace softfinger::fem::finite
