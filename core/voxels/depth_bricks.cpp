/// The build of DepthBricks in stages: which blocks hold bricks; their codes and sites, slab by
/// slab; numbers for words and slots; shared deep bricks; words with their clearances.

#include "core/voxels/depth_bricks.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "core/voxels/banded_distance.h"
#include "core/voxels/block_clearance.h"
#include "core/voxels/brick_codes.h"
#include "core/voxels/brick_plan.h"
#include "core/voxels/deep_bricks.h"
#include "core/voxels/lattice_clearance.h"

namespace palpate {
namespace {

using Int3 = std::array<std::int32_t, 3>;

constexpr std::int32_t kSlabBlocks = 4;  // rows of 16³ blocks coded at a time
// A block of 16³ without bricks gets finer words where the region may be nearer than this.
constexpr float kNear = 6.0f;

class BrickBuilder {
 public:
  BrickBuilder(const LabelGrid& grid, const VoxelBits& solid, const VoxelBits& cells,
               DepthBricks& bricks, const Progress& progress)
      : grid_(grid), solid_(solid), cells_(cells), bricks_(bricks), progress_(progress) {}

  Result<void> run() {
    planBlocks();
    if (auto ok = codeSlabs(); !ok) return ok;
    numberWords();
    shareDeepBricks();
    if (bricks_.slots.size() / 2 >= DepthBricks::kPlaceMask) {
      return fail(inputRefused("The tree would have more bricks of depths than can be linked.")
                      .butFound(std::to_string(bricks_.slots.size() / DepthBricks::kSlotWords))
                      .wants("fewer than 82595524")
                      .advise("Select fewer labels, or crop or resample the volume."));
    }
    progress_(0.6, "Measuring clearances");
    fillWords();
    if (progress_.cancelled()) return fail(cancelled());
    return {};
  }

 private:
  [[nodiscard]] Int3 blockOf(std::size_t t) const {
    const auto nx = static_cast<std::size_t>(bricks_.blocks[0]);
    const auto ny = static_cast<std::size_t>(bricks_.blocks[1]);
    return {static_cast<std::int32_t>(t % nx), static_cast<std::int32_t>(t / nx % ny),
            static_cast<std::int32_t>(t / (nx * ny))};
  }
  [[nodiscard]] static Int3 cellOf(const Int3& block, int child) {
    return {block[0] * 16 + (child & 3) * 4, block[1] * 16 + (child >> 2 & 3) * 4,
            block[2] * 16 + (child >> 4) * 4};
  }

  void planBlocks() {
    for (std::size_t a = 0; a < 3; ++a) bricks_.blocks[a] = (cells_.extent[a] + 15) / 16;
    const VoxelBits small = coarser(cells_, 2);
    plan_.resize(static_cast<std::size_t>(bricks_.blocks[0]) *
                 static_cast<std::size_t>(bricks_.blocks[1]) *
                 static_cast<std::size_t>(bricks_.blocks[2]));
    for (std::size_t t = 0; t < plan_.size(); ++t) {
      const Int3 block = blockOf(t);
      for (int z = 0; z < std::min(4, small.extent[2] - block[2] * 4); ++z) {
        for (int y = 0; y < std::min(4, small.extent[1] - block[1] * 4); ++y) {
          const std::uint64_t* row = small.row(block[1] * 4 + y, block[2] * 4 + z);
          const std::uint64_t bits = row[block[0] >> 4] >> (4 * (block[0] & 15)) & 15U;
          plan_[t].bricks |= bits << (4 * y + 16 * z);
        }
      }
    }
  }

  Result<void> codeSlabs() {
    bricks_.slots.assign(DepthBricks::kSlotWords, 0);
    bricks_.slots[DepthBricks::kRows] = ClearanceWord::kNever;
    BandedDistance distance(solid_, bricks_.palette, kLatticeReach);
    const FarDistance far(solid_, bricks_.palette);
    tbb::enumerable_thread_specific<Coders> coders([this, &far] {
      return Coders{BrickCoder(grid_, bricks_.palette, bricks_.uniformLabel),
                    LatticeClearance(bricks_.palette, grid_.geometry.dims, far)};
    });
    std::vector<float> square;
    const std::size_t layer =
        static_cast<std::size_t>(bricks_.blocks[0]) * static_cast<std::size_t>(bricks_.blocks[1]);
    for (std::int32_t first = 0; first < bricks_.blocks[2]; first += kSlabBlocks) {
      progress_(0.2 + 0.4 * first / bricks_.blocks[2], "Measuring depths");
      if (progress_.cancelled()) return fail(cancelled());
      const std::int32_t last = std::min(first + kSlabBlocks, bricks_.blocks[2]);
      const std::int32_t z0 = first * 16;
      const std::int32_t z1 = std::min(last * 16 + 1, solid_.extent[2]);
      const std::size_t from = static_cast<std::size_t>(first) * layer;
      const std::size_t to = static_cast<std::size_t>(last) * layer;
      distance.slab(z0, z1, square);
      const SquareView view{
          square.data(), {0, 0, z0}, {solid_.extent[0], solid_.extent[1], z1 - z0}};
      tbb::parallel_for(tbb::blocked_range<std::size_t>(from, to), [&](const auto& range) {
        Coders& own = coders.local();
        for (std::size_t t = range.begin(); t != range.end(); ++t) {
          measureBlock(t, view, own.lattice);
          codeBlock(t, view, own.brick);
        }
      });
      for (std::size_t t = from; t < to; ++t) takeSlots(plan_[t]);
    }
    return {};
  }

  struct Coders {
    BrickCoder brick;
    LatticeClearance lattice;
  };

  void measureBlock(std::size_t t, const SquareView& view, LatticeClearance& lattice) {
    BrickPlan& plan = plan_[t];
    plan.near = lattice.read(view, blockOf(t), kNear) || plan.bricks != 0;
    if (!plan.near) {
      plan.lattice.push_back(lattice.coarseBound(blockOf(t)));
      return;
    }
    plan.lattice.resize(64);
    for (int child = 0; child < 64; ++child) {
      plan.lattice[static_cast<std::size_t>(child)] = lattice.bound(child);
    }
  }

  void codeBlock(std::size_t t, const SquareView& view, BrickCoder& coder) {
    BrickPlan& plan = plan_[t];
    const Int3 block = blockOf(t);
    BrickCoder::Brick brick;
    for (std::uint64_t left = plan.bricks; left != 0; left &= left - 1) {
      const int child = std::countr_zero(left);
      const Int3 cell = cellOf(block, child);
      coder.code(view, cell, brick);
      if (brick.deep) plan.deep |= std::uint64_t{1} << child;
      if (brick.wide && !brick.deep) plan.wide |= std::uint64_t{1} << child;
      if (!brick.deep) {
        const auto size = (brick.wide ? 2 : 1) * DepthBricks::kSlotWords;
        plan.rows.insert(plan.rows.end(), brick.rows.begin(),
                         brick.rows.begin() + static_cast<std::ptrdiff_t>(size));
        plan.sites.insert(plan.sites.end(), brick.sites.begin(), brick.sites.end());
        plan.siteCount.push_back(static_cast<std::uint16_t>(brick.sites.size()));
        plan.fullCells.push_back(brick.fullCells);
      }
      if (bricks_.uniformLabel == 0) {
        plan.label.push_back(coder.labels(view, cell, plan.labelBytes));
      }
    }
  }

  void takeSlots(BrickPlan& plan) {
    plan.firstSlot = static_cast<std::uint32_t>(bricks_.slots.size() / DepthBricks::kSlotWords);
    bricks_.slots.append(plan.rows.data(), plan.rows.size());
    plan.rows = {};
  }

  // In the order of the blocks; the first word block stays zero: no brick.
  void numberWords() {
    std::uint32_t next = 1;
    for (BrickPlan& plan : plan_) {
      if (plan.near) plan.wordBlock = next++;
    }
    bricks_.words.assign(std::size_t{next} * 64, 0);
    bricks_.coarse.assign(plan_.size(), 0);
    bricks_.firstWord.assign(plan_.size(), 0);
    if (bricks_.uniformLabel == 0) bricks_.label.assign(bricks_.words.size(), 0);
  }

  void shareDeepBricks() {
    if (std::none_of(plan_.begin(), plan_.end(), [](const BrickPlan& p) { return p.deep != 0; })) {
      return;
    }
    firstDeep_ = static_cast<std::uint32_t>(bricks_.slots.size() / DepthBricks::kSlotWords);
    appendDeepBricks(bricks_.palette, bricks_.slots);
    Int3 extent;
    for (std::size_t a = 0; a < 3; ++a) extent[a] = (cells_.extent[a] + 3) / 4;
    VoxelBits deep(extent);
    for (std::size_t t = 0; t < plan_.size(); ++t) {
      const Int3 block = blockOf(t);
      for (std::uint64_t left = plan_[t].deep; left != 0; left &= left - 1) {
        const int c = std::countr_zero(left);
        deep.set(block[0] * 4 + (c & 3), block[1] * 4 + (c >> 2 & 3), block[2] * 4 + (c >> 4));
      }
    }
    wayOut_ = std::make_unique<DeepDirections>(deep, grid_.geometry.spacing);
  }

  void fillWords() {
    const BlockClearance clearance(bricks_, plan_);
    tbb::enumerable_thread_specific<BlockClearance::Scratch> scratches;
    std::size_t labels = 0;  // bytes of mixed labels, in bricks
    std::vector<std::uint32_t> labelStart(plan_.size());
    for (std::size_t t = 0; t < plan_.size(); ++t) {
      labelStart[t] = static_cast<std::uint32_t>(labels);
      labels += plan_[t].labelBytes.size() / DepthBricks::kLabelBytes;
    }
    bricks_.labelBytes.resize(labels * DepthBricks::kLabelBytes);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, plan_.size()), [&](const auto& range) {
      BlockClearance::Scratch& scratch = scratches.local();
      for (std::size_t t = range.begin(); t != range.end() && !progress_.cancelled(); ++t) {
        fillBlock(t, labelStart[t], clearance, scratch);
      }
    });
  }

  static std::uint32_t coarseWord(const LatticeBound& far) {
    if (far.level >= far.sloped) {
      return ClearanceWord::encode({0, 0, 0}, far.level, ClearanceWord::kCoarseSteps);
    }
    return ClearanceWord::encode({far.slopes[0], far.slopes[1], far.slopes[2]}, far.sloped,
                                 ClearanceWord::kCoarseSteps);
  }

  void fillBlock(std::size_t t, std::uint32_t labelStart, const BlockClearance& clearance,
                 BlockClearance::Scratch& scratch) {
    const BrickPlan& plan = plan_[t];
    const Int3 block = blockOf(t);
    if (!plan.near) {
      bricks_.coarse[t] = coarseWord(plan.lattice[0]);
      return;
    }
    bricks_.coarse[t] = ClearanceWord::kLink | plan.wordBlock;
    bricks_.firstWord[t] = plan.wordBlock * 64;
    clearance.gather(block, scratch);
    std::uint32_t slot = plan.firstSlot;
    std::size_t own = 0;  // bricks of this block with sites of their own
    const RegionSite* site = plan.sites.data();
    std::size_t brick = 0;
    for (int child = 0; child < 64; ++child) {
      const std::uint64_t bit = std::uint64_t{1} << child;
      std::uint32_t& word =
          bricks_.words[std::size_t{plan.wordBlock} * 64 + static_cast<std::size_t>(child)];
      if ((plan.bricks & bit) == 0) {
        word = clearance.blockWord(child, plan.lattice[static_cast<std::size_t>(child)], scratch);
        continue;
      }
      if (bricks_.uniformLabel == 0) {
        const std::uint32_t label = plan.label[brick];
        bricks_.label[std::size_t{plan.wordBlock} * 64 + static_cast<std::size_t>(child)] =
            (label & DepthBricks::kOneLabel) != 0 ? label : label + labelStart;
      }
      ++brick;
      if ((plan.deep & bit) != 0) {
        const Int3 cell = cellOf(block, child);
        const std::uint32_t number = wayOut_->brickFor({cell[0] / 4, cell[1] / 4, cell[2] / 4});
        word = ClearanceWord::kLink | DepthBricks::linkTo(firstDeep_ + 2 * number, true);
        continue;
      }
      const bool wide = (plan.wide & bit) != 0;
      word = ClearanceWord::kLink | DepthBricks::linkTo(slot, wide);
      bricks_.slots[std::size_t{slot} * DepthBricks::kSlotWords + DepthBricks::kRows] =
          clearance.brickWord(child, plan.fullCells[own], site, plan.siteCount[own],
                              plan.lattice[static_cast<std::size_t>(child)], scratch);
      site += plan.siteCount[own++];
      slot += wide ? 2 : 1;
    }
    std::copy(plan.labelBytes.begin(), plan.labelBytes.end(),
              bricks_.labelBytes.begin() + std::size_t{labelStart} * DepthBricks::kLabelBytes);
  }

  const LabelGrid& grid_;
  const VoxelBits& solid_;
  const VoxelBits& cells_;
  DepthBricks& bricks_;
  const Progress& progress_;
  std::vector<BrickPlan> plan_;
  std::unique_ptr<DeepDirections> wayOut_;
  std::uint32_t firstDeep_ = 0;
};

}  // namespace

std::uint8_t onlyLabelOf(const LabelGrid& grid, const VoxelBits& solid) {
  std::uint8_t only = 0;
  for (std::int32_t k = 0; k < solid.extent[2]; ++k) {
    for (std::int32_t j = 0; j < solid.extent[1]; ++j) {
      const std::uint64_t* row = solid.row(j, k);
      const std::uint8_t* label = grid.labels.data() + grid.geometry.index(0, j, k);
      for (std::size_t w = 0; w < solid.rowWords; ++w) {
        for (std::uint64_t bits = row[w]; bits != 0; bits &= bits - 1) {
          const std::uint8_t here =
              label[w * 64 + static_cast<std::size_t>(std::countr_zero(bits))];
          if (here == only) continue;
          if (only != 0) return 0;
          only = here;
        }
      }
    }
  }
  return only;
}

Result<DepthBricks> buildDepthBricks(const LabelGrid& grid, const VoxelBits& solid,
                                     const VoxelBits& cells, const Progress& progress) {
  DepthBricks bricks;
  bricks.palette = DepthPalette(grid.geometry.spacing);
  bricks.uniformLabel = onlyLabelOf(grid, solid);
  if (auto ok = BrickBuilder(grid, solid, cells, bricks, progress).run(); !ok) {
    return fail(ok.error());
  }
  return bricks;
}

}  // namespace palpate
