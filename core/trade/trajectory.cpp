#include "core/trade/trajectory.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <random>

#include "core/geometry/pose.h"
#include "core/session/replay.h"
#include "core/simulation/felt_voxels.h"
#include "core/simulation/fingerprint.h"

namespace palpate {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kServoPeriod = 1e-3;
constexpr double kAbove = 10e-3, kBelow = 1.5e-3, kReach = 8e-3;
constexpr double kApproach_s = 1.0, kRest_s = 0.3;
// Many short slides tell more of other motions than a long one.
constexpr double kDown_s = 0.4, kSlide_s = 0.5;

/// A pose in time, W.
using Path = std::function<Eigen::Isometry3d(double t)>;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// 0 to 1, without 1. The library's distributions differ between libraries.
  double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
  Eigen::Vector3d direction() {
    const double z = 2.0 * uniform() - 1.0, turn = 2.0 * kPi * uniform();
    const double r = std::sqrt(std::max(1.0 - z * z, 0.0));
    return {r * std::cos(turn), r * std::sin(turn), z};
  }

 private:
  std::mt19937_64 engine_;
};

std::vector<DeviceSample> sampled(const Path& path, double seconds) {
  const auto count = static_cast<std::uint64_t>(std::llround(seconds / kServoPeriod));
  std::vector<DeviceSample> samples(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    DeviceSample& sample = samples[i];
    sample.index = i;
    sample.t = static_cast<double>(i) * kServoPeriod;
    const double before = std::max(sample.t - 0.5 * kServoPeriod, 0.0);
    const double after = sample.t + 0.5 * kServoPeriod;
    const Eigen::Isometry3d at = path(sample.t), from = path(before), to = path(after);
    sample.pose = plain(at.translation(), Eigen::Quaterniond(at.linear()).normalized());
    const Eigen::Vector3d v = (to.translation() - from.translation()) / (after - before);
    const Eigen::Vector3d w =
        logMap(Eigen::Quaterniond(to.linear()) * Eigen::Quaterniond(from.linear()).conjugate()) /
        (after - before);
    for (int axis = 0; axis < 3; ++axis) {
      sample.v[axis] = v[axis];
      sample.w[axis] = w[axis];
    }
  }
  return samples;
}

/// From 0 to 1 and at rest at both ends, so that neither makes a jump of velocity.
double eased(double part) {
  return 0.5 - 0.5 * std::cos(kPi * std::clamp(part, 0.0, 1.0));
}

/// Tip first, as the built-in hand holds it: the shaft along +y of D, tilted 30 degrees to +z.
Eigen::Quaterniond grip_D() {
  return Eigen::Quaterniond(Eigen::AngleAxisd(-kPi / 3.0, Eigen::Vector3d::UnitX()));
}

Path overTheDevice(const PreparedScene& scene, double down_s, double heading, double rate) {
  const Eigen::Isometry3d X_WD = scene.X_WD;
  return [X_WD, down_s, heading, rate](double t) {
    const double y = kAbove - (kAbove + kBelow) * eased(t / down_s);
    // Sums of (1 - cos): the slide, too, begins at rest.
    const double slide = std::max(t - down_s, 0.0);
    const double along = 0.5 * kReach * (1.0 - std::cos(2.0 * kPi * rate * slide));
    const double across = 0.25 * kReach * (1.0 - std::cos(4.0 * kPi * rate * slide));
    Eigen::Isometry3d X_DT(grip_D());
    X_DT.translation() = Eigen::Vector3d(along * std::cos(heading) - across * std::sin(heading), y,
                                         along * std::sin(heading) + across * std::cos(heading));
    return Eigen::Isometry3d(X_WD * X_DT);
  };
}

std::optional<Eigen::Vector3d> directionOf(Random& random, const Surround& surround) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const Eigen::Vector3d direction = random.direction();
    if (direction.dot(surround.up_W) >= surround.leastCosine) return direction;
  }
  return std::nullopt;
}

/// +z of T, the shaft, along `out`; the rest is turned by `roll`.
Eigen::Isometry3d tipFirst(const Eigen::Vector3d& tip, const Eigen::Vector3d& out, double roll) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = (Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), out) *
                Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
                   .toRotationMatrix();
  X.translation() = tip;
  return X;
}

/// Where the tip is when the tool, on its way in from outside, first touches.
std::optional<Eigen::Vector3d> firstTouch(const ReferenceShape& shape, const Surround& surround,
                                          const Eigen::Vector3d& direction, double roll,
                                          const Eigen::Vector3d& towards) {
  constexpr double kLeastStep = 0.1e-3, kFarStep = 1e-3;
  const Eigen::Matrix3d R = tipFirst(towards, direction, roll).linear();
  for (double s = surround.radius + kAbove; s > -surround.radius;) {
    const Eigen::Vector3d tip = towards + s * direction;
    double free = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& p_T : surround.points_T) {
      free = std::min(free, shape.distance(tip + R * p_T));
      if (free < 0.0) return tip;
    }
    s -= std::isfinite(free) ? std::max(kLeastStep, 0.5 * free) : kFarStep;
  }
  return std::nullopt;
}

/// Of 26 directions, how many meet anatomy within 8 mm of a place just outside the surface.
int enclosure(const ReferenceShape& shape, const Eigen::Vector3d& p) {
  int met = 0;
  for (int code = 0; code < 27; ++code) {
    const Eigen::Vector3d d(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1);
    if (d.isZero()) continue;
    bool hit = false;
    for (double s = 1e-3; s <= 8e-3 && !hit; s += 1e-3)
      hit = shape.distance(p + s * d.normalized()) < 0.0;
    met += hit ? 1 : 0;
  }
  return met;
}

/// A way in from outside.
struct Way {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ(), towards = Eigen::Vector3d::Zero();
  int enclosure = -1;  ///< Of where it ends.
};

struct Enclosed {
  Way way;
  Eigen::Vector3d site = Eigen::Vector3d::Zero();  ///< Of the tip.
};

/// Where the tool gets to on a way, and how enclosed that is.
std::optional<Enclosed> along(const ReferenceShape& shape, const Surround& surround, Way way) {
  const auto touch = firstTouch(shape, surround, way.direction, 0.0, way.towards);
  if (!touch) return std::nullopt;
  way.enclosure = enclosure(shape, *touch + 1e-3 * way.direction);
  return Enclosed{way, *touch};
}

/// Of random ways, the one that ends in the most enclosed place: the tip alone tells which are
/// worth the whole tool, which has no room everywhere.
std::optional<Enclosed> mostEnclosed(const ReferenceShape& shape, const Surround& surround,
                                     std::uint64_t seed) {
  constexpr int kWays = 100;
  constexpr std::size_t kTried = 12;
  Random random(seed);
  Surround tip = surround;
  tip.points_T = {Eigen::Vector3d::Zero()};
  std::vector<Way> ways;
  for (int i = 0; i < kWays; ++i) {
    const auto direction = directionOf(random, surround);
    if (!direction) break;
    const Eigen::Vector3d aside = 0.4 * surround.radius * random.uniform() * random.direction();
    const auto found = along(shape, tip, {*direction, surround.centre_W + aside, -1});
    if (found) ways.push_back(found->way);
  }
  std::stable_sort(ways.begin(), ways.end(),
                   [](const Way& a, const Way& b) { return a.enclosure > b.enclosure; });
  std::optional<Enclosed> best;
  for (std::size_t i = 0; i < std::min(kTried, ways.size()); ++i) {
    const auto found = along(shape, surround, ways[i]);
    if (found && (!best || found->way.enclosure > best->way.enclosure)) best = found;
  }
  return best;
}

}  // namespace

Surround surroundOf(const PreparedScene& scene) {
  const LabelGrid& grid = *scene.labels;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  Eigen::AlignedBox3d box;
  forEachFelt(grid, feltLabelsOf(scene), [&](std::size_t, auto i, auto j, auto k) {
    const Eigen::Vector3d p_V = grid.geometry.centre_V(i, j, k);
    sum += p_V;
    count += 1.0;
    box.extend(p_V);
  });
  Surround surround;
  if (count == 0.0) return surround;
  surround.centre_W = scene.X_WV * (sum / count);
  surround.radius = 0.5 * box.diagonal().norm() + (sum / count - box.center()).norm();
  surround.up_W = scene.X_WD.linear().col(1);
  constexpr std::size_t kPoints = 150;
  const auto points = scene.shell->points_T();
  surround.points_T.clear();
  for (std::size_t i = 0; i < points.size(); i += points.size() / kPoints + 1) {
    surround.points_T.push_back(points[i]);
  }
  return surround;
}

Trajectory approachPath(const PreparedScene& scene) {
  Trajectory path{"approach", {}, 0, true};
  // The slide's sums stand still where the rate is zero.
  path.samples = sampled(overTheDevice(scene, kApproach_s, 0.0, 0.0), kApproach_s + kRest_s);
  path.restFrom = static_cast<std::size_t>(std::llround(kApproach_s / kServoPeriod));
  return path;
}

Trajectory slidePath(const PreparedScene& scene, std::uint64_t seed) {
  Random random(seed);
  const double heading = 2.0 * kPi * random.uniform();
  const double rate = 0.8 + 0.4 * random.uniform();
  Trajectory path{"slide " + std::to_string(seed), {}, 0, true};
  path.samples = sampled(overTheDevice(scene, kDown_s, heading, rate), kDown_s + kSlide_s);
  path.restFrom = path.samples.size();
  return path;
}

Trajectory cavityPath(const ReferenceShape& shape, const Surround& surround, std::uint64_t seed) {
  constexpr double kRound = 1.5e-3, kTilt = kPi / 18.0, kRound_s = 0.5, kIn_s = 0.3;
  const auto found = mostEnclosed(shape, surround, seed);
  Trajectory path{"cavity " + std::to_string(seed), {}, 0, true};
  if (!found) return path;
  const Eigen::Vector3d site = found->site, out = found->way.direction;
  const Eigen::Vector3d u = out.unitOrthogonal(), v = out.cross(u);
  path.samples = sampled(
      [=](double t) {
        const double height = kReach - (kReach + kBelow) * eased(t / kIn_s);
        const double turn = 2.0 * kPi * eased((t - kIn_s) / kRound_s);
        const Eigen::Vector3d around = kRound * (std::sin(turn) * u + (1.0 - std::cos(turn)) * v);
        const Eigen::Vector3d leaning = Eigen::AngleAxisd(kTilt * std::sin(turn), u) * out;
        return tipFirst(site + height * out + around, leaning, 0.0);
      },
      kIn_s + kRound_s);
  path.restFrom = path.samples.size();
  return path;
}

Trajectory randomPath(const ReferenceShape& shape, const Surround& surround, std::uint64_t seed) {
  constexpr double kSpeed = 50e-3, kStill_s = 0.1;
  Random random(seed);
  Trajectory path{"random " + std::to_string(seed), {}, 0, false};
  const auto direction = directionOf(random, surround);
  const double roll = 2.0 * kPi * random.uniform();
  const auto touch =
      direction ? firstTouch(shape, surround, *direction, roll, surround.centre_W) : std::nullopt;
  if (!touch) return path;
  const double moving_s = (kReach + kBelow) / kSpeed;
  path.samples = sampled(
      [&](double t) {
        const double height = kReach - kSpeed * std::min(t, moving_s);
        return tipFirst(*touch + height * *direction, *direction, roll);
      },
      moving_s + kStill_s);
  path.restFrom = static_cast<std::size_t>(std::ceil(moving_s / kServoPeriod));
  return path;
}

Result<Trajectory> sessionPath(const std::filesystem::path& file) {
  const auto recorded = readSamples(file);
  if (!recorded) return fail(recorded.error());
  Trajectory path{file.stem().string(), {}, 0, false};
  for (const ServoSample& sample : *recorded) {
    path.samples.push_back(sample.device);
    path.samples.back().index = path.samples.size() - 1;  // from 0, however late it was begun
  }
  path.restFrom = path.samples.size();
  return path;
}

}  // namespace palpate
