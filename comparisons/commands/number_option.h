#pragma once

#include <string>
#include <vector>

/// The one reader of numbers that are typed as options.
namespace softfinger::commands {

/// @param allowed  for the message: "a number > 0, in N"
/// @throws InputError(option) unless the text is one finite number
double number_of(const std::string& option, const std::string& text, const std::string& allowed);

/// "1,5" or "1, 5".
/// @param count  how many there have to be; 0: at least one
/// @throws InputError(option) unless each part is a finite number
std::vector<double> numbers_of(const std::string& option, const std::string& text,
                               const std::string& allowed, std::size_t count = 0);

}  // namespace softfinger::commands
