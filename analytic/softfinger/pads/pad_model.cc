#include "softfinger/pads/pad_model.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/pads/pad_law.h"

namespace softfinger {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using pads::PadDual;
using pads::PadLaw;
using pads::PadLayer;
using pads::PadResultants;

constexpr std::size_t kX = 0, kY = 1;
/// Share of the face that may have lifted off.
constexpr double kMostLifted = 0.8;

/// Pressures over E/h: `approach` presses, `tilt` tilts so that the pressure grows along x and y.
struct PadMotion {
  double approach_m = 0;
  Vector2d tilt_rad = Vector2d::Zero();
};

/// Forces and moments of a pad's motions, over E/h.
class PadStiffness {
 public:
  PadStiffness(const PadShape& shape, const PadLaw<double>& law) noexcept
      : pressed(pads::pressing_resultants(shape, law)) {
    const Eigen::Matrix2d& plain = shape.outline().second_moments_m4();
    for (std::size_t i = 0; i < 2; ++i) {
      const PadShape::Sums& sums = shape.sums(i == kX ? PadShape::linear_x : PadShape::linear_y);
      force_by_tilt(int(i)) = law.tilt_layer * law.layer_sum(sums, sums.integral);
      moment_by_tilt(0, int(i)) = law.tilt_layer * law.layer_sum(sums, sums.moment_x);
      moment_by_tilt(1, int(i)) = law.tilt_layer * law.layer_sum(sums, sums.moment_y);
    }
    moment_by_tilt += (1 + law.tilt_uniform) * plain;
  }

  /// Moments by tilts under a constant load.
  Eigen::Matrix2d tilting() const noexcept {
    const Vector2d moment(pressed.moment[kX], pressed.moment[kY]);
    return moment_by_tilt - moment * force_by_tilt.transpose() / pressed.force;
  }
  /// @param moment  about the centre of pressure that faces kept parallel have
  PadMotion motion(double force, const Vector2d& moment) const noexcept {
    PadMotion motion;
    motion.tilt_rad = tilting().inverse() * moment;
    motion.approach_m = (force - force_by_tilt.dot(motion.tilt_rad)) / pressed.force;
    return motion;
  }

  PadResultants<double> pressed;
  Vector2d force_by_tilt = Vector2d::Zero();
  Eigen::Matrix2d moment_by_tilt = Eigen::Matrix2d::Zero();
};

/// The rim where a plain column's pressure vanishes first: p ~ d + tilt · r. 1: just there.
double rim_utilisation(const ConvexOutline& outline, const PadMotion& motion) noexcept {
  double least = 0;
  for (const Vector2d& vertex : outline.vertices_m())
    least = std::min(least, motion.tilt_rad.dot(vertex - outline.centroid_m()));
  return motion.approach_m > 0 ? -least / motion.approach_m : kInfinity;
}

/// Pressure over E/h at a point by its rows of the three sources.
double pressure_of(const PadShape& shape, const PadLaw<double>& law, const PadMotion& motion,
                   const Vector2d& from_centroid_m,
                   const std::array<const PadShape::Row*, PadShape::kSources>& rows) noexcept {
  const PadShape::Sums& one = shape.sums(PadShape::constant);
  const auto layer = [&](PadShape::Source source) {
    return rows[source] ? law.layer_sum(shape.sums(source), *rows[source]) : 0;
  };
  const double rim = law.rim_sum(one, one.integral) / shape.outline().area_m2() -
                     (rows[PadShape::constant] ? law.rim_sum(one, *rows[PadShape::constant]) : 0);
  return motion.approach_m * (1 + law.excess_uniform +
                              law.excess_layer * layer(PadShape::constant) + law.rim * rim) +
         (1 + law.tilt_uniform) * motion.tilt_rad.dot(from_centroid_m) +
         law.tilt_layer * (motion.tilt_rad.x() * layer(PadShape::linear_x) +
                           motion.tilt_rad.y() * layer(PadShape::linear_y));
}

/// Both pressings of one problem: as pressed, and frictionless, which the largest torque follows.
struct PadLaws {
  PadLaw<double> pressed, slipping;
};

/// tanh(z)/z
double tanh_ratio(double z) noexcept { return z > 1e-4 ? std::tanh(z) / z : 1 - z * z / 3; }

class LayerPadModel final : public PadModel {
 public:
  LayerPadModel(const ModelCard& card, bool is_uniform) : card_(card), is_uniform_(is_uniform) {}
  const ModelCard& card() const noexcept override { return card_; }

  PadPrediction predict(const PadProblem& problem) const noexcept override;
  PadGradient gradient(const PadProblem& problem) const noexcept override;
  double pressure_Pa(const PadProblem& problem, const Vector2d& point_m) const noexcept override;
  std::vector<PressureSample> slipping_pressure(const PadProblem& problem) const override;

 private:
  template <class T>
  PadLaw<T> law(const PadShape& shape, const PadLayer<T>& layer,
                PadPressing pressing) const noexcept {
    if (is_uniform_) return pads::uniform_law<T>();
    return pads::pad_law(shape, layer, pressing == PadPressing::frictionless);
  }
  PadLaw<double> law(const PadProblem& problem, PadPressing pressing) const noexcept {
    const ElasticLayer& layer = problem.layer;
    return law<double>(*problem.shape,
                       {layer.youngs_modulus_Pa, layer.poisson_ratio, layer.thickness_m}, pressing);
  }

  ModelCard card_;
  bool is_uniform_;
};

double foundation(const ElasticLayer& layer) noexcept {
  return layer.youngs_modulus_Pa / layer.thickness_m;
}

/// Place of the load, from the centroid.
Vector2d load_place_m(const PadProblem& problem) noexcept {
  return *problem.load_at_m - problem.shape->outline().centroid_m();
}

/// Motion of a face that could pull.
PadMotion unbounded_motion(const PadProblem& problem, const PadStiffness& stiffness) noexcept {
  const double force = problem.load.normal_force_N / foundation(problem.layer);
  if (!problem.load_at_m) return stiffness.motion(force, Vector2d::Zero());
  const Vector2d middle(stiffness.pressed.centre(kX), stiffness.pressed.centre(kY));
  return stiffness.motion(force, force * (load_place_m(problem) - middle));
}

/// A law's pressures over E/h at the shape's samples, for an approach and for tilts of one.
class SampledLaw {
 public:
  SampledLaw(const PadShape& shape, const PadLaw<double>& law) noexcept
      : samples_(shape.samples()), uniform_(1, 1 + law.tilt_uniform) {
    const PadShape::Sums& one = shape.sums(PadShape::constant);
    uniform_[0] +=
        law.excess_uniform + law.rim * law.rim_sum(one, one.integral) / shape.outline().area_m2();
    for (std::size_t source = 0; source < PadShape::kSources; ++source) {
      const PadShape::Sums& sums = shape.sums(PadShape::Source(source));
      const double layer = source == PadShape::constant ? law.excess_layer : law.tilt_layer;
      for (std::size_t mode = 0; mode < PadShape::kMostModes; ++mode) {
        const double l = sums.stiffness_per_m2[mode];
        by_mode_[source](Eigen::Index(mode)) =
            layer * law.numerator / (law.compressible + law.per_stiffness * l);
        if (source == PadShape::constant)
          by_mode_[source](Eigen::Index(mode)) -= law.rim * law.rim_per_m2 / (law.rim_per_m2 + l);
      }
    }
  }

  std::size_t size() const noexcept { return samples_.points_m.size(); }
  double area_m2(std::size_t i) const noexcept { return samples_.areas_m2[i]; }
  const Vector2d& from_centroid_m(std::size_t i) const noexcept { return samples_.points_m[i]; }
  Vector3d per_motion(std::size_t i) const noexcept {
    const Vector2d& point = samples_.points_m[i];
    Vector3d pressures(uniform_[0], uniform_[1] * point.x(), uniform_[1] * point.y());
    for (std::size_t source = 0; source < PadShape::kSources; ++source)
      pressures[Eigen::Index(source)] +=
          samples_.modes[source].row(Eigen::Index(i)).dot(by_mode_[source]);
    return pressures;
  }

 private:
  const PadShape::Samples& samples_;
  Vector2d uniform_;
  std::array<Eigen::Matrix<double, 1, PadShape::kMostModes>, PadShape::kSources> by_mode_;
};

/// A face under a load beside its middle.
struct BalancedFace {
  PadMotion motion;
  double arm_m = 0;         ///< int p |r - centre| dA over the load
  double lifted_share = 0;  ///< of the area, in which p would be negative
  bool is_known = false;
};

/// A face does not pull: p = max(0, law), with the approach and the tilts that carry the load at
/// its place. Where nothing lifts off that is the law itself, for columns it is exact.
BalancedFace balanced_face(const PadProblem& problem, const PadLaw<double>& law) noexcept {
  const PadShape& shape = *problem.shape;
  const PadMotion motion = unbounded_motion(problem, PadStiffness(shape, law));
  const double force = problem.load.normal_force_N / foundation(problem.layer);
  const Vector2d place = load_place_m(problem);
  constexpr int kMostSteps = 40;
  constexpr double kArrived = 1e-9;
  const SampledLaw samples(shape, law);
  const double size = shape.size_m();
  // Unknowns and residuals in units of the size: all of one kind.
  const Vector3d load(1, place.x() / size, place.y() / size);
  Vector3d unknown =
      Vector3d(motion.approach_m, size * motion.tilt_rad.x(), size * motion.tilt_rad.y());
  struct Look {
    Vector3d missing;
    Matrix3d slope = Matrix3d::Zero();
    double lifted_m2 = 0;
  };
  const auto look = [&](const Vector3d& at) {
    Look seen;
    seen.missing = -load;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      Vector3d pressures = samples.per_motion(i);
      pressures.tail<2>() /= size;
      const double pressure = at.dot(pressures);
      if (!(pressure > 0)) {
        seen.lifted_m2 += samples.area_m2(i);
        continue;
      }
      const Vector2d point = samples.from_centroid_m(i) / size;
      const Vector3d part = samples.area_m2(i) / force * Vector3d(1, point.x(), point.y());
      seen.missing += pressure * part;
      seen.slope += part * pressures.transpose();
    }
    return seen;
  };
  BalancedFace face;
  Look now = look(unknown);
  for (int step = 0; step < kMostSteps && !(now.missing.norm() <= kArrived); ++step) {
    const Vector3d change = now.slope.inverse() * now.missing;
    if (!change.allFinite()) return face;
    double part = 1;
    Look next = look(unknown - change);
    for (; part > 1e-3 && !(next.missing.norm() < now.missing.norm()); part /= 2)
      next = look(unknown - part / 2 * change);
    if (!(next.missing.norm() < now.missing.norm())) return face;
    unknown -= part * change;
    now = next;
  }
  if (!(now.missing.norm() <= kArrived)) return face;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Vector3d pressures = samples.per_motion(i);
    pressures.tail<2>() /= size;
    const double pressure = std::max(0.0, unknown.dot(pressures));
    face.arm_m +=
        samples.area_m2(i) / force * pressure * (samples.from_centroid_m(i) - place).norm();
  }
  face.motion = {unknown[0], unknown.tail<2>() / size};
  face.lifted_share = now.lifted_m2 / shape.outline().area_m2();
  face.is_known = true;
  return face;
}

PadPrediction LayerPadModel::predict(const PadProblem& problem) const noexcept {
  const PadShape& shape = *problem.shape;
  const ConvexOutline& outline = shape.outline();
  const ElasticLayer& layer = problem.layer;
  PadPrediction result;
  if (problem.cylinder) {
    result.validity.add({"flat_face", 0, 1, false,
                         "the object is a cylinder, and this model is for flat faces: line_layer"});
    return result;
  }
  const double wide = shape.size_m() / layer.thickness_m;
  result.validity.add({"width_over_thickness", wide, pads::kLeastWidth, false,
                       "the pad is thicker than its closed form was fitted to: it bends and bulges "
                       "as a column does; ask finite elements"});
  if (!(wide > pads::kNarrowest && wide < pads::kWidest)) return result;

  const PadLaw<double> pressed_law = law(problem, problem.pressing);
  const PadStiffness stiffness(shape, pressed_law);
  const double per_length = foundation(layer), load_N = problem.load.normal_force_N;
  const PadMotion unbounded = unbounded_motion(problem, stiffness);
  BalancedFace pressed;
  if (problem.load_at_m) {
    pressed = balanced_face(problem, pressed_law);
    if (!pressed.is_known || pressed.lifted_share > kMostLifted) {
      result.validity.add({"lifted_share", pressed.is_known ? pressed.lifted_share : 1, kMostLifted,
                           true,
                           "the load lies so near to the outline that nearly all of the face has "
                           "lifted off: press nearer to the middle"});
      return result;
    }
  }
  const PadMotion motion = problem.load_at_m ? pressed.motion : unbounded;
  result.indentation_m = motion.approach_m;
  result.normal_stiffness_N_per_m = per_length * stiffness.pressed.force;
  const Vector2d centre = problem.load_at_m
                              ? *problem.load_at_m
                              : outline.centroid_m() + Vector2d(stiffness.pressed.centre(kX),
                                                                stiffness.pressed.centre(kY));
  result.centre_x_m = centre.x();
  result.centre_y_m = centre.y();
  result.tilt_rad = {motion.tilt_rad.y(), motion.tilt_rad.x()};

  const PadShape::Sums &one = shape.sums(PadShape::constant),
                       &by_x = shape.sums(PadShape::linear_x),
                       &by_y = shape.sums(PadShape::linear_y);
  const int probes = problem.load_at_m ? PadShape::kProbes : PadShape::kCentricProbes;
  for (std::size_t i = 0; i < std::size_t(probes); ++i)
    result.peak_pressure_Pa = std::max(
        result.peak_pressure_Pa,
        per_length * pressure_of(shape, pressed_law, motion, shape.probes_m()[i],
                                 {&one.at_probe[i], &by_x.at_probe[i], &by_y.at_probe[i]}));

  const PadLaw<double> slipping_law = law(problem, PadPressing::frictionless);
  if (problem.load_at_m) {
    result.pressure_arm_m = result.eccentricity_m = pressed.arm_m;
    result.lifted_share = pressed.lifted_share;
    if (problem.pressing == PadPressing::stuck) {
      const BalancedFace slipping = balanced_face(problem, slipping_law);
      result.eccentricity_m = slipping.is_known ? slipping.arm_m : kNaN;
    }
  } else {
    result.pressure_arm_m = stiffness.pressed.arm();
    result.eccentricity_m = problem.pressing == PadPressing::frictionless
                                ? result.pressure_arm_m
                                : pads::pressing_resultants(shape, slipping_law).arm();
  }

  const Eigen::Matrix2d tilting = stiffness.tilting();
  result.tilt_stiffness_Nm_per_rad = {per_length * tilting(1, 1), per_length * tilting(0, 0)};
  const bool is_frictionless = problem.pressing == PadPressing::frictionless;
  const Vector2d half_m = outline.extent_m() / 2;
  const auto lift = [&](double half_extent_m) {
    return is_uniform_
               ? 1
               : pads::lift_off_factor(shape.size_m(), half_extent_m, layer, is_frictionless);
  };
  const double force = load_N / per_length;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    // Eccentricity of one size, to either side.
    const double eccentricity_m = shape.size_m();
    const Vector2d moment =
        force * eccentricity_m * (axis == 0 ? Vector2d::UnitY() : Vector2d::UnitX());
    const double used = std::max(rim_utilisation(outline, stiffness.motion(force, moment)),
                                 rim_utilisation(outline, stiffness.motion(force, -moment)));
    result.tilt_limit_Nm[axis] =
        lift(axis == 0 ? half_m.y() : half_m.x()) * load_N * eccentricity_m / used;
  }
  if (problem.load_at_m) {
    // Between the axes the factor is that of the direction's share.
    const Vector2d off = (*problem.load_at_m - outline.centroid_m()).cwiseAbs();
    const double along_m = off.sum() > 0 ? off.dot(half_m) / off.sum() : half_m.sum() / 2;
    result.tilt_utilisation = rim_utilisation(outline, unbounded) / lift(along_m);
  }

  const double shear_Pa = layer.shear_modulus_Pa(), h = layer.thickness_m;
  const Eigen::Matrix2d& second = outline.second_moments_m4();
  const double plain = second.trace(), free_to_warp = shape.torsion_constant_m4();
  result.torsional_stiffness_Nm_per_rad =
      shear_Pa / h *
      (free_to_warp + (plain - free_to_warp) * tanh_ratio(pads::kWarping * h / shape.size_m()));
  // The free sides carry no shear: a part of the thickness is lost around the rim.
  const double narrow = h / std::sqrt(outline.area_m2() / kPi);
  const double lost = (0.205 - 0.18 * layer.poisson_ratio) * narrow / (1 + 2.25 * narrow * narrow);
  for (std::size_t axis = 0; axis < 2; ++axis)
    result.tangential_stiffness_N_per_m[axis] =
        1 / (h / (shear_Pa * outline.area_m2()) * (1 + lost) +
             h * h * h / (12 * layer.youngs_modulus_Pa * second(int(axis), int(axis))));

  result.validity.add({"strain", motion.approach_m / h, pads::kLargestStrain, true,
                       "the pad is compressed by more than a tenth: rubber stiffens, and linear "
                       "theory does not"});
  if (is_uniform_)
    result.validity.add({"poisson_ratio", layer.poisson_ratio, 0, true,
                         "uniform pressure is exact for nu = 0 only: rubber presses harder in the "
                         "middle of a pad"});
  result.has_answer = true;
  for (const double number :
       {result.indentation_m, result.normal_stiffness_N_per_m, result.peak_pressure_Pa,
        result.pressure_arm_m, result.eccentricity_m, result.tilt_stiffness_Nm_per_rad[0],
        result.tilt_stiffness_Nm_per_rad[1], result.tilt_limit_Nm[0], result.tilt_limit_Nm[1],
        result.tilt_rad[0], result.tilt_rad[1], result.torsional_stiffness_Nm_per_rad,
        result.tangential_stiffness_N_per_m[0], result.tangential_stiffness_N_per_m[1],
        result.tilt_utilisation})
    result.has_answer = result.has_answer && std::isfinite(number);
  if (result.has_answer) return result;
  PadPrediction none;
  none.validity = result.validity;
  none.validity.add({"finite_numbers", 1, 0, true, "a number of the answer is beyond 1e308"});
  return none;
}

PadDerivatives derivatives_of(const PadDual& number, double value, double load_N,
                              double power_of_load) noexcept {
  return {power_of_load * value / load_N, number.slope[0], number.slope[1], number.slope[2]};
}

PadGradient LayerPadModel::gradient(const PadProblem& problem) const noexcept {
  PadGradient gradient;
  if (problem.load_at_m || !predict(problem).has_answer) return gradient;
  const ElasticLayer& layer = problem.layer;
  const PadLayer<PadDual> varied = {PadDual::variable(layer.youngs_modulus_Pa, 0),
                                    PadDual::variable(layer.poisson_ratio, 1),
                                    PadDual::variable(layer.thickness_m, 2)};
  const double load_N = problem.load.normal_force_N, mu = problem.load.friction_coefficient;
  const auto pressed = pads::pressing_resultants(
      *problem.shape, law<PadDual>(*problem.shape, varied, problem.pressing));
  const PadDual slipping_arm =
      pads::pressing_resultants(*problem.shape,
                                law<PadDual>(*problem.shape, varied, PadPressing::frictionless))
          .arm();
  const PadDual stiffness = varied.youngs_modulus_Pa / varied.thickness_m * pressed.force;
  const PadDual indentation = load_N / stiffness, arm = pressed.arm(),
                torque = mu * load_N * slipping_arm;
  gradient.known = true;
  gradient.indentation_m = derivatives_of(indentation, indentation.value, load_N, 1);
  gradient.normal_stiffness_N_per_m = derivatives_of(stiffness, stiffness.value, load_N, 0);
  gradient.pressure_arm_m = derivatives_of(arm, arm.value, load_N, 0);
  gradient.eccentricity_m = derivatives_of(slipping_arm, slipping_arm.value, load_N, 0);
  gradient.max_torque_Nm = derivatives_of(torque, torque.value, load_N, 1);
  return gradient;
}

double LayerPadModel::pressure_Pa(const PadProblem& problem,
                                  const Vector2d& point_m) const noexcept {
  const PadShape& shape = *problem.shape;
  if (!shape.outline().contains(point_m)) return 0;
  const PadLaw<double> law = this->law(problem, problem.pressing);
  const PadMotion motion = problem.load_at_m ? balanced_face(problem, law).motion
                                             : unbounded_motion(problem, PadStiffness(shape, law));
  std::array<PadShape::Row, PadShape::kSources> rows;
  shape.at(point_m, rows);
  const double pressure_Pa = foundation(problem.layer) *
                             pressure_of(shape, law, motion, point_m - shape.outline().centroid_m(),
                                         {&rows[0], &rows[1], &rows[2]});
  return problem.load_at_m ? std::max(0.0, pressure_Pa) : pressure_Pa;
}

std::vector<PressureSample> LayerPadModel::slipping_pressure(const PadProblem& problem) const {
  const PadShape& shape = *problem.shape;
  const PadLaw<double> law = this->law(problem, PadPressing::frictionless);
  const PadMotion motion = problem.load_at_m ? balanced_face(problem, law).motion
                                             : unbounded_motion(problem, PadStiffness(shape, law));
  const SampledLaw samples(shape, law);
  std::vector<PressureSample> result;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vector2d point = shape.outline().centroid_m() + samples.from_centroid_m(i);
    double force_N = foundation(problem.layer) * samples.area_m2(i) *
                     Vector3d(motion.approach_m, motion.tilt_rad.x(), motion.tilt_rad.y())
                         .dot(samples.per_motion(i));
    if (problem.load_at_m) force_N = std::max(0.0, force_N);
    result.push_back({point.x(), point.y(), force_N});
  }
  return result;
}

constexpr const char* kPadSource =
    "equation: Gent and Lindley, Proc. IMechE 173 (1959) 111, and its compressible form; "
    "corrections fitted to finite elements of this project";

}  // namespace

void PadModel::predict_batch(const PadShape& shape, PadPressing pressing, const PadBatch& batch,
                             PadPrediction* predictions) const noexcept {
  PadProblem problem;
  problem.shape = &shape;
  problem.pressing = pressing;
  for (std::size_t i = 0; i < batch.count; ++i) {
    problem.load.normal_force_N = batch.normal_force_N[i];
    problem.layer = {batch.thickness_m[i], batch.youngs_modulus_Pa[i], batch.poisson_ratio[i]};
    predictions[i] = predict(problem);
  }
}

const std::vector<const PadModel*>& all_pad_models() {
  static const LayerPadModel layer = [] {
    ModelCard card;
    card.name = "pad_layer";
    card.title = "flat pad on a rigid backing, of any convex outline, thickness and nu";
    card.assumptions =
        "A flat face covers a flat pad whose side walls are free. Columns of the pad press as they "
        "are compressed, and by the shear that their sideways bulging meets.";
    card.equations =
        "p = (E d/h) (1 + C + G b U + c (psi - mean psi)), k² U - lap U = 1, U = 0 on the outline, "
        "b = 6/((1 + nu) H²), k² = 3 (1 - 2 nu)/(nu² H²); H = h on a stuck face, 2 h on a "
        "frictionless one. C, G, c: fitted. Tilting: source x for 1. Largest torque: mu P times "
        "the "
        "arm of frictionless pressing";
    card.source = kPadSource;
    card.validity =
        "size over thickness (area over half the perimeter, over h) from 0.45 to 16, strain to "
        "0.1, and no lift-off";
    card.cost = "about 1 microsecond; once per outline some ten milliseconds";
    return LayerPadModel(card, false);
  }();
  static const LayerPadModel uniform = [] {
    ModelCard card;
    card.name = "pad_uniform";
    card.title = "uniform pressure of a flat pad";
    card.assumptions = "The pad is a bundle of columns that do not touch each other.";
    card.equations = "p = P/A = E d/h; arm int r dA/A";
    card.source = "exact at nu = 0";
    card.validity = "nu = 0, or a rough torque: up to a fifth too large for thin rubber pads";
    card.cost = "about 1 microsecond; once per outline some ten milliseconds";
    return LayerPadModel(card, true);
  }();
  static const std::vector<const PadModel*> models = {&layer, &uniform};
  return models;
}

const PadModel* find_pad_model(std::string_view name) {
  for (const PadModel* model : all_pad_models())
    if (model->card().name == name) return model;
  return nullptr;
}

}  // namespace softfinger
