/// Nothing in a tick or a step allocates or locks: malloc and pthread_mutex_lock are counted over
/// ten thousand ticks, in contact. And what a tick costs, printed.

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "core/devices/simulated_phantom.h"
#include "tests/stability/closed_loop.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PALPATE_INTERCEPTS 0  // the sanitizers put their own in these places
#else
#define PALPATE_INTERCEPTS 1
#endif

namespace {
std::atomic<bool> counting{false};
std::atomic<long> allocations{0}, locks{0};
void count(std::atomic<long>& what) {
  if (counting.load(std::memory_order_relaxed)) what.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace

#if PALPATE_INTERCEPTS
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

// operator new and Eigen's aligned allocation end in these.
void* malloc(std::size_t n) noexcept {
  count(allocations);
  return __libc_malloc(n);
}
void* calloc(std::size_t n, std::size_t size) noexcept {
  count(allocations);
  return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t n) noexcept {
  count(allocations);
  return __libc_realloc(p, n);
}
void* aligned_alloc(std::size_t alignment, std::size_t n) noexcept {
  count(allocations);
  return __libc_memalign(alignment, n);
}
int pthread_mutex_lock(pthread_mutex_t* m) noexcept {
  count(locks);
  using Lock = int (*)(pthread_mutex_t*);
  static const Lock real = reinterpret_cast<Lock>(dlsym(RTLD_NEXT, "pthread_mutex_lock"));
  return real(m);
}
}
#endif

namespace palpate::stability {
namespace {

TEST(ServoGuard, TenThousandTicksAndStepsInContactNeitherAllocateNorLock) {
#if !PALPATE_INTERCEPTS
  GTEST_SKIP() << "The sanitizers replace malloc and the locks themselves.";
#endif
  LoopCase c;
  c.seconds = 12.0;
  c.meddle = [](std::uint64_t tick, ServoLoop&) {
    if (tick == 1500) counting = true;  // in contact by then
    if (tick == 11500) counting = false;
    return true;
  };
  allocations = locks = 0;
  const LoopResult r = runLoop(c);
  EXPECT_EQ(allocations.load(), 0);
  EXPECT_EQ(locks.load(), 0);
  std::uint64_t inContact = 0;
  for (std::size_t i = 1500; i < 11500; ++i) inContact += r.samples[i].contacts > 0 ? 1 : 0;
  EXPECT_GT(inContact, 4000u);
}

TEST(ServoGuard, WouldSeeAnAllocationAndALock) {
#if !PALPATE_INTERCEPTS
  GTEST_SKIP() << "The sanitizers replace malloc and the locks themselves.";
#endif
  allocations = locks = 0;
  counting = true;
  auto* v = new std::vector<double>(100);
  pthread_mutex_t m = PTHREAD_MUTEX_INITIALIZER;
  pthread_mutex_lock(&m);
  pthread_mutex_unlock(&m);
  counting = false;
  EXPECT_EQ(v->size(), 100u);
  delete v;
  EXPECT_GE(allocations.load(), 2);
  EXPECT_EQ(locks.load(), 1);
}

/// The servo's own share: the device here answers at once, as hardware's driver would.
class ReadyDevice final : public HapticDevice {
 public:
  const DeviceInfo& info() const noexcept override { return info_; }
  Result<void> open() override { return {}; }
  void close() noexcept override {}
  DeviceSample read(std::uint64_t tick) noexcept override {
    DeviceSample s;
    s.pose.p[0] = 1e-5 * static_cast<double>(tick % 100);
    s.buttons = 1;
    return s;
  }
  void write(const Wrench& w) noexcept override { got_ = w; }

 private:
  DeviceInfo info_;
  Wrench got_;
};

double percentile(std::vector<double> v, double p) {
  const auto at = static_cast<std::ptrdiff_t>(p * static_cast<double>(v.size() - 1));
  std::nth_element(v.begin(), v.begin() + at, v.end());
  return v[static_cast<std::size_t>(at)];
}

void printCost(const char* what, HapticDevice& device) {
  ServoLoop servo(device, {});
  std::vector<double> micros;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    ToolState tool;
    tool.step = i + 1;
    tool.dueTick = i;
    servo.publishTool(tool);
    const auto t0 = std::chrono::steady_clock::now();
    (void)servo.tick();
    const auto t1 = std::chrono::steady_clock::now();
    micros.push_back(std::chrono::duration<double, std::micro>(t1 - t0).count());
  }
  std::printf("servo tick, %s: p50 %.2f us  p99 %.2f us  p99.9 %.2f us\n", what,
              percentile(micros, 0.5), percentile(micros, 0.99), percentile(micros, 0.999));
  EXPECT_LT(percentile(micros, 0.5), 200.0);  // a fifth of the period, on any machine
}

TEST(ServoGuard, CostOfATick) {
  ReadyDevice ready;
  printCost("device answering at once", ready);
  auto simulated = makeSimulatedPhantom("touch-x", makeSearchingHand(1), 1);
  ASSERT_TRUE(simulated);
  ASSERT_TRUE((*simulated)->open());
  printCost("simulated Touch X and hand included", **simulated);
}

}  // namespace
}  // namespace palpate::stability
