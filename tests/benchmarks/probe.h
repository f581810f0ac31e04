#pragma once
/// The instrument of the benchmarks as a point shell.

#include <Eigen/Core>
#include <vector>

namespace palpate::bench {

/// About `points` even points on a drill, frame T, metres: a burr of 5 mm radius about the origin,
/// a shaft of 2 mm radius up to z = 30 mm, a handle of 6 mm radius up to z = 75 mm.
[[nodiscard]] std::vector<Eigen::Vector3d> drillPoints(std::size_t points);

inline constexpr double kBurrRadius = 5e-3;

}  // namespace palpate::bench
