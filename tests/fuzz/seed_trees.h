#pragma once
/// Small trees of every kind, as cache files.

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "core/voxels/tree_cache.h"

namespace palpate {

inline constexpr std::uint64_t kSeedSource = 7;

inline std::string seedTree(const std::array<std::int32_t, 3>& dims, Branching branching,
                            LeafModel leaf, bool surfaceOnly, int labels, double share) {
  LabelGrid grid;
  grid.geometry.dims = dims;
  grid.geometry.spacing = Eigen::Vector3d(0.7e-3, 0.6e-3, 1.1e-3);
  grid.labels.resize(grid.geometry.voxelCount());
  std::mt19937 rng(static_cast<std::uint32_t>(dims[0] + 100 * labels));
  for (auto& l : grid.labels) {
    const bool inside = static_cast<double>(rng() % 10000) < share * 10000;
    l = inside ? static_cast<std::uint8_t>(1 + rng() % static_cast<std::uint32_t>(labels)) : 0;
  }
  grid.labels[grid.labels.size() / 2] = 1;
  return treeToCache(VoxelTree::build(grid, {}, {branching, leaf, surfaceOnly}).value(),
                     kSeedSource);
}

inline std::vector<std::string> seedTrees() {
  std::vector<std::string> all;
  for (const Branching branching :
       {Branching::Children8, Branching::Children64, Branching::Children512}) {
    for (const LeafModel leaf : {LeafModel::Distance, LeafModel::Voxel}) {
      all.push_back(seedTree({5, 6, 4}, branching, leaf, false, 1, 0.4));
      all.push_back(seedTree({9, 5, 7}, branching, leaf, true, 3, 0.5));
      all.push_back(seedTree({18, 4, 5}, branching, leaf, false, 2, 0.05));
    }
  }
  // With shared deep bricks and wide ones.
  all.push_back(seedTree({40, 34, 22}, Branching::Children64, LeafModel::Distance, false, 1, 1.0));
  LabelGrid deep;
  deep.geometry.dims = {26, 26, 24};
  deep.labels.assign(deep.geometry.voxelCount(), 1);
  deep.labels[0] = 0;
  all.push_back(treeToCache(VoxelTree::build(deep, {}, {}).value(), kSeedSource));
  return all;
}

}  // namespace palpate
