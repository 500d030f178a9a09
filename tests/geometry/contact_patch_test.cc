#include "softfinger/geometry/contact_patch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sample_surfaces.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

using Eigen::Vector3d;

/// A Winkler-like prediction: area = 2 pi d sqrt(R' R''), for a given indentation.
std::function<double(const RelativeRadii&)> area_at(double indentation_m) {
  return [=](const RelativeRadii& r) {
    return 2 * kPi * indentation_m * std::sqrt(r.major_m * r.minor_m);
  };
}

TEST(ContactPatch, OfASphereIsTwiceThePredictedArea) {
  const auto ball = samples::sphere(10e-3, 5);
  const double indentation = 0.2e-3;
  const auto patch = fit_contact_patch(MeshContactPoint{&ball, {0, 0, 10e-3}, {}}, Quadric{}, 0,
                                       area_at(indentation));
  EXPECT_TRUE(patch.agrees) << patch.remark;
  EXPECT_TRUE(patch.remark.empty());
  EXPECT_NEAR(patch.region_area_m2 / (2 * patch.predicted_area_m2), 1, 1e-8);
  // Chords of 0.5 mm and the quadric's own error over the region: r²/R² = 4 d/R.
  const double tolerance = 0.05 * 0.05 + 4 * indentation / 10e-3;
  EXPECT_NEAR(patch.relative.radii.major_m / 10e-3, 1, tolerance);
  ASSERT_TRUE(patch.finger_fit.has_value());
  EXPECT_FALSE(patch.object_fit.has_value());
  EXPECT_NEAR(patch.finger_fit->area_m2 / patch.region_area_m2, 1, tolerance);
}

TEST(ContactPatch, OfExactQuadricsNeedsNoRegion) {
  const auto patch = fit_contact_patch(quadric_from_radii(0.01, 0.02), Quadric{}, 0, area_at(1e-4));
  EXPECT_TRUE(patch.agrees);
  EXPECT_EQ(patch.relative.radii.major_m, 0.02);
  EXPECT_EQ(patch.region_area_m2, 0);
  EXPECT_GT(patch.predicted_area_m2, 0);
}

TEST(ContactPatch, SaysInNumbersWhenTheMeshIsTooCoarse) {
  const auto coarse = samples::sphere(10e-3, 3);  // edges of 2 mm
  const auto patch = fit_contact_patch(MeshContactPoint{&coarse, {0, 0, 10e-3}, {}}, Quadric{}, 0,
                                       area_at(0.02e-3));
  EXPECT_FALSE(patch.agrees);
  EXPECT_NE(patch.remark.find("vertices within"), std::string::npos) << patch.remark;
  EXPECT_NE(patch.remark.find("times twice the predicted area"), std::string::npos);
  EXPECT_GE(patch.finger_fit->points, 8);
  EXPECT_GT(patch.region_area_m2, 2 * patch.predicted_area_m2);
}

TEST(ContactPatch, KnowsTheSurfaceToItsFacetsSagittas) {
  // Edges of 2 mm and more around a vertex. A contact of diameter D inside of these facets sees
  // D²/(8 R) of their curvature, which is the indentation itself, as a² = 2 R d.
  const auto coarse = samples::sphere(10e-3, 3);
  const auto open = [](const TriangleSurface& ball, double indentation_m) {
    return fit_contact_patch(MeshContactPoint{&ball, {0, 0, 10e-3}, {}}, Quadric{}, 0,
                             area_at(indentation_m))
               .facet_doubt_m /
           indentation_m;
  };
  // Half an edge's slope is 0.14, squared; the quadric's curvature is less exact over so few.
  EXPECT_NEAR(open(coarse, 0.02e-3), 1, 0.06);
  // Edges of 0.25 to 0.35 mm leave at most 1.5 um, and some 200 vertices a tenth of that.
  EXPECT_LT(open(samples::sphere(10e-3, 6), 0.2e-3), 1e-3);
}

TEST(ContactPatch, SaysWhenTheSurfaceEnds) {
  const auto chip = samples::quadric(3e-3, 20, 50e-3, 50e-3);
  const auto patch =
      fit_contact_patch(MeshContactPoint{&chip, Vector3d::Zero(), {}}, Quadric{}, 0, area_at(1e-3));
  EXPECT_FALSE(patch.agrees);
  EXPECT_NE(patch.remark.find("surface ends"), std::string::npos) << patch.remark;
}

TEST(ContactPatch, ReturnsTheKindWhereThereIsNoEllipse) {
  const auto saddle = samples::quadric(5e-3, 20, 20e-3, -30e-3);
  const auto patch = fit_contact_patch(MeshContactPoint{&saddle, Vector3d::Zero(), {}}, Quadric{},
                                       0, area_at(1e-4));
  EXPECT_EQ(patch.relative.kind, ContactKind::saddle);
  EXPECT_FALSE(patch.agrees);
  EXPECT_NE(patch.remark.find("no region"), std::string::npos) << patch.remark;

  const auto plate = samples::graph(5e-3, 20, [](double, double) { return 0.0; });
  const auto flat = fit_contact_patch(MeshContactPoint{&plate, Vector3d::Zero(), {}}, Quadric{}, 0,
                                      area_at(1e-4));
  EXPECT_EQ(flat.relative.kind, ContactKind::conforming);
  const auto on_rod = fit_contact_patch(MeshContactPoint{&plate, Vector3d::Zero(), {}},
                                        quadric_from_radii(kInfinity, 0.01), 0, area_at(1e-4));
  EXPECT_EQ(on_rod.relative.kind, ContactKind::line);
}

TEST(ContactPatch, SeesAMeshObjectInTheFingersFrame) {
  // The object's flattest direction lies at +0.3 from its own x axis, counter-clockwise about its
  // own normal: clockwise as the finger sees it.
  const auto object = samples::quadric(6e-3, 40, 40e-3, 10e-3, 0.3);
  const MeshContactPoint touch{&object, Vector3d::Zero(), {}};
  const auto patch = fit_contact_patch(quadric_from_radii(0.05, 0.05), touch, 0, area_at(1e-4));
  const auto turned = fit_contact_patch(quadric_from_radii(0.05, 0.05), touch, 0.5, area_at(1e-4));
  const double chords = 0.3 * 0.3 / 100;
  EXPECT_NEAR(patch.relative.radii.axis_rad, -0.3, chords);
  EXPECT_NEAR(turned.relative.radii.axis_rad, 0.5 - 0.3, chords);
  // The two views of one contact agree: finger and object exchanged, seen from the other side.
  const auto exchanged = fit_contact_patch(touch, quadric_from_radii(0.05, 0.05), 0, area_at(1e-4));
  EXPECT_NEAR(exchanged.relative.radii.axis_rad, 0.3, chords);
  EXPECT_NEAR(exchanged.relative.radii.major_m / patch.relative.radii.major_m, 1, 1e-9);
}

TEST(ContactPatch, FitsTwoMeshesOverOneRegion) {
  const auto ball = samples::sphere(10e-3, 5);
  const auto pad = samples::quadric(8e-3, 40, 40e-3, 20e-3);
  const auto patch =
      fit_contact_patch(MeshContactPoint{&pad, Vector3d::Zero(), Vector3d(0, 0, 1)},
                        MeshContactPoint{&ball, {0, 0, 10e-3}, {}}, 0, area_at(1e-4));
  EXPECT_TRUE(patch.agrees) << patch.remark;
  EXPECT_EQ(patch.finger_fit->region_radius_m, patch.object_fit->region_radius_m);
  EXPECT_NEAR(1 / patch.relative.radii.major_m, 100 + 25.0, 0.05 * 125);
  EXPECT_NEAR(1 / patch.relative.radii.minor_m, 100 + 50.0, 0.05 * 150);
}

TEST(ContactPatch, SaysThatTheSurfaceIsNarrowerThanTheContact) {
  auto strip = samples::quadric(8e-3, 60, 20e-3, 10e-3);
  for (Vector3d& vertex : strip.vertices_m) vertex.y() *= 0.1;
  for (Vector3d& vertex : strip.vertices_m)
    vertex.z() = -vertex.x() * vertex.x() / 40e-3 - vertex.y() * vertex.y() / 20e-3;
  const auto patch = fit_contact_patch(MeshContactPoint{&strip, Vector3d::Zero(), {}}, Quadric{}, 0,
                                       area_at(0.3e-3));
  EXPECT_TRUE(patch.agrees) << patch.remark;
  // The strip of 1.6 mm covers about 2 r w / (pi r²) of a disc.
  const double radius_m = std::sqrt(patch.region_area_m2 / kPi);
  EXPECT_NEAR(patch.covered, 2 * 1.6e-3 / (kPi * radius_m), 0.03);
  EXPECT_NE(patch.remark.find("narrower than the contact"), std::string::npos) << patch.remark;
}

TEST(ContactPatch, ReadsTheFacetsOfATessellatedWall) {
  // A cylinder of 24 strips as long as the wall is high: no vertex lies near the point.
  const int strips = 24;
  const double radius_m = 35e-3, height_m = 75e-3;
  TriangleSurface glass;
  for (int i = 0; i < strips; ++i)
    for (const double z_m : {0., height_m})
      glass.vertices_m.push_back({radius_m * std::cos(2 * kPi * i / strips),
                                  radius_m * std::sin(2 * kPi * i / strips), z_m});
  for (int i = 0; i < strips; ++i) {
    const int a = 2 * i, b = 2 * ((i + 1) % strips);
    glass.triangles.push_back({a, b, b + 1});
    glass.triangles.push_back({a, b + 1, a + 1});
  }
  const double angle = kPi / strips, apothem_m = radius_m * std::cos(angle);
  const Vector3d normal(std::cos(angle), std::sin(angle), 0);
  const MeshContactPoint wall{&glass, apothem_m * normal + Vector3d(0, 0, height_m / 2), normal};
  const double ball_m = 9e-3;
  const auto patch = fit_contact_patch(quadric_from_radii(ball_m, ball_m), wall, 0, area_at(2e-4));
  // Straight along the axis, curved across; the facets cut off a sagitta of 1 - cos.
  EXPECT_NEAR(patch.relative.radii.major_m / ball_m, 1, 1e-3);
  EXPECT_NEAR(1 / patch.relative.radii.minor_m - 1 / ball_m, 1 / radius_m, 0.15 / radius_m);
  EXPECT_FALSE(patch.agrees);
  EXPECT_NE(patch.remark.find("several of its facets"), std::string::npos) << patch.remark;
}

/// A finger that along x is pointed at its middle and blunter outside, along y the reverse, and
/// noisy all over: its ellipses change with the region.
TriangleSurface uneven_finger(double noise_m) {
  unsigned state = 1;
  return samples::graph(8e-3, 64, [=](double x, double y) mutable {
    state = state * 1664525u + 1013904223u;
    const double noise = noise_m * (double(state >> 8) / (1 << 24) - 0.5);
    const double waves = 20e-6 * std::cos(x / 0.7e-3) * std::cos(y / 0.9e-3);
    return -x * x / 16e-3 + 3e6 * x * x * x * x * 1e-3 - y * y / 50e-3 + waves + noise;
  });
}

TEST(ContactSurface, GrowsInAllDirectionsWithTheLoad) {
  for (const double noise_m : {0., 2e-6, 20e-6}) {
    const TriangleSurface finger = uneven_finger(noise_m);
    ContactSurface surface(MeshContactPoint{&finger, Vector3d::Zero(), Vector3d(0, 0, 1)},
                           Quadric{}, 0);
    // Semi-axes of the overlap's ellipse, a² = 2 R' d; its direction may turn.
    double region = 0, major_m = 0, minor_m = 0;
    for (double indentation_m = 1e-6; indentation_m < 0.6e-3; indentation_m *= 1.07) {
      const ContactPatch patch = surface.patch(area_at(indentation_m));
      ASSERT_EQ(patch.relative.kind, ContactKind::elliptic);
      const RelativeRadii& radii = patch.relative.radii;
      const double a_m = std::sqrt(2 * radii.major_m * indentation_m),
                   b_m = std::sqrt(2 * radii.minor_m * indentation_m);
      SCOPED_TRACE(indentation_m);
      EXPECT_GE(patch.region_area_m2, region * (1 - 1e-8));
      EXPECT_GE(a_m, major_m * (1 - 1e-8));
      EXPECT_GE(b_m, minor_m * (1 - 1e-8));
      region = patch.region_area_m2;
      major_m = a_m;
      minor_m = b_m;
    }
  }
}

TEST(ContactSurface, FitsEachRegionOnceForAllLoads) {
  const auto ball = samples::sphere(10e-3, 5);
  ContactSurface surface(MeshContactPoint{&ball, {0, 0, 10e-3}, {}}, Quadric{}, 0);
  EXPECT_GT(surface.patch(area_at(0.2e-3)).iterations, 2);
  const ContactPatch again = surface.patch(area_at(0.2e-3));
  EXPECT_EQ(again.iterations, 0);
  EXPECT_EQ(
      again.relative.radii.major_m,
      fit_contact_patch(MeshContactPoint{&ball, {0, 0, 10e-3}, {}}, Quadric{}, 0, area_at(0.2e-3))
          .relative.radii.major_m);
  EXPECT_EQ(again.radii_of_other_regions.size(), 2u);
  EXPECT_NEAR(again.covered, 1, 0.02);
}

TEST(ContactPatch, PassesOnWhatThePredictionThrows) {
  const auto ball = samples::sphere(10e-3, 4);
  const auto broken = [](const RelativeRadii&) -> double { throw std::logic_error("no model"); };
  EXPECT_THROW(fit_contact_patch(MeshContactPoint{&ball, {0, 0, 10e-3}, {}}, Quadric{}, 0, broken),
               std::logic_error);
  const auto none = [](const RelativeRadii&) { return 0.0; };
  EXPECT_THROW(fit_contact_patch(MeshContactPoint{&ball, {0, 0, 10e-3}, {}}, Quadric{}, 0, none),
               InputError);
}

}  // namespace
}  // namespace softfinger
