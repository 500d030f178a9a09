#pragma once

#include <functional>
#include <stdexcept>
#include <string>

namespace softfinger::fem {

/// Called as the work proceeds: one line of plain text per event.
using Progress = std::function<void(const std::string&)>;

/// Asked between two stages: whether to stop with what there is.
using StopRequested = std::function<bool()>;

/// The work was stopped before any level was finished.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("stopped before the first level was finished: no result") {}
};

}  // namespace softfinger::fem
