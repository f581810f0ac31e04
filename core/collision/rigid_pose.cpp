#include "core/collision/rigid_pose.h"

#include <algorithm>
#include <cmath>

namespace palpate {

bool isRigidPose(const Eigen::Isometry3d& X) noexcept {
  constexpr double kTolerance = 1e-6;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) {
      if (!std::isfinite(X(i, j))) return false;
    }
  }
  double worst = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double dot = X(0, i) * X(0, j) + X(1, i) * X(1, j) + X(2, i) * X(2, j);
      worst = std::max(worst, std::abs(dot - (i == j ? 1.0 : 0.0)));
    }
  }
  const double det = X(0, 0) * (X(1, 1) * X(2, 2) - X(1, 2) * X(2, 1)) -
                     X(0, 1) * (X(1, 0) * X(2, 2) - X(1, 2) * X(2, 0)) +
                     X(0, 2) * (X(1, 0) * X(2, 1) - X(1, 1) * X(2, 0));
  return worst <= kTolerance && det > 0.0;
}

}  // namespace palpate
