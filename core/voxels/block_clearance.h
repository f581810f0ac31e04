#pragma once
/// The clearance words of 4³ blocks, from the sites and the lattice around them. Internal to the
/// build.

#include <array>
#include <cstdint>
#include <vector>

#include "core/voxels/brick_plan.h"
#include "core/voxels/depth_bricks.h"
#include "core/voxels/site_search.h"

namespace palpate {

/// Reads the plan of all blocks once their sites are known. Shared by threads, a Scratch each.
class BlockClearance {
 public:
  struct Scratch {
    SiteSearch sites;  ///< Around one 16³ block, lengths from its corner.
    SiteSearch own;    ///< Cells inside all over of one brick.
  };
  using Block = std::array<std::int32_t, 3>;

  BlockClearance(const DepthBricks& bricks, const std::vector<BrickPlan>& plan);

  /// Makes the scratch ready for the words of one near block.
  void gather(const Block& block, Scratch& scratch) const;
  /// The word of a 4³ block without a brick.
  [[nodiscard]] std::uint32_t blockWord(int child, const LatticeBound& lattice,
                                        Scratch& scratch) const;
  /// The clearance of a brick. `fullCells`: its cells that are inside all over; `site`: its own.
  [[nodiscard]] std::uint32_t brickWord(int child, std::uint64_t fullCells, const RegionSite* site,
                                        std::size_t count, const LatticeBound& lattice,
                                        Scratch& scratch) const;

 private:
  struct Candidate {
    std::array<int, 3> slopes{};
    float fromLattice = LatticeBound::kNone;
  };
  [[nodiscard]] float boundFor(int child, const Candidate& candidate, SiteSearch& sites,
                               SiteSearch* own) const;
  void gatherChild(const Float3& corner, const RegionSite* site, std::size_t count,
                   SiteSearch& sites) const;
  [[nodiscard]] Float3 middleOf(int child) const noexcept;
  [[nodiscard]] Float3 outwardOf(const RegionSite* site, std::size_t count) const noexcept;

  const DepthBricks& bricks_;
  const std::vector<BrickPlan>& plan_;
  Float3 edge_{};  // of a cell
};

}  // namespace palpate
