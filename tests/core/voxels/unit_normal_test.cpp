#include "core/voxels/unit_normal.h"

#include <gtest/gtest.h>

#include <random>

namespace palpate {
namespace {

TEST(UnitNormal, RoundTripsWithinItsPromise) {
  constexpr std::uint32_t kSeed = 5;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  std::normal_distribution<double> normal;
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d n = Eigen::Vector3d(normal(rng), normal(rng), normal(rng)).normalized();
    const Eigen::Vector3d back = decodeNormal(encodeNormal(n));
    EXPECT_NEAR(back.norm(), 1.0, 1e-14);
    worst = std::max(worst, (back - n).norm());
  }
  EXPECT_LT(worst, 7e-5);
  EXPECT_GT(worst, 1e-6);  // it is a quantisation
}

TEST(UnitNormal, AxesAreExact) {
  for (int a = 0; a < 3; ++a) {
    for (const double sign : {-1.0, 1.0}) {
      const Eigen::Vector3d n = sign * Eigen::Vector3d::Unit(a);
      EXPECT_EQ((decodeNormal(encodeNormal(n)) - n).norm(), 0.0) << a << " " << sign;
    }
  }
}

}  // namespace
}  // namespace palpate
