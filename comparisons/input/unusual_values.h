#pragma once

#include <string>
#include <vector>

namespace softfinger::input {

struct Case;
struct Scene;

/// A sentence for each value of a case or a scene that is possible but far outside of what robots'
/// fingers have, with the usual range: mostly a wrong unit. One table holds the ranges.
std::vector<std::string> unusual_values(const Case& contact_case);
std::vector<std::string> unusual_values(const Scene& scene);

}  // namespace softfinger::input
