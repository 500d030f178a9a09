#pragma once

#include <filesystem>

/// Comparison with the tool of somebody without this project: the contact as a job for CalculiX,
/// whose `ccx` has to be on the PATH.
namespace softfinger::bench {

bool calculix_is_there();

/// A paraboloid, gap r²/(2R), pressed by `approach` on a layer with h = E = 1, the contact's radius
/// being about `a`: a quarter of C3D8I elements, `elements` per a, fixed at the base, and a rigid
/// body of C3D8 in face-to-face contact with linear overclosure.
struct CalculixContact {
  double a = 1, radius = 60, poisson_ratio = 0.3, approach = 0;
  int elements = 12;
  double contact_stiffness = 1000;  ///< pressure per overclosure; CalculiX leaves it to the user
};

/// Writes the input, runs `ccx` in `folder` and reads the load of the whole contact.
/// @throws std::runtime_error when there is no result
double load_by_calculix(const CalculixContact& contact, const std::filesystem::path& folder);

/// 3 per node that is written.
long unknowns_of(const CalculixContact& contact);

}  // namespace softfinger::bench
