#include "core/trade/tradeoff.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "core/geometry/units.h"
#include "core/trade/pass.h"
#include "core/trade/trajectory.h"

namespace palpate {
namespace {

// Every 10th step is probed: a slide moves less than half a voxel in that time.
constexpr std::size_t kProbeStride = 10;

std::string format(const char* text, double value) {
  std::array<char, 48> buffer{};
  std::snprintf(buffer.data(), buffer.size(), text, value);
  return buffer.data();
}

double spacingOf(const PreparedScene& base, const SimulationSetting& setting) {
  return setting.shellSpacing > 0.0 ? setting.shellSpacing : base.instrument.shellSpacing;
}

TradePoint named(std::string name, const SimulationSetting& setting) {
  TradePoint point;
  point.name = std::move(name);
  point.setting = setting;
  return point;
}

/// The reference, the scene's own setting, and each single change of it.
std::vector<TradePoint> candidates(const PreparedScene& base) {
  const SimulationSetting own = base.scene.setting;
  const double spacing = spacingOf(base, own);
  std::vector<TradePoint> points;
  SimulationSetting reference = own;
  reference.tree = TreeOptions{own.tree.branching, LeafModel::Distance, false};
  reference.query = QueryOptions{};
  reference.query.method = QueryMethod::BruteForce;
  reference.shellSpacing = 0.5 * spacing;
  reference.contactCapacity = std::max<std::uint32_t>(own.contactCapacity, 100000);
  points.push_back(named("reference", reference));
  points.push_back(named("default", own));
  const auto change = [&points, &own](std::string name, auto&& edit) {
    SimulationSetting setting = own;
    edit(setting);
    points.push_back(named(std::move(name), setting));
  };
  for (const Branching branching :
       {Branching::Children8, Branching::Children64, Branching::Children512}) {
    if (branching == own.tree.branching) continue;
    change("branching=" + std::to_string(static_cast<int>(branching)),
           [branching](SimulationSetting& s) { s.tree.branching = branching; });
  }
  const bool distance = own.tree.leaf == LeafModel::Distance;
  change(distance ? "leaf=voxel" : "leaf=distance", [distance](SimulationSetting& s) {
    s.tree.leaf = distance ? LeafModel::Voxel : LeafModel::Distance;
  });
  for (const double factor : {2.0, 4.0}) {
    change(format("shell=%.2fmm", millimetres(factor * spacing)),
           [&](SimulationSetting& s) { s.shellSpacing = factor * spacing; });
  }
  change(own.query.tightSpheres ? "tight-spheres=off" : "tight-spheres=on",
         [](SimulationSetting& s) { s.query.tightSpheres = !s.query.tightSpheres; });
  change(own.query.oneChildSkip ? "one-child-skip=off" : "one-child-skip=on",
         [](SimulationSetting& s) { s.query.oneChildSkip = !s.query.oneChildSkip; });
  change(own.query.sideOffset ? "side-offset=off" : "side-offset=on",
         [](SimulationSetting& s) { s.query.sideOffset = !s.query.sideOffset; });
  change("method=paper", [](SimulationSetting& s) { s.query.method = QueryMethod::Paper; });
  change("stop-level=1", [](SimulationSetting& s) { s.query.stopLevel = 1; });
  change("surface-only", [](SimulationSetting& s) { s.tree.surfaceOnly = true; });
  return points;
}

bool sameTree(const TreeOptions& a, const TreeOptions& b) {
  return a.branching == b.branching && a.leaf == b.leaf && a.surfaceOnly == b.surfaceOnly;
}

/// The base at another setting. Trees that the sweep has built are used again.
class Variants {
 public:
  explicit Variants(const PreparedScene& base) : base_(base) {
    const auto values = feltValues();
    trees_.push_back(base.tree);
    felt_.assign(values.begin(), values.end());
  }

  Result<std::shared_ptr<const PreparedScene>> at(const SimulationSetting& setting) {
    auto variant = std::make_shared<PreparedScene>(base_);
    variant->scene.setting = setting;
    auto tree = treeOf(setting.tree);
    if (!tree) return fail(tree.error());
    variant->tree = *tree;
    auto shell = PointShell::fromMesh(base_.instrument.mesh_T, spacingOf(base_, setting));
    if (!shell) return fail(shell.error());
    variant->shell = std::make_shared<const PointShell>(std::move(*shell));
    return std::shared_ptr<const PreparedScene>(std::move(variant));
  }

 private:
  [[nodiscard]] std::vector<std::uint8_t> feltValues() const {
    std::vector<std::uint8_t> values;
    for (const auto& name : base_.scene.labels) {
      for (const auto& label : base_.table) {
        if (label.name == name) values.push_back(label.value);
      }
    }
    return values;  // none: all, as the tree's builder takes it
  }
  Result<std::shared_ptr<const VoxelTree>> treeOf(const TreeOptions& options) {
    for (const auto& tree : trees_) {
      if (sameTree(tree->options(), options)) return tree;
    }
    auto built = VoxelTree::build(*base_.labels, felt_, options);
    if (!built) return fail(built.error());
    trees_.push_back(std::make_shared<const VoxelTree>(std::move(*built)));
    return trees_.back();
  }

  const PreparedScene& base_;
  std::vector<std::uint8_t> felt_;
  std::vector<std::shared_ptr<const VoxelTree>> trees_;
};

std::size_t bytesOf(const PreparedScene& scene) {
  const TreeStats& stats = scene.tree->stats();
  return stats.topologyBytes + stats.payloadBytes +
         scene.shell->size() * 2 * sizeof(Eigen::Vector3d);
}

/// Nobody else is at least as good in error, time and memory, and better in one of them.
void markFront(std::vector<TradePoint>& points) {
  const auto beats = [](const TradePoint& a, const TradePoint& b) {
    const bool noWorse = a.forceErrorP95_N <= b.forceErrorP95_N && a.stepP999_us <= b.stepP999_us &&
                         a.bytes <= b.bytes;
    return noWorse && (a.forceErrorP95_N < b.forceErrorP95_N || a.stepP999_us < b.stepP999_us ||
                       a.bytes < b.bytes);
  };
  for (auto& point : points) {
    point.onFront = std::none_of(points.begin(), points.end(),
                                 [&](const TradePoint& other) { return beats(other, point); });
  }
}

}  // namespace

Result<std::vector<TradePoint>> sweepTrade(const PreparedScene& base, std::uint64_t seed,
                                           const Progress& progress) {
  auto points = candidates(base);
  Variants variants(base);
  const auto samples = approachAndSlide(base, seed);
  const double referenceSpacing = spacingOf(base, points.front().setting);
  std::optional<Pass> reference;
  std::vector<Eigen::Isometry3d> probes;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (progress.cancelled()) return fail(cancelled());
    progress(static_cast<double>(i) / static_cast<double>(points.size()),
             "Measuring " + points[i].name);
    const auto variant = variants.at(points[i].setting);
    if (!variant) return fail(variant.error());
    Pass pass = runPass(*variant, samples);
    if (!reference) probes = probingPoses(pass, samples, kProbeStride);
    probe(**variant, probes, pass);
    if (!reference) reference = pass;
    measure(pass, *reference, spacingOf(base, points[i].setting), referenceSpacing, points[i]);
    points[i].bytes = bytesOf(**variant);
  }
  markFront(points);
  progress(1.0, "Measured");
  return points;
}

Result<TradePoint> chooseSetting(const std::vector<TradePoint>& points, double deadline_s,
                                 double headroom) {
  if (!(deadline_s > 0.0) || !std::isfinite(deadline_s)) {
    return fail(usageError("A deadline is a time above zero.").inField("deadline"));
  }
  if (!(headroom > 0.0 && headroom <= 1.0)) {
    return fail(usageError("The headroom is the share of the deadline that a step may use.")
                    .inField("headroom")
                    .wants("above 0, at most 1"));
  }
  const double most_us = headroom * deadline_s * 1e6;
  const TradePoint* best = nullptr;
  const TradePoint* fastest = nullptr;
  for (const auto& point : points) {
    if (fastest == nullptr || point.stepP999_us < fastest->stepP999_us) fastest = &point;
    if (point.stepP999_us > most_us) continue;
    const bool better =
        best == nullptr || point.forceErrorP95_N < best->forceErrorP95_N ||
        (point.forceErrorP95_N == best->forceErrorP95_N && point.stepP999_us < best->stepP999_us);
    if (better) best = &point;
  }
  if (best != nullptr) return *best;
  Error error = checkFailed("No measured setting fits the deadline.")
                    .inField("deadline")
                    .wants(format("a step of at most %.1f us at p99.9", most_us))
                    .advise("Allow a longer deadline, or a coarser instrument shell.");
  if (fastest != nullptr) {
    error.butFound(format("%.1f us, with ", fastest->stepP999_us) + fastest->name);
  }
  return fail(std::move(error));
}

}  // namespace palpate
