#include "comparisons/prediction/curved_pad.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/layer/bonded_layer.h"

namespace softfinger::prediction {
namespace {

/// Thicknesses between the ellipse and the pad's side walls from which on they change d and the arm
/// by less than 1 %, by finite elements (fem/pad/README.md).
constexpr double kFromWalls = 3;

}  // namespace

input::Case without_ends(const input::Case& contact_case) {
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  const double along_x_m = pair.curved->radius_x_m, along_y_m = pair.curved->radius_y_m;
  const RelativeRadii radii{std::max(along_x_m, along_y_m), std::min(along_x_m, along_y_m),
                            along_x_m >= along_y_m ? 0 : kPi / 2};
  const double load_N = *std::max_element(contact_case.loads_N.begin(), contact_case.loads_N.end());
  const BondedLayerContact ellipse = bonded_layer_contact(radii, contact_case.layer, load_N);
  const Eigen::Vector2d half_m = along_x_m >= along_y_m ? Eigen::Vector2d(ellipse.a_m, ellipse.b_m)
                                                        : Eigen::Vector2d(ellipse.b_m, ellipse.a_m);
  const Eigen::Vector2d to_walls_m = 0.5 * pair.pad.extent_m() - pair.offset_m.cwiseAbs() - half_m;
  if (!(to_walls_m.minCoeff() >= kFromWalls * contact_case.layer.thickness_m))
    throw InputError(
        contact_case.geometry_where,
        fmt::format("at {:g} N the ellipse would be {:.3g} x {:.3g} mm, and come nearer to the "
                    "pad's sides than {:g} thicknesses: their ends count, which the models do not "
                    "know. Type softfinger fem in the place of softfinger predict",
                    load_N, 2e3 * half_m.x(), 2e3 * half_m.y(), kFromWalls),
        "", "");
  if (!contact_case.doubts.empty())
    throw InputError(contact_case.file.string(), "\u00b1", "a number with its doubt",
                     "plain numbers for a curved object on a flat pad");
  input::Case ordinary = contact_case;
  ordinary.geometry = radii;
  return ordinary;
}

}  // namespace softfinger::prediction
