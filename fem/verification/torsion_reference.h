#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

/// Twist of a contact under constant load, from stick to slip, as others computed it. All with
/// a = G = mu P = 1: angle beta = G a² angle / (mu P), torque M = torque / (mu P a).
namespace softfinger::fem::verification {

/// Lubkin (1951): a sphere's contact on a half-space while the disc r < c sticks.
struct Lubkin {
  /// 0 < c <= 1
  static double angle(double c) { return 3 / (4 * M_PI) * rise(c); }

  static double torque(double c) {
    // Simpson's rule; the integrand is smooth but for t² ln t at 0.
    constexpr int intervals = 400;
    const double step = (1 - c) / intervals, p0 = 3 / (2 * M_PI);
    double slipping = 0;
    for (int i = 0; i <= intervals; ++i) {
      const double t = c + i * step, weight = i == 0 || i == intervals ? 1 : i % 2 ? 4 : 2;
      slipping += weight * step / 3 * 2 / M_PI * t * t * p0 * rise(t);
    }
    return 4 * M_PI * (4 * angle(c) * c * c * c / (3 * M_PI) + slipping);
  }

 private:
  /// K - E at the modulus sqrt(1 - c²)
  static double rise(double c) {
    const double modulus = std::sqrt(std::max(0.0, 1 - c * c));
    return modulus < 1 ? std::comp_ellint_1(modulus) - std::comp_ellint_2(modulus) : 0;
  }
};

/// A bonded layer under the pressure of a paraboloid: integral equation of torsion with the kernel
/// tanh(kh)/(G k), partial slip, relative 1e-7 (checked by axisymmetric finite elements).
struct LayerTwist {
  static constexpr std::array<double, 6> stick_radius{0.9999, 0.9, 0.65, 0.4, 0.15, 0.001};

  double nu, s;            ///< s = a/h
  double stiffness_ratio;  ///< initial stiffness / (16 G a³/3)
  double full_slip;        ///< M when all slips
  std::array<double, 6> angle, torque;
};

inline const std::vector<LayerTwist>& layer_twists() {
  static const std::vector<LayerTwist> twists{
      {0.3,
       0.5,
       1.0104009666572322,
       0.5885854720506734,
       {3.6965625764966214e-05, 0.03804683675439679, 0.1458507394280943, 0.2875436418652738,
        0.5405072338452217, 1.745050032981684},
       {0.00019917039444205685, 0.17577314717876713, 0.44749856131003796, 0.5586305746799768,
        0.5871191554013636, 0.5885854716248835}},
      {0.3,
       2,
       1.2581477238046626,
       0.5683261447413811,
       {2.5601272872407888e-05, 0.027544691457403334, 0.11844796396337129, 0.26093086364565,
        0.5440345326789515, 1.922106316301444},
       {0.00017175869766729087, 0.15548920835579044, 0.41662151140024517, 0.5345982006803447,
        0.5666464445619641, 0.5683261442544134}},
      {0.45,
       1,
       1.0615525859023598,
       0.581899808432902,
       {3.329022791392644e-05, 0.0348097778957309, 0.1387699353707768, 0.2834806984443234,
        0.5487607814111747, 1.8123616946199679},
       {0.00018844686589152874, 0.1679730256100469, 0.43623787642836237, 0.5504762656531077,
        0.5803591258729721, 0.5818998079864235}},
      {0.5,
       1,
       1.0615525859023598,
       0.5808313775752972,
       {3.2949964005596e-05, 0.034529550658452944, 0.13836595305167207, 0.2838769358987819,
        0.5512741210513685, 1.824389134360369},
       {0.00018652072504373647, 0.16660132822158918, 0.4343549761288217, 0.5491610803540351,
        0.5792786411045423, 0.5808313771254915}},
      {0.5,
       5,
       2.0580666185743146,
       0.5254239784951067,
       {9.466436251954207e-06, 0.01218535864843944, 0.07168088386196451, 0.19062280207246007,
        0.48797238486201705, 2.206819955246188},
       {0.00010388782081155787, 0.10960000220186582, 0.3590018080849291, 0.48717825119246927,
        0.5233737006965226, 0.5254239778835852}},
  };
  return twists;
}

/// Torque at any angle: Lubkin's curve, or a layer's between its tabulated points. Angle and torque
/// of a layer over those of the half-space at the same stick radius are smooth and interpolated by
/// polynomials; each point left out in turn, the other five give it to 0.4 % in the angle up to
/// a/h = 1, all six to some 0.05 %. Thicker contacts: only at the points themselves.
class TwistCurve {
 public:
  TwistCurve() = default;
  explicit TwistCurve(const LayerTwist& layer) {
    for (std::size_t i = 0; i < LayerTwist::stick_radius.size(); ++i) {
      angle_ratio_[i] = layer.angle[i] / Lubkin::angle(LayerTwist::stick_radius[i]);
      torque_ratio_[i] = layer.torque[i] / Lubkin::torque(LayerTwist::stick_radius[i]);
    }
    stiffness_ratio_ = layer.stiffness_ratio;
  }

  double stiffness_ratio() const { return stiffness_ratio_; }

  double torque(double angle) const {
    double low = 1e-12, high = 1;  // the angle falls with the stick radius
    for (int i = 0; i < 60; ++i) {
      const double middle = low < 1e-3 ? std::sqrt(low * high) : 0.5 * (low + high);
      (interpolate(angle_ratio_, middle) * Lubkin::angle(middle) > angle ? low : high) = middle;
    }
    return interpolate(torque_ratio_, low) * Lubkin::torque(low);
  }

 private:
  using Ratios = std::array<double, 6>;

  static double interpolate(const Ratios& ratio, double c) {
    const auto& at = LayerTwist::stick_radius;
    double sum = 0;
    for (std::size_t i = 0; i < at.size(); ++i) {
      double term = ratio[i];
      for (std::size_t j = 0; j < at.size(); ++j)
        if (j != i) term *= (c - at[j]) / (at[i] - at[j]);
      sum += term;
    }
    return sum;
  }

  Ratios angle_ratio_{1, 1, 1, 1, 1, 1}, torque_ratio_{1, 1, 1, 1, 1, 1};
  double stiffness_ratio_ = 1;
};

}  // namespace softfinger::fem::verification
