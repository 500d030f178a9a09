// Choice of a model that is accurate enough, and its agreement between all commands.
#include "comparisons/judgement/selection/model_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "comparisons/explorer/explorer.h"
#include "comparisons/exporting/contact_curve.h"
#include "comparisons/judgement/assessment.h"
#include "comparisons/judgement/comparison.h"
#include "comparisons/judgement/recommended.h"
#include "comparisons/simulation/contact_model.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/accuracy/pressing_error.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

using judgement::Candidate;
using judgement::Choice;
using judgement::Quantity;
using judgement::SelectionOptions;

/// A flat layer of 2 mm under an object.
struct Contact {
  input::Case contact_case;
  prediction::LocalGeometry geometry;
  double load_N;

  Contact(double poisson_ratio, double major_m, double minor_m, double load) : load_N(load) {
    contact_case.id = "simple";
    contact_case.layer = {2e-3, 3e5, poisson_ratio};
    contact_case.shear_law.friction_coefficient = 0.5;
    geometry.radii = {major_m, minor_m, 0};
    contact_case.geometry = geometry.radii;
    contact_case.loads_N = {load};
  }
  Choice choose(const SelectionOptions& options) const {
    return choose_model(contact_case, geometry, load_N, options);
  }
};

const Contact kRubberPad(0.49, 0.03, 0.03, 2), kOval(0.3, 0.03, 0.015, 1);

TEST(ModelChoice, ClosedFormsAreRefusedInWordsWhereNoneHolds) {
  SelectionOptions options;
  options.demand.tolerance = 0.1;
  options.models = {"hertz", "winkler", "thin_incompressible"};
  const Choice choice = kRubberPad.choose(options);
  EXPECT_EQ(choice.chosen, -1);
  EXPECT_NE(choice.reason.find("none"), std::string::npos) << choice.reason;
  options.models.push_back("bonded_layer");
  const Choice with_layer = kRubberPad.choose(options);
  ASSERT_GE(with_layer.chosen, 0) << with_layer.reason;
  EXPECT_EQ(with_layer.candidates[std::size_t(with_layer.chosen)].model, "bonded_layer");
}

TEST(ModelChoice, IsTheCheapestThatMeetsToleranceAndBudget) {
  SelectionOptions options;
  for (const double tolerance : {2., 0.3, 0.1, 0.05, 0.03, 0.015, 1e-3, 1e-5}) {
    options.demand.tolerance = tolerance;
    const Choice choice = kOval.choose(options);
    const auto& all = choice.candidates;
    ASSERT_EQ(all.size(), all_pressure_models().size()) << "and fem, but not that of stacks";
    for (std::size_t i = 1; i < all.size(); ++i)
      EXPECT_LE(all[i - 1].cost_class, all[i].cost_class);
    for (int i = 0; i < int(all.size()); ++i) {
      const Candidate& candidate = all[std::size_t(i)];
      if (candidate.usable) {
        ASSERT_TRUE(candidate.bound);
        EXPECT_LE(worst_of(*candidate.bound), tolerance);
        EXPECT_LE(choice.chosen, i);
      }
      if (i == choice.chosen) {
        EXPECT_TRUE(candidate.meets());
      } else if (i == choice.next_better) {
        EXPECT_LT(candidate.worst, all[std::size_t(choice.chosen)].worst);
      } else if (i == choice.next_cheaper) {
        EXPECT_LT(candidate.cost_class, all[std::size_t(choice.chosen)].cost_class);
      }
    }
    EXPECT_FALSE(choice.reason.empty());
  }
  options.demand.tolerance = 0.1;
  options.budget_us = 1e-3;
  const Choice none = kOval.choose(options);
  EXPECT_EQ(none.chosen, -1);
  EXPECT_NE(none.reason.find("costs at most"), std::string::npos) << none.reason;
}

TEST(ModelChoice, TellsWhatTheFiniteElementsOfTheCaseCost) {
  SelectionOptions options;
  options.demand.tolerance = 0.1;
  options.models = {"fem"};
  const auto cost_us = [&](bool curved, bool finite, bool is_scan) {
    Contact contact = kOval;
    contact.contact_case.fem_curved = curved;
    if (finite) contact.contact_case.fem_finite.emplace();
    if (is_scan) contact.geometry.patch.emplace();
    return contact.choose(options).candidates.front().cost_us;
  };
  // Newton's method solves several linear problems, and a scan is pressed in several perturbed
  // versions.
  EXPECT_GT(cost_us(false, true, false), 2 * cost_us(false, false, false));
  EXPECT_GT(cost_us(true, true, false), 2 * cost_us(true, false, false));
  EXPECT_GT(cost_us(true, true, true), 2 * cost_us(true, true, false));
  EXPECT_EQ(cost_us(false, true, true), cost_us(false, true, false)) << "pressed on a flat layer";
}

TEST(ModelChoice, LeavesTheErrorOnAMeshToTheFiniteElementsThemselves) {
  SelectionOptions options;
  options.demand.tolerance = 1e-3;
  options.models = {"bonded_layer", "fem"};
  Contact contact = kOval;
  ASSERT_TRUE(contact.choose(options).candidates.back().bound);
  contact.geometry.patch.emplace();
  const Choice choice = contact.choose(options);
  const Candidate& fem = choice.candidates.back();
  ASSERT_EQ(fem.model, "fem");
  EXPECT_FALSE(fem.bound);
  EXPECT_FALSE(fem.usable);
  EXPECT_NE(fem.remark.find("state their own error when they have run"), std::string::npos);
  EXPECT_LT(choice.chosen, 0);
  options.models = {"fem"};
  EXPECT_NE(contact.choose(options).reason.find(fem.remark), std::string::npos);
}

TEST(ModelChoice, JudgesTheQuantitiesThatCount) {
  SelectionOptions options;
  options.demand.tolerance = 1;
  options.models = {"winkler"};
  options.demand.quantities = {true, false, false, false, false, true};  // a and the torque
  const Choice choice = kOval.choose(options);
  const Candidate& winkler = choice.candidates.front();
  ASSERT_TRUE(winkler.bound);
  EXPECT_EQ(winkler.worst, std::max((*winkler.bound)[std::size_t(Quantity::a)],
                                    (*winkler.bound)[std::size_t(Quantity::max_torque)]));
}

TEST(ModelChoice, AsksModelsThatTakeMillisecondsOnlyByName) {
  SelectionOptions options;
  for (const Candidate& candidate : kOval.choose(options).candidates) {
    if (candidate.model != "layer_fft") continue;
    EXPECT_FALSE(candidate.asked);
    EXPECT_FALSE(candidate.bound);
    EXPECT_NE(candidate.remark.find("--models layer_fft"), std::string::npos) << candidate.remark;
  }
  options.models = {"layer_fft"};
  const Choice choice = kOval.choose(options);
  ASSERT_EQ(choice.candidates.size(), 1u);
  EXPECT_TRUE(choice.candidates[0].asked);
  EXPECT_TRUE(choice.candidates[0].bound);
}

/// Contacts of every kind of bodies without meshes, also such as nothing is known of.
class RandomCases {
 public:
  input::Case next() {
    input::Case contact;
    contact.id = "random";
    const double h_m = between_log(0.3e-3, 8e-3);
    contact.layer = {h_m, between_log(3e4, 3e6), uniform() < 0.2 ? 0.5 : 0.5 * uniform()};
    contact.shear_law.friction_coefficient = between_log(0.1, 1.5);
    contact.pressing = PressingFriction::coulomb;
    const double major_m = between_log(1.2, 40) * h_m, minor_m = major_m / between_log(1, 25);
    const double plane = kInfinity;
    const auto quadric = [](double x_m, double y_m) {
      return input::QuadricBody{x_m, y_m, input::FingerShape::ellipsoid, 0};
    };
    const double kind = uniform();
    if (kind < 0.25)
      contact.geometry = RelativeRadii{major_m, minor_m, 0};
    else if (kind < 0.5)
      contact.geometry = input::BodyPair{quadric(major_m, minor_m), quadric(plane, plane), 0};
    else if (kind < 0.75)
      contact.geometry = input::BodyPair{quadric(plane, plane), input::SphereBody{minor_m}, 0};
    else
      contact.geometry = input::BodyPair{quadric(major_m, minor_m),
                                         quadric(2 * major_m, 3 * minor_m), 3 * uniform()};
    const double mean_m = std::sqrt(major_m * minor_m);
    contact.loads_N = {between_log(1e-3, 0.3) * contact.layer.youngs_modulus_Pa * h_m * mean_m};
    return contact;
  }

 private:
  double uniform() { return std::uniform_real_distribution<double>(0, 1)(generator_); }
  double between_log(double least, double largest) {
    return least * std::pow(largest / least, uniform());
  }
  std::mt19937_64 generator_{20};
};

/// The bound of `found`, what the geometry leaves open included; NaN without one.
double torque_bound(const std::optional<prediction::QuantityErrors>& found) {
  return found ? (*found)[std::size_t(Quantity::max_torque)] : kNaN;
}

bool same(double one, double other) {
  return one == other || (std::isnan(one) && std::isnan(other));
}

/// Two bodies that touch in a scene as the bodies of a contact do.
input::Scene scene_of(const ContactProblem& problem) {
  input::Scene scene;
  scene.bodies.resize(2);
  scene.bodies[0].layer = problem.layer;
  scene.rules.resize(1);
  scene.rule_of_pair.assign(4, 0);
  return scene;
}

/// Expects the same model and largest torque (N m) from every command when no model is asked for.
/// @param told  predict's answers by all models
void expect_one_torque(const input::Case& contact, const prediction::GeometryResolver& resolver,
                       const std::vector<prediction::ModelAnswer>& told, const Choice& selected) {
  const prediction::ModelAnswer* const first = judgement::recommended(told);
  ASSERT_TRUE(first);
  const ContactProblem& problem = first->problem;
  ASSERT_EQ(first->model, &default_model(problem));
  const double load_N = contact.loads_N.front();
  const double torque_Nm = first->friction_ellipsoid(prediction::TorqueRule::exact).max_torque_Nm();
  // export and apply
  const auto curve = exporting::ask_contact_curve(
      contact, resolver, nullptr, {load_N, 0.99 * load_N, 1.01 * load_N}, prediction::Demand{});
  EXPECT_EQ(curve.model, first->model->card().name);
  EXPECT_EQ(curve.nominal.max_torque_Nm(), torque_Nm);
  EXPECT_EQ(curve.nominal.assessment.usable, first->assessment->usable);
  // select
  if (first->assessment->usable) {
    EXPECT_EQ(selected.candidates[std::size_t(selected.chosen)].model, first->model->card().name);
  }
  // simulate
  const PressureModel& simulated = simulation::model_of_contact(scene_of(problem), 0, 1, problem);
  EXPECT_EQ(simulated.predict(problem).torque_arm_exact_m, first->prediction.torque_arm_exact_m);
  // explore
  explorer::Question question;
  question.problem = problem;
  const nlohmann::json explored = nlohmann::json::parse(explorer::answer(question));
  EXPECT_EQ(explored["models"][explored["shown"].get<std::size_t>()]["max_torque_Nm"], torque_Nm);
  EXPECT_EQ(explored["models"][explored["shown"].get<std::size_t>()]["usable"],
            first->assessment->usable);
}

TEST(AllCommands, SayTheSameOf300RandomContacts) {
  RandomCases cases;
  int known = 0, usable = 0;
  for (int i = 0; i < 300; ++i) {
    const input::Case contact = cases.next();
    const double load_N = contact.loads_N.front();
    const prediction::Demand demand;
    const prediction::GeometryResolver resolver(contact);
    const prediction::LocalGeometry geometry = resolver.resolve(load_N);
    SelectionOptions options;
    options.demand = demand;
    const Choice selected = choose_model(contact, geometry, load_N, options);
    const judgement::Comparison compared =
        judgement::compare(contact, geometry, load_N, {}, "none");
    std::vector<prediction::ModelAnswer> told_of_all;
    for (const PressureModel* model : all_pressure_models()) {
      if (!model->card().hot_path) continue;
      const std::string name(model->card().name);
      SCOPED_TRACE(name + " in case " + std::to_string(i));
      const prediction::ModelAnswer answer =
          prediction::ask_model(*model, contact, geometry, load_N);
      // predict
      const prediction::Assessment told =
          judgement::assess(contact, geometry, answer, prediction::TorqueRule::exact, demand);
      // The library
      const ErrorBound bound =
          error_bound(*model, prediction::contact_problem(contact, geometry, load_N),
                      contact.pressing_friction_coefficient());
      if (name != "power_law") {
        ASSERT_EQ(bound.known, told.bound.has_value()) << bound.outside << " - " << told.evidence;
      }
      if (told.bound) {
        EXPECT_EQ(bound.bound, *told.bound);
      }
      // select
      for (const Candidate& candidate : selected.candidates)
        if (candidate.model == name) {
          EXPECT_TRUE(same(torque_bound(candidate.bound), told.total(Quantity::max_torque)));
          EXPECT_EQ(candidate.usable, told.usable);
        }
      // compare
      for (const judgement::ModelComparison& one : compared.models)
        if (one.answer.model == model) {
          EXPECT_EQ(one.answer.assessment->usable, told.usable);
          EXPECT_TRUE(
              same(one.answer.assessment->total(Quantity::area), told.total(Quantity::area)));
        }
      // export
      if (answer.prediction.has_answer && answer.prediction.torque_arm_exact_m > 0 && i % 10 == 0) {
        const auto curve = exporting::ask_contact_curve(
            contact, resolver, model, {load_N, 0.99 * load_N, 1.01 * load_N}, demand);
        EXPECT_TRUE(same(curve.nominal.error_bound(), told.total(Quantity::max_torque)));
        EXPECT_EQ(curve.nominal.assessment.usable, told.usable);
      }
      known += told.bound.has_value();
      usable += told.usable;
      told_of_all.push_back(answer);
      told_of_all.back().assessment = told;
    }
    expect_one_torque(contact, resolver, told_of_all, selected);
  }
  // Neither all nor none, or nothing was tested.
  std::printf("%d bounds known, %d usable\n", known, usable);
  EXPECT_GT(known, 300);
  EXPECT_GT(usable, 100);
  EXPECT_LT(usable, known);
}

}  // namespace
}  // namespace softfinger
