#include "core/trade/grid_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <thread>

#include "core/collision/contact_finder.h"

namespace palpate {
namespace {

struct RandomAnatomy {
  std::shared_ptr<LabelGrid> grid = std::make_shared<LabelGrid>();
  std::array<bool, 256> felt{};
};

/// Blobs of two labels, of which one is felt; voxels that are not cubes; turned in the patient.
RandomAnatomy randomAnatomy(std::uint64_t seed) {
  RandomAnatomy made;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  LabelGrid& grid = *made.grid;
  grid.geometry.dims = {24, 20, 17};
  for (int axis = 0; axis < 3; ++axis) grid.geometry.spacing[axis] = 1e-3 * (0.4 + part(random));
  grid.geometry.X_PV = Eigen::AngleAxisd(part(random), Eigen::Vector3d(1, 2, 3).normalized());
  grid.geometry.X_PV.translation() = Eigen::Vector3d(0.02, -0.3, 0.1);
  grid.labels.assign(grid.geometry.voxelCount(), 0);
  for (int blob = 0; blob < 9; ++blob) {
    const Eigen::Vector3d c(24 * part(random), 20 * part(random), 17 * part(random));
    const double r = 2.0 + 4.0 * part(random);
    for (std::int32_t k = 0; k < 17; ++k) {
      for (std::int32_t j = 0; j < 20; ++j) {
        for (std::int32_t i = 0; i < 24; ++i) {
          if ((Eigen::Vector3d(i, j, k) - c).norm() > r) continue;
          grid.labels[grid.geometry.index(i, j, k)] = blob % 3 == 0 ? 2 : 1;
        }
      }
    }
  }
  made.felt[1] = true;
  return made;
}

TEST(GridReference, AgreesWithTheTreeOnContactsDepthsAndNormals) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const RandomAnatomy anatomy = randomAnatomy(seed);
    const std::vector<std::uint8_t> values{1};
    const auto tree = VoxelTree::build(*anatomy.grid, values, {});
    ASSERT_TRUE(tree);
    std::mt19937_64 random(100 + seed);
    std::uniform_real_distribution<double> part(-0.1, 1.1);
    std::vector<Eigen::Vector3d> points, normals;
    const auto& g = anatomy.grid->geometry;
    for (int i = 0; i < 4000; ++i) {
      points.emplace_back(part(random) * g.dims[0] * g.spacing[0],
                          part(random) * g.dims[1] * g.spacing[1],
                          part(random) * g.dims[2] * g.spacing[2]);
      normals.push_back(Eigen::Vector3d::UnitZ());
    }
    const auto shell = PointShell::fromPoints(points, normals);
    ASSERT_TRUE(shell);
    ContactFinder finder(*tree, *shell);
    std::vector<Contact> contacts(points.size());
    const auto found = finder.find(Eigen::Isometry3d::Identity(), contacts);
    std::vector<const Contact*> at(points.size(), nullptr);
    for (std::size_t c = 0; c < found.contactCount; ++c) {
      at[contacts[c].shellIndex] = &contacts[c];
    }
    const auto reference = gridReference(anatomy.grid, anatomy.felt, 60.0);
    const double near = g.spacing.minCoeff() / 500.0;
    int inside = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p_W = g.X_PV * points[i];
      const double d = reference->distance(p_W);
      if (d < -near) {
        ++inside;
        ASSERT_NE(at[i], nullptr) << i << " at " << d;
        EXPECT_NEAR(at[i]->depth, -d, near);
        const Eigen::Vector3d n = g.X_PV.linear() * Eigen::Map<const Eigen::Vector3d>(at[i]->n);
        EXPECT_GT(n.dot(reference->normal(p_W)), 0.999) << i;
      } else if (d > near) {
        EXPECT_EQ(at[i], nullptr) << i << " at " << d;
      }
    }
    EXPECT_GT(inside, 200);
  }
}

TEST(GridReference, AClearanceIsNeverTooLarge) {
  const RandomAnatomy anatomy = randomAnatomy(3);
  const auto reference = gridReference(anatomy.grid, anatomy.felt);
  const auto& g = anatomy.grid->geometry;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> part(-0.2, 1.2), turn(-1.0, 1.0);
  constexpr double kMargin = 0.1e-3;
  int tried = 0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d p = g.X_PV * Eigen::Vector3d(part(random) * g.dims[0] * g.spacing[0],
                                                       part(random) * g.dims[1] * g.spacing[1],
                                                       part(random) * g.dims[2] * g.spacing[2]);
    const double free = reference->clearance(p, kMargin);
    if (free <= 0.0) continue;
    const Eigen::Vector3d d =
        Eigen::Vector3d(turn(random), turn(random), turn(random)).normalized();
    EXPECT_GE(reference->distance(p + free * d), kMargin - 1e-12);
    ++tried;
  }
  EXPECT_GT(tried, 5000);
}

TEST(GridReference, ThreadsThatAskAtOnceGetWhatOneGets) {
  const RandomAnatomy anatomy = randomAnatomy(7);
  const auto& g = anatomy.grid->geometry;
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  std::vector<Eigen::Vector3d> places;
  for (int i = 0; i < 5000; ++i) {
    places.push_back(g.X_PV * Eigen::Vector3d(part(random) * g.dims[0] * g.spacing[0],
                                              part(random) * g.dims[1] * g.spacing[1],
                                              part(random) * g.dims[2] * g.spacing[2]));
  }
  const auto shared = gridReference(anatomy.grid, anatomy.felt);
  std::vector<std::vector<double>> found(4);
  std::vector<std::thread> threads;
  for (auto& mine : found) {
    threads.emplace_back([&] {
      for (const Eigen::Vector3d& p : places) mine.push_back(shared->distance(p));
    });
  }
  for (std::thread& thread : threads) thread.join();
  const auto alone = gridReference(anatomy.grid, anatomy.felt);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double d = alone->distance(places[i]);
    for (const auto& mine : found) EXPECT_EQ(mine[i], d) << i;
  }
}

TEST(GridReference, OutsideTheBoxOfCentresNothingIsDefined) {
  const RandomAnatomy anatomy = randomAnatomy(1);
  const auto reference = gridReference(anatomy.grid, anatomy.felt);
  const auto& g = anatomy.grid->geometry;
  EXPECT_TRUE(std::isinf(reference->distance(g.X_PV * Eigen::Vector3d(-1e-6, 1e-3, 1e-3))));
  EXPECT_FALSE(std::isinf(reference->distance(g.X_PV * Eigen::Vector3d(1e-6, 1e-3, 1e-3))));
}

}  // namespace
}  // namespace palpate
