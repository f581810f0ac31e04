#pragma once
/// Small label volumes for the tests of voxels and collision.

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "core/voxels/label_grid.h"

namespace palpate::testing_volumes {

inline LabelGrid emptyGrid(std::array<std::int32_t, 3> dims, const Eigen::Vector3d& spacing) {
  LabelGrid grid;
  grid.geometry.dims = dims;
  grid.geometry.spacing = spacing;
  grid.labels.assign(grid.geometry.voxelCount(), 0);
  return grid;
}

/// f(i, j, k) gives the label.
template <class F>
LabelGrid makeGrid(std::array<std::int32_t, 3> dims, const Eigen::Vector3d& spacing, F&& f) {
  LabelGrid grid = emptyGrid(dims, spacing);
  std::size_t at = 0;
  for (std::int32_t k = 0; k < dims[2]; ++k) {
    for (std::int32_t j = 0; j < dims[1]; ++j) {
      for (std::int32_t i = 0; i < dims[0]; ++i) {
        grid.labels[at++] = static_cast<std::uint8_t>(f(i, j, k));
      }
    }
  }
  return grid;
}

inline std::vector<std::uint8_t> solidOf(const LabelGrid& grid) {
  std::vector<std::uint8_t> solid(grid.labels.size());
  for (std::size_t i = 0; i < solid.size(); ++i) solid[i] = grid.labels[i] != 0 ? 1 : 0;
  return solid;
}

struct NamedGrid {
  std::string name;
  LabelGrid grid;
};

/// Random ones of several densities, and the shapes that break things.
inline std::vector<NamedGrid> assortedGrids(std::uint32_t seed) {
  std::mt19937 rng(seed);
  std::vector<NamedGrid> all;
  const auto random = [&rng](double share, int labels) {
    return [&rng, share, labels](int, int, int) {
      if (std::uniform_real_distribution<double>(0, 1)(rng) >= share) return 0;
      return std::uniform_int_distribution<int>(1, labels)(rng);
    };
  };
  const Eigen::Vector3d iso = Eigen::Vector3d::Constant(1e-3);
  const Eigen::Vector3d aniso(0.95703e-3, 0.7e-3, 2.5e-3);
  all.push_back({"sparse", makeGrid({19, 14, 11}, aniso, random(0.01, 1))});
  all.push_back({"half", makeGrid({9, 17, 12}, aniso, random(0.5, 3))});
  all.push_back({"dense", makeGrid({12, 9, 10}, iso, random(0.97, 2))});
  all.push_back({"full", makeGrid({7, 6, 5}, aniso, [](int, int, int) { return 4; })});
  all.push_back({"single voxel", makeGrid({21, 9, 13}, iso, [](int i, int j, int k) {
                   return i == 17 && j == 4 && k == 12 ? 9 : 0;
                 })});
  all.push_back({"checkerboard", makeGrid({10, 11, 9}, aniso,
                                          [](int i, int j, int k) { return (i + j + k) % 2; })});
  all.push_back({"thin sheet", makeGrid({18, 18, 18}, iso, [](int, int j, int k) {
                   return k == 9 || j == 3 ? 1 : 0;
                 })});
  all.push_back({"smallest", makeGrid({2, 2, 2}, aniso, [](int i, int, int) { return i; })});
  all.push_back({"flat", makeGrid({2, 37, 3}, aniso, random(0.4, 2))});
  all.push_back({"ball", makeGrid({24, 20, 26}, Eigen::Vector3d(1e-3, 1.2e-3, 0.9e-3),
                                  [](int i, int j, int k) {
                                    const Eigen::Vector3d p(i * 1.0, j * 1.2, k * 0.9);
                                    return (p - Eigen::Vector3d(11.5, 11.4, 11.7)).norm() < 8 ? 2
                                                                                              : 0;
                                  })});
  return all;
}

}  // namespace palpate::testing_volumes
