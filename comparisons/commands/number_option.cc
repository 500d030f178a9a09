#include "comparisons/commands/number_option.h"

#include "comparisons/text/nearest_name.h"
#include "comparisons/text/number.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

[[noreturn]] void refuse_number(const std::string& option, const std::string& text,
                                const std::string& allowed) {
  throw InputError("command line", option, "\"" + text::shortened(text) + "\"", allowed);
}

}  // namespace

double number_of(const std::string& option, const std::string& text, const std::string& allowed) {
  const auto value = text::read_number(text);
  if (!value) refuse_number(option, text, allowed);
  return *value;
}

std::vector<double> numbers_of(const std::string& option, const std::string& text,
                               const std::string& allowed, std::size_t count) {
  const auto values = text::read_numbers(text);
  if (!values || (count > 0 && values->size() != count)) refuse_number(option, text, allowed);
  return *values;
}

}  // namespace softfinger::commands
