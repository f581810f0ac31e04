#include "core/voxels/tree_editor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/voxels/tree_cache.h"
#include "tests/core/voxels/random_edits.h"
#include "tests/core/voxels/same_tree.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using testing_volumes::apply;
using testing_volumes::assortedGrids;
using testing_volumes::expectSameTree;
using testing_volumes::makeGrid;
using testing_volumes::NamedGrid;
using testing_volumes::randomEdit;
using testing_volumes::RandomEdit;
using Voxel = TreeEditor::Voxel;

constexpr std::uint32_t kSeed = 1127;
constexpr Branching kBranchings[] = {Branching::Children8, Branching::Children64,
                                     Branching::Children512};
constexpr LeafModel kLeaves[] = {LeafModel::Voxel, LeafModel::Distance};

EditResult run(TreeEditor& editor, const RandomEdit& edit) {
  return edit.label == 0 ? editor.remove(edit.voxels) : editor.add(edit.voxels, edit.label);
}

// Deep enough for saturated bricks.
LabelGrid thick(const Eigen::Vector3d& spacing) {
  return makeGrid({53, 47, 58}, spacing, [](int i, int j, int k) {
    return i < 1 || k > 54 || (j > 40 && i < 20) ? 0 : (k > 30 ? 2 : 1);
  });
}

// ---- what the bounds are of ----

// Points of the contact region, by sampling the cells that reach into it; in smallest spacings.
std::vector<Eigen::Vector3f> regionOf(const LabelGrid& grid, const VoxelTree& built) {
  const auto& d = built.data();
  std::vector<Eigen::Vector3f> points;
  const Eigen::Vector3d edge = grid.geometry.spacing / grid.geometry.spacing.minCoeff();
  for (int k = 0; k < d.extent[2]; ++k) {
    for (int j = 0; j < d.extent[1]; ++j) {
      for (int i = 0; i < d.extent[0]; ++i) {
        const std::uint32_t link = d.depth.linkAt({i, j, k});
        if (link == 0) continue;
        float v[8];
        for (int c = 0; c < 8; ++c) {
          v[c] = d.depth.palette.value(
              d.depth.codeAt(link, (i & 3) + (c & 1), (j & 3) + (c >> 1 & 1), (k & 3) + (c >> 2)));
        }
        // Of cells inside all over their corners will do: others are nearer to what is outside.
        const int steps = std::all_of(v, v + 8, [](float x) { return x < 0.0f; }) ? 1 : 4;
        for (int n = 0; n < (steps + 1) * (steps + 1) * (steps + 1); ++n) {
          const float f[3] = {
              static_cast<float>(n % (steps + 1)) / static_cast<float>(steps),
              static_cast<float>(n / (steps + 1) % (steps + 1)) / static_cast<float>(steps),
              static_cast<float>(n / ((steps + 1) * (steps + 1))) / static_cast<float>(steps)};
          float value = 0;
          for (int c = 0; c < 8; ++c) {
            float w = v[c];
            for (int a = 0; a < 3; ++a) w *= (c >> a & 1) != 0 ? f[a] : 1.0f - f[a];
            value += w;
          }
          if (value >= -1e-3f) continue;
          points.emplace_back((static_cast<float>(i) + f[0]) * static_cast<float>(edge[0]),
                              (static_cast<float>(j) + f[1]) * static_cast<float>(edge[1]),
                              (static_cast<float>(k) + f[2]) * static_cast<float>(edge[2]));
        }
      }
    }
  }
  return points;
}

// The stored bound at a point of the box of centres, in cells, as a query finds it.
float boundAt(const VoxelTree::Data& d, const Eigen::Vector3f& u) {
  std::array<std::int32_t, 3> cell;
  for (std::size_t a = 0; a < 3; ++a) {
    cell[a] = std::min(static_cast<std::int32_t>(u[static_cast<int>(a)]), d.extent[a] - 1);
  }
  std::uint32_t word = d.depth.coarse[d.depth.blockAt(cell[0] >> 4, cell[1] >> 4, cell[2] >> 4)];
  std::int32_t edge = DepthBricks::kCoarseEdge;
  float steps = ClearanceWord::kCoarseSteps;
  if ((word & ClearanceWord::kLink) != 0) {
    word = d.depth.words[d.depth.wordAt(cell)];
    edge = DepthBricks::kEdge;
    steps = ClearanceWord::kBlockSteps;
    if ((word & ClearanceWord::kLink) != 0) {
      word = d.depth.slots[DepthBricks::placeOf(word) + DepthBricks::kRows];
      steps = ClearanceWord::kBrickSteps;
    }
  }
  std::array<float, 3> from;
  for (std::size_t a = 0; a < 3; ++a) {
    const float middle =
        static_cast<float>(cell[a] / edge * edge) + 0.5f * static_cast<float>(edge);
    from[a] = (u[static_cast<int>(a)] - middle) * std::sqrt(d.depth.palette.weight()[a]);
  }
  return ClearanceWord::at(word, from, steps);
}

void expectSoundClearances(const LabelGrid& grid, const VoxelTree& edited, const VoxelTree& built,
                           std::mt19937& rng, int points = 300) {
  const auto region = regionOf(grid, built);
  const VoxelTree::Data& d = edited.data();
  const Eigen::Vector3f edge =
      (grid.geometry.spacing / grid.geometry.spacing.minCoeff()).cast<float>();
  for (int n = 0; n < points; ++n) {
    Eigen::Vector3f u;
    for (int a = 0; a < 3; ++a) {
      const auto cells = static_cast<float>(d.extent[static_cast<std::size_t>(a)]);
      u[a] = std::uniform_real_distribution<float>(0.0f, cells)(rng);
    }
    const float bound = boundAt(d, u);
    if (bound <= 0.0f) continue;
    const Eigen::Vector3f p = u.cwiseProduct(edge);
    float nearest = HUGE_VALF;
    for (const auto& q : region) nearest = std::min(nearest, (p - q).squaredNorm());
    ASSERT_LE(bound, std::sqrt(nearest) + 1e-3f) << "at " << u.transpose();
  }
}

// ---- edits against a rebuild ----

void expectEditsToMatch(const std::string& name, const LabelGrid& start, int labels, int rounds,
                        std::uint32_t seed, const TreeOptions& options) {
  SCOPED_TRACE(name + ", " + std::to_string(static_cast<int>(options.branching)) +
               " children, leaf " + std::to_string(static_cast<int>(options.leaf)) + ", seed " +
               std::to_string(seed));
  std::mt19937 rng(seed);
  LabelGrid grid = start;
  auto tree = VoxelTree::build(grid, {}, options);
  ASSERT_TRUE(tree);
  auto editor = TreeEditor::create(*tree);
  ASSERT_TRUE(editor);
  RandomEdit last;
  for (int round = 0; round < rounds; ++round) {
    RandomEdit edit = randomEdit(rng, grid.geometry, labels);
    if (round % 5 == 4) {  // back, or away again
      edit = last;
      edit.label = last.label != 0 ? 0 : 1;
    }
    SCOPED_TRACE("round " + std::to_string(round) + ", " + edit.name + ", label " +
                 std::to_string(edit.label));
    LabelGrid next = grid;
    const std::size_t changed = apply(edit, next);
    const auto built = VoxelTree::build(next, {}, options);
    const EditResult result = run(*editor, edit);
    if (!built) {
      EXPECT_EQ(result.status, EditStatus::WouldBeEmpty);
      continue;
    }
    EXPECT_EQ(result.status, EditStatus::Done);
    EXPECT_EQ(result.changed, changed);
    EXPECT_EQ(result.ignored, edit.voxels.size() - changed);
    grid = std::move(next);
    last = std::move(edit);
    if (round % 7 == 6) editor->compact();
    expectSameTree(*tree, *built);
    if (options.leaf == LeafModel::Distance && round % 4 == 0) {
      expectSoundClearances(grid, *tree, *built, rng);
    }
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_TRUE(treeFromCache(treeToCache(*tree, 7), 7)) << "links leave the arrays";
}

TEST(TreeEditor, EditedTreesAreThoseOfARebuild) {
  std::uint32_t seed = kSeed;
  for (const auto& [name, grid] : assortedGrids(kSeed)) {
    for (const LeafModel leaf : kLeaves) {
      for (const Branching branching : kBranchings) {
        expectEditsToMatch(name, grid, 1 + static_cast<int>(seed % 3), 25, seed,
                           {branching, leaf, false});
        ++seed;
        if (HasFailure()) return;
      }
    }
  }
}

TEST(TreeEditor, DepthsBeyondSaturationAreThoseOfARebuild) {
  std::uint32_t seed = kSeed;
  for (const Eigen::Vector3d& spacing :
       {Eigen::Vector3d(1e-3, 1e-3, 1e-3), Eigen::Vector3d(0.5e-3, 0.7e-3, 0.9e-3)}) {
    for (const LeafModel leaf : kLeaves) {
      for (const Branching branching : kBranchings) {
        expectEditsToMatch("thick", thick(spacing), 2, 10, seed++, {branching, leaf, false});
        if (HasFailure()) return;
      }
    }
  }
}

// Cells much longer than wide: a diagonal reaches over many voxels of the short axes.
TEST(TreeEditor, LongVoxelsAreThoseOfARebuild) {
  std::uint32_t seed = kSeed;
  const Eigen::Vector3d spacing(0.4e-3, 0.3e-3, 3e-3);
  const auto grid = makeGrid(
      {40, 37, 9}, spacing, [](int i, int j, int k) { return (i - 20) * k < 90 && j > 3 ? 1 : 0; });
  for (const LeafModel leaf : kLeaves) {
    expectEditsToMatch("long", grid, 1, 20, seed++, {Branching::Children64, leaf, false});
  }
}

// Farther apart than the boxes that are done at a time, and more than one of these wide.
TEST(TreeEditor, WideEditsAreThoseOfARebuild) {
  const auto start = makeGrid({150, 70, 40}, Eigen::Vector3d::Constant(1e-3),
                              [](int, int, int k) { return k < 33 ? 1 : 0; });
  for (const LeafModel leaf : kLeaves) {
    SCOPED_TRACE(static_cast<int>(leaf));
    const TreeOptions options{Branching::Children64, leaf, false};
    auto tree = VoxelTree::build(start, {}, options);
    ASSERT_TRUE(tree);
    auto editor = TreeEditor::create(*tree);
    ASSERT_TRUE(editor);
    RandomEdit edit;
    for (int n = 0; n < 4000; ++n) edit.voxels.push_back({n * 37 % 150, n % 70, 32 - n % 3});
    edit.voxels.insert(edit.voxels.end(), {{0, 0, 0}, {149, 69, 0}, {75, 35, 5}});
    for (const std::uint8_t label : {std::uint8_t{0}, std::uint8_t{1}}) {
      edit.label = label;
      LabelGrid grid = start;
      if (label == 0) apply(edit, grid);
      EXPECT_EQ(run(*editor, edit).status, EditStatus::Done);
      const auto built = VoxelTree::build(grid, {}, options);
      ASSERT_TRUE(built);
      expectSameTree(*tree, *built);
    }
  }
}

// A block of 16³ cells beside a wall, far enough to have one clearance for all, gets its first
// brick in the corner that is farthest from the wall.
TEST(TreeEditor, BlocksThatGetTheirFirstBrickKeepTheirBounds) {
  std::mt19937 rng(kSeed);
  LabelGrid grid = makeGrid({40, 40, 40}, Eigen::Vector3d::Constant(1e-3),
                            [](int i, int, int) { return i < 8 ? 1 : 0; });
  const TreeOptions options{Branching::Children64, LeafModel::Distance, false};
  auto tree = VoxelTree::build(grid, {}, options);
  ASSERT_TRUE(tree);
  const auto& depth = tree->data().depth;
  const std::uint32_t before = depth.coarse[depth.blockAt(1, 1, 1)];
  ASSERT_EQ(before & ClearanceWord::kLink, 0U);
  ASSERT_NE(before & ClearanceWord::kSlopeMask,
            static_cast<std::uint32_t>(ClearanceWord::kSlopeBias));
  auto editor = TreeEditor::create(*tree);
  ASSERT_TRUE(editor);
  const RandomEdit edit{"corner", 1, {{30, 30, 30}}};
  EXPECT_EQ(run(*editor, edit).changed, 1U);
  apply(edit, grid);
  const auto built = VoxelTree::build(grid, {}, options);
  ASSERT_TRUE(built);
  expectSameTree(*tree, *built);
  expectSoundClearances(grid, *tree, *built, rng, 4000);
  // And bounds they are: halfway to the wall there is room.
  EXPECT_GT(boundAt(tree->data(), {17.0f, 17.0f, 17.0f}), 4.0f);
}

// ---- what is refused, ignored, counted ----

TEST(TreeEditor, WhatIsRefusedChangesNothing) {
  const auto grid = assortedGrids(kSeed)[4].grid;  // a single voxel
  for (const LeafModel leaf : kLeaves) {
    auto tree = VoxelTree::build(grid, {}, {Branching::Children64, leaf, false});
    ASSERT_TRUE(tree);
    const std::string before = treeToCache(*tree, 1);
    auto editor = TreeEditor::create(*tree);
    ASSERT_TRUE(editor);
    const Voxel last{17, 4, 12};
    for (const Voxel& outside : {Voxel{-1, 0, 0}, Voxel{0, -1, 0}, Voxel{0, 0, -1}, Voxel{21, 0, 0},
                                 Voxel{0, 9, 0}, Voxel{0, 0, 13}}) {
      const Voxel voxels[] = {{3, 3, 3}, last, outside};
      EXPECT_EQ(editor->remove(voxels).status, EditStatus::OutsideGrid);
      EXPECT_EQ(editor->add(voxels, 1).status, EditStatus::OutsideGrid);
    }
    const Voxel some[] = {{3, 3, 3}, last, last};
    EXPECT_EQ(editor->remove(some).status, EditStatus::WouldBeEmpty);
    EXPECT_EQ(editor->add(some, 0).status, EditStatus::NoLabel);
    EXPECT_EQ(editor->remove({}).changed, 0U);
    EXPECT_EQ(treeToCache(*tree, 1), before);
    EXPECT_EQ(tree->data().edits, 0U);
    // Neither was the editor's own knowledge: this is one voxel of three.
    const EditResult added = editor->add(some, 9);
    EXPECT_EQ(added.changed, 1U);
    EXPECT_EQ(added.ignored, 2U);
    EXPECT_EQ(tree->data().edits, 1U);
    EXPECT_EQ(tree->stats().solidVoxels, 2U);
  }
}

TEST(TreeEditor, SurfaceOnlyTreesAreRefused) {
  auto tree = VoxelTree::build(assortedGrids(kSeed)[9].grid, {},
                               {Branching::Children64, LeafModel::Voxel, true});
  ASSERT_TRUE(tree);
  const auto editor = TreeEditor::create(*tree);
  ASSERT_FALSE(editor);
  EXPECT_EQ(editor.error().message, "A tree of surface voxels only cannot be edited.");
  EXPECT_EQ(editor.error().field, "surfaceOnly");
}

// ---- memory ----

TEST(TreeEditor, GarbageIsBoundedHoweverManyEdits) {
  const auto start = assortedGrids(kSeed)[9].grid;
  for (const LeafModel leaf : kLeaves) {
    for (const Branching branching : kBranchings) {
      SCOPED_TRACE(std::to_string(static_cast<int>(branching)) + " children, leaf " +
                   std::to_string(static_cast<int>(leaf)) + ", seed " + std::to_string(kSeed));
      std::mt19937 rng(kSeed);
      LabelGrid grid = start;
      auto tree = VoxelTree::build(grid, {}, {branching, leaf, false});
      ASSERT_TRUE(tree);
      auto editor = TreeEditor::create(*tree);
      ASSERT_TRUE(editor);
      editor->separateLabels();
      editor->reserve({0, 0, 0}, grid.geometry.dims);
      for (int round = 0; round < 400; ++round) {
        const RandomEdit edit = randomEdit(rng, grid.geometry, 3);
        const EditResult result = run(*editor, edit);
        EXPECT_FALSE(result.tookMemory) << "round " << round << ", " << edit.name;
        if (result.status == EditStatus::Done) apply(edit, grid);
      }
      const auto built = VoxelTree::build(grid, {}, {branching, leaf, false});
      ASSERT_TRUE(built);
      editor->compact();
      expectSameTree(*tree, *built);
      EXPECT_EQ(tree->stats().topologyBytes, built->stats().topologyBytes);
    }
  }
}

}  // namespace
}  // namespace palpate
