/// A tick or a step that allocates or locks fails here.

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include <atomic>
#include <cstdlib>
#include <mutex>
#include <new>

#include "core/simulation/simulation.h"
#include "tests/core/simulation/fragment_scene.h"

namespace {
thread_local bool watching = false;
thread_local long allocations = 0;
thread_local long locks = 0;

void* counted(std::size_t size) {
  if (watching) ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
void* countedAligned(std::size_t size, std::align_val_t alignment) {
  if (watching) ++allocations;
  void* memory = nullptr;
  if (::posix_memalign(&memory, static_cast<std::size_t>(alignment), size == 0 ? 1 : size) == 0) {
    return memory;
  }
  throw std::bad_alloc();
}
}  // namespace

void* operator new(std::size_t size) {
  return counted(size);
}
void* operator new[](std::size_t size) {
  return counted(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return countedAligned(size, alignment);
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return countedAligned(size, alignment);
}
void operator delete(void* memory) noexcept {
  if (watching) ++allocations;
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  if (watching) ++allocations;
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  operator delete(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  operator delete[](memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  operator delete(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
  operator delete[](memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  operator delete(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
  operator delete[](memory);
}

extern "C" int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  using Lock = int (*)(pthread_mutex_t*);
  static const auto real = reinterpret_cast<Lock>(::dlsym(RTLD_NEXT, "pthread_mutex_lock"));
  if (watching) ++locks;
  return real(mutex);
}

namespace palpate {
namespace {

class Watch {
 public:
  Watch() {
    allocations = locks = 0;
    watching = true;
  }
  ~Watch() { watching = false; }
};

class NoSink final : public RunSink {
 public:
  bool onTick(const ServoSample&) noexcept override { return true; }
  bool onStep(const StepRecord& step) noexcept override {
    inContact += step.contacts > 0 ? 1 : 0;
    return true;
  }
  bool onCommand(std::uint64_t, const Command&) noexcept override { return true; }
  int inContact = 0;
};

TEST(RealTimeGuard, TheWatchSeesAllocationsAndLocks) {
  std::mutex mutex;
  const auto volatile size = 100;
  {
    const Watch watch;
    delete[] new char[static_cast<std::size_t>(size)];
    const std::lock_guard<std::mutex> lock(mutex);
  }
  EXPECT_EQ(allocations, 2);
  EXPECT_EQ(locks, 1);
}

TEST(RealTimeGuard, TenThousandTicksAndStepsNeitherAllocateNorLock) {
  const auto scene = prepared(ball());
  NoSink sink;
  RunOptions options;
  options.sink = &sink;
  auto runner = makeRunner(scene, options);
  ASSERT_TRUE(runner->send({Command::Kind::SetFriction, 1}));
  const Progress progress;
  Result<void> ran;
  {
    const Watch watch;
    ran = runner->runVirtual(10.0, progress);
  }
  ASSERT_TRUE(ran);
  EXPECT_EQ(allocations, 0);
  EXPECT_EQ(locks, 0);
  EXPECT_EQ(runner->report().steps, 10000U);
  EXPECT_GT(sink.inContact, 1000);
}

TEST(RealTimeGuard, TenThousandStepsPressedDeepNeitherAllocateNorLock) {
  for (const QueryMethod method :
       {QueryMethod::Hierarchy, QueryMethod::Paper, QueryMethod::BruteForce}) {
    Scene asked;
    asked.setting.query.method = method;
    asked.setting.contactCapacity = 500;  // overflows: the cut list must not allocate either
    const auto scene = prepared(ball(), asked);
    Simulation simulation(scene, CouplingGains{});
    auto snapshot = std::make_unique<Snapshot>();
    DeviceSample sample;
    sample.pose = plain(scene->X_WD);
    // The tool starts 3 mm inside and is pulled 5 mm in: in contact from the first step on.
    const Eigen::Vector3d in = -scene->X_WD.linear().col(1);
    for (int axis = 0; axis < 3; ++axis) sample.pose.p[axis] += 3e-3 * in[axis];
    std::uint64_t contacts = 0;
    const int steps = method == QueryMethod::Hierarchy ? 10000 : 1000;
    {
      const Watch watch;
      for (int i = 0; i < steps; ++i) {
        sample.index = static_cast<std::uint64_t>(i);
        contacts += simulation.step(sample).contacts;
        simulation.fill(*snapshot);
      }
    }
    EXPECT_EQ(allocations, 0);
    EXPECT_EQ(locks, 0);
    EXPECT_GT(contacts, static_cast<std::uint64_t>(steps));
  }
}

TEST(RealTimeGuard, AGovernorAndEveryChangeOfLevelNeitherAllocateNorLock) {
  const auto grid = basin({{-3, -3, 0}, {-2, -4, 8}}, 6);
  const auto plainScene = prepare(sceneWithFragments(Eigen::Vector3d(0, 0, -9.81)), grid);
  ASSERT_TRUE(plainScene) << sentence(plainScene.error());
  std::vector<GovernorLevel> levels(4);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    levels[i].name =
        "a level whose name is longer than any small string holds " + std::to_string(i);
    levels[i].stepP99_us = 100.0 / static_cast<double>(i + 1);
  }
  levels[1].perceptualBound = 1e-3;
  levels[2].contactBudget = 5;
  levels[3].stopLevel = 1;
  const auto scene = withLevels(**plainScene, levels);
  ASSERT_TRUE(scene) << sentence(scene.error());
  NoSink sink;
  RunOptions options;
  options.sink = &sink;
  options.modelledTime.step_us = 900.0;  // over the budget at any level: down to the coarsest
  auto runner = makeRunner(*scene, options);
  const Progress progress;
  Result<void> ran;
  {
    const Watch watch;
    ran = runner->runVirtual(0.1, progress);
    for (int i = 0; ran && i < 400; ++i) {
      (void)runner->send({Command::Kind::SetLevel, static_cast<double>(i % 4)});
      ran = runner->runVirtual(0.01, progress);
    }
  }
  ASSERT_TRUE(ran);
  EXPECT_EQ(allocations, 0);
  EXPECT_EQ(locks, 0);
  EXPECT_GT(runner->report().governor->changeCount, 400u);
  EXPECT_TRUE(runner->report().governor->governed);
}

TEST(RealTimeGuard, LooseBodiesInAHeapAndStepsOfEveryLengthNeitherAllocateNorLock) {
  const auto grid = basin({{-3, -3, 0}, {-2, -4, 8}, {-5, -2, 16}}, 6);
  const Eigen::Vector3d down = grid->geometry.X_PV.linear() * Eigen::Vector3d(0, 0, -9.81);
  const auto scene = prepare(sceneWithFragments(down), grid);
  ASSERT_TRUE(scene) << sentence(scene.error());
  Simulation simulation(*scene, CouplingGains{});
  auto snapshot = std::make_unique<Snapshot>();
  DeviceSample sample = farAway(**scene, 0);
  std::uint64_t touching = 0;
  {
    const Watch watch;
    for (std::uint64_t i = 0; i < 3000; ++i) {
      sample.index += 1 + i / 300;
      touching += simulation.step(sample).contactsBetweenBodies;
      simulation.fill(*snapshot);
    }
  }
  EXPECT_EQ(allocations, 0);
  EXPECT_EQ(locks, 0);
  EXPECT_GT(touching, 1000U);
}

}  // namespace
}  // namespace palpate
