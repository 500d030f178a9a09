#include "fem/levels/unsolved.h"

namespace softfinger::fem {

Unsolved unsolved_by(const Obstacle& obstacle) {
  if (const auto* last = std::get_if<NotReached>(&obstacle)) throw last->error;
  return std::get<FoldedLayer>(obstacle);
}

}  // namespace softfinger::fem
