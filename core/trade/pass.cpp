#include "core/trade/pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/geometry/units.h"
#include "core/simulation/simulation.h"

namespace palpate {
namespace {

// Half a voxel of a usual CT: inside the range that a pressed tool reaches for a moment.
constexpr double kPressed = 0.4e-3;
// A step's time is the median of so many: one that the system interrupted does not count.
constexpr std::size_t kRepeats = 3;

Eigen::Vector3d vector(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}

/// By nearest rank; 0 of nothing.
double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto rank = static_cast<std::size_t>(
      std::max(std::ceil(share * static_cast<double>(values.size())) - 1.0, 0.0));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank),
                   values.end());
  return values[rank];
}

double deepest(const std::vector<Contact>& contacts) {
  double depth = 0.0;
  for (const auto& contact : contacts) depth = std::max(depth, contact.depth);
  return depth;
}

Eigen::Vector3d meanNormal(const std::vector<Contact>& contacts) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& contact : contacts) sum += contact.depth * vector(contact.n);
  return sum;
}

/// How many of `ours` have none of `theirs` within `reach`.
std::uint64_t without(const std::vector<Contact>& ours, const std::vector<Contact>& theirs,
                      double reach) {
  std::uint64_t count = 0;
  for (const auto& mine : ours) {
    const bool met = std::any_of(theirs.begin(), theirs.end(), [&](const Contact& other) {
      return (vector(mine.p) - vector(other.p)).squaredNorm() <= reach * reach;
    });
    if (!met) ++count;
  }
  return count;
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

}  // namespace

Pass runPass(const std::shared_ptr<const PreparedScene>& scene,
             std::span<const DeviceSample> samples) {
  Pass pass;
  std::vector<std::array<double, kRepeats>> times(samples.size());
  for (std::size_t repeat = 0; repeat < kRepeats; ++repeat) {
    Simulation simulation(scene, CouplingGains{});
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const StepRecord& record = simulation.step(samples[i]);
      times[i][repeat] = record.micros;
      if (repeat > 0) continue;  // every repeat gives the same bits
      pass.tool.push_back(record.tool);
      pass.force_W.push_back(vector(simulation.tool().coupling.force));
    }
  }
  for (auto& row : times) {
    std::sort(row.begin(), row.end());
    pass.micros.push_back(row[kRepeats / 2]);
  }
  return pass;
}

void probe(const PreparedScene& scene, std::span<const Eigen::Isometry3d> probes, Pass& pass) {
  ContactFinder finder(*scene.tree, *scene.shell, scene.scene.setting.query);
  std::vector<Contact> buffer(scene.shell->size());
  const Eigen::Isometry3d X_VW = scene.X_WV.inverse();
  for (const auto& X_WT : probes) {
    const QueryResult found = finder.find(X_VW * X_WT, buffer);
    const auto count = std::min(found.contactCount, buffer.size());
    pass.probed.emplace_back(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(count));
  }
}

std::vector<Eigen::Isometry3d> probingPoses(const Pass& pass, std::span<const DeviceSample> samples,
                                            std::size_t stride) {
  std::vector<Eigen::Isometry3d> probes;
  for (std::size_t i = 0; i < pass.tool.size(); i += stride) {
    Eigen::Isometry3d X_WT = isometry(pass.tool[i]);
    const Eigen::Vector3d pull = position(samples[i].pose) - X_WT.translation();
    if (pull.norm() > 0.0) X_WT.translation() += std::min(1.0, kPressed / pull.norm()) * pull;
    probes.push_back(X_WT);
  }
  return probes;
}

void measure(const Pass& pass, const Pass& reference, double spacing, double referenceSpacing,
             TradePoint& point) {
  std::vector<double> force, depth, normal;
  for (std::size_t i = 0; i < pass.force_W.size(); ++i) {
    force.push_back((pass.force_W[i] - reference.force_W[i]).norm());
  }
  // Both shells cover the surface: a contact of one has a point of the other no farther than this.
  const double reach = spacing + referenceSpacing;
  for (std::size_t i = 0; i < pass.probed.size(); ++i) {
    const auto& ours = pass.probed[i];
    const auto& theirs = reference.probed[i];
    if (ours.empty() && theirs.empty()) continue;
    depth.push_back(millimetres(std::abs(deepest(ours) - deepest(theirs))));
    point.contactsMissed += without(theirs, ours, reach);
    point.contactsExtra += without(ours, theirs, reach);
    const Eigen::Vector3d a = meanNormal(ours), b = meanNormal(theirs);
    if (a.norm() > 0.0 && b.norm() > 0.0) normal.push_back(angle_deg(a, b));
  }
  point.forceErrorP95_N = percentile(force, 0.95);
  point.depthErrorP95_mm = percentile(depth, 0.95);
  point.normalErrorP95_deg = percentile(normal, 0.95);
  point.stepP50_us = percentile(pass.micros, 0.5);
  point.stepP99_us = percentile(pass.micros, 0.99);
  point.stepP999_us = percentile(pass.micros, 0.999);
}

}  // namespace palpate
