#pragma once
/// The label volume: one label per voxel, and the table that names them.
///
/// A plain value, made by imaging (segmentation, files), read by the tree builder. Label 0 is
/// background. At most 255 labels a case.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/grid_geometry.h"

namespace palpate {

/// Labels, x fastest, size() == geometry.voxelCount().
struct LabelGrid {
  GridGeometry geometry;
  std::vector<std::uint8_t> labels;

  [[nodiscard]] std::uint8_t at(std::int32_t i, std::int32_t j, std::int32_t k) const noexcept {
    return labels[geometry.index(i, j, k)];
  }
};

/// One row of labels.toml.
struct LabelInfo {
  std::string name;                                   ///< "bone"; unique in the table, not empty.
  std::uint8_t value = 1;                             ///< 1..255, unique in the table.
  std::array<std::uint8_t, 3> colour{227, 211, 177};  ///< sRGB.
  std::string material = "bone";                      ///< A name in datasets/materials.toml.
};

using LabelTable = std::vector<LabelInfo>;

/// A case's labels and what they are called.
struct LabelState {
  LabelGrid labels;
  LabelTable table;
};

}  // namespace palpate
