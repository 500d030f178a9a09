#pragma once

namespace softfinger::fem {

constexpr int dim = 3;  ///< of space, deal.II's first template argument

}  // namespace softfinger::fem
