#include "core/voxels/tree_cache.h"

#include <gtest/gtest.h>
#define XXH_INLINE_ALL
#include <unistd.h>
#include <xxhash.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "core/voxels/voxel_tree_data.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using testing_volumes::assortedGrids;

std::string refusal(std::string_view bytes, std::uint64_t source) {
  const auto tree = treeFromCache(bytes, source);
  if (tree) return "accepted";
  EXPECT_EQ(tree.error().kind, ErrorKind::InputRefused);
  return tree.error().message;
}

TEST(TreeCache, GivesTheSameTreeBack) {
  for (const auto& [name, grid] : assortedGrids(61)) {
    for (const auto branching :
         {Branching::Children8, Branching::Children64, Branching::Children512}) {
      for (const auto leaf : {LeafModel::Voxel, LeafModel::Distance}) {
        SCOPED_TRACE(name);
        const auto tree = VoxelTree::build(grid, {}, {branching, leaf, false});
        ASSERT_TRUE(tree);
        const std::string bytes = treeToCache(*tree, 5);
        const auto back = treeFromCache(bytes, 5);
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_EQ(treeToCache(*back, 5), bytes);
        EXPECT_EQ(back->stats().levels, tree->stats().levels);
        EXPECT_EQ(back->stats().nodesPerLevel, tree->stats().nodesPerLevel);
        EXPECT_EQ(back->stats().surfaceVoxels, tree->stats().surfaceVoxels);
        EXPECT_EQ(back->stats().solidVoxels, tree->stats().solidVoxels);
        EXPECT_EQ(back->stats().topologyBytes, tree->stats().topologyBytes);
        EXPECT_EQ(back->stats().payloadBytes, tree->stats().payloadBytes);
        EXPECT_EQ(back->geometry().dims, grid.geometry.dims);
        EXPECT_EQ(back->data().spheres.fullRadius(1), tree->data().spheres.fullRadius(1));
      }
    }
  }
}

TEST(TreeCache, DamagedForeignAndOtherFilesAreRefused) {
  const auto grid = assortedGrids(62)[9].grid;
  const auto tree = VoxelTree::build(grid, {}, {});
  ASSERT_TRUE(tree);
  const std::string good = treeToCache(*tree, 7);
  EXPECT_EQ(refusal("", 7), "The tree's cache file is cut short.");
  EXPECT_EQ(refusal(good.substr(0, good.size() - 1), 7), "The tree's cache file is cut short.");
  EXPECT_EQ(refusal(good, 8), "The tree's cache file was made from other labels.");
  std::string foreign = good;
  foreign[0] = 'X';
  EXPECT_EQ(refusal(foreign, 7), "The file is not a tree's cache.");
  std::string other = good;
  other[8] = 99;
  EXPECT_EQ(refusal(other, 7), "The tree's cache file is of another version.");
  for (std::size_t at = 64; at < good.size(); at += 997) {
    std::string damaged = good;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    EXPECT_EQ(refusal(damaged, 7), "The tree's cache file is damaged.");
  }
}

// With length and checksum of what is there.
std::string forge(std::string bytes) {
  const std::uint64_t length = bytes.size() - 64;
  const std::uint64_t sum = XXH3_64bits(bytes.data() + 64, bytes.size() - 64);
  std::memcpy(bytes.data() + 24, &length, 8);
  std::memcpy(bytes.data() + 32, &sum, 8);
  return bytes;
}

// Behind a checksum that fits, nothing may crash or be read out of bounds (sanitizers watch); most
// is refused, what passes differs in values only.
TEST(TreeCache, AForgedChecksumDoesNotMakeAFileTrusted) {
  constexpr std::uint32_t kSeed = 63;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  const auto tree = VoxelTree::build(assortedGrids(kSeed)[1].grid, {}, {});
  ASSERT_TRUE(tree);
  const std::string good = treeToCache(*tree, 7);
  ASSERT_EQ(refusal(forge(good), 7), "accepted");
  std::string wild = good;  // the root's link lies before the last array's slack
  wild[wild.size() - LargeArray<char>::kSlackBytes - 2] = 1;
  EXPECT_EQ(refusal(forge(wild), 7), "The tree's cache file contradicts itself.");
  int refusals = 0;
  for (int trial = 0; trial < 600; ++trial) {
    std::string bytes = good;
    // Half of the trials in the fields before the arrays, where they do most harm.
    const std::size_t range = trial % 2 == 0 ? 300 : good.size() - 64;
    bytes[64 + rng() % range] = static_cast<char>(rng());
    if (trial % 5 == 0) bytes.resize(64 + rng() % (good.size() - 64));
    const std::string message = refusal(forge(bytes), 7);
    refusals += message == "The tree's cache file contradicts itself." ? 1 : 0;
  }
  EXPECT_GT(refusals, 150);
}

// Found by fuzzing: the palette's table of distances grew with the square of the ratio.
TEST(TreeCache, AForgedSpacingIsRefusedBeforeAnythingIsMadeOfIt) {
  const auto tree = VoxelTree::build(assortedGrids(65)[1].grid, {}, {});
  ASSERT_TRUE(tree);
  const std::string good = treeToCache(*tree, 7);
  for (const double spacing : {50.0, 1e6, 1e30, 1e300, 1e-9, 1e-300, 5e-324}) {
    std::string bytes = good;
    std::memcpy(bytes.data() + 64 + 12, &spacing, 8);  // along x, behind the counts
    EXPECT_EQ(refusal(forge(bytes), 7), "The tree's cache file contradicts itself.") << spacing;
  }
}

TEST(TreeCache, TheFingerprintKnowsLabelsGeometrySelectionAndOptions) {
  auto grid = assortedGrids(64)[1].grid;
  const std::uint8_t one[] = {1};
  const auto base = treeSourceFingerprint(grid, {}, {});
  EXPECT_EQ(treeSourceFingerprint(grid, {}, {}), base);
  EXPECT_NE(treeSourceFingerprint(grid, one, {}), base);
  EXPECT_NE(treeSourceFingerprint(grid, {}, {Branching::Children8, LeafModel::Distance, false}),
            base);
  grid.labels[5] ^= 1;
  EXPECT_NE(treeSourceFingerprint(grid, {}, {}), base);
  grid.labels[5] ^= 1;
  grid.geometry.spacing.x() *= 1.001;
  EXPECT_NE(treeSourceFingerprint(grid, {}, {}), base);
}

// A file is mapped, not copied: what is changed in the tree must not reach it.
TEST(TreeCache, AnEditOfALoadedTreeLeavesTheFileAsItIs) {
  const auto tree = VoxelTree::build(assortedGrids(66)[9].grid, {}, {});
  ASSERT_TRUE(tree);
  const auto file = std::filesystem::path(testing::TempDir()) / "palpate_private_view.cache";
  ASSERT_TRUE(saveTreeCache(*tree, 7, file));
  {
    const auto loaded = loadTreeCache(file, 7);
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(loaded->data().depth.slots, tree->data().depth.slots);
    auto& data = const_cast<VoxelTree::Data&>(loaded->data());
    for (auto& word : data.depth.slots) word = 5;
    for (auto& mask : data.level[1].masks) mask = 1;
  }
  const auto again = loadTreeCache(file, 7);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->data().depth.slots, tree->data().depth.slots);
  EXPECT_EQ(again->data().level[1].masks, tree->data().level[1].masks);
  std::filesystem::remove(file);
}

TEST(TreeCache, AMissingFileIsRefused) {
  const auto tree = loadTreeCache("/nowhere/tree.cache", 1);
  ASSERT_FALSE(tree);
  EXPECT_EQ(tree.error().message, "The tree's cache file cannot be read.");
  EXPECT_EQ(tree.error().file, "/nowhere/tree.cache");
}

class TreeCacheFolder : public testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() /
             ("palpate-tree-cache-" + std::to_string(::getpid()));
    std::filesystem::create_directory(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder),
                                                  std::filesystem::directory_iterator()));
  }
  std::filesystem::path folder;
};

TEST_F(TreeCacheFolder, TheSecondTimeATreeIsOpenedAndTheSame) {
  const auto grid = assortedGrids(65)[9].grid;
  const auto built = openOrBuildTree(grid, {}, {}, folder);
  ASSERT_TRUE(built);
  EXPECT_EQ(files(), 1U);
  std::vector<std::string> said;
  Progress progress;
  progress.report = [&](double, const std::string& what) { said.push_back(what); };
  const auto opened = openOrBuildTree(grid, {}, {}, folder, progress);
  ASSERT_TRUE(opened);
  EXPECT_EQ(said, std::vector<std::string>{"Tree opened"});
  EXPECT_EQ(treeToCache(*opened, 1), treeToCache(*built, 1));
}

TEST_F(TreeCacheFolder, ADamagedFileIsBuiltAnewAndReplaced) {
  const auto grid = assortedGrids(66)[9].grid;
  const auto built = openOrBuildTree(grid, {}, {}, folder);
  const auto file = folder / treeCacheName(treeSourceFingerprint(grid, {}, {}));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
  const auto again = openOrBuildTree(grid, {}, {}, folder);
  ASSERT_TRUE(built && again);
  EXPECT_TRUE(loadTreeCache(file, treeSourceFingerprint(grid, {}, {})));
}

TEST_F(TreeCacheFolder, OnlyAFewTreesAreKeptAndOtherFilesStay) {
  std::ofstream(folder / "labels.mha") << "mine";
  auto grid = assortedGrids(67)[1].grid;
  for (int i = 0; i < 9; ++i) {
    grid.labels[static_cast<std::size_t>(i)] ^= 1;
    ASSERT_TRUE(openOrBuildTree(grid, {}, {}, folder));
  }
  EXPECT_EQ(files(), 1U + 4U);
  EXPECT_TRUE(std::filesystem::exists(folder / "labels.mha"));
}

TEST_F(TreeCacheFolder, AFolderThatCannotBeWrittenStillGivesATree) {
  EXPECT_TRUE(openOrBuildTree(assortedGrids(68)[9].grid, {}, {}, folder / "missing"));
}

}  // namespace
}  // namespace palpate
