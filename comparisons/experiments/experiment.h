#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// Published measurements of soft fingertips, one file (TOML) each.
namespace softfinger::experiments {

/// Contact radius a = c P^gamma.
struct GrowthLaw {
  double coefficient_m = 0;  ///< c, P in N
  double exponent = 0;       ///< gamma
};

/// Data that a calibration on a part of the loads needs beside the law.
struct LawCalibration {
  double radius_m = 0;                       ///< of the finger, a sphere on a plane
  std::array<double, 2> fit_load_N{};        ///< points of the law that are fitted
  std::vector<double> predicted_load_N;      ///< above them
  std::array<double, 2> supposed_range_N{};  ///< of the measurements behind the law
  double pressure_exponent_k = 0;            ///< p ~ (1 - (r/a)^k)^(1/k), as published
};

struct Growth {
  std::vector<GrowthLaw> laws;
  std::optional<double> exponent_uncertainty;  ///< supposed by us: none of the sources has one
  std::vector<double> poisson_ratios;
  double main_poisson_ratio = 0;  ///< one of them: for single numbers
  std::optional<LawCalibration> calibration;
};

/// A sphere pressed into a flat layer.
struct Indentation {
  double sphere_radius_m = 0, load_N = 0, indentation_m = 0, indentation_std_m = 0;
  double thickness_m = 0, youngs_modulus_Pa = 0, poisson_ratio = 0;
  double youngs_modulus_factor = 1;  ///< E lies between E/factor and E factor
  /// The approach contains that of something else as well: it is an upper limit.
  bool includes_other_compliance = false;
};

/// Shore hardness and modulus of one material.
struct Hardness {
  enum class Scale { a, oo };
  Scale scale = Scale::a;
  double value = 0, uncertainty = 0;  ///< 0 to 100
  double youngs_modulus_Pa = 0, poisson_ratio = 0;
};

/// One quantity measured by both fingers of a gripper.
struct Repeated {
  struct Pair {
    std::string object;
    std::array<double, 2> eccentricity_m{};
    bool outlier = false;
  };
  std::vector<Pair> pairs;
};

/// One number that a publication states in words.
struct Observation {
  enum class Quantity {
    pressure_exponent,       ///< n of p ~ (1 - r²/a²)^n
    torque_exponent,         ///< d ln T/d ln P at slip
    shear_stress_exponent,   ///< d ln tau/d ln p at slip
    area_change_under_shear  ///< relative
  };
  Quantity quantity = Quantity::pressure_exponent;
  double value = 0, uncertainty = 0;
};

/// Force over travel of fingertips of one shape on a plane, in equal steps from a place before the
/// touch and back.
struct PressCurves {
  struct Curve {
    std::string code, description;
    bool hollow = false;                         ///< is called so, or holds air
    std::vector<double> loading_N, unloading_N;  ///< the latter from the largest travel on
  };
  double step_m = 0, sphere_radius_m = 0, thickness_m = 0, poisson_ratio = 0;
  std::vector<Curve> curves;
};

/// Materials of input/measured_silicones.h, which has their moduli, with their makers' hardness.
struct Tension {
  struct Material {
    std::string name;
    double shore_a = 0;
  };
  std::vector<Material> materials;
};

/// A disc bonded to two plates and drawn apart.
struct BondedDisc {
  double diameter_m = 0, thickness_m = 0, machine_N_per_m = 0;
  double knee_extension = 0;  ///< below it the stress is in proportion to the extension
  std::vector<double> poisson_ratios;
  std::vector<double> extension, stress_Pa;  ///< of one length; extension over thickness
};

struct Experiment {
  std::string id, what, source, certainty;
  std::vector<std::string> unknown;  ///< what would be needed, and is not known
  std::filesystem::path file;
  std::variant<Growth, Indentation, Hardness, Repeated, Observation, PressCurves, Tension,
               BondedDisc>
      data;
};

/// @throws InputError with "file:line" for anything that is missing, unknown, of the wrong type or
/// out of range
Experiment parse_experiment(const std::string& text, const std::filesystem::path& file);
Experiment read_experiment(const std::filesystem::path& file);

}  // namespace softfinger::experiments
