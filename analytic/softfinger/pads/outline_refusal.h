#pragma once

#include <string>

namespace softfinger {

/// Apart from the outline's code, which is also compiled where nothing can be thrown
/// (comparisons/explorer/web).
/// @throws InputError("outline: field = value: allowed: ...")
[[noreturn]] void refuse_outline(const char* field, const std::string& value,
                                 const std::string& allowed);

}  // namespace softfinger
