#include "core/voxels/enclosing_ball.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace palpate {
namespace {

// A point counts as outside a ball only beyond this share of the radius; corners of cells differ
// by far more, and without it points on the sphere would be tried again for ever.
constexpr double kRelativeSlack = 1e-12;

using Support = std::array<Eigen::Vector3d, 4>;

// The smallest ball with all of the support on its sphere: the circumball in their affine hull.
Ball circumball(const Support& support, std::size_t count) {
  Ball ball;
  if (count == 0) return ball;
  if (count == 1) {
    ball.centre = support[0];
    return ball;
  }
  const auto n = static_cast<Eigen::Index>(count - 1);
  Eigen::MatrixXd edges(3, n);
  Eigen::VectorXd half(n);
  for (Eigen::Index c = 0; c < n; ++c) {
    edges.col(c) = support[static_cast<std::size_t>(c) + 1] - support[0];
    half[c] = 0.5 * edges.col(c).squaredNorm();
  }
  // Centre = support[0] + edges·w with edges^T·edges·w = half; a rank-deficient (flat) support
  // gives the least-norm answer, which the caller's check then rejects or accepts.
  const Eigen::VectorXd w = (edges.transpose() * edges).fullPivLu().solve(half);
  const Eigen::Vector3d offset = edges * w;
  ball.centre = support[0] + offset;
  ball.radius = offset.norm();
  return ball;
}

bool holds(const Ball& ball, const Eigen::Vector3d& p, double scale) {
  return (p - ball.centre).norm() <= ball.radius + kRelativeSlack * scale;
}

Ball welzl(std::span<const Eigen::Vector3d> points, std::size_t count, Support& support,
           std::size_t onSphere, double scale) {
  Ball ball = circumball(support, onSphere);
  if (onSphere == 4) return ball;
  for (std::size_t i = 0; i < count; ++i) {
    if ((onSphere > 0 || i > 0) && holds(ball, points[i], scale)) continue;
    support[onSphere] = points[i];
    ball = welzl(points, i, support, onSphere + 1, scale);
  }
  return ball;
}

}  // namespace

Ball smallestEnclosingBall(std::span<const Eigen::Vector3d> points) {
  if (points.empty()) return {};
  double scale = 0.0;
  for (const auto& p : points) scale = std::max(scale, (p - points[0]).norm());
  Support support;
  support.fill(Eigen::Vector3d::Zero());
  Ball ball = welzl(points, points.size(), support, 0, scale);
  ball.radius = 0.0;
  for (const auto& p : points) ball.radius = std::max(ball.radius, (p - ball.centre).norm());
  return ball;
}

}  // namespace palpate
