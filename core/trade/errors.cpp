#include "core/trade/errors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/geometry/units.h"
#include "core/trade/promise.h"

namespace palpate {
namespace {

constexpr double kTouch_N = 0.05;    // what a hand begins to feel, about
constexpr double kFree_N = 0.01;     // below: free motion
constexpr std::size_t kWindow = 10;  // ticks on either side of the mean that ripple is judged by
constexpr std::size_t kStill = 20;   // ticks at the end that tell where the tool rests

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

std::vector<double> pooled(const std::vector<std::vector<double>>& motions) {
  std::vector<double> all;
  for (const auto& motion : motions) all.insert(all.end(), motion.begin(), motion.end());
  return all;
}

std::optional<std::size_t> onsetOf(const Felt& felt) {
  for (std::size_t i = 0; i < felt.force_W.size(); ++i) {
    if (felt.force_W[i].norm() > kTouch_N) return i;
  }
  return std::nullopt;
}

}  // namespace

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto rank = static_cast<std::size_t>(
      std::max(std::ceil(share * static_cast<double>(values.size())) - 1.0, 0.0));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank),
                   values.end());
  return values[rank];
}

Spread spreadOf(std::vector<double> values) {
  if (values.empty()) return {};
  const double worst = *std::max_element(values.begin(), values.end());
  return {percentile(values, 0.5), percentile(values, 0.95), worst};
}

void ErrorSamples::addFelt(const Trajectory& trajectory, const Felt& felt, const Felt& reference) {
  const std::size_t count = std::min(felt.force_W.size(), reference.force_W.size());
  force_.emplace_back();
  for (std::size_t i = 0; i < count; ++i) {
    if (felt.force_W[i].norm() < kFree_N && reference.force_W[i].norm() < kFree_N) continue;
    force_.back().push_back((felt.force_W[i] - reference.force_W[i]).norm());
    torque_.push_back(1e3 * (felt.torque_W[i] - reference.torque_W[i]).norm());
  }
  for (std::size_t i = kWindow; trajectory.smooth && i + kWindow < count; ++i) {
    if (felt.force_W[i].norm() < kFree_N) continue;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t j = i - kWindow; j <= i + kWindow; ++j) mean += felt.force_W[j];
    mean /= 2.0 * kWindow + 1.0;
    ripple_.push_back((felt.force_W[i] - mean).norm());
    jump_.push_back((felt.force_W[i] - felt.force_W[i - 1]).norm());
  }
  if (trajectory.restFrom + kStill < count) {
    double sum = 0.0;
    for (std::size_t i = count - kStill; i < count; ++i) {
      sum += (felt.tool_W[i] - reference.tool_W[i]).norm();
    }
    rest_.push_back(millimetres(sum / kStill));
  }
  const auto ours = onsetOf(felt), theirs = onsetOf(reference);
  if (!ours && !theirs) return;
  const auto at = [count](const std::optional<std::size_t>& tick) {
    return static_cast<double>(tick.value_or(count));
  };
  onset_.push_back(std::abs(at(ours) - at(theirs)));
}

void ErrorSamples::addPose(const ProbedPose& pose, double deepest,
                           const Eigen::Vector3d& normal_W) {
  if (deepest == 0.0 && pose.deepest == 0.0) return;
  depth_.back().push_back(millimetres(std::abs(deepest - pose.deepest)));
  if (normal_W.norm() > 0.0 && pose.normal_W.norm() > 0.0) {
    normal_.push_back(angle_deg(normal_W, pose.normal_W));
  }
}

void ErrorSamples::addContacts(const PreparedScene& scene, std::span<const ProbedPose> poses,
                               std::span<const JudgedPose> judged) {
  ContactFinder finder(*scene.tree, *scene.shell, scene.scene.setting.query);
  std::vector<Contact> buffer(scene.shell->size());
  const Eigen::Isometry3d X_VW = scene.X_WV.inverse();
  std::vector<bool> found(scene.shell->size());
  depth_.emplace_back();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const QueryResult result = finder.find(X_VW * poses[i].X_WT, buffer);
    const std::size_t count = std::min(result.contactCount, buffer.size());
    std::fill(found.begin(), found.end(), false);
    double deepest = 0.0;
    Eigen::Vector3d normal_W = Eigen::Vector3d::Zero();
    for (std::size_t c = 0; c < count; ++c) {
      const Contact& contact = buffer[c];
      found[contact.shellIndex] = true;
      deepest = std::max(deepest, contact.depth);
      normal_W +=
          contact.depth * (scene.X_WV.linear() * Eigen::Map<const Eigen::Vector3d>(contact.n));
    }
    addPoints(found, judged[i]);
    addPose(poses[i], deepest, normal_W);
  }
}

void ErrorSamples::addPoints(std::vector<bool>& found, const JudgedPose& judged) {
  reference_ += judged.inside.size();
  for (const std::uint32_t point : judged.inside) {
    missed_ += found[point] ? 0 : 1;
    found[point] = false;
  }
  for (const std::uint32_t point : judged.undecided) found[point] = false;
  extra_ += static_cast<std::uint64_t>(std::count(found.begin(), found.end(), true));
}

void ErrorSamples::addReferenceContacts(std::span<const ProbedPose> poses,
                                        std::span<const ProbedPose> found) {
  depth_.emplace_back();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    reference_ += found[i].inside;
    addPose(poses[i], found[i].deepest, found[i].normal_W);
  }
}

TradeErrors ErrorSamples::errors() const {
  TradeErrors errors;
  errors.force_N = spreadOf(pooled(force_));
  errors.torque_Nmm = spreadOf(torque_);
  errors.depth_mm = spreadOf(pooled(depth_));
  errors.normal_deg = spreadOf(normal_);
  errors.missed = missed_;
  errors.extra = extra_;
  errors.reference = reference_;
  errors.ripple_N = spreadOf(ripple_);
  errors.jump_N_per_ms = spreadOf(jump_);
  errors.rest_mm = spreadOf(rest_);
  errors.onset_ms = spreadOf(onset_);
  return errors;
}

double ErrorSamples::promisedForce() const {
  return boundOf(force_, 0.95);
}

double ErrorSamples::promisedDepth() const {
  return boundOf(depth_, 0.95);
}

}  // namespace palpate
