#pragma once

#include <functional>
#include <ostream>
#include <string>

namespace softfinger::fem {

/// Writes a file completely or not at all (see meshes::write_whole_file). Folders on the way are
/// made.
/// @param kind  what it is, for the message
/// @throws InputError when it cannot be written
void write_file(const std::string& path, const char* kind,
                const std::function<void(std::ostream&)>& write);

}  // namespace softfinger::fem
