#pragma once
/// Labels compressed in memory, for undo: a large scan's labels are mostly long runs.

#include <cstdint>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/voxels/label_grid.h"

namespace palpate {

class PackedLabels {
 public:
  PackedLabels() = default;
  /// zlib, fastest level: a 512 × 512 × 800 head in about a second, to a few megabytes. Fails only
  /// where it is cancelled.
  [[nodiscard]] static Result<PackedLabels> pack(const LabelGrid& labels,
                                                 const Progress& progress = {});
  /// The labels again, equal to the last voxel. Fails only where it is cancelled.
  [[nodiscard]] Result<LabelGrid> unpack(const Progress& progress = {}) const;
  [[nodiscard]] std::size_t bytes() const noexcept { return packed_.size(); }

 private:
  GridGeometry geometry_;
  std::size_t voxels_ = 0;
  std::vector<std::uint8_t> packed_;
};

}  // namespace palpate
