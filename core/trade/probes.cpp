#include "core/trade/probes.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/pose.h"

namespace palpate {
namespace {

// Half a voxel of a usual CT: inside the range that a pressed tool reaches for a moment.
constexpr double kPressed = 0.4e-3;

/// The points of a shell that are nearer to a shape than a margin, pose after pose. One that was
/// farther is not asked about again before it has moved as far as it was away.
class NearPoints {
 public:
  NearPoints(const PointShell& shell, const ReferenceShape& shape, double margin)
      : shell_(shell), shape_(shape), margin_(margin), far_(shell.size()) {}

  /// Calls `visit(index, p_W, distance)` in the order of indices.
  template <class Visit>
  void forEach(const Eigen::Isometry3d& X_WT, Visit&& visit) {
    for (std::size_t i = 0; i < far_.size(); ++i) {
      const Eigen::Vector3d p = X_WT * shell_.points_T()[i];
      Far& far = far_[i];
      if ((p - far.place).squaredNorm() < far.clearance * far.clearance) continue;
      far = {p, std::max(shape_.clearance(p, margin_), 0.0)};
      if (far.clearance > 0.0) continue;
      visit(i, p, shape_.distance(p));
    }
  }

 private:
  struct Far {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    double clearance = 0.0;
  };
  const PointShell& shell_;
  const ReferenceShape& shape_;
  double margin_;
  std::vector<Far> far_;
};

}  // namespace

std::vector<ProbedPose> probedPoses(const ReferenceRun& run, const Trajectory& trajectory,
                                    const PointShell& finest, const ReferenceShape& shape,
                                    std::size_t stride) {
  std::vector<ProbedPose> poses;
  for (std::size_t i = 0; i < run.tool.size(); i += stride) {
    ProbedPose pose;
    pose.X_WT = isometry(run.tool[i]);
    const Eigen::Vector3d pull = position(trajectory.samples[i].pose) - pose.X_WT.translation();
    if (pull.norm() < 0.1 * kPressed) continue;  // free: nothing to find
    pose.X_WT.translation() += std::min(1.0, kPressed / pull.norm()) * pull;
    poses.push_back(pose);
  }
  return probedWith(poses, finest, shape);
}

std::vector<ProbedPose> probedWith(std::span<const ProbedPose> poses, const PointShell& shell,
                                   const ReferenceShape& shape) {
  NearPoints near(shell, shape, 0.0);
  std::vector<ProbedPose> all;
  for (const ProbedPose& at : poses) {
    ProbedPose pose;
    pose.X_WT = at.X_WT;
    near.forEach(pose.X_WT, [&](std::size_t, const Eigen::Vector3d& p, double distance) {
      const double depth = -distance;
      if (!(depth > 0.0)) return;
      ++pose.inside;
      pose.deepest = std::max(pose.deepest, depth);
      pose.normal_W += depth * shape.normal(p);
    });
    all.push_back(pose);
  }
  return all;
}

std::vector<JudgedPose> judged(std::span<const ProbedPose> poses, const PointShell& shell,
                               const ReferenceShape& shape, double undecided) {
  NearPoints near(shell, shape, 2.0 * undecided);
  std::vector<JudgedPose> all;
  for (const ProbedPose& pose : poses) {
    JudgedPose judged;
    near.forEach(pose.X_WT, [&](std::size_t i, const Eigen::Vector3d&, double distance) {
      if (distance > undecided) return;
      auto& list = distance < -undecided ? judged.inside : judged.undecided;
      list.push_back(static_cast<std::uint32_t>(i));
    });
    all.push_back(std::move(judged));
  }
  return all;
}

double undecidedOf(const PreparedScene& scene) {
  return scene.labels->geometry.spacing.minCoeff() / 500.0;
}

}  // namespace palpate
