#pragma once
/// The probe's side for the rivals and the prototype: a 16-ary tree of spheres over the points.
///
/// Built well, once, for all of them: ranks are an order of the points in which every run of
/// 16^l is compact, so that node i of level l holds ranks [i·16^l, (i+1)·16^l) and only centres and
/// radii are stored. Level 1 nodes hold 16 points each.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace palpate::bench {

struct SphereLevel {
  std::size_t count = 0;
  /// Frame T, metres; padded to whole runs of 16 with spheres of radius -1e9 (never touched).
  std::vector<float> x, y, z, r;
};

struct ProbeTree {
  static constexpr std::size_t kArity = 16;
  std::size_t points = 0;
  std::vector<std::uint32_t> order;  ///< rank -> index; padded like the points
  SphereLevel point;                 ///< r = 0; padding lies far outside every world
  std::vector<SphereLevel> level;    ///< [0] leaf nodes of 16 points .. back(): at most 16 nodes
};

[[nodiscard]] ProbeTree buildProbeTree(const std::vector<Eigen::Vector3d>& points_T);

}  // namespace palpate::bench
