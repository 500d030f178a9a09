#include "fem/model_cache.h"

#include <algorithm>

namespace softfinger::fem {
namespace {

bool same(const LayerDiscretisation& left, const LayerDiscretisation& right) {
  return left.a == right.a && left.b == right.b &&
         left.elements_per_semi_axis == right.elements_per_semi_axis && left.patch == right.patch &&
         left.extent == right.extent;
}

}  // namespace

std::shared_ptr<const LayerModel> ModelCache::flat_layer(const LayerDiscretisation& discretisation,
                                                         double poisson_ratio) {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.poisson_ratio == poisson_ratio &&
           same(entry.model->discretisation(), discretisation);
  });
  if (found != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, found);
    ++hits_;
    return entries_.front().model;
  }
  // Room first: the old model's memory serves the new one.
  while (!entries_.empty() && entries_.size() >= capacity_) entries_.pop_back();
  auto model = std::make_shared<const LayerModel>(discretisation, poisson_ratio);
  if (capacity_ > 0) entries_.push_front({poisson_ratio, model});
  return model;
}

}  // namespace softfinger::fem
