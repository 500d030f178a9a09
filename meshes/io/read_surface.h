#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "meshes/io/mesh_formats.h"
#include "softfinger/input/triangle_surface.h"

namespace softfinger::meshes {

/// Smallest and largest size of a surface, corner to corner of its box. Others are taken for a
/// wrong unit and refused.
constexpr double kSmallestSurface_m = 1e-5, kLargestSurface_m = 5;

/// Larger files, and files with more triangles, are refused.
constexpr std::size_t kLargestSurface_bytes = 1'000'000'000, kMostTriangles = 20'000'000;

/// A surface from a file, with the defects of the file that were repaired.
struct SurfaceFile {
  TriangleSurface surface;  ///< metres, vertices welded
  double size_m = 0;        ///< corner to corner
  /// The middle one of the three sizes of its box. The length of a finger does not matter, nor the
  /// thickness of a patch of its skin.
  double width_m = 0;
  double metres_per_unit = 1e-3;  ///< of the file's coordinates
  bool is_unit_guessed = false;
  std::optional<double> own_metres_per_unit;  ///< as the file says it; STL, OBJ and PLY do not
  std::string left_out;                       ///< of another format: "3 lines were left out"
  int degenerate_triangles = 0;               ///< dropped: zero area
  int duplicate_triangles = 0;                ///< dropped: same three vertices
  int turned_triangles = 0;   ///< faced the other way than their neighbours, see `orient`
  bool is_one_sided = false;  ///< there is no outside: not all triangles can agree
  /// Left out by whoever wants the outer skin alone: inside of a hollow tip, screws, bones.
  std::size_t hidden_triangles = 0;
  /// Edges of the whole file at which it is open; set where hidden triangles were left out, which
  /// opens others.
  std::optional<std::size_t> open_edges;

  /// Closed with inward normals: all triangles were turned round.
  bool was_inside_out() const { return std::size_t(turned_triangles) == surface.triangles.size(); }
};

/// The unit of a file that does not say it: 1e-3 (mm) or 1 (m), in which a surface of this width is
/// nearer to a fingertip's 15 mm on a logarithmic scale.
double guessed_metres_per_unit(double width_in_file);

/// Returns a note on the changes to the file's triangles: "3 degenerate and 1 duplicate triangles
/// were left out; 12 of 800 triangles faced the other way than their neighbours and were turned",
/// or an empty string.
std::string repairs(const SurfaceFile& file);

/// Reads binary or ASCII STL, or OBJ (polygons are cut into triangles), scales it to
/// metres, welds equal vertices and turns the triangles the same way round. The format is
/// recognised by the content, not by the file's name. No other file is opened, whatever this one
/// names (the materials of an OBJ).
///
/// Coordinates pass through single precision, as STL stores them: seven digits, 2 nm on a finger.
/// Vertices closer than four units in the last place are merged.
///
/// @param metres_per_unit  1e-3 for millimetres; none: it is guessed from the surface's width
/// @throws InputError (where = path, with the line where known) for a missing or unreadable file,
/// one that is not regular (a pipe, a device), is no mesh or has no triangles or too many, numbers
/// that are no finite numbers, indices out of range, a truncated file, or a surface larger than 5 m
/// or smaller than 10 micrometres across, which is a wrong unit.
SurfaceFile read_surface(const std::string& path, std::optional<double> metres_per_unit);

/// Reads a file's bytes from memory as `read_surface` does; `path` is used in messages and for its
/// ending.
SurfaceFile parse_surface(std::string bytes, const std::string& path,
                          std::optional<double> metres_per_unit);

/// Reads a file of another format, which has been converted. The unit is the typed one, else the
/// file's own, else it is guessed.
SurfaceFile parse_converted_surface(const ConvertedMesh& mesh, const std::string& path,
                                    std::optional<double> typed_metres_per_unit);

/// Writes a binary STL in millimetres, completely or not at all.
/// @throws InputError when the folder cannot be written or the disk is full.
void write_stl_mm(const TriangleSurface& surface, const std::string& path);

}  // namespace softfinger::meshes
