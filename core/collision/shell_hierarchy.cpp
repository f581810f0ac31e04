#include "core/collision/shell_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace palpate {
namespace {

using Points = std::vector<Eigen::Vector3d>;

// Orders [first, last) so that its runs of `block` points are compact, and each run within.
void orderRun(const Points& points, std::span<std::uint32_t> run, std::size_t block) {
  if (run.size() <= ShellHierarchy::kGroup) return;
  if (run.size() <= block) return orderRun(points, run, block / ShellHierarchy::kArity);
  Eigen::Vector3d lo = points[run[0]];
  Eigen::Vector3d hi = lo;
  for (const std::uint32_t i : run) {
    lo = lo.cwiseMin(points[i]);
    hi = hi.cwiseMax(points[i]);
  }
  Eigen::Index axis = 0;
  (hi - lo).maxCoeff(&axis);
  // Halve by whole blocks, so that blocks are full and follow from their number.
  const std::size_t blocks = (run.size() + block - 1) / block;
  const std::size_t left = blocks / 2 * block;
  std::nth_element(run.begin(), run.begin() + static_cast<std::ptrdiff_t>(left), run.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double pa = points[a][axis];
                     const double pb = points[b][axis];
                     return pa != pb ? pa < pb : a < b;
                   });
  orderRun(points, run.subspan(0, left), block);
  orderRun(points, run.subspan(left), block);
}

// A sphere around the points: near-smallest centre (Badoiu & Clarkson, "Smaller core-sets for
// balls", 2003), then the radius that holds them all.
ShellSphere sphereAround(const Points& points, std::span<const std::uint32_t> run) {
  Eigen::Vector3d lo = points[run[0]];
  Eigen::Vector3d hi = lo;
  for (const std::uint32_t i : run) {
    lo = lo.cwiseMin(points[i]);
    hi = hi.cwiseMax(points[i]);
  }
  Eigen::Vector3d centre = 0.5 * (lo + hi);
  const auto farthest = [&](const Eigen::Vector3d& c) {
    std::uint32_t best = run[0];
    for (const std::uint32_t i : run) {
      if ((points[i] - c).squaredNorm() > (points[best] - c).squaredNorm()) best = i;
    }
    return best;
  };
  std::uint32_t end = farthest(centre);
  Eigen::Vector3d best = centre;
  double bestRadius = (points[end] - centre).norm();
  // Within a per cent of the smallest radius; fewer for the few large nodes, which cost most.
  const int rounds = run.size() <= 256 ? 200 : 40;
  for (int round = 1; round <= rounds; ++round) {
    centre += (points[end] - centre) / (round + 1.0);
    end = farthest(centre);
    const double radius = (points[end] - centre).norm();
    if (radius < bestRadius) {
      best = centre;
      bestRadius = radius;
    }
  }
  return {{best.x(), best.y(), best.z()}, bestRadius};
}

}  // namespace

ShellHierarchy buildShellHierarchy(const Points& points_T) {
  ShellHierarchy h;
  h.order.resize(points_T.size());
  std::iota(h.order.begin(), h.order.end(), 0U);
  std::size_t levels = 1;
  while (ShellHierarchy::pointsPerNode(levels - 1) < points_T.size()) ++levels;
  orderRun(points_T, h.order, ShellHierarchy::pointsPerNode(levels - 1));
  for (const std::uint32_t i : h.order) {
    h.x.push_back(points_T[i].x());
    h.y.push_back(points_T[i].y());
    h.z.push_back(points_T[i].z());
  }
  h.level.resize(levels);
  for (std::size_t l = 0; l < levels; ++l) {
    const std::size_t step = ShellHierarchy::pointsPerNode(l);
    for (std::size_t first = 0; first < h.size(); first += step) {
      const std::size_t count = std::min(step, h.size() - first);
      h.level[l].push_back(
          sphereAround(points_T, std::span<const std::uint32_t>(h.order).subspan(first, count)));
    }
  }
  return h;
}

}  // namespace palpate
