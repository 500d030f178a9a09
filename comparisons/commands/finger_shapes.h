#pragma once

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/commands/contact_choice.h"
#include "comparisons/commands/temporary_folder.h"
#include "comparisons/exporting/robot_shapes.h"
#include "comparisons/exporting/shape_pad.h"
#include "comparisons/input/case.h"
#include "softfinger/input/triangle_surface.h"

/// The contact of a finger whose geometry is that of a robot's own file.
namespace softfinger::commands {

/// Options in place of a case.
struct ShapeChoice {
  std::string layer, object_radius_mm;  ///< as typed
  std::string cases;                    ///< folder for a case of each finger; empty: none
  std::vector<std::string> pads, package_paths;
};

void add_shape_choice(CLI::App& command, ShapeChoice& choice);

/// Finds the meshes that a robot's file names, and reads each once.
class RobotMeshes {
 public:
  /// @param model  the robot's file; empty: standard input
  RobotMeshes(std::filesystem::path model, exporting::RobotFormat format,
              const exporting::RobotShapes& shapes, std::vector<std::string> package_paths);

  /// A file whose coordinates times `metres_per_unit` are those of the shape: the mesh's own, or,
  /// where its scale is not the same along each axis, a copy.
  struct Mesh {
    std::filesystem::path path;
    double metres_per_unit = 1;
    TriangleSurface surface;
  };
  /// @throws InputError
  const Mesh& read(const exporting::NamedMesh& named);
  /// The size of the box around the mesh.
  /// @throws InputError
  Eigen::Vector3d size_m(const exporting::NamedMesh& named);

 private:
  std::filesystem::path find(const exporting::NamedMesh& named) const;

  std::filesystem::path model_;
  exporting::RobotFormat format_;
  std::string mesh_folder_;
  bool strips_paths_;
  std::vector<std::string> package_paths_;
  std::unique_ptr<TemporaryFolder> copies_;
  std::map<std::string, std::unique_ptr<Mesh>> meshes_;  ///< by file and scale
};

/// A finger with its pad, and the case that the two make.
struct ShapedFinger {
  std::string name;
  exporting::RobotShape shape;
  std::string shape_words;  ///< "a sphere of radius 8 mm"
  std::string pad_words;    ///< "towards +z of tip, where joint \"j\" closes"
  bool is_guessed = false;
  Eigen::Vector3d point_in_body_m = Eigen::Vector3d::Zero();
  std::optional<exporting::ShapePad> pad;  ///< of a shape in closed form
  input::Case contact_case;
  /// The flat face on which the pad lies, if any, and its case. A mesh may be flat for a file's
  /// rounding only: there the case of its curvature counts, as long as its answer is usable.
  std::optional<exporting::FlatEnd> flat;
  input::Case pad_case;
  std::size_t flush = 0;  ///< other shapes of the finger that end in the pad's plane
  /// Bodies of these two cases as a case file names them, a mesh as `NAME.stl` in metres.
  std::string bodies, pad_bodies;
  std::string stl;  ///< that mesh, where cases are to be written; empty: no mesh

  bool is_surely_flat() const { return pad && pad->is_flat(); }
};

/// @param choice  the numbers of layer, load and friction; it has no case and no radii
/// @throws InputError where a pad touches along a line, or cannot be guessed, and for what is typed
std::vector<std::unique_ptr<ShapedFinger>> shaped_fingers(
    const exporting::RobotShapes& shapes, const std::vector<exporting::FingerParts>& fingers,
    const ShapeChoice& typed, const ContactChoice& choice, RobotMeshes& meshes);

/// The finger as a case file, with the name of its mesh in it.
/// @param is_flat  the case of the flat face
std::string case_text(const ShapedFinger& finger, bool is_flat, const std::string& name);

/// Advice for a case with a mesh, `finger = { mesh = .., near_mm = [x, y, z] }`, as what is typed
/// here: `--pad FINGER:x,y,z` in the axes of the finger's body.
std::string as_pad(const ShapedFinger& finger, std::string advice);

/// `ask_contact_curve` for the finger's own shape: the advice is in this command's words.
/// @throws InputError
exporting::ContactCurve ask_contact_curve(const ShapedFinger& finger, const ContactChoice& choice);

/// "or a flat side, 6 x 14.3 mm: --pad jaw:1,2,3", the largest flat face of the finger's mesh that
/// makes a usable pad, tried; empty: none, or the finger is no mesh.
std::string flat_pad_in_words(const exporting::RobotShapes& shapes,
                              const exporting::FingerParts& parts, const ShapedFinger& finger,
                              const ShapeChoice& typed, const ContactChoice& choice,
                              RobotMeshes& meshes);

/// The contact that a model finds must lie on one part of the shape.
/// @throws InputError where it reaches the seam to another one
void require_on_one_part(const ShapedFinger& finger, const exporting::ContactCurve& curve);

}  // namespace softfinger::commands
