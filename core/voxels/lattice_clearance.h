#pragma once
/// Affine lower bounds of the distance to the contact region over blocks of cells, from the
/// distances at places on a lattice. Internal to the build.
///
/// Tighter than site_search.h some voxels away, looser next to the region; the builder takes the
/// better of the two. Length unit: the smallest spacing.

#include <array>
#include <cstdint>
#include <vector>

#include "core/voxels/depth_palette.h"
#include "core/voxels/far_distance.h"
#include "core/voxels/square_view.h"

namespace palpate {

/// b + g·(u − c) is at most the distance, with slopes g as a ClearanceWord holds them.
struct LatticeBound {
  static constexpr float kNone = -1e9f;
  float level = kNone;   ///< b for g = 0.
  float sloped = kNone;  ///< b for the slopes.
  std::array<std::int8_t, 3> slopes{};

  [[nodiscard]] float best() const noexcept { return level > sloped ? level : sloped; }
};

/// Distances outside that the lattice of voxels wants to know; beyond that the far one is as good.
inline constexpr float kLatticeReach = 9.0f;

/// One thread each.
class LatticeClearance {
 public:
  /// All must outlive this.
  LatticeClearance(const DepthPalette& palette, const std::array<std::int32_t, 3>& dims,
                   const FarDistance& far);

  /// Reads the centres of one block of 16³ cells. False where the region is farther than `near`
  /// from all of them.
  bool read(const SquareView& view, const std::array<std::int32_t, 3>& block, float near);
  /// Of a 4³ block in it (its number as in DepthBricks).
  [[nodiscard]] LatticeBound bound(int child) const;
  /// Of all of a block, from far places alone; nothing need be read.
  [[nodiscard]] LatticeBound coarseBound(const std::array<std::int32_t, 3>& block) const;

 private:
  static constexpr int kSide = 17;
  [[nodiscard]] float lowBound(float distance, float sag) const noexcept;
  [[nodiscard]] LatticeBound farBound(const std::array<std::int32_t, 3>& place, int side) const;
  /// `value`: the distances or D; `low`: bounds of the distance near each place; side³ of them.
  [[nodiscard]] LatticeBound fit(const float* value, const float* low, int side, int step) const;

  std::array<std::int32_t, 3> dims_, block_{};
  std::array<float, 3> edge_{};
  float overhang_, sag_;
  const FarDistance& far_;
  std::vector<float> value_, low_;  // kSide³: D; a bound of the distance near that centre
};

}  // namespace palpate
