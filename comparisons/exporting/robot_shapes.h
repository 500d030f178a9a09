#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "comparisons/exporting/mjcf.h"
#include "comparisons/exporting/robot_file.h"
#include "comparisons/input/shape.h"

/// The bodies of a robot's file and the shapes by which they touch others, as they stand in the
/// file: every shape has its element, whose line messages name.
namespace softfinger::exporting {

/// A shape whose surface is in another file.
struct NamedMesh {
  std::string file;  ///< as it is named
  const XmlElement* named_by = nullptr;
  Eigen::Vector3d scale =
      Eigen::Vector3d::Ones();  ///< metres per unit of the file, along each axis
};

/// The empty state stands for a shape that is no fingertip, or of which a size is missing.
using RobotShapeKind = std::variant<std::monostate, input::Sphere, input::Ellipsoid,
                                    input::Cylinder, input::Capsule, input::Box, NamedMesh>;

struct RobotShape {
  const XmlElement* element = nullptr;  ///< geom or collision
  std::size_t body = 0;
  RobotShapeKind kind;
  std::string unknown;  ///< why the kind is empty: "a plane"
  Eigen::Isometry3d in_body = Eigen::Isometry3d::Identity();
};

/// A hinge or a slide by which a body hangs on its parent.
struct RobotJoint {
  std::string name;
  bool is_hinge = true;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ(), anchor_m = Eigen::Vector3d::Zero();  ///< in body
  double lower = -std::numeric_limits<double>::infinity();  ///< rad or m
  double upper = std::numeric_limits<double>::infinity();
};

struct RobotBody {
  const XmlElement* element = nullptr;
  std::string name;  ///< empty: none
  int parent = -1;
  Eigen::Isometry3d in_world = Eigen::Isometry3d::Identity();  ///< with all joints at zero
  bool is_placed = true;  ///< false: the file places it in a way that is not known here
  std::vector<RobotJoint> joints;
};

struct RobotShapes {
  std::vector<RobotBody> bodies;  ///< parents before children
  std::vector<RobotShape> shapes;
  /// Folder of MJCF's meshes, relative to the model's; empty for other formats.
  std::string mesh_folder;
  bool strips_paths = false;  ///< of meshes' names
};

/// @throws InputError for numbers that are none, with their line
RobotShapes read_shapes(const XmlFile& file, RobotFormat format, const Mjcf& mjcf);

/// "a sphere of radius 8 mm", "a box of 20 x 20 x 10 mm", "the mesh tip.stl"
std::string in_words(const RobotShape& shape);

}  // namespace softfinger::exporting
