#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "fem/base/ordered_progress.h"
#include "fem/base/outcome.h"
#include "fem/base/progress.h"
#include "fem/contact/pressing.h"
#include "fem/levels/error_model.h"
#include "fem/levels/friction_levels.h"
#include "fem/problem/problem.h"
#include "fem/problem/result.h"

namespace softfinger::fem {

/// The problem that a solver is given, and the functions by which it reports progress and asks
/// whether to stop. They outlive the solver.
struct ContactTask {
  const Problem& problem;
  const Pressing& pressing;  ///< the same in units of the layer
  OrderedProgress progress;
  const StopRequested& stop;
};

/// The size of a contact on its mesh, in units of h.
struct RoughSize {
  double a = 0, b = 0;  ///< from second moments: rough but robust
  double approach = 0;
  bool reaches_rim = false;  ///< of the region where contact is possible: it may be larger
  long unknowns = 0;
  std::string effort;  ///< what it took, for a line of progress: ", iterations 7"
};

/// One mesh's answer.
struct Measurement {
  LevelResult result;
  double block_a = 0, block_b = 0;  ///< semi-axes along the surface, in h, for the next mesh
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< of the pressure, across the load, in h
  double residual = 0;  ///< worst of the equilibrium's and the contact's, relative
  std::optional<LevelResult> frictionless;  ///< where `result` is pressed with friction
  /// Contact as trials and other walls are pressed, where that is another one: without
  /// friction to the approach that is given, not to the load that friction makes of it.
  std::optional<LevelResult> compared;
};

/// The load was not reached on a mesh, which may be far too wide and coarse for it.
struct NotReached {
  ConvergenceError error;  ///< for a caller that has no other mesh
  /// Semi-axes of the contact at the last load that converged, in h; 0: none did.
  double a = 0, b = 0;
};

/// Why a contact is not pressed on a mesh.
using Obstacle = std::variant<NotReached, FoldedLayer>;

/// The line that tells a user of it.
std::string message_of(const Obstacle& obstacle);

/// Sets what the result takes from the shape of the contact.
void set_shape(const ContactShape& shape, double thickness_m, double youngs_modulus_Pa,
               LevelResult& result);

/// The pressure at a surface node, in units of E; lengths in h.
struct PressurePoint {
  double block_x = 0, block_y = 0;  ///< of the node in the undeformed block
  double x = 0, y = 0;              ///< where the pressure is reported
  double pressure = 0;
  /// The node as it is seen along the load, with its force along the load, in units of E h², and
  /// its share of the area, in h².
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double force = 0, area = 0;
  /// Friction on the layer while it is pressed, seen along the load, in units of E h².
  Eigen::Vector2d friction = Eigen::Vector2d::Zero();
};

/// Files that were written; empty where none was asked for.
struct OutputFiles {
  std::string vtu, pvd;
};

/// A contact that can be pressed on one mesh after the other: what the level loop needs to know of
/// linear elasticity and of finite strain. The methods from `size` on refer to the mesh that was
/// pressed last.
class ContactPhysics {
 public:
  virtual ~ContactPhysics() = default;

  virtual const ErrorTable& error_table() const = 0;
  /// The unknowns of a mesh from outside with its cells halved as `press` would.
  virtual long predicted_unknowns(const LayerDiscretisation& mesh) const = 0;

  /// The two levels have their meshes already, made for an earlier contact of the run.
  virtual bool shares_meshes() const { return false; }

  /// Whether the last trial mesh serves as level 0 as well. Otherwise level 0 gets a mesh made for
  /// the size that the trial found.
  virtual bool trial_is_level_0() const = 0;

  /// Applies the whole load on a mesh. The mesh before is released first, so that its
  /// memory is free.
  /// @param level  0 on trial meshes too
  /// @param mesh   not looked at where meshes are shared
  /// @returns none where the contact is pressed; after an obstacle nothing may be asked of it but
  /// to
  ///          press again
  /// @throws InputError, ConvergenceError, NotEnoughMemory
  virtual std::optional<Obstacle> press(const LayerDiscretisation& mesh, int level) = 0;

  /// Presses the contact once more, with friction, on a mesh that bore it without. Physics for
  /// which that costs much leave it to the levels: trial meshes, other walls and other readings of
  /// a scan are compared without friction.
  /// @throws InputError, ConvergenceError, NotEnoughMemory
  virtual std::optional<Obstacle> rub() { return std::nullopt; }
  virtual bool rubs_on_levels_only() const { return false; }

  virtual RoughSize size() const = 0;

  /// Whether a contact comes so near the layer's end that a clamped wall would be touched.
  /// @throws InputError where the finger ends there
  virtual std::optional<FoldedLayer> end_beside() const = 0;

  /// Presses another contact, nearly the same, with the same physics on a mesh of its own.
  /// @throws InputError, ConvergenceError, NotEnoughMemory
  using PressOther = std::function<Outcome<std::unique_ptr<ContactPhysics>, Obstacle>(
      const ContactTask& other, const LayerDiscretisation& mesh)>;
  /// Starts from what is pressed now. Another thread may call it while this contact goes on.
  virtual PressOther press_other() = 0;

  /// The discretisation of the mesh pressed last.
  virtual const LayerDiscretisation& discretisation() const = 0;

  /// @throws ConvergenceError, InputError
  virtual Outcome<Measurement, Unmeasured> measure() = 0;

  /// @pre measured
  /// @param plan      made here when it has none, by the first level, and followed by the next
  /// @param has_room  whether the mesh can be made with a larger patch
  /// @throws EdgeLeftMargin where friction moves the contact's edge out of the patch and the answer
  /// would suffer; without room only where there is none
  virtual FrictionOfLevel friction(std::optional<FrictionPlan>& plan, bool has_room) = 0;

  virtual std::vector<PressurePoint> pressures() const = 0;

  /// Writes the files that the problem asks for. @throws InputError
  virtual OutputFiles write_files() = 0;
};

}  // namespace softfinger::fem
