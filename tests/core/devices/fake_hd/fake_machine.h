#pragma once
/// For tests: the fake vendor library as dlopen gives it, and an owner of the servo's tick.

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <thread>
#include <vector>

#include "core/base/latest_value.h"
#include "core/devices/phantom.h"
#include "tests/core/devices/fake_hd/fake_hd.h"

namespace palpate::test {

inline const fake_hd::Controls& fakeControls() {
  static const fake_hd::Controls* const controls = [] {
    void* library = dlopen(FAKE_HD, RTLD_NOW | RTLD_GLOBAL);
    void* found = library != nullptr ? dlsym(library, "fake_controls") : nullptr;
    if (found == nullptr) {
      std::fprintf(stderr, "fake library: %s\n", dlerror());
      std::abort();
    }
    return reinterpret_cast<const fake_hd::Controls* (*)()>(found)();
  }();
  return *controls;
}

/// HDAPI's layout of a pose: columns, millimetres.
inline std::array<double, 16> transform(const Eigen::Isometry3d& X) {
  std::array<double, 16> out{};
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      out[static_cast<std::size_t>(4 * column + row)] =
          X.matrix()(row, column) * (column == 3 && row < 3 ? 1e3 : 1.0);
  return out;
}

inline Eigen::Isometry3d at(double x, double y, double z) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = Eigen::Vector3d(x, y, z);
  return X;
}

inline double norm(const double (&v)[3]) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/// Stands for the servo loop: reads, writes a wrench that the test chooses, notes the sample.
class Owner {
 public:
  explicit Owner(Phantom& phantom) : phantom_(phantom) {}
  ~Owner() { phantom_.stopServo(); }
  void start() { ASSERT_TRUE(phantom_.startServo(&Owner::tick, this)); }

  void push(const Wrench& wrench) { wanted_.publish(wrench); }
  void pushForce(double x, double y, double z) {
    Wrench wrench;
    wrench.force[0] = x, wrench.force[1] = y, wrench.force[2] = z;
    push(wrench);
  }
  void pauseWriting(bool paused) { silent_.store(paused); }
  /// The newest sample. The test's thread.
  DeviceSample sample() {
    samples_.refresh();
    return samples_.value();
  }
  std::uint64_t ticks() const { return ticks_.load(); }

 private:
  static void tick(void* owner) noexcept { static_cast<Owner*>(owner)->tick(); }
  void tick() noexcept {
    const std::uint64_t now = ticks_.load();
    samples_.publish(phantom_.read(now));
    wanted_.refresh();
    if (!silent_.load()) phantom_.write(wanted_.value());
    ticks_.store(now + 1);
  }
  Phantom& phantom_;
  LatestValue<DeviceSample> samples_;
  LatestValue<Wrench> wanted_;
  std::atomic<std::uint64_t> ticks_{0};
  std::atomic<bool> silent_{false};
};

class FakeMachine : public ::testing::Test {
 protected:
  void SetUp() override {
    fake().reset();
    fake().setPeriodMicroseconds(200);
  }
  static const fake_hd::Controls& fake() { return fakeControls(); }

  static PhantomOptions options(std::vector<std::string> names = {"Default PHANToM",
                                                                  "Default Device", ""}) {
    PhantomOptions options;
    options.names = std::move(names);
    options.libraries = {FAKE_HD};
    return options;
  }
  static int configure(const fake_hd::DeviceSetup& setup) { return fake().configure(&setup); }

  /// Waits up to ten seconds.
  template <class Condition>
  static bool eventually(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    return true;
  }
  static bool reaches(Phantom& phantom, hd::DriverState state) {
    return eventually([&] { return phantom.status().state == state; });
  }
  static std::vector<fake_hd::TickRecord> records(int device, std::size_t newest = 20000) {
    std::vector<fake_hd::TickRecord> all(newest);
    all.resize(fake().records(device, all.data(), newest));
    return all;
  }
  static double appliedForce(int device) {
    double force[3];
    fake().appliedForce(device, force);
    return norm(force);
  }
};

}  // namespace palpate::test
