#include "comparisons/prediction/local_geometry.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "comparisons/prediction/fit_picture.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/pressure_model.h"
#include "tests/meshes/triangulated_ellipsoid.h"

namespace softfinger {
namespace {

/// A paraboloid of radius 20 mm over |x|, |y| <= 9 mm, edges of 0.5 mm, as a file.
std::filesystem::path paraboloid_file() {
  // Tests run at the same time.
  const auto path = std::filesystem::temp_directory_path() /
                    fmt::format("softfinger_paraboloid_{}.obj",
                                testing::UnitTest::GetInstance()->current_test_info()->name());
  std::ofstream file(path);
  constexpr int kHalf = 18;
  constexpr int kRow = 2 * kHalf + 1;
  for (int j = -kHalf; j <= kHalf; ++j)
    for (int i = -kHalf; i <= kHalf; ++i) {
      const double x = 0.5 * i, y = 0.5 * j;
      file << fmt::format("v {} {} {}\n", x, y, -(x * x + y * y) / 40);
    }
  for (int j = 0; j + 1 < kRow; ++j)
    for (int i = 0; i + 1 < kRow; ++i) {
      const int corner = 1 + i + kRow * j;
      file << fmt::format("f {} {} {}\nf {} {} {}\n", corner, corner + 1, corner + kRow, corner + 1,
                          corner + kRow + 1, corner + kRow);
    }
  return path;
}

input::Case pressed_mesh() {
  return input::parse_case(fmt::format(R"(
id = "paraboloid"
[geometry]
finger = {{ mesh = "{}", point_mm = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }}
object = {{ radii_mm = [inf, inf] }}
[layer]
thickness_mm = 2.0
youngs_modulus_kPa = 100.0
poisson_ratio = 0.45
[contact]
load_N = [0.1, 4.0]
friction_coefficient = 0.5
)",
                                       paraboloid_file().string()),
                           "paraboloid.toml");
}

TEST(LocalGeometry, SaysThatAGivenNormalIsFarFromTheSurfaces) {
  input::Case contact = pressed_mesh();
  auto& normal =
      std::get<input::MeshBody>(std::get<input::BodyPair>(contact.geometry).finger).normal;
  const auto remark = [&](double angle_deg) {
    const double angle_rad = angle_deg * kPi / 180;
    normal = Eigen::Vector3d(std::sin(angle_rad), 0, std::cos(angle_rad));
    return prediction::GeometryResolver(contact).resolve(1).patch->remark;
  };
  EXPECT_NE(remark(50).find("finger's given normal lies 50° off"), std::string::npos) << remark(50);
  EXPECT_EQ(remark(25), "");
}

TEST(NoEllipse, IsNotCalledFlatWhereTheFitCannotTellASaddle) {
  // A bumpy plate: heights of 0.1 mm at random between vertices 1 mm apart.
  const auto path = std::filesystem::temp_directory_path() / "softfinger_bumpy_plate.obj";
  std::ofstream file(path);
  std::mt19937 random(3);
  constexpr int kRow = 15;
  for (int j = 0; j < kRow; ++j)
    for (int i = 0; i < kRow; ++i)
      file << fmt::format("v {} {} {}\n", i - kRow / 2, j - kRow / 2, random() % 2 ? 0.1 : -0.1);
  for (int j = 0; j + 1 < kRow; ++j)
    for (int i = 0; i + 1 < kRow; ++i) {
      const int corner = 1 + i + kRow * j;
      file << fmt::format("f {} {} {}\nf {} {} {}\n", corner, corner + 1, corner + kRow, corner + 1,
                          corner + kRow + 1, corner + kRow);
    }
  file.close();
  input::Case plate = pressed_mesh();
  auto& mesh = std::get<input::MeshBody>(std::get<input::BodyPair>(plate.geometry).finger);
  mesh.path = path;
  try {
    prediction::GeometryResolver(plate).resolve(1);
    ADD_FAILURE() << "a bumpy plate on a plane has no ellipse";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("within the fit's error"), std::string::npos)
        << error.what();
  }
  std::filesystem::remove(path);
}

}  // namespace

TEST(LocalGeometry, FitsAMeshWithOneModelAtAllLoads) {
  const input::Case contact_case = pressed_mesh();
  const prediction::GeometryResolver resolver(contact_case);
  double region_area_m2 = 0;
  for (const double load_N : contact_case.loads_N) {
    const prediction::LocalGeometry geometry = resolver.resolve(load_N);
    ASSERT_TRUE(geometry.patch);
    // Facets of 0.5 mm on a radius of 20 mm.
    EXPECT_NEAR(geometry.radii.major_m, 20e-3, 0.2e-3);
    EXPECT_NEAR(geometry.radii.minor_m, 20e-3, 0.2e-3);
    // Another one's area would jump, and the region with it.
    EXPECT_EQ(geometry.patch_model, "bonded_layer");
    EXPECT_GE(geometry.patch->region_area_m2, region_area_m2);
    region_area_m2 = geometry.patch->region_area_m2;
  }
}

TEST(FitPicture, ShowsTheFacetsThatFaceOutwardsAndTheirHeight) {
  const double radius_m = 10e-3;
  const TriangleSurface ball =
      meshes::triangulated_ellipsoid({radius_m, radius_m, radius_m}, {1e-3, 2e-3, 3e-3}, 32);
  const Eigen::Vector3d direction = Eigen::Vector3d(0.3, -0.5, 0.8).normalized();
  const Eigen::Vector3d point_m = Eigen::Vector3d(1e-3, 2e-3, 3e-3) + radius_m * direction;
  const QuadricFit fit = fit_quadric(ball, point_m, &direction, 3e-3);
  const prediction::FitPicture picture = prediction::picture_of(ball, fit);
  EXPECT_EQ(picture.region_radius_m, 3e-3);
  double area_m2 = 0;
  for (const prediction::FitPicture::Facet& facet : picture.facets) {
    const auto& [a, b, c] = facet.corners_m;
    const double twice_m2 = (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
    EXPECT_GT(twice_m2, 0);
    area_m2 += twice_m2 / 2;
    // A sphere lies below its quadric by r⁴/(8 R³); the fit spreads that over the region.
    const double reach_m = ((a + b + c) / 3).norm();
    EXPECT_LT(std::abs(facet.above_m),
              2 * std::pow(std::max(reach_m, 3e-3), 4) / (8 * std::pow(radius_m, 3)) * 1.5);
  }
  // Up to 1.5 radii along the surface's chord.
  EXPECT_NEAR(area_m2 / (kPi * std::pow(4.5e-3, 2)), 1, 0.15);
}

TEST(LocalGeometry, PlacesBodiesThatNoEllipseDescribesForFiniteElements) {
  const auto box = std::filesystem::temp_directory_path() / "softfinger_table.obj";
  std::ofstream(box) << "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\n"
                        "v -9 -9 -9\nv 9 -9 -9\nv 9 9 -9\nv -9 9 -9\n"
                        "f 1 2 3\nf 1 3 4\nf 5 8 7\nf 5 7 6\nf 1 5 6\nf 1 6 2\n"
                        "f 2 6 7\nf 2 7 3\nf 3 7 8\nf 3 8 4\nf 4 8 5\nf 4 5 1\n";
  input::Case contact_case = pressed_mesh();
  input::MeshBody table;
  table.path = box;
  table.point_m = {1e-3, 2e-3, 0};
  std::get<input::BodyPair>(contact_case.geometry).object = table;
  const prediction::GeometryResolver resolver(contact_case);
  // Eight vertices are too few for a quadric, and on a flat layer there is nothing else.
  EXPECT_THROW(resolver.resolve(0.1), InputError);
  EXPECT_THROW(resolver.place(0.1), InputError);
  contact_case.fem_curved = true;
  const prediction::LocalGeometry placed = resolver.place(0.1);
  EXPECT_NE(placed.no_ellipse.find("vertices"), std::string::npos) << placed.no_ellipse;
  ASSERT_TRUE(placed.patch);
  EXPECT_NEAR(placed.patch->object_fit->normal.z(), 1, 1e-12);
  EXPECT_NEAR(placed.patch->finger_fit->normal.z(), 1, 1e-3);
  // Two bodies given by radii that touch along a line stay refused.
  input::Case line = contact_case;
  line.geometry = input::BodyPair{input::QuadricBody(), input::QuadricBody()};
  auto& bodies = std::get<input::BodyPair>(line.geometry);
  std::get<input::QuadricBody>(bodies.finger).radius_x_m = 12e-3;
  std::get<input::QuadricBody>(bodies.finger).radius_y_m = INFINITY;
  std::get<input::QuadricBody>(bodies.object).radius_x_m = INFINITY;
  std::get<input::QuadricBody>(bodies.object).radius_y_m = INFINITY;
  EXPECT_THROW(prediction::GeometryResolver(line).place(0.1), InputError);
  // A point beside the body stays a mistake.
  std::get<input::MeshBody>(std::get<input::BodyPair>(contact_case.geometry).object).point_m.z() =
      5e-3;
  EXPECT_THROW(resolver.place(0.1), InputError);
}

}  // namespace softfinger
