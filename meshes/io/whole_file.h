#pragma once

#include <cstddef>
#include <functional>
#include <ostream>
#include <string>

namespace softfinger::meshes {

/// The content of a user's file, which is noted as an input (input_files.h). Pipes and devices are
/// refused: reading a pipe may wait for ever, and a device may have no end.
/// @param field, allowed  of the error's message
/// @throws InputError (where = path) for a file that is missing, unreadable, not regular, or larger
/// than `largest_bytes`.
std::string read_whole_file(const std::string& path, const std::string& field,
                            const std::string& allowed, std::size_t largest_bytes);

/// Writes a file completely or not at all; see output_file.h.
/// @throws InputError (where = path)
void write_whole_file(const std::string& path, const std::function<void(std::ostream&)>& write);

}  // namespace softfinger::meshes
