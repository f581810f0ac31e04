#include "core/voxels/leaf_codes.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace palpate {
namespace {

TEST(LeafCodes, ComeBackAsTheyWerePut) {
  constexpr std::uint32_t kSeed = 66;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  for (const bool labelled : {false, true}) {
    for (const bool withNormals : {false, true}) {
      std::vector<NodeLeaves> nodes(300);
      std::vector<std::uint32_t> links;
      std::vector<std::uint8_t> bytes;
      for (NodeLeaves& node : nodes) {
        const std::size_t count = 1 + rng() % 512;
        const std::uint32_t range = rng() % 2 == 0 ? 64 : 4096;
        for (std::size_t i = 0; i < count; ++i) {
          node.codes.push_back(static_cast<std::uint16_t>(rng() % range));
          if (labelled) node.labels.push_back(static_cast<std::uint8_t>(rng()));
          if (withNormals) {
            node.normals.push_back(
                {static_cast<std::int16_t>(rng()), static_cast<std::int16_t>(rng())});
          }
        }
        // The one code that makes it wide may be anywhere.
        if (range == 64 && rng() % 4 == 0) node.codes[rng() % count] = 64;
        const std::size_t before = bytes.size();
        links.push_back(appendLeaves(node, bytes));
        const bool wide =
            *std::max_element(node.codes.begin(), node.codes.end()) >= DepthPalette::kNarrow;
        EXPECT_EQ((links.back() & kWideLeaves) != 0, wide);
        EXPECT_EQ(links.back() & ~kWideLeaves, before);
        EXPECT_EQ(bytes.size() - before, leafBytesOf(count, wide, labelled, withNormals));
      }
      LargeArray<std::uint8_t> stored;
      stored.append(bytes.data(), bytes.size());
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        const NodeLeaves& node = nodes[n];
        const int count = static_cast<int>(node.codes.size());
        for (int r = 0; r < count; ++r) {
          const auto at = static_cast<std::size_t>(r);
          ASSERT_EQ(leafCode(stored, links[n], r), node.codes[at]) << n << " " << r;
          if (labelled) {
            ASSERT_EQ(leafLabel(stored, links[n], count, r), node.labels[at]);
          }
          if (withNormals) {
            const UnitNormal normal = leafNormal(stored, links[n], count, r, labelled);
            ASSERT_EQ(normal.u, node.normals[at].u);
            ASSERT_EQ(normal.v, node.normals[at].v);
          }
        }
      }
    }
  }
}

TEST(LeafCodes, TakeSixOrTwelveBitsInWholeBytes) {
  EXPECT_EQ(leafCodeBytes(1, false), 1U);
  EXPECT_EQ(leafCodeBytes(4, false), 3U);
  EXPECT_EQ(leafCodeBytes(5, false), 4U);
  EXPECT_EQ(leafCodeBytes(512, false), 384U);
  EXPECT_EQ(leafCodeBytes(1, true), 2U);
  EXPECT_EQ(leafCodeBytes(3, true), 5U);
}

}  // namespace
}  // namespace palpate
