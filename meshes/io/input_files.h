#pragma once

#include <sys/stat.h>

#include <string>
#include <string_view>

/// The files that this process has read. Every reader notes them here, and the writer of files
/// asks, so that no command can destroy its own input. What is made of a file is reused only while
/// its content is the same, whatever its time says.
namespace softfinger::meshes {

/// Notes a file that is about to be read.
/// @throws InputError if `announce_output` has named it before
void note_input(int descriptor, const std::string& path);

/// Notes what was read of a file, for `content_hash`.
void note_content(const std::string& path, std::string_view content);

/// Whether this process has read the file.
bool is_input(const struct stat& file);

/// Names an output before anything is read, so that an input that is the same file is refused
/// before anything is computed. A link is the file that it leads to.
/// @param option  for messages: "--page"
/// @throws InputError if another option names the same file
void announce_output(const std::string& option, const std::string& path);

/// A hash of the bytes that this process read, or of those that are there now if it read none.
/// Empty for a file that cannot be read.
std::string content_hash(const std::string& path);

}  // namespace softfinger::meshes
