#pragma once

namespace softfinger::fem {

/// The energy of a volume change.
enum class VolumetricLaw {
  quadratic,    ///< U = k/2 (J - 1)²
  logarithmic,  ///< U = k/2 (ln J)², Lame's lambda in place of k for the neo-Hookean material
};

enum class MaterialName { neo_hookean, mooney_rivlin, yeoh };

/// A material by the constants of small strain, which every one of them has, and what is its own.
struct MaterialChoice {
  MaterialName name = MaterialName::neo_hookean;
  VolumetricLaw volumetric = VolumetricLaw::quadratic;
  /// Mooney-Rivlin: c01/(c10 + c01), 0 to 1; 0 is the neo-Hookean material.
  double mooney_rivlin_share = 0;
  /// Yeoh: c20/c10 and c30/c10; 0 is the neo-Hookean material.
  double yeoh_second = 0, yeoh_third = 0;
};

/// The names that problems and case files use.
const char* name_of(MaterialName name);
const char* name_of(VolumetricLaw law);

}  // namespace softfinger::fem
