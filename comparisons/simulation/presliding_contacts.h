#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "comparisons/simulation/contact_creep.h"
#include "softfinger/dynamics/step/presliding.h"
#include "softfinger/dynamics/step/time_stepper.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger::simulation {

/// The contacts of a scene that give way before they slide, from step to step. A step takes the
/// stiffness of the contact at the load of the last step, and the wrench that its elements hold;
/// afterwards they are moved by what the contact has given way. In rubber that relaxes they lose
/// load from step to step, so that what is held creeps. The step's stiffness is that of
/// elements of which none slides: never too soft, so that no energy is made.
class PreslidingContacts {
 public:
  /// Forgets which contacts there are, not what they hold.
  void clear() { now_.clear(); }
  /// A contact of the coming step. The problem's load is taken where the contact is a new one.
  void add(long id, const PressureModel& model, const ContactProblem& problem,
           const EffectiveLoad& effective, const Relaxation& relaxation);
  /// Likewise the friction of a flat face, whose stiffness does not depend on the load.
  /// @param aspect  of its lengths, at most 1
  /// @param size    half of its length over the layer's thickness
  void add_face(long id, const StuckStiffness& stuck, double aspect, double size,
                const Relaxation& relaxation);
  /// Sets compliance and elastic wrench of those that were added, and drops what the others held.
  void prepare(const Multibody& bodies, double time_step_s, std::vector<Contact>& contacts);
  /// After a step that is done.
  void settle(const TimeStepper& stepper);

 private:
  struct Held {
    PreslidingElements elements;
    double load_N;
    bool is_pressed = false;  ///< has had a load
    /// The contact's first axis as it was, on its body a.
    Eigen::Vector3d axis_on_a = Eigen::Vector3d::Zero();
  };
  struct Described {
    const PressureModel* model = nullptr;  ///< null: a face
    ContactProblem problem;
    EffectiveLoad effective;
    Relaxation relaxation;
    StuckStiffness face{};
    double face_aspect = 1, face_size = 0;

    std::optional<StuckStiffness> stuck_at(double load_N) const;
  };

  /// Made once for contacts that are alike; the curves take a millisecond.
  const PreslidingElements& elements_of(const Described& contact);

  std::unordered_map<long, Described> now_;  ///< by the contact's id, like the next one
  std::unordered_map<long, Held> held_;
  std::map<std::tuple<int, int, int, int>, PreslidingElements> made_;
};

/// The stiffness of a stuck contact at a load. Of two layers each gives way by itself; nothing
/// where the model has no answer.
std::optional<StuckStiffness> stuck_stiffness_at(const PressureModel& model,
                                                 const ContactProblem& problem, double load_N);

}  // namespace softfinger::simulation
