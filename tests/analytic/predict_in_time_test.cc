#include "softfinger/time/predict_in_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

using Drive = ContactHistory::Drive;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

ContactProblem sphere() {
  ContactProblem problem;
  problem.radii = {0.01, 0.01, 0};
  problem.layer = {0.002, 300e3, 0.45};
  problem.load = {1, 0.8};
  return problem;
}

ContactProblem fingertip() {
  ContactProblem problem;
  problem.radii = {0.02, 0.012, 0};
  problem.layer = {0.002, 300e3, 0.49};
  problem.load = {2, 0.8};
  return problem;
}

const Relaxation& silicone() {
  static const Relaxation relaxation({{0.12, 0.5}, {0.06, 5}, {0.03, 60}});
  return relaxation;
}

const PressureModel& model(const char* name) { return *find_pressure_model(name); }

/// int_0^end f(s) ds by the rule of Tanh and Sinh, which needs no smoothness at the ends.
double integral(double begin, double end, const std::function<double(double)>& f) {
  double sum = 0;
  constexpr double kStep = 1. / 64;
  for (double u = -4; u <= 4; u += kStep) {
    const double x = std::tanh(1.5707963267948966 * std::sinh(u));
    const double c = std::cosh(1.5707963267948966 * std::sinh(u));
    const double weight = 1.5707963267948966 * std::cosh(u) / (c * c);
    sum += weight * f(begin + (end - begin) * (1 + x) / 2);
  }
  return sum * kStep * (end - begin) / 2;
}

TEST(PredictInTime, BeginsWithTheInstantaneousAndEndsWithTheLongTimeElasticAnswer) {
  for (const PressureModel* each : all_pressure_models()) {
    if (!each->card().hot_path || each->card().layer_constants == LayerConstants::none) continue;
    const ContactHistory history = ContactHistory::held(silicone(), Drive::load, 2);
    ContactProblem instantaneous = fingertip(), long_time = fingertip();
    long_time.layer.youngs_modulus_Pa *= silicone().long_time_modulus();
    // 1e4 s are 133 of the slowest creep's times: exp(-133) is far below rounding.
    for (const auto& [problem, time_s] : {std::pair(instantaneous, 0.), std::pair(long_time, 1e4),
                                          std::pair(long_time, kInfinite)}) {
      const Prediction elastic = each->predict(problem);
      const PredictionInTime now = predict_at(*each, fingertip(), history, time_s);
      ASSERT_EQ(now.prediction.has_answer, elastic.has_answer) << each->card().name;
      EXPECT_EQ(now.load_N, 2);
      const auto same = [&, at_s = time_s](double one, double other) {
        EXPECT_NEAR(one, other, 1e-9 * other) << each->card().name << " at " << at_s;
      };
      same(now.prediction.a_m, elastic.a_m);
      same(now.prediction.b_m, elastic.b_m);
      same(now.prediction.indentation_m, elastic.indentation_m);
      same(now.prediction.torque_arm_exact_m, elastic.torque_arm_exact_m);
      same(now.prediction.torque_arm_paper_m, elastic.torque_arm_paper_m);
      same(now.prediction.peak_pressure_Pa, elastic.peak_pressure_Pa);
    }
  }
}

TEST(PredictInTime, EqualsLeeAndRadoksSphereUnderAStepOfLoad) {
  const double share = 0.4, tau_s = 3, load_N = 1, rest = 1 - share;
  const Relaxation solid({{share, tau_s}});
  const ContactProblem problem = sphere();
  const double radius_m = problem.radii.major_m;
  const double stiff_Pa = problem.layer.plane_strain_modulus_Pa();
  // a(t)³ = 3 P R/(4 E*) E0 J(t) of the standard linear solid.
  const auto a_m = [&](double t) {
    return std::cbrt(0.75 * load_N * radius_m / stiff_Pa *
                     (1 + share / rest * (1 - std::exp(-rest * t / tau_s))));
  };
  // int E(t - s)/E0 d(a^n), by parts.
  const auto relaxed = [&](double t, double power) {
    return std::pow(a_m(t), power) - integral(0, t, [&](double s) {
             return std::pow(a_m(s), power) * share / tau_s * std::exp(-(t - s) / tau_s);
           });
  };
  const ContactHistory history = ContactHistory::held(solid, Drive::load, load_N);
  for (const double t : {0., 0.1, 1., 5., 40.}) {
    const PredictionInTime now = predict_at(model("hertz"), problem, history, t);
    // The relaxed pressures carry the load: the identity of the method.
    EXPECT_NEAR(4 * stiff_Pa / (3 * radius_m) * relaxed(t, 3), load_N, 1e-12);
    EXPECT_NEAR(now.prediction.a_m, a_m(t), 1e-12 * a_m(t));
    EXPECT_NEAR(now.prediction.indentation_m, a_m(t) * a_m(t) / radius_m, 1e-12 * 1e-3);
    // Hertz's arm is 3 pi/16 a, so that P e = pi E*/(4 R) a⁴.
    const double torque = 0.25 * 3.14159265358979324 * stiff_Pa / radius_m * relaxed(t, 4);
    EXPECT_NEAR(now.prediction.torque_arm_exact_m, torque / load_N, 1e-11 * torque);
    // The pressure at r is 2 E*/(pi R) int E(t - s)/E0 d sqrt(a(s)² - r²).
    double peak_Pa = 0;
    for (int i = 0; i < 400; ++i) {
      const double r = i / 400. * a_m(t);
      const auto depth = [&](double s) { return std::sqrt(std::max(0., a_m(s) * a_m(s) - r * r)); };
      double touched = 0;
      if (r > a_m(0))  // when a(s) = r
        touched = -tau_s / rest * std::log1p(-rest / share * (r * r * r / std::pow(a_m(0), 3) - 1));
      const double held = depth(t) - integral(touched, t, [&](double s) {
                            return depth(s) * share / tau_s * std::exp(-(t - s) / tau_s);
                          });
      peak_Pa = std::max(peak_Pa, 2 * stiff_Pa / (3.14159265358979324 * radius_m) * held);
    }
    // The maximum between the points that are looked at may be missed.
    EXPECT_NEAR(now.prediction.peak_pressure_Pa, peak_Pa, 2e-3 * peak_Pa) << t;
  }
}

TEST(PredictInTime, EqualsTingsSphereUnderATriangleOfApproach) {
  const double share = 0.6, tau_s = 1, rest = 1 - share, peak_s = 2, speed = 5e-4;
  const Relaxation solid({{share, tau_s}});
  const ContactProblem problem = sphere();
  const double radius_m = problem.radii.major_m;
  const double stiff_Pa = problem.layer.plane_strain_modulus_Pa();
  const ContactHistory history(solid, Drive::approach,
                               {{0, 0}, {peak_s, speed * peak_s}, {2 * peak_s, 0}});
  EXPECT_NEAR(history.peak_s(), peak_s, 1e-12);
  const auto modulus = [&](double t) { return rest + share * std::exp(-t / tau_s); };
  const auto of_modulus = [&](double t) {  // int_0^t E
    return rest * t + share * tau_s * (1 - std::exp(-t / tau_s));
  };
  for (const double t : {0.5, 1.9, 2.2, 2.6, 3.0, 3.2}) {
    double reach_s = t;
    if (t > peak_s) {  // int_t1^peak E(t - u) du = int_peak^t E(t - u) du
      double low = 0, high = peak_s;
      for (int i = 0; i < 100; ++i) {
        reach_s = (low + high) / 2;
        const bool too_late = of_modulus(t - reach_s) < 2 * of_modulus(t - peak_s);
        (too_late ? high : low) = reach_s;
      }
    }
    // P = 4/3 E* sqrt(R) int_0^t1 E(t - s)/E0 d(delta^(3/2))
    const double load_N =
        2 * stiff_Pa * std::sqrt(radius_m) * std::pow(speed, 1.5) *
        integral(0, reach_s, [&](double s) { return modulus(t - s) * std::sqrt(s); });
    const PredictionInTime now = predict_at(model("hertz"), problem, history, t);
    EXPECT_NEAR(now.load_N, load_N, 1e-9 * load_N) << t;
    EXPECT_NEAR(now.prediction.a_m, std::sqrt(radius_m * speed * reach_s), 1e-11) << t;
    EXPECT_NEAR(now.prediction.indentation_m, history.value(t), 1e-15);
  }
  // The rubber loses the touch before the approach is back at zero.
  EXPECT_THROW(predict_at(model("hertz"), problem, history, 3.9), InputError);
}

TEST(PredictInTime, HeldAtAnApproachTheLoadRelaxesAsTheModulusAndTheContactStays) {
  const ContactHistory history = ContactHistory::held(silicone(), Drive::approach, 4e-4);
  const char* const name = "fingertip_layer";
  const PredictionInTime start = predict_at(model(name), fingertip(), history, 0);
  EXPECT_NEAR(start.prediction.indentation_m, 4e-4, 1e-15);
  for (const double t : {0.3, 10., 1e3}) {
    const PredictionInTime now = predict_at(model(name), fingertip(), history, t);
    EXPECT_NEAR(now.load_N, start.load_N * silicone().modulus(t), 1e-12 * start.load_N);
    EXPECT_NEAR(now.prediction.a_m, start.prediction.a_m, 1e-15);
    EXPECT_NEAR(now.prediction.torque_arm_exact_m, start.prediction.torque_arm_exact_m, 1e-14);
  }
}

TEST(PredictInTime, ARampHasTheLoadOfItsPressure) {
  // The integral of the elastic load over the history is the load that was put on.
  const ContactHistory history(silicone(), Drive::load,
                               {{0, 0}, {0.2, 1}, {0.2, 1.5}, {3, 2}, {9, 2.5}});
  for (const double t : {0.05, 0.2, 1., 3., 8., 50., 1000.}) {
    const ContactHistory::Reach reach = history.at(t);
    const double load_N =
        history.relaxed([](double size) { return Eigen::ArrayXd::Constant(1, size); }, t, reach)[0];
    EXPECT_NEAR(load_N, history.value(t), 1e-11) << t;
  }
  EXPECT_EQ(history.peak_s(), kInfinite);
}

TEST(PredictInTime, TheContactGrowsOnAfterTheLoadBeginsToFall) {
  const ContactHistory history(silicone(), Drive::load, {{0, 2}, {1, 2}, {100, 1}});
  EXPECT_GT(history.peak_s(), 1);
  EXPECT_LT(history.peak_s(), 10);
  const double before = history.at(history.peak_s() - 0.05).size;
  const double after = history.at(history.peak_s() + 0.05).size;
  EXPECT_LT(before, history.at(history.peak_s()).size);
  EXPECT_LT(after, history.at(history.peak_s()).size);
}

TEST(PredictInTime, UnloadingByLoadAndByTheApproachThatItHasAreTheSame) {
  const ContactHistory by_load(silicone(), Drive::load, {{0, 2}, {2, 2}, {3, 0.2}});
  std::vector<HistoryPoint> points;
  const auto approach_at = [&](double t) {
    return predict_at(model("hertz"), sphere(), by_load, t).prediction.indentation_m;
  };
  points.push_back({0, 0});
  points.push_back({0, approach_at(0)});
  for (int i = 1; i <= 100; ++i) points.push_back({2 * std::pow(i / 100., 2), 0});
  for (int i = 1; i <= 36; ++i) points.push_back({2 + 0.95 * i / 36, 0});
  for (std::size_t i = 2; i < points.size(); ++i) points[i].value = approach_at(points[i].time_s);
  const ContactHistory by_approach(silicone(), Drive::approach, points);
  for (const double t : {1., 2., 2.3, 2.6, 2.9}) {
    const PredictionInTime one = predict_at(model("hertz"), sphere(), by_load, t);
    const PredictionInTime other = predict_at(model("hertz"), sphere(), by_approach, t);
    // Straight lines between the points lose the square of their distance.
    EXPECT_NEAR(other.load_N, one.load_N, 2e-3 * one.load_N) << t;
    EXPECT_NEAR(other.prediction.a_m, one.prediction.a_m, 1e-3 * one.prediction.a_m) << t;
    EXPECT_NEAR(other.prediction.torque_arm_exact_m, one.prediction.torque_arm_exact_m,
                1e-3 * one.prediction.torque_arm_exact_m)
        << t;
  }
}

TEST(PredictInTime, AfterAStepDownTheContactIsThatOfTheSameSizeOnItsWayUp) {
  // A rubber that has hardly relaxed is elastic: the contact is as large as that under 1 N.
  const Relaxation slow({{0.1, 1e6}});
  const ContactHistory history(slow, Drive::load, {{0, 2}, {1, 2}, {1, 1}});
  const PredictionInTime now = predict_at(model("bonded_layer"), fingertip(), history, 1);
  ContactProblem elastic = fingertip();
  elastic.load.normal_force_N = 1;
  const Prediction expected = model("bonded_layer").predict(elastic);
  EXPECT_NEAR(now.prediction.a_m, expected.a_m, 1e-6 * expected.a_m);
  EXPECT_NEAR(now.prediction.torque_arm_exact_m, expected.torque_arm_exact_m,
              1e-6 * expected.torque_arm_exact_m);
  EXPECT_NEAR(now.prediction.indentation_m, expected.indentation_m, 1e-6 * expected.indentation_m);
}

TEST(PredictInTime, FastTermsInASlowUnloadingAreTheElasticContactOfTheSofterRubber) {
  for (const double time_s : {1e-1, 1e-3, 1e-6, 1e-9}) {
    const Relaxation fast({{0.3, time_s}});
    const ContactHistory history(fast, Drive::load, {{0, 0}, {1000, 5}, {4000, 5}, {5000, 2}});
    const PredictionInTime now = predict_at(model("bonded_layer"), fingertip(), history, 4500);
    ContactProblem softer = fingertip();
    softer.load.normal_force_N = 3.5;
    softer.layer.youngs_modulus_Pa *= fast.long_time_modulus();
    const Prediction expected = model("bonded_layer").predict(softer);
    // The load changes by time_s/1000 s within the memory; the nested integrals are known to 1e-6.
    const double known = time_s / 1000 + 1e-5;
    EXPECT_NEAR(now.prediction.indentation_m / expected.indentation_m, 1, known) << time_s;
    EXPECT_NEAR(now.prediction.a_m / expected.a_m, 1, known) << time_s;
  }
}

TEST(PredictInTime, RefusesASecondGrowth) {
  const ContactHistory again(silicone(), Drive::load, {{0, 2}, {1, 1}, {2, 3}});
  EXPECT_NO_THROW(again.at(0.9));
  EXPECT_THROW(again.at(1.5), InputError);
  // Unloaded in part and held, rubber yields again.
  const ContactHistory rests(silicone(), Drive::load, {{0, 2}, {1, 2}, {1, 1}});
  EXPECT_NO_THROW(rests.at(1));
  EXPECT_THROW(rests.at(5), InputError);
}

TEST(PredictInTime, RefusesTimesAtWhichNothingIsPressed) {
  const ContactHistory history(silicone(), Drive::load, {{1, 0}, {2, 1}, {3, 0}});
  for (const double t : {0., 1., 3., 4., kInfinite, std::nan("")})
    EXPECT_THROW(history.at(t), InputError) << t;
  EXPECT_THROW(ContactHistory(silicone(), Drive::load, {}), InputError);
  EXPECT_THROW(ContactHistory(silicone(), Drive::load, {{0, 0}, {1, 0}}), InputError);
  EXPECT_THROW(ContactHistory(silicone(), Drive::load, {{1, 1}, {0, 2}}), InputError);
  EXPECT_THROW(ContactHistory(silicone(), Drive::load, {{0, 1}, {0, 2}, {0, 3}}), InputError);
  EXPECT_THROW(ContactHistory(silicone(), Drive::load, {{0, -1}}), InputError);
}

TEST(PredictInTime, AnElasticLayerOnlyFollowsItsLoad) {
  const ContactHistory history({}, Drive::load, {{0, 0}, {1, 3}, {2, 1}, {3, 2}});
  ContactProblem problem = fingertip();
  problem.load.normal_force_N = 1.5;
  const PredictionInTime now = predict_at(model("winkler"), fingertip(), history, 2.5);
  EXPECT_EQ(now.load_N, 1.5);
  EXPECT_EQ(now.prediction.a_m, model("winkler").predict(problem).a_m);
}

TEST(PredictInTime, ModelsThatCannotTellSaySo) {
  const ContactHistory history = ContactHistory::held(silicone(), Drive::load, 1);
  for (const char* name : {"power_law", "layer_fft"}) {
    const PredictionInTime now = predict_at(model(name), fingertip(), history, 1);
    EXPECT_FALSE(now.prediction.has_answer);
    EXPECT_FALSE(now.prediction.validity.holds());
  }
}

}  // namespace
}  // namespace softfinger
