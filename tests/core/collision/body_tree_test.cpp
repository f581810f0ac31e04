#include "core/collision/body_tree.h"

#include <gtest/gtest.h>

#include "core/collision/shell_hierarchy.h"
#include "core/collision/voxel_body_shell.h"
#include "core/voxels/node_mask.h"
#include "tests/core/collision/oracle.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using testing_volumes::assortedGrids;
using testing_volumes::makeGrid;

using Voxel = std::array<std::int32_t, 3>;

// Every shell point is at the centre of exactly one leaf, found by walking masks and links.
template <int Bits>
void expectLeavesAreThePoints(const PointShell& shell) {
  using Mask = NodeMask<Bits>;
  const PointShell::Data& data = shell.data();
  ASSERT_TRUE(data.body);
  const VoxelBody& body = *data.body;
  const BodyTree& tree = body.tree[Bits - 1];
  std::vector<int> seen(shell.size(), 0);
  const auto walk = [&](auto&& self, int level, std::uint32_t node, const Voxel& at) -> void {
    if (level == 0) {
      const std::uint32_t index = data.hierarchy.order[tree.rank[node]];
      ++seen[index];
      const Eigen::Vector3d inBox(at[0] + 0.5, at[1] + 0.5, at[2] + 0.5);
      const Eigen::Vector3d centre = body.origin_T + body.axes_T * inBox.cwiseProduct(body.spacing);
      ASSERT_LE((centre - shell.points_T()[index]).norm(), body.slack);
      return;
    }
    const TreeLevel& here = tree.level[static_cast<std::size_t>(level)];
    std::uint32_t next = here.firstChild[node];
    forEachChild(Mask::load(here.masks.data(), node), [&](int c) {
      self(self, level - 1, next++,
           Voxel{at[0] * Mask::kEdge + (c & Mask::kLow),
                 at[1] * Mask::kEdge + ((c >> Bits) & Mask::kLow),
                 at[2] * Mask::kEdge + (c >> (2 * Bits))});
    });
  };
  walk(walk, tree.levels, 0, Voxel{0, 0, 0});
  for (const int times : seen) EXPECT_EQ(times, 1);
}

TEST(BodyTree, EveryShellPointIsTheCentreOfOneLeafOfEachTree) {
  constexpr std::uint32_t kSeed = 91;
  std::mt19937 rng(kSeed);
  for (auto& [name, grid] : assortedGrids(kSeed)) {
    SCOPED_TRACE(name + ", seed " + std::to_string(kSeed));
    grid.geometry.X_PV = oracle::randomPose(rng, Eigen::Vector3d(0.02, -0.05, 0.01), 0.03);
    const PointShell shell = shellOfVoxelBody(grid).value();
    expectLeavesAreThePoints<1>(shell);
    expectLeavesAreThePoints<2>(shell);
    expectLeavesAreThePoints<3>(shell);
    // A picometre of a body of centimetres: slack is for rounding, not for voxels.
    EXPECT_LT(shell.data().body->slack, 1e-12);
  }
}

TEST(BodyTree, AirAroundTheBodyAddsNoLevels) {
  const auto grid = makeGrid({300, 40, 300}, Eigen::Vector3d::Constant(1e-3),
                             [](int i, int j, int k) { return i > 280 && j > 30 && k > 295; });
  const PointShell shell = shellOfVoxelBody(grid).value();
  EXPECT_EQ(shell.data().body->tree[0].levels, 5);
  EXPECT_EQ(shell.data().body->tree[1].levels, 3);
  EXPECT_EQ(shell.data().body->tree[2].levels, 2);
}

}  // namespace
}  // namespace palpate
