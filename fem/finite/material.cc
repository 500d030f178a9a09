#include "fem/finite/material.h"

#include <cmath>
#include <cstdio>

#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {
namespace {

/// w of the isochoric invariants with its derivatives.
struct InvariantResponse {
  double energy = 0, first = 0, second = 0;  ///< w, dw/dI1*, dw/dI2*
  double first_first = 0;                    ///< d²w/dI1*²; no material here has others
};

/// An isochoric invariant with its derivatives by F, the second one where it is asked for.
struct Invariant {
  double value;
  Vector9d gradient;
  Matrix9d second;
};

/// J^power times an invariant.
Invariant isochoric(const Invariant& invariant, double power, const Deformation& deformation,
                    bool with_second) {
  const double J = deformation.volume_ratio;
  const double scale = std::pow(J, power);
  const double d1 = power * scale / J, d2 = (power - 1) * d1 / J;
  const Vector9d cofactor = as_vector(deformation.cofactor);
  Invariant result;
  result.value = scale * invariant.value;
  result.gradient = scale * invariant.gradient + d1 * invariant.value * cofactor;
  if (!with_second) return result;
  const Vector9d mixed = d1 * invariant.gradient + d2 / 2 * invariant.value * cofactor;
  result.second = scale * invariant.second + d1 * invariant.value * deformation.second;
  result.second += mixed * cofactor.transpose();
  result.second += cofactor * mixed.transpose();
  return result;
}

Invariant first_invariant(const Deformation& deformation, bool with_second) {
  Invariant result;
  result.value = deformation.gradient.squaredNorm();
  result.gradient = 2 * as_vector(deformation.gradient);
  if (with_second) result.second = 2 * Matrix9d::Identity();
  return result;
}

/// |cof F|²: the cofactor's derivative is linear in F, which gives the second derivative.
Invariant second_invariant(const Deformation& deformation, bool with_second) {
  const Matrix9d derivative = cofactor_derivative(deformation.gradient);
  Invariant result;
  result.value = deformation.cofactor.squaredNorm();
  result.gradient = 2 * derivative * as_vector(deformation.cofactor);
  if (with_second)
    result.second = 2 * derivative * derivative + 2 * cofactor_derivative(deformation.cofactor);
  return result;
}

class IsochoricMaterial : public Material {
 public:
  IsochoricMaterial(const VolumetricPart& volumetric, bool takes_second)
      : Material(volumetric), takes_second_(takes_second) {}

  Response respond(const Deformation& deformation, bool with_tangent) const override {
    const Invariant first =
        isochoric(first_invariant(deformation, with_tangent), -2.0 / 3, deformation, with_tangent);
    Invariant second;
    if (takes_second_)
      second = isochoric(second_invariant(deformation, with_tangent), -4.0 / 3, deformation,
                         with_tangent);
    const InvariantResponse w = of_invariants(first.value, takes_second_ ? second.value : 3);
    Vector9d stress = w.first * first.gradient;
    if (takes_second_) stress += w.second * second.gradient;
    Response response;
    response.energy = w.energy;
    response.stress = Eigen::Map<const Eigen::Matrix3d>(stress.data());
    if (!with_tangent) return response;
    response.tangent =
        w.first * first.second + w.first_first * first.gradient * first.gradient.transpose();
    if (takes_second_) response.tangent += w.second * second.second;
    return response;
  }

 protected:
  virtual InvariantResponse of_invariants(double first, double second) const = 0;

 private:
  bool takes_second_;
};

class MooneyRivlin : public IsochoricMaterial {
 public:
  MooneyRivlin(double c10, double c01, const VolumetricPart& volumetric)
      : IsochoricMaterial(volumetric, c01 != 0), c10_(c10), c01_(c01) {}

 protected:
  InvariantResponse of_invariants(double first, double second) const override {
    return {c10_ * (first - 3) + c01_ * (second - 3), c10_, c01_, 0};
  }

 private:
  double c10_, c01_;
};

class Yeoh : public IsochoricMaterial {
 public:
  Yeoh(double c10, double c20, double c30, const VolumetricPart& volumetric)
      : IsochoricMaterial(volumetric, false), c10_(c10), c20_(c20), c30_(c30) {}

 protected:
  InvariantResponse of_invariants(double first, double) const override {
    const double x = first - 3;
    return {x * (c10_ + x * (c20_ + x * c30_)), c10_ + x * (2 * c20_ + 3 * x * c30_), 0,
            2 * c20_ + 6 * x * c30_};
  }

 private:
  double c10_, c20_, c30_;
};

/// G/2 (I1 - 3 - 2 ln J).
class CompressibleNeoHookean : public Material {
 public:
  CompressibleNeoHookean(double shear_modulus, const VolumetricPart& volumetric)
      : Material(volumetric), shear_modulus_(shear_modulus) {}

  Response respond(const Deformation& deformation, bool with_tangent) const override {
    const double G = shear_modulus_, J = deformation.volume_ratio;
    Response response;
    response.energy = G / 2 * (deformation.gradient.squaredNorm() - 3 - 2 * std::log(J));
    response.stress = G * deformation.gradient - G / J * deformation.cofactor;
    if (!with_tangent) return response;
    const Vector9d cofactor = as_vector(deformation.cofactor);
    response.tangent = G * Matrix9d::Identity() - G / J * deformation.second +
                       G / (J * J) * cofactor * cofactor.transpose();
    return response;
  }

 private:
  double shear_modulus_;
};

/// Refuses a material whose stress falls with the stretch when it is incompressible. Checked in
/// uniaxial, equibiaxial and planar stretch: the principal stretches are l, l^m, l^-(1+m) with
/// m = -1/2, 1, 0.
void require_stable(const Material& material, const std::string& what) {
  for (const double m : {-0.5, 1.0, 0.0}) {
    const auto slope = [&](double stretch) {
      // Derivative of W along the path with respect to ln(stretch).
      const Eigen::Vector3d stretches(stretch, std::pow(stretch, m), std::pow(stretch, -1 - m));
      const Response response =
          material.respond(Deformation(Eigen::Matrix3d(stretches.asDiagonal())));
      return response.stress.diagonal().dot(Eigen::Vector3d(1, m, -1 - m).cwiseProduct(stretches));
    };
    // The nominal stress slope/stretch is the force per undeformed area. It must not fall.
    constexpr double shortest = 0.4, longest = 2.5, step = 0.02;
    double previous = slope(shortest) / shortest;
    for (double stretch = shortest + step; stretch <= longest; stretch += step) {
      const double stress = slope(stretch) / stretch;
      if (!(stress > previous)) {
        char place[120];
        std::snprintf(place, sizeof place,
                      "a stable material: in %s the stress of this one falls at a stretch of %.3g",
                      m < 0 ? "uniaxial stretch" : (m > 0 ? "equibiaxial stretch" : "pure shear"),
                      stretch);
        throw InputError("material", "parameters", what, place);
      }
      previous = stress;
    }
  }
}

}  // namespace

VolumetricResponse VolumetricPart::operator()(double volume_ratio) const {
  const double k = modulus_, J = volume_ratio;
  if (law_ == VolumetricLaw::quadratic) return {k / 2 * (J - 1) * (J - 1), k * (J - 1), k};
  const double logarithm = std::log(J);
  return {k / 2 * logarithm * logarithm, k * logarithm / J, k * (1 - logarithm) / (J * J)};
}

Response Material::whole(const Deformation& deformation) const {
  Response result = respond(deformation);
  const VolumetricResponse volume = respond_to_volume(deformation.volume_ratio);
  const Vector9d cofactor = as_vector(deformation.cofactor);
  result.energy += volume.energy;
  result.stress += volume.pressure * deformation.cofactor;
  result.tangent +=
      volume.pressure * deformation.second + volume.modulus * cofactor * cofactor.transpose();
  return result;
}

std::unique_ptr<const Material> make_material(const MaterialChoice& choice, double youngs_modulus,
                                              double poisson_ratio) {
  const double G = youngs_modulus / (2 * (1 + poisson_ratio));
  const double k = youngs_modulus / (3 * (1 - 2 * poisson_ratio));
  const VolumetricPart bulk(choice.volumetric, k);
  char what[120] = "";
  std::unique_ptr<const Material> material;
  switch (choice.name) {
    case MaterialName::neo_hookean:
      if (choice.volumetric == VolumetricLaw::logarithmic)
        return std::make_unique<CompressibleNeoHookean>(
            G, VolumetricPart(choice.volumetric, k - 2 * G / 3));
      return std::make_unique<MooneyRivlin>(G / 2, 0, bulk);
    case MaterialName::mooney_rivlin: {
      const double share = choice.mooney_rivlin_share;
      std::snprintf(what, sizeof what, "c01/(c10 + c01) = %.4g", share);
      // Outside it is stable in no case: one of the constants is negative.
      if (!(share >= 0 && share <= 1))
        throw InputError("material", "mooney_rivlin_share", what, "a stable material: 0 to 1");
      material = std::make_unique<MooneyRivlin>((1 - share) * G / 2, share * G / 2, bulk);
      break;
    }
    case MaterialName::yeoh:
      std::snprintf(what, sizeof what, "c20/c10 = %.4g, c30/c10 = %.4g", choice.yeoh_second,
                    choice.yeoh_third);
      if (!std::isfinite(choice.yeoh_second) || !std::isfinite(choice.yeoh_third))
        throw InputError("material", "yeoh_ratios", what, "finite numbers");
      material = std::make_unique<Yeoh>(G / 2, choice.yeoh_second * G / 2,
                                        choice.yeoh_third * G / 2, bulk);
      break;
  }
  require_stable(*material, what);
  return material;
}

}  // namespace softfinger::fem::finite
