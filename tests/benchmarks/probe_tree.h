#pragma once
/// The probe's side for the rivals: a 16-ary tree of spheres over the points.
///
/// Built well, once, for all of them: ranks are an order of the points in which every run of
/// 16^l is compact, so that node i of level l holds ranks [i·16^l, (i+1)·16^l) and only centres and
/// radii are stored. Level 1 nodes hold 16 points each.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace palpate::bench {

/// Sixteen sibling spheres side by side.
struct alignas(64) SphereBlock {
  float x[16], y[16], z[16], r[16];
};

struct SphereLevel {
  std::size_t count = 0;
  std::vector<SphereBlock> block;  ///< the same numbers as below
  /// Frame T, metres; padded to whole runs of 16 with spheres of radius -1e9 (never touched).
  std::vector<float> x, y, z, r;
};

/// Sixteen points side by side: one run of four cache lines a leaf.
struct alignas(64) LeafPoints {
  float x[16], y[16], z[16];
  std::uint32_t index[16];
};

struct ProbeTree {
  static constexpr std::size_t kArity = 16;
  static constexpr std::size_t kStart = 64;
  std::size_t points = 0;
  std::vector<std::uint32_t> order;  ///< rank -> index; padded like the points
  SphereLevel point;                 ///< r = 0; padding lies far outside every world
  std::vector<LeafPoints> leaf;      ///< the same points and their indices, leaf by leaf
  std::size_t start = 0;           ///< the level of at most kStart nodes where tuned descents begin
  std::vector<SphereLevel> level;  ///< [0] leaf nodes of 16 points .. back(): at most 16 nodes
};

[[nodiscard]] ProbeTree buildProbeTree(const std::vector<Eigen::Vector3d>& points_T);

}  // namespace palpate::bench
