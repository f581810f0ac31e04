#include "core/voxels/enclosing_ball.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <optional>

namespace palpate {
namespace {

// A point counts as outside a ball only beyond this share of the points' extent; corners of cells
// differ by far more, and without it points on the sphere would be tried again for ever.
constexpr double kRelativeSlack = 1e-12;

// Points count as dependent (on one line, in one plane) below this share of the product of their
// edges. Rounding leaves about 1e-16; corners of cells a thousand times as long as wide give 1e-9.
constexpr double kDependent = 1e-13;

using Support = std::array<Eigen::Vector3d, 5>;

// The ball through `count` points (1 .. 4) with its centre in their affine hull; none where they
// are dependent: the support of a smallest ball never is.
std::optional<Ball> circumball(const Support& p, std::size_t count) noexcept {
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // from p[0]
  const Eigen::Vector3d a = p[1] - p[0];
  const Eigen::Vector3d b = p[2] - p[0];
  if (count == 2) {
    offset = 0.5 * a;
  } else if (count == 3) {
    const Eigen::Vector3d n = a.cross(b);
    if (!(n.norm() > kDependent * a.norm() * b.norm())) return std::nullopt;
    offset = (a.squaredNorm() * b - b.squaredNorm() * a).cross(n) / (2.0 * n.squaredNorm());
  } else if (count == 4) {
    const Eigen::Vector3d c = p[3] - p[0];
    const Eigen::Vector3d bc = b.cross(c);
    const double volume = a.dot(bc);
    if (!(std::abs(volume) > kDependent * a.norm() * b.norm() * c.norm())) return std::nullopt;
    offset = (a.squaredNorm() * bc + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b)) /
             (2.0 * volume);
  }
  return Ball{p[0] + offset, offset.norm()};
}

// The smallest ball of a support and a point outside the support's ball, by trying every subset
// that has the point on its sphere. `support` becomes the subset.
std::optional<Ball> growBy(const Eigen::Vector3d& point, double slack, Support& support,
                           std::size_t& count) noexcept {
  std::optional<Ball> best;
  Support bestSupport;
  std::size_t bestCount = 0;
  for (unsigned subset = 0; subset < 1U << count; ++subset) {
    if (std::popcount(subset) > 3) continue;
    Support chosen;
    chosen.fill(point);
    std::size_t size = 1;
    for (std::size_t i = 0; i < count; ++i) {
      if (((subset >> i) & 1U) != 0) chosen[size++] = support[i];
    }
    const auto ball = circumball(chosen, size);
    if (!ball || (best && ball->radius >= best->radius)) continue;
    const bool holds = std::all_of(
        support.begin(), support.begin() + static_cast<std::ptrdiff_t>(count),
        [&](const auto& p) { return (p - ball->centre).norm() <= ball->radius + slack; });
    if (!holds) continue;
    best = ball;
    bestSupport = chosen;
    bestCount = size;
  }
  if (best) {
    support = bestSupport;
    count = bestCount;
  }
  return best;
}

}  // namespace

Ball smallestEnclosingBall(std::span<const Eigen::Vector3d> points) noexcept {
  if (points.empty()) return {};
  Ball ball{points[0], 0.0};
  Support support;
  support.fill(points[0]);
  std::size_t count = 1;
  double slack = 0.0;
  for (bool first = true;; first = false) {
    std::size_t farthest = 0;
    double square = -1.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double d2 = (points[i] - ball.centre).squaredNorm();
      if (d2 > square) {
        square = d2;
        farthest = i;
      }
    }
    const double reach = std::sqrt(square);
    if (first) slack = kRelativeSlack * reach;
    if (reach > ball.radius + slack) {
      // The ball grows each time, so no support comes twice; where rounding lets it shrink, the
      // best there is has been found.
      const auto next = growBy(points[farthest], slack, support, count);
      if (next && next->radius > ball.radius) {
        ball = *next;
        continue;
      }
    }
    ball.radius = reach;
    return ball;
  }
}

}  // namespace palpate
