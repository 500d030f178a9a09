#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "softfinger/time/relaxation.h"

namespace softfinger {

/// A load in N or an approach in m at a time.
struct HistoryPoint {
  double time_s = 0;
  double value = 0;  ///< >= 0
};

/// Growth and shrinking of a contact of relaxing rubber under a prescribed load or approach.
///
/// Elastic contacts of one size have loads in proportion to the modulus. A contact is therefore as
/// large as the elastic one, of the instantaneous modulus E0, under some other load: the effective
/// load. Under a load P(t), while the contact only grows, that is (Lee and Radok, J. Appl. Mech.
/// 27, 1960)
///   P_eff(t) = E0 int_0^t J(t - s) dP(s),
/// and under a prescribed approach the elastic load of this approach. What was pressed earlier has
/// relaxed since: any elastic number phi that is proportional to the modulus at given size (load,
/// pressure, load times torque arm) is int_0^t E(t - s)/E0 dphi(s). After the first maximum the
/// contact shrinks, and is as large as at the time t1 before the maximum with (Ting, J. Appl. Mech.
/// 33, 1966)
///   int_0^t1 E(t - s)/E0 dP_eff(s) = P(t)   or   int_t1^t E(t - s) dd(s) = 0
/// for the approach d. The integrals above end at t1 then. A contact that grows again is not known.
class ContactHistory {
 public:
  /// The prescribed number.
  enum class Drive { load, approach };

  /// @param points  linear between them; two of the same time are a step, and so is a first one
  ///                that is not 0. Times do not fall. The last value is held for ever.
  /// @throws InputError for no points, falling times, three points of one time, values below 0, and
  /// where all values are 0
  ContactHistory(Relaxation relaxation, Drive drive, std::vector<HistoryPoint> points);

  /// A load or an approach that is put on at the time 0 and held.
  static ContactHistory held(const Relaxation& relaxation, Drive drive, double value) {
    return ContactHistory(relaxation, drive, {{0, value}});
  }

  const Relaxation& relaxation() const { return relaxation_; }
  Drive drive() const { return drive_; }
  double begin_s() const { return segments_.front().begin_s; }
  double end_s() const { return segments_.back().begin_s; }
  /// Times of the points, ascending, each once.
  std::vector<double> times_s() const;
  /// The prescribed number at a time, after a step at this time.
  double value(double time_s) const;

  /// The moment of the growth at which the contact was as large as at `time_s`.
  struct Reach {
    double time_s = 0;
    std::size_t segment = 0;
    bool is_in_step = false;  ///< within the step at the segment's beginning
    double size = 0;          ///< the effective load in N, or the approach in m
  };
  /// @throws InputError for a time before the first, where nothing touches, and beyond a first
  /// maximum of the size where the contact has grown again
  Reach at(double time_s) const;
  /// Whether the maximum of the size has passed.
  bool has_shrunk(double time_s) const {
    return time_s > peak_.time_s || (time_s == peak_.time_s && peak_.is_in_step);
  }
  /// The time from which the contact shrinks; infinite: never.
  double peak_s() const { return peak_.time_s; }

  /// Elastic numbers of a contact of this size; zeros for size 0.
  using Numbers = std::function<Eigen::ArrayXd(double size)>;
  /// int E(t - s)/E0 dphi(s) over the growth up to `reach`, at the time t = `time_s`. By Gauss's
  /// rule on panels that halve towards both ends of each segment, so that numbers of any power of
  /// the size and times of any ratio are integrated to about 1e-12.
  Eigen::ArrayXd relaxed(const Numbers& numbers, double time_s, const Reach& reach) const;

  /// The approach of a shrinking contact under a prescribed load: d with
  /// int_t1^t E(t - s) dd(s) = 0 at every t after the maximum, solved by the creep compliance. To
  /// about 1e-6.
  /// @param approach  elastic approach by size
  double shrinking_approach(const std::function<double(double size)>& approach,
                            double time_s) const;

 private:
  /// Between two points in time: first a step, then a straight line.
  struct Segment {
    double begin_s = 0, end_s = std::numeric_limits<double>::infinity();
    double value_before = 0, value = 0, slope = 0;  ///< value: after the step
    /// int exp(-rate_k (t - s)) dvalue(s) at the beginning, before and after the step.
    Eigen::ArrayXd before, after;
  };
  Eigen::ArrayXd memory(const Segment& segment, double time_s) const;
  double value_of(const Segment& segment, double time_s) const;
  double size_of(double value, const Eigen::ArrayXd& memory) const;
  double growth_rate(const Segment& segment, double time_s) const;
  /// int exp(-(t - s)/tau_i) dsize(s)
  Eigen::ArrayXd remembered(const Eigen::ArrayXd& memory) const;
  /// int_0^t1 E(t - s)/E0 dsize(s) up to the end of what `size` and `remembered` hold at t1.
  double carried(double size, const Eigen::ArrayXd& remembered, double since_s) const;
  const Segment& segment_at(double time_s) const;
  Reach shrunk_to(double time_s) const;
  void find_peak();
  void check_shrinks_until(double time_s) const;
  Eigen::ArrayXd relaxed(const Numbers& numbers, double time_s, const Reach& reach,
                         int most_levels) const;

  Relaxation relaxation_;
  Drive drive_;
  std::vector<Segment> segments_;
  Eigen::ArrayXd rates_per_s_, shares_, falls_per_s_;  ///< of the memory; g_i; 1/tau_i
  Reach peak_;
};

}  // namespace softfinger
