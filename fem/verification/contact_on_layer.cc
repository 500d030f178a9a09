#include "fem/verification/contact_on_layer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "fem/linear/model_cache.h"

namespace softfinger::fem::verification {
namespace {

const Progress quiet = [](const std::string&) {};

Residuals& residuals() {
  static Residuals all;
  return all;
}

}  // namespace

const std::vector<CircularLayer>& circular_layers() {
  static const std::vector<CircularLayer> layers{
      {0, 0.05, 1.3333995803442418, 0.9743588555311714, 0.5890486175374047, 0.6366514246550817},
      {0, 0.1, 1.3338586323145338, 0.949054665392267, 0.5890484645057272, 0.6368712685636971},
      {0, 0.2, 1.3373970253055296, 0.9005828387142208, 0.5890438449327261, 0.6385808674099394},
      {0, 0.5, 1.3856458210381806, 0.7828370907821439, 0.5887243305984446, 0.6630943374873893},
      {0, 1, 1.59994557800165, 0.6733875236268844, 0.5851198102990063, 0.7856180868481166},
      {0, 2, 2.2591075523013155, 0.5921592135932893, 0.5721323149627796, 1.208667816642181},
      {0, 5, 4.540541313001201, 0.5370736201449821, 0.5520951900994054, 2.6861554414845017},
      {0, 20, 16.29159069049116, 0.5091946858417341, 0.5382062674595794, 10.183893716820755},
      {0.3, 0.05, 1.3334218204762858, 0.97086000203518, 0.5890486152228559, 0.6366620535467583},
      {0.3, 0.1, 1.334034453628629, 0.9421665312728182, 0.5890483916744661, 0.6369555326565384},
      {0.3, 0.2, 1.338743355114718, 0.8875776971946997, 0.5890416638628031, 0.6392332383553807},
      {0.3, 0.5, 1.4022315028553989, 0.7588504178760642, 0.5885854720506734, 0.6716833239090041},
      {0.3, 1, 1.6786246034995, 0.647622319927407, 0.5837357455760828, 0.8323741463482908},
      {0.3, 2, 2.5052722713293023, 0.5730033556359877, 0.5683261447413811, 1.372479817219614},
      {0.3, 5, 5.312512985441616, 0.5270904137743812, 0.5484496662813931, 3.197227864594039},
      {0.3, 20, 19.71731504372716, 0.506293310575086, 0.5368029653983252, 12.395436118984623},
      {0.45, 0.05, 1.3334512656739348, 0.9656096086446475, 0.5890486122313215, 0.6366761255324205},
      {0.45, 0.1, 1.334267367845829, 0.9318076618134638, 0.5890482975308429, 0.6370671490805297},
      {0.45, 0.2, 1.3405326697115976, 0.8678360563061301, 0.5890388433826441, 0.6400999469179282},
      {0.45, 0.5, 1.4250498728312297, 0.7197071451791668, 0.5884053456945273, 0.683472895134063},
      {0.45, 1, 1.80176135223359, 0.5947223776361908, 0.581899808432902, 0.9050009922915476},
      {0.45, 2, 3.0344837727895513, 0.5098806195754721, 0.5623185941390921, 1.725907633314932},
      {0.45, 5, 8.318960624108827, 0.4639246887675847, 0.5365561615491652, 5.356566149669354},
      {0.45, 20, 42.58900386427492, 0.47813646496189477, 0.5252951558455335, 28.26786889553189},
      {0.5, 0.05, 1.333468350111531, 0.9625526360788248, 0.5890486104633502, 0.6366842903978651},
      {0.5, 0.1, 1.334402508763468, 0.9257745761588239, 0.5890482419040705, 0.6371319153051637},
      {0.5, 0.2, 1.3415718255088396, 0.8563144173120626, 0.5890371781998166, 0.6406034279783417},
      {0.5, 0.5, 1.4385411927435037, 0.6962463069295394, 0.5882995828388532, 0.6904530903886672},
      {0.5, 1, 1.8806668991706834, 0.5594154855629028, 0.5808313775752972, 0.9516735515116302},
      {0.5, 2, 3.464161232319539, 0.4549028215573953, 0.5586154521376132, 2.0158768940481866},
      {0.5, 5, 13.261737333703811, 0.35912469057170643, 0.5254239784951067, 9.123592305667328},
      {0.5, 20, 298.94348517498156, 0.283573481778402, 0.4843362800508304, 252.0780882472106},
  };
  return layers;
}

const CircularLayer& circular_layer(double nu, double s) {
  for (const CircularLayer& layer : circular_layers())
    if (layer.nu == nu && layer.s == s) return layer;
  throw std::out_of_range("no reference for nu " + std::to_string(nu) + ", a/h " +
                          std::to_string(s));
}

Problem circular_problem(const CircularLayer& layer) {
  const double h = 2e-3, E = 3e5, mu = 0.1, a = layer.s * h, R = 60 * a;
  const double load = layer.load * E / (1 - layer.nu * layer.nu) * a * a * a / R;
  Problem problem;
  problem.contact = {{R, R, 0}, {h, E, layer.nu}, {load, mu}};
  return problem;
}

Expected expected_of(const CircularLayer& layer) {
  const Problem problem = circular_problem(layer);
  const auto& load = problem.contact.load;
  const double a = layer.s * problem.contact.layer.thickness_m, R = problem.contact.radii.major_m;
  Expected expected;
  expected.a_m = expected.b_m = a;
  expected.indentation_m = layer.approach * a * a / R;
  expected.max_torque_Nm = load.friction_coefficient * load.normal_force_N * a * layer.torque;
  expected.peak_pressure_Pa = layer.peak * problem.contact.layer.plane_strain_modulus_Pa() * a / R;
  expected.reference_error = expected.edge_reference_error = 1e-8;
  expected.reference = "1e-8 of the integral equation";
  return expected;
}

const Residuals& residuals_so_far() { return residuals(); }

Result solve_quietly(const Problem& problem, ModelCache* models) {
  Result result = solve(
      problem, quiet, [] { return false; }, models);
  Residuals& all = residuals();
  ++all.contacts;
  for (const LevelResult& level : result.levels) {
    all.load = std::max(all.load, level.load_residual);
    all.complementarity = std::max(all.complementarity, level.complementarity_residual);
  }
  return result;
}

namespace {

Checks compare(const std::string& group, const std::string& name, const Problem& problem,
               const Expected& expected, const Result& result) {
  Checks checks;
  const auto add = [&](const char* quantity, double value, double measured, double stated,
                       double reference_error) {
    checks.push_back(stated_check(group, name, quantity, value, measured, stated, reference_error,
                                  expected.reference));
  };
  const auto& finest = result.finest;
  add("d, m", expected.indentation_m, finest.indentation_m, result.error.indentation,
      expected.reference_error);
  add("torque, N m", expected.max_torque_Nm, finest.max_torque_Nm, result.error.max_torque,
      expected.reference_error);
  add("a, m", expected.a_m, finest.a_m, result.error.a, expected.edge_reference_error);
  // In a circular contact b is the same number.
  if (problem.contact.radii.major_m != problem.contact.radii.minor_m)
    add("b, m", expected.b_m, finest.b_m, result.error.b, expected.edge_reference_error);
  if (expected.peak_pressure_Pa > 0)
    add("peak pressure, Pa", expected.peak_pressure_Pa, finest.peak_pressure_Pa,
        result.error.peak_pressure, expected.edge_reference_error);
  return checks;
}

}  // namespace

Checks compare(const std::string& group, const std::string& name, const Problem& problem,
               const Expected& expected) {
  return compare(group, name, problem, expected, solve_quietly(problem));
}

Checks compare_reused(const std::string& group, const std::string& name, const Problem& problem,
                      const Expected& expected, double larger_load) {
  ModelCache models;
  Problem first = problem;
  first.contact.load.normal_force_N *= larger_load;
  solve_quietly(first, &models);
  const Result result = solve_quietly(problem, &models);
  if (models.hits() == 0) return {};
  char larger[40];
  std::snprintf(larger, sizeof larger, ", meshes %.2f as large", result.finest.oversize);
  return compare(group, name + larger, problem, expected, result);
}

Pressed press_at_level(const Problem& problem, double a_m, double b_m, int level) {
  const double h = problem.contact.layer.thickness_m;
  LayerDiscretisation mesh;
  mesh.a = a_m / h;
  mesh.b = b_m / h;
  choose_elements(mesh, level);
  const Pressing pressing = pressing_of(problem);
  return *press_on(*make_layer(mesh, pressing), pressing);
}

PressedContact friction_start(const Pressed& pressed, const Problem& problem, double a_m,
                              double b_m) {
  const double h = problem.contact.layer.thickness_m;
  return {*pressed.model,
          pressed.gap,
          pressed.contact.force,
          a_m / h,
          b_m / h,
          pressing_of(problem).load,
          problem.friction_law_of_model()};
}

Result friction_of(const Problem& problem, double a_m, double b_m,
                   const std::function<void(FrictionPlan&)>& make_plan) {
  std::optional<FrictionPlan> plan{FrictionPlan{}};
  make_plan(*plan);
  Result result;
  std::vector<FrictionOfLevel> levels;
  for (int level = problem.level - 1; level <= problem.level; ++level) {
    const Pressed pressed = press_at_level(problem, a_m, b_m, level);
    const double h = problem.contact.layer.thickness_m;
    result.finest.elements_per_semi_axis = pressed.model->discretisation().elements_per_semi_axis;
    result.finest.load_N = problem.contact.load.normal_force_N;
    result.finest.max_force_N =
        problem.contact.load.friction_coefficient * problem.contact.load.normal_force_N;
    result.finest.max_torque_Nm = result.finest.max_force_N * pressed.torque_arm() * h;
    levels.push_back(friction_on(friction_start(pressed, problem, a_m, b_m), problem, nullptr, plan,
                                 quiet, [](auto&&...) {}));
  }
  state_friction(levels.front(), levels.back(), 2, problem, result);
  return result;
}

}  // namespace softfinger::fem::verification
