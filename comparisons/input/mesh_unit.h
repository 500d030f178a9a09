#pragma once

#include <string>

#include "meshes/io/read_surface.h"

/// Remarks about the unit of a mesh, which files in STL, OBJ and PLY do not hold. A wrong unit
/// scales all lengths alike, so that nothing else shows it.
namespace softfinger::input {

/// A finger has a usual width, 5 to 40 mm; of other bodies less is known.
enum class MeshRole { finger, object };

/// The role that a surface's width suggests: from 50 mm on, which no finger is wide, an object's.
MeshRole likely_role(const meshes::SurfaceFile& file);

/// Place where the user states ("tells") the unit: `unit = "m"` or `--unit m`.
enum class UnitIsTold { in_a_file, on_the_command_line };

/// "0.048 mm or 48 mm wide: taken as m" where the unit was guessed and this is not plain, and a
/// doubt where the surface is too wide or too narrow: of a guessed unit for a finger, of a typed
/// one for anything that a hand can hold. A typed unit that is not the file's own counts, and this
/// is said. Empty where there is nothing to say.
std::string unit_remark(const meshes::SurfaceFile& file, MeshRole role, UnitIsTold told);

/// Whether the width is unusual, so that the unit may be wrong.
bool is_width_doubtful(const meshes::SurfaceFile& file, MeshRole role);

/// @throws InputError(where) for a finger whose unit was guessed and that is narrower than 1 mm or
/// wider than 1 m: then its unit has to be typed
void require_finger_size(const meshes::SurfaceFile& file, const std::string& where,
                         UnitIsTold told);

/// "mm" or "m"; for files that say another unit themselves also "cm", "in" and so on, or "0.05 m".
std::string unit_name(double metres_per_unit);

}  // namespace softfinger::input
