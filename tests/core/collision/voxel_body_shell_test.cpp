#include "core/collision/voxel_body_shell.h"

#include <gtest/gtest.h>

#include "core/collision/contact_finder.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using testing_volumes::emptyGrid;
using testing_volumes::makeGrid;

TEST(VoxelBodyShell, IsTheCentresOfTheSurfaceVoxelsInThePatientFrame) {
  auto body = makeGrid({9, 9, 9}, Eigen::Vector3d(1e-3, 2e-3, 1e-3), [](int i, int j, int k) {
    return i >= 2 && i <= 6 && j >= 2 && j <= 6 && k >= 2 && k <= 6 ? 7 : 0;
  });
  body.geometry.X_PV.translation() = Eigen::Vector3d(0.1, -0.2, 0.3);
  body.geometry.X_PV.linear() =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const auto shell = shellOfVoxelBody(body);
  ASSERT_TRUE(shell);
  ASSERT_EQ(shell->size(), 125U - 27U);
  const Eigen::Vector3d first = body.geometry.X_PV * body.geometry.centre_V(2, 2, 2);
  EXPECT_LT((shell->points_T()[0] - first).norm(), 1e-15);
  const Eigen::Vector3d centre = body.geometry.X_PV * body.geometry.centre_V(4, 4, 4);
  for (std::size_t i = 0; i < shell->size(); ++i) {
    EXPECT_GT(shell->normals_T()[i].dot(shell->points_T()[i] - centre), 0.0);
  }
}

TEST(VoxelBodyShell, ABodyWithoutVoxelsIsRefused) {
  const auto shell = shellOfVoxelBody(emptyGrid({3, 3, 3}, Eigen::Vector3d::Ones()));
  ASSERT_FALSE(shell);
  EXPECT_EQ(shell.error().message, "The body has no solid voxel.");
}

// Two equal blocks, one shifted by three voxels of five: the overlap's surface centres touch.
TEST(VoxelBodyShell, TwoVoxelBodiesMeetWhereTheirVoxelsDo) {
  const auto block = makeGrid({9, 9, 9}, Eigen::Vector3d::Constant(1e-3), [](int i, int j, int k) {
    return i >= 2 && i <= 6 && j >= 2 && j <= 6 && k >= 2 && k <= 6;
  });
  const auto shell = shellOfVoxelBody(block);
  const auto tree = VoxelTree::build(block, {}, {Branching::Children8, LeafModel::Voxel, false});
  ASSERT_TRUE(shell && tree);
  ContactFinder finder(*tree, *shell);
  std::vector<Contact> out(shell->size());
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation().x() = 3e-3;
  // Two layers of 25: one is the face, of the other the rim of 16.
  EXPECT_EQ(finder.find(X, out).contactCount, 25U + 16U);
}

}  // namespace
}  // namespace palpate
