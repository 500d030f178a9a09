#include "meshes/scans/eroded_core.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softfinger::meshes {

using Eigen::Vector3d;

ErodedCore::ErodedCore(int half, double cell, int window)
    : half_(half),
      cell_(cell),
      window_(window),
      samples_(static_cast<std::size_t>(4 * half * half)) {}

void ErodedCore::add(int i, int j, const Sample& sample) {
  samples_[index(i, j)].push_back(sample);
}

const ErodedCore::Sample* ErodedCore::nearest(const Vector3d& point, int i, int j) const {
  const Sample* found = nullptr;
  double squared = std::numeric_limits<double>::infinity();
  for (int n = std::max(-half_, j - window_); n < std::min(half_, j + window_); ++n)
    for (int m = std::max(-half_, i - window_); m < std::min(half_, i + window_); ++m) {
      const std::vector<Sample>& cell = samples_[index(m, n)];
      // No sample of a cell is nearer than its first one by more than its diagonal.
      if (cell.empty() || (cell.front().position - point).norm() > std::sqrt(squared) + cell_)
        continue;
      for (const Sample& sample : cell)
        if (const double apart = (sample.position - point).squaredNorm(); apart < squared) {
          squared = apart;
          found = &sample;
        }
    }
  return found;
}

std::optional<Vector3d> ErodedCore::way_to(double depth, const Sample& top, int i, int j,
                                           double longest) const {
  constexpr int most_planes = 60, most_sweeps = 400;
  constexpr double accuracy = 2e-3, settled = 1e-4, astray = 0.02;
  // The shortest vector to one plane is a multiple of its normal; to the space behind several, a
  // sum of these with shares that are not negative.
  std::vector<Sample> planes{top};
  std::vector<double> share{depth};
  Vector3d way = depth * top.normal;
  while (planes.size() < most_planes) {
    const Sample* const foot = nearest(top.position - way, i, j);
    if (!foot) return std::nullopt;
    if (foot->normal.dot(foot->position - top.position + way) > (1 - accuracy) * depth) return way;
    planes.push_back(*foot);
    share.push_back(0);
    double change = 0;
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      change = 0;
      for (std::size_t p = 0; p < planes.size(); ++p) {
        const double lacks = depth - planes[p].normal.dot(planes[p].position - top.position + way);
        const double next = std::max(0.0, share[p] + lacks);
        way += (next - share[p]) * planes[p].normal;
        change = std::max(change, std::abs(next - share[p]));
        share[p] = next;
      }
      if (change < settled * depth) break;
    }
    // Nothing lies behind all of them: the shares grow without end.
    if (change > astray * depth || way.norm() > longest) return std::nullopt;
  }
  return std::nullopt;
}

double ErodedCore::length_to(double depth, const Sample& top, const Vector3d& down, int i, int j,
                             double longest) const {
  // Along a line into a convex body the depth grows ever more slowly: Newton's steps fall short of
  // it, and never go too far. No step is longer than ten times what is lacking.
  constexpr int most_steps = 30;
  constexpr double accuracy = 1e-4, flattest = 0.1;
  double length = depth;
  for (int step = 0; step < most_steps; ++step) {
    const Vector3d at = top.position - length * down;
    const Sample* const foot = nearest(at, i, j);
    if (!foot) break;
    const double lacks = depth - foot->normal.dot(foot->position - at);
    if (lacks < accuracy * depth) break;
    length = std::min(longest, length + lacks / std::max(flattest, foot->normal.dot(down)));
  }
  return length;
}

}  // namespace softfinger::meshes
