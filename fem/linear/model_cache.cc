#include "fem/linear/model_cache.h"

#include <algorithm>

namespace softfinger::fem {

std::vector<MeshPair> ModelCache::of(const LayerIdentity& layer) const {
  std::vector<MeshPair> result;
  for (const Entry& entry : entries_)
    if (entry.layer == layer) result.push_back(entry.meshes);
  return result;
}

void ModelCache::keep(const LayerIdentity& layer, const MeshPair& meshes) {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.meshes.models == meshes.models;
  });
  if (found != entries_.end()) {
    found->meshes = meshes;  // with what friction has added
    entries_.splice(entries_.begin(), entries_, found);
    ++hits_;
    return;
  }
  entries_.push_front({layer, meshes});
  if (entries_.size() > capacity_) entries_.pop_back();
}

}  // namespace softfinger::fem
