#include "core/trade/coarse_labels.h"

#include <algorithm>

namespace palpate {
namespace {

std::uint8_t commonest(const LabelGrid& grid, const std::array<std::int32_t, 3>& first,
                       int factor) {
  std::array<int, 256> count{};
  int all = 0;
  const auto end = [&](std::size_t axis) {
    return std::min(first[axis] + factor, grid.geometry.dims[axis]);
  };
  for (std::int32_t k = first[2]; k < end(2); ++k) {
    for (std::int32_t j = first[1]; j < end(1); ++j) {
      for (std::int32_t i = first[0]; i < end(0); ++i, ++all) ++count[grid.at(i, j, k)];
    }
  }
  if (2 * count[0] > all) return 0;
  const auto best = std::max_element(count.begin() + 1, count.end());
  return static_cast<std::uint8_t>(best - count.begin());
}

}  // namespace

LabelGrid coarseLabels(const LabelGrid& grid, int factor) {
  LabelGrid coarse;
  coarse.geometry = grid.geometry;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    coarse.geometry.dims[axis] = (grid.geometry.dims[axis] + factor - 1) / factor;
  }
  coarse.geometry.spacing *= factor;
  coarse.geometry.X_PV.translation() +=
      grid.geometry.X_PV.linear() * (0.5 * (factor - 1) * grid.geometry.spacing);
  coarse.labels.reserve(coarse.geometry.voxelCount());
  for (std::int32_t k = 0; k < coarse.geometry.dims[2]; ++k) {
    for (std::int32_t j = 0; j < coarse.geometry.dims[1]; ++j) {
      for (std::int32_t i = 0; i < coarse.geometry.dims[0]; ++i) {
        coarse.labels.push_back(commonest(grid, {i * factor, j * factor, k * factor}, factor));
      }
    }
  }
  return coarse;
}

}  // namespace palpate
