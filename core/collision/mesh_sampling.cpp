#include "core/collision/mesh_sampling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace palpate {
namespace {

using Triangle = std::array<Eigen::Vector3d, 3>;

constexpr double kEdgeShare = 0.375;     // longest edge of a sliver, in spacings
constexpr double kSeparation = 0.75;     // between samples of one side, in spacings
constexpr double kMaxCandidates = 20e6;  // beyond it is a mistake in units

// Samples in cells of the separation's size: only 27 cells can hold one that is near.
class SampleGrid {
 public:
  SampleGrid(SurfaceSamples& samples, double separation)
      : samples_(samples), separation_(separation) {}

  void offer(const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    const std::array<std::int64_t, 3> cell = cellOf(p);
    for (std::int64_t z = -1; z <= 1; ++z) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t x = -1; x <= 1; ++x) {
          if (taken({cell[0] + x, cell[1] + y, cell[2] + z}, p, n)) return;
        }
      }
    }
    const auto index = static_cast<std::uint32_t>(samples_.points.size());
    samples_.points.push_back(p);
    samples_.normals.push_back(n);
    const auto [at, fresh] = first_.try_emplace(keyOf(cell), index);
    next_.push_back(fresh ? kEnd : at->second);
    at->second = index;
  }

 private:
  static constexpr std::uint32_t kEnd = 0xFFFFFFFF;

  [[nodiscard]] std::array<std::int64_t, 3> cellOf(const Eigen::Vector3d& p) const {
    return {static_cast<std::int64_t>(std::floor(p.x() / separation_)),
            static_cast<std::int64_t>(std::floor(p.y() / separation_)),
            static_cast<std::int64_t>(std::floor(p.z() / separation_))};
  }
  // Two cells may share a key: their samples are then looked at in vain, never missed.
  [[nodiscard]] static std::uint64_t keyOf(const std::array<std::int64_t, 3>& c) {
    return static_cast<std::uint64_t>(c[0]) * 0x9E3779B97F4A7C15ULL ^
           static_cast<std::uint64_t>(c[1]) * 0xC2B2AE3D27D4EB4FULL ^
           static_cast<std::uint64_t>(c[2]) * 0x165667B19E3779F9ULL;
  }
  [[nodiscard]] bool taken(const std::array<std::int64_t, 3>& cell, const Eigen::Vector3d& p,
                           const Eigen::Vector3d& n) const {
    const auto at = first_.find(keyOf(cell));
    if (at == first_.end()) return false;
    for (std::uint32_t i = at->second; i != kEnd; i = next_[i]) {
      if ((samples_.points[i] - p).squaredNorm() < separation_ * separation_ &&
          samples_.normals[i].dot(n) > 0.0) {
        return true;
      }
    }
    return false;
  }

  SurfaceSamples& samples_;
  double separation_;
  std::unordered_map<std::uint64_t, std::uint32_t> first_;
  std::vector<std::uint32_t> next_;
};

// Halves the longest edge until it is short enough, then offers the centroid.
void cut(const Triangle& face, const Eigen::Vector3d& normal, double longest, SampleGrid& grid) {
  std::vector<Triangle> stack{face};
  while (!stack.empty()) {
    const Triangle t = stack.back();
    stack.pop_back();
    std::size_t worst = 0;
    for (std::size_t e = 1; e < 3; ++e) {
      if ((t[(e + 1) % 3] - t[e]).squaredNorm() > (t[(worst + 1) % 3] - t[worst]).squaredNorm()) {
        worst = e;
      }
    }
    const Eigen::Vector3d& a = t[worst];
    const Eigen::Vector3d& b = t[(worst + 1) % 3];
    const Eigen::Vector3d& c = t[(worst + 2) % 3];
    if ((b - a).norm() <= longest) {
      grid.offer((a + b + c) / 3.0, normal);
      continue;
    }
    const Eigen::Vector3d middle = 0.5 * (a + b);
    stack.push_back({middle, b, c});
    stack.push_back({a, middle, c});
  }
}

Error meshRefused(std::string message, std::string advice) {
  return inputRefused(std::move(message)).inField("mesh").advise(std::move(advice));
}

Result<void> check(const TriangleMesh& mesh, double spacing) {
  if (!std::isfinite(spacing) || spacing <= 0.0) {
    return fail(inputRefused("The spacing of the shell's points is not a positive length.")
                    .inField("spacing")
                    .butFound(std::to_string(spacing))
                    .wants("metres, above 0"));
  }
  if (mesh.triangles.empty()) {
    return fail(meshRefused("The mesh has no triangles.", "Give a closed triangle mesh."));
  }
  for (const auto& v : mesh.vertices) {
    if (!v.allFinite()) {
      return fail(meshRefused("The mesh has a vertex that is not finite.", "Repair the mesh."));
    }
  }
  for (const auto& t : mesh.triangles) {
    if (*std::max_element(t.begin(), t.end()) >= mesh.vertices.size()) {
      return fail(
          meshRefused("A triangle of the mesh names a vertex that is not there.", "Repair it."));
    }
  }
  if (!isClosed(mesh)) {
    return fail(meshRefused("The mesh is not closed, so it has no outside.",
                            "Close its holes, and join vertices that coincide."));
  }
  if (signedVolume(mesh) <= 0.0) {
    return fail(meshRefused("The triangles of the mesh face inwards.", "Flip the mesh."));
  }
  return {};
}

}  // namespace

Result<SurfaceSamples> sampleSurface(const TriangleMesh& mesh, double spacing) {
  if (auto ok = check(mesh, spacing); !ok) return fail(ok.error());
  const double longest = kEdgeShare * spacing;
  double slivers = 0.0;  // an estimate: halving leaves areas of a quarter of longest² and more
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d& a = mesh.vertices[t[0]];
    slivers += 1.0 + 2.0 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm() /
                         (longest * longest);
  }
  if (slivers > kMaxCandidates) {
    return fail(inputRefused("The spacing of the shell's points is too small for this mesh.")
                    .inField("spacing")
                    .butFound(std::to_string(spacing) + " m")
                    .advise("Choose a larger spacing."));
  }
  SurfaceSamples samples;
  SampleGrid grid(samples, kSeparation * spacing);
  for (const auto& t : mesh.triangles) {
    const Triangle face{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    const Eigen::Vector3d twiceArea = (face[1] - face[0]).cross(face[2] - face[0]);
    const double length = twiceArea.norm();
    if (length <= 0.0) continue;  // no area, nothing to cover that its neighbours do not
    cut(face, twiceArea / length, longest, grid);
  }
  return samples;
}

}  // namespace palpate
