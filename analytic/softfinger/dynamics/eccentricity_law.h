#pragma once
namespace softfinger {
class EccentricityLaw {
 public:
  virtual ~EccentricityLaw() = default;
  virtual double eccentricity_m(double load_N) const noexcept = 0;
};
}  // namespace softfinger
