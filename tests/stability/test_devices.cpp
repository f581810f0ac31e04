#include "tests/stability/test_devices.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "core/devices/random.h"

namespace palpate::stability {
namespace {

/// Velocities from poses, as a driver gives them.
class VelocityFilter {
 public:
  explicit VelocityFilter(double period)
      : period_(period), a_(1.0 - std::exp(-2.0 * std::numbers::pi * 100.0 * period)) {}
  void apply(DeviceSample& s) noexcept {
    if (!started_) last_ = s.pose;
    started_ = true;
    const Eigen::Vector3d dx = position(s.pose) - position(last_);
    const Eigen::Vector3d turn = logMap(orientation(s.pose) * orientation(last_).conjugate());
    for (int i = 0; i < 3; ++i) {
      v_[i] += a_ * (dx[i] / period_ - v_[i]);
      w_[i] += a_ * (turn[i] / period_ - w_[i]);
      s.v[i] = v_[i];
      s.w[i] = w_[i];
    }
    last_ = s.pose;
  }

 private:
  double period_, a_;
  PlainPose last_;
  Eigen::Vector3d v_ = Eigen::Vector3d::Zero(), w_ = Eigen::Vector3d::Zero();
  bool started_ = false;
};

class Puppet final : public HapticDevice {
 public:
  Puppet(DeviceInfo info, Path path, double period)
      : info_(std::move(info)), path_(std::move(path)), period_(period), filter_(period) {}
  const DeviceInfo& info() const noexcept override { return info_; }
  Result<void> open() override { return {}; }
  void close() noexcept override {}
  DeviceSample read(std::uint64_t tick) noexcept override {
    DeviceSample s;
    s.pose = path_(static_cast<double>(tick) * period_);
    s.buttons = 1;
    filter_.apply(s);
    return s;
  }
  void write(const Wrench&) noexcept override {}

 private:
  DeviceInfo info_;
  Path path_;
  double period_;
  VelocityFilter filter_;
};

/// Another device, with something done to what it reads.
class Wrapped final : public HapticDevice {
 public:
  using Change = std::function<void(std::uint64_t tick, DeviceSample&)>;
  Wrapped(std::unique_ptr<HapticDevice> device, Change change)
      : device_(std::move(device)), change_(std::move(change)) {}
  const DeviceInfo& info() const noexcept override { return device_->info(); }
  Result<void> open() override { return device_->open(); }
  void close() noexcept override { device_->close(); }
  DeviceSample read(std::uint64_t tick) noexcept override {
    DeviceSample s = device_->read(tick);
    change_(tick, s);
    return s;
  }
  void write(const Wrench& w) noexcept override { device_->write(w); }

 private:
  std::unique_ptr<HapticDevice> device_;
  Change change_;
};

}  // namespace

std::unique_ptr<HapticDevice> makePuppet(const DeviceInfo& info, Path path, double period) {
  return std::make_unique<Puppet>(info, std::move(path), period);
}

std::unique_ptr<HapticDevice> dropping(std::unique_ptr<HapticDevice> device, double share,
                                       std::uint64_t seed) {
  return std::make_unique<Wrapped>(std::move(device),
                                   [share, random = Random(seed), last = DeviceSample()](
                                       std::uint64_t tick, DeviceSample& s) mutable {
                                     if (tick > 0 && random.uniform(0.0, 1.0) < share) {
                                       s = last;
                                     }
                                     last = s;
                                   });
}

std::unique_ptr<HapticDevice> jittering(std::unique_ptr<HapticDevice> device, double period,
                                        std::uint64_t seed) {
  return std::make_unique<Wrapped>(
      std::move(device), [random = Random(seed), filter = VelocityFilter(period),
                          last = DeviceSample()](std::uint64_t tick, DeviceSample& s) mutable {
        const DeviceSample now = s;
        const double f = random.uniform(0.0, 1.0);
        if (tick > 0) {
          const Eigen::Vector3d p = (1 - f) * position(last.pose) + f * position(now.pose);
          s.pose = plain(p, orientation(last.pose).slerp(f, orientation(now.pose)).normalized());
        }
        last = now;
        filter.apply(s);
      });
}

std::unique_ptr<HapticDevice> coarser(std::unique_ptr<HapticDevice> device, double step,
                                      double period) {
  return std::make_unique<Wrapped>(std::move(device), [step, filter = VelocityFilter(period)](
                                                          std::uint64_t, DeviceSample& s) mutable {
    for (double& x : s.pose.p) x = step * std::round(x / step);
    filter.apply(s);
  });
}

std::unique_ptr<HapticDevice> spoiling(std::unique_ptr<HapticDevice> device, std::uint64_t tick,
                                       std::function<void(DeviceSample&)> spoil) {
  return std::make_unique<Wrapped>(
      std::move(device), [tick, spoil = std::move(spoil)](std::uint64_t at, DeviceSample& s) {
        if (at == tick) spoil(s);
      });
}

}  // namespace palpate::stability
