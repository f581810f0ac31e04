#pragma once
/// Squared distances in a window of a grid, for edits: what banded_distance.h measures over a
/// volume, bit for bit, with memory taken once and no threads.

#include <cstdint>

#include "core/base/large_array.h"
#include "core/voxels/depth_palette.h"
#include "core/voxels/voxel_box.h"

namespace palpate {

class DistanceWindow {
 public:
  /// What is measured: distances outside as far as a cell's diagonal, or those inside too, as far
  /// as the palette goes.
  enum class Band { Outside, Both };

  /// `palette` must outlive this. @param largest  the window's most voxels along each axis.
  DistanceWindow(const DepthPalette& palette, const Extent3& dims, const Extent3& largest,
                 Band widest);

  /// How many voxels along each axis a distance may depend on, to either side.
  [[nodiscard]] static Extent3 reachOf(const DepthPalette& palette, Band band) noexcept;

  /// Signed squares of the voxels of `box`, as BandedDistance gives them (> 0 outside). With
  /// Band::Outside those inside say nothing but the sign.
  void measure(const VoxelBits& solid, const VoxelBox& box, Band band) noexcept;
  /// Squares of the distances from the voxels of `box` to the nearest one of `sites` in `from`
  /// (which holds one); those beyond the palette's deepest say only so.
  void measureTo(const VoxelBits& sites, const VoxelBox& from, const VoxelBox& box) noexcept;

  [[nodiscard]] const VoxelBox& box() const noexcept { return box_; }
  /// Of voxel (box().lo[0], j, k); sixteen may be read at a time.
  [[nodiscard]] const float* row(std::int32_t j, std::int32_t k) const noexcept {
    return out_.data() +
           (static_cast<std::size_t>(k - box_.lo[2]) * static_cast<std::size_t>(box_.size(1)) +
            static_cast<std::size_t>(j - box_.lo[1])) *
               stride_;
  }
  [[nodiscard]] float at(std::int32_t i, std::int32_t j, std::int32_t k) const noexcept {
    return row(j, k)[i - box_.lo[0]];
  }

 private:
  const DepthPalette& palette_;
  Extent3 dims_;
  float farCap_, deepCap_;
  VoxelBox box_;
  std::size_t stride_ = 0;                   // floats a row
  LargeArray<float> alongX_, alongY_, out_;  // after each pass, [z][y][x]
};

}  // namespace palpate
