/// Contacts with an edited tree are those with one that is built from the edited labels.

#include <gtest/gtest.h>

#include "core/collision/contact_finder.h"
#include "core/voxels/tree_editor.h"
#include "tests/core/collision/oracle.h"
#include "tests/core/voxels/random_edits.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

constexpr std::uint32_t kSeed = 529;

void expectSameContacts(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].shellIndex, b[i].shellIndex);
    EXPECT_EQ(a[i].flags, b[i].flags);
    EXPECT_EQ(a[i].label, b[i].label);
    EXPECT_EQ(a[i].depth, b[i].depth);
    // Where depths are saturated, bricks may only know about which way is out.
    const bool saturated = (a[i].flags & kContactSaturated) != 0;
    for (int x = 0; x < 3; ++x) {
      EXPECT_EQ(a[i].p[x], b[i].p[x]);
      if (saturated) continue;
      EXPECT_EQ(a[i].n[x], b[i].n[x]);
    }
  }
}

void compareContacts(const LabelGrid& start, LeafModel leaf, Branching branching, int rounds,
                     std::mt19937& rng) {
  const TreeOptions options{branching, leaf, false};
  const Eigen::Vector3d middle = oracle::middleOf(start.geometry);
  const PointShell shell = oracle::randomShell(rng, 1500, middle);
  LabelGrid grid = start;
  auto tree = VoxelTree::build(grid, {}, options);
  ASSERT_TRUE(tree);
  auto editor = TreeEditor::create(*tree);
  ASSERT_TRUE(editor);
  // One from before the edits: with distance leaves it remembers nothing that these change.
  ContactFinder early(*tree, shell, {});
  std::vector<Contact> found(shell.size());
  for (int round = 0; round < rounds; ++round) {
    const auto edit = testing_volumes::randomEdit(rng, grid.geometry, 2);
    SCOPED_TRACE("round " + std::to_string(round) + ", " + edit.name);
    const EditResult result =
        edit.label == 0 ? editor->remove(edit.voxels) : editor->add(edit.voxels, edit.label);
    if (result.status != EditStatus::Done) continue;
    testing_volumes::apply(edit, grid);
    const auto built = VoxelTree::build(grid, {}, options);
    ASSERT_TRUE(built);
    for (const QueryMethod method :
         {QueryMethod::Hierarchy, QueryMethod::Paper, QueryMethod::BruteForce}) {
      QueryOptions query;
      query.method = method;
      const auto X_VT = oracle::randomPose(rng, middle, 0.4 * middle.maxCoeff());
      expectSameContacts(oracle::findAll(*tree, shell, query, X_VT),
                         oracle::findAll(*built, shell, query, X_VT));
    }
    if (leaf == LeafModel::Distance) {
      const auto X_VT = oracle::randomPose(rng, middle, 0.4 * middle.maxCoeff());
      const std::size_t count = early.find(X_VT, found).contactCount;
      expectSameContacts({found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count)},
                         oracle::findAll(*built, shell, {}, X_VT));
    }
    if (testing::Test::HasFailure()) return;
  }
}

TEST(EditedTree, ContactsAreThoseOfARebuild) {
  std::mt19937 rng(kSeed);
  auto grids = testing_volumes::assortedGrids(kSeed);
  grids.push_back({"thick", testing_volumes::makeGrid(
                                {50, 46, 44}, Eigen::Vector3d::Ones() * 1e-3,
                                [](int i, int j, int) { return i > 2 && j < 43 ? 1 : 0; })});
  for (const auto& [name, grid] : grids) {
    for (const LeafModel leaf : {LeafModel::Voxel, LeafModel::Distance}) {
      for (const Branching branching :
           {Branching::Children8, Branching::Children64, Branching::Children512}) {
        SCOPED_TRACE(name + ", " + std::to_string(static_cast<int>(branching)) +
                     " children, leaf " + std::to_string(static_cast<int>(leaf)) + ", seed " +
                     std::to_string(kSeed));
        compareContacts(grid, leaf, branching, 5, rng);
        if (HasFailure()) return;
      }
    }
  }
}

}  // namespace
}  // namespace palpate
