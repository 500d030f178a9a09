#include "fem/problem/material_choice.h"

namespace softfinger::fem {

const char* name_of(MaterialName name) {
  constexpr const char* names[] = {"neo_hookean", "mooney_rivlin", "yeoh"};
  return names[static_cast<int>(name)];
}

const char* name_of(VolumetricLaw law) {
  return law == VolumetricLaw::quadratic ? "quadratic" : "logarithmic";
}

}  // namespace softfinger::fem
