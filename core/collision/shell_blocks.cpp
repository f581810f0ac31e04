#include "core/collision/shell_blocks.h"

#include <algorithm>
#include <cmath>

#include "core/collision/shell_hierarchy.h"

namespace palpate {
namespace {

constexpr float kNowhere = 1e6f;  // metres
constexpr float kNoRadius = -1e9f;
// A float's rounding, twice over, and what a subtraction in double leaves.
constexpr double kRoundingShare = 0x1p-22;

std::vector<SphereBlock> blocksOf(const std::vector<ShellSphere>& spheres,
                                  const Eigen::Vector3d& middle) {
  std::vector<SphereBlock> blocks((spheres.size() + 15) / 16);
  for (std::size_t i = 0; i < blocks.size() * 16; ++i) {
    SphereBlock& block = blocks[i / 16];
    const std::size_t l = i % 16;
    block.x[l] = block.y[l] = block.z[l] = kNowhere;
    block.r[l] = kNoRadius;
    if (i >= spheres.size()) continue;
    const Eigen::Vector3d exact = Eigen::Vector3d(spheres[i].c) - middle;
    const Eigen::Vector3f c = exact.cast<float>();
    block.x[l] = c.x();
    block.y[l] = c.y();
    block.z[l] = c.z();
    const double r = spheres[i].r + (c.cast<double>() - exact).norm();
    block.r[l] = static_cast<float>(r * (1.0 + kRoundingShare) + exact.norm() * 0x1p-50);
  }
  return blocks;
}

}  // namespace

ShellBlocks buildShellBlocks(const ShellHierarchy& h) {
  Eigen::Vector3d lo(h.x[0], h.y[0], h.z[0]);
  Eigen::Vector3d hi = lo;
  for (std::size_t i = 0; i < h.size(); ++i) {
    const Eigen::Vector3d p(h.x[i], h.y[i], h.z[i]);
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  return buildShellBlocks(h, 0.5 * (lo + hi));
}

ShellBlocks buildShellBlocks(const ShellHierarchy& h, const Eigen::Vector3d& middle) {
  ShellBlocks blocks;
  blocks.middle = middle;
  blocks.leaf.resize((h.size() + 15) / 16);
  for (std::size_t i = 0; i < blocks.leaf.size() * 16; ++i) {
    PointBlock& leaf = blocks.leaf[i / 16];
    const std::size_t l = i % 16;
    leaf.x[l] = leaf.y[l] = leaf.z[l] = kNowhere;
    leaf.index[l] = 0;
    if (i >= h.size()) continue;
    const Eigen::Vector3d p = Eigen::Vector3d(h.x[i], h.y[i], h.z[i]) - blocks.middle;
    leaf.x[l] = static_cast<float>(p.x());
    leaf.y[l] = static_cast<float>(p.y());
    leaf.z[l] = static_cast<float>(p.z());
    leaf.index[l] = h.order[i];
    blocks.reach = std::max(blocks.reach, p.norm());
  }
  for (const auto& spheres : h.level) {
    blocks.level.push_back(blocksOf(spheres, blocks.middle));
    blocks.count.push_back(spheres.size());
  }
  blocks.start = blocks.level.size() - 1;
  while (blocks.start > 0 && blocks.count[blocks.start - 1] <= ShellBlocks::kStart) --blocks.start;
  return blocks;
}

}  // namespace palpate
