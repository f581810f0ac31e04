#include "core/voxels/surface_descriptor.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using testing_volumes::makeGrid;
using testing_volumes::solidOf;

TEST(SurfaceDescriptor, ABlockHasSkinCoreAndProximity) {
  const auto grid = makeGrid({7, 7, 7}, Eigen::Vector3d::Ones(), [](int i, int j, int k) {
    return i >= 2 && i <= 4 && j >= 2 && j <= 4 && k >= 2 && k <= 4;
  });
  const auto kind = classifySurface(grid.geometry, solidOf(grid));
  std::map<SurfaceDescriptor, int> count;
  for (const auto k : kind) ++count[k];
  EXPECT_EQ(count[SurfaceDescriptor::Full], 1);
  EXPECT_EQ(count[SurfaceDescriptor::Surface], 26);
  EXPECT_EQ(count[SurfaceDescriptor::Proximity], 54);  // six faces of nine
  EXPECT_EQ(count[SurfaceDescriptor::Empty], 343 - 27 - 54);
  EXPECT_EQ(kind[grid.geometry.index(3, 3, 3)], SurfaceDescriptor::Full);
  EXPECT_EQ(kind[grid.geometry.index(1, 1, 1)], SurfaceDescriptor::Empty);  // only a corner touches
}

TEST(SurfaceDescriptor, TheFacesOfTheGridAreOpen) {
  const auto grid = makeGrid({4, 4, 4}, Eigen::Vector3d::Ones(), [](int, int, int) { return 1; });
  const auto kind = classifySurface(grid.geometry, solidOf(grid));
  EXPECT_EQ(kind[grid.geometry.index(0, 2, 2)], SurfaceDescriptor::Surface);
  EXPECT_EQ(kind[grid.geometry.index(1, 2, 2)], SurfaceDescriptor::Full);
  const auto voxels = surfaceVoxels(grid.geometry, solidOf(grid));
  EXPECT_EQ(voxels.size(), 64U - 8U);
  EXPECT_EQ(voxels.front(), (std::array<std::int32_t, 3>{0, 0, 0}));
  EXPECT_EQ(voxels.back(), (std::array<std::int32_t, 3>{3, 3, 3}));
}

}  // namespace
}  // namespace palpate
