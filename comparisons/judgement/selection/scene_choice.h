#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "comparisons/input/scene.h"
#include "comparisons/judgement/selection/model_choice.h"
#include "comparisons/simulation/simulate.h"

/// Chooses the simplest sufficient model for each contact of a scene. The most accurate simulation
/// tells how much of its friction limit each contact uses; a second simulation tells how much the
/// simpler models change the motion.
namespace softfinger::judgement {

/// Detail that the contacts of two bodies need, from less to more.
enum class ContactDetail {
  point,          ///< no torque about the normal, for contacts that hardly carry any
  ellipsoid,      ///< friction ellipsoid, e_n(P) of a pressure model
  six_patches,    ///< six small ellipsoids, e_n(P) of a pressure model
  limit_surface,  ///< the exact limit surface, e_n(P) of a pressure model
  fem_table       ///< e_n(P) from finite elements, with the friction law that is enough
};
extern const char* const kContactDetailNames[5];

/// Two bodies that touch in a scene, one of them soft, over the whole motion. Pairs that are alike
/// (the same layers, friction, and relative radii to 2 %) are one for the choice: each has the
/// largest load, utilisation, torsion and surface change of them all.
struct PairChoice {
  int a = -1, b = -1;
  double least_load_N = 0, largest_load_N = 0;
  double utilisation = 0;     ///< largest, by the exact limit surface; 1: slides
  double torsion = 0;         ///< largest |torque|/(mu P e_n)
  double surface_change = 0;  ///< largest difference of ellipsoid and exact surface near the limit
  double allowed_error = 0;   ///< of e_n: larger for a pair that stays far from its limit
  ContactDetail detail = ContactDetail::limit_surface;
  const input::FrictionLaw* friction = &input::kLimitSurfaceLaw;
  std::string model;  ///< of the pressure; empty for a point
  Choice pressure;    ///< at the largest load
  std::string reason;
};

/// Difference of two motions: the largest difference of any body's position and orientation at the
/// same time, beside the largest travel of any body.
struct MotionChange {
  double position_m = 0, rotation_rad = 0;
  double travel_m = 0, turn_rad = 0;
  std::string body;  ///< that moved otherwise
};

struct SceneChoice {
  std::vector<PairChoice> pairs;
  MotionChange change;                ///< of the chosen against the most accurate simulation
  bool motion_holds = false;          ///< within the tolerance of the travel and turn
  bool reference_has_tables = false;  ///< e_n of finite elements in the most accurate simulation
  MotionChange plain_change;  ///< of the chosen simulation against the scene as it is written
  simulation::Recording plain, chosen;  ///< the scene as it is written, and with what was chosen
  int refinements = 0;  ///< how often pairs had to be modelled in more detail for that
  double accurate_step_ms = 0, chosen_step_ms = 0;  ///< medians
  /// Time of the pressure models in a chosen step with all soft contacts closed, two rounds each (a
  /// load and the e_n of it).
  double models_step_ms = 0;
  input::Scene scene;  ///< with what was chosen
};

/// A contact as finite elements need it: with the shapes of the bodies, as far as they are known.
struct FingerContact {
  ContactProblem problem;  ///< with the finger's own curvature
  bool is_finger_spherical = false;
  bool has_mesh = false;  ///< radii come from quadrics that were fitted to meshes
};

/// e_n over the load by finite elements of the finger itself, curved and at finite strain.
struct FemEccentricity {
  std::vector<double> eccentricity_m;  ///< at loads evenly spaced in ln P, least to largest
  /// Relative: the largest that they state for one of them, and what the shapes of the bodies can
  /// change at the largest load where only their radii are known.
  double error = 0;
};

/// May take seconds.
using FemTable = std::function<FemEccentricity(const FingerContact& contact, double least_load_N,
                                               double largest_load_N)>;

/// Estimated relative error of interpolating e_n linearly in ln e_n over ln P. It is a quarter of
/// the error that remains when every second sample is left out, because the error falls with the
/// square of the spacing.
double interpolation_error(const std::vector<double>& eccentricity_m);

/// Simulates the scene as it is written and as accurately as it can, decides, simulates again, and
/// where the motion changes by more than the tolerance, adds detail until it does not. The most
/// accurate simulation has exact limit surfaces, with e_n of the bonded layer or, for pairs whose
/// models are not known to be as accurate, of finite elements.
/// @param fem_table  called only where no model is accurate enough, once for pairs that are alike
/// @throws InputError, ConvergenceError when the accurate simulation fails
SceneChoice choose_for_scene(const input::Scene& scene, double tolerance, const FemTable& fem_table,
                             const std::function<void(const std::string&)>& progress);

/// Describes the most accurate simulation, with which the chosen one is compared.
std::string reference_in_words(const SceneChoice& choice);

/// "by at most 0.12 mm of 40 mm and at most 3.1° of 20° (object)". What is smaller than a
/// simulation can tell is not given as a number.
std::string in_words(const MotionChange& change);

/// One sentence: what a step saves by the choice, or why there is nothing to save.
std::string saving_in_words(const SceneChoice& choice);

nlohmann::json to_json(const SceneChoice& choice, double tolerance);
std::string table(const SceneChoice& choice, double tolerance);

}  // namespace softfinger::judgement
