#include "fem/contact/contact_in_time.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace softfinger::fem {
namespace {

/// Times from `begin_s` to `end_s`, near each other after a corner of the history.
std::vector<double> times_between(double begin_s, double end_s, double shortest_s, int fineness) {
  const double whole_s = end_s - begin_s, longest_s = whole_s / fineness;
  const double growth = 1 + 2.0 / fineness;
  double step_s = std::min(longest_s, shortest_s / fineness), time_s = begin_s;
  std::vector<double> times;
  while (time_s + 1.5 * step_s < end_s) {
    times.push_back(time_s += step_s);
    step_s = std::min(longest_s, growth * step_s);
  }
  times.push_back(end_s);
  return times;
}

class RelaxingContact {
 public:
  RelaxingContact(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap,
                  const std::vector<PressedInTime::Term>& terms, bool by_approach)
      : compliance_(compliance),
        gap_(gap),
        terms_(terms),
        by_approach_(by_approach),
        displacement_(Eigen::VectorXd::Zero(gap.size())),
        internal_(terms.size(), displacement_) {
    found_.contact.force = displacement_;
    found_.largest = found_.contact;
  }

  /// @param value  at the step's end; a step without a length is a jump
  void step(double length_s, double value) {
    // w_i at the end is `old` of itself, `begin` of w before and `end` of w after the step.
    struct Weights {
      double old, begin, end;
    };
    std::vector<Weights> weights;
    double modulus = 1;  // of this step, over E0
    Eigen::VectorXd remembered = Eigen::VectorXd::Zero(gap_.size());
    for (std::size_t i = 0; i < terms_.size(); ++i) {
      const double times = length_s / terms_[i].time_s;
      const double mean = times > 0 ? -std::expm1(-times) / times : 1;  // of exp(-t/tau)
      weights.push_back({std::exp(-times), mean - std::exp(-times), 1 - mean});
      modulus -= terms_[i].share * weights[i].end;
      remembered +=
          terms_[i].share * (weights[i].old * internal_[i] + weights[i].begin * displacement_);
    }
    remembered /= modulus;
    press(compliance_ / modulus, gap_ + remembered, value);
    const Eigen::VectorXd before = displacement_;
    displacement_ = remembered + compliance_ * found_.contact.force / modulus;
    for (std::size_t i = 0; i < terms_.size(); ++i)
      internal_[i] = weights[i].old * internal_[i] + weights[i].begin * before +
                     weights[i].end * displacement_;
  }

  /// After so long that nothing changes any more.
  void rest(double value) {
    double modulus = 1;
    for (const PressedInTime::Term& term : terms_) modulus -= term.share;
    press(compliance_ / modulus, gap_, value);
  }

  const ContactInTime& found() const { return found_; }

 private:
  void press(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap, double value) {
    const bool touches = value > (by_approach_ ? gap.minCoeff() : 0);
    if (!touches) {
      found_.contact = NormalContact();
      found_.contact.force = Eigen::VectorXd::Zero(gap.size());
      return;
    }
    const NormalContact* start = found_.contact.active > 0 ? &found_.contact : nullptr;
    found_.contact = by_approach_ ? solve_normal_contact_at(compliance, gap, value)
                                  : solve_normal_contact(compliance, gap, value, start);
    if (found_.contact.active > found_.largest.active) found_.largest = found_.contact;
  }

  const Eigen::MatrixXd& compliance_;
  const Eigen::VectorXd& gap_;
  const std::vector<PressedInTime::Term>& terms_;
  const bool by_approach_;
  Eigen::VectorXd displacement_;           ///< w of each node, w = 0 before the first touch
  std::vector<Eigen::VectorXd> internal_;  ///< w_i
  ContactInTime found_;
};

}  // namespace

ContactInTime follow_contact(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap,
                             const PressedInTime& pressed, bool by_approach, int fineness) {
  RelaxingContact contact(compliance, gap, pressed.terms, by_approach);
  if (!std::isfinite(pressed.time_s)) {
    contact.rest(pressed.points.back().value);
    return contact.found();
  }
  double shortest_s = std::numeric_limits<double>::infinity();
  for (const PressedInTime::Term& term : pressed.terms)
    shortest_s = std::min(shortest_s, term.time_s);
  double time_s = pressed.points.front().time_s;
  const auto just_before = [](double at_s) {
    return std::nextafter(at_s, -std::numeric_limits<double>::infinity());
  };
  const auto go_on_to = [&](double end_s) {
    if (!(end_s > time_s)) return;
    for (const double next_s : times_between(time_s, end_s, shortest_s, fineness)) {
      // The value at the end of a segment is that before a step there.
      contact.step(next_s - time_s,
                   value_at(pressed, next_s < end_s ? next_s : just_before(end_s)));
      time_s = next_s;
    }
  };
  for (const PressedInTime::Point& point : pressed.points) {
    if (point.time_s > pressed.time_s) break;
    go_on_to(point.time_s);
    contact.step(0, point.value);
  }
  go_on_to(pressed.time_s);
  return contact.found();
}

}  // namespace softfinger::fem
