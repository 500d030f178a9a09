#pragma once

#include <cstddef>
#include <list>
#include <memory>

#include "fem/layer_model.h"

namespace softfinger::fem {

/// Models of flat layers made in one run, so that contacts that differ in modulus, friction, scale,
/// or in load and radii at one size, share a factorisation. It keeps the latest used ones.
class ModelCache {
 public:
  /// @param capacity  models; one of 20 000 unknowns holds about 100 MB
  explicit ModelCache(std::size_t capacity = 4) : capacity_(capacity) {}

  /// The model of this very mesh and Poisson's ratio: kept, or made now.
  /// @throws what LayerModel's constructor throws
  std::shared_ptr<const LayerModel> flat_layer(const LayerDiscretisation& discretisation,
                                               double poisson_ratio);

  /// How often a kept model served.
  int hits() const { return hits_; }

 private:
  struct Entry {
    double poisson_ratio;
    std::shared_ptr<const LayerModel> model;
  };
  std::size_t capacity_;
  std::list<Entry> entries_;  ///< the latest used first
  int hits_ = 0;
};

}  // namespace softfinger::fem
