#pragma once

#include <array>
#include <cstddef>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/friction/friction_study.h"
#include "fem/layer/layer_model.h"

namespace softfinger::fem {

/// Properties that two contacts must share for one to be solved on the other's meshes.
struct LayerIdentity {
  std::vector<ElasticConstants> sublayers;
  std::vector<double> interfaces;
  std::string fingertip;  ///< a different text for each shape of curved layer over h; empty: flat
  MirrorPlanes planes;
  int level = 2;  ///< as in `Problem`
  std::optional<OppositeLayer> opposite = std::nullopt;

  bool operator==(const LayerIdentity& other) const {
    return sublayers == other.sublayers && interfaces == other.interfaces &&
           fingertip == other.fingertip && planes == other.planes && level == other.level &&
           opposite == other.opposite;
  }
};

/// The coarse and the fine mesh of an answer.
struct MeshPair {
  std::array<std::shared_ptr<const LayerModel>, 2> models;
  /// Semi-axes, in h, that each of them found for the contact that they were made for.
  std::array<std::array<double, 2>, 2> made_for{};
  /// The compliances that friction needs: they hold for any modulus and friction coefficient.
  std::array<KeptCompliances, 2> compliances;
};

/// The meshes of the latest contacts of a run with their factorisations: they serve further
/// contacts of any load, radii, modulus and friction whose size suits them.
class ModelCache {
 public:
  /// @param capacity  pairs; one of 25 000 unknowns holds about 150 MB
  explicit ModelCache(std::size_t capacity = 2) : capacity_(capacity) {}

  /// All that are kept of this layer, the latest used first.
  std::vector<MeshPair> of(const LayerIdentity& layer) const;

  /// Keeps a pair that has served; the one that has not for longest makes room.
  void keep(const LayerIdentity& layer, const MeshPair& meshes);

  std::size_t capacity() const { return capacity_; }
  bool empty() const { return entries_.empty(); }
  void clear() { entries_.clear(); }

  /// The number of times that a kept pair served again.
  int hits() const { return hits_; }

 private:
  struct Entry {
    LayerIdentity layer;
    MeshPair meshes;
  };
  std::size_t capacity_;
  std::list<Entry> entries_;  ///< the latest used first
  int hits_ = 0;
};

}  // namespace softfinger::fem
