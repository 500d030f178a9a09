// The shapes that a robot's file has, and the radii at their pads, against closed forms.

#include "comparisons/exporting/robot_shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "comparisons/exporting/included_files.h"
#include "comparisons/exporting/shape_pad.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::tests {
namespace {

using Eigen::Vector3d;
using exporting::RobotShapes;
using exporting::ShapePad;
using exporting::XmlFile;

constexpr double kRoundOff = 1e-12;

RobotShapes shapes_of(const XmlFile& file) {
  return exporting::read_shapes(file, exporting::format_of(file), exporting::Mjcf(file));
}

/// The surface's height under its tangent plane at a distance t from the pad is t^2/(2 R).
double radius_by_height(const Vector3d& semi_axes_m, const ShapePad& pad, const Vector3d& along) {
  const double t = 1e-4 * semi_axes_m.minCoeff();
  const Vector3d start = pad.point_m + t * along;
  double low = 0, high = semi_axes_m.minCoeff();
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    const bool is_outside = (start - middle * pad.normal).cwiseQuotient(semi_axes_m).norm() > 1;
    (is_outside ? low : high) = middle;
  }
  return t * t / (2 * low);
}

}  // namespace

TEST(ShapePad, OfASphereHasItsRadius) {
  const ShapePad pad = exporting::pad_towards(input::Sphere{0.008}, Vector3d(0.6, 0, 0.8));
  EXPECT_DOUBLE_EQ(pad.major_radius_m, 0.008);
  EXPECT_DOUBLE_EQ(pad.minor_radius_m, 0.008);
  EXPECT_LT((pad.point_m - Vector3d(0.0048, 0, 0.0064)).norm(), kRoundOff);
  EXPECT_TRUE(std::isinf(pad.to_seam_m));
}

TEST(ShapePad, OfACapsuleIsItsEndOrItsSide) {
  const input::Capsule capsule{0.006, 0.02};
  const ShapePad end = exporting::pad_towards(capsule, Vector3d(0.8, 0, -0.6));
  EXPECT_DOUBLE_EQ(end.major_radius_m, 0.006);
  EXPECT_DOUBLE_EQ(end.minor_radius_m, 0.006);
  EXPECT_LT((end.point_m - Vector3d(0.0048, 0, -0.0136)).norm(), kRoundOff);
  EXPECT_NEAR(end.to_seam_m, 0.006 * std::asin(0.6), kRoundOff);
  EXPECT_FALSE(end.is_line());
  const ShapePad side = exporting::pad_near(capsule, Vector3d(0, 0.007, 0.004));
  EXPECT_TRUE(side.is_line());
  EXPECT_FALSE(side.is_flat());
  EXPECT_DOUBLE_EQ(side.minor_radius_m, 0.006);
  EXPECT_NEAR(side.to_seam_m, 0.006, kRoundOff);
  EXPECT_LT((side.point_m - Vector3d(0, 0.006, 0.004)).norm(), kRoundOff);
  EXPECT_TRUE(exporting::pad_towards(capsule, Vector3d::UnitY()).is_line());
}

TEST(ShapePad, OfAnEllipsoidHasTheSquaresOverTheAxisAtItsPole) {
  const double a = 0.012, b = 0.009, c = 0.005;
  const ShapePad pole = exporting::pad_towards(input::Ellipsoid{{a, b, c}}, Vector3d::UnitZ());
  EXPECT_NEAR(pole.major_radius_m, a * a / c, kRoundOff);
  EXPECT_NEAR(pole.minor_radius_m, b * b / c, kRoundOff);
  const ShapePad side = exporting::pad_towards(input::Ellipsoid{{a, b, c}}, -Vector3d::UnitX());
  EXPECT_NEAR(side.major_radius_m, b * b / a, kRoundOff);
  EXPECT_NEAR(side.minor_radius_m, c * c / a, kRoundOff);
  EXPECT_LT((side.point_m - Vector3d(-a, 0, 0)).norm(), kRoundOff);
}

TEST(ShapePad, OfAnEllipsoidHasItsRadiiAnywhere) {
  const Vector3d axes(0.012, 0.009, 0.005);
  for (const Vector3d& typed : {Vector3d(1, 2, 3), Vector3d(-3, 1, 0.5), Vector3d(0, 1, 1)}) {
    const Vector3d normal = typed.normalized();
    const ShapePad pad = exporting::pad_towards(input::Ellipsoid{axes}, normal);
    EXPECT_NEAR(pad.point_m.cwiseQuotient(axes).norm(), 1, kRoundOff);
    // The least and the largest radius of all normal sections, scanned by 0.1 degrees: 1e-6 of
    // them, and 1e-4 for the step along the surface.
    const Vector3d one = normal.unitOrthogonal(), other = normal.cross(one);
    double least = 1, largest = 0;
    for (int i = 0; i < 1800; ++i) {
      const double angle_rad = i * kPi / 1800;
      const double radius_m =
          radius_by_height(axes, pad, std::cos(angle_rad) * one + std::sin(angle_rad) * other);
      least = std::min(least, radius_m);
      largest = std::max(largest, radius_m);
    }
    EXPECT_NEAR(pad.minor_radius_m / least, 1, 1e-3);
    EXPECT_NEAR(pad.major_radius_m / largest, 1, 1e-3);
    // The nearest point to one straight above is the point itself.
    const ShapePad near = exporting::pad_near(input::Ellipsoid{axes}, pad.point_m + 0.001 * normal);
    EXPECT_LT((near.point_m - pad.point_m).norm(), 1e-9);
  }
}

TEST(ShapePad, OfFlatFacesIsFlat) {
  const input::Box box{{0.01, 0.02, 0.03}};
  const ShapePad face = exporting::pad_towards(box, Vector3d(0.1, -0.9, 0.3).normalized());
  EXPECT_TRUE(face.is_flat());
  EXPECT_EQ(face.normal, -Vector3d::UnitY());
  EXPECT_LT((face.point_m - Vector3d(0, -0.01, 0)).norm(), kRoundOff);
  EXPECT_NEAR(face.to_seam_m, 0.005, kRoundOff);
  const input::Cylinder cylinder{0.01, 0.04};
  EXPECT_TRUE(exporting::pad_towards(cylinder, Vector3d::UnitZ()).is_flat());
  EXPECT_TRUE(exporting::pad_near(cylinder, Vector3d(0.001, 0, -0.021)).is_flat());
  const ShapePad side = exporting::pad_near(cylinder, Vector3d(0.011, 0, 0.015));
  EXPECT_TRUE(side.is_line());
  EXPECT_NEAR(side.to_seam_m, 0.005, kRoundOff);
}

TEST(FlatEnd, HasTheFacesAxesAndSize) {
  const input::Box box{{0.01, 0.02, 0.03}};
  for (const Vector3d& normal : {Vector3d(0, -1, 0), Vector3d(0, 0, 1), Vector3d(-1, 0, 0)}) {
    const exporting::FlatEnd end = exporting::flat_end(box, exporting::pad_near(box, 0.1 * normal));
    EXPECT_NEAR(end.in_shape.linear().determinant(), 1, kRoundOff);
    EXPECT_LT((end.in_shape.linear().col(2) - normal).norm(), kRoundOff);
    EXPECT_LT(
        (end.in_shape.translation() - normal.cwiseProduct(box.size_m) / 2).cwiseAbs().maxCoeff(),
        kRoundOff);
    const auto& figure = std::get<input::RectangleFigure>(end.figure);
    // Half the sides along the figure's axes end on the box's edges.
    const Vector3d corner = end.in_shape * Vector3d(figure.length_m / 2, figure.width_m / 2, 0);
    EXPECT_LT((corner.cwiseAbs() - box.size_m / 2).norm(), kRoundOff);
  }
  const input::Cylinder can{0.01, 0.04};
  const exporting::FlatEnd end =
      exporting::flat_end(can, exporting::pad_near(can, Vector3d(0.001, 0, -0.021)));
  EXPECT_EQ(std::get<input::DiscFigure>(end.figure).diameter_m, 0.02);
  EXPECT_LT((end.in_shape.translation() - Vector3d(0, 0, -0.02)).norm(), kRoundOff);
}

TEST(FlatEnd, OfAMeshIsItsFaceAndNoFaceWithAHole) {
  // A wedge: the face z = 0 is a right triangle of 30 x 40 mm, and 10 mm thick.
  TriangleSurface wedge;
  for (const double z : {0., 0.01})
    for (const Vector3d& corner : {Vector3d(0, 0, 0), Vector3d(0.03, 0, 0), Vector3d(0, 0.04, 0)})
      wedge.vertices_m.push_back(corner + z * Vector3d::UnitZ());
  wedge.triangles = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                     {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  const Vector3d inside(0.01, 0.01, 0);
  const auto end = exporting::flat_end_of_mesh(wedge, inside, -Vector3d::UnitZ());
  ASSERT_TRUE(end);
  const auto& points = std::get<input::OutlineFigure>(end->figure).points_m;
  const auto outline = ConvexOutline::polygon(points);
  EXPECT_NEAR(outline.area_m2(), 0.03 * 0.04 / 2, 1e-12);
  // The outline's middle is the face's, in the mesh's axes.
  const Eigen::Vector2d& middle = outline.centroid_m();
  EXPECT_LT(
      (end->in_shape * Vector3d(middle.x(), middle.y(), 0) - Vector3d(0.01, 0.04 / 3, 0)).norm(),
      1e-9);
  EXPECT_LT((end->in_shape.linear().col(2) + Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_FALSE(exporting::flat_end_of_mesh(wedge, inside, Vector3d(Vector3d::UnitX())));
  EXPECT_FALSE(exporting::flat_end_of_mesh(wedge, Vector3d(0.03, 0.04, 0), -Vector3d::UnitZ()));
}

TEST(RobotShapes, OfMjcfFollowDefaultsFramesAndAngles) {
  const XmlFile file(
      "<mujoco><compiler angle='degree' eulerseq='XYZ' meshdir='meshes'/>"
      "<default><geom type='capsule'/><default class='tip'><geom size='.006 .01'/></default>"
      "</default><asset><mesh file='a/tip.stl' scale='1e-3 1e-3 -1e-3'/></asset>"
      "<worldbody><body name='palm' pos='0 0 1' euler='90 0 90'><frame pos='.1 0 0'>"
      "<geom class='tip' pos='0 .2 0'/></frame><body name='b' pos='1 0 0'><joint name='j' "
      "axis='0 2 0' range='-10 90'/><geom name='n' size='.01' fromto='0 0 0 .04 0 0'/>"
      "<geom type='mesh' mesh='tip'/><geom type='plane' size='1 1 1'/><geom type='box' "
      "size='.01 .02 .03'/></body></body></worldbody></mujoco>",
      "hand.xml");
  const RobotShapes shapes = shapes_of(file);
  ASSERT_EQ(shapes.shapes.size(), 5u);
  EXPECT_EQ(shapes.mesh_folder, "meshes");
  const auto& capsule = std::get<input::Capsule>(shapes.shapes[0].kind);
  EXPECT_EQ(capsule.radius_m, 0.006);
  EXPECT_EQ(capsule.length_m, 0.02);
  EXPECT_LT((shapes.shapes[0].in_body.translation() - Vector3d(.1, .2, 0)).norm(), kRoundOff);
  const auto& rod = std::get<input::Capsule>(shapes.shapes[1].kind);
  EXPECT_NEAR(rod.length_m, 0.04, kRoundOff);
  EXPECT_LT((shapes.shapes[1].in_body.translation() - Vector3d(.02, 0, 0)).norm(), kRoundOff);
  EXPECT_NEAR(std::abs(shapes.shapes[1].in_body.linear()(0, 2)), 1, kRoundOff);
  const auto& mesh = std::get<exporting::NamedMesh>(shapes.shapes[2].kind);
  EXPECT_EQ(mesh.file, "a/tip.stl");
  EXPECT_EQ(mesh.scale, Vector3d(1e-3, 1e-3, -1e-3));
  EXPECT_EQ(shapes.shapes[3].unknown, "a plane");
  EXPECT_EQ(std::get<input::Box>(shapes.shapes[4].kind).size_m, Vector3d(.02, .04, .06));
  const exporting::RobotBody& body = shapes.bodies[shapes.shapes[1].body];
  EXPECT_EQ(body.name, "b");
  ASSERT_EQ(body.joints.size(), 1u);
  EXPECT_EQ(body.joints[0].axis, Vector3d::UnitY());
  EXPECT_NEAR(body.joints[0].upper, kPi / 2, kRoundOff);
  EXPECT_NEAR(body.joints[0].lower, -kPi / 18, kRoundOff);
  // About the fixed x by 90 degrees, then about the fixed z by 90: x becomes y, z becomes x.
  EXPECT_LT((body.in_world.translation() - Vector3d(0, 1, 1)).norm(), kRoundOff);
  EXPECT_LT((body.in_world.linear().col(2) - Vector3d::UnitX()).norm(), kRoundOff);
}

TEST(RobotShapes, OfUrdfHangOnTheirJoints) {
  const XmlFile file(
      "<robot name='r'><link name='tip'><collision><origin xyz='0 0 .01' rpy='0 1.5707963267948966 "
      "0'/><geometry><cylinder radius='.01' length='.03'/></geometry></collision></link>"
      "<link name='base'/><joint name='j' type='revolute'><origin xyz='1 0 0' rpy='0 0 "
      "1.5707963267948966'/><parent link='base'/><child link='tip'/><axis xyz='0 0 3'/><limit "
      "lower='0' upper='1.5'/></joint><joint name='k' type='fixed'><parent link='tip'/><child "
      "link='end'/><origin xyz='1 0 0'/></joint><link name='end'><collision><geometry><mesh "
      "filename='package://r/tip.stl' scale='.001 .001 .001'/></geometry></collision></link>"
      "</robot>",
      "robot.urdf");
  const RobotShapes shapes = shapes_of(file);
  ASSERT_EQ(shapes.shapes.size(), 2u);
  EXPECT_EQ(std::get<input::Cylinder>(shapes.shapes[0].kind).length_m, 0.03);
  EXPECT_LT((shapes.shapes[0].in_body.linear().col(2) - Vector3d::UnitX()).norm(), kRoundOff);
  const exporting::RobotBody& end = shapes.bodies[shapes.shapes[1].body];
  EXPECT_LT((end.in_world.translation() - Vector3d(1, 1, 0)).norm(), kRoundOff);
  const exporting::RobotBody& tip = shapes.bodies[std::size_t(end.parent)];
  EXPECT_EQ(tip.name, "tip");
  EXPECT_EQ(tip.joints.at(0).axis, Vector3d::UnitZ());
  EXPECT_EQ(tip.joints.at(0).upper, 1.5);
  EXPECT_EQ(std::get<exporting::NamedMesh>(shapes.shapes[1].kind).scale, Vector3d::Constant(.001));
  // A ring of links has no place, and ends.
  const XmlFile ring(
      "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='fixed'><parent "
      "link='a'/><child link='b'/></joint><joint name='k' type='fixed'><parent link='b'/><child "
      "link='a'/></joint></robot>",
      "ring.urdf");
  for (const exporting::RobotBody& body : shapes_of(ring).bodies) EXPECT_FALSE(body.is_placed);
}

TEST(RobotShapes, OfSdfHaveTheirModelsPose) {
  const XmlFile file(
      "<sdf version='1.9'><model name='m'><pose>1 0 0 0 0 1.5707963267948966</pose><link name='l'>"
      "<pose>1 0 0 0 0 0</pose><collision name='c'><geometry><ellipsoid><radii>.01 .02 .03</radii>"
      "</ellipsoid></geometry></collision></link><link name='k'><pose relative_to='l'>1 0 0 0 0 0"
      "</pose></link></model></sdf>",
      "robot.sdf");
  const RobotShapes shapes = shapes_of(file);
  ASSERT_EQ(shapes.shapes.size(), 1u);
  EXPECT_EQ(std::get<input::Ellipsoid>(shapes.shapes[0].kind).semi_axes_m, Vector3d(.01, .02, .03));
  const exporting::RobotBody& body = shapes.bodies[shapes.shapes[0].body];
  EXPECT_LT((body.in_world.translation() - Vector3d(1, 1, 0)).norm(), kRoundOff);
  EXPECT_FALSE(shapes.bodies[1].is_placed);
}

TEST(RobotShapes, RefuseNumbersThatAreNone) {
  for (const char* size : {"nan", "1e999", "0.01 x", "0x"}) {
    const XmlFile file(
        "<mujoco><worldbody>\n<geom size='" + std::string(size) + "'/></worldbody></mujoco>",
        "bad.xml");
    EXPECT_THROW(shapes_of(file), InputError) << size;
  }
  const XmlFile empty("<mujoco><worldbody><geom type='sphere' size='0'/></worldbody></mujoco>",
                      "e.xml");
  EXPECT_NE(shapes_of(empty).shapes.at(0).unknown.find("not > 0"), std::string::npos);
}

}  // namespace softfinger::tests
