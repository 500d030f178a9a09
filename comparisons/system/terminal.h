#pragma once

#include <cstddef>
#include <string>

/// Settings of the person at the terminal: quiet, colours, width.
namespace softfinger::system {

/// Leaves out remarks and progress on standard error: errors alone.
void set_quiet(bool quiet);
bool is_quiet();

/// Whether a stream is shown in colours: it is a terminal that knows them, unless NO_COLOR is set
/// (https://no-color.org) or CLICOLOR_FORCE asks for colours in a file, too.
bool has_colour(int descriptor);

/// The text of a result with its titles in bold face and with "yes" and "no" of the column "usable"
/// in green and red.
/// @param visible  without control characters but line breaks
std::string with_colours(const std::string& visible);

/// The text with longer lines broken at spaces, so that each fits the terminal that standard output
/// is; as it is where that is none. What follows a break is indented by four columns more.
std::string within_terminal(const std::string& text);
/// Breaks the lines as `within_terminal` does, for a given width.
/// @param columns  at least 20
std::string within_columns(const std::string& text, std::size_t columns);

/// A line for standard error with its first words in colour: red for an error, yellow otherwise.
/// @param line  "softfinger: error: ..." or "softfinger: ..."
std::string message_with_colours(const std::string& line);

}  // namespace softfinger::system
