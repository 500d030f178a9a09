#include "fem/contact/pressing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fem/base/formatted.h"
#include "fem/contact/contact_in_time.h"
#include "fem/layer/element_limits.h"
#include "meshes/generation/object_surface.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {

using Eigen::Index;

std::vector<ElasticConstants> Pressing::materials() const {
  return sublayers.empty() ? std::vector<ElasticConstants>{{1, poisson_ratio}} : sublayers;
}

namespace {

/// (1 - nu²)/E
double normal_compliance(const ElasticConstants& of) {
  return (1 - of.poisson_ratio * of.poisson_ratio) / of.youngs_ratio;
}

/// (1 - 2 nu) (1 + nu)/(2 E)
double coupling_compliance(const ElasticConstants& of) {
  return (1 - 2 * of.poisson_ratio) * (1 + of.poisson_ratio) / (2 * of.youngs_ratio);
}

}  // namespace

double Pressing::surface_modulus() const {
  double compliance = normal_compliance(materials().front());
  if (opposite) compliance += normal_compliance(opposite->constants);
  return 1 / compliance;
}

double Pressing::coupling() const {
  double shear = coupling_compliance(materials().front());
  if (opposite) shear -= coupling_compliance(opposite->constants);
  return std::abs(shear) * surface_modulus();
}

MirrorPlanes Pressing::planes() const {
  if (mesh || moves_off_centre) return no_plane;
  if (!fingertip) return both_planes;
  const MirrorPlanes planes = fingertip.symmetric_object ? bent.shape->planes() : no_plane;
  return rubs_deformed && !planes.both() ? no_plane : planes;
}

double Pressing::gap(const SurfaceNode& node) const {
  const double x = node.position.x(), y = node.position.y();
  if (fingertip) {
    const Eigen::Vector2d origin = bent.first_touch.head<2>() + bent.centre;
    const auto height =
        fingertip.object->height(thickness_m * (x + origin.x()), thickness_m * (y + origin.y()));
    if (!height) return beside_object;
    return *height / thickness_m - bent.first_touch.z() - node.position.z();
  }
  const double z = node.position.z();
  if (!std::isfinite(sphere)) return x * x / (2 * major) + y * y / (2 * minor) - z;
  const double r2 = x * x + y * y;
  // Beside the sphere there is nothing to touch: any gap larger than an approach will do.
  return r2 < sphere * sphere ? r2 / (sphere + std::sqrt(sphere * sphere - r2)) - z : 10 * sphere;
}

double Pressed::pressure(Index node) const {
  const SurfaceNode& at = model->nodes()[static_cast<std::size_t>(node)];
  return normal_force[node] / (at.weight * at.area_ratio);
}

double Pressed::torque_arm() const { return moment_of(contact.force) / contact.force.sum(); }

Eigen::Vector2d Pressed::centre() const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (Index i = 0; i < contact.force.size(); ++i)
    sum += contact.force[i] / contact.force.sum() *
           model->nodes()[static_cast<std::size_t>(i)].position.head<2>();
  return model->planes().middle(sum);
}

double Pressed::moment_of(const Eigen::VectorXd& force) const {
  const Eigen::Vector2d middle = centre();
  double moment = 0;
  for (Index i = 0; i < contact.force.size(); ++i)
    moment +=
        force[i] * (model->nodes()[static_cast<std::size_t>(i)].position.head<2>() - middle).norm();
  return moment;
}

namespace {

void set_sublayers(const Problem& problem, Pressing& pressing) {
  const ElasticLayer& layer = problem.contact.layer;
  pressing.poisson_ratio = compressible(layer.poisson_ratio);
  double depth_m = 0;
  for (const Sublayer& sublayer : problem.sublayers) {
    pressing.sublayers.push_back({sublayer.layer.youngs_modulus_Pa / layer.youngs_modulus_Pa,
                                  compressible(sublayer.layer.poisson_ratio)});
    if (depth_m > 0) pressing.interfaces.push_back(depth_m / layer.thickness_m);
    depth_m += sublayer.layer.thickness_m;
  }
}

}  // namespace

Pressing pressing_of(const Problem& problem, CoreWays ways) {
  const RelativeRadii& radii = problem.contact.radii;
  const ElasticLayer& layer = problem.contact.layer;
  const double h = layer.thickness_m;
  Pressing pressing;
  pressing.major = radii.major_m / h;
  pressing.minor = radii.minor_m / h;
  pressing.sphere = problem.sphere_radius_m / h;
  if (problem.approach_m > 0)
    pressing.approach = problem.approach_m / h;
  else
    pressing.load = problem.contact.load.normal_force_N / (layer.youngs_modulus_Pa * h * h);
  if (problem.in_time) {
    pressing.in_time = problem.in_time;
    const double unit = problem.approach_m > 0 ? h : layer.youngs_modulus_Pa * h * h;
    for (PressedInTime::Point& point : pressing.in_time->points) point.value /= unit;
  }
  set_sublayers(problem, pressing);
  pressing.thickness_m = h;
  pressing.unit_of_force_N = layer.youngs_modulus_Pa * h * h;
  pressing.mesh = problem.mesh;
  if (const ElasticLayer& object = problem.contact.object_layer; problem.contact.has_object_layer())
    pressing.opposite = {
        object.thickness_m / h,
        {object.youngs_modulus_Pa / layer.youngs_modulus_Pa, compressible(object.poisson_ratio)}};
  const FrictionRequest& friction = problem.friction;
  pressing.rubs_deformed = problem.finite_strain && friction.any();
  pressing.moves_off_centre =
      problem.finite_strain &&
      ((friction.limit_surface > 0 && friction.increments_to_slip > 0) ||
       (friction.torsion && (friction.twist_axis_x_m != 0 || friction.twist_axis_y_m != 0)));
  if (problem.fingertip) {
    pressing.fingertip = seen_of(problem.fingertip, h);
    pressing.bent = shape_fingertip(pressing.fingertip, h, {}, ways);
  }
  return pressing;
}

namespace {

/// Relative excess of the contact radius that is guessed by summing the stiffnesses of a half-space
/// and of a thin layer. It is largest for layers between these two limits. The formula is fitted to
/// exact round contacts (nu 0 to 1/2, s = a/h from 0.05 to 20); a radius corrected by it is within
/// 2.3 %.
double excess_of_added_stiffness(double s, double nu) {
  const double from_worst = std::log(s / 3.2) / 0.85;
  return (0.13 + 0.14 * std::pow(2 * nu, 3)) * std::exp(-from_worst * from_worst / 2);
}

}  // namespace

LayerDiscretisation first_guess(const Pressing& pressing) {
  const double nu = pressing.poisson_ratio, R = std::sqrt(pressing.major * pressing.minor);
  const double confined = M_PI / 4 * std::pow(1 - nu, 2) / (1 - 2 * nu);  // (pi/4) M / E*
  const double target = pressing.load * (1 - nu * nu) * R;                // P R / (E* h³)
  const auto load = [&](double s) {
    const double thin = 1 / (1 / (confined * s) + 1 / (0.03 * s * s * s));
    return s * s * s * (4.0 / 3 + thin);
  };
  double low = 1e-12, high = 1e12;
  // d = a²/R of Hertz, a²/(2 R) of Winkler, a²/(4 R) of the thin incompressible layer.
  if (pressing.approach > 0) low = high = std::sqrt(1.5 * pressing.approach * R);
  while (high / low > 1.01) {
    const double middle = std::sqrt(low * high);
    (load(middle) < target ? low : high) = middle;
  }
  if (!(pressing.approach > 0)) low /= 1 + excess_of_added_stiffness(low, nu);
  const double stretch = std::pow(pressing.major / pressing.minor, 0.3);
  LayerDiscretisation guess;
  guess.a = low * stretch;
  guess.b = low / stretch;
  guess.interfaces = pressing.interfaces;
  if (pressing.fingertip) {
    guess.reach_x = pressing.bent.reach_x;
    guess.reach_y = pressing.bent.reach_y;
    // A free and a clamped wall bound what lies beyond this extent.
    constexpr double enough = 3.5;
    guess.is_scan = pressing.bent.is_scan;
    if (guess.is_scan) guess.extent = enough;
  }
  return guess;
}

void choose_elements(LayerDiscretisation& mesh, int level) {
  // Finer in thin layers, where the pressure falls within a thickness of the edge: cells of at most
  // 0.4 h on the second level up to b = 9 h.
  // On a scan b is the whole outline's, not an ellipse's.
  const double thin = std::clamp(mesh.b / (mesh.is_scan ? 4.5 : 3), 1.0, 3.0);
  mesh.elements_per_semi_axis =
      static_cast<int>(std::lround((level == 0 ? 3 : 4 << (level - 1)) * thin));
  // Room for the contact to be found a cell larger than it is.
  mesh.patch = std::max(1.25, 1 + 1.2 / mesh.elements_per_semi_axis);
  // On a scan the first level has found the whole outline, and the patch is a whole contact's.
  if (mesh.is_scan && level > 1) mesh.patch = 1 + 1.5 / mesh.elements_per_semi_axis;
}

Outcome<std::shared_ptr<const LayerModel>, FoldedLayer> make_layer(
    const LayerDiscretisation& discretisation, const Pressing& pressing, const Rubs& rubs) {
  if (pressing.mesh)
    return std::make_shared<const LayerModel>(discretisation, pressing.materials(), *pressing.mesh,
                                              pressing.thickness_m, rubs);
  if (pressing.opposite)
    return LayerModel::facing(discretisation, pressing.materials(), *pressing.opposite);
  return LayerModel::made(discretisation, pressing.materials(), pressing.bent.shape,
                          pressing.planes(), rubs);
}

namespace {

/// The node where a contact touches the end of the surface that can be touched; none: nullptr.
const SurfaceNode* touched_end(const std::vector<SurfaceNode>& nodes,
                               const Eigen::VectorXd& force) {
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].at_end && force[static_cast<Index>(i)] > 0) return &nodes[i];
  return nullptr;
}

/// Whether a contact reaches the end of a scan's layer: in which direction, and how much would fit.
/// @param solve  the contact with a compliance, at a share of the load or approach
template <class Solve>
std::optional<FoldedLayer> reached_end(const Pressed& pressed, const Pressing& pressing,
                                       const Solve& solve) {
  const auto& nodes = pressed.model->nodes();
  const SurfaceNode* const end = touched_end(nodes, pressed.contact.force);
  if (!end) return std::nullopt;
  const Eigen::MatrixXd compliance = pressed.cosine.cwiseInverse().asDiagonal() *
                                     pressed.model->compliance() *
                                     pressed.cosine.cwiseInverse().asDiagonal();
  // Nor does what linear elasticity would press through the layer.
  const double fits = share_that_fits([&](double share) {
    const NormalContact contact = solve(compliance, share);
    return contact.approach < 1 && !touched_end(nodes, contact.force);
  });
  return end_of_layer(*end, pressing, fits);
}

}  // namespace

double share_that_fits(const std::function<bool(double)>& fits) {
  double share = 0;
  for (double step = 0.5; step > 5e-4; step /= 2)
    if (fits(share + step)) share += step;
  return share;
}

FoldedLayer end_of_layer(const SurfaceNode& end, const Pressing& pressing,
                         std::optional<double> fits, double around) {
  const double mm = 1e3 * pressing.thickness_m;
  // Around the node, for what is missing there lies on one side of it.
  bool is_rim = false;
  for (const double x : {-around, around})
    for (const double y : {-around, around})
      is_rim = is_rim ||
               ends_finger(pressing.bent.shape->covers(end.x + x, end.x + x, end.y + y, end.y + y));
  const Eigen::Vector2d from_first_touch = end.position.head<2>() + pressing.bent.centre;
  constexpr double nearly = 0.9;
  const bool is_cut =
      (from_first_touch + pressing.bent.first_touch.head<2>()).norm() > nearly * farthest_facet;
  const char* const why = is_rim && is_cut ? "the finger is not looked at any farther"
                          : is_rim         ? "the finger's surface ends"
                                           : "its layer would fold or turn away";
  std::string allowed = "less load, or another point";
  if (fits == 0.0)
    allowed = formatted(
        "another point, %sor far less load: under a thousandth of this one would fit on its mesh, "
        "and a smaller load gets a finer mesh",
        is_rim ? "" : "a thinner layer, ");
  else if (fits && pressing.approach > 0)
    allowed = formatted("an approach of %.3g mm at most, or another point",
                        mm * *fits * pressing.approach);
  else if (fits)
    allowed = formatted("a load of %.3g N at most, or another point",
                        pressing.unit_of_force_N * *fits * pressing.load);
  const std::string where =
      formatted("%s %.3g mm from the first touch, at x %.3g, y %.3g mm", why,
                mm * from_first_touch.norm(), mm * from_first_touch.x(), mm * from_first_touch.y());
  const InputError refusal("contact", "room on the finger", where, allowed);
  if (is_rim) throw refusal;
  return {refusal, fits};
}

std::optional<FoldedLayer> end_beside(const std::vector<SurfaceNode>& nodes,
                                      const Eigen::VectorXd& force, const Pressing& pressing) {
  if (!pressing.bent.is_scan) return std::nullopt;
  const auto covers_around = [&](const SurfaceNode& at, double distance) {
    return pressing.bent.shape->covers(at.x - distance, at.x + distance, at.y - distance,
                                       at.y + distance) == LayerShape::Cover::whole;
  };
  // A cell of the mesh is lost where the layer ends in any part of it.
  for (const double around : {0.1, 0.2, 0.4, 0.8, 1.6, 3.2}) {
    const SurfaceNode* farthest = nullptr;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const SurfaceNode& at = nodes[i];
      if (!(force[static_cast<Index>(i)] > 0) || covers_around(at, around)) continue;
      if (!farthest || at.position.head<2>().norm() > farthest->position.head<2>().norm())
        farthest = &at;
    }
    if (farthest) return end_of_layer(*farthest, pressing, std::nullopt, around);
  }
  return std::nullopt;
}

void set_size(Pressed& pressed, const Pressing& pressing) {
  const LayerDiscretisation& discretisation = pressed.model->discretisation();
  const auto& nodes = pressed.model->nodes();
  const auto count = static_cast<Index>(nodes.size());
  pressed.reaches_rim = false;
  const double spacing_a = 0.5 / discretisation.elements_along_a();
  const double spacing_b = 0.5 / discretisation.elements_along_b();
  for (Index i = 0; i < count; ++i) {
    const double force = pressed.contact.force[i];
    if (force <= 0) continue;
    constexpr double wrapped = 0.3;
    if (pressed.cosine[i] < wrapped)
      throw InputError("contact", "slope of the finger's surface", pressed.cosine[i],
                       "a contact that does not wrap around the finger (cosine of the slope at "
                       "least 0.3): less load");
    if (pressing.mesh && nodes[static_cast<std::size_t>(i)].at_end)
      refuse_end_of_surface(nodes[static_cast<std::size_t>(i)], pressing.thickness_m);
    const double x = std::abs(nodes[static_cast<std::size_t>(i)].x);
    const double y = std::abs(nodes[static_cast<std::size_t>(i)].y);
    if (std::hypot(x / discretisation.a, y / discretisation.b + spacing_b) > discretisation.patch ||
        std::hypot(x / discretisation.a + spacing_a, y / discretisation.b) > discretisation.patch)
      pressed.reaches_rim = true;
  }
  const Eigen::Vector2d axes = discretisation.is_scan
                                   ? holding_axes(nodes, pressed.contact.force, no_plane)
                                   : axes_of_moments(nodes, pressed.contact.force);
  // A row of nodes is as wide as they are apart: no less can be seen.
  pressed.moment_a = std::max(axes.x(), spacing_a * discretisation.a);
  pressed.moment_b = std::max(axes.y(), spacing_b * discretisation.b);
}

Outcome<Pressed, FoldedLayer> press_on(std::shared_ptr<const LayerModel> model,
                                       const Pressing& pressing) {
  Pressed pressed;
  pressed.model = std::move(model);
  const auto& nodes = pressed.model->nodes();
  const auto count = static_cast<Index>(nodes.size());
  pressed.gap.resize(count);
  // On a curved layer contact forces and displacements are along the surface's normals n. In terms
  // of the forces' components along the load, n_z N, and of what nodes sink along it, w / n_z, the
  // problem is that of a flat layer with the compliance C_ij / (n_z,i n_z,j).
  Eigen::VectorXd& cosine = pressed.cosine;
  cosine.resize(count);
  for (Index i = 0; i < count; ++i) {
    const SurfaceNode& node = nodes[static_cast<std::size_t>(i)];
    pressed.gap[i] = pressing.gap(node);
    cosine[i] = node.normal.z();
    // Around the finger's side nothing is pressed on any more.
    constexpr double steepest = 0.2, out_of_reach = 1e3;
    if (cosine[i] > steepest) continue;
    cosine[i] = steepest;
    pressed.gap[i] = out_of_reach;
  }
  // The approach counts from the first touch, which on a triangulated surface is not the origin.
  if (pressing.fingertip) pressed.gap.array() -= pressed.gap.minCoeff();
  const auto solve = [&](const Eigen::MatrixXd& compliance, double share) {
    return pressing.approach > 0
               ? solve_normal_contact_at(compliance, pressed.gap, share * pressing.approach)
               : solve_normal_contact(compliance, pressed.gap,
                                      share * pressing.load / pressed.copies());
  };
  const auto press = [&](const Eigen::MatrixXd& compliance) {
    if (!pressing.in_time) {
      pressed.contact = solve(compliance, 1);
      return;
    }
    PressedInTime of_nodes = *pressing.in_time;
    if (!(pressing.approach > 0))
      for (PressedInTime::Point& point : of_nodes.points) point.value /= pressed.copies();
    // Finer meshes take finer steps: the levels' difference tells of both.
    const int fineness = 2 * pressed.model->discretisation().elements_per_semi_axis;
    ContactInTime found =
        follow_contact(compliance, pressed.gap, of_nodes, pressing.approach > 0, fineness);
    pressed.contact = std::move(found.contact);
    pressed.largest = std::move(found.largest);
  };
  if (pressing.fingertip || pressing.mesh)
    press(cosine.cwiseInverse().asDiagonal() * pressed.model->compliance() *
          cosine.cwiseInverse().asDiagonal());
  else
    press(pressed.model->compliance());
  pressed.normal_force = pressed.contact.force.cwiseQuotient(cosine);

  if (pressing.bent.is_scan)
    if (const std::optional<FoldedLayer> folded = reached_end(pressed, pressing, solve))
      return *folded;

  set_size(pressed, pressing);
  return pressed;
}

std::shared_ptr<const RigidObject> rigid_object(const Pressing& pressing) {
  if (pressing.fingertip) {
    const auto height = [object = pressing.fingertip.object, h = pressing.thickness_m,
                         first = pressing.bent.first_touch, centre = pressing.bent.centre](
                            double x, double y) -> std::optional<double> {
      const auto found =
          object->height(h * (x + first.x() + centre.x()), h * (y + first.y() + centre.y()));
      if (!found) return std::nullopt;
      return *found / h - first.z();
    };
    // A thousandth of the thickness is far below any radius that a layer bears; an edge rounded
    // over a tenth of it is one that Newton's steps do not jump across.
    constexpr double step = 1e-3, rounded_edges = 0.05;
    if (pressing.fingertip.object->faceted()) return smoothed(height, rounded_edges);
    return sampled(height, step);
  }
  if (std::isfinite(pressing.sphere)) return sphere(pressing.sphere);
  return quadric(pressing.major, pressing.minor);
}

void refuse_end_of_surface(const SurfaceNode& node, double thickness_m) {
  throw InputError("mesh of the layer", "physical surface \"contact\"",
                   formatted("ends at x %.4g mm, y %.4g mm", 1e3 * thickness_m * node.x,
                             1e3 * thickness_m * node.y),
                   "one that covers the contact, which reaches that end; or a smaller load");
}

void refuse_end_of_object(const Eigen::Vector2d& place, const Pressing& pressing) {
  const Eigen::Vector2d at_mm = 1e3 * pressing.thickness_m * (place + pressing.bent.centre);
  throw InputError(
      "object", "surface",
      formatted("ends at x %.4g mm, y %.4g mm from the first touch, inside the contact", at_mm.x(),
                at_mm.y()),
      "an object that covers the contact, or less load");
}

Outcome<ContactShape, Unmeasured> measure_shape(const Pressed& pressed, const Pressing& pressing) {
  const auto& nodes = pressed.model->nodes();
  const auto count = static_cast<Index>(nodes.size());
  NodalContact contact(
      {nodes, pressed.model->faces(), pressed.normal_force, !pressing.interfaces.empty(), nullptr});
  contact.planes = pressed.model->planes();
  contact.rough_a = pressed.moment_a;
  contact.rough_b = pressed.moment_b;
  contact.nodal_pressure.resize(count);
  contact.position.resize(2, count);
  for (Index i = 0; i < count; ++i) {
    contact.nodal_pressure[i] = pressed.pressure(i);
    contact.position.col(i) = nodes[static_cast<std::size_t>(i)].position.head<2>();
  }
  contact.place = [&](const Eigen::Vector2d& at) -> Eigen::Vector2d {
    if (!pressing.bent.shape) return at;
    return pressing.bent.shape->position(at.x(), at.y(), 0).head<2>();
  };
  contact.clearance = [&]() -> Eigen::VectorXd {
    const Eigen::VectorXd sunk = pressed.model->compliance() * pressed.normal_force;
    Eigen::VectorXd apart = pressed.gap + sunk.cwiseQuotient(pressed.cosine);
    if (pressed.lift.size() > 0) apart += pressed.lift;
    return apart.array() - pressed.contact.approach;
  };
  contact.modulus = pressing.surface_modulus();
  contact.regular = !pressing.mesh;
  // Nodes just beyond the edge touch now and then. Against fits of round contacts (nu 0.3 to
  // 0.4999, a/h 0.1 to 2): 0.03 cells, +-0.015.
  contact.outline_outside = 0.03;
  return measure_shape(contact);
}

}  // namespace softfinger::fem
