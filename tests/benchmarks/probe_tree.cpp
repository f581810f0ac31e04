#include "tests/benchmarks/probe_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate::bench {
namespace {

using Points = std::vector<Eigen::Vector3d>;
using Iterator = std::vector<std::uint32_t>::iterator;

// Orders [first, last) so that every run of `unit`, then of unit/16, ... is compact: halves along
// the longest side, cut at whole runs.
void arrange(const Points& points, Iterator first, Iterator last, std::size_t unit) {
  const auto count = static_cast<std::size_t>(last - first);
  while (unit >= count && unit > 1) unit /= ProbeTree::kArity;
  if (count <= 1 || unit < ProbeTree::kArity) return;
  Eigen::Vector3d lo = points[*first];
  Eigen::Vector3d hi = lo;
  for (auto it = first; it != last; ++it) {
    lo = lo.cwiseMin(points[*it]);
    hi = hi.cwiseMax(points[*it]);
  }
  Eigen::Index axis = 0;
  (hi - lo).maxCoeff(&axis);
  const std::size_t runs = (count + unit - 1) / unit;
  const auto middle = first + static_cast<std::ptrdiff_t>((runs / 2) * unit);
  std::nth_element(first, middle, last, [&](std::uint32_t a, std::uint32_t b) {
    const double pa = points[a][axis];
    const double pb = points[b][axis];
    return pa < pb || (pa == pb && a < b);
  });
  arrange(points, first, middle, unit);
  arrange(points, middle, last, unit);
}

// Near the smallest sphere: the centre walks towards the farthest point by shrinking steps
// (Badoiu & Clarkson, 2003).
void enclose(const Points& points, const std::uint32_t* first, std::size_t count, float* out) {
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count; ++i) c += points[first[i]];
  c /= static_cast<double>(count);
  const int steps = count <= 256 ? 200 : 40;
  for (int step = 1; step <= steps; ++step) {
    std::size_t far = 0;
    double best = -1;
    for (std::size_t i = 0; i < count; ++i) {
      const double d = (points[first[i]] - c).squaredNorm();
      if (d > best) best = d, far = i;
    }
    c += (points[first[far]] - c) / (step + 1.0);
  }
  // The radius is measured from the rounded centre, and rounded up.
  for (int a = 0; a < 3; ++a) out[a] = static_cast<float>(c[a]);
  const Eigen::Vector3d rounded(out[0], out[1], out[2]);
  double r2 = 0;
  for (std::size_t i = 0; i < count; ++i) {
    r2 = std::max(r2, (points[first[i]] - rounded).squaredNorm());
  }
  out[3] = static_cast<float>(std::sqrt(r2) * (1 + 1e-6) + 1e-9);
}

void pad(SphereLevel& level, float radius, float away) {
  while (level.x.size() % ProbeTree::kArity != 0) {
    level.x.push_back(away);
    level.y.push_back(away);
    level.z.push_back(away);
    level.r.push_back(radius);
  }
}

}  // namespace

ProbeTree buildProbeTree(const Points& points_T) {
  ProbeTree tree;
  const std::size_t n = points_T.size();
  tree.points = n;
  tree.order.resize(n);
  std::iota(tree.order.begin(), tree.order.end(), 0U);
  std::size_t unit = 1;
  while (unit < n) unit *= ProbeTree::kArity;
  arrange(points_T, tree.order.begin(), tree.order.end(), unit);
  for (const std::uint32_t i : tree.order) {
    tree.point.x.push_back(static_cast<float>(points_T[i].x()));
    tree.point.y.push_back(static_cast<float>(points_T[i].y()));
    tree.point.z.push_back(static_cast<float>(points_T[i].z()));
    tree.point.r.push_back(0.0f);
  }
  tree.point.count = n;
  pad(tree.point, 0.0f, 1e3f);
  for (std::size_t run = ProbeTree::kArity;; run *= ProbeTree::kArity) {
    SphereLevel level;
    for (std::size_t first = 0; first < n; first += run) {
      float sphere[4];
      enclose(points_T, &tree.order[first], std::min(run, n - first), sphere);
      level.x.push_back(sphere[0]);
      level.y.push_back(sphere[1]);
      level.z.push_back(sphere[2]);
      level.r.push_back(sphere[3]);
    }
    level.count = level.x.size();
    pad(level, -1e9f, 1e3f);
    level.block.resize(level.x.size() / ProbeTree::kArity);
    for (std::size_t i = 0; i < level.x.size(); ++i) {
      SphereBlock& block = level.block[i / ProbeTree::kArity];
      const std::size_t l = i % ProbeTree::kArity;
      block.x[l] = level.x[i];
      block.y[l] = level.y[i];
      block.z[l] = level.z[i];
      block.r[l] = level.r[i];
    }
    tree.level.push_back(std::move(level));
    if (tree.level.back().count <= ProbeTree::kArity) break;
  }
  tree.start = tree.level.size() - 1;
  while (tree.start > 0 && tree.level[tree.start - 1].count <= ProbeTree::kStart) --tree.start;
  tree.order.resize(tree.point.x.size(), 0);
  tree.leaf.resize(tree.point.x.size() / ProbeTree::kArity);
  for (std::size_t i = 0; i < tree.point.x.size(); ++i) {
    LeafPoints& leaf = tree.leaf[i / ProbeTree::kArity];
    leaf.x[i % ProbeTree::kArity] = tree.point.x[i];
    leaf.y[i % ProbeTree::kArity] = tree.point.y[i];
    leaf.z[i % ProbeTree::kArity] = tree.point.z[i];
    leaf.index[i % ProbeTree::kArity] = tree.order[i];
  }
  return tree;
}

}  // namespace palpate::bench
