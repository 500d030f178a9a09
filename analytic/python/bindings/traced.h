#pragma once

#include <array>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "softfinger/layer/contact_numbers.h"

/// The models' formulas as a list of steps, which softfinger/arrays.py repeats on arrays. A model
/// that is written for any kind of number is called once with numbers that write down what is done
/// to them, so that no formula and no coefficient exists a second time.
namespace softfinger {

/// One operation. Operands are places of earlier steps, -1 for none.
struct TracedStep {
  const char* operation;
  std::array<int, 3> operands{-1, -1, -1};
  double number = 0;  ///< of "number" itself; of "polynomials" its table, of "item" its index
};

/// The steps of one model. Equal steps are written down once.
class Trace {
 public:
  int place_of(const TracedStep& step) {
    const auto key = std::make_tuple(std::string(step.operation), step.operands, step.number);
    const auto [found, is_new] = places_.emplace(key, int(steps_.size()));
    if (is_new) steps_.push_back(step);
    return found->second;
  }
  const std::vector<TracedStep>& steps() const { return steps_; }

 private:
  std::vector<TracedStep> steps_;
  std::map<std::tuple<std::string, std::array<int, 3>, double>, int> places_;
};

/// A number that adds each operation to `trace`. Operations on constants are done at once.
class Traced {
 public:
  inline static thread_local Trace* trace = nullptr;  ///< set while a model is called

  Traced(double number = 0) : number_(number) {}  // NOLINT: constants mix with variables
  /// The next input, numbered from 0.
  static Traced input(int index) { return step("input", {}, index); }
  static Traced step(const char* operation, const std::vector<Traced>& of, double number = 0) {
    TracedStep step{operation};
    step.number = number;
    for (std::size_t i = 0; i < of.size(); ++i) step.operands[i] = of[i].place();
    Traced result;
    result.place_ = trace->place_of(step);
    return result;
  }
  /// One of several numbers that a step gives.
  Traced item(int index) const { return step("item", {*this}, index); }
  int place() const {
    return place_ < 0 ? trace->place_of({"number", {-1, -1, -1}, number_}) : place_;
  }

  friend Traced operator+(const Traced& x, const Traced& y) {
    if (x.is(0)) return y;
    if (y.is(0)) return x;
    return x.is_constant() && y.is_constant() ? x.number_ + y.number_ : step("add", {x, y});
  }
  friend Traced operator-(const Traced& x, const Traced& y) {
    if (y.is(0)) return x;
    return x.is_constant() && y.is_constant() ? x.number_ - y.number_ : step("subtract", {x, y});
  }
  friend Traced operator*(const Traced& x, const Traced& y) {
    if (x.is(1) || y.is(0)) return y;
    if (y.is(1) || x.is(0)) return x;
    return x.is_constant() && y.is_constant() ? x.number_ * y.number_ : step("multiply", {x, y});
  }
  friend Traced operator/(const Traced& x, const Traced& y) {
    if (y.is(1) || x.is(0)) return x;
    return x.is_constant() && y.is_constant() ? x.number_ / y.number_ : step("divide", {x, y});
  }
  Traced& operator+=(const Traced& y) { return *this = *this + y; }

  friend Traced exp(const Traced& x) { return step("exp", {x}); }
  friend Traced log(const Traced& x) { return step("log", {x}); }
  friend Traced sqrt(const Traced& x) { return step("sqrt", {x}); }
  friend Traced abs(const Traced& x) { return step("absolute", {x}); }
  friend Traced hypot(const Traced& x, const Traced& y) { return sqrt(x * x + y * y); }
  friend Traced pow(const Traced& x, double power) { return step("power", {x, power}); }
  friend Traced larger(const Traced& x, const Traced& y) { return step("larger", {x, y}); }
  friend Traced smaller(const Traced& x, const Traced& y) { return step("smaller", {x, y}); }

 private:
  bool is_constant() const { return place_ < 0; }
  bool is(double number) const { return is_constant() && number_ == number; }

  int place_ = -1;  ///< -1: the constant `number_`
  double number_ = 0;
};

// Table look-ups are one step each.
constexpr int kTracedShapeTable = 0, kTracedRingTable = 1;

inline LimitShapesOf<Traced> tabulated_limit_shapes(const Traced& log_radii_ratio) {
  const Traced v = Traced::step("polynomials", {log_radii_ratio}, kTracedShapeTable);
  return {log_radii_ratio,
          v.item(0) * log_radii_ratio,
          v.item(1) * log_radii_ratio,
          v.item(2),
          v.item(3),
          v.item(4),
          v.item(5)};
}

inline Traced log_ring_arm(const Traced& log_aspect) {
  return log_aspect * log_aspect *
         Traced::step("polynomials", {log_aspect}, kTracedRingTable).item(0);
}

inline Traced log_ring_arm_slope(const Traced& log_aspect) {
  const Traced value = Traced::step("polynomials", {log_aspect}, kTracedRingTable).item(0);
  const Traced slope = Traced::step("polynomial_slopes", {log_aspect}, kTracedRingTable).item(0);
  return log_aspect * (2 * value + log_aspect * slope);
}

inline LayerQuantitiesOf<Traced> table_correction(const TableCoordinatesOf<Traced>& at) {
  const Traced v = Traced::step("spline", {at.log_size, at.compressibility, at.elongation});
  LayerQuantitiesOf<Traced> correction;
  for (std::size_t q = 0; q < kLayerQuantities; ++q) correction[q] = v.item(int(q));
  return correction;
}

}  // namespace softfinger
