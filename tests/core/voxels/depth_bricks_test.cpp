#include "core/voxels/depth_bricks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "core/voxels/voxel_tree_data.h"
#include "tests/core/voxels/contact_region.h"

namespace palpate {
namespace {

using testing_volumes::assortedAndDeepGrids;
using testing_volumes::ballGrid;
using testing_volumes::ContactRegion;
using testing_volumes::makeGrid;
using testing_volumes::NamedGrid;
using testing_volumes::placeIn;

using Cell = std::array<std::int32_t, 3>;

constexpr std::uint32_t kSeed = 90210;

std::vector<NamedGrid> grids() {
  auto all = assortedAndDeepGrids(kSeed);
  std::mt19937 rng(kSeed);
  const auto rare = [&rng](std::uint32_t one) {
    return [&rng, one](int, int, int) { return rng() % one == 0; };
  };
  all.push_back({"thick slices", makeGrid({34, 33, 19}, Eigen::Vector3d(0.5, 0.5, 4), rare(900))});
  all.push_back(
      {"slices forty times as thick", makeGrid({26, 27, 9}, Eigen::Vector3d(1, 1, 40), rare(300))});
  all.push_back({"a slope", makeGrid({50, 50, 50}, Eigen::Vector3d(1, 1, 1.2),
                                     [](int i, int j, int k) { return 3 * i + j + 2 * k < 90; })});
  // A block with the region 9.2 away on one side, just beyond what its sites are searched for, and
  // near on the other.
  all.push_back({"two sheets about a block",
                 makeGrid({10, 11, 40}, Eigen::Vector3d(1, 1, 2.05),
                          [](int, int, int k) { return (k > 7 && k < 12) || k == 33; })});
  all.push_back({"one voxel in a far corner",
                 makeGrid({70, 37, 35}, Eigen::Vector3d(1, 1, 1.3),
                          [](int i, int j, int k) { return i == 69 && j == 0 && k == 34; })});
  return all;
}

VoxelTree treeOf(const LabelGrid& grid, std::span<const std::uint8_t> labels = {},
                 int threads = 0) {
  return VoxelTree::build(grid, labels,
                          {Branching::Children64, LeafModel::Distance, false, threads})
      .value();
}

// Calls f(first cell, place in words) for each 4³ block that has words, f's cells in the grid.
template <class F>
void forEachWord(const DepthBricks& d, const Cell& dims, F&& f) {
  for (int z = 0; z + 1 < dims[2]; z += 4) {
    for (int y = 0; y + 1 < dims[1]; y += 4) {
      for (int x = 0; x + 1 < dims[0]; x += 4) {
        const std::size_t at = d.wordAt({x, y, z});
        if (at >= 64) f(Cell{x, y, z}, at);
        if (testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

// The depth at a corner of a block, the grid's edge going on beyond it.
double depthAt(const ContactRegion& region, const Cell& dims, const Cell& block, int x, int y,
               int z) {
  return region.depth(std::min(block[0] + x, dims[0] - 1), std::min(block[1] + y, dims[1] - 1),
                      std::min(block[2] + z, dims[2] - 1));
}

template <class F>
void forEachCorner(F&& f) {
  for (int z = 0; z < 5; ++z) {
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < 5; ++x) f(x, y, z);
    }
  }
}

TEST(DepthBricks, CornersOfEveryLinkedBrickHaveTheExhaustiveDepth) {
  std::size_t shared = 0;
  for (const auto& [name, grid] : grids()) {
    SCOPED_TRACE(name + ", seed " + std::to_string(kSeed));
    const VoxelTree tree = treeOf(grid);
    const DepthBricks& d = tree.data().depth;
    const ContactRegion region(grid);
    const Cell& dims = grid.geometry.dims;
    const double diagonal = region.edge().norm();
    const auto deepest = static_cast<double>(d.palette.value(d.palette.deepestCode()));
    std::size_t bricks = 0;
    forEachWord(d, dims, [&](const Cell& block, std::size_t) {
      const std::uint32_t link = d.linkAt(block);
      if (link == 0) return;
      ++bricks;
      bool deep = true;
      forEachCorner([&](int x, int y, int z) {
        deep = deep && depthAt(region, dims, block, x, y, z) <= -kSaturationVoxels;
      });
      shared += deep ? 1 : 0;
      forEachCorner([&](int x, int y, int z) {
        const double exact = depthAt(region, dims, block, x, y, z);
        const std::uint16_t code = d.codeAt(link, x, y, z);
        const auto value = static_cast<double>(d.palette.value(code));
        if (deep) {
          ASSERT_LE(value, -kSaturationVoxels);
        } else if (code == DepthPalette::kFarCode) {
          ASSERT_GT(exact + 0.5, diagonal * (1 - 1e-6));
        } else if (exact < deepest) {
          ASSERT_EQ(code, d.palette.deepestCode());
        } else {
          ASSERT_NEAR(value, exact, 1e-5)
              << block[0] + x << " " << block[1] + y << " " << block[2] + z;
        }
      });
    });
    EXPECT_GT(bricks, 0U);
  }
  EXPECT_GT(shared, 200U);  // there were interiors that deep
}

TEST(DepthBricks, ThereIsABrickExactlyWhereACellHasACornerInside) {
  for (const auto& [name, grid] : grids()) {
    SCOPED_TRACE(name + ", seed " + std::to_string(kSeed));
    const VoxelTree tree = treeOf(grid);
    const DepthBricks& d = tree.data().depth;
    const ContactRegion region(grid);
    const Cell& dims = grid.geometry.dims;
    for (int z = 0; z + 1 < dims[2]; z += 4) {
      for (int y = 0; y + 1 < dims[1]; y += 4) {
        for (int x = 0; x + 1 < dims[0]; x += 4) {
          bool present = false;
          for (int c = 0; c < 64; ++c) {
            present =
                present || region.hasCornerInside(x + (c & 3), y + (c >> 2 & 3), z + (c >> 4));
          }
          ASSERT_EQ(d.linkAt({x, y, z}) != 0, present) << x << " " << y << " " << z;
        }
      }
    }
  }
}

double claimed(std::uint32_t word, const ContactRegion& region, const Eigen::Vector3d& u,
               const Cell& low, int cells, float steps) {
  std::array<float, 3> from{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    from[a] = static_cast<float>((u[axis] - low[a] - 0.5 * cells) * region.edge()[axis]);
  }
  return static_cast<double>(ClearanceWord::at(word, from, steps));
}

TEST(DepthBricks, ClearancesNeverExceedTheDistanceToTheContactRegion) {
  for (const auto& [name, grid] : grids()) {
    SCOPED_TRACE(name + ", seed " + std::to_string(kSeed));
    std::mt19937 rng(kSeed);
    const VoxelTree tree = treeOf(grid);
    const DepthBricks& d = tree.data().depth;
    const ContactRegion region(grid);
    const Cell& dims = grid.geometry.dims;
    const auto check = [&](std::uint32_t word, const Cell& low, int cells, float steps,
                           int places) {
      for (int n = 0; n < places; ++n) {
        const Eigen::Vector3d u = placeIn(rng, low, cells);
        const double bound = claimed(word, region, u, low, cells, steps);
        if (bound <= 0) continue;
        ASSERT_LE(bound, region.distance(u) + 1e-4)
            << cells << " cells at " << low[0] << " " << low[1] << " " << low[2] << ", u "
            << u.transpose();
      }
    };
    for (int z = 0; z < d.blocks[2]; ++z) {
      for (int y = 0; y < d.blocks[1]; ++y) {
        for (int x = 0; x < d.blocks[0]; ++x) {
          const std::uint32_t word = d.coarse[d.blockAt(x, y, z)];
          if ((word & ClearanceWord::kLink) != 0) continue;
          check(word, {16 * x, 16 * y, 16 * z}, 16, ClearanceWord::kCoarseSteps, 24);
        }
      }
    }
    std::size_t blocks = 0;
    forEachWord(d, dims, [&](const Cell&, std::size_t) { ++blocks; });
    const auto places = static_cast<std::uint32_t>(std::max<std::size_t>(1, blocks / 500));
    forEachWord(d, dims, [&](const Cell& block, std::size_t at) {
      if (rng() % places != 0) return;
      const std::uint32_t word = d.words[at];
      if ((word & ClearanceWord::kLink) == 0) {
        check(word, block, 4, ClearanceWord::kBlockSteps, 8);
      } else {
        const std::size_t slot = DepthBricks::placeOf(word & ~ClearanceWord::kLink);
        check(d.slots[slot + DepthBricks::kRows], block, 4, ClearanceWord::kBrickSteps, 8);
      }
    });
  }
}

TEST(DepthBricks, LabelsOfCornersAreThoseOfTheirVoxels) {
  const std::uint8_t some[] = {1, 3};
  for (auto& [name, grid] : grids()) {
    for (const bool selected : {false, true}) {
      SCOPED_TRACE(name + (selected ? ", selected labels" : "") + ", seed " +
                   std::to_string(kSeed));
      const Cell& dims = grid.geometry.dims;
      const auto inside = [&](std::uint8_t label) {
        return selected ? label == 1 || label == 3 : label != 0;
      };
      std::set<std::uint8_t> present;
      for (const std::uint8_t label : grid.labels) {
        if (inside(label)) present.insert(label);
      }
      if (present.empty()) continue;
      const VoxelTree tree = treeOf(
          grid, selected ? std::span<const std::uint8_t>(some) : std::span<const std::uint8_t>());
      const DepthBricks& d = tree.data().depth;
      EXPECT_EQ(d.uniformLabel, present.size() == 1 ? *present.begin() : 0);
      std::size_t corners = 0;
      forEachWord(d, dims, [&](const Cell& block, std::size_t at) {
        if (d.linkAt(block) == 0) return;
        forEachCorner([&](int x, int y, int z) {
          const int i = block[0] + x, j = block[1] + y, k = block[2] + z;
          if (!grid.geometry.contains(i, j, k)) return;
          const std::uint8_t label = grid.at(i, j, k);
          if (inside(label)) {
            ASSERT_EQ(d.labelOf(at, x, y, z), label) << i << " " << j << " " << k;
            ++corners;
          } else if (d.uniformLabel == 0 && (d.label[at] & DepthBricks::kOneLabel) == 0) {
            ASSERT_EQ(d.labelOf(at, x, y, z), 0) << i << " " << j << " " << k;
          }
        });
      });
      EXPECT_GT(corners, 0U);
    }
  }
}

TEST(DepthBricks, AreTheSameAtAnyNumberOfThreads) {
  for (const auto& [name, grid] : grids()) {
    SCOPED_TRACE(name);
    const VoxelTree one = treeOf(grid, {}, 1);
    for (const int threads : {0, 2}) {
      const VoxelTree many = treeOf(grid, {}, threads);
      const DepthBricks& a = one.data().depth;
      const DepthBricks& b = many.data().depth;
      EXPECT_EQ(a.coarse, b.coarse);
      EXPECT_EQ(a.firstWord, b.firstWord);
      EXPECT_EQ(a.words, b.words);
      EXPECT_EQ(a.slots, b.slots);
      EXPECT_EQ(a.label, b.label);
      EXPECT_EQ(a.labelBytes, b.labelBytes);
    }
  }
}

// Way out of a brick: along the gradient of its values. Metres.
Eigen::Vector3d wayOut(const DepthBricks& d, std::uint32_t link, const Eigen::Vector3d& spacing,
                       int x, int y, int z) {
  const auto value = [&](int i, int j, int k) {
    return static_cast<double>(d.palette.value(d.codeAt(link, i, j, k)));
  };
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  for (int c = 0; c < 8; ++c) {
    const int i = x + (c & 1), j = y + (c >> 1 & 1), k = z + (c >> 2);
    const double v = value(i, j, k);
    g += v * Eigen::Vector3d((c & 1) != 0 ? 1 : -1, (c & 2) != 0 ? 1 : -1, (c & 4) != 0 ? 1 : -1);
  }
  return g.cwiseQuotient(spacing).normalized();
}

struct WayOut {
  double worst = 0;                // degrees
  std::size_t cells = 0, far = 0;  // in deep bricks; off by more than 20 degrees
  Cell at{};                       // of the worst
};

// `exact(p)` is the true way out at a place in V, zero where there is none to speak of.
template <class F>
WayOut worstWayOut(const LabelGrid& grid, F&& exact) {
  const VoxelTree tree = treeOf(grid);
  const DepthBricks& d = tree.data().depth;
  WayOut out;
  forEachWord(d, grid.geometry.dims, [&](const Cell& block, std::size_t) {
    const std::uint32_t link = d.linkAt(block);
    if (link == 0) return;
    bool deep = true;
    forEachCorner([&](int x, int y, int z) {
      deep = deep && d.palette.value(d.codeAt(link, x, y, z)) <= -16.0f;
    });
    if (!deep) return;
    const Eigen::Vector3d truth =
        exact(grid.geometry.centre_V(block[0] + 2, block[1] + 2, block[2] + 2));
    if (truth.norm() < 0.5) return;
    forEachCorner([&](int x, int y, int z) {
      if (x == 4 || y == 4 || z == 4) return;  // cells now
      const double cosine = wayOut(d, link, grid.geometry.spacing, x, y, z).dot(truth);
      const double off = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / 3.14159265358979;
      ++out.cells;
      out.far += off > 20 ? 1U : 0U;
      if (off <= out.worst) return;
      out.worst = off;
      out.at = block;
    });
  });
  return out;
}

// A direction of 124 lies within 12 degrees of any other; the field of blocks adds its own steps.
// The header's "about 15 degrees" holds for most: one in twenty is off by more than 20, none by 30.
void expectOut(const WayOut& found, std::size_t leastCells) {
  EXPECT_GT(found.cells, leastCells);
  EXPECT_LT(static_cast<double>(found.far), 0.2 * static_cast<double>(found.cells));
  EXPECT_LT(found.worst, 30.0) << "block at " << found.at[0] << " " << found.at[1] << " "
                               << found.at[2];
}

TEST(DeepBricks, OfABallPointAwayFromItsCentre) {
  struct Case {
    Eigen::Vector3d spacing;
    int side;
    double radius;  // smallest spacings
  };
  for (const Case& c :
       {Case{{1, 1, 1}, 72, 35.5}, Case{{1.3, 1, 1.1}, 74, 36.0}, Case{{1, 1, 2.5}, 72, 35.0}}) {
    SCOPED_TRACE("spacing " + std::to_string(c.spacing.x()) + " " + std::to_string(c.spacing.z()));
    const auto grid = ballGrid(c.side, c.spacing, c.radius);
    const Eigen::Vector3d centre = 0.5 * (c.side - 1) * c.spacing;
    const WayOut found = worstWayOut(grid, [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
      const Eigen::Vector3d out = p - centre;
      // Near the middle every way out is as long.
      return out.norm() < 8 ? Eigen::Vector3d::Zero().eval() : out.normalized();
    });
    expectOut(found, 3000);
  }
}

TEST(DeepBricks, OfAHalfSpacePointAlongItsNormal) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 12; ++trial) {
    const Eigen::Vector3d spacing =
        trial % 2 == 0 ? Eigen::Vector3d(1, 1, 1) : Eigen::Vector3d(1.2, 1, 1.6);
    SCOPED_TRACE("trial " + std::to_string(trial));
    const Eigen::Vector3d n = Eigen::Vector3d(normal(rng), normal(rng), normal(rng)).normalized();
    const std::array<std::int32_t, 3> dims{65, 49, 65};  // whole blocks of 16 cells; see below
    const Eigen::Vector3d top(64 * spacing.x(), 48 * spacing.y(), 64 * spacing.z());
    const double level = n.dot(0.5 * top) + 6;
    const auto grid = makeGrid(dims, spacing, [&](int i, int j, int k) {
      return n.dot(Eigen::Vector3d(i, j, k).cwiseProduct(spacing)) < level;
    });
    const WayOut found = worstWayOut(grid, [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
      // Where the foot on the plane is in the grid, some voxels from its edge.
      const Eigen::Vector3d foot = p + (level - n.dot(p)) * n;
      if ((foot.array() < 3).any() || (foot.array() > top.array() - 3).any()) {
        return Eigen::Vector3d::Zero();
      }
      return n;
    });
    expectOut(found, 600);
  }
}

// What lies outside the grid counts for neither kind, though blocks of 16³ reach past its end.
TEST(DeepBricks, KnowTheWayOutWhereTheGridEndsWithinABlock) {
  const auto grid = makeGrid({33, 33, 54}, Eigen::Vector3d::Ones(),
                             [](int, int, int k) { return k > 0 ? 1 : 0; });
  expectOut(worstWayOut(grid, [](const Eigen::Vector3d&) { return Eigen::Vector3d(0, 0, -1); }),
            3000);
}

}  // namespace
}  // namespace palpate
