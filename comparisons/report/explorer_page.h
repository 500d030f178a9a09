#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "comparisons/input/pad.h"
#include "softfinger/input/contact_problem.h"

namespace softfinger::report {

/// Whether the page's script, with the library as WebAssembly, was built beside the program (target
/// softfinger_explorer).
bool has_explorer();
/// The command that builds it, and what this needs.
std::string how_to_build_explorer();
/// Debian packages that this needs.
inline constexpr std::string_view kExplorerPackages =
    "clang lld libc++-14-dev-wasm32 libc++abi-14-dev-wasm32 wasi-libc libclang-rt-14-dev-wasm32";

/// The contact that the page starts with. The sliders have its numbers; the parts of the relative
/// curvature that the finger has stay as they are.
struct ExplorerStart {
  std::string case_name;  ///< as typed; empty: made up
  ContactProblem problem;
};

/// The flat pad that the page starts with. A rectangle or a disc under a larger plane is sliders;
/// any other contact stays as the case has it.
struct PadStart {
  std::string case_name;
  input::PadPair pair;
  ElasticLayer layer;
  ContactLoad load;
};

/// The page of `softfinger explore`: sliders for a contact of curved bodies or of a flat pad, and
/// what the models, their error bounds, the limit surface and the simulators make of it, computed
/// in the browser by the library itself (explorer/explorer.h). It needs no network and no server.
/// @throws InputError without `has_explorer()`
/// @param version  "softfinger 0.1.0"
/// @param command  as typed
/// @param start    none: a silicone finger on a plane by its relative radii, and a rectangular pad
std::string explorer_page(const std::string& version, const std::string& command,
                          const std::variant<std::monostate, ExplorerStart, PadStart>& start = {});

}  // namespace softfinger::report
