#include "comparisons/input/friction_law.h"

namespace softfinger::input {
namespace {

template <class Shape>
std::unique_ptr<const FrictionShape> make(double aspect, double exponent) {
  return std::make_unique<const Shape>(aspect, exponent);
}

}  // namespace

const FrictionLaw kEllipsoidLaw = {
    "ellipsoid",
    "f² + (tau/e_n)² <= (mu P)² (Ciocarlie et al. 2007, eq. 1); up to 11 % outside the exact limit "
    "surface, 5 % inside",
    FrictionRule::ellipsoid, nullptr};

const FrictionLaw kSixPatchesLaw = {"six_patches",
                                    "six small contacts, each with an ellipsoid of its own; within "
                                    "1.3 % of the exact limit surface "
                                    "for n = 0 to 4 and a/b to 10",
                                    FrictionRule::limit_surface, make<SixPatchShape>};

const FrictionLaw kLimitSurfaceLaw = {
    "limit_surface",
    "the exact limit surface of the contact ellipse and its pressure (Howe, Cutkosky 1996)",
    FrictionRule::limit_surface, make<LimitSurfaceShape>};

const FrictionLaw kFacetsLaw = {
    "facets",
    "the polytope of `vertices` points of the ellipsoid, inside it (Ciocarlie et al. 2007, eq. 2)",
    FrictionRule::facets, nullptr};

const std::vector<const FrictionLaw*>& all_friction_laws() {
  static const std::vector<const FrictionLaw*> laws = {&kEllipsoidLaw, &kSixPatchesLaw,
                                                       &kLimitSurfaceLaw, &kFacetsLaw};
  return laws;
}

}  // namespace softfinger::input
