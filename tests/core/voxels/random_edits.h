#pragma once
/// Random edits of a label grid, for the tests of TreeEditor.

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "core/voxels/tree_editor.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate::testing_volumes {

struct RandomEdit {
  std::string name;
  std::uint8_t label = 0;  ///< 0: removes.
  std::vector<TreeEditor::Voxel> voxels;
};

/// Single voxels, balls, slabs, checkerboards, whole faces, scattered ones; some given twice.
inline RandomEdit randomEdit(std::mt19937& rng, const GridGeometry& g, int labels) {
  const auto any = [&rng](int lo, int hi) {
    return std::uniform_int_distribution<int>(lo, hi)(rng);
  };
  RandomEdit edit;
  if (any(0, 2) == 0) edit.label = static_cast<std::uint8_t>(any(1, labels));
  const TreeEditor::Voxel c{any(0, g.dims[0] - 1), any(0, g.dims[1] - 1), any(0, g.dims[2] - 1)};
  const auto where = [&](auto&& wanted) {
    for (std::int32_t k = 0; k < g.dims[2]; ++k) {
      for (std::int32_t j = 0; j < g.dims[1]; ++j) {
        for (std::int32_t i = 0; i < g.dims[0]; ++i) {
          if (wanted(i, j, k)) edit.voxels.push_back({i, j, k});
        }
      }
    }
  };
  const auto ball = [&](double radius) {
    return [&g, c, radius](int i, int j, int k) {
      const double d = (g.centre_V(i, j, k) - g.centre_V(c[0], c[1], c[2])).norm();
      return d <= radius * g.spacing.minCoeff();
    };
  };
  const auto axis = static_cast<std::size_t>(any(0, 2));
  switch (any(0, 6)) {
    case 0:
      edit.name = "single voxel";
      edit.voxels = {c, c};
      break;
    case 1:
      edit.name = "small ball";
      where(ball(2.5));
      break;
    case 2:
      edit.name = "ball";
      where(ball(6.2));
      break;
    case 3: {
      edit.name = "slab";
      const int thick = any(1, 3);
      where([&](int i, int j, int k) {
        const int at[3] = {i, j, k};
        return std::abs(at[axis] - c[axis]) < thick;
      });
      break;
    }
    case 4:
      edit.name = "checkerboard";
      where([&](int i, int j, int k) { return (i + j + k) % 2 == 0 && ball(7)(i, j, k); });
      break;
    case 5: {
      edit.name = "face";
      const int face = any(0, 1) == 0 ? 0 : g.dims[axis] - 1;
      where([&](int i, int j, int k) {
        const int at[3] = {i, j, k};
        return at[axis] == face;
      });
      break;
    }
    default:
      edit.name = "scattered";
      for (int n = 0; n < 20; ++n) {
        edit.voxels.push_back(
            {any(0, g.dims[0] - 1), any(0, g.dims[1] - 1), any(0, g.dims[2] - 1)});
      }
  }
  std::shuffle(edit.voxels.begin(), edit.voxels.end(), rng);
  return edit;
}

/// Applies it to the grid; gives how many voxels changed.
inline std::size_t apply(const RandomEdit& edit, LabelGrid& grid) {
  std::size_t changed = 0;
  for (const auto& v : edit.voxels) {
    std::uint8_t& label = grid.labels[grid.geometry.index(v[0], v[1], v[2])];
    if ((label != 0) == (edit.label != 0)) continue;
    label = edit.label;
    ++changed;
  }
  return changed;
}

}  // namespace palpate::testing_volumes
