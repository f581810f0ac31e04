#pragma once
/// How much longer than a rotation a pose that is taken may make things.

#include <cmath>

namespace palpate {

/// The most that the axes (columns) can make of a vector of length one, at least 1. A pose may be
/// off a rotation by a millionth, and spheres must hold what it stretches.
[[nodiscard]] inline double stretchOf(const double axes[3][3]) noexcept {
  double square = 0.0;  // of the Frobenius norm of A^T·A − I: no eigenvalue of A^T·A is beyond it
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double dot =
          axes[0][i] * axes[0][j] + axes[1][i] * axes[1][j] + axes[2][i] * axes[2][j];
      const double e = dot - (i == j ? 1.0 : 0.0);
      square += e * e;
    }
  }
  return std::sqrt(1.0 + std::sqrt(square));
}

}  // namespace palpate
