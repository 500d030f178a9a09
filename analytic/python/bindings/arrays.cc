#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "analytic/python/bindings/traced.h"
#include "softfinger/accuracy/error_bound_core.h"
#include "softfinger/accuracy/pressing_error_core.h"
#include "softfinger/layer/stuck_stiffness.h"
#include "softfinger/pads/pad_law.h"

namespace softfinger::python {
namespace {

namespace py = pybind11;
using Input = ContactInputOf<Traced>;

/// Calls a model with traced numbers.
/// @param model  returns the numbers that are wanted
/// @return  (steps, places of the wanted numbers)
template <class Model>
py::tuple traced(const Model& model) {
  Trace trace;
  Traced::trace = &trace;
  std::vector<int> places;
  for (const Traced& number : model()) places.push_back(number.place());
  Traced::trace = nullptr;
  py::list steps;
  for (const TracedStep& step : trace.steps()) {
    py::list operands;
    for (const int place : step.operands)
      if (place >= 0) operands.append(place);
    steps.append(py::make_tuple(step.operation, py::tuple(operands), step.number));
  }
  return py::make_tuple(steps, places);
}

/// The inputs of a contact, in the order of softfinger/arrays.py.
Input contact_inputs() {
  const auto input = &Traced::input;
  return {input(0), input(1), input(2), input(3), input(4), input(5), input(6), input(7), input(8)};
}

std::vector<Traced> listed(const ContactNumbersOf<Traced>& numbers) {
  return {numbers.a_m,
          numbers.b_m,
          numbers.indentation_m,
          numbers.peak_pressure_Pa,
          numbers.torque_arm_exact_m,
          numbers.torque_arm_paper_m};
}

/// The input after those of a contact: the coefficient that acts while pressing.
Traced pressing_friction() { return Traced::input(9); }

ContactNumbersOf<Traced> rubbed_numbers(const ContactNumbersOf<Traced>& frictionless,
                                        bool has_finite_strain) {
  const Input input = contact_inputs();
  return with_friction(frictionless, input.poisson_ratio, input.thickness_m, pressing_friction(),
                       has_finite_strain);
}

/// The numbers as pressed, with the arms of frictionless pressing in place of theirs, then the arm
/// as pressed.
std::vector<Traced> pressed(const ContactNumbersOf<Traced>& frictionless, bool is_rubbed,
                            bool has_finite_strain) {
  if (!is_rubbed) return listed(frictionless);
  ContactNumbersOf<Traced> numbers = rubbed_numbers(frictionless, has_finite_strain);
  const Traced arm = numbers.torque_arm_exact_m;
  numbers.torque_arm_exact_m = frictionless.torque_arm_exact_m;
  numbers.torque_arm_paper_m = frictionless.torque_arm_paper_m;
  std::vector<Traced> result = listed(numbers);
  result.push_back(arm);
  return result;
}

/// @param is_rubbed  pressed with friction
py::tuple bonded_layer(bool is_rubbed) {
  return traced([&] {
    return pressed(bonded_layer_numbers(contact_inputs()), is_rubbed,
                   /*has_finite_strain=*/false);
  });
}

py::tuple fingertip_layer(bool is_object_spherical, bool is_rubbed) {
  return traced([&] {
    return pressed(fingertip_layer_numbers(contact_inputs(), is_object_spherical ? 1. : 0.),
                   is_rubbed, /*has_finite_strain=*/true);
  });
}

/// Returns what a model misses of friction while pressing, by its answer without.
/// @param has_finite_strain  the model is fingertip_layer, else bonded_layer
py::tuple pressing_errors(bool is_object_spherical, bool has_finite_strain) {
  return traced([&] {
    const Input input = contact_inputs();
    const ContactNumbersOf<Traced> frictionless =
        has_finite_strain ? fingertip_layer_numbers(input, is_object_spherical ? 1. : 0.)
                          : bonded_layer_numbers(input);
    const Traced size_m = sqrt(frictionless.a_m) * sqrt(frictionless.b_m);
    const ContactNumbersOf<Traced> rubbed = rubbed_numbers(frictionless, has_finite_strain);
    const auto missed = missed_of_pressing_friction(
        ratios_of<Traced>(input.poisson_ratio, size_m / input.thickness_m, pressing_friction(),
                          frictionless.indentation_m / input.thickness_m),
        frictionless, rubbed, rubbed);
    // The largest torque misses nothing.
    return std::vector<Traced>(missed.begin(), missed.end() - 1);
  });
}

/// The widths of the bands around `fingertip_layer`, then what must not be above 0.
py::tuple error_bands(bool is_object_spherical) {
  return traced([&] {
    const Input input = contact_inputs();
    const LayerArguments<Traced> at = layer_arguments(input);
    const LayerQuantitiesOf<Traced> logarithms =
        bonded_layer_logarithms(at.log_load, input.poisson_ratio, at.log_radii_ratio);
    const ContactNumbersOf<Traced> flat =
        contact_of_logarithms(logarithms, at.mean_radius_m, input);
    const auto widths =
        error_widths(fingertip_arguments(input, flat, is_object_spherical ? 1. : 0.),
                     input.poisson_ratio, logarithms[kAspect]);
    std::vector<Traced> result(widths.begin(), widths.end());
    for (const ErrorLimit<Traced>& limit : error_limits(input, flat))
      result.push_back(limit.excess);
    return result;
  });
}

/// Inputs: a, b, h, E, nu.
py::tuple stuck() {
  return traced([] {
    const auto input = &Traced::input;
    const StuckStiffnessOf<Traced> stiffness =
        stuck_stiffness(input(0), input(1), input(2), input(3), input(4));
    return std::vector<Traced>{stiffness.torsional_Nm_per_rad, stiffness.tangential_x_N_per_m,
                               stiffness.tangential_y_N_per_m};
  });
}

/// Normal stiffness, arm as pressed and arm of frictionless pressing, with the inputs E, nu, h.
py::tuple pad_layer(const PadShape& shape, bool is_stuck) {
  return traced([&] {
    const pads::PadLayer<Traced> layer{Traced::input(0), Traced::input(1), Traced::input(2)};
    const auto pressed = pads::pressing_resultants(
        shape, pads::pad_law(shape, layer, /*is_frictionless=*/!is_stuck));
    const auto slipping =
        pads::pressing_resultants(shape, pads::pad_law(shape, layer, /*is_frictionless=*/true));
    return std::vector<Traced>{layer.youngs_modulus_Pa / layer.thickness_m * pressed.force,
                               pressed.arm(), slipping.arm()};
  });
}

/// The coefficients of a table as [piece, power, function].
template <class Table>
py::array_t<double> rows_of(const Table& table, py::ssize_t functions) {
  return py::array_t<double>({py::ssize_t(kShapePieces), py::ssize_t(kShapeDegree + 1), functions},
                             table.terms()->data());
}

/// The tables of the models: piecewise polynomials, and the spline as [compressibility, elongation,
/// size, quantity] with the coordinates' ends.
py::dict tables() {
  using Table = BondedLayerTable;
  py::array_t<double> spline(
      {Table::kCompressibilities, Table::kElongations, Table::kSizes, int(kLayerQuantities)});
  double* out = spline.mutable_data();
  for (int i = 0; i < Table::kCount; ++i)
    out[i] = Table::coefficients[i] * Table::unit[std::size_t(i) % kLayerQuantities];
  py::dict result;
  result["spline"] = spline;
  result["spline_ends"] = std::vector<std::pair<double, double>>{
      {kTableLogSizeMin, kTableLogSizeMax}, {0, 1}, {0, Table::kElongationMax}};
  result["polynomials"] = py::make_tuple(rows_of(shape_table(), 6), rows_of(ring_table(), 1));
  result["piece_length"] = ShapeTable::kLength;
  result["largest_radii_ratio"] = std::exp(ShapeTable::kEnd);
  result["pad_widths"] =
      py::make_tuple(pads::kNarrowest, pads::kLeastWidth, pads::kLargestWidth, pads::kWidest);
  result["pad_strain"] = pads::kLargestStrain;
  return result;
}

}  // namespace

void bind_arrays(py::module_& module) {
  py::module_ arrays = module.def_submodule("arrays");
  arrays.def("bonded_layer", &bonded_layer);
  arrays.def("fingertip_layer", &fingertip_layer);
  arrays.def("error_bands", &error_bands);
  arrays.def("pressing_errors", &pressing_errors);
  arrays.def("stuck_stiffness", &stuck);
  arrays.def("pad_layer", &pad_layer);
  arrays.def("tables", &tables);
}

}  // namespace softfinger::python
