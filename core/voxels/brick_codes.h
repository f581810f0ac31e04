#pragma once
/// One brick from a slab of squared distances: codes, sites, labels. Internal to the build and to
/// edits.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/voxels/depth_bricks.h"
#include "core/voxels/region_site.h"
#include "core/voxels/square_view.h"

namespace palpate {

/// Makes bricks; remembers the sites of cells it has seen. One thread each.
class BrickCoder {
 public:
  /// All must outlive this.
  BrickCoder(const LabelGrid& grid, const DepthPalette& palette, std::uint8_t uniformLabel);
  ~BrickCoder();

  struct Brick {
    bool wide = false, deep = false;
    std::array<std::uint32_t, 2 * DepthBricks::kSlotWords> rows{};
    std::uint64_t fullCells = 0;
    std::vector<RegionSite> sites;
  };
  /// The brick of the 4³ cells from `cell` on. Beyond the grid its edge goes on.
  void code(const SquareView& view, const std::array<std::int32_t, 3>& cell, Brick& out);
  /// Labels of its corners: a word as in DepthBricks::label; where they differ their bytes are
  /// appended and the word counts from what `bytes` held before.
  [[nodiscard]] std::uint32_t labels(const SquareView& view,
                                     const std::array<std::int32_t, 3>& cell,
                                     std::vector<std::uint8_t>& bytes) const;

 private:
  struct Seen;
  bool site(const std::array<std::uint16_t, 8>& codes, RegionSite& out);

  const LabelGrid& grid_;
  const DepthPalette& palette_;
  std::uint8_t uniformLabel_;
  std::array<float, 3> edge_;
  std::unique_ptr<Seen> seen_;
};

/// Cells of a brick's 4³, bit x + 4 (y + 4 z).
[[nodiscard]] constexpr int cellBit(int x, int y, int z) noexcept {
  return x + 4 * (y + 4 * z);
}

/// What stored depths and their interpolation may add to a value, s: quantised depths (1/3000),
/// weights (1/32768 of a cell's difference), single precision.
inline constexpr float kDepthSlack = 1e-3f;

}  // namespace palpate
