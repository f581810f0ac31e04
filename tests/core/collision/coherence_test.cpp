/// QueryOptions::coherence: what is remembered from pose to pose never changes a bit.

#include <gtest/gtest.h>

#include <cstring>

#include "core/collision/contact_finder.h"
#include "tests/core/collision/oracle.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

struct Walk {
  std::size_t contacts = 0;
  double tests = 0, testsAlone = 0;
};

// Both finders over the same poses: steps of up to `step` metres and as many tenths of a radian a
// centimetre, and now and then somewhere else.
Walk walk(const LabelGrid& grid, double step, int teleportEvery, std::uint32_t seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal;
  const Eigen::Vector3d middle = oracle::middleOf(grid.geometry);
  const auto tree = VoxelTree::build(grid, {}, {});
  const PointShell shell = oracle::randomShell(rng, 30000, 0.5 * middle);
  ContactFinder alone(*tree, shell);
  QueryOptions options;
  options.coherence = true;
  ContactFinder coherent(*tree, shell, options);
  std::vector<Contact> a(shell.size());
  std::vector<Contact> b(shell.size());
  Eigen::Isometry3d X = oracle::randomPose(rng, middle, 0.01);
  Walk sum;
  for (int i = 0; i < 250; ++i) {
    X.translation() += step * Eigen::Vector3d(normal(rng), normal(rng), normal(rng));
    const Eigen::Vector3d axis = Eigen::Vector3d(normal(rng), normal(rng), normal(rng));
    X.linear() *= Eigen::AngleAxisd(10 * step * normal(rng), axis.normalized()).toRotationMatrix();
    X.translation() += 0.05 * (middle - X.translation());  // not away for good
    if (i % teleportEvery == teleportEvery - 1) X = oracle::randomPose(rng, middle, 0.05);
    if (i % 97 == 96) X.translation().x() += 1e6;  // out of reach, where slack is large
    // Rotations of many factors drift.
    X.linear() = Eigen::Quaterniond(X.linear()).normalized().toRotationMatrix();
    const QueryResult expected = alone.find(X, a);
    const QueryResult found = coherent.find(X, b);
    EXPECT_EQ(found.contactCount, expected.contactCount);
    if (found.contactCount != expected.contactCount) break;
    EXPECT_EQ(std::memcmp(a.data(), b.data(), found.contactCount * sizeof(Contact)), 0);
    sum.contacts += found.contactCount;
    sum.tests += found.tests;
    sum.testsAlone += expected.tests;
    if (i % 97 == 96) X.translation().x() -= 1e6;
  }
  return sum;
}

TEST(Coherence, ContactsAreTheSameBitsOverWalksAndTeleports) {
  for (const std::uint32_t seed : {71U, 72U}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    for (const auto& [name, grid] : testing_volumes::assortedGrids(seed)) {
      if (name != "ball" && name != "half" && name != "thin sheet") continue;
      SCOPED_TRACE(name);
      for (const double step : {2e-5, 2e-4, 1.5e-3}) {
        EXPECT_GT(walk(grid, step, 50, seed).contacts, 100U);
      }
      EXPECT_GT(walk(grid, 1e-3, 2, seed).contacts, 100U);
    }
  }
}

}  // namespace
}  // namespace palpate
